//! Static sparsity patterns, and matrices that are assembled into them again and again.
//!
//! An assembly emits its entries (row, column, value) in an order that does not depend on values.
//! The first pass records where each emitted entry goes; later passes replay the record, so
//! adding an entry is one indexed addition. Entries at the same place add up.

use crate::math::{Mat3, Scalar, Vec3};
use std::collections::BTreeSet;

/// Receives the entries of an assembly, in its fixed order.
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
}

/// Places of the non-zeros of a square matrix by compressed columns.
#[derive(Clone, Debug)]
pub struct Pattern {
    column_starts: Vec<usize>,
    rows: Vec<usize>,
    slots: Vec<u32>,
}

/// Collects the places that an assembly touches.
struct Recorder(Vec<(usize, usize)>);

impl<S: Scalar> Emit<S> for Recorder {
    fn add(&mut self, row: usize, column: usize, _: S) {
        self.0.push((column, row));
    }
}

impl Pattern {
    /// Records the pattern of order `n` of the given assembly.
    pub fn record<S: Scalar>(n: usize, assemble: impl FnOnce(&mut dyn Emit<S>)) -> Self {
        let mut recorder = Recorder(Vec::new());
        assemble(&mut recorder);
        let places: BTreeSet<_> = recorder.0.iter().copied().collect();
        let mut column_starts = vec![0; n + 1];
        for &(column, _) in &places {
            column_starts[column + 1] += 1;
        }
        for j in 0..n {
            column_starts[j + 1] += column_starts[j];
        }
        let sorted: Vec<(usize, usize)> = places.into_iter().collect();
        let slots = recorder
            .0
            .iter()
            .map(|place| {
                let slot = sorted
                    .binary_search(place)
                    .expect("every place was recorded");
                u32::try_from(slot).expect("fewer than 2^32 entries")
            })
            .collect();
        Self {
            column_starts,
            rows: sorted.into_iter().map(|(_, row)| row).collect(),
            slots,
        }
    }

    /// Order of the matrix.
    pub fn order(&self) -> usize {
        self.column_starts.len() - 1
    }

    /// Number of stored entries.
    pub fn entries(&self) -> usize {
        self.rows.len()
    }

    /// Start of each column among the entries, and one past the last.
    pub fn column_starts(&self) -> &[usize] {
        &self.column_starts
    }

    /// Row of each entry.
    pub fn rows(&self) -> &[usize] {
        &self.rows
    }
}

/// A matrix in a static pattern.
#[derive(Clone, Debug)]
pub struct SparseMatrix<S> {
    /// Where the entries are.
    pub pattern: Pattern,
    /// Their values.
    pub values: Vec<S>,
}

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
        self.values[slot as usize] += value;
    }
}

impl<S: Scalar> SparseMatrix<S> {
    /// A matrix of zeros.
    pub fn new(pattern: Pattern) -> Self {
        let values = vec![S::zero(); pattern.entries()];
        Self { pattern, values }
    }

    /// Replaces the values by those that the recorded assembly emits now.
    pub fn assemble(&mut self, assemble: impl FnOnce(&mut dyn Emit<S>)) {
        self.values.fill(S::zero());
        let mut replay = Replay {
            slots: self.pattern.slots.iter(),
            values: &mut self.values,
        };
        assemble(&mut replay);
        debug_assert!(
            replay.slots.next().is_none(),
            "an assembly emits as often as recorded"
        );
    }

    /// The product Aᵀ x.
    pub fn multiply_transposed(&self, x: &[S]) -> Vec<S> {
        let column = |j: usize| self.pattern.column_starts[j]..self.pattern.column_starts[j + 1];
        let entry = |k: usize| self.values[k] * x[self.pattern.rows[k]];
        (0..x.len())
            .map(|j| column(j).fold(S::zero(), |sum, k| sum + entry(k)))
            .collect()
    }

    /// The product A x.
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
}
