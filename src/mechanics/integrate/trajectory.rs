//! The result of a run.

use super::grid::{Grid, SamplePlace};
use super::limits::Limits;
use super::quadrature::{Due, Step, weights};
use super::rows::real;
use super::schedule::Schedule;
use super::settings::{Method, StepSolver};
use super::work::{Measured, WorkCounts};
use super::{explicit, implicit};
use crate::math::{Complex64, Scalar};
use crate::system::Numbering;
use crate::system::initial::InitialState;

/// The motion at the sampled instants, and the data for the adjoint.
#[derive(Clone, Debug)]
pub struct Trajectory<S: Scalar> {
    /// Numbering of the states.
    pub numbering: Numbering,
    /// The integration method.
    pub method: Method,
    /// Solver of the equations of implicit steps.
    pub solver: StepSolver,
    /// Duration T \[s\].
    pub duration: S,
    /// Ends of the steps.
    pub grid: Grid,
    /// Sampled instants as fractions of T, from 0 to 1.
    pub instants: Vec<f64>,
    /// Positions of the sampled instants relative to the steps.
    pub places: Vec<SamplePlace>,
    /// Weights of the sampled instants in sums over the motion; their sum is one.
    pub weights: Vec<f64>,
    /// Their derivatives dw/dT times T, plus w: derivatives of the weights of integrals, T w.
    pub moving: Vec<f64>,
    /// Whether the sampled instants with weights are the nodes of the cells of the steps.
    pub has_cells: bool,
    /// By instant: whether tables and figures show it.
    pub shown: Vec<bool>,
    /// Positions: one row of `numbering.positions()` per instant.
    pub q: Vec<S>,
    /// Velocities: one row of `numbering.velocities()` per instant.
    pub v: Vec<S>,
    /// Accelerations v̇ of the method: one row of `numbering.velocities()` per instant.
    pub a: Vec<S>,
    /// Multipliers λ: one row per instant; empty if the method does not compute them (see
    /// [`multipliers`](super::multipliers)).
    pub lambda: Vec<S>,
    /// The consistent start.
    pub initial: InitialState<S>,
    /// Largest estimated error of a step, relative to the scene's lengths and speeds; zero if the
    /// method has no estimate.
    pub step_error: f64,
    /// Data for the adjoint.
    pub tape: Tape<S>,
    /// Work spent.
    pub counts: WorkCounts,
    /// Limits of the simulation, which gradients heed too.
    pub limits: Limits,
    /// What an explicit march with a tolerance measured of the stiffness of the scene.
    pub stiffness: Option<Measured>,
}

/// Data for the adjoint, by family of methods.
#[derive(Clone, Debug)]
pub enum Tape<S: Scalar> {
    /// Of the explicit method.
    Explicit(explicit::Tape<S>),
    /// Of an implicit method.
    Implicit(implicit::Tape<S>),
}

impl<S: Scalar> Trajectory<S> {
    /// A trajectory that has only its start.
    pub fn start(
        numbering: Numbering,
        method: Method,
        duration: S,
        initial: InitialState<S>,
        tape: Tape<S>,
    ) -> Self {
        Self {
            method,
            solver: StepSolver::default(),
            duration,
            grid: Grid::growing(),
            instants: vec![0.0],
            places: vec![SamplePlace::Node(0)],
            weights: vec![0.0],
            moving: vec![0.0],
            shown: vec![true],
            has_cells: false,
            q: initial.q.clone(),
            v: initial.v.clone(),
            a: initial.a.clone(),
            lambda: Vec::new(),
            numbering,
            initial,
            step_error: 0.0,
            tape,
            counts: WorkCounts::default(),
            limits: Limits::default(),
            stiffness: None,
        }
    }

    /// Reserves memory for `steps` steps and `samples` instants.
    pub fn reserve(&mut self, steps: usize, samples: usize) {
        let (nq, nv) = (self.numbering.positions(), self.numbering.velocities());
        self.grid.reserve(steps);
        self.instants.reserve(samples);
        self.places.reserve(samples);
        self.weights.reserve(samples);
        self.moving.reserve(samples);
        self.shown.reserve(samples);
        self.q.reserve(samples * nq);
        self.v.reserve(samples * nv);
        self.a.reserve(samples * nv);
        if !self.lambda.is_empty() {
            self.lambda.reserve(samples * self.numbering.constraints());
        }
    }

    /// Adds an instant.
    pub fn push(&mut self, due: Due, place: SamplePlace, [q, v, a, lambda]: [&[S]; 4]) {
        let growth = self.grid.growth(self.grid.ends()[self.grid.steps() - 1]);
        self.instants.push(due.at);
        self.weights.push(due.weight);
        self.moving.push(due.weight * growth);
        self.shown.push(due.shown);
        self.places.push(place);
        self.q.extend_from_slice(q);
        self.v.extend_from_slice(v);
        self.a.extend_from_slice(a);
        self.lambda.extend_from_slice(lambda);
    }

    /// Keeps the start alone of the samples.
    pub(super) fn forget_samples(&mut self) {
        let (nq, nv) = (self.numbering.positions(), self.numbering.velocities());
        self.instants.truncate(1);
        self.places.truncate(1);
        self.shown.truncate(1);
        (self.weights, self.moving) = (vec![0.0], vec![0.0]);
        self.q.truncate(nq);
        self.v.truncate(nv);
        self.a.truncate(nv);
        self.lambda.truncate(self.numbering.constraints());
    }

