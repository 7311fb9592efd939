//! Markers: points P = r + R s and directions u = R e that move with a body, with their velocity
//! and acceleration, and how cotangents of these come back to the body.
//!
//! ```text
//! u = R e,   u̇ = R (ω × e),   ü|_{v̇=0} = R (ω × (ω × e))        (P adds r, ṙ, 0)
//! ```

use super::bodies::Motion;
use crate::math::{Scalar, Vec3};

/// Value, velocity and acceleration (at v̇ = 0) of a marker, in ground axes.
#[derive(Clone, Copy, Debug)]
pub struct Jet<S> {
    /// Value.
    pub x: Vec3<S>,
    /// First derivative in time.
    pub rate: Vec3<S>,
    /// Second derivative in time at v̇ = 0.
    pub bias: Vec3<S>,
}

impl<S: Scalar> Jet<S> {
    /// The direction with components `e` in body axes.
    pub fn direction(motion: &Motion<S>, e: &Vec3<S>) -> Self {
        let (r, w) = (&motion.rotation, &motion.omega);
        let turned = w.cross(e);
        Jet {
            x: r * e,
            rate: r * turned,
            bias: r * w.cross(&turned),
        }
    }

    /// The point at `s` from the centre of mass, in body axes.
    pub fn point(motion: &Motion<S>, s: &Vec3<S>) -> Self {
        let mut jet = Self::direction(motion, s);
        jet.x += motion.position;
        jet.rate += motion.velocity;
        jet
    }
}

/// Cotangents that a marker's jet leaves on its body (for a point, those of r and ṙ are the jet's
/// own cotangents of x and rate).
#[derive(Clone, Copy, Debug)]
pub struct MarkerCotangent<S> {
    /// By the tangent rotation δθ, body axes.
    pub theta: Vec3<S>,
    /// By ω.
    pub omega: Vec3<S>,
    /// By the marker's constant vector in body axes.
    pub vector: Vec3<S>,
}

/// Pulls the cotangent of a jet back: the transposed derivative of [`Jet::direction`].
pub fn pull_back<S: Scalar>(motion: &Motion<S>, e: &Vec3<S>, cot: &Jet<S>) -> MarkerCotangent<S> {
    let (r, w) = (&motion.rotation, &motion.omega);
    let (x, rate, bias) = (r.tr_mul(&cot.x), r.tr_mul(&cot.rate), r.tr_mul(&cot.bias));
    let turned = w.cross(e);
    let bias_turned = bias.cross(w);
    MarkerCotangent {
        theta: e.cross(&x) + turned.cross(&rate) + w.cross(&turned).cross(&bias),
        omega: e.cross(&(rate + bias_turned)) + turned.cross(&bias),
        vector: x + (rate + bias_turned).cross(w),
    }
}
