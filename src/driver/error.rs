//! The discretisation error of functions and gradients, by halving every step.
//!
//! Let f_{h,c} be the value with the steps and the cells of sums in use, f_{h,2c} that with every
//! cell halved, and f_{h/2,2c} that with every step halved, too. For a method of order m,
//!
//! ```text
//! f_{h,c} − f ≈ (f_{h,2c} − f_{h/2,2c}) 2ᵐ / (2ᵐ − 1) + (f_{h,c} − f_{h,2c})
//! ```
//!
//! (Richardson): the first term is the error of the steps, the second that of sums over the motion.
//! A function of the end alone has no second term. The terms are separate, so each may have any
//! size and sign. Motions that are sampled at the ends of equal steps have no cells: every second
//! sample of the finer run is used instead. If both miss a sharp peak of an aggregate, the integral of
//! its polynomials between the samples gives the second term.
//!
//! Flexible bodies have vibrations that steps of one size do not follow. A method that damps them makes f_{h/2} as wrong
//! as f_h, and the difference of both may vanish. Such motions, and those by methods up to order three, are made with
//! doubled steps, too, and all three are judged together (see [`of_three`]).

use super::estimate::with_expressions;
pub use super::estimate::{Estimate, FunctionError};
use super::evaluate::Evaluated;
use super::event::{self, Admit};
use super::integration::looks_at_the_whole;
use crate::functions::between_samples;
use crate::integrate::{
    Grid, IntegrationFailure, Limits, Samples, Settings, Spacing, Trajectory, quadrature, simulate,
};
use crate::problem::Problem;
use crate::system::flexible;

/// Estimates the discretisation errors of the functions `which` at a simulated design, and of their
/// gradients if `gradients`.
///
/// # Errors
/// If the finer simulation or a gradient fails.
pub fn estimate(
    problem: &Problem,
    at: &Evaluated,
    which: &[usize],
    gradients: bool,
) -> Result<Vec<FunctionError>, IntegrationFailure> {
    with_expressions((problem, &at.x), which, |which| {
        of_scene(problem, at, which, gradients)
    })
}

