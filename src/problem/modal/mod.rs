//! Bodies from files of other codes: reads their files, reduces their matrices, and describes the
//! result.

mod describe;
mod dmig;
mod matrix_market;
mod nodes;
mod numbers;
mod standard_input;
mod symmetry;

pub(super) use describe::described;
pub(super) use numbers::{numbers, scale, start};

use super::data_file::{DataFault, DataFiles};
use super::data_text as text;
use super::fault::Faults;
use super::finding::Finding;
use super::pointer::join;
use super::source::Source;
use crate::schema::Document;
use crate::schema::modal::{Modal, ModalFrame, Source as Files, Units};
use crate::structures::modal::craig_bampton::reduce;
use crate::structures::modal::free_body::{FreeBody, NoFreeBody};
use crate::structures::modal::interfaces::{Holding, Interface, NoReduction};
use crate::structures::modal::loaded::{Loaded, Reduced};
use crate::structures::modal::written::WrittenMatrix;
use nodes::NodeTable;
use std::sync::Arc;

/// Fixed-interface modes where a file gives no number.
const MODES: u32 = 10;

/// Reads the files of all bodies of a document in this directory. Returns their content as a text
/// for the hash of the problem.
///
/// # Errors
/// The first fault of a file, or of the entries of the document about it.
pub(super) fn load(
    document: &mut Document,
    (file, source): (&str, &Source),
) -> Result<String, Faults> {
    let mut reader = Reader(DataFiles::beside(file));
    for (name, body) in &mut document.bodies {
        let Some(modal) = &mut body.modal else {
            continue;
        };
        let pointer = join(&join("/bodies", name), "modal");
        let loaded = reader.body(&pointer, modal);
        let loaded = loaded.map_err(|fault| fault.located((file, source)))?;
        modal.loaded = loaded.map(Arc::new);
    }
    Ok(reader.0.content)
}

/// Copies the data of the files to the same bodies of `to`.
pub(super) fn share(from: &Document, to: &mut Document) {
    for (from, to) in from.bodies.values().zip(to.bodies.values_mut()) {
        if let (Some(from), Some(to)) = (&from.modal, &mut to.modal) {
            to.loaded.clone_from(&from.loaded);
        }
    }
}

struct Reader<'a>(DataFiles<'a>);

impl Reader<'_> {
    /// A body; none if the document names interfaces that it does not have. That fault is reported
    /// elsewhere.
    fn body(&mut self, pointer: &str, modal: &Modal) -> Result<Option<Loaded>, Box<DataFault>> {
        let source = join(pointer, "source");
        match &modal.source {
            Files::StandardInput(file) => {
                let place = join(&source, "standard_input");
                let body = self.0.read(&place, file, standard_input::read)?;
                Ok(Some(Loaded {
                    body,
                    reduced: None,
                }))
            }
            Files::MatrixMarket {
                nodes,
                stiffness,
                mass,
                units,
            } => {
                let below = join(&source, "matrix_market");
                let table = self.0.read(&join(&below, "nodes"), nodes, nodes::read)?;
                let mut matrix = |key: &str, file: &str| {
                    let place = join(&below, key);
                    self.0
                        .read(&place, file, |text| matrix_market::read(text, &table))
                };
                let pair = [matrix("stiffness", stiffness)?, matrix("mass", mass)?];
                reduced(pointer, modal, &table, pair, units)
            }
            Files::Dmig {
                nodes,
                file,
                stiffness,
                mass,
                units,
            } => {
                let below = join(&source, "dmig");
                let table = self.0.read(&join(&below, "nodes"), nodes, nodes::read)?;
                let names = [
                    stiffness.as_deref().unwrap_or("KAAX"),
                    mass.as_deref().unwrap_or("MAAX"),
                ];
                let place = join(&below, "file");
                let pair = self
                    .0
                    .read(&place, file, |text| dmig::read(text, &table, names))?;
                reduced(pointer, modal, &table, pair, units)
            }
        }
    }
}

