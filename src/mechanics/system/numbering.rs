//! Indices of the states of bodies and of the multipliers of joints, and the pairs of bodies that may touch. They are fixed for a scene.
//!
//! Every rigid body has seven positions and six velocities. Its mobility determines its unknowns in
//! linear systems (see [`super::reduce`]).

use super::near::Near;
use crate::math::Scalar;
use crate::model::{Mobility, Model};
use std::ops::Range;
use std::sync::Arc;

/// Number of positions and of velocities of a body.
const POSITIONS: usize = 7;
const VELOCITIES: usize = 6;

/// Offsets of bodies and joints in the state vectors and among the unknowns.
#[derive(Clone, Debug, PartialEq)]
pub struct Numbering {
    mobility: Vec<Mobility>,
    unknown: Vec<usize>,
    constraint: Vec<usize>,
    near: Option<Arc<Near>>,
    /// Rows of B, by velocity; none if v = u.
    rows: Arc<[[(usize, f64); 2]]>,
}

impl Numbering {
    /// Numbers the bodies and joints of `model` in their order.
    pub fn new<S: Scalar>(model: &Model<S>) -> Self {
        let offsets = |sizes: &mut dyn Iterator<Item = usize>| {
            let mut all = vec![0];
            for size in sizes {
                all.push(all[all.len() - 1] + size);
            }
            all
        };
        let mobility: Vec<Mobility> = model.bodies.iter().map(|body| body.mobility).collect();
        let all = Self {
            unknown: offsets(&mut mobility.iter().map(Mobility::unknowns)),
            mobility,
            constraint: offsets(&mut model.joints.iter().map(|joint| joint.rows().count())),
            near: Near::new(model).map(Arc::new),
            rows: Arc::default(),
        };
        let count = match all.is_reduced() {
            true => all.velocities(),
            false => 0,
        };
        let rows = (0..count).map(|place| {
            let (body, k) = (place / 6, place % 6);
            let at = all.unknown(body);
            all.mobility[body].row(k).map(|(own, by)| (at + own, by))
        });
        Self {
            rows: rows.collect(),
            ..all
        }
    }

    /// A row of v = B u, for u that has fewer components: pairs of an index in u and an entry. A zero entry is a filler.
    pub(crate) fn row(&self, place: usize) -> [(usize, f64); 2] {
        self.rows[place]
    }

    /// The contacts between bodies by pairs, if there are many.
    pub(crate) fn near(&self) -> Option<&Near> {
        self.near.as_deref()
    }

    /// Number of bodies.
    pub fn bodies(&self) -> usize {
        self.mobility.len()
    }

    /// Number of joints.
    pub fn joints(&self) -> usize {
        self.constraint.len() - 1
    }

    /// Length n_q of q: seven per rigid body (r, p).
    pub fn positions(&self) -> usize {
        POSITIONS * self.bodies()
    }

    /// Length n_v of v: six per rigid body (ṙ, ω).
    pub fn velocities(&self) -> usize {
        VELOCITIES * self.bodies()
    }

    /// Number n_u of unknowns u in v = B u.
    pub fn unknowns(&self) -> usize {
        self.unknown[self.bodies()]
    }

    /// Whether some body has fewer unknowns than velocities.
    pub fn is_reduced(&self) -> bool {
        self.unknowns() < self.velocities()
    }

    /// Whether some body cannot rotate or move, so that this part of it stays as placed.
    pub fn keeps_placed(&self) -> bool {
        !self.mobility.iter().all(Mobility::has_rotation)
    }

    /// Number n_c of constraint rows.
    pub fn constraints(&self) -> usize {
        self.constraint[self.joints()]
    }

    /// First index of a body's positions in q.
    pub fn position(&self, body: usize) -> usize {
        POSITIONS * body
    }

    /// First index of a body's velocities in v.
    pub fn velocity(&self, body: usize) -> usize {
        VELOCITIES * body
    }

    /// First index of a body's unknowns in u.
    pub fn unknown(&self, body: usize) -> usize {
        self.unknown[body]
    }

    /// Number of a body's unknowns.
    pub fn unknowns_of(&self, body: usize) -> usize {
        self.unknown[body + 1] - self.unknown[body]
    }

    /// The velocities that a body can have.
    pub fn mobility(&self, body: usize) -> &Mobility {
        &self.mobility[body]
    }

    /// The body of a component of v.
    pub fn body_of_velocity(&self, component: usize) -> usize {
        component / VELOCITIES
    }

    /// A component of v of the same body as an unknown, for messages.
    pub fn velocity_of_unknown(&self, unknown: usize) -> usize {
        let body = self.unknown.partition_point(|&start| start <= unknown) - 1;
        self.velocity(body) + unknown - self.unknown[body]
    }

    /// A joint's rows among the constraints.
    pub fn rows(&self, joint: usize) -> Range<usize> {
        self.constraint[joint]..self.constraint[joint + 1]
    }

    /// The joint of a constraint row.
    pub fn joint_of_row(&self, row: usize) -> usize {
        self.constraint.partition_point(|&start| start <= row) - 1
    }
}
