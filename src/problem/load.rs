//! A problem from its file: of one machine, of its cases, or of a motion that events divide.

use super::fault::Faults;
use super::overrides::Override;
use super::{Problem, cases, events, read};
use std::path::Path;

/// Reads a problem file.
pub(super) fn load(path: &Path, overrides: &[Override]) -> Result<Problem, Faults> {
    let (text, file) = read::text_of(path)?;
    parse(&text, &file, overrides)
}

/// Reads a problem from its text.
pub(super) fn parse(written: &str, file: &str, overrides: &[Override]) -> Result<Problem, Faults> {
    let (document, source, findings) = read::document(written, file, overrides)?;
    let has = |key: &str| (document[key].as_object()).is_some_and(|all| !all.is_empty());
    let is_divided = ["cases", "events"]
        .iter()
        .any(|key| document.get(key).is_some());
    let of_parts = is_divided.then(|| source.clone());
    // The phases of each case are read with it.
    let phase = (has("events") && !has("cases")).then_some(0);
    let (problem, stated) = read::single(document, source, findings, (file, overrides), phase)?;
    match (stated, of_parts) {
        (Some(stated), Some(source)) => {
            cases::complete(problem, stated, &source, (file, overrides))
        }
        (None, Some(source)) if phase.is_some() => {
            events::complete(problem, &source, (file, overrides))
        }
        _ => Ok(problem),
    }
}
