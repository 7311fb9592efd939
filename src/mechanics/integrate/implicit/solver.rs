//! Consecutive steps of the implicit methods.

use super::Stage;
use super::estimate::Estimate;
use super::formula::{Formula, History, memory_size, remembers_start};
use super::newton::{self, Newton};
use super::predict::Past;
use super::radau::Scheme;
use super::stage_newton::{self, StageNewton};
use super::tangent::TangentError;
use crate::integrate::failure::IntegrationFailure;
use crate::integrate::scale::Scale;
use crate::integrate::settings::{Method, StepSolver};
use crate::integrate::work::WorkCounts;
use crate::integrate::{has_kinks, stage_time};
use crate::linalg::SolveScalar;
use crate::model::Model;
use crate::system::initial::InitialState;
use crate::system::{Numbering, RedundantRows, bodies, flexible};

/// Data that Newton's method keeps from step to step.
#[derive(Clone, Debug)]
pub struct Memory<S> {
    one: Option<newton::Memory<S>>,
    coupled: Option<stage_newton::Memory>,
    left_out: RedundantRows,
}

/// The initial stage, with its rates q̇ = T(q) v and v̇.
pub fn starting_stage<S: SolveScalar>(numbering: &Numbering, start: &InitialState<S>) -> Stage<S> {
    let mut first = Stage::zero(numbering);
    first.q.copy_from_slice(&start.q);
    first.v.copy_from_slice(&start.v);
    first.lambda.copy_from_slice(&start.lambda);
    first.vdot.copy_from_slice(&start.a);
    bodies::rates(numbering, &start.q, &start.v, &mut first.qdot);
    first
}

/// Sets a stage after the time h to a guess.
type Guess<S> = fn(&mut Past<S>, &Numbering, S, &mut Stage<S>);

/// Makes the steps of a method.
pub(super) struct Solver<'a, S> {
    method: Method,
    solver: StepSolver,
    model: &'a Model<S>,
    real: &'a Model<f64>,
    numbering: &'a Numbering,
    scheme: &'a Scheme,
    /// Whether some body has shells.
    shells: bool,
    /// Whether loads or drives have kinks.
    kinks: bool,
    /// Newton's method for formulas, created when needed.
    one: Option<Newton<'a, S>>,
    /// Newton's method for Radau IIA, created when needed.
    coupled: Option<StageNewton<'a, S>>,
    estimate: Option<Estimate<'a>>,
    tangent: Option<TangentError<'a, S>>,
    /// Redundant rows, which are not imposed.
    left_out: RedundantRows,
    /// Memory of a formula, for q and v.
    pub memory: [Vec<Vec<S>>; 2],
    history: History<S>,
    /// Stages of the latest step; that of a formula is the first.
    pub stages: Vec<Stage<S>>,
}

impl<'a, S: SolveScalar> Solver<'a, S> {
    /// A solver of `method` for a model with the real part `real`. `estimates` states whether
    /// errors will be needed.
    pub fn new(
        (method, solver): (Method, StepSolver),
        (model, real): (&'a Model<S>, &'a Model<f64>),
        (numbering, scheme): (&'a Numbering, &'a Scheme),
        estimates: bool,
    ) -> Self {
        let lengths = [numbering.positions(), numbering.velocities()];
        Self {
            method,
            solver,
            model,
            real,
            numbering,
            scheme,
            shells: flexible::has_shells(model),
            kinks: has_kinks(model),
            one: None,
            coupled: None,
            estimate: estimates.then(|| Estimate::new(real, numbering, scheme)),
            tangent: None,
            left_out: RedundantRows::default(),
            memory: lengths.map(|n| vec![vec![S::zero(); n]; memory_size(method)]),
            history: History::new(numbering),
            stages: vec![Stage::zero(numbering); scheme.stages()],
        }
    }

    /// Judges the tangent, too.
    pub fn resolve_tangent(&mut self) {
        let tangent = TangentError::new(self.model, self.numbering, self.scheme);
        self.tangent = Some(tangent);
    }

    /// The data that Newton's method keeps from step to step.
    pub fn newton(&mut self) -> Memory<S> {
        Memory {
            one: self.one.as_mut().map(Newton::memory),
            coupled: self.coupled.as_mut().map(StageNewton::memory),
            left_out: self.left_out.clone(),
        }
    }

    /// Restores the data that Newton's method kept.
    pub fn restore(&mut self, newton: &Memory<S>, counts: &mut WorkCounts) {
        self.leave_out(&newton.left_out);
        match &newton.one {
            None => self.one = None,
            Some(kept) => {
                let (model, numbering, solver) = (self.model, self.numbering, self.solver);
                let newton =
                    (self.one).get_or_insert_with(|| Newton::new(model, numbering, solver));
                newton.leave_out(&self.left_out);
                newton.restore(kept, counts);
            }
        }
        match &newton.coupled {
            None => self.coupled = None,
            Some(kept) => {
                let estimates = self.estimate.is_some();
                let (model, real, newton) = (self.model, self.real, self.solver.newton);
                let newton = self.coupled.get_or_insert_with(|| {
                    StageNewton::new(
                        (model, real),
                        self.numbering,
                        self.scheme,
                        (estimates, newton),
                    )
                });
                newton.leave_out(&self.left_out);
                newton.restore(kept, counts);
            }
        }
    }

