//! Whether an optimum is a minimum of second order: the curvature of the Lagrangian along the
//! directions that the active bounds and constraints leave free.

use super::evaluate::Evaluator;
use super::journal::Journal;
use crate::optimiser::{EvaluationFailure, Nlp, Outcome};
use crate::problem::Problem;
use crate::report::optimum::SecondOrder;
use nalgebra::{DMatrix, DVector};

/// Length of a difference in scaled variables: the error of a central difference of gradients is
/// of its square.
const STEP: f64 = 1e-4;
/// Eigenvalues of AᵀA for the active rows A, each of unit length, below this count as zero.
const NEGLIGIBLE: f64 = 1e-10;

/// Eigenvalues of the reduced Hessian Zᵀ ∇²L Z of the minimised Lagrangian, in the variables as
/// the optimiser scales them, by central differences of gradients: four gradients a direction.
///
/// Z spans the directions along which free variables (those off their bounds) move without
/// changing active constraints to first order. Their error is estimated from a second
/// step of twice the length and from their asymmetry.
///
/// # Errors
/// If a simulation fails beside the optimum.
pub fn second_order(
    problem: &Problem,
    outcome: &Outcome,
) -> Result<Option<SecondOrder>, EvaluationFailure> {
    let Some(mut program) = Evaluator::new(problem, Journal::default()) else {
        return Ok(None);
    };
    let x = DVector::from_column_slice(&outcome.x);
    let on_bound = |i: usize| {
        let name = &problem.variables[i].name;
        outcome.active_bounds.iter().any(|a| a.name == *name)
    };
    let free: Vec<usize> = (0..x.len()).filter(|&i| !on_bound(i)).collect();
    let active: Vec<usize> = (0..problem.constraints.len())
        .filter(|&j| {
            let name = &problem.constraints[j].name;
            outcome.active_constraints.iter().any(|a| a.name == *name)
        })
        .collect();
    let jacobian = program.gradients(x.as_slice())?.jacobian;
    let rows = DMatrix::from_fn(active.len(), free.len(), |r, c| {
        jacobian[(active[r], free[c])]
    });
    let basis = null_space(&rows);
    let (lower, upper) = program.variable_bounds();
    let room = |i: usize| (x[i] - lower[i]).min(upper[i] - x[i]);
    let step = free.iter().map(|&i| 0.25 * room(i)).fold(STEP, f64::min);
    if step < 1e-3 * STEP {
        return Ok(None);
    }

    let multipliers = DVector::from_column_slice(&outcome.multipliers.constraints);
    let mut slope = |x: &DVector<f64>| -> Result<DVector<f64>, EvaluationFailure> {
        let g = program.gradients(x.as_slice())?;
        let all = DVector::from_vec(g.objective) + g.jacobian.tr_mul(&multipliers);
        Ok(DVector::from_iterator(
            free.len(),
            free.iter().map(|&i| all[i]),
        ))
    };
    let k = basis.ncols();
    let mut differences = |step: f64| -> Result<DMatrix<f64>, EvaluationFailure> {
        let mut hessian = DMatrix::zeros(k, k);
        for j in 0..k {
            let mut beside = |length: f64| {
                let mut at = x.clone();
                for (c, &i) in free.iter().enumerate() {
                    at[i] += length * basis[(c, j)];
                }
                slope(&at)
            };
            let change = beside(step)? - beside(-step)?;
            hessian.set_column(j, &(basis.tr_mul(&change) / (2.0 * step)));
        }
        Ok(hessian)
    };
    let (coarse, hessian) = (differences(2.0 * step)?, differences(step)?);
    let transposed = hessian.transpose();
    let asymmetry = (&hessian - &transposed).amax() * 0.5;
    let uncertainty = (&hessian - &coarse).amax().max(asymmetry);
    let mut eigenvalues: Vec<f64> = ((hessian + transposed) * 0.5)
        .symmetric_eigenvalues()
        .iter()
        .copied()
        .collect();
    eigenvalues.sort_by(f64::total_cmp);
    Ok(Some(SecondOrder {
        eigenvalues,
        uncertainty,
    }))
}

/// Orthonormal basis of the directions that `rows` map to zero.
fn null_space(rows: &DMatrix<f64>) -> DMatrix<f64> {
    let n = rows.ncols();
    if rows.nrows() == 0 || n == 0 {
        return DMatrix::identity(n, n);
    }
    // Rows may have any units: only their directions count.
    let mut unit = rows.clone();
    for mut row in unit.row_iter_mut() {
        let length = row.norm();
        if length > 0.0 {
            row /= length;
        }
    }
    let gram = unit.tr_mul(&unit).symmetric_eigen();
    let free: Vec<_> = (0..n)
        .filter(|&i| gram.eigenvalues[i] <= NEGLIGIBLE)
        .map(|i| gram.eigenvectors.column(i).into_owned())
        .collect();
    if free.is_empty() {
        DMatrix::zeros(n, 0)
    } else {
        DMatrix::from_columns(&free)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_null_space_is_orthonormal_and_complete() {
        let rows = DMatrix::from_row_slice(2, 4, &[1.0, 2.0, 0.0, -1.0, 2.0, 4.0, 0.0, -2.0]);
        let basis = null_space(&rows);
        assert_eq!(basis.shape(), (4, 3));
        assert!((&rows * &basis).amax() < 1e-14);
        assert!((basis.tr_mul(&basis) - DMatrix::identity(3, 3)).amax() < 1e-14);
        assert_eq!(null_space(&DMatrix::zeros(0, 3)).shape(), (3, 3));
        let units = DMatrix::from_row_slice(2, 3, &[1e8, 0.0, 0.0, 0.0, 1.0, 0.0]);
        assert_eq!(null_space(&units).shape(), (3, 1));
    }
}
