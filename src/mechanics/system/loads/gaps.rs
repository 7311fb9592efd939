//! How near the stops, contacts and slack cables of a scene are, for the control of steps.

use super::{cable, contact, for_loads, stop};
use crate::math::{Scalar, Vec3};
use crate::model::{LoadKind, Model};
use crate::system::bodies::BodyMotion;

/// A place where a load may begin to press.
#[derive(Clone, Copy, Debug)]
pub struct Gap {
    /// The load.
    pub load: usize,
    /// Penetration, negative before the contact \[m or rad\].
    pub penetration: f64,
    /// Bound of its rate.
    pub speed: f64,
    /// Penetration at which the force sets in \[m or rad\].
    pub onset: f64,
    /// The normal of a contact, in ground axes; zero of others.
    pub normal: Vec3<f64>,
}

/// Part of the width of an onset before the limit at which the force is felt: 0.7 % of the force at the limit.
const FELT: f64 = 0.25;

/// Where a gap is in the onset of its force, which is smooth within each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// There is no force.
    Apart,
    /// Within the width of the onset.
    Onset,
    /// Behind it.
    Pressed,
}

impl Gap {
    /// Where the gap is in the onset.
    pub fn phase(&self) -> Phase {
        let half = -0.5 * self.onset / FELT;
        match self.penetration {
            depth if depth <= -half => Phase::Apart,
            depth if depth < half => Phase::Onset,
            _ => Phase::Pressed,
        }
    }
}

/// Whether a load presses only behind a limit.
pub fn may_touch<S>(kind: &LoadKind<S>) -> bool {
    stop::of(kind).is_some() || matches!(kind, LoadKind::Contact(_) | LoadKind::Cable(_))
}

/// Lists the gaps at `time` of those of the loads `of` that may touch, always in the same order.
pub fn gaps<S: Scalar>(
    model: &Model<S>,
    (motions, time): (&[BodyMotion<S>], f64),
    of: impl Iterator<Item = usize> + Clone,
    out: &mut Vec<Gap>,
) {
    out.clear();
    for_loads(model, motions, of.clone(), |load, kind, at| {
        let mut add = |penetration: f64, speed: f64, width: S, normal: Vec3<f64>| {
            out.push(Gap {
                load,
                penetration,
                speed,
                onset: -FELT * width.re(),
                normal,
            });
        };
        if let Some(stop) = stop::of(kind) {
            let none = Vec3::zeros();
            stop.each_gap(at, |depth, speed| add(depth, speed, stop.width(), none));
        }
        if let LoadKind::Contact(own) = kind {
            let (depth, normal) = contact::place(own, at);
            let normal = normal.map(|x| x.re());
            add(depth.re(), contact::speed(own, at), own.law.width, normal);
        }
    });
    for load in of {
        if let LoadKind::Cable(own) = &model.loads[load].kind {
            let [penetration, speed] = cable::gap(own, motions, time.into());
            out.push(Gap {
                load,
                penetration,
                speed,
                onset: -FELT * own.law.width.re(),
                normal: Vec3::zeros(),
            });
        }
    }
}
