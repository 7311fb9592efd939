//! What the program does with a problem: simulate it, check its gradients, optimise it, measure the
//! methods on it, and test extreme scenes.

pub mod accuracy;
mod alike;
pub mod analysed;
pub mod bases;
pub mod certificate;
pub mod chaos;
pub mod check;
mod driven_start;
pub mod ends;
pub mod error;
pub mod evaluate;
pub mod evaluator;
pub mod event;
pub mod explain;
mod flexible_limits;
pub mod integration;
pub mod known_evaluations;
pub mod memory;
pub mod multi_start;
pub mod not_finite;
pub mod optimise;
pub mod parameter;
mod record;
pub mod recorded;
pub mod resolved;
pub mod second_order;
pub mod simulate;
mod speculation;
pub mod stability;
pub mod start;
pub mod statics;
mod stretch;
pub mod unfollowed;
pub mod warm_start;
pub mod work_precision;

use flexbody_mathematics::math;
use flexbody_mechanics::{adjoint, functions, integrate, model, structures, system};
use flexbody_optimiser as optimiser;
use flexbody_problem as problem;
use flexbody_report as report;

pub use analysed::check;
pub use analysed::{Analysed, AnalysisFailure, Simulated};
pub use certificate::certify;
pub use chaos::chaos;
pub use check::CheckedDerivative;
pub use evaluate::Evaluated;
pub use explain::{explain, merged_errs};
pub use known_evaluations::KnownEvaluations;
pub use multi_start::multi_start;
pub use optimise::{Optimisation, optimise};
pub use parameter::{sensitivity, swept};
pub use second_order::second_order;
pub use simulate::{Simulation, simulate, simulate_for_gradients};
pub use warm_start::WarmStart;
