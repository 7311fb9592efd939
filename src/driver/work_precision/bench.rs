//! One run of a work-precision measurement: its error, its drift, its work and its time.

use super::clock::fastest;
use super::exact::{Reference, distance, gradient_error, positions};
use crate::adjoint;
use crate::functions::Scene;
use crate::integrate::{
    IntegrationFailure, Limits, Method, Samples, Settings, Spacing, StepSolver, Trajectory,
    simulate,
};
use crate::integration::{Integration, looks_at_the_whole};
use crate::memory;
use crate::problem::Problem;
use crate::report::PrecisionRow;
use crate::{Evaluated, Simulation};
use std::hint::black_box;

/// The scene that is run repeatedly.
pub struct Bench<'a> {
    problem: &'a Problem,
    x: &'a [f64],
    /// The scene at the design x.
    pub scene: Scene<f64>,
    function: Option<usize>,
}

impl<'a> Bench<'a> {
    /// The scene of `problem` at `x`; gradients are those of `function`.
    pub fn new(problem: &'a Problem, x: &'a [f64], function: Option<usize>) -> Self {
        Self {
            scene: problem.scene(x),
            problem,
            x,
            function,
        }
    }

    /// Limits of a simulation.
    pub fn limits(&self) -> Limits {
        self.problem.simulation.limits.clone()
    }

    /// Whether gradients are wanted.
    pub fn has_gradient(&self) -> bool {
        self.function.is_some()
    }

    /// Whether the function is a sum over the motion, so that its gradient needs samples.
    pub fn sums(&self) -> bool {
        let which: Vec<usize> = self.function.into_iter().collect();
        let of_scene = self.problem.composition.of_scene(&which);
        let mut all = of_scene.iter().map(|&f| &self.scene.functions[f]);
        all.any(looks_at_the_whole)
    }

    /// Gradient of the function in the design variables.
    ///
    /// # Errors
    /// The equations of a step are singular.
    pub fn gradient(&self, run: Trajectory<f64>) -> Result<Option<Vec<f64>>, IntegrationFailure> {
        let Some(function) = self.function else {
            return Ok(None);
        };
        let (mut found, _) = self.at(run).gradients(self.problem, &[function])?;
        Ok(found.pop())
    }

    /// The row of the runs by `method` with `spacing`; times are the least of `runs`.
    ///
    /// # Errors
    /// A simulation or a gradient fails.
    pub fn row(
        &self,
        (method, spacing): (Method, &Spacing),
        reference: &Reference,
        runs: usize,
    ) -> Result<PrecisionRow, IntegrationFailure> {
        let settings = |samples, memory| Settings {
            method,
            solver: StepSolver::suited(self.problem.simulation.solver, spacing),
            spacing: spacing.clone(),
            samples,
            limits: self.limits(),
            memory,
            derivatives: reference.gradient.is_some(),
        };
        let (model, duration) = (&self.scene.model, self.scene.duration);
        let with_gradient = reference.gradient.is_some();
        let memory = memory::for_gradients(self.problem.simulation.memory);
        let history = simulate(
            model,
            duration,
            &settings(Samples::StepEnds, if with_gradient { memory } else { 0 }),
        )?;
        let error = distance(&reference.positions, &positions(&history));
        let counts = history.counts;
        let summed = self.sums() && matches!(spacing, Spacing::Tolerance(_));
        let (drift, history) = self.drift(history);

        let bare = settings(Samples::Uniform(1), 0);
        let cpu_seconds = fastest(runs, || {
            simulate(model, duration, &bare).map(|run| {
                black_box(run);
            })
        })?;
        let mut row = PrecisionRow {
            method: method.name(),
            order: method.order(),
            step: None,
            tolerance: None,
            error,
            gradient_error: None,
            energy_drift: drift[0],
            position_drift: drift[1],
            velocity_drift: drift[2],
            counts,
            cpu_seconds,
            gradient_cpu_seconds: None,
        };
        match spacing {
            Spacing::Steps(steps) => row.step = Some(duration / *steps as f64),
            Spacing::Tolerance(tolerance) => row.tolerance = Some(*tolerance),
            Spacing::Frozen(_) => {}
        }
        if let (Some(exact), Some(function)) = (&reference.gradient, self.function) {
            let run = match summed {
                // Sampled as in an optimisation.
                true => {
                    let asked = [function];
                    let integration =
                        Integration::new(self.problem, &self.scene, Some(&asked), true);
                    let samples = integration.samples();
                    simulate(model, duration, &settings(samples, memory))?
                }
                false => history,
            };
            let of_scene = self.problem.composition.of_scene(&[function]).into_owned();
            row.gradient_cpu_seconds = Some(fastest(runs, || {
                adjoint::gradients(&self.scene, &run, &of_scene).map(|found| {
                    black_box(found);
                })
            })?);
            row.gradient_error = self
                .gradient(run)?
                .map(|found| gradient_error(&found, exact));
        }
        Ok(row)
    }

    /// Largest drift of energy \[J\], position and velocity constraints over a run.
    fn drift(&self, run: Trajectory<f64>) -> ([f64; 3], Trajectory<f64>) {
        let seen = Simulation::of(self.problem, self.at(run));
        let (position, velocity) = seen.constraint_drift();
        ([seen.energy_drift(), position, velocity], seen.at.run)
    }

    fn at(&self, run: Trajectory<f64>) -> Evaluated {
        Evaluated {
            x: self.x.to_vec(),
            scene: self.scene.clone(),
            run,
            composition: self.problem.composition.clone(),
        }
    }
}
