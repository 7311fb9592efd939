//! Exact gradients of functions of interest: the discrete adjoint of the integration.

pub mod backward;
mod sweep;

pub use backward::{AdjointRun, gradients};
