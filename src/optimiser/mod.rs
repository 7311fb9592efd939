//! Optimiser for smooth nonlinear programs of which only first derivatives are known.

mod barrier;
mod derivatives;
mod direction;
mod doubts;
mod elastic_qp;
mod ending;
mod feasibility;
mod filter;
mod functions;
mod interior_point;
mod iterate;
mod jacobian;
mod kkt_dense;
mod kkt_sparse;
mod kkt_system;
mod least_violation;
mod line_search;
mod nlp;
mod observer;
mod options;
mod outcome;
mod program;
mod qp;
mod quasi_newton;
mod refined_qp;
mod renewal;
mod scaling;
mod solve;
mod split_qp;
mod start;
mod state;
mod steering;
mod trust_region;
mod verdict;
mod well_posed;

#[cfg(test)]
pub(crate) use filter::{Filter, Measure};

pub use derivatives::{DerivativeError, derivative_errors};
pub use functions::Functions;
pub use jacobian::Jacobian;
pub use nlp::{Evaluation, EvaluationFailure, Gradients, Nlp};
pub use observer::{Observer, Phase, Printed, Row, Silent};
pub use options::{Barrier, Method, Options};
pub use outcome::{ActiveBound, BoundSide, Counts, FailedDesign, Kkt, Outcome, Status};
pub use quasi_newton::QuasiNewton;
pub use solve::{resume, solve};
pub use state::{Multipliers, SavedState, Scaling};
