//! Entries of a symmetric matrix from those of a file.

use super::text::{TextFault, words};
use crate::structures::modal::free_body::COMPONENTS;
use crate::structures::modal::written::WrittenMatrix;
use std::collections::HashMap;

/// A number is rounded if it is shorter than the longest of its file by at most these characters: a
/// sign, and a digit of the exponent. A shorter one had room for more digits and is exact.
const SHORTER: usize = 2;

/// Difference of two entries that should be equal, relative to the entries on the diagonal.
const EQUAL: f64 = 1e-9;

/// Which entries a file gives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Given {
    /// Each pair once.
    Lower,
    /// Both halves.
    Both,
}

/// An entry with its place in the file.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    /// Keys of its row and column.
    pub row: usize,
    pub column: usize,
    pub value: f64,
    /// Largest change by rounding, and number of characters.
    pub rounding: f64,
    pub length: usize,
    /// Byte at which it begins.
    pub at: usize,
}

/// Each pair of keys once. Both halves of a matrix may differ by rounding.
pub(super) fn symmetric(
    mut places: Vec<Place>,
    given: Given,
    text: &str,
) -> Result<WrittenMatrix, TextFault> {
    let pair = |p: &Place| (p.row.max(p.column), p.row.min(p.column));
    places.sort_by_key(|p| (pair(p), p.row < p.column, p.at));
    let here = |p: &Place| {
        let word = words(p.at, text[p.at..].lines().next().unwrap_or(""), ' ').next();
        p.at..p.at + word.map_or(1, |word| word.1.len())
    };
    let second = |p: &Place| {
        let fault = TextFault::new(here(p), "this entry a second time", "each entry once");
        fault.hint("add the values of equal rows and columns")
    };
    let diagonal: HashMap<usize, f64> = (places.iter())
        .filter(|p| p.row == p.column)
        .map(|p| (p.row, p.value.abs()))
        .collect();
    let mut matrix = WrittenMatrix {
        entries: Vec::with_capacity(places.len()),
        rounding: Vec::with_capacity(places.len()),
    };
    let longest = places.iter().map(|p| p.length).max().unwrap_or(0);
    for place in &mut places {
        if place.length + SHORTER < longest {
            place.rounding = 0.0;
        }
    }
    let mut k = 0;
    while k < places.len() {
        let first = places[k];
        let group = places[k..].iter().take_while(|p| pair(p) == pair(&first));
        let group: Vec<&Place> = group.collect();
        k += group.len();
        let value = match (given, &group[..]) {
            (_, [_]) if first.row == first.column => first.value,
            (Given::Lower, [_]) => first.value,
            (Given::Both, [one]) if one.value == 0.0 => 0.0,
            (Given::Both, [a, b]) if a.row != b.row => {
                let size = |key: usize| diagonal.get(&key).copied().unwrap_or(0.0);
                let size = (size(a.row) * size(a.column)).sqrt();
                let most = EQUAL * size.max(a.value.abs()).max(b.value.abs());
                let most = most + a.rounding + b.rounding;
                if (a.value - b.value).abs() > most {
                    return Err(unequal(here(b), (b, b.value), a.value));
                }
                0.5 * (a.value + b.value)
            }
            (Given::Both, [one]) => return Err(unequal(here(one), (one, one.value), 0.0)),
            (_, all) => return Err(second(all[all.len() - 1])),
        };
        let rounding = group.iter().fold(0.0, |m: f64, p| m.max(p.rounding));
        matrix.entries.push((first.row, first.column, value));
        matrix.rounding.push(rounding);
    }
    Ok(matrix)
}

fn unequal(at: std::ops::Range<usize>, (place, value): (&Place, f64), other: f64) -> TextFault {
    let found = format!("{value:e}, and {other:e} with row and column exchanged");
    let [row, column] = [place.row, place.column].map(|key| COMPONENTS[key % 6]);
    let fault = TextFault::new(at, found, "a symmetric matrix");
    fault.hint(&format!("it joins {row} and {column}"))
}
