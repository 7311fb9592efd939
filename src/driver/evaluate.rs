//! Functions and gradients of a problem at a design: one simulation, one backward march.

use super::composed;
pub use super::composed::Derivative;
use super::event;
use super::integration::{Integration, Refresh};
use crate::adjoint::{self, Target, WeightedHistories};
use crate::functions::rest::{passes_rest, vanishing};
use crate::functions::{Function, Reduction, Scene, evaluate, smoothed};
use crate::integrate::{
    IntegrationFailure, Samples, Settings, StepSolver, Trajectory, WorkCounts, irregular,
    simulate_by,
};
use crate::math::scalar::COMPLEX_STEP;
use crate::math::soft_max::Smoothed;
use crate::math::{Complex64, Dual, Parameters, Team};
use crate::model::RigidBody;
use crate::model::flexible::FlexibleBody;
use crate::problem::{Composition, EndCotangent, Focus, Partials, Problem};
use crate::system::equilibrium::FrozenMode;
use crate::system::flexible;
use rayon::prelude::*;
use std::borrow::Cow;
use std::sync::Arc;

/// Derivatives by variables that are computed at once.
const SIDE_BY_SIDE: usize = 8;

/// A norm is zero below this part of its size in the scene: to round-off, and for warnings.
const ZERO: f64 = 64.0 * f64::EPSILON;
const ALMOST_ZERO: f64 = 1e-6;

/// A design that was simulated.
pub struct Evaluated {
    /// The design.
    pub x: Vec<f64>,
    /// The scene there.
    pub scene: Scene<f64>,
    /// Its motion.
    pub run: Trajectory<f64>,
    /// Functions that expressions of others give.
    pub composition: Arc<Composition>,
}

/// A design with an infinitesimal change of all variables, each in its scale.
fn along(problem: &Problem, x: &[f64]) -> Vec<Complex64> {
    let scaled = problem.variables.iter().zip(x).enumerate();
    let moved = scaled
        .map(|(i, (variable, &x))| Complex64::new(x, COMPLEX_STEP * variable.scale * irregular(i)));
    // The state with which a phase begins.
    let fixed = x.iter().skip(problem.variables.len());
    moved.chain(fixed.map(|&x| Complex64::from(x))).collect()
}

impl Evaluated {
    /// Simulates the design `x`; the whole motion is sampled.
    ///
    /// # Errors
    /// If the simulation fails.
    pub fn new(problem: &Problem, x: &[f64]) -> Result<Self, IntegrationFailure> {
        let mut integration = Integration::new(problem, &problem.scene(x), None, true);
        Ok(Self::with(&mut integration, problem, x)?.0)
    }

    /// Simulates the design `x` with the steps in use; also says if these changed.
    ///
    /// # Errors
    /// If the simulation fails.
    pub fn with(
        integration: &mut Integration,
        problem: &Problem,
        x: &[f64],
    ) -> Result<(Self, Option<Refresh>), IntegrationFailure> {
        if let Some(what) = problem.undefined_expression(x) {
            return Err(IntegrationFailure::Undefined { what });
        }
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
        let (mut run, mut refresh) = integration.simulate(&mut scene)?;
        if refresh.is_some() {
            let tangent = || problem.scene(&along(problem, x));
            let (resolved, more) = integration.resolve_tangent(&mut scene, run, tangent)?;
            (run, refresh) = (resolved, more.or(refresh));
        }
        let x = x.to_vec();
        let composition = problem.composition.clone();
        let at = Self {
            x,
            scene,
            run,
            composition,
        };
        Ok((at, refresh))
    }

    /// Whether the machine is at rest: its motion is one instant.
    pub fn is_rest(&self) -> bool {
        self.run.last() == 0
    }

    /// The same design with another motion.
    pub fn with_run(&self, scene: Scene<f64>, run: Trajectory<f64>) -> Self {
        Self {
            x: self.x.clone(),
            scene,
            run,
            composition: self.composition.clone(),
        }
    }

