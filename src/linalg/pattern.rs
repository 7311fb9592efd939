//! Static sparsity patterns, and matrices that are assembled into them repeatedly.
//!
//! An assembly emits its entries (row, column, value) in an order that does not depend on values.
//! The first pass records the place of each entry. Later passes replay the record, so an entry
//! costs one indexed addition. Entries at the same place are summed.

use crate::math::{Mat3, Scalar, Vec3};
use std::sync::Arc;

/// Receives the entries of an assembly in their fixed order.
pub(crate) trait Emit<S: Scalar> {
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
const NONE: u32 = u32::MAX;

/// Positions of the non-zeros of a square matrix in compressed columns.
#[derive(Clone, Debug)]
pub(crate) struct Pattern {
    column_starts: Vec<usize>,
    rows: Vec<usize>,
    record: Record,
    /// Pivots that are known before the values.
    known_pivots: Option<Arc<KnownPivots>>,
}

/// Pivots (row, column) that are known before the values, in the order of their elimination: of structures
/// with many elastic coordinates, whose own matrices are nearly symmetric and definite.
#[derive(Clone, Debug, Default)]
pub(crate) struct KnownPivots {
    /// Rows with few entries, eliminated first; no two of their rows and columns share an entry.
    pub short: Vec<(usize, usize)>,
    /// The others.
    pub inner: Vec<(usize, usize)>,
}

/// Slots of the entries of an assembly, in its order.
#[derive(Clone, Debug)]
enum Record {
    /// One slot per entry, or [`NONE`].
    Whole(Vec<u32>),
    /// Entry k goes to the slots from `starts[k]` to `starts[k + 1]`, each with a weight.
    Shared {
        starts: Vec<u32>,
        shares: Vec<(u32, f64)>,
    },
}

/// Collects the places of an assembly.
struct Recorder(Vec<(usize, usize)>);

impl<S: Scalar> Emit<S> for Recorder {
    fn add(&mut self, row: usize, column: usize, _: S) {
        self.0.push((column, row));
    }
}

impl Pattern {
    /// Records the pattern of order `n` of an assembly.
    pub(crate) fn record<S: Scalar>(n: usize, assemble: impl FnOnce(&mut dyn Emit<S>)) -> Self {
        let mut recorder = Recorder(Vec::new());
        assemble(&mut recorder);
        let (column_starts, sorted) = Self::sort(n, &recorder.0);
        let slots = recorder.0.iter().map(|place| slot(&sorted, place));
        Self {
            record: Record::Whole(slots.collect()),
            known_pivots: None,
            column_starts,
            rows: sorted.into_iter().map(|(_, row)| row).collect(),
        }
    }

