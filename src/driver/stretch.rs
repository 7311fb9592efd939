//! The first stretch of a long motion, from which the whole is estimated.

use super::integration::Integration;
use crate::functions::Scene;
use crate::integrate::{
    Chosen, IntegrationFailure, Samples, Settings, Spacing, Trajectory, simulate_by,
};

/// Limit of steps times bodies to explain a motion, and least number of steps.
const WORK: usize = 20_000;
const LEAST: usize = 4;
/// Least number of steps with elastic bodies, if the method is chosen by measuring it.
const LEAST_FLEXIBLE: usize = 250;
/// The first part of a motion to try, and the largest growth of the next one.
const FIRST: f64 = 1e-3;
const LONGER: f64 = 10.0;

/// A stretch of a motion.
pub(super) struct Stretch {
    /// The part of the duration.
    pub part: f64,
    /// The run.
    pub run: Trajectory<f64>,
    /// Why its method was chosen.
    pub reason: String,
    /// Steps of the whole motion, estimated.
    pub steps: usize,
    /// Samples of the whole motion.
    pub samples: usize,
}

/// The first stretch of the motion of `scene`, if the whole takes too many steps to be explained.
///
/// # Errors
/// If its simulation fails.
pub(super) fn of_long(
    scene: &Scene<f64>,
    integration: &Integration,
) -> Result<Option<Stretch>, IntegrationFailure> {
    let measured = integration.method().is_none() && !scene.model.flexible.is_empty();
    let least = if measured { LEAST_FLEXIBLE } else { LEAST };
    let most = (WORK / scene.model.bodies.len().max(1)).max(least);
    let wanted = integration.wanted();
    let run = |part: f64, settings: &Settings| {
        simulate_by(
            &scene.model,
            scene.duration * part,
            integration.method(),
            settings,
        )
    };
    let stretch = |part: f64, chosen: Chosen<f64>, steps: usize| Stretch {
        part,
        steps,
        samples: match wanted.samples {
            Samples::StepEnds => steps,
            Samples::Uniform(samples) => samples,
            Samples::Quadrature(_) => {
                let each = chosen.run.last() as f64 / chosen.run.grid.steps() as f64;
                (each * steps as f64) as usize
            }
        },
        reason: chosen.reason,
        run: chosen.run,
    };
    let given = match &wanted.spacing {
        Spacing::Steps(steps) => Some(*steps),
        Spacing::Frozen(grid) => Some(grid.steps()),
        Spacing::Tolerance(_) => None,
    };
    if let Some(steps) = given {
        if steps <= most {
            return Ok(None);
        }
        let part = most as f64 / steps as f64;
        let spacing = Spacing::Steps(most);
        let settings = Settings { spacing, ..wanted };
        return Ok(Some(stretch(part, run(part, &settings)?, steps)));
    }
    let mut part = FIRST;
    loop {
        let chosen = run(part, &wanted)?;
        let made = chosen.run.grid.steps();
        if made >= most / 2 {
            let steps = (made as f64 / part).ceil() as usize;
            return Ok(Some(stretch(part, chosen, steps)));
        }
        part *= (most as f64 / made.max(1) as f64).clamp(2.0, LONGER);
        if part >= 1.0 {
            return Ok(None);
        }
    }
}
