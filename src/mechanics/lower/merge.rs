//! Merges bodies that are welded to each other.
//!
//! Member i of a cluster has a constant pose on its host h, R_i = R_h Q_i and r_i = c + R_h s_i.
//! Here c is the common centre of mass. Mass, centre of mass and inertia of the host become
//!
//! ```text
//! m = Σ m_i,     c = Σ m_i r_i / m,     J = Σ Q_i J_i Q_iᵀ + m_i (sᵀs − s sᵀ)
//! ```
//!
//! in the axes of the host. The same poses map frames, points and directions of joints, loads and
//! functions to the host. The poses depend on the design. The other members stay in the model as
//! copies of the host without mass and unknowns, so the numbers of the bodies do not change. Their
//! motion follows from that of the host after a run.

use crate::functions::seen::Seen;
use crate::functions::{Instant, Scene};
use crate::integrate::Trajectory;
use crate::math::rotation::{self, Quat};
use crate::math::{Mat3, Scalar, Vec3};
use crate::model::{Axes, Joint, JointFrame, LoadKind, Mobility, Model};
use crate::system::Numbering;

/// Bodies that move as one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Cluster {
    /// The body whose unknowns are kept.
    pub host: usize,
    /// All members, including the host.
    pub members: Vec<usize>,
}

/// Constant pose of a body on its host.
#[derive(Clone, Copy, Debug)]
struct Pose<S> {
    host: usize,
    /// s \[m\]: from the common centre of mass to the body's, axes of the host.
    centre: Vec3<S>,
    /// Q: rotation from the axes of the body to those of the host; matrix and Euler parameters.
    turn: Mat3<S>,
    parameters: Quat<S>,
}

impl<S: Scalar> Pose<S> {
    fn point(&self, point: &Vec3<S>) -> Vec3<S> {
        self.centre + self.turn * point
    }
}

/// The common centre of mass of a cluster as placed, and the poses of its members on the host.
fn poses<S: Scalar>(model: &Model<S>, cluster: &Cluster) -> (Vec3<S>, Vec<(usize, Pose<S>)>) {
    let (mut mass, mut moment) = (S::zero(), Vec3::zeros());
    for &i in &cluster.members {
        let body = &model.bodies[i];
        mass += body.mass;
        moment += body.position * body.mass;
    }
    // Bodies without mass have no centre of mass; the host's place serves.
    let centre = match mass.re() > 0.0 {
        true => moment / mass,
        false => model.bodies[cluster.host].position,
    };
    let host = &model.bodies[cluster.host].orientation;
    let back = rotation::conjugate(host);
    let to_host = rotation::matrix(host).transpose();
    let pose = |&i: &usize| {
        let body = &model.bodies[i];
        let (turn, parameters) = match i == cluster.host {
            true => {
                let [one, zero] = [S::one(), S::zero()];
                (Mat3::identity(), [one, zero, zero, zero])
            }
            false => (
                to_host * rotation::matrix(&body.orientation),
                rotation::compose(&back, &body.orientation),
            ),
        };
        let pose = Pose {
            host: cluster.host,
            centre: to_host * (body.position - centre),
            turn,
            parameters,
        };
        (i, pose)
    };
    (centre, cluster.members.iter().map(pose).collect())
}

