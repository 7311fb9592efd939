//! The text of a problem file, with the places of its keys and values.

use super::origins::Origins;
use super::pointer::join;
use std::collections::HashMap;
use std::ops::Range;

/// A valid JSON text with the places of its keys and values.
#[derive(Clone, Debug, Default)]
pub struct Source {
    text: String,
    spans: HashMap<String, Span>,
    /// Keys that occur twice in an object.
    pub duplicates: Vec<Duplicate>,
    /// Where the entries of a written-out document come from.
    pub origins: Origins,
    /// Texts of other files: the pointer where their content stands, their name, and the text.
    pub files: Vec<(String, String, Source)>,
}

/// A key that occurs twice in an object.
#[derive(Clone, Debug, PartialEq)]
pub struct Duplicate {
    /// Pointer to the entry.
    pub pointer: String,
    /// The key.
    pub key: String,
    /// Bytes of the second key.
    pub bytes: Range<usize>,
    /// Line of the first key.
    pub first_line: usize,
}

/// Bytes of an entry.
#[derive(Clone, Debug)]
struct Span {
    key: Option<Range<usize>>,
    value: Range<usize>,
}

impl Source {
    /// A text without an index: it gives only the places of bytes.
    pub fn plain(text: &str) -> Self {
        Self {
            text: text.to_owned(),
            ..Self::default()
        }
    }

    /// Indexes a text that is valid JSON.
    pub fn index(text: &str) -> Self {
        let mut scanner = Scanner {
            source: Self::plain(text),
            at: 0,
        };
        scanner.value("", None);
        scanner.source
    }

    /// Line and column (in characters) of a byte, both from 1.
    pub fn place(&self, byte: usize) -> (usize, usize) {
        let before = &self.text[..byte.min(self.text.len())];
        let line = before.matches('\n').count() + 1;
        let start = before.rfind('\n').map_or(0, |newline| newline + 1);
        (line, before[start..].chars().count() + 1)
    }

    /// A line of the text, from 1.
    pub fn line(&self, line: usize) -> &str {
        self.text.lines().nth(line.saturating_sub(1)).unwrap_or("")
    }

    /// The first line of a part of the text.
    pub fn slice(&self, bytes: Range<usize>) -> &str {
        let piece = self.text.get(bytes).unwrap_or("");
        piece.lines().next().unwrap_or("")
    }

    /// The text that has the entry of a document, with its name if it is another file, and the pointer there.
    pub fn holding(&self, pointer: &str) -> (Option<&str>, &Self, String) {
        let own = self.origins.resolve(pointer);
        let mut files = self.files.iter();
        let other = files.find_map(|(at, name, source)| {
            let below = own.strip_prefix(at.as_str())?;
            let inside = below.is_empty() || below.starts_with('/');
            inside.then(|| (Some(name.as_str()), source, below.to_owned()))
        });
        other.unwrap_or((None, self, own))
    }

    /// Bytes of the key at a pointer; of the value if it is an item of a list.
    pub fn key(&self, pointer: &str) -> Option<Range<usize>> {
        let (_, source, pointer) = self.holding(pointer);
        let span = source.span(&pointer)?;
        Some(span.key.clone().unwrap_or_else(|| span.value.clone()))
    }

    /// Bytes of the value at a pointer.
    pub fn value(&self, pointer: &str) -> Option<Range<usize>> {
        let (_, source, pointer) = self.holding(pointer);
        source.span(&pointer).map(|span| span.value.clone())
    }

    /// The entry at a pointer, or the nearest one above it.
    fn span(&self, pointer: &str) -> Option<&Span> {
        let mut pointer = pointer;
        loop {
            if let Some(span) = self.spans.get(pointer) {
                return Some(span);
            }
            pointer = pointer.rsplit_once('/')?.0;
        }
    }
}

/// Scans a valid text. The parser that accepted it has limited its depth.
struct Scanner {
    source: Source,
    at: usize,
}

impl Scanner {
    fn peek(&self) -> u8 {
        *self.source.text.as_bytes().get(self.at).unwrap_or(&0)
    }

    fn skip_space(&mut self) {
        while self.peek().is_ascii_whitespace() {
            self.at += 1;
        }
    }

    /// Skips white space, and the next byte if it is this mark: `{ } [ ] , :`. Returns whether it
    /// is.
    fn take(&mut self, mark: u8) -> bool {
        self.skip_space();
        let found = self.peek() == mark;
        self.at += usize::from(found);
        found
    }

    /// Skips a string and returns its bytes, including the quotes.
    fn string(&mut self) -> Range<usize> {
        self.skip_space();
        let start = self.at;
        self.at += 1;
        while self.at < self.source.text.len() && self.peek() != b'"' {
            self.at += if self.peek() == b'\\' { 2 } else { 1 };
        }
        self.at += 1;
        start..self.at
    }

    fn value(&mut self, pointer: &str, key: Option<Range<usize>>) {
        self.skip_space();
        let start = self.at;
        match self.peek() {
            b'{' => self.object(pointer),
            b'[' => self.list(pointer),
            b'"' => {
                self.string();
            }
            _ => {
                let ends = |c: u8| c.is_ascii_whitespace() || b",]}\0".contains(&c);
                while !ends(self.peek()) {
                    self.at += 1;
                }
            }
        }
        let value = start..self.at;
        self.source
            .spans
            .insert(pointer.to_owned(), Span { key, value });
    }

    fn object(&mut self, pointer: &str) {
        self.take(b'{');
        let mut seen: HashMap<String, usize> = HashMap::new();
        while !self.take(b'}') {
            let bytes = self.string();
            let key: String = serde_json::from_str(&self.source.text[bytes.clone()])
                .expect("a key of valid JSON is a string");
            let inner = join(pointer, &key);
            match seen.get(&key) {
                Some(&first) => self.source.duplicates.push(Duplicate {
                    pointer: inner.clone(),
                    key,
                    bytes: bytes.clone(),
                    first_line: self.source.place(first).0,
                }),
                None => {
                    seen.insert(key, bytes.start);
                }
            }
            self.take(b':');
            self.value(&inner, Some(bytes));
            self.take(b',');
        }
    }

    fn list(&mut self, pointer: &str) {
        self.take(b'[');
        let mut count = 0;
        while !self.take(b']') {
            self.value(&join(pointer, count), None);
            self.take(b',');
            count += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_and_values_are_found() {
        let text = "{\n  \"a\": [1, {\"b/c\": \"x\\\"y\"}],\n  \"é\": -2e3, \"a\": 0 }";
        let source = Source::index(text);
        let at = |range: Option<Range<usize>>| &text[range.expect("an entry")];
        assert_eq!(at(source.value("/a/1/b~1c")), "\"x\\\"y\"");
        assert_eq!(at(source.key("/a/1/b~1c")), "\"b/c\"");
        assert_eq!(at(source.value("/é")), "-2e3");
        assert_eq!(
            source.place(source.value("/é").expect("an entry").start),
            (3, 8)
        );
        assert_eq!(at(source.value("/é/lost")), "-2e3");
        assert_eq!(source.duplicates.len(), 1);
        assert_eq!(source.duplicates[0].pointer, "/a");
        assert_eq!(source.duplicates[0].first_line, 2);
    }
}