    /// Records the pattern of order `n` of Bᵀ A B for an assembly of A. `shares` gives a row of B:
    /// the columns and values of its non-zeros (a zero value is ignored).
    pub(crate) fn record_reduced<S: Scalar>(
        n: usize,
        shares: impl Fn(usize) -> [(usize, f64); 2],
        assemble: impl FnOnce(&mut dyn Emit<S>),
    ) -> Self {
        let mut recorder = Recorder(Vec::new());
        assemble(&mut recorder);
        let (mut starts, mut places, mut weights) = (vec![0], Vec::new(), Vec::new());
        for &(column, row) in &recorder.0 {
            for (i, x) in shares(row) {
                for (j, y) in shares(column) {
                    if x * y != 0.0 {
                        places.push((j, i));
                        weights.push(x * y);
                    }
                }
            }
            starts.push(u32::try_from(places.len()).expect("fewer than 2^32 entries"));
        }
        let (column_starts, sorted) = Self::sort(n, &places);
        let slots = places.iter().map(|place| slot(&sorted, place));
        // An entry that stays as it is, or is left out, needs no weight.
        let single = starts.windows(2).all(|own| own[1] - own[0] <= 1);
        let record = if single && weights.iter().all(|&weight| weight == 1.0) {
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
        Self {
            record,
            known_pivots: None,
            column_starts,
            rows: sorted.into_iter().map(|(_, row)| row).collect(),
        }
    }

    /// Column starts, and the distinct places (column, row) in ascending order.
    fn sort(n: usize, places: &[(usize, usize)]) -> (Vec<usize>, Vec<(usize, usize)>) {
        let mut sorted = places.to_vec();
        sorted.sort_unstable();
        sorted.dedup();
        let mut column_starts = vec![0; n + 1];
        for &(column, _) in &sorted {
            column_starts[column + 1] += 1;
        }
        for j in 0..n {
            column_starts[j + 1] += column_starts[j];
        }
        (column_starts, sorted)
    }

    /// The pattern with pivots that are known before the values; none if there are none.
    pub(crate) fn with_pivots(mut self, pivots: KnownPivots) -> Self {
        self.known_pivots = (!pivots.inner.is_empty()).then(|| Arc::new(pivots));
        self
    }

    /// Pivots that are known before the values.
    pub(crate) fn known_pivots(&self) -> Option<&KnownPivots> {
        self.known_pivots.as_deref()
    }

    /// Order of the matrix.
    pub(crate) fn order(&self) -> usize {
        self.column_starts.len() - 1
    }

    /// Number of stored entries.
    pub(crate) fn entries(&self) -> usize {
        self.rows.len()
    }

    /// First entry of each column, and the number of entries; length order + 1.
    pub(crate) fn column_starts(&self) -> &[usize] {
        &self.column_starts
    }

    /// Slots of the entries of `other`, a part of this pattern.
    ///
    /// # Panics
    /// An entry of `other` is not in this pattern.
    pub(crate) fn slots_of(&self, other: &Self) -> Vec<usize> {
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
    pub(crate) fn rows(&self) -> &[usize] {
        &self.rows
    }
}

/// Index of a place among those of a pattern.
fn slot(sorted: &[(usize, usize)], place: &(usize, usize)) -> u32 {
    let slot = sorted
        .binary_search(place)
        .expect("every place was recorded");
    u32::try_from(slot).expect("fewer than 2^32 entries")
}

/// A matrix in a static pattern.
#[derive(Clone, Debug)]
pub(crate) struct SparseMatrix<S> {
    /// Positions of the entries.
    pub pattern: Pattern,
    /// Values of the entries, in the order of the pattern.
    pub values: Vec<S>,
}

/// Adds the entries to their slots.
struct Replay<'a, S> {
    slots: std::slice::Iter<'a, u32>,
    values: &'a mut [S],
}

impl<S: Scalar> Emit<S> for Replay<'_, S> {
    fn add(&mut self, _: usize, _: usize, value: S) {
        let slot = *self
            .slots
            .next()
            .expect("an assembly emits as often as when recorded");
        if slot != NONE {
            self.values[slot as usize] += value;
        }
    }

    fn add_dense(&mut self, _: &[usize], _: &[usize], scale: S, block: &[S]) {
        let (own, rest) = self.slots.as_slice().split_at(block.len());
        self.slots = rest.iter();
        for (&slot, &value) in own.iter().zip(block) {
            if slot != NONE {
                self.values[slot as usize] += value * scale;
            }
        }
    }
}

/// Adds the entries, with their weights, to their slots.
struct SharedReplay<'a, S> {
    starts: &'a [u32],
    shares: &'a [(u32, f64)],
    next: usize,
    values: &'a mut [S],
}

impl<S: Scalar> Emit<S> for SharedReplay<'_, S> {
    fn add(&mut self, _: usize, _: usize, value: S) {
        let own = self.starts[self.next] as usize..self.starts[self.next + 1] as usize;
        for &(slot, weight) in &self.shares[own] {
            self.values[slot as usize] += value * weight;
        }
        self.next += 1;
    }
}

impl<S: Scalar> SparseMatrix<S> {
    /// A matrix of zeros.
    pub(crate) fn new(pattern: Pattern) -> Self {
        let values = vec![S::zero(); pattern.entries()];
        Self { pattern, values }
    }

