//! Fits: residuals of misfits with their derivatives, and what the fitted numbers are worth.

use super::analysed::{Analysed, AnalysisFailure, Simulated};
use super::evaluate::{Derivative, Evaluated};
use super::event;
use super::frozen::{complex_motion, settings};
use super::statics::{StaticDesign, StaticsFailure};
use crate::functions::Function;
use crate::functions::misfit::{complex_residuals, residuals};
use crate::functions::series::Series;
use crate::integrate::IntegrationFailure;
use crate::math::Complex64;
use crate::math::scalar::COMPLEX_STEP;
use crate::optimiser::{self, Outcome, Statistics, Variance};
use crate::problem::{Asked, MeasuredFunction, Problem, Sense};
use crate::report::fit::{Fit, FittedNumber, FittedSeries, VarianceFrom};
use indexmap::IndexMap;
use rayon::prelude::*;

/// Residuals of an objective f = Σ r_i² / N.
#[derive(Clone, Debug, PartialEq)]
pub struct FitResiduals {
    /// The residuals r, in standard deviations.
    pub values: Vec<f64>,
    /// Their derivatives in the variables, one row each.
    pub jacobian: Vec<Vec<f64>>,
}

/// The misfit that the objective of a problem minimises, if it is one.
pub fn fitted(problem: &Problem) -> Option<usize> {
    let objective = problem
        .objective
        .filter(|own| own.sense == Sense::Minimise)?;
    problem
        .is_misfit(objective.function)
        .then_some(objective.function)
}

/// Residuals of the misfit f at a design, and their derivatives by one complex run per variable with the steps
/// of the real one.
///
/// # Errors
/// If a run fails.
pub fn of_motion(
    problem: &Problem,
    at: &Evaluated,
    f: usize,
) -> Result<Option<FitResiduals>, IntegrationFailure> {
    let Function::Misfit { series } = &at.scene.functions[f] else {
        return Ok(None);
    };
    let values = residuals(series, &at.scene.model, &at.run);
    let (Some(values), Some(settings)) = (values, settings(problem, at)) else {
        return Ok(None);
    };
    let rate = match &at.scene.until {
        Some(_) => event::rate(&at.scene, &settings, at.run.duration)?,
        None => f64::NAN,
    };
    let n = at.x.len();
    let column = |i: usize| -> Result<Vec<f64>, IntegrationFailure> {
        let unit = |j: usize| if i == j { 1.0 } else { 0.0 };
        let along: Vec<f64> = (0..n).map(unit).collect();
        let event = (at.run.duration, rate);
        let (scene, run) = complex_motion(problem, &settings, event, &at.x, &along)?;
        let found = match &scene.functions[f] {
            Function::Misfit { series } => complex_residuals(series, &scene.model, &run),
            _ => None,
        };
        let slope = |r: Complex64| r.im / COMPLEX_STEP;
        let missing = || vec![f64::NAN; values.len()];
        Ok(found.map_or_else(missing, |all| all.into_iter().map(slope).collect()))
    };
    let columns: Vec<Vec<f64>> = (0..n)
        .into_par_iter()
        .map(column)
        .collect::<Result<_, _>>()?;
    let row = |k: usize| columns.iter().map(|column| column[k]).collect();
    Ok(Some(FitResiduals {
        jacobian: (0..values.len()).map(row).collect(),
        values,
    }))
}

/// Residuals of the misfit f of structures, and their derivatives.
///
/// # Errors
/// If a function has no derivative.
fn of_structures(
    problem: &Problem,
    at: &StaticDesign,
    f: usize,
) -> Result<Option<FitResiduals>, StaticsFailure> {
    let Asked::Misfit { numbers, .. } = &at.statics.functions[f] else {
        return Ok(None);
    };
    let which: Vec<usize> = numbers.iter().map(|own| own.function).collect();
    let (gradients, _) = at.derivatives(problem, &which)?;
    let row = |(own, gradient): (&MeasuredFunction, &Vec<Derivative>)| {
        gradient.iter().map(|d| d.value * own.weight).collect()
    };
    Ok(Some(FitResiduals {
        values: numbers.iter().map(|own| at.residual(own)).collect(),
        jacobian: numbers.iter().zip(&gradients).map(row).collect(),
    }))
}

