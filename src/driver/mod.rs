//! What the program does with a problem: simulate it, check its gradients, optimise it, measure the
//! methods on it, and test extreme scenes.

pub(crate) mod analysed;
pub(crate) mod certificate;
pub(crate) mod chaos;
pub(crate) mod check;
mod connectors;
pub(crate) mod error;
pub(crate) mod evaluate;
pub(crate) mod evaluator;
pub(crate) mod event;
pub(crate) mod explain;
pub(crate) mod figures;
pub(crate) mod integration;
pub(crate) mod known_evaluations;
pub(crate) mod memory;
pub(crate) mod multi_start;
pub(crate) mod not_finite;
pub(crate) mod optimise;
pub(crate) mod parameter;
mod record;
pub(crate) mod second_order;
pub(crate) mod simulate;
mod speculation;
pub(crate) mod stability;
pub(crate) mod start;
pub(crate) mod statics;
mod stretch;
pub(crate) mod tables;
pub(crate) mod warm_start;
pub(crate) mod work_precision;

pub(crate) use analysed::check;
pub(crate) use analysed::{Analysed, AnalysisFailure, Simulated};
pub(crate) use certificate::certify;
pub(crate) use chaos::chaos;
pub use check::CheckedDerivative;
pub(crate) use evaluate::Evaluated;
pub(crate) use explain::{explain, merged_errs};
pub(crate) use known_evaluations::KnownEvaluations;
pub(crate) use multi_start::multi_start;
pub(crate) use optimise::{Optimisation, optimise};
pub(crate) use parameter::{sensitivity, swept};
pub(crate) use second_order::second_order;
pub(crate) use simulate::{Simulation, simulate};
pub(crate) use warm_start::WarmStart;