/// Those of functions of the scene.
fn of_scene(
    problem: &Problem,
    at: &Evaluated,
    which: &[usize],
    gradients: bool,
) -> Result<Vec<FunctionError>, IntegrationFailure> {
    if at.is_rest() {
        return without_steps(problem, at, which, gradients);
    }
    let sums = |f: &usize| looks_at_the_whole(&at.scene.functions[*f]);
    let summed: Vec<usize> = which.iter().copied().filter(sums).collect();
    let cells = at.run.has_cells;
    let limits = problem.simulation.limits.clone();
    let settings = halved(&at.run, (cells, !summed.is_empty()), limits);
    let Finer {
        mut fine,
        is_halved,
    } = finer(problem, at, &settings)?;
    let numbers = |of: &Evaluated, which: &[usize]| -> Result<Vec<Vec<f64>>, IntegrationFailure> {
        let mut all: Vec<Vec<f64>> = which.iter().map(|&f| vec![of.function(f).value]).collect();
        if gradients && !which.is_empty() && !problem.variables.is_empty() {
            let (found, _) = of.gradients(problem, which)?;
            all.iter_mut()
                .zip(found)
                .for_each(|(row, gradient)| row.extend(gradient));
        }
        Ok(all)
    };
    let team = flexible::team(&at.scene.model);
    let (coarse, finer) = team.join(|| numbers(at, which), || numbers(&fine, which));
    let (coarse, finer) = (coarse?, finer?);
    let maxima = which.iter().map(|&f| {
        let [coarse, fine] = [at, &fine].map(|of| of.function(f).maximum.map(|m| m.value));
        coarse.zip(fine)
    });
    let maxima: Vec<Option<(f64, f64)>> = maxima.collect();
    // Motions in between: the same steps with twice the cells, or finer steps with half the
    // samples.
    let between = match (
        cells && !summed.is_empty(),
        fine.run.last() == 2 * at.run.last(),
    ) {
        (true, _) => {
            let doubled = Settings {
                spacing: Spacing::Frozen(at.run.grid.with_double_cells()),
                samples: Samples::Quadrature(0),
                ..settings
            };
            let run = simulate(&at.scene.model, at.run.duration, &doubled)?;
            at.with_run(at.scene.clone(), run)
        }
        (false, true) => {
            thin(&mut fine.run);
            fine
        }
        (false, false) => fine,
    };
    let mut thinner = numbers(&between, &summed)?.into_iter();
    let of_sums = match cells {
        true => 16,
        false => quadrature::order(&at.run.instants),
    };
    let doubled = doubled(problem, at, (&summed[..], &between), which, &numbers)?;
    let gain = |order: usize| 2.0_f64.powi(order as i32);
    let by_halving = |order: usize| gain(order) / (gain(order) - 1.0);
    let samples = by_halving(of_sums);
    let steps = match is_halved {
        true => by_halving(at.run.method.order()),
        false => 1.0,
    };
    let mut all = Vec::new();
    let rows = which.iter().zip(coarse).zip(finer).zip(maxima);
    for (row, (((&function, coarse), finer), maximum)) in rows.enumerate() {
        let thinner = match summed.contains(&function) {
            true => thinner.next().unwrap_or_else(|| finer.clone()),
            // Its error is that of the steps alone.
            false if cells => coarse.clone(),
            false => finer.clone(),
        };
        let estimate = |(number, ((&h, &thin), &fine)): (usize, ((&f64, &f64), &f64))| {
            let (halving, of_samples) = match cells {
                true => (thin - fine, (h - thin) * samples),
                false => (h - thin, (thin - fine) * samples),
            };
            let of_steps = match &doubled {
                Some(rows) => of_three(rows[row][number], halving, gain(at.run.method.order())),
                None => halving * steps,
            };
            Estimate {
                value: h,
                error: (of_steps + of_samples).abs(),
                of_steps,
                of_samples,
            }
        };
        let numbers = coarse.iter().zip(&thinner).zip(&finer);
        let mut estimates: Vec<Estimate> = numbers.enumerate().map(estimate).collect();
        let of_value = &mut estimates[0];
        // Twice as many samples may miss a sharp peak too.
        let resolved = between_samples(&at.scene.functions[function], &at.scene.model, &at.run);
        if let Some(missed) = resolved.map(|resolved| of_value.value - resolved)
            && missed.abs() > of_value.of_samples.abs()
        {
            of_value.of_samples = missed;
            of_value.error = (of_value.of_steps + missed).abs();
        }
        let value = estimates.remove(0);
        not_by_chance(problem, &mut estimates);
        all.push(FunctionError {
            function,
            value,
            maximum: maximum.map(|(value, fine)| {
                let of_steps = (value - fine) * steps;
                Estimate {
                    value,
                    error: of_steps.abs(),
                    of_steps,
                    of_samples: 0.0,
                }
            }),
            gradient: estimates,
        });
    }
    Ok(all)
}

/// A motion that is more accurate.
struct Finer {
    fine: Evaluated,
    /// By halved steps, or by others.
    is_halved: bool,
}

/// Steps of a tolerance that is smaller by this factor are taken for exact where halved ones fail.
const TIGHTER: f64 = 1e-2;

/// The motion by halved steps. Where these fail and steps follow a tolerance, it is that of a smaller tolerance: impacts move with
/// the steps, and halves of the steps around one may pass over the next.
///
/// # Errors
/// That of the halved steps, if both fail.
fn finer(
    problem: &Problem,
    at: &Evaluated,
    halved: &Settings,
) -> Result<Finer, IntegrationFailure> {
    let run = |settings: &Settings| -> Result<Evaluated, IntegrationFailure> {
        let mut scene = at.scene.clone();
        let run = event::settle(&mut scene, settings, at.run.duration, Admit::Late)?;
        Ok(at.with_run(scene, run))
    };
    let failure = match run(halved) {
        Ok(fine) => {
            let is_halved = true;
            return Ok(Finer { fine, is_halved });
        }
        Err(failure) => failure,
    };
    let Spacing::Tolerance(tolerance) = problem.simulation.spacing else {
        return Err(failure);
    };
    let tighter = Settings {
        spacing: Spacing::Tolerance(tolerance * TIGHTER),
        ..halved.clone()
    };
    let fine = run(&tighter).map_err(|_| failure)?;
    let is_halved = false;
    Ok(Finer { fine, is_halved })
}

