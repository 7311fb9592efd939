//! The document of a problem file: serde structures. Their documentation becomes the JSON Schema.

pub mod cases;
pub mod combined;
pub mod contacts;
pub mod controllers;
pub mod couplings;
pub mod drives;
pub mod elements;
pub mod events;
pub mod flexible;
pub mod functions;
pub mod instants;
pub mod joints;
pub mod length_unit;
pub mod loads;
pub mod magnitudes;
pub mod measured;
pub mod mechanics;
pub mod misfit;
pub mod modal;
pub mod modes;
pub mod names;
pub mod parts;
pub mod prepared;
pub mod quantity;
pub mod section;
pub mod standard_input;
pub mod statics;
pub mod structures;
pub mod windows;

use cases::Case;
use couplings::Coupling;
use drives::Drive;
use events::Event;
use flexbody_mechanics::system::equilibrium::{KnownStarts, Sought};
use functions::{Function, Instant, WhichFunction};
use indexmap::IndexMap;
use joints::Joint;
use loads::Load;
use mechanics::{AssemblyVelocity, Body};
use modes::{ModeTable, SteadyRotation};
use parts::{Defaults, Part, Use};
use quantity::{Quantity, Vector};
use schemars::JsonSchema;
use serde::Deserialize;
use statics::{CaseLoad, Statics};
use std::sync::OnceLock;
use structures::{Material, Structure};

/// The unit of parameters in the schema.
pub const OF_PARAMETERS: &str = "that of the numbers it gives";

/// Version of the format.
pub const VERSION: u64 = 1;

