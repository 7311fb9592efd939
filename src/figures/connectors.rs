//! Where joints, rods, springs and arms are in a picture of the motion.

use crate::functions::snapshot::Snapshot;
use crate::integrate::Trajectory;
use crate::math::Vec3;
use crate::model::{JointKind, LoadKind, Model};
use crate::plots::{Connector, ConnectorKind};
use crate::problem::{Drawing, Outline};

/// A point of a body from its centre of mass, or of ground.
type Fixed = (Option<usize>, Vec3<f64>);

/// A connector at some instants, in ground axes.
pub(super) struct Joined {
    pub kind: ConnectorKind,
    /// Whether it joins a body to ground.
    pub to_ground: bool,
    /// Its two points at each instant \[m\].
    pub ends: Vec<[Vec3<f64>; 2]>,
}

/// The connectors of a model at the instants of a time lapse, in the plane of the view.
pub(super) fn connectors(
    of: (&Model<f64>, &Trajectory<f64>),
    drawing: &Drawing,
    instants: &[usize],
) -> Vec<Connector> {
    let flat = |joined: Joined| Connector {
        kind: joined.kind,
        to_ground: joined.to_ground,
        ends: (joined.ends.iter())
            .map(|ends| ends.each_ref().map(|p| drawing.flat(p)))
            .collect(),
    };
    joined(of, drawing, instants)
        .into_iter()
        .map(flat)
        .collect()
}

/// The connectors of a model at some instants.
pub(super) fn joined(
    (model, run): (&Model<f64>, &Trajectory<f64>),
    drawing: &Drawing,
    instants: &[usize],
) -> Vec<Joined> {
    let place = |k: usize, (body, point): &Fixed| match body {
        Some(body) => Snapshot::of(model, run, k).motion(*body).point(point),
        None => *point,
    };
    let mut all = Vec::new();
    let mut add = |kind, to_ground, ends: &dyn Fn(usize) -> [Vec3<f64>; 2]| {
        all.push(Joined {
            kind,
            to_ground,
            ends: instants.iter().map(|&k| ends(k)).collect(),
        });
    };
    // Points that a joint, spring or arm uses, by body.
    let traces = drawing.traces.iter();
    let mut held: Vec<(usize, Vec3<f64>)> = traces.map(|own| (own.body, own.point)).collect();
    for load in &model.loads {
        if let LoadKind::Cable(own) = &load.kind {
            for part in own.points.windows(2) {
                let ends = |k| [&part[0], &part[1]].map(|own| place(k, &(own.body, own.point)));
                add(ConnectorKind::Rod, part[1].body.is_none(), &ends);
            }
            let points = own.points.iter();
            held.extend(points.filter_map(|own| Some((own.body?, own.point))));
        }
        if let LoadKind::Spring {
            body_a,
            body_b,
            point_a,
            point_b,
            ..
        } = &load.kind
        {
            let both: [Fixed; 2] = [(Some(*body_a), *point_a), (*body_b, *point_b)];
            held.extend(
                both.iter()
                    .filter_map(|(body, point)| Some(((*body)?, *point))),
            );
            let ends = |k| both.each_ref().map(|end| place(k, end));
            add(ConnectorKind::Spring, body_b.is_none(), &ends);
        }
    }
    for joint in &model.joints {
        let both: [Fixed; 2] = [
            (Some(joint.body_a), joint.frame_a.point),
            (joint.body_b, joint.frame_b.point),
        ];
        let kind = match joint.kind {
            JointKind::Rod => ConnectorKind::Rod,
            JointKind::Prismatic | JointKind::Cylindrical => ConnectorKind::Slider,
            JointKind::Spherical | JointKind::Revolute | JointKind::Universal => {
                ConnectorKind::Hinge
            }
            // Welded bodies, and bodies that slide in a plane, have no common point.
            JointKind::Weld
            | JointKind::Free
            | JointKind::Planar
            | JointKind::Attachment
            | JointKind::Coupled(_) => {
                continue;
            }
        };
        held.extend(both.iter().filter_map(|(body, point)| {
            let follows = kind != ConnectorKind::Slider;
            follows.then_some(((*body)?, *point))
        }));
        let ends = |k| match kind {
            ConnectorKind::Slider => {
                let at = place(k, &both[0]);
                let motion = Snapshot::of(model, run, k).motion(joint.body_a);
                [at, at + motion.rotation * joint.frame_a.axes[2]]
            }
            _ => both.each_ref().map(|end| place(k, end)),
        };
        add(kind, joint.body_b.is_none(), &ends);
    }
    for (body, point) in held {
        if beside(&drawing.outlines[body], &point) {
            let ends = |k| [Vec3::zeros(), point].map(|p| place(k, &(Some(body), p)));
            add(ConnectorKind::Arm { body }, false, &ends);
        }
    }
    all
}

/// Whether a point of a body lies outside its shape.
fn beside(outline: &Outline, point: &Vec3<f64>) -> bool {
    match outline {
        Outline::Sphere(radius) => point.norm() > radius * (1.0 + 1e-9),
        // Joints hold points of beams and shells by bodies of their own.
        Outline::Deformed(_) | Outline::Shells(_) => false,
        // Corners are on the surface, so the box around them holds all of the shape.
        Outline::Hull(corners) => (0..3).any(|i| {
            let reach = corners.iter().map(|c| c[i].abs()).fold(0.0, f64::max);
            let longest = corners.iter().map(Vec3::norm).fold(0.0, f64::max);
            point[i].abs() > reach + 1e-9 * longest
        }),
        Outline::Spokes(ends) => {
            let near = |end: &Vec3<f64>| (end - point).norm() < 1e-9 * (1.0 + point.norm());
            point.norm() > 0.0 && !ends.iter().any(near)
        }
    }
}
