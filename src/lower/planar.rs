//! Scenes that move in a plane: three unknowns a body, and no rows across the plane.
//!
//! With n the normal, a scene is planar if every axis that a joint's rows use is along or across n,
//! the points that a joint brings together are equally high above the plane, n is a principal axis
//! of every inertia, gravity, forces and velocities lie in the plane and torques and angular
//! velocities are along n, and if nothing tilts: bodies that no joint holds upright have the points
//! where forces act as high as their centres of mass.
//!
//! The rows of a joint, by whether the axes they use are along n (N) or across it (P):
//!
//! ```text
//! Coincident k         left out for the k of the largest |n_k|: d · n = 0 identically
//! Perpendicular N P    left out
//! Perpendicular P P    kept
//! Sliding N            left out
//! Sliding P            kept
//! ```

use super::examine::{Examiner, Obstacle};
use super::normal::{candidate, clean};
use super::tilt;
use crate::math::scalar::lift3;
use crate::math::{Mat3, Scalar, Vec3, rotation};
use crate::model::{Axes, ConstraintRow, Freedom, Joint, JointFrame, JointKind, LoadKind};
use crate::model::{Mobility, Model};
use crate::system::assembly::length_scale;
use crate::system::reduce::along;
use crate::system::redundancy;
use ConstraintRow::{Coincident, Distance, Perpendicular, Sliding};

/// A plane, and where the parts of a scene stand in it.
#[derive(Clone, Debug)]
pub struct Plane {
    /// Its unit normal, ground axes.
    pub normal: Vec3<f64>,
    /// Two orthonormal directions in it.
    along: [Vec3<f64>; 2],
    /// The normal in the axes of each body, and the height of its centre of mass.
    bodies: Vec<(Vec3<f64>, f64)>,
    joints: Vec<Joined>,
    /// Heights of the points of each load above the centres of mass (above the origin on ground).
    loads: Vec<[f64; 2]>,
    /// Bodies that tilt as one; `None` if they do not.
    groups: Vec<Option<usize>>,
}

/// A joint in the plane.
#[derive(Clone, Debug)]
struct Joined {
    /// Rows that hold identically.
    identical: Vec<ConstraintRow>,
    /// Rows that follow from others in the plane.
    left_out: Vec<ConstraintRow>,
    /// Axes of the frames by those that are written, if these have to be turned to the normal.
    turn: Option<Mat3<f64>>,
    /// Heights of its points above the centres of mass (above the origin on ground).
    heights: [f64; 2],
}

/// The normal in the axes of the bodies and of ground.
struct Turned<S> {
    normals: Vec<Vec3<S>>,
    ground: Vec3<S>,
}

impl<S: Scalar> Turned<S> {
    fn new(model: &Model<S>, normal: &Vec3<f64>) -> Self {
        let ground: Vec3<S> = lift3(normal);
        let bodies = model.bodies.iter();
        Self {
            normals: bodies
                .map(|body| rotation::matrix(&body.orientation).tr_mul(&ground))
                .collect(),
            ground,
        }
    }

    fn normal(&self, body: Option<usize>) -> &Vec3<S> {
        body.map_or(&self.ground, |body| &self.normals[body])
    }
}

/// Points of a load on its bodies.
fn points<S: Scalar>(kind: &LoadKind<S>) -> [Option<(Option<usize>, Vec3<S>)>; 2] {
    match kind {
        LoadKind::Force { body, point, .. } => [Some((Some(*body), *point)), None],
        LoadKind::Spring {
            body_a,
            body_b,
            point_a,
            point_b,
            ..
        } => [Some((Some(*body_a), *point_a)), Some((*body_b, *point_b))],
        LoadKind::Torque { .. }
        | LoadKind::TorsionSpring { .. }
        | LoadKind::Damping { .. }
        | LoadKind::BallDamping { .. }
        | LoadKind::Friction { .. } => [None, None],
    }
}