/// A multibody scene in motion, or structures under load cases; what is asked of them and what may be
/// designed. Units are SI, angles are in radians; the keys of bodies, joints, loads, drives, couplings,
/// structures, materials, load cases, functions, variables and constraints are their names.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(
    title = "flexbody problem",
    extend(
        "if" = {"required": ["structures"]},
        "then" = {"required": ["materials"]},
        "else" = {
            "required": ["bodies"],
            "if": {
                "properties": {"analysis": {"const": "rest", "description": "At rest nothing is simulated."}},
                "required": ["analysis"]
            },
            "else": {
                "if": {
                    "properties": {"analysis": {"const": "modes", "description": "Modes are about rest."}},
                    "required": ["analysis"]
                },
                "else": {"required": ["simulation"]}
            }
        }
    )
)]
pub struct Document {
    /// Address of this schema, for editors.
    #[serde(rename = "$schema")]
    pub _schema: Option<String>,
    /// Version of the format: 1.
    #[schemars(extend(
        "const" = VERSION,
        "design_variable" = "the version of the format is not a physical number"
    ))]
    #[serde(rename = "version")]
    pub _version: u64,
    /// Name of the problem and of its results.
    pub name: String,
    /// Description of the problem.
    #[serde(rename = "description")]
    pub _description: Option<String>,
    /// Gravitational acceleration in ground axes, default [0, −9.81, 0].
    #[schemars(extend("unit" = "m/s²"))]
    pub gravity: Option<Vector>,
    /// How well rounded numbers fit: joints of loops may miss each other by this part of the size of
    /// their loop and by this angle \[rad\], and an inertia may miss that of a solid by this part.
    /// What is left out is said. Default 1e-5.
    #[schemars(extend(
        "minimum" = 1e-13,
        "maximum" = 1e-3,
        "design_variable" = "a tolerance is the file's, not a physical number"
    ))]
    pub input_tolerance: Option<f64>,
    /// Numbers by name that expressions use: "= L/2" stands for a number anywhere in the file. Expressions have + − * / ^,
    /// parentheses, pi, deg (a degree in radians), sin, cos, tan, asin, acos, atan, atan2, sqrt, exp, log, and these
    /// names. A parameter may be an expression of others, and a design variable.
    #[serde(default)]
    #[schemars(extend("unit" = OF_PARAMETERS))]
    pub parameters: IndexMap<String, Quantity>,
    /// Bodies by name.
    #[serde(default)]
    pub bodies: IndexMap<String, Body>,
    /// What is computed of a machine of bodies: its motion (default), where it rests under gravity and loads, or its modes
    /// about that rest. Structures are always at rest.
    pub analysis: Option<Analysis>,
    /// Which modes are told and drawn, with "analysis": "modes".
    pub modes: Option<ModeTable>,
    /// Steady rotation of the machine, with "analysis": "modes".
    pub turning: Option<SteadyRotation>,
    /// Deformations of flexible bodies at the start, default "given".
    #[serde(default)]
    pub start: flexible::Start,
    /// Known starts in equilibrium.
    #[serde(skip)]
    #[schemars(skip)]
    pub known_starts: KnownStarts,
    /// Velocity of the whole assembly at the start, default at rest.
    pub initial_velocity: Option<AssemblyVelocity>,
    /// Joints by name.
    #[serde(default)]
    pub joints: IndexMap<String, Joint>,
    /// Loads by name: forces, torques, springs, dampers and friction.
    #[serde(default)]
    pub loads: IndexMap<String, Load>,
    /// Drives by name: prescribed motions of joints.
    #[serde(default)]
    pub drives: IndexMap<String, Drive>,
    /// Couplings by name: gears, racks, screws, belts and other relations between motions of joints.
    #[serde(default)]
    pub couplings: IndexMap<String, Coupling>,
    /// Duration and accuracy of the simulation.
    pub simulation: Option<Simulation>,
    /// Events that change the machine during its motion, by name, in the order in which they come: joints, loads and drives
    /// go off or on, and the motion goes on.
    #[serde(default)]
    pub events: IndexMap<String, Event>,
    /// The part of the motion that a problem has, if events divide it: the number of events before it.
    #[serde(skip)]
    #[schemars(skip)]
    pub phase: Option<usize>,
    /// Structures of shells and beams by name, which do not move.
    #[serde(default)]
    pub structures: IndexMap<String, Structure>,
    /// Materials by name.
    #[serde(default)]
    pub materials: IndexMap<String, Material>,
    /// Load cases by name: the loads of each, by name.
    #[serde(default)]
    pub load_cases: IndexMap<String, IndexMap<String, CaseLoad>>,
    /// How structures are analysed.
    pub statics: Option<Statics>,
    /// Cases by name: analyses of this machine with some of its values replaced. Every function of the machine has a value in
    /// each, "FUNCTION in CASE"; constraints on it hold in all.
    #[serde(default)]
    pub cases: IndexMap<String, Case>,
    /// Functions of interest by name.
    #[serde(default)]
    pub functions: IndexMap<String, Function>,
    /// Design variables by name.
    #[serde(default)]
    pub variables: IndexMap<String, Variable>,
    /// The function that is minimised or maximised.
    pub objective: Option<Objective>,
    /// Constraints by name.
    #[serde(default)]
    pub constraints: IndexMap<String, Constraint>,
    /// Settings of the optimiser.
    pub optimiser: Option<Optimiser>,
    /// Settings of the plot of the motion.
    #[serde(default)]
    pub plot: Plot,
    /// Parts by name: groups of bodies, joints, loads, drives and couplings that are defined once.
    #[serde(default, rename = "parts")]
    pub _parts: IndexMap<String, Part>,
    /// Uses of parts by name. The body "thigh" of a part is "NAME/thigh" in the machine.
    #[serde(default, rename = "use")]
    pub _use: IndexMap<String, Use>,
    /// Keys that bodies and joints have unless they give their own.
    #[serde(default, rename = "defaults")]
    pub _defaults: Defaults,
}

/// What is computed of a machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Analysis {
    /// Its motion over time.
    Motion,
    /// Where it rests: without velocity and acceleration, drives and loads held as they are at t = 0.
    Rest,
    /// Its vibrations about rest, or about steady rotation: frequencies, damping ratios and shapes.
    Modes,
}

/// Default tolerance of the input.
const INPUT_TOLERANCE: f64 = 1e-5;

impl Document {
    /// Whether motions of joints are coupled, by couplings or with rotors.
    pub fn is_coupled(&self) -> bool {
        let turns = |load: &loads::Load| match load {
            loads::Load::Controller(own) => {
                (own.motor.as_ref()).is_some_and(|motor| motor.rotor_inertia.is_some())
            }
            _ => false,
        };
        !self.couplings.is_empty() || self.loads.values().any(turns)
    }

    /// The tolerance of the input, relative.
    pub fn input_tolerance(&self) -> f64 {
        self.input_tolerance.unwrap_or(INPUT_TOLERANCE)
    }

    /// Whether a machine of bodies is at rest.
    pub fn is_rest(&self) -> bool {
        matches!(self.analysis, Some(Analysis::Rest | Analysis::Modes))
            && self.structures.is_empty()
    }

