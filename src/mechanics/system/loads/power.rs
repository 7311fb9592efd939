//! The forces of the simple kinds of load, and what the others are made of.

use super::Acting;
use crate::math::scalar::length;
use crate::math::{Scalar, Vec3};
use crate::model::{Axes, ConstraintRow, DegreeOfFreedom, ForceTable, LoadKind};
use crate::system::bodies::BodyMotion;
use crate::system::constraint;
use crate::system::marker::MarkerKinematics;
use std::f64::consts::TAU;

/// The row whose rate is that of a displacement along the axis of a joint.
pub(super) const SLIDE: ConstraintRow = ConstraintRow::Sliding { a: 2 };

/// Force (ground axes) and torque (body axes, about the centre of mass) on body A and on body B.
pub(super) fn forces<S: Scalar>(
    kind: &LoadKind<S>,
    at: &Acting<S>,
    time: S,
) -> [(Vec3<S>, Vec3<S>); 2] {
    let none = (Vec3::zeros(), Vec3::zeros());
    let (ra, rb) = (&at.a.motion.rotation, &at.b.motion.rotation);
    let sa = &at.a.frame.point;
    match kind {
        LoadKind::Force {
            direction,
            axes,
            magnitude,
            ..
        } => {
            let n = direction * magnitude.value(time);
            let on_a = match axes {
                Axes::Ground => (n, sa.cross(&ra.tr_mul(&n))),
                Axes::Body => (ra * n, sa.cross(&n)),
            };
            [on_a, none]
        }
        LoadKind::Torque {
            direction,
            axes,
            magnitude,
            ..
        } => {
            let n = direction * magnitude.value(time);
            let torque = match axes {
                Axes::Ground => ra.tr_mul(&n),
                Axes::Body => n,
            };
            [(Vec3::zeros(), torque), none]
        }
        LoadKind::Damping {
            dof,
            coefficient,
            table,
            ..
        } => along(at, *dof, |rate| damping(*coefficient, table, rate)[0]),
        LoadKind::Friction {
            dof, size, width, ..
        } => along(at, *dof, |rate| -(*size * tanh(rate / *width))),
        LoadKind::BallDamping { coefficient, .. } => {
            let relative = ra * at.a.motion.omega - rb * at.b.motion.omega;
            let torque = relative * *coefficient;
            [
                (Vec3::zeros(), -ra.tr_mul(&torque)),
                (Vec3::zeros(), rb.tr_mul(&torque)),
            ]
        }
        // They have files of their own.
        LoadKind::Spring { .. }
        | LoadKind::TorsionSpring { .. }
        | LoadKind::JointStop { .. }
        | LoadKind::DistanceStop { .. }
        | LoadKind::Drag { .. }
        | LoadKind::Contact(_)
        | LoadKind::Bushing { .. }
        | LoadKind::Controller(_)
        | LoadKind::Cable(_)
        | LoadKind::Distributed(_) => [none, none],
    }
}

/// The force −(c r + D(r)) of a damper at the rate r, and its slope.
pub(super) fn damping<S: Scalar>(c: S, table: &Option<ForceTable<S>>, rate: S) -> [S; 2] {
    let own = table.as_ref().map(|table| table.force(rate));
    let [force, slope] = own.unwrap_or([S::zero(); 2]);
    [-(c * rate + force), -(c + slope)]
}

/// The rate of a degree of freedom of a joint.
pub(super) fn rate_of<S: Scalar>(at: &Acting<S>, dof: DegreeOfFreedom) -> S {
    match dof {
        DegreeOfFreedom::Rotation => turn_rate(at),
        DegreeOfFreedom::Translation => constraint::rate(SLIDE, &at.a, &at.b),
    }
}

