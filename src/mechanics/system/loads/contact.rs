//! Forces of contacts and all their derivatives.
//!
//! With the centre p of the sphere, x = p − c, c a point of the plane, the centre of the other sphere or the nearest point of
//! the axis of a capsule, R = R_A + R_B, and the relative velocity v of the bodies at the place of contact z:
//!
//! ```text
//! plane      δ = R_A − n·x,   n given,          z = p − R_A n
//! others     δ = R − |x|,     n = x / |x|,      z = p − x R_A / R
//! box        x = y − Σ a_i s_i,   s_i = y·a_i / a_i² within ±1,   y from the centre of the box with the half edges a_i
//! inside it  δ = R − d,   d = n·y − |a|,   n the normal of the nearest face with the half edge a,   z = p − n d R_A / R
//! wheel      p = c_A + ϱ u,   u = −(n − a n·a) / √(1 − (n·a)²),   on a plane; a the axis, ϱ the radius of its circle
//! δ̇ = −n·v,   v_t = v − n (n·v),   t = v_tᵀ u / s,   s = √(v_tᵀ v_t + w²)
//! ψᵀf = N (n·u − μ t)                            u: the relative velocity of ψ at z
//! ```
//!
//! The normal force has no power along the tangent, so δ̇ follows from v at z whatever the place of z along n. The pull-backs
//! go from the cotangents of δ, n, v, u and z to the bodies.

use super::normal_law;
use super::power::relative;
use super::pull::{Pulled, pull_point};
use super::{Acting, stop};
use crate::math::scalar::length;
use crate::math::{Scalar, Vec3};
use crate::model::contact::{Contact, Surface, Wheel};

use crate::system::bodies::BodyMotion;
use crate::system::constraint::SideCotangent;
use crate::system::side::JointSide;

/// Places of the scalars of a contact.
const RADIUS_A: usize = 0;
const LAW: usize = 1;
const FRICTION: usize = 4;
const SLIP: usize = 5;
const RADIUS_B: usize = 6;
const WHEEL: usize = 7;
/// Place of the axis of a wheel among the directions; a plane has one.
const AXIS: usize = 1;

/// A contact at an instant.
struct State<S> {
    /// From c to p.
    x: Vec3<S>,
    /// The distance |x|, or n·x above a plane.
    distance: S,
    normal: Vec3<S>,
    penetration: S,
    /// Place of contact z in ground axes.
    place: Vec3<S>,
    /// v.
    velocity: Vec3<S>,
    /// Share R_A / R of a curved surface.
    share: S,
    /// Where the axis of a capsule or the half edges of a box are nearest, as a fraction of each; whether that is between its ends.
    along: [(S, bool); 3],
    /// The nearest face of a box that p is in: its half edge.
    face: Option<usize>,
    /// From the centre of a wheel to p, of length 1, and √(1 − (n·a)²).
    down: Option<(Vec3<S>, S)>,
}

/// Cotangents of the quantities of a contact.
struct Cotangent<S> {
    penetration: S,
    normal: Vec3<S>,
    velocity: Vec3<S>,
    place: Vec3<S>,
}

/// Tangential velocity, s and their square.
struct Slip<S> {
    tangential: Vec3<S>,
    approach: S,
    size: S,
}

