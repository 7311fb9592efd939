//! Shape functions of the beam, and the axes of its section.

use super::BEAM_NODES;
use crate::math::{Scalar, Vec3, scalar::length};

/// Shape functions at r and their slopes.
pub(super) fn shape(r: f64) -> ([f64; BEAM_NODES], [f64; BEAM_NODES]) {
    let n = [0.5 * r * (r - 1.0), 1.0 - r * r, 0.5 * r * (r + 1.0)];
    (n, [r - 0.5, -2.0 * r, r + 0.5])
}

/// The two points and weights at which strains are taken.
pub(super) fn strain_points() -> [(f64, f64); 2] {
    let p = 1.0 / 3.0_f64.sqrt();
    [(-p, 1.0), (p, 1.0)]
}

/// Three Gauss points and weights, for masses and loads.
pub(super) fn mass_points() -> [(f64, f64); 3] {
    let c = 0.6_f64.sqrt();
    [(-c, 5.0 / 9.0), (0.0, 8.0 / 9.0), (c, 5.0 / 9.0)]
}

/// Σ_a w_a v_a.
pub(super) fn sum<S: Scalar>(
    weights: &[f64; BEAM_NODES],
    vectors: &[Vec3<S>; BEAM_NODES],
) -> Vec3<S> {
    let mut total = Vec3::zeros();
    for (v, &w) in vectors.iter().zip(weights) {
        total += v * S::from(w);
    }
    total
}

/// Transpose of [`sum`].
pub(super) fn add_sum_transpose<S: Scalar>(
    weights: &[f64; BEAM_NODES],
    total: &Vec3<S>,
    vectors: &mut [Vec3<S>; BEAM_NODES],
) {
    for (v, &w) in vectors.iter_mut().zip(weights) {
        *v += total * S::from(w);
    }
}

/// The axes at a point: t along the beam, e3 along t × v, e2 = e3 × t, so that the orientation v lies in
/// the plane of t and e2; and the speed |x,r| \[m\]. Or their cotangents.
#[derive(Clone, Copy, Debug)]
pub(super) struct Axes<S> {
    pub t: Vec3<S>,
    pub e2: Vec3<S>,
    pub e3: Vec3<S>,
    pub speed: S,
}

impl<S: Scalar> Axes<S> {
    pub fn zeros() -> Self {
        Self {
            t: Vec3::zeros(),
            e2: Vec3::zeros(),
            e3: Vec3::zeros(),
            speed: S::zero(),
        }
    }

    /// The axes of a tangent x,r and an orientation v.
    pub fn of(tangent: &Vec3<S>, orientation: &Vec3<S>) -> Self {
        let speed = length(tangent);
        let t = tangent / speed;
        let across = t.cross(orientation);
        let e3 = across / length(&across);
        Self {
            t,
            e2: e3.cross(&t),
            e3,
            speed,
        }
    }

    /// Transpose of the derivative of [`Axes::of`].
    pub fn add_of_transpose(
        &self,
        bar: &Self,
        orientation: &Vec3<S>,
        tangent_to: &mut Vec3<S>,
        orientation_to: &mut Vec3<S>,
    ) {
        let e3_bar = bar.e3 + self.t.cross(&bar.e2);
        let mut t_bar = bar.t + bar.e2.cross(&self.e3);
        let across = length(&self.t.cross(orientation));
        let across_bar = (e3_bar - self.e3 * self.e3.dot(&e3_bar)) / across;
        t_bar += orientation.cross(&across_bar);
        *orientation_to += across_bar.cross(&self.t);
        *tangent_to += (t_bar - self.t * self.t.dot(&t_bar)) / self.speed + self.t * bar.speed;
    }
}
