//! The discretisation error of functions and gradients, by cutting every step in two.
//!
//! With f_h the value on the steps in use and f_{h/2} that on steps of half the size, of a method of
//! order m,
//!
//! ```text
//! f_h − f ≈ (f_h − f_{h/2}) 2ᵐ / (2ᵐ − 1)
//! ```
//!
//! (Richardson). Samples are doubled as well, so that the error of sums over the motion, of order
//! 2, is seen; the smaller order is taken.

use super::evaluate::Evaluated;
use super::integration::{Integration, looks_at_the_whole};
use crate::integrate::{IntegrationFailure, Samples, Settings, Spacing, Trajectory, simulate};
use crate::problem::Problem;

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
    let run = simulate(&at.scene.model, at.scene.duration, &halved(&at.run))?;
    let fine = Evaluated {
        x: at.x.clone(),
        scene: at.scene.clone(),
        run,
    };
    let derivatives = |of: &Evaluated| -> Result<Vec<Vec<f64>>, IntegrationFailure> {
        match gradients {
            true => Ok(of.gradients(problem, which)?.0),
            false => Ok(vec![Vec::new(); which.len()]),
        }
    };
    let (coarse_gradients, fine_gradients) = (derivatives(at)?, derivatives(&fine)?);
    let all = which
        .iter()
        .zip(coarse_gradients.iter().zip(&fine_gradients));
    Ok(all
        .map(|(&function, (coarse, finer))| {
            let order = match looks_at_the_whole(&at.scene.functions[function]) {
                true => at.run.method.order().min(SUMS),
                false => at.run.method.order(),
            };
            let gain = 2.0_f64.powi(order as i32);
            let compare = |value: f64, fine: f64| Estimate {
                value,
                error: (value - fine).abs() * gain / (gain - 1.0),
            };
            let value = compare(at.function(function).value, fine.function(function).value);
            let pairs = coarse.iter().zip(finer);
            FunctionError {
                function,
                value,
                gradient: pairs.map(|(&value, &fine)| compare(value, fine)).collect(),
            }
        })
        .collect())
}

/// The settings of a run with every step cut in two and twice the samples.
fn halved(run: &Trajectory<f64>) -> Settings {
    let instants = run.last();
    let samples = if run.instants == run.grid.ends() {
        Samples::StepEnds
    } else if instants == 1 {
        Samples::Uniform(1)
    } else {
        Samples::Uniform(2 * instants)
    };
    Settings {
        method: run.method,
        spacing: Spacing::Frozen(run.grid.halved()),
        samples,
        keep_stages: false,
    }
}

/// Steps that reach an accuracy, and what they cost.
#[derive(Clone, Debug)]
pub struct Accuracy {
    /// Number of steps.
    pub steps: usize,
    /// Tolerance of the steps, if they follow one.
    pub tolerance: Option<f64>,
    /// Number of samples, if they were increased.
    pub samples: Option<usize>,
    /// Estimated error reached, relative to the function.
    pub error: f64,
}

impl Accuracy {
    /// The changes of the problem file that make these steps, as path=value.
    pub fn overrides(&self) -> Vec<String> {
        let mut all = match self.tolerance {
            Some(tolerance) => vec![format!("/simulation/tolerance={tolerance:e}")],
            None => vec![format!("/simulation/steps={}", self.steps)],
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
        let tolerance = self.tolerance.map_or_else(String::new, |tolerance| {
            format!(", tolerance {tolerance:.1e}")
        });
        format!(
            "accuracy {asked:.1e}: {} steps{tolerance}; estimated relative error of the objective \
             at the start {:.1e}{missed}",
            self.steps, self.error
        )
    }
}

/// Changes the steps of `problem` until the estimated error of the function `which` at its start is
/// below `accuracy`, relative to the function.
///
/// # Errors
/// If a simulation fails.
pub fn reach(
    problem: &mut Problem,
    which: usize,
    accuracy: f64,
) -> Result<Accuracy, IntegrationFailure> {
    let x = problem.start();
    let mut reached = f64::INFINITY;
    let mut steps = 0;
    for _ in 0..ATTEMPTS {
        let scene = problem.scene(&x);
        let mut integration = Integration::new(problem, &scene, false, false);
        let (at, _) = Evaluated::with(&mut integration, problem, &x)?;
        let found = estimate(problem, &at, &[which], false)?;
        let value = found[0].value;
        reached = value.error / value.value.abs().max(f64::MIN_POSITIVE);
        steps = at.run.grid.steps();
        if reached <= accuracy {
            break;
        }
        // Half of the excess may be the sums' and half the steps': refine both.
        let order = at.run.method.order();
        let summed = looks_at_the_whole(&at.scene.functions[which]);
        let gain = (2.0 * reached / accuracy).max(2.0);
        let simulation = &mut problem.simulation;
        match &mut simulation.spacing {
            Spacing::Tolerance(tolerance) => {
                if *tolerance <= FINEST.0 && !summed {
                    break;
                }
                *tolerance = (*tolerance / gain).max(FINEST.0);
            }
            Spacing::Steps(count) => {
                let order = if summed { order.min(SUMS) } else { order };
                let more = gain.powf(1.0 / order as f64);
                let next = (*count as f64 * more).ceil() as usize;
                if *count >= FINEST.1 {
                    break;
                }
                *count = next.min(FINEST.1);
            }
            Spacing::Frozen(_) => break,
        }
        let between = !matches!(simulation.spacing, Spacing::Steps(_));
        if summed && (between || simulation.samples.is_some()) {
            let more = gain.sqrt().min(8.0);
            let next = (at.run.last() as f64 * more).ceil() as usize;
            simulation.samples = Some(next.min(FINEST.1));
        }
    }
    let simulation = &problem.simulation;
    Ok(Accuracy {
        steps,
        tolerance: match simulation.spacing {
            Spacing::Tolerance(tolerance) => Some(tolerance),
            _ => None,
        },
        samples: simulation.samples,
        error: reached,
    })
}
