//! Static sparsity patterns.
//!
//! An assembly emits its entries (row, column, value) in an order that does not depend on values.
//! The first pass records the place of each entry. Later passes replay the record, so an entry
//! costs one indexed addition. Entries at the same place are summed.

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
    column_starts: Vec<usize>,
    rows: Vec<usize>,
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
    Whole(Vec<u32>),
    /// Entry k goes to the slots from `starts[k]` to `starts[k + 1]`, each with a weight.
    Shared {
        starts: Vec<u32>,
        shares: Vec<(u32, f64)>,
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

impl Pattern {
    /// Records the pattern of order `n` of an assembly.
    pub fn record<S: Scalar>(n: usize, assemble: impl FnOnce(&mut dyn Emit<S>)) -> Self {
        let mut recorder = Recorder(Vec::new());
        assemble(&mut recorder);
        let mut pattern = Self::of(n, &recorder.0);
        pattern.record_places(&recorder.0);
        pattern
    }

    /// Records the pattern of order `n` of Bᵀ A B for an assembly of A. `shares` gives a row of B:
    /// the columns and values of its non-zeros (a zero value is ignored).
    pub fn record_reduced<S: Scalar>(
        n: usize,
        shares: impl Fn(usize) -> [(usize, f64); 2],
        assemble: impl FnOnce(&mut dyn Emit<S>),
    ) -> Self {
        let all = Shares::of(shares, assemble);
        let mut pattern = Self::of(n, &all.places);
        pattern.record_shares(all);
        pattern
    }

    /// The same pattern for another assembly, of some of its entries.
    pub fn for_assembly<S: Scalar>(&self, assemble: impl FnOnce(&mut dyn Emit<S>)) -> Self {
        let mut recorder = Recorder(Vec::new());
        assemble(&mut recorder);
        let mut pattern = self.clone();
        pattern.record_places(&recorder.0);
        pattern
    }

    /// As [`Pattern::for_assembly`], reduced.
    pub fn for_reduced<S: Scalar>(
        &self,
        shares: impl Fn(usize) -> [(usize, f64); 2],
        assemble: impl FnOnce(&mut dyn Emit<S>),
    ) -> Self {
        let mut pattern = self.clone();
        pattern.record_shares(Shares::of(shares, assemble));
        pattern
    }

    fn record_places(&mut self, places: &[[u32; 2]]) {
        let slots = places.iter().map(|place| self.slot(place));
        self.record = Record::Whole(slots.collect());
    }

    fn record_shares(&mut self, all: Shares) {
        let Shares {
            starts,
            places,
            weights,
        } = all;
        let slots = places.iter().map(|place| self.slot(place));
        // An entry that stays as it is, or is left out, needs no weight.
        let single = starts.windows(2).all(|own| own[1] - own[0] <= 1);
        self.record = if single && weights.iter().all(|&weight| weight == 1.0) {
            let mut slots = slots;
            let own = starts.windows(2).map(|own| match own[1] > own[0] {
                true => slots.next().unwrap_or(NONE),
                false => NONE,
            });
            Record::Whole(own.collect())
        } else {
            let shares = slots.zip(weights).collect();
            Record::Shared { starts, shares }
        };
    }

    /// The pattern of order `n` of places (column, row), without a record.
    fn of(n: usize, places: &[[u32; 2]]) -> Self {
        // Sorted by columns, then within each column.
        let mut starts = vec![0; n + 1];
        for &[column, _] in places {
            starts[column as usize + 1] += 1;
        }
        for j in 0..n {
            starts[j + 1] += starts[j];
        }
        let (mut next, mut sorted) = (starts.clone(), vec![0_u32; places.len()]);
        for &[column, row] in places {
            let at = &mut next[column as usize];
            sorted[*at] = row;
            *at += 1;
        }
        let (mut column_starts, mut rows) = (vec![0], Vec::new());
        for j in 0..n {
            let own = &mut sorted[starts[j]..starts[j + 1]];
            own.sort_unstable();
            let mut last = None;
            for &row in &*own {
                if last.replace(row) != Some(row) {
                    rows.push(row as usize);
                }
            }
            column_starts.push(rows.len());
        }
        rows.shrink_to_fit();
        Self {
            column_starts,
            rows,
            record: Record::Whole(Vec::new()),
            known_pivots: None,
            team: Team::default(),
        }
    }

    /// Index of a place (column, row) of this pattern.
    fn slot(&self, &[column, row]: &[u32; 2]) -> u32 {
        let column = column as usize;
        let start = self.column_starts[column];
        let own = &self.rows[start..self.column_starts[column + 1]];
        let found = own.binary_search(&(row as usize));
        let slot = start + found.expect("every place was recorded");
        u32::try_from(slot).expect("fewer than 2^32 entries")
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
        self.column_starts.len() - 1
    }

    /// Number of stored entries.
    pub fn entries(&self) -> usize {
        self.rows.len()
    }

    /// First entry of each column, and the number of entries; length order + 1.
    pub fn column_starts(&self) -> &[usize] {
        &self.column_starts
    }

    /// Slots of the entries of `other`, a part of this pattern.
    ///
    /// # Panics
    /// An entry of `other` is not in this pattern.
    pub fn slots_of(&self, other: &Self) -> Vec<usize> {
        let mut slots = Vec::with_capacity(other.entries());
        for j in 0..other.order() {
            let own = self.column_starts[j]..self.column_starts[j + 1];
            for row in &other.rows[other.column_starts[j]..other.column_starts[j + 1]] {
                let at = self.rows[own.clone()].binary_search(row);
                slots.push(own.start + at.expect("the other pattern is a part of this"));
            }
        }
        slots
    }

    /// Row of each entry.
    pub fn rows(&self) -> &[usize] {
        &self.rows
    }
}
