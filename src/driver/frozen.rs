//! Complex runs of a design with the steps of its real one.

use super::evaluate::Evaluated;
use super::event;
use super::integration::{Integration, KeptSteps};
use crate::functions::Scene;
use crate::integrate::{IntegrationFailure, MEMORY, Settings, Spacing, Trajectory, simulate};
use crate::math::Complex64;
use crate::math::scalar::COMPLEX_STEP;
use crate::problem::Problem;

/// The settings of a run, with its steps frozen.
pub(super) fn settings(problem: &Problem, at: &Evaluated) -> Option<Settings> {
    let mut integration = Integration::new(problem, &at.scene, None, true);
    integration.restore(KeptSteps {
        method: at.run.method,
        reason: None,
        grid: match problem.simulation.spacing {
            Spacing::Steps(_) if !at.run.grid.is_equal() => None,
            Spacing::Steps(_) | Spacing::Tolerance(_) | Spacing::Frozen(_) => {
                Some(at.run.grid.clone())
            }
        },
        refreshes: 0,
        cases: Vec::new(),
    });
    integration.chosen().map(|(settings, _)| settings.clone())
}

/// The design x + i h d.
pub(super) fn complex_design(x: &[f64], direction: &[f64]) -> Vec<Complex64> {
    let along = x.iter().zip(direction);
    let moved = |(&x, d): (&f64, &f64)| Complex64::new(x, COMPLEX_STEP * d);
    along.map(moved).collect()
}

/// What a complex run stores.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Stored {
    /// Its steps, for the adjoint on its real part: at least as many as the default memory holds. Steps that are made again
    /// in real numbers differ from it by round-off.
    Steps,
    /// The motion alone.
    Motion,
}

/// The scene and its motion at a complex design; `event` is when the event comes at its real part, and how fast.
pub(super) fn complex_motion(
    problem: &Problem,
    (settings, stored): (&Settings, Stored),
    event: (f64, f64),
    x: &[Complex64],
) -> Result<(Scene<Complex64>, Trajectory<Complex64>), IntegrationFailure> {
    let scene = problem.scene(x);
    scene.admit_start()?;
    let duration = event::complex_duration(&scene, settings, event)?;
    let settings = Settings {
        memory: match stored {
            Stored::Steps => settings.memory.max(MEMORY),
            Stored::Motion => 0,
        },
        ..settings.clone()
    };
    let run = simulate(&scene.model, duration, &settings)?;
    Ok((scene, run))
}
