//! The problem file: reading, faults, schema, and the map from a design to a scene.
//!
//! A file is read in steps: JSON syntax; the structure of the document by its schema; the meaning
//! of names, numbers and design variables. Each step reports all faults that it finds. Only a
//! document without a fault becomes a [`Problem`].

mod aggregates;
mod beam;
mod bounds;
mod bushings;
mod cams;
mod case_faults;
mod cases;
mod centres;
mod check;
mod combined;
mod composed;
mod composing;
mod contacts;
mod controllers;
mod couplings;
mod courses;
mod data_file;
mod data_text;
mod derived;
mod division;
mod drawing;
mod elastic_drawing;
pub mod elements;
mod events;
mod expansion;
mod expression;
mod expression_units;
mod fault;
mod fibres;
mod file_text;
pub mod finding;
mod first_scene;
mod flexible;
mod focus;
mod gmsh;
mod hinge;
mod holds;
mod instances;
mod joints;
mod load;
mod load_ends;
mod loads;
mod mass;
mod measurements;
mod memory;
mod modal;
mod modes;
mod msh;
mod notes;
mod origins;
mod overrides;
mod parameter_units;
mod parts;
mod phases;
mod placement;
pub mod pointer;
mod points;
mod prune;
mod quantities;
mod quantity_units;
mod read;
mod reduced;
mod scene;
mod section;
mod smoothing;
mod source;
mod spread_loads;
mod start_rates;
mod starting_angles;
mod starts;
mod stated_cases;
mod statics;
pub mod structure;
mod surfaces;
mod syntax;
mod text;
mod together;
mod turns;
mod variables;
mod windows;

use flexbody_document::{self as schema, prepared, quantity};
use flexbody_mathematics::math;
use flexbody_mechanics::{adjoint, functions, integrate, lower, model, structures, system};
use flexbody_optimiser as optimiser;

pub use aggregates::OpenAggregate;
pub use composed::{Composed, Composition, Partials};
use derived::Derived;
pub use division::{Case, Cases, Division};
pub use drawing::{BarrierLine, Drawing, Outline};
pub use elastic_drawing::{DeformedLine, ElasticPoint, Trace};
pub use fault::{Fault, Faults};
pub use fibres::{BeamFibres, larger};
pub use focus::Focus;
pub use instances::SceneScalar;
pub use memory::available as available_memory;
pub use overrides::{Override, OverrideError};
pub use phases::EndCotangent;
pub use schema::{schema, schema_with_expressions};
pub use statics::{Asked, MeasuredFunction, Moved, StaticScene, Statics, Workspace};
pub use text::{visible, visible_lines};
pub use variables::Variable;

use crate::functions::Scene;
use crate::integrate::Spacing;
use crate::lower::Lowering;
use crate::math::{Scalar, Team, Vec3};
use crate::model::{ConstraintRow, Fit};
use crate::optimiser::Method;
use crate::structures::loads::Load;
use crate::structures::quality::MeshFault;
use crate::structures::structure::Structure;
use crate::system::equilibrium::{self, Stability};
use crate::system::left_out::Redundancy;
use model::Model;
use schema::{Document, View};
use std::borrow::Cow;
use std::path::Path;
use std::sync::Arc;

/// Direction of the optimisation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sense {
    /// The smallest value is sought.
    Minimise,
    /// The largest value is sought.
    Maximise,
}

/// The function that is optimised.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Objective {
    /// Index of the function.
    pub function: usize,
    /// Direction.
    pub sense: Sense,
}

/// Bounds on a function.
#[derive(Clone, Debug, PartialEq)]
pub struct Constraint {
    /// Name in the problem file.
    pub name: String,
    /// Index of the function.
    pub function: usize,
    /// Smallest value; −∞ if there is none.
    pub lower: f64,
    /// Largest value; +∞ if there is none.
    pub upper: f64,
}

