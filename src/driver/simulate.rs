//! A simulation and what it is judged by.

use super::evaluate::Evaluated;
use crate::integrate::{IntegrationFailure, Method, Settings};
use crate::problem::Problem;
use crate::system::observe::{Observation, Reaction, observe, reactions};

/// A simulated design with its observations at every instant.
pub struct Simulation {
    /// The design, its scene and motion.
    pub at: Evaluated,
    /// Energy, momentum and drift at every instant.
    pub observations: Vec<Observation>,
}

/// Simulates the design `x` of `problem`.
///
/// # Errors
/// If the simulation fails.
pub fn simulate(problem: &Problem, x: &[f64]) -> Result<Simulation, IntegrationFailure> {
    let at = Evaluated::new(problem, x)?;
    let (model, run) = (&at.scene.model, &at.run);
    let observations = (0..=run.steps)
        .map(|k| observe(model, &run.numbering, run.q(k), run.v(k)))
        .collect();
    Ok(Simulation { at, observations })
}

impl Simulation {
    /// Largest |E(t) − E(0)| of the total energy (J).
    pub fn energy_drift(&self) -> f64 {
        let total = |o: &Observation| o.kinetic + o.potential;
        let start = total(&self.observations[0]);
        self.observations
            .iter()
            .fold(0.0, |m, o| m.max((total(o) - start).abs()))
    }

    /// Largest position and velocity constraint violations.
    pub fn constraint_drift(&self) -> (f64, f64) {
        let all = self.observations.iter();
        all.fold((0.0, 0.0), |(p, v), o| {
            (p.max(o.position_drift), v.max(o.velocity_drift))
        })
    }

    /// Joint reactions at instant k.
    pub fn reactions(&self, k: usize) -> Vec<Reaction> {
        let run = &self.at.run;
        reactions(
            &self.at.scene.model,
            &run.numbering,
            run.q(k),
            run.lambda(k),
        )
    }
}

/// A function's value and an estimate of its discretisation error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Value with the problem's steps.
    pub value: f64,
    /// Estimated error, |f_h − f_2h| / (2^m − 1) for a method of order m (Richardson).
    pub error: f64,
}

/// Estimates the discretisation error of the functions `which` at a simulated design by a second
/// simulation with half the steps; `None` if there are too few steps or the coarse run fails.
pub fn estimate_errors(
    problem: &Problem,
    at: &Evaluated,
    which: &[usize],
) -> Option<Vec<Estimate>> {
    let Settings { steps, method } = problem.settings;
    if steps < 4 {
        return None;
    }
    let mut coarse = problem.clone();
    coarse.settings.steps = steps / 2;
    let coarse = Evaluated::new(&coarse, &at.x).ok()?;
    let Method::Bdf { order } = method;
    let ratio = steps as f64 / (steps / 2) as f64;
    let gain = ratio.powi(order as i32) - 1.0;
    let estimate = |&f: &usize| {
        let value = at.function(f).value;
        Estimate {
            value,
            error: (value - coarse.function(f).value).abs() / gain,
        }
    };
    Some(which.iter().map(estimate).collect())
}
