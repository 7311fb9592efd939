//! Beams and lumped masses of a body of elements, from a file.

use super::statics::mesh::Part as MeshPart;
use super::statics::properties::{section, section_by, slots};
use crate::math::scalar::lift3;
use crate::math::{Scalar, Vec3};
use crate::model::finite::Part;
use crate::prepared::{PartSource, Prepared, WrittenPart};
use crate::quantity::Quantity;
use crate::schema::Document;
use crate::schema::elements::Elements;
use crate::schema::structures::{Direction, Mesh, Structure as Written};
use crate::structures::beam::Beam;
use crate::structures::beam_sections::BeamLine;
use crate::structures::floating::{NodeMotion, Surface, normal};
use crate::structures::lumped_mass::LumpedMass;
use crate::structures::material::Material;
use crate::structures::parts::{of_beam, of_mass};
use crate::structures::structure::Structure;

/// Steps between nodes along a line of a panel in this direction. A beam takes two of them: an element of nine nodes,
/// or two of four.
pub(super) fn steps_along(structure: &Written, along: Direction) -> Option<usize> {
    let [nx, ny] = structure.mesh.panel_elements()?;
    let order = structure.shell_kind().order();
    Some(match along {
        Direction::X => order * nx,
        Direction::Y => order * ny,
    })
}

/// The nodes of the beams of a line along a panel.
fn line(structure: &Written, along: Direction, at: f64) -> Vec<[usize; 3]> {
    let mesh = &structure.mesh;
    let (Some([nx, ny]), Some(steps)) = (mesh.panel_elements(), steps_along(structure, along))
    else {
        return Vec::new();
    };
    let order = structure.shell_kind().order();
    let columns = order * nx + usize::from(!matches!(mesh, Mesh::Cylinder { .. }));
    let node = |i: usize, j: usize| j * columns + i % columns;
    let border = |count: usize| order * (at * count as f64).round() as usize;
    let place = |k: usize| match along {
        Direction::X => node(k, border(ny)),
        Direction::Y => node(border(nx), k),
    };
    (0..steps / 2)
        .map(|e| [0, 1, 2].map(|k| place(2 * e + k)))
        .collect()
}

/// Adds stiffeners to the beams of a mesh; gives where the file has the numbers of each beam.
pub(super) fn beams(elements: &Elements, part: &mut MeshPart<f64>) -> Vec<PartSource> {
    let mut all: Vec<PartSource> = match elements.structure.mesh.is_of_beams() {
        true => (slots(&elements.structure, part).into_iter())
            .map(PartSource::Beam)
            .collect(),
        false => Vec::new(),
    };
    for (number, stiffener) in elements.stiffeners.values().enumerate() {
        for nodes in line(&elements.structure, stiffener.along, stiffener.at) {
            all.push(PartSource::Stiffener(number));
            (part.orientations).push(normal(&part.mesh, &part.nodes, nodes[1]));
            part.mesh.beams.push(nodes);
        }
    }
    all
}

/// The parts of a body with their nodes; `set` gives the nodes of a set.
pub(super) fn written(
    elements: &Written,
    (beams, structure): (Vec<PartSource>, &Structure<f64>),
    surface: &Surface,
    set: impl Fn(&str) -> Vec<usize>,
) -> Vec<WrittenPart> {
    let mesh = &structure.topology.mesh;
    let lines = beams.into_iter().zip(&mesh.beams);
    let lines = lines.zip(&structure.orientations);
    let of_beams = lines.map(|((source, nodes), orientation)| WrittenPart {
        source,
        nodes: nodes.iter().map(|&node| surface.unknowns(node)).collect(),
        orientation: *orientation,
    });
    let of_masses = elements.masses.values().enumerate().flat_map(|(k, mass)| {
        let nodes = set(&mass.nodes).into_iter();
        nodes.map(move |node| WrittenPart {
            source: PartSource::Mass(k),
            nodes: vec![surface.unknowns(node)],
            orientation: Vec3::zeros(),
        })
    });
    of_beams.chain(of_masses).collect()
}