    /// The modes that are told, if they are asked for.
    pub fn told_modes(&self) -> Option<ModeTable> {
        (self.analysis == Some(Analysis::Modes) && self.structures.is_empty())
            .then(|| self.modes.clone().unwrap_or_default())
    }

    /// What is sought before the functions are evaluated or the motion begins, if anything.
    pub fn sought(&self) -> Option<Sought> {
        match (self.start, self.is_rest()) {
            (flexible::Start::Placed, _) | (flexible::Start::Given, false) => None,
            (_, true) => Some(Sought::Rest),
            (flexible::Start::Equilibrium, false) => Some(Sought::Start),
        }
    }
}

/// Duration and accuracy of the simulation.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Simulation {
    /// Simulated time; with `until`, the longest time to wait for the event.
    #[schemars(extend("unit" = "s", "exclusiveMinimum" = 0))]
    pub duration: Quantity,
    /// Event that ends the run: a quantity reaches a value for the first time. Default none.
    pub until: Option<TerminalEvent>,
    /// Number of equal time steps, instead of a tolerance.
    #[schemars(extend(
        "minimum" = 1,
        "maximum" = 10_000_000,
        "design_variable" = "a number of steps is a count, not a physical number"
    ))]
    pub steps: Option<usize>,
    /// Tolerance of the error per step, relative to the lengths and speeds of the scene. Default
    /// 1e-9 if the number of steps is not given, 1e-6 with elastic bodies, 1e-5 with finite elements
    /// of all nodes.
    #[schemars(extend(
        "minimum" = 1e-14,
        "maximum" = 0.1,
        "design_variable" = "a tolerance is the method's, not a physical number"
    ))]
    pub tolerance: Option<f64>,
    /// Number of equal intervals at whose ends the motion is sampled, for functions of the whole
    /// motion and for figures. Default: the ends of the steps if their number is given, else 1000.
    #[schemars(extend(
        "minimum" = 1,
        "maximum" = 10_000_000,
        "design_variable" = "a number of samples is a count, not a physical number"
    ))]
    pub samples: Option<usize>,
    /// Longest wall time of one simulation \[s\], default none. The number of steps is limited, too.
    #[schemars(extend(
        "exclusiveMinimum" = 0,
        "design_variable" = "a limit of the run is the computer's, not a physical number"
    ))]
    pub seconds: Option<f64>,
    /// Integration method. Default: chosen for the scene, dop853 unless it is stiff, else radau.
    pub method: Option<Method>,
    /// How the linear systems of bodies of finite elements are solved, default direct.
    pub linear_solver: Option<LinearSolver>,
}

impl Simulation {
    /// That of a machine at rest: no step. Nothing depends on its duration.
    fn of_rest() -> Self {
        Self {
            duration: Quantity::fixed(1.0),
            until: None,
            steps: Some(0),
            tolerance: None,
            samples: None,
            seconds: None,
            method: Some(Method::Dop853),
            linear_solver: None,
        }
    }

    /// Whether it is that of a machine at rest.
    pub fn is_of_rest(&self) -> bool {
        self.steps == Some(0)
    }
}

/// How linear systems are solved.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum LinearSolver {
    /// By factors, which are kept from step to step while they converge.
    Direct,
    /// By FGMRES, a Krylov method, with kept factors as preconditioner, for bdf and generalised_alpha.
    Krylov,
}

/// An event that ends the run.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TerminalEvent {
    /// The quantity.
    pub measure: Instant,
    /// The value that it reaches.
    #[schemars(extend("unit" = "that of the quantity"))]
    pub reaches: Quantity,
}

/// An integration method.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Method {
    /// Explicit Runge-Kutta method of order 8 with projection onto the joints, for scenes that are
    /// not stiff.
    Dop853,
    /// Implicit Runge-Kutta method Radau IIA, for stiff scenes.
    Radau {
        /// Number of stages: 2 (order 3) or 3 (order 5).
        #[schemars(extend(
            "minimum" = 2,
            "maximum" = 3,
            "design_variable" = "a number of stages is a count, not a physical number"
        ))]
        stages: usize,
    },
    /// Backward differentiation formula.
    Bdf {
        /// Order, 1 to 6.
        #[schemars(extend(
            "minimum" = 1,
            "maximum" = 6,
            "design_variable" = "an order is a count, not a physical number"
        ))]
        order: usize,
        /// Method of the first steps, default radau.
        start: Option<Start>,
    },
    /// Generalised-alpha method.
    GeneralisedAlpha {
        /// Spectral radius at infinite frequency.
        #[schemars(extend(
            "minimum" = 0.5,
            "maximum" = 0.9,
            "design_variable" = "a spectral radius is the method's, not a physical number"
        ))]
        radius: f64,
    },
}

