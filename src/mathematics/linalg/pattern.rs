//! Static sparsity patterns.
//!
//! An assembly emits its entries (row, column, value) in an order that does not depend on values.
//! The first pass records the place of each entry. Later passes replay the record, so an entry
//! costs one indexed addition. Entries at the same place are summed.

use super::places::Places;
use crate::math::{Mat3, Scalar, Team, Vec3};
use std::sync::Arc;

/// Receives the entries of an assembly in their fixed order.
pub trait Emit<S: Scalar> {
    /// Adds `value` at (`row`, `column`).
    fn add(&mut self, row: usize, column: usize, value: S);

    /// Adds a 3 × 3 block with its corner at (`row`, `column`).
    fn add_block(&mut self, row: usize, column: usize, block: &Mat3<S>) {
        for i in 0..3 {
            for j in 0..3 {
                self.add(row + i, column + j, block[(i, j)]);
            }
        }
    }

    /// Adds `value` times the identity of order 3 with its corner at (`row`, `column`).
    fn add_identity(&mut self, row: usize, column: usize, value: S) {
        for i in 0..3 {
            self.add(row + i, column + i, value);
        }
    }

    /// Adds a row of three entries.
    fn add_row(&mut self, row: usize, column: usize, values: &Vec3<S>) {
        for j in 0..3 {
            self.add(row, column + j, values[j]);
        }
    }

    /// Adds a column of three entries.
    fn add_column(&mut self, row: usize, column: usize, values: &Vec3<S>) {
        for i in 0..3 {
            self.add(row + i, column, values[i]);
        }
    }

    /// Adds `scale` times a dense block, by rows, at `rows` and `columns`.
    fn add_dense(&mut self, rows: &[usize], columns: &[usize], scale: S, block: &[S]) {
        let mut values = block.iter();
        for &row in rows {
            for (&column, &value) in columns.iter().zip(&mut values) {
                self.add(row, column, value * scale);
            }
        }
    }
}

/// The slot of an entry that is left out.
pub(super) const NONE: u32 = u32::MAX;

/// Positions of the non-zeros of a square matrix in compressed columns.
#[derive(Clone, Debug)]
pub struct Pattern {
    pub(super) places: Arc<Places>,
    pub(super) record: Record,
    /// Pivots that are known before the values.
    known_pivots: Option<Arc<KnownPivots>>,
    /// The ranks that factorise matrices of this pattern together.
    team: Team,
}

/// Pivots (row, column) that are known before the values, in the order of their elimination: those
/// of structures with many elastic coordinates, whose matrices are nearly symmetric and definite.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct KnownPivots {
    /// Rows with few entries, eliminated first; no two of their rows and columns share an entry.
    pub short: Vec<(usize, usize)>,
    /// The others.
    pub inner: Vec<(usize, usize)>,
}

/// Slots of the entries of an assembly, in its order.
#[derive(Clone, Debug)]
pub(super) enum Record {
    /// One slot per entry, or [`NONE`].
    Whole(Arc<[u32]>),
    /// Entry k goes to the slots from `starts[k]` to `starts[k + 1]`, each with a weight.
    Shared {
        starts: Vec<u32>,
        slots: Arc<[u32]>,
        weights: Vec<f64>,
    },
}

/// Collects the places of an assembly: column and row.
struct Recorder(Vec<[u32; 2]>);

impl<S: Scalar> Emit<S> for Recorder {
    fn add(&mut self, row: usize, column: usize, _: S) {
        self.0.push([column as u32, row as u32]);
    }
}

/// Entries of a reduced assembly: where those of each entry begin, their places and weights.
struct Shares {
    starts: Vec<u32>,
    places: Vec<[u32; 2]>,
    weights: Vec<f64>,
}

impl Shares {
    fn of<S: Scalar>(
        shares: impl Fn(usize) -> [(usize, f64); 2],
        assemble: impl FnOnce(&mut dyn Emit<S>),
    ) -> Self {
        let mut recorder = Recorder(Vec::new());
        assemble(&mut recorder);
        let (mut starts, mut places, mut weights) = (vec![0], Vec::new(), Vec::new());
        for &[column, row] in &recorder.0 {
            for (i, x) in shares(row as usize) {
                for (j, y) in shares(column as usize) {
                    if x * y != 0.0 {
                        places.push([j as u32, i as u32]);
                        weights.push(x * y);
                    }
                }
            }
            starts.push(u32::try_from(places.len()).expect("fewer than 2^32 entries"));
        }
        Self {
            starts,
            places,
            weights,
        }
    }
}