/// What the numbers of a fit are worth at the end of a run, and the fit beside its data.
///
/// # Errors
/// If a run fails, or a function has no derivative.
pub fn of_end(
    problem: &Problem,
    outcome: &Outcome,
    end: &Simulated,
) -> Result<Option<Fit>, AnalysisFailure> {
    let Some(f) = fitted(problem) else {
        return Ok(None);
    };
    let is_active =
        |name: &String, all: &[optimiser::ActiveBound]| all.iter().any(|own| own.name == *name);
    let active = problem.constraints.iter();
    let active = active.filter(|own| is_active(&own.name, &outcome.active_constraints));
    let active: Vec<usize> = active.map(|own| own.function).collect();
    let (found, given, rows) = match end {
        Simulated::Motion(end) => {
            let Function::Misfit { series } = &end.at.scene.functions[f] else {
                return Ok(None);
            };
            let given = series.iter().all(|own| own.data.has_deviations);
            let (rows, _) = end.at.gradients(problem, &active)?;
            (of_motion(problem, &end.at, f)?, given, rows)
        }
        Simulated::Statics(at) => {
            let Asked::Misfit { given, .. } = &at.statics.functions[f] else {
                return Ok(None);
            };
            let (rows, _) = at.derivatives(problem, &active)?;
            let value = |row: Vec<Derivative>| row.into_iter().map(|d| d.value).collect();
            let rows = rows.into_iter().map(value).collect();
            (of_structures(problem, at, f)?, *given, rows)
        }
    };
    let Some(found) = found else {
        return Ok(None);
    };
    let variance = if given {
        Variance::Given
    } else {
        Variance::Estimated
    };
    let held: Vec<bool> = (problem.variables.iter())
        .map(|own| own.lower == own.upper || is_active(&own.name, &outcome.active_bounds))
        .collect();
    let scales: Vec<f64> = problem.variables.iter().map(|own| own.scale).collect();
    let worth = optimiser::statistics(&optimiser::Fit {
        residuals: &found.values,
        jacobian: &found.jacobian,
        scales: &scales,
        held: &held,
        rows: &rows,
        variance,
    });
    let own = |worth: Statistics| Fit {
        series: series(end, f),
        numbers: numbers(problem, end, f),
        ..recorded(problem, &found, (&worth, variance))
    };
    Ok(worth.map(own))
}

/// The series of a fit beside their data.
fn series(end: &Simulated, f: usize) -> IndexMap<String, FittedSeries> {
    let Simulated::Motion(end) = end else {
        return IndexMap::new();
    };
    let at = &end.at;
    let Function::Misfit { series } = &at.scene.functions[f] else {
        return IndexMap::new();
    };
    let shown = |own: &Series<f64>| {
        let fitted = own.values(&at.scene.model, &at.run)?;
        let data = &own.data;
        let deviations = data.weights.iter().map(|weight| 1.0 / weight);
        let series = FittedSeries {
            unit: Some(own.of.unit()).filter(|unit| !unit.is_empty() && unit != "1"),
            offset: own.offset,
            time: data.times.clone(),
            measured: data.values.clone(),
            standard_deviation: deviations.collect(),
            fitted,
        };
        Some((data.name.clone(), series))
    };
    series.iter().filter_map(shown).collect()
}

/// The fitted functions beside their measured values.
fn numbers(problem: &Problem, end: &Simulated, f: usize) -> IndexMap<String, FittedNumber> {
    let Simulated::Statics(at) = end else {
        return IndexMap::new();
    };
    let Asked::Misfit { numbers, .. } = &at.statics.functions[f] else {
        return IndexMap::new();
    };
    let shown = |own: &MeasuredFunction| {
        let number = FittedNumber {
            unit: Some(problem.function_unit(own.function)),
            measured: own.value,
            standard_deviation: 1.0 / own.weight,
            fitted: at.function(own.function).value,
        };
        (problem.function_names[own.function].clone(), number)
    };
    numbers.iter().map(shown).collect()
}

fn recorded(
    problem: &Problem,
    found: &FitResiduals,
    (worth, variance): (&Statistics, Variance),
) -> Fit {
    let names: Vec<&String> = problem.variables.iter().map(|own| &own.name).collect();
    let known = |i: &usize| worth.deviations[*i].is_some_and(|own| own > 0.0);
    let pairs = |of: &dyn Fn(usize, usize) -> Option<f64>| {
        let row = |i: usize| -> IndexMap<String, f64> {
            let entry = |j: usize| Some((names[j].clone(), of(i, j)?));
            (0..names.len()).filter(known).filter_map(entry).collect()
        };
        let rows = (0..names.len()).filter(known);
        rows.map(|i| (names[i].clone(), row(i))).collect()
    };
    let deviations = names.iter().zip(&worth.deviations);
    let direction = |parts: &Vec<(usize, f64)>| {
        let part = |&(i, by): &(usize, f64)| (names[i].clone(), by * problem.variables[i].scale);
        parts.iter().map(part).collect()
    };
    Fit {
        data: found.values.len() as u64,
        freedom: worth.freedom as u64,
        reduced_chi_square: worth.reduced_chi_square,
        variance: match variance {
            Variance::Given => VarianceFrom::Given,
            Variance::Estimated => VarianceFrom::Estimated,
        },
        standard_deviations: deviations
            .map(|(name, own)| ((*name).clone(), *own))
            .collect(),
        covariance: pairs(&|i, j| Some(worth.covariance[i][j])),
        correlation: pairs(&|i, j| worth.correlation(i, j)),
        undetermined: worth.undetermined.iter().map(direction).collect(),
        series: IndexMap::new(),
        numbers: IndexMap::new(),
    }
}

impl Analysed {
    /// Residuals of the misfit f and their derivatives, if it is one.
    ///
    /// # Errors
    /// If a run fails, or a function has no derivative.
    pub(super) fn residuals(
        &self,
        problem: &Problem,
        f: usize,
    ) -> Result<Option<FitResiduals>, AnalysisFailure> {
        match self {
            Self::Motion(at) => Ok(of_motion(problem, at, f)?),
            Self::Statics(at) => Ok(of_structures(problem, at, f)?),
        }
    }
}
