//! Faults of a problem file: what is wrong, where it is, and what was expected.

use super::finding::{Finding, Part};
use super::overrides::Override;
use super::pointer::{is_below, join};
use super::source::Source;
use super::text::{shortened, visible};
use std::fmt;
use std::ops::Range;

/// Longest excerpt of a source line [characters].
const EXCERPT: usize = 96;
/// Longest text of a message, and longest key of a pointer, that are not shortened [characters].
const LONGEST_WORDS: usize = 800;
const LONGEST_KEY: usize = 60;

/// One fault of a problem file.
#[derive(Clone, Debug, PartialEq)]
pub struct Fault {
    /// JSON Pointer to the faulty entry; empty for the whole document.
    pub path: String,
    /// Line in the file from 1; 0 if the fault has no place in the file.
    pub line: usize,
    /// Column in characters from 1; 0 if the fault has no place in the file.
    pub column: usize,
    /// What was found.
    pub found: String,
    /// What was expected.
    pub expected: String,
    /// Advice, such as the nearest valid name.
    pub hint: Option<String>,
    /// Origin: the file, or the override.
    origin: String,
    /// Excerpt of the source line, and its numbers of characters before and under the marks.
    excerpt: Option<(String, usize, usize)>,
}

/// All faults of a problem file, in the order of the file.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub struct Faults {
    /// The faults; never empty.
    pub list: Vec<Fault>,
}

impl Faults {
    /// A single fault: the file cannot be read as text.
    pub(super) fn unreadable(file: &str, found: &str, expected: &str) -> Self {
        let finding = Finding {
            part: Part::File,
            ..Finding::new("", found, expected)
        };
        Self::locate(vec![finding], file, &Source::default(), &[])
    }

    /// Looks up the places of the findings in the source, and sorts them.
    pub(super) fn locate(
        findings: Vec<Finding>,
        file: &str,
        source: &Source,
        overrides: &[Override],
    ) -> Self {
        let mut list: Vec<Fault> = findings
            .into_iter()
            .map(|finding| locate(finding, file, source, overrides))
            .collect();
        list.sort_by_key(|fault| (fault.line, fault.column));
        if !source.origins.is_empty() {
            // One entry of a part or default is used several times.
            let mut once: Vec<Fault> = Vec::new();
            for fault in list {
                if !once.iter().any(|other| fault.is_again(other)) {
                    once.push(fault);
                }
            }
            list = once;
        }
        Self { list }
    }
}

impl Faults {
    /// Those of a case: each names it, and one of a value that the case sets is at its place there.
    pub(super) fn in_case(
        mut self,
        case: &str,
        sets: &[String],
        (file, source): (&str, &Source),
    ) -> Self {
        for fault in &mut self.list {
            let of_case = format!("this is in the case \"{case}\"");
            let hint = [fault.hint.take(), Some(of_case)];
            let hint = hint.into_iter().flatten().collect::<Vec<_>>().join("; ");
            fault.hint = Some(hint);
            let set = sets.iter().find(|path| is_below(&fault.path, path));
            if let Some(path) = set {
                let pointer = join(&join(&join("/cases", case), "set"), path);
                let finding = Finding::new(pointer, &fault.found, &fault.expected);
                *fault = locate(finding.hint(fault.hint.take()), file, source, &[]);
            }
        }
        self
    }
}

impl Fault {
    /// Whether another fault says the same of the same place.
    fn is_again(&self, other: &Self) -> bool {
        self.line > 0
            && (self.line, self.column) == (other.line, other.column)
            && (&self.found, &self.expected) == (&other.found, &other.expected)
            && self.origin == other.origin
            && self.path != other.path
    }
}

