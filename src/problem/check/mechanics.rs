//! Bodies and placements.

use super::{Checker, rigid_keys};
use crate::finding::Finding;
use crate::mass::{mass_properties, volume};
use crate::placement::{GROUND, placement_order};
use crate::pointer::join;
use crate::quantity::Quantity;
use crate::schema::mechanics::{Body, Location, Place, Shape, Turns};
use crate::system::equilibrium::Sought;

impl Checker<'_> {
    pub(super) fn mechanics(&mut self) {
        let document = self.document;
        self.names("bodies", document.bodies.keys());
        if !self.is_static() && document.bodies.is_empty() && !self.damage.touches("bodies") {
            self.fault(Finding::new("/bodies", "no body", "at least one"));
        }
        for (name, body) in &document.bodies {
            let pointer = join("/bodies", name);
            if name == GROUND || name.contains('.') {
                let found = format!("the name \"{name}\"");
                let expected = "a name that is not \"ground\" and has no dot";
                self.fault(Finding::new(&pointer, found, expected).of_key());
            }
            let flexible = [
                ("beam", body.beam.is_some()),
                ("elements", body.elements.is_some()),
                ("modal", body.modal.is_some()),
            ];
            let mut given = flexible.iter().filter(|(_, given)| *given);
            if let (Some((first, _)), Some((second, _))) = (given.next(), given.next()) {
                let found = format!("\"{second}\" beside \"{first}\"");
                self.fault(Finding::new(join(&pointer, second), found, "one of them").of_key());
            }
            match (&body.beam, &body.elements, &body.modal) {
                (Some(beam), _, _) => self.beam(&pointer, body, beam),
                (None, Some(elements), _) => self.elements(&pointer, (name, body), elements),
                (None, None, Some(modal)) => self.modal(&pointer, body, modal),
                (None, None, None) => self.mass(&pointer, body),
            }
            self.points(&join(&pointer, "points"), body);
            self.place(&join(&pointer, "place"), name, &body.place);
        }
        self.start_of_deformations();
        if let Err(circle) = placement_order(document) {
            let pointer = join(&join("/bodies", &circle[0]), "place");
            let found = format!("the circle {}", circle.join(" → "));
            let expected = "bodies whose places lead to the ground";
            self.fault(Finding::new(pointer, found, expected));
        }
    }

    /// Checks that a start in equilibrium has flexible bodies, and that these give no other.
    fn start_of_deformations(&mut self) {
        let Some(sought) = self.document.sought() else {
            return;
        };
        let bodies = &self.document.bodies;
        let flexible = sought == Sought::Rest || bodies.values().any(Body::is_flexible);
        if !flexible && !self.damage.touches("bodies") {
            let found = "a start in equilibrium without a flexible body";
            let finding = Finding::new("/start", found, "a beam, shells or a modal body");
            self.fault(finding);
        }
        for (name, body) in bodies {
            let given = [
                (
                    "beam",
                    body.beam.as_ref().is_some_and(|own| own.start.is_some()),
                ),
                (
                    "modal",
                    body.modal.as_ref().is_some_and(|own| own.start.is_some()),
                ),
            ];
            for (key, _) in given.into_iter().filter(|(_, given)| *given) {
                let pointer = join(&join(&join("/bodies", name), key), "start");
                let found = "a start of coordinates beside that in equilibrium";
                self.fault(Finding::new(pointer, found, "one of them").of_key());
            }
        }
    }

    /// Checks that the mass properties of a body are given once, and are those of a solid.
    fn mass(&mut self, pointer: &str, body: &Body) {
        if body.mass_properties.is_some() {
            for key in rigid_keys(body).filter(|key| *key != "mass_properties") {
                let found = format!("\"{key}\" beside \"mass_properties\"");
                let expected = "one of them, as the surface gives it";
                self.fault(Finding::new(join(pointer, key), found, expected).of_key());
            }
            return;
        }
        let mut wrong = |key: &str, found: &str, expected: &str| {
            let finding = Finding::new(join(pointer, key), found, expected);
            self.findings.push(finding.of_key());
        };
        match (&body.shape, &body.density, &body.mass) {
            (Some(_), Some(_), Some(_)) => {
                wrong("density", "\"density\" and \"mass\"", "one of them");
            }
            (Some(_), None, None) => {
                wrong(
                    "shape",
                    "\"shape\" alone",
                    "\"mass\" or \"density\" with it",
                );
            }
            (None, Some(_), _) => {
                wrong(
                    "density",
                    "\"density\" without \"shape\"",
                    "\"mass\" and \"inertia\"",
                );
            }
            (Some(Shape::Point), Some(_), None) => {
                wrong("density", "the density of a point", "a mass");
            }
            (Some(shape), Some(_), None) if volume::<f64>(shape, &[]) == 0.0 => {
                let found = "the density of a rod without radius";
                wrong("density", found, "a mass, or a radius above 0");
            }
            // Without mass there is no inertia.
            (None, None, Some(mass)) if *mass == Quantity::fixed(0.0) => {}
            (None, None, mass) if mass.is_none() || body.inertia.is_none() => {
                let finding = Finding::new(
                    pointer,
                    "a body without its mass properties",
                    "\"shape\" and \"mass\" or \"density\", or else \"mass\" and \"inertia\", or else \"mass_properties\", \"beam\", \"elements\" or \"modal\"",
                );
                self.fault(finding.of_key());
                return;
            }
            _ => {}
        }
        if body.shape.is_some() {
            let extra = [
                ("inertia", body.inertia.is_some()),
                ("centre_of_mass", body.centre_of_mass.is_some()),
            ];
            for (key, _) in extra.into_iter().filter(|(_, given)| *given) {
                let found = format!("\"{key}\" and \"shape\"");
                let expected = "one of them, as the shape gives it";
                self.fault(Finding::new(join(pointer, key), found, expected).of_key());
            }
            return;
        }
        if body.inertia.is_some() {
            let inertia = mass_properties::<f64>(body, &[]).inertia;
            let tolerance = self.document.input_tolerance();
            self.inertia(&join(pointer, "inertia"), &inertia, tolerance);
        }
    }

    fn place(&mut self, pointer: &str, name: &str, place: &Place) {
        if let Some(put) = &place.put {
            self.point(&join(pointer, "put"), name, put);
        }
        if let Some(Location::Named(text)) = &place.at {
            self.location(&join(pointer, "at"), text);
        }
        if let Some(other) = place
            .relative_to
            .as_deref()
            .filter(|other| *other != GROUND)
        {
            self.body(&join(pointer, "relative_to"), other);
        }
        let turn = join(pointer, "turn");
        match &place.turn {
            Some(Turns::One(one)) => self.turn(&turn, one),
            Some(Turns::Several(several)) => {
                for (k, one) in several.iter().enumerate() {
                    self.turn(&join(&turn, k), one);
                }
            }
            None => {}
        }
    }
}
