//! The table of the nodes of a body.

use super::text::{TextFault, Word, bytes, lines, number, quoted, whole, words};
use crate::math::Vec3;
use std::collections::HashMap;

/// Lines that begin with one of these are comments.
const COMMENTS: [char; 3] = ['#', '%', '$'];

/// The nodes of a body.
#[derive(Clone, Debug, Default)]
pub(super) struct NodeTable {
    /// Their numbers.
    pub numbers: Vec<u64>,
    /// Their positions, in the unit of the file.
    pub places: Vec<Vec3<f64>>,
    /// The components of their unknowns, if the table says them.
    pub components: Option<Vec<[bool; 6]>>,
    /// Index of each number.
    pub index: HashMap<u64, usize>,
}

/// Reads a table: number, x, y, z and perhaps components in each line.
pub(super) fn read(text: &str) -> Result<NodeTable, TextFault> {
    let mut table = NodeTable::default();
    let mut components = Vec::new();
    for (start, line) in lines(text) {
        let all: Vec<Word> = words(start, line, ',').collect();
        let Some(first) = all.first() else { continue };
        if first.1.starts_with(COMMENTS) {
            continue;
        }
        let expected = "a node: its number, x, y, z, and perhaps its components such as 123456";
        if !(4..=5).contains(&all.len()) {
            let at = start..start + line.len();
            let found = format!("{} entries", all.len());
            return Err(TextFault::new(at, found, expected));
        }
        let id = whole(first, 1, "the number of a node, 1 or more")?;
        if table.index.insert(id, table.numbers.len()).is_some() {
            let found = format!("node {id} a second time");
            return Err(TextFault::new(bytes(first), found, "each node once"));
        }
        let [x, y, z] = [number(&all[1])?, number(&all[2])?, number(&all[3])?];
        table.numbers.push(id);
        table.places.push(Vec3::new(x, y, z));
        if let Some(word) = all.get(4) {
            components.push(digits(word)?);
        }
        if !components.is_empty() && components.len() != table.numbers.len() {
            let at = start..start + line.len();
            let found = "components of some nodes";
            return Err(TextFault::new(at, found, "those of all nodes, or of none"));
        }
    }
    if table.numbers.is_empty() {
        let expected = "at least one node: its number, x, y, z";
        return Err(TextFault::new(0..text.len().min(1), "no node", expected));
    }
    table.components = (!components.is_empty()).then_some(components);
    Ok(table)
}

fn digits(word: &Word) -> Result<[bool; 6], TextFault> {
    let mut all = [false; 6];
    for digit in word.1.chars() {
        let k = digit.to_digit(10).filter(|k| (1..=6).contains(k));
        match k {
            Some(k) if !all[k as usize - 1] => all[k as usize - 1] = true,
            _ => {
                let expected = "components: digits from 1 to 6, each once";
                return Err(TextFault::new(bytes(word), quoted(word.1), expected));
            }
        }
    }
    Ok(all)
}

impl NodeTable {
    /// The keys 6 × node + component of the rows of a matrix of this order; none if it does not suit.
    pub(super) fn rows(&self, order: usize) -> Option<Vec<usize>> {
        let nodes = self.numbers.len();
        let of = |k: &dyn Fn(usize) -> [bool; 6]| -> Vec<usize> {
            let keys = |node: usize| {
                let there = k(node);
                (0..6).filter(move |c| there[*c]).map(move |c| 6 * node + c)
            };
            (0..nodes).flat_map(keys).collect()
        };
        let all = match &self.components {
            Some(components) => of(&|node| components[node]),
            None if order == 6 * nodes => of(&|_| [true; 6]),
            None => of(&|_| [true, true, true, false, false, false]),
        };
        (all.len() == order).then_some(all)
    }

    /// Orders of a matrix that suit the table, in words.
    pub(super) fn orders(&self) -> String {
        let nodes = self.numbers.len();
        match &self.components {
            Some(components) => {
                let count = components.iter().flatten().filter(|there| **there).count();
                format!("{count}, the components of {nodes} nodes")
            }
            None => format!(
                "{} or {}, three or six for each of {nodes} nodes",
                3 * nodes,
                6 * nodes
            ),
        }
    }
}
