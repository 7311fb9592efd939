//! Derivatives that the steps do not resolve.
//!
//! The steps bound the error of the motion, and adaptive explicit ones that of its tangent (see
//! `integrate/explicit/tangent.rs`). What is left is found by halving every step
//! ([`error`]): a derivative counts as unresolved if its estimated error is a tenth of
//! its size or more. A derivative that is small in the gradient of its function, each variable in
//! its scale, is judged by a tenth of the largest one; one that changes the function by less than
//! its round-off counts as zero.

use super::error::{self, FunctionError};
use super::evaluate::Evaluated;
use super::integration::Integration;
use super::size::{function_size, largest_datum};
use crate::functions::Function;
use crate::integrate::{IntegrationFailure, Method, Samples, Settings, Spacing, simulate};
use crate::problem::Problem;

/// Largest error of a derivative, relative to its size.
const LARGEST: f64 = 0.1;
/// Part of the largest derivative of a function that counts for the smaller ones.
const OF_LARGEST: f64 = 0.1;
/// A change of a function by this part of the size of its kind, by a typical change of the
/// variable, counts as zero.
const NOTHING: f64 = 1e-8;
/// Part of a standard deviation of data whose derivative counts for that of smaller residuals.
const OF_DEVIATION: f64 = 1e-3;
/// Derivatives on doubled steps that differ by this part of their size or less: those on the steps
/// themselves are then far more accurate.
const ALIKE: f64 = 0.3;

/// A derivative whose estimated error is a tenth of its size or more.
#[derive(Clone, Debug, PartialEq)]
pub struct Unresolved {
    /// Function and variable, by index.
    pub of: (usize, usize),
    /// The derivative and its estimated error.
    pub value: f64,
    /// Its estimated error.
    pub error: f64,
}

impl Unresolved {
    /// The derivative with its names.
    pub fn describe(&self, problem: &Problem) -> String {
        let (f, i) = self.of;
        format!(
            "the derivative of \"{}\" by \"{}\", {:.6e}, has an estimated error of {:.1e}",
            problem.function_names[f], problem.variables[i].name, self.value, self.error
        )
    }
}

/// Why a gradient is refused, if it is: names the first derivatives.
pub fn refusal(problem: &Problem, found: &[Unresolved]) -> Option<String> {
    let more = match found.len() {
        0 => return None,
        1..=3 => String::new(),
        n => format!(" and {} more", n - 3),
    };
    let named: Vec<String> = found
        .iter()
        .take(3)
        .map(|own| own.describe(problem))
        .collect();
    Some(format!(
        "the steps do not resolve the gradient: {}{more}; {}",
        named.join("; "),
        advice(problem)
    ))
}

/// What may resolve the derivatives of a problem.
pub fn advice(problem: &Problem) -> &'static str {
    match problem.simulation.spacing {
        Spacing::Steps(_) => "take more \"steps\", or a shorter duration",
        Spacing::Tolerance(_) | Spacing::Frozen(_) => {
            "take a smaller \"tolerance\", given \"steps\", or a shorter duration"
        }
    }
}

/// The unresolved derivatives of all functions at the design `x`.
///
/// # Errors
/// If the simulation or a gradient fails.
pub fn of_design(problem: &Problem, x: &[f64]) -> Result<Vec<Unresolved>, IntegrationFailure> {
    let scene = problem.scene(x);
    let which: Vec<usize> = (0..problem.function_names.len()).collect();
    let mut integration = Integration::new(problem, &scene, Some(&which), true);
    let (at, _) = Evaluated::with(&mut integration, problem, x)?;
    by_halves(problem, &at, &which, &|f, gradient| {
        sizes(problem, &at, f, gradient)
    })
}

/// The unresolved ones of these `gradients` of the functions `which`, first judged by doubled steps,
/// which cost half as much as the gradients themselves.
///
/// # Errors
/// If the simulation with halved steps or its gradient fails.
pub fn of_gradients(
    problem: &Problem,
    at: &Evaluated,
    which: &[usize],
    gradients: &[Vec<f64>],
) -> Result<Vec<Unresolved>, IntegrationFailure> {
    let sizes = |row: usize, gradient: &[f64]| sizes(problem, at, which[row], gradient);
    let coarse = on_doubled_steps(problem, at, which);
    match coarse.is_some_and(|coarse| alike(gradients, &coarse, &sizes)) {
        true => Ok(Vec::new()),
        false => by_halves(problem, at, which, &sizes),
    }
}

