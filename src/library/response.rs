//! A simulated motion: histories, and the pull-back of functions of histories to the design.

use super::SimulationError;
use crate::adjoint::WeightedHistories;
use crate::driver::integration::Integration;
use crate::driver::{AnalysisFailure, Evaluated, resolved};
use crate::functions::Scene;
use crate::functions::histories::{Readings, history};
use crate::integrate::{Trajectory, WorkCounts};
use crate::problem::Problem;
use crate::system::observe::Observation;
use std::sync::{Arc, OnceLock};

/// Instants may lie outside of a motion by this part of its duration, which is round-off.
pub(super) const ROUND_OFF: f64 = 1e-12;

/// Simulates the design `x`: one number per variable, in the units of the problem file.
///
/// # Errors
/// The joints cannot be closed, the motion cannot be integrated to its end, or the problem is one of
/// structures without a motion.
pub fn simulate(problem: &Problem, x: &[f64]) -> Result<Motion, SimulationError> {
    has_one_motion(problem)?;
    let mut integration = Integration::of(problem, None, false);
    let found = Evaluated::with(&mut integration, problem, x);
    let (evaluated, _) = found.map_err(AnalysisFailure::from)?;
    Ok(Motion::new(Arc::new(problem.clone()), evaluated))
}

/// Refuses a problem of structures, and one of several cases.
pub(super) fn has_one_motion(problem: &Problem) -> Result<(), SimulationError> {
    if problem.cases.is_some() {
        return Err(AnalysisFailure::SeveralCases.into());
    }
    if problem.statics.is_some() {
        return Err(AnalysisFailure::NoMotion.into());
    }
    Ok(())
}

fn is_inside(fraction: f64) -> bool {
    (-ROUND_OFF..=1.0 + ROUND_OFF).contains(&fraction)
}

/// The motion of a design at some instants.
pub struct Motion {
    pub(super) problem: Arc<Problem>,
    pub(super) at: Evaluated,
    /// The instants as fractions of the duration, and as sums of samples.
    pub(super) fractions: Vec<f64>,
    pub(super) readings: Readings,
    /// Whether the instants keep their time where the duration changes; else they keep their fraction of it.
    are_fixed: bool,
    pub(super) whole: OnceLock<Whole>,
}

/// The scene as it is written, and the motion of all its bodies if some were merged or left out.
pub(super) struct Whole {
    pub(super) scene: Scene<f64>,
    pub(super) motion: Option<(Trajectory<f64>, Readings)>,
    pub(super) observations: OnceLock<Vec<Observation>>,
}

/// Derivatives of a function of histories by the histories: weights at each instant of
/// [`Motion::times`].
#[derive(Clone, Debug, Default)]
pub struct Cotangents {
    /// Pairs of a function with a history, and the weights of its quantity.
    pub functions: Vec<(usize, Vec<f64>)>,
    /// Weights of the instants themselves; empty for none. They move only where the duration depends on
    /// the design.
    pub times: Vec<f64>,
}

impl Motion {
    /// A motion at the instants of tables and figures.
    pub(super) fn new(problem: Arc<Problem>, at: Evaluated) -> Self {
        let run = &at.run;
        let shown = run.shown().into_iter().map(|k| run.instants[k]);
        Self {
            fractions: shown.collect(),
            readings: Readings::shown(run),
            are_fixed: false,
            problem,
            at,
            whole: OnceLock::new(),
        }
    }

    /// The same motion at these instants \[s\]. They are fixed: where the duration depends on the design,
    /// derivatives are those at these times.
    ///
    /// # Errors
    /// An instant is not between 0 and the end.
    pub fn at_times(self, times: &[f64]) -> Result<Self, String> {
        let end = self.at.run.duration;
        let fractions: Vec<f64> = times.iter().map(|time| time / end).collect();
        let wrong = times.iter().zip(&fractions);
        match wrong.into_iter().find(|(_, part)| !is_inside(**part)) {
            None => Ok(self.read(fractions, true)),
            Some((time, _)) => Err(format!(
                "found the instant {time} s, expected one between 0 and the end of the motion, {end} s"
            )),
        }
    }

    /// The same motion at instants at these fractions of the duration, which they keep where it depends on the design.
    ///
    /// # Errors
    /// A fraction is not between 0 and 1.
    pub fn at_fractions(self, fractions: &[f64]) -> Result<Self, String> {
        match fractions.iter().find(|part| !is_inside(**part)) {
            None => Ok(self.read(fractions.to_vec(), false)),
            Some(part) => Err(format!(
                "found the fraction {part}, expected one between 0 and 1"
            )),
        }
    }

    fn read(mut self, mut fractions: Vec<f64>, are_fixed: bool) -> Self {
        for part in &mut fractions {
            *part = part.clamp(0.0, 1.0);
        }
        self.readings = Readings::at(&self.at.run, &fractions);
        (self.fractions, self.are_fixed, self.whole) = (fractions, are_fixed, OnceLock::new());
        self
    }

    /// Instants \[s\]: those that were requested, or from 0 to the end of the motion.
    pub fn times(&self) -> Vec<f64> {
        let run = &self.at.run;
        let time = |&at: &f64| run.grid.time(run.duration, at);
        self.fractions.iter().map(time).collect()
    }

