//! Replay of the explicit steps of a run.

use super::Stepper;
use super::march::failed;
use super::record::Node;
use super::step::StepFailure;
use super::tape::Block;
use crate::integrate::grid::SamplePlace;
use crate::integrate::replay::March;
use crate::integrate::{IntegrationFailure, Trajectory};
use crate::model::Model;
use crate::system::accelerations::Memory;

/// Repeats the steps of a run.
pub struct Replayer<'a> {
    run: &'a Trajectory<f64>,
    /// The steps.
    pub stepper: Stepper<'a, f64>,
    from: Node<Vec<f64>>,
    to: Node<Vec<f64>>,
}

impl<'a> Replayer<'a> {
    /// A replayer at the start of `run`, a run of `model`.
    pub fn new(model: &'a Model<f64>, run: &'a Trajectory<f64>) -> Self {
        let start = &run.initial;
        let node = Node {
            q: start.q.clone(),
            v: start.v.clone(),
            a: start.a.clone(),
            lambda: start.lambda.clone(),
        };
        Self {
            run,
            stepper: Stepper::new(model, &run.numbering),
            from: node.clone(),
            to: node,
        }
    }

    /// Whether samples lie inside step k.
    fn is_dense(&self, k: usize) -> bool {
        let places = &self.run.places;
        let first = places.partition_point(|place| place.step() < k);
        let own = places[first..].iter().take_while(|place| place.step() == k);
        own.into_iter()
            .any(|place| matches!(place, SamplePlace::Inside { .. }))
    }

    fn make(&mut self, k: usize, dense: bool) -> Result<(), StepFailure> {
        let (duration, grid) = (self.run.duration, &self.run.grid);
        let times = (duration * grid.ends()[k - 1], duration * grid.width(k));
        let stepper = &mut self.stepper;
        if let Some(rows) = grid.left_out(k) {
            stepper.field.leave_out(rows);
        }
        stepper.stages(self.from.view(), times)?;
        stepper.finish(&mut self.to, duration * grid.ends()[k])?;
        if dense {
            stepper.dense_stages((self.from.view(), self.to.view()), times)?;
        }
        Ok(())
    }
}

impl March for Replayer<'_> {
    type Block = Block<f64>;

    fn state(&self) -> Node<Vec<f64>> {
        self.from.clone()
    }

    fn solver(&mut self) -> Memory {
        self.stepper.field.memory()
    }

    fn restore(&mut self, state: &Node<Vec<f64>>) {
        self.from.clone_from(state);
    }

    fn restore_solver(&mut self, solver: &Memory) {
        self.stepper.field.restore(solver);
    }

    fn step(&mut self, k: usize, block: Option<&mut Block<f64>>) -> Result<(), IntegrationFailure> {
        // Stages of the dense output are needed only for the block or if the solver remembers them.
        let seen = block.is_some() || self.stepper.field.remembers();
        let made = self.make(k, seen && self.is_dense(k));
        made.map_err(|failure| {
            let time = self.run.duration * self.run.grid.ends()[k];
            let field = &self.stepper.field;
            failed(failure, (field.model, field.numbering), (k, time))
        })?;
        if let Some(block) = block {
            let nodes = [self.from.view(), self.to.view()];
            block.push(nodes, self.stepper.data.view());
        }
        std::mem::swap(&mut self.from, &mut self.to);
        Ok(())
    }
}
