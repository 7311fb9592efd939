//! The three constraint rows: value, rate, acceleration bias, Jacobian and pull-back of each.
//!
//! A row is a bilinear function of markers (see [`super::marker`]): with d = P_A − P_B the
//! distance of two points and u, w axes of the two frames (see [`crate::model::joint`]),
//!
//! ```text
//!                  value Φ     rate G v             bias: Φ̈ = G v̇ + bias
//! Coincident k     d_k         ḋ_k                  d̈_k
//! Perpendicular    u · w       u̇ · w + u · ẇ        ü · w + 2 u̇ · ẇ + u · ẅ
//! Sliding          u · d       u̇ · d + u · ḋ        ü · d + 2 u̇ · ḋ + u · d̈
//! ```
//!
//! The acceleration term of the index-1 equations is γ = −bias.

use super::bodies::Motion;
use super::marker::{self, Jet};
use crate::math::scalar::skew;
use crate::math::{Mat3, Scalar, Vec3};
use crate::model::{ConstraintRow, JointFrame};
use ConstraintRow::{Coincident, Perpendicular, Sliding};

/// One side of a joint: the body's motion and the joint's frame on it.
#[derive(Clone, Copy, Debug)]
pub struct Side<'a, S> {
    /// Motion of the body (ground at rest if there is none).
    pub motion: &'a Motion<S>,
    /// The joint's frame on the body.
    pub frame: &'a JointFrame<S>,
}

impl<S: Scalar> Side<'_, S> {
    fn axis(&self, i: usize) -> Vec3<S> {
        self.motion.rotation * self.frame.axes[i]
    }

    fn point(&self) -> Vec3<S> {
        self.motion.position + self.motion.rotation * self.frame.point
    }

    fn axis_jet(&self, i: usize) -> Jet<S> {
        Jet::direction(self.motion, &self.frame.axes[i])
    }

    fn point_jet(&self) -> Jet<S> {
        Jet::point(self.motion, &self.frame.point)
    }
}

fn difference<S: Scalar>(a: Jet<S>, b: Jet<S>) -> Jet<S> {
    Jet {
        x: a.x - b.x,
        rate: a.rate - b.rate,
        bias: a.bias - b.bias,
    }
}

/// The vectors u, w (or d) whose product a bilinear row is, as jets.
fn factors<S: Scalar>(row: ConstraintRow, a: &Side<S>, b: &Side<S>) -> (Jet<S>, Jet<S>) {
    match row {
        Coincident(k) => {
            let mut unit = Vec3::zeros();
            unit[k] = S::one();
            let fixed = Jet {
                x: unit,
                rate: Vec3::zeros(),
                bias: Vec3::zeros(),
            };
            (fixed, difference(a.point_jet(), b.point_jet()))
        }
        Perpendicular { a: i, b: j } => (a.axis_jet(i), b.axis_jet(j)),
        Sliding { a: i } => (a.axis_jet(i), difference(a.point_jet(), b.point_jet())),
    }
}

/// Value Φ of a row.
pub fn value<S: Scalar>(row: ConstraintRow, a: &Side<S>, b: &Side<S>) -> S {
    match row {
        Coincident(k) => a.point()[k] - b.point()[k],
        Perpendicular { a: i, b: j } => a.axis(i).dot(&b.axis(j)),
        Sliding { a: i } => a.axis(i).dot(&(a.point() - b.point())),
    }
}

/// Rate G v of a row.
pub fn rate<S: Scalar>(row: ConstraintRow, a: &Side<S>, b: &Side<S>) -> S {
    let (u, w) = factors(row, a, b);
    u.rate.dot(&w.x) + u.x.dot(&w.rate)
}

/// Acceleration bias of a row: its second time derivative at v̇ = 0.
pub fn bias<S: Scalar>(row: ConstraintRow, a: &Side<S>, b: &Side<S>) -> S {
    let (u, w) = factors(row, a, b);
    u.bias.dot(&w.x) + u.rate.dot(&w.rate) * 2.0 + u.x.dot(&w.bias)
}

