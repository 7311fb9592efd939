//! Forces of contacts and all their derivatives.
//!
//! With δ, n and the place z of contact ([`geometry`]), the relative velocity v of the bodies at z, its tangential part v_t, μ and s
//! ([`friction`]):
//!
//! ```text
//! δ̇ = −n·v,   t = v_tᵀ u / s,   ψᵀf = N (n·u − μ t)          u: the relative velocity of ψ at z
//! ```
//!
//! The normal force has no power along the tangent, so δ̇ follows from v at z whatever the place of z along n. The pull-backs
//! go from the cotangents of δ, n, v, u and z to the bodies. A contact that does not touch has none.

mod cotangent;
mod field;
mod friction;
mod geometry;
mod last_steps;
mod nearest;
mod rim;

use super::normal_law::{self, NormalForce};
use super::power::{relative, speed_seen};
use super::pull::{Pulled, Virtual, hold_virtual, moving, with_motions};
use super::{Acting, stop};
use crate::math::scalar::length;
use crate::math::{Scalar, Vec3};
use crate::model::contact::{Contact, Shape, Surface};
use crate::system::bodies::BodyMotion;
use crate::system::constraint::SideCotangent;
use crate::system::side::JointSide;
use cotangent::{Cotangent, RADIUS_A, RADIUS_B, WHEEL};
use friction::Slip;
use geometry::{Touch, is_far, touch};

pub(in crate::system::loads) use geometry::meets;

/// First place of the law among the scalars of a contact.
const LAW: usize = 1;

/// A contact that presses: where, how fast and how strongly.
pub(super) struct State<S> {
    touch: Touch<S>,
    velocity: Vec3<S>,
    slip: Slip<S>,
    force: NormalForce<S>,
}

/// Cotangents of N, n, v and z.
struct Cotangents<S> {
    force: S,
    normal: Vec3<S>,
    velocity: Vec3<S>,
    place: Vec3<S>,
}

/// The contact in a motion, if it presses.
pub(super) fn state<S: Scalar>(contact: &Contact<S>, at: &Acting<S>) -> Option<State<S>> {
    if is_far(contact, at) {
        return None;
    }
    let touch = touch(contact, at);
    if !normal_law::touches(&contact.law, touch.penetration) {
        return None;
    }
    let velocity = relative(at, &touch.place);
    let rate = -touch.normal.dot(&velocity);
    let force = normal_law::force(&contact.law, touch.penetration, rate) * contact.share();
    (!force.value.is_zero()).then(|| State {
        slip: Slip::of(&contact.friction, &touch, &velocity),
        touch,
        velocity,
        force,
    })
}

/// δ.
pub(super) fn penetration<S: Scalar>(contact: &Contact<S>, at: &Acting<S>) -> S {
    touch(contact, at).penetration
}

/// δ and n.
pub(super) fn place<S: Scalar>(contact: &Contact<S>, at: &Acting<S>) -> (S, Vec3<S>) {
    let touch = touch(contact, at);
    (touch.penetration, touch.normal)
}

/// A bound of the rate of δ.
pub(super) fn speed<S: Scalar>(contact: &Contact<S>, at: &Acting<S>) -> f64 {
    let turning = |motion: &BodyMotion<S>| motion.omega.map(|x| x.re()).norm();
    let around = match &contact.shape {
        Shape::Sphere => 0.0,
        Shape::Wheel { radius, .. } => radius.re() * turning(at.a.motion),
        Shape::Capsule { half, .. } => {
            length(half).re() * (turning(at.a.motion) + turning(at.b.motion))
        }
    };
    speed_seen(at) + around
}

/// N.
pub(super) fn normal<S: Scalar>(contact: &Contact<S>, at: &Acting<S>) -> S {
    state(contact, at).map_or(S::zero(), |now| now.force.value)
}

/// The size of the friction, μ N |v_t| / s.
pub(super) fn tangential<S: Scalar>(contact: &Contact<S>, at: &Acting<S>) -> S {
    match state(contact, at) {
        Some(State { slip, force, .. }) if !slip.is_none() => {
            slip.coefficient * force.value * length(&slip.tangential) / slip.size
        }
        _ => S::zero(),
    }
}

