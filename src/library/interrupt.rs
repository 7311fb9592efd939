//! An interrupt of simulations under way.

use crate::integrate::Progress;
use crate::problem::Problem;
use std::sync::Arc;
use std::time::Instant;

/// Ends the simulations of the problems that heed it. They then fail as interrupted.
#[derive(Clone, Debug, Default)]
pub struct Interrupt {
    progress: Arc<Progress>,
}

impl Interrupt {
    /// An interrupt that has not occurred.
    pub fn new() -> Self {
        Self::default()
    }

    /// Makes a problem heed it.
    pub fn attach(&self, problem: &mut Problem) {
        problem.change_all(&|own| own.simulation.limits.progress = Some(self.progress.clone()));
    }

    /// Ends the simulations under way, and lets no other begin.
    pub fn stop(&self) {
        self.progress.end_by(Instant::now());
    }

    /// Lets simulations begin again.
    pub fn reset(&self) {
        self.progress.go_on();
    }

    /// Whether it has occurred.
    pub fn has_stopped(&self) -> bool {
        self.progress.is_over()
    }
}
