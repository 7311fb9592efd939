//! The rows as products of markers, in the plane and in space: time derivatives, and the pull-back to
//! the markers.
//!
//! Every row is Φ = s u · w with markers u, w and a constant s; a Distance also has −L/2:
//!
//! ```text
//!                  u      w      s
//! Coincident k     e_k    d      1            (e_k: ground axis, constant)
//! Perpendicular    u      w      1
//! Sliding          u      d      1
//! Distance         d      d      1 / (2 L)
//! Aligned          half the difference of two rows Perpendicular
//! ```
//!
//! The table in [`super::constraint`] follows by the product rule. Vectors have D components: 3 in
//! space, 2 in a plane (see [`super::planar`]).

use super::marker::MarkerKinematics;
use crate::math::Scalar;
use crate::model::ConstraintRow;
use ConstraintRow::{Aligned, Coincident, Distance, Perpendicular, Sliding};
use nalgebra::SVector;

/// The markers that the rows of a joint need.
#[derive(Clone, Copy, Default)]
pub(super) struct MarkersUsed {
    /// The vector between the points.
    pub points: bool,
    /// Axes of the frame on body A.
    pub axes_a: [bool; 3],
    /// Axes of the frame on body B.
    pub axes_b: [bool; 3],
}

impl MarkersUsed {
    /// Those of `rows`.
    pub(super) fn by(rows: impl Iterator<Item = ConstraintRow>) -> Self {
        let mut used = Self::default();
        for row in rows {
            match row {
                Coincident(_) | Distance => used.points = true,
                Perpendicular { a, b } => {
                    used.axes_a[a] = true;
                    used.axes_b[b] = true;
                }
                Sliding { a } => {
                    used.points = true;
                    used.axes_a[a] = true;
                }
                Aligned { a, b } => {
                    for i in [a, b] {
                        used.axes_a[i] = true;
                        used.axes_b[i] = true;
                    }
                }
            }
        }
        used
    }
}

/// The markers of a joint, or their cotangents. Markers that no row uses are zero.
#[derive(Clone, Copy)]
pub(super) struct Markers<S, const D: usize> {
    /// d = P_A − P_B.
    pub distance: MarkerKinematics<S, D>,
    /// Axes of the frame on body A.
    pub axes_a: [MarkerKinematics<S, D>; 3],
    /// Axes of the frame on body B.
    pub axes_b: [MarkerKinematics<S, D>; 3],
}

impl<S: Scalar, const D: usize> Markers<S, D> {
    fn zero() -> Self {
        Self {
            distance: MarkerKinematics::zero(),
            axes_a: [MarkerKinematics::zero(); 3],
            axes_b: [MarkerKinematics::zero(); 3],
        }
    }

    /// The markers that are `used`, by the vector between the points and the axes of both frames.
    pub(super) fn of(
        used: &MarkersUsed,
        distance: impl FnOnce() -> MarkerKinematics<S, D>,
        axis_a: impl Fn(usize) -> MarkerKinematics<S, D>,
        axis_b: impl Fn(usize) -> MarkerKinematics<S, D>,
    ) -> Self {
        let mut out = Self::zero();
        if used.points {
            out.distance = distance();
        }
        for i in 0..3 {
            if used.axes_a[i] {
                out.axes_a[i] = axis_a(i);
            }
            if used.axes_b[i] {
                out.axes_b[i] = axis_b(i);
            }
        }
        out
    }
}

/// The rows of a joint with their markers.
pub(super) struct Rows<'a, S, R, const D: usize> {
    /// The rows, in their order.
    pub rows: R,
    /// The markers.
    pub markers: &'a Markers<S, D>,
    /// Length L of a rod \[m\].
    pub length: S,
    /// The ground axes e_k.
    pub ground: &'a [SVector<S, D>; 3],
}

