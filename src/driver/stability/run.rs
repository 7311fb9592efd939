//! Runs one case and judges what the program reports.

use super::case::{Case, Judge};
use crate::CheckedDerivative;
use crate::analysed::Simulated;
use crate::certificate::{self, certify};
use crate::check::check;
use crate::integrate::{Method, Spacing};
use crate::optimiser::Status;
use crate::problem::{Override, Problem};
use crate::report::{StabilityOutcome, StabilityRow};
use crate::{KnownEvaluations, Optimisation, Simulation, error, optimise, simulate, start};
use std::ops::ControlFlow;

/// A reported number indicates an error if it is at least this part of it.
const TELLING: f64 = 0.1;
/// With more steps no gradient is computed: the check stores the stages of three runs.
const MOST_STEPS: usize = 100_000;
/// Tolerances of the runs that judge runs of the other family: explicit, implicit.
const TIGHT: (f64, f64) = (1e-13, 1e-11);
/// Number of equal steps of runs that judge bodies of finite elements.
const SMALL_STEPS: usize = 10_000;

/// Runs a case and judges it.
pub(super) fn run(case: &Case) -> StabilityRow {
    let mut row = blank(case);
    let problem = match read(case, usize::MAX) {
        Ok(problem) => problem,
        Err(message) => {
            row.outcome = StabilityOutcome::Refused { message };
            return row;
        }
    };
    match case.judge {
        Judge::Optimum { value, size } => optimisation(&mut row, case, &problem, (value, size)),
        Judge::Exact(_) | Judge::OtherMethod { .. } | Judge::SmallSteps { .. } => {
            motion(&mut row, case, &problem)
        }
    }
    row
}

/// The problem of a case with the first `kept` of its changes.
fn read(case: &Case, kept: usize) -> Result<Problem, String> {
    let parse = |text: &String| Override::parse(text);
    let changes: Result<Vec<Override>, _> = case.overrides(kept).iter().map(parse).collect();
    let changes = changes.map_err(|fault| fault.to_string())?;
    Problem::parse(case.scene.text, case.scene.name, &changes)
        .map_err(|faults| one_line(&faults.to_string()))
}

/// The row of a case without results.
pub(super) fn blank(case: &Case) -> StabilityRow {
    let judge = match case.judge {
        Judge::Exact(exact) => exact.source().into(),
        Judge::OtherMethod { kept, .. } if kept < case.changes.len() => {
            "the file as it is by the other family at 1e-13 or 1e-11".into()
        }
        Judge::OtherMethod { .. } => "explicit against implicit at 1e-13 or 1e-11".into(),
        Judge::SmallSteps { .. } => format!("the other implicit family in {SMALL_STEPS} steps"),
        Judge::Optimum { value, .. } if value.is_nan() => "there is no optimum".into(),
        Judge::Optimum { .. } => "the least that can be in closed form".into(),
    };
    StabilityRow {
        family: case.family.into(),
        extreme: case.extreme.clone(),
        scene: case.scene.name.into(),
        method: case.method(),
        by: None,
        steps: None,
        outcome: StabilityOutcome::WrongAndSilent,
        error: None,
        bound: case.bound,
        judge,
        energy_drift: None,
        position_drift: None,
        velocity_drift: None,
        gradient_error: None,
        no_gradient: None,
        command: case.command(),
    }
}

