//! A start from where another optimisation ended.

use crate::optimiser::{Outcome, SavedState};
use crate::problem::{Problem, Sense};
use serde::{Deserialize, Serialize};

/// The optimiser's state at the end of a run, and what it belongs to: `state.json`.
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
}

impl WarmStart {
    /// What the end of a run leaves to another one.
    pub fn of(problem: &Problem, outcome: &Outcome) -> Option<Self> {
        Some(Self {
            variables: variables(problem),
            constraints: constraints(problem),
            objective: objective(problem),
            state: outcome.state.clone()?,
        })
    }

    /// Whether the state can be used for `problem`: same variables, scales, constraints and objective,
    /// and undamaged.
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
