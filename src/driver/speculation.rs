//! Simulations and gradients computed in advance, side by side.
//!
//! They use the steps in use. If the steps change before a result is requested, it is discarded. So
//! a run finds the same numbers, in the same order, on any number of processors.

use super::analysed::{Analysed, AnalysisFailure};
use super::integration::Integration;
use super::known_evaluations::bits;
use crate::integrate::WorkCounts;
use crate::problem::Problem;
use rayon::prelude::*;
use std::collections::HashMap;

/// Gradients of the requested functions, with the work of the simulation and of the gradients.
pub(super) type Derived = (Vec<Vec<f64>>, [WorkCounts; 2]);

/// Cached evaluations, keyed by the exact bits of the design.
#[derive(Default)]
pub(super) struct SpeculativeCache {
    /// How often the steps had been chosen at that time.
    refreshes: usize,
    simulated: HashMap<Vec<u64>, Result<Analysed, AnalysisFailure>>,
    derived: HashMap<Vec<u64>, Derived>,
}

/// Whether simulations may run side by side: steps are in use, and there is no event whose search
/// starts at the last one. Cases that are spread over ranks are computed when all ask for them.
fn is_possible(problem: &Problem, integration: &Integration) -> bool {
    if integration.shared.is_some() {
        return false;
    }
    if problem.statics.is_some() {
        return rayon::current_num_threads() > 1;
    }
    rayon::current_num_threads() > 1 && integration.has_steps(problem) && !has_event(problem)
}

/// Whether a motion ends at an event.
fn has_event(problem: &Problem) -> bool {
    match &problem.cases {
        Some(cases) => cases.list.iter().any(|case| has_event(&case.problem)),
        None if problem.statics.is_some() => false,
        None => problem.scene::<f64>(&problem.start()).until.is_some(),
    }
}

/// The design `x` simulated with the steps of `integration`, or `None` if it needs others.
fn simulated(
    (problem, functions): (&Problem, &[usize]),
    integration: &Integration,
    x: &[f64],
) -> Option<Result<Analysed, AnalysisFailure>> {
    let mut own = integration.clone();
    let found = Analysed::with(&mut own, problem, x, functions);
    let same = own.refreshes == integration.refreshes && own.unlowered == integration.unlowered;
    match found {
        Ok((evaluated, None)) if same => Some(Ok(evaluated)),
        Err(failure) if same => Some(Err(failure)),
        _ => None,
    }
}

impl SpeculativeCache {
    /// Simulates the first of `designs`, as many as there are processors.
    pub fn simulate(
        &mut self,
        asked: (&Problem, &[usize]),
        integration: &Integration,
        designs: &[Vec<f64>],
    ) {
        if !is_possible(asked.0, integration) {
            return;
        }
        self.keep(integration);
        let few = designs.par_iter().take(rayon::current_num_threads());
        let new = few.filter(|x| !self.simulated.contains_key(&bits(x)));
        let found = new.filter_map(|x| Some((bits(x), simulated(asked, integration, x)?)));
        let found: Vec<_> = found.collect();
        self.simulated.extend(found);
    }

    /// Computes the gradients of `functions` at all `designs`.
    pub fn differentiate(
        &mut self,
        problem: &Problem,
        integration: &Integration,
        (designs, functions): (&[Vec<f64>], &[usize]),
    ) {
        if !is_possible(problem, integration) {
            return;
        }
        self.keep(integration);
        let gradients = |x: &Vec<f64>| {
            let at = simulated((problem, functions), integration, x)?.ok()?;
            let (found, work) = at.gradients(problem, functions).ok()?;
            Some((bits(x), (found, [at.counts(), work])))
        };
        let found: Vec<_> = designs.par_iter().filter_map(gradients).collect();
        self.derived.extend(found);
    }

    /// The cached simulation of a design with the steps in use.
    pub fn take(
        &mut self,
        integration: &Integration,
        x: &[f64],
    ) -> Option<Result<Analysed, AnalysisFailure>> {
        self.keep(integration);
        self.simulated.remove(&bits(x))
    }

    /// The cached gradients of a design.
    pub fn take_gradients(&mut self, integration: &Integration, x: &[f64]) -> Option<Derived> {
        self.keep(integration);
        self.derived.remove(&bits(x))
    }

    /// Discards results that were computed with other steps than those in use.
    fn keep(&mut self, integration: &Integration) {
        if self.refreshes != integration.refreshes {
            self.simulated.clear();
            self.derived.clear();
            self.refreshes = integration.refreshes;
        }
    }
}
