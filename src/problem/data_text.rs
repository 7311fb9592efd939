//! Texts of data files: their words with places, and their faults.

use std::ops::Range;

/// A fault at a place of a data file.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct TextFault {
    /// Bytes of the file.
    pub at: Range<usize>,
    pub found: String,
    pub expected: String,
    pub hint: Option<String>,
}

impl TextFault {
    pub(crate) fn new(
        at: Range<usize>,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) -> Self {
        Self {
            at,
            found: found.into(),
            expected: expected.into(),
            hint: None,
        }
    }

    pub(crate) fn hint(self, hint: &str) -> Self {
        Self {
            hint: Some(hint.to_owned()),
            ..self
        }
    }
}

/// A word and the byte at which it begins.
pub(crate) type Word<'a> = (usize, &'a str);

/// The bytes of a word.
pub(crate) fn bytes((at, text): &Word) -> Range<usize> {
    *at..at + text.len()
}

/// The lines of a text and where they begin, without their ends.
pub(crate) fn lines(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let mut at = 0;
    text.split_inclusive('\n').map(move |line| {
        let start = at;
        at += line.len();
        (start, line.trim_end_matches(['\n', '\r']))
    })
}

/// The words of a line that begins at a byte; separators beside white space are those of `also`.
pub(crate) fn words<'a>(start: usize, line: &'a str, also: char) -> impl Iterator<Item = Word<'a>> {
    let ends = move |c: char| c.is_ascii_whitespace() || c == also;
    let mut at = 0;
    std::iter::from_fn(move || {
        let rest = &line[at..];
        let first = rest.find(|c| !ends(c))?;
        let word = &rest[first..];
        let word = &word[..word.find(ends).unwrap_or(word.len())];
        let place = start + at + first;
        at += first + word.len();
        Some((place, word))
    })
}

/// A finite number; the exponent may be written as by Fortran: 1.5D+03, 1.5+3.
pub(crate) fn number(word: &Word) -> Result<f64, TextFault> {
    let text = word.1.trim();
    let plain = text.parse::<f64>().ok();
    let found = plain.or_else(|| fortran(text));
    match found {
        // "nan" and "infinity" are no numbers here.
        Some(x) if x.is_finite() && !text.contains(['n', 'N']) => Ok(x),
        _ => Err(TextFault::new(bytes(word), quoted(text), "a finite number")),
    }
}

/// Half a unit of the last digit of a written number: the largest change by rounding. A whole
/// number without point and exponent is exact.
pub(crate) fn rounding(word: &Word) -> f64 {
    let text = word.1.trim().trim_start_matches(['+', '-']);
    let mantissa = text
        .find(|c: char| !c.is_ascii_digit() && c != '.')
        .map_or(text, |end| &text[..end]);
    let decimals = mantissa
        .find('.')
        .map_or(0, |point| mantissa.len() - point - 1);
    if mantissa.len() == text.len() && !text.contains('.') {
        return 0.0;
    }
    let exponent = text[mantissa.len()..].trim_start_matches(['d', 'D', 'e', 'E']);
    let exponent = exponent.parse::<i32>().unwrap_or(0);
    0.5 * 10.0_f64.powi(exponent.saturating_sub(i32::try_from(decimals).unwrap_or(0)))
}

fn fortran(text: &str) -> Option<f64> {
    let mut written = String::with_capacity(text.len() + 1);
    let mut last = ' ';
    let mut exponent = false;
    for c in text.chars() {
        match c {
            'd' | 'D' | 'e' | 'E' => {
                exponent = true;
                written.push('e');
            }
            '+' | '-' if (last.is_ascii_digit() || last == '.') && !exponent => {
                exponent = true;
                written.push('e');
                written.push(c);
            }
            c => written.push(c),
        }
        last = c;
    }
    written.parse().ok()
}

/// A whole number of at least `least`.
pub(crate) fn whole(word: &Word, least: u64, what: &str) -> Result<u64, TextFault> {
    let text = word.1.trim();
    match text.parse::<u64>() {
        Ok(n) if n >= least => Ok(n),
        _ => Err(TextFault::new(bytes(word), quoted(text), what)),
    }
}

/// A word in quotes, shortened.
pub(crate) fn quoted(text: &str) -> String {
    match text.chars().count() {
        0 => "nothing".into(),
        1..=40 => format!("\"{text}\""),
        _ => format!("\"{}…\"", text.chars().take(40).collect::<String>()),
    }
}
