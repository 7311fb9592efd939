//! The normal of the plane that a scene may move in.

use super::examine::ROUND_OFF;
use crate::math::{Vec3, rotation};
use crate::model::{Joint, JointKind, LoadKind, Model};

/// Vectors whose angle is smaller are taken to be parallel when a normal is made of two.
const PARALLEL: f64 = 1e-6;

/// Unit vector with round-off components set to zero.
pub(super) fn clean(v: Vec3<f64>) -> Vec3<f64> {
    let unit = v.normalize();
    unit.map(|x| if x.abs() < 4.0 * f64::EPSILON { 0.0 } else { x })
        .normalize()
}

/// The axis e3 of a joint in ground axes, where its bodies are placed.
fn axis(model: &Model<f64>, joint: &Joint<f64>) -> Vec3<f64> {
    rotation::matrix(&model.bodies[joint.body_a].orientation) * joint.frame_a.axes[2]
}

/// The normal that most of the joints' axes agree on; without such axes, that of the vectors that
/// have to lie in the plane. `None` if these span the space.
pub(super) fn candidate(model: &Model<f64>) -> Option<Vec3<f64>> {
    let turns = |joint: &&Joint<f64>| match joint.kind {
        JointKind::Revolute | JointKind::Planar | JointKind::Cylindrical => true,
        JointKind::Spherical
        | JointKind::Prismatic
        | JointKind::Universal
        | JointKind::Rod
        | JointKind::Weld => false,
    };
    let axes: Vec<Vec3<f64>> = model
        .joints
        .iter()
        .filter(turns)
        .map(|joint| axis(model, joint))
        .collect();
    let agree = |a: &Vec3<f64>| {
        let same = |b: &&Vec3<f64>| a.cross(b).norm() <= ROUND_OFF;
        axes.iter().filter(same).count()
    };
    // The first of those that most agree on.
    let most = axes.iter().map(agree).max();
    if let Some(first) = axes.iter().find(|axis| Some(agree(axis)) == most) {
        return Some(clean(*first));
    }
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
        // All on one line: a ground axis across it.
        _ => [Vec3::z(), Vec3::x(), Vec3::y()]
            .into_iter()
            .find(|axis| axis.dot(first).abs() <= ROUND_OFF),
    }
}

/// Unit vectors that have to be along the normal, and those that have to lie in the plane.
fn vectors(model: &Model<f64>) -> (Vec<Vec3<f64>>, Vec<Vec3<f64>>) {
    let (mut across, mut inside) = (Vec::new(), vec![model.gravity]);
    let turn = |body: usize| rotation::matrix(&model.bodies[body].orientation);
    for (i, body) in model.bodies.iter().enumerate() {
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
            } => {
                let at = |body: usize, point: &Vec3<f64>| {
                    model.bodies[body].position + turn(body) * point
                };
                let b = body_b.map_or(*point_b, |body| at(body, point_b));
                inside.push(at(*body_a, point_a) - b);
                inside.push(turn(*body_a) * point_a);
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
            | LoadKind::Friction { .. } => {}
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
