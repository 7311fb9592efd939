//! The smallest system that moves as a scene does: what is left out of it before anything is
//! integrated, and why nothing more is.
//!
//! A reduction is made only if it changes nothing but round-off, at every design: it is examined at
//! the start, at both bounds and at designs between them, and by dual numbers in its derivative by
//! every variable. The same examination, in values, is repeated wherever a scene is made.

mod characteristic_length;
mod examine;
pub(crate) mod fixed;
mod in_plane;
mod merge;
pub(crate) mod non_rotating;
mod normal;
mod out_of_plane;
pub(crate) mod planar;
mod point;
pub(crate) mod unseen;
pub(crate) mod welded;

pub(crate) use examine::{Range, ViolatedCondition};
pub(crate) use fixed::Fixed;
pub(crate) use non_rotating::NonRotating;
pub(crate) use planar::Plane;
pub(crate) use unseen::Seen;
pub(crate) use welded::Welded;

use crate::functions::Scene;
use crate::integrate::Trajectory;
use crate::math::{Dual, Scalar};
use crate::model::{ConstraintRow, Mobility, Model};
use crate::system::redundancy;
use characteristic_length::Reach;
use examine::Designs;

/// A reduction that is not made.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Kept {
    /// What could have been left out.
    pub reduction: String,
    /// What stands against it.
    pub obstacles: Vec<ViolatedCondition>,
}

/// Violated conditions of one reduction that are reported.
const TOLD: usize = 5;

impl std::fmt::Display for Kept {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        let told = self.obstacles.iter().take(TOLD);
        let told: Vec<String> = told.map(ViolatedCondition::to_string).collect();
        write!(f, "{}: {}", self.reduction, told.join("; "))?;
        match self.obstacles.len() - told.len() {
            0 => Ok(()),
            more => write!(f, "; and {more} more"),
        }
    }
}

/// What is left out of the scenes of a problem.
#[derive(Clone, Debug)]
pub(crate) struct Lowering {
    /// Bodies that are welded to each other.
    pub welded: Welded,
    /// The plane that all motion stays in, or what leaves every plane.
    pub plane: Result<Plane, Kept>,
    /// Bodies whose rotation nothing turns or looks at.
    pub points: Vec<usize>,
    /// Bodies whose rotation ground holds.
    pub non_rotating: NonRotating,
    /// Bodies that nothing can move.
    pub fixed: Fixed,
    /// Reductions that are not made, but for the plane.
    kept: Vec<Kept>,
    /// Rows that follow from others once these are made, by joint.
    redundant: Vec<Vec<ConstraintRow>>,
}

impl Lowering {
    /// Finds what can be left out of the scenes that `real` and `dual` make of a design.
    pub(crate) fn find(
        real: &dyn Fn(&[f64]) -> Scene<f64>,
        dual: &dyn Fn(&[Dual]) -> Scene<Dual>,
        variables: &[Range],
    ) -> Self {
        let mut designs = Designs::new(real, dual, variables);
        let (welded, mut kept) = Welded::find(&designs);
        if !welded.is_empty() {
            designs.change(|scene| welded.apply(scene), |scene| welded.apply(scene));
        }
        let (fixed, of_fixed) = Fixed::find(&designs);
        let plane = Plane::find(&designs);
        let (non_rotating, of_non_rotating) = NonRotating::find(&designs, &fixed);
        let mut points = Vec::new();
        // A body in the plane has three unknowns already.
        if plane.is_err() {
            let model = &designs.start.model;
            let characteristic_length = Reach::new(model);
            for (index, body) in model.bodies.iter().enumerate() {
                let held = fixed.holds_end(Some(index)) || non_rotating.contains(index);
                if held || body.mobility == Mobility::fixed() {
                    continue;
                }
                // What the start says is enough.
                let start = point::holds(&designs.start, &characteristic_length, index, 0.0);
                let verdict = start.and_then(|()| {
                    designs.ask(
                        |scene| point::holds(scene, &Reach::new(&scene.model), index, 0.0),
                        |scene, change| {
                            point::holds(scene, &Reach::new(&scene.model), index, change)
                        },
                    )
                });
                match verdict {
                    Ok(()) => points.push(index),
                    Err(obstacles) => kept.push(Kept {
                        reduction: format!("the rotation of body \"{}\"", body.name),
                        obstacles,
                    }),
                }
            }
        }
        kept.extend(of_fixed.into_iter().chain(of_non_rotating));
        let mut found = Self {
            welded,
            plane,
            points,
            non_rotating,
            fixed,
            kept,
            redundant: Vec::new(),
        };
        if !(found.welded.is_empty() && found.non_rotating.is_empty() && found.fixed.is_empty()) {
            let mut lowered = designs.start;
            found.leave_out(&mut lowered);
            redundancy::leave_out(&mut lowered.model);
            let joints = lowered.model.joints.into_iter();
            found.redundant = joints.map(|joint| joint.redundant).collect();
        }
        found
    }

    /// Every reduction that is not made, with what stands against it.
    pub(crate) fn kept(&self) -> Vec<&Kept> {
        self.plane
            .as_ref()
            .err()
            .into_iter()
            .chain(&self.kept)
            .collect()
    }

    /// Leaves out of `scene` what can be; false if its design does not admit all of it, and it stays as
    /// it is.
    pub(crate) fn apply<S: Scalar>(&self, scene: &mut Scene<S>) -> bool {
        if self.welded.is_empty() {
            let admitted = self.admits(scene);
            if admitted {
                self.leave_out(scene);
            }
            return admitted;
        }
        if self.welded.holds(scene, 0.0).is_err() {
            return false;
        }
        let mut merged = scene.clone();
        self.welded.apply(&mut merged);
        let admitted = self.admits(&merged);
        if admitted {
            self.leave_out(&mut merged);
            *scene = merged;
        }
        admitted
    }

    /// Whether all but the merging of welded bodies, which has been done, may be.
    fn admits<S: Scalar>(&self, scene: &Scene<S>) -> bool {
        let model = &scene.model;
        let characteristic_length = Reach::new(model);
        let point = |&body: &usize| point::holds(scene, &characteristic_length, body, 0.0).is_ok();
        let plane = self.plane.as_ref();
        plane.map_or(true, |plane| plane.holds(model, 0.0).is_ok())
            && self.points.iter().all(point)
            && self.non_rotating.holds(model, 0.0).is_ok()
            && self.fixed.holds(model, 0.0).is_ok()
    }

    fn leave_out<S: Scalar>(&self, scene: &mut Scene<S>) {
        let model = &mut scene.model;
        if let Ok(plane) = &self.plane {
            plane.apply(model);
        }
        for &body in &self.points {
            model.bodies[body].mobility = Mobility::point();
        }
        self.non_rotating.apply(model);
        self.fixed.apply(model);
        for (joint, redundant) in model.joints.iter_mut().zip(&self.redundant) {
            joint.redundant.clone_from(redundant);
        }
    }

    /// The motion of all bodies of `written`, the model that a lowered scene was made of, from the run
    /// of that; `None` if that is it.
    pub(crate) fn expand(
        &self,
        written: &Model<f64>,
        run: &Trajectory<f64>,
    ) -> Option<Trajectory<f64>> {
        (!self.welded.is_empty()).then(|| self.welded.expand(written, run))
    }
}
