//! Messages for faults of JSON syntax.

use super::finding::{Finding, Part};

/// The syntax fault of `text`.
pub(super) fn fault(text: &str, error: &serde_json::Error) -> Finding {
    let whole = |found: &str, expected: &str| Finding {
        part: Part::File,
        ..Finding::new("", found, expected)
    };
    if text.trim().is_empty() {
        return whole("an empty file", "a JSON object");
    }
    let start = token_start(text, offset(text, error));
    let rest = &text[start..];
    let length = match rest.chars().next() {
        Some(c) if in_token(c) => rest.find(|c| !in_token(c)).unwrap_or(rest.len()),
        Some(c) => c.len_utf8(),
        None => 0,
    };
    let token = &rest[..length];
    let message = error.to_string();
    let message = message.split(" at line").next().unwrap_or_default();
    let (found, expected) = explain(token, message);
    Finding {
        part: Part::Bytes(start..start + length),
        ..Finding::new("", found, expected)
    }
}

/// Found and expected, from the faulty token and the parser's message.
fn explain(token: &str, message: &str) -> (String, String) {
    let bare = token.trim_start_matches(['-', '+']).to_lowercase();
    let quoted = match token {
        "" => "the end of the file".to_owned(),
        token => format!("`{token}`"),
    };
    let found_expected = |found: &str, expected: &str| (found.to_owned(), expected.to_owned());
    if ["nan", "inf", "infinity"].contains(&bare.as_str()) {
        return (quoted, "a finite number".into());
    }
    if message == "number out of range" {
        return (quoted, "a number of size up to 1.7e308".into());
    }
    if message == "recursion limit exceeded" {
        return found_expected(
            "more than 127 brackets inside each other",
            "a shallower document",
        );
    }
    if message == "trailing comma" {
        return found_expected(
            "a comma before a closing bracket",
            "no comma after the last entry",
        );
    }
    if message == "trailing characters" {
        return (quoted, "nothing after the end of the document".into());
    }
    if message.starts_with("EOF while parsing") {
        let what = message.trim_start_matches("EOF while parsing ");
        return found_expected("the end of the file", &format!("the rest of {what}"));
    }
    if token.starts_with('/') || token.starts_with('#') {
        return found_expected("a comment", "JSON, which has none; use \"description\"");
    }
    if token.starts_with('\'') {
        return found_expected("a single quote", "a double quote");
    }
    if message == "key must be a string" {
        return (quoted, "a key in double quotes".into());
    }
    if let Some(expected) = message.strip_prefix("expected ") {
        let expected = match expected {
            "value" | "ident" => "a JSON value",
            other => other,
        };
        return (quoted, expected.into());
    }
    (message.to_owned(), "JSON".into())
}

/// The byte at which the parser stopped.
fn offset(text: &str, error: &serde_json::Error) -> usize {
    let before = error.line().saturating_sub(1);
    let line: usize = text.split_inclusive('\n').take(before).map(str::len).sum();
    let mut at = (line + error.column().saturating_sub(1)).min(text.len());
    while !text.is_char_boundary(at) {
        at -= 1;
    }
    at
}

/// Whether a character belongs to words and numbers.
fn in_token(c: char) -> bool {
    c.is_alphanumeric() || "+-._".contains(c)
}

/// The first byte of the word or number that contains or ends at byte `at`.
fn token_start(text: &str, at: usize) -> usize {
    let inside = text[at..].chars().next().is_some_and(in_token);
    if !inside {
        return at;
    }
    let word = text[..at].chars().rev().take_while(|&c| in_token(c));
    at - word.map(char::len_utf8).sum::<usize>()
}
