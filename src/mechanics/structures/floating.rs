//! Shells as bodies that move: the numbers of a mesh for a floating frame, and how its nodes and edges move
//! with the coordinates.

use super::assembly::Assembly;
use super::mesh::{Edge, Mesh, UnknownSet};
use super::shell::{ShellKind, ShellNodes};
use super::state::Configuration;
use super::structure::Structure;
use super::supports::{NodeUnknowns, Rotations, Support, Tangents};
use crate::math::{Mat3, Scalar, Vec3};
use crate::model::element_operators::{Columns, Symmetric};
use crate::model::finite::{
    ElementMesh, FiniteElements, NODES, QUADRATIC, Rotation, SQUARES, ShellElement,
};
use std::collections::BTreeMap;
use std::sync::{Arc, OnceLock};

/// What holds the axes of a body of shells.
#[derive(Clone, Debug)]
pub enum FrameNodes {
    /// Nodes O, B, C: O is where it was, B stays on the line from O, C in the plane of the three. Of B all
    /// displacements are held but that most along the line, of C that most along the normal.
    Chord([usize; 3]),
    /// Nodes that do not move.
    Clamped(Vec<usize>),
}

/// The component of a vector that is largest.
fn largest(v: &Vec3<f64>) -> usize {
    let all = (0..3).max_by(|&i, &j| v[i].abs().total_cmp(&v[j].abs()));
    all.unwrap_or(0)
}

/// The sine of the angle at O below which three nodes count as on a line.
const ON_LINE: f64 = 0.01;

/// Whether three nodes span a plane.
pub fn spans(nodes: &[Vec3<f64>], [o, b, c]: [usize; 3]) -> bool {
    let (b, c) = (nodes[b] - nodes[o], nodes[c] - nodes[o]);
    b.cross(&c).norm() > ON_LINE * b.norm() * c.norm()
}

/// An edge is straight if its nodes are off their line by less than this part of its length.
const STRAIGHT: f64 = 1e-4;

/// Whether the nodes of an edge lie on a line.
pub fn is_straight(nodes: &[Vec3<f64>], edges: &[Edge]) -> bool {
    let all: Vec<Vec3<f64>> = edges.iter().flatten().map(|&node| nodes[node]).collect();
    let Some(&first) = all.first() else {
        return true;
    };
    let [start, end] = ends(&all, first);
    let along = end - start;
    let off = |x: &Vec3<f64>| (x - start).cross(&along).norm();
    all.iter()
        .all(|x| off(x) <= STRAIGHT * along.norm_squared())
}

/// The point farthest from `from`, and the one farthest from that.
fn ends(points: &[Vec3<f64>], from: Vec3<f64>) -> [Vec3<f64>; 2] {
    let far = |from: Vec3<f64>| {
        let distance = |x: &Vec3<f64>| (x - from).norm();
        let far = points.iter().copied();
        far.max_by(|a, b| distance(a).total_cmp(&distance(b)))
            .unwrap_or(from)
    };
    let start = far(from);
    [start, far(start)]
}

/// The normal of the surface of shells at a node, not of length one; zero at nodes without shells.
pub fn normal(mesh: &Mesh, nodes: &[Vec3<f64>], node: usize) -> Vec3<f64> {
    let mut sum = Vec3::zeros();
    for element in &mesh.shells {
        let Some(local) = element.iter().position(|&own| own == node) else {
            continue;
        };
        let tangent = |k: usize| {
            let by = &ShellKind::of(element).tables().nodes[local].by[k];
            let all = element.iter().zip(by);
            all.fold(Vec3::zeros(), |sum: Vec3<f64>, (&b, n)| sum + nodes[b] * *n)
        };
        sum += tangent(0).cross(&tangent(1));
    }
    sum
}

