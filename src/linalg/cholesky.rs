//! Sparse Cholesky factorisation of symmetric positive definite matrices, analysed once.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::LltRegularization;
use faer::perm::PermRef;
use faer::sparse::linalg::amd;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par, Side};

/// Growth of a random vector by the solution of the matrix with ones on its diagonal from which on
/// it counts as singular.
const SINGULAR_GROWTH: f64 = 1e14;
/// What is added to the diagonal to find the weakest direction of a matrix that has no factors.
const PROBE_SHIFT: f64 = 1e-9;

/// The lower part, diagonal included, of a symmetric sparse matrix by columns.
#[derive(Clone, Debug, PartialEq)]
pub struct SymmetricPattern {
    starts: Vec<usize>,
    rows: Vec<usize>,
}

impl SymmetricPattern {
    /// The pattern whose column j has `columns[j]` for its rows: sorted, none twice, the first being j.
    ///
    /// # Panics
    /// If that does not hold.
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

    /// Where entry (i, j) of the lower part, i ≥ j, stands among the values.
    pub fn slot(&self, i: usize, j: usize) -> Option<usize> {
        let start = self.starts[j];
        let column = &self.rows[start..self.starts[j + 1]];
        column.binary_search(&i).ok().map(|at| start + at)
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

/// The matrix is not positive definite: along `direction` it has no stiffness, or less.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error(
    "the matrix is not positive definite: xᵀA x / xᵀ diag(A) x = {quotient:.1e} along a direction"
)]
pub struct NotPositiveDefinite {
    /// xᵀ A x / xᵀ diag(A) x.
    pub quotient: f64,
    /// The direction x.
    pub direction: Vec<f64>,
}

/// Factors L Lᵀ = D A D, D making the diagonal ones. The order of the rows is the caller's: see
/// [`fill_reducing_order`].
pub struct SparseCholesky {
    symbolic: SymbolicCholesky<usize>,
    factors: Vec<f64>,
    scale: Vec<f64>,
    scaled: Vec<f64>,
    scratch: MemBuffer,
}

impl SparseCholesky {
    /// Analyses a pattern.
    ///
    /// # Panics
    /// If memory is exhausted.
    pub fn new(pattern: &SymmetricPattern) -> Self {
        let same: Vec<usize> = (0..pattern.order()).collect();
        // faer reads the lower part of a matrix only when it is given an order.
        let symbolic = factorize_symbolic_cholesky(
            structure(pattern),
            Side::Lower,
            SymmetricOrdering::Custom(PermRef::new_checked(&same, &same, pattern.order())),
            CholeskySymbolicParams::default(),
        )
        .expect("the analysis fails only when memory is exhausted");
        let factorise = symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Default::default());
        let solve = symbolic.solve_in_place_scratch::<f64>(1, Par::Seq);
        Self {
            factors: vec![0.0; symbolic.len_val()],
            scale: vec![1.0; pattern.order()],
            scaled: vec![0.0; pattern.entries()],
            scratch: MemBuffer::new(factorise.or(solve)),
            symbolic,
        }
    }

    /// Entries of the factor.
    pub fn entries(&self) -> usize {
        self.factors.len()
    }

    /// Factorises the matrix of these values.
    ///
    /// # Errors
    /// [`NotPositiveDefinite`] if a pivot is not positive, or if the matrix is singular to round-off.
    pub fn factorise(
        &mut self,
        pattern: &SymmetricPattern,
        values: &[f64],
    ) -> Result<(), NotPositiveDefinite> {
        for j in 0..pattern.order() {
            let diagonal = values[pattern.starts[j]];
            self.scale[j] = if diagonal > 0.0 {
                1.0 / diagonal.sqrt()
            } else {
                1.0
            };
        }
        if self.factorise_shifted(pattern, values, 0.0) && self.growth() < SINGULAR_GROWTH {
            return Ok(());
        }
        Err(self.weakest(pattern, values))
    }

    /// Factorises D A D + `shift` I; false if it has no factors.
    fn factorise_shifted(
        &mut self,
        pattern: &SymmetricPattern,
        values: &[f64],
        shift: f64,
    ) -> bool {
        for j in 0..pattern.order() {
            for at in pattern.starts[j]..pattern.starts[j + 1] {
                self.scaled[at] = values[at] * self.scale[j] * self.scale[pattern.rows[at]];
            }
            self.scaled[pattern.starts[j]] += shift;
        }
        let factors = self.symbolic.factorize_numeric_llt(
            &mut self.factors,
            SparseColMatRef::new(structure(pattern), &self.scaled),
            Side::Lower,
            LltRegularization::default(),
            Par::Seq,
            MemStack::new(&mut self.scratch),
            Default::default(),
        );
        factors.is_ok() && self.factors.iter().all(|x| x.is_finite())
    }

    /// Growth of a vector that no mode is likely to be orthogonal to.
    fn growth(&mut self) -> f64 {
        let mut x: Vec<f64> = (0..self.scale.len()).map(|i| (i as f64).sin()).collect();
        let before = norm(&x);
        self.solve_scaled(&mut x);
        norm(&x) / before
    }

    /// The weakest direction, by inverse iteration with a shift that makes the matrix definite.
    fn weakest(&mut self, pattern: &SymmetricPattern, values: &[f64]) -> NotPositiveDefinite {
        let mut shift = PROBE_SHIFT;
        while !self.factorise_shifted(pattern, values, shift) && shift < 1e3 {
            shift *= 10.0;
        }
        let order = pattern.order();
        let mut x: Vec<f64> = (0..order).map(|i| (i as f64).sin()).collect();
        for _ in 0..10 {
            self.solve_scaled(&mut x);
            let size = norm(&x);
            x.iter_mut().for_each(|x| *x /= size);
        }
        for (x, s) in x.iter_mut().zip(&self.scale) {
            *x *= s;
        }
        let mut product = vec![0.0; order];
        pattern.multiply(values, &x, &mut product);
        let work: f64 = x.iter().zip(&product).map(|(x, y)| x * y).sum();
        NotPositiveDefinite {
            quotient: work,
            direction: x,
        }
    }

    /// Solves A x = b in place.
    pub fn solve(&mut self, b: &mut [f64]) {
        for (b, s) in b.iter_mut().zip(&self.scale) {
            *b *= s;
        }
        self.solve_scaled(b);
        for (b, s) in b.iter_mut().zip(&self.scale) {
            *b *= s;
        }
    }

    fn solve_scaled(&mut self, b: &mut [f64]) {
        let order = b.len();
        LltRef::<usize, f64>::new(&self.symbolic, &self.factors).solve_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(b, order, 1),
            Par::Seq,
            MemStack::new(&mut self.scratch),
        );
    }
}

fn norm(x: &[f64]) -> f64 {
    x.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// An order of the nodes of a graph that keeps the fill of a factorisation small (approximate minimum
/// degree): `order[k]` is the node that comes k-th. `neighbours[j]` are the neighbours i > j, sorted.
///
/// # Panics
/// If memory is exhausted.
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

fn structure(pattern: &SymmetricPattern) -> SymbolicSparseColMatRef<'_, usize> {
    let n = pattern.order();
    SymbolicSparseColMatRef::new_checked(n, n, &pattern.starts, None, &pattern.rows)
}
