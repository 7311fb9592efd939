//! Beams with elastic coordinates.

use super::{Checker, rigid_keys};
use crate::beam::{modes, shears};
use crate::finding::Finding;
use crate::pointer::{advice, join};
use crate::quantity::Vector;
use crate::schema::flexible::{Beam, BeamSection, Functions, Strain};
use crate::schema::joints::PointPair;
use crate::schema::mechanics::{Body, Point};

/// Part of the length by which a point may lie beyond an end.
const BEYOND: f64 = 1e-9;

impl Checker<'_> {
    pub(super) fn beam(&mut self, pointer: &str, body: &Body, beam: &Beam) {
        let expected = "one of them, as section and material of the beam give it";
        self.without_rigid_keys(pointer, body, ("beam", expected));
        let places = body.points.iter();
        for (name, point) in places.filter_map(|(name, own)| Some((name, own.coordinates()?))) {
            self.on_beam(&join(&join(pointer, "points"), name), beam, point);
        }
        let pointer = &join(pointer, "beam");
        for (name, station) in &beam.stations {
            self.part(&join(&join(pointer, "stations"), name), station.value);
            if body.points.contains_key(name) {
                let found = format!("\"{name}\", which \"points\" has too");
                let place = join(&join(pointer, "stations"), name);
                self.fault(Finding::new(place, found, "a name once").of_key());
            }
        }
        self.section(pointer, beam);
        let modes = modes(beam);
        let count = modes.count();
        if count == 0 {
            let found = "a beam without elastic coordinates";
            let hint = "a rigid body has \"shape\" and \"mass\" or \"density\"".to_owned();
            let finding = Finding::new(join(pointer, "modes"), found, "at least one function");
            self.fault(finding.hint(Some(hint)));
        }
        if beam.functions == Functions::Sine && beam.strain != Strain::Linear {
            let found = "sines with von Karman's strain";
            let hint =
                "no function of stretch lets a beam that is bent by sines shorten without strain";
            let finding = Finding::new(
                join(pointer, "functions"),
                found,
                "\"polynomial\", or \"strain\": \"linear\"",
            );
            self.fault(finding.hint(Some(hint.into())));
        }
        if let Some(start) = &beam.start {
            for (key, row) in [("coordinates", &start.coordinates), ("rates", &start.rates)] {
                let Some(row) = row.as_ref().filter(|row| row.len() != count) else {
                    continue;
                };
                let [y, z, torsion, stretch] = modes.ranges().map(|range| range.len());
                let found = format!("a list of {}", row.len());
                let expected = format!(
                    "a list of {count} numbers: {y} of bending along y, {z} along z, {torsion} of \
                     torsion, {stretch} of stretch"
                );
                let place = join(&join(pointer, "start"), key);
                self.fault(Finding::new(place, found, expected));
            }
        }
    }

    /// Checks that a flexible body has no keys of rigid ones; `own` is its key and what is expected.
    pub(super) fn without_rigid_keys(
        &mut self,
        pointer: &str,
        body: &Body,
        (own, expected): (&str, &str),
    ) {
        for key in rigid_keys(body) {
            let found = format!("\"{key}\" beside \"{own}\"");
            self.fault(Finding::new(join(pointer, key), found, expected).of_key());
        }
    }

    /// Checks that a body has elastic coordinates; whether it has.
    pub(super) fn measured_flexible(&mut self, pointer: &str, name: &str) -> bool {
        let body = self.document.bodies.get(name);
        if body.is_some_and(|body| body.is_flexible()) {
            return true;
        }
        if !self.damage.holds("bodies", name) {
            let bodies = self.document.bodies.iter();
            let flexible = bodies.filter(|(_, body)| body.is_flexible());
            let hint = advice(name, "such bodies", flexible.map(|(name, _)| name.as_str()));
            let place = join(pointer, "body");
            let expected = "the name of a beam, of shells or of a modal body";
            self.fault(Finding::new(place, format!("\"{name}\""), expected).hint(hint));
        }
        false
    }

    /// Checks that a section has what its functions and its inertia need.
    fn section(&mut self, pointer: &str, beam: &Beam) {
        let place = join(pointer, "section");
        let modes = modes(beam);
        let material = beam.material.as_ref();
        if let BeamSection::Given(given) = &beam.section {
            let needed = [
                ("ei_y", modes.bending[0] > 0, given.ei_y.is_some()),
                ("ei_z", modes.bending[1] > 0, given.ei_z.is_some()),
                ("gj", modes.torsion > 0, given.gj.is_some()),
                (
                    "ga_y",
                    shears(beam) && modes.bending[0] > 0,
                    given.ga_y.is_some(),
                ),
                (
                    "ga_z",
                    shears(beam) && modes.bending[1] > 0,
                    given.ga_z.is_some(),
                ),
            ];
            for (key, _, _) in needed.iter().filter(|(_, needed, given)| *needed && !given) {
                let found = format!("a given section without \"{key}\"");
                let expected = format!("\"{key}\", as the beam has functions that need it");
                let finding = Finding::new(join(&place, "given"), found, expected);
                self.fault(finding.of_key());
            }
            let turns = given.inertia_y.value + given.inertia_z.value > 0.0;
            if modes.torsion > 0 && !turns {
                let found = "torsion of sections without inertia";
                let expected = "\"inertia_y\" or \"inertia_z\", or no functions of torsion";
                self.fault(Finding::new(join(&place, "given"), found, expected).of_key());
            }
            if beam.shear.is_some() {
                let found = "\"shear\" beside given stiffnesses";
                let expected = "\"ga_y\" and \"ga_z\" in the section, or neither";
                self.fault(Finding::new(join(pointer, "shear"), found, expected).of_key());
            }
            return;
        }
        match material {
            None => {
                let found = "a beam without material";
                self.fault(Finding::new(pointer, found, "\"material\"").of_key());
            }
            Some(material) if material.density.is_none() => {
                let finding = Finding::new(
                    join(pointer, "material"),
                    "a material without density",
                    "\"density\", which gives the beam its mass",
                );
                self.fault(finding.of_key());
            }
            Some(_) => {}
        }
        self.sizes(&place, &beam.section);
    }

    pub(super) fn part(&mut self, pointer: &str, part: f64) {
        if !(-BEYOND..=1.0 + BEYOND).contains(&part) {
            let finding = Finding::new(
                pointer,
                format!("{part}"),
                "a fraction of the length, 0 to 1",
            );
            self.fault(finding);
        }
    }

    fn on_beam(&mut self, pointer: &str, beam: &Beam, point: &Vector) {
        let (x, length) = (point[0].value, beam.length.value);
        if !(-BEYOND..=1.0 + BEYOND).contains(&(x / length)) {
            let found = format!("a point at x = {x} m");
            let expected = format!("one on the beam, x from 0 to {length} m");
            self.fault(Finding::new(pointer, found, expected));
        }
    }

    /// Checks where a joint holds a beam, if the file says it in the beam's own axes.
    pub(super) fn held(&mut self, pointer: &str, between: &[String; 2], pair: &PointPair) {
        for (key, name, point) in [("a", &between[0], &pair.a), ("b", &between[1], &pair.b)] {
            let body = self.document.bodies.get(name);
            if let (Some(beam), Point::Coordinates(point)) =
                (body.and_then(|body| body.beam.as_ref()), point)
            {
                self.on_beam(&join(pointer, key), beam, point);
            }
        }
    }
}
