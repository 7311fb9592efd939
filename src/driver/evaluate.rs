//! Functions and gradients of a problem at a design: one simulation, one backward march.

use super::integration::{Integration, Refresh};
use super::journal::{Account, Journal, bits};
use crate::adjoint;
use crate::functions::{Scene, evaluate};
use crate::integrate::{IntegrationFailure, Trajectory, WorkCounts};
use crate::math::Dual;
use crate::model::RigidBody;
use crate::optimiser::{Evaluation, EvaluationFailure, Gradients, Nlp};
use crate::problem::{Problem, Sense};
use crate::report::evaluations::Work;
use nalgebra::DMatrix;
use std::borrow::Cow;
use std::cell::RefCell;
use std::collections::HashMap;
use std::rc::Rc;

/// A design that was simulated.
pub struct Evaluated {
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
        let mut scene = problem.unlowered_scene::<f64>(x);
        let not_solid = |body: &&RigidBody<f64>| !body.is_solid();
        if let Some(body) = scene.model.bodies.iter().find(not_solid) {
            return Err(IntegrationFailure::Unphysical {
                body: body.name.clone(),
            });
        }
        integration.unlowered += usize::from(!problem.lower(&mut scene));
        let (run, refresh) = integration.simulate(&mut scene)?;
        let x = x.to_vec();
        Ok((Self { x, scene, run }, refresh))
    }

    /// The scene as it is written, and the motion of all its bodies.
    pub fn written(&self, problem: &Problem) -> (Scene<f64>, Cow<'_, Trajectory<f64>>) {
        let written = problem.unlowered_scene(&self.x);
        let lowering = problem.lowering.as_ref();
        let admitted = lowering.filter(|lowering| lowering.apply(&mut written.clone()));
        let motion = admitted.and_then(|lowering| lowering.expand(&written.model, &self.run));
        (written, motion.map_or(Cow::Borrowed(&self.run), Cow::Owned))
    }

    /// A function of interest, by index.
    pub fn function(&self, index: usize) -> evaluate::Evaluated<f64> {
        self.scene.functions[index].evaluate(&self.scene.model, &self.run)
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

    /// As [`Evaluated::gradients`], with the sizes of what was summed.
    ///
    /// # Errors
    /// If a step's equations are singular.
    pub fn derivatives(
        &self,
        problem: &Problem,
        which: &[usize],
    ) -> Result<(Vec<Vec<Derivative>>, WorkCounts), IntegrationFailure> {
        // A function that is asked for twice, as objective and in a constraint, is swept once.
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
    // The duration is none of the design's any more.
    out.duration = 0.0;
    out
}

/// A derivative in a variable: the sum over the parameters of the scene that it moves.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Derivative {
    /// The sum.
    pub value: f64,
    /// The sum of the terms' sizes, of which the last digits are round-off.
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

/// The steps that the functions of a design were found with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct JudgedOn {
    /// Number of steps.
    pub steps: Option<usize>,
    /// How often they had been chosen anew.
    pub refreshes: usize,
}

/// The steps of every design that was evaluated, by its bits; shared with who observes the run.
pub type Judgements = Rc<RefCell<HashMap<Vec<u64>, JudgedOn>>>;

/// The problem as a nonlinear program. Keeps the last simulated design, so that a gradient where
/// the functions were just evaluated costs the backward march only.
pub struct Evaluator<'a> {
    problem: &'a Problem,
    objective: usize,
    sign: f64,
    last: Option<Evaluated>,
    /// The steps in use.
    pub integration: Integration,
    /// How many designs did not admit what the lowering leaves out at the others.
    pub unlowered: usize,
    journal: Journal<'a>,
    /// Which choice of steps of the journal `integration` goes by, and the evaluation of the record
    /// whose event it knows.
    choice: Option<usize>,
    latest: Option<usize>,
    /// What the functions of each design were found with.
    pub judgements: Judgements,
}

impl<'a> Evaluator<'a> {
    /// The program that `problem` states, or `None` if it has no objective.
    pub fn new(problem: &'a Problem, journal: Journal<'a>) -> Option<Self> {
        let objective = problem.objective?;
        let scene = problem.scene(&problem.start());
        let sign = match objective.sense {
            Sense::Minimise => 1.0,
            Sense::Maximise => -1.0,
        };
        let asked = asked(problem, objective.function);
        Some(Self {
            problem,
            objective: objective.function,
            sign,
            last: None,
            integration: Integration::new(problem, &scene, Some(&asked), true),
            unlowered: 0,
            journal,
            choice: None,
            latest: None,
            judgements: Judgements::default(),
        })
    }

    /// +1 if the objective is minimised, −1 if it is maximised.
    pub fn sign(&self) -> f64 {
        self.sign
    }

    /// Indices of the objective's function and the constraints' functions.
    fn functions(&self) -> Vec<usize> {
        asked(self.problem, self.objective)
    }

    /// Work of all simulations and gradients so far, those that the journal knew included.
    pub fn counts(&self) -> Work {
        self.journal.work()
    }

