//! The inertia of a kinetic energy that leaves out deformations.
//!
//! Kennedy & Boopathy (2016), equations (10), (13) and (14), neglect products of places with deformations:
//!
//! ```text
//! T = ½ m v·v + ½ ω·J ω + ½ q̇·M q̇ − v·(c × ω) + v·p q̇ + ω·h q̇,     c, J, p, h, M constant
//! force   m v̇ − c × ω̇ + p q̈ + ω × (m v − c × ω + p q̇)
//! torque  c × (v̇ + ω × v) + J ω̇ + h q̈ + ω × J ω + v × p q̇ + ω × h q̇
//! elastic pᵀ v̇ + hᵀ ω̇ + M q̈,     v̇ = Rᵀ r̈ − ω × v
//! ```
//!
//! v is the velocity of the frame's origin in the axes of the frame. The equations keep this T, but
//! they depend on v itself, so a constant velocity of 10 m/s changes the deformation. Gravity is
//! exact: it has the potential of the deformed body.
//!
//! At q = 0, q̇ = 0 and ω = 0 the complete inertia gives the part that is linear in accelerations, for each form of body.
//! The rest is a product of v, ω and gravity with c, π = p q̇, H = h q̇ and s = p q.

use super::coordinates::at_rest;
use super::form::{
    emit_mass_of, first_moment, inertial as complete, moving, pull_first_moment, pull_inertial,
    pull_kinetic as pull_complete_kinetic,
};
use crate::linalg::Emit;
use crate::math::scalar::skew;
use crate::math::{Mat3, Scalar, Vec3};
use crate::model::Model;
use crate::model::flexible::{FlexibleBody, Form, Inertia};
use crate::system::bodies::BodyMotion;
use crate::system::flexing::{Block, Flexing, FlexingCotangent, Generalised};
use crate::system::{elastic, finite};

/// Velocity of the frame's origin and gravity, in the axes of the frame.
pub(super) struct Beside<S> {
    velocity: Vec3<S>,
    gravity: Vec3<S>,
}

impl<S: Scalar> Beside<S> {
    /// Those of a body in motion.
    pub(super) fn of(model: &Model<S>, frame: &BodyMotion<S>) -> Self {
        Self {
            velocity: frame.rotation.tr_mul(&frame.velocity),
            gravity: frame.rotation.tr_mul(&model.gravity),
        }
    }

    /// None, as in products with the mass matrix.
    pub(super) fn none() -> Self {
        Self {
            velocity: Vec3::zeros(),
            gravity: Vec3::zeros(),
        }
    }
}

/// The body of `at` without deformation and velocities.
fn undeformed<S: Scalar>(at: &Flexing<S>, gamma: Vec3<S>) -> Flexing<S> {
    let still = vec![S::zero(); at.q.len()];
    Flexing {
        rotation: at.rotation,
        gamma,
        omega: Vec3::zeros(),
        alpha: at.alpha,
        q: still.clone(),
        rate: still,
        acceleration: at.acceleration.clone(),
    }
}

/// Common terms of the formulas: c, π, H and s.
struct Moments<S> {
    c: Vec3<S>,
    pi: Vec3<S>,
    h: Vec3<S>,
    s: Vec3<S>,
}

impl<S: Scalar> Moments<S> {
    fn of(form: &Form<S>, at: &Flexing<S>) -> Self {
        let still = vec![S::zero(); at.q.len()];
        let c = first_moment(form, &still);
        let mut rates = undeformed(at, Vec3::zeros());
        rates.rate.clone_from(&at.rate);
        let moving = moving(form, &rates, &Vec3::zeros());
        Self {
            s: first_moment(form, &at.q) - c,
            c,
            pi: moving.momentum,
            h: moving.spin,
        }
    }
}

/// Rᵀ (r̈ − g) − ω × v.
fn seen<S: Scalar>(at: &Flexing<S>, beside: &Beside<S>) -> Vec3<S> {
    at.gamma - at.omega.cross(&beside.velocity)
}

/// Inertial forces without those of the rigid body.
pub(super) fn inertial<S: Scalar>(
    form: &Form<S>,
    at: &Flexing<S>,
    beside: &Beside<S>,
) -> Generalised<S> {
    let (omega, v) = (&at.omega, &beside.velocity);
    let Moments { c, pi, h, s } = Moments::of(form, at);
    let mut out = complete(form, &undeformed(at, seen(at, beside)));
    out.linear += at.rotation * omega.cross(&(omega.cross(&c) + pi));
    out.angular += c.cross(&omega.cross(v)) + omega.cross(&h) + v.cross(&pi);
    out.angular -= s.cross(&beside.gravity);
    out
}

