//! Where joints, rods, springs and arms are in a picture of the motion.

use crate::functions::snapshot::Snapshot;
use crate::integrate::Trajectory;
use crate::math::Vec3;
use crate::model::{JointKind, LoadKind, Model, Role};
use crate::plots::{Connector, ConnectorKind};
use crate::problem::{Drawing, Outline};
use crate::system::loads;

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
    let forces = forces(of, instants).into_iter();
    let forces = forces.map(|(to_ground, ends)| Joined {
        kind: ConnectorKind::Force,
        to_ground,
        ends,
    });
    let joined = joined(of, drawing, instants);
    joined.into_iter().chain(forces).map(flat).collect()
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

/// Most contacts whose forces are drawn: more hide the machine.
const MOST: usize = 24;
/// Length of the arrow of the largest force, relative to the room in which bodies and contacts are.
const LONGEST: f64 = 0.3;

/// The arrows of the forces of contacts on their first bodies at some instants, and whether each is with ground; none without
/// force.
fn forces(
    (model, run): (&Model<f64>, &Trajectory<f64>),
    instants: &[usize],
) -> Vec<(bool, Vec<[Vec3<f64>; 2]>)> {
    let contacts = model.loads.iter();
    let contacts = contacts.filter(|load| matches!(load.kind, LoadKind::Contact(_)));
    if !(1..=MOST).contains(&contacts.count()) {
        return Vec::new();
    }
    let motions: Vec<_> = instants
        .iter()
        .map(|&k| Snapshot::of(model, run, k).motions())
        .collect();
    let pressed: Vec<_> = motions
        .iter()
        .map(|motions| loads::contact_forces(model, motions))
        .collect();
    let places = motions.iter().flatten().zip(model.bodies.iter().cycle());
    let places = places.filter(|(_, body)| body.role == Role::Solid);
    let places = places.map(|(motion, _)| motion.position);
    let touched = pressed.iter().flatten().map(|(_, [place, _])| *place);
    let all: Vec<Vec3<f64>> = places.chain(touched).collect();
    let room = |i: usize| {
        let (low, high) = all
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| {
                (a.min(x[i]), b.max(x[i]))
            });
        high - low
    };
    let size = (0..3).map(room).fold(0.0, f64::hypot);
    let largest = pressed.iter().flatten();
    let largest = largest.fold(0.0, |most: f64, (_, [_, force])| most.max(force.norm()));
    if largest == 0.0 {
        return Vec::new();
    }
    let scale = LONGEST * size / largest;
    let of = |i: usize| {
        let (load, _) = pressed[0][i];
        let to_ground = match &model.loads[load].kind {
            LoadKind::Contact(own) => own.body_b.is_none(),
            _ => false,
        };
        let ends = pressed.iter().map(|own| {
            let (_, [place, force]) = own[i];
            [place, place + force * scale]
        });
        (to_ground, ends.collect())
    };
    (0..pressed[0].len()).map(of).collect()
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
