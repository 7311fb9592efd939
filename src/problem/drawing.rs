//! Data of a plot of the motion: outlines of the bodies, the view, ground and barrier.

use super::placement::{Assembly, split_location};
use super::quantity::vector;
use super::schema::functions::Function;
use super::schema::mechanics::{Body, Shape};
use super::schema::modal::Modal;
use super::schema::{Document, View};
use crate::math::Vec3;
use crate::model::Model;
use crate::model::finite::ElementMesh;
use crate::model::flexible::Quadratic;
use crate::structures::modal::{BeamFrame, FlexibleBeam};
use std::collections::BTreeMap;
use std::f64::consts::TAU;

/// Default number of instants of the time lapse.
const SNAPSHOTS: usize = 12;
/// Straight pieces of a side of a beam.
const SLICES: usize = 24;
/// Number of corners of the polygon that approximates a circle.
const CORNERS: usize = 32;

/// The outline of a body: points from its centre of mass, body axes \[m\].
#[derive(Clone, Debug)]
pub(crate) enum Outline {
    /// The silhouette is the convex hull of these points in the plane of the view.
    Hull(Vec<Vec3<f64>>),
    /// The silhouette is a circle of this radius about the centre of mass.
    Sphere(f64),
    /// A beam: a closed line of points of the deformed body.
    Deformed(DeformedLine),
    /// A body without a shape: lines from the centre of mass to these points.
    Spokes(Vec<Vec3<f64>>),
}

/// A closed line of points that move on their body.
#[derive(Clone, Debug)]
pub(crate) struct DeformedLine {
    /// Its points: where they are in the undeformed body (m), and their displacements by each coordinate.
    pub points: Vec<(Vec3<f64>, Vec<Vec3<f64>>)>,
    /// Between each pair of neighbouring points on one side and the next: the stress along both sides (Pa).
    /// Empty for a section without size. The points of the other side follow in opposite order.
    pub stresses: Vec<[Quadratic<f64>; 2]>,
}

/// A displacement of a point of a beam against its axes, in its axes (m).
#[derive(Clone, Debug)]
pub(crate) struct BeamPoint {
    /// Name of the beam, the point and the direction.
    pub name: String,
    /// The body.
    pub body: usize,
    /// The displacement by each coordinate.
    pub by: Vec<f64>,
}

/// A barrier across the direction of flight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct BarrierLine {
    /// Position along the direction of flight \[m\].
    pub distance: f64,
    /// Height of the top above the origin \[m\].
    pub top: f64,
}

/// How the motion of a design is drawn.
#[derive(Clone, Debug)]
pub(crate) struct Drawing {
    /// Ground axis that points to the right.
    pub right: Vec3<f64>,
    /// Ground axis that points up.
    pub up: Vec3<f64>,
    /// Number of instants of the time lapse.
    pub snapshots: usize,
    /// Outlines in the order of the bodies.
    pub outlines: Vec<Outline>,
    /// Points of beams whose displacements are drawn against time.
    pub beam_points: Vec<BeamPoint>,
    /// Points whose paths are drawn: body, and point from its centre of mass in body axes \[m\].
    pub traces: Vec<(usize, Vec3<f64>)>,
    /// Height of the ground on which a range is measured \[m\].
    pub ground: Option<f64>,
    /// The barrier of a clearance.
    pub barrier: Option<BarrierLine>,
}

/// The drawing of a checked document at the design `x`.
pub(crate) fn drawing(document: &Document, order: &[usize], x: &[f64]) -> Drawing {
    let assembly = Assembly::new(document, order, x);
    let (right, up) = axes(document.plot.view.unwrap_or_default());
    let scene = super::scene::scene(document, order, x);
    let gravity = &scene.model.gravity;
    let falls = up.dot(gravity) < -0.999 * gravity.norm();
    let ground = scene.functions.iter().find_map(|function| match function {
        crate::functions::Function::Reduced {
            instant: crate::functions::Instant::Range { projectile, .. },
            ..
        } => Some(projectile.ground),
        _ => None,
    });
    let barrier = document
        .functions
        .values()
        .find_map(|function| match function {
            Function::Clearance(clearance) => Some(BarrierLine {
                distance: clearance.barrier.distance.get(x),
                top: clearance.barrier.top.get(x),
            }),
            _ => None,
        });
    let traces = document.plot.trace.iter().filter_map(|text| {
        let body = split_location(text).0;
        let index = assembly.index(body)?;
        Some((
            index,
            assembly.named_in_body(text) - assembly.poses[index].centre,
        ))
    });
    Drawing {
        right,
        up,
        snapshots: document.plot.snapshots.unwrap_or(SNAPSHOTS),
        outlines: outlines(document, &assembly, &scene.model, right.cross(&up), x),
        beam_points: beam_points(document, x),
        traces: traces.collect(),
        // Heights appear only if gravity points down in the view.
        ground: ground.filter(|_| falls),
        barrier: barrier.filter(|_| falls),
    }
}

