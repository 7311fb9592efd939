//! Every derivative of functions of structures, by the adjoint and by the complex step.

use super::lifted::along;
use super::{StaticDesign, StaticsFailure};
use crate::checked::{CheckedDerivative, checked_row};
use crate::problem::{Asked, Problem};
use crate::structures::functions::Function;
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
    let rows = which.iter().map(|&f| {
        let others = |i: usize| (columns[i][f], None);
        checked_row((problem, &at.x), (f, size_of(at, f)), &gradients[f], others)
    });
    Ok(rows.flatten().collect())
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
