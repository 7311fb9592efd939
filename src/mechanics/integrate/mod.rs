//! Time integration: methods, steps, and the resulting motion.

pub mod choice;
pub mod control;
pub mod energy;
pub mod explicit;
pub mod failure;
pub mod grid;
pub mod headway;
pub mod implicit;
mod instances;
pub mod limits;
pub mod multipliers;
mod parts;
pub mod quadrature;
pub mod replay;
mod resample;
pub mod rows;
pub mod scale;
pub mod schedule;
pub mod settings;
mod singular;
mod stops;
pub mod touches;
pub mod trajectory;
pub mod work;

pub use choice::{Chosen, simulate_by};
pub use failure::IntegrationFailure;
pub use grid::Grid;
pub use instances::Integrated;
pub use limits::{Limits, Progress};
pub use multipliers::Multipliers;
pub use quadrature::Samples;
pub use settings::MEMORY;
pub use settings::{LinearSolver, Method, Settings, Spacing, Start, StepSolver};
pub use singular::irregular;
pub use stops::{has_kinks, stage_time};
pub use trajectory::{Tape, Trajectory};
pub use work::WorkCounts;

use crate::linalg::SolveScalar;
use crate::model::Model;
use crate::system::kkt::SaddlePoint;
use crate::system::{BodyMotion, Numbering, assembly, initial, redundancy};
use control::Controller;
use explicit::stiffness::Watch;
use headway::Stop;

/// Integrates `model` over `duration`, in real numbers or, for complex-step derivatives, in complex
/// ones.
///
/// # Errors
/// [`IntegrationFailure`] says what failed, when and where.
pub fn simulate<S: Integrated>(
    model: &Model<S>,
    duration: S,
    settings: &Settings,
) -> Result<Trajectory<S>, IntegrationFailure> {
    S::simulate(model, duration, settings, Watch::Stability)
}

/// As [`simulate`]. An explicit march with a tolerance watches for `watch`.
fn simulate_watching<S: SolveScalar>(
    model: &Model<S>,
    duration: S,
    settings: &Settings,
    watch: Watch,
) -> Result<Trajectory<S>, IntegrationFailure> {
    if settings.spacing.is_rest() {
        return rest(model, duration, settings);
    }
    if !(duration.is_finite() && duration.re() > 0.0) {
        return Err(IntegrationFailure::Duration {
            duration: duration.re(),
        });
    }
    let numbering = Numbering::new(model);
    let mut saddle = SaddlePoint::new(model, &numbering);
    let start = initial::solve(model, &numbering, &mut saddle)?;
    let mut run = match settings.method {
        Method::Dop853 => {
            explicit::march::march(model, &numbering, duration, settings, start, watch)?
        }
        Method::Radau { .. } | Method::Bdf { .. } | Method::GeneralisedAlpha { .. } => {
            implicit::march::march(model, &numbering, duration, settings, start)?
        }
    };
    run.limits = settings.limits.clone();
    run.counts.factorisations += saddle.factorisations;
    run.counts.solves += saddle.factorisations;
    Ok(run)
}

/// The single instant of a machine that is placed at rest.
fn rest<S: SolveScalar>(
    model: &Model<S>,
    duration: S,
    settings: &Settings,
) -> Result<Trajectory<S>, IntegrationFailure> {
    let numbering = Numbering::new(model);
    let mut saddle = SaddlePoint::new(model, &numbering);
    let start = initial::solve(model, &numbering, &mut saddle)?;
    let tape = Tape::Explicit(explicit::Tape::none(&numbering));
    let mut run = Trajectory::start(numbering, Method::Dop853, duration, start, tape);
    (run.weights, run.moving) = (vec![1.0], vec![1.0]);
    run.limits = settings.limits.clone();
    run.counts.factorisations = saddle.factorisations;
    run.counts.solves = saddle.factorisations;
    Ok(run)
}

/// Completes `run` after the march over the steps of `controller`.
fn close<S: SolveScalar>(
    run: &mut Trajectory<S>,
    controller: &Controller,
) -> Result<(), IntegrationFailure> {
    let (time, step) = (run.time_reached(), run.grid.steps() + 1);
    match controller.stopped() {
        None => {}
        Some(Stop::TooSmall) => return Err(IntegrationFailure::StepTooSmall { time, step }),
        Some(Stop::Rejected { in_a_row }) => {
            return Err(IntegrationFailure::Rejected {
                time,
                step,
                in_a_row,
            });
        }
        Some(Stop::Interrupted) => return Err(IntegrationFailure::Interrupted),
        Some(Stop::TimeLimit(seconds)) => {
            return Err(IntegrationFailure::TimeLimit {
                seconds,
                time,
                duration: run.duration.re(),
                step,
            });
        }
        Some(Stop::NoHeadway {
            tries,
            rejected,
            advance,
        }) => {
            return Err(IntegrationFailure::NoHeadway {
                time,
                duration: run.duration.re(),
                step,
                tries,
                rejected,
                advance: advance * run.duration.re(),
            });
        }
    }
    // Nodes of cells have their weights already.
    if !run.has_cells {
        run.weigh();
    }
    run.step_error = controller.largest_error();
    run.counts.steps = run.grid.steps();
    Ok(())
}

/// Fails if a redundant row that was left out is violated, or if a driven joint is half a turn off,
/// at the end of step `step` with the motions and the time `at`.
fn watch<S: SolveScalar>(
    model: &Model<S>,
    at: (&[BodyMotion<S>], S),
    step: usize,
) -> Result<(), IntegrationFailure> {
    if let Some(joint) = assembly::turned(model, at) {
        return Err(IntegrationFailure::Turned {
            joint: joint.name.clone(),
            time: at.1.re(),
            step,
        });
    }
    match redundancy::opened(model, at) {
        None => Ok(()),
        Some(open) => Err(IntegrationFailure::RedundancyLost {
            joint: model.joints[open.joint].name.clone(),
            gap: open.gap,
            time: at.1.re(),
            step,
        }),
    }
}
