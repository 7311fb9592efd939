//! Text of a user in messages. It cannot move the cursor of a terminal, break a line, change the
//! direction of writing, or fill the screen.

use super::finding::{Finding, Part};
use super::pointer::join;
use serde_json::Value;
use std::borrow::Cow;

/// Longest name [characters].
const LONGEST: usize = 200;
/// Ends of the pointers of texts that are prose. They may have lines and any length.
const PROSE: [&str; 2] = ["/description", "/$schema"];

/// Whether a character is invisible: controls, line and paragraph separators, and marks of writing
/// direction. Joiners that scripts need are not among them.
fn is_unseen(c: char) -> bool {
    c.is_control()
        || matches!(
            c,
            '\u{2028}' | '\u{2029}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}' | '\u{fffe}' | '\u{ffff}'
        )
}

fn escaped(text: &str, kept: &[char]) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match is_unseen(c) && !kept.contains(&c) {
            true => out.extend(c.escape_unicode()),
            false => out.push(c),
        }
    }
    out
}

/// The text on one line, with escapes such as \u{1b} for invisible characters.
pub fn visible(text: &str) -> String {
    escaped(text, &[])
}

/// As [`visible`], for a text that may have lines.
pub fn visible_lines(text: &str) -> String {
    escaped(text, &['\n', '\t'])
}

/// The beginning and the end of a text, if it is longer than `most` characters.
pub fn shortened(text: &str, most: usize) -> Cow<'_, str> {
    let count = text.chars().count();
    if count <= most {
        return text.into();
    }
    let (head, tail) = (2 * most / 3, most / 4);
    let start: String = text.chars().take(head).collect();
    let end: String = text.chars().skip(count - tail).collect();
    format!("{start}… ({count} characters) …{end}").into()
}

/// Faults of the names and texts of a document: invisible characters, and names that are too long.
pub(super) fn faults(document: &Value) -> Vec<Finding> {
    let mut findings = Vec::new();
    walk(document, "", &mut findings);
    findings
}

fn walk(value: &Value, pointer: &str, findings: &mut Vec<Finding>) {
    match value {
        Value::Object(object) => {
            for (key, inner) in object {
                let below = join(pointer, key);
                if let Some(finding) = fault(key, &below) {
                    findings.push(finding.of_key());
                }
                walk(inner, &below, findings);
            }
        }
        Value::Array(items) => {
            for (k, inner) in items.iter().enumerate() {
                if inner.is_object() || inner.is_array() || inner.is_string() {
                    walk(inner, &join(pointer, k), findings);
                }
            }
        }
        Value::String(text) if !PROSE.iter().any(|prose| pointer.ends_with(prose)) => {
            findings.extend(fault(text, pointer).map(|finding| Finding {
                part: Part::Value,
                ..finding
            }));
        }
        Value::String(_) | Value::Null | Value::Bool(_) | Value::Number(_) => {}
    }
}

fn fault(name: &str, pointer: &str) -> Option<Finding> {
    if let Some(c) = name.chars().find(|&c| is_unseen(c)) {
        let found = format!(
            "the character U+{:04X} in \"{}\"",
            u32::from(c),
            shortened(&visible(name), 60)
        );
        return Some(Finding::new(
            pointer,
            found,
            "a text of visible characters in one line",
        ));
    }
    let count = name.chars().count();
    (count > LONGEST).then(|| {
        let found = format!("\"{}\"", shortened(name, 40));
        Finding::new(
            pointer,
            found,
            format!("a text of at most {LONGEST} characters"),
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn letters_of_all_scripts_stay_and_controls_are_seen() {
        for name in [
            "Träger",
            "рычаг",
            "曲柄",
            "بازو",
            "भुजा",
            "می‌خواهم",
            "👩‍🔧",
            "e\u{301}",
        ] {
            assert_eq!(visible(name), name);
            assert_eq!(fault(name, "").map(|f| f.found), None);
        }
        let cases = [
            ("\u{1b}[2J", "\\u{1b}[2J"),
            ("a\nb", "a\\u{a}b"),
            ("a\u{9b}31m", "a\\u{9b}31m"),
            ("\u{202e}abc", "\\u{202e}abc"),
            ("a\u{2028}b", "a\\u{2028}b"),
            ("\u{7f}\r\0", "\\u{7f}\\u{d}\\u{0}"),
        ];
        for (text, shown) in cases {
            assert_eq!(visible(text), shown);
            assert!(fault(text, "").is_some());
        }
        assert_eq!(visible_lines("a\n\tb\r"), "a\n\tb\\u{d}");
    }

    /// Remarks may have lines and any length wherever they stand, names may not.
    #[test]
    fn descriptions_are_prose() {
        let long = format!("a\n{}", "b".repeat(300));
        let remark =
            serde_json::json!({"description": long, "bodies": {"arm": {"description": long}}});
        assert!(faults(&remark).is_empty());
        let name =
            serde_json::json!({"bodies": {"arm": {"material": long}}, "description": {"x": long}});
        let places = faults(&name);
        assert_eq!(places.len(), 2, "{places:?}");
    }

    #[test]
    fn long_texts_show_both_ends() {
        assert_eq!(shortened("abc", 3), "abc");
        let long = "ä".repeat(5000) + &"z".repeat(5000);
        let short = shortened(&long, 40);
        assert!(short.starts_with("ää") && short.ends_with("zz"), "{short}");
        assert!(short.contains("(10000 characters)") && short.chars().count() < 70);
    }
}
