//! Linear algebra: static patterns of sparse matrices, their LU and Cholesky factors, and eigenvalues of dense ones.

mod border;
mod branches;
pub mod cholesky;
mod eigenvalues;
mod eliminated;
mod elimination;
mod factors;
mod front;
mod fronts;
pub mod gmres;
mod matrix;
mod multifrontal;
mod owners;
pub mod pattern;
mod places;
mod plans;
mod replay;
mod scaling;
mod short_rows;
mod sparse_lu;
mod substitution;
mod workspace;

pub use eigenvalues::{complex_eigenvalues, eigenvalues};
pub use elimination::{Factors, Pivots, SingularMatrix, SolveScalar};
pub use factors::{LAST, REFINED_SOLVES, SparseLu, is_last};
pub use front::System;
pub use matrix::SparseMatrix;
pub use pattern::{Emit, KnownPivots, Pattern};
