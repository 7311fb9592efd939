//! Optimiser for smooth nonlinear programs of which only first derivatives are known.
//!
//! `solve` starts a run, chooses the method and reports the result. `convergence` says when a run
//! has converged, `ending` how it ended. Each method has a folder.

mod constants;
mod convergence;
mod derivatives;
mod doubts;
mod ending;
mod evaluations;
mod feasibility;
mod functions;
mod interior_point;
mod least_squares;
mod least_violation;
mod linear;
mod multipliers;
mod nlp;
mod observer;
mod options;
mod outcome;
mod program;
mod quadratic;
mod renewal;
mod report;
mod scaling;
mod solve;
mod start;
mod state;
mod status;
mod trust_region;
mod unbounded;
mod well_posed;

pub use derivatives::{DerivativeError, derivative_errors};
pub use functions::Functions;
pub use least_squares::statistics::{Fit, Statistics, Variance, statistics};
pub use linear::curvature::Curvature;
pub use linear::jacobian::Jacobian;
pub use linear::quasi_newton::QuasiNewton;
pub use nlp::{Evaluation, EvaluationFailure, Gradients, Nlp, Residuals};
pub use observer::{Observer, Phase, Printed, Row, Silent};
pub use options::{Barrier, Method, Options};
pub use outcome::{ActiveBound, BoundSide, Counts, FailedDesign, Kkt, Outcome};
pub use solve::{resume, solve};
pub use state::{Multipliers, SavedState, Scaling};
pub use status::Status;

#[doc(hidden)]
pub use interior_point::filter::{Filter, Measure};
