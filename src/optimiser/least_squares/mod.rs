//! Sums of squares: the model that their residuals give to the trust region, and what the fitted numbers are worth.

pub(crate) mod model;
pub(crate) mod spectrum;
pub(crate) mod statistics;
pub(crate) mod subproblem;
