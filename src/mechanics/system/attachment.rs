//! Attachments: how the frame of a joint on a flexible body moves with the elastic coordinates, and how
//! cotangents of the frame come back to these.
//!
//! ```text
//! s = X + Σ q_I N_I,     e_k' = e_k + θ × e_k,     θ = Σ q_I Θ_I
//! ```
//!
//! Both are linear in q, so rates, accelerations and virtual rates have the same form.

use super::bodies::BodyMotion;
use super::frame_motion::FrameMotion;
use super::numbering::Numbering;
use crate::math::{Scalar, Vec3};
use crate::model::{Joint, JointFrame, Modes};

/// A vector of the motion of a body.
pub(super) type Part<S> = fn(&BodyMotion<S>) -> Vec3<S>;

/// Position, velocity, acceleration and virtual velocity.
pub(super) fn parts<S: Scalar>() -> [Part<S>; 4] {
    [
        |x| x.position,
        |x| x.velocity,
        |x| x.acceleration,
        |x| x.virtual_velocity,
    ]
}

/// Σ x_I N_I and Σ x_I Θ_I; `of` gives the component of a carrier.
pub(super) fn sums<S: Scalar>(
    modes: &Modes<S>,
    of: impl Fn(usize, usize) -> S,
) -> (Vec3<S>, Vec3<S>) {
    let mut sums = (Vec3::zeros(), Vec3::zeros());
    let shapes = modes.displacement.iter().zip(&modes.rotation);
    for ((n, t), &(carrier, k)) in shapes.zip(&modes.places) {
        let x = of(carrier, k);
        sums.0 += n * x;
        sums.1 += t * x;
    }
    sums
}

/// The same with a vector of each carrier.
pub(super) fn sums_of<S: Scalar>(
    modes: &Modes<S>,
    motions: &[BodyMotion<S>],
    part: Part<S>,
) -> (Vec3<S>, Vec3<S>) {
    sums(modes, |carrier, k| part(&motions[carrier])[k])
}

/// The rotation Σ q_I Θ_I of a section, axes of its body \[rad\].
pub fn section_rotation<S: Scalar>(modes: &Modes<S>, motions: &[BodyMotion<S>]) -> Vec3<S> {
    sums_of(modes, motions, |x| x.position).1
}

/// The change of a frame with these displacement and rotation.
fn change<S: Scalar>(frame: &JointFrame<S>, (n, t): (Vec3<S>, Vec3<S>)) -> JointFrame<S> {
    JointFrame {
        point: n,
        axes: frame.axes.map(|axis| t.cross(&axis)),
        length: S::zero(),
    }
}

/// The frame of an attachment on the deformed body, and its motion.
pub fn deformed_frame<S: Scalar>(
    frame: &JointFrame<S>,
    modes: &Modes<S>,
    motions: &[BodyMotion<S>],
) -> (JointFrame<S>, FrameMotion<S>) {
    let mut moved = *frame;
    moved.add(&change(frame, sums_of(modes, motions, |x| x.position)));
    let motion = FrameMotion {
        rate: change(frame, sums_of(modes, motions, |x| x.velocity)),
        acceleration: change(frame, sums_of(modes, motions, |x| x.acceleration)),
        virtual_rate: change(frame, sums_of(modes, motions, |x| x.virtual_velocity)),
    };
    (moved, motion)
}

/// Derivatives of a row's rate in the rates of the elastic coordinates, with their places among the
/// velocities, for a row with this force and torque on the section (body axes).
pub fn elastic_gradient<'a, S: Scalar>(
    modes: &'a Modes<S>,
    numbering: &'a Numbering,
    (force, torque): (Vec3<S>, Vec3<S>),
) -> impl Iterator<Item = (usize, S)> + 'a {
    let shapes = modes.displacement.iter().zip(&modes.rotation);
    let places = shapes.zip(&modes.places);
    places.map(move |((n, t), &(carrier, k))| {
        let slot = numbering.velocity(carrier) + k;
        (slot, n.dot(&force) + t.dot(&torque))
    })
}

/// Σ e_k × f_k: the moment of cotangents of the axes about the section.
fn moment<S: Scalar>(frame: &JointFrame<S>, by: &JointFrame<S>) -> Vec3<S> {
    let axes = frame.axes.iter().zip(&by.axes);
    axes.fold(Vec3::zeros(), |sum, (e, f)| sum + e.cross(f))
}

/// Derivatives in the elastic coordinates of a quantity with the cotangents `by` in frame A, with
/// their places among the tangent positions.
pub fn by_coordinates<'a, S: Scalar>(
    joint: &Joint<S>,
    modes: &'a Modes<S>,
    numbering: &'a Numbering,
    by: &JointFrame<S>,
) -> impl Iterator<Item = (usize, S)> + 'a {
    let torque = moment(&joint.frame_a, by);
    elastic_gradient(modes, numbering, (by.point, torque))
}

/// Pulls cotangents of frame A and of its motion back to tangent positions and velocities, where these
/// are wanted, and to the parameters of the joint (added to `own`); accelerations and virtual velocities
/// are held.
pub fn pull_frame(
    (joint, modes): (&Joint<f64>, &Modes<f64>),
    (numbering, motions): (&Numbering, &[BodyMotion<f64>]),
    (by_frame, by_motion): (&JointFrame<f64>, &FrameMotion<f64>),
    states: (Option<&mut [f64]>, Option<&mut [f64]>),
    own: &mut Joint<f64>,
) {
    let all = [
        by_frame,
        &by_motion.rate,
        &by_motion.acceleration,
        &by_motion.virtual_rate,
    ];
    own.frame_a.add(by_frame);
    for (by, of) in all.into_iter().zip(parts()) {
        let turned = sums_of(modes, motions, of).1;
        // f · (θ × e) = e · (f × θ).
        for (axis, f) in own.frame_a.axes.iter_mut().zip(&by.axes) {
            *axis += f.cross(&turned);
        }
    }
    let by = all.map(|by| (by.point, moment(&joint.frame_a, by)));
    pull_coordinates(modes, (numbering, motions), &by, states, own);
}

/// Pulls cotangents of Σ x_I N_I and Σ x_I Θ_I, for each of [`parts`], back to tangent positions and velocities, where these
/// are wanted, and to the modes of a joint (added to `own`).
pub(super) fn pull_coordinates(
    modes: &Modes<f64>,
    (numbering, motions): (&Numbering, &[BodyMotion<f64>]),
    by: &[(Vec3<f64>, Vec3<f64>); 4],
    (mut y, mut v): (Option<&mut [f64]>, Option<&mut [f64]>),
    own: &mut Joint<f64>,
) {
    for (i, (&(force, torque), of)) in by.iter().zip(parts()).enumerate() {
        let Some(cot) = &mut own.modes else { continue };
        let places = (modes.places.iter()).zip(cot.displacement.iter_mut().zip(&mut cot.rotation));
        for (&(carrier, k), (n, t)) in places {
            let x = of(&motions[carrier])[k];
            *n += force * x;
            *t += torque * x;
        }
        let state = match i {
            0 => y.as_deref_mut(),
            1 => v.as_deref_mut(),
            _ => None,
        };
        if let Some(state) = state {
            for (slot, x) in elastic_gradient(modes, numbering, (force, torque)) {
                state[slot] += x;
            }
        }
    }
}
