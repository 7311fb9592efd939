//! Sparse LU with partial pivoting: one analysis, many factorisations. faer orders the columns and
//! chooses the pivots. Only this folder uses faer.

use super::elimination::{Pivots, SingularMatrix, SolveScalar};
use super::matrix::SparseMatrix;
use super::pattern::Pattern;
use super::replay::Replay;
use super::scaling::Equilibration;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::linalg::lu::{LuSymbolicParams, SymbolicLu, factorize_symbolic_lu, simplicial};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use std::sync::Arc;

/// LU factors P R A C Q = L U. Q (COLAMD) depends only on the pattern; P, R and C depend on values.
///
/// R and C are powers of two that make the largest entries of all rows and columns equal up to 2⁸.
/// P is found by partial pivoting. All three are those of the first matrix, and are kept while its
/// pivots stay good. A new search reuses the memory, so factorisations do not allocate.
pub struct PivotedLu<S> {
    symbolic: SymbolicLu<usize>,
    pivoting: Pivoting<S>,
    replay: Option<Replay<S>>,
    /// The pivots in use, if they have been requested.
    pivots: Option<Arc<Pivots>>,
}

/// The search for pivots, with its workspace.
struct Pivoting<S> {
    scaling: Equilibration,
    scaled: Vec<S>,
    factors: simplicial::SimplicialLu<usize, S>,
    rows: Vec<usize>,
    inverse: Vec<usize>,
    scratch: MemBuffer,
}

impl<S: SolveScalar> Pivoting<S> {
    fn new(pattern: &Pattern) -> Self {
        let n = pattern.order();
        let scratch = simplicial::factorize_simplicial_numeric_lu_scratch::<usize, S>(n, n);
        Self {
            scaling: Equilibration::new(pattern),
            scaled: vec![S::zero(); pattern.entries()],
            factors: simplicial::SimplicialLu::new(),
            rows: vec![0; n],
            inverse: vec![0; n],
            scratch: MemBuffer::new(scratch),
        }
    }

    /// Scales a matrix and finds the pivot rows of partial pivoting.
    fn search(
        &mut self,
        matrix: &SparseMatrix<S>,
        symbolic: &SymbolicLu<usize>,
    ) -> Result<(), SingularMatrix> {
        self.scaling.fit(matrix, &mut self.scaled);
        simplicial::factorize_simplicial_numeric_lu(
            &mut self.rows,
            &mut self.inverse,
            &mut self.factors,
            SparseColMatRef::new(structure(&matrix.pattern), &self.scaled),
            symbolic.col_perm(),
            MemStack::new(&mut self.scratch),
        )
        .map_err(|_| SingularMatrix { column: 0 })
    }
}

impl<S: SolveScalar> PivotedLu<S> {
    /// Analyses a pattern.
    ///
    /// # Panics
    /// Memory is exhausted.
    pub fn new(pattern: &Pattern) -> Self {
        let symbolic = factorize_symbolic_lu(structure(pattern), LuSymbolicParams::default())
            .expect("the analysis fails only when memory is exhausted");
        Self {
            symbolic,
            pivoting: Pivoting::new(pattern),
            replay: None,
            pivots: None,
        }
    }

    /// Factorises `matrix`, which has the analysed pattern.
    ///
    /// # Errors
    /// [`SingularMatrix`] if a pivot of the scaled matrix is zero or not finite.
    pub fn factorise(&mut self, matrix: &SparseMatrix<S>) -> Result<(), SingularMatrix> {
        if let Some(replay) = &mut self.replay {
            match replay.factorise(matrix) {
                Ok(()) => return Ok(()),
                Err(bad) if !bad.replaceable => return Err(SingularMatrix { column: bad.column }),
                Err(_) => {}
            }
        }
        self.pivoting.search(matrix, &self.symbolic)?;
        self.pivots = None;
        let columns = self.symbolic.col_perm().arrays().0;
        let replay = self
            .replay
            .get_or_insert_with(|| Replay::new(&matrix.pattern, columns));
        replay.plan(&matrix.pattern, &self.pivoting.scaling, &self.pivoting.rows);
        replay
            .factorise(matrix)
            .map_err(|bad| SingularMatrix { column: bad.column })
    }

