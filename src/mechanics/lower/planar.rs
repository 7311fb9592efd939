//! Planar scenes: three unknowns per body, and no rows across the plane.
//!
//! Let n be the normal. A scene is planar if
//! - every axis that a joint's rows use is along or across n, and the points of a joint have one
//!   height;
//! - n is a principal axis of every inertia;
//! - gravity, forces and velocities lie in the plane, torques and angular velocities are along n;
//! - forces on bodies that no joint holds upright act at the height of the centre of mass;
//! - shapes of flexible bodies lie in the plane, and so do their centres.
//!
//! Rows of a joint by the axes that they use, along n \[N\] or across it (P):
//!
//! ```text
//! Coincident k         left out for the k of the largest |n_k|: d · n = 0 identically. So the multipliers give
//!                      a force but for a part along n (see `reactions::turn_into_plane`)
//! Perpendicular N P    left out
//! Perpendicular P P    kept
//! Sliding N            left out
//! Sliding P            kept
//! ```

use super::Kept;
use super::examine::{Designs, Verdict, ViolatedCondition};
use super::fixed::is_void;
use super::normal::{candidates, clean};
use super::{out_of_plane, reactions};
use crate::functions::Scene;
use crate::math::scalar::lift3;
use crate::math::{Mat3, Scalar, Vec3, rotation};
use crate::model::{ConstraintRow, Joint, JointFrame, JointKind};
use crate::model::{LoadKind, Mobility, Model, RigidBody};
use crate::system::redundancy;
use ConstraintRow::{Aligned, Coincident, Distance, Perpendicular, Sliding};

/// A plane, and the heights of the parts of a scene in it.
#[derive(Clone, Debug)]
pub struct Plane {
    /// Unit normal, ground axes.
    pub normal: Vec3<f64>,
    /// Two orthonormal directions in the plane.
    along: [Vec3<f64>; 2],
    /// By body: the normal in its axes, and the height of its centre of mass \[m\].
    pub(super) bodies: Vec<(Vec3<f64>, f64)>,
    pub(super) joints: Vec<Joined>,
    /// By load: heights of its points above the centres of mass (on ground: above the origin)
    /// \[m\].
    pub(super) loads: Vec<[f64; 2]>,
    /// By body: group that rotates out of the plane as one; `None` if ground holds the body
    /// upright.
    pub(super) groups: Vec<Option<usize>>,
}

/// A joint in the plane.
#[derive(Clone, Debug)]
pub(super) struct Joined {
    /// Trivially satisfied rows.
    pub trivial_rows: Vec<ConstraintRow>,
    /// Redundant rows.
    redundant: Vec<ConstraintRow>,
    /// Rotation of the frames' axes, if they are turned to the normal.
    turn: Option<Mat3<f64>>,
    /// Heights of its points above the centres of mass (on ground: above the origin) \[m\].
    pub heights: [f64; 2],
}

/// The normal in the axes of the bodies and of ground.
pub(super) struct Turned<S> {
    pub normals: Vec<Vec3<S>>,
    pub ground: Vec3<S>,
}

impl<S: Scalar> Turned<S> {
    pub fn new(model: &Model<S>, normal: &Vec3<f64>) -> Self {
        let ground: Vec3<S> = lift3(normal);
        let bodies = model.bodies.iter();
        Self {
            normals: bodies
                .map(|body| rotation::matrix(&body.orientation).tr_mul(&ground))
                .collect(),
            ground,
        }
    }

    pub fn normal(&self, body: Option<usize>) -> &Vec3<S> {
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

/// Axes that the rows of a joint use: [side][axis], sides A and B.
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
            Aligned { a, b } => {
                for side in &mut used {
                    (side[a], side[b]) = (true, true);
                }
            }
        }
    }
    used
}

impl Plane {
    /// The normal as text for messages.
    pub fn name(&self) -> String {
        vector(&self.normal)
    }

