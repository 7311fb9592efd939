//! Directors of the nodes: unit averages of the normals of the elements of one smooth sheet.
//!
//! Elements that meet at a node belong to one sheet there if their normals differ by less than the
//! fold angle, from neighbour to neighbour. A node on a fold has a director a sheet. Which elements
//! belong together is found once, from the first geometry; the directors follow every geometry.

use super::mesh::Mesh;
use super::shell::NODES;
use super::shell::basis::TABLES;
use crate::math::{Scalar, Vec3, scalar::length};

/// Angle between normals above which a node is on a fold [rad].
pub const FOLD_ANGLE: f64 = 0.35;

/// Which director each corner of each element has.
#[derive(Clone, Debug)]
pub struct Sheets {
    /// Director of each local node of each shell.
    pub corners: Vec<[usize; NODES]>,
    /// The node of each director.
    pub nodes: Vec<usize>,
    /// Directors of each node: from, to.
    pub of_node: Vec<std::ops::Range<usize>>,
}

impl Sheets {
    /// Finds the sheets of a geometry.
    pub fn new(mesh: &Mesh, nodes: &[Vec3<f64>], fold_angle: f64) -> Self {
        let mut at_node: Vec<Vec<(usize, usize, Vec3<f64>)>> = vec![Vec::new(); mesh.nodes];
        for (shell, element) in mesh.shells.iter().enumerate() {
            for local in 0..NODES {
                let n = normal(&corner_tangents(element, local, nodes));
                at_node[element[local]].push((shell, local, n));
            }
        }
        let mut sheets = Self {
            corners: vec![[0; NODES]; mesh.shells.len()],
            nodes: Vec::new(),
            of_node: Vec::with_capacity(mesh.nodes),
        };
        for (node, corners) in at_node.iter().enumerate() {
            let first = sheets.nodes.len();
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
            for local in 0..NODES {
                all[corners[local]] += normal(&corner_tangents(element, local, nodes));
            }
        }
        all
    }

    /// The largest angle at each node by which an element there turns from the normal at it to that at another of
    /// its nodes \[rad\].
    pub fn turns(&self, mesh: &Mesh, nodes: &[Vec3<f64>]) -> Vec<f64> {
        let mut all: Vec<f64> = vec![0.0; mesh.nodes];
        for element in &mesh.shells {
            let normals: [Vec3<f64>; NODES] =
                std::array::from_fn(|local| normal(&corner_tangents(element, local, nodes)));
            for (&node, own) in element.iter().zip(&normals) {
                for other in &normals {
                    all[node] = all[node].max(own.cross(other).norm().atan2(own.dot(other)));
                }
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
            for local in 0..NODES {
                let [r, s] = corner_tangents(element, local, nodes);
                let bar = unit_transpose(&r.cross(&s), &bar[corners[local]]);
                let (r_bar, s_bar) = (s.cross(&bar), bar.cross(&r));
                let basis = &TABLES.nodes[local];
                for a in 0..NODES {
                    let (by_r, by_s) = (S::from(basis.by[0][a]), S::from(basis.by[1][a]));
                    to[element[a]] += r_bar * by_r + s_bar * by_s;
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
    element: &[usize; NODES],
    local: usize,
    nodes: &[Vec3<S>],
) -> [Vec3<S>; 2] {
    let basis = &TABLES.nodes[local];
    let mut tangents = [Vec3::zeros(); 2];
    for a in 0..NODES {
        for k in 0..2 {
            if basis.by[k][a] != 0.0 {
                tangents[k] += nodes[element[a]] * S::from(basis.by[k][a]);
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