/// Method of the first steps of a multistep formula.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Start {
    /// Radau IIA, which keeps the order.
    Radau,
    /// Formulas of rising order, which limit the order to 2.
    RisingOrder,
}

/// A design variable: one or several physical numbers of this file that share a value. It starts at
/// the value in the file.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Variable {
    /// Remark for readers of the file.
    #[serde(rename = "description")]
    pub _description: Option<String>,
    /// JSON Pointer to the number, such as /bodies/arm/mass; or to a list, each number of which becomes a variable
    /// `name[0]`, `name[1]`, … with these bounds.
    pub path: Option<String>,
    /// JSON Pointers to several numbers with one value, instead of `path`.
    pub paths: Option<Vec<String>>,
    /// Smallest value, in the number's own unit; default none.
    #[schemars(extend("design_variable" = "a bound limits the design, it is no part of it"))]
    pub lower: Option<f64>,
    /// Largest value, in the number's own unit; default none.
    #[schemars(extend("design_variable" = "a bound limits the design, it is no part of it"))]
    pub upper: Option<f64>,
    /// Typical change, by which the optimiser scales the variable. Default: half the distance of
    /// the bounds, but at most 1000 max(|start|, 1); without bounds |start|, or 1 if that is zero.
    #[schemars(extend(
        "exclusiveMinimum" = 0,
        "design_variable" = "a scale is the optimiser's, not a physical number"
    ))]
    pub scale: Option<f64>,
}

/// The function that is optimised.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Objective {
    /// The function to minimise: its name, or an expression.
    Minimise(WhichFunction),
    /// The function to maximise: its name, or an expression.
    Maximise(WhichFunction),
}

/// Bounds on a function. Equal bounds make an equality.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Constraint {
    /// Remark for readers of the file.
    #[serde(rename = "description")]
    pub _description: Option<String>,
    /// The function: its name, or an expression.
    pub function: WhichFunction,
    /// Smallest value, default none.
    #[schemars(extend("design_variable" = "a bound limits the design, it is no part of it"))]
    pub lower: Option<f64>,
    /// Largest value, default none.
    #[schemars(extend("design_variable" = "a bound limits the design, it is no part of it"))]
    pub upper: Option<f64>,
}

/// An optimisation algorithm.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum OptimisationMethod {
    /// Primal-dual interior point with a filter line search.
    InteriorPoint,
    /// Trust-region sequential quadratic programming: fewest simulations for few variables.
    TrustRegion,
    /// Trust region on the residuals of a misfit, by Gauss and Newton. It is the default where the objective is a misfit.
    LeastSquares,
    /// Interior point; if it does not converge, trust region from its best point.
    Auto,
}

/// Settings of the optimiser.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Optimiser {
    /// Algorithm, default interior point; least squares where the objective is a misfit to minimise.
    pub method: Option<OptimisationMethod>,
    /// The optimiser stops at this scaled residual of the optimality conditions.
    #[schemars(extend(
        "exclusiveMinimum" = 0,
        "design_variable" = "a tolerance is the optimiser's, not a physical number"
    ))]
    pub tolerance: Option<f64>,
    /// Largest number of iterations.
    #[schemars(extend(
        "minimum" = 1,
        "design_variable" = "a number of iterations is a count, not a physical number"
    ))]
    pub iterations: Option<usize>,
    /// Largest violation of a constraint at an optimum, in its own unit; it must also be below 1e-4
    /// of the size of the constraint. Default 1e-6.
    #[schemars(extend(
        "exclusiveMinimum" = 0,
        "design_variable" = "a tolerance is the optimiser's, not a physical number"
    ))]
    pub constraint_tolerance: Option<f64>,
    /// Largest number of simulations.
    #[schemars(extend(
        "minimum" = 1,
        "design_variable" = "a number of simulations is a count, not a physical number"
    ))]
    pub evaluations: Option<usize>,
    /// Longest wall time of the run \[s\].
    #[schemars(extend(
        "exclusiveMinimum" = 0,
        "design_variable" = "a limit of the run is the optimiser's, not a physical number"
    ))]
    pub seconds: Option<f64>,
    /// The problem is unbounded if the minimised objective falls below this negative value. A
    /// maximised objective is compared by its negative. Default -1e20.
    #[schemars(extend(
        "exclusiveMaximum" = 0,
        "design_variable" = "a limit of the run is the optimiser's, not a physical number"
    ))]
    pub unbounded_below: Option<f64>,
}

