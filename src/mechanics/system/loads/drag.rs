//! Quadratic drag on a point of a body and its derivatives.
//!
//! ```text
//! F = −c g u,   g = uᵀu / √(uᵀu + w²),   u = ṙ at the point
//! ```
//!
//! F is −c |u| u but for a part of at most ½ w²/|u|², and has all derivatives at u = 0.

use super::Acting;
use super::pull::{Pulled, hold_virtual, pull_point};
use crate::math::{Scalar, Vec3};

/// Places of coefficient and width among the scalars.
const COEFFICIENT: usize = 0;
const WIDTH: usize = 1;

/// g, its derivative in uᵀu, and that in w.
fn speed<S: Scalar>(u: &Vec3<S>, width: S) -> [S; 3] {
    let square = u.dot(u);
    let root = (square + width * width).sqrt();
    let cube = root * root * root;
    [
        square / root,
        (square * 0.5 + width * width) / cube,
        -(square * width / cube),
    ]
}

/// Force (ground axes) and torque (body axes) on the body.
pub(super) fn force<S: Scalar>(at: &Acting<S>, coefficient: S, width: S) -> (Vec3<S>, Vec3<S>) {
    let u = at.a.point_jet().rate;
    let force = u * -(coefficient * speed(&u, width)[0]);
    let local = at.a.motion.rotation.tr_mul(&force);
    (force, at.a.frame.point.cross(&local))
}

/// Adds the derivatives of ψᵀf; `virtually` has the velocities ψ.
pub(super) fn pull<S: Scalar>(
    at: &Acting<S>,
    virtually: &Acting<S>,
    [coefficient, width]: [S; 2],
    out: &mut Pulled<S>,
) {
    let (u, w) = (at.a.point_jet().rate, virtually.a.point_jet().rate);
    let [g, by_square, by_width] = speed(&u, width);
    let along = u.dot(&w);
    out.scalars[COEFFICIENT] -= g * along;
    out.scalars[WIDTH] -= coefficient * by_width * along;
    pull_point(
        &virtually.a,
        [Vec3::zeros(), u * -(coefficient * g)],
        &mut out.a,
    );
    hold_virtual(out);
    let by_u = (w * g + u * (by_square * along * 2.0)) * -coefficient;
    pull_point(&at.a, [Vec3::zeros(), by_u], &mut out.a);
}