fn motion(row: &mut StabilityRow, case: &Case, problem: &Problem) {
    let start = problem.start();
    let seen = match simulate(problem, &start) {
        Ok(seen) => seen,
        Err(failure) => {
            let message = failure.to_string();
            row.outcome = StabilityOutcome::Refused { message };
            return;
        }
    };
    let count = problem.function_names.len();
    let values: Vec<f64> = (0..count).map(|f| seen.at.function(f).value).collect();
    row.steps = Some(seen.at.run.grid.steps());
    row.by = Some(seen.at.run.method.name());
    if values.iter().any(|value| !value.is_finite()) {
        let message = "a function is not finite".into();
        row.outcome = StabilityOutcome::Refused { message };
        return;
    }
    let (exact, sizes) = match known(case) {
        Ok(known) => known,
        Err(message) => {
            row.judge = format!("nobody: {message}");
            return;
        }
    };
    let relative = |(f, value): (usize, &f64)| (value - exact[f]).abs() / sizes[f];
    let error = largest(values.iter().enumerate().map(relative));
    row.error = Some(error).filter(|error| error.is_finite());
    let (position, velocity) = seen.constraint_drift();
    (row.position_drift, row.velocity_drift) = (Some(position), Some(velocity));
    if case.conservative {
        let kinetic = largest(seen.observations.iter().map(|o| o.kinetic));
        let drift = seen.energy_drift();
        row.energy_drift = Some(if kinetic > 0.0 {
            drift / kinetic
        } else {
            drift
        });
    }
    row.outcome = if error <= case.bound {
        StabilityOutcome::Accurate
    } else {
        match told(row, problem, &seen, error, &sizes) {
            Some(told) => StabilityOutcome::Degraded { told },
            None => StabilityOutcome::WrongAndSilent,
        }
    };
    let steps = seen.at.run.grid.steps();
    drop(seen);
    if steps > MOST_STEPS {
        row.no_gradient = Some(format!("not requested beyond {MOST_STEPS} steps"));
        return;
    }
    match check(problem, &start) {
        Ok(all) => row.gradient_error = Some(gradient_error(&all, &start, &sizes)),
        Err(failure) => row.no_gradient = Some(failure.to_string()),
    }
}

/// Largest difference of a derivative from the complex step, relative to the largest derivative of
/// the scene. Each is multiplied by its variable (one, if that is zero) and divided by the size of
/// its function, so that units do not matter.
fn gradient_error(all: &[CheckedDerivative], x: &[f64], sizes: &[f64]) -> f64 {
    let unit = |d: &CheckedDerivative| match x[d.variable] {
        0.0 => 1.0 / sizes[d.function],
        x => x.abs() / sizes[d.function],
    };
    let difference = |d: &CheckedDerivative| (d.adjoint - d.complex_step).abs() * unit(d);
    largest(all.iter().map(difference))
        / largest(all.iter().map(|d| d.complex_step.abs() * unit(d)))
}

/// Correct values of the functions, and the sizes to which errors are relative.
fn known(case: &Case) -> Result<(Vec<f64>, Vec<f64>), String> {
    let (values, sizes) = match case.judge {
        Judge::Exact(exact) => {
            let numbers = exact.numbers();
            (numbers.values, numbers.sizes)
        }
        Judge::SmallSteps { size } => {
            let mut other = read(case, usize::MAX)?;
            other.simulation.method = Some(match other.simulation.method {
                Some(Method::Radau { .. }) => Method::GeneralisedAlpha { radius: 0.8 },
                _ => Method::Radau { stages: 3 },
            });
            other.simulation.spacing = Spacing::Steps(SMALL_STEPS);
            values_of(&other, size)?
        }
        Judge::OtherMethod { size, .. } | Judge::Optimum { size, .. } => {
            let kept = match case.judge {
                Judge::OtherMethod { kept, .. } => kept,
                _ => usize::MAX,
            };
            let mut other = read(case, kept)?;
            let explicit = matches!(other.simulation.method, None | Some(Method::Dop853));
            let (method, tolerance) = match explicit {
                true => (Method::Radau { stages: 3 }, TIGHT.1),
                false => (Method::Dop853, TIGHT.0),
            };
            other.simulation.method = Some(method);
            other.simulation.spacing = Spacing::Tolerance(tolerance);
            values_of(&other, size)?
        }
    };
    let scaled = |all: Vec<f64>| all.iter().map(|x| x * case.length).collect();
    Ok((scaled(values), scaled(sizes)))
}

