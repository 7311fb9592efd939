//! Solution of the linear system of a primal–dual step.

use std::cmp::Ordering;

use nalgebra::DVector;

use crate::optimiser::linear::jacobian::Jacobian;
use crate::optimiser::linear::kkt_dense::DenseKkt;
use crate::optimiser::linear::kkt_sparse::SparseKkt;
use crate::optimiser::linear::quasi_newton::QuasiNewton;

/// Residual, relative to the right-hand side, at which refinement ends, and the largest number of
/// refinements.
const EXACT: f64 = 1e-13;
const REFINEMENTS: usize = 5;

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
}

impl KktSystem {
    /// Factors the system; `None` if it cannot be made regular.
    pub(crate) fn factor(
        b: &mut QuasiNewton,
        sigma: DVector<f64>,
        a: &Jacobian,
        d: DVector<f64>,
    ) -> Option<KktSystem> {
        let factors = if b.is_dense() {
            Factors::Dense(Box::new(DenseKkt::factor(b, &sigma, a, &d)?))
        } else {
            let h = &sigma + b.base();
            Factors::Sparse(Box::new(SparseKkt::factor(&h, b.compact(), a, &d)?))
        };
        Some(KktSystem { factors, sigma, d })
    }

    /// δ that was added to dependent rows.
    pub(crate) fn regularisation(&self) -> f64 {
        match &self.factors {
            Factors::Dense(dense) => dense.regularisation,
            Factors::Sparse(_) => 0.0,
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
        let (mut dx, mut dy) = self.solve_once(a, p, q);
        let size = p.amax().max(q.amax());
        let mut last = f64::INFINITY;
        let most = match &self.factors {
            Factors::Dense(dense) => dense.refinements(),
            Factors::Sparse(_) => REFINEMENTS,
        };
        for _ in 0..most {
            let rp = p - b.multiply(&dx) - self.sigma.component_mul(&dx) - a.tr_mul(&dy);
            let rq = q - a * &dx + self.d.component_mul(&dy);
            let residual = rp.amax().max(rq.amax());
            let stands = residual.partial_cmp(&last) != Some(Ordering::Less);
            if residual <= EXACT * size || stands {
                break;
            }
            last = residual;
            let (ex, ey) = self.solve_once(a, &rp, &rq);
            dx += ex;
            dy += ey;
        }
        (dx, dy)
    }

    fn solve_once(
        &self,
        a: &Jacobian,
        p: &DVector<f64>,
        q: &DVector<f64>,
    ) -> (DVector<f64>, DVector<f64>) {
        match &self.factors {
            Factors::Dense(dense) => dense.solve(a, &self.d, p, q),
            Factors::Sparse(sparse) => sparse.solve(p, q),
        }
    }
}
