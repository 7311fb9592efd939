//! The discretisation error of functions and gradients, by halving every step.
//!
//! Let f_{h,c} be the value with the steps and the cells of sums in use, f_{h,2c} that with every
//! cell halved, and f_{h/2,2c} that with every step halved, too. For a method of order m,
//!
//! ```text
//! f_{h,c} − f ≈ (f_{h,2c} − f_{h/2,2c}) 2ᵐ / (2ᵐ − 1) + (f_{h,c} − f_{h,2c})
//! ```
//!
//! (Richardson): the first term is the error of the steps, the second that of sums over the motion.
//! A function of the end alone has no second term. The terms are separate, so each may have any
//! size and sign. Motions that are sampled at the ends of equal steps have no cells: every second
//! sample of the finer run is used instead.

use super::evaluate::Evaluated;
use super::event::{self, Admit};
use super::integration::looks_at_the_whole;
use crate::integrate::{
    IntegrationFailure, Limits, Samples, Settings, Spacing, Trajectory, quadrature, simulate,
};
use crate::problem::Problem;

/// A number with its estimated error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Estimate {
    /// The number on the steps in use.
    pub value: f64,
    /// Its estimated error, absolute.
    pub error: f64,
    /// The error of the steps, with its sign.
    pub of_steps: f64,
    /// The error of the samples, with its sign.
    pub of_samples: f64,
}

/// A function's value and, if requested, its gradient in the design variables.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct FunctionError {
    /// The function, by index.
    pub function: usize,
    /// Its value.
    pub value: Estimate,
    /// The largest value over the motion, if it is an aggregate.
    pub maximum: Option<Estimate>,
    /// Its derivatives in the variables; empty if they were not requested.
    pub gradient: Vec<Estimate>,
}

/// Estimates the discretisation errors of the functions `which` at a simulated design, and of their
/// gradients if `gradients`.
///
/// # Errors
/// If the finer simulation or a gradient fails.
pub(crate) fn estimate(
    problem: &Problem,
    at: &Evaluated,
    which: &[usize],
    gradients: bool,
) -> Result<Vec<FunctionError>, IntegrationFailure> {
    let sums = |f: &usize| looks_at_the_whole(&at.scene.functions[*f]);
    let summed: Vec<usize> = which.iter().copied().filter(sums).collect();
    let cells = at.run.has_cells;
    let limits = problem.simulation.limits.clone();
    let settings = halved(&at.run, (cells, !summed.is_empty()), limits);
    let mut scene = at.scene.clone();
    let run = event::settle(&mut scene, &settings, at.run.duration, Admit::Late)?;
    let x = at.x.clone();
    let mut fine = Evaluated { x, scene, run };
    let numbers = |of: &Evaluated, which: &[usize]| -> Result<Vec<Vec<f64>>, IntegrationFailure> {
        let mut all: Vec<Vec<f64>> = which.iter().map(|&f| vec![of.function(f).value]).collect();
        if gradients && !which.is_empty() {
            let (found, _) = of.gradients(problem, which)?;
            all.iter_mut()
                .zip(found)
                .for_each(|(row, gradient)| row.extend(gradient));
        }
        Ok(all)
    };
    let (coarse, finer) = rayon::join(|| numbers(at, which), || numbers(&fine, which));
    let (coarse, finer) = (coarse?, finer?);
    let maxima = which.iter().map(|&f| {
        let [coarse, fine] = [at, &fine].map(|of| of.function(f).maximum.map(|m| m.value));
        coarse.zip(fine)
    });
    let maxima: Vec<Option<(f64, f64)>> = maxima.collect();
    // Motions in between: the same steps with twice the cells, or finer steps with half the
    // samples.
    let between = match (
        cells && !summed.is_empty(),
        fine.run.last() == 2 * at.run.last(),
    ) {
        (true, _) => {
            let doubled = Settings {
                spacing: Spacing::Frozen(at.run.grid.with_double_cells()),
                samples: Samples::Quadrature(0),
                ..settings
            };
            let (x, scene) = (at.x.clone(), at.scene.clone());
            let run = simulate(&scene.model, at.run.duration, &doubled)?;
            Evaluated { x, scene, run }
        }
        (false, true) => {
            thin(&mut fine.run);
            fine
        }
        (false, false) => fine,
    };
    let mut thinner = numbers(&between, &summed)?.into_iter();
    let of_sums = match cells {
        true => 16,
        false => quadrature::order(&at.run.instants),
    };
    let [steps, samples] = [at.run.method.order(), of_sums].map(|order| {
        let gain = 2.0_f64.powi(order as i32);
        gain / (gain - 1.0)
    });
    let mut all = Vec::new();
    let rows = which.iter().zip(coarse).zip(finer).zip(maxima);
    for (((&function, coarse), finer), maximum) in rows {
        let thinner = match summed.contains(&function) {
            true => thinner.next().unwrap_or_else(|| finer.clone()),
            // Its error is that of the steps alone.
            false if cells => coarse.clone(),
            false => finer.clone(),
        };
        let estimate = |((&h, &thin), &fine): ((&f64, &f64), &f64)| {
            let (of_steps, of_samples) = match cells {
                true => ((thin - fine) * steps, (h - thin) * samples),
                false => ((h - thin) * steps, (thin - fine) * samples),
            };
            Estimate {
                value: h,
                error: (of_steps + of_samples).abs(),
                of_steps,
                of_samples,
            }
        };
        let numbers = coarse.iter().zip(&thinner).zip(&finer);
        let mut estimates: Vec<Estimate> = numbers.map(estimate).collect();
        all.push(FunctionError {
            function,
            value: estimates.remove(0),
            maximum: maximum.map(|(value, fine)| {
                let of_steps = (value - fine) * steps;
                Estimate {
                    value,
                    error: of_steps.abs(),
                    of_steps,
                    of_samples: 0.0,
                }
            }),
            gradient: estimates,
        });
    }
    Ok(all)
}

/// The settings of a run with every step halved and twice the samples.
fn halved(run: &Trajectory<f64>, (cells, summed): (bool, bool), limits: Limits) -> Settings {
    let instants = run.last();
    let samples = if cells {
        Samples::Quadrature(0)
    } else if run.instants == run.grid.ends() {
        Samples::StepEnds
    } else if instants == 1 && !summed {
        Samples::Uniform(1)
    } else {
        Samples::Uniform(2 * instants)
    };
    Settings {
        method: run.method,
        solver: run.solver,
        spacing: Spacing::Frozen(run.grid.halved()),
        samples,
        limits,
        memory: 0,
        derivatives: false,
    }
}

/// Keeps every second sample of a run.
fn thin(run: &mut Trajectory<f64>) {
    let nc = match run.lambda.is_empty() {
        true => 0,
        false => run.numbering.constraints(),
    };
    let (nq, nv) = (run.numbering.positions(), run.numbering.velocities());
    let rows = |all: &[f64], width: usize| -> Vec<f64> {
        let rows = all.chunks_exact(width.max(1)).step_by(2);
        rows.flatten().copied().collect()
    };
    run.q = rows(&run.q, nq);
    run.v = rows(&run.v, nv);
    run.a = rows(&run.a, nv);
    run.lambda = rows(&run.lambda, nc);
    run.instants = run.instants.iter().copied().step_by(2).collect();
    run.places = run.places.iter().copied().step_by(2).collect();
    run.shown = vec![true; run.instants.len()];
    run.weights = quadrature::weights(&run.instants);
}
