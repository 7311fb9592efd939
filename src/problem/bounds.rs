//! Limits on the size of a problem file. They are checked before memory is allocated for its
//! content.

use super::finding::{Finding, Part};
use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

/// Largest file \[bytes\].
pub const LARGEST: usize = 256 << 20;
/// Largest number of entries of one list or object, and of all together.
const MOST_ENTRIES: usize = 1_000_000;
const MOST_VALUES: usize = 8_000_000;
/// Largest depth of nested brackets that the parser accepts.
const DEEPEST: usize = 127;

/// Reads a file up to one byte beyond the largest size.
///
/// # Errors
/// The file cannot be read.
pub(super) fn read(path: &Path) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let most = LARGEST as u64 + 1;
    File::open(path)?.take(most).read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// The first limit that a text exceeds, if any. It is found in one pass, without memory for the
/// content. The parser reports text that is not JSON.
pub(super) fn exceeded(text: &str) -> Option<Finding> {
    let fault = |at: usize, found: String, expected: String| Finding {
        part: Part::Bytes(at..at + 1),
        ..Finding::new("", &found, &expected)
    };
    if text.len() > LARGEST {
        let found = format!("a file of more than {} MB", LARGEST >> 20);
        return Some(Finding {
            part: Part::File,
            ..Finding::new("", &found, "a smaller one")
        });
    }
    let bytes = text.as_bytes();
    // Number of entries so far of each open list and object.
    let mut open: Vec<usize> = Vec::new();
    let (mut values, mut at) = (0, 0);
    while let Some(&byte) = bytes.get(at) {
        match byte {
            b'"' => {
                at += 1;
                while let Some(&inner) = bytes.get(at).filter(|inner| **inner != b'"') {
                    at += if inner == b'\\' { 2 } else { 1 };
                }
            }
            b'[' | b'{' => {
                open.push(1);
                if open.len() > DEEPEST {
                    return None;
                }
            }
            b']' | b'}' => {
                open.pop()?;
            }
            b',' => {
                let entries = open.last_mut()?;
                *entries += 1;
                values += 1;
                if *entries > MOST_ENTRIES {
                    let found = format!("a list or object of more than {MOST_ENTRIES} entries");
                    return Some(fault(at, found, "fewer entries".into()));
                }
                if values > MOST_VALUES {
                    let found = format!("a document of more than {MOST_VALUES} values");
                    return Some(fault(at, found, "fewer values".into()));
                }
            }
            _ => {}
        }
        at += 1;
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_lists_are_found_where_they_become_too_long() {
        for (open, close) in [
            ("[", "]"),
            ("{\"a\": [[", "]]}"),
            ("{\"x,\\\"y\": {\"b\": [", "]}}"),
        ] {
            let list = |n: usize| format!("{open}{}1{close}", "1,".repeat(n - 1));
            assert!(exceeded(&list(MOST_ENTRIES)).is_none());
            let text = list(MOST_ENTRIES + 1);
            let found = exceeded(&text).expect("too long");
            let Part::Bytes(bytes) = found.part else {
                panic!("no place");
            };
            assert_eq!(bytes.start, open.len() + 2 * MOST_ENTRIES - 1);
            assert_eq!(text.as_bytes()[bytes.start], b',');
        }
    }

    #[test]
    fn what_is_no_json_is_left_to_the_parser() {
        for text in ["", "]", "\"", "\"\\", ",", "{]", &"[".repeat(100_000)] {
            assert!(exceeded(text).is_none(), "{text:.20}");
        }
    }

    #[test]
    fn many_values_in_short_lists_are_too_many() {
        let row = format!("[{}1],", "1,".repeat(999));
        let text = format!("[{}1]", row.repeat(9000));
        assert!(exceeded(&text).is_some());
    }
}
