//! The joints of a model in motion: constraint vectors, reactions and pull-backs over all rows.

use super::attachment;
use super::bodies::{BodyMotion, add6, velocities_of};
use super::constraint::{self, RowGradient, SideCotangent, gradient};
use super::in_motion::InMotion;
use super::numbering::Numbering;
use super::reaction::{self, ReactionJacobian};
use super::rows::RowCotangent;
use super::side::{JointSide, curvature_of_cam, pull_driven_frame, pull_followed_frame, sides};
use crate::math::{Scalar, Vec3};
use crate::model::{ConstraintRow, Joint, Model, Modes};
use std::ops::Range;

/// Largest number of rows of a joint.
pub const ROWS: usize = 6;

/// Calls `visit(row numbers, joint, side a, side b)` for every joint.
fn for_each_joint<S: Scalar>(
    at: &InMotion<S>,
    mut visit: impl FnMut(Range<usize>, &Joint<S>, &JointSide<S>, &JointSide<S>),
) {
    let ground = BodyMotion::ground();
    for (j, joint) in at.model.joints.iter().enumerate() {
        let (a, b) = sides(joint, at.motions, &ground, at.time);
        visit(at.numbering.rows(j), joint, &a, &b);
    }
}

/// Calls `visit(joint number, row, side a, side b)` for every row.
pub fn for_each_row<S: Scalar>(
    model: &Model<S>,
    (motions, time): (&[BodyMotion<S>], S),
    mut visit: impl FnMut(usize, ConstraintRow, &JointSide<S>, &JointSide<S>),
) {
    let ground = BodyMotion::ground();
    for (j, joint) in model.joints.iter().enumerate() {
        let (a, b) = sides(joint, motions, &ground, time);
        for row in joint.rows() {
            visit(j, row, &a, &b);
        }
    }
}

/// Constraints Φ(q, t); `out` has length n_c.
pub fn values<S: Scalar>(at: &InMotion<S>, out: &mut [S]) {
    for_each_joint(at, |numbers, joint, a, b| {
        for (out, row) in out[numbers].iter_mut().zip(joint.rows()) {
            *out = constraint::value(row, a, b);
        }
    });
}

/// Products G(q) v from the gradients; `out` has length n_c.
pub fn rates_from_gradients<S: Scalar>(
    model: &Model<S>,
    numbering: &Numbering,
    gradients: &[RowGradient<S>],
    v: &[S],
    out: &mut [S],
) {
    for (j, joint) in model.joints.iter().enumerate() {
        let (linear_a, omega_a) = velocities_of(&v[numbering.velocity(joint.body_a)..]);
        let (linear_b, omega_b) = joint.body_b.map_or((Vec3::zeros(), Vec3::zeros()), |b| {
            velocities_of(&v[numbering.velocity(b)..])
        });
        let relative = linear_a - linear_b;
        let modes = joint.modes.as_ref();
        // The few coordinates of a coupling are summed row by row: their sum may cancel.
        let (coupled, deformed) = match joint.is_coupled() {
            true => (modes, None),
            false => (None, modes),
        };
        let rate = |carrier: usize, k: usize| v[numbering.velocity(carrier) + k];
        let of_frame = deformed.map(|modes| attachment::sums(modes, rate));
        for i in numbering.rows(j) {
            let g = &gradients[i];
            out[i] = g.force.dot(&relative) + g.torque_a.dot(&omega_a) + g.torque_b.dot(&omega_b);
            if let Some((linear, angular)) = &of_frame {
                out[i] += g.local_force.dot(linear) + g.local_torque.dot(angular);
            }
            if let Some(modes) = coupled {
                for (slot, x) in attachment::elastic_gradient(modes, numbering, g.local()) {
                    out[i] += x * v[slot];
                }
            }
        }
    }
}

/// Constraint rates G(q) v + Φ_t; `out` has length n_c.
pub fn rates<S: Scalar>(at: &InMotion<S>, out: &mut [S]) {
    for_each_joint(at, |numbers, joint, a, b| {
        constraint::rates(joint.rows(), a, b, &mut out[numbers]);
    });
}

/// Adds the rates Φ_t of the drives to `out`.
pub fn add_driven_rates<S: Scalar>(at: &InMotion<S>, out: &mut [S]) {
    let (model, numbering) = (at.model, at.numbering);
    let ground = BodyMotion::ground();
    let held = |motion: &BodyMotion<S>| BodyMotion {
        velocity: Vec3::zeros(),
        omega: Vec3::zeros(),
        ..*motion
    };
    for (j, joint) in model.joints.iter().enumerate() {
        if joint.drives.is_empty() {
            continue;
        }
        let (mut a, mut b) = sides(joint, at.motions, &ground, at.time);
        let (at_a, at_b) = (held(a.motion), held(b.motion));
        (a.motion, b.motion) = (&at_a, &at_b);
        let mut rates = [S::zero(); ROWS];
        let rates = &mut rates[..numbering.rows(j).len()];
        constraint::rates(joint.rows(), &a, &b, rates);
        for (out, &rate) in out[numbering.rows(j)].iter_mut().zip(&*rates) {
            *out += rate;
        }
    }
}

