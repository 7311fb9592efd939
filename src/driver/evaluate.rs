//! Functions and gradients of a problem at a design: one simulation, one backward march.

use super::integration::{Integration, Refresh};
use crate::adjoint;
use crate::functions::rest::passes_rest;
use crate::functions::{Scene, evaluate};
use crate::integrate::{
    IntegrationFailure, Samples, Settings, Trajectory, WorkCounts, simulate_by,
};
use crate::math::{Dual, Parameters};
use crate::model::RigidBody;
use crate::model::flexible::FlexibleBody;
use crate::problem::{Focus, Problem};
use std::borrow::Cow;

/// A design that was simulated.
pub(crate) struct Evaluated {
    /// The design.
    pub x: Vec<f64>,
    /// The scene there.
    pub scene: Scene<f64>,
    /// Its motion.
    pub run: Trajectory<f64>,
}

impl Evaluated {
    /// Simulates the design `x`; the whole motion is sampled.
    ///
    /// # Errors
    /// If the simulation fails.
    #[cfg(test)]
    pub fn new(problem: &Problem, x: &[f64]) -> Result<Self, IntegrationFailure> {
        let mut integration = Integration::new(problem, &problem.scene(x), None, true);
        Ok(Self::with(&mut integration, problem, x)?.0)
    }

    /// Simulates the design `x` with the steps in use; also says if these changed.
    ///
    /// # Errors
    /// If the simulation fails.
    pub(crate) fn with(
        integration: &mut Integration,
        problem: &Problem,
        x: &[f64],
    ) -> Result<(Self, Option<Refresh>), IntegrationFailure> {
        let mut scene = problem.unlowered_scene::<f64>(x);
        // Coordinates and points of flexible bodies have no mass of their own.
        let model = &scene.model;
        let tolerance = problem.input_tolerance();
        let not_solid = |(k, body): &(usize, &RigidBody<f64>)| {
            let frame = |flexible: &FlexibleBody<f64>| flexible.frame == *k;
            let own = !model.is_of_flexible(*k) || model.flexible.iter().any(frame);
            own && !body.is_solid(tolerance)
        };
        if let Some((_, body)) = model.bodies.iter().enumerate().find(not_solid) {
            return Err(IntegrationFailure::Unphysical {
                body: body.name.clone(),
            });
        }
        if let Some((body, fault)) = problem.impossible_section(x) {
            let fault = fault.to_string();
            return Err(IntegrationFailure::Section { body, fault });
        }
        integration.unlowered += usize::from(!problem.lower(&mut scene));
        let (run, refresh) = integration.simulate(&mut scene)?;
        let x = x.to_vec();
        Ok((Self { x, scene, run }, refresh))
    }

    /// The scene as it is written, and the motion of all its bodies. Bodies that no function
    /// observes are simulated for it; if that fails, they rest.
    pub(crate) fn written(&self, problem: &Problem) -> (Scene<f64>, Cow<'_, Trajectory<f64>>) {
        if let Some(whole) = problem.whole() {
            let (scene, run) = self.whole(problem, &whole);
            return (scene, Cow::Owned(run));
        }
        self.written_of_seen(problem)
    }

    /// The whole scene and its motion, with steps of its own.
    fn whole(&self, problem: &Problem, whole: &Problem) -> (Scene<f64>, Trajectory<f64>) {
        let written = whole.unlowered_scene::<f64>(&self.x);
        let mut scene = written.clone();
        whole.lower(&mut scene);
        let settings = Settings {
            spacing: whole.simulation.spacing.clone(),
            samples: match self.run.instants == self.run.grid.ends() {
                true => Samples::StepEnds,
                false => Samples::Uniform(self.run.last()),
            },
            limits: whole.simulation.limits.clone(),
            solver: whole.simulation.solver,
            ..Settings::steps(self.run.method, 1)
        };
        let method = whole.simulation.method;
        let run = match simulate_by(&scene.model, self.run.duration, method, &settings) {
            Ok(chosen) => {
                let lowering = whole.lowering.as_ref();
                let admitted = lowering.filter(|own| own.apply(&mut written.clone()));
                let all = admitted.and_then(|own| own.expand(&written.model, &chosen.run));
                all.unwrap_or(chosen.run)
            }
            Err(_) => {
                let (_, seen) = self.written_of_seen(problem);
                let rest = |focus: &Focus| focus.seen.at_rest(&written.model, &seen);
                (problem.focus.as_ref()).map_or_else(|| self.run.clone(), rest)
            }
        };
        (written, run)
    }

    fn written_of_seen(&self, problem: &Problem) -> (Scene<f64>, Cow<'_, Trajectory<f64>>) {
        let written = problem.unlowered_scene(&self.x);
        let lowering = problem.lowering.as_ref();
        let admitted = lowering.filter(|lowering| lowering.apply(&mut written.clone()));
        let motion = admitted.and_then(|lowering| lowering.expand(&written.model, &self.run));
        (written, motion.map_or(Cow::Borrowed(&self.run), Cow::Owned))
    }

