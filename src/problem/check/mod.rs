//! Checks the meaning of a document: names, numbers, and faults that a schema cannot express.

mod beams;
mod contacts;
mod controllers;
mod couplings;
mod elements;
mod events;
mod joints;
mod load_cases;
mod loads;
mod mechanics;
mod modal;
mod properties;
mod rest;
mod sections;
mod sets;
mod structures;
mod study;
mod turns;
mod windows;

use super::finding::Finding;
use super::placement::{GROUND, split_location};
use super::pointer::{advice, join};
use super::prune::Damage;
use crate::quantity::{Vector, values};
use crate::schema::Document;
use crate::schema::mechanics::{Body, Point};

/// All faults of a document. Damaged parts are not checked.
pub(super) fn check(document: &Document, damage: &Damage) -> Vec<Finding> {
    let mut checker = Checker {
        document,
        damage,
        findings: Vec::new(),
        sets: sets::Sets::default(),
    };
    checker.mechanics();
    checker.joints();
    checker.loads();
    checker.drives();
    checker.couplings();
    checker.structures();
    checker.events();
    checker.analysis();
    checker.study();
    checker.findings
}

/// A document and its findings.
struct Checker<'a> {
    document: &'a Document,
    damage: &'a Damage,
    findings: Vec<Finding>,
    sets: sets::Sets,
}

impl<'a> Checker<'a> {
    fn fault(&mut self, finding: Finding) {
        self.findings.push(finding);
    }

    /// Whether nothing is wrong so far. Only then are all names known, also those of parts that were left out
    /// because of their faults, so that a mesh can be built and looked into.
    fn sound(&self) -> bool {
        self.findings.is_empty() && self.damage.is_empty()
    }

    /// The body of this name, given at `pointer`; a fault if there is none.
    fn body(&mut self, pointer: &str, name: &str) -> Option<&'a Body> {
        let body = self.document.bodies.get(name);
        if body.is_none() && !self.damage.holds("bodies", name) {
            let names = self.document.bodies.keys().map(String::as_str);
            let hint = advice(name, "bodies", names);
            let found = format!("\"{name}\"");
            self.fault(Finding::new(pointer, found, "the name of a body").hint(hint));
        }
        body
    }

    /// Checks that a body has a point; `whole` is the text in the file.
    fn named_point(&mut self, pointer: &str, body: &Body, name: &str, whole: &str) {
        let beam = body.beam.as_ref();
        let modal = body.modal.as_ref();
        let is_station = beam.is_some_and(|beam| beam.station(name).is_some());
        let elements = body.elements.as_ref();
        let is_held = elements.is_some_and(|elements| elements.points.contains_key(name));
        let is_interface = modal.is_some_and(|modal| modal.point_names().any(|own| own == name));
        if body.points.contains_key(name) || is_station || is_held || is_interface {
            return;
        }
        // Files that are not read have a fault of their own.
        if modal.is_some_and(|modal| modal.loaded.is_none()) {
            return;
        }
        let prefix = whole.strip_suffix(name).unwrap_or_default();
        let names: Vec<String> = body
            .points
            .keys()
            .map(String::as_str)
            .chain(beam.iter().flat_map(|beam| beam.station_names()))
            .chain(
                elements
                    .iter()
                    .flat_map(|all| all.points.keys().map(String::as_str)),
            )
            .chain(modal.iter().flat_map(|modal| modal.point_names()))
            .map(|key| format!("{prefix}{key}"))
            .collect();
        let hint = advice(whole, "points", names.iter().map(String::as_str));
        let found = format!("\"{whole}\"");
        self.fault(Finding::new(pointer, found, "the name of a point of the body").hint(hint));
    }

    /// Checks a point of a body, given by name or coordinates.
    fn point(&mut self, pointer: &str, body: &str, point: &Point) {
        if let Point::Named(name) = point {
            if body == GROUND {
                let expected = "a list of 3 numbers [m], as ground has no named points";
                self.fault(Finding::new(pointer, format!("\"{name}\""), expected));
            } else if let Some(body) = self.document.bodies.get(body) {
                self.named_point(pointer, body, name, name);
            }
        }
    }

    /// Checks `"body.point"` or `"body"`.
    fn location(&mut self, pointer: &str, text: &str) {
        let (name, point) = split_location(text);
        if name == GROUND {
            let expected = "\"body.point\", or a list of 3 numbers [m] for a point of ground";
            self.fault(Finding::new(pointer, format!("\"{text}\""), expected));
        } else if let (Some(body), Some(point)) = (self.body(pointer, name), point) {
            self.named_point(pointer, body, point, text);
        }
    }

    /// Checks that a direction is not zero.
    fn direction(&mut self, pointer: &str, direction: &Vector) {
        self.nonzero(pointer, values(direction).into());
    }

    fn nonzero(&mut self, pointer: &str, direction: [f64; 3]) {
        let square: f64 = direction.iter().map(|x| x * x).sum();
        if !(square.is_normal()) {
            let [x, y, z] = direction;
            let found = format!("the direction [{x}, {y}, {z}]");
            self.fault(Finding::new(pointer, found, "a direction that is not zero"));
        }
    }

    /// Checks the names of a section.
    fn names<'n>(&mut self, section: &str, names: impl Iterator<Item = &'n String>) {
        for name in names.filter(|name| name.trim().is_empty()) {
            let pointer = join(&format!("/{section}"), name);
            self.fault(Finding::new(pointer, "an empty name", "a name").of_key());
        }
    }
}

/// The keys of rigid bodies that a body has.
fn rigid_keys(body: &Body) -> impl Iterator<Item = &'static str> {
    let all = [
        ("shape", body.shape.is_some()),
        ("density", body.density.is_some()),
        ("mass", body.mass.is_some()),
        ("centre_of_mass", body.centre_of_mass.is_some()),
        ("inertia", body.inertia.is_some()),
        ("mass_properties", body.mass_properties.is_some()),
    ];
    all.into_iter()
        .filter_map(|(key, given)| given.then_some(key))
}