/// Second derivatives Φ̈ at the accelerations of `motions`. If these are zero, they are the biases
/// −γ of Φ̈ = G v̇ − γ.
pub fn accelerations<S: Scalar>(at: &InMotion<S>, out: &mut [S]) {
    for_each_joint(at, |numbers, joint, a, b| {
        constraint::accelerations(joint.rows(), a, b, &mut out[numbers]);
    });
}

/// Gradients of all rows: the non-zero blocks of G.
pub fn gradients<S: Scalar>(at: &InMotion<S>, out: &mut Vec<RowGradient<S>>) {
    out.clear();
    for_each_joint(at, |_, joint, a, b| {
        out.extend(joint.rows().map(|row| gradient(row, a, b)));
    });
}

/// Adds G(q)ᵀ λ to `out`, in velocity numbering.
pub fn add_reactions<S: Scalar>(
    model: &Model<S>,
    numbering: &Numbering,
    gradients: &[RowGradient<S>],
    lambda: &[S],
    out: &mut [S],
) {
    for (j, joint) in model.joints.iter().enumerate() {
        let mut total = RowGradient::zero();
        for i in numbering.rows(j) {
            total.force += gradients[i].force * lambda[i];
            total.torque_a += gradients[i].torque_a * lambda[i];
            total.torque_b += gradients[i].torque_b * lambda[i];
        }
        add6(
            &mut out[numbering.velocity(joint.body_a)..],
            &total.force,
            &total.torque_a,
        );
        if let Some(body) = joint.body_b {
            add6(
                &mut out[numbering.velocity(body)..],
                &-total.force,
                &total.torque_b,
            );
        }
        if let Some(modes) = &joint.modes {
            for i in numbering.rows(j) {
                total.local_force += gradients[i].local_force * lambda[i];
                total.local_torque += gradients[i].local_torque * lambda[i];
            }
            for (slot, x) in attachment::elastic_gradient(modes, numbering, total.local()) {
                out[slot] += x;
            }
        }
    }
}

/// Derivative of G(q)ᵀ λ of one joint in the tangent positions of its two bodies.
pub fn reaction_jacobian<S: Scalar>(
    joint: &Joint<S>,
    (motions, time): (&[BodyMotion<S>], S),
    lambda: &[S],
) -> ReactionJacobian<S> {
    let ground = BodyMotion::ground();
    let (a, b) = sides(joint, motions, &ground, time);
    let mut out = ReactionJacobian::zero();
    for (row, &l) in joint.rows().zip(lambda) {
        reaction::add_reaction_jacobian(row, l, &a, &b, &mut out);
    }
    out
}

/// Derivatives of the torques of G(q)ᵀ λ of an attachment in each elastic coordinate, on body A and on
/// body B, with the place of the coordinate among the velocities; those of the elastic forces in the
/// rotations are the same numbers, and there are no others. None of a coupled joint: where it is closed its row is linear
/// in the coordinates and the rotation to first order, sin(x − θ) = 0, but for the [`curvature`] of a cam.
pub fn elastic_reactions<S: Scalar>(
    joint: &Joint<S>,
    modes: &Modes<S>,
    at: &InMotion<S>,
    lambda: &[S],
) -> Vec<(usize, Vec3<S>, Vec3<S>)> {
    if joint.is_coupled() {
        return Vec::new();
    }
    let ground = BodyMotion::ground();
    let (a, b) = sides(joint, at.motions, &ground, at.time);
    let mut turned = reaction::ElasticReaction::zero();
    for (row, &l) in joint.rows().zip(lambda) {
        reaction::add_elastic_reaction(row, l, (&a, &joint.frame_a), &b, &mut turned);
    }
    let shapes = modes.displacement.iter().zip(&modes.rotation);
    let places = shapes.zip(modes.places.iter().copied());
    places
        .map(|((n, t), (carrier, k))| {
            let slot = at.numbering.velocity(carrier) + k;
            let by_a = n.cross(&turned.force) + turned.a_by_rotation * t;
            (slot, by_a, turned.b_by_rotation * t)
        })
        .collect()
}

/// The derivative of the product of a row of a cam and its coordinate's velocity by the coordinate, for the velocity 1, with the
/// place of the coordinate among the velocities: that of λ G for λ = 1 as well. `None` of other joints.
pub fn curvature<S: Scalar>(joint: &Joint<S>, at: &InMotion<S>) -> Option<(usize, S)> {
    let modes = joint.modes.as_ref()?;
    let curvature = curvature_of_cam(joint.kind, modes, at.motions)?;
    let ground = BodyMotion::ground();
    let (a, b) = sides(joint, at.motions, &ground, at.time);
    let row = joint.rows().next()?;
    let by_motion = constraint::followed_gradient(row, &a, &b);
    let mut all = attachment::elastic_gradient(modes, at.numbering, by_motion);
    all.next().map(|(slot, x)| (slot, x * curvature))
}

