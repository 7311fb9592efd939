//! Kinetic energy and momenta of a flexible body, and their derivatives.

use super::{Flexing, FlexingCotangent, axial, inner, moments, static_moment, with_first};
use crate::math::scalar::skew;
use crate::math::{Mat3, Scalar, Vec3};
use crate::model::flexible::ModalInertia;

/// Kinetic energy and momenta without those of m and S_00.
#[derive(Clone, Copy, Debug)]
pub struct Moving<S> {
    /// Kinetic energy \[J\].
    pub kinetic: S,
    /// Linear momentum, axes of the frame \[kg m/s\].
    pub momentum: Vec3<S>,
    /// Angular momentum about the frame's origin, axes of the frame \[kg m²/s\].
    pub spin: Vec3<S>,
}

/// Kinetic energy and momenta at the velocity ν of the frame's origin (axes of the frame).
pub fn moving<S: Scalar>(inertia: &ModalInertia<S>, at: &Flexing<S>, nu: &Vec3<S>) -> Moving<S> {
    let kept = Kept::of(inertia, at);
    let half = S::from(0.5);
    let mut kinetic = nu.dot(&kept.momentum);
    let mut turning = Mat3::zeros();
    for (i, q) in with_first(S::one(), &at.q).enumerate() {
        kinetic += inner(&kept.velocity(at, i), &kept.by_velocity[i]) * half;
        turning += kept.by_velocity[i] * q;
    }
    Moving {
        kinetic,
        momentum: kept.momentum,
        spin: kept.p.cross(nu) + axial(&turning),
    }
}

/// Σ_J V_J S_IJᵀ with V_J = q_J ω̃ + q̇_J 1, and Σ V_J p_J.
struct Kept<S> {
    by_velocity: Vec<Mat3<S>>,
    momentum: Vec3<S>,
    p: Vec3<S>,
    spin: Mat3<S>,
}

impl<S: Scalar> Kept<S> {
    fn of(inertia: &ModalInertia<S>, at: &Flexing<S>) -> Self {
        let spin = skew(&at.omega);
        let q = moments(inertia, S::one(), &at.q);
        let rate = moments(inertia, S::zero(), &at.rate);
        let p = static_moment(inertia, S::one(), &at.q);
        Self {
            by_velocity: q.iter().zip(&rate).map(|(q, r)| spin * q + r).collect(),
            momentum: spin * p + static_moment(inertia, S::zero(), &at.rate),
            p,
            spin,
        }
    }

    fn velocity(&self, at: &Flexing<S>, i: usize) -> Mat3<S> {
        match i {
            0 => self.spin,
            _ => self.spin * at.q[i - 1] + Mat3::identity() * at.rate[i - 1],
        }
    }
}

/// Pulls the kinetic energy of [`moving`], times `scale`, back to the motion, to the velocity of the
/// origin (ground axes, returned) and to the parameters (added to `cot`).
pub fn pull_kinetic(
    inertia: &ModalInertia<f64>,
    at: &Flexing<f64>,
    nu: &Vec3<f64>,
    scale: f64,
    cot: &mut ModalInertia<f64>,
) -> (FlexingCotangent<f64>, Vec3<f64>) {
    let kept = Kept::of(inertia, at);
    let velocity: Vec<Mat3<f64>> = (0..=at.q.len()).map(|i| kept.velocity(at, i)).collect();
    let mut out = FlexingCotangent {
        theta: kept.momentum.cross(nu) * scale,
        omega: Vec3::zeros(),
        q: Vec::with_capacity(at.q.len()),
        rate: Vec::with_capacity(at.q.len()),
        gravity: Vec3::zeros(),
    };
    for (j, q) in with_first(1.0, &at.q).enumerate() {
        let p = match j {
            0 => inertia.centre,
            _ => inertia.static_moments[j - 1],
        };
        let by = (nu * p.transpose() + kept.by_velocity[j]) * scale;
        let axis = axial(&by);
        out.omega += axis * q;
        if j > 0 {
            out.q.push(at.omega.dot(&axis));
            out.rate.push(by.trace());
        }
    }
    cot.centre += velocity[0].tr_mul(nu) * scale;
    for (j, p) in cot.static_moments.iter_mut().enumerate() {
        *p += velocity[j + 1].tr_mul(nu) * scale;
    }
    for (j, s) in cot.with_position.iter_mut().enumerate() {
        *s += velocity[0].tr_mul(&velocity[j + 1]) * scale;
    }
    let mut k = 0;
    for i in 1..=at.q.len() {
        for j in i..=at.q.len() {
            let half = if i == j { 0.5 } else { 1.0 };
            cot.products[k] += velocity[i].tr_mul(&velocity[j]) * (half * scale);
            k += 1;
        }
    }
    (out, at.rotation * kept.momentum * scale)
}