/// The frame with axes e'_i = Σ_j c_ij e_j.
fn turned<S: Scalar>(frame: &JointFrame<S>, c: &Mat3<f64>) -> JointFrame<S> {
    let [e1, e2, e3] = frame.axes;
    let part = |i: usize, j: usize| S::from(c[(i, j)]);
    JointFrame {
        axes: std::array::from_fn(|i| e1 * part(i, 0) + e2 * part(i, 1) + e3 * part(i, 2)),
        ..*frame
    }
}

/// Axes that the rows of a joint use, on side A and on side B.
fn used<S>(joint: &Joint<S>) -> [[bool; 3]; 2] {
    let mut used = [[false; 3]; 2];
    for row in joint.all_rows() {
        match row {
            Coincident(_) | Distance => {}
            Perpendicular { a, b } => {
                used[0][a] = true;
                used[1][b] = true;
            }
            Sliding { a } => used[0][a] = true,
        }
    }
    used
}

impl Plane {
    /// The plane that `model` moves in.
    ///
    /// # Errors
    /// What leaves it.
    pub fn find(model: &Model<f64>) -> Result<Self, Obstacle> {
        let normal = candidate(model).ok_or_else(|| Obstacle {
            what: "gravity, lever arms and velocities lie in no common plane".into(),
            size: 0.0,
            unit: "",
            variable: None,
            elsewhere: false,
        })?;
        let turned = Turned::new(model, &normal);
        let farthest = normal.iamin();
        let mut first = Vec3::zeros();
        first[farthest] = 1.0;
        let first = clean(first - normal * normal[farthest]);
        let height = |body: Option<usize>, point: &Vec3<f64>| turned.normal(body).dot(point);
        let joints = model.joints.iter().map(|joint| {
            let turn = turn_to(joint, turned.normal(Some(joint.body_a)));
            Joined {
                identical: Vec::new(),
                left_out: Vec::new(),
                turn,
                heights: [
                    height(Some(joint.body_a), &joint.frame_a.point),
                    height(joint.body_b, &joint.frame_b.point),
                ],
            }
        });
        let loads = model.loads.iter().map(|load| {
            points(&load.kind).map(|at| at.map_or(0.0, |(body, point)| height(body, &point)))
        });
        let mut plane = Self {
            normal,
            along: [first, clean(normal.cross(&first))],
            bodies: (model.bodies.iter().zip(&turned.normals))
                .map(|(body, own)| (clean(*own), normal.dot(&body.position)))
                .collect(),
            joints: joints.collect(),
            loads: loads.collect(),
            groups: Vec::new(),
        };
        for (j, joint) in model.joints.iter().enumerate() {
            plane.joints[j].identical = plane.identical(joint, &turned, j);
        }
        let upright = |j: usize| tilt::holds_upright(&plane.joints[j].identical);
        plane.groups = tilt::groups(model.bodies.len(), &model.joints, upright);
        plane.holds(model, 0.0)?;
        let mut lowered = model.clone();
        plane.apply(&mut lowered);
        redundancy::leave_out(&mut lowered);
        for (own, joint) in plane.joints.iter_mut().zip(lowered.joints) {
            own.left_out = joint.left_out;
        }
        Ok(plane)
    }

    /// Rows of joint j that hold identically, if the joint fits the plane.
    fn identical<S: Scalar>(
        &self,
        joint: &Joint<S>,
        turned: &Turned<S>,
        j: usize,
    ) -> Vec<ConstraintRow> {
        let frames = self.frames(joint, j);
        let bodies = [Some(joint.body_a), joint.body_b];
        let across = |side: usize, axis: usize| {
            let normal = turned.normal(bodies[side]);
            normal.dot(&frames[side].axes[axis]).re().abs() > 0.5
        };
        let largest = Coincident(self.normal.iamax());
        let identical = |row: &ConstraintRow| match *row {
            Coincident(_) => *row == largest,
            Perpendicular { a, b } => across(0, a) != across(1, b),
            Sliding { a } => across(0, a),
            Distance => false,
        };
        joint.all_rows().filter(identical).collect()
    }

