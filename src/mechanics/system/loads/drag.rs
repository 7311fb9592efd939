//! Quadratic drag on a point of a body, and the lift of a plate there, with their derivatives.
//!
//! ```text
//! F = −g (c u + c_n n (n·u)),   g = uᵀu / √(uᵀu + w²),   u = ṙ at the point, n the normal of the plate
//! ```
//!
//! g is |u| but for a part of at most ½ w²/|u|, and F has all derivatives at u = 0. A plate at the angle α to the flow has the force
//! c_n u² sin α along its normal, so its lift is c_n u² sin α cos α: that of a flat plate at all angles, and of a thin wing with
//! c_n = ½ ρ A ∂C_L/∂α at small ones.

use super::Acting;
use super::pull::{Pulled, hold_virtual, pull_point};
use crate::math::{Scalar, Vec3};
use crate::model::load::Plate;

/// Places of the coefficients and the width among the scalars.
pub(super) const COEFFICIENT: usize = 0;
pub(super) const WIDTH: usize = 1;
pub(super) const PLATE: usize = 2;

/// The coefficient c, the width w and the plate.
pub(super) type Law<'a, S> = (S, S, Option<&'a Plate<S>>);

/// g, its derivative in uᵀu, and that in w.
pub(super) fn speed<S: Scalar>(u: &Vec3<S>, width: S) -> [S; 3] {
    let square = u.dot(u);
    let root = (square + width * width).sqrt();
    let cube = root * root * root;
    [
        square / root,
        (square * 0.5 + width * width) / cube,
        -(square * width / cube),
    ]
}

/// c u + c_n n (n·u), with n in ground axes.
fn resisted<S: Scalar>((coefficient, _, plate): Law<S>, at: &Acting<S>, u: &Vec3<S>) -> Vec3<S> {
    let own = u * coefficient;
    match plate {
        None => own,
        Some(plate) => {
            let normal = at.a.motion.rotation * plate.normal;
            own + normal * (plate.coefficient * normal.dot(u))
        }
    }
}

/// Force (ground axes) and torque (body axes) on the body.
pub(super) fn force<S: Scalar>(law: Law<S>, at: &Acting<S>) -> (Vec3<S>, Vec3<S>) {
    let u = at.a.point_jet().rate;
    let force = match law.2 {
        None => u * -(law.0 * speed(&u, law.1)[0]),
        Some(_) => resisted(law, at, &u) * -speed(&u, law.1)[0],
    };
    let local = at.a.motion.rotation.tr_mul(&force);
    (force, at.a.frame.point.cross(&local))
}

/// Adds the derivatives of ψᵀf; `virtually` has the velocities ψ.
pub(super) fn pull<S: Scalar>(
    law @ (_, width, plate): Law<S>,
    at: &Acting<S>,
    virtually: &Acting<S>,
    out: &mut Pulled<S>,
) {
    let (u, w) = (at.a.point_jet().rate, virtually.a.point_jet().rate);
    let [g, by_square, by_width] = speed(&u, width);
    let (by_u, by_w) = (resisted(law, at, &w), resisted(law, at, &u));
    // P = −g (c u·w + c_n (n·u) (n·w)).
    let product = by_w.dot(&w);
    out.scalars[COEFFICIENT] -= g * u.dot(&w);
    out.scalars[WIDTH] -= by_width * product;
    pull_point(&virtually.a, [Vec3::zeros(), by_w * -g], &mut out.a);
    hold_virtual(out);
    let by_u = -(by_u * g + u * (by_square * product * 2.0));
    pull_point(&at.a, [Vec3::zeros(), by_u], &mut out.a);
    let Some(plate) = plate else {
        return;
    };
    let rotation = &at.a.motion.rotation;
    let normal = rotation * plate.normal;
    let (of_u, of_w) = (normal.dot(&u), normal.dot(&w));
    out.scalars[PLATE] -= g * of_u * of_w;
    let by_normal = (u * of_w + w * of_u) * -(g * plate.coefficient);
    let local = rotation.tr_mul(&by_normal);
    out.a.theta += plate.normal.cross(&local);
    out.direction += local;
}
