//! Sparse LU with partial pivoting, analysed once and factorised often. The only file that names
//! faer.

use super::pattern::{Pattern, SparseMatrix};
use crate::math::Scalar;
use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::perm::PermRef;
use faer::sparse::linalg::lu::{LuSymbolicParams, SymbolicLu, factorize_symbolic_lu, simplicial};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par};

/// A scalar that linear systems are solved in: `f64` and `Complex64`.
pub trait SolveScalar: Scalar + faer::traits::ComplexField {}
impl<S: Scalar + faer::traits::ComplexField> SolveScalar for S {}

/// The matrix has no usable pivot in some column.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("singular matrix: column {column} has no usable pivot")]
pub struct SingularMatrix {
    /// A column that depends on the others.
    pub column: usize,
}

/// LU factors P A Q = L U; Q (COLAMD) depends on the pattern only, P on the values.
pub struct SparseLu<S> {
    symbolic: SymbolicLu<usize>,
    factors: simplicial::SimplicialLu<usize, S>,
    rows_forward: Vec<usize>,
    rows_inverse: Vec<usize>,
    memory: MemBuffer,
}

impl<S: SolveScalar> SparseLu<S> {
    /// Analyses a pattern.
    ///
    /// # Panics
    /// If memory is exhausted.
    pub fn new(pattern: &Pattern) -> Self {
        let n = pattern.order();
        let symbolic = factorize_symbolic_lu(structure(pattern), LuSymbolicParams::default())
            .expect("the analysis fails only when memory is exhausted");
        let factor = simplicial::factorize_simplicial_numeric_lu_scratch::<usize, S>(n, n);
        let solve = simplicial::solve_in_place_scratch::<usize, S>(n, 1, Par::Seq);
        Self {
            symbolic,
            factors: simplicial::SimplicialLu::new(),
            rows_forward: vec![0; n],
            rows_inverse: vec![0; n],
            memory: MemBuffer::new(StackReq::any_of(&[factor, solve])),
        }
    }

    /// Factorises `matrix`, which has the analysed pattern.
    ///
    /// # Errors
    /// [`SingularMatrix`] if a pivot is zero, not finite, or smaller than 10⁻³⁰⁰.
    pub fn factorise(&mut self, matrix: &SparseMatrix<S>) -> Result<(), SingularMatrix> {
        let stack = MemStack::new(&mut self.memory);
        simplicial::factorize_simplicial_numeric_lu(
            &mut self.rows_forward,
            &mut self.rows_inverse,
            &mut self.factors,
            SparseColMatRef::new(structure(&matrix.pattern), &matrix.values),
            self.symbolic.col_perm(),
            stack,
        )
        .map_err(|_| SingularMatrix { column: 0 })?;
        let (worst, smallest) = self.smallest_pivot();
        if smallest.is_nan() || smallest <= 1e-300 {
            return Err(SingularMatrix { column: worst });
        }
        Ok(())
    }

    /// Smallest modulus of a pivot, and the column of the matrix that it stands in; NaN if any
    /// pivot is not finite.
    pub fn smallest_pivot(&self) -> (usize, f64) {
        let u = self.factors.u_factor_unsorted();
        let columns = self.symbolic.col_perm().arrays().0;
        let mut worst = (0, f64::INFINITY);
        for j in 0..u.ncols() {
            // The diagonal entry is the last of its column.
            let pivot = u.val_of_col(j).last().map_or(S::zero(), |p| *p).re().abs();
            if pivot.is_nan() || pivot.is_infinite() {
                return (columns[j], f64::NAN);
            }
            if pivot < worst.1 {
                worst = (columns[j], pivot);
            }
        }
        worst
    }

    /// Solves A x = b in place.
    pub fn solve(&mut self, b: &mut [S]) {
        self.apply(b, false);
    }

    /// Solves Aᵀ x = b in place (transposed, not conjugated).
    pub fn solve_transposed(&mut self, b: &mut [S]) {
        self.apply(b, true);
    }

