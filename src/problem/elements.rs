//! From the elements of a body in a file to their coordinates and points.

use super::holds::{self, nodes_of};
use super::parts;
use super::reduced;
use super::spread_loads::unit_forces;
use super::statics::mesh::{Part, part};
use super::statics::properties::{slots, thickness};
use crate::math::{Scalar, Team, Vec3};
use crate::model::finite::FiniteElements;
use crate::prepared::Prepared;
use crate::quantity::Quantity;
use crate::schema::Document;
use crate::schema::elements::{ElementBasis, ElementFrame, Elements, Held};
use crate::schema::structures::{Mesh as WrittenMesh, Structure as WrittenStructure};
use crate::structures::beam::{Section, SectionValues};
use crate::structures::floating::{FrameNodes, NodeMotion, element_mesh};
use crate::structures::material::Material;
use crate::structures::mesh::Mesh;
use crate::structures::modes::PencilFailure;
use crate::structures::parts::coordinates;
use crate::structures::structure::{Structure, Topology};
use std::sync::Arc;

/// The nodes that hold the axes; `None` if a set is missing.
pub fn frame_nodes(mesh: &Mesh, frame: &ElementFrame) -> Option<FrameNodes> {
    let one = |set: &String| nodes_of(mesh, set)?.first().copied();
    match frame {
        ElementFrame::Chord([o, b, c]) => Some(FrameNodes::Chord([one(o)?, one(b)?, one(c)?])),
        ElementFrame::Clamped(set) => {
            let nodes = nodes_of(mesh, set).filter(|nodes| !nodes.is_empty());
            nodes.map(FrameNodes::Clamped)
        }
    }
}

/// Whether bodies of elements have all their nodes as coordinates.
pub fn has_all_nodes(document: &Document) -> bool {
    let bodies = document.bodies.values();
    let mut elements = bodies.filter_map(|body| body.elements.as_ref());
    elements.any(|own| own.basis == ElementBasis::Full)
}

/// The numbers of a mesh.
pub fn mesh_quantities(mesh: &WrittenMesh) -> Vec<Quantity> {
    match mesh {
        WrittenMesh::Plate { length, width, .. } => vec![*length, *width],
        WrittenMesh::Panel { points, .. } => points.as_flattened().to_vec(),
        WrittenMesh::CurvedPanel {
            radius,
            length,
            angles,
            ..
        } => vec![*radius, *length, angles[0], angles[1]],
        WrittenMesh::Cylinder { radius, length, .. } => vec![*radius, *length],
        WrittenMesh::StraightBeam {
            from,
            to,
            orientation,
            ..
        } => [*from, *to, *orientation].concat(),
        WrittenMesh::CurvedBeam { radius, angles, .. } => vec![*radius, angles[0], angles[1]],
        WrittenMesh::Frame { points, members } => {
            let orientations = members.values().map(|member| member.orientation);
            points
                .values()
                .copied()
                .chain(orientations)
                .flatten()
                .collect()
        }
        WrittenMesh::Gmsh(gmsh) => gmsh.orientation.iter().flatten().copied().collect(),
    }
}

/// The mesh of shells with the numbers of the file.
pub fn part_of_file(structure: &WrittenStructure) -> Part<f64> {
    let place = structure.at.iter().flatten().copied();
    let numbers = mesh_quantities(&structure.mesh).into_iter().chain(place);
    let mut x = Vec::new();
    for quantity in numbers {
        if let Some(i) = quantity.variable {
            x.resize(x.len().max(i + 1), 0.0);
            x[i] = quantity.value;
        }
    }
    part(structure, &x, 1)
}

/// Computes the data that no design changes. A checked file has all sets.
pub fn prepared(document: &Document, elements: &Elements) -> Arc<Prepared> {
    const CHECKED: &str = "stiffness is checked when a problem is read";
    prepare(document, elements).expect(CHECKED)
}