    /// The scene as it is written, and the motion of all its bodies. Bodies that no function
    /// observes are simulated for it; if that fails, they rest.
    pub fn written(&self, problem: &Problem) -> (Scene<f64>, Cow<'_, Trajectory<f64>>) {
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
            solver: StepSolver::suited(whole.simulation.solver, &whole.simulation.spacing),
            derivatives: !whole.variables.is_empty(),
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

    /// Why function f has no derivative by the design here, if so; of an expression, why one that it names has none.
    pub fn no_derivative(&self, problem: &Problem, f: usize) -> Option<String> {
        match self.composition.gives(f) {
            false => self.vanishes(problem, f, ZERO),
            true => {
                let moving = self.partials(f).by_function.into_iter();
                let mut moving = moving.filter(|(_, by)| *by != 0.0);
                moving.find_map(|(g, _)| self.vanishes(problem, g, ZERO))
            }
        }
    }

    /// Why the history of function f has no derivative by the design here, if so.
    pub fn no_derivative_of_history(&self, problem: &Problem, f: usize) -> Option<String> {
        let instant = self.scene.functions.get(f)?.instant()?.clone();
        let over_all = Function::reduced(instant, Reduction::Integral);
        self.vanishing(problem, (f, &over_all), ZERO)
    }

    fn vanishes(&self, problem: &Problem, f: usize, part: f64) -> Option<String> {
        self.vanishing(problem, (f, &self.scene.functions[f]), part)
    }

    fn vanishing(
        &self,
        problem: &Problem,
        (f, function): (usize, &Function<f64>),
        part: f64,
    ) -> Option<String> {
        let (scene, name) = (&self.scene, &problem.function_names[f]);
        let norm = vanishing(function, &scene.model, &self.run, part)?;
        let advice = match norm {
            "speed" => ": take \"speed_squared\"",
            _ => "",
        };
        Some(format!(
            "the {norm} of \"{name}\" is zero, where it has a kink and no derivative by the design{advice}"
        ))
    }

    /// Warnings of the functions `which`: of a speed that passes through its kink at rest, of a norm that is
    /// zero, and of a peak that the samples do not resolve.
    pub fn doubts(&self, problem: &Problem, which: impl Iterator<Item = usize>) -> Vec<String> {
        let asked: Vec<usize> = which.collect();
        let which = self.composition.of_scene(&asked);
        let doubts = |f: usize| {
            let name = &problem.function_names[f];
            let rests = passes_rest(&self.scene.functions[f], &self.scene.model, &self.run);
            let sharpness = self.function(f).peak_sharpness;
            let kink = rests.map(|time| {
                format!(
                    "the speed of \"{name}\" passes zero at t = {time:.4} s, where it has a kink: take \
                     \"speed_squared\""
                )
            });
            let narrow = (sharpness > 1.0).then(|| {
                format!(
                    "the peak of \"{name}\" is narrower than the distance of samples (rho times the \
                     change of the quantity beside it is {sharpness:.1}): take more samples or steps, \
                     a tolerance, or a lower rho"
                )
            });
            let kink = kink.or_else(|| self.vanishes(problem, f, ALMOST_ZERO));
            kink.into_iter().chain(narrow)
        };
        which.iter().copied().flat_map(doubts).collect()
    }

    /// A function of interest, by index. An expression has a value alone.
    pub fn function(&self, index: usize) -> evaluate::Evaluated<f64> {
        match self.composition.gives(index) {
            true => evaluate::Evaluated {
                value: self.value(index),
                maximum: None,
                peak_sharpness: 0.0,
            },
            false => self.scene.functions[index].evaluate(&self.scene.model, &self.run),
        }
    }

    /// The value of a function of interest, by index.
    pub fn value(&self, index: usize) -> f64 {
        let of = |g: usize| self.function(g).value;
        self.composition.value(index, &self.x, &of)
    }

    /// Derivatives of an expression by the functions and numbers that it names.
    pub fn partials(&self, index: usize) -> Partials {
        let of = |g: usize| self.function(g).value;
        self.composition.partials(index, &self.x, &of)
    }

    /// What a function of interest stands for, if something in it is smoothed.
    pub fn smoothed(&self, index: usize) -> Option<Smoothed> {
        if self.composition.gives(index) {
            let one = |g: usize| (self.smoothed(g), self.function(g).value);
            return composed::smoothed(&self.composition, index, &self.x, &one);
        }
        let function = &self.scene.functions[index];
        let found = self.function(index);
        smoothed::of_motion(function, &self.scene.model, &self.run, &found)
    }

    /// Exact gradients of the functions `which` in the design variables, and the work they took.
    ///
    /// # Errors
    /// If a step's equations are singular.
    pub fn gradients(
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
    pub fn derivatives(
        &self,
        problem: &Problem,
        which: &[usize],
    ) -> Result<(Vec<Vec<Derivative>>, WorkCounts), IntegrationFailure> {
        // A function that is requested twice, as objective and in a constraint, is swept once.
        let mut once = self.composition.of_scene(which).into_owned();
        once.sort_unstable();
        once.dedup();
        let place = |f: &usize| {
            once.binary_search(f)
                .expect("every function is in the list")
        };
        let targets = once.iter().map(|&f| Target::Function(f)).collect();
        let (all, counts) = self.derivatives_of(problem, targets, &[])?;
        let row = |g: usize| &all[place(&g)][..];
        let one = |&f: &usize| match self.composition.gives(f) {
            true => composed::derivatives(&self.partials(f), &row),
            false => row(f).to_vec(),
        };
        Ok((which.iter().map(one).collect(), counts))
    }

    /// Exact derivatives of functions of histories, from their cotangents: one row for each of `histories`,
    /// one number per variable, by one backward march. Instants keep their fraction of the duration.
    ///
    /// # Errors
    /// If a step's equations are singular.
    pub fn pull_back(
        &self,
        problem: &Problem,
        histories: Vec<WeightedHistories>,
    ) -> Result<Vec<Vec<f64>>, IntegrationFailure> {
        let targets = histories.into_iter().map(Target::Histories).collect();
        let (all, _) = self.derivatives_of(problem, targets, &[])?;
        let value = |row: Vec<Derivative>| row.into_iter().map(|d| d.value).collect();
        Ok(all.into_iter().map(value).collect())
    }

    /// Exact derivatives of the functions `which` of the scene, and of sums of the state at the end, by one backward march.
    ///
    /// # Errors
    /// If a step's equations are singular.
    pub fn derivatives_to_end(
        &self,
        problem: &Problem,
        which: &[usize],
        ends: &[&EndCotangent],
    ) -> Result<(Vec<Vec<Derivative>>, WorkCounts), IntegrationFailure> {
        let functions = which.iter().map(|&f| Target::Function(f));
        let of_ends = ends.iter().map(|own| Target::End(own.end.clone()));
        self.derivatives_of(problem, functions.chain(of_ends).collect(), ends)
    }

    /// Derivatives of targets; the last of them are sums of the end, whose parts without the motion `ends` has.
    fn derivatives_of(
        &self,
        problem: &Problem,
        mut targets: Vec<Target>,
        ends: &[&EndCotangent],
    ) -> Result<(Vec<Vec<Derivative>>, WorkCounts), IntegrationFailure> {
        let count = targets.len();
        let ends_at_event = self.scene.until.is_some() && count > 0;
        if ends_at_event {
            targets.push(Target::Function(self.scene.event()));
        }
        let mut adjoint = adjoint::gradients_of(&self.scene, &self.run, &targets)?;
        let of_ends = adjoint.gradients[count - ends.len()..].iter_mut();
        for (gradient, end) in of_ends.zip(ends) {
            gradient.duration += end.duration;
            for (joint, [by_a, by_b]) in &end.frames {
                let own = &mut gradient.model.joints[*joint];
                own.frame_a.add(by_a);
                own.frame_b.add(by_b);
            }
        }
        let mut of_event: Option<Vec<Scene<f64>>> = None;
        if ends_at_event && let Some(event) = adjoint.gradients.pop() {
            adjoint.modes.pop();
            event::refuse_touch(&self.scene, &self.run, event.duration)?;
            let along = |gradient: &Scene<f64>| along_event(gradient, &event);
            let (all, sizes): (Vec<_>, Vec<_>) = adjoint.gradients.iter().map(along).unzip();
            (adjoint.gradients, of_event) = (all, Some(sizes));
        }
        let by_parameters: Vec<Vec<f64>> =
            adjoint.gradients.iter().map(Scene::parameters).collect();
        let sizes: Vec<Vec<f64>> = match &of_event {
            Some(sizes) => sizes.iter().map(Scene::parameters).collect(),
            None => by_parameters.clone(),
        };
        let along = |i: usize| -> Result<Vec<[f64; 2]>, IntegrationFailure> {
            let scene = moved_scene(problem, &self.x, i)?;
            let moved: Vec<f64> = scene.parameters().into_iter().map(|p| p.du).collect();
            let rows = by_parameters.iter().zip(&sizes).zip(&adjoint.modes);
            let one = |((by, sizes), modes): ((&Vec<f64>, &Vec<f64>), &Vec<FrozenMode>)| {
                let [mut value, mut all] = [0.0; 2];
                for by_mode in modes.iter().map(|mode| mode.along(&scene.model)) {
                    value += by_mode;
                    all += by_mode.abs();
                }
                // A parameter without a derivative concerns the functions that depend on it alone.
                let terms = by.iter().zip(sizes).zip(&moved);
                for ((a, size), b) in terms.filter(|((a, size), _)| **a != 0.0 || **size != 0.0) {
                    value += a * b;
                    all += (size * b).abs();
                }
                [value, all]
            };
            Ok(rows.map(one).collect())
        };
        // Variables are divided among ranks and threads, of which each may have factors of its own. One that fails is computed
        // again by all, for its error.
        let team = flexible::team(&self.scene.model);
        let share = team.share(0..self.x.len());
        let piece = share.len().div_ceil(SIDE_BY_SIDE);
        let share = share.into_par_iter().with_min_len(piece.max(1));
        let own: Vec<Option<Vec<[f64; 2]>>> = share.map(|i| along(i).ok()).collect();
        let mut all = vec![Vec::with_capacity(self.x.len()); count];
        for (i, of_variable) in team.gather(own).into_iter().enumerate() {
            let of_variable = of_variable.map_or_else(|| along(i), Ok)?;
            for (gradient, [value, terms]) in all.iter_mut().zip(of_variable) {
                gradient.push(Derivative { value, terms });
            }
        }
        Ok((all, adjoint.counts))
    }
}

/// The derivative of a function where the event moves with the parameters: ∂f − (∂f/∂T) (∂g − ∂c) /
/// (∂g/∂T); and the sum of the sizes of both terms.
fn along_event(function: &Scene<f64>, event: &Scene<f64>) -> (Scene<f64>, Scene<f64>) {
    let ratio = function.duration / event.duration;
    let mut event = event.clone();
    if let Some(until) = &mut event.until {
        until.value = -1.0;
    }
    let by_event = event.parameters();
    let with = |term: &dyn Fn(f64, f64) -> f64| {
        let mut next = by_event.iter();
        let mut of = |f: f64| term(f, ratio * next.next().expect("scenes of one shape"));
        let mut out = function.map(&mut of);
        // The design no longer determines the duration.
        out.duration = 0.0;
        out
    };
    (with(&|f, e| f - e), with(&|f, e| f.abs() + e.abs()))
}

/// The scene with the derivatives of all its parameters in variable i.
///
/// # Errors
/// The start has no derivative, as of a machine at rest that nothing holds against a change.
fn moved_scene(problem: &Problem, x: &[f64], i: usize) -> Result<Scene<Dual>, IntegrationFailure> {
    let x: Vec<Dual> = x
        .iter()
        .enumerate()
        .map(|(j, &value)| Dual::new(value, if i == j { 1.0 } else { 0.0 }))
        .collect();
    let mut scene = problem.scene(&x);
    scene.admit_start()?;
    // Each rank has its own variables, so nothing else is exchanged meanwhile.
    flexible::set_team(&mut scene.model, &Team::default());
    Ok(scene)
}