fn state<S: Scalar>(contact: &Contact<S>, at: &Acting<S>) -> State<S> {
    let (p, o) = (at.a.point(), at.b.point());
    let y = p - o;
    let turned = |direction: &Vec3<S>| at.b.motion.rotation * direction;
    let (zero, one) = (S::zero(), S::one());
    let nowhere = [(zero, false); 3];
    let radius = match &contact.surface {
        Surface::Plane { normal } => {
            let normal = turned(normal);
            let down = contact.wheel.as_ref().map(|own| lowest(own, at, &normal));
            let centre = match (&contact.wheel, &down) {
                (Some(own), Some((down, _))) => p + down * own.radius,
                _ => p,
            };
            let x = centre - o;
            let distance = normal.dot(&x);
            let place = centre - normal * contact.radius;
            return State {
                x,
                distance,
                normal,
                penetration: contact.radius - distance,
                place,
                velocity: relative(at, &place),
                share: one,
                along: nowhere,
                face: None,
                down,
            };
        }
        Surface::Sphere { radius }
        | Surface::Capsule { radius, .. }
        | Surface::Box { radius, .. } => *radius,
    };
    let mut along = nowhere;
    let mut x = y;
    for (half, along) in contact.surface.directions().iter().zip(&mut along) {
        let a = turned(half);
        let free = y.dot(&a) / a.dot(&a);
        *along = match free.re() {
            s if s >= 1.0 => (one, false),
            s if s <= -1.0 => (-one, false),
            _ => (free, true),
        };
        x -= a * along.0;
    }
    let sum = contact.radius + radius;
    // A point and sharp edges have no radius.
    let share = match sum.re() {
        0.0 => zero,
        _ => contact.radius / sum,
    };
    let mut face = None;
    let (mut distance, mut normal) = (zero, Vec3::zeros());
    if let Surface::Box { halves, .. } = &contact.surface
        && along.iter().all(|own| own.1)
    {
        let depth = |i: &usize| (1.0 - along[*i].0.re().abs()) * length(&halves[*i]).re();
        let nearest = (0..3).min_by(|i, k| depth(i).total_cmp(&depth(k)));
        if let Some(i) = nearest {
            let size = length(&halves[i]);
            normal = turned(&halves[i]) * (S::from(along[i].0.re().signum()) / size);
            distance = normal.dot(&y) - size;
            x = normal * distance;
            face = nearest;
        }
    }
    if face.is_none() {
        distance = length(&x);
        normal = x / distance;
    }
    let place = p - x * share;
    State {
        x,
        distance,
        normal,
        penetration: sum - distance,
        place,
        velocity: relative(at, &place),
        share,
        along,
        face,
        down: None,
    }
}

/// Where a wheel is lowest on a plane with this normal, from its centre, of length 1; and √(1 − (n·a)²).
fn lowest<S: Scalar>(wheel: &Wheel<S>, at: &Acting<S>, normal: &Vec3<S>) -> (Vec3<S>, S) {
    let axis = at.a.motion.rotation * wheel.axis;
    let across = normal - axis * axis.dot(normal);
    let size = length(&across);
    (-across / size, size)
}

fn slip<S: Scalar>(contact: &Contact<S>, now: &State<S>) -> Slip<S> {
    let approach = now.normal.dot(&now.velocity);
    let tangential = now.velocity - now.normal * approach;
    let square = tangential.dot(&tangential) + contact.slip * contact.slip;
    Slip {
        tangential,
        approach,
        size: square.sqrt(),
    }
}

impl<S: Scalar> Slip<S> {
    fn is_none(&self) -> bool {
        self.tangential.iter().all(|x| x.re() == 0.0)
    }
}

impl<S: Scalar> State<S> {
    /// N and its derivatives.
    fn force(&self, contact: &Contact<S>) -> normal_law::NormalForce<S> {
        let rate = -self.normal.dot(&self.velocity);
        normal_law::force(&contact.law, self.penetration, rate)
    }
}

/// Whether the centre of A is where a curved surface has no normal: in the centre of a sphere or on the axis of a capsule.
pub(super) fn meets(contact: &Contact<f64>, at: &Acting<f64>) -> bool {
    let curved = match contact.surface {
        Surface::Plane { .. } => contact.wheel.is_some(),
        Surface::Box { .. } => false,
        Surface::Sphere { .. } | Surface::Capsule { .. } => true,
    };
    if let (Some(wheel), Surface::Plane { normal }) = (&contact.wheel, &contact.surface) {
        let normal = at.b.motion.rotation * normal;
        return lowest(wheel, at, &normal).1 <= super::ROUND_OFF;
    }
    curved
        && state(contact, at).distance <= super::ROUND_OFF * contact.radius.max(at.a.point().norm())
}

/// δ.
pub(super) fn penetration<S: Scalar>(contact: &Contact<S>, at: &Acting<S>) -> S {
    state(contact, at).penetration
}

/// N.
pub(super) fn normal<S: Scalar>(contact: &Contact<S>, at: &Acting<S>) -> S {
    state(contact, at).force(contact).value
}

/// The size of the friction, μ N |v_t| / s.
pub(super) fn tangential<S: Scalar>(contact: &Contact<S>, at: &Acting<S>) -> S {
    let now = state(contact, at);
    let slip = slip(contact, &now);
    if slip.is_none() {
        return S::zero();
    }
    contact.friction * now.force(contact).value * length(&slip.tangential) / slip.size
}

