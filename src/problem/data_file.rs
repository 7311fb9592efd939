//! Files of data that a problem file names: their texts, their share of the hash of the problem, and where
//! their faults are.

use super::bounds;
use super::data_text::TextFault;
use super::fault::Faults;
use super::finding::{Finding, Part};
use super::source::Source;
use sha2::{Digest, Sha256};
use std::path::{Path, PathBuf};

/// A fault of data.
pub(super) enum DataFault {
    /// In a file of them.
    Data {
        path: PathBuf,
        text: String,
        finding: Finding,
    },
    /// In the problem file.
    Document(Finding),
}

impl DataFault {
    /// The fault with its place in its file, or in the problem file.
    pub(super) fn located(self, (file, source): (&str, &Source)) -> Faults {
        match self {
            DataFault::Data {
                path,
                text,
                finding,
            } => {
                let file = path.display().to_string();
                Faults::locate(vec![finding], &file, &Source::plain(&text), &[])
            }
            DataFault::Document(finding) => Faults::locate(vec![finding], file, source, &[]),
        }
    }
}

/// Reads the files that a problem file names.
pub(super) struct DataFiles<'a> {
    /// The directory of the problem file.
    pub directory: &'a Path,
    /// The hashes of the files so far.
    pub content: String,
}

impl<'a> DataFiles<'a> {
    /// Of the problem in this file.
    pub(super) fn beside(file: &'a str) -> Self {
        Self {
            directory: Path::new(file).parent().unwrap_or(Path::new("")),
            content: String::new(),
        }
    }

    /// Reads the bytes of a file that the entry at `pointer` names.
    pub(super) fn bytes(&mut self, pointer: &str, file: &str) -> Result<Vec<u8>, Box<DataFault>> {
        let path = self.directory.join(file);
        let document = |found: String| {
            let expected = "a file that can be read; its path is relative to the problem file";
            Box::new(DataFault::Document(Finding::new(pointer, found, expected)))
        };
        let named = path.display();
        let bytes = bounds::read(&path).map_err(|error| match error.kind() {
            _ if path.is_dir() => document(format!("the directory {named}")),
            std::io::ErrorKind::NotFound => document(format!("no file {named}")),
            _ => document(format!("{error} of {named}")),
        })?;
        if bytes.len() > bounds::LARGEST {
            return Err(document(format!(
                "a file of more than {} MB, {named}",
                bounds::LARGEST >> 20
            )));
        }
        let hash = Sha256::digest(&bytes);
        self.content
            .extend(hash.iter().map(|byte| format!("{byte:02x}")));
        Ok(bytes)
    }

    /// Reads a text that the entry at `pointer` names.
    pub(super) fn read<T>(
        &mut self,
        pointer: &str,
        file: &str,
        parse: impl FnOnce(&str) -> Result<T, TextFault>,
    ) -> Result<T, Box<DataFault>> {
        let bytes = self.bytes(pointer, file)?;
        self.text(pointer, file, bytes, parse)
    }

    /// Parses the bytes of a text that the entry at `pointer` names.
    pub(super) fn text<T>(
        &self,
        pointer: &str,
        file: &str,
        bytes: Vec<u8>,
        parse: impl FnOnce(&str) -> Result<T, TextFault>,
    ) -> Result<T, Box<DataFault>> {
        let path = self.directory.join(file);
        let data = |text: String, fault: TextFault| {
            Box::new(DataFault::Data {
                path: path.clone(),
                text,
                finding: Finding {
                    part: Part::Bytes(fault.at),
                    ..Finding::new(pointer, fault.found, fault.expected).hint(fault.hint)
                },
            })
        };
        let text = String::from_utf8(bytes).map_err(|error| {
            let at = error.utf8_error().valid_up_to();
            let text = String::from_utf8_lossy(error.as_bytes()).into_owned();
            let end = at + char::REPLACEMENT_CHARACTER.len_utf8();
            data(
                text,
                TextFault::new(at..end, "a byte that is not UTF-8", "a text"),
            )
        })?;
        // A text may begin with a byte order mark.
        let written = text.strip_prefix('\u{feff}').unwrap_or(&text);
        parse(written).map_err(|fault| data(written.to_owned(), fault))
    }
}
