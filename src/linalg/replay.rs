//! LU factorisation with a pivot sequence that is known beforehand.
//!
//! The matrices of consecutive steps differ little, and a pivot sequence that was good for one is
//! good for the next: structure and order of elimination are planned once and replayed with new
//! values (left-looking, as in Gilbert & Peierls 1988 and in the refactorisation of KLU, Davis &
//! Palamadai Natarajan 2010). A pivot that has become too small ends the replay.

use super::pattern::{Pattern, SparseMatrix};
use crate::math::Scalar;
use std::collections::BTreeSet;

/// A pivot smaller than this part of the largest candidate of its column is refused.
const THRESHOLD: f64 = 0.1;

/// The pivot of some column of the matrix is zero, not finite, or too small beside the others.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct BadPivot {
    /// Column of the matrix.
    pub column: usize,
    /// Whether another pivot of the same column would do.
    pub replaceable: bool,
}

/// Columns of a triangular factor, diagonal left out, rows ascending in pivot order.
struct Triangle<S> {
    starts: Vec<usize>,
    rows: Vec<u32>,
    values: Vec<S>,
}

impl<S: Scalar> Triangle<S> {
    fn new() -> Self {
        Self {
            starts: vec![0],
            rows: Vec::new(),
            values: Vec::new(),
        }
    }

    fn close_column(&mut self) {
        self.starts.push(self.rows.len());
        self.values.resize(self.rows.len(), S::zero());
    }

    fn rows(&self, j: usize) -> &[u32] {
        &self.rows[self.starts[j]..self.starts[j + 1]]
    }

    fn column(&self, j: usize) -> impl Iterator<Item = (usize, S)> + '_ {
        let at = self.starts[j]..self.starts[j + 1];
        let rows = self.rows[at.clone()].iter().map(|&i| i as usize);
        rows.zip(self.values[at].iter().copied())
    }
}

/// Planned elimination and the factors of the latest matrix: P A Q = L U, L with unit diagonal.
pub(super) struct Replay<S> {
    /// Column of the matrix that is eliminated j-th.
    columns: Vec<usize>,
    /// Row of the matrix that is the j-th pivot's.
    pivot_rows: Vec<usize>,
    /// Rows of the matrix's entries in pivot order, entry by entry.
    entry_rows: Vec<u32>,
    lower: Triangle<S>,
    upper: Triangle<S>,
    /// Reciprocals of the pivots.
    inverse_pivots: Vec<S>,
    work: Vec<S>,
}

impl<S: Scalar> Replay<S> {
    /// Plans the elimination: pivot j stands in row `pivot_rows[j]` and column `columns[j]`.
    pub fn plan(pattern: &Pattern, pivot_rows: &[usize], columns: &[usize]) -> Self {
        let n = pattern.order();
        let mut place = vec![0_u32; n];
        for (j, &row) in pivot_rows.iter().enumerate() {
            place[row] = j as u32;
        }
        let entry_rows: Vec<u32> = pattern.rows().iter().map(|&i| place[i]).collect();
        let mut lower = Triangle::new();
        let mut upper = Triangle::new();
        for (j, &column) in columns.iter().enumerate() {
            let entries = pattern.column_starts()[column]..pattern.column_starts()[column + 1];
            let mut fill: BTreeSet<u32> = entry_rows[entries].iter().copied().collect();
            let mut next = 0;
            while let Some(&k) = fill.range(next..j as u32).next() {
                fill.extend(lower.rows(k as usize));
                next = k + 1;
            }
            let j = j as u32;
            upper.rows.extend(fill.range(..j));
            lower.rows.extend(fill.range(j + 1..));
            upper.close_column();
            lower.close_column();
        }
        Self {
            columns: columns.to_vec(),
            pivot_rows: pivot_rows.to_vec(),
            entry_rows,
            lower,
            upper,
            inverse_pivots: vec![S::zero(); n],
            work: vec![S::zero(); n],
        }
    }