/// The elastic energy.
pub(super) fn potential<S: Scalar>(contact: &Contact<S>, at: &Acting<S>) -> S {
    normal_law::potential(&contact.law, state(contact, at).penetration).0
}

/// The place of contact, and the force on body A there, in ground axes.
pub(super) fn pressed<S: Scalar>(contact: &Contact<S>, at: &Acting<S>) -> [Vec3<S>; 2] {
    let now = state(contact, at);
    let normal = now.force(contact).value;
    if normal.is_zero() {
        return [now.place, Vec3::zeros()];
    }
    let slip = slip(contact, &now);
    let friction = contact.friction * normal / slip.size;
    [now.place, now.normal * normal - slip.tangential * friction]
}

/// Force (ground axes) and torque (body axes) on body A and on body B.
pub(super) fn forces<S: Scalar>(contact: &Contact<S>, at: &Acting<S>) -> [(Vec3<S>, Vec3<S>); 2] {
    let [place, force] = pressed(contact, at);
    if force.iter().all(|x| x.is_zero()) {
        return [(Vec3::zeros(), Vec3::zeros()); 2];
    }
    let on = |motion: &BodyMotion<S>, force: Vec3<S>| {
        let moment = (place - motion.position).cross(&force);
        (force, motion.rotation.tr_mul(&moment))
    };
    [on(at.a.motion, force), on(at.b.motion, -force)]
}

/// Adds the derivatives of ψᵀf; `virtually` has the velocities ψ.
pub(super) fn pull<S: Scalar>(
    contact: &Contact<S>,
    at: &Acting<S>,
    virtually: &Acting<S>,
    out: &mut Pulled<S>,
) {
    let now = state(contact, at);
    let force = now.force(contact);
    if force.value.is_zero() {
        return;
    }
    let slip = slip(contact, &now);
    let u = relative(virtually, &now.place);
    let (n, v, a) = (now.normal, now.velocity, slip.approach);
    let b = n.dot(&u);
    let t = slip.tangential.dot(&u) / slip.size;
    // P = N (b − μ t).
    let by_force = b - contact.friction * t;
    give_force(&force, by_force, out);
    out.scalars[FRICTION] -= force.value * t;
    let by_t = -(contact.friction * force.value);
    let by_product = by_t / slip.size;
    let by_size = -(by_t * t / slip.size);
    out.scalars[SLIP] += by_size * contact.slip / slip.size;
    let by_a = -(by_force * force.by_rate) - by_size * a / slip.size - by_product * b;
    let by_b = force.value - by_product * a;
    let by_v = v * (by_size / slip.size) + u * by_product + n * by_a;
    let by_u = v * by_product + n * by_b;
    let mut place = pull_velocity(&virtually.a, &now.place, by_u, &mut out.a);
    place += pull_velocity(&virtually.b, &now.place, -by_u, &mut out.b);
    super::pull::hold_virtual(out);
    let cot = Cotangent {
        penetration: by_force * force.by_penetration,
        normal: v * by_a + u * by_b + n * (by_size * a * a / slip.size),
        velocity: by_v,
        place,
    };
    pull_state(contact, at, &now, cot, out);
}

/// Adds `weight` times the derivatives of N.
pub(super) fn pull_normal<S: Scalar>(
    contact: &Contact<S>,
    at: &Acting<S>,
    weight: S,
    out: &mut Pulled<S>,
) {
    let now = state(contact, at);
    let force = now.force(contact);
    give_force(&force, weight, out);
    let by_a = -(weight * force.by_rate);
    let cot = Cotangent {
        penetration: weight * force.by_penetration,
        normal: now.velocity * by_a,
        velocity: now.normal * by_a,
        place: Vec3::zeros(),
    };
    pull_state(contact, at, &now, cot, out);
}

