//! Errors of reading and writing records.

use crate::problem::visible;
use std::path::{Path, PathBuf};

/// A path in a message.
fn shown(path: &Path) -> String {
    visible(&path.display().to_string())
}

/// A record that could not be read, written or drawn.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// The operating system refused to write.
    #[error("cannot write {}: {source}", shown(path))]
    Write {
        /// The requested file; it is unchanged.
        path: PathBuf,
        /// What the operating system said.
        source: std::io::Error,
    },
    /// Another run writes its results to the directory.
    #[error(
        "{}: found a run that is writing its results there, expected none: wait for its end, or give \
         another --output",
        shown(path)
    )]
    InUse {
        /// The directory; it has not changed.
        path: PathBuf,
    },
    /// The operating system refused to read.
    #[error("cannot read {}: {source}", shown(path))]
    Read {
        /// The requested file.
        path: PathBuf,
        /// What the operating system said.
        source: std::io::Error,
    },
    /// A history that is no valid table.
    #[error("history, line {line}: found {found}, expected {expected}")]
    History {
        /// Line of the file where the record starts, counted from one.
        line: usize,
        /// What was found.
        found: String,
        /// What was expected.
        expected: String,
    },
    /// A record of evaluations is damaged or belongs elsewhere.
    #[error("{}:{line}: found {found}, expected {expected}", shown(path))]
    Evaluations {
        /// The file.
        path: PathBuf,
        /// Line, counted from one.
        line: usize,
        /// What was found.
        found: String,
        /// What was expected.
        expected: String,
    },
    /// A table of reference positions that is not valid.
    #[error("{}:{line}: found {found}, expected {expected}", shown(path))]
    Positions {
        /// The file.
        path: PathBuf,
        /// Line, counted from one.
        line: usize,
        /// What was found.
        found: String,
        /// What was expected.
        expected: String,
    },
    /// An optimum that is no valid JSON document.
    #[error("optimum: {0}")]
    Optimum(#[from] serde_json::Error),
    /// A number of an optimum is NaN or infinite, which JSON cannot hold.
    #[error("optimum: the number at {pointer} is not finite, so it cannot be recorded")]
    NotFinite {
        /// JSON Pointer of the number.
        pointer: String,
    },
}
