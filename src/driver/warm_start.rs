//! A start from the end of another optimisation.

use super::integration::{Integration, KeptSteps};
use super::known_evaluations::{kept, steps_of};
use crate::optimiser::{Outcome, SavedState};
use crate::problem::{Problem, Sense};
use crate::report::evaluations::StepsInUse;
use serde::{Deserialize, Serialize};

/// Relative difference of a design after scaling and unscaling.
const ROUND_OFF: f64 = 4.0 * f64::EPSILON;

/// The optimiser's state at the end of a run, and the problem that it belongs to: `state.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WarmStart {
    /// Names and scales of the variables.
    variables: Vec<(String, f64)>,
    /// Names of the constraints.
    constraints: Vec<String>,
    /// Name of the function that is the objective, and whether it is maximised.
    #[serde(default)]
    objective: Option<(String, bool)>,
    /// Point, multipliers, quasi-Newton matrix and barrier parameter.
    pub state: SavedState,
    /// The steps in use at the end, by tolerance; older versions wrote none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    steps: Option<StepsInUse>,
    /// Whether the scene was integrated as written, without reductions.
    #[serde(default)]
    pub as_written: bool,
}

impl WarmStart {
    /// The state at the end of a run.
    pub fn of(problem: &Problem, outcome: &Outcome, integration: &Integration) -> Option<Self> {
        let steps = integration.in_use("at the end");
        let steps = steps.filter(|own| own.grid.is_some() || !own.cases.is_empty());
        let steps = steps.map(steps_of);
        Some(Self {
            steps,
            as_written: !problem.is_lowered(),
            variables: variables(problem),
            constraints: constraints(problem),
            objective: objective(problem),
            state: outcome.state.clone()?,
        })
    }

    /// The steps in use at the end, if they followed a tolerance.
    pub fn kept_steps(&self) -> Option<KeptSteps> {
        kept(self.steps.as_ref()?, 0)
    }

    /// Whether the state belongs to `design`, in the units of the problem file: equal up to the
    /// round-off of the scales.
    pub fn is_at(&self, design: &[f64]) -> bool {
        let point = self.variables.iter().zip(&self.state.x);
        let same = |((_, scale), x): (&(String, f64), &f64), d: &f64| {
            (scale * x - d).abs() <= ROUND_OFF * d.abs()
        };
        design.len() == self.state.x.len() && point.zip(design).all(|(p, d)| same(p, d))
    }

    /// Whether the state fits `problem`: same variables, scales, constraints and objective, and no
    /// damage.
    pub fn fits(&self, problem: &Problem) -> bool {
        let (n, m) = (self.variables.len(), self.constraints.len());
        self.variables == variables(problem)
            && self.constraints == constraints(problem)
            && self.objective == objective(problem)
            && self.state.fault(n, m).is_none()
    }
}

fn variables(problem: &Problem) -> Vec<(String, f64)> {
    let variables = problem.variables.iter();
    variables.map(|v| (v.name.clone(), v.scale)).collect()
}

fn constraints(problem: &Problem) -> Vec<String> {
    problem.constraints.iter().map(|c| c.name.clone()).collect()
}

fn objective(problem: &Problem) -> Option<(String, bool)> {
    let objective = problem.objective?;
    let name = problem.function_names[objective.function].clone();
    Some((name, objective.sense == Sense::Maximise))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn problem(objective: &str) -> Problem {
        let text = format!(
            r#"{{
                "version": 1, "name": "pendulum",
                "bodies": {{"bar": {{"shape": {{"box": {{"size": [1, 0.1, 0.1]}}}}, "mass": 1,
                    "points": {{"end": [-0.5, 0, 0]}}, "place": {{"put": "end", "at": [0, 0, 0]}}}}}},
                "joints": {{"hinge": {{"revolute": {{"between": ["bar", "ground"], "at": [0, 0, 0],
                    "axis": [0, 0, 1]}}}}}},
                "simulation": {{"duration": 0.5, "steps": 100}},
                "functions": {{
                    "height": {{"final": {{"position": {{"body": "bar", "direction": [0, 1, 0]}}}}}},
                    "reach": {{"final": {{"position": {{"body": "bar", "direction": [1, 0, 0]}}}}}}}},
                "variables": {{"gravity": {{"path": "/gravity/1", "lower": -20, "upper": -1}}}},
                "gravity": [0, -9.81, 0],
                "objective": {objective}
            }}"#
        );
        Problem::parse(&text, "pendulum.json", &[]).expect("no faults")
    }

    fn state() -> SavedState {
        let state = serde_json::json!({
            "x": [0.5],
            "objective": 1.0,
            "multipliers": {"constraints": [], "lower_bounds": [0.0], "upper_bounds": [0.0]},
            "scaling": {
                "objective": 1.0, "constraints": [], "variables": [1.0], "objective_gradient": 1.0,
                "typical_gradient": 1.0, "constraint_gradients": [], "zero_rows": [],
                "zero_columns": []
            },
            "quasi_newton": {
                "n": 1, "dense": true, "memory": 200, "sigma": 1.0,
                "pairs": [{"s": [1.0], "y": [2.0]}], "skipped": 0
            },
            "barrier": 0.1,
            "radius": 1.0
        });
        serde_json::from_value(state).expect("a state")
    }

    #[test]
    fn a_state_fits_its_own_objective_alone() {
        let lowest = problem(r#"{"minimise": "height"}"#);
        let warm = WarmStart {
            variables: variables(&lowest),
            constraints: constraints(&lowest),
            objective: objective(&lowest),
            state: state(),
            steps: None,
            as_written: false,
        };
        assert!(warm.fits(&lowest));
        let x = 0.5 * lowest.variables[0].scale;
        assert!(warm.is_at(&[x]) && warm.is_at(&[x * (1.0 + f64::EPSILON)]));
        assert!(!warm.is_at(&[x * (1.0 + 1e-14)]) && !warm.is_at(&[x, x]));
        assert!(!warm.fits(&problem(r#"{"maximise": "height"}"#)));
        assert!(!warm.fits(&problem(r#"{"minimise": "reach"}"#)));
        let mut damaged = warm.clone();
        damaged.state.barrier = f64::NAN;
        assert!(!damaged.fits(&lowest));
        let mut damaged = warm;
        damaged.state.multipliers.lower_bounds.clear();
        assert!(!damaged.fits(&lowest));
    }
}
