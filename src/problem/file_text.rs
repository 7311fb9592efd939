//! The text of a file, and its JSON.

use super::bounds;
use super::fault::Faults;
use super::finding::{Finding, Part};
use super::source::Source;
use super::syntax;
use serde_json::Value;
use std::io::ErrorKind;
use std::path::Path;

/// Reads a text.
///
/// # Errors
/// Why it cannot be read, in words, or the place of a byte that is no text.
pub fn read(path: &Path) -> Result<String, Unread> {
    let bytes = bounds::read(path).map_err(|error| {
        Unread::Missing(match error.kind() {
            _ if path.is_dir() => "a directory".to_owned(),
            ErrorKind::NotFound => "no file".to_owned(),
            _ => error.to_string(),
        })
    })?;
    if bytes.len() > bounds::LARGEST {
        let found = format!("a file of more than {} MB", bounds::LARGEST >> 20);
        return Err(Unread::Missing(found));
    }
    String::from_utf8(bytes).map_err(|error| {
        let at = error.utf8_error().valid_up_to();
        let text = String::from_utf8_lossy(error.as_bytes());
        let finding = Finding {
            part: Part::Bytes(at..at + char::REPLACEMENT_CHARACTER.len_utf8()),
            ..Finding::new("", "a byte that is not UTF-8", "a text in UTF-8")
        };
        let file = path.display().to_string();
        Unread::Faulty(Faults::locate(
            vec![finding],
            &file,
            &Source::plain(&text),
            &[],
        ))
    })
}

/// Why a text is not read.
pub enum Unread {
    /// There is none.
    Missing(String),
    /// It has a fault.
    Faulty(Faults),
}

/// Reads JSON; `file` is the name of the text in faults.
///
/// # Errors
/// The place that is no JSON, or too large.
pub fn json(text: &str, file: &str) -> Result<Value, Faults> {
    let located = |finding: Finding| Faults::locate(vec![finding], file, &Source::plain(text), &[]);
    match bounds::exceeded(text) {
        Some(finding) => Err(located(finding)),
        None => serde_json::from_str(text).map_err(|error| located(syntax::fault(text, &error))),
    }
}
