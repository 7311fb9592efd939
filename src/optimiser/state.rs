//! The state from which a later run continues.

use serde::{Deserialize, Serialize};

use super::outcome::{Multipliers, Scaling};
use super::quasi_newton::QuasiNewton;

/// Two values of one objective at almost the same point differ by less than this, relatively.
const SAME: f64 = 1e-6;

/// State of the solver, in a form that can be stored.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SavedState {
    /// Point, in the units of the user.
    pub x: Vec<f64>,
    /// Objective there. If a program has another value, the state belongs to another objective.
    #[serde(default)]
    pub objective: f64,
    /// Multipliers, in the units of the user.
    pub multipliers: Multipliers,
    /// Scale factors that belong to the quasi-Newton matrix.
    pub scaling: Scaling,
    /// Quasi-Newton matrix in scaled variables without the fixed ones.
    pub quasi_newton: QuasiNewton,
    /// Barrier parameter.
    pub barrier: f64,
    /// Radius of the trust region.
    pub radius: f64,
}

impl SavedState {
    /// The fault of the state for a program of `variables` variables and `constraints` rows, by
    /// name: lengths that disagree or numbers out of range. `None` if there is none.
    #[must_use]
    pub fn fault(&self, variables: usize, constraints: usize) -> Option<String> {
        let (z, scaling) = (&self.multipliers, &self.scaling);
        let lists: [(&str, &[f64], usize); 6] = [
            ("the point", &self.x, variables),
            (
                "the multipliers of lower bounds",
                &z.lower_bounds,
                variables,
            ),
            (
                "the multipliers of upper bounds",
                &z.upper_bounds,
                variables,
            ),
            ("the multipliers of rows", &z.constraints, constraints),
            ("the scales of variables", &scaling.variables, variables),
            ("the scales of rows", &scaling.constraints, constraints),
        ];
        for (name, list, expected) in lists {
            if list.len() != expected {
                let found = list.len();
                return Some(format!("{name} have {found} entries instead of {expected}"));
            }
            if let Some(value) = list.iter().find(|v| !v.is_finite()) {
                return Some(format!("{name} contain {value}"));
            }
        }
        let scales = scaling.variables.iter().chain(&scaling.constraints);
        if let Some(value) = scales.copied().find(|v| *v <= 0.0) {
            return Some(format!("a scale is {value}"));
        }
        let positive = [
            ("the scale of the objective", scaling.objective),
            ("the barrier parameter", self.barrier),
            ("the radius of the trust region", self.radius),
        ];
        if let Some((name, value)) = positive.iter().find(|(_, v)| !(v.is_finite() && *v > 0.0)) {
            return Some(format!("{name} is {value}"));
        }
        if !self.objective.is_finite() {
            return Some(format!("the objective is {}", self.objective));
        }
        self.quasi_newton.fault(variables)
    }

    /// Whether `objective`, the value at this state's point, agrees with the stored one.
    pub(super) fn is_of(&self, objective: f64) -> bool {
        (objective - self.objective).abs() <= SAME * objective.abs().max(self.objective.abs())
    }
}
