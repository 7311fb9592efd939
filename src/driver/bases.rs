//! The error of bases of flexible bodies: the same run with all nodes and more functions of beams, or with richer bases.
//!
//! All nodes give the error of a basis itself, be it by truncation or because the basis was made for the
//! design in the file. They may be dear. Richer bases have more fixed-interface modes and vectors of
//! smaller amplitudes, and rigid shells get a basis: cheaper, but of a poor basis they tell the order of
//! magnitude at best.

use super::evaluate::Evaluated;
use super::integration::Integration;
use crate::integrate::IntegrationFailure;
use crate::problem::Problem;

/// A function with another basis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BasisError {
    /// The function, by index.
    pub function: usize,
    /// Its value.
    pub value: f64,
    /// Its value with the other basis.
    pub other: f64,
    /// The largest value over the motion with both, if it is an aggregate.
    pub maximum: Option<[f64; 2]>,
}

impl BasisError {
    /// The error, absolute, if the other basis is exact.
    pub fn error(&self) -> f64 {
        (self.value - self.other).abs()
    }
}

/// Functions of a simulated design with all nodes and more functions of beams. Empty if no body has a basis.
///
/// # Errors
/// If this simulation fails.
pub fn errors(
    problem: &Problem,
    at: &Evaluated,
    which: &[usize],
) -> Result<Vec<BasisError>, IntegrationFailure> {
    match problem.with_finer_bodies(&at.x) {
        Some(other) => compare(at, &other, which),
        None => Ok(Vec::new()),
    }
}

/// Functions of a simulated design with richer bases. Empty if no body has a reduced basis.
///
/// # Errors
/// If the simulation with richer bases fails.
pub fn changes(
    problem: &Problem,
    at: &Evaluated,
    which: &[usize],
) -> Result<Vec<BasisError>, IntegrationFailure> {
    match problem.with_richer_bases(&at.x) {
        Some(other) => compare(at, &other, which),
        None => Ok(Vec::new()),
    }
}

/// Functions of a simulated design, and those of another problem at the same design.
fn compare(
    at: &Evaluated,
    other: &Problem,
    which: &[usize],
) -> Result<Vec<BasisError>, IntegrationFailure> {
    let other = run(other, &at.x, which)?;
    let one = |&function: &usize| {
        let [own, other] = [at, &other].map(|of| of.function(function));
        let maxima = own.maximum.zip(other.maximum);
        BasisError {
            function,
            value: own.value,
            other: other.value,
            maximum: maxima.map(|(own, other)| [own.value, other.value]),
        }
    };
    Ok(which.iter().map(one).collect())
}

/// A problem at a design, simulated for the functions `which`.
///
/// # Errors
/// If the simulation fails.
pub fn run(problem: &Problem, x: &[f64], which: &[usize]) -> Result<Evaluated, IntegrationFailure> {
    let scene = problem.scene(x);
    let mut integration = Integration::new(problem, &scene, Some(which), false);
    let (at, _) = Evaluated::with(&mut integration, problem, x)?;
    Ok(at)
}
