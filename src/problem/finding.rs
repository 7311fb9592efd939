//! Findings: faults of a document without their place in the file.

use std::ops::Range;

/// Which part of the entry at a pointer is at fault.
#[derive(Clone, Debug, PartialEq)]
pub enum Part {
    /// The key.
    Key,
    /// The value.
    Value,
    /// These bytes of the file.
    Bytes(Range<usize>),
    /// The file as a whole.
    File,
}

/// A fault without its place in the file.
#[derive(Clone, Debug)]
pub struct Finding {
    pub pointer: String,
    pub part: Part,
    pub found: String,
    pub expected: String,
    pub hint: Option<String>,
}

impl Finding {
    /// A fault of the value at `pointer`.
    pub fn new(
        pointer: impl Into<String>,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) -> Self {
        Self {
            pointer: pointer.into(),
            part: Part::Value,
            found: found.into(),
            expected: expected.into(),
            hint: None,
        }
    }

    /// The same fault, of the key.
    pub fn of_key(self) -> Self {
        Self {
            part: Part::Key,
            ..self
        }
    }

    /// The same fault with advice.
    pub fn hint(self, hint: Option<String>) -> Self {
        Self { hint, ..self }
    }
}
