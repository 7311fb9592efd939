//! Fields over an element: the geometry (X, D) and a motion (u, q) alike.
//!
//! x = Σ N_a X_a and d = Σ N_a D_a; d is not normalised again. A motion moves x by u = Σ N_a u_a
//! and d by q = Σ N_a q_a with q_a = θ_a × D_a.
//!
//! All kinds of elements have room for nine nodes; what an element of fewer does not need is zero. Sums over the nodes
//! have as many terms as the kind has nodes, which is known when a program is compiled.

use super::basis::{Basis, NODES};
use crate::math::{Scalar, Vec3};
use crate::model::shell_kind::PerNode;

/// Nodal values of a field: points (X or u) \[m\] and directors (D or q) [-].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Field<S> {
    /// X_a or u_a \[m\]; zero beyond the nodes of the element.
    pub points: [Vec3<S>; NODES],
    /// D_a or q_a [-]; zero beyond the nodes of the element.
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

/// Nodes of the smaller kind of element.
const FEW: usize = 4;

/// Σ_a w_a v_a.
#[inline]
pub fn sum<S: Scalar>(weights: &PerNode<f64>, vectors: &[Vec3<S>; NODES]) -> Vec3<S> {
    match weights.len() {
        FEW => sum_of::<S, FEW>(weights.places(), vectors),
        _ => sum_of::<S, NODES>(weights.places(), vectors),
    }
}

#[inline(always)]
fn sum_of<S: Scalar, const N: usize>(
    weights: &[f64; NODES],
    vectors: &[Vec3<S>; NODES],
) -> Vec3<S> {
    let mut total = Vec3::zeros();
    for a in 0..N {
        for i in 0..3 {
            total[i] += vectors[a][i] * weights[a];
        }
    }
    total
}

/// Transpose of [`sum`]: v̄_a += w_a t̄.
#[inline]
pub fn add_sum_transpose<S: Scalar>(
    weights: &PerNode<f64>,
    total: &Vec3<S>,
    vectors: &mut [Vec3<S>; NODES],
) {
    for (vector, &weight) in vectors.iter_mut().zip(weights) {
        for i in 0..3 {
            vector[i] += total[i] * weight;
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
    match basis.n.len() {
        FEW => add_transpose_of::<S, FEW>(basis, at, field),
        _ => add_transpose_of::<S, NODES>(basis, at, field),
    }
}

#[inline(always)]
fn add_transpose_of<S: Scalar, const N: usize>(
    basis: &Basis,
    at: &AtPoint<S>,
    field: &mut Field<S>,
) {
    let (n, [by_r, by_s]) = (basis.n.places(), basis.by.each_ref().map(PerNode::places));
    for a in 0..N {
        let (n, nr, ns) = (n[a], by_r[a], by_s[a]);
        for i in 0..3 {
            field.points[a][i] += at.by[0][i] * nr + at.by[1][i] * ns;
            field.directors[a][i] +=
                at.director[i] * n + at.director_by[0][i] * nr + at.director_by[1][i] * ns;
        }
    }
}
