//! Matrices in a static pattern, which are assembled repeatedly.

use super::pattern::{Emit, NONE, Pattern, Record};
use crate::math::Scalar;
use crate::math::slices::dot_at;
use rayon::prelude::*;
use std::sync::Arc;

/// Entries from which on a product is divided among processors, and the columns that are one piece of it.
const SIDE_BY_SIDE: usize = 1 << 17;
const COLUMNS: usize = 256;

/// A matrix in a static pattern.
#[derive(Clone, Debug)]
pub struct SparseMatrix<S> {
    /// Positions of the entries.
    pub pattern: Arc<Pattern>,
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
    slots: &'a [u32],
    weights: &'a [f64],
    next: usize,
    values: &'a mut [S],
}

impl<S: Scalar> Emit<S> for SharedReplay<'_, S> {
    fn add(&mut self, _: usize, _: usize, value: S) {
        let own = self.starts[self.next] as usize..self.starts[self.next + 1] as usize;
        for (&slot, &weight) in self.slots[own.clone()].iter().zip(&self.weights[own]) {
            self.values[slot as usize] += value * weight;
        }
        self.next += 1;
    }
}

impl<S: Scalar> SparseMatrix<S> {
    /// A matrix of zeros.
    pub fn new(pattern: impl Into<Arc<Pattern>>) -> Self {
        let pattern = pattern.into();
        let values = vec![S::zero(); pattern.entries()];
        Self { pattern, values }
    }

    /// Replaces the values by those of the recorded assembly.
    pub fn assemble(&mut self, assemble: impl FnOnce(&mut dyn Emit<S>)) {
        self.values.fill(S::zero());
        let values = &mut self.values[..];
        let whole = match &self.pattern.record {
            Record::Whole(slots) => {
                let slots = slots.iter();
                let mut replay = Replay { slots, values };
                assemble(&mut replay);
                replay.slots.next().is_none()
            }
            Record::Shared {
                starts,
                slots,
                weights,
            } => {
                let mut replay = SharedReplay {
                    starts,
                    slots,
                    weights,
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
    pub fn emit(&self, at: (usize, usize), scale: S, emit: &mut dyn Emit<S>) {
        let starts = self.pattern.column_starts();
        for j in 0..self.pattern.order() {
            for k in starts[j]..starts[j + 1] {
                emit.add(
                    at.0 + self.pattern.rows()[k],
                    at.1 + j,
                    self.values[k] * scale,
                );
            }
        }
    }

    /// The inner product of column j with x.
    fn along(&self, j: usize, x: &[S]) -> S {
        let starts = self.pattern.column_starts();
        let own = starts[j]..starts[j + 1];
        dot_at(&self.values[own.clone()], &self.pattern.rows()[own], x)
    }

    /// The product Aᵀ x, side by side for large matrices.
    pub fn multiply_transposed(&self, x: &[S], out: &mut [S]) {
        self.each_column(out, |j| self.along(j, x));
    }

    /// What is left of Aᵀ x = b, b − Aᵀ x; zero in columns that do not count.
    pub fn remain_transposed(&self, x: &[S], b: &[S], counts: &[bool], out: &mut [S]) {
        self.each_column(out, |j| match counts.get(j) {
            Some(false) => S::zero(),
            _ => b[j] - self.along(j, x),
        });
    }

    /// Sets an entry for each column, side by side for large matrices.
    fn each_column(&self, out: &mut [S], entry: impl Fn(usize) -> S + Sync) {
        let out = &mut out[..self.pattern.order()];
        if self.values.len() < SIDE_BY_SIDE {
            (out.iter_mut().enumerate()).for_each(|(j, out)| *out = entry(j));
        } else {
            let all = out.par_iter_mut().with_min_len(COLUMNS).enumerate();
            all.for_each(|(j, out)| *out = entry(j));
        }
    }

    /// The product A x.
    pub fn multiply_into(&self, x: &[S], out: &mut [S]) {
        out.fill(S::zero());
        let starts = self.pattern.column_starts();
        for (j, &x) in x.iter().enumerate() {
            let own = starts[j]..starts[j + 1];
            let entries = self.values[own.clone()].iter();
            for (&value, &row) in entries.zip(&self.pattern.rows()[own]) {
                out[row] += value * x;
            }
        }
    }

    /// The product A x.
    pub fn multiply(&self, x: &[S]) -> Vec<S> {
        let mut y = vec![S::zero(); x.len()];
        self.multiply_into(x, &mut y);
        y
    }
}

#[cfg(test)]
impl SparseMatrix<f64> {
    /// The largest remainder of A x = b and of Aᵀ y = b.
    pub fn remainder(&self, [x, y]: [&[f64]; 2], b: &[f64]) -> f64 {
        let mut by_y = vec![0.0; y.len()];
        self.multiply_transposed(y, &mut by_y);
        let products = [self.multiply(x), by_y];
        let all = products.iter().flat_map(|product| product.iter().zip(b));
        all.fold(0.0, |most, (a, b)| match (a - b).abs() {
            rest if rest.is_nan() => f64::INFINITY,
            rest => most.max(rest),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Vec3;

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
