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

use super::Kept;
use super::examine::{Designs, ViolatedCondition};
use super::fixed::is_void;
use super::normal::{candidates, clean};
use super::out_of_plane;
use crate::math::scalar::lift3;
use crate::math::{Mat3, Scalar, Vec3, rotation};
use crate::model::{ConstraintRow, Joint, JointFrame, JointKind};
use crate::model::{LoadKind, Mobility, Model, RigidBody};
use crate::system::redundancy;
use ConstraintRow::{Coincident, Distance, Perpendicular, Sliding};

/// A plane, and where the parts of a scene stand in it.
#[derive(Clone, Debug)]
pub(crate) struct Plane {
    /// Its unit normal, ground axes.
    pub normal: Vec3<f64>,
    /// Two orthonormal directions in it.
    along: [Vec3<f64>; 2],
    /// The normal in the axes of each body, and the height of its centre of mass.
    pub(super) bodies: Vec<(Vec3<f64>, f64)>,
    pub(super) joints: Vec<Joined>,
    /// Heights of the points of each load above the centres of mass (above the origin on ground).
    pub(super) loads: Vec<[f64; 2]>,
    /// Bodies that tilt as one; `None` if they do not.
    pub(super) groups: Vec<Option<usize>>,
}

/// A joint in the plane.
#[derive(Clone, Debug)]
pub(super) struct Joined {
    /// Rows that hold identically.
    pub trivial_rows: Vec<ConstraintRow>,
    /// Rows that follow from others in the plane.
    redundant: Vec<ConstraintRow>,
    /// Axes of the frames by those that are written, if these have to be turned to the normal.
    turn: Option<Mat3<f64>>,
    /// Heights of its points above the centres of mass (above the origin on ground).
    pub heights: [f64; 2],
}

/// The normal in the axes of the bodies and of ground.
pub(super) struct Turned<S> {
    pub normals: Vec<Vec3<S>>,
    pub ground: Vec3<S>,
}

impl<S: Scalar> Turned<S> {
    pub(crate) fn new(model: &Model<S>, normal: &Vec3<f64>) -> Self {
        let ground: Vec3<S> = lift3(normal);
        let bodies = model.bodies.iter();
        Self {
            normals: bodies
                .map(|body| rotation::matrix(&body.orientation).tr_mul(&ground))
                .collect(),
            ground,
        }
    }

