//! Markers: points P = r + R s and directions u = R e that move with a body, with their velocity
//! and acceleration, and the pull-back of their cotangents to the body.
//!
//! ```text
//! u = R e,   u̇ = R (ω × e + ė),   ü = R (α × e + ω × (ω × e) + 2 ω × ė + ë)    (P adds r, ṙ, r̈)
//! ```
//!
//! ė and ë are zero unless the marker moves on its body.

use super::bodies::BodyMotion;
use crate::math::{Scalar, Vec3};
use nalgebra::SVector;

/// Value, velocity, acceleration and virtual velocity of a marker: components along the ground axes,
/// or along D = 2 directions of a plane.
#[derive(Clone, Copy, Debug)]
pub struct MarkerKinematics<S, const D: usize = 3> {
    /// Value.
    pub x: SVector<S, D>,
    /// First derivative in time.
    pub rate: SVector<S, D>,
    /// Second derivative in time, at the accelerations of the motion.
    pub acceleration: SVector<S, D>,
    /// Rate at the virtual velocities of the motion.
    pub virtual_rate: SVector<S, D>,
}

/// Motion of a marker's vector on its body, in the body's axes.
#[derive(Clone, Copy, Debug)]
pub struct RelativeMotion<S> {
    /// ė.
    pub rate: Vec3<S>,
    /// ë.
    pub acceleration: Vec3<S>,
    /// The rate of e that the virtual velocities make.
    pub virtual_rate: Vec3<S>,
}

impl<S: Scalar, const D: usize> MarkerKinematics<S, D> {
    /// A fixed marker at zero.
    pub fn zero() -> Self {
        Self::fixed(SVector::zeros())
    }

    /// A fixed marker.
    pub fn fixed(x: SVector<S, D>) -> Self {
        Self {
            x,
            rate: SVector::zeros(),
            acceleration: SVector::zeros(),
            virtual_rate: SVector::zeros(),
        }
    }

    /// The difference of two markers.
    pub fn minus(&self, other: &Self) -> Self {
        MarkerKinematics {
            x: self.x - other.x,
            rate: self.rate - other.rate,
            acceleration: self.acceleration - other.acceleration,
            virtual_rate: self.virtual_rate - other.virtual_rate,
        }
    }

    /// The marker times a number.
    pub fn scaled(&self, scale: S) -> Self {
        MarkerKinematics {
            x: self.x * scale,
            rate: self.rate * scale,
            acceleration: self.acceleration * scale,
            virtual_rate: self.virtual_rate * scale,
        }
    }

    /// Adds another marker.
    pub fn add(&mut self, other: &Self) {
        self.x += other.x;
        self.rate += other.rate;
        self.acceleration += other.acceleration;
        self.virtual_rate += other.virtual_rate;
    }
}

impl<S: Scalar> MarkerKinematics<S> {
    /// The point at `s` from the centre of mass, in body axes.
    pub fn point(motion: &BodyMotion<S>, s: &Vec3<S>) -> Self {
        Self::moving_point(motion, s, None)
    }

    /// The direction with components `e` in body axes; it may move on the body.
    pub fn moving_direction(
        motion: &BodyMotion<S>,
        e: &Vec3<S>,
        local: Option<&RelativeMotion<S>>,
    ) -> Self {
        let (r, w) = (&motion.rotation, &motion.omega);
        let (rate, acceleration) = derivatives(motion, e, local);
        let virtual_rate = virtual_derivative(motion, e, local);
        MarkerKinematics {
            x: r * e,
            rate: r * rate,
            acceleration: r * (w.cross(&rate) + acceleration),
            virtual_rate: r * virtual_rate,
        }
    }

    /// The point at `s` from the centre of mass in body axes; it may move on the body.
    pub fn moving_point(
        motion: &BodyMotion<S>,
        s: &Vec3<S>,
        local: Option<&RelativeMotion<S>>,
    ) -> Self {
        let mut jet = Self::moving_direction(motion, s, local);
        jet.x += motion.position;
        jet.rate += motion.velocity;
        jet.acceleration += motion.acceleration;
        jet.virtual_rate += motion.virtual_velocity;
        jet
    }
}

/// In body axes: b = ω × e + ė, and α × e + ω × ė + ë; the second derivative is the latter plus ω ×
/// b.
fn derivatives<S: Scalar>(
    motion: &BodyMotion<S>,
    e: &Vec3<S>,
    local: Option<&RelativeMotion<S>>,
) -> (Vec3<S>, Vec3<S>) {
    let (mut rate, mut acceleration) = (motion.omega.cross(e), motion.alpha.cross(e));
    if let Some(local) = local {
        rate += local.rate;
        acceleration += motion.omega.cross(&local.rate) + local.acceleration;
    }
    (rate, acceleration)
}

/// In body axes: the virtual rate ω' × e + ė'.
fn virtual_derivative<S: Scalar>(
    motion: &BodyMotion<S>,
    e: &Vec3<S>,
    local: Option<&RelativeMotion<S>>,
) -> Vec3<S> {
    let turned = motion.virtual_omega.cross(e);
    local.map_or(turned, |local| turned + local.virtual_rate)
}

/// Cotangents of a body from those of a marker. For a point, the cotangents of r, ṙ and r̈ are
/// those of the marker itself.
#[derive(Clone, Copy, Debug)]
pub struct MarkerCotangent<S> {
    /// Of the tangent rotation δθ, body axes.
    pub theta: Vec3<S>,
    /// Of ω.
    pub omega: Vec3<S>,
    /// Of the angular acceleration α.
    pub alpha: Vec3<S>,
    /// Of the marker's vector in body axes.
    pub vector: Vec3<S>,
    /// Of the motion of that vector on the body.
    pub local: RelativeMotion<S>,
}

/// Pulls the cotangent of a marker back: the transposed derivative of
/// [`MarkerKinematics::moving_direction`] at constant virtual velocities.
pub fn pull_back<S: Scalar>(
    motion: &BodyMotion<S>,
    e: &Vec3<S>,
    cot: &MarkerKinematics<S>,
) -> MarkerCotangent<S> {
    pull_back_moving(motion, e, None, cot)
}

/// As [`pull_back`], for a marker that moves on its body.
pub fn pull_back_moving<S: Scalar>(
    motion: &BodyMotion<S>,
    e: &Vec3<S>,
    local: Option<&RelativeMotion<S>>,
    cot: &MarkerKinematics<S>,
) -> MarkerCotangent<S> {
    let (r, w) = (&motion.rotation, &motion.omega);
    let (x, rate) = (r.tr_mul(&cot.x), r.tr_mul(&cot.rate));
    let second = r.tr_mul(&cot.acceleration);
    let virtually = r.tr_mul(&cot.virtual_rate);
    let (first, rest) = derivatives(motion, e, local);
    let by_first = rate + second.cross(w);
    let mut omega = e.cross(&by_first) + first.cross(&second);
    if let Some(local) = local {
        omega += local.rate.cross(&second);
    }
    MarkerCotangent {
        theta: e.cross(&x)
            + first.cross(&rate)
            + (w.cross(&first) + rest).cross(&second)
            + virtual_derivative(motion, e, local).cross(&virtually),
        omega,
        alpha: e.cross(&second),
        vector: x
            + by_first.cross(w)
            + second.cross(&motion.alpha)
            + virtually.cross(&motion.virtual_omega),
        local: RelativeMotion {
            rate: by_first + second.cross(w),
            acceleration: second,
            virtual_rate: virtually,
        },
    }
}
