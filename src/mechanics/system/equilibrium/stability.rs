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
use super::{FINE, KnownStarts, Solver, State, with_solution, without_spin};
use crate::math::slices::{add_scaled, dot};
use crate::model::Model;
use crate::system::failure::AssemblyFailure;
use crate::system::numbering::Numbering;
use nalgebra::DMatrix;

/// Largest dimension of the Krylov space.
const DIMENSION: usize = 24;
/// A negative eigenvalue counts if it is larger than this, relative to the largest one.
const COUNTS: f64 = 1e-7;
/// Largest residual |S⁻¹ M y − μ y| of an eigenvalue μ, relative to it, for |y| = 1 in the metric of the mass.
const CONVERGED: f64 = 1e-2;
/// A vector lies in the space of those before if this part of it is left.
const DEPENDENT: f64 = 1e-8;

/// The fastest growth σ \[1/s\] of a deformation at the quasi-static start of `model`, whose bodies are placed and
/// undeformed; `None` if none grows.
///
/// # Errors
/// If there is no such start.
pub fn growth(model: &Model<f64>, known: &KnownStarts) -> Result<Option<f64>, AssemblyFailure> {
    let own = without_spin(model);
    let numbering = Numbering::new(&own);
    let growth = |_: &_, solver: &Solver, found: &_| {
        solver.with_factors(found, |factors| solver.growth(factors, found))?
    };
    with_solution((&own, &numbering), known, growth)
}

impl Solver<'_> {
    fn growth(
        &self,
        factors: &mut Factors,
        found: &State<f64>,
    ) -> Result<Option<f64>, AssemblyFailure> {
        let n = self.layout.numbering.unknowns();
        let elastic = n - self.layout.rigid.len();
        let motions = self.layout.at_rest(&found.q);
        let weighted = |y: &[f64]| self.layout.mass_product(self.model, &motions, y);
        let mut softened = |y: &[f64]| {
            let mut right = weighted(y);
            right.resize(self.layout.order(), 0.0);
            let mut y = self.change(factors, found, &right, FINE);
            y.truncate(n);
            y
        };
        // Any vector has a part of each deformation.
        let any: Vec<f64> = (0..n)
            .map(|i| (1.0 + i as f64).sqrt().fract() - 0.5)
            .collect();
        let mut next = softened(&any);
        let mut basis: Vec<[Vec<f64>; 2]> = Vec::new();
        let mut columns: Vec<Vec<f64>> = Vec::new();
        loop {
            // Orthogonal in the metric of the mass.
            let before = dot(&next, &weighted(&next)).sqrt();
            let mut column = vec![0.0; basis.len()];
            for _ in 0..2 {
                for (part, [y, with_mass]) in column.iter_mut().zip(&basis) {
                    let along = dot(with_mass, &next);
                    *part += along;
                    add_scaled(&mut next, -along, y);
                }
            }
            let mut mass = weighted(&next);
            let rest = dot(&next, &mass).sqrt();
            if !rest.is_finite() {
                return Err(AssemblyFailure::Singular);
            }
            column.push(rest);
            if !basis.is_empty() {
                columns.push(column);
            }
            if rest <= DEPENDENT * before || basis.len() == DIMENSION.min(elastic) {
                break;
            }
            next.iter_mut().for_each(|x| *x /= rest);
            mass.iter_mut().for_each(|x| *x /= rest);
            let y = next;
            next = softened(&y);
            basis.push([y, mass]);
        }
        let mut fastest: Option<f64> = None;
        for (value, parts) in negative(&columns) {
            let mut y = vec![0.0; n];
            for (part, [own, _]) in parts.iter().zip(&basis) {
                add_scaled(&mut y, *part, own);
            }
            // A space of errors of solutions has eigenvalues, too.
            let mut rest = softened(&y);
            add_scaled(&mut rest, -value, &y);
            if dot(&rest, &weighted(&rest)).sqrt() <= CONVERGED * value.abs() {
                let sigma = (-1.0 / value).sqrt();
                fastest = Some(fastest.map_or(sigma, |other| other.max(sigma)));
            }
        }
        Ok(fastest)
    }
}

/// Negative eigenvalues of the columns of a Hessenberg matrix, with unit eigenvectors.
fn negative(columns: &[Vec<f64>]) -> Vec<(f64, Vec<f64>)> {
    let k = columns.len();
    if k == 0 {
        return Vec::new();
    }
    let h = DMatrix::from_fn(k, k, |i, j| columns[j].get(i).copied().unwrap_or(0.0));
    let values = h.clone().schur().complex_eigenvalues();
    let largest = values.iter().fold(0.0_f64, |m, x| m.max(x.norm()));
    let counts = |x: &f64| *x < -COUNTS * largest;
    let real = values.iter().filter(|x| x.im == 0.0).map(|x| x.re);
    real.filter(counts)
        .filter_map(|value| {
            let shifted = &h - DMatrix::identity(k, k) * value;
            let v = shifted.svd(false, true).v_t?;
            Some((value, v.row(k - 1).iter().copied().collect()))
        })
        .collect()
}
