//! Contributions of the bodies to the iteration matrices of implicit methods.

use super::bodies::{angular_velocity_by_theta, positions_of, torque_by_omega};
use super::in_motion::InMotion;
use crate::linalg::Emit;
use crate::math::{Mat3, Scalar};

/// Derivatives of the rates in the unknowns of a step of size h: ∂q̇/∂q = ∂v̇/∂v = c.
#[derive(Clone, Copy, Debug)]
pub struct Rates<S> {
    /// c \[1/s\].
    pub by_state: S,
    /// h \[s\].
    pub h: S,
}

/// Emits the derivatives of P(q) q̇ − v, times h, in tangent positions and velocities (these
/// columns divided by h), at row `row` and columns `y` and `v`.
pub fn emit_kinematics<S: Scalar>(
    at: &InMotion<S>,
    qdot: &[S],
    (row, y, v): (usize, usize, usize),
    rates: Rates<S>,
    emit: &mut dyn Emit<S>,
) {
    let Rates { by_state: c, h } = rates;
    let identity = Mat3::<S>::identity();
    for (i, motion) in at.motions.iter().enumerate() {
        let o = at.numbering.velocity(i);
        let (_, pdot) = positions_of(&qdot[at.numbering.position(i)..]);
        let turned = angular_velocity_by_theta(&motion.orientation, &pdot);
        emit.add_identity(row + o, y + o, c * h);
        emit.add_block(row + o + 3, y + o + 3, &(identity * (c * h) + turned * h));
        emit.add_identity(row + o, v + o, -S::one());
        emit.add_identity(row + o + 3, v + o + 3, -S::one());
    }
}

/// Emits the derivatives of M v̇ − f(q, v), times h², in velocities (columns divided by h) at
/// (`row`, `v`). M and the forces of rigid bodies under gravity do not depend on q.
pub fn emit_force_balance<S: Scalar>(
    at: &InMotion<S>,
    (row, v): (usize, usize),
    rates: Rates<S>,
    emit: &mut dyn Emit<S>,
) {
    let Rates { by_state: c, h } = rates;
    for (i, (body, motion)) in at.model.bodies.iter().zip(at.motions).enumerate() {
        let o = at.numbering.velocity(i);
        let torque = torque_by_omega(body, &motion.omega);
        emit.add_identity(row + o, v + o, body.mass * c * h);
        emit.add_block(
            row + o + 3,
            v + o + 3,
            &(body.inertia * (c * h) + torque * h),
        );
    }
}