/// Settings of the optimiser in a file.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OptimiserSettings {
    /// Algorithm.
    pub method: Option<Method>,
    /// The optimiser stops at this scaled residual of the optimality conditions.
    pub tolerance: Option<f64>,
    /// Largest violation of a constraint, in its own unit.
    pub constraint_tolerance: Option<f64>,
    /// Largest number of iterations.
    pub iterations: Option<usize>,
    /// Largest number of simulations.
    pub evaluations: Option<usize>,
    /// Longest wall time of the run \[s\].
    pub seconds: Option<f64>,
    /// The problem is unbounded if the minimised objective falls below this value.
    pub unbounded_below: Option<f64>,
}

/// Settings of the integration in a file.
#[derive(Clone, Debug, PartialEq)]
pub struct Simulation {
    /// The method; `None` if it is chosen for the scene.
    pub method: Option<integrate::Method>,
    /// Solver of the linear systems of implicit steps.
    pub solver: integrate::LinearSolver,
    /// Steps or tolerance.
    pub spacing: Spacing,
    /// Number of equal intervals at whose ends the motion is sampled, if the file gives it.
    pub samples: Option<usize>,
    /// Limits of a simulation, and the observer of its progress.
    pub limits: integrate::Limits,
    /// Memory for the data that gradients need \[bytes\]; `None` for a share of the available
    /// memory.
    pub memory: Option<usize>,
}

/// A problem: a scene that depends on a design, its functions, and the settings of the solution.
///
/// ```
/// use flexbody_problem::Problem;
///
/// let text = r#"{
///   "version": 1, "name": "ball",
///   "bodies": {"ball": {"shape": {"sphere": {"radius": 0.5}}, "mass": 2}},
///   "simulation": {"duration": 1, "steps": 100},
///   "variables": {"radius": {"path": "/bodies/ball/shape/sphere/radius", "lower": 0.1}}
/// }"#;
/// let problem = Problem::parse(text, "ball.json", &[])?;
/// assert_eq!(problem.start(), [0.5]);
/// # Ok::<(), flexbody_problem::Faults>(())
/// ```
#[derive(Clone, Debug)]
pub struct Problem {
    /// Name of the problem and of its results.
    pub name: String,
    /// How the scene is integrated.
    pub simulation: Simulation,
    /// Design variables in the order of the file.
    pub variables: Vec<Variable>,
    /// The function that is optimised, if any. Without an objective, a file with constraints and
    /// variables requests the feasible design nearest to its own: the objective is then the last
    /// function of the scene, Σ ((x − x0)/scale)².
    pub objective: Option<Objective>,
    /// x0, if the file has no objective.
    nearest_to: Option<Vec<f64>>,
    /// Constraints in the order of the file.
    pub constraints: Vec<Constraint>,
    /// Names of the functions in the order of the file and of [`Scene::functions`], then of those that expressions give.
    pub function_names: Vec<String>,
    /// Settings of the optimiser.
    pub optimiser: OptimiserSettings,
    /// The document with its overrides applied. [`Problem::parse`] makes the same problem from it.
    pub document: serde_json::Value,
    /// SHA-256 of the document without white space and of the files that it names, hexadecimal.
    pub hash: String,
    /// SHA-256 of each of these files, hexadecimal, in the order in which they are read.
    pub files: String,
    /// The document with its numbers bound to the design variables.
    written: Document,
    /// Order in which the bodies are placed.
    order: Vec<usize>,
    /// Joints with redundant rows at the start design. These rows are left out at every design.
    pub redundant: Vec<Redundancy>,
    /// By joint: the rows that are left out.
    left_out: Vec<(Vec<ConstraintRow>, Fit)>,
    /// Reductions of its scenes; `None` if none shall be made.
    pub lowering: Option<Lowering>,
    /// The requested functions and the bodies on which they depend; `None` for all.
    pub focus: Option<Focus>,
    /// Numbers that expressions give.
    derived: Derived,
    /// Functions that expressions of other functions give.
    pub composition: Arc<Composition>,
    /// Structures under load cases; then nothing moves, and there are no scenes.
    pub statics: Option<Arc<Statics>>,
    /// Cases; then what is computed is computed in each, and this problem has no scene of its own.
    pub cases: Option<Arc<Cases>>,
    /// The ranks that compute its motions together.
    team: Team,
}

