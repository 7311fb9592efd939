//! Motions that several processes compute together.

use super::{Division, Problem};
use crate::math::Team;
use crate::model::Form;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// Elements of a body from which on ranks divide them.
const ENOUGH: usize = 16;

impl Problem {
    /// Whether several processes may compute its motions together: a body has enough elements, and no clock of one process
    /// ends a motion.
    pub fn can_be_shared(&self) -> bool {
        if let Some(cases) = &self.cases {
            let mut all = cases.list.iter();
            return cases.division == Division::Events
                && all.any(|own| own.problem.can_be_shared());
        }
        if !self.has_scene() || self.is_rest() || self.simulation.limits.seconds.is_some() {
            return false;
        }
        let scene = self.scene(&self.start());
        scene.model.flexible.iter().any(|body| match &body.form {
            Form::Finite(own) => own.mesh.elements.len() >= ENOUGH,
            Form::Modal(_) => false,
        })
    }

    /// The problem with motions that all ranks compute together, until `over` says to all of them that they must end. Each
    /// may take so much `memory` \[bytes\] for a gradient.
    #[must_use]
    pub fn together(&self, team: &Team, (over, memory): (&Arc<AtomicBool>, usize)) -> Self {
        let mut all = self.clone();
        // That of a problem is for the motions of all threads.
        let of_threads = memory.saturating_mul(rayon::current_num_threads());
        all.change_all(&|own| {
            own.simulation.memory = Some(of_threads);
            own.team = team.clone();
            own.simulation.limits.agreed = Some(over.clone());
        });
        all
    }
}
