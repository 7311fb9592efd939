//! Conditions on the steps from loads and drives that depend on time.

use super::parts::distinct;
use super::settings::Method;
use crate::math::Scalar;
use crate::model::controller::Controller;
use crate::model::table::{breaks, continuous};
use crate::model::{Model, TimeFunction};

/// Largest step, as a part of the period of the fastest harmonic load.
const PART_OF_PERIOD: f64 = 0.25;

/// All functions of time in the loads and drives of a model.
fn courses<S>(model: &Model<S>) -> impl Iterator<Item = &TimeFunction<S>>
where
    S: Scalar,
{
    let magnitudes = model.loads.iter().filter_map(|load| load.kind.course());
    let drives = model.joints.iter().flat_map(|joint| &joint.drives);
    let controllers = model.controllers().flat_map(Controller::courses);
    magnitudes
        .chain(controllers)
        .chain(drives.map(|drive| &drive.course))
}

/// Whether loads or drives have kinks at some time.
pub fn has_kinks<S: Scalar>(model: &Model<S>) -> bool {
    courses(model).any(|function| {
        matches!(
            function,
            TimeFunction::Table { .. } | TimeFunction::SCurve(_)
        )
    })
}

/// Time of a stage at the fraction `c` of a step of size h from `start`. Among loads or drives with kinks, steps end at
/// these, and the end of a step counts as before the kink: derivatives in time are those within the step.
pub fn stage_time<S: Scalar>((start, h): (S, S), c: f64, kinks: bool) -> S {
    const BEFORE: f64 = 1.0 - 8.0 * f64::EPSILON;
    let time = start + h * c;
    match kinks && c == 1.0 {
        true => time * BEFORE,
        false => time,
    }
}

/// Largest width of a step that harmonic loads and drives allow, as a fraction of the duration.
pub fn widest<S: Scalar>(model: &Model<S>, duration: f64) -> f64 {
    courses(model).fold(1.0, |widest: f64, function| match function {
        TimeFunction::Polynomial(_) | TimeFunction::Table { .. } | TimeFunction::SCurve(_) => {
            widest
        }
        TimeFunction::Harmonic { frequency, .. } => {
            let period = 1.0 / frequency.re().abs();
            widest.min(PART_OF_PERIOD * period / duration)
        }
    })
}

/// Kinks of loads and drives at which steps of a method must end: ascending fractions of the
/// duration. A break of derivative p of a force, inside steps of size h, makes derivatives in the
/// duration wrong by h^p. Formulas start anew at a kink, so only breaks with p below their order
/// count for them, or below two.
pub fn kinks<S: Scalar>(model: &Model<S>, duration: f64, method: Method) -> Vec<f64> {
    let mut all = Vec::new();
    for function in courses(model) {
        // It has three continuous derivatives, but its ends must not be missed.
        if let TimeFunction::SCurve(curve) = function
            && method.is_adaptive()
        {
            all.extend(curve.breaks().map(|at| at / duration));
        }
        let TimeFunction::Table {
            times,
            interpolation,
            smoothness,
            ..
        } = function
        else {
            continue;
        };
        let of = (*interpolation, *smoothness);
        if method.is_adaptive() || continuous(of) + 1 < method.order().max(2) {
            all.extend(breaks(times, of).into_iter().map(|at| at / duration));
        }
    }
    distinct(all)
}