    fn frames<S: Scalar>(&self, joint: &Joint<S>, j: usize) -> [JointFrame<S>; 2] {
        let frames = [joint.frame_a, joint.frame_b];
        match self.joints[j].turn {
            Some(turn) => frames.map(|frame| turned(&frame, &turn)),
            None => frames,
        }
    }

    /// Leaves out of a model that the plane holds for what is across it.
    pub fn apply<S: Scalar>(&self, model: &mut Model<S>) {
        for (body, (normal, _)) in model.bodies.iter_mut().zip(&self.bodies) {
            body.mobility = Mobility::Planar {
                along: self.along,
                normal: *normal,
            };
        }
        for (j, own) in self.joints.iter().enumerate() {
            let joint = &mut model.joints[j];
            [joint.frame_a, joint.frame_b] = self.frames(joint, j);
            joint.identical.clone_from(&own.identical);
            joint.left_out.clone_from(&own.left_out);
        }
    }

    /// Examines whether `model` moves in this plane, and by how much its derivative leaves it for a
    /// `change` of the variable.
    ///
    /// # Errors
    /// What leaves it first.
    pub fn holds<S: Scalar>(&self, model: &Model<S>, change: f64) -> Result<(), Obstacle> {
        let turned = Turned::new(model, &self.normal);
        let mut examiner = Examiner::new(change);
        let length = length_scale(model);
        self.joints(model, &turned, length, &mut examiner);
        self.bodies(model, &turned, length, &mut examiner);
        self.loads(model, &turned, length, &mut examiner);
        self.upright(model, length, &mut examiner);
        examiner.found
    }

    fn bodies<S: Scalar>(
        &self,
        model: &Model<S>,
        turned: &Turned<S>,
        length: f64,
        examiner: &mut Examiner,
    ) {
        let gravity = largest(&model.gravity);
        examiner.zero(along(&model.gravity, &self.normal), gravity, || {
            ("gravity leaves the plane".into(), "m/s²")
        });
        let speed = model.bodies.iter().map(|body| largest(&body.velocity));
        let spin = model
            .bodies
            .iter()
            .map(|body| largest(&body.angular_velocity));
        let (speed, spin) = (speed.fold(0.0, f64::max), spin.fold(0.0, f64::max));
        for (i, body) in model.bodies.iter().enumerate() {
            let (normal, height) = &self.bodies[i];
            let own: Vec3<S> = lift3(normal);
            let name = &body.name;
            for x in (turned.normals[i] - own).iter() {
                let what = || (format!("body \"{name}\" is turned out of the plane"), "rad");
                examiner.zero(*x, 1.0, what);
            }
            let above = along(&body.position, &self.normal) - *height;
            let what = || (format!("body \"{name}\" is moved across the plane"), "m");
            examiner.zero(above, length, what);
            let scale = body
                .inertia
                .iter()
                .fold(0.0_f64, |m, x| m.max(x.re().abs()));
            for (about, inertia) in [
                (body.inertia * own, body.inertia),
                (body.inertia.tr_mul(&own), body.inertia.transpose()),
            ] {
                let off = about - own * own.dot(&(inertia * own));
                for x in off.iter() {
                    let what = || {
                        let what = "the normal is off the principal axes of inertia of body";
                        (format!("{what} \"{name}\""), "kg m²")
                    };
                    examiner.zero(*x, scale, what);
                }
            }
            let what = || {
                (
                    format!("the velocity of body \"{name}\" leaves the plane"),
                    "m/s",
                )
            };
            examiner.zero(along(&body.velocity, &self.normal), speed, what);
            let omega = &body.angular_velocity;
            for x in (omega - own * own.dot(omega)).iter() {
                let what = || {
                    let what = "is off the normal";
                    (
                        format!("the angular velocity of body \"{name}\" {what}"),
                        "rad/s",
                    )
                };
                examiner.zero(*x, spin, what);
            }
        }
    }

