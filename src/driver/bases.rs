//! The error of reduced bases: the same run with richer ones, made at the design itself.
//!
//! A richer basis has more fixed-interface modes and vectors of smaller amplitudes; rigid shells
//! get a basis. The change of a function estimates the error by truncation, and the error of a
//! basis that was made for the design in the file.

use super::evaluate::Evaluated;
use super::integration::Integration;
use crate::integrate::IntegrationFailure;
use crate::problem::Problem;

/// A function with another basis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct BasisError {
    /// The function, by index.
    pub function: usize,
    /// Its value.
    pub value: f64,
    /// Its value with richer bases.
    pub richer: f64,
}

impl BasisError {
    /// The estimated error, absolute.
    pub(crate) fn error(&self) -> f64 {
        (self.value - self.richer).abs()
    }
}

/// Functions of a simulated design with richer bases. None if no body has a reduced basis.
///
/// # Errors
/// If the other simulation fails.
pub(crate) fn errors(
    problem: &Problem,
    at: &Evaluated,
    which: &[usize],
) -> Result<Vec<BasisError>, IntegrationFailure> {
    let Some(richer) = problem.with_richer_bases(&at.x) else {
        return Ok(Vec::new());
    };
    let scene = richer.scene(&at.x);
    let mut integration = Integration::new(&richer, &scene, Some(which), false);
    let (other, _) = Evaluated::with(&mut integration, &richer, &at.x)?;
    let one = |&function: &usize| BasisError {
        function,
        value: at.function(function).value,
        richer: other.function(function).value,
    };
    Ok(which.iter().map(one).collect())
}
