//! Inertial forces of a flexible body and their derivatives.
//!
//! A point x = Σ_J q_J X_J of the body (q_0 = 1, X_0 = X) has in the axes of the frame the acceleration
//! less gravity
//!
//! ```text
//! γ + Σ_J A_J X_J,     γ = Rᵀ (r̈ − g),     A_J = q_J B + 2 q̇_J ω̃ + q̈_J 1,     B = ω̃ ω̃ + ω̇~
//! ```
//!
//! and the virtual velocity φ + Σ_I Ψ_I X_I with Ψ_I = q_I t̃ + e_I 1 of a virtual motion (φ, t, e) of
//! frame and coordinates (e_0 = 0). The virtual power of the inertial forces is therefore
//!
//! ```text
//! P = m φ·γ + Σ_J φ · A_J p_J + Σ_I γ · Ψ_I p_I + Σ_IJ tr(A_Jᵀ Ψ_I S_IJ)
//! ```
//!
//! from which forces, mass matrix and all derivatives follow: full Coriolis and centrifugal terms. Terms
//! of m and S_00 alone are those of a rigid body; they are in [`crate::system::bodies`] and left out here.

mod kinetic;

pub use kinetic::{Moving, moving, pull_kinetic};

use crate::linalg::Emit;
use crate::math::scalar::skew;
use crate::math::{Mat3, Scalar, Vec3};
use crate::model::flexible::ModalInertia;

/// The motion of a flexible body as its inertial forces depend on it; all in the axes of its frame.
#[derive(Clone, Debug)]
pub struct Flexing<S> {
    /// R, axes of the frame to ground.
    pub rotation: Mat3<S>,
    /// Rᵀ (r̈ − g).
    pub gamma: Vec3<S>,
    /// ω.
    pub omega: Vec3<S>,
    /// ω̇.
    pub alpha: Vec3<S>,
    /// q.
    pub q: Vec<S>,
    /// q̇.
    pub rate: Vec<S>,
    /// q̈.
    pub acceleration: Vec<S>,
}

/// Force (ground axes) and torque (axes of the frame) on the frame, and forces on the coordinates; or a
/// virtual motion, or any cotangent of these.
#[derive(Clone, Debug)]
pub struct Generalised<S> {
    /// Linear part, ground axes.
    pub linear: Vec3<S>,
    /// Angular part, axes of the frame.
    pub angular: Vec3<S>,
    /// Elastic part.
    pub elastic: Vec<S>,
}

/// Cotangents of the motion of a flexible body.
#[derive(Clone, Debug)]
pub struct FlexingCotangent<S> {
    /// By the tangent rotation δθ.
    pub theta: Vec3<S>,
    /// By ω.
    pub omega: Vec3<S>,
    /// By q.
    pub q: Vec<S>,
    /// By q̇.
    pub rate: Vec<S>,
    /// By the gravitational acceleration, ground axes.
    pub gravity: Vec3<S>,
}

/// A square matrix in the order linear, angular, elastic, by rows.
#[derive(Clone, Debug)]
pub struct Block<S> {
    /// Its order, 6 + m.
    pub order: usize,
    /// Its entries.
    pub entries: Vec<S>,
}

impl<S: Scalar> Block<S> {
    pub fn zero(modes: usize) -> Self {
        let order = 6 + modes;
        Self {
            order,
            entries: vec![S::zero(); order * order],
        }
    }

    pub fn add(&mut self, row: usize, column: usize, x: S) {
        self.entries[row * self.order + column] += x;
    }

    /// Emits this block times `scale` at the places `slots` from this row and column on.
    pub fn emit(
        &self,
        slots: &[usize],
        (row, column): (usize, usize),
        scale: S,
        emit: &mut dyn Emit<S>,
    ) {
        let mut entries = self.entries.iter();
        for i in slots {
            for (j, &x) in slots.iter().zip(&mut entries) {
                emit.add(row + i, column + j, x * scale);
            }
        }
    }

    fn add_matrix(&mut self, row: usize, column: usize, x: &Mat3<S>) {
        for i in 0..3 {
            for j in 0..3 {
                self.add(row + i, column + j, x[(i, j)]);
            }
        }
    }

