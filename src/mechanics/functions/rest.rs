//! Zeros of norms: of the speed of a point and of the length of a spring. They have kinks there, in time as
//! |v| ~ |t − t0|, and in the design.

use super::function::{Function, Reduction};
use super::instant::Instant;
use super::quantity::Quantity;
use super::samples::sample;
use super::snapshot::Snapshot;
use crate::integrate::Trajectory;
use crate::math::Vec3;
use crate::model::Model;
use crate::system::loads::measured::{LoadMeasure, LoadPart};
use crate::system::placement::length_scale;

/// Smallest speed, relative to the change of velocity between two samples, that the samples
/// distinguish from a kink.
const CLOSE: f64 = 0.05;

/// The norm on which `function` depends, by name, if it is zero wherever the function looks: at the end, or over
/// the whole run. The function has no derivative by the design then. `part` is the largest zero, relative to
/// the size of the scene and the duration.
pub fn vanishing(
    function: &Function<f64>,
    model: &Model<f64>,
    run: &Trajectory<f64>,
    part: f64,
) -> Option<&'static str> {
    let Function::Reduced {
        of: Quantity::Of(instant),
        during: None,
        reduction,
    } = function
    else {
        return None;
    };
    let length = length_scale(model);
    let (norm, name, size) = match instant {
        Instant::Speed { .. } => (instant.clone(), "speed", length / run.duration),
        Instant::Load(LoadMeasure {
            load,
            part: LoadPart::Length | LoadPart::Tension,
        }) => {
            let (load, part) = (*load, LoadPart::Length);
            (
                Instant::Load(LoadMeasure { load, part }),
                "length of the spring",
                length,
            )
        }
        _ => return None,
    };
    let values = sample(&norm, model, run);
    let first = match reduction {
        Reduction::Final => run.last(),
        Reduction::Integral
        | Reduction::Mean
        | Reduction::Damage { .. }
        | Reduction::Ks { .. }
        | Reduction::InducedExponential { .. } => 0,
    };
    let zero = |value: &f64| value.abs() <= part * size;
    values[first..].iter().all(zero).then_some(name)
}

/// The first time \[s\] at which a speed that `function` reduces over the run vanishes, if this
/// affects its value. Start and end of a run do not count: the speed is smooth up to them.
pub fn passes_rest(
    function: &Function<f64>,
    model: &Model<f64>,
    run: &Trajectory<f64>,
) -> Option<f64> {
    let Function::Reduced {
        of: Quantity::Of(Instant::Speed { body, point }),
        during: None,
        reduction,
    } = function
    else {
        return None;
    };
    let velocity = |k| {
        let motion = Snapshot::of(model, run, k).motion(*body);
        motion.point_velocity(point)
    };
    let all: Vec<Vec3<f64>> = (0..=run.last()).map(velocity).collect();
    let fastest = all.iter().map(Vec3::norm).fold(0.0, f64::max);
    // The weight of an instant at rest relative to that of the largest speed.
    let counts = match reduction {
        Reduction::Final => false,
        Reduction::Integral | Reduction::Mean | Reduction::Damage { .. } => true,
        Reduction::Ks { rho, .. } | Reduction::InducedExponential { rho } => {
            (-rho * fastest).exp() > f64::EPSILON
        }
    };
    if !counts {
        return None;
    }
    let last = all.len() - 1;
    (1..=last).find_map(|k| {
        let (before, change) = (all[k - 1], all[k] - all[k - 1]);
        let square = change.norm_squared();
        let part = -before.dot(&change) / square;
        let inside = (k > 1 || part > CLOSE) && (k < last || part < 1.0 - CLOSE);
        let nearest = (before + change * part).norm_squared();
        let close = nearest < CLOSE * CLOSE * square;
        let (t0, t1) = (run.time(k - 1), run.time(k));
        ((0.0..=1.0).contains(&part) && inside && close).then_some(t0 + part * (t1 - t0))
    })
}
