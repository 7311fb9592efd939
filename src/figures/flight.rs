//! The release of a projectile and its flight.

use crate::driver::Simulation;
use crate::functions::samples::sample;
use crate::functions::snapshot::Snapshot;
use crate::functions::{Function, Instant, Quantity, Reduction};
use crate::plots::Flight;
use crate::problem::{Drawing, Trace};

/// A projectile that is let go.
pub(super) struct Release {
    /// Sample of the motion at which it is let go.
    pub sample: usize,
    /// Its point.
    pub projectile: Trace,
    /// What it does afterwards, along the axes of the view.
    pub flight: Flight,
}

/// The release of a design: at the end of the run, or where the gated range is largest. `None` if no
/// function of the scene that the objective needs is a range, or if gravity does not point down in the view.
pub(super) fn release(
    simulation: &Simulation,
    drawing: &Drawing,
    objective: Option<&[usize]>,
) -> Option<Release> {
    let (written, run) = (&simulation.written, simulation.motion());
    let (model, functions) = (&written.model, &written.functions);
    if drawing.up.dot(&model.gravity) >= -0.999 * model.gravity.norm() {
        return None;
    }
    let all: Vec<usize> = (0..functions.len()).collect();
    let mut which = objective.unwrap_or(&all).iter();
    let (sample, thrown) = which.find_map(|&f| {
        let Function::Reduced {
            of: Quantity::Of(instant @ Instant::Range { projectile, .. }),
            during: None,
            reduction,
        } = functions.get(f)?
        else {
            return None;
        };
        if *reduction == Reduction::Final {
            return Some((run.last(), *projectile));
        }
        let values = sample(instant, model, run);
        let best = (0..values.len()).reduce(|b, k| if values[k] > values[b] { k } else { b })?;
        Some((best, *projectile))
    })?;
    let motion = Snapshot::of(model, run, sample).motion(thrown.body);
    Some(Release {
        sample,
        flight: Flight {
            position: drawing.flat(&motion.point(&thrown.point)),
            velocity: drawing.flat(&motion.point_velocity(&thrown.point)),
            gravity: -drawing.up.dot(&model.gravity),
        },
        projectile: Trace {
            name: String::new(),
            body: thrown.body,
            point: thrown.point,
            by: Vec::new(),
        },
    })
}
