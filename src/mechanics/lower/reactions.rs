//! Reactions that functions observe, and the reductions that would lose them.

use super::examine::{ConditionChecker, Verdict, ViolatedCondition};
use crate::functions::Scene;
use crate::math::scalar::lift3;
use crate::math::{Scalar, Vec3, rotation};
use crate::model::{Axes, Model};
use crate::system::measures::{Wrench, WrenchPart};
use crate::system::redundancy;

/// The reactions that the functions and the event of a scene observe.
pub(super) fn observed<S: Scalar>(scene: &Scene<S>) -> impl Iterator<Item = &Wrench<S>> {
    let event = scene.until.iter().map(|until| &until.measure);
    let all = scene.functions.iter().chain(event);
    all.flat_map(|function| function.reactions())
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

/// The normal of a plane in the axes of the direction of a reaction.
fn normal_of<S: Scalar>(model: &Model<S>, wrench: &Wrench<S>, normal: &Vec3<f64>) -> Vec3<S> {
    let normal: Vec3<S> = lift3(normal);
    match wrench.axes {
        Axes::Ground => normal,
        Axes::Body => {
            let body = &model.bodies[model.joints[wrench.joint].body_a];
            rotation::matrix(&body.orientation).tr_mul(&normal)
        }
    }
}

/// Examines whether a plane keeps all reactions that functions observe: moments along its normal, and
/// forces in it. Across it the joints of a tree bear no force. Those of a loop may.
pub(super) fn in_plane<S: Scalar>(scene: &Scene<S>, normal: &Vec3<f64>, change: f64) -> Verdict {
    let mut examiner = ConditionChecker::new(change);
    let model = &scene.model;
    let mut loops = None;
    for wrench in observed(scene) {
        let joint = &model.joints[wrench.joint];
        let normal = normal_of(model, wrench, normal);
        let size = wrench.direction.map(|x| x.re()).norm();
        let what = |part: &str| {
            let name = &joint.name;
            let what = format!("a function observes a {part} across the plane of joint \"{name}\"");
            (what, "")
        };
        match wrench.part {
            WrenchPart::Moment => {
                let across = wrench.direction.cross(&normal);
                examiner.vanishes(across.as_slice(), size, || what("moment"));
            }
            WrenchPart::Force => {
                let loops = loops.get_or_insert_with(|| redundancy::in_loops(model));
                if loops.contains(&wrench.joint) {
                    examiner.zero(wrench.direction.dot(&normal), size, || what("force"));
                }
            }
        }
    }
    examiner.verdict()
}

/// Turns the directions of observed forces into a plane that [`in_plane`] admits. In a plane the
/// multipliers of a joint determine its force but for a part along the normal, which is zero.
pub(super) fn turn_into_plane<S: Scalar>(scene: &mut Scene<S>, normal: &Vec3<f64>) {
    let model = &scene.model;
    let event = scene.until.iter_mut().map(|until| &mut until.measure);
    let all = scene.functions.iter_mut().chain(event);
    for wrench in all.flat_map(|function| function.reactions_mut()) {
        if wrench.part == WrenchPart::Force {
            let normal = normal_of(model, wrench, normal);
            wrench.direction -= normal * normal.dot(&wrench.direction);
        }
    }
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
