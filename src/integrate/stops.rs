//! Conditions on the steps from loads and drives that depend on time.

use crate::math::Scalar;
use crate::model::table::breaks;
use crate::model::{Model, TimeFunction};

/// Largest step, as a part of the period of the fastest harmonic load.
const PART_OF_PERIOD: f64 = 0.25;

/// Conditions on the steps from loads and drives: ascending fractions of the duration at which
/// steps must end, and the largest width.
pub(crate) fn load_steps<S: Scalar>(model: &Model<S>, duration: f64) -> (Vec<f64>, f64) {
    let mut stops = Vec::new();
    let mut widest = 1.0_f64;
    let magnitudes = model.loads.iter().filter_map(|load| load.kind.course());
    let drives = model.joints.iter().flat_map(|joint| &joint.drives);
    for function in magnitudes.chain(drives.map(|drive| &drive.course)) {
        match function {
            TimeFunction::Polynomial(_) => {}
            TimeFunction::Harmonic { frequency, .. } => {
                let period = 1.0 / frequency.re().abs();
                widest = widest.min(PART_OF_PERIOD * period / duration);
            }
            TimeFunction::Table {
                times,
                interpolation,
                smoothness,
                ..
            } => stops.extend(breaks(times, (*interpolation, *smoothness))),
        }
    }
    stops.iter_mut().for_each(|at| *at /= duration);
    stops.retain(|&at| at > 0.0 && at < 1.0);
    stops.sort_by(f64::total_cmp);
    (stops, widest)
}