    /// Finds the plane in which all `designs` move.
    ///
    /// # Errors
    /// The violated conditions of the likeliest plane.
    pub(super) fn find(designs: &Designs) -> Result<Self, Kept> {
        let mut first = None;
        for normal in candidates(&designs.start.model) {
            let plane = Self::across(&designs.start.model, normal);
            let verdict = designs.ask(
                |scene| plane.admits(scene, 0.0),
                |scene, change| plane.admits(scene, change),
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

    /// The plane in which `model` moves.
    ///
    /// # Errors
    /// The violated conditions of the likeliest plane.
    pub fn of(model: &Model<f64>) -> Result<Self, Kept> {
        let scene = Scene {
            model: model.clone(),
            duration: 1.0,
            until: None,
            functions: Vec::new(),
            unstarted: None,
        };
        Self::find(&Designs::single(scene))
    }

    /// Examines the conditions on the model, and those on the functions.
    fn admits<S: Scalar>(&self, scene: &Scene<S>, change: f64) -> Verdict {
        self.holds(&scene.model, change)?;
        reactions::in_plane(scene, &self.normal, change)
    }

    /// The plane with this normal, and the heights of the parts of `model`.
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

    /// The plane, with the redundant rows of the reduced model.
    fn without_redundancy(mut self, model: &Model<f64>) -> Self {
        let mut lowered = model.clone();
        self.apply(&mut lowered);
        redundancy::leave_out(&mut lowered);
        for (own, joint) in self.joints.iter_mut().zip(lowered.joints) {
            own.redundant = joint.redundant;
        }
        self
    }

    /// Trivially satisfied rows of joint j; `None` if the joint does not fit the plane.
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
            Perpendicular { a, b } | Aligned { a, b } => across(0, a) != across(1, b),
            Sliding { a } => across(0, a),
            Distance => false,
        };
        let left_out = |row: &ConstraintRow| trivial_rows(row) || joint.trivial_rows.contains(row);
        joint.all_rows().filter(left_out).collect()
    }

    pub(super) fn frames<S: Scalar>(&self, joint: &Joint<S>, j: usize) -> [JointFrame<S>; 2] {
        let frames = [joint.frame_a, joint.frame_b];
        match self.joints[j].turn {
            Some(turn) => frames.map(|frame| turned(&frame, &turn)),
            None => frames,
        }
    }

    /// Reduces a model that satisfies the conditions of this plane.
    pub fn apply<S: Scalar>(&self, model: &mut Model<S>) {
        let carries: Vec<bool> = (0..model.bodies.len())
            .map(|i| model.is_carrier(i))
            .collect();
        let moving = |(body, _): &(&mut RigidBody<S>, _)| body.mobility != Mobility::fixed();
        let bodies = model
            .bodies
            .iter_mut()
            .zip(self.bodies.iter().zip(&carries));
        for (body, ((normal, _), carries)) in bodies.filter(moving) {
            if !carries {
                body.mobility = Mobility::planar(self.along, *normal);
            }
        }
        for (j, own) in self.joints.iter().enumerate() {
            let joint = &mut model.joints[j];
            [joint.frame_a, joint.frame_b] = self.frames(joint, j);
            joint.trivial_rows.clone_from(&own.trivial_rows);
            joint.redundant.clone_from(&own.redundant);
        }
    }
}

/// Rotation that turns the axes of a joint's frames along or across the normal; `None` if they
/// already are, or may not be turned. A joint with e3 in the plane may be turned about e3, a weld
/// about any axis.
fn turn_to(joint: &Joint<f64>, normal: &Vec3<f64>) -> Option<Mat3<f64>> {
    const ALIGNED: f64 = 4.0 * f64::EPSILON;
    let [e1, e2, e3] = &joint.frame_a.axes;
    let n = Vec3::new(normal.dot(e1), normal.dot(e2), normal.dot(e3));
    let aligned = n.iter().filter(|x| x.abs() <= ALIGNED).count() == 2;
    if aligned || is_void(joint) || used(joint) == [[false; 3]; 2] {
        return None;
    }
    let third = match joint.kind {
        JointKind::Weld | JointKind::Attachment => {
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

/// Points of a load, each with its body.
pub(super) fn points<S: Scalar>(kind: &LoadKind<S>) -> [Option<(Option<usize>, Vec3<S>)>; 2] {
    match kind {
        LoadKind::Force { body, point, .. } | LoadKind::Drag { body, point, .. } => {
            [Some((Some(*body), *point)), None]
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
        } => [Some((Some(*body_a), *point_a)), Some((*body_b, *point_b))],
        LoadKind::Contact(own) => [
            Some((Some(own.body_a), own.point_a)),
            Some((own.body_b, own.point_b)),
        ],
        LoadKind::Torque { .. }
        | LoadKind::TorsionSpring { .. }
        | LoadKind::Damping { .. }
        | LoadKind::BallDamping { .. }
        | LoadKind::Bushing { .. }
        | LoadKind::Friction { .. }
        | LoadKind::JointStop { .. }
        | LoadKind::Controller(_)
        | LoadKind::Cable(_)
        | LoadKind::Distributed(_) => [None, None],
    }
}

/// A vector as text for messages.
fn vector(v: &Vec3<f64>) -> String {
    // Adding zero removes the sign of −0.
    let [x, y, z] = [v.x + 0.0, v.y + 0.0, v.z + 0.0];
    format!("({x:.6}, {y:.6}, {z:.6})")
}