    fn joints<S: Scalar>(
        &self,
        model: &Model<S>,
        turned: &Turned<S>,
        length: f64,
        examiner: &mut Examiner,
    ) {
        for (j, joint) in model.joints.iter().enumerate() {
            let own = &self.joints[j];
            let name = &joint.name;
            let frames = self.frames(joint, j);
            let bodies = [Some(joint.body_a), joint.body_b];
            for (side, used) in used(joint).into_iter().enumerate() {
                let normal = turned.normal(bodies[side]);
                for axis in (0..3).filter(|&axis| used[axis]) {
                    let e = &frames[side].axes[axis];
                    let part = normal.dot(e);
                    if part.re().abs() > 0.5 {
                        for x in (e - normal * part).iter() {
                            let what = || {
                                (
                                    format!("the axis of joint \"{name}\" is off the normal"),
                                    "rad",
                                )
                            };
                            examiner.zero(*x, 1.0, what);
                        }
                    } else {
                        let what = || {
                            (
                                format!("the axis of joint \"{name}\" leaves the plane"),
                                "rad",
                            )
                        };
                        examiner.zero(part, 1.0, what);
                    }
                }
            }
            for drive in &joint.drives {
                let normal = turned.normal(Some(joint.body_a));
                let e = &frames[0].axes[2];
                let part = normal.dot(e);
                let what = || (format!("joint \"{name}\" is driven out of the plane"), "");
                match drive.freedom {
                    Freedom::Turn => {
                        for x in (e - normal * part).iter() {
                            examiner.zero(*x, 1.0, what);
                        }
                    }
                    Freedom::Slide => examiner.zero(part, 1.0, what),
                }
            }
            if self.identical(joint, turned, j) != own.identical {
                let what = || (format!("joint \"{name}\" is turned"), "");
                examiner.zero(S::one(), 0.0, what);
            }
            let mut heights = [S::zero(); 2];
            for (side, frame) in frames.iter().enumerate() {
                let above = turned.normal(bodies[side]).dot(&frame.point);
                let what = || {
                    (
                        format!("a point of joint \"{name}\" is moved across the plane"),
                        "m",
                    )
                };
                examiner.zero(above - own.heights[side], length, what);
                let centre = bodies[side].map_or(0.0, |body| self.bodies[body].1);
                heights[side] = above + centre;
            }
            let what = || {
                let what = "are not equally high above the plane";
                (format!("the points of joint \"{name}\" {what}"), "m")
            };
            examiner.zero(heights[0] - heights[1], length, what);
        }
    }

    fn loads<S: Scalar>(
        &self,
        model: &Model<S>,
        turned: &Turned<S>,
        length: f64,
        examiner: &mut Examiner,
    ) {
        for (load, heights) in model.loads.iter().zip(&self.loads) {
            let name = &load.name;
            let mut ends = [None; 2];
            for (k, at) in points(&load.kind).into_iter().enumerate() {
                let Some((body, point)) = at else { continue };
                let above = turned.normal(body).dot(&point);
                let what = || {
                    (
                        format!("a point of load \"{name}\" is moved across the plane"),
                        "m",
                    )
                };
                examiner.zero(above - heights[k], length, what);
                ends[k] = Some(above + body.map_or(0.0, |body| self.bodies[body].1));
            }
            let what = || (format!("load \"{name}\" leaves the plane"), "");
            if let [Some(a), Some(b)] = ends {
                examiner.zero(a - b, length, what);
            }
            let normal = |body: &usize, axes: &Axes| match axes {
                Axes::Ground => turned.ground,
                Axes::Body => turned.normals[*body],
            };
            match &load.kind {
                LoadKind::Force {
                    body,
                    direction,
                    axes,
                    ..
                } => {
                    let part = normal(body, axes).dot(direction);
                    examiner.zero(part, largest(direction), what);
                }
                LoadKind::Torque {
                    body,
                    direction,
                    axes,
                    ..
                } => {
                    let n = normal(body, axes);
                    for x in (direction - n * n.dot(direction)).iter() {
                        examiner.zero(*x, largest(direction), what);
                    }
                }
                LoadKind::TorsionSpring { joint, .. }
                | LoadKind::Damping {
                    joint,
                    freedom: Freedom::Turn,
                    ..
                }
                | LoadKind::Friction {
                    joint,
                    freedom: Freedom::Turn,
                    ..
                } => {
                    let joint = &model.joints[*joint];
                    let n = turned.normals[joint.body_a];
                    let e = &joint.frame_a.axes[2];
                    for x in (e - n * n.dot(e)).iter() {
                        examiner.zero(*x, 1.0, what);
                    }
                }
                LoadKind::Spring { .. }
                | LoadKind::BallDamping { .. }
                | LoadKind::Damping {
                    freedom: Freedom::Slide,
                    ..
                }
                | LoadKind::Friction {
                    freedom: Freedom::Slide,
                    ..
                } => {}
            }
        }
    }

