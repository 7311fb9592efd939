//! Data of implicit steps for the adjoint.

use super::Stage;
use super::formula::memory_size;
use super::predict::{Past, recent};
use super::solver::Memory;
use crate::integrate::replay;
use crate::integrate::rows::Rows;
use crate::integrate::schedule::MemoryOfBlock;
use crate::integrate::settings::Method;
use crate::math::{Complex64, Scalar, Team};
use crate::system::Numbering;
use std::ops::Range;

/// Stored data of a run.
pub type Tape<S> = replay::Tape<Block<S>>;

/// Consecutive steps: their stages (one for a formula, all for Radau IIA) and the state at the
/// start of the first step. The last stage of a step is its end.
#[derive(Clone, Debug)]
pub struct Block<S> {
    first: usize,
    start: Stage<S>,
    stages: Rows<S, 9>,
    /// By step: number of stages up to its end.
    ends: Vec<usize>,
    /// Largest number of stages of a step.
    most: usize,
}

impl<S: Scalar> Block<S> {
    /// An empty block of a run that starts with `start`, whose stages are spread over the ranks of a team. A step has at most
    /// `most` stages.
    pub fn new((numbering, team): (&Numbering, &Team), start: Stage<S>, most: usize) -> Self {
        let (nq, nv) = (numbering.positions(), numbering.velocities());
        let nc = numbering.constraints();
        Self {
            first: 0,
            start,
            stages: Rows::over(team, [nq, nv, nq, nv, nc, nc, nq, nv, 1]),
            ends: Vec::new(),
            most,
        }
    }

    /// Memory of a step and of a checkpoint of a method.
    pub fn room(&self, method: Method) -> MemoryOfBlock {
        let [nq, nv, _, _, nc, ..] = self.stages.lengths();
        let (width, number) = (self.stages.width(), size_of::<S>());
        let stages = match method {
            Method::Radau { .. } => self.most,
            Method::Dop853 | Method::Bdf { .. } | Method::GeneralisedAlpha { .. } => 1,
        };
        // A checkpoint holds the state, the stages of the last step, what guesses extrapolate, the memory of a
        // formula, and the stage of the factors.
        let states = (2 + self.most) * width + recent(method) * (nq + nv + 2 * nc);
        MemoryOfBlock {
            step: (stages * self.stages.most_kept() + 1) * number,
            checkpoint: (states + memory_size(method) * (nq + nv) + 32) * number,
        }
    }

    /// Adds a step that starts at `from`.
    pub fn push(&mut self, from: &Stage<S>, stages: &[Stage<S>]) {
        if self.ends.is_empty() {
            self.start.set(from);
        }
        for stage in stages {
            self.stages.push(stage.parts());
        }
        let before = self.ends.last().copied().unwrap_or(0);
        self.ends.push(before + stages.len());
    }

    /// Number of stages before step `at` of this block, counted from 0.
    fn before(&self, at: usize) -> usize {
        at.checked_sub(1).map_or(0, |last| self.ends[last])
    }

    /// Writes the stages of step k of the run to the first entries of `out`; returns their number.
    pub fn read(&self, k: usize, out: &mut [Stage<S>]) -> usize {
        let at = k - self.first - 1;
        let all = self.before(at)..self.ends[at];
        for (stage, i) in out.iter_mut().zip(all.clone()) {
            stage.set_parts(self.stages.vectors(&self.stages.record(i)));
        }
        all.len()
    }

    /// Writes the end of step k of the run to `out`; k may be the step before the first of this
    /// block.
    pub fn read_end(&self, k: usize, out: &mut Stage<S>) {
        match self.before(k - self.first) {
            0 => out.set(&self.start),
            end => out.set_parts(self.stages.vectors(&self.stages.record(end - 1))),
        }
    }
}

/// History before a step, and the memory of a formula for q and v.
pub type State<S> = (Past<S>, [Vec<Vec<S>>; 2]);

impl<S: Scalar> replay::Block for Block<S> {
    type State = State<S>;
    type Solver = Memory<S>;

    fn restart(&mut self, first: usize) {
        self.first = first;
        self.stages.restart();
        self.ends.clear();
    }

    fn reserve(&mut self, steps: usize) {
        self.ends.reserve(steps);
        self.stages.reserve(steps);
    }

    fn steps(&self) -> Range<usize> {
        self.first + 1..self.first + 1 + self.ends.len()
    }

    fn numbers(&self) -> usize {
        self.stages.width() + self.stages.numbers()
    }

    fn empty(&self) -> Self {
        Self {
            first: 0,
            start: self.start.clone(),
            stages: Rows::over(self.stages.team(), self.stages.lengths()),
            ends: Vec::new(),
            most: self.most,
        }
    }
}

impl Block<Complex64> {
    /// The real part.
    pub fn real(&self) -> Block<f64> {
        Block {
            first: self.first,
            start: self.start.real(),
            stages: self.stages.real(),
            ends: self.ends.clone(),
            most: self.most,
        }
    }
}
