//! What the smoothing of loads changes: the same run with half the widths of stops, contacts, cables, friction and drag.
//!
//! The onset of a contact changes a rebound in the third order of its width, friction a way in the second (docs/formulation.md), so
//! the difference is 3/4 to 7/8 of the whole change.

use super::compared::{Compared, compare};
use super::evaluate::Evaluated;
use crate::integrate::IntegrationFailure;
use crate::problem::Problem;

/// Functions of a simulated design with half the widths. Empty if no load has one.
///
/// # Errors
/// If this simulation fails.
pub fn changes(
    problem: &Problem,
    at: &Evaluated,
    which: &[usize],
) -> Result<Vec<Compared>, IntegrationFailure> {
    match problem.with_half_widths() {
        Some(other) => compare(at, &other, which),
        None => Ok(Vec::new()),
    }
}