/// At rest there is no step, and no error of steps.
fn without_steps(
    problem: &Problem,
    at: &Evaluated,
    which: &[usize],
    gradients: bool,
) -> Result<Vec<FunctionError>, IntegrationFailure> {
    let exact = |value: f64| Estimate {
        value,
        error: 0.0,
        of_steps: 0.0,
        of_samples: 0.0,
    };
    let rows = match gradients && !problem.variables.is_empty() {
        true => at.gradients(problem, which)?.0,
        false => vec![Vec::new(); which.len()],
    };
    let one = |(&function, row): (&usize, Vec<f64>)| {
        let found = at.function(function);
        FunctionError {
            function,
            value: exact(found.value),
            maximum: found.maximum.map(|own| exact(own.value)),
            gradient: row.into_iter().map(exact).collect(),
        }
    };
    Ok(which.iter().zip(rows).map(one).collect())
}

/// Raises errors that vanish by chance, where the error changes its sign with the step: the relative error of a
/// derivative is at least a part of that of the gradient, each variable in its scale.
fn not_by_chance(problem: &Problem, gradient: &mut [Estimate]) {
    const PART: f64 = 0.02;
    let largest = |of: fn(&Estimate) -> f64| {
        let scaled = gradient.iter().zip(&problem.variables);
        scaled
            .map(|(d, variable)| of(d).abs() * variable.scale)
            .fold(0.0, f64::max)
    };
    let relative = largest(|d| d.error) / largest(|d| d.value);
    if relative.is_finite() {
        for d in gradient {
            d.error = d.error.max(PART * relative * d.value.abs());
        }
    }
}

/// The error of f_h, from f_2h − f_h and f_h − f_{h/2}; `gain` is 2ᵐ.
///
/// Their ratio is 2ᵐ for small steps and smaller where stiff parts reduce the order. Then the differences are a
/// geometric series. With a larger ratio the second difference is small by chance, or because half steps damp the same
/// vibrations; the first one then tells the error by the order of the method. Without a decline no error of another
/// size is known than that of the differences.
fn of_three(first: f64, second: f64, gain: f64) -> f64 {
    const DECLINES: f64 = 1.5;
    let ratio = first / second;
    let sign = if second == 0.0 { first } else { second };
    let size = match ratio.is_nan() || ratio.abs() < DECLINES || ratio < 0.0 && ratio > -gain {
        true => first.abs().max(second.abs()),
        false => first.abs() / (ratio.abs().min(gain) - 1.0),
    };
    size.copysign(sign)
}

/// Differences of functions and derivatives by doubled steps from those by the steps in use, with samples at the same
/// instants; `None` of rigid scenes by methods of order four or more, and of flexible ones if steps have no pairs of one size.
fn doubled(
    problem: &Problem,
    at: &Evaluated,
    (summed, between): (&[usize], &Evaluated),
    which: &[usize],
    numbers: &impl Fn(&Evaluated, &[usize]) -> Result<Vec<Vec<f64>>, IntegrationFailure>,
) -> Result<Option<Vec<Vec<f64>>>, IntegrationFailure> {
    let (run, cells) = (&at.run, at.run.has_cells);
    let rigid = at.scene.model.flexible.is_empty();
    let pairs = |grid: &Grid| match grid.paired() {
        None if rigid => grid.doubled(),
        equal => equal,
    };
    let grid = match cells && !summed.is_empty() {
        true => pairs(&run.grid.with_double_cells()),
        false => pairs(&run.grid),
    };
    // A difference that is small by chance tells by the other one; by methods of high order that would claim too much.
    let told = !rigid || run.method.order() <= 3;
    let Some(grid) = grid.filter(|_| told) else {
        return Ok(None);
    };
    let instants = run.last();
    let even = cells || summed.is_empty() || instants.is_multiple_of(2);
    if !even {
        return Ok(None);
    }
    let settings = Settings {
        method: run.method,
        solver: run.solver,
        spacing: Spacing::Frozen(grid),
        samples: if cells {
            Samples::Quadrature(0)
        } else if run.instants == run.grid.ends() {
            Samples::StepEnds
        } else {
            Samples::Uniform((instants / 2).max(1))
        },
        limits: problem.simulation.limits.clone(),
        derivatives: false,
        memory: 0,
    };
    let mut scene = at.scene.clone();
    // Doubled steps may be too large for Newton's method.
    let Ok(found) = event::settle(&mut scene, &settings, run.duration, Admit::Late) else {
        return Ok(None);
    };
    let coarse = at.with_run(scene, found);
    // The motion by the steps in use with the samples of the other.
    let mut thinned: Evaluated;
    let same = match (cells, summed.is_empty()) {
        (_, true) => at,
        (true, false) => between,
        (false, false) => {
            thinned = at.with_run(at.scene.clone(), at.run.clone());
            thin(&mut thinned.run);
            &thinned
        }
    };
    let of_sums = |f: &usize| summed.contains(f);
    let (sums, ends): (Vec<usize>, Vec<usize>) = which.iter().copied().partition(of_sums);
    let differences = |beside: &Evaluated, which: &[usize]| -> Result<_, IntegrationFailure> {
        let pairs = numbers(&coarse, which)?
            .into_iter()
            .zip(numbers(beside, which)?);
        let row = |(a, b): (Vec<f64>, Vec<f64>)| a.iter().zip(b).map(|(a, b)| a - b).collect();
        Ok(pairs.map(row).collect::<Vec<Vec<f64>>>().into_iter())
    };
    let (mut by_sums, mut by_ends) = (differences(same, &sums)?, differences(at, &ends)?);
    let next = |f: &usize| match summed.contains(f) {
        true => by_sums.next(),
        false => by_ends.next(),
    };
    let rows = which.iter().map(next);
    Ok(Some(rows.map(Option::unwrap_or_default).collect()))
}

