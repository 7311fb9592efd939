//! Symmetric matrices as DMIG entries of bulk data (MSC Nastran Quick Reference Guide, DMIG): small fields of 8
//! characters, or large ones of 16 behind `DMIG*`, as punch files have them.
//!
//! The header has the form (6 symmetric, 1 square) and the type (1, 2 real). A column names node and component
//! of the column, and then groups of node, component and value.

use super::nodes::NodeTable;
use super::symmetry::{Given, Place, symmetric};
use super::text::{TextFault, Word, bytes, lines, number, quoted, rounding, whole};
use crate::structures::modal::written::WrittenMatrix;

/// Characters of the first field of a line.
const FIRST: usize = 8;

/// A card: its fields behind the name, each line filled up.
struct Card<'a> {
    start: usize,
    fields: Vec<Word<'a>>,
}

impl<'a> Card<'a> {
    fn field(&self, k: usize) -> Word<'a> {
        self.fields.get(k).copied().unwrap_or((self.start, ""))
    }

    fn begin(&self) -> std::ops::Range<usize> {
        self.start..self.start + 4
    }
}

/// A matrix while it is read.
struct Matrix<'a> {
    name: &'a str,
    given: Option<Given>,
    places: Vec<Place>,
}

/// Reads the matrices of these names: stiffness and mass.
pub(super) fn read(
    text: &str,
    nodes: &NodeTable,
    names: [&str; 2],
) -> Result<[WrittenMatrix; 2], TextFault> {
    let mut matrices = names.map(|name| Matrix {
        name,
        given: None,
        places: Vec::new(),
    });
    for card in cards(text)? {
        let name = card.field(0);
        let Some(matrix) = (matrices.iter_mut()).find(|m| m.name.eq_ignore_ascii_case(name.1))
        else {
            continue;
        };
        if card.field(1).1 == "0" {
            if matrix.given.is_some() {
                let found = format!("the header of {} a second time", name.1);
                return Err(TextFault::new(card.begin(), found, "each matrix once"));
            }
            matrix.given = Some(header(&card)?);
        } else if matrix.given.is_none() {
            let found = format!("a column of {} before its header", name.1);
            let expected = format!("DMIG, {}, 0, form, type", name.1);
            return Err(TextFault::new(card.begin(), found, expected));
        } else {
            column(&card, nodes, &mut matrix.places)?;
        }
    }
    let [k, m] = matrices;
    let entries = |matrix: Matrix| match matrix.given {
        Some(given) => symmetric(matrix.places, given, text),
        None => {
            let at = text.len().saturating_sub(1)..text.len();
            let found = format!("no matrix {}", matrix.name);
            let fault = TextFault::new(at, found, "DMIG entries of this name");
            Err(fault.hint("\"stiffness\" and \"mass\" say the names of the matrices"))
        }
    };
    Ok([entries(k)?, entries(m)?])
}

/// The fields of a line: four of 16 characters or eight of 8.
fn fields(start: usize, line: &str, large: bool) -> Vec<Word<'_>> {
    let (width, count) = if large { (16, 4) } else { (8, 8) };
    let field = |k: usize| {
        let from = (FIRST + k * width).min(line.len());
        let text = &line[from..(from + width).min(line.len())];
        let trimmed = text.trim_start();
        (
            start + from + text.len() - trimmed.len(),
            trimmed.trim_end(),
        )
    };
    (0..count).map(field).collect()
}

