//! Factors of a sparse matrix: by searched pivots, or by pivots that its pattern knows.

use super::multifrontal::Multifrontal;
use super::pattern::{Pattern, SparseMatrix};
use super::scaling::size;
use super::sparse_lu::{PivotedLu, Pivots, SingularMatrix, SolveScalar};
use std::sync::Arc;

/// Number of steps of iterative refinement of a transposed solution.
const REFINEMENTS: usize = 2;
/// Number of solves with the factors for a refined solution.
pub(crate) const REFINED_SOLVES: usize = 1 + REFINEMENTS;

/// Where pivots are known, a correction below this part of each entry is the last: the next one would be its
/// square. Entries below [`NEGLIGIBLE`] of the largest one do not count.
const LAST: f64 = 1e-7;
const NEGLIGIBLE: f64 = 1e-12;

/// LU factors of a sparse matrix.
pub(crate) struct SparseLu<S> {
    kind: Kind<S>,
    /// Right-hand side and correction of a refined solution.
    refined: [Vec<S>; 2],
}

/// How the matrix is eliminated.
enum Kind<S> {
    /// Pivots are searched.
    Pivoted(Box<PivotedLu<S>>),
    /// Most pivots are known.
    Fronts(Box<Multifrontal<S>>),
}

impl<S: SolveScalar> SparseLu<S> {
    /// Analyses a pattern.
    pub(crate) fn new(pattern: &Pattern) -> Self {
        let n = pattern.order();
        Self {
            kind: match pattern.known_pivots() {
                Some(known) => Kind::Fronts(Box::new(Multifrontal::new(pattern, known))),
                None => Kind::Pivoted(Box::new(PivotedLu::new(pattern))),
            },
            refined: [vec![S::zero(); n], vec![S::zero(); n]],
        }
    }

    /// Factorises `matrix`, which has the analysed pattern.
    ///
    /// # Errors
    /// [`SingularMatrix`] if a pivot of the scaled matrix is zero or not finite.
    pub(crate) fn factorise(&mut self, matrix: &SparseMatrix<S>) -> Result<(), SingularMatrix> {
        match &mut self.kind {
            Kind::Pivoted(own) => own.factorise(matrix),
            Kind::Fronts(own) => own.factorise(matrix),
        }
    }

    /// The pivots in use; `None` before the first factorisation, or if they follow from the matrix.
    pub(crate) fn pivots(&mut self) -> Option<Arc<Pivots>> {
        match &mut self.kind {
            Kind::Pivoted(own) => own.pivots(),
            Kind::Fronts(_) => None,
        }
    }

    /// Sets pivots that were in use for matrices of the same pattern.
    pub(crate) fn set_pivots(&mut self, pattern: &Pattern, pivots: Option<&Arc<Pivots>>) {
        match &mut self.kind {
            Kind::Pivoted(own) => own.set_pivots(pattern, pivots),
            Kind::Fronts(_) => {}
        }
    }

    /// Number of entries of both factors, and of floating-point operations of a factorisation.
    ///
    /// # Panics
    /// No matrix has been factorised.
    pub(crate) fn cost(&mut self) -> (usize, usize) {
        match &mut self.kind {
            Kind::Pivoted(own) => own.cost(),
            Kind::Fronts(own) => own.cost(),
        }
    }

    /// Solves A x = b in place.
    ///
    /// # Panics
    /// No matrix has been factorised.
    pub(crate) fn solve(&mut self, b: &mut [S]) {
        match &mut self.kind {
            Kind::Pivoted(own) => own.solve(b),
            Kind::Fronts(own) => own.solve(b),
        }
    }

    /// Solves Aᵀ x = b in place (transposed, not conjugated).
    ///
    /// # Panics
    /// No matrix has been factorised.
    pub(crate) fn solve_transposed(&mut self, b: &mut [S]) {
        match &mut self.kind {
            Kind::Pivoted(own) => own.solve_transposed(b),
            Kind::Fronts(own) => own.solve_transposed(b),
        }
    }

    /// Smallest absolute pivot of the scaled matrix in the columns from `first` on, and its column;
    /// infinite if there is none.
    ///
    /// # Panics
    /// No matrix has been factorised.
    pub(crate) fn smallest_pivot(&mut self, first: usize) -> (f64, usize) {
        match &mut self.kind {
            Kind::Pivoted(own) => own.smallest_pivot(first),
            Kind::Fronts(own) => own.smallest_pivot(first),
        }
    }

    /// Solves Aᵀ x = b in place for the matrix A that was factorised last, with two steps of
    /// iterative refinement. The backward error of each equation is then small for any growth of
    /// the pivots (Skeel 1980). Of matrices with known pivots, which are large, the second step is left
    /// out if the first one shows that it would change round-off alone. Returns the number of solves.
    ///
    /// # Panics
    /// No matrix has been factorised.
    pub(crate) fn solve_transposed_refined(
        &mut self,
        matrix: &SparseMatrix<S>,
        b: &mut [S],
    ) -> usize {
        let [mut rhs, mut correction] = std::mem::take(&mut self.refined);
        rhs.copy_from_slice(b);
        self.solve_transposed(b);
        let mut solves = 1;
        while solves < REFINED_SOLVES {
            matrix.multiply_transposed(b, &mut correction);
            for (r, &b) in correction.iter_mut().zip(&rhs) {
                *r = b - *r;
            }
            self.solve_transposed(&mut correction);
            for (x, d) in b.iter_mut().zip(&correction) {
                *x += *d;
            }
            solves += 1;
            if matches!(self.kind, Kind::Fronts(_)) && is_last(b, &correction) {
                break;
            }
        }
        self.refined = [rhs, correction];
        solves
    }
}

/// Whether a correction is so small that the next one changes round-off alone.
fn is_last<S: SolveScalar>(x: &[S], correction: &[S]) -> bool {
    let largest = x.iter().fold(0.0_f64, |m, &x| m.max(size(x)));
    let mut pairs = x.iter().zip(correction);
    pairs.all(|(&x, &d)| size(d) <= LAST * size(x).max(NEGLIGIBLE * largest))
}
