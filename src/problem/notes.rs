//! What a run says of its input: what is left out, used though it does not fit, or stiffer than it looks.

use super::elements::part_of_file;
use super::{Problem, beam, elements, holds, mass};
use crate::math::Vec3;
use crate::model::rigid_body::{ROUNDING, excess_of_inertia};
use crate::schema::Document;
use crate::schema::flexible::Strain;
use crate::structures::modal::BeamModes;
use crate::structures::quality::most_turned;
use crate::structures::shell::ShellKind;
use crate::system::left_out;

/// Turns of the normal from the middle of an element to a node, of four and of nine nodes, that are told \[rad\].
const WARPED: f64 = 0.2;
const CURVED: f64 = 0.4;

impl Problem {
    /// Redundant rows of joints, inertias of no solid within the tolerance of the input, surfaces seen from inside, edges
    /// that axes alone make rigid, beams that lock, and elements that turn much within themselves.
    pub fn notes_of_input(&self) -> Vec<String> {
        let mut notes = left_out::told(&self.redundant);
        notes.extend(self.inertias());
        notes.extend(inwards(&self.written));
        notes.extend(edges(&self.written));
        notes.extend(locked_beams(&self.written));
        notes.extend(turned_elements(&self.written));
        notes
    }

    fn inertias(&self) -> impl Iterator<Item = String> {
        let start = self.start_numbers();
        self.written.bodies.iter().filter_map(move |(name, body)| {
            body.inertia.as_ref()?;
            let excess = excess_of_inertia(&mass::mass_properties(body, &start).inertia);
            (excess > ROUNDING).then(|| {
                format!(
                    "body \"{name}\": a principal moment of inertia is above the sum of the others by {excess:.1e} of it \
                     (\"input_tolerance\" {:e}), and is used as it is",
                    self.input_tolerance()
                )
            })
        })
    }
}

fn edges(document: &Document) -> impl Iterator<Item = String> {
    document.bodies.iter().filter_map(|(name, body)| {
        let own = body.elements.as_ref()?;
        let prepared = elements::prepared(document, own);
        let set = holds::rigid_by_axes(own, &prepared.sets)?;
        Some(format!(
            "body \"{name}\": its axes are clamped at \"{set}\", where no point holds it: the nodes there keep their places \
             among each other, and the body is stiffer than in \"chord\" axes"
        ))
    })
}

/// Beams with too few functions of stretch to bend without it.
fn locked_beams(document: &Document) -> impl Iterator<Item = String> {
    document.bodies.iter().filter_map(|(name, body)| {
        let own = body.beam.as_ref().filter(|own| own.strain == Strain::VonKarman)?;
        let modes = beam::modes(own);
        let needed = BeamModes::companions(modes.bending, modes.torsion);
        let bends = modes.bending != [0, 0] && modes.stretch < needed;
        bends.then(|| {
            format!(
                "body \"{name}\": \"stretch\": {} with von Karman's strains, where this bending needs {needed}: it becomes too \
                 stiff where it bends by more than its thickness (membrane locking); without the key it has as many as it needs",
                modes.stretch
            )
        })
    })
}

/// Elements of meshes whose normal turns so much that they err.
fn turned_elements(document: &Document) -> impl Iterator<Item = String> {
    let bodies = document.bodies.iter().filter_map(|(name, body)| {
        let own = &body.elements.as_ref()?.structure;
        Some((format!("body \"{name}\""), own))
    });
    let structures =
        (document.structures.iter()).map(|(name, own)| (format!("structure \"{name}\""), own));
    bodies.chain(structures).filter_map(|(what, own)| {
        let part = part_of_file(own);
        let (shell, turn) = most_turned(&part.mesh, &part.nodes)?;
        let element = &part.mesh.shells[shell];
        let (most, word) = match ShellKind::of(element) {
            ShellKind::Mitc4 => (WARPED, "warped"),
            ShellKind::Mitc9 => (CURVED, "curved"),
        };
        let places = element.iter().map(|&node| part.nodes[node]);
        let middle = places.sum::<Vec3<f64>>() / element.len() as f64;
        (turn > most).then(|| {
            format!(
                "{what}: the element at ({:.4}, {:.4}, {:.4}) m is {word}: its normal turns by {:.1} degrees from its middle to \
                 a node; from {:.1} on such elements err, and smaller ones err less",
                middle.x,
                middle.y,
                middle.z,
                turn.to_degrees(),
                most.to_degrees()
            )
        })
    })
}

fn inwards(document: &Document) -> impl Iterator<Item = String> {
    document.bodies.iter().filter_map(|(name, body)| {
        let own = body.mass_properties.as_ref()?;
        let solid = own.solid.as_ref().filter(|solid| solid.inwards)?;
        Some(format!(
            "body \"{name}\": the triangles of {} are ordered as seen from inside; its volume is taken as {:.6e} m³",
            own.stl, solid.volume
        ))
    })
}
