//! Every derivative of functions of structures, by the adjoint and by the complex step.

use super::lifted::along;
use super::{StaticDesign, StaticsFailure};
use crate::CheckedDerivative;
use crate::evaluate::Derivative;
use crate::problem::Problem;
use rayon::prelude::*;

/// Derivatives of all functions in all variables at a solved design.
///
/// # Errors
/// [`StaticsFailure`] if a function has no derivative there.
pub fn check(
    problem: &Problem,
    at: &StaticDesign,
) -> Result<Vec<CheckedDerivative>, StaticsFailure> {
    let which: Vec<usize> = (0..problem.function_names.len()).collect();
    let (gradients, _) = at.derivatives(problem, &which)?;
    let count = at.x.len();
    let columns: Result<Vec<Vec<f64>>, StaticsFailure> = (0..count)
        .into_par_iter()
        .map(|i| {
            if problem.simulation.limits.is_over() {
                return Err(StaticsFailure::Interrupted);
            }
            let mut direction = vec![0.0; count];
            direction[i] = 1.0;
            along(problem, at, &which, &direction)
        })
        .collect();
    let columns = columns?;
    let mut all = Vec::with_capacity(which.len() * count);
    for &f in &which {
        let sizes = size_of(problem, at, f, &gradients[f]);
        for i in 0..count {
            let Derivative { value, terms } = gradients[f][i];
            all.push(CheckedDerivative {
                function: f,
                variable: i,
                adjoint: value,
                complex_step: columns[i][f],
                terms: terms.max(sizes / problem.variables[i].scale),
                in_use: value,
            });
        }
    }
    Ok(all)
}

/// The change of a function by a typical change of the variable that changes it most, or its own size.
fn size_of(problem: &Problem, at: &StaticDesign, f: usize, gradient: &[Derivative]) -> f64 {
    let scaled = gradient.iter().zip(&problem.variables);
    let largest = scaled.map(|(d, v)| (d.value * v.scale).abs());
    largest.fold(at.function(f).value.abs(), f64::max)
}

/// The derivatives of all functions along a direction: by the adjoint, by the complex step, the sum of the
/// sizes of the parts, and the sizes of the terms.
///
/// # Errors
/// [`StaticsFailure`] if a function has no derivative there.
pub fn directional(
    problem: &Problem,
    at: &StaticDesign,
    direction: &[f64],
) -> Result<Vec<[f64; 4]>, StaticsFailure> {
    let which: Vec<usize> = (0..problem.function_names.len()).collect();
    let (gradients, _) = at.derivatives(problem, &which)?;
    let complex = along(problem, at, &which, direction)?;
    let one = |(&f, complex): (&usize, f64)| {
        let parts = gradients[f].iter().zip(direction);
        let mut sums = [0.0, complex, 0.0, at.function(f).value.abs()];
        for (d, by) in parts {
            sums[0] += d.value * by;
            sums[2] += (d.value * by).abs();
            sums[3] += d.terms * by.abs();
        }
        sums
    };
    Ok(which.iter().zip(complex).map(one).collect())
}