/// Pulls the cotangent ψ of [`inertial`] back to the motion, the accelerations held, to the velocity of the origin
/// (ground axes, returned) and to the parameters (added to `cot`).
pub(super) fn pull_back(
    form: &Form<f64>,
    (at, beside): (&Flexing<f64>, &Beside<f64>),
    psi: &Generalised<f64>,
    cot: &mut Form<f64>,
) -> (FlexingCotangent<f64>, Vec3<f64>) {
    let (omega, v, t) = (&at.omega, &beside.velocity, &psi.angular);
    let phi = at.rotation.tr_mul(&psi.linear);
    let own = Moments::of(form, at);
    let gamma = seen(at, beside);
    let still = vec![0.0; at.q.len()];
    let base = pull_inertial(form, &undeformed(at, gamma), psi, cot);
    // By γ − ω × v; that of the rotation had γ − ω × v for γ.
    let by_seen = -at.rotation.tr_mul(&base.gravity);
    let by_gravity = -t.cross(&own.s);
    let by_v = omega.cross(&by_seen) + t.cross(&own.c).cross(omega) + own.pi.cross(t);
    let force = omega.cross(&(omega.cross(&own.c) + own.pi));
    let theta = base.theta - by_seen.cross(&gamma)
        + by_seen.cross(&at.gamma)
        + by_v.cross(v)
        + by_gravity.cross(&beside.gravity)
        + force.cross(&phi);
    let by_omega = by_seen.cross(v)
        + (omega.cross(&own.c) + own.pi).cross(&phi)
        + own.c.cross(&phi.cross(omega))
        + v.cross(&t.cross(&own.c))
        + own.h.cross(t);
    let mut out = FlexingCotangent {
        theta,
        omega: by_omega,
        q: still.clone(),
        rate: still.clone(),
        gravity: base.gravity + at.rotation * by_gravity,
    };
    let by_c = omega.cross(&omega.cross(&phi)) + omega.cross(v).cross(t);
    let mut unused = still.clone();
    pull_first_moment(form, (&still, true), &by_c, &mut unused, cot);
    let by_pi = phi.cross(omega) + t.cross(v);
    pull_first_moment(form, (&at.rate, false), &by_pi, &mut out.rate, cot);
    let by_s = -beside.gravity.cross(t);
    pull_first_moment(form, (&at.q, false), &by_s, &mut out.q, cot);
    // H is the torque of the accelerations q̇, and its transpose the elastic forces of an angular acceleration.
    let by_h = t.cross(omega);
    let mut rates = undeformed(at, Vec3::zeros());
    rates.alpha = Vec3::zeros();
    rates.acceleration.clone_from(&at.rate);
    let turned = Generalised {
        linear: Vec3::zeros(),
        angular: by_h,
        elastic: still.clone(),
    };
    pull_inertial(form, &rates, &turned, cot);
    rates.alpha = by_h;
    rates.acceleration = still;
    let transposed = complete(form, &rates).elastic;
    (out.rate.iter_mut().zip(&transposed)).for_each(|(x, &by)| *x += by);
    (out, at.rotation * by_v)
}

/// p_j and h_j of all coordinates: the columns of force and torque in the mass matrix of the undeformed body.
struct Columns<S> {
    force: Vec<Vec3<S>>,
    torque: Vec<Vec3<S>>,
}

impl<S: Scalar> Columns<S> {
    fn of(form: &Form<S>, count: usize) -> Self {
        let none = vec![Vec3::zeros(); count];
        let mut out = Self {
            force: none.clone(),
            torque: none,
        };
        let slots: Vec<usize> = (0..6 + count).collect();
        let still = vec![S::zero(); count];
        let at = (&Mat3::identity(), &still[..]);
        emit_mass_of(form, at, &slots, (0, 0), S::one(), &mut out);
        out
    }
}

impl<S: Scalar> Emit<S> for Columns<S> {
    fn add(&mut self, row: usize, column: usize, value: S) {
        if column >= 6 {
            match row {
                0..3 => self.force[column - 6][row] += value,
                3..6 => self.torque[column - 6][row - 3] += value,
                _ => {}
            }
        }
    }

    fn add_dense(&mut self, _rows: &[usize], _columns: &[usize], _scale: S, _block: &[S]) {}
}

/// Passes on the entries that are not in some columns.
struct Without<'a, S> {
    columns: std::ops::Range<usize>,
    emit: &'a mut dyn Emit<S>,
}

impl<S: Scalar> Emit<S> for Without<'_, S> {
    fn add(&mut self, row: usize, column: usize, value: S) {
        if !self.columns.contains(&column) {
            self.emit.add(row, column, value);
        }
    }

    // Dense blocks are those of elastic coordinates.
    fn add_dense(&mut self, rows: &[usize], columns: &[usize], scale: S, block: &[S]) {
        self.emit.add_dense(rows, columns, scale, block);
    }
}

