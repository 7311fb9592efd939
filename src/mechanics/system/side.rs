//! The two sides of a joint at an instant: the motion of the body, and the joint's frame on it,
//! which drives may move.
//!
//! A frame on body B with rotation φ and displacement σ (see [`crate::model::drive`]) has
//!
//! ```text
//! ė1 = φ̇ e2,  ë1 = φ̈ e2 − φ̇² e1,  ė2 = −φ̇ e1,  ë2 = −φ̈ e1 − φ̇² e2,  ṡ = σ̇ e3,  s̈ = σ̈ e3
//! ```

use super::attachment::deformed_frame;
use super::bodies::BodyMotion;
use super::frame_motion::FrameMotion;
use super::marker::MarkerKinematics;
use crate::math::{Scalar, Vec3};
use crate::model::{DegreeOfFreedom, Joint, JointFrame};

/// One side of a joint.
#[derive(Clone, Debug)]
pub struct JointSide<'a, S> {
    /// Motion of the body, or of ground.
    pub motion: &'a BodyMotion<S>,
    /// The joint's frame on the body at this instant.
    pub frame: JointFrame<S>,
    /// Motion of the frame on the body, if it moves.
    pub moving: Option<FrameMotion<S>>,
    /// The frame on the undeformed body, if the body deforms under it.
    pub undeformed: Option<JointFrame<S>>,
}

impl<'a, S: Scalar> JointSide<'a, S> {
    /// A side with a fixed frame.
    pub fn fixed(motion: &'a BodyMotion<S>, frame: JointFrame<S>) -> Self {
        Self {
            motion,
            frame,
            moving: None,
            undeformed: None,
        }
    }

    /// Axis i in ground axes.
    pub fn axis(&self, i: usize) -> Vec3<S> {
        self.motion.rotation * self.frame.axes[i]
    }

    /// The point in ground axes.
    pub fn point(&self) -> Vec3<S> {
        self.motion.position + self.motion.rotation * self.frame.point
    }

    /// Axis i as a marker.
    pub fn axis_jet(&self, i: usize) -> MarkerKinematics<S> {
        let local = self.moving.as_ref().map(|moving| moving.axis(i));
        MarkerKinematics::moving_direction(self.motion, &self.frame.axes[i], local.as_ref())
    }

    /// The point as a marker.
    pub fn point_jet(&self) -> MarkerKinematics<S> {
        let local = self.moving.as_ref().map(|moving| moving.point());
        MarkerKinematics::moving_point(self.motion, &self.frame.point, local.as_ref())
    }
}

/// Both sides of a joint at `time` \[s\]; `ground` is the motion of a missing body B.
pub fn sides<'a, S: Scalar>(
    joint: &Joint<S>,
    motions: &'a [BodyMotion<S>],
    ground: &'a BodyMotion<S>,
    time: S,
) -> (JointSide<'a, S>, JointSide<'a, S>) {
    let motion_b = joint.body_b.map_or(ground, |body| &motions[body]);
    let mut b = JointSide::fixed(motion_b, joint.frame_b);
    if !joint.drives.is_empty() {
        let (frame, moving) = driven_frame(joint, time);
        b.frame = frame;
        b.moving = Some(moving);
    }
    let mut a = JointSide::fixed(&motions[joint.body_a], joint.frame_a);
    if let Some(modes) = &joint.modes {
        let (frame, moving) = deformed_frame(&joint.frame_a, modes, motions);
        a.undeformed = Some(joint.frame_a);
        a.frame = frame;
        a.moving = Some(moving);
    }
    (a, b)
}

/// The prescribed motions of the joint at `time`: (rotation, displacement), zero without a drive.
fn courses<S: Scalar>(joint: &Joint<S>, time: S) -> ([S; 4], [S; 4]) {
    let zero = [S::zero(); 4];
    let (mut turn, mut slide) = (zero, zero);
    for drive in &joint.drives {
        let at = drive.course.derivatives(time);
        match drive.dof {
            DegreeOfFreedom::Rotation => turn = at,
            DegreeOfFreedom::Translation => slide = at,
        }
    }
    (turn, slide)
}

/// The frame on body B of a driven joint at `time`, and its motion.
fn driven_frame<S: Scalar>(joint: &Joint<S>, time: S) -> (JointFrame<S>, FrameMotion<S>) {
    let ([turn, spin, spin_up, _], [shift, speed, speed_up, _]) = courses(joint, time);
    let mut frame = joint.frame_b;
    let [e1, e2, e3] = frame.axes;
    let (sine, cosine) = turn.sin_cos();
    let (e1, e2) = (e1 * cosine + e2 * sine, e2 * cosine - e1 * sine);
    frame.axes = [e1, e2, e3];
    frame.point += e3 * shift;
    let square = spin * spin;
    let mut moving = FrameMotion::zero();
    moving.rate.axes = [e2 * spin, -e1 * spin, Vec3::zeros()];
    moving.rate.point = e3 * speed;
    moving.acceleration.axes = [
        e2 * spin_up - e1 * square,
        -e1 * spin_up - e2 * square,
        Vec3::zeros(),
    ];
    moving.acceleration.point = e3 * speed_up;
    (frame, moving)
}

/// Pulls the cotangents of the frame on body B at `time` and of its motion back to the joint's
/// parameters (added to `own`). Returns the derivative in time.
pub fn pull_driven_frame(
    joint: &Joint<f64>,
    time: f64,
    by_frame: &JointFrame<f64>,
    by_motion: &FrameMotion<f64>,
    own: &mut Joint<f64>,
) -> f64 {
    let (turn, slide) = courses(joint, time);
    let [angle, spin, spin_up, _] = turn;
    let (frame, _) = driven_frame(joint, time);
    let [e1, e2, e3] = frame.axes;
    let (x, r, a) = (by_frame, &by_motion.rate, &by_motion.acceleration);
    let square = spin * spin;
    // Cotangents of the turned axes, through themselves and their derivatives.
    let by_e1 = x.axes[0] - r.axes[1] * spin - a.axes[1] * spin_up - a.axes[0] * square;
    let by_e2 = x.axes[1] + r.axes[0] * spin + a.axes[0] * spin_up - a.axes[1] * square;
    let weights_turn = [
        by_e1.dot(&e2) - by_e2.dot(&e1),
        r.axes[0].dot(&e2)
            - r.axes[1].dot(&e1)
            - 2.0 * spin * (a.axes[0].dot(&e1) + a.axes[1].dot(&e2)),
        a.axes[0].dot(&e2) - a.axes[1].dot(&e1),
    ];
    let weights_slide = [x.point.dot(&e3), r.point.dot(&e3), a.point.dot(&e3)];
    let (sine, cosine) = angle.sin_cos();
    let along = x.point * slide[0] + r.point * slide[1] + a.point * slide[2];
    own.frame_b.add(&JointFrame {
        point: x.point,
        axes: [
            by_e1 * cosine - by_e2 * sine,
            by_e1 * sine + by_e2 * cosine,
            x.axes[2] + along,
        ],
        length: x.length,
    });
    let mut by_time = 0.0;
    for (drive, own) in joint.drives.iter().zip(&mut own.drives) {
        let weights = match drive.dof {
            DegreeOfFreedom::Rotation => weights_turn,
            DegreeOfFreedom::Translation => weights_slide,
        };
        by_time += drive.course.pull_back(time, weights, &mut own.course);
    }
    by_time
}