impl Record {
    /// The record of a reduced assembly whose places have these slots.
    fn of_shares(all: Shares, slots: Arc<[u32]>) -> Self {
        let Shares {
            starts, weights, ..
        } = all;
        // An entry that stays as it is, or is left out, needs no weight.
        let single = starts.windows(2).all(|own| own[1] - own[0] <= 1);
        if !(single && weights.iter().all(|&weight| weight == 1.0)) {
            return Self::Shared {
                starts,
                slots,
                weights,
            };
        }
        let own = starts.windows(2).map(|own| match own[1] > own[0] {
            true => slots[own[0] as usize],
            false => NONE,
        });
        Self::Whole(own.collect())
    }
}

impl Pattern {
    /// Records the pattern of order `n` of an assembly.
    pub fn record<S: Scalar>(n: usize, assemble: impl FnOnce(&mut dyn Emit<S>)) -> Self {
        let mut recorder = Recorder(Vec::new());
        assemble(&mut recorder);
        let (places, slots) = Places::record(n, &recorder.0);
        Self::new(places, Record::Whole(slots))
    }

    /// Records the pattern of order `n` of Bᵀ A B for an assembly of A. `shares` gives a row of B:
    /// the columns and values of its non-zeros (a zero value is ignored).
    pub fn record_reduced<S: Scalar>(
        n: usize,
        shares: impl Fn(usize) -> [(usize, f64); 2],
        assemble: impl FnOnce(&mut dyn Emit<S>),
    ) -> Self {
        let all = Shares::of(shares, assemble);
        let (places, slots) = Places::record(n, &all.places);
        Self::new(places, Record::of_shares(all, slots))
    }

    /// The same pattern for another assembly, of some of its entries.
    pub fn for_assembly<S: Scalar>(&self, assemble: impl FnOnce(&mut dyn Emit<S>)) -> Self {
        let mut recorder = Recorder(Vec::new());
        assemble(&mut recorder);
        self.with_record(Record::Whole(self.places.slots_of(&recorder.0)))
    }

    /// As [`Pattern::for_assembly`], reduced.
    pub fn for_reduced<S: Scalar>(
        &self,
        shares: impl Fn(usize) -> [(usize, f64); 2],
        assemble: impl FnOnce(&mut dyn Emit<S>),
    ) -> Self {
        let all = Shares::of(shares, assemble);
        let slots = self.places.slots_of(&all.places);
        self.with_record(Record::of_shares(all, slots))
    }

    fn new(places: Arc<Places>, record: Record) -> Self {
        Self {
            places,
            record,
            known_pivots: None,
            team: Team::default(),
        }
    }

    fn with_record(&self, record: Record) -> Self {
        Self {
            record,
            ..self.clone()
        }
    }

    /// The pattern with pivots that are known before the values; none if there are none.
    pub fn with_pivots(mut self, pivots: KnownPivots) -> Self {
        self.known_pivots = (!pivots.inner.is_empty()).then(|| Arc::new(pivots));
        self
    }

    /// The pattern of matrices that some ranks factorise together.
    pub fn with_team(mut self, team: Team) -> Self {
        self.team = team;
        self
    }

    /// The ranks that factorise matrices of this pattern together.
    pub fn team(&self) -> &Team {
        &self.team
    }

    /// Pivots that are known before the values.
    pub fn known_pivots(&self) -> Option<&KnownPivots> {
        self.known_pivots.as_deref()
    }

    /// Order of the matrix.
    pub fn order(&self) -> usize {
        self.places.order()
    }

    /// Number of stored entries.
    pub fn entries(&self) -> usize {
        self.places.rows.len()
    }

    /// First entry of each column, and the number of entries; length order + 1.
    pub fn column_starts(&self) -> &[usize] {
        &self.places.starts
    }

    /// Slots of the entries of `other`, a part of this pattern.
    ///
    /// # Panics
    /// An entry of `other` is not in this pattern.
    pub fn slots_of(&self, other: &Self) -> Vec<usize> {
        let [own, part] = [&*self.places, &*other.places];
        let mut slots = Vec::with_capacity(other.entries());
        for j in 0..other.order() {
            let column = own.starts[j]..own.starts[j + 1];
            for row in &part.rows[part.starts[j]..part.starts[j + 1]] {
                let at = own.rows[column.clone()].binary_search(row);
                slots.push(column.start + at.expect("the other pattern is a part of this"));
            }
        }
        slots
    }

    /// Row of each entry.
    pub fn rows(&self) -> &[usize] {
        &self.places.rows
    }
}
