//! Fixed bodies: welded to ground, directly or through other fixed bodies. They have no unknowns,
//! and joints between them and ground have no rows. A design variable may change their position.

use super::examine::{ConditionChecker, Designs, Verdict, ViolatedCondition};
use super::{Kept, reactions};
use crate::math::Scalar;
use crate::model::{Joint, JointKind, Mobility, Model};
use crate::system::measures::Wrench;
use crate::system::placement::{guess, length_scale};
use crate::system::{BodyMotion, Numbering, constraint, side};

/// Bodies that cannot move.
#[derive(Clone, Debug, Default)]
pub struct Fixed {
    /// By body: whether it is fixed. Empty if none is.
    held: Vec<bool>,
}

/// By body: whether welds hold it to ground.
pub(super) fn welded_to_ground<S>(model: &Model<S>) -> Vec<bool> {
    let mut held = vec![false; model.bodies.len()];
    loop {
        let welded = model.joints.iter().find_map(|joint| {
            let ends = [Some(joint.body_a), joint.body_b];
            let mut free = ends.into_iter().flatten().filter(|&body| !held[body]);
            match (joint.kind, free.next(), free.next()) {
                (JointKind::Weld, Some(body), None) if !is_void(joint) => Some(body),
                _ => None,
            }
        });
        match welded {
            Some(body) => held[body] = true,
            None => return held,
        }
    }
}

/// Whether a joint has no rows left.
pub(super) fn is_void<S>(joint: &Joint<S>) -> bool {
    joint.trivial_rows.len() == joint.all_rows().count()
}

impl Fixed {
    /// Finds the fixed bodies. There are none if no body would move.
    pub(super) fn find(designs: &Designs) -> (Self, Option<Kept>) {
        let model = &designs.start.model;
        let held = welded_to_ground(model);
        // Merged bodies follow their host and are not fixed.
        let free = |body: usize| !held[body] && model.bodies[body].mobility != Mobility::fixed();
        let some_move = (0..held.len()).any(free);
        if !held.contains(&true) || !some_move {
            return Default::default();
        }
        let fixed = Self { held };
        let lost = |wrench: &Wrench<f64>| fixed.holds_joint(&model.joints[wrench.joint]);
        let obstacles = reactions::kept(&designs.start, lost);
        if !obstacles.is_empty() {
            return (Self::default(), Some(Self::kept(obstacles)));
        }
        let verdict = designs.ask(
            |scene| fixed.holds(&scene.model, 0.0),
            |scene, change| fixed.holds(&scene.model, change),
        );
        match verdict {
            Ok(()) => (fixed, None),
            Err(obstacles) => (Self::default(), Some(Self::kept(obstacles))),
        }
    }

    fn kept(obstacles: Vec<ViolatedCondition>) -> Kept {
        Kept {
            reduction: "bodies that are welded to ground".into(),
            obstacles,
        }
    }

    /// Whether no body is fixed.
    pub fn is_empty(&self) -> bool {
        self.held.is_empty()
    }

    /// Whether body `index` is fixed.
    pub fn contains(&self, index: usize) -> bool {
        self.held.get(index) == Some(&true)
    }

    /// Whether an end of a joint cannot move.
    pub(super) fn holds_end(&self, body: Option<usize>) -> bool {
        body.is_none_or(|body| self.contains(body))
    }

    /// Whether neither end of a joint can move.
    fn holds_joint<S>(&self, joint: &Joint<S>) -> bool {
        self.holds_end(Some(joint.body_a)) && self.holds_end(joint.body_b)
    }

    /// Removes the unknowns of fixed bodies and the rows between them.
    pub(super) fn apply<S: Scalar>(&self, model: &mut Model<S>) {
        let bodies = model.bodies.iter_mut().zip(&self.held);
        for (body, _) in bodies.filter(|(_, held)| **held) {
            body.mobility = Mobility::fixed();
        }
        for joint in &mut model.joints {
            if self.holds_joint(joint) {
                joint.trivial_rows = joint.all_rows().collect();
                joint.redundant.clear();
            }
        }
    }

    /// Examines whether the joints between fixed bodies are closed, and remain closed.
    pub(super) fn holds<S: Scalar>(&self, model: &Model<S>, change: f64) -> Verdict {
        let mut examiner = ConditionChecker::new(change);
        if self.is_empty() {
            return Ok(());
        }
        let length = length_scale(model);
        let (q, v) = guess(model);
        let mut motions = Vec::new();
        BodyMotion::all_normalised(&Numbering::new(model), &q, &v, &mut motions);
        let ground = BodyMotion::ground();
        for joint in model.joints.iter().filter(|joint| self.holds_joint(joint)) {
            if is_void(joint) {
                continue;
            }
            let what = || (format!("joint \"{}\" moves its bodies", joint.name), "");
            if !joint.drives.is_empty() {
                examiner.tell(what().0);
            }
            let (a, b) = side::sides(joint, &motions, &ground, S::zero());
            for row in joint.all_rows() {
                examiner.zero(constraint::value(row, &a, &b), length.max(1.0), what);
            }
        }
        examiner.verdict()
    }
}
