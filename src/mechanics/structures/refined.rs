//! Meshes of which every element is cut into smaller ones on its own geometry.

use super::mesh::{Edge, Mesh, shell_edges};
use super::shell::{ShellKind, ShellNodes};
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
        let order = ShellKind::of(element).order();
        let (wide, row) = (order * cuts + 1, order + 1);
        for (j, i) in (0..cuts).flat_map(|j| (0..cuts).map(move |i| (j, i))) {
            let point = |k: usize| points[(order * j + k / row) * wide + order * i + k % row];
            out.shells.push(ShellNodes::from_fn(row * row, point));
            parents.push(shell);
        }
    }
    for (beam, element) in mesh.beams.iter().enumerate() {
        let points = grid.edge(&(*element).into());
        let all = pieces(&points, 2).into_iter();
        out.beams.extend(all.map(|own| [own[0], own[1], own[2]]));
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
        let edges = edges
            .iter()
            .flat_map(|edge| pieces(&grid.edge(edge), edge.len() - 1));
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

/// The nodes of each piece of a line of points, `order` steps long.
fn pieces(points: &[usize], order: usize) -> Vec<Edge> {
    let starts = (0..points.len() - 1).step_by(order);
    starts
        .map(|k| Edge::from_fn(order + 1, |i| points[k + i]))
        .collect()
}

struct Grid {
    cuts: usize,
    nodes: Vec<Vec3<f64>>,
    /// Of each new node: the nodes of the edge or of the shell on which it stands.
    carriers: Vec<Vec<usize>>,
    /// New nodes on edges, by the nodes of the edge, the smaller end first, and their place.
    on_edges: HashMap<(Edge, usize), usize>,
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
    fn edge(&mut self, edge: &Edge) -> Vec<usize> {
        let order = edge.len() - 1;
        let kind = match order {
            1 => ShellKind::Mitc4,
            _ => ShellKind::Mitc9,
        };
        let steps = order * self.cuts;
        let mut ends = *edge;
        let forwards = edge[0] < edge[order];
        if !forwards {
            ends.reverse();
        }
        let one = |t: usize| {
            if t.is_multiple_of(self.cuts) {
                return edge[t / self.cuts];
            }
            let from = if forwards { t } else { steps - t };
            if let Some(&node) = self.on_edges.get(&(ends, from)) {
                return node;
            }
            // Of an edge s = −1 the first shape functions are those of a line.
            let basis = kind.basis(self.coordinate(from, order), -1.0);
            let node = self.add(&ends, &basis.n[..=order]);
            self.on_edges.insert((ends, from), node);
            node
        };
        (0..=steps).map(one).collect()
    }

    /// From −1 to 1 along an edge.
    fn coordinate(&self, step: usize, order: usize) -> f64 {
        2.0 * step as f64 / (order * self.cuts) as f64 - 1.0
    }

    /// The points of a shell, row by row.
    fn shell(&mut self, element: &ShellNodes) -> Vec<usize> {
        let (cuts, kind) = (self.cuts, ShellKind::of(element));
        let order = kind.order();
        let (steps, wide) = (order * cuts, order * cuts + 1);
        let mut all = vec![usize::MAX; wide * wide];
        for (k, edge) in shell_edges(element).iter().enumerate() {
            let points = self.edge(edge);
            for (t, point) in points.into_iter().enumerate() {
                let (i, j) = [(t, 0), (steps, t), (t, steps), (0, t)][k];
                all[j * wide + i] = point;
            }
        }
        for (j, i) in (1..steps).flat_map(|j| (1..steps).map(move |i| (j, i))) {
            all[j * wide + i] = match (i, j) {
                // The node in the middle of nine.
                (i, j) if i == cuts && j == cuts && order == 2 => element[4],
                _ => {
                    let at = [i, j].map(|step| self.coordinate(step, order));
                    let basis = kind.basis(at[0], at[1]);
                    self.add(element, &basis.n)
                }
            };
        }
        all
    }
}
