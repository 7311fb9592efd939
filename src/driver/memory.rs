//! Memory of a motion, and available memory.

use crate::integrate::{IntegrationFailure, Method, Samples, Settings, Spacing};
use crate::model::Model;
use crate::problem::available_memory;
use crate::report::size;
use crate::system::{Numbering, flexible};

/// Part of the available memory that gradients may use, and the limit if that is unknown \[bytes\].
const PART: usize = 2;
const UNKNOWN: usize = 1 << 30;

/// Memory limit of the tapes of all concurrent motions of this process \[bytes\], unless one is given.
pub fn usual() -> usize {
    available_memory().map_or(UNKNOWN, |bytes| bytes / PART)
}

/// Memory limit of the tape of one motion \[bytes\], if `given` is for all concurrent motions.
pub fn for_gradients(given: Option<usize>) -> usize {
    let all = given.unwrap_or_else(usual);
    (all / rayon::current_num_threads().max(1)).max(1)
}

/// Memory of a body besides its states: inertia, markers, factors \[bytes\].
const OF_BODY: usize = 4000;
/// Number of stages of a step in memory.
const STAGES: usize = 16;
/// Memory below this is not checked \[bytes\].
const LITTLE: usize = 1 << 26;

/// Rejects a run that needs more memory than available. Memory for gradients counts as far as it is
/// used.
///
/// # Errors
/// [`IntegrationFailure::Memory`].
pub(super) fn admit(model: &Model<f64>, settings: &Settings) -> Result<(), IntegrationFailure> {
    // Of several ranks none goes alone.
    if !flexible::team(model).is_alone() {
        return Ok(());
    }
    let numbering = Numbering::new(model);
    let (nq, nv) = (numbering.positions(), numbering.velocities());
    let nc = numbering.constraints();
    let steps = match &settings.spacing {
        Spacing::Steps(steps) => *steps,
        Spacing::Frozen(grid) => grid.steps(),
        Spacing::Tolerance(_) => 0,
    };
    let grid = match &settings.spacing {
        Spacing::Frozen(grid) => Some(grid),
        Spacing::Steps(_) | Spacing::Tolerance(_) => None,
    };
    let samples = match (settings.samples, settings.method) {
        (samples, Method::Dop853 | Method::Radau { .. }) => samples.count(steps, grid),
        (Samples::Uniform(1), _) => 1,
        (Samples::StepEnds | Samples::Uniform(_) | Samples::Quadrature(_), _) => steps,
    } + 1;
    let number = size_of::<f64>();
    // A sample has an instant and a position among the steps.
    let of_sample = (nq + 2 * nv + nc + 4) * number;
    let of_step = STAGES * 2 * (nq + nv + nc) * number;
    let of_samples = samples.saturating_mul(of_sample);
    // Ends of the steps, of this run and of the one that it follows.
    let needed = of_samples
        .saturating_add(2 * steps * number)
        .saturating_add(of_step + numbering.bodies() * OF_BODY)
        .saturating_add(settings.memory.min(steps.saturating_mul(of_step)));
    if needed <= LITTLE {
        return Ok(());
    }
    match available_memory() {
        Some(available) if needed > available => Err(IntegrationFailure::Memory {
            needed: size(needed),
            available: size(available),
            samples,
            bodies: numbering.bodies(),
            of_samples: size(of_samples),
            hint: match settings.memory > available / PART {
                true => ", or less --memory",
                false => "",
            },
        }),
        _ => Ok(()),
    }
}
