//! The problem file: reading, faults, schema, and the map from a design to a scene.
//!
//! A file is read in steps, each of which reports all that it finds: JSON syntax; the shape of the
//! document against its schema; what names, numbers and design variables mean together. Only a
//! document without a fault becomes a [`Problem`].

mod blocks;
mod bounds;
mod check;
mod drawing;
mod fault;
mod finding;
mod focus;
mod joints;
mod loads;
mod mass;
mod memory;
mod overrides;
mod placement;
mod pointer;
mod points;
mod prune;
mod quantity;
mod read;
mod scene;
mod schema;
mod source;
mod start_rates;
mod starts;
mod structure;
mod syntax;
#[cfg(test)]
mod tests;
mod text;
mod variables;

pub(crate) use drawing::{Drawing, Outline};
pub use fault::{Fault, Faults};
pub(crate) use focus::Focus;
pub(crate) use memory::available as available_memory;
pub use overrides::{Override, OverrideError};
pub(crate) use schema::schema;
pub(crate) use text::{visible, visible_lines};
pub use variables::Variable;

use crate::functions::{Function, Scene};
use crate::integrate::{self, Spacing};
use crate::lower::Lowering;
use crate::math::{Scalar, Vec3};
use crate::model::ConstraintRow;
use crate::optimiser::Method;
use crate::system::redundancy::Redundancy;
use schema::Document;
use std::path::Path;

/// Which way an objective goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Sense {
    /// As small as can be.
    Minimise,
    /// As large as can be.
    Maximise,
}

/// The function that is optimised.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Objective {
    /// Index of the function.
    pub function: usize,
    /// Which way.
    pub sense: Sense,
}

/// Bounds on a function.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Constraint {
    /// Name in the problem file.
    pub name: String,
    /// Index of the function.
    pub function: usize,
    /// Smallest value; −∞ if there is none.
    pub lower: f64,
    /// Largest value; +∞ if there is none.
    pub upper: f64,
}

/// Settings of the optimiser that a file may give.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct OptimiserSettings {
    /// Algorithm.
    pub method: Option<Method>,
    /// Scaled residual of the optimality conditions at which it stops.
    pub tolerance: Option<f64>,
    /// Largest violation of a constraint, in its own unit.
    pub constraint_tolerance: Option<f64>,
    /// Largest number of iterations.
    pub iterations: Option<usize>,
    /// Largest number of simulations.
    pub evaluations: Option<usize>,
    /// Longest wall time of the run (s).
    pub seconds: Option<f64>,
    /// Minimised objective below which the problem is called unbounded.
    pub unbounded_below: Option<f64>,
}

/// How a scene is integrated, as far as the file says.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Simulation {
    /// The method; `None` if the scene chooses.
    pub method: Option<integrate::Method>,
    /// Steps or tolerance.
    pub spacing: Spacing,
    /// Number of equal intervals at whose ends the motion is sampled, if the file says so.
    pub samples: Option<usize>,
    /// What a simulation may take, and who is told how far it is.
    pub limits: integrate::Limits,
    /// Memory that what is kept for gradients may take (bytes); `None` for a part of what there is.
    pub memory: Option<usize>,
}

/// A problem: a scene that depends on a design, what is asked of it, and how it is solved.
///
/// ```
/// use flexbody::Problem;
///
/// let text = r#"{
///   "version": 1, "name": "ball",
///   "bodies": {"ball": {"shape": {"sphere": {"radius": 0.5}}, "mass": 2}},
///   "simulation": {"duration": 1, "steps": 100},
///   "variables": {"radius": {"path": "/bodies/ball/shape/sphere/radius", "lower": 0.1}}
/// }"#;
/// let problem = Problem::parse(text, "ball.json", &[])?;
/// assert_eq!(problem.start(), [0.5]);
/// # Ok::<(), flexbody::Faults>(())
/// ```
#[derive(Clone, Debug)]
pub struct Problem {
    /// Name of the problem and of its results.
    pub(crate) name: String,
    /// How the scene is integrated.
    pub(crate) simulation: Simulation,
    /// Design variables in the order of the file.
    pub(crate) variables: Vec<Variable>,
    /// The function that is optimised, if any. A file with constraints and variables and without
    /// objective asks for the feasible design nearest to its own: then it is the last function,
    /// Σ ((x − x0)/scale)².
    pub(crate) objective: Option<Objective>,
    /// x0, where the file has no objective.
    nearest_to: Option<Vec<f64>>,
    /// Constraints in the order of the file.
    pub(crate) constraints: Vec<Constraint>,
    /// Names of the functions in the order of the file, which is that of [`Scene::functions`].
    pub(crate) function_names: Vec<String>,
    /// Settings of the optimiser.
    pub(crate) optimiser: OptimiserSettings,
    /// The document with its overrides applied; a problem is made from it again by
    /// [`Problem::parse`].
    pub(crate) document: serde_json::Value,
    /// SHA-256 of the document without white space, in hexadecimal.
    pub(crate) hash: String,
    /// The document with its numbers bound to the design variables.
    written: Document,
    /// Order in which the bodies are placed.
    order: Vec<usize>,
    /// Joints whose rows follow in part from other joints at the start design. Those rows are left
    /// out at every design.
    pub(crate) redundant: Vec<Redundancy>,
    /// The rows that are left out, by joint.
    left_out: Vec<Vec<ConstraintRow>>,
    /// What is left out of its scenes before they are integrated; `None` if nothing shall be.
    pub(crate) lowering: Option<Lowering>,
    /// The functions that are asked for and the bodies that they can see; `None` is all.
    pub(crate) focus: Option<Focus>,
}