/// The mesh of a structure of shells in a floating frame. Its nodes are in the axes of the frame.
///
/// # Errors
/// None for sets that are made here.
pub fn element_mesh(
    structure: &Structure<f64>,
    frame: &FrameNodes,
) -> Result<(ElementMesh, Surface), UnknownSet> {
    let mut held = structure.clone();
    let topology = Arc::make_mut(&mut held.topology);
    let mut supports = Vec::new();
    let mut hold =
        |name: &str, nodes: Vec<usize>, displacements: [bool; 3], rotations: [bool; 3]| {
            topology.mesh.node_sets.insert(name.to_owned(), nodes);
            supports.push(Support::of(name, displacements, rotations));
        };
    match frame {
        FrameNodes::Chord([o, b, c]) => {
            let (along, aside) = (
                structure.nodes[*b] - structure.nodes[*o],
                structure.nodes[*c] - structure.nodes[*o],
            );
            let (line, normal) = (largest(&along), largest(&along.cross(&aside)));
            let none = [false; 3];
            hold("frame, origin", vec![*o], [true; 3], none);
            hold("frame, line", vec![*b], [0, 1, 2].map(|k| k != line), none);
            hold(
                "frame, plane",
                vec![*c],
                [0, 1, 2].map(|k| k == normal),
                none,
            );
        }
        FrameNodes::Clamped(nodes) => {
            hold("frame, clamped", nodes.clone(), [true; 3], [true; 3]);
        }
    }
    let assembly = Assembly::new(&held, &supports, NodeUnknowns::Natural)?;
    let configuration = assembly.configuration(&held);
    let unknowns = &assembly.unknowns;
    let elements = (0..held.topology.mesh.shells.len()).map(|i| element(&configuration, i));
    let surface = Surface::of(&configuration);
    let mesh = ElementMesh {
        coordinates: unknowns.count,
        elements: elements.collect(),
        nodes: held.nodes.clone(),
        displacements: unknowns.nodes.iter().map(|at| at.displacements).collect(),
        parts: Vec::new(),
        beams: held.topology.mesh.beams.clone(),
    };
    Ok((mesh, surface))
}

fn element(configuration: &Configuration<f64>, index: usize) -> ShellElement {
    let shell = configuration.shell(index);
    let nodes = configuration.structure.topology.mesh.shells[index];
    let axes = configuration.element_axes(index);
    let operators = shell.operators(&axes);
    let mut points = [Vec3::zeros(); 2 * NODES];
    points[..NODES].copy_from_slice(&shell.geometry.points);
    points[NODES..].copy_from_slice(&shell.geometry.directors);
    let (mut coordinates, mut moves) = (Vec::new(), Vec::new());
    for (a, &node) in nodes.iter().enumerate() {
        for (k, displacement) in configuration.unknowns.nodes[node]
            .displacements
            .iter()
            .enumerate()
        {
            coordinates.push(*displacement);
            moves.push((a, Vec3::ith(k, 1.0)));
        }
    }
    for (a, &node) in nodes.iter().enumerate() {
        for (axis, unknown) in axes.axes[a]
            .iter()
            .zip(configuration.unknowns.rotations_of(node))
        {
            coordinates.push(Some(unknown));
            moves.push((NODES + a, axis.cross(&shell.geometry.directors[a])));
        }
    }
    let mut shares = [[0.0; NODES]; NODES];
    let mut area = 0.0;
    for (k, basis) in shell.gauss() {
        let own = shell.area(k);
        area += own;
        for (a, n) in basis.n.iter().enumerate() {
            for (b, other) in basis.n.iter().enumerate() {
                shares[a][b] += own * n * other;
            }
        }
    }
    let displacements = 3 * nodes.len();
    let second = |points: &[Vec3<f64>]| {
        let mut sum = Mat3::zeros();
        for (a, x) in points.iter().enumerate() {
            for (b, y) in points.iter().enumerate() {
                sum += x * y.transpose() * shares[a][b];
            }
        }
        sum
    };
    ShellElement {
        nodes,
        coordinates,
        second: [second(&points[..NODES]), second(&points[NODES..])],
        points,
        shares,
        area,
        membrane: Columns::of(
            (0..displacements).map(|i| std::array::from_fn(|p| operators.membrane[p][i])),
        ),
        slopes: Columns::of((0..displacements).map(|i| {
            std::array::from_fn(|p| match p < QUADRATIC {
                true => operators.slopes[p][0][i],
                false => operators.slopes[p - QUADRATIC + SQUARES][1][i],
            })
        })),
        plane: operators.plane,
        shear: Columns::of(
            (0..moves.len()).map(|i| std::array::from_fn(|p| operators.shear[p][i])),
        ),
        linear: operators.linear.map(|all| Symmetric::of(&all, moves.len())),
        stress: OnceLock::new(),
        moves,
        turns: turns(configuration, &nodes),
        poisson: shell.material.poisson,
        yield_stress: shell.material.yield_stress,
    }
}

/// Node and axis of the rotations of an element, if they can follow any rotation of it.
fn turns(configuration: &Configuration<f64>, nodes: &ShellNodes) -> Vec<Rotation> {
    let mut all = Vec::new();
    for (node, &at) in nodes.iter().enumerate() {
        match configuration.unknowns.nodes[at].rotations {
            Rotations::Global([true, true, true]) | Rotations::Smooth(Tangents::Both(_), _) => {}
            _ => return Vec::new(),
        }
        let (axes, count) = configuration.axes(at);
        all.extend(axes[..count].iter().map(|&axis| Rotation {
            node,
            axis,
            inverse: axis / axis.dot(&axis),
        }));
    }
    all
}

