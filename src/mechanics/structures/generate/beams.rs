//! Generators of beams: straight, curved, and frames.

use crate::math::{Scalar, Vec3, scalar::length};
use crate::structures::mesh::Mesh;

/// A mesh of beams, the places of its nodes \[m\] and the orientation of each beam.
#[derive(Clone, Debug)]
pub struct GeneratedBeams<S> {
    /// The mesh.
    pub mesh: Mesh,
    /// Places of the nodes.
    pub nodes: Vec<Vec3<S>>,
    /// A vector in the plane of each beam and its axis 2.
    pub orientations: Vec<Vec3<S>>,
}

/// A member of a frame: a straight line between two of its points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Member<S> {
    /// The points that it joins.
    pub ends: [usize; 2],
    /// Number of elements.
    pub elements: usize,
    /// A vector in the plane of the member and axis 2 of its section.
    pub orientation: Vec3<S>,
}

/// A line of beams; `place` maps ξ ∈ [0, 1] to a point. Its ends are the sets of nodes `start` and `end`;
/// `all` is the set of all nodes and of all beams.
pub fn line<S: Scalar>(
    elements: usize,
    orientation: Vec3<S>,
    place: impl Fn(f64) -> Vec3<S>,
) -> GeneratedBeams<S> {
    let count = 2 * elements + 1;
    let mut mesh = Mesh {
        nodes: count,
        beams: (0..elements)
            .map(|e| [0, 1, 2].map(|k| 2 * e + k))
            .collect(),
        ..Mesh::default()
    };
    mesh.node_sets.insert("start".into(), vec![0]);
    mesh.node_sets.insert("end".into(), vec![count - 1]);
    name_all(&mut mesh);
    GeneratedBeams {
        mesh,
        nodes: (0..count)
            .map(|k| place(k as f64 / (count - 1) as f64))
            .collect(),
        orientations: vec![orientation; elements],
    }
}

/// A straight beam from one point to another.
pub fn straight_beam<S: Scalar>(
    ends: [Vec3<S>; 2],
    orientation: Vec3<S>,
    elements: usize,
) -> GeneratedBeams<S> {
    line(elements, orientation, |x| {
        ends[0] + (ends[1] - ends[0]) * S::from(x)
    })
}

/// An arc in the plane z = 0 about the origin, from `angles[0]` to `angles[1]` \[rad\], measured from the x
/// axis. Axis 2 of its section is the z axis.
pub fn curved_beam<S: Scalar>(radius: S, angles: [S; 2], elements: usize) -> GeneratedBeams<S> {
    line(elements, Vec3::z(), |x| {
        let (sin, cos) = (angles[0] + (angles[1] - angles[0]) * x).sin_cos();
        Vec3::new(radius * cos, radius * sin, S::zero())
    })
}

/// A frame of straight members between points, which are joined rigidly. Point k is the set of nodes
/// `point{k}`, member k the set of beams `member{k}`; `all` as above.
///
/// # Panics
/// If a member names a point that there is not, or the same one twice.
pub fn frame<S: Scalar>(points: &[Vec3<S>], members: &[Member<S>]) -> GeneratedBeams<S> {
    let mut mesh = Mesh::default();
    let (mut nodes, mut orientations) = (points.to_vec(), Vec::new());
    for (k, member) in members.iter().enumerate() {
        let [first, last] = member.ends;
        assert!(first != last && first.max(last) < points.len());
        let inner = 2 * member.elements - 1;
        let start = nodes.len();
        let way = points[last] - points[first];
        let steps = (1..=inner).map(|i| S::from(i as f64 / (inner + 1) as f64));
        nodes.extend(steps.map(|x| points[first] + way * x));
        let node = |i: usize| match i {
            0 => first,
            i if i == inner + 1 => last,
            i => start + i - 1,
        };
        let beams = mesh.beams.len()..mesh.beams.len() + member.elements;
        mesh.beams
            .extend((0..member.elements).map(|e| [0, 1, 2].map(|i| node(2 * e + i))));
        orientations.extend(std::iter::repeat_n(member.orientation, member.elements));
        mesh.beam_sets.insert(format!("member{k}"), beams.collect());
    }
    for k in 0..points.len() {
        mesh.node_sets.insert(format!("point{k}"), vec![k]);
    }
    mesh.nodes = nodes.len();
    name_all(&mut mesh);
    GeneratedBeams {
        mesh,
        nodes,
        orientations,
    }
}

fn name_all(mesh: &mut Mesh) {
    mesh.node_sets
        .insert("all".into(), (0..mesh.nodes).collect());
    mesh.beam_sets
        .insert("all".into(), (0..mesh.beams.len()).collect());
}

/// A vector that any section of a straight beam can be turned by: the global axis least along it, made
/// square to it.
pub fn any_orientation(ends: [Vec3<f64>; 2]) -> Vec3<f64> {
    let way = ends[1] - ends[0];
    let t = way / length(&way);
    let least = (0..3).min_by(|&a, &b| t[a].abs().total_cmp(&t[b].abs()));
    let axis = Vec3::from_fn(|i, _| f64::from(u8::from(Some(i) == least)));
    axis - t * t.dot(&axis)
}
