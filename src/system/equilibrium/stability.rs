//! Whether a quasi-static start is stable.
//!
//! Let J be the matrix of the equations of the start, and S its part for changes y of positions after the other unknowns
//! are eliminated: S y = f are the forces that hold a deformation. A deformation with
//!
//! ```text
//! S y = −σ² M y
//! ```
//!
//! grows as exp(σ t), as a column does that buckles. Where the bodies turn, this is so if gyroscopic forces do not hold
//! it. Arnoldi's method for S⁻¹ M (solutions with J) finds the eigenvalues −1/σ² first, since those of stable
//! deformations are positive and gather at zero. Oscillations that grow (flutter) are not found.

use super::matrix::Factors;
use super::{KnownStarts, ROUGH, Solver, State, with_solution};
use crate::math::slices::{add_scaled, dot};
use crate::model::Model;
use crate::system::failure::AssemblyFailure;
use nalgebra::DMatrix;

/// Largest dimension of the Krylov space.
const DIMENSION: usize = 24;
/// A negative eigenvalue counts if it is larger than this, relative to the largest one.
const COUNTS: f64 = 1e-8;
/// Largest residual of an eigenvalue, relative to it.
const CONVERGED: f64 = 1e-2;
/// A vector lies in the space of those before if this part of it is left.
const DEPENDENT: f64 = 1e-8;

/// The fastest growth σ \[1/s\] of a deformation at the quasi-static start of `model`, whose bodies are placed and
/// undeformed; `None` if none grows.
///
/// # Errors
/// If there is no such start.
pub(crate) fn growth(
    model: &Model<f64>,
    known: &KnownStarts,
) -> Result<Option<f64>, AssemblyFailure> {
    with_solution(model, known, |_, _, solver, found| solver.growth(found))
}

impl Solver<'_> {
    fn growth(&self, found: &State<f64>) -> Result<Option<f64>, AssemblyFailure> {
        let factors = Factors::new(self.layout, self.model, found);
        let mut factors = factors.ok_or(AssemblyFailure::Singular)?;
        let n = self.layout.numbering.unknowns();
        let weighted = |y: &[f64]| self.layout.mass_product(self.model, &found.q, y);
        let softened = |mass: &[f64], factors: &mut Factors| {
            let mut right = mass.to_vec();
            right.resize(self.layout.order(), 0.0);
            let mut y = self.change(factors, found, &right, ROUGH);
            y.truncate(n);
            y
        };
        // Any vector has a part of each deformation.
        let any: Vec<f64> = (0..n)
            .map(|i| (1.0 + i as f64).sqrt().fract() - 0.5)
            .collect();
        let mut next = softened(&weighted(&any), &mut factors);
        let mut basis: Vec<[Vec<f64>; 2]> = Vec::new();
        let mut columns: Vec<Vec<f64>> = Vec::new();
        loop {
            // Orthogonal in the metric of the mass.
            let mut mass = weighted(&next);
            let before = dot(&next, &mass).sqrt();
            let mut column = vec![0.0; basis.len()];
            for _ in 0..2 {
                for (part, [y, with_mass]) in column.iter_mut().zip(&basis) {
                    let along = dot(with_mass, &next);
                    *part += along;
                    add_scaled(&mut next, -along, y);
                }
            }
            mass.copy_from_slice(&weighted(&next));
            let rest = dot(&next, &mass).sqrt();
            if !rest.is_finite() {
                return Err(AssemblyFailure::Singular);
            }
            column.push(rest);
            if !basis.is_empty() {
                columns.push(column);
            }
            let ends = rest <= DEPENDENT * before || basis.len() == DIMENSION.min(n);
            if ends {
                return Ok(fastest(&columns));
            }
            next.iter_mut().for_each(|x| *x /= rest);
            mass.iter_mut().for_each(|x| *x /= rest);
            let y = next;
            next = softened(&mass, &mut factors);
            basis.push([y, mass]);
        }
    }
}

/// σ of the negative eigenvalue of least size in the columns of a Hessenberg matrix.
fn fastest(columns: &[Vec<f64>]) -> Option<f64> {
    let beyond = columns.last()?.last()?.abs();
    let k = columns.len();
    let h = DMatrix::from_fn(k, k, |i, j| columns[j].get(i).copied().unwrap_or(0.0));
    let values = h.clone().schur().complex_eigenvalues();
    let largest = values.iter().fold(0.0_f64, |m, x| m.max(x.norm()));
    let mut out: Option<f64> = None;
    for value in values
        .iter()
        .filter(|x| x.im == 0.0 && x.re < -COUNTS * largest)
    {
        let shifted = &h - DMatrix::identity(k, k) * value.re;
        let decomposed = shifted.svd(false, true);
        // The residual is the last part of the eigenvector times the next column's length.
        let last = decomposed.v_t.map_or(1.0, |v| v[(k - 1, k - 1)].abs());
        if beyond * last <= CONVERGED * value.re.abs() {
            let sigma = (-1.0 / value.re).sqrt();
            out = Some(out.map_or(sigma, |other| other.max(sigma)));
        }
    }
    out
}