/// Merges each cluster into one body. The joints `welds` keep no rows.
pub(super) fn merge<S: Scalar>(scene: &mut Scene<S>, clusters: &[Cluster], welds: &[usize]) {
    let model = &mut scene.model;
    let mut on_host: Vec<Option<Pose<S>>> = vec![None; model.bodies.len()];
    for cluster in clusters {
        let (centre, members) = poses(model, cluster);
        let (mut mass, mut inertia) = (S::zero(), Mat3::zeros());
        for (i, pose) in &members {
            let body = &model.bodies[*i];
            let s = &pose.centre;
            let about = Mat3::identity() * s.dot(s) - s * s.transpose();
            mass += body.mass;
            inertia += pose.turn * body.inertia * pose.turn.transpose() + about * body.mass;
            on_host[*i] = Some(*pose);
        }
        let own = on_host[cluster.host].as_ref();
        let arm = own.map_or(Vec3::zeros(), |pose| -pose.centre);
        let host = &mut model.bodies[cluster.host];
        let turn = rotation::matrix(&host.orientation);
        host.mass = mass;
        host.inertia = (inertia + inertia.transpose()) * S::from(0.5);
        host.position = centre;
        host.velocity += turn * host.angular_velocity.cross(&arm);
        let copy = host.clone();
        for &i in cluster.members.iter().filter(|&&i| i != cluster.host) {
            let body = &mut model.bodies[i];
            *body = crate::model::RigidBody {
                name: std::mem::take(&mut body.name),
                mass: S::zero(),
                inertia: Mat3::zeros(),
                mobility: Mobility::fixed(),
                role: body.role,
                ..copy.clone()
            };
        }
    }
    // By joint: the pose of its body A on the host.
    let written: Vec<Option<Pose<S>>> = (model.joints.iter())
        .map(|joint| on_host[joint.body_a])
        .collect();
    for (j, joint) in model.joints.iter_mut().enumerate() {
        match welds.contains(&j) {
            true => leave_without_rows(joint, &on_host),
            false => move_joint(joint, &on_host),
        }
    }
    for load in &mut model.loads {
        move_load(&mut load.kind, &on_host);
    }
    let event = scene.until.as_mut().map(|until| &mut until.measure);
    for function in scene.functions.iter_mut().chain(event) {
        for wrench in function.reactions_mut() {
            if let (Axes::Body, Some(pose)) = (wrench.axes, &written[wrench.joint]) {
                wrench.direction = pose.turn * wrench.direction;
            }
        }
        for instant in function.instants_mut() {
            turn_direction(instant, &on_host);
        }
        function.for_each_place(&mut |body, point| {
            if let Some(pose) = &on_host[*body] {
                *body = pose.host;
                if let Some(point) = point {
                    *point = pose.point(point);
                }
            }
        });
    }
}

/// Turns a direction in the axes of a body to those of its host.
fn turn_direction<S: Scalar>(instant: &mut Instant<S>, on_host: &[Option<Pose<S>>]) {
    let (body, direction) = match instant {
        Instant::Felt {
            body, direction, ..
        } => (*body, direction),
        Instant::Seen(Seen {
            from: Some(body),
            direction,
            ..
        }) => (*body, direction),
        _ => return,
    };
    if let Some(pose) = &on_host[body] {
        *direction = pose.turn * *direction;
    }
}

/// Turns a weld into a joint between a merged body and ground, without rows.
fn leave_without_rows<S: Scalar>(joint: &mut Joint<S>, on_host: &[Option<Pose<S>>]) {
    let carried = |body: &usize| on_host[*body].is_some_and(|pose| pose.host != *body);
    let ends = [Some(joint.body_a), joint.body_b];
    // At least one of two welded bodies is not the host.
    joint.body_a = (ends.into_iter().flatten().find(carried)).unwrap_or(joint.body_a);
    joint.body_b = None;
    joint.frame_a = JointFrame::zero();
    joint.frame_b = JointFrame::zero();
    joint.redundant.clear();
    joint.trivial_rows = joint.all_rows().collect();
}

fn move_joint<S: Scalar>(joint: &mut Joint<S>, on_host: &[Option<Pose<S>>]) {
    let frame = |body: &mut usize, frame: &mut JointFrame<S>| {
        if let Some(pose) = &on_host[*body] {
            *body = pose.host;
            frame.point = pose.point(&frame.point);
            frame.axes = frame.axes.map(|axis| pose.turn * axis);
        }
    };
    frame(&mut joint.body_a, &mut joint.frame_a);
    if let Some(body) = &mut joint.body_b {
        frame(body, &mut joint.frame_b);
    }
}