impl Problem {
    /// Reads a problem file, with `overrides` in place of what it says.
    ///
    /// # Errors
    /// All faults that are found, each with its place.
    pub fn load(path: &Path, overrides: &[Override]) -> Result<Self, Faults> {
        read::load(path, overrides)
    }

    /// Reads a problem from its text; `file` is what faults call it.
    ///
    /// # Errors
    /// All faults that are found, each with its place.
    pub fn parse(text: &str, file: &str, overrides: &[Override]) -> Result<Self, Faults> {
        read::parse(text, file, overrides)
    }

    /// Name of the problem and of its results.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Design variables in the order of the file.
    pub fn variables(&self) -> &[Variable] {
        &self.variables
    }

    /// Names of the functions in the order of the file.
    pub fn functions(&self) -> &[String] {
        &self.function_names
    }

    /// Bounds the memory \[bytes\] of what is kept of a motion for its gradients. The other steps are made
    /// again from checkpoints.
    pub fn limit_memory(&mut self, bytes: usize) {
        self.simulation.memory = Some(bytes);
    }

    /// The design that the file describes.
    pub fn start(&self) -> Vec<f64> {
        self.variables
            .iter()
            .map(|variable| variable.start)
            .collect()
    }

    /// Makes `x`, moved inside the bounds, the start.
    pub(crate) fn restart(&mut self, x: &[f64]) {
        for (variable, &x) in self.variables.iter_mut().zip(x) {
            variable.start = x.clamp(variable.lower, variable.upper);
        }
    }

    /// SI unit of the function `index`.
    ///
    /// # Panics
    /// If there is no such function.
    pub(crate) fn function_unit(&self, index: usize) -> String {
        self.scene(&self.start()).functions[index].unit()
    }

    /// The scene at the design `x`, analytic in `x`; one component per variable, each in the unit
    /// of its numbers.
    ///
    /// What its lowering leaves out is left out of the model, where the design admits it.
    pub(crate) fn scene<S: Scalar>(&self, x: &[S]) -> Scene<S> {
        self.lowered_scene(x).0
    }

    /// As [`Problem::scene`], and whether the design admits all that the lowering leaves out.
    pub(crate) fn lowered_scene<S: Scalar>(&self, x: &[S]) -> (Scene<S>, bool) {
        let mut scene = self.unlowered_scene(x);
        let all = self.lower(&mut scene);
        (scene, all)
    }

    /// Leaves out of a scene what its lowering does; false if its design does not admit all of that,
    /// and the scene stays as it is.
    pub(crate) fn lower<S: Scalar>(&self, scene: &mut Scene<S>) -> bool {
        let lowering = self.lowering.as_ref();
        lowering.is_none_or(|lowering| lowering.apply(scene))
    }

    /// The scene at the design `x` with nothing left out but what follows from other joints, and what
    /// cannot be seen by the functions that a [focused](Problem::focused) problem asks for.
    pub(crate) fn unlowered_scene<S: Scalar>(&self, x: &[S]) -> Scene<S> {
        let mut scene = scene::scene(&self.written, &self.order, x);
        for (joint, left_out) in scene.model.joints.iter_mut().zip(&self.left_out) {
            joint.redundant.clone_from(left_out);
        }
        if let Some(start) = &self.nearest_to {
            let terms = x.iter().zip(start).zip(&self.variables);
            let distance = terms.fold(S::zero(), |sum, ((&x, &x0), variable)| {
                let change = (x - x0) / variable.scale;
                sum + change * change
            });
            scene.functions.push(Function::OfDesign(distance));
        }
        if let Some(focus) = &self.focus {
            focus.seen.apply(&mut scene);
        }
        scene
    }

    /// Velocity [m/s] and angular velocity [rad/s] in ground axes that the file gives each body as its
    /// own; `None` if it gives it none.
    pub(crate) fn own_velocities(&self, x: &[f64]) -> Vec<Option<[Vec3<f64>; 2]>> {
        scene::own_velocities(&self.written, x)
    }

    /// The objective that the file states.
    pub(crate) fn stated_objective(&self) -> Option<Objective> {
        self.objective.filter(|_| self.nearest_to.is_none())
    }

    /// How the motion of the design `x` is drawn.
    pub(crate) fn drawing(&self, x: &[f64]) -> Drawing {
        drawing::drawing(&self.written, &self.order, x)
    }
}