impl<S: Scalar> FiniteElements<S> {
    /// Mass \[kg\], and inertia about the origin \[kg m²\], of the undeformed body.
    pub fn rigid(&self) -> (S, Mat3<S>) {
        let (mut mass, mut second) = (S::zero(), Mat3::zeros());
        for (i, element) in self.mesh.elements.iter().enumerate() {
            let (h, rho) = (self.thickness[i], self.density[i]);
            let per_area = rho * h + self.surface_mass[i];
            mass += per_area * element.area;
            second += element.second[0].map(S::from) * per_area;
            second += element.second[1].map(S::from) * (rho * h * h * h * (1.0 / 12.0));
        }
        for part in &self.parts {
            mass += part.mass;
            second += part.second;
        }
        (mass, Mat3::identity() * second.trace() - second)
    }
}

/// How a point of the body moves with some coordinates.
#[derive(Clone, Debug, Default)]
pub struct PointMotion {
    /// Where it is in the undeformed body \[m\].
    pub place: Vec3<f64>,
    /// The coordinates.
    pub coordinates: Vec<usize>,
    /// Displacement by each.
    pub displacement: Vec<Vec3<f64>>,
    /// Rotation by each.
    pub rotation: Vec<Vec3<f64>>,
}

/// Displacements and rotations of all nodes by coordinates.
#[derive(Clone, Debug)]
pub struct Surface {
    nodes: Vec<Vec3<f64>>,
    displacements: Vec<[Option<usize>; 3]>,
    /// Rotation of each node: coordinate and rotation vector.
    rotations: Vec<Vec<(usize, Vec3<f64>)>>,
    /// Those of its own unknowns alone.
    unknown_rotations: Vec<Vec<(usize, Vec3<f64>)>>,
}

/// The unknowns of a node and how they move it.
#[derive(Clone, Debug)]
pub struct NodeMotion {
    /// Where it is in the undeformed body \[m\].
    pub place: Vec3<f64>,
    /// Coordinates of its displacements; none where the frame holds them.
    pub displacements: [Option<usize>; 3],
    /// Coordinates of its rotations, with the rotation by each.
    pub rotations: Vec<(usize, Vec3<f64>)>,
}

impl Surface {
    /// Rotations about tangents are those of the nodes; that about the normal of a smooth surface without beams
    /// is ½ (e2·u,1 − e1·u,2) there, the mean over the elements.
    fn of(configuration: &Configuration<f64>) -> Self {
        let unknowns = configuration.unknowns;
        let mesh = &configuration.structure.topology.mesh;
        let nodes = &configuration.structure.nodes;
        let displacements: Vec<[Option<usize>; 3]> =
            unknowns.nodes.iter().map(|at| at.displacements).collect();
        let mut rotations: Vec<Vec<(usize, Vec3<f64>)>> = (0..nodes.len())
            .map(|node| {
                let (axes, _) = configuration.axes(node);
                unknowns.rotations_of(node).zip(axes).collect()
            })
            .collect();
        let unknown_rotations = rotations.clone();
        let on_beams = mesh.on_beams();
        let mut uses = vec![0.0; nodes.len()];
        for element in &mesh.shells {
            element.iter().for_each(|&node| uses[node] += 1.0);
        }
        for element in &mesh.shells {
            for (local, &node) in element.iter().enumerate() {
                if on_beams[node] || configuration.smooth_director(node).is_none() {
                    continue;
                }
                let basis = &ShellKind::of(element).tables().nodes[local];
                let tangent = |k: usize| {
                    let all = element.iter().zip(&basis.by[k]);
                    all.fold(Vec3::zeros(), |sum: Vec3<f64>, (&b, n)| sum + nodes[b] * *n)
                };
                let (ar, as_) = (tangent(0), tangent(1));
                let normal = ar.cross(&as_);
                // About n: ½ (a_s·u_r − a_r·u_s) / J.
                let about = normal * (0.5 / (normal.norm_squared() * uses[node]));
                for (b, &other) in element.iter().enumerate() {
                    let by = as_ * basis.by[0][b] - ar * basis.by[1][b];
                    for k in 0..3 {
                        if let Some(coordinate) = displacements[other][k] {
                            rotations[node].push((coordinate, about * by[k]));
                        }
                    }
                }
            }
        }
        Self {
            nodes: nodes.clone(),
            displacements,
            rotations,
            unknown_rotations,
        }
    }