    /// The pivots in use; `None` before the first factorisation.
    pub fn pivots(&mut self) -> Option<Arc<Pivots>> {
        let replay = self.replay.as_ref()?;
        let found = self.pivots.get_or_insert_with(|| {
            let (rows, scaling) = replay.planned();
            Arc::new(Pivots {
                rows: rows.to_vec(),
                scaling: scaling.clone(),
            })
        });
        Some(Arc::clone(found))
    }

    /// Sets pivots that were in use for matrices of the same pattern.
    pub fn set_pivots(&mut self, pattern: &Pattern, pivots: Option<&Arc<Pivots>>) {
        let Some(new) = pivots else {
            (self.replay, self.pivots) = (None, None);
            return;
        };
        if (self.pivots.as_ref()).is_some_and(|own| Arc::ptr_eq(own, new)) {
            return;
        }
        let columns = self.symbolic.col_perm().arrays().0;
        self.replay
            .get_or_insert_with(|| Replay::new(pattern, columns))
            .plan(pattern, &new.scaling, &new.rows);
        self.pivots = Some(Arc::clone(new));
    }

    /// Number of entries of both factors, and of floating-point operations of a factorisation.
    ///
    /// # Panics
    /// No matrix has been factorised.
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
    /// No matrix has been factorised.
    pub fn solve(&mut self, b: &mut [S]) {
        self.factors().solve(b);
    }

    /// Solves Aᵀ x = b in place (transposed, not conjugated).
    ///
    /// # Panics
    /// No matrix has been factorised.
    pub fn solve_transposed(&mut self, b: &mut [S]) {
        self.factors().solve_transposed(b);
    }

    /// Smallest absolute pivot of the scaled matrix in the columns from `first` on, and its column;
    /// infinite if there is none.
    ///
    /// # Panics
    /// No matrix has been factorised.
    pub fn smallest_pivot(&mut self, first: usize) -> (f64, usize) {
        self.factors().smallest_pivot(first)
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
        let mut lu = PivotedLu::new(&matrix.pattern);
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

    /// x + k y = 1 + k and x + y = 2 in units of any size. With the first row as pivot, x would be
    /// lost in round-off relative to k.
    #[test]
    fn units_of_rows_and_columns_do_not_spoil_a_solution() {
        let k = 1e30;
        for (r, c) in [(1.0, 1.0), (1e-25, 1e20), (1e12, 1e-18)] {
            let assembly = |emit: &mut dyn Emit<f64>| {
                emit.add(0, 0, r * c);
                emit.add(0, 1, r * k);
                emit.add(1, 0, c);
                emit.add(1, 1, 1.0);
            };
            let mut matrix = SparseMatrix::new(Pattern::record(2, assembly));
            matrix.assemble(assembly);
            let mut lu = PivotedLu::new(&matrix.pattern);
            lu.factorise(&matrix).expect("regular");
            assert!(lu.smallest_pivot(0).0 > 1e-3);
            let mut x = [r * (1.0 + k), 2.0];
            lu.solve(&mut x);
            assert!((x[0] * c - 1.0).abs() < 1e-14 && (x[1] - 1.0).abs() < 1e-14);
            let mut x = [2.0 * c, 1.0 + k];
            lu.solve_transposed(&mut x);
            assert!((x[0] * r - 1.0).abs() < 1e-14 && (x[1] - 1.0).abs() < 1e-14);
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
        let failure = PivotedLu::new(&matrix.pattern).factorise(&matrix);
        assert_eq!(failure, Err(SingularMatrix { column: 1 }));
    }
}
