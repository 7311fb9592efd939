//! The constraint rows: value, rate, acceleration bias, Jacobian and pull-back of each.
//!
//! A row is a bilinear function of markers (see [`super::marker`]). Let d = P_A − P_B be the vector
//! between two points, and u, w axes of the two frames (see [`crate::model::joint`]):
//!
//! ```text
//!                  value Φ     rate G v             second derivative Φ̈
//! Coincident k     d_k         ḋ_k                  d̈_k
//! Perpendicular    u · w       u̇ · w + u · ẇ        ü · w + 2 u̇ · ẇ + u · ẅ
//! Sliding          u · d       u̇ · d + u · ḋ        ü · d + 2 u̇ · ḋ + u · d̈
//! Distance         ½(d·d/L−L)  d · ḋ / L            (d · d̈ + ḋ · ḋ) / L
//! Aligned          half the difference of two rows Perpendicular
//! ```
//!
//! [`crate::model::JointKind::rows`] lists the rows of each joint: a revolute has Coincident 0, 1, 2 and
//! two Perpendicular rows. [`super::reaction`] has ∂(Gᵀλ)/∂q.
//!
//! A drive moves the markers on body B (see [`super::side`]). Then the rate is G v + Φ_t. The
//! acceleration term of the index-1 equations is γ = −bias, where the bias is Φ̈ at v̇ = 0.

use super::frame_motion::FrameMotion;
use super::marker::{self, MarkerKinematics};
use super::rows::{Markers, MarkersUsed, RowCotangent, Rows};
use super::side::JointSide;
use crate::math::{Scalar, Vec3};
use crate::model::{ConstraintRow, JointFrame};
use ConstraintRow::{Aligned, Coincident, Distance, Perpendicular, Sliding};

/// The markers of the rows of a joint; each is evaluated once.
fn markers<S: Scalar>(used: &MarkersUsed, a: &JointSide<S>, b: &JointSide<S>) -> Markers<S, 3> {
    let distance = || a.point_jet().minus(&b.point_jet());
    Markers::of(used, distance, |i| a.axis_jet(i), |i| b.axis_jet(i))
}

/// Calls `on_rows` with the rows of a joint and their markers.
fn with_rows<S: Scalar, R: Iterator<Item = ConstraintRow> + Clone, T>(
    rows: R,
    (a, b): (&JointSide<S>, &JointSide<S>),
    on_rows: impl FnOnce(&MarkersUsed, &Rows<S, R, 3>) -> T,
) -> T {
    let used = MarkersUsed::by(rows.clone());
    let rows = Rows {
        rows,
        markers: &markers(&used, a, b),
        length: a.frame.length,
        ground: &[Vec3::x(), Vec3::y(), Vec3::z()],
    };
    on_rows(&used, &rows)
}

/// Value Φ of a row.
pub fn value<S: Scalar>(row: ConstraintRow, a: &JointSide<S>, b: &JointSide<S>) -> S {
    match row {
        Coincident(k) => a.point()[k] - b.point()[k],
        Perpendicular { a: i, b: j } => a.axis(i).dot(&b.axis(j)),
        Sliding { a: i } => a.axis(i).dot(&(a.point() - b.point())),
        Distance => {
            let (d, length) = (a.point() - b.point(), a.frame.length);
            (d.dot(&d) / length - length) * 0.5
        }
        Aligned { a: i, b: j } => (a.axis(i).dot(&b.axis(j)) - a.axis(j).dot(&b.axis(i))) * 0.5,
    }
}

/// Rate G v + Φ_t of a row.
pub fn rate<S: Scalar>(row: ConstraintRow, a: &JointSide<S>, b: &JointSide<S>) -> S {
    let mut out = [S::zero()];
    rates(std::iter::once(row), a, b, &mut out);
    out[0]
}

/// Rates G v + Φ_t of the rows of a joint.
pub fn rates<S: Scalar>(
    rows: impl Iterator<Item = ConstraintRow> + Clone,
    a: &JointSide<S>,
    b: &JointSide<S>,
    out: &mut [S],
) {
    with_rows(rows, (a, b), |_, rows| rows.rates(out));
}

/// Second derivatives Φ̈ of the rows of a joint at the accelerations of the motions. If these are
/// zero, they are the acceleration bias.
pub fn accelerations<S: Scalar>(
    rows: impl Iterator<Item = ConstraintRow> + Clone,
    a: &JointSide<S>,
    b: &JointSide<S>,
    out: &mut [S],
) {
    with_rows(rows, (a, b), |_, rows| rows.accelerations(out));
}

/// One row of G: the derivatives of the rate in the velocities of both bodies.
#[derive(Clone, Copy, Debug)]
pub struct RowGradient<S> {
    /// In ṙ_A. The derivative in ṙ_B is its negative, because common motion changes no row.
    pub force: Vec3<S>,
    /// In ω_A (body axes of A).
    pub torque_a: Vec3<S>,
    /// In ω_B (body axes of B).
    pub torque_b: Vec3<S>,
    /// By the rate of the point on body A (body axes), if the body deforms under the joint; by that of the frame on body B
    /// (its axes), if it follows a coupling.
    pub local_force: Vec3<S>,
    /// By the rate of the section's rotation on body A (body axes), or by that of the frame, likewise.
    pub local_torque: Vec3<S>,
}

