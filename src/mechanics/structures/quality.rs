//! Faults of a mesh: loose nodes, inverted or warped elements, mid nodes out of place.

use super::mesh::{Edge, Mesh, shell_edges};
use super::sheets::{corner_tangents, fold_angle, normal};
use super::shell::basis::Basis;
use super::shell::{ShellKind, ShellNodes};
use crate::math::Vec3;
use std::collections::HashMap;

/// A fault of a mesh, with the number of the element or node.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MeshFault {
    /// An element names a node that does not exist.
    #[error("shell {shell} names node {node}, and there are {nodes} nodes")]
    UnknownNode {
        /// The element.
        shell: usize,
        /// The node.
        node: usize,
        /// How many there are.
        nodes: usize,
    },
    /// A node occurs twice in an element.
    #[error("shell {shell} names node {node} twice")]
    RepeatedNode {
        /// The element.
        shell: usize,
        /// The node.
        node: usize,
    },
    /// A node belongs to no element.
    #[error("node {node} is loose: no element has it")]
    LooseNode {
        /// The node.
        node: usize,
    },
    /// A place that is not finite.
    #[error("node {node} has no finite place")]
    NoPlace {
        /// The node.
        node: usize,
    },
    /// The normal of an element turns over within it, or its area vanishes.
    #[error(
        "shell {shell} is inverted or folded: its normal at local node {local} turns by more than \
         80 degrees from that of its centre, or its area vanishes there"
    )]
    Inverted {
        /// The element.
        shell: usize,
        /// The local node.
        local: usize,
    },
    /// A middle node is far from the middle.
    #[error(
        "shell {shell}: its middle node {local} stands at {fraction:.3} of its edge, not near 0.5 \
         (allowed are 0.3 to 0.7): is the order of the nodes right?"
    )]
    MiddleNode {
        /// The element.
        shell: usize,
        /// The local node.
        local: usize,
        /// Its position along the edge.
        fraction: f64,
    },
    /// A beam names a node that does not exist, or one twice.
    #[error("beam {beam} names node {node}, which does not exist or which it names twice")]
    BeamNode {
        /// The beam.
        beam: usize,
        /// The node.
        node: usize,
    },
    /// The middle node of a beam is far from the middle, or the beam turns back.
    #[error(
        "beam {beam}: its middle node stands at {fraction:.3} of its length, not near 0.5 (allowed are \
         0.3 to 0.7), or the beam turns back within itself: is the order of the nodes right?"
    )]
    BeamShape {
        /// The beam.
        beam: usize,
        /// Position of the middle node along the chord.
        fraction: f64,
    },
    /// A beam without an orientation.
    #[error("there are {beams} beams and {orientations} orientations")]
    Orientations {
        /// Number of beams.
        beams: usize,
        /// Number of orientations.
        orientations: usize,
    },
    /// The orientation of a beam runs along it.
    #[error(
        "beam {beam}: its orientation is nothing or runs along the beam within 1e-3 rad at node {local} \
         of it, so its section has no axis 2; give another vector"
    )]
    Orientation {
        /// The beam.
        beam: usize,
        /// The local node.
        local: usize,
    },
    /// Two elements at an edge have opposite normals.
    #[error("shells {first} and {second} share an edge and are wound in opposite directions")]
    OppositeNormals {
        /// An element.
        first: usize,
        /// Its neighbour.
        second: usize,
    },
}

impl MeshFault {
    /// The shell or beam at fault, if it is one.
    pub fn element(&self) -> Option<usize> {
        match *self {
            Self::UnknownNode { shell, .. }
            | Self::RepeatedNode { shell, .. }
            | Self::Inverted { shell, .. }
            | Self::MiddleNode { shell, .. } => Some(shell),
            Self::BeamNode { beam, .. }
            | Self::BeamShape { beam, .. }
            | Self::Orientation { beam, .. } => Some(beam),
            Self::OppositeNormals { second, .. } => Some(second),
            Self::LooseNode { .. } | Self::NoPlace { .. } | Self::Orientations { .. } => None,
        }
    }
}

