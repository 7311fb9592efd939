//! Sparse Cholesky factorisation of symmetric positive definite matrices: one analysis, many
//! matrices.

mod inertia;
mod pattern;

pub use pattern::{SymmetricPattern, fill_reducing_order};

use pattern::structure;

use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::linalg::cholesky::llt::factor::LltRegularization;
use faer::perm::PermRef;
use faer::sparse::SparseColMatRef;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::{Conj, MatMut, Par, Side};

/// The matrix with unit diagonal is singular if its solution magnifies a random vector by this
/// factor.
const SINGULAR_GROWTH: f64 = 1e14;
/// Columns are factorised in dense blocks above this work per entry of the factor (in units of 40
/// operations, as faer counts). On two plates of 64 shells this takes 1.8 ms, column by column 7.2
/// ms.
const SUPERNODAL_FROM: SupernodalThreshold = SupernodalThreshold(0.3);
/// First shift of the diagonal in the search for the weakest direction of an indefinite matrix.
const PROBE_SHIFT: f64 = 1e-9;
/// The last one, with the diagonal scaled to one.
const LAST_SHIFT: f64 = 1e15;

/// The matrix is not positive definite: its stiffness along `direction` is zero or negative.
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

/// Factors L Lᵀ = D A D, where D makes the diagonal one. The caller orders the rows; see
/// [`fill_reducing_order`].
pub struct SparseCholesky {
    symbolic: SymbolicCholesky<usize>,
    factors: Vec<f64>,
    scale: Vec<f64>,
    scaled: Vec<f64>,
    scratch: MemBuffer,
    /// Number of right sides for which the scratch memory suffices.
    columns: usize,
}

impl SparseCholesky {
    /// Analyses a pattern.
    ///
    /// # Panics
    /// Memory is exhausted.
    pub fn new(pattern: &SymmetricPattern) -> Self {
        let same: Vec<usize> = (0..pattern.order()).collect();
        // Only with an explicit order does faer read just the lower part.
        let symbolic = factorize_symbolic_cholesky(
            structure(pattern),
            Side::Lower,
            SymmetricOrdering::Custom(PermRef::new_checked(&same, &same, pattern.order())),
            CholeskySymbolicParams {
                supernodal_flop_ratio_threshold: SUPERNODAL_FROM,
                ..CholeskySymbolicParams::default()
            },
        )
        .expect("the analysis fails only when memory is exhausted");
        let solve = symbolic.solve_in_place_scratch::<f64>(1, Par::Seq);
        Self {
            factors: vec![0.0; symbolic.len_val()],
            scale: vec![1.0; pattern.order()],
            scaled: vec![0.0; pattern.entries()],
            scratch: MemBuffer::new(factorise_scratch(&symbolic).or(solve)),
            columns: 1,
            symbolic,
        }
    }

    /// Number of entries of the factor.
    pub fn entries(&self) -> usize {
        self.factors.len()
    }

    /// Factorises the matrix with these values.
    ///
    /// # Errors
    /// [`NotPositiveDefinite`] if a pivot is not positive, or if the matrix is singular up to
    /// round-off.
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

    /// Factorises D A D + `shift` I; false if it is not positive definite.
    fn factorise_shifted(
        &mut self,
        pattern: &SymmetricPattern,
        values: &[f64],
        shift: f64,
    ) -> bool {
        self.scale_values(pattern, values);
        for j in 0..pattern.order() {
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

    /// D A D.
    fn scale_values(&mut self, pattern: &SymmetricPattern, values: &[f64]) {
        for j in 0..pattern.order() {
            for at in pattern.starts[j]..pattern.starts[j + 1] {
                self.scaled[at] = values[at] * self.scale[j] * self.scale[pattern.rows[at]];
            }
        }
    }

    /// Growth by a solution of a vector that is hardly orthogonal to any mode.
    fn growth(&mut self) -> f64 {
        let mut x: Vec<f64> = (0..self.scale.len()).map(|i| (i as f64).sin()).collect();
        let before = norm(&x);
        self.solve_scaled(&mut x);
        norm(&x) / before
    }

    /// The weakest direction, by inverse iteration with a shift that makes the matrix positive
    /// definite.
    fn weakest(&mut self, pattern: &SymmetricPattern, values: &[f64]) -> NotPositiveDefinite {
        let mut shift = PROBE_SHIFT;
        while !self.factorise_shifted(pattern, values, shift) && shift < LAST_SHIFT {
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

    /// Solves A X = B in place; `b` holds the columns of B in order.
    pub fn solve(&mut self, b: &mut [f64]) {
        self.scale_columns(b);
        self.solve_scaled(b);
        self.scale_columns(b);
    }

    fn scale_columns(&self, b: &mut [f64]) {
        for column in b.chunks_exact_mut(self.scale.len().max(1)) {
            for (b, s) in column.iter_mut().zip(&self.scale) {
                *b *= s;
            }
        }
    }

    fn solve_scaled(&mut self, b: &mut [f64]) {
        let order = self.scale.len();
        let columns = b.len() / order.max(1);
        if columns > self.columns {
            let needed = self
                .symbolic
                .solve_in_place_scratch::<f64>(columns, Par::Seq);
            self.scratch = MemBuffer::new(needed.or(factorise_scratch(&self.symbolic)));
            self.columns = columns;
        }
        LltRef::<usize, f64>::new(&self.symbolic, &self.factors).solve_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(b, order, columns),
            Par::Seq,
            MemStack::new(&mut self.scratch),
        );
    }
}

fn factorise_scratch(symbolic: &SymbolicCholesky<usize>) -> StackReq {
    symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Default::default())
}

fn norm(x: &[f64]) -> f64 {
    x.iter().map(|x| x * x).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn many_right_sides_are_solved_as_one_by_one() {
        let columns: Vec<Vec<usize>> = (0..30).map(|j| (j..30.min(j + 3)).collect()).collect();
        let pattern = SymmetricPattern::new(&columns);
        let mut values = vec![-1.0; pattern.entries()];
        for j in 0..30 {
            values[pattern.slot(j, j).expect("diagonal")] = 5.0 + j as f64;
        }
        let mut solver = SparseCholesky::new(&pattern);
        solver.factorise(&pattern, &values).expect("definite");
        let right: Vec<f64> = (0..90).map(|i| (i as f64).cos()).collect();
        let mut together = right.clone();
        solver.solve(&mut together);
        for (all, column) in together.chunks(30).zip(right.chunks(30)) {
            let mut one = column.to_vec();
            solver.solve(&mut one);
            let mut product = vec![0.0; 30];
            pattern.multiply(&values, all, &mut product);
            for i in 0..30 {
                assert!((one[i] - all[i]).abs() < 1e-15);
                assert!((product[i] - column[i]).abs() < 1e-14);
            }
        }
    }
}