    /// Sets the redundant rows of the next steps.
    pub fn leave_out(&mut self, rows: &RedundantRows) {
        self.left_out.clone_from(rows);
        if let Some(newton) = &mut self.one {
            newton.leave_out(rows);
        }
        if let Some(newton) = &mut self.coupled {
            newton.leave_out(rows);
        }
        if let Some(estimate) = &mut self.estimate {
            estimate.leave_out(rows);
        }
        if let Some(tangent) = &mut self.tangent {
            tangent.leave_out(rows);
        }
    }

    /// Discards the factors of rejected steps.
    pub fn forget(&mut self) {
        if let Some(newton) = &mut self.coupled {
            newton.forget();
        }
    }

    /// Makes step `at.0` of size `h`, the step `in_part` since the start or since a kink; returns its
    /// number of stages. A formula starts anew at a kink.
    pub fn step(
        &mut self,
        past: &mut Past<S>,
        (start, h): (S, S),
        (in_part, at): (usize, (usize, f64)),
        counts: &mut WorkCounts,
    ) -> Result<usize, IntegrationFailure> {
        let (model, real, numbering) = (self.model, self.real, self.numbering);
        let (stages, kinks) = (&mut self.stages, self.kinks);
        if in_part == 1 {
            past.forget_increments();
        }
        let Some(formula) = Formula::of_step(self.method, in_part) else {
            past.predict_stages(numbering, self.scheme, h, stages);
            let nodes = &self.scheme.nodes;
            let place = |stages: &mut [Stage<S>], from: &Stage<S>| {
                for (stage, &c) in stages.iter_mut().zip(nodes) {
                    stage.project_increments(numbering, from);
                    stage.time = stage_time((start, h), c, kinks);
                }
            };
            place(stages, &past.from);
            let (scheme, estimates) = (self.scheme, self.estimate.is_some());
            let tolerance = self.solver.newton;
            let newton = (self.coupled).get_or_insert_with(|| {
                StageNewton::new((model, real), numbering, scheme, (estimates, tolerance))
            });
            newton.leave_out(&self.left_out);
            let found = newton.solve(stages, h, at, counts);
            if found.is_err() && self.shells {
                past.coast_stages(numbering, scheme, h, stages);
                place(stages, &past.from);
                newton.forget();
                newton.solve(stages, h, at, counts)?;
            } else {
                found?;
            }
            return Ok(stages.len());
        };
        if in_part == 1 && remembers_start(self.method) {
            for (memory, rates) in self
                .memory
                .iter_mut()
                .zip([&past.from.qdot, &past.from.vdot])
            {
                for m in memory {
                    m.iter_mut().zip(rates).for_each(|(m, &x)| *m = x * h);
                }
            }
        }
        // The matrices of the first steps of shells are large, and not needed again.
        if self.shells {
            self.coupled = None;
        }
        let stage = &mut stages[0];
        past.predict(numbering, h, stage);
        stage.project_increments(numbering, &past.from);
        stage.time = stage_time((start, h), 1.0, kinks);
        self.history.set(&formula, &self.memory, h);
        let history = &self.history;
        let solver = self.solver;
        let newton = self
            .one
            .get_or_insert_with(|| Newton::new(model, numbering, solver));
        newton.leave_out(&self.left_out);
        let found = newton.solve(stage, history, h, at, counts);
        // The extrapolation over large steps may be a bad guess, and so are accelerations of light parts.
        let guesses: [Guess<S>; 2] = [Past::taylor, Past::coast];
        let others = if self.shells { 2 } else { 1 };
        let found = guesses[..others].iter().fold(found, |found, guess| {
            found.or_else(|_| {
                guess(past, numbering, h, stage);
                stage.project_increments(numbering, &past.from);
                stage.time = stage_time((start, h), 1.0, kinks);
                newton.forget();
                newton.solve(stage, history, h, at, counts)
            })
        });
        found.map(|()| 1)
    }

    /// Updates the memory after a step with `count` stages, the step `in_part` since the start or since
    /// a kink.
    pub fn remember(&mut self, count: usize, in_part: usize) {
        let last = &self.stages[count - 1];
        let formula = Formula::of_step(self.method, in_part);
        for (memory, delta) in self.memory.iter_mut().zip([&last.dq, &last.dv]) {
            match &formula {
                Some(formula) => {
                    for (k, &delta) in delta.iter().enumerate() {
                        formula.remember(delta, memory, k);
                    }
                }
                // Increments for a later formula, newest first.
                None => {
                    if let Some(oldest) = memory.last_mut() {
                        oldest.copy_from_slice(delta);
                        memory.rotate_right(1);
                    }
                }
            }
        }
    }

    /// Estimated error of the last step, which started at `from`, relative to the scene's scale;
    /// zero without an estimate.
    pub fn error(&mut self, from: &Stage<S>, h: f64, scale: &Scale) -> f64 {
        match (&mut self.coupled, &mut self.estimate) {
            (Some(newton), Some(estimate)) => {
                let step = (from, &self.stages[..]);
                let of_motion = estimate.error(newton, step, h, scale);
                let of_tangent = (self.tangent.as_mut())
                    .map_or(0.0, |tangent| tangent.error(newton, step, h, scale));
                // Neither NaN is lost.
                match of_motion >= of_tangent || of_motion.is_nan() {
                    true => of_motion,
                    false => of_tangent,
                }
            }
            _ => 0.0,
        }
    }

    /// Adds the work of the estimates to `counts`.
    pub fn count(&self, counts: &mut WorkCounts) {
        if let Some(estimate) = &self.estimate {
            estimate.count(counts);
        }
        if let Some(tangent) = &self.tangent {
            tangent.count(counts);
        }
    }
}