    fn add_column(&mut self, row: usize, column: usize, x: &Vec3<S>) {
        for i in 0..3 {
            self.add(row + i, column, x[i]);
        }
    }

    fn add_row(&mut self, row: usize, column: usize, x: &Vec3<S>) {
        for i in 0..3 {
            self.add(row, column + i, x[i]);
        }
    }
}

/// The vector w with tr(Zᵀ t̃) = t · w for all t.
pub fn axial<S: Scalar>(z: &Mat3<S>) -> Vec3<S> {
    Vec3::new(
        z[(2, 1)] - z[(1, 2)],
        z[(0, 2)] - z[(2, 0)],
        z[(1, 0)] - z[(0, 1)],
    )
}

/// tr(Aᵀ B).
fn inner<S: Scalar>(a: &Mat3<S>, b: &Mat3<S>) -> S {
    a.iter()
        .zip(b.iter())
        .fold(S::zero(), |sum, (&a, &b)| sum + a * b)
}

/// The symmetric part, which alone counts of S_II.
fn symmetric<S: Scalar>(s: &Mat3<S>) -> Mat3<S> {
    (s + s.transpose()) * S::from(0.5)
}

/// Σ_J x_J S_IJᵀ for I = 0 … m, with S_00 left out.
fn moments<S: Scalar>(inertia: &ModalInertia<S>, first: S, x: &[S]) -> Vec<Mat3<S>> {
    let mut out = vec![Mat3::zeros(); x.len() + 1];
    for (j, s) in inertia.with_position.iter().enumerate() {
        out[0] += s.transpose() * x[j];
        out[j + 1] += s * first;
    }
    let mut k = 0;
    for i in 0..x.len() {
        for j in i..x.len() {
            let s = &inertia.products[k];
            if j > i {
                out[i + 1] += s.transpose() * x[j];
                out[j + 1] += s * x[i];
            } else {
                out[i + 1] += symmetric(s) * x[i];
            }
            k += 1;
        }
    }
    out
}

/// Σ_I x_I p_I.
pub fn static_moment<S: Scalar>(inertia: &ModalInertia<S>, first: S, x: &[S]) -> Vec3<S> {
    let all = inertia.static_moments.iter().zip(x);
    all.fold(inertia.centre * first, |sum, (p, &x)| sum + p * x)
}

/// Common terms of the formulas of a motion.
struct Shared<S> {
    spin: Mat3<S>,
    b: Mat3<S>,
    /// Σ q_J S_IJᵀ and Σ q̇_J S_IJᵀ.
    q: Vec<Mat3<S>>,
    rate: Vec<Mat3<S>>,
    /// Σ q_I p_I and Σ q̇_I p_I.
    p: Vec3<S>,
    p_rate: Vec3<S>,
    /// Derivative of P by Ψ_I.
    by_virtual: Vec<Mat3<S>>,
    /// Σ A_J p_J.
    force: Vec3<S>,
}

impl<S: Scalar> Shared<S> {
    fn of(inertia: &ModalInertia<S>, at: &Flexing<S>) -> Self {
        let (one, zero) = (S::one(), S::zero());
        let spin = skew(&at.omega);
        let b = spin * spin + skew(&at.alpha);
        let q = moments(inertia, one, &at.q);
        let rate = moments(inertia, zero, &at.rate);
        let second = moments(inertia, zero, &at.acceleration);
        let p = static_moment(inertia, one, &at.q);
        let p_rate = static_moment(inertia, zero, &at.rate);
        let p_second = static_moment(inertia, zero, &at.acceleration);
        let twice = spin * S::from(2.0);
        let by_virtual = (0..q.len())
            .map(|i| {
                let p = match i {
                    0 => &inertia.centre,
                    _ => &inertia.static_moments[i - 1],
                };
                at.gamma * p.transpose() + b * q[i] + twice * rate[i] + second[i]
            })
            .collect();
        Self {
            force: b * p + twice * p_rate + p_second,
            spin,
            b,
            q,
            rate,
            p,
            p_rate,
            by_virtual,
        }
    }
}

/// x_I with x_0 in front.
fn with_first<S: Scalar>(first: S, x: &[S]) -> impl Iterator<Item = S> + '_ {
    std::iter::once(first).chain(x.iter().copied())
}

