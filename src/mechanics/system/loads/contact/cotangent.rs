//! What the pull-backs of the surfaces of contacts have in common.

use crate::math::{Scalar, Vec3};
use crate::system::loads::pull::Pulled;
use crate::system::side::JointSide;

/// Places of radii and of the width of the onset among the scalars of a contact.
pub(super) const RADIUS_A: usize = 0;
pub(super) const WIDTH: usize = 3;
pub(super) const RADIUS_B: usize = 6;
pub(super) const WHEEL: usize = 7;

/// Cotangents of penetration, normal and place.
pub(super) struct Cotangent<S> {
    pub penetration: S,
    pub normal: Vec3<S>,
    pub place: Vec3<S>,
}

/// Pulls the cotangent of direction i of body B in ground axes back.
pub(super) fn pull_direction<S: Scalar>(
    side: &JointSide<S>,
    (i, direction): (usize, &Vec3<S>),
    by: Vec3<S>,
    out: &mut Pulled<S>,
) {
    let local = side.motion.rotation.tr_mul(&by);
    out.b.theta += direction.cross(&local);
    out.directions[i] += local;
}
