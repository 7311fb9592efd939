//! What an earlier optimisation left: its design, and the state of its optimiser.

use super::{Failure, record, shown};
use crate::driver::WarmStart;
use crate::library::written::STATE;
use crate::problem::Problem;
use std::path::Path;

/// The state of the optimiser in a result directory, if it is there and can be read.
pub(super) fn state_in(directory: &Path) -> Option<WarmStart> {
    let text = std::fs::read(directory.join(STATE)).ok()?;
    serde_json::from_slice(&text).ok()
}

/// Moves the start to the design of another optimum. Returns its state, if there is one of the same
/// design and problem.
pub(super) fn start_from(problem: &mut Problem, from: &Path) -> Result<Option<WarmStart>, Failure> {
    let (record, optimum) = record(from)?;
    let mut start = problem.start();
    let mut known = 0;
    for (x, variable) in start.iter_mut().zip(&problem.variables) {
        if let Some(design) = optimum.design.get(&variable.name) {
            *x = design.value;
            known += 1;
        }
    }
    if known == 0 {
        return Err(Failure::bad_input(format!(
            "{}: found the variables {}, expected at least one of {}",
            shown(&record),
            optimum
                .design
                .keys()
                .cloned()
                .collect::<Vec<_>>()
                .join(", "),
            problem
                .variables
                .iter()
                .map(|v| v.name.as_str())
                .collect::<Vec<_>>()
                .join(", ")
        )));
    }
    problem.restart(&start);
    let state = state_in(record.parent().unwrap_or(Path::new("")));
    Ok(state.filter(|state| state.fits(problem) && state.is_at(&start)))
}
