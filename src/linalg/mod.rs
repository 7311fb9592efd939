//! Sparse linear algebra: static patterns, LU and Cholesky factorisation.

pub(crate) mod cholesky;
mod eliminated;
mod factors;
mod fronts;
pub(crate) mod gmres;
mod multifrontal;
pub(crate) mod pattern;
mod replay;
mod scaling;
pub(crate) mod sparse_lu;

pub(crate) use factors::{REFINED_SOLVES, SparseLu};
pub(crate) use pattern::{Emit, KnownPivots, Pattern, SparseMatrix};
pub(crate) use sparse_lu::{Pivots, SingularMatrix, SolveScalar};
