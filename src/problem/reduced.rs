//! Reduced bases of shells, and shells that are rigid, from a file.

use super::pointer::join;
use crate::model::finite::{ElementMesh, FiniteElements};
use crate::prepared::{Prepared, ReducedBody};
use crate::schema::Document;
use crate::schema::elements::{ElementBasis, ReducedKeys};
use crate::schema::mechanics::Body;
use crate::structures::floating::{NodeMotion, PointMotion};
use crate::structures::modes::PencilFailure;
use crate::system::reduction::{ModeChoice, ReducedBasis, Request, Tie, project, reduced_basis};
use serde_json::json;
use std::collections::BTreeMap;
use std::sync::OnceLock;

/// Fixed-interface modes where a file gives no number.
const MODES: u32 = 6;
/// Deflection of static solutions, as a part of the size of the body: none.
const DEFLECTION: f64 = 0.0;
/// Amplitude below which vectors are left out.
const TOLERANCE: f64 = 1e-4;

/// Growth of the number of modes, or of their highest frequency, of a richer basis.
const RICHER: f64 = 1.5;
/// Its tolerance relative to that of the basis.
const FINER: f64 = 0.3;

/// Requests richer bases. Rigid shells get the default basis. False if no body has a basis.
pub(super) fn enrich(document: &mut Document) -> bool {
    let mut changed = false;
    for elements in (document.bodies.values_mut()).filter_map(|body| body.elements.as_mut()) {
        elements.basis = match &elements.basis {
            ElementBasis::Full => continue,
            ElementBasis::Rigid => ElementBasis::Reduced(ReducedKeys::default()),
            ElementBasis::Reduced(keys) => {
                let modes = f64::from(keys.modes.unwrap_or(MODES));
                let more = (RICHER * modes).ceil().max(modes + 1.0) as u32;
                ElementBasis::Reduced(ReducedKeys {
                    modes: keys.highest_frequency.is_none().then_some(more),
                    highest_frequency: keys.highest_frequency.map(|f| RICHER * f),
                    tolerance: Some(two_digits(FINER * keys.tolerance.unwrap_or(TOLERANCE))),
                    ..keys.clone()
                })
            }
        };
        elements.prepared = OnceLock::new();
        changed = true;
    }
    changed
}

/// A number with two significant digits.
fn two_digits(x: f64) -> f64 {
    format!("{x:.1e}").parse().unwrap_or(x)
}

/// Keeps all nodes of bodies that are reduced or rigid. False if there are none.
pub(super) fn keep_all_nodes(document: &mut Document) -> bool {
    let mut changed = false;
    for elements in (document.bodies.values_mut()).filter_map(|body| body.elements.as_mut()) {
        if elements.basis != ElementBasis::Full {
            elements.basis = ElementBasis::Full;
            elements.prepared = OnceLock::new();
            changed = true;
        }
    }
    changed
}

/// Bases that differ from those of `before`, as path=value.
pub(super) fn overrides(document: &Document, before: &Document) -> Vec<String> {
    let basis = |body: &Body| {
        body.elements
            .as_ref()
            .map(|elements| elements.basis.clone())
    };
    let one = |(name, body): (&String, &Body)| {
        let now = basis(body)?;
        let value = match &now {
            _ if before.bodies.get(name).and_then(basis).as_ref() == Some(&now) => return None,
            ElementBasis::Full => json!("full"),
            ElementBasis::Rigid => json!("rigid"),
            ElementBasis::Reduced(keys) => json!({ "reduced": keys }),
        };
        let path = join(&join(&join("/bodies", name), "elements"), "basis");
        Some(format!("{path}={value}"))
    };
    document.bodies.iter().filter_map(one).collect()
}

/// The basis that a file requests.
pub(super) fn request(keys: &ReducedKeys, mesh: &ElementMesh) -> Request {
    let first = mesh.nodes[0];
    let size = (mesh.nodes.iter()).fold(0.0_f64, |size, node| size.max((node - first).norm()));
    let count = ModeChoice::Count(keys.modes.unwrap_or(MODES) as usize);
    Request {
        modes: keys.highest_frequency.map_or(count, ModeChoice::Below),
        companions: keys.companions.unwrap_or(true),
        deflection: keys.deflection.unwrap_or(DEFLECTION) * size,
        tolerance: keys.tolerance.unwrap_or(TOLERANCE),
    }
}

/// Gives prepared shells the basis that their file requests; `of_file` are those of the design in
/// the file, `loads` the forces of loads that are spread over them.
///
/// # Errors
/// [`PencilFailure`]: the stiffness is singular with the axes held.
pub(super) fn reduce(
    basis: &ElementBasis,
    of_file: &FiniteElements<f64>,
    loads: impl FnOnce(&Prepared) -> Vec<Vec<f64>>,
    prepared: &mut Prepared,
) -> Result<(), PencilFailure> {
    let basis = match basis {
        ElementBasis::Full => return Ok(()),
        ElementBasis::Rigid => None,
        ElementBasis::Reduced(keys) => Some(make(keys, of_file, &loads(prepared), prepared)?),
    };
    let (mesh, slots) = (&prepared.mesh, &prepared.slots);
    let (vectors, bending) = basis.as_ref().map_or_else(Default::default, |basis| {
        (basis.vectors.clone(), basis.bending.clone())
    });
    let shells = project(mesh, slots, vectors, bending);
    for point in prepared.points.values_mut() {
        *point = shells.point(point);
    }
    // The vectors follow already.
    prepared.ties.clear();
    prepared.reduced = Some(ReducedBody { shells, basis });
    Ok(())
}

fn make(
    keys: &ReducedKeys,
    of_file: &FiniteElements<f64>,
    loads: &[Vec<f64>],
    prepared: &Prepared,
) -> Result<ReducedBasis, PencilFailure> {
    let points = prepared.points.iter();
    let points = points.filter(|(name, _)| match &keys.interfaces {
        None => true,
        Some(interfaces) => interfaces.contains(name),
    });
    let points: Vec<&PointMotion> = points.map(|(_, point)| point).collect();
    let ties = prepared.ties.iter();
    let ties: Vec<Tie> = ties
        .map(|(name, nodes)| tie(nodes, &prepared.points[name]))
        .collect();
    let request = request(keys, &prepared.mesh);
    reduced_basis(of_file, &points, &ties, loads, &request)
}

/// The rows that vanish where the nodes of an edge follow its average.
fn tie(nodes: &[NodeMotion], average: &PointMotion) -> Tie {
    let motions = || {
        let all = average.displacement.iter().zip(&average.rotation);
        average.coordinates.iter().zip(all)
    };
    let mut rows = Vec::new();
    for node in nodes {
        let arm = node.place - average.place;
        for (k, own) in node.displacements.iter().enumerate() {
            let follows = motions().map(|(&i, (u, turn))| (i, -(u + turn.cross(&arm))[k]));
            rows.push(joined(own.map(|i| (i, 1.0)).into_iter().chain(follows)));
        }
        for (own, axis) in &node.rotations {
            let size = axis.norm();
            let follows = motions().map(|(&i, (_, turn))| (i, -turn.dot(axis) / size));
            rows.push(joined(std::iter::once((*own, size)).chain(follows)));
        }
    }
    rows
}

/// A row with one entry for each unknown that it has.
fn joined(entries: impl Iterator<Item = (usize, f64)>) -> Vec<(usize, f64)> {
    let mut sums = BTreeMap::new();
    for (i, x) in entries {
        *sums.entry(i).or_insert(0.0) += x;
    }
    sums.into_iter().filter(|(_, x)| *x != 0.0).collect()
}
