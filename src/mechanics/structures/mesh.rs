//! Meshes: which nodes make which elements, and the names of sets of nodes, edges and faces.

use std::collections::BTreeMap;

use super::beam::BEAM_NODES;
use super::shell::{ShellKind, ShellNodes};
use crate::math::ArrayVec;

/// The nodes of an edge of a shell, in a row: three of MITC9, two of MITC4.
pub type Edge = ArrayVec<usize, 3>;

/// The four edges of a shell, along s = −1, r = +1, s = +1, r = −1.
pub fn shell_edges(nodes: &ShellNodes) -> [Edge; 4] {
    let of = |edges: [[usize; 3]; 4], count: usize| {
        edges.map(|edge| Edge::from_fn(count, |k| nodes[edge[k]]))
    };
    match ShellKind::of(nodes) {
        ShellKind::Mitc9 => of([[0, 1, 2], [2, 5, 8], [6, 7, 8], [0, 3, 6]], 3),
        ShellKind::Mitc4 => of([[0, 1, 0], [1, 3, 0], [2, 3, 0], [0, 2, 0]], 2),
    }
}

/// A mesh of shells of nine or four nodes and three-node beams. The nodes of a shell are row by row along r, of which
/// the next is at a larger s; the normal is a_r × a_s.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Number of nodes.
    pub nodes: usize,
    /// Nodes of each shell.
    pub shells: Vec<ShellNodes>,
    /// Nodes of each beam: an end, the middle, the other end.
    pub beams: Vec<[usize; BEAM_NODES]>,
    /// Nodes by the name of their set.
    pub node_sets: BTreeMap<String, Vec<usize>>,
    /// Edges by the name of their set.
    pub edge_sets: BTreeMap<String, Vec<Edge>>,
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
        let shells = self.shells.iter().map(|nodes| &nodes[..]);
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
    pub fn edge_set(&self, name: &str) -> Result<&[Edge], UnknownSet> {
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