/// Forces of size `law(rate)` along or about the axis of a joint.
pub(super) fn along<S: Scalar>(
    at: &Acting<S>,
    dof: DegreeOfFreedom,
    law: impl Fn(S) -> S,
) -> [(Vec3<S>, Vec3<S>); 2] {
    match dof {
        DegreeOfFreedom::Rotation => about_axis(at, law(turn_rate(at))),
        DegreeOfFreedom::Translation => {
            let size = law(constraint::rate(SLIDE, &at.a, &at.b));
            let g = constraint::gradient(SLIDE, &at.a, &at.b);
            [
                (g.force * size, g.torque_a * size),
                (g.force * -size, g.torque_b * size),
            ]
        }
    }
}

pub(super) fn about_axis<S: Scalar>(at: &Acting<S>, torque: S) -> [(Vec3<S>, Vec3<S>); 2] {
    let e = at.a.frame.axes[2];
    let in_b = at.b.motion.rotation.tr_mul(&(at.a.motion.rotation * e));
    [(Vec3::zeros(), e * torque), (Vec3::zeros(), in_b * -torque)]
}

/// φ̇ = e · (ω_A − ω_B), where e is the third axis of the frame on A.
pub(super) fn turn_rate<S: Scalar>(at: &Acting<S>) -> S {
    let (a, b) = (at.a.motion, at.b.motion);
    let e = &at.a.frame.axes[2];
    e.dot(&a.omega) - (a.rotation * e).dot(&(b.rotation * b.omega))
}

/// The angle φ of frame A relative to frame B about the third axis, minus `rest`: in (−π, π], if its turns are not counted.
pub(super) fn angle<S: Scalar>(at: &Acting<S>, rest: S) -> S {
    let a1 = at.a.motion.rotation * at.a.frame.axes[0];
    let [x, y] = [0, 1].map(|i| a1.dot(&(at.b.motion.rotation * at.b.frame.axes[i])));
    let (s, c) = rest.sin_cos();
    let angle = (y * c - x * s).atan2(x * c + y * s);
    match at.counted {
        Some(counted) => {
            let turns = ((counted - rest.re() - angle.re()) / TAU).round();
            angle + TAU * turns
        }
        None => angle,
    }
}

/// Length of a spring, its rate, and its direction from B to A.
pub(super) struct SpringLength<S> {
    pub length: S,
    pub rate: S,
    pub direction: Vec3<S>,
    /// The vector from B to A.
    pub apart: Vec3<S>,
}

/// The distance of the points of a load. The points are apart.
pub(super) fn apart<S: Scalar>(at: &Acting<S>) -> SpringLength<S> {
    let a = MarkerKinematics::point(at.a.motion, &at.a.frame.point);
    let b = MarkerKinematics::point(at.b.motion, &at.b.frame.point);
    let d = a.x - b.x;
    let length = length(&d);
    let direction = d / length;
    SpringLength {
        length,
        rate: direction.dot(&(a.rate - b.rate)),
        direction,
        apart: d,
    }
}

/// Velocity of the point of a body that is at a place in ground axes.
pub(super) fn velocity_at<S: Scalar>(motion: &BodyMotion<S>, place: &Vec3<S>) -> Vec3<S> {
    motion.velocity + (motion.rotation * motion.omega).cross(&(place - motion.position))
}

/// Velocity of A against B at a place.
pub(super) fn relative<S: Scalar>(at: &Acting<S>, place: &Vec3<S>) -> Vec3<S> {
    velocity_at(at.a.motion, place) - velocity_at(at.b.motion, place)
}

/// The speed of the point of A as body B sees it: no distance from what is fixed on B changes faster.
pub(super) fn speed_seen<S: Scalar>(at: &Acting<S>) -> f64 {
    let seen = relative(at, &at.a.point());
    seen.map(Scalar::re).norm()
}

/// Hyperbolic tangent.
pub(super) fn tanh<S: Scalar>(x: S) -> S {
    if x.re() < 0.0 {
        return -tanh(-x);
    }
    let e = (x * -2.0).exp();
    (S::one() - e) / (S::one() + e)
}