    /// Takes the steps and the event that the journal has come to.
    fn follow(&mut self) {
        let choice = self.journal.choice();
        if choice != self.choice {
            self.choice = choice;
            if let Some(kept) = self.journal.steps() {
                self.integration.restore(kept);
            }
        }
        if let Some((place, event)) = self.journal.latest()
            && self.latest != Some(place)
        {
            self.latest = Some(place);
            self.integration.event = event;
        }
    }

    fn failure(&self, reason: String) -> EvaluationFailure {
        EvaluationFailure {
            what: format!("the simulation of \"{}\"", self.problem.name),
            reason,
        }
    }
}

fn asked(problem: &Problem, objective: usize) -> Vec<usize> {
    let constraints = problem.constraints.iter().map(|c| c.function);
    std::iter::once(objective).chain(constraints).collect()
}

/// The simulated design `x`: the last one, or a new one.
fn at<'e>(
    last: &'e mut Option<Evaluated>,
    (integration, account): (&mut Integration, &mut Account),
    problem: &Problem,
    x: &[f64],
) -> Result<&'e Evaluated, IntegrationFailure> {
    let found = match last.take().filter(|last| last.x == x) {
        Some(known) => Ok(known),
        None => {
            integration.settled = account.settled;
            Evaluated::with(integration, problem, x).map(|(evaluated, refresh)| {
                account.refresh = refresh;
                if !account.repeated {
                    account.work += evaluated.run.counts;
                }
                evaluated
            })
        }
    };
    integration.settled = None;
    account.event = integration.event;
    Ok(last.insert(found?))
}

impl Nlp for Evaluator<'_> {
    fn variables(&self) -> usize {
        self.problem.variables.len()
    }

    fn constraints(&self) -> usize {
        self.problem.constraints.len()
    }

    fn variable_bounds(&self) -> (Vec<f64>, Vec<f64>) {
        self.problem
            .variables
            .iter()
            .map(|v| (v.lower / v.scale, v.upper / v.scale))
            .unzip()
    }

    fn constraint_bounds(&self) -> (Vec<f64>, Vec<f64>) {
        self.problem
            .constraints
            .iter()
            .map(|c| (c.lower, c.upper))
            .unzip()
    }

    fn start(&self) -> Vec<f64> {
        self.problem
            .variables
            .iter()
            .map(|v| v.start / v.scale)
            .collect()
    }

    fn variable_name(&self, i: usize) -> String {
        self.problem.variables[i].name.clone()
    }

    fn constraint_name(&self, j: usize) -> String {
        self.problem.constraints[j].name.clone()
    }

    fn evaluate(&mut self, x: &[f64]) -> Result<Evaluation, EvaluationFailure> {
        let x = unscaled(self.problem, x);
        let functions = self.functions();
        let (problem, last) = (self.problem, &mut self.last);
        let integration = &mut self.integration;
        let (before, mut known) = (integration.unlowered, true);
        let found = self.journal.values(&x, |account| {
            known = false;
            let steps = (&mut *integration, account);
            let at = at(last, steps, problem, &x).map_err(|failure| failure.to_string())?;
            Ok(functions.iter().map(|&f| at.function(f).value).collect())
        });
        self.unlowered += match known {
            true => usize::from(!problem.lowered_scene(&x).1),
            false => integration.unlowered - before,
        };
        self.follow();
        let judged = JudgedOn {
            steps: self.integration.steps(),
            refreshes: self.integration.refreshes,
        };
        let mut judgements = self.judgements.borrow_mut();
        judgements.entry(bits(&x)).or_insert(judged);
        drop(judgements);
        let values = found.map_err(|reason| self.failure(reason))?;
        Ok(Evaluation {
            objective: self.sign * values[0],
            constraints: values[1..].to_vec(),
        })
    }

    fn gradients(&mut self, x: &[f64]) -> Result<Gradients, EvaluationFailure> {
        let problem = self.problem;
        let x = unscaled(problem, x);
        let functions = self.functions();
        let (last, integration) = (&mut self.last, &mut self.integration);
        let found = self.journal.gradients(&x, |account| {
            let steps = (integration, &mut *account);
            let at = at(last, steps, problem, &x).map_err(|failure| failure.to_string())?;
            let found = at.gradients(problem, &functions);
            let (gradients, work) = found.map_err(|failure| failure.to_string())?;
            account.work += work;
            Ok(gradients)
        });
        self.follow();
        let gradients = found.map_err(|reason| self.failure(reason))?;
        let scaled = |f: usize, i: usize| gradients[f][i] * problem.variables[i].scale;
        let n = x.len();
        Ok(Gradients {
            objective: (0..n).map(|i| self.sign * scaled(0, i)).collect(),
            jacobian: DMatrix::from_fn(functions.len() - 1, n, |j, i| scaled(j + 1, i)),
        })
    }
}

/// A design in the problem's units from the optimiser's, x = scale · x̂.
pub fn unscaled(problem: &Problem, x: &[f64]) -> Vec<f64> {
    // A scaled bound comes back as the bound itself, whatever round-off did.
    let clamp = |x: f64, v: &crate::problem::Variable| (x * v.scale).clamp(v.lower, v.upper);
    x.iter()
        .zip(&problem.variables)
        .map(|(&x, v)| clamp(x, v))
        .collect()
}