fn move_load<S: Scalar>(kind: &mut LoadKind<S>, on_host: &[Option<Pose<S>>]) {
    let turned = |body: usize, direction: &mut Vec3<S>, axes: &Axes| {
        if let (Some(pose), Axes::Body) = (&on_host[body], axes) {
            *direction = pose.turn * *direction;
        }
    };
    let moved = |body: &mut usize, point: &mut Vec3<S>| {
        if let Some(pose) = &on_host[*body] {
            *body = pose.host;
            *point = pose.point(point);
        }
    };
    match kind {
        LoadKind::Force {
            body,
            point,
            direction,
            axes,
            ..
        } => {
            turned(*body, direction, axes);
            moved(body, point);
        }
        LoadKind::Torque {
            body,
            direction,
            axes,
            ..
        } => {
            turned(*body, direction, axes);
            moved(body, &mut Vec3::zeros());
        }
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
            moved(body_a, point_a);
            if let Some(body) = body_b {
                moved(body, point_b);
            }
        }
        LoadKind::Drag {
            body, point, plate, ..
        } => {
            if let (Some(pose), Some(own)) = (&on_host[*body], plate) {
                own.normal = pose.turn * own.normal;
            }
            moved(body, point);
        }
        LoadKind::Contact(own) => {
            if let (Some(pose), Some(own)) = (&on_host[own.body_a], own.shape.direction_mut()) {
                *own = pose.turn * *own;
            }
            moved(&mut own.body_a, &mut own.point_a);
            if let Some(body) = &mut own.body_b {
                if let Some(pose) = &on_host[*body] {
                    own.surface.turn(|direction| pose.turn * direction);
                }
                moved(body, &mut own.point_b);
            }
        }
        LoadKind::TorsionSpring { .. }
        | LoadKind::Damping { .. }
        | LoadKind::BallDamping { .. }
        | LoadKind::Bushing { .. }
        | LoadKind::Friction { .. }
        | LoadKind::JointStop { .. } => {}
        // It acts on a flexible body, and these are not merged; nor are bodies with controllers or cables.
        LoadKind::Distributed(_) | LoadKind::Controller(_) | LoadKind::Cable(_) => {}
    }
}

/// The motion of all bodies of `written` from `run`, the motion of the model with merged clusters.
pub(super) fn expand(
    written: &Model<f64>,
    clusters: &[Cluster],
    run: &Trajectory<f64>,
) -> Trajectory<f64> {
    let numbering = Numbering::new(written);
    let [mut q, mut v, mut a] = [run.q.clone(), run.v.clone(), run.a.clone()];
    let (nq, nv) = (numbering.positions(), numbering.velocities());
    for cluster in clusters {
        let (_, members) = poses(written, cluster);
        for k in 0..=run.last() {
            let (of_q, of_v) = (
                k * nq + numbering.position(cluster.host),
                k * nv + numbering.velocity(cluster.host),
            );
            let three = |all: &[f64], at: usize| Vec3::from_fn(|i, _| all[at + i]);
            let (centre, p) = (
                three(&q, of_q),
                std::array::from_fn::<f64, 4, _>(|i| q[of_q + 3 + i]),
            );
            let turn = rotation::matrix(&rotation::unit(&p));
            let (velocity, omega) = (three(&v, of_v), three(&v, of_v + 3));
            let (acceleration, alpha) = (three(&a, of_v), three(&a, of_v + 3));
            for (i, pose) in &members {
                let s = &pose.centre;
                let (at_q, at_v) = (
                    k * nq + numbering.position(*i),
                    k * nv + numbering.velocity(*i),
                );
                let swing = omega.cross(s);
                let bend = alpha.cross(s) + omega.cross(&swing);
                let put = |all: &mut [f64], at: usize, x: Vec3<f64>| {
                    all[at..at + 3].copy_from_slice(x.as_slice());
                };
                put(&mut q, at_q, centre + turn * s);
                q[at_q + 3..at_q + 7].copy_from_slice(&rotation::compose(&p, &pose.parameters));
                put(&mut v, at_v, velocity + turn * swing);
                put(&mut v, at_v + 3, pose.turn.tr_mul(&omega));
                put(&mut a, at_v, acceleration + turn * bend);
                put(&mut a, at_v + 3, pose.turn.tr_mul(&alpha));
            }
        }
    }
    run.with_states(numbering, [q, v, a])
}

/// Bodies whose rotation a function of the scene observes.
pub(super) fn watched<S: Scalar>(scene: &Scene<S>) -> Vec<usize> {
    let mut all = Vec::new();
    let mut functions = scene.functions.clone();
    functions.extend(scene.until.as_ref().map(|until| until.measure.clone()));
    for function in &mut functions {
        function.for_each_place(&mut |body, point| {
            if point.is_none() {
                all.push(*body);
            }
        });
    }
    all
}
