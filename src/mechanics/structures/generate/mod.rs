//! Generators of meshes. Their sizes are scalars of any kind, so that nodes move smoothly with them.
//!
//! A panel has two directions, x and y. Its edges are named `x0`, `x1`, `y0` and `y1` for the ends of
//! each direction, both as sets of edges and as sets of nodes; its corners, sets of one node, are
//! `x0y0`, `x1y0`, `x0y1` and `x1y1`; `all` is the set of all nodes and of all faces.

mod beams;

pub use beams::{GeneratedBeams, Member, any_orientation, curved_beam, frame, line, straight_beam};

use super::mesh::{Edge, Mesh};
use super::shell::{ShellKind, ShellNodes};
use crate::math::{Scalar, Vec3};

/// A mesh and the places of its nodes \[m\].
#[derive(Clone, Debug)]
pub struct Generated<S> {
    /// The mesh.
    pub mesh: Mesh,
    /// Places of the nodes.
    pub nodes: Vec<Vec3<S>>,
}

/// A panel of `elements` = (n_x, n_y) shells MITC9; `place` maps (ξ, η) ∈ [0, 1]² to a point. With `closed`
/// the ends of the first direction are the same line, and its edges have no names.
pub fn panel<S: Scalar>(
    elements: [usize; 2],
    closed: bool,
    place: impl Fn(f64, f64) -> Vec3<S>,
) -> Generated<S> {
    panel_of(ShellKind::Mitc9, elements, closed, place)
}

/// As [`panel`], of shells of this kind.
pub fn panel_of<S: Scalar>(
    kind: ShellKind,
    elements: [usize; 2],
    closed: bool,
    place: impl Fn(f64, f64) -> Vec3<S>,
) -> Generated<S> {
    let [nx, ny] = elements;
    let order = kind.order();
    let row = order + 1;
    let (steps_x, steps_y) = (order * nx, order * ny);
    let columns = if closed { steps_x } else { steps_x + 1 };
    let rows = steps_y + 1;
    let node = |i: usize, j: usize| j * columns + i % columns;
    let nodes = (0..columns * rows)
        .map(|k| {
            let (i, j) = (k % columns, k / columns);
            place(i as f64 / steps_x as f64, j as f64 / steps_y as f64)
        })
        .collect();
    let mut mesh = Mesh {
        nodes: columns * rows,
        ..Mesh::default()
    };
    for j in 0..ny {
        for i in 0..nx {
            let local = |k: usize| node(order * i + k % row, order * j + k / row);
            mesh.shells.push(ShellNodes::from_fn(row * row, local));
        }
    }
    let nodes_of_row = |j: usize| -> Vec<usize> { (0..columns).map(|i| node(i, j)).collect() };
    let along = |j: usize| (0..nx).map(move |i| Edge::from_fn(row, |k| node(order * i + k, j)));
    for (name, j) in [("y0", 0), ("y1", steps_y)] {
        mesh.node_sets.insert(name.into(), nodes_of_row(j));
        mesh.edge_sets.insert(name.into(), along(j).collect());
    }
    if !closed {
        for (name, i) in [("x0", 0), ("x1", steps_x)] {
            let column = (0..rows).map(|j| node(i, j)).collect();
            mesh.node_sets.insert(name.into(), column);
            let edges = (0..ny).map(|j| Edge::from_fn(row, |k| node(i, order * j + k)));
            mesh.edge_sets.insert(name.into(), edges.collect());
        }
        for (name, i, j) in [
            ("x0y0", 0, 0),
            ("x1y0", steps_x, 0),
            ("x0y1", 0, steps_y),
            ("x1y1", steps_x, steps_y),
        ] {
            mesh.node_sets.insert(name.into(), vec![node(i, j)]);
        }
    }
    mesh.node_sets
        .insert("all".into(), (0..mesh.nodes).collect());
    mesh.face_sets
        .insert("all".into(), (0..mesh.shells.len()).collect());
    Generated { mesh, nodes }
}

/// A rectangular plate in the plane z = 0 from the origin to (length, width).
pub fn plate<S: Scalar>(size: [S; 2], elements: [usize; 2]) -> Generated<S> {
    plate_of(ShellKind::Mitc9, size, elements)
}

/// As [`plate`], of shells of this kind.
pub fn plate_of<S: Scalar>(kind: ShellKind, size: [S; 2], elements: [usize; 2]) -> Generated<S> {
    panel_of(kind, elements, false, |x, y| {
        Vec3::new(size[0] * x, size[1] * y, S::zero())
    })
}

/// A piece of a cylinder about the z axis: x runs along the arc from `angles[0]` to `angles[1]` \[rad\],
/// measured from the x axis, y along the axis from z = 0 to `length` \[m\]. The normal points outwards.
pub fn curved_panel<S: Scalar>(
    radius: S,
    length: S,
    angles: [S; 2],
    elements: [usize; 2],
) -> Generated<S> {
    curved_panel_of(ShellKind::Mitc9, (radius, length, angles), elements)
}

/// As [`curved_panel`], of shells of this kind.
pub fn curved_panel_of<S: Scalar>(
    kind: ShellKind,
    (radius, length, angles): (S, S, [S; 2]),
    elements: [usize; 2],
) -> Generated<S> {
    panel_of(kind, elements, false, |x, y| {
        on_cylinder(radius, angles[0] + (angles[1] - angles[0]) * x, length * y)
    })
}

/// A whole cylinder about the z axis; its ends are the edges `y0` (z = 0) and `y1` (z = length).
pub fn cylinder<S: Scalar>(radius: S, length: S, elements: [usize; 2]) -> Generated<S> {
    cylinder_of(ShellKind::Mitc9, (radius, length), elements)
}

/// As [`cylinder`], of shells of this kind.
pub fn cylinder_of<S: Scalar>(
    kind: ShellKind,
    (radius, length): (S, S),
    elements: [usize; 2],
) -> Generated<S> {
    panel_of(kind, elements, true, |x, y| {
        on_cylinder(radius, S::from(2.0 * std::f64::consts::PI * x), length * y)
    })
}

fn on_cylinder<S: Scalar>(radius: S, angle: S, z: S) -> Vec3<S> {
    let (sin, cos) = angle.sin_cos();
    Vec3::new(radius * cos, radius * sin, z)
}
