//! `optimize compare`, `optimize plot` and `optimize schema`.

use super::arguments::Comparison;
use super::{DONE, Failure, NOT_REACHED, print};
use crate::driver::figures;
use crate::report::{Optimum, Tolerances, read_text, write_all};
use std::path::{Path, PathBuf};

/// Compares two records.
pub fn compare(files: &Comparison) -> Result<u8, Failure> {
    let (new, baseline) = (record(&files.new)?, record(&files.baseline)?);
    let comparison = crate::report::compare(&new, &baseline, &Tolerances::default());
    print(&comparison.text())?;
    Ok(if comparison.passed() {
        DONE
    } else {
        NOT_REACHED
    })
}

/// Draws the figures of a result directory again.
pub fn plot(directory: &Path) -> Result<u8, Failure> {
    let optimum = record(directory)?;
    let history = read_text(&directory.join("history.csv")).map_err(Failure::bad_input)?;
    let history = crate::report::History::from_csv(&history).map_err(Failure::bad_input)?;
    let files = figures::of_record(&optimum, &history).map_err(Failure::bad_input)?;
    let files: Vec<(PathBuf, Vec<u8>)> = files
        .into_iter()
        .map(|(name, bytes)| (directory.join(name), bytes))
        .collect();
    write_all(&files).map_err(Failure::bad_input)?;
    Ok(DONE)
}

/// Prints the schema of problem files.
pub fn schema() -> Result<u8, Failure> {
    let text =
        serde_json::to_string_pretty(&crate::problem::schema()).map_err(Failure::bad_input)?;
    print(&(text + "\n"))?;
    Ok(DONE)
}

/// Reads a record from its file or its directory.
fn record(path: &Path) -> Result<Optimum, Failure> {
    let path = if path.is_dir() {
        path.join("optimum.json")
    } else {
        path.to_path_buf()
    };
    let text = read_text(&path).map_err(Failure::bad_input)?;
    Optimum::from_json(&text)
        .map_err(|error| Failure::bad_input(format!("{}: {error}", path.display())))
}
