//! Sparse LU with partial pivoting, analysed once and factorised often. The only file that names
//! faer, which orders the columns and chooses the pivots.

use super::pattern::{Pattern, SparseMatrix};
use super::replay::Replay;
use crate::math::Scalar;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::linalg::lu::{LuSymbolicParams, SymbolicLu, factorize_symbolic_lu, simplicial};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};

/// Steps of iterative refinement of a transposed solution.
const REFINEMENTS: usize = 2;
/// Solves with the factors that a refined solution takes.
pub const REFINED_SOLVES: usize = 1 + REFINEMENTS;

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
///
/// P is found by partial pivoting at the first matrix and kept while its pivots stay good.
pub struct SparseLu<S> {
    symbolic: SymbolicLu<usize>,
    replay: Option<Replay<S>>,
}

impl<S: SolveScalar> SparseLu<S> {
    /// Analyses a pattern.
    ///
    /// # Panics
    /// If memory is exhausted.
    pub fn new(pattern: &Pattern) -> Self {
        let symbolic = factorize_symbolic_lu(structure(pattern), LuSymbolicParams::default())
            .expect("the analysis fails only when memory is exhausted");
        Self {
            symbolic,
            replay: None,
        }
    }

    /// Factorises `matrix`, which has the analysed pattern.
    ///
    /// # Errors
    /// [`SingularMatrix`] if a pivot is zero or not finite.
    pub fn factorise(&mut self, matrix: &SparseMatrix<S>) -> Result<(), SingularMatrix> {
        if let Some(replay) = &mut self.replay {
            match replay.factorise(matrix) {
                Ok(()) => return Ok(()),
                Err(bad) if !bad.replaceable => return Err(SingularMatrix { column: bad.column }),
                Err(_) => {}
            }
        }
        let pivot_rows = self.pivot_rows(matrix)?;
        let columns = self.symbolic.col_perm().arrays().0;
        let replay = Replay::plan(&matrix.pattern, &pivot_rows, columns);
        self.replay
            .insert(replay)
            .factorise(matrix)
            .map_err(|bad| SingularMatrix { column: bad.column })
    }

    /// Rows of the pivots that partial pivoting chooses.
    fn pivot_rows(&self, matrix: &SparseMatrix<S>) -> Result<Vec<usize>, SingularMatrix> {
        let n = matrix.pattern.order();
        let (mut rows, mut inverse) = (vec![0; n], vec![0; n]);
        let scratch = simplicial::factorize_simplicial_numeric_lu_scratch::<usize, S>(n, n);
        simplicial::factorize_simplicial_numeric_lu(
            &mut rows,
            &mut inverse,
            &mut simplicial::SimplicialLu::new(),
            SparseColMatRef::new(structure(&matrix.pattern), &matrix.values),
            self.symbolic.col_perm(),
            MemStack::new(&mut MemBuffer::new(scratch)),
        )
        .map_err(|_| SingularMatrix { column: 0 })?;
        Ok(rows)
    }

    /// Entries of both factors, and floating-point operations of a factorisation.
    ///
    /// # Panics
    /// If no matrix was factorised.
    pub fn cost(&mut self) -> (usize, usize) {
        self.factors().cost()
    }

    /// The factors.
    fn factors(&mut self) -> &mut Replay<S> {
        self.replay
            .as_mut()
            .expect("a matrix is factorised before a system is solved")
    }

    /// Solves A x = b in place.
    ///
    /// # Panics
    /// If no matrix was factorised.
    pub fn solve(&mut self, b: &mut [S]) {
        self.factors().solve(b);
    }

    /// Solves Aᵀ x = b in place (transposed, not conjugated).
    ///
    /// # Panics
    /// If no matrix was factorised.
    pub fn solve_transposed(&mut self, b: &mut [S]) {
        self.factors().solve_transposed(b);
    }

    /// Solves Aᵀ x = b in place for the matrix A that was factorised last, with two steps of
    /// iterative refinement: the error of x is then that of its residual in each equation, however
    /// badly the pivots have grown (Skeel 1980).
    pub fn solve_transposed_refined(&mut self, matrix: &SparseMatrix<S>, b: &mut [S]) {
        let rhs = b.to_vec();
        self.solve_transposed(b);
        for _ in 0..REFINEMENTS {
            let mut correction = matrix.multiply_transposed(b);
            for (r, &b) in correction.iter_mut().zip(&rhs) {
                *r = b - *r;
            }
            self.solve_transposed(&mut correction);
            for (x, d) in b.iter_mut().zip(&correction) {
                *x += *d;
            }
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
