//! What a run found.

use serde::{Deserialize, Serialize};

use crate::options::Method;
use crate::state::{Multipliers, SavedState, Scaling};
use crate::status::Status;

/// Residuals of the Karush–Kuhn–Tucker conditions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Kkt {
    /// Largest violation of a constraint row or bound, in the units of the user.
    pub violation: f64,
    /// Largest |∇f + Jᵀy − z_L + z_U|, in the units of the user.
    pub stationarity: f64,
    /// `stationarity` divided by ‖∇f‖∞ or, if that vanishes, by a tenth of its typical size in the
    /// run ([`Scaling::typical_gradient`]). It is never divided by multipliers.
    pub relative_stationarity: f64,
    /// Sum of the products of multipliers and distances to their bounds, on either side, in units
    /// of the objective. To first order, the distance of the objective from its least value.
    pub complementarity: f64,
    /// `complementarity` divided by |f| or, if that vanishes, by a hundredth of the typical ‖∇f‖∞
    /// (a change of a variable by one).
    pub relative_complementarity: f64,
    /// Largest residual in the scaled units in which the iteration runs.
    pub scaled: f64,
}

/// Work done.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Counts {
    /// Iterations of either method.
    pub iterations: usize,
    /// Evaluations of the functions.
    pub evaluations: usize,
    /// Evaluations of the gradients.
    pub gradients: usize,
    /// Evaluations, of functions or gradients, that failed or were not finite.
    pub failures: usize,
    /// Quadratic programs solved.
    pub quadratic_programs: usize,
    /// Wall time spent in the quadratic programs \[s\].
    pub quadratic_program_seconds: f64,
    /// Wall time spent in evaluating functions and gradients \[s\].
    pub evaluation_seconds: f64,
    /// Wall time of the run \[s\].
    pub seconds: f64,
}

/// A design at which the functions or their gradients could not be evaluated.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FailedDesign {
    /// The design.
    pub x: Vec<f64>,
    /// The failed function, and the reason.
    pub what: String,
}

/// Bound of a variable or a constraint that is active at the solution.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ActiveBound {
    /// Name of the variable or constraint.
    pub name: String,
    /// Which bound.
    pub side: BoundSide,
    /// Multiplier, never negative, in the units of the user.
    pub multiplier: f64,
}

/// Side of a pair of bounds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum BoundSide {
    /// Lower bound.
    Lower,
    /// Upper bound.
    Upper,
    /// Both bounds coincide.
    Equal,
}

/// What a run found.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Outcome {
    /// How the run ended.
    pub status: Status,
    /// The method that found this end; of both methods of [`Method::Auto`] one.
    pub method: Method,
    /// How the other method of [`Method::Auto`] ended, if both ran.
    #[serde(default)]
    pub other: Option<Box<Status>>,
    /// The best point.
    pub x: Vec<f64>,
    /// Objective there.
    pub objective: f64,
    /// Constraint values there.
    pub constraints: Vec<f64>,
    /// Multipliers there.
    pub multipliers: Multipliers,
    /// Residuals there.
    pub kkt: Kkt,
    /// Variables at a bound.
    pub active_bounds: Vec<ActiveBound>,
    /// Constraints at a bound.
    pub active_constraints: Vec<ActiveBound>,
    /// Work done.
    pub counts: Counts,
    /// Designs at which an evaluation failed, the first hundred of them.
    pub failed_designs: Vec<FailedDesign>,
    /// Scale factors and warnings about derivatives.
    pub scaling: Scaling,
    /// What a later run needs to continue from here.
    pub state: Option<SavedState>,
}

impl Outcome {
    /// Whether the run ended at a point that satisfies the first-order conditions.
    #[must_use]
    pub fn converged(&self) -> bool {
        self.status == Status::Converged
    }
}