impl<S: Scalar> RowGradient<S> {
    /// Force and torque on the section of body A.
    pub fn local(&self) -> (Vec3<S>, Vec3<S>) {
        (self.local_force, self.local_torque)
    }

    /// Half the difference of two rows.
    fn half_less(&self, other: &Self) -> Self {
        let half = |x: &Vec3<S>, y: &Vec3<S>| (x - y) * S::from(0.5);
        Self {
            force: half(&self.force, &other.force),
            torque_a: half(&self.torque_a, &other.torque_a),
            torque_b: half(&self.torque_b, &other.torque_b),
            local_force: half(&self.local_force, &other.local_force),
            local_torque: half(&self.local_torque, &other.local_torque),
        }
    }

    /// All zero.
    pub fn zero() -> Self {
        let zero = Vec3::zeros();
        Self {
            force: zero,
            torque_a: zero,
            torque_b: zero,
            local_force: zero,
            local_torque: zero,
        }
    }
}

/// Derivatives of the rate of a row by the speed of frame B along e3 and by its spin about it, in the axes of the frame.
pub(super) fn followed_gradient<S: Scalar>(
    row: ConstraintRow,
    a: &JointSide<S>,
    b: &JointSide<S>,
) -> (Vec3<S>, Vec3<S>) {
    let along = |x: S| Vec3::new(S::zero(), S::zero(), x);
    let e3 = b.axis(2);
    match row {
        Perpendicular { a: i, b: j } => {
            let spin = a.axis(i).dot(&e3.cross(&b.axis(j)));
            (Vec3::zeros(), along(spin))
        }
        Sliding { a: i } => (along(-a.axis(i).dot(&e3)), Vec3::zeros()),
        // No coupled joint has such a row.
        Coincident(_) | Distance | Aligned { .. } => (Vec3::zeros(), Vec3::zeros()),
    }
}

/// Gradient of a row.
pub fn gradient<S: Scalar>(
    row: ConstraintRow,
    a: &JointSide<S>,
    b: &JointSide<S>,
) -> RowGradient<S> {
    let (ra, rb) = (&a.motion.rotation, &b.motion.rotation);
    let (sa, sb) = (&a.frame.point, &b.frame.point);
    let zero = Vec3::zeros();
    // Force at the point of a section of body A that deforms, and torque on it.
    let of_section = |force, axis: Option<usize>, arm: &Vec3<S>| match &a.undeformed {
        Some(undeformed) => {
            let torque = axis.map_or(zero, |i| undeformed.axes[i].cross(arm));
            (force, torque)
        }
        None => (zero, zero),
    };
    let (force, torque_a, torque_b, (local_force, local_torque)) = match row {
        Coincident(k) => {
            let mut force = zero;
            force[k] = S::one();
            let along_a = ra.row(k).transpose();
            let torque_b = -sb.cross(&rb.row(k).transpose());
            let local = of_section(along_a, None, &zero);
            (force, sa.cross(&along_a), torque_b, local)
        }
        Perpendicular { a: i, b: j } => {
            let w = ra.tr_mul(&b.axis(j));
            let torque_b = b.frame.axes[j].cross(&rb.tr_mul(&a.axis(i)));
            let local = of_section(zero, Some(i), &w);
            (zero, a.frame.axes[i].cross(&w), torque_b, local)
        }
        Sliding { a: i } => {
            let (e, u) = (&a.frame.axes[i], a.axis(i));
            let d = ra.tr_mul(&(a.point() - b.point()));
            let torque_b = -sb.cross(&rb.tr_mul(&u));
            let local = of_section(*e, Some(i), &d);
            (u, e.cross(&d) + sa.cross(e), torque_b, local)
        }
        Distance => {
            let u = (a.point() - b.point()) / a.frame.length;
            let along_a = ra.tr_mul(&u);
            let torque_b = -sb.cross(&rb.tr_mul(&u));
            let local = of_section(along_a, None, &zero);
            (u, sa.cross(&along_a), torque_b, local)
        }
        Aligned { a: i, b: j } => {
            let [one, other] = [(i, j), (j, i)].map(|(a_axis, b_axis)| {
                let row = Perpendicular {
                    a: a_axis,
                    b: b_axis,
                };
                gradient(row, a, b)
            });
            return one.half_less(&other);
        }
    };
    let mut out = RowGradient {
        force,
        torque_a,
        torque_b,
        local_force,
        local_torque,
    };
    if let (None, Some(slope)) = (&a.undeformed, b.follows) {
        let (force, torque) = followed_gradient(row, a, b);
        (out.local_force, out.local_torque) = (force * slope, torque * slope);
    }
    out
}