impl Problem {
    /// Reads a problem file and applies `overrides`. Aggregates whose ρ it leaves out are NaN, see
    /// [`Problem::open_aggregates`].
    ///
    /// # Errors
    /// All faults that are found, each with its place.
    pub fn load(path: &Path, overrides: &[Override]) -> Result<Self, Faults> {
        load::load(path, overrides)
    }

    /// Reads a problem from its text; `file` is its name in faults.
    ///
    /// # Errors
    /// All faults that are found, each with its place.
    pub fn parse(text: &str, file: &str, overrides: &[Override]) -> Result<Self, Faults> {
        load::parse(text, file, overrides)
    }

    /// Whether a body has finite elements.
    pub fn has_shells(&self) -> bool {
        let bodies = self.written.bodies.values();
        bodies.into_iter().any(|body| body.elements.is_some())
    }

    /// Whether the end of the motion depends on the design: its duration is a variable, or it begins or ends at an
    /// event.
    pub fn end_moves(&self) -> bool {
        let simulation = self.written.simulation.as_ref();
        self.is_phase()
            || simulation.is_some_and(|simulation| {
                simulation.duration.variable.is_some() || simulation.until.is_some()
            })
    }

    /// Name of the problem and of its results.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Design variables in the order of the file.
    pub fn variables(&self) -> &[Variable] {
        &self.variables
    }

    /// Names of the functions in the order of the file, those that expressions give after the others.
    pub fn functions(&self) -> &[String] {
        &self.function_names
    }

    /// Limits the memory for the data of a motion that its gradients need \[bytes\]. Other steps
    /// are repeated from checkpoints.
    pub fn limit_memory(&mut self, bytes: usize) {
        self.change_all(&|own| own.simulation.memory = Some(bytes));
    }

    /// The design in the file.
    pub fn start(&self) -> Vec<f64> {
        self.variables
            .iter()
            .map(|variable| variable.start)
            .collect()
    }

    /// Makes `x` the start, after it is moved inside the bounds.
    pub fn restart(&mut self, x: &[f64]) {
        for (variable, &x) in self.variables.iter_mut().zip(x) {
            variable.start = x.clamp(variable.lower, variable.upper);
        }
        if let Some(cases) = &mut self.cases {
            let cases = Arc::make_mut(cases).list.iter_mut();
            cases.for_each(|case| case.problem.restart(x));
        }
    }

    /// Whether it has a scene of bodies of its own: it is neither one of structures nor one of cases.
    pub fn has_scene(&self) -> bool {
        self.statics.is_none() && self.cases.is_none()
    }

    /// Whether its scenes, or those of its cases, are reduced.
    pub fn is_lowered(&self) -> bool {
        match &self.cases {
            Some(cases) => cases.list.iter().any(|case| case.problem.is_lowered()),
            None => self.lowering.is_some(),
        }
    }

    /// SI unit of the function `index`; empty if that of an expression is not known.
    ///
    /// # Panics
    /// If there is no such function.
    pub fn function_unit(&self, index: usize) -> String {
        if self.composition.gives(index) {
            return self.composition.list[index - self.composition.first]
                .unit
                .clone();
        }
        match (&self.cases, &self.statics) {
            (Some(cases), _) => {
                let (case, own) = cases.places[index];
                cases.list[case].problem.function_unit(own)
            }
            (None, Some(statics)) => statics.functions[index].unit().to_owned(),
            (None, None) => self.scene(&self.start()).functions[index].unit(),
        }
    }

