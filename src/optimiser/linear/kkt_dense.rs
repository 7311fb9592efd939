//! The linear system of a primal–dual step for few variables.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

use crate::constants::ROUND_OFF;
use crate::linear::jacobian::Jacobian;
use crate::linear::quasi_newton::QuasiNewton;

/// Factors by the Schur complement S = A H⁻¹ Aᵀ + D with H = B + Σ. If there are more inequality
/// rows than variables, they are eliminated first: H = B + Σ + A_Iᵀ D_I⁻¹ A_I, and S has the other
/// rows. The inertia is (n, m, 0) whenever S has a Cholesky factor; where equality rows are
/// dependent it has none and δ is added to D.
pub(crate) struct DenseKkt {
    hessian: Cholesky<f64, Dyn>,
    schur: Cholesky<f64, Dyn>,
    /// Rows of S, and the rows that are eliminated first.
    kept: Vec<usize>,
    eliminated: Vec<usize>,
    /// H⁻¹ Aᵀ over the rows of S.
    reduced: DMatrix<f64>,
    pub regularisation: f64,
}

impl DenseKkt {
    /// `None` if H or S cannot be made positive definite.
    pub(crate) fn factor(
        b: &mut QuasiNewton,
        sigma: &DVector<f64>,
        a: &Jacobian,
        d: &DVector<f64>,
    ) -> Option<DenseKkt> {
        let (n, m) = (sigma.len(), d.len());
        let inequalities = d.iter().filter(|d| **d > 0.0).count();
        let many = inequalities > n;
        let (eliminated, kept): (Vec<usize>, Vec<usize>) =
            (0..m).partition(|&j| many && d[j] > 0.0);
        let mut h = b.dense_plus(sigma);
        for &j in &eliminated {
            for (i, v) in a.row(j) {
                for (k, w) in a.row(j) {
                    h[(i, k)] += v * w / d[j];
                }
            }
        }
        let hessian = Cholesky::new(h)?;
        let mut reduced = DMatrix::zeros(n, kept.len());
        for (c, &j) in kept.iter().enumerate() {
            for (i, v) in a.row(j) {
                reduced[(i, c)] = v;
            }
        }
        let transposed = reduced.transpose();
        hessian.solve_mut(&mut reduced);
        let mut schur = transposed * &reduced;
        for (c, &j) in kept.iter().enumerate() {
            schur[(c, c)] += d[j];
        }
        let mut delta = 0.0;
        loop {
            let mut s = schur.clone();
            for c in 0..kept.len() {
                s[(c, c)] += delta * (1.0 + schur[(c, c)]);
            }
            let diagonal = s.diagonal();
            if let Some(schur) = Cholesky::new(s) {
                let l = schur.l_dirty();
                let independent = |c: usize| l[(c, c)].powi(2) > ROUND_OFF * diagonal[c];
                if (0..kept.len()).all(independent) {
                    return Some(DenseKkt {
                        hessian,
                        schur,
                        kept,
                        eliminated,
                        reduced,
                        regularisation: delta,
                    });
                }
            }
            delta = if delta == 0.0 { 1e-12 } else { delta * 100.0 };
            if delta > 1.0 {
                return None;
            }
        }
    }

    pub(crate) fn solve(
        &self,
        a: &Jacobian,
        d: &DVector<f64>,
        p: &DVector<f64>,
        q: &DVector<f64>,
    ) -> (DVector<f64>, DVector<f64>) {
        // An eliminated row has dy = (a·dx − q)/d.
        let mut p = p.clone();
        for &j in &self.eliminated {
            for (i, v) in a.row(j) {
                p[i] += v * q[j] / d[j];
            }
        }
        // S dy = (A H⁻¹) p − q;  dx = H⁻¹ (p − Aᵀ dy).
        let mut dy = self.reduced.tr_mul(&p);
        for (c, &j) in self.kept.iter().enumerate() {
            dy[c] -= q[j];
        }
        self.schur.solve_mut(&mut dy);
        let dx = self.hessian.solve(&p) - &self.reduced * &dy;
        let mut all = DVector::zeros(q.len());
        for (c, &j) in self.kept.iter().enumerate() {
            all[j] = dy[c];
        }
        for &j in &self.eliminated {
            all[j] = (a.row_dot(j, &dx) - q[j]) / d[j];
        }
        (dx, all)
    }
}
