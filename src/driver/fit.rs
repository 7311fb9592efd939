//! Fits: residuals of misfits with their derivatives, and what the fitted numbers are worth.

use super::analysed::{Analysed, AnalysisFailure, Simulated};
use super::evaluate::{Derivative, Evaluated};
use super::event;
use super::frozen::{Stored, complex_design, complex_motion, settings};
use super::statics::{StaticDesign, StaticsFailure};
use crate::functions::misfit::residuals;
use crate::functions::series::{Measured, Series};
use crate::functions::{Function, Scene};
use crate::integrate::IntegrationFailure;
use crate::math::Complex64;
use crate::math::scalar::COMPLEX_STEP;
use crate::optimiser::{self, Outcome, Statistics, Variance};
use crate::problem::{Asked, MeasuredFunction, Problem, Sense};
use crate::report::fit::{Fit, FittedNumber, FittedSeries, VarianceFrom};
use indexmap::IndexMap;
use rayon::prelude::*;

/// The misfits of a sum f = Σ c_m f_m, f_m = Σ r_i² / N_m: each with its factor c_m.
pub type Misfits = Vec<(usize, f64)>;

/// Residuals of a sum of misfits.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FitResiduals {
    /// The residuals r, in standard deviations.
    pub values: Vec<f64>,
    /// Their derivatives in the variables, one row each.
    pub jacobian: Vec<Vec<f64>>,
    /// Their factors √(c/N): f is the sum of the squares of the products.
    pub factors: Vec<f64>,
}

impl FitResiduals {
    /// Residuals of misfits with these numbers of data and factors, without derivatives.
    fn of(parts: Vec<(Vec<f64>, f64)>) -> Self {
        let factors = parts.iter().flat_map(|(own, c)| {
            let factor = (c / own.len() as f64).sqrt();
            std::iter::repeat_n(factor, own.len())
        });
        Self {
            factors: factors.collect(),
            jacobian: Vec::new(),
            values: parts.into_iter().flat_map(|(own, _)| own).collect(),
        }
    }
}

/// The misfits whose sum the objective of a problem minimises, if it is one.
pub fn fitted(problem: &Problem) -> Option<Misfits> {
    let objective = problem
        .objective
        .filter(|own| own.sense == Sense::Minimise)?;
    problem.misfits(objective.function)
}

/// The series of the misfit f of a scene; none if it is another function.
pub fn series_of<S>(scene: &Scene<S>, f: usize) -> &[Series<S>] {
    match &scene.functions[f] {
        Function::Misfit { series } => series,
        _ => &[],
    }
}

/// The name of a series, with that of its misfit where there are several.
pub fn series_name(problem: &Problem, misfits: &Misfits, (f, data): (usize, &Measured)) -> String {
    match misfits.len() {
        1 => data.name.clone(),
        _ => format!("{}: {}", problem.function_names[f], data.name),
    }
}

/// Residuals of misfits at a design, and their derivatives by one complex run per variable with the steps of the
/// real one; `None` where a time of the data is outside of the motion.
///
/// # Errors
/// If a run fails.
pub fn of_motion(
    problem: &Problem,
    at: &Evaluated,
    misfits: &Misfits,
) -> Result<Option<FitResiduals>, IntegrationFailure> {
    let values = misfits.iter().map(|&(f, c)| {
        let own = residuals(series_of(&at.scene, f), &at.scene.model, &at.run)?;
        Some((own, c))
    });
    let (Some(values), Some(settings)) = (values.collect(), settings(problem, at)) else {
        return Ok(None);
    };
    let found = FitResiduals::of(values);
    let rate = match &at.scene.until {
        Some(_) => event::rate(&at.scene, &settings, at.run.duration)?,
        None => f64::NAN,
    };
    let n = at.x.len();
    let column = |i: usize| -> Result<Vec<f64>, IntegrationFailure> {
        let unit = |j: usize| if i == j { 1.0 } else { 0.0 };
        let along: Vec<f64> = (0..n).map(unit).collect();
        let event = (at.run.duration, rate);
        let moved = complex_design(&at.x, &along);
        let (scene, run) = complex_motion(problem, (&settings, Stored::Motion), event, &moved)?;
        let slope = |r: Complex64| r.im / COMPLEX_STEP;
        let own = misfits.iter().map(|&(f, _)| {
            let own = residuals(series_of(&scene, f), &scene.model, &run)?;
            Some(own.into_iter().map(slope).collect::<Vec<f64>>())
        });
        let own: Option<Vec<Vec<f64>>> = own.collect();
        let missing = || vec![f64::NAN; found.values.len()];
        Ok(own.map_or_else(missing, |own| own.concat()))
    };
    let columns: Vec<Vec<f64>> = (0..n)
        .into_par_iter()
        .map(column)
        .collect::<Result<_, _>>()?;
    let row = |k: usize| columns.iter().map(|column| column[k]).collect();
    Ok(Some(FitResiduals {
        jacobian: (0..found.values.len()).map(row).collect(),
        ..found
    }))
}

