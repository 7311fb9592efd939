//! Markers: points P = r + R s and directions u = R e that move with a body, with their velocity
//! and acceleration, and how cotangents of these come back to the body.
//!
//! ```text
//! u = R e,   u̇ = R (ω × e),   ü = R (α × e + ω × (ω × e))        (P adds r, ṙ, r̈)
//! ```

use super::bodies::Motion;
use crate::math::{Scalar, Vec3};

/// Value, velocity, acceleration and virtual velocity of a marker, in ground axes.
#[derive(Clone, Copy, Debug)]
pub struct Jet<S> {
    /// Value.
    pub x: Vec3<S>,
    /// First derivative in time.
    pub rate: Vec3<S>,
    /// Second derivative in time, at the accelerations of the motion.
    pub acceleration: Vec3<S>,
    /// Rate that the virtual velocities of the motion make.
    pub virtual_rate: Vec3<S>,
}

impl<S: Scalar> Jet<S> {
    /// A jet that does not move from zero.
    pub fn zero() -> Self {
        Self::fixed(Vec3::zeros())
    }

    /// A jet that does not move.
    pub fn fixed(x: Vec3<S>) -> Self {
        Self {
            x,
            rate: Vec3::zeros(),
            acceleration: Vec3::zeros(),
            virtual_rate: Vec3::zeros(),
        }
    }

    /// The direction with components `e` in body axes.
    pub fn direction(motion: &Motion<S>, e: &Vec3<S>) -> Self {
        let (r, w) = (&motion.rotation, &motion.omega);
        let turned = w.cross(e);
        Jet {
            x: r * e,
            rate: r * turned,
            acceleration: r * (w.cross(&turned) + motion.alpha.cross(e)),
            virtual_rate: r * motion.virtual_omega.cross(e),
        }
    }

    /// The point at `s` from the centre of mass, in body axes.
    pub fn point(motion: &Motion<S>, s: &Vec3<S>) -> Self {
        let mut jet = Self::direction(motion, s);
        jet.x += motion.position;
        jet.rate += motion.velocity;
        jet.acceleration += motion.acceleration;
        jet.virtual_rate += motion.virtual_velocity;
        jet
    }

    /// The difference of two jets.
    pub fn minus(&self, other: &Self) -> Self {
        Jet {
            x: self.x - other.x,
            rate: self.rate - other.rate,
            acceleration: self.acceleration - other.acceleration,
            virtual_rate: self.virtual_rate - other.virtual_rate,
        }
    }

    /// Adds another jet.
    pub fn add(&mut self, other: &Self) {
        self.x += other.x;
        self.rate += other.rate;
        self.acceleration += other.acceleration;
        self.virtual_rate += other.virtual_rate;
    }
}

/// Cotangents that a marker's jet leaves on its body (for a point, those of r, ṙ and r̈ are the
/// jet's own cotangents).
#[derive(Clone, Copy, Debug)]
pub struct MarkerCotangent<S> {
    /// By the tangent rotation δθ, body axes.
    pub theta: Vec3<S>,
    /// By ω.
    pub omega: Vec3<S>,
    /// By the angular acceleration α.
    pub alpha: Vec3<S>,
    /// By the marker's constant vector in body axes.
    pub vector: Vec3<S>,
}

/// Pulls the cotangent of a jet back: the transposed derivative of [`Jet::direction`], the virtual
/// velocities held.
pub fn pull_back<S: Scalar>(motion: &Motion<S>, e: &Vec3<S>, cot: &Jet<S>) -> MarkerCotangent<S> {
    let (r, w) = (&motion.rotation, &motion.omega);
    let (x, rate) = (r.tr_mul(&cot.x), r.tr_mul(&cot.rate));
    let second = r.tr_mul(&cot.acceleration);
    let virtually = r.tr_mul(&cot.virtual_rate);
    let turned = w.cross(e);
    let by_turned = rate + second.cross(w);
    MarkerCotangent {
        theta: e.cross(&x)
            + turned.cross(&rate)
            + (w.cross(&turned) + motion.alpha.cross(e)).cross(&second)
            + motion.virtual_omega.cross(e).cross(&virtually),
        omega: e.cross(&by_turned) + turned.cross(&second),
        alpha: e.cross(&second),
        vector: x
            + by_turned.cross(w)
            + second.cross(&motion.alpha)
            + virtually.cross(&motion.virtual_omega),
    }
}
