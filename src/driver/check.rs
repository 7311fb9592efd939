//! The check of gradients of a motion: adjoint against complex step.

use super::checked::{CheckedDerivative, checked_row};
use super::composed::infinitesimal;
use super::evaluate::Evaluated;
use super::event;
use super::frozen::{Stored, complex_design, complex_motion};
use super::integration::Integration;
use super::size::function_size;
use crate::functions::Function;
use crate::integrate::{IntegrationFailure, Settings, Trajectory};
use crate::math::Complex64;
use crate::math::scalar::COMPLEX_STEP;
use crate::problem::Problem;
use rayon::prelude::*;

/// Derivatives of every function in every variable at the design `x`, function by function. The
/// complex steps, one simulation a variable, run in parallel.
///
/// # Errors
/// If a simulation fails.
pub fn check(problem: &Problem, x: &[f64]) -> Result<Vec<CheckedDerivative>, IntegrationFailure> {
    let scene = problem.scene(x);
    let which: Vec<usize> = (0..problem.function_names.len()).collect();
    let mut integration = Integration::new(problem, &scene, Some(&which), true);
    let (in_use, _) = Evaluated::with(&mut integration, problem, x)?;
    let Some((settings, _)) = integration.chosen() else {
        return Ok(Vec::new());
    };
    let duration = in_use.run.duration;
    let rate = match &in_use.scene.until {
        Some(_) => event::rate(&in_use.scene, settings, duration)?,
        None => f64::NAN,
    };
    // The adjoint follows the first of these motions.
    let steps: Vec<ComplexStep> = (0..x.len())
        .into_par_iter()
        .map(|i| {
            let unit = |j: usize| if i == j { 1.0 } else { 0.0 };
            let direction: Vec<f64> = (0..x.len()).map(unit).collect();
            let stored = match i {
                0 => Stored::Steps,
                _ => Stored::Motion,
            };
            complex_step(problem, (settings, stored), (duration, rate), x, &direction)
        })
        .collect::<Result<_, _>>()?;
    let Some(first) = steps.first() else {
        return Ok(Vec::new());
    };
    let same = in_use.with_run(in_use.scene.clone(), first.run.clone());
    let (adjoint, _) = same.derivatives(problem, &which)?;
    let (in_use, _) = in_use.gradients(problem, &which)?;
    let rows = which.iter().map(|&f| {
        let others = |i: usize| (steps[i].derivatives[f], Some(in_use[f][i]));
        checked_row(
            (problem, x),
            (f, function_size(&same, f)),
            &adjoint[f],
            others,
        )
    });
    Ok(rows.flatten().collect())
}

/// Derivatives of all functions along a direction, and the real part of the motion.
pub(super) struct ComplexStep {
    pub derivatives: Vec<f64>,
    pub run: Trajectory<f64>,
}

/// Im f(x + i h d)/h of every function f; `event` is when the event comes at x, and how fast.
pub(super) fn complex_step(
    problem: &Problem,
    with: (&Settings, Stored),
    event: (f64, f64),
    x: &[f64],
    direction: &[f64],
) -> Result<ComplexStep, IntegrationFailure> {
    let moved = complex_design(x, direction);
    let (scene, run) = complex_motion(problem, with, event, &moved)?;
    let value = |f: &Function<Complex64>| f.evaluate(&scene.model, &run).value;
    let values: Vec<Complex64> = scene.functions.iter().map(value).collect();
    Ok(ComplexStep {
        derivatives: infinitesimal(&problem.composition, &moved, &values, COMPLEX_STEP),
        run: run.real(),
    })
}