    /// SI units of the functions of the scene.
    fn units_of_scene(&self) -> Vec<String> {
        match &self.statics {
            Some(statics) => (statics.functions.iter())
                .map(|own| own.unit().to_owned())
                .collect(),
            None => {
                let scene = self.unlowered_scene(&self.start());
                scene
                    .functions
                    .iter()
                    .map(crate::functions::Function::unit)
                    .collect()
            }
        }
    }

    /// Structures and load cases at the design `x`, analytic in `x`.
    pub fn static_scene<S: SceneScalar>(&self, statics: &Statics, x: &[S]) -> StaticScene<S> {
        S::static_scene(self, statics, x)
    }

    /// The structures with every element cut in `cuts` along each direction.
    ///
    /// # Errors
    /// The faults of the finer meshes.
    pub fn cut_statics(&self, cuts: usize) -> Result<Statics, Vec<(String, MeshFault)>> {
        Statics::new(&self.written, &self.start_numbers(), cuts)
    }

    /// Σ ((x − x0)/scale)² of a design of a file without objective.
    pub fn distance_from_start<S: Scalar>(&self, x: &[S]) -> S {
        let start = self.nearest_to.iter().flatten();
        let terms = x.iter().zip(start).zip(&self.variables);
        terms.fold(S::zero(), |sum, ((&x, &x0), variable)| {
            let change = (x - x0) / variable.scale;
            sum + change * change
        })
    }

    /// Whether a design moves the nodes of structures.
    pub fn moves_meshes(&self) -> bool {
        let own = self.variables.iter().flat_map(|own| &own.paths);
        let mut all = own.chain(self.derived.pointers());
        all.any(|path| path.contains("/mesh/"))
    }

    /// Derivatives of the numbers of structures, except thickness and sections, in the design.
    pub fn moved(&self, statics: &Statics, x: &[f64]) -> Moved {
        let moves = |variable: &Variable| {
            let mut paths = variable.paths.iter();
            !paths.all(|path| statics::expand::is_direct(path))
        };
        let all = self.variables.iter().enumerate();
        let which: Vec<usize> = all.filter(|(_, v)| moves(v)).map(|(i, _)| i).collect();
        statics.moved(&self.written, x, &self.derived, &which)
    }

    /// Derivatives by the design variables, from those by structure and loads.
    pub fn pull_back(
        &self,
        statics: &Statics,
        moved: &Moved,
        gradient: (&Structure<f64>, &[Vec<Load<f64>>]),
    ) -> statics::PulledBack {
        let count = (self.variables.len(), self.derived.count());
        statics.pull_back(&self.written, count, moved, gradient)
    }

    /// The reduced scene at the design `x`, analytic in `x`. `x` has one component per variable, in
    /// the unit of its numbers. The scene is not reduced if the design violates a condition.
    pub fn scene<S: SceneScalar>(&self, x: &[S]) -> Scene<S> {
        self.lowered_scene(x).0
    }

    /// [`Problem::scene`], and whether the scene is reduced.
    pub fn lowered_scene<S: SceneScalar>(&self, x: &[S]) -> (Scene<S>, bool) {
        let mut scene = self.unlowered_scene(x);
        let all = self.lower(&mut scene);
        (scene, all)
    }

    /// Applies the reductions to a scene and returns true. If its design violates a condition,
    /// returns false and leaves the scene as it is.
    pub fn lower<S: SceneScalar>(&self, scene: &mut Scene<S>) -> bool {
        S::lower(self, scene)
    }

    /// The problem whose scene starts as its bodies are placed before equilibrium is sought; `None` if this one does not
    /// start in equilibrium and is not at rest.
    pub fn without_equilibrium(&self) -> Option<Self> {
        self.written.sought().map(|_| {
            let mut other = self.clone();
            other.written.start = schema::flexible::Start::Placed;
            other
        })
    }

