//! `--accuracy`: steps, samples and bases that reach an accuracy.

use super::bases;
use super::error::estimate;
use super::evaluate::Evaluated;
use super::size::function_size;
use crate::functions::Function;
use crate::integrate::{IntegrationFailure, Spacing, Trajectory};
use crate::problem::{Problem, Simulation, larger};

/// Largest number of attempts to reach an accuracy.
const ATTEMPTS: usize = 12;
/// Finer steps that do not reduce the error to this part of the least one are in vain, and so many in turn are the last.
const PROGRESS: f64 = 0.7;
const IN_VAIN: usize = 2;
/// Largest number of richer bases.
const BASES: usize = 5;
/// Largest number of times that bases are judged, each time at finer steps.
const ROUNDS: usize = 4;
/// Part of the size of its kind below which a function is round-off, so that no error relative to it can be reached.
const ROUND_OFF: f64 = 1e-13;
/// Smallest tolerance and largest number of steps to try.
const FINEST: (f64, usize) = (1e-14, 10_000_000);

/// Steps that reach an accuracy, and their cost.
#[derive(Clone, Debug)]
pub struct Accuracy {
    /// Number of steps.
    pub steps: usize,
    /// Number of steps of equal size or tolerance, if it was refined.
    pub spacing: Option<Spacing>,
    /// Number of samples, if it was increased.
    pub samples: Option<usize>,
    /// Changes of reduced bases, as path=value.
    pub bases: Vec<String>,
    /// Largest estimated error reached, relative to the function.
    pub error: f64,
}

impl Accuracy {
    /// The changes of the problem file that give these steps, as path=value.
    pub fn overrides(&self) -> Vec<String> {
        let mut all = match self.spacing {
            Some(Spacing::Tolerance(tolerance)) => {
                vec![format!("/simulation/tolerance={tolerance:e}")]
            }
            Some(Spacing::Steps(steps)) => vec![format!("/simulation/steps={steps}")],
            Some(Spacing::Frozen(_)) | None => Vec::new(),
        };
        all.extend((self.samples).map(|samples| format!("/simulation/samples={samples}")));
        all.extend_from_slice(&self.bases);
        all
    }

    /// The reached accuracy and the requested one; `of` names the functions.
    pub fn describe(&self, asked: f64, of: &str) -> String {
        let missed = match self.error <= asked {
            true => "",
            false => ", which is all that can be reached",
        };
        let refined = match self.spacing {
            Some(Spacing::Tolerance(tolerance)) => format!(", tolerance {tolerance:.1e}"),
            _ => String::new(),
        };
        let samples = self
            .samples
            .map_or_else(String::new, |samples| format!(", {samples} samples"));
        let bases: String = (self.bases.iter())
            .map(|change| format!(", {change}"))
            .collect();
        format!(
            "accuracy {asked:.1e}: {} steps{refined}{samples}{bases}; estimated relative error of the \
             {of} at the start {:.1e}{missed}",
            self.steps, self.error
        )
    }
}

/// A function whose error is judged, and a size that counts if the function is smaller.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Judged {
    /// The function, by index.
    pub function: usize,
    /// The largest finite bound of a constraint; 0 for an objective.
    pub bound: f64,
}

impl Judged {
    /// A function relative to itself.
    pub fn alone(function: usize) -> Self {
        let bound = 0.0;
        Self { function, bound }
    }

    fn size(&self, value: f64) -> f64 {
        value.abs().max(self.bound).max(f64::MIN_POSITIVE)
    }

    /// Whether this difference or value is round-off of functions of its kind.
    fn is_round_off(&self, x: f64, at: &Evaluated) -> bool {
        x.abs() <= ROUND_OFF * function_size(at, self.function)
    }
}

/// What an accuracy looks at, and its name: the objective, or the constraints that depend on the motion if the objective
/// does not.
pub fn judged(problem: &Problem, objective: usize) -> (Vec<Judged>, &'static str) {
    let functions = problem.scene(&problem.start()).functions;
    let moves = |f: usize| {
        let needed = problem.composition.of_scene(&[f]).into_owned();
        let mut needed = needed.into_iter().map(|g| &functions[g]);
        needed.any(|own| !matches!(own, Function::OfDesign { .. }))
    };
    let constraints = problem.constraints.iter().filter(|c| moves(c.function));
    let all: Vec<Judged> = constraints
        .map(|c| {
            let bounds = [c.lower, c.upper].into_iter().filter(|x| x.is_finite());
            Judged {
                function: c.function,
                bound: bounds.fold(0.0, |m, x| m.max(x.abs())),
            }
        })
        .collect();
    match moves(objective) || all.is_empty() {
        true => (vec![Judged::alone(objective)], "objective"),
        false => (all, "constraints"),
    }
}

fn indices(which: &[Judged]) -> Vec<usize> {
    which.iter().map(|own| own.function).collect()
}

