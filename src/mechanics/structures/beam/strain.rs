//! Strains of a section of a beam as quadratic forms of the motion at a point.

use super::frame::Axes;
use crate::math::{Scalar, Vec3};

/// Motion at a point: w,r, θ and θ,r.
pub(super) struct AtPoint<S> {
    pub w: Vec3<S>,
    pub turn: Vec3<S>,
    pub turn_by: Vec3<S>,
}

impl<S: Scalar> AtPoint<S> {
    pub(super) fn zeros() -> Self {
        Self {
            w: Vec3::zeros(),
            turn: Vec3::zeros(),
            turn_by: Vec3::zeros(),
        }
    }
}

/// Numbers of a motion in the axes (t, e2, e3) at a point: w,s; θ; θ,s.
pub(super) const LOCAL: usize = 9;
/// ε, γ2, γ3, κ1, κ2, κ3.
pub(super) const STRAINS: usize = 6;

/// The linear parts of the strains: (strain, number, factor).
const LINEAR: [(usize, usize, f64); 8] = [
    (0, 0, 1.0),
    (1, 1, 1.0),
    (1, 5, -1.0),
    (2, 2, 1.0),
    (2, 4, 1.0),
    (3, 6, 1.0),
    (4, 7, 1.0),
    (5, 8, 1.0),
];

/// Their products of two numbers: (strain, number, number, factor). That of Wagner's term, the first, is
/// multiplied by the square of the radius of gyration.
const PRODUCTS: [(usize, usize, usize, f64); 11] = [
    (0, 6, 6, 0.5),
    (0, 1, 1, 0.5),
    (0, 2, 2, 0.5),
    (1, 3, 4, -0.5),
    (2, 3, 5, -0.5),
    (3, 4, 8, -0.5),
    (3, 5, 7, 0.5),
    (4, 5, 6, -0.5),
    (4, 3, 8, 0.5),
    (5, 3, 7, -0.5),
    (5, 4, 6, 0.5),
];

/// The strains of a section as quadratic forms of the numbers of a motion at a point.
pub(super) struct Strains<S> {
    /// Factors of [`PRODUCTS`]; none of linear strains.
    pub products: Vec<(usize, usize, usize, S)>,
}

impl<S: Scalar> Strains<S> {
    pub(super) fn new(stiffness: &[S; STRAINS], von_karman: bool) -> Self {
        let kept = if von_karman { &PRODUCTS[..] } else { &[] };
        let all = kept.iter().enumerate().map(|(n, &(k, i, j, c))| {
            let by = if n == 0 {
                gyration(stiffness)
            } else {
                S::one()
            };
            (k, i, j, by * c)
        });
        Self {
            products: all.collect(),
        }
    }

    pub(super) fn values(&self, x: &[S; LOCAL]) -> [S; STRAINS] {
        let mut out = [S::zero(); STRAINS];
        for (k, i, c) in LINEAR {
            out[k] += x[i] * c;
        }
        for &(k, i, j, c) in &self.products {
            out[k] += c * x[i] * x[j];
        }
        out
    }

    /// Derivatives of all strains by the numbers of the motion.
    pub(super) fn gradients(&self, x: &[S; LOCAL]) -> [[S; LOCAL]; STRAINS] {
        let mut out = [[S::zero(); LOCAL]; STRAINS];
        for (k, i, c) in LINEAR {
            out[k][i] += S::from(c);
        }
        for &(k, i, j, c) in &self.products {
            out[k][i] += c * x[j];
            out[k][j] += c * x[i];
        }
        out
    }

    /// Second derivatives of Σ n_k e_k, added to `to`.
    pub(super) fn add_curved(&self, n: &[S; STRAINS], to: &mut [[S; LOCAL]; LOCAL]) {
        for &(k, i, j, c) in &self.products {
            to[i][j] += c * n[k];
            to[j][i] += c * n[k];
        }
    }
}

/// I_p / A, the square of the radius of gyration \[m²\].
pub(super) fn gyration<S: Scalar>(stiffness: &[S; STRAINS]) -> S {
    (stiffness[4] + stiffness[5]) / stiffness[0]
}

/// The numbers of a motion at a point.
pub(super) fn local<S: Scalar>(axes: &Axes<S>, at: &AtPoint<S>) -> [S; LOCAL] {
    let all = [axes.t, axes.e2, axes.e3];
    let mut out = [S::zero(); LOCAL];
    for (i, e) in all.iter().enumerate() {
        out[i] = e.dot(&at.w) / axes.speed;
        out[3 + i] = e.dot(&at.turn);
        out[6 + i] = e.dot(&at.turn_by) / axes.speed;
    }
    out
}

/// Transpose of the derivative of [`local`], whose values are `x`, added to the cotangents of axes and motion.
pub(super) fn add_local_transpose<S: Scalar>(
    (axes, at, x): (&Axes<S>, &AtPoint<S>, &[S; LOCAL]),
    bar: &[S; LOCAL],
    axes_to: &mut Axes<S>,
    to: &mut AtPoint<S>,
) {
    let per = S::one() / axes.speed;
    let [t, e2, e3] = [0, 1, 2].map(|i| {
        let (w, turn, by) = (bar[i] * per, bar[3 + i], bar[6 + i] * per);
        axes_to.speed -= (bar[i] * x[i] + bar[6 + i] * x[6 + i]) * per;
        let e = [axes.t, axes.e2, axes.e3][i];
        to.w += e * w;
        to.turn += e * turn;
        to.turn_by += e * by;
        at.w * w + at.turn * turn + at.turn_by * by
    });
    axes_to.t += t;
    axes_to.e2 += e2;
    axes_to.e3 += e3;
}
