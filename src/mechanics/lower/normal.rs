//! The normal of the plane in which a scene may move.

use super::examine::ROUND_OFF;
use crate::math::{Vec3, rotation};
use crate::model::{Joint, JointKind, LoadKind, Model, Shape};

/// Unit vectors are parallel if the norm of their cross product is smaller.
const PARALLEL: f64 = 1e-6;
/// Largest number of joint axes that are tried.
const MOST: usize = 6;

/// Unit vector with round-off components set to zero.
pub(super) fn clean(v: Vec3<f64>) -> Vec3<f64> {
    let unit = v.normalize();
    unit.map(|x| if x.abs() < 4.0 * f64::EPSILON { 0.0 } else { x })
        .normalize()
}

/// Axis e3 of a joint, ground axes, as placed.
fn axis(model: &Model<f64>, joint: &Joint<f64>) -> Vec3<f64> {
    rotation::matrix(&model.bodies[joint.body_a].orientation) * joint.frame_a.axes[2]
}

/// Chooses one of v and −v: the same for both.
fn unsigned(v: Vec3<f64>) -> Vec3<f64> {
    // The first component that is about as large as the largest decides.
    let largest = v.amax();
    let first = v.iter().find(|x| x.abs() > 0.9 * largest);
    if first.is_some_and(|x| *x < 0.0) {
        -v
    } else {
        v
    }
}

/// Normals to try, the likeliest first: first the rotation axes of joints, the most frequent first,
/// then the normal of the vectors that must lie in the plane. Empty if these span the space. The
/// result does not depend on the order of the joints or on the signs of their axes.
pub(super) fn candidates(model: &Model<f64>) -> Vec<Vec3<f64>> {
    let turns = |joint: &&Joint<f64>| match joint.kind {
        JointKind::Revolute | JointKind::Planar | JointKind::Cylindrical => true,
        JointKind::Spherical
        | JointKind::Prismatic
        | JointKind::Universal
        | JointKind::Rod
        | JointKind::Weld
        | JointKind::Free
        | JointKind::Attachment
        | JointKind::Coupled(_) => false,
    };
    let joints = model.joints.iter().filter(turns);
    let mut axes: Vec<(usize, Vec3<f64>)> = Vec::new();
    for axis in joints.map(|joint| unsigned(clean(axis(model, joint)))) {
        let same = |(_, own): &&mut (usize, Vec3<f64>)| own.cross(&axis).norm() <= ROUND_OFF;
        match axes.iter_mut().find(same) {
            Some((count, _)) => *count += 1,
            None => axes.push((1, axis)),
        }
    }
    let by_direction = |a: &Vec3<f64>, b: &Vec3<f64>| {
        let pairs = b.iter().rev().zip(a.iter().rev());
        pairs.fold(std::cmp::Ordering::Equal, |order, (b, a)| {
            order.then(b.total_cmp(a))
        })
    };
    axes.sort_by(|(m, a), (n, b)| n.cmp(m).then_with(|| by_direction(a, b)));
    let mut all: Vec<Vec3<f64>> = axes.into_iter().map(|(_, axis)| axis).take(MOST).collect();
    if let Some(normal) = spanned(model).map(unsigned) {
        let known = all.iter().any(|own| own.cross(&normal).norm() <= ROUND_OFF);
        all.extend((!known).then_some(normal));
    }
    all
}

/// The normal of the vectors that must lie in the plane; `None` if these span the space.
fn spanned(model: &Model<f64>) -> Option<Vec3<f64>> {
    let (across, inside) = vectors(model);
    if let Some(first) = across.first() {
        return Some(clean(*first));
    }
    let Some(first) = inside.first() else {
        return Some(Vec3::z());
    };
    let normals = inside.iter().map(|other| first.cross(other));
    let largest = normals.max_by(|a, b| a.norm().total_cmp(&b.norm()));
    match largest {
        Some(normal) if normal.norm() > PARALLEL => Some(clean(normal)),
        // All are parallel: a ground axis across them.
        _ => [Vec3::z(), Vec3::x(), Vec3::y()]
            .into_iter()
            .find(|axis| axis.dot(first).abs() <= ROUND_OFF),
    }
}

/// Unit vectors that must be along the normal, and those that must lie in the plane.
fn vectors(model: &Model<f64>) -> (Vec<Vec3<f64>>, Vec<Vec3<f64>>) {
    let (mut across, mut inside) = (Vec::new(), vec![model.gravity]);
    let turn = |body: usize| rotation::matrix(&model.bodies[body].orientation);
    let bodies = model.bodies.iter().enumerate();
    for (i, body) in bodies.filter(|(i, _)| !model.is_carrier(*i)) {
        across.push(turn(i) * body.angular_velocity);
        inside.push(body.velocity);
    }
    for joint in &model.joints {
        inside.push(turn(joint.body_a) * joint.frame_a.point);
        if let Some(body) = joint.body_b {
            inside.push(turn(body) * joint.frame_b.point);
        }
        if joint.kind == JointKind::Prismatic {
            inside.push(axis(model, joint));
        }
    }
    for load in &model.loads {
        match &load.kind {
            LoadKind::Spring {
                body_a,
                body_b,
                point_a,
                point_b,
                ..
            }
            | LoadKind::DistanceStop {
                body_a,
                body_b,
                point_a,
                point_b,
                ..
            } => {
                let at = |body: usize, point: &Vec3<f64>| {
                    model.bodies[body].position + turn(body) * point
                };
                let b = body_b.map_or(*point_b, |body| at(body, point_b));
                inside.push(at(*body_a, point_a) - b);
                inside.push(turn(*body_a) * point_a);
            }
            LoadKind::Drag {
                body, point, plate, ..
            } => {
                inside.push(turn(*body) * point);
                inside.extend(plate.as_ref().map(|own| turn(*body) * own.normal));
            }
            LoadKind::Contact(own) => {
                let (of_a, of_b) = (turn(own.body_a), own.body_b.map(turn));
                inside.push(of_a * own.point_a);
                for direction in own.surface.directions() {
                    inside.push(of_b.map_or(*direction, |turn| turn * direction));
                }
                match &own.shape {
                    Shape::Sphere => {}
                    Shape::Wheel { axis, .. } => across.push(of_a * axis),
                    Shape::Capsule { half, .. } => inside.push(of_a * half),
                }
            }
            LoadKind::Force {
                body,
                direction,
                axes,
                ..
            } => inside.push(in_ground(&turn(*body), direction, *axes)),
            LoadKind::Torque {
                body,
                direction,
                axes,
                ..
            } => across.push(in_ground(&turn(*body), direction, *axes)),
            LoadKind::TorsionSpring { .. }
            | LoadKind::Damping { .. }
            | LoadKind::BallDamping { .. }
            | LoadKind::Bushing { .. }
            | LoadKind::Friction { .. }
            | LoadKind::JointStop { .. }
            | LoadKind::Controller(_)
            | LoadKind::Cable(_)
            | LoadKind::Distributed(_) => {}
        }
    }
    let units = |all: Vec<Vec3<f64>>| {
        let sized = all.into_iter().filter(|v| v.norm() > 0.0);
        sized.map(|v| v.normalize()).collect()
    };
    (units(across), units(inside))
}

fn in_ground(
    turn: &crate::math::Mat3<f64>,
    direction: &Vec3<f64>,
    axes: crate::model::Axes,
) -> Vec3<f64> {
    match axes {
        crate::model::Axes::Ground => *direction,
        crate::model::Axes::Body => turn * direction,
    }
}
