//! Solution of the linear system of a primal–dual step.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

use super::quasi_newton::{Factor, QuasiNewton};

/// Relative size of a pivot of the Schur complement below which rows count as dependent.
const DEPENDENT: f64 = 1e-14;

/// Factors of
///
/// ```text
/// [ B + Σ   Aᵀ ] [dx]   [p]
/// [ A      −D  ] [dy] = [q]
/// ```
///
/// with B + Σ positive definite and D ≥ 0 diagonal. Elimination of dx leaves the Schur complement
/// S = A (B + Σ)⁻¹ Aᵀ + D, so the inertia is (n, m, 0) whenever S has a Cholesky factor; where
/// equality rows are dependent it has none and δ is added to D.
pub(super) struct KktSystem {
    hessian: Factor,
    schur: Cholesky<f64, Dyn>,
    reduced: DMatrix<f64>,
    sigma: DVector<f64>,
    d: DVector<f64>,
    /// δ that was added to the rows.
    pub regularisation: f64,
}

impl KktSystem {
    /// Factors the system; `None` if B + Σ or S cannot be made positive definite.
    pub(crate) fn factor(
        b: &mut QuasiNewton,
        sigma: DVector<f64>,
        a: &DMatrix<f64>,
        d: DVector<f64>,
    ) -> Option<KktSystem> {
        let hessian = b.factor(&sigma)?;
        let mut reduced = a.transpose();
        hessian.solve_mut(&mut reduced);
        let mut schur = a * &reduced;
        for j in 0..d.len() {
            schur[(j, j)] += d[j];
        }
        let mut delta = 0.0;
        loop {
            let mut s = schur.clone();
            for j in 0..d.len() {
                s[(j, j)] += delta * (1.0 + schur[(j, j)]);
            }
            let diagonal = s.diagonal();
            if let Some(schur) = Cholesky::new(s) {
                let l = schur.l_dirty();
                let independent = |j: usize| l[(j, j)].powi(2) > DEPENDENT * diagonal[j];
                if (0..d.len()).all(independent) {
                    let regularisation = delta;
                    return Some(KktSystem {
                        hessian,
                        schur,
                        reduced,
                        sigma,
                        d,
                        regularisation,
                    });
                }
            }
            delta = if delta == 0.0 { 1e-12 } else { delta * 100.0 };
            if delta > 1.0 {
                return None;
            }
        }
    }

    /// Solves for dx and dy, with iterative refinement where no δ was added.
    pub(crate) fn solve(
        &self,
        b: &mut QuasiNewton,
        a: &DMatrix<f64>,
        p: &DVector<f64>,
        q: &DVector<f64>,
    ) -> (DVector<f64>, DVector<f64>) {
        let (mut dx, mut dy) = self.solve_once(p, q);
        for _ in 0..2 {
            let rp = p - b.multiply(&dx) - self.sigma.component_mul(&dx) - a.tr_mul(&dy);
            let rq = q - a * &dx + self.d.component_mul(&dy);
            let size = p.amax().max(q.amax());
            if rp.amax().max(rq.amax()) <= 1e-13 * size || self.regularisation > 0.0 {
                break;
            }
            let (ex, ey) = self.solve_once(&rp, &rq);
            dx += ex;
            dy += ey;
        }
        (dx, dy)
    }

    fn solve_once(&self, p: &DVector<f64>, q: &DVector<f64>) -> (DVector<f64>, DVector<f64>) {
        // S dy = (A (B + Σ)⁻¹) p − q;  dx = (B + Σ)⁻¹ (p − Aᵀ dy).
        let mut dy = self.reduced.tr_mul(p) - q;
        self.schur.solve_mut(&mut dy);
        let mut h = DMatrix::from_column_slice(p.len(), 1, p.as_slice());
        self.hessian.solve_mut(&mut h);
        let dx = h.column(0) - &self.reduced * &dy;
        (dx, dy)
    }
}