/// All faults of a mesh with nodes at these places \[m\].
pub fn faults(mesh: &Mesh, nodes: &[Vec3<f64>]) -> Vec<MeshFault> {
    let at_edges = elements_at_edges(mesh);
    let mut all = connectivity(mesh, &at_edges);
    if !all.is_empty() {
        return all;
    }
    for (node, place) in nodes.iter().enumerate() {
        if place.iter().any(|x| !x.is_finite()) {
            all.push(MeshFault::NoPlace { node });
        }
    }
    if all.is_empty() {
        for (shell, element) in mesh.shells.iter().enumerate() {
            all.extend(shape(shell, element, nodes));
        }
        all.extend(opposite_sheets((mesh, nodes), &at_edges));
        for (beam, element) in mesh.beams.iter().enumerate() {
            all.extend(beam_shape(beam, &element.map(|k| nodes[k])));
        }
    }
    all
}

fn connectivity(mesh: &Mesh, at_edges: &AtEdges) -> Vec<MeshFault> {
    let mut used = vec![false; mesh.nodes];
    let mut all = Vec::new();
    for (shell, element) in mesh.shells.iter().enumerate() {
        for (k, &node) in element.iter().enumerate() {
            if node >= mesh.nodes {
                let nodes = mesh.nodes;
                all.push(MeshFault::UnknownNode { shell, node, nodes });
            } else if element[..k].contains(&node) {
                all.push(MeshFault::RepeatedNode { shell, node });
            } else {
                used[node] = true;
            }
        }
    }
    for (beam, element) in mesh.beams.iter().enumerate() {
        for (k, &node) in element.iter().enumerate() {
            if node >= mesh.nodes || element[..k].contains(&node) {
                all.push(MeshFault::BeamNode { beam, node });
            } else {
                used[node] = true;
            }
        }
    }
    let loose = used.iter().enumerate().filter(|(_, used)| !**used);
    all.extend(loose.map(|(node, _)| MeshFault::LooseNode { node }));
    all.extend(opposite_normals(at_edges));
    all
}

/// The elements at each edge with the direction in which it is written. An element's boundary runs along its edges in turn,
/// and its neighbour runs through the same edge backwards.
type AtEdges = HashMap<Edge, Vec<usize>>;

fn elements_at_edges(mesh: &Mesh) -> AtEdges {
    let mut all = AtEdges::new();
    for (shell, element) in mesh.shells.iter().enumerate() {
        for (k, mut nodes) in shell_edges(element).into_iter().enumerate() {
            if k >= 2 {
                nodes.reverse();
            }
            all.entry(nodes).or_default().push(shell);
        }
    }
    all
}

fn backwards(edge: &Edge) -> Edge {
    let mut out = *edge;
    out.reverse();
    out
}

/// Edges of two elements that both run through in the same direction.
fn opposite_normals(at_edges: &AtEdges) -> Vec<MeshFault> {
    let opposite = |(edge, shells): (&Edge, &Vec<usize>)| {
        let others = at_edges.get(&backwards(edge)).map_or(0, Vec::len);
        match (shells.as_slice(), others) {
            (&[first, second], 0) => Some([first, second]),
            _ => None,
        }
    };
    in_order(at_edges.iter().filter_map(opposite).collect())
}

/// Elements that meet others at an edge, continue each other smoothly there, and run through it in the same direction.
fn opposite_sheets((mesh, nodes): (&Mesh, &[Vec3<f64>]), at_edges: &AtEdges) -> Vec<MeshFault> {
    // At the edge, where directors are.
    let normal_at = |shell: usize, edge: &Edge| -> Vec3<f64> {
        let element = &mesh.shells[shell];
        let at_edge = (0..element.len()).filter(|&local| edge.contains(&element[local]));
        let normals = at_edge.map(|local| normal(&corner_tangents(element, local, nodes)));
        normals.sum::<Vec3<f64>>().normalize()
    };
    let mut all = Vec::new();
    for (edge, shells) in at_edges {
        let others = at_edges.get(&backwards(edge)).map_or(0, Vec::len);
        if shells.len() < 2 || shells.len() + others < 3 {
            continue;
        }
        for (k, &first) in shells.iter().enumerate() {
            for &second in &shells[k + 1..] {
                let fold = fold_angle(ShellKind::of(&mesh.shells[first]));
                if normal_at(first, edge).dot(&normal_at(second, edge)) < -fold.cos() {
                    all.push([first.min(second), first.max(second)]);
                }
            }
        }
    }
    let mut faults = in_order(all);
    faults.dedup();
    faults
}

fn in_order(mut pairs: Vec<[usize; 2]>) -> Vec<MeshFault> {
    pairs.sort_unstable();
    let fault = |[first, second]: [usize; 2]| MeshFault::OppositeNormals { first, second };
    pairs.into_iter().map(fault).collect()
}

/// A normal of an element, not of unit length, and the lengths of its tangents multiplied.
type Normal = (Vec3<f64>, f64);

