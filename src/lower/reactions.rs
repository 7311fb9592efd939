//! Reactions that functions observe, and the reductions that would lose them.

use super::examine::{ConditionChecker, Verdict, ViolatedCondition};
use crate::functions::Scene;
use crate::math::scalar::lift3;
use crate::math::{Scalar, Vec3, rotation};
use crate::model::Axes;
use crate::system::measures::{Wrench, WrenchPart};

/// The reactions that the functions and the event of a scene observe.
pub(super) fn observed<S: Scalar>(scene: &Scene<S>) -> impl Iterator<Item = &Wrench<S>> {
    let event = scene.until.iter().map(|until| &until.measure);
    let all = scene.functions.iter().chain(event);
    all.filter_map(|function| function.reaction())
}

/// The bodies whose rotation turns the direction of the reaction, or the moment.
pub(super) fn turning<S: Scalar>(scene: &Scene<S>, wrench: &Wrench<S>) -> Vec<usize> {
    let joint = &scene.model.joints[wrench.joint];
    match (wrench.part, wrench.axes) {
        (WrenchPart::Force, Axes::Ground) => Vec::new(),
        (WrenchPart::Force, Axes::Body) => vec![joint.body_a],
        (WrenchPart::Moment, Axes::Ground | Axes::Body) => {
            let ends = [Some(joint.body_a), joint.body_b];
            ends.into_iter().flatten().collect()
        }
    }
}

/// Examines whether all moments that functions observe are along the normal of a plane.
pub(super) fn in_plane<S: Scalar>(scene: &Scene<S>, normal: &Vec3<f64>, change: f64) -> Verdict {
    let mut examiner = ConditionChecker::new(change);
    let moments = observed(scene).filter(|wrench| wrench.part == WrenchPart::Moment);
    for wrench in moments {
        let joint = &scene.model.joints[wrench.joint];
        let normal: Vec3<S> = lift3(normal);
        let normal = match wrench.axes {
            Axes::Ground => normal,
            Axes::Body => {
                let body = &scene.model.bodies[joint.body_a];
                rotation::matrix(&body.orientation).tr_mul(&normal)
            }
        };
        let size = wrench.direction.map(|x| x.re()).norm();
        examiner.vanishes(wrench.direction.cross(&normal).as_slice(), size, || {
            let what = "a function observes a moment across the plane of joint";
            (format!("{what} \"{}\"", joint.name), "")
        });
    }
    examiner.verdict()
}

/// A violated condition for each observed reaction of a joint that `lost` names.
pub(super) fn kept<S: Scalar>(
    scene: &Scene<S>,
    lost: impl Fn(&Wrench<S>) -> bool,
) -> Vec<ViolatedCondition> {
    let lost = observed(scene).filter(|wrench| lost(wrench));
    let mut joints: Vec<usize> = lost.map(|wrench| wrench.joint).collect();
    joints.sort_unstable();
    joints.dedup();
    let told = joints.into_iter().map(|j| {
        let name = &scene.model.joints[j].name;
        ViolatedCondition::plain(format!(
            "a function observes the reaction of joint \"{name}\""
        ))
    });
    told.collect()
}
