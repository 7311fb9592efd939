//! Directors of the nodes: unit averages of the normals of the elements of one smooth sheet.
//!
//! Elements that meet at a node belong to one sheet there if their normals differ by less than the
//! fold angle, from neighbour to neighbour. Elements of four nodes are nearly flat, and turn their normals from one to
//! the next: their fold angle is larger. A node on a fold has a director a sheet. Which elements
//! belong together is found once, from the first geometry; the directors follow every geometry.

use super::mesh::Mesh;
use super::shell::{PerNode, ShellKind, ShellNodes};
use crate::math::{Scalar, Vec3, scalar::length};

/// Angle between normals above which a node is on a fold \[rad\].
pub(super) fn fold_angle(kind: ShellKind) -> f64 {
    match kind {
        ShellKind::Mitc9 => 0.35,
        ShellKind::Mitc4 => 0.6,
    }
}

/// How well directors are known, as a part of the square of the angle that an element turns by. At the edge
/// of a circular arc of elements of angle β they err by β³/32.
const OF_TURN: f64 = 0.1;
/// The same of elements of four nodes, as a part of the angle between their normals and the directors at their nodes.
/// At the edge of a circular arc the director is the normal of one flat element, and errs by β/2, which is this angle.
const OF_FACETS: f64 = 1.5;

/// Which director each corner of each element has.
#[derive(Clone, Debug)]
pub struct Sheets {
    /// Director of each local node of each shell.
    pub corners: Vec<PerNode<usize>>,
    /// The node of each director.
    pub nodes: Vec<usize>,
    /// Directors of each node: from, to.
    pub of_node: Vec<std::ops::Range<usize>>,
}

impl Sheets {
    /// Finds the sheets of a geometry.
    pub fn new(mesh: &Mesh, nodes: &[Vec3<f64>]) -> Self {
        let mut at_node: Vec<Vec<(usize, usize, Vec3<f64>)>> = vec![Vec::new(); mesh.nodes];
        for (shell, element) in mesh.shells.iter().enumerate() {
            for local in 0..element.len() {
                let n = normal(&corner_tangents(element, local, nodes));
                at_node[element[local]].push((shell, local, n));
            }
        }
        let mut sheets = Self {
            corners: (mesh.shells.iter().map(|element| element.map(|_| 0))).collect(),
            nodes: Vec::new(),
            of_node: Vec::with_capacity(mesh.nodes),
        };
        for (node, corners) in at_node.iter().enumerate() {
            let first = sheets.nodes.len();
            let kinds = corners.iter().map(|own| ShellKind::of(&mesh.shells[own.0]));
            let fold_angle = kinds.map(fold_angle).fold(0.0, f64::max);
            let groups = group(corners, fold_angle);
            for (&(shell, local, _), &group) in corners.iter().zip(&groups) {
                sheets.corners[shell][local] = first + group;
            }
            let count = groups.iter().max().map_or(0, |last| last + 1);
            sheets.nodes.extend(std::iter::repeat_n(node, count));
            sheets.of_node.push(first..first + count);
        }
        sheets
    }

    /// Directors of a geometry.
    pub fn directors<S: Scalar>(&self, mesh: &Mesh, nodes: &[Vec3<S>]) -> Vec<Vec3<S>> {
        let mut all = self.sums(mesh, nodes);
        for d in &mut all {
            *d /= length(d);
        }
        all
    }

    fn sums<S: Scalar>(&self, mesh: &Mesh, nodes: &[Vec3<S>]) -> Vec<Vec3<S>> {
        let mut all = vec![Vec3::zeros(); self.nodes.len()];
        for (element, corners) in mesh.shells.iter().zip(&self.corners) {
            for (local, &corner) in corners.iter().enumerate() {
                all[corner] += normal(&corner_tangents(element, local, nodes));
            }
        }
        all
    }