    /// The unknowns of a node.
    pub fn unknowns(&self, node: usize) -> NodeMotion {
        NodeMotion {
            place: self.nodes[node],
            displacements: self.displacements[node],
            rotations: self.unknown_rotations[node].clone(),
        }
    }

    /// The motion of a node.
    pub fn node(&self, node: usize) -> PointMotion {
        let mut sum = Sum::default();
        sum.displace(&self.displacements[node], 1.0);
        for (coordinate, rotation) in &self.rotations[node] {
            sum.at(*coordinate).1 += rotation;
        }
        sum.finish(self.nodes[node])
    }

    /// The motion of an edge as a whole: the mean displacement by the weights of Simpson, or of the trapezoidal rule of two
    /// nodes, and the rotation
    /// J⁻¹ Σ w r × u that fits the displacements u best, r from the middle, J = Σ w (r·r I − r rᵀ). A straight edge
    /// has no such rotation about its line: there it is the mean of the rotations.
    pub fn edge(&self, edges: &[Edge]) -> PointMotion {
        let mut weights: BTreeMap<usize, f64> = BTreeMap::new();
        for edge in edges {
            let Some((&first, &last)) = edge.first().zip(edge.last()) else {
                continue;
            };
            let length = (self.nodes[last] - self.nodes[first]).norm();
            let parts: &[f64] = match edge.len() {
                2 => &[3.0, 3.0],
                _ => &[1.0, 4.0, 1.0],
            };
            for (&node, part) in edge.iter().zip(parts) {
                *weights.entry(node).or_default() += part / 6.0 * length;
            }
        }
        let total: f64 = weights.values().sum();
        let all = weights.iter().map(|(&node, w)| (node, w / total));
        let all: Vec<(usize, f64)> = all.collect();
        let place = (all.iter()).fold(Vec3::zeros(), |sum: Vec3<f64>, &(node, w)| {
            sum + self.nodes[node] * w
        });
        let arm = |node: usize| self.nodes[node] - place;
        let second = all
            .iter()
            .fold(Mat3::zeros(), |sum: Mat3<f64>, &(node, w)| {
                let r = arm(node);
                sum + (Mat3::identity() * r.norm_squared() - r * r.transpose()) * w
            });
        // Of a straight edge: its line, and the inverse of J across it.
        let (along, inverse) = match is_straight(&self.nodes, edges) {
            true => {
                let nodes: Vec<Vec3<f64>> = all.iter().map(|&(node, _)| self.nodes[node]).collect();
                let [start, end] = ends(&nodes, place);
                let along = (end - start).normalize();
                let across = Mat3::identity() - along * along.transpose();
                (Some(along), across * (2.0 / second.trace()))
            }
            false => (None, second.try_inverse().unwrap_or_else(Mat3::zeros)),
        };
        let mut sum = Sum::default();
        for &(node, w) in &all {
            sum.displace(&self.displacements[node], w);
            for (k, coordinate) in self.displacements[node].iter().enumerate() {
                if let Some(coordinate) = coordinate {
                    let moment = arm(node).cross(&Vec3::ith(k, 1.0)) * w;
                    sum.at(*coordinate).1 += inverse * moment;
                }
            }
            let Some(along) = along else { continue };
            // The normal of a surface is across its edges.
            for (coordinate, rotation) in &self.unknown_rotations[node] {
                sum.at(*coordinate).1 += along * (w * rotation.dot(&along));
            }
        }
        sum.finish(place)
    }
}

/// A sum of displacements and rotations by coordinates.
#[derive(Default)]
struct Sum(BTreeMap<usize, (Vec3<f64>, Vec3<f64>)>);

impl Sum {
    fn at(&mut self, coordinate: usize) -> &mut (Vec3<f64>, Vec3<f64>) {
        self.0.entry(coordinate).or_default()
    }

    fn displace(&mut self, coordinates: &[Option<usize>; 3], weight: f64) {
        for (k, coordinate) in coordinates.iter().enumerate() {
            if let Some(coordinate) = coordinate {
                self.at(*coordinate).0[k] += weight;
            }
        }
    }

    fn finish(self, place: Vec3<f64>) -> PointMotion {
        let mut out = PointMotion {
            place,
            ..PointMotion::default()
        };
        for (coordinate, (displacement, rotation)) in self.0 {
            out.coordinates.push(coordinate);
            out.displacement.push(displacement);
            out.rotation.push(rotation);
        }
        out
    }
}
