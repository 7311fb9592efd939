//! Positions of joints at the present poses of their bodies, and the rigid motions that change them.

use crate::math::rotation::{Quat, compose, matrix};
use crate::math::{Mat3, Scalar, Vec3};
use crate::model::{DegreeOfFreedom, JointFrame, Model, RigidBody};

/// A rigid motion of a body: x ↦ R x + shift.
#[derive(Clone, Copy, Debug)]
pub(super) struct Move<S> {
    pub turn: Quat<S>,
    pub rotation: Mat3<S>,
    pub shift: Vec3<S>,
}

impl<S: Scalar> Move<S> {
    /// Composition: first `first`, then this motion.
    pub(super) fn after(&self, first: &Self) -> Self {
        Self {
            turn: compose(&self.turn, &first.turn),
            rotation: self.rotation * first.rotation,
            shift: self.rotation * first.shift + self.shift,
        }
    }

    pub(super) fn apply(&self, body: &mut RigidBody<S>) {
        body.position = self.rotation * body.position + self.shift;
        body.orientation = compose(&self.turn, &body.orientation);
    }
}

/// A joint in no loop, relative to the body beyond it.
pub(super) struct Hinge<S> {
    /// Its axis on the near body, ground axes.
    pub axis: Vec3<S>,
    /// Its point on the body beyond it, ground axes \[m\].
    pub point: Vec3<S>,
    /// 1 if the body beyond it is body A, whose motion relative to B is that of the joint; else −1.
    pub sign: S,
}

/// The [`Hinge`] of a joint in no loop with the body `beyond` it.
pub(super) fn hinge<S: Scalar>(model: &Model<S>, joint: usize, beyond: usize) -> Hinge<S> {
    let [a, b] = frames(model, joint);
    let first = model.joints[joint].body_a == beyond;
    let (near, far) = if first { (b, a) } else { (a, b) };
    Hinge {
        axis: near.axes[2],
        point: far.point,
        sign: S::from(if first { 1.0 } else { -1.0 }),
    }
}

/// The frames of a joint in ground axes, at the present poses of the bodies.
fn frames<S: Scalar>(model: &Model<S>, joint: usize) -> [JointFrame<S>; 2] {
    let joint = &model.joints[joint];
    let on = |body: &RigidBody<S>, frame: &JointFrame<S>| {
        let rotation = matrix(&body.orientation);
        JointFrame {
            point: body.position + rotation * frame.point,
            axes: frame.axes.map(|axis| rotation * axis),
            length: frame.length,
        }
    };
    let b = joint
        .body_b
        .map(|body| on(&model.bodies[body], &joint.frame_b));
    [
        on(&model.bodies[joint.body_a], &joint.frame_a),
        b.unwrap_or(joint.frame_b),
    ]
}

/// The angle \[rad\] or displacement \[m\] of a joint at the present poses of the bodies.
pub(super) fn place<S: Scalar>(model: &Model<S>, joint: usize, dof: DegreeOfFreedom) -> S {
    let [a, b] = frames(model, joint);
    match dof {
        DegreeOfFreedom::Rotation => (a.axes[0].dot(&b.axes[1])).atan2(a.axes[0].dot(&b.axes[0])),
        DegreeOfFreedom::Translation => b.axes[2].dot(&(a.point - b.point)),
    }
}