    /// How far the director at each node may be from the normal of the surface that the mesh stands for, as the sine of
    /// an angle.
    pub fn errors(&self, mesh: &Mesh, nodes: &[Vec3<f64>], directors: &[Vec3<f64>]) -> Vec<f64> {
        let mut all: Vec<f64> = vec![0.0; mesh.nodes];
        let angle = |a: &Vec3<f64>, b: &Vec3<f64>| a.cross(b).norm().atan2(a.dot(b));
        for (element, corners) in mesh.shells.iter().zip(&self.corners) {
            let at = |local: usize| normal(&corner_tangents(element, local, nodes));
            let normals: Vec<Vec3<f64>> = (0..element.len()).map(at).collect();
            for (&node, own) in element.iter().zip(&normals) {
                let error = match ShellKind::of(element) {
                    ShellKind::Mitc9 => {
                        let turns = normals.iter().map(|other| angle(own, other));
                        let turn = turns.fold(0.0, f64::max);
                        OF_TURN * turn * turn
                    }
                    ShellKind::Mitc4 => {
                        let turns = corners.iter().map(|&corner| angle(own, &directors[corner]));
                        OF_FACETS * turns.fold(0.0, f64::max)
                    }
                };
                all[node] = all[node].max(error);
            }
        }
        all
    }

    /// Transpose of the derivative of [`Sheets::directors`].
    pub fn add_directors_transpose<S: Scalar>(
        &self,
        mesh: &Mesh,
        nodes: &[Vec3<S>],
        bar: &[Vec3<S>],
        to: &mut [Vec3<S>],
    ) {
        let sums = self.sums(mesh, nodes);
        let bar: Vec<Vec3<S>> = sums
            .iter()
            .zip(bar)
            .map(|(sum, bar)| unit_transpose(sum, bar))
            .collect();
        for (element, corners) in mesh.shells.iter().zip(&self.corners) {
            for (local, &corner) in corners.iter().enumerate() {
                let [r, s] = corner_tangents(element, local, nodes);
                let bar = unit_transpose(&r.cross(&s), &bar[corner]);
                let (r_bar, s_bar) = (s.cross(&bar), bar.cross(&r));
                let basis = &ShellKind::of(element).tables().nodes[local];
                for (a, &node) in element.iter().enumerate() {
                    let (by_r, by_s) = (S::from(basis.by[0][a]), S::from(basis.by[1][a]));
                    to[node] += r_bar * by_r + s_bar * by_s;
                }
            }
        }
    }
}

/// Transpose of the derivative of v / |v|.
pub(super) fn unit_transpose<S: Scalar>(v: &Vec3<S>, bar: &Vec3<S>) -> Vec3<S> {
    let size = length(v);
    let unit = v / size;
    (bar - unit * unit.dot(bar)) / size
}

/// Tangents of an element at one of its nodes.
pub(super) fn corner_tangents<S: Scalar>(
    element: &ShellNodes,
    local: usize,
    nodes: &[Vec3<S>],
) -> [Vec3<S>; 2] {
    let basis = &ShellKind::of(element).tables().nodes[local];
    let mut tangents = [Vec3::zeros(); 2];
    for (a, &node) in element.iter().enumerate() {
        for k in 0..2 {
            if basis.by[k][a] != 0.0 {
                tangents[k] += nodes[node] * S::from(basis.by[k][a]);
            }
        }
    }
    tangents
}

pub(super) fn normal<S: Scalar>([r, s]: &[Vec3<S>; 2]) -> Vec3<S> {
    let n = r.cross(s);
    n / length(&n)
}

/// Numbers the groups of corners whose normals are joined by angles below the fold angle.
fn group(corners: &[(usize, usize, Vec3<f64>)], fold_angle: f64) -> Vec<usize> {
    let mut groups: Vec<Option<usize>> = vec![None; corners.len()];
    let mut count = 0;
    for start in 0..corners.len() {
        if groups[start].is_some() {
            continue;
        }
        groups[start] = Some(count);
        let mut open = vec![start];
        while let Some(k) = open.pop() {
            for other in 0..corners.len() {
                let near = corners[k].2.dot(&corners[other].2) > fold_angle.cos();
                if groups[other].is_none() && near {
                    groups[other] = Some(count);
                    open.push(other);
                }
            }
        }
        count += 1;
    }
    groups.into_iter().flatten().collect()
}