/// Inertial forces without those of m and S_00.
pub fn inertial<S: Scalar>(inertia: &ModalInertia<S>, at: &Flexing<S>) -> Generalised<S> {
    let shared = Shared::of(inertia, at);
    let turning = (shared.by_virtual.iter().zip(with_first(S::one(), &at.q)))
        .fold(Mat3::zeros(), |sum, (z, q)| sum + z * q);
    Generalised {
        linear: at.rotation * shared.force,
        angular: axial(&turning),
        elastic: shared.by_virtual[1..].iter().map(|z| z.trace()).collect(),
    }
}

/// The mass matrix without m and S_00.
pub fn mass<S: Scalar>(inertia: &ModalInertia<S>, rotation: &Mat3<S>, q: &[S]) -> Block<S> {
    let mut out = Block::zero(q.len());
    let of_q = moments(inertia, S::one(), q);
    let p = skew(&static_moment(inertia, S::one(), q));
    let coupled = rotation * p;
    out.add_matrix(0, 3, &-coupled);
    out.add_matrix(3, 0, &-coupled.transpose());
    let second =
        (of_q.iter().zip(with_first(S::one(), q))).fold(Mat3::zeros(), |sum, (z, q)| sum + z * q);
    out.add_matrix(3, 3, &(Mat3::identity() * second.trace() - second));
    for (j, p) in inertia.static_moments.iter().enumerate() {
        let (linear, angular) = (rotation * p, axial(&of_q[j + 1].transpose()));
        out.add_column(0, 6 + j, &linear);
        out.add_row(6 + j, 0, &linear);
        out.add_column(3, 6 + j, &angular);
        out.add_row(6 + j, 3, &angular);
    }
    let mut k = 0;
    for i in 0..q.len() {
        for j in i..q.len() {
            let trace = inertia.products[k].trace();
            out.add(6 + i, 6 + j, trace);
            if j > i {
                out.add(6 + j, 6 + i, trace);
            }
            k += 1;
        }
    }
    out
}

/// Derivatives of [`inertial`] in the tangent positions and in the velocities.
pub fn jacobian<S: Scalar>(inertia: &ModalInertia<S>, at: &Flexing<S>) -> (Block<S>, Block<S>) {
    let shared = Shared::of(inertia, at);
    let (mut by_y, mut by_v) = (Block::zero(at.q.len()), Block::zero(at.q.len()));
    let two = S::from(2.0);
    let rotation = &at.rotation;
    by_y.add_matrix(0, 3, &-(rotation * skew(&shared.force)));
    by_y.add_matrix(3, 3, &(skew(&shared.p) * skew(&at.gamma)));
    let sum = |all: &[Mat3<S>]| {
        (all.iter().zip(with_first(S::one(), &at.q))).fold(Mat3::zeros(), |sum, (z, q)| sum + z * q)
    };
    let (second, second_rate) = (sum(&shared.q), sum(&shared.rate));
    for k in 0..3 {
        let mut unit = Vec3::zeros();
        unit[k] = S::one();
        let unit = skew(&unit);
        let b = unit * shared.spin + shared.spin * unit;
        let force = b * shared.p + unit * shared.p_rate * two;
        by_v.add_column(0, 3 + k, &(rotation * force));
        let torque = axial(&(b * second + unit * second_rate * two));
        by_v.add_column(3, 3 + k, &torque);
        for i in 1..shared.q.len() {
            let on = (b * shared.q[i] + unit * shared.rate[i] * two).trace();
            by_v.add(5 + i, 3 + k, on);
        }
    }
    for (j, p) in inertia.static_moments.iter().enumerate() {
        let (b, spin) = (&shared.b, &shared.spin);
        let transposed = shared.q[j + 1].transpose();
        by_y.add_row(6 + j, 3, &p.cross(&at.gamma));
        by_y.add_column(0, 6 + j, &(rotation * (b * p)));
        let torque = axial(&(shared.by_virtual[j + 1] + b * transposed));
        by_y.add_column(3, 6 + j, &torque);
        by_v.add_column(0, 6 + j, &(rotation * (spin * p) * two));
        by_v.add_column(3, 6 + j, &(axial(&(spin * transposed)) * two));
    }
    let mut k = 0;
    for i in 0..at.q.len() {
        for j in i..at.q.len() {
            // tr(B S_IJᵀ) and tr(B S_IJ).
            let s = &inertia.products[k];
            if j > i {
                let transposed = s.transpose();
                by_y.add(6 + i, 6 + j, inner(&shared.b, s));
                by_v.add(6 + i, 6 + j, inner(&shared.spin, s) * two);
                by_y.add(6 + j, 6 + i, inner(&shared.b, &transposed));
                by_v.add(6 + j, 6 + i, inner(&shared.spin, &transposed) * two);
            } else {
                by_y.add(6 + i, 6 + i, inner(&shared.b, &symmetric(s)));
            }
            k += 1;
        }
    }
    (by_y, by_v)
}

