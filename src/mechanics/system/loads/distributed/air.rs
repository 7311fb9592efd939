//! The force of air at rest on a surface that moves through it.
//!
//! With the area vector A of a piece of surface, its velocity u and g = uᵀu / √(uᵀu + w²) of [`drag`](super::super::drag):
//!
//! ```text
//! F = −g (c |A| u + c_n A (A·u) / |A|)
//! ```

use crate::math::scalar::length;
use crate::math::{Scalar, Vec3};
use crate::model::distributed::Air;
use crate::system::loads::drag::speed;

/// Derivatives of the power F·w of a piece of surface.
pub(super) struct Pulled<S> {
    /// In A.
    pub area: Vec3<S>,
    /// In u.
    pub velocity: Vec3<S>,
    /// In c, c_n and w.
    pub air: [S; 3],
}

/// F.
pub(super) fn force<S: Scalar>(air: &Air<S>, area: &Vec3<S>, u: &Vec3<S>) -> Vec3<S> {
    let size = length(area);
    let along = u * (air.coefficient * size);
    let across = area * (air.normal_coefficient * area.dot(u) / size);
    (along + across) * -speed(u, air.width)[0]
}

/// The derivatives of F·w at a given w.
pub(super) fn pull<S: Scalar>(
    air: &Air<S>,
    (area, u): (&Vec3<S>, &Vec3<S>),
    w: &Vec3<S>,
) -> Pulled<S> {
    let [g, by_square, by_width] = speed(u, air.width);
    let size = length(area);
    let (c, n) = (air.coefficient, air.normal_coefficient);
    let (along, of_u, of_w) = (u.dot(w), area.dot(u), area.dot(w));
    let across = of_u * of_w / size;
    // P = −g (c |A| u·w + c_n (A·u) (A·w) / |A|).
    let bracket = c * size * along + n * across;
    let by_area =
        area * ((c * along - n * across / size) / size) + (u * of_w + w * of_u) * (n / size);
    let by_velocity = w * (c * size) + area * (n * of_w / size);
    Pulled {
        area: by_area * -g,
        velocity: by_velocity * -g - u * (bracket * by_square * 2.0),
        air: [-(g * size * along), -(g * across), -(bracket * by_width)],
    }
}