impl<S: Scalar, R: Iterator<Item = ConstraintRow> + Clone, const D: usize> Rows<'_, S, R, D> {
    /// Some of the rows.
    pub(super) fn only<Q>(&self, rows: Q) -> Rows<'_, S, Q, D> {
        Rows {
            rows,
            markers: self.markers,
            length: self.length,
            ground: self.ground,
        }
    }

    /// The sum of `of(u, w)` times s over the products of a row.
    fn over_products(
        &self,
        row: ConstraintRow,
        of: impl Fn(&MarkerKinematics<S, D>, &MarkerKinematics<S, D>) -> S,
    ) -> S {
        let m = self.markers;
        match row {
            Coincident(k) => of(&MarkerKinematics::fixed(self.ground[k]), &m.distance),
            Perpendicular { a, b } => of(&m.axes_a[a], &m.axes_b[b]),
            Sliding { a } => of(&m.axes_a[a], &m.distance),
            Distance => of(&m.distance, &m.distance) * (S::from(0.5) / self.length),
            Aligned { a, b } => {
                (of(&m.axes_a[a], &m.axes_b[b]) - of(&m.axes_a[b], &m.axes_b[a])) * 0.5
            }
        }
    }

    /// Φ̇ of each row.
    pub(super) fn rates(&self, out: &mut [S]) {
        for (row, out) in self.rows.clone().zip(out) {
            *out = self.over_products(row, |u, w| u.rate.dot(&w.x) + u.x.dot(&w.rate));
        }
    }

    /// Φ̈ of each row.
    pub(super) fn accelerations(&self, out: &mut [S]) {
        for (row, out) in self.rows.clone().zip(out) {
            *out = match row {
                Coincident(k) => self.ground[k].dot(&self.markers.distance.acceleration),
                Perpendicular { .. } | Sliding { .. } | Distance | Aligned { .. } => self
                    .over_products(row, |u, w| {
                        let ends = u.acceleration.dot(&w.x) + u.x.dot(&w.acceleration);
                        ends + u.rate.dot(&w.rate) * 2.0
                    }),
            };
        }
    }

    /// Pulls the cotangents `cot(i)` of row i back to the markers and to the length L: the transposed
    /// derivative of Φ, Φ̇, Φ̈ and of the virtual rate.
    pub(super) fn pull_back(&self, cot: impl Fn(usize) -> RowCotangent<S>) -> (Markers<S, D>, S) {
        let (mut by, mut by_length) = (Markers::zero(), S::zero());
        for (i, row) in self.rows.clone().enumerate() {
            let cot = cot(i);
            let m = self.markers;
            match row {
                Coincident(k) => {
                    let e = self.ground[k];
                    by.distance.x += e * cot.value;
                    by.distance.rate += e * cot.rate;
                    by.distance.acceleration += e * cot.acceleration;
                    by.distance.virtual_rate += e * cot.virtual_rate;
                }
                Perpendicular { a, b } => {
                    by.axes_a[a].add(&on_factor(&cot, &m.axes_b[b]));
                    by.axes_b[b].add(&on_factor(&cot, &m.axes_a[a]));
                }
                Aligned { a, b } => {
                    for (i, j, half) in [(a, b, 0.5), (b, a, -0.5)] {
                        let half = S::from(half);
                        by.axes_a[i].add(&on_factor(&cot, &m.axes_b[j]).scaled(half));
                        by.axes_b[j].add(&on_factor(&cot, &m.axes_a[i]).scaled(half));
                    }
                }
                Sliding { a } => {
                    by.axes_a[a].add(&on_factor(&cot, &m.distance));
                    by.distance.add(&on_factor(&cot, &m.axes_a[a]));
                }
                Distance => {
                    // Both factors are d; Φ has the additional term −L / 2.
                    let (d, length) = (&m.distance, self.length);
                    by.distance
                        .add(&on_factor(&cot, d).scaled(S::one() / length));
                    let squares = d.x.dot(&d.x) * 0.5 * cot.value
                        + d.x.dot(&d.rate) * cot.rate
                        + (d.x.dot(&d.acceleration) + d.rate.dot(&d.rate)) * cot.acceleration
                        + d.x.dot(&d.virtual_rate) * cot.virtual_rate;
                    by_length -= squares / (length * length) + cot.value * 0.5;
                }
            }
        }
        (by, by_length)
    }
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
    /// Of the rate G w at the virtual velocities w.
    pub virtual_rate: S,
}

/// Cotangent of one factor of a row from the other. Φ = u · w and its time derivatives are symmetric
/// in u and w.
fn on_factor<S: Scalar, const D: usize>(
    cot: &RowCotangent<S>,
    other: &MarkerKinematics<S, D>,
) -> MarkerKinematics<S, D> {
    MarkerKinematics {
        x: other.x * cot.value
            + other.rate * cot.rate
            + other.acceleration * cot.acceleration
            + other.virtual_rate * cot.virtual_rate,
        rate: other.x * cot.rate + other.rate * (cot.acceleration * 2.0),
        acceleration: other.x * cot.acceleration,
        virtual_rate: other.x * cot.virtual_rate,
    }
}
