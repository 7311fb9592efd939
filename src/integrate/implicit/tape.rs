//! What the adjoint needs of implicit steps.

use super::Stage;
use crate::integrate::rows::Rows;
use crate::math::{Complex64, Scalar};
use crate::system::Numbering;

/// What the adjoint needs: the state at the start and the stages of every step, one for a formula,
/// all for Radau IIA; the last stage stands at the step's end.
#[derive(Clone, Debug)]
pub struct Tape<S> {
    /// The start, with the rates there.
    pub start: Stage<S>,
    stages: Rows<S, 9>,
    /// How many stages there are up to the end of each step.
    ends: Vec<usize>,
}

impl<S: Scalar> Tape<S> {
    /// No step yet.
    pub fn new(numbering: &Numbering, start: Stage<S>) -> Self {
        let (nq, nv) = (numbering.positions(), numbering.velocities());
        let nc = numbering.constraints();
        Self {
            start,
            stages: Rows::new([nq, nv, nq, nv, nc, nc, nq, nv, 1]),
            ends: Vec::new(),
        }
    }

    /// Makes room for so many steps and stages.
    pub fn reserve(&mut self, steps: usize, stages: usize) {
        self.stages.reserve(stages);
        self.ends.reserve(steps);
    }

    /// Adds a step.
    pub fn push(&mut self, stages: &[Stage<S>]) {
        for stage in stages {
            self.stages.push(stage.parts());
        }
        self.ends.push(self.first(self.steps() + 1) + stages.len());
    }

    /// Number of steps.
    pub fn steps(&self) -> usize {
        self.ends.len()
    }

    /// Number of stages before step k = 1 … N.
    fn first(&self, k: usize) -> usize {
        if k == 1 { 0 } else { self.ends[k - 2] }
    }

    /// Puts the stages of step k = 1 … N in front of `out`, and returns how many there are.
    pub fn read(&self, k: usize, out: &mut [Stage<S>]) -> usize {
        let all = self.first(k)..self.ends[k - 1];
        for (stage, i) in out.iter_mut().zip(all.clone()) {
            stage.set_parts(self.stages.get(i));
        }
        all.len()
    }

    /// Puts the end of step k, for k = 0 the start, into `out`.
    pub fn read_end(&self, k: usize, out: &mut Stage<S>) {
        match k {
            0 => out.set(&self.start),
            _ => out.set_parts(self.stages.get(self.ends[k - 1] - 1)),
        }
    }

    /// How many numbers it holds.
    pub fn numbers(&self) -> usize {
        self.stages.width() + self.stages.numbers()
    }
}

impl Tape<Complex64> {
    /// The real part.
    pub fn real(&self) -> Tape<f64> {
        Tape {
            start: self.start.real(),
            stages: self.stages.real(),
            ends: self.ends.clone(),
        }
    }
}
