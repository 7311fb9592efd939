//! What the program does with a problem: simulate it, check its gradients, optimise it, measure the
//! methods on it, and test extreme scenes.

pub mod certificate;
pub mod chaos;
pub mod check;
mod connectors;
pub mod error;
pub mod evaluate;
pub mod evaluator;
pub mod event;
pub mod explain;
pub mod figures;
mod foreseen;
pub mod integration;
pub mod journal;
pub mod memory;
pub mod multi_start;
mod not_finite;
pub mod optimise;
mod record;
pub mod second_order;
pub mod simulate;
pub mod stability;
pub mod start;
mod stretch;
pub mod tables;
pub mod warm_start;
pub mod work_precision;

pub use certificate::certify;
pub use chaos::chaos;
pub use check::{CheckedDerivative, check};
pub use evaluate::Evaluated;
pub use explain::{explain, merged_errs};
pub use journal::Journal;
pub use multi_start::multi_start;
pub use optimise::{Optimisation, optimise};
pub use second_order::second_order;
pub use simulate::{Simulation, simulate};
pub use warm_start::WarmStart;