/// Values of functions that the misfit f of structures has measured; none if it is another function.
fn measured_of(at: &StaticDesign, f: usize) -> &[MeasuredFunction] {
    match &at.statics.functions[f] {
        Asked::Misfit { numbers, .. } => numbers,
        _ => &[],
    }
}

/// Residuals of misfits of structures, and their derivatives.
///
/// # Errors
/// If a function has no derivative.
fn of_structures(
    problem: &Problem,
    at: &StaticDesign,
    misfits: &Misfits,
) -> Result<FitResiduals, StaticsFailure> {
    let numbers = || misfits.iter().flat_map(|&(f, _)| measured_of(at, f));
    let which: Vec<usize> = numbers().map(|own| own.function).collect();
    let (gradients, _) = at.derivatives(problem, &which)?;
    let row = |(own, gradient): (&MeasuredFunction, &Vec<Derivative>)| {
        gradient.iter().map(|d| d.value * own.weight).collect()
    };
    let values = misfits.iter().map(|&(f, c)| {
        let own = measured_of(at, f).iter();
        (own.map(|own| at.residual(own)).collect(), c)
    });
    Ok(FitResiduals {
        jacobian: numbers().zip(&gradients).map(row).collect(),
        ..FitResiduals::of(values.collect())
    })
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
    let Some(misfits) = fitted(problem) else {
        return Ok(None);
    };
    let is_active =
        |name: &String, all: &[optimiser::ActiveBound]| all.iter().any(|own| own.name == *name);
    let active = problem.constraints.iter();
    let active = active.filter(|own| is_active(&own.name, &outcome.active_constraints));
    let active: Vec<usize> = active.map(|own| own.function).collect();
    let (found, given, rows) = match end {
        // A sum of misfits over cases is not one of residuals.
        Simulated::Cases(_) => return Ok(None),
        Simulated::Motion(end) => {
            let given = misfits.iter().all(|&(f, _)| {
                let mut series = series_of(&end.at.scene, f).iter();
                series.all(|own| own.data.has_deviations)
            });
            let (rows, _) = end.at.gradients(problem, &active)?;
            (of_motion(problem, &end.at, &misfits)?, given, rows)
        }
        Simulated::Statics(at) => {
            let given = misfits.iter().all(|&(f, _)| {
                matches!(&at.statics.functions[f], Asked::Misfit { given: true, .. })
            });
            let (rows, _) = at.derivatives(problem, &active)?;
            let value = |row: Vec<Derivative>| row.into_iter().map(|d| d.value).collect();
            let rows = rows.into_iter().map(value).collect();
            (Some(of_structures(problem, at, &misfits)?), given, rows)
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
        factors: &found.factors,
        scales: &scales,
        held: &held,
        rows: &rows,
        variance,
    });
    let own = |worth: Statistics| Fit {
        series: series(problem, end, &misfits),
        numbers: numbers(problem, end, &misfits),
        ..recorded(problem, &found, (&worth, variance))
    };
    Ok(worth.map(own))
}

/// The series of a fit beside their data.
fn series(problem: &Problem, end: &Simulated, misfits: &Misfits) -> IndexMap<String, FittedSeries> {
    let Simulated::Motion(end) = end else {
        return IndexMap::new();
    };
    let at = &end.at;
    let shown = |f: usize, own: &Series<f64>| {
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
        Some((series_name(problem, misfits, (f, data)), series))
    };
    let of = |&(f, _): &(usize, f64)| {
        let all = series_of(&at.scene, f).iter();
        all.filter_map(move |own| shown(f, own))
    };
    misfits.iter().flat_map(of).collect()
}

/// The fitted functions beside their measured values.
fn numbers(
    problem: &Problem,
    end: &Simulated,
    misfits: &Misfits,
) -> IndexMap<String, FittedNumber> {
    let Simulated::Statics(at) = end else {
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
    let all = misfits.iter().flat_map(|&(f, _)| measured_of(at, f));
    all.map(shown).collect()
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
    /// Residuals of misfits and their derivatives, if they have values.
    ///
    /// # Errors
    /// If a run fails, or a function has no derivative.
    pub(super) fn residuals(
        &self,
        problem: &Problem,
        misfits: &Misfits,
    ) -> Result<Option<FitResiduals>, AnalysisFailure> {
        match self {
            Self::Motion(at) => Ok(of_motion(problem, at, misfits)?),
            Self::Statics(at) => Ok(Some(of_structures(problem, at, misfits)?)),
            Self::Cases(_) | Self::Elsewhere(_) => Ok(None),
        }
    }
}
