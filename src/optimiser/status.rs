//! How a run ended.

use serde::{Deserialize, Serialize};

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

impl Status {
    /// One word and one sentence for how the run ended.
    #[must_use]
    pub fn verdict(&self) -> (&'static str, String) {
        match self {
            Self::Converged => ("converged", "the optimality conditions hold".into()),
            Self::AtPrecision => (
                "at_precision",
                "what could still be gained is below the rounding of the objective, \
             but the optimality conditions do not hold to the tolerance"
                    .into(),
            ),
            Self::Infeasible {
                constraint,
                violation,
            } => (
                "infeasible",
                format!(
                    "no feasible design was found: \"{constraint}\" is violated by {violation:.3e}, \
                 and no small change reduces the violation"
                ),
            ),
            Self::IllPosed { what } => ("ill_posed", format!("the problem makes no sense: {what}")),
            Self::Unbounded => ("unbounded", "the objective improves without bound".into()),
            Self::UndefinedStart { what } => (
                "undefined_start",
                format!("the start cannot be evaluated: {what}"),
            ),
            Self::Inconsistent { what } => {
                let text = format!("values and gradients disagree: {what}");
                ("inconsistent", text)
            }
            Self::Degenerate { constraint } => (
                "degenerate",
                format!(
                    "the derivatives of \"{constraint}\" vanish where it holds, so no multipliers exist; \
                 the best design that was found is kept"
                ),
            ),
            Self::Panicked { what } => (
                "panicked",
                format!("an evaluation panicked ({what}); the best design so far is kept"),
            ),
            Self::Stalled => (
                "stalled",
                "no further progress; the best design that was found is kept".into(),
            ),
            Self::IterationLimit => ("iteration_limit", "the iteration limit was reached".into()),
            Self::EvaluationLimit => (
                "evaluation_limit",
                "the evaluation limit was reached".into(),
            ),
            Self::TimeLimit => ("time_limit", "the time limit was reached".into()),
            Self::Interrupted => (
                "interrupted",
                "interrupted; the best design so far is kept".into(),
            ),
        }
    }
}
