//! Symmetric matrices in the coordinate format of Matrix Market (Boisvert, Pozo & Remington 1996, *The Matrix
//! Market Exchange Formats*, NISTIR 5935).

use super::nodes::NodeTable;
use super::symmetry::{Given, Place, symmetric};
use super::text::{TextFault, Word, bytes, lines, number, quoted, rounding, whole, words};
use crate::structures::modal::written::WrittenMatrix;

const HEADER: &str = "%%MatrixMarket matrix coordinate real symmetric";

/// Reads a matrix whose rows are the unknowns of the nodes.
pub(super) fn read(text: &str, nodes: &NodeTable) -> Result<WrittenMatrix, TextFault> {
    let mut all = lines(text);
    let (start, header) = all.next().unwrap_or((0, ""));
    let given = header_of(start, header)?;
    let mut size: Option<(Vec<usize>, usize)> = None;
    let mut places: Vec<Place> = Vec::new();
    for (start, line) in all {
        let mut found = words(start, line, ' ');
        let Some(first) = found.next() else { continue };
        if first.1.starts_with('%') {
            continue;
        }
        let mut three = || -> Result<[Word; 3], TextFault> {
            let (second, third) = (found.next(), found.next());
            match (second, third, found.next()) {
                (Some(second), Some(third), None) => Ok([first, second, third]),
                _ => {
                    let at = start..start + line.len();
                    let count = words(start, line, ' ').count();
                    let expected = match size.is_some() {
                        true => "row, column and value",
                        false => "numbers of rows, columns and entries",
                    };
                    Err(TextFault::new(at, format!("{count} entries"), expected))
                }
            }
        };
        let [a, b, c] = three()?;
        let Some((rows, entries)) = &size else {
            let order = whole(&a, 1, "a number of rows, 1 or more")?;
            let columns = whole(&b, 1, "a number of columns, 1 or more")?;
            let entries = whole(&c, 0, "a number of entries")?;
            if columns != order {
                let found = format!("{order} rows and {columns} columns");
                return Err(TextFault::new(bytes(&b), found, "a square matrix"));
            }
            let rows = usize::try_from(order)
                .ok()
                .and_then(|order| nodes.rows(order));
            let Some(rows) = rows else {
                let found = format!("{order} rows");
                return Err(TextFault::new(bytes(&a), found, nodes.orders()));
            };
            let entries = usize::try_from(entries).unwrap_or(usize::MAX);
            // The file is not longer than its entries: four bytes each at least.
            places.reserve(entries.min(text.len() / 4));
            size = Some((rows, entries));
            continue;
        };
        if places.len() == *entries {
            let found = format!("an entry beyond the {entries} that the file announces");
            let at = start..start + line.len();
            return Err(TextFault::new(at, found, "the end of the file"));
        }
        let index = |word: &Word, what: &str| {
            let expected = format!("a {what} from 1 to {}", rows.len());
            let i = whole(word, 1, &expected)?;
            match usize::try_from(i - 1).ok().filter(|i| *i < rows.len()) {
                Some(i) => Ok(i),
                None => Err(TextFault::new(bytes(word), i.to_string(), expected)),
            }
        };
        let (i, j) = (index(&a, "row")?, index(&b, "column")?);
        if given == Given::Lower && i < j {
            let found = format!("row {} above the diagonal, column {}", i + 1, j + 1);
            let fault = TextFault::new(bytes(&a), found, "an entry on or below the diagonal");
            let hint = "a symmetric file has only these; write \"general\" if both parts are given";
            return Err(fault.hint(hint));
        }
        places.push(Place {
            row: rows[i],
            column: rows[j],
            value: number(&c)?,
            rounding: rounding(&c),
            length: c.1.len(),
            at: a.0,
        });
    }
    let end = text.len().saturating_sub(1)..text.len();
    match size {
        None => Err(TextFault::new(
            end,
            "no size of the matrix",
            "numbers of rows, columns and entries",
        )),
        Some((_, entries)) if places.len() < entries => {
            let found = format!("{} entries", places.len());
            let expected = format!("the {entries} that the file announces");
            Err(TextFault::new(end, found, expected))
        }
        Some(_) => symmetric(places, given, text),
    }
}

fn header_of(start: usize, line: &str) -> Result<Given, TextFault> {
    let found: Vec<Word> = words(start, line, ' ').collect();
    let wanted: [&[&str]; 5] = [
        &["%%matrixmarket"],
        &["matrix"],
        &["coordinate"],
        &["real", "integer", "double"],
        &["symmetric", "general"],
    ];
    if found.len() != wanted.len() {
        let at = start..start + line.len();
        let expected = format!("a header as {HEADER}");
        return Err(TextFault::new(at, quoted(line), expected));
    }
    for (word, wanted) in found.iter().zip(wanted) {
        if !wanted.contains(&word.1.to_lowercase().as_str()) {
            let expected = format!("{} in a header as {HEADER}", wanted.join(" or "));
            return Err(TextFault::new(bytes(word), quoted(word.1), expected));
        }
    }
    match found[4].1.to_lowercase().as_str() {
        "symmetric" => Ok(Given::Lower),
        _ => Ok(Given::Both),
    }
}