/// The parts with the values that `get` gives to quantities.
pub(super) fn values<S: Scalar>(
    document: &Document,
    elements: &Elements,
    prepared: &Prepared,
    get: impl Fn(Quantity) -> S,
) -> Vec<Part<S>> {
    let one = |own: &WrittenPart| match beam(document, elements, own, &get) {
        Some((nodes, beam)) => of_beam(&nodes, &beam),
        None => of_mass(&own.nodes[0], &mass(elements, own, &get)),
    };
    prepared.parts.iter().map(one).collect()
}

/// The numbers of a lumped mass.
fn mass<S: Scalar>(
    elements: &Elements,
    own: &WrittenPart,
    get: impl Fn(Quantity) -> S,
) -> LumpedMass<S> {
    let PartSource::Mass(k) = own.source else {
        unreachable!("what is no beam is a mass");
    };
    let mass = &elements.structure.masses[k];
    LumpedMass {
        mass: get(mass.mass),
        inertia: mass.inertia.map_or([S::zero(); 6], |all| all.map(&get)),
    }
}

/// A beam of a body with its nodes; none if the part is a mass.
fn beam<S: Scalar>(
    document: &Document,
    elements: &Elements,
    own: &WrittenPart,
    get: impl Fn(Quantity) -> S,
) -> Option<([NodeMotion; 3], Beam<S>)> {
    let structure = &elements.structure;
    let written = &document.materials[&structure.material];
    let of = |quantity: Option<Quantity>| quantity.map_or(S::zero(), &get);
    let (section, offset, line_mass) = match own.source {
        PartSource::Mass(_) => return None,
        PartSource::Beam(slot) => {
            let section = section(structure, slot);
            (section, structure.offset, structure.line_mass)
        }
        PartSource::Stiffener(k) => {
            let own = &elements.stiffeners[k];
            (Some(&own.section), own.offset, own.line_mass)
        }
    };
    let nodes = [0, 1, 2].map(|a: usize| own.nodes[a].clone());
    let beam = Beam {
        points: nodes.each_ref().map(|node| lift3(&node.place)),
        orientation: lift3(&own.orientation),
        section: section_by(section, |quantity| get(*quantity)),
        offset: offset.map_or([S::zero(); 2], |all| all.map(&get)),
        material: Material {
            young: get(written.young),
            poisson: get(written.poisson),
            density: of(written.density),
            yield_stress: of(written.yield_stress),
        },
        line_mass: of(line_mass),
    };
    Some((nodes, beam))
}

/// The beams of a set, of a stiffener, or all: their numbers among the parts of the body.
pub fn chosen(elements: &Elements, prepared: &Prepared, name: Option<&String>) -> Vec<usize> {
    let all = 0..prepared.mesh.beams.len();
    let Some(name) = name else {
        return all.collect();
    };
    match elements.stiffeners.get_index_of(name) {
        Some(k) => {
            let own = |&part: &usize| prepared.parts[part].source == PartSource::Stiffener(k);
            all.filter(own).collect()
        }
        None => prepared
            .sets
            .beam_sets
            .get(name)
            .cloned()
            .unwrap_or_default(),
    }
}

/// Each beam of a body as a line of its own at the design `x`, in the order of the mesh.
pub(super) fn lines(
    document: &Document,
    elements: &Elements,
    prepared: &Prepared,
    x: &[f64],
) -> Vec<BeamLine<f64>> {
    let parts = prepared.parts.iter();
    parts
        .filter_map(|part| beam(document, elements, part, |quantity| quantity.get(x)))
        .map(|beam| BeamLine::new(&[beam]))
        .collect()
}

/// The sections of these beams at the design `x`.
pub fn line_of<S: Scalar>(
    document: &Document,
    elements: &Elements,
    prepared: &Prepared,
    (name, x): (Option<&String>, &[S]),
) -> BeamLine<S> {
    let parts = chosen(elements, prepared, name).into_iter();
    let beams = parts.filter_map(|part| {
        beam(document, elements, &prepared.parts[part], |quantity| {
            quantity.get(x)
        })
    });
    BeamLine::new(&beams.collect::<Vec<_>>())
}