    /// End of the motion \[s\].
    pub fn duration(&self) -> f64 {
        self.at.run.duration
    }

    /// Name of the method.
    pub fn method(&self) -> String {
        self.at.run.method.name()
    }

    /// Value of every function, in the order of [`Problem::functions`].
    pub fn values(&self) -> Vec<f64> {
        let count = self.problem.function_names.len();
        (0..count).map(|f| self.at.value(f)).collect()
    }

    /// Exact gradients of the functions with the indices `which`, on the steps of this motion.
    ///
    /// # Errors
    /// The equations of a step are singular.
    pub fn gradients(&self, which: &[usize]) -> Result<Vec<Vec<f64>>, SimulationError> {
        let found = self.at.gradients(&self.problem, which);
        Ok(found.map_err(AnalysisFailure::from)?.0)
    }

    /// The quantity that the function with this index reduces, at every instant; `None` for functions that
    /// reduce none, such as a duration, a mass or a clearance.
    pub fn history(&self, function: usize) -> Option<Vec<f64>> {
        let samples = self.samples(function)?;
        Some(self.readings.values(&samples))
    }

    /// Largest estimated error of [`Motion::history`] by the polynomials between the samples; zero at samples.
    pub fn history_error(&self, function: usize) -> Option<f64> {
        let samples = self.samples(function)?;
        Some(self.readings.error(&samples))
    }

    fn samples(&self, function: usize) -> Option<Vec<f64>> {
        let scene = &self.at.scene;
        history(scene.functions.get(function)?, &scene.model, &self.at.run)
    }

    /// Exact derivatives of functions of histories by the design, from their cotangents w: one row of
    /// Σ w_k dg(t_k)/dx for each of `all`, in one backward march of the discrete adjoint. Where the duration depends
    /// on the design, instants of [`Motion::at_times`] keep their time, others their fraction of it. With t = s T of
    /// the part of the motion that moves, a fixed time has ds/dT = −(dt/dT)/T.
    ///
    /// # Errors
    /// The equations of a step are singular; a function has no history; or a list has another length than
    /// [`Motion::times`].
    pub fn pull_back(&self, all: &[Cotangents]) -> Result<Vec<Vec<f64>>, SimulationError> {
        let undefined = |what: String| SimulationError::from(AnalysisFailure::Undefined(what));
        let spread = |name: &str, weights: &[f64]| match weights.len() == self.readings.count() {
            true => Ok(self.readings.spread(weights)),
            false => Err(undefined(format!(
                "found {} weights of \"{name}\", expected one for each of {} instants",
                weights.len(),
                self.readings.count()
            ))),
        };
        let weighted = |own: &Cotangents| -> Result<WeightedHistories, SimulationError> {
            let mut functions = Vec::with_capacity(own.functions.len());
            for (f, weights) in &own.functions {
                let function = self.at.scene.functions.get(*f);
                let name = self.problem.function_names.get(*f);
                let name = name.map_or("?", String::as_str);
                if function.and_then(|function| function.instant()).is_none() {
                    return Err(undefined(format!("the function \"{name}\" has no history")));
                }
                if let Some(why) = self.at.no_derivative_of_history(&self.problem, *f) {
                    return Err(undefined(why));
                }
                functions.push((*f, spread(name, weights)?));
            }
            let mut times = match own.times.is_empty() || self.are_fixed {
                true => Vec::new(),
                false => spread("time", &own.times)?,
            };
            if self.are_fixed {
                times = vec![0.0; self.at.run.last() + 1];
                for (f, weights) in &own.functions {
                    self.hold_times(*f, weights, &mut times);
                }
            }
            Ok(WeightedHistories { functions, times })
        };
        let all = all.iter().map(weighted).collect::<Result<_, _>>()?;
        let found = self.at.pull_back(&self.problem, all);
        let found = found.map_err(AnalysisFailure::from)?;
        match found.iter().flatten().all(|d| d.is_finite()) {
            true => Ok(found),
            false => Err(undefined(
                "a derivative of the function of histories is not finite".to_owned(),
            )),
        }
    }

    /// Adds the weights of samples' instants by which the readings of a function keep their time.
    fn hold_times(&self, function: usize, weights: &[f64], times: &mut [f64]) {
        let Some(samples) = self.samples(function) else {
            return;
        };
        let slopes = self.readings.slopes(&samples);
        let by_time = weights.iter().zip(slopes);
        let by_time: Vec<f64> = by_time
            .map(|(w, slope)| -w * slope / self.at.run.duration)
            .collect();
        for (sum, by) in times.iter_mut().zip(self.readings.spread(&by_time)) {
            *sum += by;
        }
    }

    /// Why derivatives of the functions `which` mean nothing, if so: the time steps do not resolve them.
    ///
    /// # Errors
    /// The equations of a step are singular.
    pub fn unresolved(&self, which: &[usize]) -> Result<Option<String>, SimulationError> {
        let gradients = self.gradients(which)?;
        let found = resolved::of_gradients(&self.problem, &self.at, which, &gradients);
        // Where the finer run fails this cannot be judged.
        Ok(found
            .ok()
            .and_then(|own| resolved::refusal(&self.problem, &own)))
    }

    /// Work of the simulation.
    pub fn work(&self) -> WorkCounts {
        self.at.run.counts
    }
}
