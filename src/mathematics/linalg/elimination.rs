//! What every elimination of a sparse matrix offers, and the scalars for which it is compiled.

use super::front::System;
use super::matrix::SparseMatrix;
use super::pattern::Pattern;
use super::scaling::Equilibration;
use crate::math::Scalar;
use std::sync::Arc;

/// A scalar of linear systems: `f64` or `Complex64`.
pub trait SolveScalar: Scalar + faer::traits::ComplexField {
    /// Factors of matrices of a pattern.
    fn factors(pattern: &Pattern) -> Box<dyn Factors<Self>>;
}

/// A column of the matrix has no usable pivot.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("singular matrix: column {column} has no usable pivot")]
pub struct SingularMatrix {
    /// A column that depends on the others.
    pub column: usize,
}

/// Pivots and scaling of a factorisation. With the matrix they determine its factors.
#[derive(Clone, Debug)]
pub struct Pivots {
    pub(super) rows: Vec<usize>,
    pub(super) scaling: Equilibration,
}

/// How a matrix is eliminated. Scalars give it as an object, so that it is compiled in this crate alone.
pub trait Factors<S>: Send + Sync {
    /// As `SparseLu::another`.
    fn another(&self, pattern: &Pattern) -> Box<dyn Factors<S>>;
    /// As `SparseLu::factorise`.
    ///
    /// # Errors
    /// As there.
    fn factorise(&mut self, matrix: &SparseMatrix<S>) -> Result<(), SingularMatrix>;
    /// As `SparseLu::pivots`.
    fn pivots(&mut self) -> Option<Arc<Pivots>>;
    /// As `SparseLu::set_pivots`.
    fn set_pivots(&mut self, pattern: &Pattern, pivots: Option<&Arc<Pivots>>);
    /// As `SparseLu::cost`.
    fn cost(&mut self) -> (usize, usize);
    /// Solves a system in place for several right-hand sides.
    fn solve(&mut self, system: System, b: &mut [&mut [S]]);
    /// As `SparseLu::smallest_pivot`.
    fn smallest_pivot(&mut self, first: usize) -> (f64, usize);
    /// Whether most pivots are known before.
    fn knows_pivots(&self) -> bool;
    /// By column, whether a transposed solution may leave more than round-off there; all if empty.
    fn remaining(&self) -> Vec<bool>;
}