/// Pulls the cotangent ψ of [`inertial`] back to the motion, the accelerations held, and to the
/// parameters (added to `cot`).
pub fn pull_back(
    inertia: &ModalInertia<f64>,
    at: &Flexing<f64>,
    psi: &Generalised<f64>,
    cot: &mut ModalInertia<f64>,
) -> FlexingCotangent<f64> {
    let shared = Shared::of(inertia, at);
    let (t, e) = (&psi.angular, &psi.elastic);
    let phi = at.rotation.tr_mul(&psi.linear);
    let turn = skew(t);
    let of_e = moments(inertia, 0.0, e);
    let static_of = |i: usize| match i {
        0 => inertia.centre,
        _ => inertia.static_moments[i - 1],
    };
    let by_a: Vec<Mat3<f64>> = (0..=at.q.len())
        .map(|j| phi * static_of(j).transpose() + turn * shared.q[j] + of_e[j])
        .collect();
    let by_gamma = t.cross(&shared.p) + static_moment(inertia, 0.0, e);
    let mut out = FlexingCotangent {
        theta: by_gamma.cross(&at.gamma) + shared.force.cross(&phi),
        omega: Vec3::zeros(),
        q: Vec::with_capacity(at.q.len()),
        rate: Vec::with_capacity(at.q.len()),
        gravity: -(at.rotation * by_gamma),
    };
    let mut by_b = Mat3::zeros();
    for (z, q) in by_a.iter().zip(with_first(1.0, &at.q)) {
        by_b += z * q;
    }
    out.omega -= axial(&(by_b * shared.spin + shared.spin * by_b));
    for (j, z) in by_a[1..].iter().enumerate() {
        let axis = axial(z);
        out.q
            .push(inner(z, &shared.b) + t.dot(&axial(&shared.by_virtual[j + 1])));
        out.rate.push(2.0 * at.omega.dot(&axis));
        out.omega += axis * (2.0 * at.rate[j]);
    }
    // A_J and Ψ_I, for the parameters.
    let accelerated: Vec<Mat3<f64>> = (0..=at.q.len())
        .map(|j| match j {
            0 => shared.b,
            _ => {
                shared.b * at.q[j - 1]
                    + shared.spin * (2.0 * at.rate[j - 1])
                    + Mat3::identity() * at.acceleration[j - 1]
            }
        })
        .collect();
    let virtually: Vec<Mat3<f64>> = (0..=at.q.len())
        .map(|i| match i {
            0 => turn,
            _ => turn * at.q[i - 1] + Mat3::identity() * e[i - 1],
        })
        .collect();
    let by_static = |i: usize| accelerated[i].tr_mul(&phi) + virtually[i].tr_mul(&at.gamma);
    cot.centre += by_static(0);
    for (j, p) in cot.static_moments.iter_mut().enumerate() {
        *p += by_static(j + 1);
    }
    let both = |i: usize, j: usize| {
        virtually[i].tr_mul(&accelerated[j]) + accelerated[i].tr_mul(&virtually[j])
    };
    for (j, s) in cot.with_position.iter_mut().enumerate() {
        *s += both(0, j + 1);
    }
    let mut k = 0;
    for i in 1..=at.q.len() {
        cot.products[k] += symmetric(&virtually[i].tr_mul(&accelerated[i]));
        k += 1;
        for j in i + 1..=at.q.len() {
            cot.products[k] += both(i, j);
            k += 1;
        }
    }
    out
}
