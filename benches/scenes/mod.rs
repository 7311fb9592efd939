//! The scenes that are measured, with the reference trajectories that they are judged by.
#![allow(dead_code)] // each bench uses a part

#[path = "../../tests/reference/mod.rs"]
pub mod reference;

use flexbody::functions::{Bound, EnergyPart, Function, Instant, Reduction, Scene};
use flexbody::integrate::{MEMORY, Method, Samples, Settings, Spacing, Trajectory, simulate};
use flexbody::math::Vec3;
use flexbody::problem::Problem;
use serde_json::json;
use std::fmt;

/// Names of the scenes, of their reference files and, but for the chain, of problem files.
pub const NAMES: [&str; 3] = ["triple_pendulum", "trebuchet", "chain_16"];

/// A scene with a step, and the position error that the step makes.
pub struct Case {
    pub name: &'static str,
    pub scene: Scene<f64>,
    pub settings: Settings,
    /// Largest distance of a centre of mass from the reference [m].
    pub error: f64,
}

impl Case {
    /// The scene `name` with BDF2 and steps of `h` [s].
    pub fn new(name: &'static str, h: f64) -> Self {
        let (_, instants) = reference::load(name);
        let duration = instants.last().expect("a reference has instants").time;
        let steps = (duration / h).round() as usize;
        Self::with(name, Settings::steps(reference::rising(2), steps))
    }

    /// The scene `name` with the explicit method and steps that follow a tolerance, as an
    /// optimisation keeps them.
    pub fn explicit(name: &'static str, tolerance: f64) -> Self {
        let (model, instants) = reference::load(name);
        let duration = instants.last().expect("a reference has instants").time;
        let mut settings = Settings {
            method: Method::Dop853,
            spacing: Spacing::Tolerance(tolerance),
            samples: Samples::Uniform(1),
            limits: Default::default(),
            memory: MEMORY,
        };
        let run = simulate(&model, duration, &settings).expect("the scene runs");
        settings.spacing = Spacing::Frozen(run.grid);
        Self::with(name, settings)
    }

    fn with(name: &'static str, settings: Settings) -> Self {
        let (model, instants) = reference::load(name);
        let duration = instants.last().expect("a reference has instants").time;
        let last = model.bodies.len() - 1;
        let reduced = |instant, reduction| Function::Reduced { instant, reduction };
        let (body, point) = (last, Vec3::zeros());
        let functions = vec![
            reduced(
                Instant::Speed { body, point },
                Reduction::Ks {
                    rho: 0.1,
                    bound: Bound::Below,
                },
            ),
            reduced(
                Instant::Position {
                    body,
                    point,
                    direction: Vec3::y(),
                },
                Reduction::Final,
            ),
            reduced(Instant::Energy(EnergyPart::Kinetic), Reduction::Integral),
        ];
        let mut case = Self {
            name,
            scene: Scene {
                model,
                duration,
                until: None,
                functions,
                unstarted: None,
            },
            settings,
            error: f64::NAN,
        };
        case.error = reference::motion_error(&case.simulate(), &instants).0;
        case
    }

    /// One simulation.
    pub fn simulate(&self) -> Trajectory<f64> {
        simulate(&self.scene.model, self.scene.duration, &self.settings).expect("the scene runs")
    }
}

impl fmt::Display for Case {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { name, error, .. } = self;
        let steps = self.simulate().grid.steps();
        let method = self.settings.method.name();
        write!(f, "{name}, {method}, {steps} steps: {error:.1e} m")
    }
}

/// `problems/trebuchet.json` with a third function beside its two, and the error of its motion.
pub fn trebuchet_problem() -> (Problem, f64) {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/problems/trebuchet.json");
    let text = std::fs::read_to_string(file).expect("the problem file");
    let mut document: serde_json::Value = serde_json::from_str(&text).expect("valid JSON");
    document["functions"]["top speed"] =
        json!({"ks": {"rho": 0.1, "of": {"speed": {"body": "stone"}}}});
    let problem = Problem::parse(&document.to_string(), "trebuchet.json", &[]).expect("no faults");
    let scene = problem.scene(&problem.start());
    let simulation = &problem.simulation;
    let settings = Settings {
        method: simulation.method.unwrap_or(Method::Dop853),
        spacing: simulation.spacing.clone(),
        samples: Samples::Uniform(200),
        limits: Default::default(),
        memory: 0,
    };
    let run = simulate(&scene.model, scene.duration, &settings).expect("the scene runs");
    let (_, instants) = reference::load("trebuchet");
    let error = reference::motion_error(&run, &instants).0;
    (problem, error)
}
