//! LU factorisation with a known pivot sequence.
//!
//! Matrices of consecutive steps differ little, so a pivot sequence that was good for one is good
//! for the next. Structure and order of elimination are planned once and replayed with new values
//! (left-looking, Gilbert & Peierls 1988; refactorisation of KLU, Davis & Palamadai Natarajan
//! 2010). The replay fails if a pivot has become too small.

use super::matrix::SparseMatrix;
use super::pattern::Pattern;
use super::scaling::{Equilibration, size};
use crate::math::Scalar;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// A pivot below this fraction of the largest candidate of its column is rejected.
const THRESHOLD: f64 = 0.1;

/// A pivot of the matrix is zero, not finite, or too small relative to other candidates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct BadPivot {
    /// Column of the matrix.
    pub column: usize,
    /// Whether another pivot in the same column is acceptable.
    pub replaceable: bool,
}

/// Columns of a triangular factor without its diagonal; rows ascend in pivot order.
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

    fn clear(&mut self) {
        self.starts.truncate(1);
        self.rows.clear();
        self.values.clear();
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

/// Planned elimination and the factors of the latest matrix: P R A C Q = L U. L has a unit
/// diagonal, R and C are diagonal with powers of two.
pub(super) struct Replay<S> {
    /// Column of the matrix of the j-th pivot.
    columns: Vec<usize>,
    /// Row of the matrix of the j-th pivot.
    pivot_rows: Vec<usize>,
    /// By entry of the matrix: its row in pivot order.
    entry_rows: Vec<u32>,
    /// By entry of the matrix: its scale.
    scales: Vec<f64>,
    scaling: Equilibration,
    lower: Triangle<S>,
    upper: Triangle<S>,
    /// Reciprocals of the pivots.
    inverse_pivots: Vec<S>,
    work: Vec<S>,
    /// By row of the matrix: its index in pivot order.
    place: Vec<u32>,
    /// For planning: the last column that used each row, and the rows that follow.
    seen: Vec<u32>,
    heap: BinaryHeap<Reverse<u32>>,
}

impl<S: Scalar> Replay<S> {
    /// An elimination without plan: columns of matrices of this pattern in the given order.
    pub fn new(pattern: &Pattern, columns: &[usize]) -> Self {
        let n = pattern.order();
        Self {
            columns: columns.to_vec(),
            pivot_rows: vec![0; n],
            entry_rows: vec![0; pattern.entries()],
            scales: vec![1.0; pattern.entries()],
            scaling: Equilibration::new(pattern),
            lower: Triangle::new(),
            upper: Triangle::new(),
            inverse_pivots: vec![S::zero(); n],
            work: vec![S::zero(); n],
            place: vec![0; n],
            seen: vec![u32::MAX; n],
            heap: BinaryHeap::new(),
        }
    }

    /// Plans the elimination of a matrix with this scaling; row `pivot_rows[j]` has pivot j.
    pub fn plan(&mut self, pattern: &Pattern, scaling: &Equilibration, pivot_rows: &[usize]) {
        self.scaling.set(scaling);
        self.pivot_rows.copy_from_slice(pivot_rows);
        for (j, &row) in pivot_rows.iter().enumerate() {
            self.place[row] = j as u32;
        }
        for (own, &row) in self.entry_rows.iter_mut().zip(pattern.rows()) {
            *own = self.place[row];
        }
        let starts = pattern.column_starts().windows(2);
        for (own, &by) in starts.zip(&scaling.columns) {
            for k in own[0]..own[1] {
                self.scales[k] = scaling.rows[pattern.rows()[k]] * by;
            }
        }
        let Self {
            lower,
            upper,
            seen,
            heap,
            ..
        } = self;
        seen.fill(u32::MAX);
        lower.clear();
        upper.clear();
        for (j, &column) in self.columns.iter().enumerate() {
            let j = j as u32;
            let entries = pattern.column_starts()[column]..pattern.column_starts()[column + 1];
            let mut add = |rows: &[u32], heap: &mut BinaryHeap<Reverse<u32>>| {
                for &i in rows {
                    if seen[i as usize] != j {
                        seen[i as usize] = j;
                        heap.push(Reverse(i));
                    }
                }
            };
            add(&self.entry_rows[entries], heap);
            // Fill lies below the entry that causes it, so the rows come in ascending order.
            while let Some(Reverse(i)) = heap.pop() {
                if i < j {
                    upper.rows.push(i);
                    add(lower.rows(i as usize), heap);
                } else if i > j {
                    lower.rows.push(i);
                }
            }
            upper.close_column();
            lower.close_column();
        }
    }

    /// The rows of the pivots and the scaling in use.
    pub fn planned(&self) -> (&[usize], &Equilibration) {
        (&self.pivot_rows, &self.scaling)
    }

    /// Number of entries of both factors, and of floating-point operations of a factorisation.
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

    /// The smallest pivot of the scaled matrix in the columns from `first` on, and its column.
    pub fn smallest_pivot(&self, first: usize) -> (f64, usize) {
        let mut found = (0.0, first);
        for (&inverse, &column) in self.inverse_pivots.iter().zip(&self.columns) {
            if column >= first && size(inverse) > found.0 {
                found = (size(inverse), column);
            }
        }
        (1.0 / found.0, found.1)
    }

    /// Factorises `matrix`, which has the planned pattern.
    ///
    /// # Errors
    /// [`BadPivot`]; the factors are then not usable.
    pub fn factorise(&mut self, matrix: &SparseMatrix<S>) -> Result<(), BadPivot> {
        let starts = matrix.pattern.column_starts();
        let x = &mut self.work;
        for (j, &column) in self.columns.iter().enumerate() {
            for k in starts[column]..starts[column + 1] {
                x[self.entry_rows[k] as usize] = matrix.values[k] * self.scales[k];
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
                largest = largest.max(size(v));
                *value = v * inverse;
            }
            let size = size(pivot);
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
            *x = b[row] * self.scaling.rows[row];
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
            b[column] = std::mem::replace(x, S::zero()) * self.scaling.columns[column];
        }
    }

    /// Solves Aᵀ x = b in place.
    pub fn solve_transposed(&mut self, b: &mut [S]) {
        let x = &mut self.work;
        for (x, &column) in x.iter_mut().zip(&self.columns) {
            *x = b[column] * self.scaling.columns[column];
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
            b[row] = std::mem::replace(x, S::zero()) * self.scaling.rows[row];
        }
    }
}
