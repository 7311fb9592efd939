//! Reductions: the smaller system that moves as a scene does. It is found before any integration.
//!
//! A reduction is made only if it changes nothing but round-off at every design. Its conditions are
//! examined in values at the start, at both corners of the bounds and at designs between them, and
//! in their derivatives by every variable (dual numbers). The values are examined again in every
//! scene.

mod characteristic_length;
mod examine;
pub mod fixed;
mod in_plane;
mod merge;
pub mod non_rotating;
mod normal;
mod out_of_plane;
pub mod planar;
mod point;
mod reactions;
pub mod unseen;
pub mod welded;

pub use examine::{Makers, Range, ViolatedCondition};
pub use fixed::Fixed;
pub use non_rotating::NonRotating;
pub use planar::Plane;
pub use unseen::Seen;
pub use welded::Welded;

use crate::functions::{Instant, Scene};
use crate::integrate::Trajectory;
use crate::math::Scalar;
use crate::model::{ConstraintRow, Mobility, Model};
use crate::system::redundancy;
use characteristic_length::Reach;
use examine::Designs;

/// A reduction that is not made.
#[derive(Clone, Debug, PartialEq)]
pub struct Kept {
    /// The reduction.
    pub reduction: String,
    /// The conditions that the model violates.
    pub obstacles: Vec<ViolatedCondition>,
}

/// Largest number of violated conditions of one reduction that are reported.
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

/// The reductions of the scenes of a problem.
#[derive(Clone, Debug)]
pub struct Lowering {
    /// Bodies that are welded to each other. They are merged.
    pub welded: Welded,
    /// The plane of the motion, or the conditions that it violates.
    pub plane: Result<Plane, Kept>,
    /// Bodies whose rotation is neither loaded nor observed.
    pub points: Vec<usize>,
    /// Moving bodies whose rotation ground holds.
    pub non_rotating: NonRotating,
    /// Bodies that cannot move.
    pub fixed: Fixed,
    /// Reductions that are not made, except for the plane.
    kept: Vec<Kept>,
    /// By joint: rows that are redundant after the reductions.
    redundant: Vec<Vec<ConstraintRow>>,
    /// Numbers of parts of the scenes.
    parts: [usize; 3],
}

/// Numbers of bodies, with those that carry elastic coordinates, of joints and of loads.
fn parts<S>(model: &Model<S>) -> [usize; 3] {
    [model.bodies.len(), model.joints.len(), model.loads.len()]
}

