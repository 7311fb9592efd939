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
    pub(crate) fn multiply(&self, v: &DVector<f64>) -> DVector<f64> {
        match self.factors.solve(&self.u.tr_mul(v)) {
            Some(inner) => v.component_mul(&self.base) - &self.u * inner,
            None => v.component_mul(&self.base),
        }
    }
}
