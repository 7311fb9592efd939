//! A start from where another optimisation ended.

use crate::optimiser::{Outcome, SavedState};
use crate::problem::Problem;
use serde::{Deserialize, Serialize};

/// The optimiser's state at the end of a run, and what it belongs to: `state.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WarmStart {
    /// Names and scales of the variables.
    variables: Vec<(String, f64)>,
    /// Names of the constraints.
    constraints: Vec<String>,
    /// Point, multipliers, quasi-Newton matrix and barrier parameter.
    pub state: SavedState,
}

impl WarmStart {
    /// What the end of a run leaves to another one.
    pub fn of(problem: &Problem, outcome: &Outcome) -> Option<Self> {
        Some(Self {
            variables: variables(problem),
            constraints: constraints(problem),
            state: outcome.state.clone()?,
        })
    }

    /// Whether the state can be used for `problem`: same variables, scales and constraints, and
    /// undamaged.
    pub fn fits(&self, problem: &Problem) -> bool {
        self.variables == variables(problem)
            && self.constraints == constraints(problem)
            && self.is_sound()
    }

    /// Whether lengths agree, and what has to be positive is.
    fn is_sound(&self) -> bool {
        let (n, m) = (self.variables.len(), self.constraints.len());
        let SavedState {
            x,
            multipliers,
            scaling,
            barrier,
            radius,
            ..
        } = &self.state;
        let lengths = [
            (x.len(), n),
            (multipliers.lower_bounds.len(), n),
            (multipliers.upper_bounds.len(), n),
            (scaling.variables.len(), n),
            (multipliers.constraints.len(), m),
            (scaling.constraints.len(), m),
        ];
        let scales = scaling.constraints.iter().chain(&scaling.variables);
        let positive = |x: &f64| x.is_finite() && *x > 0.0;
        lengths.iter().all(|(found, expected)| found == expected)
            && scales
                .chain([barrier, radius, &scaling.objective])
                .all(positive)
    }
}

fn variables(problem: &Problem) -> Vec<(String, f64)> {
    let variables = problem.variables.iter();
    variables.map(|v| (v.name.clone(), v.scale)).collect()
}

fn constraints(problem: &Problem) -> Vec<String> {
    problem.constraints.iter().map(|c| c.name.clone()).collect()
}