/// The settings of a run with every step halved and twice the samples.
pub(super) fn halved(
    run: &Trajectory<f64>,
    (cells, summed): (bool, bool),
    limits: Limits,
) -> Settings {
    let instants = run.last();
    let samples = if cells {
        Samples::Quadrature(0)
    } else if run.instants == run.grid.ends() {
        Samples::StepEnds
    } else if instants == 1 && !summed {
        Samples::Uniform(1)
    } else {
        Samples::Uniform(2 * instants)
    };
    Settings {
        method: run.method,
        solver: run.solver,
        spacing: Spacing::Frozen(run.grid.halved()),
        samples,
        limits,
        memory: 0,
        derivatives: false,
    }
}

/// Keeps every second sample of a run.
fn thin(run: &mut Trajectory<f64>) {
    let nc = match run.lambda.is_empty() {
        true => 0,
        false => run.numbering.constraints(),
    };
    let (nq, nv) = (run.numbering.positions(), run.numbering.velocities());
    let rows = |all: &[f64], width: usize| -> Vec<f64> {
        let rows = all.chunks_exact(width.max(1)).step_by(2);
        rows.flatten().copied().collect()
    };
    run.q = rows(&run.q, nq);
    run.v = rows(&run.v, nv);
    run.a = rows(&run.a, nv);
    run.lambda = rows(&run.lambda, nc);
    run.instants = run.instants.iter().copied().step_by(2).collect();
    run.places = run.places.iter().copied().step_by(2).collect();
    run.shown = vec![true; run.instants.len()];
    run.weigh();
}

#[cfg(test)]
mod tests {
    use super::*;

    /// f_h = c hᵐ has the error c hᵐ; so has a series of a smaller order. Where the second difference vanishes by
    /// chance, the first tells the error by the order; where nothing declines, it is the larger of both.
    #[test]
    fn three_runs_tell_the_error() {
        for order in 1..6 {
            let gain = 2.0_f64.powi(order);
            for smaller in 1..=order {
                let own = 2.0_f64.powi(smaller);
                for c in [1e-3, -7.0] {
                    let (first, second) = (c * (own - 1.0), c * (1.0 - 1.0 / own));
                    let found = of_three(first, second, gain);
                    assert!(
                        (found - c).abs() < 1e-12 * c.abs(),
                        "{order} {smaller}: {found}"
                    );
                }
            }
            let first = 3.0 * (gain - 1.0);
            for second in [0.0, 1e-9, -1e-9] {
                assert!((of_three(first, second, gain).abs() - 3.0).abs() < 1e-12);
            }
            for (first, second) in [(1.0, 1.0), (0.1, -2.0), (1e-3, 1.0), (-1.1, 1.0)] {
                let largest = f64::max(first, second).abs().max(f64::abs(second));
                let most = f64::abs(first).max(largest);
                assert_eq!(of_three(first, second, gain.max(4.0)).abs(), most);
            }
        }
        assert_eq!(of_three(0.0, 0.0, 4.0), 0.0);
    }
}