fn cards(text: &str) -> Result<Vec<Card<'_>>, TextFault> {
    let mut all: Vec<Card> = Vec::new();
    let mut open = false;
    for (start, line) in lines(text) {
        let whole_line = start..start + line.len();
        if line.trim().is_empty() || line.starts_with('$') {
            continue;
        }
        if !line.is_ascii() {
            let expected = "DMIG entries in plain characters";
            return Err(TextFault::new(whole_line, quoted(line), expected));
        }
        let head = line[..FIRST.min(line.len())].trim_end();
        match head.to_ascii_uppercase().as_str() {
            _ if line.contains(',') => {
                let fault = TextFault::new(whole_line, "a comma", "fields of 8 or 16 characters");
                return Err(fault.hint("free fields are not read"));
            }
            "DMIG" | "DMIG*" => {
                let fields = fields(start, line, head.ends_with('*'));
                all.push(Card { start, fields });
                open = true;
            }
            "ENDDATA" => break,
            _ if head.is_empty() || head.starts_with(['*', '+']) => {
                let Some(card) = all.last_mut().filter(|_| open) else {
                    let found = "a continuation without a DMIG entry";
                    return Err(TextFault::new(whole_line, found, "a DMIG entry before it"));
                };
                card.fields
                    .extend(fields(start, line, head.starts_with('*')));
            }
            _ => {
                let expected = "DMIG entries, their continuations, and comments behind $";
                return Err(TextFault::new(
                    start..start + head.len(),
                    quoted(head),
                    expected,
                ));
            }
        }
    }
    Ok(all)
}

fn header(card: &Card) -> Result<Given, TextFault> {
    let form = card.field(2);
    let given = match form.1 {
        "6" => Given::Lower,
        "1" => Given::Both,
        _ => {
            let expected = "the form 6 (symmetric) or 1 (square)";
            return Err(TextFault::new(bytes(&form), quoted(form.1), expected));
        }
    };
    let kind = card.field(3);
    match kind.1 {
        "1" | "2" => Ok(given),
        _ => {
            let expected = "the type 1 or 2 (real)";
            Err(TextFault::new(bytes(&kind), quoted(kind.1), expected))
        }
    }
}

fn key(nodes: &NodeTable, node: &Word, component: &Word) -> Result<usize, TextFault> {
    let id = whole(node, 1, "the number of a node")?;
    let Some(index) = nodes.index.get(&id) else {
        let expected = "a node of the table of nodes";
        return Err(TextFault::new(bytes(node), format!("node {id}"), expected));
    };
    match component.1 {
        "1" | "2" | "3" | "4" | "5" | "6" => {
            let component = component.1.as_bytes()[0] - b'1';
            Ok(6 * index + usize::from(component))
        }
        "0" | "" => {
            let found = format!("the scalar point {id}");
            let fault = TextFault::new(bytes(node), found, "a node with a component from 1 to 6");
            Err(fault.hint("give the matrices before their reduction, which is done here"))
        }
        other => {
            let expected = "a component from 1 to 6";
            Err(TextFault::new(bytes(component), quoted(other), expected))
        }
    }
}

fn column(card: &Card, nodes: &NodeTable, places: &mut Vec<Place>) -> Result<(), TextFault> {
    let column = key(nodes, &card.field(1), &card.field(2))?;
    let mut groups = 0;
    for group in card.fields[4.min(card.fields.len())..].chunks(4) {
        let [node, component, value, imaginary] = [0, 1, 2, 3].map(|k| {
            let last = group.last().copied().unwrap_or((card.start, ""));
            group.get(k).copied().unwrap_or((last.0, ""))
        });
        if [node, component, value, imaginary]
            .iter()
            .all(|w| w.1.is_empty())
        {
            continue;
        }
        if !imaginary.1.is_empty() && number(&imaginary)? != 0.0 {
            let found = format!("the imaginary part {}", imaginary.1);
            return Err(TextFault::new(bytes(&imaginary), found, "a real matrix"));
        }
        places.push(Place {
            row: key(nodes, &node, &component)?,
            column,
            value: number(&value)?,
            rounding: rounding(&value),
            length: value.1.trim().len(),
            at: node.0,
        });
        groups += 1;
    }
    if groups == 0 {
        let expected = "node, component and value of at least one entry";
        return Err(TextFault::new(
            card.begin(),
            "a column without entries",
            expected,
        ));
    }
    Ok(())
}
