//! Blocks of bodies and rows in the unknowns of the bodies, and their factors.

use super::SMALL;
use crate::math::Scalar;
use crate::model::{Mobility, RigidBody};
use crate::system::constraint::RowGradient;
use crate::system::numbering::Numbering;

/// Factors of one link in blocks of up to order N.
#[derive(Clone)]
pub(super) struct Factors<S, const N: usize> {
    /// Articulated inertia, then its Cholesky factor L D Lᵀ (D inverted on the diagonal).
    pub inertia: [[S; N]; N],
    /// G_jb M̂⁻¹, row by row.
    pub lever: [[S; N]; N],
    /// G_jp, row by row.
    pub above: [[S; N]; N],
    /// L D Lᵀ of S.
    pub schur: [[S; N]; N],
}

/// Order of the block of a body; a constant if all have up to three unknowns.
pub(super) fn size<const N: usize>(numbering: &Numbering, body: usize) -> usize {
    match N {
        SMALL => SMALL,
        _ => numbering.unknowns_of(body),
    }
}

/// Number of unknowns of a body; a constant if all have N.
pub(super) fn unknowns<const N: usize, const FULL: bool>(
    numbering: &Numbering,
    body: usize,
) -> usize {
    match FULL {
        true => N,
        false => numbering.unknowns_of(body),
    }
}

/// Bᵀ M B of a body. It is extended by the unit matrix to order three, so that it can be decomposed
/// in that order.
pub(super) fn inertia<S: Scalar, const N: usize>(
    body: &RigidBody<S>,
    mobility: &Mobility,
) -> [[S; N]; N] {
    let mut out = [[S::zero(); N]; N];
    let Mobility {
        translation,
        rotation,
    } = mobility;
    let linear = translation.free();
    for i in 0..linear {
        out[i][i] = body.mass;
    }
    for i in 0..rotation.free() {
        for k in 0..rotation.free() {
            out[linear + i][linear + k] = rotation.quadratic(&body.inertia, i, k);
        }
    }
    for i in mobility.unknowns()..SMALL {
        out[i][i] = S::one();
    }
    out
}

/// A row of G B on side A or B of its joint.
#[inline]
pub(super) fn reduced<S: Scalar, const N: usize>(
    g: &RowGradient<S>,
    side_a: bool,
    mobility: &Mobility,
) -> [S; N] {
    let (f, t) = match side_a {
        true => (g.force, &g.torque_a),
        false => (-g.force, &g.torque_b),
    };
    let mut out = [S::zero(); N];
    mobility.reduce(&f, t, &mut out);
    out
}