/// The fault of a finding.
fn locate(finding: Finding, file: &str, source: &Source, overrides: &[Override]) -> Fault {
    let written = source.origins.resolve(&finding.pointer);
    let overridden = overrides.iter().rev().find(|o| o.holds(&written));
    let bytes = match (&finding.part, overridden) {
        (Part::File, _) | (_, Some(_)) => None,
        (Part::Bytes(bytes), None) => Some(bytes.clone()),
        (Part::Key, None) => source.key(&finding.pointer),
        (Part::Value, None) => source.value(&finding.pointer),
    };
    let used = source.origins.used(&finding.pointer);
    let used = used.map(|used| format!("this is in the use \"{used}\""));
    let hint = [finding.hint, used].into_iter().flatten();
    let hint = hint.collect::<Vec<_>>().join("; ");
    let (other, source, _) = source.holding(&finding.pointer);
    let file = other.unwrap_or(file);
    let (line, column) = bytes
        .clone()
        .map_or((0, 0), |bytes| source.place(bytes.start));
    Fault {
        path: finding.pointer,
        line,
        column,
        found: readable(&finding.found),
        expected: readable(&finding.expected),
        hint: (!hint.is_empty()).then(|| readable(&hint)),
        origin: overridden.map_or_else(|| visible(file), |o| readable(&format!("--set {o}"))),
        excerpt: bytes.map(|bytes| excerpt(source, line, column, bytes)),
    }
}

/// Text of a message, which may contain text of the file.
fn readable(text: &str) -> String {
    shortened(&visible(text), LONGEST_WORDS).into_owned()
}

/// A pointer with long keys shortened.
fn readable_pointer(pointer: &str) -> String {
    let keys = pointer.split('/').map(|key| shortened(key, LONGEST_KEY));
    visible(&keys.collect::<Vec<_>>().join("/"))
}

/// The excerpt of a source line around a fault, and the place of its marks.
fn excerpt(
    source: &Source,
    line: usize,
    column: usize,
    bytes: Range<usize>,
) -> (String, usize, usize) {
    let text: Vec<char> = source.line(line).chars().collect();
    let before = (column - 1).min(text.len());
    let marked = source.slice(bytes);
    // Only the bracket of an object or list is marked, other values up to the end of the line.
    let width = match marked.chars().next() {
        Some('{' | '[') | None => 1,
        _ => marked.chars().count(),
    };
    let indent = text
        .iter()
        .take_while(|c| c.is_whitespace())
        .count()
        .min(before);
    let start = if before - indent > EXCERPT * 2 / 3 {
        before - EXCERPT / 3
    } else {
        indent
    };
    let end = (start + EXCERPT).min(text.len());
    let mut shown = String::new();
    let mut shift = 0;
    if start > indent {
        shown.push('…');
        shift = 1;
    }
    shown.extend(text[start..end].iter().map(|&c| match c {
        '\t' => ' ',
        // Each character is replaced by one character, so the marks keep their place.
        c if visible(c.encode_utf8(&mut [0; 4])).len() > c.len_utf8() => '\u{fffd}',
        c => c,
    }));
    if end < text.len() {
        shown.push('…');
    }
    let width = width.min((end.max(before + 1)) - before).max(1);
    (shown, before - start + shift, width)
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.origin)?;
        if self.line > 0 {
            write!(f, ":{}:{}", self.line, self.column)?;
        }
        if !self.path.is_empty() {
            write!(f, "  {}", readable_pointer(&self.path))?;
        }
        let number = self.line.to_string();
        match &self.excerpt {
            Some((text, before, width)) => {
                write!(f, "\n  {number} | {}", text.trim_end())?;
                let margin = " ".repeat(number.len());
                let (before, marks) = (" ".repeat(*before), "^".repeat(*width));
                write!(f, "\n  {margin} | {before}{marks} ")?;
            }
            None => write!(f, "\n  ")?,
        }
        write!(f, "found {}, expected {}", self.found, self.expected)?;
        match &self.hint {
            Some(hint) => write!(f, "; {hint}"),
            None => Ok(()),
        }
    }
}

/// Most faults that are told at once: a generated file may have thousands of a kind.
const TOLD: usize = 40;

impl fmt::Display for Faults {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (k, fault) in self.list.iter().take(TOLD).enumerate() {
            if k > 0 {
                writeln!(f)?;
            }
            write!(f, "{fault}")?;
        }
        match self.list.len().saturating_sub(TOLD) {
            0 => Ok(()),
            more => write!(f, "\n… and {more} more faults"),
        }
    }
}
