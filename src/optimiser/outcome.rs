//! How a run ended, and what it found.

use serde::{Deserialize, Serialize};

use crate::optimiser::options::Method;
use crate::optimiser::state::{Multipliers, SavedState, Scaling};

/// How a run ended.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Status {
    /// The point satisfies the first-order conditions to the tolerances in the units of the user
    /// ([`Options::tolerance`](super::Options::tolerance)).
    Converged,
    /// The tolerances cannot be reached in the units of the user. The residuals are small relative
    /// to the gradients of the run, the gain predicted by the quasi-Newton model is below the
    /// rounding of the objective, and a restart at the point gained nothing.
    AtPrecision,
    /// The point is infeasible and a stationary point of the constraint violation, or bounds of a
    /// constraint or variable cross.
    Infeasible {
        /// Name of the most violated constraint, or of the one whose bounds cross.
        constraint: String,
        /// Its violation, in its own units, at the point where the largest violation is least to
        /// first order. Half the distance of bounds that cross.
        violation: f64,
    },
    /// The program or the options make no sense. Nothing was evaluated, or a list of values or
    /// derivatives has a wrong length.
    IllPosed {
        /// What is wrong, by name.
        what: String,
    },
    /// The objective falls below every bound along feasible points.
    Unbounded,
    /// A function is undefined at the start and at perturbed starts.
    UndefinedStart {
        /// Which function, and why.
        what: String,
    },
    /// Values and gradients disagree where the run could not go on.
    Inconsistent {
        /// Which function, and its slopes by values and by gradients.
        what: String,
    },
    /// The derivatives of a row vanish where it holds, as those of x² = 0 do: the point may be
    /// optimal, but no multipliers exist.
    Degenerate {
        /// Name of the row.
        constraint: String,
    },
    /// An evaluation panicked.
    Panicked {
        /// Its message.
        what: String,
    },
    /// No step makes progress although the conditions are violated. The best point is returned.
    Stalled,
    /// The limit of iterations was reached.
    IterationLimit,
    /// The limit of evaluations was reached.
    EvaluationLimit,
    /// The limit of wall time was reached.
    TimeLimit,
    /// The observer asked to stop.
    Interrupted,
}

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