    /// Replaces the values by those of the recorded assembly.
    pub(crate) fn assemble(&mut self, assemble: impl FnOnce(&mut dyn Emit<S>)) {
        self.values.fill(S::zero());
        let values = &mut self.values[..];
        let whole = match &self.pattern.record {
            Record::Whole(slots) => {
                let slots = slots.iter();
                let mut replay = Replay { slots, values };
                assemble(&mut replay);
                replay.slots.next().is_none()
            }
            Record::Shared { starts, shares } => {
                let mut replay = SharedReplay {
                    starts,
                    shares,
                    next: 0,
                    values,
                };
                assemble(&mut replay);
                replay.next + 1 == starts.len()
            }
        };
        debug_assert!(whole, "an assembly emits as often as recorded");
    }

    /// Emits every entry, shifted by `at` and multiplied by `scale`.
    pub(crate) fn emit(&self, at: (usize, usize), scale: S, emit: &mut dyn Emit<S>) {
        let starts = self.pattern.column_starts();
        for j in 0..self.pattern.order() {
            for k in starts[j]..starts[j + 1] {
                emit.add(
                    at.0 + self.pattern.rows[k],
                    at.1 + j,
                    self.values[k] * scale,
                );
            }
        }
    }

    /// The product Aᵀ x.
    pub(crate) fn multiply_transposed(&self, x: &[S], out: &mut [S]) {
        for (j, out) in out.iter_mut().enumerate().take(self.pattern.order()) {
            let own = self.pattern.column_starts[j]..self.pattern.column_starts[j + 1];
            let entries = self.values[own.clone()].iter().zip(&self.pattern.rows[own]);
            *out = entries.fold(S::zero(), |sum, (&value, &row)| sum + value * x[row]);
        }
    }

    /// The product A x.
    #[cfg(test)]
    pub fn multiply(&self, x: &[S]) -> Vec<S> {
        let mut y = vec![S::zero(); x.len()];
        for j in 0..x.len() {
            for k in self.pattern.column_starts[j]..self.pattern.column_starts[j + 1] {
                y[self.pattern.rows[k]] += self.values[k] * x[j];
            }
        }
        y
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn replay_adds_up_entries_at_the_same_place() {
        let assembly = |scale: f64| {
            move |emit: &mut dyn Emit<f64>| {
                emit.add(0, 1, scale);
                emit.add_identity(1, 1, 2.0 * scale);
                emit.add(0, 1, 3.0 * scale);
                emit.add_row(0, 1, &Vec3::new(1.0, 0.0, 0.0));
            }
        };
        let mut matrix = SparseMatrix::new(Pattern::record(4, assembly(0.0)));
        for scale in [1.0, 10.0] {
            matrix.assemble(assembly(scale));
            let y = matrix.multiply(&[0.0, 1.0, 0.0, 0.0]);
            assert_eq!(y, [4.0 * scale + 1.0, 2.0 * scale, 0.0, 0.0]);
        }
        assert_eq!(matrix.pattern.entries(), 6);
    }

    /// B has the rows (0.6, 0.8), (0, 0) and (1, 0).
    #[test]
    fn shares_reduce_a_matrix() {
        let rows = [[0.6, 0.8], [0.0, 0.0], [1.0, 0.0]];
        let shares = |i: usize| [(0, rows[i][0]), (1, rows[i][1])];
        let entry = |i: usize, j: usize| (1 + 3 * i + j) as f64;
        let assembly = |emit: &mut dyn Emit<f64>| {
            for k in 0..9 {
                emit.add(k / 3, k % 3, entry(k / 3, k % 3));
            }
        };
        let mut matrix = SparseMatrix::new(Pattern::record_reduced(2, shares, assembly));
        matrix.assemble(assembly);
        for (c, unit) in [[1.0, 0.0], [0.0, 1.0]].iter().enumerate() {
            let column = matrix.multiply(unit);
            for (r, found) in column.iter().enumerate() {
                let all = (0..9).map(|k| rows[k / 3][r] * entry(k / 3, k % 3) * rows[k % 3][c]);
                assert!((found - all.sum::<f64>()).abs() < 1e-14);
            }
        }
    }
}
