//! Sensitivity of the optimum to a parameter of the problem file that is not designed.

use super::evaluator::{Evaluator, unscaled};
use super::known_evaluations::KnownEvaluations;
use super::optimise::solve;
use super::record::verdict;
use crate::optimiser::{EvaluationFailure, Nlp, Outcome};
use crate::problem::Problem;
use crate::report::history::Column;
use crate::report::{History, SweptOptimum};
use std::ops::ControlFlow;

/// Derivative of the optimal objective f* by the last variable p of `problem`, at the optimum of
/// the problem without it.
///
/// df*/dp = ∂L/∂p = ∂f/∂p + yᵀ ∂c/∂p with the multipliers y at the optimum: the design moves with
/// p, but to first order that changes nothing (Fiacco 1983, theorem 3.4.1). The derivatives come
/// from the adjoint. The objective is in the user's sense. `None` if there is no objective.
///
/// # Errors
/// If the simulation or its gradient fails.
pub(crate) fn sensitivity(
    problem: &Problem,
    outcome: &Outcome,
) -> Result<Option<f64>, EvaluationFailure> {
    let Some(mut program) = Evaluator::new(problem, KnownEvaluations::default()) else {
        return Ok(None);
    };
    let n = outcome.x.len();
    let mut x = outcome.x.clone();
    x.extend(&program.start()[n..]);
    program.evaluate(&x)?;
    let slopes = program.gradients(&x)?;
    let rows = slopes
        .jacobian
        .weighted_sum(&outcome.multipliers.constraints);
    let change = slopes.objective[n] + rows[n];
    Ok(Some(program.sign() * change / problem.variables[n].scale))
}

/// Objective, variables and constraints.
type Columns = (Column, Vec<Column>, Vec<Column>);

/// The optimum of `problem`, in which a parameter has the value `value`, and the names of its
/// numbers. `None` if there is nothing to optimise.
pub(crate) fn swept(
    problem: &Problem,
    value: f64,
    progress: &mut dyn FnMut(&History) -> ControlFlow<()>,
) -> Option<(Columns, SweptOptimum)> {
    let solved = solve(problem, None, KnownEvaluations::default(), progress)?;
    let objective = solved.objective();
    let (outcome, history) = (solved.outcome, solved.history);
    let optimum = SweptOptimum {
        value,
        problem: problem.hash.clone(),
        status: verdict(&outcome.status).0.to_owned(),
        converged: outcome.converged(),
        evaluations: outcome.counts.evaluations,
        objective,
        design: unscaled(problem, &outcome.x),
        constraints: outcome.constraints,
    };
    let columns = (history.objective, history.variables, history.constraints);
    Some((columns, optimum))
}
