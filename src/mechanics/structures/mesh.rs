//! Meshes: which nodes make which elements, and the names of sets of nodes, edges and faces.

use std::collections::BTreeMap;

use super::beam::BEAM_NODES;
use super::shell::NODES;

/// Local nodes of the four edges of a shell element, along s = −1, r = +1, s = +1, r = −1.
pub const SHELL_EDGES: [[usize; 3]; 4] = [[0, 1, 2], [2, 5, 8], [6, 7, 8], [0, 3, 6]];

/// A mesh of nine-node shells and three-node beams. Node k = 3j + i of an element is at (r, s) = (i
/// − 1, j − 1); the normal is a_r × a_s.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Number of nodes.
    pub nodes: usize,
    /// Nodes of each shell.
    pub shells: Vec<[usize; NODES]>,
    /// Nodes of each beam: an end, the middle, the other end.
    pub beams: Vec<[usize; BEAM_NODES]>,
    /// Nodes by the name of their set.
    pub node_sets: BTreeMap<String, Vec<usize>>,
    /// Edges (three nodes in a row) by the name of their set.
    pub edge_sets: BTreeMap<String, Vec<[usize; 3]>>,
    /// Shells by the name of their set.
    pub face_sets: BTreeMap<String, Vec<usize>>,
    /// Beams by the name of their set.
    pub beam_sets: BTreeMap<String, Vec<usize>>,
}

/// A name that no set of the mesh has.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("no {kind} of the name \"{name}\"; there are: {known}")]
pub struct UnknownSet {
    /// Kind of the set.
    pub kind: &'static str,
    /// The name.
    pub name: String,
    /// The names that exist, with commas between.
    pub known: String,
}

fn find<'a, T>(
    sets: &'a BTreeMap<String, Vec<T>>,
    kind: &'static str,
    name: &str,
) -> Result<&'a [T], UnknownSet> {
    sets.get(name).map(Vec::as_slice).ok_or_else(|| UnknownSet {
        kind,
        name: name.to_owned(),
        known: sets.keys().cloned().collect::<Vec<_>>().join(", "),
    })
}

impl Mesh {
    /// The nodes of each element.
    pub fn elements(&self) -> impl Iterator<Item = &[usize]> {
        let shells = self.shells.iter().map(|nodes| nodes.as_slice());
        shells.chain(self.beams.iter().map(|nodes| nodes.as_slice()))
    }

    /// Number of parts of the elements that share no node.
    pub fn parts(&self) -> usize {
        // By node: another one of its part, itself for one of them.
        let mut same: Vec<usize> = (0..self.nodes).collect();
        let root = |same: &mut Vec<usize>, mut node: usize| {
            while same[node] != node {
                same[node] = same[same[node]];
                node = same[node];
            }
            node
        };
        let mut used = vec![false; self.nodes];
        for nodes in self.elements() {
            for &node in nodes {
                used[node] = true;
                let [a, b] = [nodes[0], node].map(|node| root(&mut same, node));
                same[b] = a;
            }
        }
        (0..self.nodes)
            .filter(|&node| used[node] && same[node] == node)
            .count()
    }

    /// Which nodes belong to beams.
    pub fn on_beams(&self) -> Vec<bool> {
        let mut all = vec![false; self.nodes];
        for &node in self.beams.iter().flatten() {
            all[node] = true;
        }
        all
    }

    /// The beams of a set.
    ///
    /// # Errors
    /// [`UnknownSet`] if there is none of this name.
    pub fn beam_set(&self, name: &str) -> Result<&[usize], UnknownSet> {
        find(&self.beam_sets, "set of beams", name)
    }

    /// The nodes of a set.
    ///
    /// # Errors
    /// [`UnknownSet`] if there is none of this name.
    pub fn node_set(&self, name: &str) -> Result<&[usize], UnknownSet> {
        find(&self.node_sets, "set of nodes", name)
    }

    /// The edges of a set.
    ///
    /// # Errors
    /// [`UnknownSet`] if there is none of this name.
    pub fn edge_set(&self, name: &str) -> Result<&[[usize; 3]], UnknownSet> {
        find(&self.edge_sets, "set of edges", name)
    }

    /// The shells of a set.
    ///
    /// # Errors
    /// [`UnknownSet`] if there is none of this name.
    pub fn face_set(&self, name: &str) -> Result<&[usize], UnknownSet> {
        find(&self.face_sets, "set of faces", name)
    }
}
