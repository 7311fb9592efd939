//! The three constraint rows: value, rate, acceleration bias, Jacobian and pull-back of each.
//!
//! A row is a bilinear function of markers (see [`super::marker`]): with d = P_A − P_B the
//! distance of two points and u, w axes of the two frames (see [`crate::model::joint`]),
//!
//! ```text
//!                  value Φ     rate G v             second derivative Φ̈
//! Coincident k     d_k         ḋ_k                  d̈_k
//! Perpendicular    u · w       u̇ · w + u · ẇ        ü · w + 2 u̇ · ẇ + u · ẅ
//! Sliding          u · d       u̇ · d + u · ḋ        ü · d + 2 u̇ · ḋ + u · d̈
//! ```
//!
//! The acceleration term of the index-1 equations is γ = −bias, the bias being Φ̈ at v̇ = 0.

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

/// The markers that the rows of a joint are made of, each in motion once.
struct Markers<S> {
    distance: Jet<S>,
    axes_a: [Jet<S>; 3],
    axes_b: [Jet<S>; 3],
}

impl<S: Scalar> Markers<S> {
    fn of(rows: impl Iterator<Item = ConstraintRow>, a: &Side<S>, b: &Side<S>) -> Self {
        let used = MarkersUsed::by(rows);
        let axis = |side: &Side<S>, used: bool, i: usize| match used {
            true => side.axis_jet(i),
            false => Jet::zero(),
        };
        Self {
            distance: match used.points {
                true => a.point_jet().minus(&b.point_jet()),
                false => Jet::zero(),
            },
            axes_a: std::array::from_fn(|i| axis(a, used.axes_a[i], i)),
            axes_b: std::array::from_fn(|i| axis(b, used.axes_b[i], i)),
        }
    }

    /// The vectors u, w (or d) whose product a row is.
    fn factors(&self, row: ConstraintRow) -> (Jet<S>, Jet<S>) {
        match row {
            Coincident(k) => (Jet::fixed(unit(k)), self.distance),
            Perpendicular { a, b } => (self.axes_a[a], self.axes_b[b]),
            Sliding { a } => (self.axes_a[a], self.distance),
        }
    }
}

/// Which markers the rows of a joint need.
struct MarkersUsed {
    points: bool,
    axes_a: [bool; 3],
    axes_b: [bool; 3],
}

impl MarkersUsed {
    fn by(rows: impl Iterator<Item = ConstraintRow>) -> Self {
        let mut used = Self {
            points: false,
            axes_a: [false; 3],
            axes_b: [false; 3],
        };
        for row in rows {
            match row {
                Coincident(_) => used.points = true,
                Perpendicular { a, b } => {
                    used.axes_a[a] = true;
                    used.axes_b[b] = true;
                }
                Sliding { a } => {
                    used.points = true;
                    used.axes_a[a] = true;
                }
            }
        }
        used
    }
}

fn unit<S: Scalar>(k: usize) -> Vec3<S> {
    let mut unit = Vec3::zeros();
    unit[k] = S::one();
    unit
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
    let mut out = [S::zero()];
    rates(std::iter::once(row), a, b, &mut out);
    out[0]
}

/// Rates G v of the rows of a joint.
pub fn rates<S: Scalar>(
    rows: impl Iterator<Item = ConstraintRow> + Clone,
    a: &Side<S>,
    b: &Side<S>,
    out: &mut [S],
) {
    let markers = Markers::of(rows.clone(), a, b);
    for (row, out) in rows.zip(out) {
        let (u, w) = markers.factors(row);
        *out = u.rate.dot(&w.x) + u.x.dot(&w.rate);
    }
}

