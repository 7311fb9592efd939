//! Bodies of finite elements.

use super::{Checker, rigid_keys};
use crate::composing::is_wanted;
use crate::elements::{frame_nodes, prepare};
use crate::finding::Finding;
use crate::holds::nodes_of;
use crate::parts::beams;
use crate::parts::steps_along;
use crate::placement::GROUND;
use crate::pointer::{advice, join, keys};
use crate::schema::elements::{ElementBasis, ElementFrame, Elements, Held};
use crate::schema::functions::ShellStress;
use crate::schema::mechanics::Body;
use crate::schema::structures::Structure;
use crate::statics::mesh::part;
use crate::structures::floating::{FrameNodes, spans};
use crate::structures::mesh::Mesh;
use crate::structures::quality::{faults, orientation_faults};
use std::collections::{BTreeMap, BTreeSet};

/// The names of the sets that have something.
fn filled<T>(sets: &BTreeMap<String, Vec<T>>) -> Vec<&String> {
    let some = sets.iter().filter(|(_, own)| !own.is_empty());
    some.map(|(name, _)| name).collect()
}

impl Checker<'_> {
    pub(super) fn elements(
        &mut self,
        pointer: &str,
        (name, body): (&str, &Body),
        elements: &Elements,
    ) {
        let points = (!body.points.is_empty()).then_some("points");
        for key in rigid_keys(body).chain(points) {
            let found = format!("\"{key}\" beside \"elements\"");
            let expected = match key {
                "points" => "the points of \"elements\", which are nodes and edges",
                _ => "one of them, as the elements give it",
            };
            self.fault(Finding::new(join(pointer, key), found, expected).of_key());
        }
        let pointer = join(pointer, "elements");
        let own = join(&pointer, "structure");
        let structure = &elements.structure;
        let before = self.findings.len();
        self.structure_at(own.clone(), name, structure);
        if !structure.supports.is_empty() {
            let found = "\"supports\" of elements that move";
            let expected = "joints, which hold bodies that move";
            self.fault(Finding::new(join(&own, "supports"), found, expected).of_key());
        }
        self.element_damping(&join(&own, "damping"), structure);
        self.stiffeners(&join(&pointer, "stiffeners"), elements);
        if self.findings.len() > before || structure.mesh.is_unread() {
            return;
        }
        // A faulty material has been told.
        let Some(material) = self.document.materials.get(&structure.material) else {
            return;
        };
        if material.density.is_none_or(|density| density.value <= 0.0) {
            let place = join(&join("/materials", &structure.material), "density");
            let found = "no density of a material of elements that move";
            self.fault(Finding::new(place, found, "a density above 0 [kg/m³]").of_key());
        }
        let mut part = part::<f64>(structure, &[], 1);
        beams(elements, &mut part);
        let mut wrong = faults(&part.mesh, &part.nodes);
        if wrong.is_empty() {
            wrong = orientation_faults(&part.mesh, &part.nodes, &part.orientations);
        }
        if let Some(fault) = wrong.first() {
            let expected = "a mesh of sound elements";
            let place = join(&own, "mesh");
            self.fault(Finding::new(place, fault.to_string(), expected).of_key());
            return;
        }
        let parts = part.mesh.parts();
        if parts > 1 {
            let found = format!("a mesh of {parts} parts that share no node");
            let expected = "one part; a body of its own for each, and joints between them";
            self.fault(Finding::new(join(&own, "mesh"), found, expected).of_key());
            return;
        }
        let nodes = part.mesh.node_sets.keys().map(String::as_str);
        let edges = part.mesh.edge_sets.keys().map(String::as_str);
        let all: BTreeSet<&str> = nodes.chain(edges.clone()).collect();
        let frame = join(&pointer, "frame");
        let wanted = match &elements.frame {
            ElementFrame::Chord(sets) => {
                let sets = sets.iter().enumerate();
                let pointer = join(&frame, "chord");
                sets.map(|(k, set)| (join(&pointer, k), set, true))
                    .collect()
            }
            ElementFrame::Clamped(set) => vec![(join(&frame, "clamped"), set, false)],
        };
        let held = elements.points.iter().map(|(name, held)| {
            let pointer = join(&join(&pointer, "points"), name);
            let one = matches!(held, Held::Node(_));
            (join(&pointer, held.key()), held.set(), one)
        });
        let mut wanted: Vec<(String, &String, bool)> = wanted;
        wanted.extend(held);
        for (place, set, one) in wanted {
            let (found, expected, hint) = match nodes_of(&part.mesh, set) {
                None => {
                    let hint = advice(set, "sets", all.iter().copied());
                    (
                        format!("\"{set}\""),
                        "the name of a set of nodes or of an edge",
                        hint,
                    )
                }
                Some(nodes) if one && nodes.len() != 1 => (
                    format!("\"{set}\", a set of {} nodes", nodes.len()),
                    "a set of one node",
                    None,
                ),
                Some(_) => continue,
            };
            self.fault(Finding::new(place, found, expected).hint(hint));
        }
        for (name, held) in &elements.points {
            if matches!(held, Held::Node(_)) {
                continue;
            }
            let set = held.set();
            let place = join(&join(&join(&pointer, "points"), name), held.key());
            match part.mesh.edge_sets.get(set) {
                // A set that is not there has been told.
                None if !all.contains(set.as_str()) => {}
                None => {
                    let hint = advice(set, "edges", edges.clone());
                    let found = format!("\"{set}\"");
                    self.fault(Finding::new(place, found, "the name of an edge").hint(hint));
                }
                Some(_) => {}
            }
        }
        if self.findings.len() > before {
            return;
        }
        let wrong = match frame_nodes(&part.mesh, &elements.frame) {
            Some(FrameNodes::Chord(chord)) if !spans(&part.nodes, chord) => Some((
                "chord",
                "three nodes on a line",
                "three nodes that span a plane",
            )),
            Some(FrameNodes::Chord(_)) => None,
            Some(FrameNodes::Clamped(nodes)) => {
                clamped_fault(&part.mesh, &nodes).map(|(found, wanted)| ("clamped", found, wanted))
            }
            None => Some(("clamped", "a set without nodes", "a set of some nodes")),
        };
        if let Some((key, found, expected)) = wrong {
            self.fault(Finding::new(join(&frame, key), found, expected));
            return;
        }
        self.basis(&join(&pointer, "basis"), elements);
    }

    /// Damping of elements is α M + β K.
    fn element_damping(&mut self, pointer: &str, structure: &Structure) {
        let Some(damping) = &structure.damping else {
            return;
        };
        let ratios = [
            ("ratio", damping.ratio),
            ("torsion_ratio", damping.torsion_ratio),
            ("stretch_ratio", damping.stretch_ratio),
        ];
        for (key, _) in ratios.iter().filter(|(_, given)| given.is_some()) {
            let found = format!("\"{key}\" of elements");
            let expected = "\"mass\" and \"stiffness\", as elements have no modes of their own";
            self.fault(Finding::new(join(pointer, key), found, expected).of_key());
        }
        if damping.mass.is_none() && damping.stiffness.is_none() {
            let expected = "\"mass\", \"stiffness\" or both";
            self.fault(Finding::new(pointer, "no factor of damping", expected));
        }
    }

    fn stiffeners(&mut self, pointer: &str, elements: &Elements) {
        for (name, stiffener) in &elements.stiffeners {
            let place = join(pointer, name);
            if elements.structure.mesh.is_of_beams() {
                let found = "a stiffener of a mesh of beams";
                self.fault(Finding::new(&place, found, "a mesh of shells").of_key());
            } else if elements.structure.mesh.panel_elements().is_none() {
                let found = "a stiffener of a mesh without directions x and y";
                let expected = "a mesh of a generator, which has lines of nodes along them";
                self.fault(Finding::new(&place, found, expected).of_key());
            } else if steps_along(&elements.structure, stiffener.along)
                .is_some_and(|steps| !steps.is_multiple_of(2))
            {
                let found = "a stiffener along an odd number of elements of four nodes";
                let expected = "an even number, as each beam has the nodes of two of them";
                self.fault(Finding::new(join(&place, "along"), found, expected));
            }
            self.sizes(&join(&place, "section"), &stiffener.section);
        }
    }

    fn basis(&mut self, pointer: &str, elements: &Elements) {
        let ElementBasis::Reduced(keys) = &elements.basis else {
            return;
        };
        let pointer = join(pointer, "reduced");
        if keys.modes.is_some() && keys.highest_frequency.is_some() {
            let found = "\"highest_frequency\" beside \"modes\"";
            let place = join(&pointer, "highest_frequency");
            self.fault(Finding::new(place, found, "one of them").of_key());
        }
        for (k, name) in keys.interfaces.iter().flatten().enumerate() {
            if !elements.points.contains_key(name) {
                let place = join(&join(&pointer, "interfaces"), k);
                let points = elements.points.keys().map(String::as_str);
                let hint = advice(name, "points", points);
                let found = format!("\"{name}\"");
                let expected = "the name of a point of the \"elements\"";
                self.fault(Finding::new(place, found, expected).hint(hint));
            }
        }
        if self.sound() && prepare(self.document, elements).is_err() {
            let found = "elements that move without forces while their axes are held";
            let expected = "elements that hang together, for a reduced basis";
            self.fault(Finding::new(pointer, found, expected));
        }
    }

    /// A body of elements that has a set; the key of the set says of which kind it is.
    pub(super) fn loaded_elements(&mut self, pointer: &str, name: &str, set: (&str, &String)) {
        let place = join(pointer, "body");
        if name == GROUND {
            let expected = "the name of a body of elements, as ground does not move";
            self.fault(Finding::new(place, "\"ground\"", expected));
            return;
        }
        let Some(body) = self.body(&place, name) else {
            return;
        };
        let Some(elements) = &body.elements else {
            let bodies = self.document.bodies.iter();
            let suitable = bodies.filter(|(_, body)| body.elements.is_some());
            let names = suitable.map(|(name, _)| name.as_str());
            let hint = advice(name, "bodies of elements", names);
            let found = format!("\"{name}\", a body without \"elements\"");
            let expected = "a body of elements, over which the load is spread";
            self.fault(Finding::new(place, found, expected).hint(hint));
            return;
        };
        let (key, set) = set;
        let place = join(pointer, key);
        if key == "beams" && elements.structure.offset.is_some() {
            let found = "a load on beams whose section has an \"offset\"";
            let expected = "beams without an offset, as the load acts at their nodes";
            self.fault(Finding::new(place, found, expected));
            return;
        }
        // A faulty structure has no mesh to look into.
        if !self.sound() {
            return;
        }
        let mesh = part::<f64>(&elements.structure, &[], 1).mesh;
        let names: Vec<&String> = match key {
            "faces" => filled(&mesh.face_sets),
            "edges" => filled(&mesh.edge_sets),
            _ => filled(&mesh.beam_sets),
        };
        if !names.contains(&set) {
            let what = format!("sets of {key}");
            let hint = advice(set, &what, names.iter().map(|name| name.as_str()));
            let expected = format!("the name of a set of {key} of \"{name}\" that has some");
            self.fault(Finding::new(place, format!("\"{set}\""), expected).hint(hint));
        }
    }

    /// Refuses a stress of a rigid body as objective or constraint: it is zero, so every design is strong enough.
    pub(super) fn stress_of_rigid(&mut self, pointer: &str, (name, elements): (&str, &Elements)) {
        if elements.basis != ElementBasis::Rigid {
            return;
        }
        let keys = keys(pointer);
        let [_, function, ..] = &keys[..] else { return };
        if is_wanted(self.document, function) {
            let found = format!("\"{name}\", whose \"basis\" is \"rigid\"");
            let expected = "a body that deforms, as the stress of a rigid one is not known";
            self.fault(Finding::new(join(pointer, "body"), found, expected));
        }
    }

    pub(super) fn shell_stress(&mut self, pointer: &str, of: &ShellStress) {
        let body = self.document.bodies.get(&of.body);
        let Some(elements) = body.and_then(|body| body.elements.as_ref()) else {
            if !self.damage.holds("bodies", &of.body) {
                let bodies = self.document.bodies.iter();
                let shells = bodies.filter(|(_, body)| body.elements.is_some());
                let hint = advice(
                    &of.body,
                    "bodies of shells",
                    shells.map(|(name, _)| name.as_str()),
                );
                let found = format!("\"{}\"", of.body);
                let finding =
                    Finding::new(join(pointer, "body"), found, "the name of a body of shells");
                self.fault(finding.hint(hint));
            }
            return;
        };
        self.stress_of_rigid(pointer, (&of.body, elements));
        let structure = &elements.structure;
        if structure.mesh.is_of_beams() {
            let found = "a body of beams";
            let expected = "a body of shells, as these are stresses of shells";
            self.fault(Finding::new(join(pointer, "body"), found, expected));
            return;
        }
        let material = self.document.materials.get(&structure.material);
        if material.is_some_and(|material| material.yield_stress.is_none()) {
            let place = join("/materials", &structure.material);
            let found = "a material without \"yield_stress\"";
            let expected = "a yield stress, as a function compares stresses with it";
            self.fault(Finding::new(place, found, expected).of_key());
        }
        let Some(set) = &of.elements else { return };
        if self.sound() {
            let sets = part::<f64>(structure, &[], 1).mesh.face_sets;
            if sets.get(set).is_none_or(Vec::is_empty) {
                let hint = advice(set, "sets of faces", sets.keys().map(String::as_str));
                let found = format!("\"{set}\"");
                let expected = "the name of a set of elements that has some";
                self.fault(Finding::new(join(pointer, "elements"), found, expected).hint(hint));
            }
        }
    }
}

/// What is wrong with nodes that hold the axes, and what is expected.
fn clamped_fault(mesh: &Mesh, nodes: &[usize]) -> Option<(&'static str, &'static str)> {
    let all: BTreeSet<usize> = nodes.iter().copied().collect();
    let meshed: BTreeSet<usize> = (mesh.shells.iter().flatten())
        .chain(mesh.beams.iter().flatten())
        .copied()
        .collect();
    if meshed.is_subset(&all) {
        let found = "a set of all nodes";
        return Some((found, "some nodes, or \"basis\": \"rigid\" if none moves"));
    }
    // A node of a shell has no rotation about the normal.
    let on_beams = mesh.on_beams();
    let turns = all.len() == 1 && all.iter().all(|&node| !on_beams[node]);
    turns.then_some((
        "one node of a shell, about whose normal the body turns",
        "two nodes or more, such as an edge",
    ))
}
