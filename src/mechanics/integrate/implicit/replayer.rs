//! Replay of the implicit steps of a run.

use super::Stage;
use super::predict::Past;
use super::radau::Scheme;
use super::solver::{Memory, Solver, starting_stage};
use super::tape::{Block, State};
use crate::integrate::replay::March;
use crate::integrate::work::WorkCounts;
use crate::integrate::{IntegrationFailure, Trajectory};
use crate::model::Model;
use crate::system::turns;

/// Repeats the steps of a run.
pub struct Replayer<'a> {
    model: &'a Model<f64>,
    run: &'a Trajectory<f64>,
    solver: Solver<'a, f64>,
    past: Past<f64>,
    /// Work so far.
    pub counts: WorkCounts,
}

impl<'a> Replayer<'a> {
    /// A replayer at the start of `run`, a run of `model`.
    pub fn new(model: &'a Model<f64>, run: &'a Trajectory<f64>, scheme: &'a Scheme) -> Self {
        let numbering = &run.numbering;
        let system = (numbering, scheme);
        let first: Stage<f64> = starting_stage(numbering, &run.initial);
        Self {
            model,
            run,
            solver: Solver::new((run.method, run.solver), (model, model), system, false),
            past: Past::new(numbering, first, (run.method, scheme.stages())),
            counts: WorkCounts::default(),
        }
    }
}

impl March for Replayer<'_> {
    type Block = Block<f64>;

    fn state(&self) -> State<f64> {
        (self.past.clone(), self.solver.memory.clone())
    }

    fn solver(&mut self) -> Memory<f64> {
        self.solver.newton()
    }

    fn restore(&mut self, (past, memory): &State<f64>) {
        self.past.clone_from(past);
        self.solver.memory.clone_from(memory);
    }

    fn restore_solver(&mut self, newton: &Memory<f64>) {
        self.solver.restore(newton, &mut self.counts);
    }

    fn step(&mut self, k: usize, block: Option<&mut Block<f64>>) -> Result<(), IntegrationFailure> {
        let (duration, grid) = (self.run.duration, &self.run.grid);
        let (start, h) = (duration * grid.ends()[k - 1], duration * grid.width(k));
        let at = (k, duration * grid.ends()[k]);
        let in_part = grid.in_part(k);
        let (past, solver) = (&mut self.past, &mut self.solver);
        if let Some(rows) = grid.left_out(k) {
            solver.leave_out(rows);
        }
        let count = solver.step(past, (start, h), (in_part, at), &mut self.counts)?;
        if let Some(block) = block {
            block.push(&past.from, &solver.stages[..count]);
        }
        solver.remember(count, in_part);
        past.advance(h, &mut solver.stages, count);
        turns::count(self.model, &self.run.numbering, &mut past.from.q);
        Ok(())
    }
}
