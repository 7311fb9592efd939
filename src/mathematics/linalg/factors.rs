//! Factors of a sparse matrix: with pivots that are searched, or known from its pattern.

use super::elimination::{Factors, Pivots, SingularMatrix, SolveScalar};
use super::front::System;
use super::matrix::SparseMatrix;
use super::multifrontal::Multifrontal;
use super::pattern::Pattern;
use super::scaling::size;
use super::sparse_lu::PivotedLu;
use crate::math::Complex64;
use crate::math::slices::any_vector;
use std::mem::take;
use std::sync::Arc;

/// Number of steps of iterative refinement of a transposed solution.
const REFINEMENTS: usize = 2;
/// Number of solves with the factors for a refined solution.
pub const REFINED_SOLVES: usize = 1 + REFINEMENTS;

/// Where pivots are known, a correction below this part of each entry is the last: the next one would be its
/// square. Entries below [`NEGLIGIBLE`] of the largest one do not count.
pub const LAST: f64 = 1e-7;
const NEGLIGIBLE: f64 = 1e-12;

/// Part of the sizes of its terms that an equation may leave, if the pivots are good ones.
const SOUND: f64 = 1e-6;

/// LU factors of a sparse matrix.
pub struct SparseLu<S> {
    factors: Box<dyn Factors<S>>,
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

/// Factors of matrices of a pattern.
fn factors<S: SolveScalar>(pattern: &Pattern) -> Box<dyn Factors<S>> {
    match pattern.known_pivots() {
        Some(known) => Box::new(Multifrontal::new(pattern, known)),
        None => Box::new(PivotedLu::new(pattern)),
    }
}

impl SolveScalar for f64 {
    fn factors(pattern: &Pattern) -> Box<dyn Factors<Self>> {
        factors(pattern)
    }
}

impl SolveScalar for Complex64 {
    fn factors(pattern: &Pattern) -> Box<dyn Factors<Self>> {
        factors(pattern)
    }
}

impl<S: SolveScalar> SparseLu<S> {
    /// Analyses a pattern.
    pub fn new(pattern: &Pattern) -> Self {
        Self::of(S::factors(pattern))
    }

    /// Factors of other matrices of the same pattern, without another analysis if its pivots are known.
    pub fn another(&self, pattern: &Pattern) -> Self {
        Self::of(self.factors.another(pattern))
    }

    fn of(factors: Box<dyn Factors<S>>) -> Self {
        Self {
            refined: Refined {
                rhs: Vec::new(),
                corrections: Vec::new(),
                done: Vec::new(),
                remaining: factors.remaining(),
            },
            factors,
        }
    }

    /// Factorises `matrix`, which has the analysed pattern.
    ///
    /// # Errors
    /// [`SingularMatrix`] if a pivot of the scaled matrix is zero or not finite.
    pub fn factorise(&mut self, matrix: &SparseMatrix<S>) -> Result<(), SingularMatrix> {
        self.factors.factorise(matrix)
    }

    /// The pivots in use; `None` before the first factorisation, or if they follow from the matrix.
    pub fn pivots(&mut self) -> Option<Arc<Pivots>> {
        self.factors.pivots()
    }

    /// Sets pivots that were in use for matrices of the same pattern.
    pub fn set_pivots(&mut self, pattern: &Pattern, pivots: Option<&Arc<Pivots>>) {
        self.factors.set_pivots(pattern, pivots)
    }

    /// Number of entries of both factors, and of floating-point operations of a factorisation.
    ///
    /// # Panics
    /// No matrix has been factorised.
    pub fn cost(&mut self) -> (usize, usize) {
        self.factors.cost()
    }

    /// Solves A x = b in place.
    ///
    /// # Panics
    /// No matrix has been factorised.
    pub fn solve(&mut self, b: &mut [S]) {
        self.factors.solve(System::Plain, &mut [b]);
    }

    /// Solves Aᵀ x = b in place (transposed, not conjugated).
    ///
    /// # Panics
    /// No matrix has been factorised.
    pub fn solve_transposed(&mut self, b: &mut [S]) {
        self.factors.solve(System::Transposed, &mut [b]);
    }