/// Second derivatives Φ̈ of the rows of a joint at the accelerations of the motions: the
/// acceleration bias if these are zero.
pub fn accelerations<S: Scalar>(
    rows: impl Iterator<Item = ConstraintRow> + Clone,
    a: &Side<S>,
    b: &Side<S>,
    out: &mut [S],
) {
    let markers = Markers::of(rows.clone(), a, b);
    for (row, out) in rows.zip(out) {
        let (u, w) = markers.factors(row);
        *out = match row {
            Coincident(k) => w.acceleration[k],
            Perpendicular { .. } | Sliding { .. } => {
                u.acceleration.dot(&w.x) + u.rate.dot(&w.rate) * 2.0 + u.x.dot(&w.acceleration)
            }
        };
    }
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

/// Pulls the cotangents of the rows of a joint back to positions, velocities and joint frames of
/// both bodies: the transposed derivative of [`value`], [`rates`] and [`accelerations`], the
/// accelerations of the bodies held.
pub fn pull_back<S: Scalar>(
    rows: impl Iterator<Item = ConstraintRow> + Clone,
    cot: impl Fn(usize) -> RowCotangent<S>,
    a: &Side<S>,
    b: &Side<S>,
) -> (SideCotangent<S>, SideCotangent<S>) {
    let markers = Markers::of(rows.clone(), a, b);
    let mut by_distance = Jet::zero();
    let mut by_axes_a = [Jet::zero(); 3];
    let mut by_axes_b = [Jet::zero(); 3];
    for (i, row) in rows.clone().enumerate() {
        let cot = cot(i);
        // Φ = u·w and its time derivatives are symmetric in the two factors.
        let by = |other: &Jet<S>| Jet {
            x: other.x * cot.value
                + other.rate * cot.rate
                + other.acceleration * cot.acceleration
                + other.virtual_rate * cot.virtual_rate,
            rate: other.x * cot.rate + other.rate * (cot.acceleration * 2.0),
            acceleration: other.x * cot.acceleration,
            virtual_rate: other.x * cot.virtual_rate,
        };
        match row {
            Coincident(k) => {
                by_distance.x[k] += cot.value;
                by_distance.rate[k] += cot.rate;
                by_distance.acceleration[k] += cot.acceleration;
                by_distance.virtual_rate[k] += cot.virtual_rate;
            }
            Perpendicular { a: i, b: j } => {
                by_axes_a[i].add(&by(&markers.axes_b[j]));
                by_axes_b[j].add(&by(&markers.axes_a[i]));
            }
            Sliding { a: i } => {
                by_axes_a[i].add(&by(&markers.distance));
                by_distance.add(&by(&markers.axes_a[i]));
            }
        }
    }
    let used = MarkersUsed::by(rows);
    let (mut out_a, mut out_b) = (SideCotangent::zero(), SideCotangent::zero());
    if used.points {
        pull_point(a, &by_distance, &mut out_a);
        pull_point(b, &Jet::zero().minus(&by_distance), &mut out_b);
    }
    for i in 0..3 {
        if used.axes_a[i] {
            pull_axis(a, i, &by_axes_a[i], &mut out_a);
        }
        if used.axes_b[i] {
            pull_axis(b, i, &by_axes_b[i], &mut out_b);
        }
    }
    (out_a, out_b)
}

/// Cotangents of a row's value, rate, second derivative and virtual rate.
#[derive(Clone, Copy, Debug)]
pub struct RowCotangent<S> {
    /// Of Φ.
    pub value: S,
    /// Of G v.
    pub rate: S,
    /// Of Φ̈.
    pub acceleration: S,
    /// Of the rate G w that the virtual velocities w make.
    pub virtual_rate: S,
}

impl<S: Scalar> SideCotangent<S> {
    /// Adds another cotangent.
    pub fn add(&mut self, other: &Self) {
        self.position += other.position;
        self.theta += other.theta;
        self.velocity += other.velocity;
        self.omega += other.omega;
        self.frame.point += other.frame.point;
        for (axis, by) in self.frame.axes.iter_mut().zip(&other.frame.axes) {
            *axis += by;
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
