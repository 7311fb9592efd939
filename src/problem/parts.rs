//! Beams and lumped masses of a body of elements, from a file.

use super::prepared::{PartSource, Prepared, WrittenPart};
use super::quantity::Quantity;
use super::schema::Document;
use super::schema::elements::Elements;
use super::schema::structures::{Direction, Mesh, Structure as Written};
use super::statics::mesh::{Part as MeshPart, panel_elements};
use super::statics::properties::{section, section_by, slots};
use crate::math::scalar::lift3;
use crate::math::{Scalar, Vec3};
use crate::model::finite::Part;
use crate::structures::beam::Beam;
use crate::structures::floating::{Surface, normal};
use crate::structures::lumped_mass::LumpedMass;
use crate::structures::material::Material;
use crate::structures::parts::{of_beam, of_mass};
use crate::structures::structure::Structure;

/// The nodes of the beams of a line along a panel.
fn line(mesh: &Mesh, along: Direction, at: f64) -> Vec<[usize; 3]> {
    let Some([nx, ny]) = panel_elements(mesh) else {
        return Vec::new();
    };
    let columns = 2 * nx + usize::from(!matches!(mesh, Mesh::Cylinder { .. }));
    let node = |i: usize, j: usize| j * columns + i % columns;
    let border = |count: usize| 2 * (at * count as f64).round() as usize;
    let place = |k: usize| match along {
        Direction::X => node(k, border(ny)),
        Direction::Y => node(border(nx), k),
    };
    let count = match along {
        Direction::X => nx,
        Direction::Y => ny,
    };
    (0..count)
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
        for nodes in line(&elements.structure.mesh, stiffener.along, stiffener.at) {
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
    let structure = &elements.structure;
    let written = &document.materials[&structure.material];
    let of = |quantity: Option<Quantity>| quantity.map_or(S::zero(), &get);
    let material = Material {
        young: get(written.young),
        poisson: get(written.poisson),
        density: of(written.density),
        yield_stress: of(written.yield_stress),
    };
    let one = |own: &WrittenPart| {
        let (section, offset, line_mass) = match own.source {
            PartSource::Mass(k) => {
                let mass = &structure.masses[k];
                let inertia = mass.inertia.map_or([S::zero(); 6], |all| all.map(&get));
                let mass = LumpedMass {
                    mass: get(mass.mass),
                    inertia,
                };
                return of_mass(&own.nodes[0], &mass);
            }
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
            material,
            line_mass: of(line_mass),
        };
        of_beam(&nodes, &beam)
    };
    prepared.parts.iter().map(one).collect()
}
