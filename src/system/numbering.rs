//! Where each body's states and each joint's multipliers stand; frozen once per scene.

use crate::model::Model;
use std::ops::Range;

/// Offsets of bodies and joints in the state vectors.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Numbering {
    position: Vec<usize>,
    velocity: Vec<usize>,
    constraint: Vec<usize>,
}

impl Numbering {
    /// Numbers the bodies and joints of `model` in its order.
    pub fn new<S>(model: &Model<S>) -> Self {
        let offsets = |sizes: &mut dyn Iterator<Item = usize>| {
            let mut all = vec![0];
            for size in sizes {
                all.push(all[all.len() - 1] + size);
            }
            all
        };
        Self {
            position: offsets(&mut model.bodies.iter().map(|_| 7)),
            velocity: offsets(&mut model.bodies.iter().map(|_| 6)),
            constraint: offsets(&mut model.joints.iter().map(|joint| joint.rows().count())),
        }
    }

    /// Number of bodies.
    pub fn bodies(&self) -> usize {
        self.position.len() - 1
    }

    /// Number of joints.
    pub fn joints(&self) -> usize {
        self.constraint.len() - 1
    }

    /// Length of q: seven a rigid body (r, p).
    pub fn positions(&self) -> usize {
        self.position[self.bodies()]
    }

    /// Length of v: six a rigid body (ṙ, ω).
    pub fn velocities(&self) -> usize {
        self.velocity[self.bodies()]
    }

    /// Number of constraint rows.
    pub fn constraints(&self) -> usize {
        self.constraint[self.joints()]
    }

    /// Start of a body's positions in q.
    pub fn position(&self, body: usize) -> usize {
        self.position[body]
    }

    /// Start of a body's velocities in v.
    pub fn velocity(&self, body: usize) -> usize {
        self.velocity[body]
    }

    /// The body that a component of v belongs to.
    pub fn body_of_velocity(&self, component: usize) -> usize {
        self.velocity.partition_point(|&start| start <= component) - 1
    }

    /// A joint's rows among the constraints.
    pub fn rows(&self, joint: usize) -> Range<usize> {
        self.constraint[joint]..self.constraint[joint + 1]
    }

    /// The joint that a constraint row belongs to.
    pub fn joint_of_row(&self, row: usize) -> usize {
        self.constraint.partition_point(|&start| start <= row) - 1
    }
}
