//! The state from which a later run continues.

use serde::{Deserialize, Serialize};

use crate::constants::SMALL_PART;
use crate::linear::quasi_newton::QuasiNewton;

/// Lagrange multipliers in the units of the user.
///
/// They satisfy ∇f + (∂c/∂x)ᵀ y − z_L + z_U = 0 with z_L, z_U ≥ 0. Hence moving the active bound
/// of constraint j up by one unit changes the least objective by −y_j, moving an active lower
/// bound of variable i by z_Li, and moving an active upper one by −z_Ui.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Multipliers {
    /// y, one per constraint row: positive where the upper bound is active, negative where the
    /// lower one is.
    pub constraints: Vec<f64>,
    /// z_L, one per variable.
    pub lower_bounds: Vec<f64>,
    /// z_U, one per variable.
    pub upper_bounds: Vec<f64>,
}

/// Scale factors, those of the constraints as chosen at the start, and suspicious derivatives
/// there.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Scaling {
    /// Factor of the objective.
    pub objective: f64,
    /// Factor of each constraint row.
    pub constraints: Vec<f64>,
    /// Length of one scaled unit of each variable, in the units of the user.
    pub variables: Vec<f64>,
    /// Norm ‖∇f‖∞ at the start, in the units of the user.
    pub objective_gradient: f64,
    /// Typical ‖∇f‖∞ of the run, in the units of the user: the third largest, or the median of fewer
    /// than five.
    #[serde(default)]
    pub typical_gradient: f64,
    /// Norm ‖∇c_j‖∞ of each row at the start, in the units of the user.
    pub constraint_gradients: Vec<f64>,
    /// Constraints whose gradient is zero at the start, by name.
    pub zero_rows: Vec<String>,
    /// Variables on which neither objective nor constraints depend at the start, by name.
    pub zero_columns: Vec<String>,
}

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
    pub(crate) fn is_of(&self, objective: f64) -> bool {
        (objective - self.objective).abs() <= SMALL_PART * objective.abs().max(self.objective.abs())
    }
}