impl Lowering {
    /// Finds the reductions of the scenes that `real` and `dual` make of a design.
    pub fn find(start: Scene<f64>, others: Makers, variables: &[Range]) -> Self {
        let mut designs = Designs::new(start, others, variables);
        if let Some(none) = Self::of_unlike(&designs) {
            return none;
        }
        let model = &designs.start.model;
        let parts = parts(model);
        if model.is_entangled() {
            return Self::of_flexible(&designs);
        }
        let (welded, mut kept) = Welded::find(&designs);
        if !welded.is_empty() {
            designs.change(|scene| welded.apply(scene), |scene| welded.apply(scene));
        }
        let (fixed, of_fixed) = Fixed::find(&designs);
        let plane = Plane::find(&designs);
        let (non_rotating, of_non_rotating) = NonRotating::find(&designs, &fixed);
        let mut points = Vec::new();
        // A planar body has three unknowns already.
        if plane.is_err() {
            let held = |body| fixed.holds_end(Some(body)) || non_rotating.contains(body);
            points = find_points(&designs, held, &mut kept);
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
            parts,
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

    /// The plane of the motion alone: all bodies keep their numbers and all of their states, with which another scene
    /// may begin.
    pub fn of_plane(start: Scene<f64>, others: Makers, variables: &[Range]) -> Self {
        let designs = Designs::new(start, others, variables);
        Self::of_unlike(&designs).unwrap_or_else(|| {
            let plane = Plane::find(&designs);
            Self::of_plane_and_points(&designs, plane, (Vec::new(), Vec::new()))
        })
    }

    /// No reduction, if a function looks at vibrations of the whole machine, or designs have other parts than the start.
    fn of_unlike(designs: &Designs) -> Option<Self> {
        let what = if shakes(&designs.start) {
            "a function looks at vibrations of the whole machine in all directions"
        } else if !designs.all_have(parts(&designs.start.model)) {
            "the number of bodies, joints or elastic coordinates depends on the design"
        } else {
            return None;
        };
        let plane = Kept {
            reduction: "a plane".to_owned(),
            obstacles: vec![ViolatedCondition::plain(what)],
        };
        let none = (Vec::new(), Vec::new());
        Some(Self::of_plane_and_points(designs, Err(plane), none))
    }

    /// The reductions of scenes with flexible bodies, couplings or controllers: a plane, or else the rotation of bodies that
    /// are points. The other reductions assume rigid bodies whose joints alone hold them.
    fn of_flexible(designs: &Designs) -> Self {
        let model = &designs.start.model;
        let (mut points, mut kept) = (Vec::new(), Vec::new());
        let plane = Plane::find(designs);
        if plane.is_err() {
            points = find_points(designs, |body| model.is_of_flexible(body), &mut kept);
        }
        Self::of_plane_and_points(designs, plane, (points, kept))
    }

    fn of_plane_and_points(
        designs: &Designs,
        plane: Result<Plane, Kept>,
        (points, kept): (Vec<usize>, Vec<Kept>),
    ) -> Self {
        Self {
            welded: Welded::default(),
            plane,
            points,
            non_rotating: NonRotating::default(),
            fixed: Fixed::default(),
            kept,
            redundant: Vec::new(),
            parts: parts(&designs.start.model),
        }
    }

    /// The reductions that are not made, with their violated conditions.
    pub fn kept(&self) -> Vec<&Kept> {
        self.plane
            .as_ref()
            .err()
            .into_iter()
            .chain(&self.kept)
            .collect()
    }

    /// Applies the reductions to `scene` and returns true. If its design violates a condition, it
    /// returns false and leaves `scene` as it is.
    pub fn apply<S: Scalar>(&self, scene: &mut Scene<S>) -> bool {
        if parts(&scene.model) != self.parts {
            return false;
        }
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

    /// Whether `scene`, whose welded bodies are merged, satisfies the conditions of all other
    /// reductions.
    fn admits<S: Scalar>(&self, scene: &Scene<S>) -> bool {
        let model = &scene.model;
        let characteristic_length = Reach::new(model);
        let point = |&body: &usize| point::holds(scene, &characteristic_length, body, 0.0).is_ok();
        let plane = self.plane.as_ref();
        let in_plane = |plane: &Plane| {
            plane.holds(model, 0.0).is_ok()
                && reactions::in_plane(scene, &plane.normal, 0.0).is_ok()
        };
        plane.map_or(true, in_plane)
            && self.points.iter().all(point)
            && self.non_rotating.holds(model, 0.0).is_ok()
            && self.fixed.holds(model, 0.0).is_ok()
    }

    fn leave_out<S: Scalar>(&self, scene: &mut Scene<S>) {
        if let Ok(plane) = &self.plane {
            reactions::turn_into_plane(scene, &plane.normal);
            plane.apply(&mut scene.model);
        }
        let model = &mut scene.model;
        for &body in &self.points {
            model.bodies[body].mobility = Mobility::point();
        }
        self.non_rotating.apply(model);
        self.fixed.apply(model);
        for (joint, redundant) in model.joints.iter_mut().zip(&self.redundant) {
            joint.redundant.clone_from(redundant);
        }
    }

    /// The motion of all bodies of `written` from `run`, the motion of its reduced model; `None` if
    /// no bodies were merged.
    pub fn expand(&self, written: &Model<f64>, run: &Trajectory<f64>) -> Option<Trajectory<f64>> {
        (!self.welded.is_empty()).then(|| self.welded.expand(written, run))
    }
}

/// Bodies whose rotation is neither loaded nor observed, without those that `held` names. The reasons of
/// other bodies are added to `kept`.
fn find_points(
    designs: &Designs,
    held: impl Fn(usize) -> bool,
    kept: &mut Vec<Kept>,
) -> Vec<usize> {
    let mut points = Vec::new();
    let model = &designs.start.model;
    let characteristic_length = Reach::new(model);
    for (index, body) in model.bodies.iter().enumerate() {
        if held(index) || body.mobility == Mobility::fixed() {
            continue;
        }
        // The conditions at the start suffice.
        let start = point::holds(&designs.start, &characteristic_length, index, 0.0);
        let verdict = start.and_then(|()| {
            designs.ask(
                |scene| point::holds(scene, &Reach::new(&scene.model), index, 0.0),
                |scene, change| point::holds(scene, &Reach::new(&scene.model), index, change),
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
    points
}

/// Whether a function looks at vibrations, which need all motions that the machine can have.
fn shakes(scene: &Scene<f64>) -> bool {
    let mut all = scene.functions.iter().flat_map(|own| own.instants());
    all.any(|own| matches!(own, Instant::Vibration(_)))
}