    /// Entries of both factors, and floating-point operations of a factorisation.
    pub fn cost(&self) -> (usize, usize) {
        let n = self.columns.len();
        let column = |j: usize| {
            let updates = self.upper.rows(j).iter();
            let updates: usize = updates
                .map(|&k| 2 * self.lower.rows(k as usize).len())
                .sum();
            updates + self.lower.rows(j).len() + 1
        };
        let entries = n + self.lower.rows.len() + self.upper.rows.len();
        (entries, (0..n).map(column).sum())
    }

    /// Eliminates the values of `matrix`, whose pattern was planned for.
    ///
    /// # Errors
    /// [`BadPivot`]; the factors are then of no use.
    pub fn factorise(&mut self, matrix: &SparseMatrix<S>) -> Result<(), BadPivot> {
        let starts = matrix.pattern.column_starts();
        let x = &mut self.work;
        for (j, &column) in self.columns.iter().enumerate() {
            for k in starts[column]..starts[column + 1] {
                x[self.entry_rows[k] as usize] = matrix.values[k];
            }
            let at = self.upper.starts[j]..self.upper.starts[j + 1];
            for (&k, value) in self.upper.rows[at.clone()]
                .iter()
                .zip(&mut self.upper.values[at])
            {
                let u = std::mem::replace(&mut x[k as usize], S::zero());
                *value = u;
                for (i, l) in self.lower.column(k as usize) {
                    x[i] -= l * u;
                }
            }
            let pivot = std::mem::replace(&mut x[j], S::zero());
            let inverse = S::one() / pivot;
            let at = self.lower.starts[j]..self.lower.starts[j + 1];
            let mut largest = 0.0_f64;
            for (&i, value) in self.lower.rows[at.clone()]
                .iter()
                .zip(&mut self.lower.values[at])
            {
                let v = std::mem::replace(&mut x[i as usize], S::zero());
                largest = largest.max(v.re().abs());
                *value = v * inverse;
            }
            let size = pivot.re().abs();
            if !size.is_finite() || size <= f64::MIN_POSITIVE || size < THRESHOLD * largest {
                x.fill(S::zero());
                return Err(BadPivot {
                    column,
                    replaceable: size.is_finite() && size < THRESHOLD * largest,
                });
            }
            self.inverse_pivots[j] = inverse;
        }
        Ok(())
    }

    /// Solves A x = b in place.
    pub fn solve(&mut self, b: &mut [S]) {
        let x = &mut self.work;
        for (x, &row) in x.iter_mut().zip(&self.pivot_rows) {
            *x = b[row];
        }
        for j in 0..x.len() {
            let u = x[j];
            for (i, l) in self.lower.column(j) {
                x[i] -= l * u;
            }
        }
        for j in (0..x.len()).rev() {
            let u = x[j] * self.inverse_pivots[j];
            x[j] = u;
            for (i, a) in self.upper.column(j) {
                x[i] -= a * u;
            }
        }
        for (x, &column) in x.iter_mut().zip(&self.columns) {
            b[column] = std::mem::replace(x, S::zero());
        }
    }

    /// Solves Aᵀ x = b in place.
    pub fn solve_transposed(&mut self, b: &mut [S]) {
        let x = &mut self.work;
        for (x, &column) in x.iter_mut().zip(&self.columns) {
            *x = b[column];
        }
        for j in 0..x.len() {
            let sum = self
                .upper
                .column(j)
                .fold(x[j], |sum, (i, u)| sum - u * x[i]);
            x[j] = sum * self.inverse_pivots[j];
        }
        for j in (0..x.len()).rev() {
            x[j] = self
                .lower
                .column(j)
                .fold(x[j], |sum, (i, l)| sum - l * x[i]);
        }
        for (x, &row) in x.iter_mut().zip(&self.pivot_rows) {
            b[row] = std::mem::replace(x, S::zero());
        }
    }
}
