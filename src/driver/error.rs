//! The discretisation error of functions and gradients, by cutting every step in two.
//!
//! With f_{h,n} the value on the steps in use and n samples, f_{h/2,2n} that on steps of half the size
//! and twice the samples, and f_{h/2,n} that of the same run at every second sample, of a method of
//! order m,
//!
//! ```text
//! f_{h,n} − f ≈ (f_{h,n} − f_{h/2,n}) 2ᵐ / (2ᵐ − 1) + (f_{h/2,n} − f_{h/2,2n}) 2² / (2² − 1)
//! ```
//!
//! (Richardson): the first term is the error of the steps, the second that of sums over the motion,
//! which are of order 2. Where a function looks at the end alone there is no second term. Told apart,
//! the two may be of any size and sign.

use super::evaluate::Evaluated;
use super::event::{self, Admit};
use super::integration::{Integration, looks_at_the_whole};
use crate::integrate::{IntegrationFailure, Limits, Samples, Settings, Spacing, Trajectory};
use crate::problem::{Problem, Simulation};

/// Order of the trapezoidal rule, by which functions sum over the motion.
const SUMS: usize = 2;
/// Most attempts to reach an accuracy.
const ATTEMPTS: usize = 12;
/// Smallest tolerance and largest number of steps that are tried.
const FINEST: (f64, usize) = (1e-14, 10_000_000);

/// A number with its estimated error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The number on the steps in use.
    pub value: f64,
    /// Its estimated error, absolute.
    pub error: f64,
    /// The part of the steps in it, with its sign.
    pub of_steps: f64,
    /// The part of the samples in it, with its sign.
    pub of_samples: f64,
}

/// A function's value and, if asked for, its gradient in the design variables.
#[derive(Clone, Debug, PartialEq)]
pub struct FunctionError {
    /// The function, by index.
    pub function: usize,
    /// Its value.
    pub value: Estimate,
    /// Its derivatives in the variables; empty if they were not asked for.
    pub gradient: Vec<Estimate>,
}

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
    let sums = |f: &usize| looks_at_the_whole(&at.scene.functions[*f]);
    let limits = problem.simulation.limits.clone();
    let finer = halved(&at.run, which.iter().any(sums), limits);
    let mut scene = at.scene.clone();
    let run = event::settle(&mut scene, &finer, at.run.duration, Admit::Late)?;
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
    let summed: Vec<usize> = which.iter().copied().filter(sums).collect();
    let doubled = fine.run.last() == 2 * at.run.last();
    if doubled {
        thin(&mut fine.run);
    }
    let mut thinner = numbers(&fine, &summed)?.into_iter();
    let [steps, samples] = [at.run.method.order(), SUMS].map(|order| {
        let gain = 2.0_f64.powi(order as i32);
        gain / (gain - 1.0)
    });
    let mut all = Vec::new();
    for ((&function, coarse), finer) in which.iter().zip(coarse).zip(finer) {
        let thinner = match summed.contains(&function) {
            true => thinner.next().unwrap_or_else(|| finer.clone()),
            false => finer.clone(),
        };
        let estimate = |((&h, &thin), &fine): ((&f64, &f64), &f64)| {
            let (of_steps, of_samples) = ((h - thin) * steps, (thin - fine) * samples);
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
            gradient: estimates,
        });
    }
    Ok(all)
}

/// The settings of a run with every step cut in two and twice the samples.
fn halved(run: &Trajectory<f64>, summed: bool, limits: Limits) -> Settings {
    let instants = run.last();
    let samples = if run.instants == run.grid.ends() {
        Samples::StepEnds
    } else if instants == 1 && !summed {
        Samples::Uniform(1)
    } else {
        Samples::Uniform(2 * instants)
    };
    Settings {
        method: run.method,
        spacing: Spacing::Frozen(run.grid.halved()),
        samples,
        keep_stages: false,
        limits,
    }
}

