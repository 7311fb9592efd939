//! What holds the edges of bodies of elements: all of their nodes, or their average.
//!
//! The key of a point says it, or for `edge` the joints: a weld holds all nodes, as a support at rest does,
//! other joints hold the average. The frame of a body has no part in it. Axes that are clamped at an edge of
//! which only the average is held are held there by single nodes. A body with a reduced basis has its axes
//! clamped at the rigid edge at which its frame is, or else at the first one that is rigid.

use crate::math::Vec3;
use crate::schema::Document;
use crate::schema::elements::{ElementBasis, ElementFrame, Elements, Held};
use crate::schema::joints::{Joint, JointPlace};
use crate::schema::mechanics::Point;
use crate::structures::floating::FrameNodes;
use crate::structures::mesh::Mesh;
use std::cmp::Ordering;
use std::collections::BTreeSet;

/// Lengths are alike if their quotient is nearer to one.
const ALIKE: f64 = 1.0 - 1e-9;

/// The nodes of a set of nodes or of an edge.
pub fn nodes_of(mesh: &Mesh, set: &str) -> Option<Vec<usize>> {
    let nodes = mesh.node_sets.get(set).cloned();
    nodes.or_else(|| {
        mesh.edge_sets
            .get(set)
            .map(|edges| edges.iter().flatten().copied().collect())
    })
}

/// The point of body `side` of a joint that its place names; none if it is another way there.
fn named<'a>(joint: &'a Joint, side: usize, points: &[&'a String]) -> Option<&'a String> {
    let body = &joint.between()[side];
    let is = |name: &String| points.iter().copied().find(|&own| own == name);
    match joint.place()? {
        JointPlace::Named(name) => (points.iter().copied())
            .find(|own| name.strip_prefix(body.as_str()) == Some(&format!(".{own}"))),
        JointPlace::Each(pair) => match [&pair.a, &pair.b][side] {
            Point::Named(name) => is(name),
            Point::Coordinates(_) => None,
        },
        JointPlace::Coordinates(_) => None,
    }
}

/// Finds the points that welds hold. A weld at coordinates counts for every point that no joint names.
pub(super) fn find_welds(document: &mut Document) {
    let (joints, bodies) = (&document.joints, &mut document.bodies);
    for (body, elements) in bodies.iter_mut() {
        let Some(elements) = &mut elements.elements else {
            continue;
        };
        let points: Vec<&String> = elements.points.keys().collect();
        let own = joints.values().flat_map(|joint| {
            let sides = joint.between().iter().enumerate();
            sides
                .filter(|(_, name)| *name == body)
                .map(move |(side, _)| (joint, side))
        });
        let (mut welded, mut known, mut elsewhere) = (Vec::new(), Vec::new(), false);
        for (joint, side) in own {
            let weld = matches!(joint, Joint::Weld(_));
            match named(joint, side, &points) {
                Some(name) if weld => welded.push(name.clone()),
                Some(name) => known.push(name.clone()),
                None => elsewhere |= weld,
            }
        }
        if elsewhere {
            let others = points.into_iter().filter(|name| !known.contains(name));
            welded.extend(others.cloned());
        }
        elements.welded = welded;
    }
}

/// Whether all nodes of a point follow what holds it.
pub(super) fn is_rigid(elements: &Elements, name: &str) -> bool {
    match elements.points.get(name) {
        Some(Held::Rigid(_)) => true,
        Some(Held::Edge(_)) => elements.welded.iter().any(|own| own == name),
        Some(Held::Node(_) | Held::Mean(_)) | None => false,
    }
}

/// The nodes that hold the axes, where `given` are those of the frame.
pub(super) fn axes(
    elements: &Elements,
    given: FrameNodes,
    (mesh, nodes): (&Mesh, &[Vec3<f64>]),
) -> FrameNodes {
    let edges = (elements.points.iter()).filter(|(_, held)| !matches!(held, Held::Node(_)));
    let edges = edges.filter_map(|(name, held)| {
        let mut of_edge = nodes_of(mesh, held.set())?;
        of_edge.sort_unstable();
        of_edge.dedup();
        Some((is_rigid(elements, name), of_edge))
    });
    let edges: Vec<(bool, Vec<usize>)> = edges.collect();
    let reduced = matches!(elements.basis, ElementBasis::Reduced(_));
    let clamped: &[usize] = match &given {
        FrameNodes::Clamped(clamped) => clamped,
        _ => &[],
    };
    let same = |of_edge: &[usize]| {
        clamped.iter().all(|node| of_edge.contains(node))
            && of_edge.iter().all(|node| clamped.contains(node))
    };
    let rigid = || edges.iter().filter(|(rigid, _)| *rigid);
    let held = rigid()
        .find(|(_, own)| same(own))
        .or_else(|| rigid().next());
    if let (true, Some((_, held))) = (reduced, held) {
        return FrameNodes::Clamped(held.clone());
    }
    if clamped.is_empty() {
        return given;
    }
    let mean = edges.iter().any(|(rigid, of_edge)| !rigid && same(of_edge));
    match mean.then(|| beside(mesh, nodes, clamped)).flatten() {
        Some(chord) => FrameNodes::Chord(chord),
        None => given,
    }
}

/// The set of nodes that keep their places among each other because axes are clamped there, and for no other reason.
pub(super) fn rigid_by_axes<'a>(elements: &'a Elements, mesh: &Mesh) -> Option<&'a str> {
    let ElementFrame::Clamped(set) = &elements.frame else {
        return None;
    };
    let all =
        |set: &str| -> BTreeSet<usize> { nodes_of(mesh, set).into_iter().flatten().collect() };
    let clamped = all(set);
    let reduced = matches!(elements.basis, ElementBasis::Reduced(_));
    let elsewhere = elements.points.iter().any(|(name, held)| {
        !matches!(held, Held::Node(_))
            && (all(held.set()) == clamped || (reduced && is_rigid(elements, name)))
    });
    (clamped.len() > 1 && !elsewhere).then_some(set)
}