    /// A warning for each of the functions `which` that reduces a speed through its kink at rest.
    pub(crate) fn kinks(
        &self,
        problem: &Problem,
        which: impl Iterator<Item = usize>,
    ) -> Vec<String> {
        let warn = |f: usize| {
            let time = passes_rest(&self.scene.functions[f], &self.scene.model, &self.run)?;
            Some(format!(
                "the speed of \"{}\" passes zero at t = {time:.4} s, where it has a kink: take \
                 \"speed_squared\"",
                problem.function_names[f]
            ))
        };
        which.filter_map(warn).collect()
    }

    /// A function of interest, by index.
    pub(crate) fn function(&self, index: usize) -> evaluate::Evaluated<f64> {
        self.scene.functions[index].evaluate(&self.scene.model, &self.run)
    }

    /// Exact gradients of the functions `which` in the design variables, and the work they took.
    ///
    /// # Errors
    /// If a step's equations are singular.
    pub(crate) fn gradients(
        &self,
        problem: &Problem,
        which: &[usize],
    ) -> Result<(Vec<Vec<f64>>, WorkCounts), IntegrationFailure> {
        let (found, counts) = self.derivatives(problem, which)?;
        let value = |row: Vec<Derivative>| row.into_iter().map(|d| d.value).collect();
        Ok((found.into_iter().map(value).collect(), counts))
    }

    /// As [`Evaluated::gradients`], with the sizes of the terms.
    ///
    /// # Errors
    /// If a step's equations are singular.
    pub(crate) fn derivatives(
        &self,
        problem: &Problem,
        which: &[usize],
    ) -> Result<(Vec<Vec<Derivative>>, WorkCounts), IntegrationFailure> {
        // A function that is requested twice, as objective and in a constraint, is swept once.
        let mut once = which.to_vec();
        once.sort_unstable();
        once.dedup();
        let place = |f: &usize| {
            once.binary_search(f)
                .expect("every function is in the list")
        };
        let adjoint = match &self.scene.until {
            Some(_) if !once.is_empty() => {
                let with_event: Vec<usize> =
                    once.iter().copied().chain([self.scene.event()]).collect();
                let mut found = adjoint::gradients(&self.scene, &self.run, &with_event)?;
                let event = found.gradients.pop();
                for gradient in &mut found.gradients {
                    *gradient =
                        along_event(gradient, event.as_ref().expect("the event was asked for"));
                }
                found
            }
            _ => adjoint::gradients(&self.scene, &self.run, &once)?,
        };
        let by_parameters: Vec<Vec<f64>> =
            adjoint.gradients.iter().map(Scene::parameters).collect();
        let mut all = vec![Vec::with_capacity(self.x.len()); once.len()];
        for i in 0..self.x.len() {
            let moved = parameter_derivatives(problem, &self.x, i);
            for (gradient, by) in all.iter_mut().zip(&by_parameters) {
                let mut sum = Derivative::default();
                for (a, b) in by.iter().zip(&moved) {
                    sum.value += a * b;
                    sum.terms += (a * b).abs();
                }
                gradient.push(sum);
            }
        }
        let asked = which.iter().map(|f| all[place(f)].clone()).collect();
        Ok((asked, adjoint.counts))
    }
}

/// The derivative of a function where the event moves with the parameters: ∂f − (∂f/∂T) (∂g − ∂c) /
/// (∂g/∂T).
fn along_event(function: &Scene<f64>, event: &Scene<f64>) -> Scene<f64> {
    let ratio = function.duration / event.duration;
    let mut event = event.clone();
    if let Some(until) = &mut event.until {
        until.value = -1.0;
    }
    let by_event = event.parameters();
    let mut next = by_event.into_iter();
    let mut out = function.map(&mut |f| f - ratio * next.next().expect("scenes of one shape"));
    // The design no longer determines the duration.
    out.duration = 0.0;
    out
}

/// A derivative in a variable: the sum over the parameters of the scene that it moves.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Derivative {
    /// The sum.
    pub value: f64,
    /// The sum of the sizes of the terms; its last digits are round-off.
    pub terms: f64,
}

/// Derivative of every parameter of the scene in variable i.
fn parameter_derivatives(problem: &Problem, x: &[f64], i: usize) -> Vec<f64> {
    let x: Vec<Dual> = x
        .iter()
        .enumerate()
        .map(|(j, &value)| Dual::new(value, if i == j { 1.0 } else { 0.0 }))
        .collect();
    problem
        .scene(&x)
        .parameters()
        .into_iter()
        .map(|p| p.du)
        .collect()
}
