//! The check of gradients: adjoint beside complex step.

use super::evaluate::Evaluated;
use crate::integrate::IntegrationFailure;
use crate::integrate::bdf::simulate_complex;
use crate::math::Complex64;
use crate::math::scalar::COMPLEX_STEP;
use crate::problem::Problem;
use rayon::prelude::*;

/// One derivative, computed twice.
#[derive(Clone, Debug, PartialEq)]
pub struct CheckedDerivative {
    /// Function, by index.
    pub function: usize,
    /// Variable, by index.
    pub variable: usize,
    /// By the discrete adjoint.
    pub adjoint: f64,
    /// By the complex step.
    pub complex_step: f64,
}

impl CheckedDerivative {
    /// |adjoint − complex step| relative to the complex step; absolute where that is zero.
    pub fn relative_difference(&self) -> f64 {
        let difference = (self.adjoint - self.complex_step).abs();
        if difference == 0.0 || self.complex_step == 0.0 {
            difference
        } else {
            difference / self.complex_step.abs()
        }
    }
}

/// Derivatives of every function in every variable at the design `x`, function by function. The
/// complex steps, one simulation a variable, run in parallel.
///
/// # Errors
/// If a simulation fails.
pub fn check(problem: &Problem, x: &[f64]) -> Result<Vec<CheckedDerivative>, IntegrationFailure> {
    let evaluated = Evaluated::new(problem, x)?;
    let which: Vec<usize> = (0..evaluated.scene.functions.len()).collect();
    let (adjoint, _) = evaluated.gradients(problem, &which)?;
    let by_variable: Vec<Vec<f64>> = (0..x.len())
        .into_par_iter()
        .map(|i| complex_step(problem, x, i))
        .collect::<Result<_, _>>()?;
    let pairs = which
        .iter()
        .flat_map(|&f| (0..x.len()).map(move |i| (f, i)));
    Ok(pairs
        .map(|(function, variable)| CheckedDerivative {
            function,
            variable,
            adjoint: adjoint[function][variable],
            complex_step: by_variable[variable][function],
        })
        .collect())
}

/// Derivatives of all functions in variable i.
fn complex_step(problem: &Problem, x: &[f64], i: usize) -> Result<Vec<f64>, IntegrationFailure> {
    let mut x: Vec<Complex64> = x.iter().map(|&x| x.into()).collect();
    x[i].im = COMPLEX_STEP;
    let scene = problem.scene(&x);
    let run = simulate_complex(&scene.model, scene.duration, &problem.settings)?;
    let derivative = |f: &crate::functions::Function<Complex64>| {
        f.evaluate(&scene.model, &run).value.im / COMPLEX_STEP
    };
    Ok(scene.functions.iter().map(derivative).collect())
}