    /// Adds the weight of the start of a step to the last instant.
    pub(super) fn weigh_start(&mut self, step: &Step) {
        let growth = self.grid.growth(step.from);
        if let (Some(weight), Some(moving)) = (self.weights.last_mut(), self.moving.last_mut()) {
            *weight += step.first_weight();
            *moving += step.first_weight() * growth;
        }
    }

    /// Weighs samples that are no nodes of cells.
    pub fn weigh(&mut self) {
        let kinks = self.grid.kinks();
        self.weights = weights(&self.instants, kinks);
        let Some(&last) = kinks.last() else {
            self.moving.clone_from(&self.weights);
            return;
        };
        // The weights of the last part alone.
        let growth = self.grid.growth(last);
        let from = self
            .instants
            .partition_point(|&at| self.grid.growth(at) == 0.0);
        let part: Vec<f64> = self.instants[from..]
            .iter()
            .map(|at| (at - last) / (1.0 - last))
            .collect();
        let own = weights(&part, &[]);
        let own = own.into_iter().map(|w| w * (1.0 - last) * growth);
        self.moving = vec![0.0; from].into_iter().chain(own).collect();
    }

    /// The sampled instants that tables and figures show.
    pub fn shown(&self) -> Vec<usize> {
        (0..=self.last()).filter(|&k| self.shown[k]).collect()
    }

    /// Memory of the samples and of the data for the adjoint \[bytes\].
    pub fn bytes(&self) -> [usize; 2] {
        let samples = [&self.q, &self.v, &self.a, &self.lambda];
        let samples: usize = samples.iter().map(|all| all.len()).sum();
        let number = size_of::<S>();
        let tape = match &self.tape {
            Tape::Explicit(tape) => tape.bytes(number),
            Tape::Implicit(tape) => tape.bytes(number),
        };
        [samples * number, tape]
    }

    /// The schedule of a run of `steps` steps in the same memory, and its memory \[bytes\].
    pub fn checkpoint_plan(&self, steps: usize) -> (Schedule, usize) {
        match &self.tape {
            Tape::Explicit(tape) => tape.checkpoint_plan(steps),
            Tape::Implicit(tape) => tape.checkpoint_plan(steps),
        }
    }

    /// Time that the steps have reached \[s\].
    pub fn time_reached(&self) -> f64 {
        self.duration.re() * self.grid.reached()
    }

    /// Index of the last instant.
    pub fn last(&self) -> usize {
        self.instants.len() - 1
    }

    /// Time of instant k \[s\].
    pub fn time(&self, k: usize) -> S {
        self.grid.time(self.duration, self.instants[k])
    }

    /// Positions at instant k.
    pub fn q(&self, k: usize) -> &[S] {
        row(&self.q, self.numbering.positions(), k)
    }

    /// Velocities at instant k.
    pub fn v(&self, k: usize) -> &[S] {
        row(&self.v, self.numbering.velocities(), k)
    }

    /// Accelerations at instant k.
    pub fn a(&self, k: usize) -> &[S] {
        row(&self.a, self.numbering.velocities(), k)
    }

    /// Weight of instant k in sums over [0, 1].
    pub fn quadrature_weight(&self, k: usize) -> S {
        let duration = self.duration.re();
        let change = (self.duration - S::from(duration)) / duration;
        change * (self.moving[k] - self.weights[k]) + self.weights[k]
    }
}

impl Trajectory<f64> {
    /// This run with the states `[q, v, a]` of another model, numbered by `numbering`. It has neither
    /// multipliers nor data for an adjoint.
    pub fn with_states(&self, numbering: Numbering, [q, v, a]: [Vec<f64>; 3]) -> Self {
        Self {
            method: self.method,
            solver: self.solver,
            duration: self.duration,
            grid: self.grid.clone(),
            instants: self.instants.clone(),
            places: self.places.clone(),
            weights: self.weights.clone(),
            moving: self.moving.clone(),
            has_cells: self.has_cells,
            shown: self.shown.clone(),
            q,
            v,
            a,
            lambda: Vec::new(),
            initial: self.initial.clone(),
            step_error: self.step_error,
            tape: Tape::Explicit(explicit::Tape::none(&numbering)),
            counts: self.counts,
            limits: self.limits.clone(),
            stiffness: self.stiffness,
            numbering,
        }
    }
}

impl Trajectory<Complex64> {
    /// The real part of a complex run.
    pub fn real(&self) -> Trajectory<f64> {
        Trajectory {
            numbering: self.numbering.clone(),
            method: self.method,
            solver: self.solver,
            duration: self.duration.re,
            grid: self.grid.clone(),
            instants: self.instants.clone(),
            places: self.places.clone(),
            weights: self.weights.clone(),
            moving: self.moving.clone(),
            shown: self.shown.clone(),
            has_cells: self.has_cells,
            q: real(&self.q),
            v: real(&self.v),
            a: real(&self.a),
            lambda: real(&self.lambda),
            initial: InitialState {
                q: real(&self.initial.q),
                v: real(&self.initial.v),
                a: real(&self.initial.a),
                lambda: real(&self.initial.lambda),
                s: real(&self.initial.s),
                sigma: real(&self.initial.sigma),
                left_out: self.initial.left_out.clone(),
                iterations: self.initial.iterations,
            },
            step_error: self.step_error,
            tape: match &self.tape {
                Tape::Explicit(tape) => Tape::Explicit(tape.with(tape.block.real())),
                Tape::Implicit(tape) => Tape::Implicit(tape.with(tape.block.real())),
            },
            counts: self.counts,
            limits: self.limits.clone(),
            stiffness: self.stiffness,
        }
    }
}

fn row<S>(all: &[S], width: usize, k: usize) -> &[S] {
    &all[k * width..(k + 1) * width]
}