/// The body of two matrices, reduced.
fn reduced(
    pointer: &str,
    modal: &Modal,
    table: &NodeTable,
    [mut stiffness, mut mass]: [WrittenMatrix; 2],
    units: &Units,
) -> Result<Option<Loaded>, Box<DataFault>> {
    let at = |place: &str, found: String, expected: &str, hint: Option<&str>| {
        let finding = Finding::new(place, found, expected);
        Box::new(DataFault::Document(finding.hint(hint.map(str::to_owned))))
    };
    let document = |key: &str, found: String, expected: &str, hint: Option<&str>| {
        at(&join(pointer, key), found, expected, hint)
    };
    let Units {
        length,
        mass: kilograms,
        time,
    } = *units;
    // A rotation has no length: its rows are moments, its columns act by angles.
    let factor = |i: usize, j: usize| {
        let rotations = [i, j].iter().filter(|key| **key % 6 >= 3).count();
        kilograms * length.powi(rotations as i32)
    };
    stiffness.scale(|i, j| factor(i, j) / (time * time));
    mass.scale(factor);
    let Some(holding) = holding(modal) else {
        return Ok(None);
    };
    let mut interfaces = Vec::new();
    for (name, written) in &modal.interfaces {
        let place = join(&join(pointer, "interfaces"), name);
        let mut nodes = Vec::new();
        for id in written.list() {
            let Some(&node) = table.index.get(id) else {
                let expected = "the number of a node of the table of nodes";
                return Err(at(&place, format!("node {id}"), expected, None));
            };
            let before = interfaces
                .iter()
                .find(|other: &&Interface| other.nodes.contains(&node));
            if nodes.contains(&node) || before.is_some() {
                let found = format!("node {id} a second time");
                return Err(at(&place, found, "each node in one interface", None));
            }
            nodes.push(node);
        }
        interfaces.push(Interface {
            name: name.clone(),
            nodes,
        });
    }
    let places = table.places.iter().map(|place| place * length).collect();
    let free = FreeBody::written(places, &stiffness, &mass);
    free.check(|node| table.numbers[node].to_string())
        .map_err(|fault| {
            let expected = "stiffness and mass matrix of a free body in space";
            let hint = "write the matrices without supports, in the axes of the table of nodes";
            match fault {
                NoFreeBody::Indefinite { .. } => {
                    let (key, file) = mass_file(&modal.source);
                    let found = format!("in {file} {fault}");
                    let expected = "a mass matrix without negative masses";
                    at(&format!("{pointer}/{key}"), found, expected, None)
                }
                fault => document("source", fault.to_string(), expected, Some(hint)),
            }
        })?;
    let modes = modal.modes.unwrap_or(MODES) as usize;
    let reduction = reduce(&free, &interfaces, &holding, modes).map_err(|failure| {
        let found = failure.to_string();
        let hold = "interfaces that hold the axes: one that moves and turns, or three points";
        match &failure {
            NoReduction::Interior(_) => document(
                "source",
                found,
                "a body that is held where its interfaces are",
                None,
            ),
            NoReduction::Digits { .. } => {
                let hint = "large fields of DMIG have 16 characters, Matrix Market has no limit";
                let expected = "numbers with more digits";
                document("source", found, expected, Some(hint))
            }
            NoReduction::Loose | NoReduction::Collinear => document("frame", found, hold, None),
            NoReduction::Without { .. } => {
                let hint = "several nodes in one interface move and turn as one rigid body";
                let expected = "an interface that moves and turns in all directions";
                document("interfaces", found, expected, Some(hint))
            }
            NoReduction::OnALine { .. } => {
                document("interfaces", found, "nodes that are not in one line", None)
            }
            NoReduction::NoConvergence { .. } => {
                document("modes", found, "another number of modes", None)
            }
            NoReduction::Nothing => {
                document("modes", found, "more modes or interfaces, and mass", None)
            }
        }
    })?;
    Ok(Some(Loaded {
        body: reduction.body.clone(),
        reduced: Some(Reduced {
            free,
            reduction,
            interfaces,
            holding,
        }),
    }))
}

/// The key of the file with the mass matrix, and its name.
fn mass_file(source: &Files) -> (&'static str, &str) {
    match source {
        Files::MatrixMarket { mass, .. } => ("source/matrix_market/mass", mass),
        Files::Dmig { file, .. } | Files::StandardInput(file) => ("source/dmig/file", file),
    }
}

/// Support of the axes; none if an interface that it names does not exist.
fn holding(modal: &Modal) -> Option<Holding> {
    if modal
        .interfaces
        .values()
        .any(|nodes| nodes.list().is_empty())
    {
        return None;
    }
    let index = |name: &String| modal.interfaces.get_index_of(name);
    match &modal.frame {
        None => (!modal.interfaces.is_empty()).then_some(Holding::Clamped(0)),
        Some(ModalFrame::Clamped(name)) => Some(Holding::Clamped(index(name)?)),
        Some(ModalFrame::Chord(names)) => match &names[..] {
            [a, b] if a != b => Some(Holding::Chord(index(a)?, index(b)?, None)),
            [a, b, c] if a != b && b != c && a != c => {
                Some(Holding::Chord(index(a)?, index(b)?, Some(index(c)?)))
            }
            _ => None,
        },
    }
}
