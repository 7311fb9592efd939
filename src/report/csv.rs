//! Comma separated values (RFC 4180): quoting and its inverse.

use std::fmt::Write;

/// Appends one record, quoted where needed, ended by a line feed.
pub(super) fn write_record<'a>(out: &mut String, fields: impl Iterator<Item = &'a str>) {
    for (i, field) in fields.enumerate() {
        if i > 0 {
            out.push(',');
        }
        if field.contains([',', '"', '\n', '\r']) {
            out.push('"');
            out.push_str(&field.replace('"', "\"\""));
            out.push('"');
        } else {
            out.push_str(field);
        }
    }
    out.push('\n');
}

/// A table with a heading for each column. Numbers read back exactly; an entry that is not finite
/// is empty.
pub fn csv_table(header: &[String], rows: impl Iterator<Item = Vec<f64>>) -> String {
    let mut text = String::new();
    write_record(&mut text, header.iter().map(String::as_str));
    for row in rows {
        for (i, x) in row.iter().enumerate() {
            if i > 0 {
                text.push(',');
            }
            if x.is_finite() {
                let _ = write!(text, "{x}");
            }
        }
        text.push('\n');
    }
    text
}

/// One record and the line where it starts, counted from one.
#[derive(Debug, PartialEq)]
pub(super) struct Record {
    pub line: usize,
    pub fields: Vec<String>,
}

/// A quote that is never closed, or text after a closing quote, at the given line.
#[derive(Debug, PartialEq)]
pub(super) struct BadQuote {
    pub line: usize,
}

/// Splits a text into records. Lines end with a line feed, with or without a carriage return;
/// empty lines are skipped.
pub(super) fn parse(text: &str) -> Result<Vec<Record>, BadQuote> {
    let mut records = Vec::new();
    let mut chars = text.chars().peekable();
    let mut line = 1;
    while chars.peek().is_some() {
        let start = line;
        let mut fields = Vec::new();
        let mut more = true;
        while more {
            let mut field = String::new();
            if chars.next_if_eq(&'"').is_some() {
                loop {
                    match chars.next() {
                        Some('"') if chars.next_if_eq(&'"').is_some() => field.push('"'),
                        Some('"') => break,
                        Some(c) => {
                            line += usize::from(c == '\n');
                            field.push(c);
                        }
                        None => return Err(BadQuote { line: start }),
                    }
                }
                if chars.peek().is_some_and(|c| ![',', '\n', '\r'].contains(c)) {
                    return Err(BadQuote { line });
                }
            } else {
                while let Some(c) = chars.next_if(|c| ![',', '\n', '\r'].contains(c)) {
                    field.push(c);
                }
            }
            fields.push(field);
            more = chars.next_if_eq(&',').is_some();
        }
        chars.next_if_eq(&'\r');
        if chars.next_if_eq(&'\n').is_some() {
            line += 1;
        }
        if fields != [""] {
            records.push(Record {
                line: start,
                fields,
            });
        }
    }
    Ok(records)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn awkward_fields_survive() {
        let rows = [
            vec!["a", "", "with, comma"],
            vec!["\"quoted\"", "two\nlines", "cr\r"],
        ];
        let mut text = String::new();
        for row in &rows {
            write_record(&mut text, row.iter().copied());
        }
        let back = parse(&text).expect("is valid");
        assert_eq!(back[0].fields, rows[0]);
        assert_eq!(back[1].fields, rows[1]);
        assert_eq!(back[1].line, 2);
    }

    #[test]
    fn carriage_returns_and_a_missing_last_line_end_are_accepted() {
        let back = parse("a,b\r\n\r\n1,\"2\"").expect("is valid");
        assert_eq!(back.len(), 2);
        assert_eq!(back[1].fields, ["1", "2"]);
        assert_eq!(back[1].line, 3);
    }

    #[test]
    fn bad_quotes_are_refused_with_their_line() {
        assert_eq!(parse("a\n\"open"), Err(BadQuote { line: 2 }));
        assert_eq!(parse("\"a\"b\n"), Err(BadQuote { line: 1 }));
    }
}