    /// Solves Aᵀ x = b in place for the matrix A that was factorised last, with one step of
    /// iterative refinement: the error of x is then that of its residual in each equation, however
    /// badly the pivots have grown (Skeel 1980).
    pub fn solve_transposed_refined(&mut self, matrix: &SparseMatrix<S>, b: &mut [S]) {
        let mut correction = b.to_vec();
        self.solve_transposed(b);
        let product = matrix.multiply_transposed(b);
        for (r, ax) in correction.iter_mut().zip(&product) {
            *r -= *ax;
        }
        self.solve_transposed(&mut correction);
        for (x, d) in b.iter_mut().zip(&correction) {
            *x += *d;
        }
    }

    fn apply(&mut self, b: &mut [S], transposed: bool) {
        let n = b.len();
        let rows = PermRef::new_checked(&self.rows_forward, &self.rows_inverse, n);
        let columns = self.symbolic.col_perm();
        let stack = MemStack::new(&mut self.memory);
        let rhs = MatMut::from_column_major_slice_mut(b, n, 1);
        if transposed {
            let solve = simplicial::SimplicialLu::solve_transpose_in_place_with_conj;
            solve(&self.factors, rows, columns, Conj::No, rhs, Par::Seq, stack);
        } else {
            let solve = simplicial::SimplicialLu::solve_in_place_with_conj;
            solve(&self.factors, rows, columns, Conj::No, rhs, Par::Seq, stack);
        }
    }
}

fn structure(pattern: &Pattern) -> SymbolicSparseColMatRef<'_, usize> {
    let n = pattern.order();
    SymbolicSparseColMatRef::new_checked(n, n, pattern.column_starts(), None, pattern.rows())
}

#[cfg(test)]
mod tests {
    use super::super::pattern::Emit;
    use super::*;
    use crate::math::Complex64;
    use nalgebra::{DMatrix, DVector};

    /// A saddle-point matrix like those of constrained dynamics, with zeros on the diagonal.
    fn sample(n: usize, emit: &mut dyn Emit<Complex64>) {
        for i in 0..n {
            let x = i as f64;
            if i % 3 != 2 {
                emit.add(i, i, Complex64::new(2.0 + x.sin(), 0.1 * x));
            }
            emit.add(i, (i * 7 + 1) % n, Complex64::new(x.cos(), 0.3));
            emit.add((i * 5 + 2) % n, i, Complex64::new(1.0, -0.2 * x));
        }
    }

    #[test]
    fn plain_and_transposed_solutions_agree_with_a_dense_oracle() {
        let n = 30;
        let mut matrix = SparseMatrix::new(Pattern::record(n, |e| sample(n, e)));
        matrix.assemble(|e| sample(n, e));
        let mut dense = DMatrix::from_element(n, n, Complex64::new(0.0, 0.0));
        for j in 0..n {
            let mut unit = vec![Complex64::new(0.0, 0.0); n];
            unit[j].re = 1.0;
            dense.set_column(j, &DVector::from_vec(matrix.multiply(&unit)));
        }
        let b = DVector::from_fn(n, |i, _| Complex64::new(i as f64, 1.0));
        let mut lu = SparseLu::new(&matrix.pattern);
        for _ in 0..2 {
            lu.factorise(&matrix).expect("regular");
            let mut x = b.as_slice().to_vec();
            lu.solve(&mut x);
            let oracle = dense.clone().lu().solve(&b).expect("regular");
            assert!((DVector::from_vec(x) - oracle).camax() < 1e-11);
            let mut x = b.as_slice().to_vec();
            lu.solve_transposed(&mut x);
            let oracle = dense.transpose().lu().solve(&b).expect("regular");
            assert!((DVector::from_vec(x) - oracle).camax() < 1e-11);
        }
    }

    #[test]
    fn a_zero_column_is_singular() {
        let assembly = |emit: &mut dyn Emit<f64>| {
            emit.add(0, 0, 1.0);
            emit.add(1, 1, 0.0);
        };
        let mut matrix = SparseMatrix::new(Pattern::record(2, assembly));
        matrix.assemble(assembly);
        let failure = SparseLu::new(&matrix.pattern).factorise(&matrix);
        assert_eq!(failure, Err(SingularMatrix { column: 1 }));
    }
}
