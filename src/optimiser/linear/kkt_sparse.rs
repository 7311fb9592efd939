//! The linear system of a primal–dual step for many variables or rows.

use clarabel::algebra::CscMatrix;
use clarabel::qdldl::{QDLDLFactorisation, QDLDLSettings};
use nalgebra::{DMatrix, DVector, Dyn, LU};

use crate::constants::HALF_OF_DIGITS;
use crate::linear::compact::Compact;
use crate::linear::jacobian::Jacobian;

/// Factors of
///
/// ```text
/// [ H   Aᵀ ]   with H = diag(h) − U M⁻¹ Uᵀ:
/// [ A   −D ]
/// ```
///
/// a sparse LDLᵀ of the matrix without U, and the Woodbury formula for U.
pub(crate) struct SparseKkt {
    n: usize,
    factors: QDLDLFactorisation<f64>,
    low_rank: Option<LowRank>,
}

struct LowRank {
    u: DMatrix<f64>,
    /// K⁻¹ [U; 0] and M − [U; 0]ᵀ K⁻¹ [U; 0], for the matrix K without U.
    solved: DMatrix<f64>,
    inner: LU<f64, Dyn, Dyn>,
}

impl SparseKkt {
    /// `None` if the matrix is singular.
    pub(crate) fn factor(
        h: &DVector<f64>,
        compact: Option<&Compact>,
        a: &Jacobian,
        d: &DVector<f64>,
        w: Option<&Jacobian>,
    ) -> Option<SparseKkt> {
        let (n, m) = (h.len(), d.len());
        // Inequality rows stiffen their variables.
        let mut stiff = h.clone();
        for j in (0..m).filter(|&j| d[j] > 0.0) {
            a.row(j).for_each(|(i, v)| stiff[i] += v * v / d[j]);
        }
        // The upper triangle, column by column: h, then each row of A above its −D, or its −W.
        let plain = m - w.map_or(0, |w| w.shape().0);
        let mut pointers: Vec<usize> = (0..=n).collect();
        let mut indices: Vec<usize> = (0..n).collect();
        let mut values: Vec<f64> = h.as_slice().to_vec();
        for j in 0..m {
            let mut own = 0.0;
            for (i, v) in a.row(j) {
                own += v * v / stiff[i];
                indices.push(i);
                values.push(v);
            }
            if let Some(w) = w.filter(|_| j >= plain) {
                for (i, v) in w.row(j - plain) {
                    indices.push(n + plain + i);
                    values.push(-v);
                }
            } else {
                indices.push(n + j);
                values.push(-d[j].max(HALF_OF_DIGITS * own).max(f64::MIN_POSITIVE));
            }
            pointers.push(indices.len());
        }
        let matrix = CscMatrix::new(n + m, n + m, pointers, indices, values);
        let settings = QDLDLSettings {
            regularize_enable: false,
            Dsigns: Some([vec![1; n], vec![-1; m]].concat()),
            ..QDLDLSettings::default()
        };
        let factors = QDLDLFactorisation::new(&matrix, Some(settings)).ok()?;
        let mut system = SparseKkt {
            n,
            factors,
            low_rank: None,
        };
        if let Some(Compact { u, middle, .. }) = compact {
            let mut solved = DMatrix::zeros(n + m, u.ncols());
            for k in 0..u.ncols() {
                let mut column = solved.column_mut(k);
                column.rows_mut(0, n).copy_from(&u.column(k));
                system.solve_in_place(column.as_mut_slice());
            }
            let inner = (middle - u.transpose() * solved.rows(0, n)).lu();
            if !inner.is_invertible() {
                return None;
            }
            let u = u.clone();
            system.low_rank = Some(LowRank { u, solved, inner });
        }
        Some(system)
    }

    /// Number of positive pivots. It is the number of positive eigenvalues.
    pub(crate) fn positive_pivots(&self) -> usize {
        self.factors.Dinv.iter().filter(|v| **v > 0.0).count()
    }

    pub(crate) fn solve(&self, p: &DVector<f64>, q: &DVector<f64>) -> (DVector<f64>, DVector<f64>) {
        let mut all = DVector::zeros(p.len() + q.len());
        all.rows_mut(0, self.n).copy_from(p);
        all.rows_mut(self.n, q.len()).copy_from(q);
        self.solve_in_place(all.as_mut_slice());
        if let Some(LowRank { u, solved, inner }) = &self.low_rank {
            let mut small = u.tr_mul(&all.rows(0, self.n));
            inner.solve_mut(&mut small);
            all += solved * small;
        }
        let dx = all.rows(0, self.n).into_owned();
        let dy = all.rows(self.n, q.len()).into_owned();
        (dx, dy)
    }

    /// Solves with the matrix without U.
    fn solve_in_place(&self, b: &mut [f64]) {
        let QDLDLFactorisation { perm, L, Dinv, .. } = &self.factors;
        let mut x: Vec<f64> = perm.iter().map(|&i| b[i]).collect();
        for k in 0..x.len() {
            let value = x[k];
            if value != 0.0 {
                for at in L.colptr[k]..L.colptr[k + 1] {
                    x[L.rowval[at]] -= L.nzval[at] * value;
                }
            }
        }
        for k in (0..x.len()).rev() {
            let mut value = x[k] * Dinv[k];
            for at in L.colptr[k]..L.colptr[k + 1] {
                value -= L.nzval[at] * x[L.rowval[at]];
            }
            x[k] = value;
        }
        for (&i, value) in perm.iter().zip(x) {
            b[i] = value;
        }
    }
}
