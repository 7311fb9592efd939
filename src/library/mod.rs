//! The public interface: simulate a design, compute its functions and exact gradients, check them,
//! and find the best design.
//!
//! These types hide the integration of a scene, so that they can stay the same when it changes.
//! Bindings to other languages use only them.

use crate::driver::integration::Integration;
use crate::driver::{self, Analysed, AnalysisFailure, KnownEvaluations, Simulation};
use crate::problem::Problem;
use crate::report::optimum::Optimum as Record;
use std::ops::ControlFlow;

pub use crate::driver::CheckedDerivative;
pub(crate) use crate::integrate::WorkCounts;

/// The reason why a design could not be simulated or differentiated, with time and place.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error(transparent)]
pub struct SimulationError(#[from] AnalysisFailure);

/// Simulates the design `x`: one number per variable, in the units of the problem file.
///
/// # Errors
/// The joints cannot be closed, the motion cannot be integrated to its end, or the problem is one of
/// structures without a motion.
pub fn simulate(problem: &Problem, x: &[f64]) -> Result<Motion, SimulationError> {
    if problem.statics.is_some() {
        return Err(AnalysisFailure::NoMotion.into());
    }
    let simulation = driver::simulate(problem, x).map_err(AnalysisFailure::from)?;
    Ok(Motion { simulation })
}

/// The motion of a design at its sampled instants.
pub struct Motion {
    simulation: Simulation,
}

/// Position and velocity of a body at one instant, in ground axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyState {
    /// Centre of mass \[m\].
    pub position: [f64; 3],
    /// Euler parameters of the rotation from body axes to ground axes; the real part comes first.
    pub orientation: [f64; 4],
    /// Velocity of the centre of mass \[m/s\].
    pub velocity: [f64; 3],
    /// Angular velocity \[rad/s\].
    pub angular_velocity: [f64; 3],
}

impl Motion {
    /// Sampled instants \[s\], from 0 to the end of the motion.
    pub fn times(&self) -> Vec<f64> {
        let run = self.simulation.motion();
        (0..=run.last()).map(|k| run.time(k)).collect()
    }

    /// State of a body at the instant `k` of [`Motion::times`]. `None` if there is no such body or
    /// instant.
    pub fn body(&self, name: &str, k: usize) -> Option<BodyState> {
        let bodies = &self.simulation.written.model.bodies;
        let run = self.simulation.motion();
        let index = bodies.iter().position(|body| body.name == name)?;
        if k > run.last() {
            return None;
        }
        let q = &run.q(k)[run.numbering.position(index)..];
        let v = &run.v(k)[run.numbering.velocity(index)..];
        Some(BodyState {
            position: [q[0], q[1], q[2]],
            orientation: [q[3], q[4], q[5], q[6]],
            velocity: [v[0], v[1], v[2]],
            angular_velocity: [v[3], v[4], v[5]],
        })
    }

    /// Value of every function, in the order of [`Problem::functions`].
    pub fn values(&self) -> Vec<f64> {
        let at = &self.simulation.at;
        let count = at.scene.functions.len();
        (0..count).map(|f| at.function(f).value).collect()
    }

    /// Largest |E(t) − E(0)| of kinetic and potential energy \[J\].
    pub fn energy_drift(&self) -> f64 {
        self.simulation.energy_drift()
    }

    /// Largest violation of a position constraint \[m or 1\] and of a velocity constraint \[m/s or
    /// rad/s\].
    pub fn constraint_drift(&self) -> (f64, f64) {
        self.simulation.constraint_drift()
    }

    /// Work of the simulation.
    pub fn work(&self) -> WorkCounts {
        self.simulation.at.run.counts
    }
}

/// Simulates consecutive designs and differentiates them.
///
/// It keeps the time steps from design to design. So values are smooth in the design, and gradients
/// are exact. It chooses new steps if their error has grown.
pub struct Analysis<'a> {
    problem: &'a Problem,
    integration: Integration,
}

impl<'a> Analysis<'a> {
    /// An analysis of all functions of `problem`.
    pub fn new(problem: &'a Problem) -> Self {
        let integration = Integration::of(problem, None, true);
        Self {
            problem,
            integration,
        }
    }