/// What the steps do not resolve of the gradients at the end of an optimisation, where the size of a
/// derivative is at least that at the start, as the gradient at an optimum may vanish. Adaptive explicit
/// steps resolve all by themselves. Where it cannot be judged there is none.
pub fn at_the_end(
    problem: &Problem,
    (start, end): (&Evaluated, &Evaluated),
    which: &[usize],
) -> Option<String> {
    let adaptive = !matches!(problem.simulation.spacing, Spacing::Steps(_));
    if adaptive && end.run.method == Method::Dop853 || which.is_empty() {
        return None;
    }
    let (last, _) = end.gradients(problem, which).ok()?;
    let coarse = on_doubled_steps(problem, end, which);
    let is_alike = |sizes: &Sizes<'_>| {
        let coarse = coarse.as_ref();
        coarse.is_some_and(|coarse| alike(&last, coarse, sizes))
    };
    let own = |row: usize, gradient: &[f64]| sizes(problem, end, which[row], gradient);
    if is_alike(&own) {
        return None;
    }
    // The start decides only where the gradient at the end is small.
    let (first, _) = start.gradients(problem, which).ok()?;
    let sizes = |row: usize, gradient: &[f64]| {
        let before = sizes(problem, start, which[row], &first[row]);
        let now = own(row, gradient);
        // A derivative by what has become a hundred times as large counts as much at a hundredth of its size.
        let part = |i: usize| match (start.x[i].abs(), end.x[i].abs()) {
            (before, now) if before < now && before > 0.0 => before / now,
            _ => 1.0,
        };
        let pairs = now.into_iter().zip(before).enumerate();
        pairs
            .map(|(i, (now, before))| now.max(part(i) * before))
            .collect()
    };
    if is_alike(&sizes) {
        return None;
    }
    let found = by_halves(problem, end, which, &sizes).ok()?;
    Some(format!("at the end {}", refusal(problem, &found)?))
}

/// The sizes of the derivatives of a function, by its place among the requested ones and its gradient.
type Sizes<'a> = dyn Fn(usize, &[f64]) -> Vec<f64> + 'a;

/// Whether the gradients on doubled steps are nearly the same.
fn alike(gradients: &[Vec<f64>], coarse: &[Vec<f64>], sizes: &Sizes<'_>) -> bool {
    let mut rows = gradients.iter().zip(coarse).enumerate();
    rows.all(|(row, (fine, coarse))| {
        let sizes = sizes(row, fine);
        let mut pairs = fine.iter().zip(coarse).zip(sizes);
        pairs.all(|((x, y), size)| (x - y).abs() <= ALIKE * size)
    })
}

/// The gradients on doubled steps; `None` if there are none.
fn on_doubled_steps(problem: &Problem, at: &Evaluated, which: &[usize]) -> Option<Vec<Vec<f64>>> {
    // An event would have to be settled again.
    if at.scene.until.is_some() {
        return None;
    }
    let run = &at.run;
    let settings = Settings {
        solver: run.solver,
        spacing: Spacing::Frozen(run.grid.doubled()?),
        samples: match (run.has_cells, run.last()) {
            (true, _) => Samples::Quadrature(0),
            (false, 1) => Samples::Uniform(1),
            (false, _) => Samples::StepEnds,
        },
        limits: problem.simulation.limits.clone(),
        ..Settings::steps(run.method, 1)
    };
    let coarse = simulate(&at.scene.model, run.duration, &settings).ok()?;
    let coarse = at.with_run(at.scene.clone(), coarse);
    Some(coarse.gradients(problem, which).ok()?.0)
}

fn by_halves(
    problem: &Problem,
    at: &Evaluated,
    which: &[usize],
    sizes: &Sizes<'_>,
) -> Result<Vec<Unresolved>, IntegrationFailure> {
    let found = error::estimate(problem, at, which, true)?;
    let of = |(row, own): (usize, &FunctionError)| {
        let function = own.function;
        let values: Vec<f64> = own.gradient.iter().map(|d| d.value).collect();
        let sizes = sizes(row, &values);
        let each = own.gradient.iter().zip(sizes).enumerate();
        let beyond = each.filter(|(_, (d, size))| d.error > LARGEST * size || d.error.is_nan());
        let named = beyond.map(|(i, (d, _))| Unresolved {
            of: (function, i),
            value: d.value,
            error: d.error,
        });
        named.collect::<Vec<_>>()
    };
    Ok(found.iter().enumerate().flat_map(of).collect())
}

/// What an error of each derivative of function f is compared with.
fn sizes(problem: &Problem, at: &Evaluated, f: usize, gradient: &[f64]) -> Vec<f64> {
    let scale = |i: usize| problem.variables[i].scale;
    let scaled = gradient.iter().enumerate().map(|(i, d)| d.abs() * scale(i));
    let largest = scaled.fold(0.0, f64::max);
    let misfits = problem.misfits(f).unwrap_or_default();
    let largest_of = |&(g, c): &(usize, f64)| match at.scene.functions.get(g) {
        Some(Function::Misfit { series }) => Some(c * largest_datum(series)),
        _ => None,
    };
    let nothing = match misfits.iter().filter_map(largest_of).reduce(f64::max) {
        // Residuals of a part of a standard deviation count as zero.
        Some(datum) => OF_DEVIATION * datum,
        None => NOTHING / LARGEST * function_size(at, f),
    };
    let of = |(i, d): (usize, &f64)| {
        let change = scale(i).max(at.x[i].abs());
        let by_others = OF_LARGEST * largest / scale(i);
        d.abs().max(by_others).max(nothing / change)
    };
    gradient.iter().enumerate().map(of).collect()
}
