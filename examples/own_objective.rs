//! Minimises an objective of its own over a simulated machine: exact gradients of the functions of a problem, and the
//! chain rule. `cargo run --release --example own_objective`.

use flexbody::optimiser::{
    Evaluation, EvaluationFailure, Gradients, Jacobian, Nlp, Options, Silent, Status, solve,
};
use flexbody::{Analysis, Design, Problem};
use std::error::Error;

/// A bar swings down from its hinge.
const SWING: &str = r#"{
    "version": 1, "name": "swing",
    "bodies": {"bar": {
        "shape": {"rod": {"length": 1}}, "mass": 2,
        "points": {"pin": [-0.4, 0, 0]}, "place": {"put": "pin", "at": [0, 0, 0]}
    }},
    "joints": {"hinge": {"revolute": {"between": ["bar", "ground"], "at": "bar.pin", "axis": [0, 0, 1]}}},
    "simulation": {"duration": 0.4},
    "functions": {
        "swept angle": {"final": {"angle": {"joint": "hinge"}}},
        "mass": "mass"
    },
    "variables": {
        "pin": {"path": "/bodies/bar/points/pin/0", "lower": -0.5, "upper": -0.1},
        "mass": {"path": "/bodies/bar/mass", "lower": 1, "upper": 3}
    }
}"#;

/// The angle that is asked for \[rad\].
const ANGLE: f64 = -1.25;

/// Minimise (φ − ANGLE)² + 0.01 m² of the swept angle φ and the mass m.
struct Own {
    analysis: Analysis,
    start: Vec<f64>,
    /// The design of the last evaluation, so that its gradients need no second simulation.
    last: Option<(Vec<f64>, Design)>,
}

impl Own {
    fn at(&mut self, x: &[f64]) -> Result<&Design, EvaluationFailure> {
        if self.last.as_ref().is_none_or(|(of, _)| of != x) {
            let failed = |error: flexbody::SimulationError| EvaluationFailure {
                what: "the swing".into(),
                reason: error.to_string(),
            };
            let design = self.analysis.at(x).map_err(failed)?;
            self.last = Some((x.to_vec(), design));
        }
        Ok(&self.last.as_ref().expect("it was made").1)
    }
}

impl Nlp for Own {
    fn variables(&self) -> usize {
        2
    }

    fn constraints(&self) -> usize {
        0
    }

    fn variable_bounds(&self) -> (Vec<f64>, Vec<f64>) {
        (vec![-0.5, 1.0], vec![-0.1, 3.0])
    }

    fn constraint_bounds(&self) -> (Vec<f64>, Vec<f64>) {
        (Vec::new(), Vec::new())
    }

    fn start(&self) -> Vec<f64> {
        self.start.clone()
    }

    fn evaluate(&mut self, x: &[f64]) -> Result<Evaluation, EvaluationFailure> {
        let values = self.at(x)?.values();
        Ok(Evaluation {
            objective: (values[0] - ANGLE).powi(2) + 0.01 * values[1].powi(2),
            constraints: Vec::new(),
        })
    }

    fn gradients(&mut self, x: &[f64]) -> Result<Gradients, EvaluationFailure> {
        let design = self.at(x)?;
        let values = design.values();
        let by = design
            .gradients(&[0, 1])
            .map_err(|error| EvaluationFailure {
                what: "the gradients".into(),
                reason: error.to_string(),
            })?;
        // Chain rule: ∂f/∂φ dφ/dx + ∂f/∂m dm/dx.
        let weights = [2.0 * (values[0] - ANGLE), 0.02 * values[1]];
        let objective = (0..2).map(|i| weights[0] * by[0][i] + weights[1] * by[1][i]);
        Ok(Gradients {
            objective: objective.collect(),
            jacobian: Jacobian::dense(0, 2, Vec::new()),
        })
    }
}

/// Runs the example.
pub fn main() -> Result<(), Box<dyn Error>> {
    let problem = Problem::parse(SWING, "swing.json", &[])?;
    let mut own = Own {
        analysis: Analysis::new(&problem),
        start: problem.start(),
        last: None,
    };
    let found = solve(&mut own, &Options::default(), &mut Silent);
    println!(
        "{:?} at {:?}: f = {:.8}",
        found.status, found.x, found.objective
    );
    assert_eq!(found.status, Status::Converged);
    // The lightest bar, and a hinge from which it sweeps the angle.
    assert!((found.objective - 0.01).abs() < 1e-6);
    Ok(())
}