    pub(crate) fn normal(&self, body: Option<usize>) -> &Vec3<S> {
        body.map_or(&self.ground, |body| &self.normals[body])
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
pub(super) fn used<S>(joint: &Joint<S>) -> [[bool; 3]; 2] {
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
    /// Its normal for messages.
    pub(crate) fn name(&self) -> String {
        vector(&self.normal)
    }

    /// The plane that all `designs` move in.
    ///
    /// # Errors
    /// What leaves it: the plane that most joints turn in, if there is none.
    pub(super) fn find(designs: &Designs) -> Result<Self, Kept> {
        let mut first = None;
        for normal in candidates(&designs.start.model) {
            let plane = Self::across(&designs.start.model, normal);
            let verdict = designs.ask(
                |scene| plane.holds(&scene.model, 0.0),
                |scene, change| plane.holds(&scene.model, change),
            );
            match verdict {
                Ok(()) => return Ok(plane.without_redundancy(&designs.start.model)),
                Err(obstacles) => first = first.or(Some((normal, obstacles))),
            }
        }
        Err(match first {
            Some((normal, obstacles)) => Kept {
                reduction: format!("motion out of the plane across {}", vector(&normal)),
                obstacles,
            },
            None => Kept {
                reduction: "motion out of a plane".into(),
                obstacles: vec![ViolatedCondition::plain(
                    "gravity, lever arms and velocities lie in no common plane",
                )],
            },
        })
    }

    /// The plane that `model` moves in, whatever the design.
    ///
    /// # Errors
    /// What leaves that which most joints turn in.
    #[cfg(test)]
    pub fn of(model: &Model<f64>) -> Result<Self, Kept> {
        let scene = crate::functions::Scene {
            model: model.clone(),
            duration: 1.0,
            until: None,
            functions: Vec::new(),
            unstarted: None,
        };
        Self::find(&Designs::single(scene))
    }

    /// The plane with this normal, and where the parts of `model` stand in it.
    fn across(model: &Model<f64>, normal: Vec3<f64>) -> Self {
        let turned = Turned::new(model, &normal);
        let farthest = normal.iamin();
        let mut first = Vec3::zeros();
        first[farthest] = 1.0;
        let first = clean(first - normal * normal[farthest]);
        let height = |body: Option<usize>, point: &Vec3<f64>| turned.normal(body).dot(point);
        let joints = model.joints.iter().map(|joint| {
            let turn = turn_to(joint, turned.normal(Some(joint.body_a)));
            Joined {
                trivial_rows: Vec::new(),
                redundant: Vec::new(),
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
            plane.joints[j].trivial_rows = plane.trivial_rows(joint, &turned, j);
        }
        let upright = |j: usize| out_of_plane::holds_upright(&plane.joints[j].trivial_rows);
        plane.groups = out_of_plane::groups(model.bodies.len(), &model.joints, upright);
        plane
    }

    /// The plane with those rows left out that follow from others in it.
    fn without_redundancy(mut self, model: &Model<f64>) -> Self {
        let mut lowered = model.clone();
        self.apply(&mut lowered);
        redundancy::leave_out(&mut lowered);
        for (own, joint) in self.joints.iter_mut().zip(lowered.joints) {
            own.redundant = joint.redundant;
        }
        self
    }

    /// Rows of joint j that hold identically, if the joint fits the plane.
    pub(super) fn trivial_rows<S: Scalar>(
        &self,
        joint: &Joint<S>,
        turned: &Turned<S>,
        j: usize,
    ) -> Vec<ConstraintRow> {
        if is_void(joint) {
            return joint.trivial_rows.clone();
        }
        let frames = self.frames(joint, j);
        let bodies = [Some(joint.body_a), joint.body_b];
        let across = |side: usize, axis: usize| {
            let normal = turned.normal(bodies[side]);
            normal.dot(&frames[side].axes[axis]).re().abs() > 0.5
        };
        let largest = Coincident(self.normal.iamax());
        let trivial_rows = |row: &ConstraintRow| match *row {
            Coincident(_) => *row == largest,
            Perpendicular { a, b } => across(0, a) != across(1, b),
            Sliding { a } => across(0, a),
            Distance => false,
        };
        joint.all_rows().filter(trivial_rows).collect()
    }

    pub(super) fn frames<S: Scalar>(&self, joint: &Joint<S>, j: usize) -> [JointFrame<S>; 2] {
        let frames = [joint.frame_a, joint.frame_b];
        match self.joints[j].turn {
            Some(turn) => frames.map(|frame| turned(&frame, &turn)),
            None => frames,
        }
    }

    /// Leaves out of a model that the plane holds for what is across it.
    pub(crate) fn apply<S: Scalar>(&self, model: &mut Model<S>) {
        let moving = |(body, _): &(&mut RigidBody<S>, _)| body.mobility != Mobility::fixed();
        let bodies = model.bodies.iter_mut().zip(&self.bodies);
        for (body, (normal, _)) in bodies.filter(moving) {
            body.mobility = Mobility::planar(self.along, *normal);
        }
        for (j, own) in self.joints.iter().enumerate() {
            let joint = &mut model.joints[j];
            [joint.frame_a, joint.frame_b] = self.frames(joint, j);
            joint.trivial_rows.clone_from(&own.trivial_rows);
            joint.redundant.clone_from(&own.redundant);
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
    if aligned || is_void(joint) || used(joint) == [[false; 3]; 2] {
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

/// Points of a load on its bodies.
pub(super) fn points<S: Scalar>(kind: &LoadKind<S>) -> [Option<(Option<usize>, Vec3<S>)>; 2] {
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

/// A vector for messages.
fn vector(v: &Vec3<f64>) -> String {
    // Zero has no sign.
    let [x, y, z] = [v.x + 0.0, v.y + 0.0, v.z + 0.0];
    format!("({x:.6}, {y:.6}, {z:.6})")
}
