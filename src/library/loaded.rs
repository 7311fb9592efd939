//! Problems from files and texts, with each ρ that these leave out.

use crate::driver::aggregates::{self, Unread};
use crate::problem::{Override, Problem};
use std::path::Path;

/// Reads a problem file as [`Problem::load`] does, and chooses each ρ of aggregates that the file leaves out by one
/// simulation at the start.
///
/// # Errors
/// Faults of the file, or a ρ that cannot be chosen.
pub fn load(path: &Path, overrides: &[Override]) -> Result<Problem, Unread> {
    aggregates::read(&|own| Problem::load(path, own), overrides, &mut |_| {})
}

/// As [`load`], of a text; `file` names it in faults.
///
/// # Errors
/// As of [`load`].
pub fn parse(text: &str, file: &str, overrides: &[Override]) -> Result<Problem, Unread> {
    aggregates::read(
        &|own| Problem::parse(text, file, own),
        overrides,
        &mut |_| {},
    )
}
