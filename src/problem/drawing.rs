//! Data of a plot of the motion: outlines of the bodies, the view, ground and barrier.

use super::elastic_drawing::{
    DeformedLine, ElasticPoint, ShellLine, Trace, beam_outline, beam_points, line_of_points,
    shell_line, shell_points, traces,
};
use super::fibres::{BeamFibres, fibres};
use super::placement::Assembly;
use super::statics::properties::thickness;
use crate::functions::{Instant, Quantity};
use crate::math::Vec3;
use crate::model::Model;
use crate::quantity::vector;
use crate::schema::functions::Function;
use crate::schema::mechanics::{Body, BodyPoint, Shape};
use crate::schema::{Document, View};
use std::f64::consts::TAU;

/// Default number of instants of the time lapse.
const SNAPSHOTS: usize = 12;
/// Shift to the left and down of a point that is a metre nearer to the viewer.
const OBLIQUE: [f64; 2] = [0.4, 0.3];
/// Number of corners of the polygon that approximates a circle.
const CORNERS: usize = 32;

/// The outline of a body: points from its centre of mass, body axes \[m\].
#[derive(Clone, Debug)]
pub enum Outline {
    /// The silhouette is the convex hull of these points in the plane of the view.
    Hull(Vec<Vec3<f64>>),
    /// The silhouette is a circle of this radius about the centre of mass.
    Sphere(f64),
    /// A beam: a closed line of points of the deformed body.
    Deformed(DeformedLine),
    /// Shells: their free edges.
    Shells(ShellLine),
    /// A body without a shape: lines from the centre of mass to these points.
    Spokes(Vec<Vec3<f64>>),
}

/// A barrier across the direction of flight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BarrierLine {
    /// Position along the direction of flight \[m\].
    pub distance: f64,
    /// Height of the top above the origin \[m\].
    pub top: f64,
}

/// How the motion of a design is drawn.
#[derive(Clone, Debug)]
pub struct Drawing {
    /// A point p is drawn at right · p to the right: a ground axis, or for shells an axis less a
    /// part of the one that points to the viewer.
    pub right: Vec3<f64>,
    /// A point p is drawn at up · p above the origin.
    pub up: Vec3<f64>,
    /// Number of instants of the time lapse.
    pub snapshots: usize,
    /// Outlines in the order of the bodies.
    pub outlines: Vec<Outline>,
    /// Points of flexible bodies whose displacements are drawn against time.
    pub elastic_points: Vec<ElasticPoint>,
    /// Points whose paths are drawn.
    pub traces: Vec<Trace>,
    /// In the order of the bodies: stresses along fibres of their beams.
    pub fibres: Vec<Vec<BeamFibres>>,
    /// Height of the ground on which a range is measured \[m\].
    pub ground: Option<f64>,
    /// The barrier of a clearance.
    pub barrier: Option<BarrierLine>,
}

impl Drawing {
    /// Place of a point of ground in the picture, to the right and up.
    pub fn flat(&self, point: &Vec3<f64>) -> [f64; 2] {
        [self.right.dot(point), self.up.dot(point)]
    }

    /// The direction to the viewer: points along it have one place in the picture.
    pub fn sight(&self) -> Vec3<f64> {
        self.right.cross(&self.up)
    }

    /// Whether it is seen from above and beside.
    pub fn is_oblique(&self) -> bool {
        self.sight().norm() > 1.0 + 1e-9
    }
}

/// The drawing of a checked document at the design `x`.
pub fn drawing(document: &Document, order: &[usize], x: &[f64]) -> Drawing {
    let assembly = Assembly::new(document, order, x);
    let (right, up) = axes(document.plot.view.unwrap_or_default());
    let towards = right.cross(&up);
    let scene = super::scene::scene(document, order, x);
    let gravity = &scene.model.gravity;
    let falls = up.dot(gravity) < -0.999 * gravity.norm();
    let ground = scene.functions.iter().find_map(|function| match function {
        crate::functions::Function::Reduced {
            of: Quantity::Of(Instant::Range { projectile, .. }),
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
    let mut fibres = fibres(document, x);
    fibres.resize(scene.model.bodies.len(), Vec::new());
    let mut elastic_points = beam_points(document, x);
    elastic_points.extend(shell_points(document));
    // Shells seen along their surface are lines, so the view is from above and beside.
    let shells = document.bodies.values().any(|body| body.elements.is_some());
    let oblique = if shells { OBLIQUE } else { [0.0; 2] };
    Drawing {
        right: right - towards * oblique[0],
        up: up - towards * oblique[1],
        snapshots: document.plot.snapshots.unwrap_or(SNAPSHOTS),
        outlines: outlines(document, &assembly, &scene.model, towards, x),
        elastic_points,
        traces: traces(document, &assembly, x),
        fibres,
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
                    let prepared = super::elements::prepared(document, elements);
                    let of = |&slot: &usize| thickness(&elements.structure, slot).get(x);
                    let thickness = prepared.slots.iter().map(of).collect();
                    Outline::Shells(shell_line(&prepared.mesh, thickness))
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
    let surface = body.mass_properties.as_ref();
    if let Some(solid) = surface.and_then(|own| own.solid.as_ref()) {
        return Outline::Hull(solid.outermost.iter().map(|p| p - centre).collect());
    }
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
            // Points between others lie on lines that are drawn.
            (body.points.values())
                .filter_map(BodyPoint::coordinates)
                .map(|p| vector(p, x) - centre)
                .collect(),
        ),
    }
}