/// Outlines of all bodies of a model. Those that a file does not have are not seen.
fn outlines(
    document: &Document,
    assembly: &Assembly<f64>,
    model: &Model<f64>,
    towards: Vec3<f64>,
    x: &[f64],
) -> Vec<Outline> {
    let written = document.bodies.values().zip(&assembly.poses);
    let mut all: Vec<Outline> = written
        .map(
            |(body, pose)| match (&body.beam, &body.elements, &body.modal) {
                (None, Some(elements), _) => {
                    let mesh = super::elements::prepared(document, elements).mesh.clone();
                    Outline::Deformed(shell_outline(&mesh))
                }
                (Some(beam), _, _) => {
                    let sight = pose.rotation.tr_mul(&towards);
                    Outline::Deformed(beam_outline(&super::beam::beam(beam, x), &sight))
                }
                (None, None, Some(modal)) => Outline::Deformed(line_of_points(modal, x)),
                (None, None, None) => outline(body, pose.centre, x),
            },
        )
        .collect();
    all.resize(model.bodies.len(), Outline::Spokes(Vec::new()));
    all
}

/// The free edges of shells, one after the other.
fn shell_outline(mesh: &ElementMesh) -> DeformedLine {
    const EDGES: [[usize; 3]; 4] = [[0, 1, 2], [2, 5, 8], [8, 7, 6], [6, 3, 0]];
    let edges = |element: &crate::model::finite::ShellElement| {
        let nodes = element.nodes;
        EDGES.map(|edge| edge.map(|local| nodes[local]))
    };
    let mut uses: BTreeMap<usize, usize> = BTreeMap::new();
    for edge in mesh.elements.iter().flat_map(edges) {
        *uses.entry(edge[1]).or_default() += 1;
    }
    let all = mesh.elements.iter().flat_map(edges);
    let mut next: BTreeMap<usize, [usize; 3]> = (all.filter(|edge| uses[&edge[1]] == 1))
        .map(|edge| (edge[0], edge))
        .collect();
    let mut line = Vec::new();
    while let Some((&start, _)) = next.first_key_value() {
        let mut at = start;
        while let Some([from, middle, to]) = next.remove(&at) {
            line.extend([from, middle]);
            at = to;
        }
        line.push(at);
    }
    let point = |node: usize| {
        let mut modes = vec![Vec3::zeros(); mesh.coordinates];
        for (k, coordinate) in mesh.displacements[node].iter().enumerate() {
            if let Some(coordinate) = coordinate {
                modes[*coordinate][k] = 1.0;
            }
        }
        (mesh.nodes[node], modes)
    };
    DeformedLine {
        points: line.into_iter().map(point).collect(),
        stresses: Vec::new(),
    }
}

/// The sides of a beam that is seen along `sight`, in its own axes.
fn beam_outline(beam: &FlexibleBeam<f64>, sight: &Vec3<f64>) -> DeformedLine {
    // The side that is seen best: along y or z.
    let along_y = sight.z.abs() >= sight.y.abs();
    let [y, z] = beam.half_sizes().unwrap_or([0.0; 2]);
    let side = if along_y { [y, 0.0] } else { [0.0, z] };
    let at = |k: usize, sign: f64| {
        let modes = beam.point(k as f64 / SLICES as f64, side.map(|x| x * sign));
        (modes.position, modes.displacement)
    };
    let there = (0..=SLICES).map(|k| at(k, 1.0));
    let back = (0..=SLICES).rev().map(|k| at(k, -1.0));
    let middle = |k: usize| (k as f64 + 0.5) / SLICES as f64;
    let stress = |k: usize| {
        let along = |sign: f64| beam.fibre_stress(middle(k), side.map(|x| x * sign));
        [along(1.0), along(-1.0)]
    };
    let sized = beam.half_sizes().is_some();
    DeformedLine {
        points: there.chain(back).collect(),
        stresses: (0..SLICES).filter(|_| sized).map(stress).collect(),
    }
}

