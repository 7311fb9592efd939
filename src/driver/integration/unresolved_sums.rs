//! A warning of integrals that the finest samples do not find, as across a pole of a quotient.

use super::Integration;
use crate::functions::resolution::resolution;
use crate::functions::{Function, Reduction, Scene};
use crate::integrate::{Samples, Trajectory};
use crate::problem::Problem;

/// An error that is told, relative to the integral of the size.
const LARGE: f64 = 0.01;
/// That of other sums: below it round-off of what is integrated is no error.
const GOAL: f64 = 1e-9;

impl Integration {
    /// The integrals and means of a run whose samples leave a large error.
    pub(crate) fn unresolved_sums(
        &self,
        problem: &Problem,
        (scene, run): (&Scene<f64>, &Trajectory<f64>),
    ) -> Option<String> {
        let Samples::Quadrature(_) = self.samples else {
            return None;
        };
        let is_integral = |f: usize| match scene.function(f) {
            Function::Reduced { reduction, .. } => {
                matches!(reduction, Reduction::Integral | Reduction::Mean)
            }
            _ => false,
        };
        let told = |&f: &usize| {
            let name = problem.function_names.get(f)?;
            let error = match is_integral(f) {
                true => resolution(scene, &[f], run, GOAL).error,
                false => 0.0,
            };
            (error > LARGE).then(|| format!("\"{name}\" by {:.0} %", 100.0 * error.min(1.0)))
        };
        let all: Vec<String> = self.summed.iter().filter_map(told).collect();
        (!all.is_empty()).then(|| {
            format!(
                "integrals may err, relative to those of sizes: {}; what is integrated has no bound, or peaks between samples",
                all.join(", ")
            )
        })
    }
}
