//! Fields over an element: the geometry (X, D) and a motion (u, q) alike.
//!
//! x = Σ N_a X_a and d = Σ N_a D_a; d is not normalised again. A motion moves x by u = Σ N_a u_a
//! and d by q = Σ N_a q_a with q_a = θ_a × D_a.

use super::basis::{Basis, NODES};
use crate::math::{Scalar, Vec3};

/// Nodal values of a field: points (X or u) \[m\] and directors (D or q) [-].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Field<S> {
    /// X_a or u_a \[m\].
    pub points: [Vec3<S>; NODES],
    /// D_a or q_a [-].
    pub directors: [Vec3<S>; NODES],
}

impl<S: Scalar> Field<S> {
    /// The zero field.
    pub fn zeros() -> Self {
        let zero = [Vec3::zeros(); NODES];
        Self {
            points: zero,
            directors: zero,
        }
    }
}

/// A field at a point: derivatives of the points by r and s, the director and its derivatives.
#[derive(Clone, Copy, Debug)]
pub struct AtPoint<S> {
    pub by: [Vec3<S>; 2],
    pub director: Vec3<S>,
    pub director_by: [Vec3<S>; 2],
}

impl<S: Scalar> AtPoint<S> {
    pub fn zeros() -> Self {
        let zero = Vec3::zeros();
        Self {
            by: [zero; 2],
            director: zero,
            director_by: [zero; 2],
        }
    }
}

/// Σ_a w_a v_a.
#[inline]
pub fn sum<S: Scalar>(weights: &[f64; NODES], vectors: &[Vec3<S>; NODES]) -> Vec3<S> {
    let mut total = Vec3::zeros();
    for a in 0..NODES {
        for i in 0..3 {
            total[i] += vectors[a][i] * weights[a];
        }
    }
    total
}

/// Transpose of [`sum`]: v̄_a += w_a t̄.
#[inline]
pub fn add_sum_transpose<S: Scalar>(
    weights: &[f64; NODES],
    total: &Vec3<S>,
    vectors: &mut [Vec3<S>; NODES],
) {
    for a in 0..NODES {
        for i in 0..3 {
            vectors[a][i] += total[i] * weights[a];
        }
    }
}

/// The field at a point.
#[inline]
pub fn interpolate<S: Scalar>(basis: &Basis, field: &Field<S>) -> AtPoint<S> {
    AtPoint {
        by: std::array::from_fn(|k| sum(&basis.by[k], &field.points)),
        director: sum(&basis.n, &field.directors),
        director_by: std::array::from_fn(|k| sum(&basis.by[k], &field.directors)),
    }
}

/// Transpose of [`interpolate`]: adds the contributions of a point to the nodal cotangents.
#[inline]
pub fn add_interpolate_transpose<S: Scalar>(basis: &Basis, at: &AtPoint<S>, field: &mut Field<S>) {
    for a in 0..NODES {
        let (n, nr, ns) = (basis.n[a], basis.by[0][a], basis.by[1][a]);
        for i in 0..3 {
            field.points[a][i] += at.by[0][i] * nr + at.by[1][i] * ns;
            field.directors[a][i] +=
                at.director[i] * n + at.director_by[0][i] * nr + at.director_by[1][i] * ns;
        }
    }
}
