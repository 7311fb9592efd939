//! The chained hash of a file of evaluations. It shows a changed, moved or removed line.

use super::{EvaluationRecord, Head};
use sha2::{Digest, Sha256};
use std::borrow::Cow;

/// Bytes of a digest that are written, two hexadecimal digits each.
const BYTES: usize = 8;
/// The text around the hash at the end of a line.
const AROUND: (&str, &str) = (r#","chain":""#, r#""}"#);

/// The hash hₖ = SHA-256(hₖ₋₁ + lineₖ) of the lines so far, with line k without its hash. h₀ is
/// that of the head without its settings, which may change.
#[derive(Clone, Debug)]
pub(super) struct Chain {
    hash: String,
}

impl Chain {
    /// The chain of a file with this head.
    pub fn of(head: &Head) -> Result<Self, serde_json::Error> {
        let lasting = serde_json::to_string(&head.without_settings())?;
        Ok(Self {
            hash: digest("", lasting.as_bytes()),
        })
    }

    /// The hash after one more line, given without its hash.
    pub fn next(&mut self, line: &[u8]) -> &str {
        self.hash = digest(&self.hash, line);
        &self.hash
    }

    /// The next line, with its hash and its end.
    pub fn line(&mut self, record: &EvaluationRecord) -> Result<String, serde_json::Error> {
        let mut line = serde_json::to_string(record)?;
        self.next(line.as_bytes());
        // The brace of the record comes after the hash.
        line.pop();
        for part in [AROUND.0, &self.hash, AROUND.1, "\n"] {
            line.push_str(part);
        }
        Ok(line)
    }

    /// A line without its hash, and that hash, if it has one.
    pub fn split(line: &[u8]) -> (Cow<'_, [u8]>, Option<String>) {
        let hash = line.strip_suffix(AROUND.1.as_bytes()).and_then(|rest| {
            let (before, hash) = rest.split_at_checked(rest.len().checked_sub(2 * BYTES)?)?;
            let body = before.strip_suffix(AROUND.0.as_bytes())?;
            Some((body, std::str::from_utf8(hash).ok()?))
        });
        match hash {
            Some((body, hash)) => (Cow::Owned([body, b"}"].concat()), Some(hash.to_owned())),
            None => (Cow::Borrowed(line), None),
        }
    }
}

fn digest(before: &str, line: &[u8]) -> String {
    let mut hasher = Sha256::new();
    hasher.update(before.as_bytes());
    hasher.update(line);
    let bytes = hasher.finalize();
    bytes[..BYTES]
        .iter()
        .map(|byte| format!("{byte:02x}"))
        .collect()
}
