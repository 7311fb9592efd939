//! The files of an optimisation: record, history, state, figures and page.

use super::made::made;
use crate::driver::ends::Ends;
use crate::driver::{Optimisation, WarmStart};
use crate::figures;
use crate::figures::report_page::page;
use crate::problem::Problem;
use crate::report::{History, Optimum, ReportError, atomic_write, prepare_directory, write_all};
use std::path::{Path, PathBuf};

/// The record of the optimum.
pub(crate) const OPTIMUM: &str = "optimum.json";
/// The state of the optimiser, for a warm start.
pub(crate) const STATE: &str = "state.json";
/// The distinct optima of several starts.
const OPTIMA: &str = "optima.csv";
/// The history during the run. The other results are still those of an earlier run.
pub(crate) const PARTIAL: &str = "history.partial.csv";
/// The page of a result.
pub(crate) const REPORT: &str = "report.html";

/// Why a page was not written.
#[derive(Debug, thiserror::Error)]
pub enum PageError {
    /// A number of the record is not finite.
    #[error(transparent)]
    NotFinite(#[from] serde_json::Error),
    /// The file.
    #[error(transparent)]
    File(#[from] ReportError),
}

/// Writes all results except figures: all of them, or only the record, or nothing. Also returns
/// whether the record was written.
pub(crate) fn write(
    done: &Optimisation,
    state: Option<WarmStart>,
    optima: Option<&str>,
    directory: &Path,
) -> (bool, Option<ReportError>) {
    let mut files = Vec::new();
    // If the record has no text, this is reported at the end.
    if let Ok(text) = done.optimum.to_json() {
        files.push((OPTIMUM, text.into_bytes()));
    }
    if let Ok(text) = done.history.to_csv() {
        files.push(("history.csv", text.into_bytes()));
    }
    if let Some(text) = state.and_then(|state| serde_json::to_vec(&state).ok()) {
        files.push((STATE, text));
    }
    let several = optima.is_some();
    files.extend(optima.map(|text| (OPTIMA, text.as_bytes().to_vec())));
    let files: Vec<(PathBuf, Vec<u8>)> = files
        .into_iter()
        .map(|(name, bytes)| (directory.join(name), bytes))
        .collect();
    if let Err(error) = write_all(&files) {
        let record = files.iter().find(|(path, _)| path.ends_with(OPTIMUM));
        let recorded = record.is_some_and(|(path, bytes)| atomic_write(path, bytes).is_ok());
        let others = files.iter().filter(|(path, _)| !path.ends_with(OPTIMUM));
        for (path, _) in others.filter(|_| recorded) {
            // With a new record, files of an earlier run would be wrong.
            let _ = std::fs::remove_file(path);
        }
        return (recorded, Some(error));
    }
    // The whole history is written. A partial one that stays does no harm.
    let _ = std::fs::remove_file(directory.join(PARTIAL));
    if !several {
        // The optima of an earlier run.
        let _ = std::fs::remove_file(directory.join(OPTIMA));
    }
    (true, None)
}

/// Writes figures. Those that cannot be written are returned, and the figures of an earlier run in their
/// place are removed.
pub(crate) fn draw(directory: &Path, figures: Vec<figures::NamedFile>) -> Vec<ReportError> {
    let mut missing = Vec::new();
    for (name, bytes) in figures {
        let path = directory.join(name);
        if let Err(error) = atomic_write(&path, &bytes) {
            let _ = std::fs::remove_file(&path);
            missing.push(error);
        }
    }
    missing
}

/// [`draw`] of the figures of an optimisation; all figures of an earlier run are removed. Those of cases are in folders of
/// their names.
pub(crate) fn draw_optimisation(
    directory: &Path,
    problem: &Problem,
    done: &Optimisation,
) -> Vec<ReportError> {
    let mut missing = replace(directory, figures::of_optimisation(problem, done));
    // Figures of a motion have all of its phases.
    let ends = Ends::of_optimisation(done);
    let alone = ends
        .cases
        .iter()
        .filter(|(case, _)| !case.problem.is_phase());
    for (case, ends) in alone {
        let drawn = figures::of_designs(&case.problem, ends);
        missing.extend(draw_case(directory, &case.name, drawn));
    }
    missing
}

/// Writes the figures of a case into its folder; all figures of an earlier run there are removed.
fn draw_case(directory: &Path, name: &str, drawn: Vec<figures::NamedFile>) -> Vec<ReportError> {
    let own = directory.join(name);
    match prepare_directory(&own) {
        Ok(_held) => replace(&own, drawn),
        Err(error) => vec![error],
    }
}

/// [`draw`]; other figures in the directory are removed.
fn replace(directory: &Path, drawn: Vec<figures::NamedFile>) -> Vec<ReportError> {
    let is_drawn = |name: &&&str| drawn.iter().any(|(own, _)| own == *name);
    for name in figures::NAMES.iter().filter(|name| !is_drawn(name)) {
        let _ = std::fs::remove_file(directory.join(name));
    }
    draw(directory, drawn)
}

/// Writes the page of designs, and of the optimisation that led to the last, into a directory; `by` says
/// what made it.
///
/// # Errors
/// [`PageError`].
pub(crate) fn write_page(
    directory: &Path,
    problem: &Problem,
    (summary, by): (String, &str),
    ends: &Ends,
    of_run: Option<(&Optimum, &History)>,
) -> Result<(), PageError> {
    let text = page(problem, summary, ends, (of_run, made(by)))?;
    Ok(atomic_write(&directory.join(REPORT), text.as_bytes())?)
}
