//! The two sides of a joint at an instant: the motion of the body, and the joint's frame on it,
//! which drives and couplings may move.
//!
//! A frame on body B with rotation φ and displacement σ (see [`crate::model::drive`] and [`crate::model::coupling`]) has
//!
//! ```text
//! ė1 = φ̇ e2,  ë1 = φ̈ e2 − φ̇² e1,  ė2 = −φ̇ e1,  ë2 = −φ̈ e1 − φ̇² e2,  ṡ = σ̇ e3,  s̈ = σ̈ e3
//! ```

use super::attachment::{self, deformed_frame};
use super::bodies::BodyMotion;
use super::frame_motion::FrameMotion;
use super::marker::MarkerKinematics;
use super::numbering::Numbering;
use crate::math::{Scalar, Vec3};
use crate::model::{DegreeOfFreedom, Joint, JointFrame, JointKind, Modes};

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
    /// The derivative of the motion of a frame that follows coordinates of a coupling, by their sum: 1, or f' of a cam.
    pub follows: Option<S>,
}

impl<'a, S: Scalar> JointSide<'a, S> {
    /// A side with a fixed frame.
    pub fn fixed(motion: &'a BodyMotion<S>, frame: JointFrame<S>) -> Self {
        Self {
            motion,
            frame,
            moving: None,
            undeformed: None,
            follows: None,
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
        let (frame, moving) = moved_frame(&joint.frame_b, &prescribed(joint, time));
        b.frame = frame;
        b.moving = Some(moving);
    }
    let mut a = JointSide::fixed(&motions[joint.body_a], joint.frame_a);
    match &joint.modes {
        Some(modes) if joint.is_coupled() => {
            let (course, slope) = followed(joint.kind, modes, motions);
            let (frame, moving) = moved_frame(&joint.frame_b, &course);
            b.frame = frame;
            b.moving = Some(moving);
            b.follows = Some(slope);
        }
        Some(modes) => {
            let (frame, moving) = deformed_frame(&joint.frame_a, modes, motions);
            a.undeformed = Some(joint.frame_a);
            a.frame = frame;
            a.moving = Some(moving);
        }
        None => {}
    }
    (a, b)
}

/// Rotation φ about e3 and displacement σ along it of a frame, with their first and second derivatives and their virtual
/// rates.
struct Course<S> {
    turn: [S; 4],
    slide: [S; 4],
}

/// The prescribed motions of the joint at `time`, zero without a drive. A virtual motion does not change them.
fn prescribed<S: Scalar>(joint: &Joint<S>, time: S) -> Course<S> {
    let zero = [S::zero(); 4];
    let (mut turn, mut slide) = (zero, zero);
    for drive in &joint.drives {
        let [value, rate, acceleration, _] = drive.course.derivatives(time);
        let at = [value, rate, acceleration, S::zero()];
        match drive.dof {
            DegreeOfFreedom::Rotation => turn = at,
            DegreeOfFreedom::Translation => slide = at,
        }
    }
    Course { turn, slide }
}

/// The sums of the coordinates of a coupling with their factors.
fn summed<S: Scalar>(modes: &Modes<S>, motions: &[BodyMotion<S>]) -> Course<S> {
    let sums = attachment::parts().map(|part| attachment::sums_of(modes, motions, part));
    Course {
        turn: sums.map(|(_, turn)| turn.z),
        slide: sums.map(|(slide, _)| slide.z),
    }
}

/// The motions that the coordinates of a coupling give, and their derivative by the sum: 1, or f' of a cam.
fn followed<S: Scalar>(
    kind: JointKind,
    modes: &Modes<S>,
    motions: &[BodyMotion<S>],
) -> (Course<S>, S) {
    let mut course = summed(modes, motions);
    let Some(profile) = &modes.profile else {
        return (course, S::one());
    };
    let own = course.of(kind);
    let [x, rate, acceleration, virtual_rate] = *own;
    let [value, slope, curvature, _] = profile.derivatives(x);
    *own = [
        value,
        slope * rate,
        slope * acceleration + curvature * rate * rate,
        slope * virtual_rate,
    ];
    (course, slope)
}

impl<S> Course<S> {
    /// The part in which a coupled joint moves.
    fn of(&mut self, kind: JointKind) -> &mut [S; 4] {
        match kind {
            JointKind::Coupled(DegreeOfFreedom::Translation) => &mut self.slide,
            _ => &mut self.turn,
        }
    }
}

/// The derivative f'' of the slope of a cam at the sum of its coordinates; `None` of other couplings.
pub fn curvature_of_cam<S: Scalar>(
    kind: JointKind,
    modes: &Modes<S>,
    motions: &[BodyMotion<S>],
) -> Option<S> {
    let profile = modes.profile.as_ref()?;
    let [x, ..] = *summed(modes, motions).of(kind);
    Some(profile.derivatives(x)[2])
}

/// A frame on body B that is moved so, and its motion.
fn moved_frame<S: Scalar>(
    frame: &JointFrame<S>,
    course: &Course<S>,
) -> (JointFrame<S>, FrameMotion<S>) {
    let ([turn, spin, spin_up, virtual_spin], [shift, speed, speed_up, virtual_speed]) =
        (course.turn, course.slide);
    let mut frame = *frame;
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
    moving.virtual_rate.axes = [e2 * virtual_spin, -e1 * virtual_spin, Vec3::zeros()];
    moving.virtual_rate.point = e3 * virtual_speed;
    (frame, moving)
}

/// Pulls the cotangents of a moved frame and of its motion back to the frame (added to `own`): those of the course.
fn pull_moved_frame(
    frame: &JointFrame<f64>,
    course: &Course<f64>,
    by_frame: &JointFrame<f64>,
    by_motion: &FrameMotion<f64>,
    own: &mut JointFrame<f64>,
) -> Course<f64> {
    let (turn, slide) = (&course.turn, &course.slide);
    let [angle, spin, spin_up, virtual_spin] = *turn;
    let [e1, e2, e3] = moved_frame(frame, course).0.axes;
    let (x, r, a) = (by_frame, &by_motion.rate, &by_motion.acceleration);
    let w = &by_motion.virtual_rate;
    let square = spin * spin;
    // Cotangents of the turned axes, through themselves and their derivatives.
    let by_e1 = x.axes[0]
        - r.axes[1] * spin
        - a.axes[1] * spin_up
        - a.axes[0] * square
        - w.axes[1] * virtual_spin;
    let by_e2 = x.axes[1] + r.axes[0] * spin + a.axes[0] * spin_up - a.axes[1] * square
        + w.axes[0] * virtual_spin;
    let (sine, cosine) = angle.sin_cos();
    let along = x.point * slide[0] + r.point * slide[1] + a.point * slide[2] + w.point * slide[3];
    own.add(&JointFrame {
        point: x.point,
        axes: [
            by_e1 * cosine - by_e2 * sine,
            by_e1 * sine + by_e2 * cosine,
            x.axes[2] + along,
        ],
        length: x.length,
    });
    Course {
        turn: [
            by_e1.dot(&e2) - by_e2.dot(&e1),
            r.axes[0].dot(&e2)
                - r.axes[1].dot(&e1)
                - 2.0 * spin * (a.axes[0].dot(&e1) + a.axes[1].dot(&e2)),
            a.axes[0].dot(&e2) - a.axes[1].dot(&e1),
            w.axes[0].dot(&e2) - w.axes[1].dot(&e1),
        ],
        slide: [x, r, a, w].map(|part| part.point.dot(&e3)),
    }
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
    let course = prescribed(joint, time);
    let by = pull_moved_frame(
        &joint.frame_b,
        &course,
        by_frame,
        by_motion,
        &mut own.frame_b,
    );
    let mut by_time = 0.0;
    for (drive, own) in joint.drives.iter().zip(&mut own.drives) {
        let [value, rate, acceleration, _] = match drive.dof {
            DegreeOfFreedom::Rotation => by.turn,
            DegreeOfFreedom::Translation => by.slide,
        };
        let weights = [value, rate, acceleration];
        by_time += drive.course.pull_back(time, weights, &mut own.course);
    }
    by_time
}

/// Pulls the cotangents of frame B of a coupled joint and of its motion back to tangent positions and velocities, where
/// these are wanted, and to the parameters of the joint (added to `own`); accelerations and virtual velocities are held.
pub fn pull_followed_frame(
    (joint, modes): (&Joint<f64>, &Modes<f64>),
    (numbering, motions): (&Numbering, &[BodyMotion<f64>]),
    (by_frame, by_motion): (&JointFrame<f64>, &FrameMotion<f64>),
    states: (Option<&mut [f64]>, Option<&mut [f64]>),
    own: &mut Joint<f64>,
) {
    let (course, _) = followed(joint.kind, modes, motions);
    let mut by = pull_moved_frame(
        &joint.frame_b,
        &course,
        by_frame,
        by_motion,
        &mut own.frame_b,
    );
    if let Some(profile) = &modes.profile {
        let [x, rate, acceleration, virtual_rate] = *summed(modes, motions).of(joint.kind);
        let [_, slope, curvature, _] = profile.derivatives(x);
        let by = by.of(joint.kind);
        let [value, by_rate, by_acceleration, by_virtual] = *by;
        let by_slope = by_rate * rate + by_acceleration * acceleration + by_virtual * virtual_rate;
        let weights = [value, by_slope, by_acceleration * rate * rate];
        let to = own.modes.as_mut().and_then(|own| own.profile.as_mut());
        let to = to.expect("a cotangent has the profile of its joint");
        *by = [
            profile.pull_back(x, weights, to),
            by_rate * slope + 2.0 * by_acceleration * curvature * rate,
            by_acceleration * slope,
            by_virtual * slope,
        ];
    }
    let along = |x: f64| Vec3::new(0.0, 0.0, x);
    let parts = std::array::from_fn(|i| (along(by.slide[i]), along(by.turn[i])));
    attachment::pull_coordinates(modes, (numbering, motions), &parts, states, own);
}