/// Emits the derivatives of [`inertial`] and of elastic and viscous forces, the accelerations held: in tangent positions times
/// `by_y` at (row, y), in velocities times `by_v` at (row, v).
pub(super) fn emit_jacobian<S: Scalar>(
    form: &Form<S>,
    (at, beside): (&Flexing<S>, &Beside<S>),
    slots: &[usize],
    (row, y, v): (usize, usize, usize),
    (by_y, by_v): (S, S),
    emit: &mut dyn Emit<S>,
) {
    let count = at.q.len();
    match form {
        Form::Modal(modal) => {
            let (mut in_y, mut in_v) = (Block::zero(count), Block::zero(count));
            elastic::add_jacobian(modal, (&at.q, &at.rate), &mut in_y, &mut in_v);
            in_y.emit(slots, (row, y), by_y, emit);
            in_v.emit(slots, (row, v), by_v, emit);
        }
        Form::Finite(own) => {
            // Without accelerations and rotation these are elastic and viscous forces, and Coriolis forces by the
            // angular velocity alone.
            let mut alone = undeformed(at, Vec3::zeros());
            alone.alpha = Vec3::zeros();
            alone.acceleration.fill(S::zero());
            alone.q.clone_from(&at.q);
            alone.rate.clone_from(&at.rate);
            let columns = v + slots[3]..v + slots[3] + 3;
            let mut emit = Without {
                columns,
                emit: &mut *emit,
            };
            finite::emit_jacobian(own, &alone, slots, (row, y, v), (by_y, by_v), &mut emit);
        }
    }
    let (omega, own) = (&at.omega, Moments::of(form, at));
    let (velocity, rotation) = (&beside.velocity, &at.rotation);
    let columns = Columns::of(form, count);
    let accelerated = complete(form, &undeformed(at, seen(at, beside)));
    let turning = omega.cross(&own.c) + own.pi;
    let force = rotation.tr_mul(&accelerated.linear) + omega.cross(&turning);
    let (spin, pi) = (skew(omega), skew(&own.pi));
    let (linear, angular) = (slots[0], slots[3]);
    let mut block = |(i, k): (usize, usize), x: &Mat3<S>, scale: S| {
        emit.add_block(row + i, k, &(x * scale));
    };
    block((linear, y + angular), &-(rotation * skew(&force)), by_y);
    let torque =
        skew(&own.c) * skew(&at.gamma) - pi * skew(velocity) - skew(&own.s) * skew(&beside.gravity);
    block((angular, y + angular), &torque, by_y);
    block((angular, v + linear), &-(pi * rotation.transpose()), by_v);
    let by_spin = -(rotation * (skew(&turning) + spin * skew(&own.c)));
    block((linear, v + angular), &by_spin, by_v);
    block((angular, v + angular), &-skew(&own.h), by_v);
    for (j, slot) in slots[6..].iter().enumerate() {
        let (p, h) = (&columns.force[j], &columns.torque[j]);
        let across = omega.cross(p);
        let lifted = rotation * across;
        emit.add_column(row + angular, y + slot, &(-p.cross(&beside.gravity) * by_y));
        emit.add_column(row + linear, v + slot, &(lifted * by_v));
        let torque = omega.cross(h) + velocity.cross(p);
        emit.add_column(row + angular, v + slot, &(torque * by_v));
        let by_turn = p.cross(&at.gamma) + across.cross(velocity);
        emit.add_row(row + slot, y + angular, &(by_turn * by_y));
        emit.add_row(row + slot, v + linear, &(lifted * by_v));
        emit.add_row(row + slot, v + angular, &(p.cross(velocity) * by_v));
    }
}

/// The motion of a body of which kinetic energy, momenta and mass matrix are taken: undeformed if its inertia leaves
/// deformations out.
pub(super) fn weighed<S: Scalar>(body: &FlexibleBody<S>, motions: &[BodyMotion<S>]) -> Flexing<S> {
    let mut at = at_rest(body, motions);
    match body.inertia {
        Inertia::Full => {}
        Inertia::Paper => at.q.fill(S::zero()),
    }
    at
}

/// Transpose of the derivative of the kinetic energy, times `scale`; see [`super::form::pull_kinetic`].
pub(super) fn pull_kinetic(
    body: &FlexibleBody<f64>,
    (at, nu): (&Flexing<f64>, &Vec3<f64>),
    scale: f64,
    cot: &mut Form<f64>,
) -> (FlexingCotangent<f64>, Vec3<f64>) {
    let (mut by, velocity) = pull_complete_kinetic(&body.form, at, nu, scale, cot);
    match body.inertia {
        Inertia::Full => {}
        Inertia::Paper => by.q.fill(0.0),
    }
    (by, velocity)
}
