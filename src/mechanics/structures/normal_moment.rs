//! Moments on nodes of smooth surfaces that have no unknown rotation about their director D.
//!
//! The rotation about D is that of the surface, so the part of a moment along D acts on the displacements of
//! the elements e that meet at the node:
//!
//! ```text
//! W = m·(θ − D (D·θ)) + (m·D) ω,     ω = Σ ω_e / Σ n_e·D,     ω_e = ½ (a_s·u,r − a_r·u,s) / |a_r × a_s|
//! ```
//!
//! with the normals n_e. D is the direction of Σ n_e, so ω = D·θ in every rigid rotation θ: the moment is in
//! balance with the supports.

use super::mesh::UnknownSet;
use super::sheets::{corner_tangents, normal, unit_transpose};
use super::shell::frame::{add_area_transpose, area};
use super::shell::{ShellKind, ShellNodes};
use super::state::{Configuration, Cotangent, NodalMotion};
use super::structure::Structure;
use super::supports::{NodeUnknowns, Normal, Rotations, Support, Unknowns, along_director};
use crate::math::{Scalar, Vec3};

/// A node with a moment of which more than the error of directors is along the director, though the node has no
/// unknown rotation about it.
///
/// # Errors
/// [`UnknownSet`] if the load or a support names no set of the mesh.
pub fn along_normal(
    structure: &Structure<f64>,
    (supports, node_unknowns): (&[Support], NodeUnknowns),
    (nodes, moment): (&str, &Vec3<f64>),
) -> Result<Option<usize>, UnknownSet> {
    let topology = &structure.topology;
    let order: Vec<usize> = (0..topology.mesh.nodes).collect();
    let unknowns = Unknowns::new(structure, supports, node_unknowns, &order)?;
    let directors = topology.sheets.directors(&topology.mesh, &structure.nodes);
    let sheets = &topology.sheets;
    let errors = sheets.errors(&topology.mesh, &structure.nodes, &directors);
    let has_part = |node: &usize| {
        let director = directors[topology.sheets.of_node[*node].start];
        moment.dot(&director).abs() > along_director(errors[*node]) * moment.norm()
    };
    let on_surface = |node: &usize| {
        matches!(
            unknowns.nodes[*node].rotations,
            Rotations::Smooth(_, Normal::Surface)
        )
    };
    let mut all = topology.mesh.node_set(nodes)?.iter().copied();
    Ok(all.find(|node| on_surface(node) && has_part(node)))
}

/// Displacements of an element by r and s at its local node.
fn slopes<S: Scalar>(element: &ShellNodes, local: usize, motion: &NodalMotion<S>) -> [Vec3<S>; 2] {
    ShellKind::of(element).tables().nodes[local].by.map(|by| {
        let nodes = element.iter().zip(&by);
        nodes.fold(Vec3::zeros(), |sum, (&node, &w)| {
            sum + motion.displacement[node] * S::from(w)
        })
    })
}

/// Adds the derivatives of the work W of a moment on such a node: by the motion to `force`, by the structure
/// to `to`. Gives that by the moment.
pub(super) fn add_transpose<S: Scalar>(
    configuration: &Configuration<S>,
    (node, director): (usize, usize),
    moment: &Vec3<S>,
    motion: &NodalMotion<S>,
    force: &mut NodalMotion<S>,
    to: &mut Cotangent<S>,
) -> Vec3<S> {
    let mesh = &configuration.structure.topology.mesh;
    let nodes = &configuration.structure.nodes;
    let d = configuration.directors[director];
    let theta = motion.rotation[node];
    let along = moment.dot(&d);
    let corners = mesh.shells.iter().filter_map(|element| {
        let local = element.iter().position(|&own| own == node)?;
        Some((element, local))
    });
    let (mut spin, mut projected, mut normals) = (S::zero(), S::zero(), Vec3::zeros());
    for (element, local) in corners.clone() {
        let tangents = corner_tangents(element, local, nodes);
        let [by_r, by_s] = slopes(element, local, motion);
        spin += (tangents[1].dot(&by_r) - tangents[0].dot(&by_s)) * 0.5 / area(&tangents);
        let own = normal(&tangents);
        projected += own.dot(&d);
        normals += own;
    }
    let omega = spin / projected;
    let (by_spin, by_projected) = (along / projected, -along * omega / projected);
    for (element, local) in corners {
        let tangents = corner_tangents(element, local, nodes);
        let [r, s] = &tangents;
        let [by_r, by_s] = slopes(element, local, motion);
        let size = area(&tangents);
        let own = (s.dot(&by_r) - r.dot(&by_s)) * 0.5 / size;
        let half = by_spin * 0.5 / size;
        let by_normal = unit_transpose(&r.cross(s), &(d * by_projected));
        let mut bar = [
            by_s * -half + s.cross(&by_normal),
            by_r * half + by_normal.cross(r),
        ];
        add_area_transpose(&tangents, -by_spin * own / size, &mut bar);
        let by = &ShellKind::of(element).tables().nodes[local].by;
        for (b, &other) in element.iter().enumerate() {
            let (n_r, n_s) = (S::from(by[0][b]), S::from(by[1][b]));
            force.displacement[other] += s * (half * n_r) - r * (half * n_s);
            to.structure.nodes[other] += bar[0] * n_r + bar[1] * n_s;
        }
    }
    force.rotation[node] += moment - d * along;
    to.directors[director] +=
        moment * (omega - d.dot(&theta)) - theta * along + normals * by_projected;
    theta + d * (omega - d.dot(&theta))
}
