//! The error of bases of flexible bodies: the same run with all nodes and more functions of beams, or with richer bases.
//!
//! All nodes give the error of a basis itself, be it by truncation or because the basis was made for the
//! design in the file. They may be dear. Richer bases have more fixed-interface modes and vectors of
//! smaller amplitudes, and rigid shells get a basis: cheaper, but of a poor basis they tell the order of
//! magnitude at best.

pub use super::compared::run;
use super::compared::{Compared, compare};
use super::evaluate::Evaluated;
use crate::integrate::IntegrationFailure;
use crate::problem::Problem;

/// Functions of a simulated design with all nodes and more functions of beams. Empty if no body has a basis.
///
/// # Errors
/// If this simulation fails.
pub fn errors(
    problem: &Problem,
    at: &Evaluated,
    which: &[usize],
) -> Result<Vec<Compared>, IntegrationFailure> {
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
) -> Result<Vec<Compared>, IntegrationFailure> {
    match problem.with_richer_bases(&at.x) {
        Some(other) => compare(at, &other, which),
        None => Ok(Vec::new()),
    }
}