/// The normals of an element in its middle and at its nodes.
fn normals(element: &ShellNodes, nodes: &[Vec3<f64>]) -> (Normal, Vec<Normal>) {
    let x = element.gather(Vec3::zeros(), |node| nodes[node]);
    let normal = |basis: &Basis| {
        let along = |by| -> Vec3<f64> {
            let terms = x.iter().zip(by);
            terms.map(|(x, n): (&Vec3<f64>, &f64)| x * *n).sum()
        };
        let [r, s] = basis.by.each_ref().map(along);
        (r.cross(&s), r.norm() * s.norm())
    };
    let tables = ShellKind::of(element).tables();
    (
        normal(&tables.middle),
        tables.nodes.iter().map(normal).collect(),
    )
}

/// The shell within which the normal turns most from that of its middle, and by how much \[rad\]. It needs a mesh without faults.
pub fn most_turned(mesh: &Mesh, nodes: &[Vec3<f64>]) -> Option<(usize, f64)> {
    let turn = |element: &ShellNodes| {
        let ((centre, _), others) = normals(element, nodes);
        let angles = others.iter().map(|(n, _)| n.angle(&centre));
        angles.fold(0.0, f64::max)
    };
    let all = mesh.shells.iter().map(turn).enumerate();
    all.max_by(|a, b| a.1.total_cmp(&b.1))
}

fn shape(shell: usize, element: &ShellNodes, nodes: &[Vec3<f64>]) -> Option<MeshFault> {
    let kind = ShellKind::of(element);
    let ((centre, size), others) = normals(element, nodes);
    let flat = centre.norm() <= 1e-6 * size || size == 0.0;
    for (local, (n, size)) in others.into_iter().enumerate() {
        let turned = n.dot(&centre) <= 80.0_f64.to_radians().cos() * n.norm() * centre.norm();
        if flat || turned || n.norm() <= 1e-6 * size {
            return Some(MeshFault::Inverted { shell, local });
        }
    }
    if kind == ShellKind::Mitc4 {
        return None;
    }
    let x = element.gather(Vec3::zeros(), |node| nodes[node]);
    let rows = [
        [0, 1, 2],
        [3, 4, 5],
        [6, 7, 8],
        [0, 3, 6],
        [1, 4, 7],
        [2, 5, 8],
    ];
    for [first, local, last] in rows {
        let chord = x[last] - x[first];
        let fraction = (x[local] - x[first]).dot(&chord) / chord.norm_squared();
        if !(0.3..=0.7).contains(&fraction) {
            return Some(MeshFault::MiddleNode {
                shell,
                local,
                fraction,
            });
        }
    }
    None
}

fn beam_shape(beam: usize, x: &[Vec3<f64>; 3]) -> Option<MeshFault> {
    let chord = x[2] - x[0];
    let fraction = (x[1] - x[0]).dot(&chord) / chord.norm_squared();
    // The tangents at both ends go forwards.
    let ends = [
        x[1] * 4.0 - x[0] * 3.0 - x[2],
        x[0] + x[2] * 3.0 - x[1] * 4.0,
    ];
    let forwards = ends.iter().all(|t| t.dot(&chord) > 0.0);
    let sound = forwards && (0.3..=0.7).contains(&fraction);
    (!sound).then_some(MeshFault::BeamShape { beam, fraction })
}

/// Orientations that are missing or run along their beams. The mesh has no other faults.
pub fn orientation_faults(
    mesh: &Mesh,
    nodes: &[Vec3<f64>],
    orientations: &[Vec3<f64>],
) -> Vec<MeshFault> {
    if mesh.beams.len() != orientations.len() {
        return vec![MeshFault::Orientations {
            beams: mesh.beams.len(),
            orientations: orientations.len(),
        }];
    }
    let mut all = Vec::new();
    for (beam, (element, v)) in mesh.beams.iter().zip(orientations).enumerate() {
        let x = element.map(|k| nodes[k]);
        let tangents = [
            x[1] * 4.0 - x[0] * 3.0 - x[2],
            x[2] - x[0],
            x[0] + x[2] * 3.0 - x[1] * 4.0,
        ];
        let along = |t: &Vec3<f64>| {
            let sine = t.cross(v).norm() / (t.norm() * v.norm());
            sine.is_nan() || sine <= 1e-3
        };
        if let Some(local) = tangents.iter().position(along) {
            all.push(MeshFault::Orientation { beam, local });
        }
    }
    all
}
