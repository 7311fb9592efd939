//! Data of explicit steps for the adjoint.

use super::record::{Node, StepData};
use super::tableau::{ALL, STAGES};
use crate::integrate::quadrature::Samples;
use crate::integrate::replay;
use crate::integrate::rows::Rows;
use crate::integrate::schedule::MemoryOfBlock;
use crate::math::{Complex64, Scalar};
use crate::system::Numbering;
use crate::system::accelerations::Memory;
use std::ops::Range;

/// Stored data of a run.
pub type Tape<S> = replay::Tape<Block<S>>;

/// Consecutive steps: nodes and stages.
#[derive(Clone, Debug)]
pub struct Block<S> {
    first: usize,
    nodes: Rows<S, 4>,
    steps: Rows<S, 10>,
    /// By step: whether the stages of the dense output were computed.
    dense: Vec<bool>,
}

impl<S: Scalar> Tape<S> {
    /// The tape of a motion without gradients.
    pub fn none(numbering: &Numbering) -> Self {
        let block = Block::new(numbering, Samples::StepEnds, false);
        let room = block.room();
        Self::new(block, (0, room), None)
    }
}

impl<S: Scalar> Block<S> {
    /// An empty block. It has memory for the stages of the dense output only if samples may lie
    /// inside steps, as the end of the motion does if steps may `leap` over it.
    pub fn new(numbering: &Numbering, samples: Samples, leap: bool) -> Self {
        let stages = match samples {
            Samples::StepEnds | Samples::Uniform(..=1) if !leap => STAGES,
            Samples::StepEnds | Samples::Uniform(_) | Samples::Quadrature(_) => ALL,
        };
        Self {
            first: 0,
            nodes: Rows::new(Node::<&[S]>::lengths(numbering)),
            steps: Rows::new(StepData::<&[S]>::lengths(numbering, stages)),
            dense: Vec::new(),
        }
    }

    /// Memory of a step and of a checkpoint.
    pub fn room(&self) -> MemoryOfBlock {
        let node = self.nodes.width();
        MemoryOfBlock {
            step: (node + self.steps.width() + 1) * size_of::<S>(),
            checkpoint: (node + 16) * size_of::<S>(),
        }
    }

    /// Adds a step between two nodes.
    pub fn push(&mut self, [from, to]: [Node<&[S]>; 2], step: StepData<&[S]>) {
        if self.dense.is_empty() {
            self.nodes.push([from.q, from.v, from.a, from.lambda]);
        }
        self.nodes.push([to.q, to.v, to.a, to.lambda]);
        let (parts, lengths) = (step.parts(), self.steps.lengths());
        self.steps
            .push(std::array::from_fn(|i| &parts[i][..lengths[i]]));
        self.dense.push(step.dense);
    }

    /// The node after step n of the run.
    pub fn node(&self, n: usize) -> Node<&[S]> {
        let [q, v, a, lambda] = self.nodes.get(n - self.first);
        Node { q, v, a, lambda }
    }

    /// The stages of step n of the run.
    pub fn step(&self, n: usize) -> StepData<&[S]> {
        let at = n - self.first - 1;
        StepData::of_parts(self.steps.get(at), self.dense[at])
    }
}

impl<S: Scalar> replay::Block for Block<S> {
    type State = Node<Vec<S>>;
    type Solver = Memory;

    fn restart(&mut self, first: usize) {
        self.first = first;
        self.nodes.restart();
        self.steps.restart();
        self.dense.clear();
    }

    fn reserve(&mut self, steps: usize) {
        self.nodes.reserve(steps + 1);
        self.steps.reserve(steps);
        self.dense.reserve(steps);
    }

    fn steps(&self) -> Range<usize> {
        self.first + 1..self.first + 1 + self.dense.len()
    }

    fn numbers(&self) -> usize {
        self.nodes.numbers() + self.steps.numbers()
    }

    fn empty(&self) -> Self {
        Self {
            first: 0,
            nodes: Rows::new(self.nodes.lengths()),
            steps: Rows::new(self.steps.lengths()),
            dense: Vec::new(),
        }
    }
}

impl Block<Complex64> {
    /// The real part.
    pub fn real(&self) -> Block<f64> {
        Block {
            first: self.first,
            nodes: self.nodes.real(),
            steps: self.steps.real(),
            dense: self.dense.clone(),
        }
    }
}
