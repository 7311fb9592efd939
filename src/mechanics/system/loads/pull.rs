//! The transposed derivative of the power ψᵀf of each kind of load.

use super::Acting;
use super::power::{SLIDE, SpringLength, damping, tanh, turn_rate};
use crate::math::{Scalar, Vec3};
use crate::model::{Axes, ConstraintRow, DegreeOfFreedom, LoadKind};
use crate::system::bodies::BodyMotion;
use crate::system::constraint::{self, SideCotangent};
use crate::system::marker::{self, MarkerKinematics};
use crate::system::rows::RowCotangent;
use crate::system::side::JointSide;

/// Most scalars of a load: a contact has as many.
pub(super) const SCALARS: usize = 10;

/// Derivatives of the power (or energy) of a load.
pub(super) struct Pulled<S> {
    /// In the motion of body A, and in the load's point or frame on it.
    pub a: SideCotangent<S>,
    /// The same for body B.
    pub b: SideCotangent<S>,
    /// In the direction of a force or torque, or that of the shape of a contact.
    pub direction: Vec3<S>,
    /// Of a contact: in the directions of its surface.
    pub directions: [Vec3<S>; 3],
    /// In the scalars of the load, in the order of its definition. For a force or torque the first
    /// is the magnitude.
    pub scalars: [S; SCALARS],
    /// Of a bushing: vectors a, b, c, so that the derivatives in its matrices are a bᵀ and a cᵀ.
    pub six: Option<[[S; 6]; 3]>,
    /// Where the tables of a spring or damper are read: at the stretch and at its rate.
    pub places: [S; 2],
    /// In the forces of both tables there, and in the energy of the first.
    pub by_tables: [S; 3],
}

impl<S: Scalar> Pulled<S> {
    pub(super) fn zero() -> Self {
        Self {
            a: SideCotangent::fixed(),
            b: SideCotangent::fixed(),
            direction: Vec3::zeros(),
            directions: [Vec3::zeros(); 3],
            scalars: [S::zero(); SCALARS],
            six: None,
            places: [S::zero(); 2],
            by_tables: [S::zero(); 3],
        }
    }

    /// Sets the first scalars.
    pub(super) fn set_scalars<const N: usize>(&mut self, scalars: [S; N]) {
        self.scalars[..N].copy_from_slice(&scalars);
    }
}

/// Virtual velocities (linear in ground axes, angular in body axes) of body A and body B.
pub(super) type Virtual<S> = [(Vec3<S>, Vec3<S>); 2];

/// The load's bodies with the velocities ψ.
pub(super) fn moving<S: Scalar>(at: &Acting<S>, psi: &Virtual<S>) -> [BodyMotion<S>; 2] {
    let with = |motion: &BodyMotion<S>, (velocity, omega): (Vec3<S>, Vec3<S>)| BodyMotion {
        velocity,
        omega,
        ..*motion
    };
    [with(at.a.motion, psi[0]), with(at.b.motion, psi[1])]
}

/// The load with other motions of its bodies.
pub(super) fn with_motions<'a, S: Scalar>(
    at: &Acting<S>,
    motions: &'a [BodyMotion<S>; 2],
) -> Acting<'a, S> {
    Acting {
        bodies: at.bodies,
        a: JointSide::fixed(&motions[0], at.a.frame),
        b: JointSide::fixed(&motions[1], at.b.frame),
        counted: at.counted,
        part: at.part,
    }
}

