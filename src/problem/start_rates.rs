//! Initial rates of joints: velocities of the bodies at which the joints have the rates of the
//! file.
//!
//! The blocks of joints are processed from ground outwards (see [`crate::system::blocks`]). Behind a joint
//! in no loop, the velocity field of the far body is that of the near body, plus their relative
//! motion by the velocities of the file, plus the difference between the prescribed rates and the
//! file's:
//!
//! ```text
//! ω + e (φ̇ − φ̇_file),     ẋ + e × (x − P) (φ̇ − φ̇_file) + e (σ̇ − σ̇_file).
//! ```
//!
//! In loops, the velocities relative to the root are those nearest to the file's (in the metric of
//! the mass) that satisfy joints and rates. Bodies behind a loop move with it. Velocities of the
//! file that violate the joints are projected last, all together, with the rates as additional
//! rows.

use super::hinge::{Hinge, hinge};
use super::starts::{Asked, DOFS, Starts, put};
use crate::math::rotation::matrix;
use crate::math::{Scalar, Vec3};
use crate::model::{Model, RigidBody};
use crate::system::blocks::Block;
use crate::system::bodies::velocities_of;
use crate::system::failure::AssemblyFailure;
use crate::system::nearest::nearest;

/// The velocity field of a rigid body.
#[derive(Clone, Copy, Debug)]
struct Twist<S: Scalar> {
    /// Angular velocity, ground axes \[rad/s\].
    omega: Vec3<S>,
    /// Velocity of the field at the origin \[m/s\].
    origin: Vec3<S>,
}

impl<S: Scalar> Twist<S> {
    fn zero() -> Self {
        Self {
            omega: Vec3::zeros(),
            origin: Vec3::zeros(),
        }
    }

    fn of(body: &RigidBody<S>) -> Self {
        let omega = matrix(&body.orientation) * body.angular_velocity;
        Self {
            omega,
            origin: body.velocity - omega.cross(&body.position),
        }
    }

    /// Velocity of the field at a point \[m/s\].
    fn at(&self, point: &Vec3<S>) -> Vec3<S> {
        self.origin + self.omega.cross(point)
    }

    fn plus(&self, other: &Self) -> Self {
        Self {
            omega: self.omega + other.omega,
            origin: self.origin + other.origin,
        }
    }

    fn minus(&self, other: &Self) -> Self {
        Self {
            omega: self.omega - other.omega,
            origin: self.origin - other.origin,
        }
    }

    /// Sets the velocities of a body.
    fn give(&self, body: &mut RigidBody<S>) {
        body.velocity = self.at(&body.position);
        body.angular_velocity = matrix(&body.orientation).tr_mul(&self.omega);
    }
}

/// Sets the velocities of the bodies of `model` that follow from the rates of its joints.
///
/// # Errors
/// The joint that cannot start at its rate.
pub(super) fn set<S: Scalar>(
    starts: &Starts<S>,
    model: &mut Model<S>,
) -> Result<(), AssemblyFailure> {
    let groups = starts.groups(model, Asked::Rate);
    let mut closed = model.clone();
    // Open joints are closed as at the start of a simulation.
    for (bodies, joints) in &groups {
        if !starts.is_consistent(bodies, joints) {
            let mut part = starts.part(&closed, (None, bodies), joints);
            starts.drive(&mut part, joints, Asked::Place, 1.0);
            let q = nearest(&part)?.q;
            put(&mut closed, bodies, &q);
        }
    }
    let mut changes: Vec<Option<Twist<S>>> = vec![None; model.bodies.len()];
    for block in &starts.blocks.list {
        if !groups
            .iter()
            .any(|(_, joints)| joints.contains(&block.joints[0]))
        {
            continue;
        }
        let own = match (&block.joints[..], &block.bodies[..]) {
            (&[joint], &[body]) => vec![lacking(starts, &closed, joint, body, block.root)],
            _ => of_loops(starts, &closed, block)?,
        };
        let root = block.root.and_then(|root| changes[root]);
        for (&body, own) in block.bodies.iter().zip(own) {
            changes[body] = match (root, own) {
                (Some(root), Some(own)) => Some(root.plus(&own)),
                (root, own) => root.or(own),
            };
        }
    }
    for (body, change) in closed.bodies.iter_mut().zip(&changes) {
        if let Some(change) = change {
            Twist::of(body).plus(change).give(body);
        }
    }
    for (bodies, joints) in &groups {
        if !starts.is_consistent(bodies, joints) {
            let mut part = starts.part(&closed, (None, bodies), joints);
            starts.drive(&mut part, joints, Asked::Rate, 1.0);
            let v = nearest(&part)?.v;
            for (&body, v) in bodies.iter().zip(v.chunks(6)) {
                let body = &mut closed.bodies[body];
                (body.velocity, body.angular_velocity) = velocities_of(v);
            }
        }
    }
    for (body, found) in model.bodies.iter_mut().zip(&closed.bodies) {
        body.velocity = found.velocity;
        body.angular_velocity = found.angular_velocity;
    }
    Ok(())
}

/// Difference between the rates of a joint in no loop and those that the file's velocities give.
fn lacking<S: Scalar>(
    starts: &Starts<S>,
    model: &Model<S>,
    joint: usize,
    beyond: usize,
    near: Option<usize>,
) -> Option<Twist<S>> {
    let [spin, speed] = DOFS.map(|dof| starts.value(model, joint, dof, Asked::Rate));
    if spin.is_none() && speed.is_none() {
        return None;
    }
    let Hinge { axis, point, sign } = hinge(model, joint, beyond);
    let near = near.map_or(Twist::zero(), |near| Twist::of(&model.bodies[near]));
    let file = Twist::of(&model.bodies[beyond]).minus(&near);
    let lacks = |rate: Option<S>, file: S| rate.map_or(S::zero(), |rate| rate * sign - file);
    let spin = axis * lacks(spin, axis.dot(&file.omega));
    let slide = axis * lacks(speed, axis.dot(&file.at(&point)));
    Some(Twist {
        omega: spin,
        origin: point.cross(&spin) + slide,
    })
}

/// Changes of the file's velocities by the rates in loops, by body; `None` if no joint has a rate.
fn of_loops<S: Scalar>(
    starts: &Starts<S>,
    model: &Model<S>,
    block: &Block,
) -> Result<Vec<Option<Twist<S>>>, AssemblyFailure> {
    let rate = |&joint: &usize| {
        let mut rates = DOFS.map(|dof| starts.value(model, joint, dof, Asked::Rate));
        rates.iter_mut().any(|rate| rate.is_some())
    };
    if !block.joints.iter().any(rate) {
        return Ok(vec![None; block.bodies.len()]);
    }
    let root = block.root.map(|root| Twist::of(&model.bodies[root]));
    let root = root.unwrap_or(Twist::zero());
    let mut part = starts.part(model, (block.root, &block.bodies), &block.joints);
    starts.check_free(&part, &block.joints, Asked::Rate)?;
    let count = block.bodies.len();
    let file: Vec<Twist<S>> = (part.bodies.iter_mut().take(count))
        .map(|body| {
            let relative = Twist::of(body).minus(&root);
            relative.give(body);
            relative
        })
        .collect();
    starts.drive(&mut part, &block.joints, Asked::Rate, 1.0);
    let v = nearest(&part)?.v;
    for (body, v) in part.bodies.iter_mut().zip(v.chunks(6)) {
        (body.velocity, body.angular_velocity) = velocities_of(v);
    }
    let pairs = part.bodies.iter().zip(&file);
    Ok(pairs
        .map(|(body, file)| Some(Twist::of(body).minus(file)))
        .collect())
}
