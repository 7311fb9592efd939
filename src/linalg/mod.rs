//! Sparse linear algebra: static patterns, the LU and the Cholesky factorisation.

pub mod cholesky;
pub mod pattern;
mod replay;
mod scaling;
pub mod sparse_lu;

pub use pattern::{Emit, Pattern, SparseMatrix};
pub use sparse_lu::{Pivots, REFINED_SOLVES, SingularMatrix, SolveScalar, SparseLu};