/// Values of the functions of another run, and their `size`.
fn values_of(other: &Problem, size: f64) -> Result<(Vec<f64>, Vec<f64>), String> {
    let seen = simulate(other, &other.start()).map_err(|failure| failure.to_string())?;
    let count = other.function_names.len();
    let values = (0..count).map(|f| seen.at.function(f).value).collect();
    Ok((values, vec![size; count]))
}

/// How the program reports that a motion has the error `error`: a warning, the printed energy
/// drift, a joint that is left out completely, or the estimate of `--error`.
fn told(
    row: &StabilityRow,
    problem: &Problem,
    seen: &Simulation,
    error: f64,
    sizes: &[f64],
) -> Option<String> {
    if let Some(warning) = &seen.warning {
        return Some(format!("warning: {warning}"));
    }
    if let Some(note) = start::unstable(problem, &seen.at.x) {
        return Some(format!("note: {note}"));
    }
    if row
        .energy_drift
        .is_some_and(|drift| drift >= TELLING * error)
    {
        return Some("the energy drift".into());
    }
    let mut redundant = problem.redundant.iter();
    if let Some(all) = redundant.find(|joint| joint.left_out == joint.rows) {
        return Some(format!("what is said of the file as it is read: {all}"));
    }
    let which: Vec<usize> = (0..sizes.len()).collect();
    match error::estimate(problem, &seen.at, &which, false) {
        Ok(all) => {
            let estimate = largest(all.iter().map(|e| e.value.error / sizes[e.function]));
            let telling = estimate.is_nan() || estimate >= TELLING * error;
            telling.then(|| "the estimate of --error".into())
        }
        Err(failure) => Some(format!("--error: halves of the steps fail: {failure}")),
    }
}

fn optimisation(
    row: &mut StabilityRow,
    case: &Case,
    problem: &Problem,
    (optimum, size): (f64, f64),
) {
    let go_on = &mut |_: &_| ControlFlow::Continue(());
    let Some(done) = optimise(
        problem,
        case.scene.name,
        None,
        KnownEvaluations::default(),
        go_on,
    ) else {
        let message = "nothing to optimise".into();
        row.outcome = StabilityOutcome::Refused { message };
        return;
    };
    if let Status::UndefinedStart { what } | Status::IllPosed { what } = &done.outcome.status {
        let message = what.clone();
        row.outcome = StabilityOutcome::Refused { message };
        return;
    }
    row.steps = done.end.as_ref().and_then(|end| match end {
        Simulated::Motion(end) => Some(end.at.run.grid.steps()),
        Simulated::Statics(_) | Simulated::Cases(_) => None,
    });
    let found = done.optimum.objective.value;
    let error = (found - optimum).abs() / size;
    row.error = Some(error).filter(|error| error.is_finite());
    row.outcome = match done.outcome.status {
        Status::Converged if error <= case.bound => StabilityOutcome::Accurate,
        Status::Converged => match not_confirmed(problem, &done) {
            Some(message) => StabilityOutcome::Refused { message },
            None => StabilityOutcome::WrongAndSilent,
        },
        _ => StabilityOutcome::Refused {
            message: done.optimum.message.clone(),
        },
    };
}

/// Why the gradients of an optimum are not confirmed, with which the command fails, if so.
fn not_confirmed(problem: &Problem, done: &Optimisation) -> Option<String> {
    let found = certify(problem, done, certificate::TOLERANCE);
    let designs = [&found.start, &found.optimum];
    let mut faults = designs.into_iter().flat_map(|design| &design.faults);
    faults.next().map(|fault| format!("gradients: {fault}"))
}

/// A text over several lines as one.
fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// The largest number; NaN if there is one.
fn largest(all: impl Iterator<Item = f64>) -> f64 {
    all.fold(0.0, |m: f64, x| match x.is_nan() || m.is_nan() {
        true => f64::NAN,
        false => m.max(x),
    })
}
