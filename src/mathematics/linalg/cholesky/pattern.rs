//! The pattern of a symmetric matrix, and an order of its rows with little fill.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::SymbolicSparseColMatRef;
use faer::sparse::linalg::amd;

/// The lower part of a symmetric sparse matrix, with its diagonal, in compressed columns.
#[derive(Clone, Debug, PartialEq)]
pub struct SymmetricPattern {
    pub(super) starts: Vec<usize>,
    pub(super) rows: Vec<usize>,
}

impl SymmetricPattern {
    /// The pattern with the rows `columns[j]` in column j: ascending and unique, the first is j.
    ///
    /// # Panics
    /// A column is not so.
    pub fn new(columns: &[Vec<usize>]) -> Self {
        let mut starts = vec![0];
        let mut rows = Vec::with_capacity(columns.iter().map(Vec::len).sum());
        for (j, column) in columns.iter().enumerate() {
            assert!(column.first() == Some(&j) && column.is_sorted_by(|a, b| a < b));
            rows.extend_from_slice(column);
            starts.push(rows.len());
        }
        Self { starts, rows }
    }

    /// Number of rows.
    pub fn order(&self) -> usize {
        self.starts.len() - 1
    }

    /// Number of entries of the lower part.
    pub fn entries(&self) -> usize {
        self.rows.len()
    }

    /// Index of entry (i, j), i ≥ j, among the values; `None` if it is not stored.
    pub fn slot(&self, i: usize, j: usize) -> Option<usize> {
        let start = self.starts[j];
        let column = &self.rows[start..self.starts[j + 1]];
        column.binary_search(&i).ok().map(|at| start + at)
    }

    /// Slots and rows of the stored entries of a column; the first is the diagonal.
    pub fn column(&self, j: usize) -> impl Iterator<Item = (usize, usize)> + '_ {
        (self.starts[j]..self.starts[j + 1]).map(|at| (at, self.rows[at]))
    }

    /// r = b − A x, every entry rounded only once or twice: the rounding errors of products and
    /// sums are added (Dekker 1971, Knuth 1969). Refinement with such residuals gives solutions of
    /// full accuracy.
    pub fn exact_residual(&self, values: &[f64], x: &[f64], b: &[f64], r: &mut [f64]) {
        let mut lost = vec![0.0; b.len()];
        r.copy_from_slice(b);
        let mut subtract = |i: usize, a: f64, x: f64| {
            let (product, rest) = two_product(a, x);
            let (sum, error) = two_sum(r[i], -product);
            r[i] = sum;
            lost[i] += error - rest;
        };
        for j in 0..self.order() {
            for at in self.starts[j]..self.starts[j + 1] {
                let (i, a) = (self.rows[at], values[at]);
                subtract(i, a, x[j]);
                if i != j {
                    subtract(j, a, x[i]);
                }
            }
        }
        for (r, lost) in r.iter_mut().zip(&lost) {
            *r += lost;
        }
    }

    /// y = A x.
    pub fn multiply(&self, values: &[f64], x: &[f64], y: &mut [f64]) {
        y.fill(0.0);
        for j in 0..self.order() {
            let mut sum = 0.0;
            for at in self.starts[j]..self.starts[j + 1] {
                let (i, a) = (self.rows[at], values[at]);
                y[i] += a * x[j];
                if i != j {
                    sum += a * x[i];
                }
            }
            y[j] += sum;
        }
    }
}

/// a + b, and its rounding error.
fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let part = sum - a;
    (sum, (a - (sum - part)) + (b - part))
}

/// a b, and its rounding error.
fn two_product(a: f64, b: f64) -> (f64, f64) {
    let split = |x: f64| {
        let large = 134_217_729.0 * x;
        let high = large - (large - x);
        (high, x - high)
    };
    let (product, (a1, a2), (b1, b2)) = (a * b, split(a), split(b));
    (
        product,
        a2 * b2 - (((product - a1 * b1) - a2 * b1) - a1 * b2),
    )
}

/// An order of the nodes of a graph with little fill (approximate minimum degree). `order[k]` is
/// the k-th node; `neighbours[j]` are the neighbours i > j, ascending.
///
/// # Panics
/// Memory is exhausted.
pub fn fill_reducing_order(neighbours: &[Vec<usize>]) -> Vec<usize> {
    let columns: Vec<Vec<usize>> = neighbours
        .iter()
        .enumerate()
        .map(|(j, rows)| std::iter::once(j).chain(rows.iter().copied()).collect())
        .collect();
    // The upper part by columns is the lower part by rows; the graph is the same.
    let pattern = SymmetricPattern::new(&columns);
    let (n, entries) = (pattern.order(), pattern.entries());
    let (mut order, mut inverse) = (vec![0; n], vec![0; n]);
    let mut scratch = MemBuffer::new(amd::order_maybe_unsorted_scratch::<usize>(n, entries));
    amd::order_maybe_unsorted(
        &mut order,
        &mut inverse,
        structure(&pattern),
        amd::Control::default(),
        MemStack::new(&mut scratch),
    )
    .expect("the ordering fails only when memory is exhausted");
    order
}

pub(super) fn structure(pattern: &SymmetricPattern) -> SymbolicSparseColMatRef<'_, usize> {
    let n = pattern.order();
    SymbolicSparseColMatRef::new_checked(n, n, &pattern.starts, None, &pattern.rows)
}