/// As [`prepared`], for a file whose stiffness may be singular.
///
/// # Errors
/// [`PencilFailure`]: the shells have no reduced basis, as they are a mechanism.
pub fn prepare(document: &Document, elements: &Elements) -> Result<Arc<Prepared>, PencilFailure> {
    if let Some(known) = elements.prepared.get() {
        return Ok(known.clone());
    }
    let new = || {
        const CHECKED: &str = "sets are checked when a problem is read";
        let (written, none) = (&elements.structure, Section::Given(SectionValues::zeros()));
        let mut part = part_of_file(written);
        let beams = parts::beams(elements, &mut part);
        let shells = part.mesh.shells.len();
        let mut slots = slots(written, &part);
        slots.truncate(shells);
        let material = document.materials.get(&written.material);
        let value =
            |quantity: Option<Quantity>, default: f64| quantity.map_or(default, |q| q.value);
        let structure = Structure {
            topology: Arc::new(Topology::new(
                part.mesh.clone(),
                &part.nodes,
                [vec![0; shells], vec![0; beams.len()]],
                Vec::new(),
            )),
            nodes: part.nodes,
            thickness: vec![1.0; shells],
            surface_mass: vec![0.0; shells],
            sections: vec![none; beams.len()],
            orientations: part.orientations.clone(),
            offsets: vec![[0.0; 2]; beams.len()],
            line_mass: vec![0.0; beams.len()],
            masses: Vec::new(),
            materials: vec![Material {
                young: 1.0,
                poisson: value(material.map(|material| material.poisson), 0.3),
                density: 1.0,
                yield_stress: value(material.and_then(|material| material.yield_stress), 1.0),
            }],
        };
        let given = frame_nodes(&part.mesh, &elements.frame).expect(CHECKED);
        let frame = holds::axes(elements, given, (&part.mesh, &structure.nodes));
        let (mut mesh, surface) = element_mesh(&structure, &frame).expect(CHECKED);
        let written_parts = parts::written(written, (beams, &structure), &surface, |set| {
            part.mesh.node_sets.get(set).cloned().unwrap_or_default()
        });
        let all = written_parts.iter();
        mesh.parts = all.map(|own| coordinates(&own.nodes)).collect();
        let motion = |held: &Held| match held {
            Held::Node(set) => surface.node(nodes_of(&part.mesh, set).expect(CHECKED)[0]),
            Held::Edge(set) | Held::Rigid(set) | Held::Mean(set) => {
                surface.edge(&part.mesh.edge_sets[set])
            }
        };
        let ties = elements.points.iter().filter_map(|(name, held)| {
            if !holds::is_rigid(elements, name) {
                return None;
            }
            let mut nodes = nodes_of(&part.mesh, held.set())?;
            nodes.sort_unstable();
            nodes.dedup();
            let nodes = nodes.into_iter().map(|node| surface.unknowns(node));
            let nodes: Vec<NodeMotion> = nodes.collect();
            // A clamped edge follows already.
            let moves = |own: &NodeMotion| own.displacements.iter().any(Option::is_some);
            nodes.iter().any(moves).then(|| (name.clone(), nodes))
        });
        let points = elements.points.iter();
        Prepared {
            mesh: Arc::new(mesh),
            points: points
                .map(|(name, held)| (name.clone(), motion(held)))
                .collect(),
            ties: ties.collect(),
            slots,
            parts: written_parts,
            sets: part.mesh,
            reduced: None,
        }
    };
    let mut made = new();
    let of_file = shells(document, elements, &made, |quantity| {
        let other = elements.design.as_ref();
        other.map_or(quantity.value, |x| quantity.get(x))
    });
    let loads = |made: &Prepared| unit_forces(document, elements, made);
    reduced::reduce(&elements.basis, &of_file, loads, &mut made)?;
    Ok(elements.prepared.get_or_init(|| Arc::new(made)).clone())
}

/// Copies the prepared data to the bound document from the one it was bound from.
pub(super) fn share(written: &Document, bound: &mut Document) {
    for (from, to) in written.bodies.values().zip(bound.bodies.values_mut()) {
        if let (Some(from), Some(to)) = (&from.elements, &mut to.elements) {
            to.prepared.clone_from(&from.prepared);
        }
    }
}

/// The shells at the design `x`.
pub fn finite<S: Scalar>(document: &Document, elements: &Elements, x: &[S]) -> FiniteElements<S> {
    let prepared = prepared(document, elements);
    shells(document, elements, &prepared, |quantity| quantity.get(x))
}

/// The shells with the values that `get` gives to quantities.
fn shells<S: Scalar>(
    document: &Document,
    elements: &Elements,
    prepared: &Prepared,
    get: impl Fn(Quantity) -> S,
) -> FiniteElements<S> {
    let written = &elements.structure;
    let material = &document.materials[&written.material];
    let count = prepared.mesh.elements.len();
    let zero = Quantity::fixed(0.0);
    let all = |quantity: Quantity| vec![get(quantity); count];
    FiniteElements {
        thickness: (prepared.slots.iter())
            .map(|&slot| get(thickness(written, slot)))
            .collect(),
        young: all(material.young),
        density: all(material.density.unwrap_or(zero)),
        surface_mass: all(written.surface_mass.unwrap_or(zero)),
        parts: parts::values(document, elements, prepared, &get),
        damping: written.damping.as_ref().map(|own| {
            let of = |factor: Option<Quantity>| get(factor.unwrap_or(zero));
            [of(own.mass), of(own.stiffness)]
        }),
        mesh: prepared.mesh.clone(),
        team: Team::default(),
    }
}

/// The place of a named point in the undeformed body, in its axes \[m\].
pub fn place(document: &Document, elements: &Elements, name: &str) -> Vec3<f64> {
    prepared(document, elements).points[name].place
}
