//! Every derivative of functions of structures, by the adjoint and by the complex step.

use super::lifted::along;
use super::{StaticDesign, StaticsFailure};
use crate::CheckedDerivative;
use crate::evaluate::Derivative;
use crate::problem::{Asked, Problem};
use crate::structures::functions::Function;
use rayon::prelude::*;

/// The least change of a variable, over its scale, to which round-off of a function is related.
const LEAST: f64 = 1e-4;

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
        let largest = largest_change(problem, &gradients[f]);
        let size = size_of(at, f);
        for i in 0..count {
            let Derivative { value, terms } = gradients[f][i];
            let scale = problem.variables[i].scale;
            let by_size = size / change_of(at.x[i], scale);
            all.push(CheckedDerivative {
                function: f,
                variable: i,
                adjoint: value,
                complex_step: columns[i][f],
                terms: terms.max(largest / scale).max(by_size),
                in_use: value,
            });
        }
    }
    Ok(all)
}

/// The change of a function by a typical change of the variable that changes it most.
fn largest_change(problem: &Problem, gradient: &[Derivative]) -> f64 {
    let scaled = gradient.iter().zip(&problem.variables);
    let largest = scaled.map(|(d, v)| (d.value * v.scale).abs());
    largest.fold(0.0, f64::max)
}

/// The size of a function whose last digits are its round-off: its value, or the largest coordinate if it is a place.
fn size_of(at: &StaticDesign, f: usize) -> f64 {
    let size = match at.statics.functions.get(f) {
        Some(Asked::OfSolutions(Function::Centre(_))) => {
            let nodes = at.scene.structure.nodes.iter();
            nodes
                .flat_map(|x| x.iter())
                .fold(0.0, |most: f64, x| most.max(x.abs()))
        }
        _ => 0.0,
    };
    size.max(at.function(f).value.abs())
}

/// The change of a variable to which the round-off of a function belongs: the variable's own size, as terms that cancel are in
/// proportion to powers of it, and between 1e-4 of its scale and the scale.
fn change_of(x: f64, scale: f64) -> f64 {
    match x.abs() {
        0.0 => scale,
        x => x.clamp(LEAST * scale, scale),
    }
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
