//! How near the stops and contacts of a scene are, for the control of steps.

use super::{contact, for_each_load, stop};
use crate::math::{Scalar, Vec3};
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

/// What a penetration follows from, with rates. All of it is smooth, also where a body flies past a point.
#[derive(Clone, Copy, Debug)]
pub enum Course {
    /// The penetration itself.
    Depth {
        /// Penetration, negative before the contact \[m or rad\].
        value: f64,
        /// Its rate.
        rate: f64,
    },
    /// A point y and a segment from −a to a at a distance d: the penetration is `side` (`reach` − d).
    Distance {
        /// y \[m\].
        point: Vec3<f64>,
        /// ẏ \[m/s\].
        rate: Vec3<f64>,
        /// a; zero for a point \[m\].
        half: Vec3<f64>,
        /// Distance at which they touch \[m\].
        reach: f64,
        /// 1 if they press when near, −1 when far.
        side: f64,
    },
}

impl Course {
    /// The penetration.
    pub fn penetration(&self) -> f64 {
        match *self {
            Self::Depth { value, .. } => value,
            Self::Distance {
                point,
                half,
                reach,
                side,
                ..
            } => {
                let square = half.norm_squared();
                let along = match square > 0.0 {
                    true => (point.dot(&half) / square).clamp(-1.0, 1.0),
                    false => 0.0,
                };
                side * (reach - (point - half * along).norm())
            }
        }
    }
}

/// Part of the width of an onset before the limit at which the force is felt: 0.7 % of the force at the limit.
const FELT: f64 = 0.25;

/// Whether a load presses only behind a limit.
pub fn may_touch<S>(kind: &LoadKind<S>) -> bool {
    match kind {
        LoadKind::JointStop { .. } | LoadKind::DistanceStop { .. } | LoadKind::Contact(_) => true,
        LoadKind::Force { .. }
        | LoadKind::Torque { .. }
        | LoadKind::Spring { .. }
        | LoadKind::TorsionSpring { .. }
        | LoadKind::Damping { .. }
        | LoadKind::BallDamping { .. }
        | LoadKind::Friction { .. }
        | LoadKind::Drag { .. }
        | LoadKind::Distributed(_) => false,
    }
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