    /// Bodies that nothing holds upright have what acts on them from outside their group as high as
    /// their centres of mass.
    fn upright<S: Scalar>(&self, model: &Model<S>, length: f64, examiner: &mut Examiner) {
        let group = |body: Option<usize>| body.and_then(|body| self.groups[body]);
        let mut level = vec![None; model.bodies.len()];
        for (i, body) in model.bodies.iter().enumerate() {
            let Some(own) = self.groups[i] else { continue };
            let height = self.bodies[i].1;
            let first: f64 = *level[own].get_or_insert(height);
            let name = &body.name;
            let what = || {
                (
                    format!("body \"{name}\" tilts: its centre of mass is off the others'"),
                    "m",
                )
            };
            examiner.zero(height - first, length, what);
        }
        let mut acts =
            |body: Option<usize>, height: f64, what: &dyn Fn() -> (String, &'static str)| {
                if let (Some(own), Some(body)) = (group(body), body) {
                    let off = self.bodies[body].1 + height - level[own].unwrap_or(0.0);
                    examiner.zero(off, length, what);
                }
            };
        for (joint, own) in model.joints.iter().zip(&self.joints) {
            let bodies = [Some(joint.body_a), joint.body_b];
            if group(bodies[0]) == group(bodies[1]) {
                continue;
            }
            let name = &joint.name;
            let what = || {
                (
                    format!("joint \"{name}\" tilts a body: it is off its centre of mass"),
                    "m",
                )
            };
            for (body, height) in bodies.into_iter().zip(own.heights) {
                acts(body, height, &what);
            }
        }
        for (load, heights) in model.loads.iter().zip(&self.loads) {
            let name = &load.name;
            let what = || {
                (
                    format!("load \"{name}\" tilts a body: it is off its centre of mass"),
                    "m",
                )
            };
            for (at, height) in points(&load.kind).into_iter().zip(heights) {
                if let Some((body, _)) = at {
                    acts(body, *height, &what);
                }
            }
        }
    }
}

/// Axes of a joint's frames that are along or across the normal, where those that its rows use are
/// not, and may be turned: about e3 if that lies in the plane, anyhow in a weld.
fn turn_to(joint: &Joint<f64>, normal: &Vec3<f64>) -> Option<Mat3<f64>> {
    const ALIGNED: f64 = 4.0 * f64::EPSILON;
    let [e1, e2, e3] = &joint.frame_a.axes;
    let n = Vec3::new(normal.dot(e1), normal.dot(e2), normal.dot(e3));
    let aligned = n.iter().filter(|x| x.abs() <= ALIGNED).count() == 2;
    if aligned || used(joint) == [[false; 3]; 2] {
        return None;
    }
    let third = match joint.kind {
        JointKind::Weld => {
            // Any direction across the normal.
            let mut farthest = Vec3::zeros();
            farthest[n.iamin()] = 1.0;
            n.cross(&farthest).normalize()
        }
        _ if n.z.abs() <= 0.5 => Vec3::z(),
        _ => return None,
    };
    let first = (n - third * n.dot(&third)).normalize();
    let second = third.cross(&first);
    Some(Mat3::from_rows(&[
        first.transpose(),
        second.transpose(),
        third.transpose(),
    ]))
}

fn largest<S: Scalar>(v: &Vec3<S>) -> f64 {
    v.iter().fold(0.0, |m, x| m.max(x.re().abs()))
}