/// What friction takes, μ N v_tᵀ v_t / s.
pub(super) fn slip_power<S: Scalar>(contact: &Contact<S>, at: &Acting<S>) -> S {
    state(contact, at).map_or(S::zero(), |State { slip, force, .. }| {
        slip.coefficient * force.value * slip.tangential.dot(&slip.tangential) / slip.size
    })
}

/// The elastic energy.
pub(super) fn potential<S: Scalar>(contact: &Contact<S>, at: &Acting<S>) -> S {
    if is_far(contact, at) {
        return S::zero();
    }
    normal_law::potential(&contact.law, penetration(contact, at)).0 * contact.share()
}

/// The place of contact, and the force on body A there, in ground axes; none if nothing touches.
fn pressing<S: Scalar>(contact: &Contact<S>, at: &Acting<S>) -> Option<[Vec3<S>; 2]> {
    let State {
        touch, slip, force, ..
    } = state(contact, at)?;
    let friction = slip.coefficient * force.value / slip.size;
    let force = touch.normal * force.value - slip.tangential * friction;
    Some([touch.place, force])
}

/// The place of contact, and the force on body A there, in ground axes.
pub(super) fn pressed<S: Scalar>(contact: &Contact<S>, at: &Acting<S>) -> [Vec3<S>; 2] {
    pressing(contact, at).unwrap_or_else(|| [touch(contact, at).place, Vec3::zeros()])
}

/// Force (ground axes) and torque (body axes) on body A and on body B.
pub(super) fn forces<S: Scalar>(contact: &Contact<S>, at: &Acting<S>) -> [(Vec3<S>, Vec3<S>); 2] {
    let Some([place, force]) = pressing(contact, at) else {
        return [(Vec3::zeros(), Vec3::zeros()); 2];
    };
    let on = |motion: &BodyMotion<S>, force: Vec3<S>| {
        let moment = (place - motion.position).cross(&force);
        (force, motion.rotation.tr_mul(&moment))
    };
    [on(at.a.motion, force), on(at.b.motion, -force)]
}

/// The derivatives of ψᵀf in the state `now`, if the contact presses.
pub(super) fn pulled<S: Scalar>(
    (contact, now): (&Contact<S>, Option<&State<S>>),
    at: &Acting<S>,
    psi: &Virtual<S>,
) -> Pulled<S> {
    let mut out = Pulled::zero();
    if let Some(now) = now {
        let motions = moving(at, psi);
        now.pull_power(contact, at, &with_motions(at, &motions), &mut out);
    }
    out
}

/// Adds `weight` times the derivatives of N.
pub(super) fn pull_normal<S: Scalar>(
    contact: &Contact<S>,
    at: &Acting<S>,
    weight: S,
    out: &mut Pulled<S>,
) {
    let none = Vec3::zeros();
    let cot = Cotangents {
        force: weight,
        normal: none,
        velocity: none,
        place: none,
    };
    if let Some(now) = state(contact, at) {
        now.pull(contact, at, cot, out);
    }
}

/// Adds `weight` times the derivatives of the size of the friction; zero without slip.
pub(super) fn pull_tangential<S: Scalar>(
    contact: &Contact<S>,
    at: &Acting<S>,
    weight: S,
    out: &mut Pulled<S>,
) {
    let Some(now) = state(contact, at) else {
        return;
    };
    let (slip, width) = (&now.slip, contact.friction.width);
    if slip.is_none() {
        return;
    }
    let speed = length(&slip.tangential);
    let part = speed / slip.size;
    let by_coefficient = weight * now.force.value * part;
    // |v_t| / s has the slope w² / s³ in |v_t| and −|v_t| w / s³ in w.
    let cube = slip.size * slip.size * slip.size;
    let by_part = weight * slip.coefficient * now.force.value;
    let by_width = -(by_part * speed * width / cube);
    slip.give(&contact.friction, (by_coefficient, by_width), out);
    let mut by_tangential = slip.tangential * (by_part * width * width / (cube * speed));
    if let Some(falls) = slip.falls() {
        by_tangential += slip.tangential * (by_coefficient * falls * 2.0);
    }
    let by_force = weight * slip.coefficient * part;
    now.pull_slip(contact, at, (by_force, by_tangential), out);
}

