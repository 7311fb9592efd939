//! Solution of the linear system of a primal–dual step.

use nalgebra::DVector;

use crate::constants::ROUND_OFF;
use crate::linear::curvature::{Curvature, symmetric_product};
use crate::linear::jacobian::Jacobian;
use crate::linear::kkt_dense::DenseKkt;
use crate::linear::kkt_sparse::SparseKkt;
use crate::linear::quasi_newton::QuasiNewton;

/// Factors of
///
/// ```text
/// [ B + Σ   Aᵀ ] [dx]   [p]
/// [ A      −D  ] [dy] = [q]
/// ```
///
/// with B + Σ positive definite and D ≥ 0 diagonal.
pub(crate) struct KktSystem {
    factors: Factors,
    sigma: DVector<f64>,
    d: DVector<f64>,
}

enum Factors {
    Dense(Box<DenseKkt>),
    Sparse(Box<SparseKkt>),
    Exact(Box<Exact>),
}

/// The system with second derivatives: rows G and −W are added below A and −D.
struct Exact {
    factors: SparseKkt,
    diagonal: DVector<f64>,
    rows: Jacobian,
    stiffness: Jacobian,
}

impl Exact {
    /// If the matrix has not n positive eigenvalues, the most negative entry h of its diagonal is
    /// reversed by the addition of 2 |h| I. This suffices, as Gᵀ W⁻¹ G has none below zero.
    fn factor(
        curvature: &Curvature,
        sigma: &DVector<f64>,
        a: &Jacobian,
        d: &DVector<f64>,
    ) -> Option<Exact> {
        let n = sigma.len();
        let rows = a.above(&curvature.coupling);
        let stiffness = curvature.stiffness.clone();
        let d = d.clone().resize_vertically(rows.shape().0, 0.0);
        let mut diagonal = DVector::from_column_slice(&curvature.diagonal);
        let least = (sigma + &diagonal).min();
        for added in [0.0, -2.0 * least] {
            diagonal.add_scalar_mut(added);
            let h = sigma + &diagonal;
            if let Some(factors) = SparseKkt::factor(&h, None, &rows, &d, Some(&stiffness))
                && factors.positive_pivots() == n
            {
                return Some(Exact {
                    factors,
                    diagonal,
                    rows,
                    stiffness,
                });
            }
        }
        None
    }

    /// The product of D and −W with the multipliers of the rows.
    fn damp(&self, d: &DVector<f64>, y: &DVector<f64>) -> DVector<f64> {
        let (m, k) = (d.len(), self.stiffness.shape().0);
        let mut all = DVector::zeros(m + k);
        all.rows_mut(0, m)
            .copy_from(&d.component_mul(&y.rows(0, m)));
        let below = symmetric_product(&self.stiffness, &y.rows(m, k).into_owned());
        all.rows_mut(m, k).copy_from(&below);
        all
    }
}

impl KktSystem {
    /// Factors the system; `None` if it cannot be made regular.
    pub(crate) fn factor(
        b: &mut QuasiNewton,
        sigma: DVector<f64>,
        a: &Jacobian,
        d: DVector<f64>,
    ) -> Option<KktSystem> {
        let factors = if let Some(curvature) = b.exact() {
            Factors::Exact(Box::new(Exact::factor(curvature, &sigma, a, &d)?))
        } else if b.is_dense() {
            Factors::Dense(Box::new(DenseKkt::factor(b, &sigma, a, &d)?))
        } else {
            let h = &sigma + b.base();
            Factors::Sparse(Box::new(SparseKkt::factor(&h, b.compact(), a, &d, None)?))
        };
        Some(KktSystem { factors, sigma, d })
    }

    /// δ that was added to dependent rows.
    pub(crate) fn regularisation(&self) -> f64 {
        match &self.factors {
            Factors::Dense(dense) => dense.regularisation,
            Factors::Sparse(_) | Factors::Exact(_) => 0.0,
        }
    }

    /// Solves for dx and dy, with iterative refinement as long as it helps.
    pub(crate) fn solve(
        &self,
        b: &mut QuasiNewton,
        a: &Jacobian,
        p: &DVector<f64>,
        q: &DVector<f64>,
    ) -> (DVector<f64>, DVector<f64>) {
        let sigma = &self.sigma;
        match &self.factors {
            Factors::Dense(dense) => refined(
                dense.regularisation == 0.0,
                (p, q, a),
                |p, v| p - b.multiply(v) - sigma.component_mul(v),
                |y| self.d.component_mul(y),
                |p, q| dense.solve(a, &self.d, p, q),
            ),
            Factors::Sparse(sparse) => refined(
                true,
                (p, q, a),
                |p, v| p - b.multiply(v) - sigma.component_mul(v),
                |y| self.d.component_mul(y),
                |p, q| sparse.solve(p, q),
            ),
            Factors::Exact(exact) => {
                let m = q.len();
                let q = q.clone().resize_vertically(exact.rows.shape().0, 0.0);
                let h = sigma + &exact.diagonal;
                let (dx, dy) = refined(
                    true,
                    (p, &q, &exact.rows),
                    |p, v| p - h.component_mul(v),
                    |y| exact.damp(&self.d, y),
                    |p, q| exact.factors.solve(p, q),
                );
                (dx, dy.rows(0, m).into_owned())
            }
        }
    }
}

/// Solves for dx and dy by `solve_once`, refined as long as the residual falls if `refines`. `rest` is p − (B + Σ) dx
/// and `damping` D dy.
fn refined(
    refines: bool,
    (p, q, a): (&DVector<f64>, &DVector<f64>, &Jacobian),
    mut rest: impl FnMut(&DVector<f64>, &DVector<f64>) -> DVector<f64>,
    damping: impl Fn(&DVector<f64>) -> DVector<f64>,
    solve_once: impl Fn(&DVector<f64>, &DVector<f64>) -> (DVector<f64>, DVector<f64>),
) -> (DVector<f64>, DVector<f64>) {
    let (mut dx, mut dy) = solve_once(p, q);
    if !refines {
        return (dx, dy);
    }
    let size = p.amax().max(q.amax());
    let mut last = f64::INFINITY;
    loop {
        let rp = rest(p, &dx) - a.tr_mul(&dy);
        let rq = q - a * &dx + damping(&dy);
        let residual = rp.amax().max(rq.amax());
        let falls = residual < last;
        if residual <= ROUND_OFF * size || !falls {
            return (dx, dy);
        }
        last = residual;
        let (ex, ey) = solve_once(&rp, &rq);
        dx += ex;
        dy += ey;
    }
}