/// Cotangents of one side of a joint.
#[derive(Clone, Debug)]
pub struct SideCotangent<S> {
    /// Of the tangent position: δr (ground axes).
    pub position: Vec3<S>,
    /// Of the tangent position: δθ (body axes).
    pub theta: Vec3<S>,
    /// Of ṙ.
    pub velocity: Vec3<S>,
    /// Of ω.
    pub omega: Vec3<S>,
    /// Of the frame's point and axes.
    pub frame: JointFrame<S>,
    /// Of their motion on the body, if they move.
    pub moving: Option<FrameMotion<S>>,
}

impl<S: Scalar> SideCotangent<S> {
    /// The zero cotangent of a side with a fixed frame.
    pub fn fixed() -> Self {
        let zero = Vec3::zeros();
        Self {
            position: zero,
            theta: zero,
            velocity: zero,
            omega: zero,
            frame: JointFrame::zero(),
            moving: None,
        }
    }

    /// Adds another cotangent of a side with a fixed frame.
    pub fn add(&mut self, other: &Self) {
        self.position += other.position;
        self.theta += other.theta;
        self.velocity += other.velocity;
        self.omega += other.omega;
        self.frame.add(&other.frame);
    }

    /// The zero cotangent of `side`.
    fn of(side: &JointSide<S>) -> Self {
        let moving = side.moving.as_ref();
        Self {
            moving: moving.map(|_| FrameMotion::zero()),
            ..Self::fixed()
        }
    }
}

/// Pulls the cotangents of the rows of a joint back to positions, velocities and joint frames of
/// both bodies: the transposed derivative of [`value`], [`rates`] and [`accelerations`], at
/// constant accelerations of the bodies.
pub fn pull_back<S: Scalar>(
    rows: impl Iterator<Item = ConstraintRow> + Clone,
    cot: impl Fn(usize) -> RowCotangent<S>,
    a: &JointSide<S>,
    b: &JointSide<S>,
) -> (SideCotangent<S>, SideCotangent<S>) {
    with_rows(rows, (a, b), |used, rows| {
        pull_markers(used, rows.pull_back(cot), (a, b))
    })
}

/// Calls `visit` with every row and the pull-back of its cotangent `cot` alone.
pub fn pull_back_each<S: Scalar>(
    rows: impl Iterator<Item = ConstraintRow> + Clone,
    cot: RowCotangent<S>,
    (a, b): (&JointSide<S>, &JointSide<S>),
    mut visit: impl FnMut(ConstraintRow, SideCotangent<S>, SideCotangent<S>),
) {
    with_rows(rows, (a, b), |_, all| {
        for row in all.rows.clone() {
            let alone = std::iter::once(row);
            let used = MarkersUsed::by(alone.clone());
            let (by_a, by_b) = pull_markers(&used, all.only(alone).pull_back(|_| cot), (a, b));
            visit(row, by_a, by_b);
        }
    });
}

/// Pulls cotangents of the markers in use, and of the length of a rod, back to both sides.
fn pull_markers<S: Scalar>(
    used: &MarkersUsed,
    (by, by_length): (Markers<S, 3>, S),
    (a, b): (&JointSide<S>, &JointSide<S>),
) -> (SideCotangent<S>, SideCotangent<S>) {
    let (mut out_a, mut out_b) = (SideCotangent::of(a), SideCotangent::of(b));
    out_a.frame.length = by_length;
    if used.points {
        pull_point(a, &by.distance, &mut out_a);
        pull_point(b, &MarkerKinematics::zero().minus(&by.distance), &mut out_b);
    }
    for i in 0..3 {
        if used.axes_a[i] {
            pull_axis(a, i, &by.axes_a[i], &mut out_a);
        }
        if used.axes_b[i] {
            pull_axis(b, i, &by.axes_b[i], &mut out_b);
        }
    }
    (out_a, out_b)
}

fn pull_axis<S: Scalar>(
    side: &JointSide<S>,
    i: usize,
    cot: &MarkerKinematics<S>,
    out: &mut SideCotangent<S>,
) {
    let local = side.moving.as_ref().map(|moving| moving.axis(i));
    let by = marker::pull_back_moving(side.motion, &side.frame.axes[i], local.as_ref(), cot);
    out.theta += by.theta;
    out.omega += by.omega;
    out.frame.axes[i] += by.vector;
    if let Some(moving) = &mut out.moving {
        moving.rate.axes[i] += by.local.rate;
        moving.acceleration.axes[i] += by.local.acceleration;
        moving.virtual_rate.axes[i] += by.local.virtual_rate;
    }
}

fn pull_point<S: Scalar>(
    side: &JointSide<S>,
    cot: &MarkerKinematics<S>,
    out: &mut SideCotangent<S>,
) {
    let local = side.moving.as_ref().map(|moving| moving.point());
    let by = marker::pull_back_moving(side.motion, &side.frame.point, local.as_ref(), cot);
    out.theta += by.theta;
    out.omega += by.omega;
    out.frame.point += by.vector;
    out.position += cot.x;
    out.velocity += cot.rate;
    if let Some(moving) = &mut out.moving {
        moving.rate.point += by.local.rate;
        moving.acceleration.point += by.local.acceleration;
        moving.virtual_rate.point += by.local.virtual_rate;
    }
}
