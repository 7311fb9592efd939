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
//! sample of the finer run is used instead.

use super::bases;
use super::check::own_size;
use super::evaluate::Evaluated;
use super::event::{self, Admit};
use super::integration::looks_at_the_whole;
use crate::integrate::{
    IntegrationFailure, Limits, Samples, Settings, Spacing, Trajectory, quadrature, simulate,
};
use crate::problem::{Problem, Simulation};

/// Largest number of attempts to reach an accuracy.
const ATTEMPTS: usize = 12;
/// Largest number of richer bases.
const BASES: usize = 5;
/// Largest number of times that bases are judged, each time at finer steps.
const ROUNDS: usize = 4;
/// Part of the size of its kind below which a function is round-off, so that no error relative to it can be reached.
const ROUND_OFF: f64 = 1e-13;
/// Smallest tolerance and largest number of steps to try.
const FINEST: (f64, usize) = (1e-14, 10_000_000);

/// A number with its estimated error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Estimate {
    /// The number on the steps in use.
    pub value: f64,
    /// Its estimated error, absolute.
    pub error: f64,
    /// The error of the steps, with its sign.
    pub of_steps: f64,
    /// The error of the samples, with its sign.
    pub of_samples: f64,
}

/// A function's value and, if requested, its gradient in the design variables.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct FunctionError {
    /// The function, by index.
    pub function: usize,
    /// Its value.
    pub value: Estimate,
    /// The largest value over the motion, if it is an aggregate.
    pub maximum: Option<Estimate>,
    /// Its derivatives in the variables; empty if they were not requested.
    pub gradient: Vec<Estimate>,
}

