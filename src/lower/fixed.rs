//! Bodies that nothing can move: welded to ground, or to a body that is. They have no unknowns, and
//! what joins them to ground has no rows.
//!
//! No variable may move such a body: its place is then that of the placement at every design.

use super::examine::{Examiner, Obstacle};
use crate::math::Scalar;
use crate::math::rotation::Quat;
use crate::math::{Vec3, scalar::lift3};
use crate::model::{Joint, JointKind, Mobility, Model};
use crate::system::assembly::length_scale;
use crate::system::{Motion, Numbering, constraint, initial, side};

/// Bodies that nothing can move.
#[derive(Clone, Debug, Default)]
pub struct Fixed {
    /// Index, position and Euler parameters of each.
    bodies: Vec<(usize, Vec3<f64>, Quat<f64>)>,
}

impl Fixed {
    /// Bodies that welds hold to ground where `model` is placed; none if these are all it has.
    pub fn find(model: &Model<f64>) -> Self {
        let mut fixed = Self::default();
        loop {
            let welded = model.joints.iter().find_map(|joint| {
                let ends = [Some(joint.body_a), joint.body_b];
                let free = |end: &&Option<usize>| !fixed.holds_end(**end);
                let mut free = ends.iter().filter(free);
                match (joint.kind, free.next(), free.next()) {
                    (JointKind::Weld, Some(&body), None) => body,
                    _ => None,
                }
            });
            let Some(body) = welded else { break };
            let own = &model.bodies[body];
            fixed.bodies.push((body, own.position, own.orientation));
        }
        let some_move = fixed.bodies.len() < model.bodies.len();
        match some_move && fixed.holds(model, 0.0).is_ok() {
            true => fixed,
            false => Self::default(),
        }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.bodies.is_empty()
    }

    /// Whether an end of a joint cannot move.
    fn holds_end(&self, body: Option<usize>) -> bool {
        body.is_none_or(|body| self.bodies.iter().any(|own| own.0 == body))
    }

    /// Whether neither end of a joint can move.
    fn holds_joint<S>(&self, joint: &Joint<S>) -> bool {
        self.holds_end(Some(joint.body_a)) && self.holds_end(joint.body_b)
    }

    /// Leaves out of a model what they do not need.
    pub fn apply<S: Scalar>(&self, model: &mut Model<S>) {
        for &(body, ..) in &self.bodies {
            model.bodies[body].mobility = Mobility::Fixed;
        }
        for joint in &mut model.joints {
            if self.holds_joint(joint) {
                joint.identical = joint.all_rows().collect();
                joint.left_out.clear();
            }
        }
    }

    /// Examines whether the bodies are where they were found, and what joins them is closed.
    ///
    /// # Errors
    /// What is not.
    pub fn holds<S: Scalar>(&self, model: &Model<S>, change: f64) -> Result<(), Obstacle> {
        let mut examiner = Examiner::new(change);
        if self.is_empty() {
            return Ok(());
        }
        let length = length_scale(model);
        for (body, position, orientation) in &self.bodies {
            let own = &model.bodies[*body];
            let what = || (format!("body \"{}\" is moved", own.name), "");
            let away = own.position - lift3(position);
            examiner.vanishes(away.as_slice(), length, what);
            let turned: [S; 4] = std::array::from_fn(|k| own.orientation[k] - orientation[k]);
            examiner.vanishes(&turned, 1.0, what);
        }
        let (q, v) = initial::guess(model);
        let mut motions = Vec::new();
        Motion::all_normalised(&Numbering::new(model), &q, &v, &mut motions);
        let ground = Motion::ground();
        for joint in model.joints.iter().filter(|joint| self.holds_joint(joint)) {
            let what = || (format!("joint \"{}\" moves its bodies", joint.name), "");
            if !joint.drives.is_empty() {
                examiner.zero(S::one(), 0.0, what);
            }
            let (a, b) = side::sides(joint, &motions, &ground, S::zero());
            for row in joint.all_rows() {
                examiner.zero(constraint::value(row, &a, &b), length.max(1.0), what);
            }
        }
        examiner.found
    }
}
