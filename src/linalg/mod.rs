//! Sparse linear algebra: static patterns, LU and Cholesky factorisation.

mod border;
mod branches;
pub(crate) mod cholesky;
mod eliminated;
mod factors;
mod front;
mod fronts;
pub(crate) mod gmres;
mod matrix;
mod multifrontal;
pub(crate) mod pattern;
mod plans;
mod replay;
mod scaling;
mod short_rows;
mod sparse_lu;
mod substitution;

pub(crate) use factors::{LAST, REFINED_SOLVES, SparseLu, is_last};
pub(crate) use front::System;
pub(crate) use matrix::SparseMatrix;
pub(crate) use pattern::{Emit, KnownPivots, Pattern};
pub(crate) use sparse_lu::{Pivots, SingularMatrix, SolveScalar};
