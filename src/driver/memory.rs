//! How much memory a motion takes, and how much of it there is.

use crate::integrate::{IntegrationFailure, Method, Samples, Settings, Spacing};
use crate::model::Model;
use crate::problem::available_memory;
use crate::report::size;
use crate::system::Numbering;

/// Part of the memory that there is that gradients may take, and what they may if that is not known
/// (bytes).
const PART: usize = 2;
const UNKNOWN: usize = 1 << 30;

/// Memory that the tape of one motion may take (bytes), if `given` is for all motions at a time.
pub fn for_gradients(given: Option<usize>) -> usize {
    let all = given.unwrap_or_else(|| available_memory().map_or(UNKNOWN, |bytes| bytes / PART));
    (all / rayon::current_num_threads().max(1)).max(1)
}

/// What a body takes beside its states: inertia, markers, factors (bytes).
const OF_BODY: usize = 4000;
/// Stages of a step that are worked on.
const STAGES: usize = 16;
/// Less than this is not asked for (bytes).
const LITTLE: usize = 1 << 26;

/// Refuses a run that takes more memory than there is. What is kept for gradients counts as far as it
/// is filled.
///
/// # Errors
/// [`IntegrationFailure::Memory`].
pub(super) fn admit(model: &Model<f64>, settings: &Settings) -> Result<(), IntegrationFailure> {
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
    // A sample stands at an instant and at a place among the steps.
    let of_sample = (nq + 2 * nv + nc + 4) * number;
    let of_step = STAGES * 2 * (nq + nv + nc) * number;
    let of_samples = samples.saturating_mul(of_sample);
    // Ends of the steps, of the run and of what it follows.
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