/// Adds `weight` times the derivatives of what friction takes.
pub(super) fn pull_slip_power<S: Scalar>(
    contact: &Contact<S>,
    at: &Acting<S>,
    weight: S,
    out: &mut Pulled<S>,
) {
    let Some(now) = state(contact, at) else {
        return;
    };
    let (slip, width) = (&now.slip, contact.friction.width);
    let square = slip.tangential.dot(&slip.tangential);
    let part = square / slip.size;
    let by_part = weight * slip.coefficient * now.force.value;
    let by_coefficient = weight * now.force.value * part;
    // q / s has the slope (½ q + w²) / s³ in q and −q w / s³ in w.
    let cube = slip.size * slip.size * slip.size;
    slip.give(
        &contact.friction,
        (by_coefficient, -(by_part * square * width / cube)),
        out,
    );
    let mut by_square = by_part * (square * 0.5 + width * width) / cube;
    if let Some(falls) = slip.falls() {
        by_square += by_coefficient * falls;
    }
    let by_force = weight * slip.coefficient * part;
    let by_tangential = slip.tangential * (by_square * 2.0);
    now.pull_slip(contact, at, (by_force, by_tangential), out);
}

/// Adds `weight` times the derivatives of δ.
pub(super) fn pull_penetration<S: Scalar>(
    contact: &Contact<S>,
    at: &Acting<S>,
    weight: S,
    out: &mut Pulled<S>,
) {
    let cot = Cotangent {
        penetration: weight,
        normal: Vec3::zeros(),
        place: Vec3::zeros(),
    };
    touch(contact, at).pull(contact, at, &cot, out);
}

/// Adds `weight` times the derivatives of the elastic energy.
pub(super) fn pull_potential<S: Scalar>(
    contact: &Contact<S>,
    at: &Acting<S>,
    weight: S,
    out: &mut Pulled<S>,
) {
    if is_far(contact, at) {
        return;
    }
    let depth = penetration(contact, at);
    let weight = weight * contact.share();
    let (_, by_depth, [by_stiffness, by_width]) = normal_law::potential(&contact.law, depth);
    out.scalars[LAW] += by_stiffness * weight;
    out.scalars[LAW + 2] += by_width * weight;
    pull_penetration(contact, at, by_depth * weight, out);
}

impl<S: Scalar> State<S> {
    /// Adds the derivatives of ψᵀf; `virtually` has the velocities ψ.
    fn pull_power(
        &self,
        contact: &Contact<S>,
        at: &Acting<S>,
        virtually: &Acting<S>,
        out: &mut Pulled<S>,
    ) {
        let (slip, force) = (&self.slip, &self.force);
        let u = relative(virtually, &self.touch.place);
        let (n, v, a) = (self.touch.normal, self.velocity, slip.apart);
        let b = n.dot(&u);
        let t = slip.tangential.dot(&u) / slip.size;
        // P = N (b − μ t).
        let by_force = b - slip.coefficient * t;
        let by_t = -(slip.coefficient * force.value);
        let by_product = by_t / slip.size;
        let by_size = -(by_t * t / slip.size);
        let by_coefficient = -(force.value * t);
        let by_width = by_size * contact.friction.width / slip.size;
        slip.give(&contact.friction, (by_coefficient, by_width), out);
        // With m = nᵀn: v_t·u = v·u − a b / m, q = vᵀv − a² / m.
        let m = self.touch.square;
        let by_a = -by_size * a / slip.size / m - by_product * b / m;
        let by_b = force.value - by_product * a / m;
        let mut by_v = v * (by_size / slip.size) + u * by_product + n * by_a;
        let by_u = v * by_product + n * by_b;
        let mut by_normal = v * by_a + u * by_b + n * (by_size * a * a / slip.size / (m * m));
        if self.touch.is_crowned {
            by_normal += n * (by_product * a * b * 2.0 / (m * m));
        }
        if let Some(falls) = slip.falls() {
            let by_square = by_coefficient * falls * 2.0;
            let by_a = -by_square * a / m;
            by_v += v * by_square + n * by_a;
            by_normal += v * by_a + n * (by_square * a * a / (m * m));
        }
        let mut place = pull_velocity(&virtually.a, &self.touch.place, by_u, &mut out.a);
        place += pull_velocity(&virtually.b, &self.touch.place, -by_u, &mut out.b);
        hold_virtual(out);
        let cot = Cotangents {
            force: by_force,
            normal: by_normal,
            velocity: by_v,
            place,
        };
        self.pull(contact, at, cot, out);
    }