/// Settings of the plot of the motion.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Plot {
    /// Plane of the view: first axis to the right, second up; default xy.
    pub view: Option<View>,
    /// Number of instants of the time lapse, default 12.
    #[schemars(extend(
        "minimum" = 2,
        "design_variable" = "a number of pictures is a count, not a physical number"
    ))]
    pub snapshots: Option<usize>,
    /// Points whose paths are drawn: `"body.point"`, or `"body"` for the origin of its axes.
    #[serde(default)]
    pub trace: Vec<String>,
}

/// Plane of the view: first axis to the right, second up.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum View {
    /// x to the right, y up.
    #[default]
    Xy,
    /// x to the right, z up.
    Xz,
    /// y to the right, z up.
    Yz,
    /// y to the right, x up.
    Yx,
    /// z to the right, x up.
    Zx,
    /// z to the right, y up.
    Zy,
}

/// Reads a document from its JSON.
///
/// # Errors
/// The keys and indices that lead to the fault, and what is wrong there.
pub fn read(json: &serde_json::Value) -> Result<Document, (Vec<String>, String)> {
    let read: Result<Document, _> = serde_path_to_error::deserialize(json);
    let mut document = read.map_err(|error| {
        let path = error.path().iter().map(ToString::to_string).collect();
        (path, error.inner().to_string())
    })?;
    if document.is_rest() && document.simulation.is_none() {
        document.simulation = Some(Simulation::of_rest());
    }
    Ok(document)
}

/// The JSON Schema of a problem file: `unit` is a number's unit. `design_variable` is true where a
/// design variable may point, or states why it may not.
pub fn schema() -> &'static serde_json::Value {
    static SCHEMA: OnceLock<serde_json::Value> = OnceLock::new();
    SCHEMA.get_or_init(|| {
        let mut schema = schemars::schema_for!(Document).to_value();
        tidy(&mut schema);
        schema
    })
}

/// [`schema`] for editors: every number may be an expression, a text that begins with "=".
pub fn schema_with_expressions() -> serde_json::Value {
    let mut schema = schema().clone();
    admit_expressions(&mut schema);
    schema
}

fn admit_expressions(schema: &mut serde_json::Value) {
    use serde_json::{Value, json};
    match schema {
        Value::Array(items) => items.iter_mut().for_each(admit_expressions),
        Value::Object(object) => {
            let kind = object.get("type").and_then(Value::as_str);
            if let (Some(kind @ ("number" | "integer")), false) =
                (kind, object.contains_key("const"))
            {
                let kinds = json!([kind, "string"]);
                object.insert("type".into(), kinds);
                object.insert("pattern".into(), json!("^="));
            }
            object.values_mut().for_each(admit_expressions);
        }
        _ => {}
    }
}

/// Removes `null` (an unused key is omitted) and line breaks in descriptions, and moves units and
/// limits of arrays and maps to their numbers.
fn tidy(schema: &mut serde_json::Value) {
    use serde_json::Value;
    match schema {
        Value::Array(items) => items.iter_mut().for_each(tidy),
        Value::Object(object) => {
            if let Some(Value::Array(types)) = object.get("type")
                && let Some(only) = types.iter().find(|t| *t != "null").cloned()
            {
                object.insert("type".into(), only);
            }
            if let Some(Value::Array(choices)) = object.get("anyOf")
                && choices.iter().any(|c| c["type"] == "null")
                && let Some(Value::Object(only)) =
                    choices.iter().find(|c| c["type"] != "null").cloned()
            {
                object.shift_remove("anyOf");
                object.extend(only);
            }
            if object.get("default").is_some_and(Value::is_null) {
                object.shift_remove("default");
            }
            for inner in ["items", "additionalProperties"] {
                if !object.get(inner).is_some_and(Value::is_object) {
                    continue;
                }
                for key in ["unit", "exclusiveMinimum", "minimum", "design_variable"] {
                    if let Some(value) = object.shift_remove(key) {
                        object[inner][key] = value;
                    }
                }
            }
            if let Some(Value::String(text)) = object.get_mut("description") {
                *text = text.replace('\n', " ");
            }
            object.values_mut().for_each(tidy);
        }
        _ => {}
    }
}