/// Three nodes of the elements at a straight edge: its ends, and one off its line. Their places choose them, and not their
/// numbers.
fn beside(mesh: &Mesh, nodes: &[Vec3<f64>], edge: &[usize]) -> Option<[usize; 3]> {
    let order = |a: &usize, b: &usize| {
        let pairs = nodes[*a].iter().zip(&nodes[*b]);
        let mut orders = pairs.map(|(a, b)| a.total_cmp(b));
        orders.find(|own| own.is_ne()).unwrap_or(Ordering::Equal)
    };
    let far = |from: usize| {
        let distance = |node: &usize| (nodes[*node] - nodes[from]).norm();
        let all = edge.iter().copied();
        all.max_by(|a, b| distance(a).total_cmp(&distance(b)))
    };
    let one = far(*edge.first()?)?;
    let mut ends = [one, far(one)?];
    ends.sort_by(order);
    let [start, end] = ends;
    let along = (nodes[end] - nodes[start]).normalize();
    let off = |node: &usize| (nodes[*node] - nodes[start]).cross(&along).norm();
    let touching = mesh.shells.iter().filter(|own| own.contains(&start));
    let all: Vec<usize> = touching.flatten().copied().collect();
    let farthest = all.iter().map(&off).fold(0.0, f64::max);
    let as_far = all.into_iter().filter(|node| off(node) >= ALIKE * farthest);
    let near = |node: &usize| (nodes[*node] - nodes[start]).norm();
    let third = as_far.min_by(|a, b| match near(a) - near(b) {
        d if d.abs() <= (1.0 - ALIKE) * farthest => order(a, b),
        d => d.total_cmp(&0.0),
    })?;
    Some([start, end, third])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::structures::shell::ShellNodes;

    /// Two shells of nine nodes beside each other; their left edge is averaged.
    #[test]
    fn the_nodes_that_hold_axes_are_chosen_by_place() {
        let place = |k: usize| Vec3::new((k % 5) as f64, (k / 5) as f64, 0.0);
        let shell = |first: usize| std::array::from_fn(|k| first + 5 * (k / 3) + k % 3);
        let chosen = |number: &dyn Fn(usize) -> usize| {
            let mut nodes = vec![Vec3::zeros(); 15];
            (0..15).for_each(|k| nodes[number(k)] = place(k));
            let renumbered = |shell: [usize; 9]| ShellNodes::from(shell.map(number));
            let mesh = Mesh {
                nodes: 15,
                shells: [2, 0].map(|first| renumbered(shell(first))).to_vec(),
                ..Mesh::default()
            };
            let mut edge = [0, 5, 10].map(number);
            edge.sort_unstable();
            beside(&mesh, &nodes, &edge).map(|all| all.map(|k| nodes[k]))
        };
        let known = [[0.0, 0.0], [0.0, 2.0], [2.0, 0.0]];
        let known = known.map(|[x, y]| Vec3::new(x, y, 0.0));
        for number in [&(|k| k) as &dyn Fn(usize) -> usize, &|k| 14 - k, &|k| {
            (4 * k) % 15
        }] {
            assert_eq!(chosen(number), Some(known));
        }
    }
}
