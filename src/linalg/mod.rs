//! Sparse linear algebra: static patterns, LU and Cholesky factorisation.

pub(crate) mod cholesky;
pub(crate) mod pattern;
mod replay;
mod scaling;
pub(crate) mod sparse_lu;

pub(crate) use pattern::{Emit, Pattern, SparseMatrix};
pub(crate) use sparse_lu::{Pivots, REFINED_SOLVES, SingularMatrix, SolveScalar, SparseLu};