/// Adds `weight` times the derivatives of the size of the friction; zero without slip.
pub(super) fn pull_tangential<S: Scalar>(
    contact: &Contact<S>,
    at: &Acting<S>,
    weight: S,
    out: &mut Pulled<S>,
) {
    let now = state(contact, at);
    let slip = slip(contact, &now);
    if slip.is_none() {
        return;
    }
    let force = now.force(contact);
    let speed = length(&slip.tangential);
    let part = speed / slip.size;
    let by_force = weight * contact.friction * part;
    give_force(&force, by_force, out);
    out.scalars[FRICTION] += weight * force.value * part;
    // |v_t| / s has the slope w² / s³ in |v_t| and −|v_t| w / s³ in w.
    let cube = slip.size * slip.size * slip.size;
    let by_part = weight * contact.friction * force.value;
    out.scalars[SLIP] -= by_part * speed * contact.slip / cube;
    let by_tangential = slip.tangential * (by_part * contact.slip * contact.slip / (cube * speed));
    // v_t is across n.
    let by_a = -(by_force * force.by_rate);
    let cot = Cotangent {
        penetration: by_force * force.by_penetration,
        normal: now.velocity * by_a - by_tangential * slip.approach,
        velocity: now.normal * by_a + by_tangential,
        place: Vec3::zeros(),
    };
    pull_state(contact, at, &now, cot, out);
}

/// Adds `weight` times the derivatives of δ.
pub(super) fn pull_penetration<S: Scalar>(
    contact: &Contact<S>,
    at: &Acting<S>,
    weight: S,
    out: &mut Pulled<S>,
) {
    let now = state(contact, at);
    let cot = Cotangent {
        penetration: weight,
        normal: Vec3::zeros(),
        velocity: Vec3::zeros(),
        place: Vec3::zeros(),
    };
    pull_state(contact, at, &now, cot, out);
}

/// Adds `weight` times the derivatives of the elastic energy.
pub(super) fn pull_potential<S: Scalar>(
    contact: &Contact<S>,
    at: &Acting<S>,
    weight: S,
    out: &mut Pulled<S>,
) {
    let depth = penetration(contact, at);
    let (_, by_depth, [by_stiffness, by_width]) = normal_law::potential(&contact.law, depth);
    out.scalars[LAW] += by_stiffness * weight;
    out.scalars[LAW + 2] += by_width * weight;
    pull_penetration(contact, at, by_depth * weight, out);
}

