//! Other samples of a motion whose steps are stored, without their repetition.

use super::quadrature::Samples;
use super::replay::Block;
use super::trajectory::{Tape, Trajectory};
use super::{explicit, implicit};
use crate::model::Model;

impl Trajectory<f64> {
    /// The motion of this run of `model` with these numbers of cells by step and these samples. `None` if not all of its steps are
    /// stored, or if it cannot be sampled there.
    pub fn resampled(
        mut self,
        model: &Model<f64>,
        cells: Vec<u32>,
        samples: Samples,
    ) -> Option<Self> {
        let steps = match &self.tape {
            Tape::Explicit(tape) => tape.block.steps(),
            Tape::Implicit(tape) => tape.block.steps(),
        };
        if !self.has_cells || steps != (1..self.grid.steps() + 1) {
            return None;
        }
        let whole = self.grid.with_cells(cells);
        self.grid = whole.to_grow();
        let intervals = whole.intervals(samples.intervals());
        self.forget_samples();
        let none = Tape::Explicit(explicit::Tape::none(&self.numbering));
        let mut tape = std::mem::replace(&mut self.tape, none);
        let (own, at) = ((model, &mut self), (samples, &intervals));
        match &mut tape {
            Tape::Explicit(tape) => {
                let steps = (&*tape, &whole);
                tape.block = explicit::samples::sample_again(own, steps, at).ok()?;
            }
            Tape::Implicit(tape) => implicit::samples::sample_again(own, (tape, &whole), at),
        }
        (self.tape, self.grid) = (tape, whole);
        Some(self)
    }

    /// Frees the memory of its steps. A gradient repeats them.
    pub fn forget_steps(&mut self) {
        match &mut self.tape {
            Tape::Explicit(tape) => tape.forget(),
            Tape::Implicit(tape) => tape.forget(),
        }
    }
}
