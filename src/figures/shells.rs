//! Shells in motion: where their nodes are, their stresses, and coloured parts of their surface.

use super::detail::{Detail, quarters, whole};
use crate::math::Vec3;
use crate::model::Model;
use crate::model::finite::{ElementMesh, FiniteElements};
use crate::plots::Patch;
use crate::problem::{BeamFibres, Drawing, larger};
use crate::structures::shell::{PerNode, ShellKind};
use crate::system::finite::stress_ratios;

/// Bodies with at most this number of elements are drawn in four parts an element, others in one.
const IN_PARTS: usize = 40;

/// The shells of a body, if it has some.
pub(super) fn of(model: &Model<f64>, body: usize) -> Option<&FiniteElements<f64>> {
    let own = model.flexible.iter().find(|own| own.frame == body)?;
    own.form.shells()
}

/// The unknowns of the nodes of the shells of a body at its elastic coordinates `q`; `q` of other bodies.
pub(super) fn unknowns(model: &Model<f64>, body: usize, q: Vec<f64>) -> Vec<f64> {
    match model.flexible.iter().find(|own| own.frame == body) {
        Some(own) => own.form.unknowns(q),
        None => q,
    }
}

/// Where the nodes are at their unknowns `q`, in the axes of the body \[m\].
pub(super) fn places(mesh: &ElementMesh, q: &[f64]) -> Vec<Vec3<f64>> {
    let moved = |(place, by): (&Vec3<f64>, &[Option<usize>; 3])| {
        place + Vec3::from_fn(|k, _| by[k].map_or(0.0, |i| q[i]))
    };
    mesh.nodes
        .iter()
        .zip(&mesh.displacements)
        .map(moved)
        .collect()
}

/// Von Mises stress of each element at the Gauss points, row by row: the larger of both faces \[Pa\].
pub(super) fn stresses<'a>(
    finite: &'a FiniteElements<f64>,
    q: &'a [f64],
) -> impl Iterator<Item = PerNode<f64>> + 'a {
    finite.mesh.elements.iter().enumerate().map(|(i, element)| {
        let faces = stress_ratios(finite, q, &[i]);
        PerNode::from_fn(faces.len() / 2, |g| {
            element.yield_stress * faces[2 * g].max(faces[2 * g + 1])
        })
    })
}

/// Coloured parts of the surface and halves of beams, those that are far first. A colour of shells is the mean over
/// the Gauss points of the part, of beams the larger stress of the sections at both ends. `place` takes points of the
/// body to ground.
pub(super) fn patches(
    (finite, fibres): (&FiniteElements<f64>, &[BeamFibres]),
    q: &[f64],
    place: impl Fn(&Vec3<f64>) -> Vec3<f64>,
    (drawing, detail): (&Drawing, &Detail),
) -> Vec<Patch> {
    let nodes: Vec<Vec3<f64>> = places(&finite.mesh, q).iter().map(place).collect();
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let sight = drawing.sight();
    let mut all: Vec<(f64, Patch)> = Vec::new();
    let mut add = |corners: &[usize], value: f64| {
        let depth: f64 = corners.iter().map(|&node| sight.dot(&nodes[node])).sum();
        let corners: Vec<[f64; 2]> = corners.iter().map(|&n| drawing.flat(&nodes[n])).collect();
        all.push((depth / corners.len() as f64, Patch { corners, value }));
    };
    for (element, stress) in finite.mesh.elements.iter().zip(stresses(finite, q)) {
        let kind = element.kind();
        if detail.is_thinned() {
            add(
                &whole(kind).map(|local| element.nodes[local]),
                mean(&stress),
            );
            continue;
        }
        if finite.mesh.elements.len() > IN_PARTS {
            let line: &[usize] = match kind {
                ShellKind::Mitc9 => &[0, 1, 2, 5, 8, 7, 6, 3],
                ShellKind::Mitc4 => whole(kind),
            };
            let line: Vec<usize> = line.iter().map(|&local| element.nodes[local]).collect();
            add(&line, mean(&stress));
            continue;
        }
        for corners in quarters(kind) {
            add(
                &corners.map(|local| element.nodes[local]),
                mean(&corners.map(|g| stress[g])),
            );
        }
    }
    for (ends, beam) in finite.mesh.beams.iter().zip(fibres) {
        let (halves, largest) = (ends.windows(2), beam.largest(q));
        for (half, stresses) in halves.zip(largest.windows(2)) {
            let (a, b) = (&nodes[half[0]], &nodes[half[1]]);
            // A beam is drawn on top of the shells that it stiffens.
            let depth = 0.5 * sight.dot(&(a + b)) + (b - a).norm();
            let patch = Patch {
                corners: vec![drawing.flat(a), drawing.flat(b)],
                value: larger(stresses[0], stresses[1]),
            };
            all.push((depth, patch));
        }
    }
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    all.into_iter().map(|(_, patch)| patch).collect()
}