/// Adds the derivatives of `weight` N in the parameters of the law.
fn give_force<S: Scalar>(force: &normal_law::NormalForce<S>, weight: S, out: &mut Pulled<S>) {
    for (k, by) in force.by_law.into_iter().enumerate() {
        out.scalars[LAW + k] += by * weight;
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

/// Pulls the cotangent of direction i of body B in ground axes back.
fn pull_direction<S: Scalar>(
    side: &JointSide<S>,
    (i, direction): (usize, &Vec3<S>),
    by: Vec3<S>,
    out: &mut Pulled<S>,
) {
    let local = side.motion.rotation.tr_mul(&by);
    out.b.theta += direction.cross(&local);
    out.directions[i] += local;
}

/// Pulls the cotangent of the centre c + ϱ u of the lowest sphere of a wheel back to its axis and radius. Returns that of the normal
/// of the plane.
fn pull_wheel<S: Scalar>(
    wheel: &Wheel<S>,
    (at, now): (&Acting<S>, &State<S>),
    by_centre: Vec3<S>,
    out: &mut Pulled<S>,
) -> Vec3<S> {
    let Some((down, size)) = now.down else {
        return Vec3::zeros();
    };
    let (n, rotation) = (now.normal, &at.a.motion.rotation);
    let axis = rotation * wheel.axis;
    out.scalars[WHEEL] += down.dot(&by_centre);
    let by_down = by_centre * wheel.radius;
    let by_across = (down * down.dot(&by_down) - by_down) / size;
    let by_axis = -(by_across * axis.dot(&n)) - n * axis.dot(&by_across);
    let local = rotation.tr_mul(&by_axis);
    out.a.theta += wheel.axis.cross(&local);
    out.directions[AXIS] += local;
    by_across - axis * axis.dot(&by_across)
}

/// Pulls the cotangents of the contact with a face of a box that p is in.
fn pull_face<S: Scalar>(
    contact: &Contact<S>,
    at: &Acting<S>,
    (now, i): (&State<S>, usize),
    (cot, by_place): (&Cotangent<S>, Vec3<S>),
    out: &mut Pulled<S>,
) {
    let Surface::Box { halves, radius } = &contact.surface else {
        return;
    };
    let (n, d) = (now.normal, now.distance);
    let y = at.a.point() - at.b.point();
    let toward = n.dot(&by_place);
    // δ = R − d, z = p − n d R_A / R.
    let by_distance = -cot.penetration - toward * now.share;
    let by_normal = cot.normal - by_place * (d * now.share) + y * by_distance;
    let sum = contact.radius + *radius;
    if sum.re() != 0.0 {
        let by_share = -(toward * d) / (sum * sum);
        out.scalars[RADIUS_A] += by_share * *radius;
        out.scalars[RADIUS_B] -= by_share * contact.radius;
    }
    out.scalars[RADIUS_A] += cot.penetration;
    out.scalars[RADIUS_B] += cot.penetration;
    let size = length(&halves[i]);
    let sign = S::from(now.along[i].0.re().signum());
    let across = by_normal - n * n.dot(&by_normal);
    let by_half = across * (sign / size) - n * (sign * by_distance);
    pull_direction(&at.b, (i, &halves[i]), by_half, out);
    let none = Vec3::zeros();
    let by_y = n * by_distance;
    pull_point(&at.a, [by_y + by_place, none], &mut out.a);
    pull_point(&at.b, [-by_y, none], &mut out.b);
}

/// Pulls the cotangents of a contact's quantities back to the bodies and parameters.
fn pull_state<S: Scalar>(
    contact: &Contact<S>,
    at: &Acting<S>,
    now: &State<S>,
    cot: Cotangent<S>,
    out: &mut Pulled<S>,
) {
    let mut by_place = cot.place;
    by_place += pull_velocity(&at.a, &now.place, cot.velocity, &mut out.a);
    by_place += pull_velocity(&at.b, &now.place, -cot.velocity, &mut out.b);
    let (n, by_depth) = (now.normal, cot.penetration);
    let none = Vec3::zeros();
    let radius_b = match &contact.surface {
        Surface::Plane { normal } => {
            out.scalars[RADIUS_A] += by_depth - n.dot(&by_place);
            pull_point(&at.a, [by_place - n * by_depth, none], &mut out.a);
            pull_point(&at.b, [n * by_depth, none], &mut out.b);
            let mut by_normal = cot.normal - now.x * by_depth - by_place * contact.radius;
            if let Some(wheel) = &contact.wheel {
                let by_centre = by_place - n * by_depth;
                by_normal += pull_wheel(wheel, (at, now), by_centre, out);
            }
            return pull_direction(&at.b, (0, normal), by_normal, out);
        }
        Surface::Sphere { radius }
        | Surface::Capsule { radius, .. }
        | Surface::Box { radius, .. } => *radius,
    };
    if let Some(i) = now.face {
        return pull_face(contact, at, (now, i), (&cot, by_place), out);
    }
    let sum = contact.radius + radius_b;
    // z = p − x R_A / R.
    out.scalars[RADIUS_A] += by_depth;
    out.scalars[RADIUS_B] += by_depth;
    if sum.re() != 0.0 {
        let by_share = -now.x.dot(&by_place) / (sum * sum);
        out.scalars[RADIUS_A] += by_share * radius_b;
        out.scalars[RADIUS_B] -= by_share * contact.radius;
    }
    let across = cot.normal - n * n.dot(&cot.normal);
    let by_x = across / now.distance - n * by_depth - by_place * now.share;
    let y = at.a.point() - at.b.point();
    let mut by_y = by_x;
    let halves = contact.surface.directions().iter().zip(now.along);
    for (i, (half, (s, between))) in halves.enumerate() {
        let a = at.b.motion.rotation * half;
        let mut by_a = -(by_x * s);
        if between {
            // x has −a s, s = y·a / a·a.
            let part = a.dot(&by_x) / a.dot(&a);
            by_a -= (y - a * (s * 2.0)) * part;
            by_y -= a * part;
        }
        pull_direction(&at.b, (i, half), by_a, out);
    }
    pull_point(&at.a, [by_y + by_place, none], &mut out.a);
    pull_point(&at.b, [-by_y, none], &mut out.b);
}

/// Adds the derivatives in the parameters of a contact to their cotangents.
pub(super) fn give(pulled: &Pulled<f64>, own: &mut Contact<f64>) {
    let scalars = &pulled.scalars;
    own.point_a += pulled.a.frame.point;
    own.point_b += pulled.b.frame.point;
    own.radius += scalars[RADIUS_A];
    own.friction += scalars[FRICTION];
    own.slip += scalars[SLIP];
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
    }
    if let Some(wheel) = &mut own.wheel {
        wheel.axis += pulled.directions[AXIS];
        wheel.radius += scalars[WHEEL];
    }
}
