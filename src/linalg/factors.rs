//! Factors of a sparse matrix: with pivots that are searched, or known from its pattern.

use super::front::System;
use super::matrix::SparseMatrix;
use super::multifrontal::Multifrontal;
use super::pattern::Pattern;
use super::scaling::size;
use super::sparse_lu::{PivotedLu, Pivots, SingularMatrix, SolveScalar};
use std::mem::take;
use std::sync::Arc;

/// Number of steps of iterative refinement of a transposed solution.
const REFINEMENTS: usize = 2;
/// Number of solves with the factors for a refined solution.
pub(crate) const REFINED_SOLVES: usize = 1 + REFINEMENTS;

/// Where pivots are known, a correction below this part of each entry is the last: the next one would be its
/// square. Entries below [`NEGLIGIBLE`] of the largest one do not count.
pub(crate) const LAST: f64 = 1e-7;
const NEGLIGIBLE: f64 = 1e-12;

/// LU factors of a sparse matrix.
pub(crate) struct SparseLu<S> {
    kind: Kind<S>,
    refined: Refined<S>,
}

/// Workspace of refined solutions.
struct Refined<S> {
    rhs: Vec<Vec<S>>,
    corrections: Vec<Vec<S>>,
    /// Which need no further correction.
    done: Vec<bool>,
    /// By column, whether a solution leaves more than round-off there; all if empty.
    remaining: Vec<bool>,
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
        Self::of(match pattern.known_pivots() {
            Some(known) => Kind::Fronts(Box::new(Multifrontal::new(pattern, known))),
            None => Kind::Pivoted(Box::new(PivotedLu::new(pattern))),
        })
    }

    /// Factors of other matrices of the same pattern, without another analysis if its pivots are known.
    pub(crate) fn another(&self, pattern: &Pattern) -> Self {
        Self::of(match &self.kind {
            Kind::Fronts(own) => {
                Kind::Fronts(Box::new(Multifrontal::by(own.plan.clone(), pattern)))
            }
            Kind::Pivoted(_) => Kind::Pivoted(Box::new(PivotedLu::new(pattern))),
        })
    }

    fn of(kind: Kind<S>) -> Self {
        Self {
            refined: Refined {
                rhs: Vec::new(),
                corrections: Vec::new(),
                done: Vec::new(),
                remaining: match &kind {
                    Kind::Pivoted(_) => Vec::new(),
                    Kind::Fronts(own) => own.remaining(),
                },
            },
            kind,
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
            Kind::Fronts(own) => own.border.as_mut()?.pivots(),
        }
    }

    /// Sets pivots that were in use for matrices of the same pattern.
    pub(crate) fn set_pivots(&mut self, pattern: &Pattern, pivots: Option<&Arc<Pivots>>) {
        match &mut self.kind {
            Kind::Pivoted(own) => own.set_pivots(pattern, pivots),
            Kind::Fronts(own) => {
                if let Some(border) = &mut own.border {
                    border.set_pivots(pivots);
                }
            }
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
            Kind::Fronts(own) => own.solve(System::Plain, &mut [b]),
        }
    }

    /// Solves Aᵀ x = b in place (transposed, not conjugated).
    ///
    /// # Panics
    /// No matrix has been factorised.
    pub(crate) fn solve_transposed(&mut self, b: &mut [S]) {
        match &mut self.kind {
            Kind::Pivoted(own) => own.solve_transposed(b),
            Kind::Fronts(own) => own.solve(System::Transposed, &mut [b]),
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

    /// Solves Aᵀ x = b in place, for several b and the matrix A that was factorised last, with two steps of
    /// iterative refinement. The backward error of each equation is then small for any growth of
    /// the pivots (Skeel 1980). Of matrices with known pivots, which are large, the second step is left
    /// out if the first one shows that it would change round-off alone. Returns the number of solves.
    pub(crate) fn solve_transposed_refined<T: AsRef<[S]> + AsMut<[S]>>(
        &mut self,
        matrix: &SparseMatrix<S>,
        b: &mut [T],
    ) -> usize {
        let own = &mut self.refined;
        let (mut rhs, mut corrections) = (take(&mut own.rhs), take(&mut own.corrections));
        let (mut done, n) = (take(&mut own.done), matrix.pattern.order());
        let remaining = take(&mut own.remaining);
        for all in [&mut rhs, &mut corrections] {
            all.resize_with(b.len(), || vec![S::zero(); n]);
        }
        done.clear();
        done.resize(b.len(), false);
        for (rhs, b) in rhs.iter_mut().zip(&*b) {
            rhs.copy_from_slice(&b.as_ref()[..n]);
        }
        let known = matches!(self.kind, Kind::Fronts(_));
        self.solve_all_transposed(n, b);
        let mut solves = b.len();
        for _ in 0..REFINEMENTS {
            for ((correction, rhs), b) in corrections.iter_mut().zip(&rhs).zip(&*b) {
                matrix.remain_transposed(b.as_ref(), rhs, &remaining, correction);
            }
            self.solve_all_transposed(n, &mut corrections);
            let all = corrections.iter().zip(&mut *b).zip(&mut done);
            for ((correction, b), done) in all.filter(|(_, done)| !**done) {
                let b = &mut b.as_mut()[..n];
                for (x, d) in b.iter_mut().zip(correction) {
                    *x += *d;
                }
                solves += 1;
                *done = known && is_last(b, correction);
            }
            if done.iter().all(|&done| done) {
                break;
            }
        }
        self.refined = Refined {
            rhs,
            corrections,
            done,
            remaining,
        };
        solves
    }

    /// Solves Aᵀ x = b in place for the first n entries of several b.
    fn solve_all_transposed<T: AsMut<[S]>>(&mut self, n: usize, b: &mut [T]) {
        match &mut self.kind {
            Kind::Pivoted(own) => {
                let all = b.iter_mut();
                all.for_each(|b| own.solve_transposed(&mut b.as_mut()[..n]));
            }
            Kind::Fronts(own) => own.solve(System::Transposed, b),
        }
    }
}

/// Whether a correction is so small that the next one changes round-off alone.
pub(crate) fn is_last<S: SolveScalar>(x: &[S], correction: &[S]) -> bool {
    let largest = x.iter().fold(0.0_f64, |m, &x| m.max(size(x)));
    let mut pairs = x.iter().zip(correction);
    pairs.all(|(&x, &d)| size(d) <= LAST * size(x).max(NEGLIGIBLE * largest))
}