/// The free end of beams whose start holds their axes, the middle of those on their chord, in each direction
/// in which they bend.
fn beam_points(document: &Document, x: &[f64]) -> Vec<BeamPoint> {
    let mut all = Vec::new();
    for (body, (name, written)) in document.bodies.iter().enumerate() {
        let Some(written) = &written.beam else {
            continue;
        };
        let beam = super::beam::beam(written, x);
        let (place, at) = match beam.frame {
            BeamFrame::Clamped => ("end", 1.0),
            BeamFrame::Chord => ("middle", 0.5),
        };
        let modes = beam.point(at, [0.0; 2]);
        for (k, direction) in [(1, "y"), (2, "z")] {
            let by: Vec<f64> = modes.displacement.iter().map(|n| n[k]).collect();
            if by.iter().any(|&n| n != 0.0) {
                let name = format!("{name}: {place} along {direction}");
                all.push(BeamPoint { name, body, by });
            }
        }
    }
    all
}

/// Lines between the points of a body of files, in their order and back.
fn line_of_points(modal: &Modal, x: &[f64]) -> DeformedLine {
    let scale = super::modal::scale(modal, x);
    let points = modal.body().points.iter();
    let mut points: Vec<_> = points
        .map(|point| (point.position * scale, point.displacement.clone()))
        .collect();
    let back: Vec<_> = points.iter().rev().skip(1).cloned().collect();
    points.extend(back);
    DeformedLine {
        points,
        stresses: Vec::new(),
    }
}

/// The axes to the right and up of the file's view, or of another one if it has none.
pub(super) fn view_or(document: &Document, other: View) -> [[f64; 3]; 2] {
    let (right, up) = axes(document.plot.view.unwrap_or(other));
    [right.into(), up.into()]
}

/// The axes of a view that point right and up.
fn axes(view: View) -> (Vec3<f64>, Vec3<f64>) {
    let (ex, ey, ez) = (Vec3::x(), Vec3::y(), Vec3::z());
    match view {
        View::Xy => (ex, ey),
        View::Xz => (ex, ez),
        View::Yz => (ey, ez),
        View::Yx => (ey, ex),
        View::Zx => (ez, ex),
        View::Zy => (ez, ey),
    }
}

/// The outline of a body whose centre of mass is at `centre` \[m\] in its axes.
fn outline(body: &Body, centre: Vec3<f64>, x: &[f64]) -> Outline {
    let circle = |radius: f64| {
        (0..CORNERS).map(move |k| {
            let (s, c) = (TAU * k as f64 / CORNERS as f64).sin_cos();
            (radius * c, radius * s)
        })
    };
    match &body.shape {
        Some(Shape::Box { size }) => {
            let half = vector(size, x) * 0.5;
            let signs =
                |k: usize| [k & 1, k >> 1 & 1, k >> 2 & 1].map(|bit| 2.0 * bit as f64 - 1.0);
            Outline::Hull(
                (0..8)
                    .map(|k| half.component_mul(&Vec3::from(signs(k))))
                    .collect(),
            )
        }
        Some(Shape::Cylinder { radius, length }) => {
            let half = 0.5 * length.get(x);
            let rim = circle(radius.get(x));
            Outline::Hull(
                rim.flat_map(|(a, b)| [Vec3::new(a, b, -half), Vec3::new(a, b, half)])
                    .collect(),
            )
        }
        Some(Shape::Rod { length, radius }) => {
            let half = 0.5 * length.get(x);
            let rim = circle(radius.get(x));
            Outline::Hull(
                rim.flat_map(|(a, b)| [Vec3::new(-half, a, b), Vec3::new(half, a, b)])
                    .collect(),
            )
        }
        Some(Shape::Sphere { radius }) => Outline::Sphere(radius.get(x)),
        Some(Shape::Point) | None => Outline::Spokes(
            body.points
                .values()
                .map(|p| vector(p, x) - centre)
                .collect(),
        ),
    }
}
