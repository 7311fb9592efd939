//! Exact gradients of functions of interest: the discrete adjoint of the integration.

mod compensated;
mod explicit;
mod implicit;
mod sensitivity;
mod workspace;

use crate::functions::Scene;
use crate::integrate::{IntegrationFailure, Tape, Trajectory, WorkCounts};
use crate::system::equilibrium::FrozenMode;
use crate::system::flexible;

/// Gradients and the work of computing them.
#[derive(Clone, Debug)]
pub struct AdjointRun {
    /// By requested function: its derivative in every parameter of the scene (a cotangent of the
    /// scene).
    pub gradients: Vec<Scene<f64>>,
    /// By requested function: what its derivative in the parameters of the model has besides, through vibrations.
    pub modes: Vec<Vec<FrozenMode>>,
    /// Work of the backward march.
    pub counts: WorkCounts,
}

/// What a backward march differentiates.
#[derive(Clone, Debug)]
pub enum Target {
    /// A function of interest, by its number in the scene.
    Function(usize),
    /// Σ w_k g(t_k) of histories.
    Histories(WeightedHistories),
    /// Σ w q(T) + Σ u v(T) of the state at the end.
    End(WeightedEnd),
}

/// Weights of the coordinates at the end of a run: the cotangent of its last state.
#[derive(Clone, Debug, Default)]
pub struct WeightedEnd {
    /// Of the positions, seven for each body.
    pub q: Vec<f64>,
    /// Of the velocities, six for each body.
    pub v: Vec<f64>,
}

/// Σ_f Σ_k w_fk g_f(t_k) + Σ_k u_k t_k over the instants t_k of a run, with the quantities g_f behind
/// functions of interest: the cotangents of a function of histories.
#[derive(Clone, Debug, Default)]
pub struct WeightedHistories {
    /// The functions that reduce a quantity, and the weight of the quantity at each instant.
    pub functions: Vec<(usize, Vec<f64>)>,
    /// Weights of the instants themselves, which move with the duration; empty for none.
    pub times: Vec<f64>,
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
    let targets: Vec<Target> = which.iter().map(|&f| Target::Function(f)).collect();
    gradients_of(scene, run, &targets)
}

/// [`gradients`] of any targets.
///
/// # Errors
/// The equations of a step are singular.
pub fn gradients_of(
    scene: &Scene<f64>,
    run: &Trajectory<f64>,
    targets: &[Target],
) -> Result<AdjointRun, IntegrationFailure> {
    match &run.tape {
        Tape::Explicit(tape) => explicit::gradients(scene, run, tape, targets),
        Tape::Implicit(tape) if flexible::has_shells(&scene.model) => {
            rayon::scope(|_| implicit::gradients(scene, run, tape, targets))
        }
        Tape::Implicit(tape) => implicit::gradients(scene, run, tape, targets),
    }
}
