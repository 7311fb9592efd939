//! How near the stops and contacts of a scene are, for the control of steps.

use super::course::Course;
use super::{contact, for_each_load, stop};
use crate::math::Scalar;
use crate::model::{LoadKind, Model};
use crate::system::bodies::BodyMotion;

/// A place where a load may begin to press.
#[derive(Clone, Copy, Debug)]
pub struct Gap {
    /// The load.
    pub load: usize,
    /// What the penetration follows from.
    pub course: Course,
    /// Penetration at which the force sets in \[m or rad\].
    pub onset: f64,
}

/// Part of the width of an onset before the limit at which the force is felt: 0.7 % of the force at the limit.
const FELT: f64 = 0.25;

/// Whether a load presses only behind a limit.
pub fn may_touch<S>(kind: &LoadKind<S>) -> bool {
    stop::of(kind).is_some() || matches!(kind, LoadKind::Contact(_))
}

/// Lists the gaps of all loads that may touch, always in the same order.
pub fn gaps<S: Scalar>(model: &Model<S>, motions: &[BodyMotion<S>], out: &mut Vec<Gap>) {
    out.clear();
    for_each_load(model, motions, |load, kind, at| {
        let mut add = |course: Course, width: S| {
            out.push(Gap {
                load,
                course,
                onset: -FELT * width.re(),
            });
        };
        if let Some(stop) = stop::of(kind) {
            stop.each_course(at, |course| add(course, stop.width()));
        }
        if let LoadKind::Contact(own) = kind {
            add(contact::course(own, at), own.law.width);
        }
    });
}