/// One row of G: derivative of the rate in the velocities of both bodies.
#[derive(Clone, Copy, Debug)]
pub struct RowGradient<S> {
    /// By ṙ_A; that by ṙ_B is its negative, since no row changes when both bodies move together.
    pub force: Vec3<S>,
    /// By ω_A (body axes of A).
    pub torque_a: Vec3<S>,
    /// By ω_B (body axes of B).
    pub torque_b: Vec3<S>,
}

/// Gradient of a row.
pub fn gradient<S: Scalar>(row: ConstraintRow, a: &Side<S>, b: &Side<S>) -> RowGradient<S> {
    let (ra, rb) = (&a.motion.rotation, &b.motion.rotation);
    let (sa, sb) = (&a.frame.point, &b.frame.point);
    match row {
        Coincident(k) => {
            let mut force = Vec3::zeros();
            force[k] = S::one();
            RowGradient {
                force,
                torque_a: sa.cross(&ra.row(k).transpose()),
                torque_b: -sb.cross(&rb.row(k).transpose()),
            }
        }
        Perpendicular { a: i, b: j } => RowGradient {
            force: Vec3::zeros(),
            torque_a: a.frame.axes[i].cross(&ra.tr_mul(&b.axis(j))),
            torque_b: b.frame.axes[j].cross(&rb.tr_mul(&a.axis(i))),
        },
        Sliding { a: i } => {
            let (e, u) = (&a.frame.axes[i], a.axis(i));
            let d = a.point() - b.point();
            RowGradient {
                force: u,
                torque_a: e.cross(&ra.tr_mul(&d)) + sa.cross(e),
                torque_b: -sb.cross(&rb.tr_mul(&u)),
            }
        }
    }
}

/// Derivative of Gᵀλ of one row in the tangent positions (δr_A, δθ_A, δr_B, δθ_B), rows ordered
/// likewise; 3 × 3 blocks. Blocks that vanish for every row are left out, and the rows of r_B are
/// the negatives of those of r_A.
#[derive(Clone, Copy, Debug)]
pub struct ReactionJacobian<S> {
    /// (r_A, θ_A).
    pub force_by_a: Mat3<S>,
    /// (θ_A, r_A); (θ_A, r_B) is its negative.
    pub a_by_position: Mat3<S>,
    /// (θ_A, θ_A).
    pub a_by_a: Mat3<S>,
    /// (θ_A, θ_B).
    pub a_by_b: Mat3<S>,
    /// (θ_B, θ_A).
    pub b_by_a: Mat3<S>,
    /// (θ_B, θ_B).
    pub b_by_b: Mat3<S>,
}

impl<S: Scalar> ReactionJacobian<S> {
    /// All blocks zero.
    pub fn zero() -> Self {
        let zero = Mat3::zeros();
        Self {
            force_by_a: zero,
            a_by_position: zero,
            a_by_a: zero,
            a_by_b: zero,
            b_by_a: zero,
            b_by_b: zero,
        }
    }
}

/// Adds the derivative of λ (row of G)ᵀ to `out`.
pub fn add_reaction_jacobian<S: Scalar>(
    row: ConstraintRow,
    lambda: S,
    a: &Side<S>,
    b: &Side<S>,
    out: &mut ReactionJacobian<S>,
) {
    let (ra, rb) = (&a.motion.rotation, &b.motion.rotation);
    let (sa, sb) = (skew(&a.frame.point), skew(&b.frame.point));
    match row {
        Coincident(k) => {
            let (fa, fb) = (ra.row(k).transpose(), rb.row(k).transpose());
            out.a_by_a += sa * skew(&fa) * lambda;
            out.b_by_b -= sb * skew(&fb) * lambda;
        }
        Perpendicular { a: i, b: j } => {
            let (ea, eb) = (skew(&a.frame.axes[i]), skew(&b.frame.axes[j]));
            let mixed = ea * ra.tr_mul(rb) * eb * lambda;
            out.a_by_a += ea * skew(&ra.tr_mul(&b.axis(j))) * lambda;
            out.b_by_b += eb * skew(&rb.tr_mul(&a.axis(i))) * lambda;
            out.a_by_b -= mixed;
            out.b_by_a -= mixed.transpose();
        }
        Sliding { a: i } => {
            let e = skew(&a.frame.axes[i]);
            let u = a.axis(i);
            let d = a.point() - b.point();
            let mixed = e * ra.tr_mul(rb) * sb * lambda;
            out.force_by_a -= ra * e * lambda;
            out.a_by_position += e * ra.transpose() * lambda;
            out.a_by_a += e * (skew(&ra.tr_mul(&d)) - sa) * lambda;
            out.a_by_b += mixed;
            out.b_by_a += mixed.transpose();
            out.b_by_b -= sb * skew(&rb.tr_mul(&u)) * lambda;
        }
    }
}

