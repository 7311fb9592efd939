//! The check of gradients of a problem with cases: each case by itself, and functions over cases from those.

use super::cases::InCases;
use super::{Analysed, AnalysisFailure};
use crate::CheckedDerivative;
use crate::composed::infinitesimal;
use crate::integration::Integration;
use crate::math::Complex64;
use crate::math::scalar::COMPLEX_STEP;
use crate::problem::{Cases, Problem};
use std::collections::HashMap;
use std::sync::Arc;

/// Derivatives of every function in every variable at the design `x`, function by function.
///
/// # Errors
/// If an analysis fails; it names the case.
pub(super) fn check(
    (problem, cases): (&Problem, &Arc<Cases>),
    x: &[f64],
) -> Result<Vec<CheckedDerivative>, AnalysisFailure> {
    let (composition, count) = (&problem.composition, x.len());
    let mut all: Vec<CheckedDerivative> = Vec::new();
    let mut first = 0;
    for case in &cases.list {
        let found = super::check(&case.problem, x);
        let found = found.map_err(|failure| AnalysisFailure::InCase {
            case: case.name.clone(),
            failure: Box::new(failure),
        })?;
        all.extend(found.into_iter().map(|own| CheckedDerivative {
            function: first + own.function,
            ..own
        }));
        first += case.problem.function_names.len();
    }
    if composition.list.is_empty() {
        return Ok(all);
    }
    let which: Vec<usize> = (0..composition.first).collect();
    let mut integration = Integration::of(problem, Some(&which), true);
    let (at, _) = InCases::<Analysed>::with(&mut integration, (problem, cases), x, &which)?;
    let values: Vec<f64> = which.iter().map(|&k| at.value(k)).collect();
    // A function without a value has no derivatives.
    let numbered = all.iter().map(|own| ((own.function, own.variable), own));
    let numbered: HashMap<(usize, usize), &CheckedDerivative> = numbered.collect();
    let of = |k: usize, i: usize| {
        let unknown = CheckedDerivative {
            function: k,
            variable: i,
            adjoint: f64::NAN,
            complex_step: f64::NAN,
            terms: f64::NAN,
            in_use: None,
        };
        numbered.get(&(k, i)).map_or(unknown, |own| (*own).clone())
    };
    let complex = |i: usize| {
        let unit = |j: usize| if i == j { COMPLEX_STEP } else { 0.0 };
        let x = x.iter().enumerate();
        let x: Vec<Complex64> = x.map(|(j, &x)| Complex64::new(x, unit(j))).collect();
        let value = |k: usize| Complex64::new(values[k], COMPLEX_STEP * of(k, i).complex_step);
        let values: Vec<Complex64> = which.iter().map(|&k| value(k)).collect();
        infinitesimal(composition, &x, &values, COMPLEX_STEP)
    };
    let columns: Vec<Vec<f64>> = (0..count).map(complex).collect();
    let mut composed = Vec::new();
    for function in composition.first..problem.function_names.len() {
        let partials = composition.partials(function, x, &|k| values[k]);
        let moving = || partials.by_function.iter().filter(|(_, by)| *by != 0.0);
        for (variable, &direct) in partials.by_variable.iter().enumerate() {
            let sum = |of_one: &dyn Fn(&CheckedDerivative) -> f64| -> f64 {
                moving().map(|&(k, by)| by * of_one(&of(k, variable))).sum()
            };
            let terms = moving().map(|&(k, by)| (by * of(k, variable).terms).abs());
            let in_use = moving().map(|&(k, by)| Some(by * of(k, variable).in_use?));
            let in_use: Option<f64> = in_use.sum();
            composed.push(CheckedDerivative {
                function,
                variable,
                adjoint: direct + sum(&|own| own.adjoint),
                complex_step: columns[variable][function],
                terms: direct.abs() + terms.sum::<f64>(),
                in_use: in_use.map(|sum| direct + sum),
            });
        }
    }
    all.extend(composed);
    Ok(all)
}
