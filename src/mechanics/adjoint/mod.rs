//! Exact gradients of functions of interest: the discrete adjoint of the integration.

mod compensated;
mod explicit;
mod implicit;
mod sensitivity;
mod workspace;

use crate::functions::Scene;
use crate::integrate::{IntegrationFailure, Tape, Trajectory, WorkCounts};
use crate::system::flexible;

/// Gradients and the work of computing them.
#[derive(Clone, Debug)]
pub struct AdjointRun {
    /// By requested function: its derivative in every parameter of the scene (a cotangent of the
    /// scene).
    pub gradients: Vec<Scene<f64>>,
    /// Work of the backward march.
    pub counts: WorkCounts,
}

/// Exact derivatives of the functions `which` (indices into the scene's functions) over `run`, by
/// one backward march.
///
/// # Errors
/// The equations of a step are singular.
pub fn gradients(
    scene: &Scene<f64>,
    run: &Trajectory<f64>,
    which: &[usize],
) -> Result<AdjointRun, IntegrationFailure> {
    match &run.tape {
        Tape::Explicit(tape) => explicit::gradients(scene, run, tape, which),
        Tape::Implicit(tape) if flexible::has_shells(&scene.model) => {
            rayon::scope(|_| implicit::gradients(scene, run, tape, which))
        }
        Tape::Implicit(tape) => implicit::gradients(scene, run, tape, which),
    }
}
