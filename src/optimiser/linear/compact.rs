//! The compact form of a limited-memory matrix.

use nalgebra::{DMatrix, DVector, Dyn, LU};

/// B = D − U M⁻¹ Uᵀ with U = [D S, Y] (Byrd, Nocedal & Schnabel 1994, eq. 2.17). D is σ I or the
/// diagonal.
#[derive(Clone, Debug)]
pub(crate) struct Compact {
    pub base: DVector<f64>,
    pub u: DMatrix<f64>,
    pub middle: DMatrix<f64>,
    pub factors: LU<f64, Dyn, Dyn>,
}

impl Compact {
    /// The matrix with the diagonal `base` and these pairs s, y.
    pub(crate) fn new<'a>(
        base: DVector<f64>,
        pairs: impl ExactSizeIterator<Item = (&'a DVector<f64>, &'a DVector<f64>)>,
    ) -> Compact {
        let (n, k) = (base.len(), pairs.len());
        let mut s = DMatrix::zeros(n, k);
        let mut u = DMatrix::zeros(n, 2 * k);
        for (p, (of_s, of_y)) in pairs.enumerate() {
            s.set_column(p, of_s);
            u.set_column(p, &of_s.component_mul(&base));
            u.column_mut(k + p).copy_from(of_y);
        }
        let products = s.transpose() * &u;
        let mut middle = DMatrix::zeros(2 * k, 2 * k);
        for i in 0..k {
            for j in 0..k {
                middle[(i, j)] = products[(i, j)];
                if i > j {
                    let l = products[(i, k + j)];
                    middle[(i, k + j)] = l;
                    middle[(k + j, i)] = l;
                }
            }
            middle[(k + i, k + i)] = -products[(i, k + i)];
        }
        let factors = middle.clone().lu();
        Compact {
            base,
            u,
            middle,
            factors,
        }
    }

    /// B⁻¹ `force`, by (D − U M⁻¹ Uᵀ)⁻¹ = D⁻¹ + D⁻¹ U (M − Uᵀ D⁻¹ U)⁻¹ Uᵀ D⁻¹; `None` if it is
    /// singular.
    pub(crate) fn solve(&self, force: &DVector<f64>) -> Option<DVector<f64>> {
        let mut divided = self.u.clone();
        for mut column in divided.column_iter_mut() {
            column.component_div_assign(&self.base);
        }
        let inner = (&self.middle - self.u.transpose() * &divided).lu();
        let small = inner.solve(&divided.tr_mul(force))?;
        Some(force.component_div(&self.base) + divided * small)
    }

    /// Product B v.
    pub(crate) fn multiply(&self, v: &DVector<f64>) -> DVector<f64> {
        match self.factors.solve(&self.u.tr_mul(v)) {
            Some(inner) => v.component_mul(&self.base) - &self.u * inner,
            None => v.component_mul(&self.base),
        }
    }
}