    /// Whether the factors of a matrix solve a system but for round-off, each equation relative to the sizes of its terms.
    ///
    /// # Panics
    /// No matrix has been factorised.
    pub fn solve_soundly(&mut self, matrix: &SparseMatrix<S>) -> bool {
        let right = any_vector(matrix.pattern.order(), 1.7);
        let mut x: Vec<S> = right.iter().map(|&x| S::from(x)).collect();
        self.solve(&mut x);
        let left = matrix.multiply(&x);
        let sizes: Vec<f64> = x.into_iter().map(size).collect();
        let terms = matrix.sizes().multiply(&sizes);
        let mut rows = left.iter().zip(&right).zip(&terms);
        rows.all(|((&l, &r), terms)| size(l - S::from(r)) <= SOUND * (terms + r.abs()))
    }

    /// Smallest absolute pivot of the scaled matrix in the columns from `first` on, and its column;
    /// infinite if there is none.
    ///
    /// # Panics
    /// No matrix has been factorised.
    pub fn smallest_pivot(&mut self, first: usize) -> (f64, usize) {
        self.factors.smallest_pivot(first)
    }

    /// Solves Aᵀ x = b in place, for several b and the matrix A that was factorised last, with two steps of
    /// iterative refinement. The backward error of each equation is then small for any growth of
    /// the pivots (Skeel 1980). Of matrices with known pivots, which are large, the second step is left
    /// out if the first one shows that it would change round-off alone. Returns the number of solves.
    pub fn solve_transposed_refined<T: AsRef<[S]> + AsMut<[S]>>(
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
        let known = self.factors.knows_pivots();
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
        if let [b] = b {
            let b = &mut b.as_mut()[..n];
            return self.factors.solve(System::Transposed, &mut [b]);
        }
        let mut all: Vec<&mut [S]> = b.iter_mut().map(|b| &mut b.as_mut()[..n]).collect();
        self.factors.solve(System::Transposed, &mut all);
    }
}

impl<S: SolveScalar> Factors<S> for PivotedLu<S> {
    fn another(&self, pattern: &Pattern) -> Box<dyn Factors<S>> {
        Box::new(PivotedLu::new(pattern))
    }

    fn factorise(&mut self, matrix: &SparseMatrix<S>) -> Result<(), SingularMatrix> {
        self.factorise(matrix)
    }

    fn pivots(&mut self) -> Option<Arc<Pivots>> {
        self.pivots()
    }

    fn set_pivots(&mut self, pattern: &Pattern, pivots: Option<&Arc<Pivots>>) {
        self.set_pivots(pattern, pivots);
    }

    fn cost(&mut self) -> (usize, usize) {
        self.cost()
    }

    fn solve(&mut self, system: System, b: &mut [&mut [S]]) {
        for b in b {
            match system {
                System::Plain => self.solve(b),
                System::Transposed => self.solve_transposed(b),
            }
        }
    }

    fn smallest_pivot(&mut self, first: usize) -> (f64, usize) {
        self.smallest_pivot(first)
    }

    fn knows_pivots(&self) -> bool {
        false
    }

    fn remaining(&self) -> Vec<bool> {
        Vec::new()
    }
}

impl<S: SolveScalar> Factors<S> for Multifrontal<S> {
    fn another(&self, pattern: &Pattern) -> Box<dyn Factors<S>> {
        Box::new(Multifrontal::by(self.plan.clone(), pattern))
    }

    fn factorise(&mut self, matrix: &SparseMatrix<S>) -> Result<(), SingularMatrix> {
        self.factorise(matrix)
    }

    fn pivots(&mut self) -> Option<Arc<Pivots>> {
        self.border.as_mut()?.pivots()
    }

    fn set_pivots(&mut self, _: &Pattern, pivots: Option<&Arc<Pivots>>) {
        if let Some(border) = &mut self.border {
            border.set_pivots(pivots);
        }
    }

    fn cost(&mut self) -> (usize, usize) {
        self.cost()
    }

    fn solve(&mut self, system: System, b: &mut [&mut [S]]) {
        self.solve(system, b);
    }

    fn smallest_pivot(&mut self, first: usize) -> (f64, usize) {
        self.smallest_pivot(first)
    }

    fn knows_pivots(&self) -> bool {
        true
    }

    fn remaining(&self) -> Vec<bool> {
        self.remaining()
    }
}

/// Whether a correction is so small that the next one changes round-off alone.
pub fn is_last<S: SolveScalar>(x: &[S], correction: &[S]) -> bool {
    let largest = x.iter().fold(0.0_f64, |m, &x| m.max(size(x)));
    let mut pairs = x.iter().zip(correction);
    pairs.all(|(&x, &d)| size(d) <= LAST * size(x).max(NEGLIGIBLE * largest))
}
