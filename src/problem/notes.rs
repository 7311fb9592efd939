//! What a run says of its input: what is left out, used though it does not fit, or stiffer than it looks.

use super::{Problem, beam, elements, holds, mass};
use crate::model::rigid_body::{ROUNDING, excess_of_inertia};
use crate::schema::Document;
use crate::schema::flexible::Strain;
use crate::structures::modal::BeamModes;
use crate::system::left_out;

impl Problem {
    /// Redundant rows of joints, inertias of no solid within the tolerance of the input, surfaces seen from inside, edges
    /// that axes alone make rigid, and beams that lock.
    pub fn notes_of_input(&self) -> Vec<String> {
        let mut notes = left_out::told(&self.redundant);
        notes.extend(self.inertias());
        notes.extend(inwards(&self.written));
        notes.extend(edges(&self.written));
        notes.extend(locked_beams(&self.written));
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