    /// Pulls the cotangents of N and v_t = v − n (n·v) / nᵀn back.
    fn pull_slip(
        &self,
        contact: &Contact<S>,
        at: &Acting<S>,
        (force, by): (S, Vec3<S>),
        out: &mut Pulled<S>,
    ) {
        let (n, m, a) = (self.touch.normal, self.touch.square, self.slip.apart);
        let along = n.dot(&by) / m;
        let mut normal = -by * (a / m) - self.velocity * along;
        if self.touch.is_crowned {
            normal += n * (along * a * 2.0 / m);
        }
        let cot = Cotangents {
            force,
            normal,
            velocity: by - n * along,
            place: Vec3::zeros(),
        };
        self.pull(contact, at, cot, out);
    }

    /// Pulls cotangents back to the bodies and parameters.
    fn pull(&self, contact: &Contact<S>, at: &Acting<S>, cot: Cotangents<S>, out: &mut Pulled<S>) {
        for (k, by) in self.force.by_law.into_iter().enumerate() {
            out.scalars[LAW + k] += by * cot.force;
        }
        let (n, place) = (self.touch.normal, &self.touch.place);
        let by_apart = -(cot.force * self.force.by_rate);
        let by_velocity = cot.velocity + n * by_apart;
        let mut by_place = cot.place;
        by_place += pull_velocity(&at.a, place, by_velocity, &mut out.a);
        by_place += pull_velocity(&at.b, place, -by_velocity, &mut out.b);
        let cot = Cotangent {
            penetration: cot.force * self.force.by_penetration,
            normal: cot.normal + self.velocity * by_apart,
            place: by_place,
        };
        self.touch.pull(contact, at, &cot, out);
    }
}

/// Pulls the cotangent of the velocity of a body at a place back to its motion. Returns that of the place.
fn pull_velocity<S: Scalar>(
    side: &JointSide<S>,
    place: &Vec3<S>,
    by: Vec3<S>,
    out: &mut SideCotangent<S>,
) -> Vec3<S> {
    let motion = side.motion;
    let arm = place - motion.position;
    let by_spin = motion.rotation.tr_mul(&arm.cross(&by));
    out.velocity += by;
    out.omega += by_spin;
    out.theta += motion.omega.cross(&by_spin);
    let by_arm = by.cross(&(motion.rotation * motion.omega));
    out.position -= by_arm;
    by_arm
}

/// Adds the derivatives in the parameters of a contact to their cotangents; `part` is that of a capsule's half at which it touches, or 0.
pub(super) fn give(pulled: &Pulled<f64>, part: f64, own: &mut Contact<f64>) {
    let scalars = &pulled.scalars;
    own.point_a += pulled.a.frame.point;
    own.point_b += pulled.b.frame.point;
    own.radius += scalars[RADIUS_A];
    friction::give(scalars, &mut own.friction);
    stop::give_law(&scalars[LAW..], &mut own.law);
    match &mut own.surface {
        Surface::Plane { normal } => *normal += pulled.directions[0],
        Surface::Sphere { radius } => *radius += scalars[RADIUS_B],
        Surface::Capsule { half, radius } => {
            *half += pulled.directions[0];
            *radius += scalars[RADIUS_B];
        }
        Surface::Box { halves, radius } => {
            for (own, by) in halves.iter_mut().zip(&pulled.directions) {
                *own += by;
            }
            *radius += scalars[RADIUS_B];
        }
        Surface::Field { axes, .. } => {
            for (own, by) in axes.iter_mut().zip(&pulled.directions) {
                *own += by;
            }
        }
    }
    match &mut own.shape {
        Shape::Sphere => {}
        Shape::Wheel { axis, radius } => {
            *axis += pulled.direction;
            *radius += scalars[WHEEL];
        }
        Shape::Capsule { half, .. } => *half += pulled.direction + pulled.a.frame.point * part,
    }
}
