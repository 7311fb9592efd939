//! Natural frequencies of a body with elastic coordinates.

use super::ModalNumbers;
use crate::math::Vec3;
use nalgebra::{DMatrix, SymmetricEigen};

/// What holds the axes of a body while it vibrates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Held {
    /// The axes are at rest.
    Axes,
    /// Nothing: the body floats freely.
    Nothing,
}

/// Natural frequencies \[Hz\] of small vibrations, ascending, without rigid motions. None if the stiffness
/// is not positive definite.
pub fn frequencies(body: &ModalNumbers<f64>, held: Held) -> Option<Vec<f64>> {
    let m = body.modes();
    if m == 0 {
        return Some(Vec::new());
    }
    let mut mass = DMatrix::from_row_slice(m, m, &body.elastic_mass());
    if held == Held::Nothing {
        // The rigid motion follows that of the coordinates: M_ee − M_er M_rr⁻¹ M_re.
        let rigid = rigid_mass(body).cholesky()?;
        let coupling = coupling(body);
        mass -= coupling.transpose() * rigid.solve(&coupling);
    }
    let stiffness = DMatrix::from_row_slice(m, m, &body.linear_stiffness());
    let l = stiffness.cholesky()?.l();
    // 1/ω² are the eigenvalues of L⁻¹ M L⁻ᵀ: the lowest frequencies are known best.
    let half = l.solve_lower_triangular(&mass)?;
    let inverse = l.solve_lower_triangular(&half.transpose())?;
    let inverse = (&inverse + inverse.transpose()) * 0.5;
    let mut all: Vec<f64> = SymmetricEigen::new(inverse)
        .eigenvalues
        .iter()
        .map(|x| 1.0 / (x.sqrt() * 2.0 * std::f64::consts::PI))
        .collect();
    all.sort_by(f64::total_cmp);
    Some(all)
}

/// Mass of the rigid motion (velocity of the origin, angular velocity) of the undeformed body.
fn rigid_mass(body: &ModalNumbers<f64>) -> DMatrix<f64> {
    let cross = body.shapes.centre.cross_matrix();
    let mut all = DMatrix::zeros(6, 6);
    all.fixed_view_mut::<3, 3>(0, 0).fill_diagonal(body.mass);
    all.fixed_view_mut::<3, 3>(0, 3).copy_from(&-cross);
    all.fixed_view_mut::<3, 3>(3, 0).copy_from(&cross);
    all.fixed_view_mut::<3, 3>(3, 3).copy_from(&body.inertia);
    all
}

/// ∫ X_I dm and ∫ X × X_I dm.
fn coupling(body: &ModalNumbers<f64>) -> DMatrix<f64> {
    let mut all = DMatrix::zeros(6, body.modes());
    let shapes = &body.shapes;
    for (i, (p, s)) in (shapes.static_moments.iter())
        .zip(&shapes.with_position)
        .enumerate()
    {
        let turn = Vec3::new(
            s[(1, 2)] - s[(2, 1)],
            s[(2, 0)] - s[(0, 2)],
            s[(0, 1)] - s[(1, 0)],
        );
        all.fixed_view_mut::<3, 1>(0, i).copy_from(p);
        all.fixed_view_mut::<3, 1>(3, i).copy_from(&turn);
    }
    all
}
