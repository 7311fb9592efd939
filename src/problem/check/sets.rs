//! Sets of nodes, edges and elements: their names, and that they are not empty.

use super::Checker;
use crate::finding::Finding;
use crate::pointer::{advice, join};
use crate::schema::structures::{Mesh, Set, Structure, Thickness};
use crate::statics::mesh::{element_count, generated};
use std::collections::{BTreeMap, BTreeSet};

/// Name of the set of everything.
const ALL: &str = "all";

/// Names of the sets of all structures.
#[derive(Default)]
pub(super) struct Sets {
    pub(super) nodes: BTreeSet<String>,
    pub(super) edges: BTreeSet<String>,
    pub(super) faces: BTreeSet<String>,
    pub(super) beams: BTreeSet<String>,
    /// A structure is at fault, so its sets are not known.
    pub(super) unknown: bool,
}

/// A kind of set.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Nodes,
    Edges,
    Faces,
    Beams,
}

impl Kind {
    fn plural(self) -> &'static str {
        match self {
            Self::Nodes => "sets of nodes",
            Self::Edges => "sets of edges",
            Self::Faces => "sets of faces",
            Self::Beams => "sets of beams",
        }
    }

    fn wanted(self) -> &'static str {
        match self {
            Self::Nodes => "the name of a set of nodes",
            Self::Edges => "the name of a set of edges",
            Self::Faces => "the name of a set of faces",
            Self::Beams => "the name of a set of beams",
        }
    }
}

impl Sets {
    fn of(&self, kind: Kind) -> &BTreeSet<String> {
        match kind {
            Kind::Nodes => &self.nodes,
            Kind::Edges => &self.edges,
            Kind::Faces => &self.faces,
            Kind::Beams => &self.beams,
        }
    }
}

impl Checker<'_> {
    /// No set has the name of one that the generator makes.
    pub(super) fn names_of_sets(&mut self, pointer: &str, structure: &Structure) {
        let made = generated::<f64>(&structure.mesh, structure.shell_kind(), &[], 1).mesh;
        let is_made = |name: &String| {
            name == ALL
                || made.node_sets.contains_key(name)
                || made.edge_sets.contains_key(name)
                || made.face_sets.contains_key(name)
                || made.beam_sets.contains_key(name)
        };
        let mut taken: Vec<String> = (structure.sets.keys().filter(|name| is_made(name)))
            .map(|name| join(&join(pointer, "sets"), name))
            .collect();
        if let Mesh::Frame { points, members } = &structure.mesh {
            let frame = format!("{pointer}/mesh/frame");
            let named = [
                ("points", points.contains_key(ALL)),
                ("members", members.contains_key(ALL)),
            ];
            let named = named.iter().filter(|(_, named)| *named);
            taken.extend(named.map(|(key, _)| format!("{frame}/{key}/{ALL}")));
        }
        for place in taken {
            let found = "the name of a set that the mesh has anyway";
            self.fault(Finding::new(place, found, "another name").of_key());
        }
    }

    /// Every set of elements has one.
    pub(super) fn empty_sets(
        &mut self,
        pointer: &str,
        structure: &Structure,
        mesh: &crate::structures::mesh::Mesh,
    ) {
        for (name, set) in &structure.sets {
            let of =
                |sets: &BTreeMap<String, Vec<usize>>| sets.get(name).is_some_and(Vec::is_empty);
            if let Set::Elements { from, to } = set
                && (of(&mesh.face_sets) || of(&mesh.beam_sets))
            {
                let found = format!("no element between {from:?} and {to:?}");
                let expected = "corners with the middle of an element between them";
                let place = join(&join(&join(pointer, "sets"), name), "elements");
                self.fault(Finding::new(place, found, expected));
            }
        }
    }

    pub(super) fn written_set(&mut self, pointer: &str, set: &Set) {
        match set {
            Set::Node { at } => {
                if at.iter().any(|t| !(0.0..=1.0).contains(t)) {
                    let found = format!("[{}, {}]", at[0], at[1]);
                    let place = format!("{pointer}/node/at");
                    self.fault(Finding::new(place, found, "two numbers from 0 to 1"));
                }
            }
            Set::Elements { from, to } => {
                if (0..2).any(|k| from[k] >= to[k]) {
                    let found = format!("from {from:?} to {to:?}");
                    let place = format!("{pointer}/elements/to");
                    self.fault(Finding::new(
                        place,
                        found,
                        "more than \"from\" in both directions",
                    ));
                }
            }
        }
    }

    /// Groups exist, and every element has one.
    pub(super) fn groups(
        &mut self,
        pointer: &str,
        structure: &Structure,
        faces: &BTreeMap<String, Vec<usize>>,
        beams: &BTreeMap<String, Vec<usize>>,
    ) {
        let (key, groups, sets) = match (&structure.thickness, &structure.sections) {
            (Some(Thickness::Varied(varied)), _) => ("thickness", &varied.groups, faces),
            (_, Some(varied)) => ("sections", &varied.groups, beams),
            _ => return,
        };
        let Some(groups) = groups else {
            return;
        };
        let pointer = join(&join(pointer, key), "groups");
        let mut held = vec![false; element_count(&structure.mesh)];
        let mut known = true;
        for (k, group) in groups.iter().enumerate() {
            match sets.get(group) {
                Some(_) if groups[..k].contains(group) => {
                    let found = format!("\"{group}\" a second time");
                    self.fault(Finding::new(join(&pointer, k), found, "a group once"));
                }
                Some(set) => set.iter().for_each(|&e| held[e] = true),
                None => {
                    known = false;
                    let hint = advice(group, "sets", sets.keys().map(String::as_str));
                    let found = format!("\"{group}\"");
                    let expected = "the name of a set of elements of this structure";
                    self.fault(Finding::new(join(&pointer, k), found, expected).hint(hint));
                }
            }
        }
        if let (true, Some(e)) = (known, held.iter().position(|held| !held)) {
            let found = format!("no group with element {e}");
            self.fault(Finding::new(
                &pointer,
                found,
                "groups that hold every element",
            ));
        }
    }

    pub(super) fn set_among(&mut self, pointer: &str, name: &str, kind: Kind, sets: &Sets) {
        let known = sets.of(kind);
        if !known.contains(name) {
            let hint = advice(name, kind.plural(), known.iter().map(String::as_str));
            self.fault(Finding::new(pointer, format!("\"{name}\""), kind.wanted()).hint(hint));
        }
    }

    /// A set of the whole, unless some are not known.
    pub(super) fn set(&mut self, pointer: &str, name: &str, kind: Kind) {
        if !self.sets.unknown {
            let sets = std::mem::take(&mut self.sets);
            self.set_among(pointer, name, kind, &sets);
            self.sets = sets;
        }
    }
}
