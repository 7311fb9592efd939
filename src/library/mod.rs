//! The public interface: simulate a design, compute its functions and exact gradients, check them,
//! and find the best design.
//!
//! These types hide the integration of a scene, so that they can stay the same when it changes.
//! Bindings to other languages use only them.
//!
//! | File | Content |
//! |---|---|
//! | `loaded` | problems from files and texts |
//! | `analysis` | consecutive designs: values and gradients |
//! | `response`, `states` | a motion: histories and their pull-back; states of all bodies |
//! | `rest` | structures under load cases, and modes |
//! | `optimum` | optimisation, from one start or several |
//! | `logs`, `written` | the files of an optimisation |

mod analysis;
mod interrupt;
mod loaded;
pub(crate) mod logs;
pub(crate) mod made;
pub(crate) mod optimum;
mod response;
mod rest;
mod states;
pub(crate) mod written;

use crate::driver;
use crate::driver::AnalysisFailure;
use crate::problem::{Case, Problem};

pub use crate::driver::CheckedDerivative;
pub use analysis::{Analysis, Design};
pub use interrupt::Interrupt;
pub use loaded::{load, parse};
pub use optimum::{
    Iteration, OptimisationError, OptimisationOptions, Optimum, optimise, optimise_with,
    page_of_design,
};
pub use response::{Cotangents, Motion, simulate};
pub use rest::{CaseAtRest, Mode, Rest, modes, rest, start_states};
pub use states::{BodyState, ElasticStates, Energies, Reactions};
pub use written::PageError;

/// The reason why a design could not be simulated or differentiated, with time and place.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error(transparent)]
pub struct SimulationError(#[from] AnalysisFailure);

/// Compares every derivative at the design `x` by the adjoint with the complex step.
///
/// # Errors
/// A simulation fails.
pub fn check(problem: &Problem, x: &[f64]) -> Result<Vec<CheckedDerivative>, SimulationError> {
    Ok(driver::check(problem, x)?)
}

/// Why derivatives at the design `x` mean nothing although they are exact for its time steps: the steps do not
/// resolve them. One sentence for each, then advice; empty if they are resolved.
pub fn unresolved(problem: &Problem, x: &[f64]) -> Vec<String> {
    if let Some(cases) = &problem.cases {
        let of_case = |case: &Case| {
            let own = unresolved(&case.problem, x).into_iter();
            own.map(|why| case.tell(why)).collect::<Vec<_>>()
        };
        // Derivatives of a phase are also those by the state with which it begins.
        let alone = cases.list.iter().filter(|case| !case.problem.is_phase());
        return alone.flat_map(of_case).collect();
    }
    if problem.statics.is_some() {
        return Vec::new();
    }
    // Where the finer run fails, adjoint and complex step still agree or not.
    let found = driver::resolved::of_design(problem, x).unwrap_or_default();
    let mut all: Vec<String> = found.iter().map(|own| own.describe(problem)).collect();
    if !all.is_empty() {
        let advice = driver::resolved::advice(problem);
        all.push(format!(
            "the steps do not resolve these derivatives: {advice}"
        ));
    }
    all
}
