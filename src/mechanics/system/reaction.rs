//! Derivatives of the reactions Gᵀλ of the rows in the positions, for the iteration matrices of
//! implicit methods. Test: `reaction_jacobians` in tests/dynamics/constraint_derivatives.rs.

use super::side::JointSide;
use crate::math::scalar::skew;
use crate::math::{Mat3, Scalar, Vec3};
use crate::model::{ConstraintRow, JointFrame};
use ConstraintRow::{Aligned, Coincident, Distance, Perpendicular, Sliding};

/// Derivative of Gᵀλ of one row in the tangent positions (δr_A, δθ_A, δr_B, δθ_B); components in
/// the same order, 3 × 3 blocks. Blocks that vanish for every row are omitted. The components of
/// r_B are the negatives of those of r_A.
#[derive(Clone, Copy, Debug)]
pub struct ReactionJacobian<S> {
    /// (r_A, r_A); (r_A, r_B) is its negative.
    pub force_by_position: Mat3<S>,
    /// (r_A, θ_A).
    pub force_by_a: Mat3<S>,
    /// (r_A, θ_B).
    pub force_by_b: Mat3<S>,
    /// (θ_A, r_A); (θ_A, r_B) is its negative.
    pub a_by_position: Mat3<S>,
    /// (θ_B, r_A); (θ_B, r_B) is its negative.
    pub b_by_position: Mat3<S>,
    /// (θ_A, θ_A).
    pub a_by_a: Mat3<S>,
    /// (θ_A, θ_B).
    pub a_by_b: Mat3<S>,
    /// (θ_B, θ_A).
    pub b_by_a: Mat3<S>,
    /// (θ_B, θ_B).
    pub b_by_b: Mat3<S>,
}

impl<S: Scalar> ReactionJacobian<S> {
    /// All blocks zero.
    pub fn zero() -> Self {
        let zero = Mat3::zeros();
        Self {
            force_by_position: zero,
            force_by_a: zero,
            force_by_b: zero,
            a_by_position: zero,
            b_by_position: zero,
            a_by_a: zero,
            a_by_b: zero,
            b_by_a: zero,
            b_by_b: zero,
        }
    }
}

/// Adds the derivative of λ (row of G)ᵀ to `out`.
pub fn add_reaction_jacobian<S: Scalar>(
    row: ConstraintRow,
    lambda: S,
    a: &JointSide<S>,
    b: &JointSide<S>,
    out: &mut ReactionJacobian<S>,
) {
    let (ra, rb) = (&a.motion.rotation, &b.motion.rotation);
    let (sa, sb) = (skew(&a.frame.point), skew(&b.frame.point));
    match row {
        Coincident(k) => {
            let (fa, fb) = (ra.row(k).transpose(), rb.row(k).transpose());
            out.a_by_a += sa * skew(&fa) * lambda;
            out.b_by_b -= sb * skew(&fb) * lambda;
        }
        Perpendicular { a: i, b: j } => {
            let (ea, eb) = (skew(&a.frame.axes[i]), skew(&b.frame.axes[j]));
            let mixed = ea * ra.tr_mul(rb) * eb * lambda;
            out.a_by_a += ea * skew(&ra.tr_mul(&b.axis(j))) * lambda;
            out.b_by_b += eb * skew(&rb.tr_mul(&a.axis(i))) * lambda;
            out.a_by_b -= mixed;
            out.b_by_a -= mixed.transpose();
        }
        Sliding { a: i } => {
            let e = skew(&a.frame.axes[i]);
            let u = a.axis(i);
            let d = a.point() - b.point();
            let mixed = e * ra.tr_mul(rb) * sb * lambda;
            out.force_by_a -= ra * e * lambda;
            out.a_by_position += e * ra.transpose() * lambda;
            out.a_by_a += e * (skew(&ra.tr_mul(&d)) - sa) * lambda;
            out.a_by_b += mixed;
            out.b_by_a += mixed.transpose();
            out.b_by_b -= sb * skew(&rb.tr_mul(&u)) * lambda;
        }
        Distance => {
            let d = a.point() - b.point();
            let l = lambda / a.frame.length;
            let mixed = sa * ra.tr_mul(rb) * sb * l;
            out.force_by_position += Mat3::identity() * l;
            out.force_by_a -= ra * sa * l;
            out.force_by_b += rb * sb * l;
            out.a_by_position += sa * ra.transpose() * l;
            out.b_by_position -= sb * rb.transpose() * l;
            out.a_by_a += sa * (skew(&ra.tr_mul(&d)) - sa) * l;
            out.a_by_b += mixed;
            out.b_by_a += mixed.transpose();
            out.b_by_b -= sb * (skew(&rb.tr_mul(&d)) + sb) * l;
        }
        Aligned { a: i, b: j } => {
            let half = lambda * 0.5;
            add_reaction_jacobian(Perpendicular { a: i, b: j }, half, a, b, out);
            add_reaction_jacobian(Perpendicular { a: j, b: i }, -half, a, b, out);
        }
    }
}

/// How the torques of Gᵀλ of an attachment turn with the deformation of its section.
#[derive(Clone, Copy, Debug)]
pub struct ElasticReaction<S> {
    /// Force on the section, axes of body A: a displacement n adds the torque n × f on body A.
    pub force: Vec3<S>,
    /// Torque on body A by the rotation of the section.
    pub a_by_rotation: Mat3<S>,
    /// Torque on body B likewise.
    pub b_by_rotation: Mat3<S>,
}

impl<S: Scalar> ElasticReaction<S> {
    /// All zero.
    pub fn zero() -> Self {
        Self {
            force: Vec3::zeros(),
            a_by_rotation: Mat3::zeros(),
            b_by_rotation: Mat3::zeros(),
        }
    }
}

/// Adds those of λ (row of G)ᵀ to `out`, the frame on the undeformed body A being `undeformed`.
pub fn add_elastic_reaction<S: Scalar>(
    row: ConstraintRow,
    lambda: S,
    (a, undeformed): (&JointSide<S>, &JointFrame<S>),
    b: &JointSide<S>,
    out: &mut ElasticReaction<S>,
) {
    let (ra, rb) = (&a.motion.rotation, &b.motion.rotation);
    match row {
        Coincident(k) => out.force += ra.row(k).transpose() * lambda,
        Perpendicular { a: i, b: j } => {
            let e = skew(&undeformed.axes[i]);
            let w = skew(&ra.tr_mul(&b.axis(j)));
            out.a_by_rotation += w * e * lambda;
            out.b_by_rotation -= skew(&b.frame.axes[j]) * rb.tr_mul(ra) * e * lambda;
        }
        Aligned { a: i, b: j } => {
            let half = lambda * 0.5;
            let at = (a, undeformed);
            add_elastic_reaction(Perpendicular { a: i, b: j }, half, at, b, out);
            add_elastic_reaction(Perpendicular { a: j, b: i }, -half, at, b, out);
        }
        // No attachment has such a row.
        Sliding { .. } | Distance => {}
    }
}