/// Refines the steps or the samples of `problem`, whichever have too large an error, until the
/// estimated errors of the functions `which` at the start are below `accuracy`, relative to their
/// sizes. They never become coarser than the problem requests.
///
/// # Errors
/// If a simulation fails.
pub fn reach(
    problem: &mut Problem,
    which: &[Judged],
    accuracy: f64,
) -> Result<Accuracy, IntegrationFailure> {
    let asked = problem.clone();
    let reduced = problem.with_all_nodes(&problem.start()).is_some();
    // Bases and steps may each have half of the allowed error.
    let part = if reduced { 0.5 * accuracy } else { accuracy };
    let (mut of_steps, mut steps) = reach_steps(problem, which, part)?;
    let mut of_bases = 0.0;
    for _ in 0..ROUNDS {
        // Bases are judged at the steps that are taken in the end.
        let changed;
        (of_bases, changed) = reach_bases(problem, which, part)?;
        if !changed {
            break;
        }
        let before = problem.simulation.clone();
        (of_steps, steps) = reach_steps(problem, which, part)?;
        if problem.simulation == before {
            break;
        }
    }
    let (now, asked_steps) = (&problem.simulation, &asked.simulation);
    Ok(Accuracy {
        steps,
        spacing: (now.spacing != asked_steps.spacing).then(|| now.spacing.clone()),
        samples: now.samples.filter(|_| now.samples != asked_steps.samples),
        bases: problem.basis_overrides(&asked),
        error: of_steps + of_bases,
    })
}

/// Refines steps and samples until their estimated errors are below `accuracy`, relative to the functions; the
/// largest error, and the number of steps.
fn reach_steps(
    problem: &mut Problem,
    which: &[Judged],
    accuracy: f64,
) -> Result<(f64, usize), IntegrationFailure> {
    let x = problem.start();
    let functions = indices(which);
    let mut attempts = ATTEMPTS;
    let (mut least, mut in_vain) = (f64::INFINITY, 0);
    loop {
        let at = bases::run(problem, &x, &functions)?;
        let all = estimate(problem, &at, &functions, false)?;
        let (mut reached, mut excess, mut is_done) = (0.0_f64, [0.0_f64; 2], true);
        for (own, found) in which.iter().zip(&all) {
            let value = &found.value;
            let size = own.size(value.value);
            reached = larger(reached, value.error / size);
            if value.error <= accuracy * size || own.is_round_off(value.value, &at) {
                continue;
            }
            is_done = false;
            for (excess, part) in excess.iter_mut().zip([value.of_steps, value.of_samples]) {
                // Each part may have half of the allowed error.
                *excess = larger(*excess, 2.0 * part.abs() / (accuracy * size));
            }
        }
        let steps = at.run.grid.steps();
        attempts -= 1;
        in_vain = if reached < PROGRESS * least {
            0
        } else {
            in_vain + 1
        };
        least = least.min(reached);
        let [of_steps, of_samples] = excess;
        if is_done
            || attempts == 0
            || in_vain == IN_VAIN
            || !refine(&mut problem.simulation, &at.run, of_steps, of_samples)
        {
            return Ok((reached, steps));
        }
    }
}

/// Makes reduced bases richer until their errors against all nodes are below `accuracy`, relative to the functions; the
/// largest error, and whether bases were changed. Takes all nodes if no basis does. The steps are those of the problem.
pub fn reach_bases(
    problem: &mut Problem,
    which: &[Judged],
    accuracy: f64,
) -> Result<(f64, bool), IntegrationFailure> {
    let x = problem.start();
    let Some(all_nodes) = problem.with_all_nodes(&x) else {
        return Ok((0.0, false));
    };
    let functions = indices(which);
    let exact = bases::run(&all_nodes, &x, &functions)?;
    let exact: Vec<f64> = functions.iter().map(|&f| exact.function(f).value).collect();
    // The largest relative error, and whether all are small.
    let judge = |at: &Evaluated| {
        let (mut error, mut is_done) = (0.0_f64, true);
        for (own, &exact) in which.iter().zip(&exact) {
            let difference = at.function(own.function).value - exact;
            let relative = difference.abs() / own.size(exact);
            error = larger(error, relative);
            is_done &= relative <= accuracy || own.is_round_off(difference, at);
        }
        (error, is_done)
    };
    for attempt in 0..BASES {
        let (error, is_done) = judge(&bases::run(problem, &x, &functions)?);
        if is_done {
            return Ok((error, attempt > 0));
        }
        if let Some(richer) = problem.with_richer_bases(&x) {
            *problem = richer;
        }
    }
    if problem.simulation.method.is_none() {
        // Bodies with all nodes need a method.
        let at = bases::run(problem, &x, &functions)?;
        return Ok((judge(&at).0, true));
    }
    *problem = all_nodes;
    Ok((0.0, true))
}

/// Refines steps and samples by the factors by which their errors exceed the allowed ones. `false`
/// if no refinement is possible.
fn refine(
    simulation: &mut Simulation,
    run: &Trajectory<f64>,
    of_steps: f64,
    of_samples: f64,
) -> bool {
    let before = simulation.clone();
    let more_samples = of_samples.sqrt().clamp(2.0_f64.sqrt(), 8.0);
    // Cells follow the tolerance; samples at the ends of steps follow the steps.
    let apart = simulation.samples.is_some() && !run.has_cells;
    if of_samples > 1.0 && apart {
        let next = (run.last() as f64 * more_samples).ceil() as usize;
        simulation.samples = Some(next.min(FINEST.1));
    }
    match &mut simulation.spacing {
        Spacing::Tolerance(tolerance) if of_steps.max(of_samples) > 1.0 => {
            *tolerance = (*tolerance / of_steps.max(of_samples).max(2.0)).max(FINEST.0);
        }
        Spacing::Steps(count) => {
            let mut more = 1.0_f64;
            if of_steps > 1.0 {
                more = of_steps.max(2.0).powf(1.0 / run.method.order() as f64);
            }
            if of_samples > 1.0 && !apart {
                more = more.max(more_samples);
            }
            *count = ((*count as f64 * more).ceil() as usize).min(FINEST.1);
        }
        Spacing::Tolerance(_) | Spacing::Frozen(_) => {}
    }
    *simulation != before
}
