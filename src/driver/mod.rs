//! What the program does with a problem: simulate it, check its gradients, optimise it.

pub mod check;
pub mod evaluate;
pub mod figures;
pub mod optimise;
pub mod simulate;

pub use check::{CheckedDerivative, check};
pub use evaluate::{Evaluated, Evaluator};
pub use optimise::{Optimisation, optimise};
pub use simulate::{Simulation, simulate};
