//! Non-rotating bodies: they slide along an axis of ground or of another such body. They have three
//! unknowns (two in the plane) and no rows for their rotation.
//!
//! Their rotation is that of the placement, provided that it satisfies these rows.

use super::examine::{ConditionChecker, Designs, Verdict};
use super::fixed::{Fixed, is_void};
use super::{Kept, reactions};
use crate::math::Scalar;
use crate::model::{ConstraintRow, DegreeOfFreedom, Joint, Model};
use crate::system::measures::{Wrench, WrenchPart};
use crate::system::{BodyMotion, Numbering, constraint, placement, side};

/// Bodies that move but cannot rotate.
#[derive(Clone, Debug, Default)]
pub struct NonRotating {
    /// By body: whether it moves and cannot rotate. Empty if none does.
    bodies: Vec<bool>,
    /// By body: whether it cannot rotate; fixed bodies included.
    still: Vec<bool>,
}

fn holds_rotation(row: &ConstraintRow) -> bool {
    row.is_angle()
}

/// Whether a joint prevents any relative rotation of its bodies.
fn holds_both<S>(joint: &Joint<S>) -> bool {
    let turns = joint
        .drives
        .iter()
        .any(|own| own.dof == DegreeOfFreedom::Rotation);
    !turns && joint.all_rows().filter(holds_rotation).count() == 3
}

impl NonRotating {
    /// Finds the bodies whose rotation ground holds.
    pub(super) fn find(designs: &Designs, fixed: &Fixed) -> (Self, Option<Kept>) {
        let model = &designs.start.model;
        let count = model.bodies.len();
        let held: Vec<bool> = (0..count).map(|body| fixed.holds_end(Some(body))).collect();
        let mut still = held.clone();
        loop {
            let next = model.joints.iter().find_map(|joint| {
                let ends = [Some(joint.body_a), joint.body_b];
                let mut free = ends.into_iter().flatten().filter(|&body| !still[body]);
                match (free.next(), free.next()) {
                    (Some(body), None) if holds_both(joint) && !is_void(joint) => Some(body),
                    _ => None,
                }
            });
            match next {
                Some(body) => still[body] = true,
                None => break,
            }
        }
        let bodies: Vec<bool> = still.iter().zip(&held).map(|(s, h)| *s && !h).collect();
        if !bodies.contains(&true) {
            return Default::default();
        }
        let found = Self { bodies, still };
        let kept = |obstacles| Kept {
            reduction: "the rotation of bodies that cannot turn".into(),
            obstacles,
        };
        let lost = |wrench: &Wrench<f64>| {
            wrench.part == WrenchPart::Moment && found.holds_joint(&model.joints[wrench.joint])
        };
        let obstacles = reactions::kept(&designs.start, lost);
        if !obstacles.is_empty() {
            return (Self::default(), Some(kept(obstacles)));
        }
        let verdict = designs.ask(
            |scene| found.holds(&scene.model, 0.0),
            |scene, change| found.holds(&scene.model, change),
        );
        match verdict {
            Ok(()) => (found, None),
            Err(obstacles) => (Self::default(), Some(kept(obstacles))),
        }
    }

    /// Whether there are no non-rotating bodies.
    pub fn is_empty(&self) -> bool {
        self.bodies.is_empty()
    }

    /// Whether body `index` is non-rotating.
    pub fn contains(&self, index: usize) -> bool {
        self.bodies.get(index) == Some(&true)
    }

    /// Whether neither end of a joint can rotate.
    fn holds_joint<S>(&self, joint: &Joint<S>) -> bool {
        let still = |body: usize| self.still.get(body) == Some(&true);
        still(joint.body_a) && joint.body_b.is_none_or(still) && !is_void(joint)
    }

    /// Removes the rotations of these bodies and the rows that hold them.
    pub(super) fn apply<S: Scalar>(&self, model: &mut Model<S>) {
        let bodies = model.bodies.iter_mut().zip(&self.bodies);
        for (body, _) in bodies.filter(|(_, own)| **own) {
            body.mobility = body.mobility.without_rotation();
        }
        for joint in &mut model.joints {
            if self.holds_joint(joint) {
                let rows = joint.all_rows();
                let gone =
                    rows.filter(|row| holds_rotation(row) || joint.trivial_rows.contains(row));
                joint.trivial_rows = gone.collect();
                let held = |row: &ConstraintRow| !holds_rotation(row);
                joint.redundant.retain(held);
            }
        }
    }

    /// Examines whether the placement satisfies the rows for the rotation of these bodies.
    pub(super) fn holds<S: Scalar>(&self, model: &Model<S>, change: f64) -> Verdict {
        let mut examiner = ConditionChecker::new(change);
        if self.is_empty() {
            return Ok(());
        }
        let (q, v) = placement::guess(model);
        let mut motions = Vec::new();
        BodyMotion::all_normalised(&Numbering::new(model), &q, &v, &mut motions);
        let ground = BodyMotion::ground();
        for joint in model.joints.iter().filter(|joint| self.holds_joint(joint)) {
            let name = &joint.name;
            let turns = |own: &crate::model::Drive<S>| own.dof == DegreeOfFreedom::Rotation;
            if joint.drives.iter().any(turns) {
                examiner.tell(format!("joint \"{name}\" is driven to turn"));
            }
            let (a, b) = side::sides(joint, &motions, &ground, S::zero());
            for row in joint.all_rows().filter(holds_rotation) {
                let what = || (format!("joint \"{name}\" turns its bodies"), "rad");
                examiner.zero(constraint::value(row, &a, &b), 1.0, what);
            }
        }
        examiner.verdict()
    }
}