    /// The design `x`, then the numbers that expressions give.
    fn extended<'x, S: Scalar>(&self, x: &'x [S]) -> Cow<'x, [S]> {
        self.derived.extend(self.split(x).0)
    }

    /// The design in the file, then the numbers that expressions give.
    fn start_numbers(&self) -> Vec<f64> {
        self.extended(&self.start()).into_owned()
    }

    /// The first expression without a finite value at the design `x`, in words.
    pub fn undefined_expression(&self, x: &[f64]) -> Option<String> {
        self.derived.undefined(self.split(x).0)
    }

    /// The model whose bodies are as placed.
    pub(crate) fn as_placed(&self, x: &[f64]) -> Model<f64> {
        let scene = scene::scene(&self.written, &self.order, &self.extended(x));
        let mut model = scene.model;
        if self.is_rest() {
            scene::without_spin(&self.written, &mut model);
        }
        model
    }

    /// The fastest growth \[1/s\] of a deformation at the start in equilibrium; `None` if none grows, or
    /// if there is no such start.
    pub fn growth_at_equilibrium(&self, x: &[f64]) -> Option<f64> {
        let placed = self.without_equilibrium()?;
        let model = placed.as_placed(x);
        let found = equilibrium::growth(&model, &self.written.known_starts);
        found.ok().flatten()
    }

    /// Whether a machine of bodies is at rest: its functions are values there, and nothing is integrated.
    pub fn is_rest(&self) -> bool {
        self.written.is_rest()
    }

    /// The stability of a machine at rest; `None` if it is not at rest, or does not come to it.
    pub fn stability_at_rest(&self, x: &[f64]) -> Option<Stability> {
        let placed = self.without_equilibrium().filter(|_| self.is_rest())?;
        let model = placed.as_placed(x);
        equilibrium::stability(&model, &self.written.known_starts).ok()
    }

    /// By flexible body: name, and the vibration that the start in equilibrium leaves in it as a part of its deformation
    /// (see [`equilibrium::left_out`]); `None` if there is no such start.
    pub fn unsteady_at_equilibrium(&self, x: &[f64]) -> Option<Vec<(String, f64)>> {
        let placed = self.without_equilibrium()?;
        let model = placed.as_placed(x);
        let parts = equilibrium::left_out(&model, &self.written.known_starts).ok()?;
        let names = model.flexible.iter().map(|body| body.name.clone());
        Some(names.zip(parts).collect())
    }

    /// The scene at the design `x` without reductions. Redundant rows are left out, and the parts
    /// on which no function of a [focused](Problem::focused) problem depends.
    pub fn unlowered_scene<S: SceneScalar>(&self, x: &[S]) -> Scene<S> {
        S::unlowered_scene(self, x)
    }

    /// The tolerance of the input, relative.
    pub fn input_tolerance(&self) -> f64 {
        self.written.input_tolerance()
    }

    /// By body: velocity [m/s] and angular velocity [rad/s] in ground axes, if the file gives them
    /// for this body and starts of joints may replace them.
    pub fn own_velocities(&self, x: &[f64]) -> Vec<Option<[Vec3<f64>; 2]>> {
        scene::own_velocities(&self.written, &self.extended(x))
    }

    /// Whether function f of the scene is a misfit.
    fn is_misfit(&self, f: usize) -> bool {
        let name = self.function_names.get(f);
        let own = name.and_then(|name| self.written.functions.get(name));
        matches!(own, Some(schema::functions::Function::Misfit(_)))
    }

    /// The misfits f_m and their factors c_m > 0 in f = Σ c_m f_m, if function f is such a sum.
    pub fn misfits(&self, f: usize) -> Option<Vec<(usize, f64)>> {
        let parts = self.composition.sum(f)?;
        let all = parts.iter().all(|&(g, c)| c > 0.0 && self.is_misfit(g));
        (all && !parts.is_empty()).then_some(parts)
    }

    /// Whether bodies or measured values have files of their own.
    pub fn names_files(&self) -> bool {
        let bodies = &mut self.written.bodies.values();
        bodies.any(|body| body.modal.is_some()) || measurements::names_files(&self.written)
    }

    /// Number of bodies in the file.
    pub fn body_count(&self) -> usize {
        self.written.bodies.len()
    }

    /// Number of joints in the file.
    pub fn joint_count(&self) -> usize {
        self.written.joints.len()
    }

    /// How the last motion of each coupling follows the others in an unreduced model of the problem, for messages.
    pub fn couplings(&self, model: &Model<f64>) -> Vec<String> {
        couplings::described(&self.written, model)
    }

    /// What the states of controllers cost in an unreduced model of the problem, for messages.
    pub fn controllers(&self, model: &Model<f64>) -> Vec<String> {
        controllers::described(model)
    }

    /// The flexible bodies at the design `x`: their coordinates and natural frequencies.
    pub fn flexible_bodies(&self, x: &[f64]) -> Vec<String> {
        flexible::described(&self.written, &self.extended(x))
    }

    /// The problem with richer reduced bases, made at the design `x`, and with shells that are not rigid.
    /// `None` if no body has such a basis, or parts of the scene are left out for some functions.
    pub fn with_richer_bases(&self, x: &[f64]) -> Option<Self> {
        self.with_bases(x, reduced::enrich)
    }

    /// The problem with all nodes of bodies that are reduced or rigid. `None` as of
    /// [`Self::with_richer_bases`].
    pub fn with_all_nodes(&self, x: &[f64]) -> Option<Self> {
        self.with_bases(x, reduced::keep_all_nodes)
    }

    /// The problem with all nodes of such bodies and more functions of beams. `None` as of [`Self::with_richer_bases`].
    pub fn with_finer_bodies(&self, x: &[f64]) -> Option<Self> {
        self.with_bases(x, |document| {
            let nodes = reduced::keep_all_nodes(document);
            beam::enrich(document) || nodes
        })
    }

    /// The problem with half the widths over which its loads are smooth. `None` if it has no such loads, or parts of the scene are left
    /// out for some functions.
    pub fn with_half_widths(&self) -> Option<Self> {
        if self.focus.is_some() {
            return None;
        }
        let mut written = self.written.clone();
        smoothing::halve(&mut written).then(|| read::remade(self, written))
    }

    /// The problem with bases that `change` has changed, made at the design `x`.
    fn with_bases(&self, x: &[f64], change: fn(&mut Document) -> bool) -> Option<Self> {
        if self.focus.is_some() {
            return None;
        }
        let mut written = self.written.clone();
        if !change(&mut written) {
            return None;
        }
        let bodies = written.bodies.values_mut();
        for elements in bodies.filter_map(|body| body.elements.as_mut()) {
            elements.design = Some(self.extended(x).into_owned());
        }
        Some(read::remade(self, written))
    }

    /// Bases that differ from those of `before`, as changes of the problem file, path=value.
    pub fn basis_overrides(&self, before: &Self) -> Vec<String> {
        reduced::overrides(&self.written, &before.written)
    }

    /// The axes to the right and up in pictures of structures: those of the file, else x and z.
    pub fn view_of_structures(&self) -> [[f64; 3]; 2] {
        drawing::view_or(&self.written, View::Xz)
    }

    /// The objective, if the file states it.
    pub fn stated_objective(&self) -> Option<Objective> {
        self.objective.filter(|_| self.nearest_to.is_none())
    }

    /// The data of a plot of the motion at the design `x`.
    pub fn drawing(&self, x: &[f64]) -> Drawing {
        drawing::drawing(&self.written, &self.order, &self.extended(x))
    }

    /// Stresses along fibres of the beams of each body of the file at the design `x`.
    pub fn fibres(&self, x: &[f64]) -> Vec<Vec<BeamFibres>> {
        fibres::fibres(&self.written, &self.extended(x))
    }
}