    /// Simulates the design `x`: one number per variable.
    ///
    /// # Errors
    /// The joints cannot be closed, or the motion cannot be integrated to its end.
    pub fn at(&mut self, x: &[f64]) -> Result<Design<'a>, SimulationError> {
        let all: Vec<usize> = (0..self.problem.functions().len()).collect();
        let found = Analysed::with(&mut self.integration, self.problem, x, &all);
        let (evaluated, _) = found?;
        Ok(Design {
            problem: self.problem,
            evaluated,
        })
    }
}

/// A simulated design, with values and gradients.
pub struct Design<'a> {
    problem: &'a Problem,
    evaluated: Analysed,
}

impl Design<'_> {
    /// Value of every function, in the order of [`Problem::functions`].
    pub fn values(&self) -> Vec<f64> {
        let count = self.problem.functions().len();
        (0..count).map(|f| self.evaluated.value(f)).collect()
    }

    /// Exact gradients of the functions with the indices `which`: one row per function, one number
    /// per variable. The discrete adjoint of the time integration computes them in one backward
    /// march.
    ///
    /// # Errors
    /// The equations of a step are singular.
    pub fn gradients(&self, which: &[usize]) -> Result<Vec<Vec<f64>>, SimulationError> {
        Ok(self.gradients_and_work(which)?.0)
    }

    /// [`Design::gradients`], and their work.
    ///
    /// # Errors
    /// The equations of a step are singular.
    pub fn gradients_and_work(
        &self,
        which: &[usize],
    ) -> Result<(Vec<Vec<f64>>, WorkCounts), SimulationError> {
        Ok(self.evaluated.gradients(self.problem, which)?)
    }

    /// Work of the simulation.
    pub fn work(&self) -> WorkCounts {
        self.evaluated.counts()
    }
}

/// Compares every derivative at the design `x` by the adjoint with the complex step.
///
/// # Errors
/// A simulation fails.
pub fn check(problem: &Problem, x: &[f64]) -> Result<Vec<CheckedDerivative>, SimulationError> {
    Ok(driver::check(problem, x)?)
}

/// One iteration of an optimisation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Iteration {
    /// Its number, from 0 at the start.
    pub number: usize,
    /// Simulations so far.
    pub evaluations: usize,
    /// The objective in the user's sense.
    pub objective: f64,
    /// Largest violation of a constraint, in its unit.
    pub infeasibility: f64,
    /// Largest residual of the optimality conditions, scaled.
    pub optimality: f64,
}

/// Finds the best design from the problem's start. It calls `progress` at every iteration, which
/// may stop the run. `None` if the problem has no variables, or neither objective nor constraints.
pub fn optimise(
    problem: &Problem,
    progress: &mut dyn FnMut(Iteration) -> ControlFlow<()>,
) -> Option<Optimum> {
    let mut seen = |history: &crate::report::history::History| match history.rows.last() {
        None => ControlFlow::Continue(()),
        Some(row) => progress(Iteration {
            number: row.iteration,
            evaluations: row.evaluations,
            objective: row.objective,
            infeasibility: row.infeasibility,
            optimality: row.optimality,
        }),
    };
    let found = driver::optimise(problem, "", None, KnownEvaluations::default(), &mut seen)?;
    Some(Optimum {
        record: found.optimum,
    })
}

/// The end of an optimisation.
pub struct Optimum {
    record: Record,
}

impl Optimum {
    /// Whether the first-order conditions hold to the tolerances.
    pub fn converged(&self) -> bool {
        self.record.status == "converged"
    }

    /// The end of the run: a word such as `converged`, and a sentence.
    pub fn status(&self) -> (&str, &str) {
        (&self.record.status, &self.record.message)
    }

    /// The objective in the user's sense.
    pub fn objective(&self) -> f64 {
        self.record.objective.value
    }

    /// The design: one number per variable.
    pub fn design(&self) -> Vec<f64> {
        self.record.design.values().map(|own| own.value).collect()
    }

    /// The whole record, as the command writes it to `optimum.json`; `None` if it contains a number
    /// that is not finite.
    pub fn to_json(&self) -> Option<String> {
        self.record.to_json().ok()
    }
}
