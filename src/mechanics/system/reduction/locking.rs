//! Strain energy that a reduced basis locks.

use super::matrices::Matrices;
use super::spaces::bending_unknowns;
use crate::math::slices::dot;
use crate::model::reduced::ReducedShells;
use crate::structures::modes::PencilFailure;
use crate::system::finite::energy;
use nalgebra::{Cholesky, DMatrix, DVector};

/// The part of the strain energy of flat shells at coordinates q that displacements outside the basis would relieve;
/// `None` of other shells, whose forces of first order also stretch. What bends of v = V q stretches shells by quadratic
/// forces f; linear statics relieves
///
/// ```text
/// ½ f · (K⁻¹ f − V (Vᵀ K V)⁻¹ Vᵀ f)
/// ```
///
/// # Errors
/// [`PencilFailure`]: the stiffness K is singular with the axes held.
pub fn locked_part(body: &ReducedShells<f64>, q: &[f64]) -> Result<Option<f64>, PencilFailure> {
    if bending_unknowns(&body.elements).is_none() {
        return Ok(None);
    }
    let v = body.unknowns(q);
    let whole = energy(&body.elements, &v);
    if whole <= 0.0 {
        return Ok(Some(0.0));
    }
    let mut bent = vec![0.0; q.len()];
    body.pairs.of.iter().for_each(|&i| bent[i] = q[i]);
    let mut matrices = Matrices::new(&body.elements, &[])?;
    let force = matrices.quadratic(&body.unknowns(&bent));
    let vectors = &body.basis.vectors;
    let stiff: Vec<Vec<f64>> = vectors.iter().map(|x| matrices.stiff(x)).collect();
    let count = vectors.len();
    let small = DMatrix::from_fn(count, count, |i, j| dot(&vectors[i], &stiff[j]));
    let along = DVector::from_iterator(count, vectors.iter().map(|x| dot(x, &force)));
    let Some(factors) = Cholesky::new(small) else {
        return Ok(None);
    };
    let of_basis = along.dot(&factors.solve(&along));
    let relieved = 0.5 * (dot(&force, &matrices.solve(&force)) - of_basis);
    Ok(Some(relieved / whole))
}
