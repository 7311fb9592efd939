//! Characteristic lengths of the parts of a model: the scales of distances.

use crate::math::{Scalar, Vec3};
use crate::model::Model;
use crate::system::placement::length_scale;

/// Characteristic lengths \[m\]. A distance is round-off if it is small relative to them.
pub(super) struct Reach {
    /// By body: the largest of its distance from the origin, the lever arms of its joints, and
    /// those of the bodies that these joints connect it with.
    bodies: Vec<f64>,
    whole: f64,
}

impl Reach {
    pub fn new<S: Scalar>(model: &Model<S>) -> Self {
        let bodies = model.bodies.iter();
        let mut own: Vec<f64> = bodies.map(|body| largest(&body.position)).collect();
        for joint in &model.joints {
            let arm = largest(&joint.frame_a.point).max(largest(&joint.frame_b.point));
            for body in [Some(joint.body_a), joint.body_b].into_iter().flatten() {
                own[body] = own[body].max(arm);
            }
        }
        let mut bodies = own.clone();
        for joint in &model.joints {
            let Some(b) = joint.body_b else { continue };
            bodies[joint.body_a] = bodies[joint.body_a].max(own[b]);
            bodies[b] = bodies[b].max(own[joint.body_a]);
        }
        Self {
            bodies,
            whole: length_scale(model),
        }
    }

    /// Characteristic length of the given bodies \[m\]; that of the whole model if theirs is zero.
    pub fn of(&self, bodies: [Option<usize>; 2]) -> f64 {
        let own = bodies.into_iter().flatten().map(|body| self.bodies[body]);
        let longest = own.fold(0.0, f64::max);
        if longest > 0.0 { longest } else { self.whole }
    }
}

/// Absolute value of the largest component.
pub(super) fn largest<S: Scalar>(v: &Vec3<S>) -> f64 {
    v.iter().fold(0.0, |m, x| m.max(x.re().abs()))
}