/// Calls `visit(row, side a, side b)` for every row of a joint, with the derivatives of its rate in the tangent positions
/// of the two bodies.
pub fn rates_by_position<S: Scalar>(
    joint: &Joint<S>,
    (a, b): (&JointSide<S>, &JointSide<S>),
    visit: impl FnMut(ConstraintRow, SideCotangent<S>, SideCotangent<S>),
) {
    let unit = RowCotangent {
        value: S::zero(),
        rate: S::one(),
        acceleration: S::zero(),
        virtual_rate: S::zero(),
    };
    constraint::pull_back_each(joint.rows(), unit, (a, b), visit);
}

/// Destination of the pull-back of the constraints.
pub struct JointCotangent<'a> {
    /// Tangent positions, velocity numbering; `None` if not needed.
    pub y: Option<&'a mut [f64]>,
    /// Velocities; `None` if not needed.
    pub v: Option<&'a mut [f64]>,
    /// Parameters of the joints.
    pub model: &'a mut Model<f64>,
}

/// Cotangents of all rows; `None` for zero.
#[derive(Clone, Copy, Debug, Default)]
pub struct RowCotangents<'a> {
    /// Of the values Φ.
    pub value: Option<&'a [f64]>,
    /// Of the rates G v + Φ_t.
    pub rate: Option<&'a [f64]>,
    /// Of the second derivatives Φ̈.
    pub acceleration: Option<&'a [f64]>,
    /// Of the rates G w at the virtual velocities w.
    pub virtual_rate: Option<&'a [f64]>,
}

impl RowCotangents<'_> {
    /// The cotangents of row i.
    pub fn row(&self, i: usize) -> RowCotangent<f64> {
        let at = |all: Option<&[f64]>| all.map_or(0.0, |all| all[i]);
        RowCotangent {
            value: at(self.value),
            rate: at(self.rate),
            acceleration: at(self.acceleration),
            virtual_rate: at(self.virtual_rate),
        }
    }
}

/// Pulls cotangents of all rows back to tangent positions, velocities and the parameters of the
/// joints, at constant accelerations and virtual velocities. Returns the derivative in time.
pub fn pull_back(at: &InMotion<f64>, cotangents: &RowCotangents, out: &mut JointCotangent) -> f64 {
    let (model, numbering, time) = (at.model, at.numbering, at.time);
    let ground = BodyMotion::ground();
    let mut by_time = 0.0;
    for (j, joint) in model.joints.iter().enumerate() {
        let (a, b) = sides(joint, at.motions, &ground, time);
        let first = numbering.rows(j).start;
        let cot = |i: usize| cotangents.row(first + i);
        let (by_a, by_b) = constraint::pull_back(joint.rows(), cot, &a, &b);
        by_time += give(at, j, (&by_a, &by_b), out);
    }
    by_time
}

/// Hands cotangents of both sides of joint `j` on to tangent positions, velocities and the parameters of
/// the joint. Returns the derivative in time.
pub fn give(
    at: &InMotion<f64>,
    j: usize,
    (by_a, by_b): (&SideCotangent<f64>, &SideCotangent<f64>),
    out: &mut JointCotangent,
) -> f64 {
    let joint = &at.model.joints[j];
    give_to_states(at, joint, (by_a, by_b), out);
    let target = &mut out.model.joints[j];
    match (&joint.modes, &by_a.moving) {
        (Some(modes), Some(motion)) => attachment::pull_frame(
            (joint, modes),
            (at.numbering, at.motions),
            (&by_a.frame, motion),
            (out.y.as_deref_mut(), out.v.as_deref_mut()),
            target,
        ),
        _ => target.frame_a.add(&by_a.frame),
    }
    match (&by_b.moving, &joint.modes) {
        (None, _) => {
            target.frame_b.add(&by_b.frame);
            0.0
        }
        (Some(motion), Some(modes)) => {
            pull_followed_frame(
                (joint, modes),
                (at.numbering, at.motions),
                (&by_b.frame, motion),
                (out.y.as_deref_mut(), out.v.as_deref_mut()),
                target,
            );
            0.0
        }
        (Some(motion), None) => pull_driven_frame(joint, at.time, &by_b.frame, motion, target),
    }
}

/// The part of [`give`] that belongs to the motions of the bodies.
pub fn give_to_states(
    at: &InMotion<f64>,
    joint: &Joint<f64>,
    (by_a, by_b): (&SideCotangent<f64>, &SideCotangent<f64>),
    out: &mut JointCotangent,
) {
    for (body, by) in [(Some(joint.body_a), by_a), (joint.body_b, by_b)] {
        let Some(body) = body else { continue };
        let o = at.numbering.velocity(body);
        if let Some(y) = out.y.as_deref_mut() {
            add6(&mut y[o..], &by.position, &by.theta);
        }
        if let Some(v) = out.v.as_deref_mut() {
            add6(&mut v[o..], &by.velocity, &by.omega);
        }
    }
}
