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
use super::ritz::ritz_vectors;
use super::{FINE, KnownStarts, Solver, Sought, State, at_solution};
use crate::model::Model;
use crate::system::failure::AssemblyFailure;

/// A negative eigenvalue counts if it is larger than this, relative to the largest one.
const COUNTS: f64 = 1e-7;

/// The fastest growth σ \[1/s\] of a deformation at the quasi-static start of `model`, whose bodies are placed and
/// undeformed; `None` if none grows.
///
/// # Errors
/// If there is no such start.
pub fn growth(model: &Model<f64>, known: &KnownStarts) -> Result<Option<f64>, AssemblyFailure> {
    at_solution(model, known, Sought::Start, |solver, factors, found| {
        solver.growth(factors, found)
    })
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
        let softened = |y: &[f64]| {
            let mut right = weighted(y);
            right.resize(self.layout.order(), 0.0);
            let mut y = self.change(factors, found, &right, FINE);
            y.truncate(n);
            y
        };
        let counts = |value: f64, largest: f64| value < -COUNTS * largest;
        let growing = ritz_vectors(softened, weighted, (n, elastic), counts)
            .ok_or(AssemblyFailure::Singular)?;
        let rates = growing.iter().map(|(value, _)| (-1.0 / value).sqrt());
        Ok(rates.reduce(f64::max))
    }
}
