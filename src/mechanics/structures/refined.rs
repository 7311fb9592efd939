//! Meshes of which every element is cut into smaller ones on its own geometry.

use super::beam::BEAM_NODES;
use super::mesh::{Mesh, SHELL_EDGES};
use super::shell::NODES;
use super::shell::basis::Basis;
use crate::math::Vec3;
use std::collections::{BTreeMap, BTreeSet, HashMap};

/// A mesh of cut elements. Its first nodes are those of the mesh that was cut.
#[derive(Clone, Debug)]
pub struct Refined {
    /// The mesh, with the sets of the one that was cut.
    pub mesh: Mesh,
    /// Places of the nodes \[m\].
    pub nodes: Vec<Vec3<f64>>,
    /// The element from which each shell, then each beam was cut, numbered in the same way.
    pub parents: Vec<usize>,
}

/// Cuts every element `cuts` times along each direction. A new node is in the sets that have all nodes of
/// the edge or, if it is on none, of the shell on which it stands.
pub fn refined(mesh: &Mesh, nodes: &[Vec3<f64>], cuts: usize) -> Refined {
    let mut grid = Grid {
        cuts,
        nodes: nodes.to_vec(),
        carriers: Vec::new(),
        on_edges: HashMap::new(),
    };
    let mut out = Mesh::default();
    let mut parents = Vec::new();
    for (shell, element) in mesh.shells.iter().enumerate() {
        let points = grid.shell(element);
        let wide = 2 * cuts + 1;
        for (j, i) in (0..cuts).flat_map(|j| (0..cuts).map(move |i| (j, i))) {
            let point = |k: usize| points[(2 * j + k / 3) * wide + 2 * i + k % 3];
            out.shells.push(std::array::from_fn(point));
            parents.push(shell);
        }
    }
    for (beam, element) in mesh.beams.iter().enumerate() {
        let points = grid.edge(element);
        out.beams.extend(pieces(&points));
        parents.extend(std::iter::repeat_n(mesh.shells.len() + beam, cuts));
    }
    let children = |own: &Vec<usize>, each: usize| -> Vec<usize> {
        (own.iter().flat_map(|&e| e * each..(e + 1) * each)).collect()
    };
    let of_elements = |sets: &BTreeMap<String, Vec<usize>>, each: usize| {
        let sets = sets.iter();
        sets.map(|(name, own)| (name.clone(), children(own, each)))
            .collect()
    };
    out.face_sets = of_elements(&mesh.face_sets, cuts * cuts);
    out.beam_sets = of_elements(&mesh.beam_sets, cuts);
    for (name, edges) in &mesh.edge_sets {
        let edges = edges.iter().flat_map(|edge| pieces(&grid.edge(edge)));
        out.edge_sets.insert(name.clone(), edges.collect());
    }
    for (name, own) in &mesh.node_sets {
        let all: BTreeSet<usize> = own.iter().copied().collect();
        let new = grid.carriers.iter().enumerate();
        let new = new.filter(|(_, carriers)| carriers.iter().all(|node| all.contains(node)));
        let new = new.map(|(k, _)| mesh.nodes + k);
        let own = own.iter().copied().chain(new).collect();
        out.node_sets.insert(name.clone(), own);
    }
    out.nodes = grid.nodes.len();
    Refined {
        mesh: out,
        nodes: grid.nodes,
        parents,
    }
}

/// The three nodes of each piece of a line of points.
fn pieces(points: &[usize]) -> Vec<[usize; BEAM_NODES]> {
    let starts = (0..points.len() - 1).step_by(2);
    starts
        .map(|k| [points[k], points[k + 1], points[k + 2]])
        .collect()
}

struct Grid {
    cuts: usize,
    nodes: Vec<Vec3<f64>>,
    /// Of each new node: the nodes of the edge or of the shell on which it stands.
    carriers: Vec<Vec<usize>>,
    /// New nodes on edges, by the ends of the edge, the smaller one first, its middle node, and their place.
    on_edges: HashMap<([usize; 3], usize), usize>,
}

impl Grid {
    fn add(&mut self, carriers: &[usize], weights: &[f64]) -> usize {
        let places = carriers.iter().zip(weights);
        let place = places.fold(Vec3::zeros(), |sum, (&node, w)| sum + self.nodes[node] * *w);
        self.nodes.push(place);
        self.carriers.push(carriers.to_vec());
        self.nodes.len() - 1
    }

    /// The points of an edge or a beam from its first node to its last.
    fn edge(&mut self, &[first, middle, last]: &[usize; 3]) -> Vec<usize> {
        let steps = 2 * self.cuts;
        let one = |t: usize| match t {
            0 => first,
            t if t == self.cuts => middle,
            t if t == steps => last,
            t => {
                let (ends, from) = match first < last {
                    true => ([first, middle, last], t),
                    false => ([last, middle, first], steps - t),
                };
                if let Some(&node) = self.on_edges.get(&(ends, from)) {
                    return node;
                }
                // Of an edge s = −1 the first three shape functions are those of a line.
                let basis = Basis::at(self.coordinate(from), -1.0);
                let node = self.add(&ends, &basis.n[..3]);
                self.on_edges.insert((ends, from), node);
                node
            }
        };
        (0..=steps).map(one).collect()
    }

    fn coordinate(&self, step: usize) -> f64 {
        step as f64 / self.cuts as f64 - 1.0
    }

    /// The points of a shell, row by row.
    fn shell(&mut self, element: &[usize; NODES]) -> Vec<usize> {
        let (cuts, wide) = (self.cuts, 2 * self.cuts + 1);
        let mut all = vec![usize::MAX; wide * wide];
        for (k, edge) in SHELL_EDGES.iter().enumerate() {
            let points = self.edge(&edge.map(|local| element[local]));
            for (t, point) in points.into_iter().enumerate() {
                let (i, j) = [(t, 0), (2 * cuts, t), (t, 2 * cuts), (0, t)][k];
                all[j * wide + i] = point;
            }
        }
        for (j, i) in (1..2 * cuts).flat_map(|j| (1..2 * cuts).map(move |i| (j, i))) {
            all[j * wide + i] = match (i, j) {
                (i, j) if i == cuts && j == cuts => element[NODES / 2],
                _ => {
                    let basis = Basis::at(self.coordinate(i), self.coordinate(j));
                    self.add(element, &basis.n)
                }
            };
        }
        all
    }
}
