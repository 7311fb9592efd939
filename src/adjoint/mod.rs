//! Exact gradients of functions of interest: the discrete adjoint of the integration.

pub mod backward;

pub use backward::{AdjointRun, gradients};
