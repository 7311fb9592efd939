//! Functions of structures along a direction of the design, by the complex step.

use super::{StaticDesign, StaticsFailure, cases_of, of_cases, of_modes, with_measured};
use crate::frozen::complex_design;
use crate::math::scalar::COMPLEX_STEP;
use crate::math::soft_max::SoftMax;
use crate::math::{Complex64, Scalar};
use crate::problem::{Asked, MeasuredFunction, Problem, StaticScene};
use crate::structures::functions::Solved;
use crate::structures::lifted::eigenvalue_rates;
use crate::structures::modes::{ModalFailure, Modes};
use crate::structures::statics::StaticFailure;
use std::collections::BTreeMap;
use std::f64::consts::PI;

/// Derivatives of the functions `which` of a solved design along a direction, Im f(x + i h d) / h. Matrices
/// and modes are those of the design; a workspace of its own serves each call, so calls run side by side.
pub(super) fn along(
    problem: &Problem,
    at: &StaticDesign,
    which: &[usize],
    direction: &[f64],
) -> Result<Vec<f64>, StaticsFailure> {
    let x = complex_design(&at.x, direction);
    let statics = &at.statics;
    let scene: StaticScene<Complex64> = problem.static_scene(statics, &x);
    let real = &at.scene.structure;
    let mut own = at.copied_workspace()?;
    let functions = with_measured(statics, &at.composition.of_scene(which));
    let mut needed: Vec<usize> = functions
        .iter()
        .flat_map(|&f| cases_of(&statics.functions[f]))
        .copied()
        .collect();
    needed.sort_unstable();
    needed.dedup();
    let mut solutions = vec![Vec::new(); scene.cases.len()];
    for case in needed {
        let matrices = of_cases(&mut own, statics, real)?;
        let (loads, x) = (&scene.cases[case], &at.solutions[case]);
        if statics.terms.von_karman {
            matrices
                .factorise_for(real, x)
                .map_err(ModalFailure::from)?;
        }
        let found = matrices.infinitesimal_solution(&scene.structure, loads, x, statics.terms);
        solutions[case] = found.map_err(|unknown| StaticsFailure::Case {
            case: statics.cases[case].clone(),
            failure: unknown.into(),
        })?;
    }
    let mut rates: BTreeMap<usize, f64> = BTreeMap::new();
    for f in functions {
        let value = match &statics.functions[f] {
            Asked::Misfit { numbers, .. } => {
                let rate = |own: &MeasuredFunction| {
                    2.0 * at.residual(own) * own.weight * rates[&own.function]
                };
                numbers.iter().map(rate).sum::<f64>() / numbers.len() as f64
            }
            Asked::DistanceFromStart => problem.distance_from_start(&x).infinitesimal(),
            Asked::OfSolutions(function) => {
                let solved = Solved {
                    problem: of_cases(&mut own, statics, real)?,
                    structure: &scene.structure,
                    cases: &scene.cases,
                    solutions: &solutions,
                    terms: statics.terms,
                };
                let found = solved.value(function);
                found
                    .map_err(|unknown| ModalFailure::from(StaticFailure::from(unknown)))?
                    .infinitesimal()
            }
            Asked::Frequency { .. } => {
                let modes = at.modes.as_ref().expect("modes were found before");
                let modal = of_modes(&mut own, statics, real)?;
                let rates = eigenvalue_rates(modal, &scene.structure, modes);
                frequency_rates(modes, &rates)[at.mode_of(f)]
            }
            Asked::LowestFrequency(rho) => {
                let found = at.lowest[f].as_ref().expect("it was found before");
                let modal = of_modes(&mut own, statics, real)?;
                let rates = eigenvalue_rates(modal, &scene.structure, &found.modes);
                let rates = frequency_rates(&found.modes, &rates);
                let negative: Vec<f64> = found.modes.frequencies().iter().map(|f| -f).collect();
                let weights = SoftMax::new(&negative, |_| 1.0, *rho).weights;
                weights.iter().zip(&rates).map(|(w, rate)| w * rate).sum()
            }
        };
        rates.insert(f, value);
    }
    at.statics.workspaces.give(own);
    let of = |g: usize| Complex64::new(at.function(g).value, rates[&g]);
    let rate = |&f: &usize| match at.composition.gives(f) {
        true => at.composition.value(f, &x, &of).im,
        false => rates[&f],
    };
    Ok(which.iter().map(|f| rate(f) / COMPLEX_STEP).collect())
}

/// Rates of frequencies from those of eigenvalues, f = √λ / 2π.
fn frequency_rates(modes: &Modes, rates: &[f64]) -> Vec<f64> {
    let pairs = modes.eigenvalues.iter().zip(rates);
    pairs
        .map(|(lambda, rate)| rate / (4.0 * PI * lambda.sqrt()))
        .collect()
}

impl StaticDesign {
    /// A workspace of the same design for another thread.
    fn copied_workspace(&self) -> Result<crate::problem::Workspace, StaticsFailure> {
        let mut own = self.statics.workspaces.take();
        if !self.statics.terms.von_karman && self.solutions.iter().any(|x| !x.is_empty()) {
            let matrices = of_cases(&mut own, &self.statics, &self.scene.structure)?;
            matrices
                .factorise(&self.scene.structure)
                .map_err(ModalFailure::from)?;
        }
        Ok(own)
    }
}