/// Estimates the discretisation errors of the functions `which` at a simulated design, and of their
/// gradients if `gradients`.
///
/// # Errors
/// If the finer simulation or a gradient fails.
pub(crate) fn estimate(
    problem: &Problem,
    at: &Evaluated,
    which: &[usize],
    gradients: bool,
) -> Result<Vec<FunctionError>, IntegrationFailure> {
    let sums = |f: &usize| looks_at_the_whole(&at.scene.functions[*f]);
    let summed: Vec<usize> = which.iter().copied().filter(sums).collect();
    let cells = at.run.has_cells;
    let limits = problem.simulation.limits.clone();
    let settings = halved(&at.run, (cells, !summed.is_empty()), limits);
    let mut scene = at.scene.clone();
    let run = event::settle(&mut scene, &settings, at.run.duration, Admit::Late)?;
    let x = at.x.clone();
    let mut fine = Evaluated { x, scene, run };
    let numbers = |of: &Evaluated, which: &[usize]| -> Result<Vec<Vec<f64>>, IntegrationFailure> {
        let mut all: Vec<Vec<f64>> = which.iter().map(|&f| vec![of.function(f).value]).collect();
        if gradients && !which.is_empty() {
            let (found, _) = of.gradients(problem, which)?;
            all.iter_mut()
                .zip(found)
                .for_each(|(row, gradient)| row.extend(gradient));
        }
        Ok(all)
    };
    let (coarse, finer) = rayon::join(|| numbers(at, which), || numbers(&fine, which));
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
            let (x, scene) = (at.x.clone(), at.scene.clone());
            let run = simulate(&scene.model, at.run.duration, &doubled)?;
            Evaluated { x, scene, run }
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
    let [steps, samples] = [at.run.method.order(), of_sums].map(|order| {
        let gain = 2.0_f64.powi(order as i32);
        gain / (gain - 1.0)
    });
    let mut all = Vec::new();
    let rows = which.iter().zip(coarse).zip(finer).zip(maxima);
    for (((&function, coarse), finer), maximum) in rows {
        let thinner = match summed.contains(&function) {
            true => thinner.next().unwrap_or_else(|| finer.clone()),
            // Its error is that of the steps alone.
            false if cells => coarse.clone(),
            false => finer.clone(),
        };
        let estimate = |((&h, &thin), &fine): ((&f64, &f64), &f64)| {
            let (of_steps, of_samples) = match cells {
                true => ((thin - fine) * steps, (h - thin) * samples),
                false => ((h - thin) * steps, (thin - fine) * samples),
            };
            Estimate {
                value: h,
                error: (of_steps + of_samples).abs(),
                of_steps,
                of_samples,
            }
        };
        let numbers = coarse.iter().zip(&thinner).zip(&finer);
        let mut estimates: Vec<Estimate> = numbers.map(estimate).collect();
        all.push(FunctionError {
            function,
            value: estimates.remove(0),
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

/// The settings of a run with every step halved and twice the samples.
fn halved(run: &Trajectory<f64>, (cells, summed): (bool, bool), limits: Limits) -> Settings {
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
    run.weights = quadrature::weights(&run.instants);
}

/// Steps that reach an accuracy, and their cost.
#[derive(Clone, Debug)]
pub(crate) struct Accuracy {
    /// Number of steps.
    pub steps: usize,
    /// Number of steps of equal size or tolerance, if it was refined.
    pub spacing: Option<Spacing>,
    /// Number of samples, if it was increased.
    pub samples: Option<usize>,
    /// Changes of reduced bases, as path=value.
    pub bases: Vec<String>,
    /// Estimated error reached, relative to the function.
    pub error: f64,
}

impl Accuracy {
    /// The changes of the problem file that give these steps, as path=value.
    pub(crate) fn overrides(&self) -> Vec<String> {
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

    /// The reached accuracy and the requested one.
    pub(crate) fn describe(&self, asked: f64) -> String {
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
             objective at the start {:.1e}{missed}",
            self.steps, self.error
        )
    }
}

/// Refines the steps or the samples of `problem`, whichever have too large an error, until the
/// estimated error of the function `which` at the start is below `accuracy`, relative to the
/// function. They never become coarser than the problem requests.
///
/// # Errors
/// If a simulation fails.
pub(crate) fn reach(
    problem: &mut Problem,
    which: usize,
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

/// Refines steps and samples until their estimated error is below `accuracy`, relative to the function; the error,
/// and the number of steps.
fn reach_steps(
    problem: &mut Problem,
    which: usize,
    accuracy: f64,
) -> Result<(f64, usize), IntegrationFailure> {
    let x = problem.start();
    let mut attempts = ATTEMPTS;
    loop {
        let at = bases::run(problem, &x, &[which])?;
        let value = estimate(problem, &at, &[which], false)?[0].value;
        let size = value.value.abs().max(f64::MIN_POSITIVE);
        let reached = value.error / size;
        let steps = at.run.grid.steps();
        attempts -= 1;
        let round_off = value.value.abs() <= ROUND_OFF * own_size(&at, which);
        if reached <= accuracy || attempts == 0 || round_off {
            return Ok((reached, steps));
        }
        // Each part may have half of the allowed error.
        let excess = |part: f64| 2.0 * part.abs() / (accuracy * size);
        let (of_steps, of_samples) = (excess(value.of_steps), excess(value.of_samples));
        if !refine(&mut problem.simulation, &at.run, of_steps, of_samples) {
            return Ok((reached, steps));
        }
    }
}

/// Makes reduced bases richer until their error against all nodes is below `accuracy`, relative to the function; the
/// error, and whether bases were changed. Takes all nodes if no basis does. The steps are those of the problem.
pub(crate) fn reach_bases(
    problem: &mut Problem,
    which: usize,
    accuracy: f64,
) -> Result<(f64, bool), IntegrationFailure> {
    let x = problem.start();
    let Some(all_nodes) = problem.with_all_nodes(&x) else {
        return Ok((0.0, false));
    };
    let exact = bases::run(&all_nodes, &x, &[which])?.function(which).value;
    let relative = |value: f64| (value - exact).abs() / exact.abs().max(f64::MIN_POSITIVE);
    for attempt in 0..BASES {
        let at = bases::run(problem, &x, &[which])?;
        let value = at.function(which).value;
        let error = relative(value);
        let round_off = (value - exact).abs() <= ROUND_OFF * own_size(&at, which);
        if error <= accuracy || round_off {
            return Ok((error, attempt > 0));
        }
        if let Some(richer) = problem.with_richer_bases(&x) {
            *problem = richer;
        }
    }
    if problem.simulation.method.is_none() {
        // Bodies with all nodes need a method.
        let at = bases::run(problem, &x, &[which])?;
        return Ok((relative(at.function(which).value), true));
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
