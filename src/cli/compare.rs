//! `optimize compare`, `optimize plot` and `optimize schema`.

use super::arguments::Comparison;
use super::optimise::STATE;
use super::{DONE, Failure, NOT_REACHED, print, record};
use crate::driver::{WarmStart, figures};
use crate::report::{Tolerances, prepare_directory, read_text, write_all};
use std::path::{Path, PathBuf};

/// Compares two records.
pub(crate) fn compare(files: &Comparison) -> Result<u8, Failure> {
    let ((_, new), (_, baseline)) = (record(&files.new)?, record(&files.baseline)?);
    let comparison = crate::report::compare(&new, &baseline, &Tolerances::default());
    print(&comparison.text())?;
    Ok(if comparison.passed() {
        DONE
    } else {
        NOT_REACHED
    })
}

/// Draws the figures of a result directory from its record.
pub(crate) fn plot(directory: &Path) -> Result<u8, Failure> {
    let (_, optimum) = record(directory)?;
    let history = read_text(&directory.join("history.csv"))?;
    let history = crate::report::History::from_csv(&history)?;
    let state = std::fs::read(directory.join(STATE)).ok();
    let state = state.and_then(|text| serde_json::from_slice::<WarmStart>(&text).ok());
    let _held = prepare_directory(directory)?;
    let files = figures::of_record(&optimum, &history, state.as_ref(), directory)
        .map_err(Failure::bad_input)?;
    let files: Vec<(PathBuf, Vec<u8>)> = files
        .into_iter()
        .map(|(name, bytes)| (directory.join(name), bytes))
        .collect();
    write_all(&files)?;
    Ok(DONE)
}

/// Prints the JSON Schema of problem files.
pub(crate) fn schema() -> Result<u8, Failure> {
    let text =
        serde_json::to_string_pretty(&crate::problem::schema()).map_err(Failure::bad_input)?;
    print(&(text + "\n"))?;
    Ok(DONE)
}
