//! A step of a run, for the backward march.

use crate::integrate::Trajectory;
use crate::integrate::implicit::Stage;
use crate::integrate::implicit::tape::Block;
use crate::system::{Numbering, RedundantRows};

/// A step with its stages.
pub(super) struct Step<'a> {
    /// Its number, from 1.
    pub number: usize,
    /// Its number since the start or since a kink, from 1.
    pub in_part: usize,
    /// Derivatives of its size and of its end in the duration.
    pub growth: f64,
    pub rate: f64,
    /// Its size \[s\].
    pub size: f64,
    /// Redundant rows that are left out of its equations.
    pub left_out: Option<&'a RedundantRows>,
    /// The state at its start.
    pub from: Stage<f64>,
    stages: Vec<Stage<f64>>,
    count: usize,
}

impl<'a> Step<'a> {
    /// Room for a step of at most so many stages.
    pub(super) fn new(numbering: &Numbering, stages: usize) -> Self {
        let from = Stage::zero(numbering);
        Self {
            number: 0,
            in_part: 1,
            growth: 0.0,
            rate: 0.0,
            size: 0.0,
            left_out: None,
            stages: vec![from.clone(); stages],
            from,
            count: 0,
        }
    }

    /// Reads step `number` of a run from a block that holds it.
    pub(super) fn read(&mut self, run: &'a Trajectory<f64>, block: &Block<f64>, number: usize) {
        self.number = number;
        let (width, ends) = (run.grid.width(number), run.grid.ends());
        self.in_part = run.grid.in_part(number);
        self.growth = width * run.grid.growth(ends[number - 1]);
        self.rate = run.grid.rate(ends[number]);
        self.size = run.duration * width;
        self.left_out = run.grid.left_out(number);
        block.read_end(number - 1, &mut self.from);
        self.count = block.read(number, &mut self.stages);
    }

    /// Its stages.
    pub(super) fn stages(&self) -> &[Stage<f64>] {
        &self.stages[..self.count]
    }

    /// The stage at its end.
    pub(super) fn last(&self) -> &Stage<f64> {
        &self.stages[self.count - 1]
    }
}