/// Adds the derivatives of ψᵀf; `virtually` has the velocities ψ.
pub(super) fn pull<S: Scalar>(
    kind: &LoadKind<S>,
    at: &Acting<S>,
    time: S,
    virtually: &Acting<S>,
    out: &mut Pulled<S>,
) {
    let (psi_a, psi_b) = (virtually.a.motion, virtually.b.motion);
    match kind {
        LoadKind::Force {
            direction,
            axes,
            magnitude,
            point,
            ..
        } => {
            let m = magnitude.value(time);
            let by = match axes {
                Axes::Ground => {
                    let rate = MarkerKinematics::point(psi_a, point).rate;
                    pull_point(&virtually.a, [Vec3::zeros(), direction * m], &mut out.a);
                    rate
                }
                Axes::Body => {
                    let (linear, angular) = (psi_a.velocity, psi_a.omega);
                    let local = at.a.motion.rotation.tr_mul(&linear);
                    out.a.theta += direction.cross(&local) * m;
                    out.a.frame.point += direction.cross(&angular) * m;
                    local + angular.cross(point)
                }
            };
            out.direction = by * m;
            out.scalars[0] = by.dot(direction);
            // The virtual velocities are constant.
            (out.a.velocity, out.a.omega) = (Vec3::zeros(), Vec3::zeros());
        }
        LoadKind::Torque {
            direction,
            axes,
            magnitude,
            ..
        } => {
            let m = magnitude.value(time);
            let omega = psi_a.omega;
            let by = match axes {
                Axes::Ground => {
                    let local = at.a.motion.rotation.tr_mul(direction);
                    out.a.theta += omega.cross(&local) * m;
                    at.a.motion.rotation * omega
                }
                Axes::Body => omega,
            };
            out.direction = by * m;
            out.scalars[0] = by.dot(direction);
        }
        LoadKind::Damping {
            dof,
            coefficient,
            table,
            ..
        } => {
            let law = |rate: S| damping(*coefficient, table, rate).into();
            let (rate, virtual_rate) = pull_along(at, virtually, *dof, law, out);
            out.scalars[0] = -(rate * virtual_rate);
            (out.places[1], out.by_tables[1]) = (rate, -virtual_rate);
        }
        LoadKind::Friction {
            dof, size, width, ..
        } => {
            let law = |rate: S| {
                let t = tanh(rate / *width);
                (-(*size * t), -(*size * (S::one() - t * t) / *width))
            };
            let (rate, virtual_rate) = pull_along(at, virtually, *dof, law, out);
            let by_rate = law(rate).1;
            out.scalars[0] = -(tanh(rate / *width) * virtual_rate);
            out.scalars[1] = -(by_rate * virtual_rate * rate / *width);
        }
        LoadKind::BallDamping { coefficient, .. } => {
            let (ra, rb) = (&at.a.motion.rotation, &at.b.motion.rotation);
            let (wa, wb) = (at.a.motion.omega, at.b.motion.omega);
            let (pa, pb) = (psi_a.omega, psi_b.omega);
            // ψᵀf = −c X · Y with the relative angular velocities X (real) and Y (virtual).
            let (x, y) = (ra * wa - rb * wb, ra * pa - rb * pb);
            let c = *coefficient;
            out.scalars[0] = -x.dot(&y);
            let (xa, ya) = (ra.tr_mul(&x), ra.tr_mul(&y));
            out.a.theta = (wa.cross(&ya) + pa.cross(&xa)) * -c;
            out.a.omega = ya * -c;
            let (xb, yb) = (rb.tr_mul(&x), rb.tr_mul(&y));
            out.b.theta = (wb.cross(&yb) + pb.cross(&xb)) * c;
            out.b.omega = yb * c;
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
        | LoadKind::Distributed(_) => {}
    }
}

/// Clears the derivatives in velocities, because the virtual ones are constant.
pub(super) fn hold_virtual<S: Scalar>(out: &mut Pulled<S>) {
    for side in [&mut out.a, &mut out.b] {
        (side.velocity, side.omega) = (Vec3::zeros(), Vec3::zeros());
    }
}

/// Pulls the cotangents of a point's position and velocity back.
pub(super) fn pull_point<S: Scalar>(
    side: &JointSide<S>,
    [x, rate]: [Vec3<S>; 2],
    out: &mut SideCotangent<S>,
) {
    let acceleration = Vec3::zeros();
    let cot = MarkerKinematics {
        x,
        rate,
        acceleration,
        virtual_rate: Vec3::zeros(),
    };
    let by = marker::pull_back(side.motion, &side.frame.point, &cot);
    out.position += x;
    out.velocity += rate;
    out.theta += by.theta;
    out.omega += by.omega;
    out.frame.point += by.vector;
}

/// Pulls the cotangent of an axis back.
pub(super) fn pull_axis<S: Scalar>(
    side: &JointSide<S>,
    axis: usize,
    x: Vec3<S>,
    out: &mut SideCotangent<S>,
) {
    let by = marker::pull_back(
        side.motion,
        &side.frame.axes[axis],
        &MarkerKinematics::fixed(x),
    );
    out.theta += by.theta;
    out.frame.axes[axis] += by.vector;
}

/// Pulls the cotangents of a spring's length and its rate back.
pub(super) fn pull_rate<S: Scalar>(
    at: &Acting<S>,
    now: &SpringLength<S>,
    (by_length, by_rate): (S, S),
    out: &mut Pulled<S>,
) {
    let (length, direction) = (now.length, now.direction);
    let speed = |side: &JointSide<S>| side.point_jet().rate;
    let apart = speed(&at.a) - speed(&at.b);
    // The component of a displacement across the direction turns it.
    let across = apart - direction * direction.dot(&apart);
    let turning = match by_rate.is_zero() {
        true => S::zero(),
        false => by_rate / length,
    };
    let x = direction * by_length + across * turning;
    let rate = direction * by_rate;
    pull_point(&at.a, [x, rate], &mut out.a);
    pull_point(&at.b, [-x, -rate], &mut out.b);
}

/// Pulls the cotangent of [`turn_rate`] back.
pub(super) fn pull_turn<S: Scalar>(at: &Acting<S>, cot: S, out: &mut Pulled<S>) {
    let (a, b) = (at.a.motion, at.b.motion);
    let e = at.a.frame.axes[2];
    let omega_in_a = a.rotation.tr_mul(&(b.rotation * b.omega));
    let e_in_b = b.rotation.tr_mul(&(a.rotation * e));
    out.a.frame.axes[2] += (a.omega - omega_in_a) * cot;
    out.a.omega += e * cot;
    out.b.omega -= e_in_b * cot;
    out.a.theta -= e.cross(&omega_in_a) * cot;
    out.b.theta -= b.omega.cross(&e_in_b) * cot;
}

/// Pulls the cotangent of [`angle`] back, except to the angle at rest.
pub(super) fn pull_angle<S: Scalar>(at: &Acting<S>, cot: S, out: &mut Pulled<S>) {
    let a1 = at.a.motion.rotation * at.a.frame.axes[0];
    let [b1, b2] = [0, 1].map(|i| at.b.motion.rotation * at.b.frame.axes[i]);
    let (x, y) = (a1.dot(&b1), a1.dot(&b2));
    let scale = cot / (x * x + y * y);
    let (by_x, by_y) = (-(y * scale), x * scale);
    pull_axis(&at.a, 0, b1 * by_x + b2 * by_y, &mut out.a);
    pull_axis(&at.b, 0, a1 * by_x, &mut out.b);
    pull_axis(&at.b, 1, a1 * by_y, &mut out.b);
}

/// Pulls back the power of a force along or about the axis of a joint, `law(rate)` = (size, its
/// derivative). Returns the rate and the virtual rate.
pub(super) fn pull_along<S: Scalar>(
    at: &Acting<S>,
    virtually: &Acting<S>,
    dof: DegreeOfFreedom,
    law: impl Fn(S) -> (S, S),
    out: &mut Pulled<S>,
) -> (S, S) {
    match dof {
        DegreeOfFreedom::Rotation => {
            let (rate, virtual_rate) = (turn_rate(at), turn_rate(virtually));
            let (size, by_rate) = law(rate);
            pull_turn(virtually, size, out);
            hold_virtual(out);
            pull_turn(at, by_rate * virtual_rate, out);
            (rate, virtual_rate)
        }
        DegreeOfFreedom::Translation => {
            let rate = constraint::rate(SLIDE, &at.a, &at.b);
            let virtual_rate = constraint::rate(SLIDE, &virtually.a, &virtually.b);
            let (size, by_rate) = law(rate);
            pull_slide(virtually, size, out);
            hold_virtual(out);
            pull_slide(at, by_rate * virtual_rate, out);
            (rate, virtual_rate)
        }
    }
}

pub(super) fn pull_slide<S: Scalar>(at: &Acting<S>, rate: S, out: &mut Pulled<S>) {
    let cot = RowCotangent {
        value: S::zero(),
        rate,
        acceleration: S::zero(),
        virtual_rate: S::zero(),
    };
    pull_row(at, SLIDE, cot, out);
}

/// Pulls the cotangents of a row back.
pub(super) fn pull_row<S: Scalar>(
    at: &Acting<S>,
    row: ConstraintRow,
    cot: RowCotangent<S>,
    out: &mut Pulled<S>,
) {
    let (by_a, by_b) = constraint::pull_back(std::iter::once(row), |_| cot, &at.a, &at.b);
    out.a.add(&by_a);
    out.b.add(&by_b);
}
