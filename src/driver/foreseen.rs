//! Simulations and gradients that will be asked for, made side by side beforehand.
//!
//! They are made with the steps in use and are thrown away where these change before they are asked
//! for, so a run finds the same numbers, in the same order, on any number of processors.

use super::evaluate::Evaluated;
use super::integration::Integration;
use super::journal::bits;
use crate::integrate::{IntegrationFailure, WorkCounts};
use crate::problem::Problem;
use rayon::prelude::*;
use std::collections::HashMap;

/// Gradients of the functions asked for, with the work of the simulation and of the gradients.
pub(super) type Derived = (Vec<Vec<f64>>, [WorkCounts; 2]);

/// What was made beforehand, by the bits of the design.
#[derive(Default)]
pub(super) struct Foreseen {
    /// How often the steps had been chosen when it was made.
    refreshes: usize,
    simulated: HashMap<Vec<u64>, Result<Evaluated, IntegrationFailure>>,
    derived: HashMap<Vec<u64>, Derived>,
}

/// Whether simulations may be made side by side: there are steps in use, and no event whose search
/// starts where the last one came.
fn is_possible(problem: &Problem, integration: &Integration) -> bool {
    let event = problem.scene::<f64>(&problem.start()).until.is_some();
    rayon::current_num_threads() > 1 && integration.chosen().is_some() && !event
}

/// The design `x` by the steps of `integration`, or `None` if it asks for others.
fn simulated(
    problem: &Problem,
    integration: &Integration,
    x: &[f64],
) -> Option<Result<Evaluated, IntegrationFailure>> {
    let mut own = integration.clone();
    let found = Evaluated::with(&mut own, problem, x);
    let same = own.refreshes == integration.refreshes && own.unlowered == integration.unlowered;
    match found {
        Ok((evaluated, None)) if same => Some(Ok(evaluated)),
        Err(failure) if same => Some(Err(failure)),
        _ => None,
    }
}

impl Foreseen {
    /// Simulates the first of `designs`, as many as there are processors.
    pub fn simulate(&mut self, problem: &Problem, integration: &Integration, designs: &[Vec<f64>]) {
        if !is_possible(problem, integration) {
            return;
        }
        self.keep(integration);
        let few = designs.par_iter().take(rayon::current_num_threads());
        let new = few.filter(|x| !self.simulated.contains_key(&bits(x)));
        let found = new.filter_map(|x| Some((bits(x), simulated(problem, integration, x)?)));
        let found: Vec<_> = found.collect();
        self.simulated.extend(found);
    }

    /// Finds the gradients of `functions` at all `designs`.
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
            let at = simulated(problem, integration, x)?.ok()?;
            let (found, work) = at.gradients(problem, functions).ok()?;
            Some((bits(x), (found, [at.run.counts, work])))
        };
        let found: Vec<_> = designs.par_iter().filter_map(gradients).collect();
        self.derived.extend(found);
    }

    /// What became of a design that was simulated beforehand with the steps in use.
    pub fn take(
        &mut self,
        integration: &Integration,
        x: &[f64],
    ) -> Option<Result<Evaluated, IntegrationFailure>> {
        self.keep(integration);
        self.simulated.remove(&bits(x))
    }

    /// Its gradients, likewise.
    pub fn take_gradients(&mut self, integration: &Integration, x: &[f64]) -> Option<Derived> {
        self.keep(integration);
        self.derived.remove(&bits(x))
    }

    /// Forgets what was made with other steps than those in use.
    fn keep(&mut self, integration: &Integration) {
        if self.refreshes != integration.refreshes {
            self.simulated.clear();
            self.derived.clear();
            self.refreshes = integration.refreshes;
        }
    }
}
