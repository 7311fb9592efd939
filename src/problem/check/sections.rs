//! What is measured of sections of beams, by functions or by elements.

use super::Checker;
use crate::elements::prepared;
use crate::finding::Finding;
use crate::flexible::{END, START};
use crate::parts::chosen;
use crate::pointer::{advice, join};
use crate::schema::elements::Elements;
use crate::schema::flexible::BeamSection;
use crate::schema::measured::{SectionPlace, SectionPlaces};
use crate::schema::structures::{Mesh, Section};

/// Largest number of sections at equal distances.
const MOST_SECTIONS: usize = 1000;

impl Checker<'_> {
    /// Checks that a body has beams, for what is measured of them: it is one, or its elements have some. False after a
    /// fault.
    fn measured_beams(&mut self, pointer: &str, (name, set): (&str, Option<&String>)) -> bool {
        let body = self.document.bodies.get(name);
        if let Some(elements) = body.and_then(|body| body.elements.as_ref()) {
            return self.line_of_elements(pointer, (name, elements), set);
        }
        let is_beam = body.is_some_and(|body| body.beam.is_some());
        if !is_beam && !self.damage.holds("bodies", name) {
            let bodies = self.document.bodies.iter();
            let beams = bodies.filter(|(_, body)| {
                let elements = body.elements.as_ref();
                body.beam.is_some() || elements.is_some_and(|own| own.sections().next().is_some())
            });
            let hint = advice(name, "beams", beams.map(|(name, _)| name.as_str()));
            let found = format!("\"{name}\"");
            let place = join(pointer, "body");
            self.fault(Finding::new(place, found, "the name of a beam").hint(hint));
        }
        if is_beam && set.is_some() {
            let found = "\"beams\" of a beam that has no elements";
            let expected = "no such key, as the body is one beam";
            self.fault(Finding::new(join(pointer, "beams"), found, expected).of_key());
        }
        is_beam && set.is_none()
    }

    /// Beams of a body of elements that make one line.
    fn line_of_elements(
        &mut self,
        pointer: &str,
        (name, elements): (&str, &Elements),
        set: Option<&String>,
    ) -> bool {
        self.stress_of_rigid(pointer, (name, elements));
        // A faulty structure has no mesh to look into.
        if !self.sound() {
            return false;
        }
        let own = prepared(self.document, elements);
        let stiffeners = elements.stiffeners.keys();
        let sets = own.sets.beam_sets.iter();
        let filled = sets.filter(|(_, beams)| !beams.is_empty());
        let filled = filled.map(|(name, _)| name);
        let names: Vec<&str> = stiffeners.chain(filled).map(String::as_str).collect();
        let found = match set {
            _ if own.mesh.beams.is_empty() => {
                let found = format!("\"{name}\", whose elements are shells");
                let expected = "a body that has beams";
                self.fault(Finding::new(join(pointer, "body"), found, expected));
                return false;
            }
            Some(set) if chosen(elements, &own, Some(set)).is_empty() => format!("\"{set}\""),
            Some(_) => return true,
            None => {
                let several = matches!(elements.structure.mesh, Mesh::Frame { .. })
                    || elements.stiffeners.len() > 1;
                if !several {
                    return true;
                }
                "several lines of beams without \"beams\"".to_owned()
            }
        };
        let hint = match set {
            Some(set) => advice(set, "such names", names),
            None => Some(format!("they are: {}", names.join(", "))),
        };
        let expected =
            format!("\"beams\": the name of a set of beams or of a stiffener of \"{name}\"");
        let finding = match set {
            Some(_) => Finding::new(join(pointer, "beams"), found, expected),
            None => Finding::new(pointer, found, expected).of_key(),
        };
        self.fault(finding.hint(hint));
        false
    }

    /// Checks where a section is.
    pub(super) fn station(
        &mut self,
        pointer: &str,
        of: (&str, Option<&String>),
        place: &SectionPlace,
    ) {
        if self.measured_beams(pointer, of) {
            self.section_place(&join(pointer, "station"), of.0, place);
        }
    }

    /// Checks where several sections are.
    pub(super) fn stations(
        &mut self,
        pointer: &str,
        of: (&str, Option<&String>),
        places: &SectionPlaces,
    ) {
        if !self.measured_beams(pointer, of) {
            return;
        }
        let pointer = join(pointer, "stations");
        let fault = |found: &str, expected| Finding::new(&pointer, found, expected);
        let several = format!("a list of sections, or a number of them from 2 to {MOST_SECTIONS}");
        match places {
            SectionPlaces::Count(count) if (2..=MOST_SECTIONS).contains(count) => {}
            SectionPlaces::Count(count) => {
                let finding = fault(&format!("{count}"), &several);
                self.fault(finding);
            }
            SectionPlaces::List(all) if all.is_empty() => {
                let finding = fault("an empty list", &several);
                self.fault(finding);
            }
            SectionPlaces::List(all) => {
                for (k, place) in all.iter().enumerate() {
                    self.section_place(&join(&pointer, k), of.0, place);
                }
            }
        }
    }

    /// Checks where a section of a body with beams is.
    fn section_place(&mut self, pointer: &str, name: &str, place: &SectionPlace) {
        let Some(body) = self.document.bodies.get(name) else {
            return;
        };
        match (place, &body.beam) {
            (SectionPlace::Fraction(place), _) => self.part(pointer, place.value),
            (SectionPlace::Named(text), Some(beam)) if beam.station(text).is_some() => {}
            (SectionPlace::Named(text), None) if [START, END].contains(&text.as_str()) => {}
            (SectionPlace::Named(text), beam) => {
                let names: Vec<&str> = match beam {
                    Some(beam) => beam.station_names().collect(),
                    None => vec![START, END],
                };
                let hint = advice(text, "stations", names);
                let expected = "the name of a station, or a fraction of the length";
                self.fault(Finding::new(pointer, format!("\"{text}\""), expected).hint(hint));
            }
        }
    }

    /// Checks that the sections of a body have stresses.
    pub(super) fn has_stress(&mut self, pointer: &str, name: &str) {
        let Some(body) = self.document.bodies.get(name) else {
            return;
        };
        let beam = body.beam.as_ref();
        let elements = body.elements.as_ref();
        let given = beam.is_some_and(|beam| matches!(beam.section, BeamSection::Given(_)))
            || elements.is_some_and(|own| own.sections().any(|s| matches!(s, Section::Given(_))));
        if given {
            let found = format!("stress in \"{name}\", which has given stiffnesses");
            let expected = "a beam whose section has sizes";
            self.fault(Finding::new(join(pointer, "body"), found, expected));
        }
    }

    /// Checks that a fibre is in the section.
    pub(super) fn fibre(&mut self, pointer: &str, [y, z]: [f64; 2]) {
        if [y, z].iter().any(|part| part.abs() > 1.0) {
            let found = format!("the fibre [{y}, {z}]");
            let expected = "parts of half the section's size along y and z, from -1 to 1";
            self.fault(Finding::new(pointer, found, expected));
        }
    }

    /// Checks several fibres.
    pub(super) fn fibres(&mut self, pointer: &str, fibres: Option<&[[f64; 2]]>) {
        if fibres.is_some_and(<[_]>::is_empty) {
            let expected = "at least one fibre, or none for those at the corners";
            self.fault(Finding::new(pointer, "an empty list", expected));
        }
        for (k, fibre) in fibres.into_iter().flatten().enumerate() {
            self.fibre(&join(pointer, k), *fibre);
        }
    }
}
