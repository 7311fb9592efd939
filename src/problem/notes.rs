//! What a run says of its input: what is left out, used though it does not fit, or stiffer than it looks.

use super::{Problem, elements, holds, mass};
use crate::model::rigid_body::{ROUNDING, excess_of_inertia};
use crate::schema::Document;
use crate::system::left_out;

impl Problem {
    /// Redundant rows of joints, inertias of no solid within the tolerance of the input, surfaces seen from inside, and
    /// edges that axes alone make rigid.
    pub fn notes_of_input(&self) -> Vec<String> {
        let mut notes = left_out::told(&self.redundant);
        notes.extend(self.inertias());
        notes.extend(inwards(&self.written));
        notes.extend(edges(&self.written));
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