/// Cotangents of one side of a joint.
#[derive(Clone, Copy, Debug)]
pub struct SideCotangent<S> {
    /// By the tangent position: δr (ground axes).
    pub position: Vec3<S>,
    /// By the tangent position: δθ (body axes).
    pub theta: Vec3<S>,
    /// By ṙ.
    pub velocity: Vec3<S>,
    /// By ω.
    pub omega: Vec3<S>,
    /// By the frame's point and axes.
    pub frame: JointFrame<S>,
}

impl<S: Scalar> SideCotangent<S> {
    /// All cotangents zero.
    pub fn zero() -> Self {
        let zero = Vec3::zeros();
        Self {
            position: zero,
            theta: zero,
            velocity: zero,
            omega: zero,
            frame: JointFrame::zero(),
        }
    }
}

fn pull_axis<S: Scalar>(side: &Side<S>, i: usize, cot: &Jet<S>, out: &mut SideCotangent<S>) {
    let by = marker::pull_back(side.motion, &side.frame.axes[i], cot);
    out.theta += by.theta;
    out.omega += by.omega;
    out.frame.axes[i] += by.vector;
}

fn pull_point<S: Scalar>(side: &Side<S>, cot: &Jet<S>, out: &mut SideCotangent<S>) {
    let by = marker::pull_back(side.motion, &side.frame.point, cot);
    out.theta += by.theta;
    out.omega += by.omega;
    out.frame.point += by.vector;
    out.position += cot.x;
    out.velocity += cot.rate;
}

/// Cotangents of a row's value, rate and bias.
#[derive(Clone, Copy, Debug)]
pub struct RowCotangent<S> {
    /// Of Φ.
    pub value: S,
    /// Of G v.
    pub rate: S,
    /// Of the bias.
    pub bias: S,
}

/// Pulls the cotangents of a row back to positions, velocities and joint frames of both bodies:
/// the transposed derivative of [`value`], [`rate`] and [`bias`].
pub fn pull_back<S: Scalar>(
    row: ConstraintRow,
    cot: &RowCotangent<S>,
    a: &Side<S>,
    b: &Side<S>,
    out_a: &mut SideCotangent<S>,
    out_b: &mut SideCotangent<S>,
) {
    let (u, w) = factors(row, a, b);
    // Φ = u·w and its time derivatives are symmetric in the two factors.
    let by = |other: &Jet<S>| Jet {
        x: other.x * cot.value + other.rate * cot.rate + other.bias * cot.bias,
        rate: other.x * cot.rate + other.rate * (cot.bias * 2.0),
        bias: other.x * cot.bias,
    };
    let (by_u, by_w) = (by(&w), by(&u));
    match row {
        Coincident(_) => {}
        Perpendicular { a: i, .. } | Sliding { a: i } => pull_axis(a, i, &by_u, out_a),
    }
    match row {
        Perpendicular { b: j, .. } => pull_axis(b, j, &by_w, out_b),
        Coincident(_) | Sliding { .. } => {
            pull_point(a, &by_w, out_a);
            let minus = Jet {
                x: -by_w.x,
                rate: -by_w.rate,
                bias: -by_w.bias,
            };
            pull_point(b, &minus, out_b);
        }
    }
}