/// Leaves every second sample of a run.
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
}

/// Steps that reach an accuracy, and what they cost.
#[derive(Clone, Debug)]
pub struct Accuracy {
    /// Number of steps.
    pub steps: usize,
    /// Number of steps of equal size or tolerance, if it was refined.
    pub spacing: Option<Spacing>,
    /// Number of samples, if it was increased.
    pub samples: Option<usize>,
    /// Estimated error reached, relative to the function.
    pub error: f64,
}

impl Accuracy {
    /// The changes of the problem file that make these steps, as path=value.
    pub fn overrides(&self) -> Vec<String> {
        let mut all = match self.spacing {
            Some(Spacing::Tolerance(tolerance)) => {
                vec![format!("/simulation/tolerance={tolerance:e}")]
            }
            Some(Spacing::Steps(steps)) => vec![format!("/simulation/steps={steps}")],
            Some(Spacing::Frozen(_)) | None => Vec::new(),
        };
        all.extend((self.samples).map(|samples| format!("/simulation/samples={samples}")));
        all
    }

    /// What was reached of the accuracy that was asked for.
    pub fn describe(&self, asked: f64) -> String {
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
        format!(
            "accuracy {asked:.1e}: {} steps{refined}{samples}; estimated relative error of the \
             objective at the start {:.1e}{missed}",
            self.steps, self.error
        )
    }
}

/// Refines the steps or the samples of `problem`, whichever err too much, until the estimated error
/// of the function `which` at its start is below `accuracy`, relative to the function. They get no
/// coarser than the problem asks for.
///
/// # Errors
/// If a simulation fails.
pub fn reach(
    problem: &mut Problem,
    which: usize,
    accuracy: f64,
) -> Result<Accuracy, IntegrationFailure> {
    let x = problem.start();
    let asked = problem.simulation.clone();
    let mut attempts = ATTEMPTS;
    let (error, steps) = loop {
        let scene = problem.scene(&x);
        let mut integration = Integration::new(problem, &scene, Some(&[which]), false);
        let (at, _) = Evaluated::with(&mut integration, problem, &x)?;
        let value = estimate(problem, &at, &[which], false)?[0].value;
        let size = value.value.abs().max(f64::MIN_POSITIVE);
        let reached = value.error / size;
        attempts -= 1;
        if reached <= accuracy || attempts == 0 {
            break (reached, at.run.grid.steps());
        }
        // Either part may have half of what is allowed.
        let excess = |part: f64| 2.0 * part.abs() / (accuracy * size);
        let (of_steps, of_samples) = (excess(value.of_steps), excess(value.of_samples));
        if !refine(&mut problem.simulation, &at.run, of_steps, of_samples) {
            break (reached, at.run.grid.steps());
        }
    };
    let now = &problem.simulation;
    Ok(Accuracy {
        steps,
        spacing: (now.spacing != asked.spacing).then(|| now.spacing.clone()),
        samples: now.samples.filter(|_| now.samples != asked.samples),
        error,
    })
}

/// Refines steps and samples that err by so many times what is allowed, if more than once; `false` if
/// nothing can be refined.
fn refine(
    simulation: &mut Simulation,
    run: &Trajectory<f64>,
    of_steps: f64,
    of_samples: f64,
) -> bool {
    let before = simulation.clone();
    let more_samples = of_samples.sqrt().clamp(2.0_f64.sqrt(), 8.0);
    // Methods of equal steps are sampled at their ends.
    let apart = run.method.is_adaptive();
    if of_samples > 1.0 && apart {
        let next = (run.last() as f64 * more_samples).ceil() as usize;
        simulation.samples = Some(next.min(FINEST.1));
    }
    match &mut simulation.spacing {
        Spacing::Tolerance(tolerance) if of_steps > 1.0 => {
            *tolerance = (*tolerance / of_steps.max(2.0)).max(FINEST.0);
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
