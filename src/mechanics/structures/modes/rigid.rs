//! Rigid motions that the supports leave, for each connected part of a structure.

use nalgebra::{DMatrix, SymmetricEigen, Vector6};

use crate::math::Vec3;
use crate::structures::state::Configuration;
use crate::structures::supports::NodeUnknowns;

/// Mean square of what a support forbids of a rigid motion below which it counts as allowed.
const ALLOWED: f64 = 1e-14;

/// Rigid motions in the unknowns, linearly independent.
pub(super) fn rigid_motions(configuration: &Configuration<f64>) -> Vec<Vec<f64>> {
    parts(configuration)
        .iter()
        .flat_map(|part| motions_of(configuration, part))
        .collect()
}

/// The nodes of each connected part.
fn parts(configuration: &Configuration<f64>) -> Vec<Vec<usize>> {
    let mesh = &configuration.structure.topology.mesh;
    let mut parent: Vec<usize> = (0..mesh.nodes).collect();
    fn root(parent: &mut [usize], mut k: usize) -> usize {
        while parent[k] != k {
            parent[k] = parent[parent[k]];
            k = parent[k];
        }
        k
    }
    for element in mesh.elements() {
        let first = root(&mut parent, element[0]);
        for &node in &element[1..] {
            let other = root(&mut parent, node);
            parent[other] = first;
        }
    }
    let mut all: std::collections::BTreeMap<usize, Vec<usize>> = Default::default();
    for node in 0..mesh.nodes {
        let root = root(&mut parent, node);
        all.entry(root).or_default().push(node);
    }
    all.into_values().collect()
}

/// A rigid motion k < 6 at a place: displacement and rotation; lengths are measured in `size`.
fn rigid(k: usize, place: &Vec3<f64>, size: f64) -> (Vec3<f64>, Vec3<f64>) {
    let axis = Vec3::ith(k % 3, 1.0);
    if k < 3 {
        (axis, Vec3::zeros())
    } else {
        (axis.cross(place) / size, axis / size)
    }
}

fn motions_of(configuration: &Configuration<f64>, part: &[usize]) -> Vec<Vec<f64>> {
    let nodes = &configuration.structure.nodes;
    let count = part.len() as f64;
    let centre: Vec3<f64> = part.iter().map(|&node| nodes[node]).sum::<Vec3<f64>>() / count;
    let spread = part
        .iter()
        .map(|&node| (nodes[node] - centre).norm_squared());
    let size = (spread.sum::<f64>() / count).sqrt();
    let on_beams = configuration.structure.topology.mesh.on_beams();
    let mut forbidden = DMatrix::<f64>::zeros(6, 6);
    let mut rows = 0;
    for &node in part {
        let at = &configuration.unknowns.nodes[node];
        let motions: Vec<_> = (0..6)
            .map(|k| rigid(k, &(nodes[node] - centre), size))
            .collect();
        let mut forbid = |row: Vector6<f64>| {
            forbidden += row * row.transpose();
            rows += 1;
        };
        for i in (0..3).filter(|&i| at.displacements[i].is_none()) {
            forbid(Vector6::from_fn(|k, _| motions[k].0[i]));
        }
        let rest: Vec<Vec3<f64>> = motions
            .iter()
            .map(|(_, turn)| {
                (turn - allowed_turn(configuration, node, on_beams[node], turn)) * size
            })
            .collect();
        if rest.iter().any(|rest| rest.norm() > 1e-12) {
            for i in 0..3 {
                forbid(Vector6::from_fn(|k, _| rest[k][i]));
            }
        }
    }
    if rows > 0 {
        forbidden /= f64::from(rows);
    }
    let eigen = SymmetricEigen::new(forbidden);
    (0..6)
        .filter(|&k| eigen.eigenvalues[k] < ALLOWED)
        .map(|k| {
            let mix = eigen.eigenvectors.column(k);
            let mut x = vec![0.0; configuration.unknowns.count];
            for &node in part {
                let (mut u, mut turn) = (Vec3::zeros(), Vec3::zeros());
                for i in 0..6 {
                    let (du, dturn) = rigid(i, &(nodes[node] - centre), size);
                    u += du * mix[i];
                    turn += dturn * mix[i];
                }
                write(configuration, node, &u, &turn, &mut x);
            }
            x
        })
        .collect()
}

/// The part of a rotation that the unknowns of a node give, or that has no unknown because it turns
/// about the director.
fn allowed_turn(
    configuration: &Configuration<f64>,
    node: usize,
    on_beam: bool,
    turn: &Vec3<f64>,
) -> Vec3<f64> {
    let (axes, count) = configuration.axes(node);
    let mut rest = *turn;
    for axis in &axes[..count] {
        rest -= axis * (axis.dot(&rest) / axis.norm_squared());
    }
    let director = configuration.smooth_director(node);
    let natural = configuration.node_unknowns == NodeUnknowns::Natural;
    if let (Some(d), true) = (director, natural && !on_beam) {
        rest -= d * d.dot(&rest);
    }
    turn - rest
}

/// Writes the motion of a node into the unknowns. Axes of a node are orthogonal.
fn write(
    configuration: &Configuration<f64>,
    node: usize,
    u: &Vec3<f64>,
    turn: &Vec3<f64>,
    x: &mut [f64],
) {
    let at = &configuration.unknowns.nodes[node];
    for i in 0..3 {
        if let Some(unknown) = at.displacements[i] {
            x[unknown] = u[i];
        }
    }
    let (axes, count) = configuration.axes(node);
    for k in 0..count {
        x[at.first_rotation + k] = axes[k].dot(turn) / axes[k].norm_squared();
    }
}
