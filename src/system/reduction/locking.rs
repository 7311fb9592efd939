//! Strain energy that a reduced basis locks.

use super::matrices::Matrices;
use crate::math::slices::dot;
use crate::model::reduced::ReducedShells;
use crate::structures::modes::PencilFailure;
use crate::system::finite::energy;
use nalgebra::{Cholesky, DMatrix, DVector};

/// The part of the strain energy at coordinates q that displacements outside the basis would relieve. What bends of
/// v = V q stretches shells by quadratic forces f; linear statics relieves
///
/// ```text
/// ½ f · (K⁻¹ f − V (Vᵀ K V)⁻¹ Vᵀ f)
/// ```
///
/// # Errors
/// [`PencilFailure`]: the stiffness K is singular with the axes held.
pub(crate) fn locked_part(body: &ReducedShells<f64>, q: &[f64]) -> Result<f64, PencilFailure> {
    let v = body.unknowns(q);
    let whole = energy(&body.elements, &v);
    if whole <= 0.0 {
        return Ok(0.0);
    }
    let mut bent = vec![0.0; q.len()];
    body.pairs.of.iter().for_each(|&i| bent[i] = q[i]);
    let mut matrices = Matrices::new(&body.elements)?;
    let force = matrices.quadratic(&body.unknowns(&bent));
    let vectors = &body.basis.vectors;
    let stiff: Vec<Vec<f64>> = vectors.iter().map(|x| matrices.stiff(x)).collect();
    let count = vectors.len();
    let small = DMatrix::from_fn(count, count, |i, j| dot(&vectors[i], &stiff[j]));
    let along = DVector::from_iterator(count, vectors.iter().map(|x| dot(x, &force)));
    let Some(factors) = Cholesky::new(small) else {
        return Ok(0.0);
    };
    let of_basis = along.dot(&factors.solve(&along));
    let relieved = 0.5 * (dot(&force, &matrices.solve(&force)) - of_basis);
    Ok(relieved / whole)
}
