//! Sensitivity of the optimum to a parameter of the problem file that is not designed.

use super::evaluator::Evaluator;
use super::known_evaluations::KnownEvaluations;
use super::multi_start::{Run, best, distinct};
use crate::optimiser::{EvaluationFailure, Nlp, Outcome};
use crate::problem::Problem;
use crate::report::SweptOptimum;
use crate::report::history::Column;

/// Derivative of the optimal objective f* by the last variable p of `problem`, at the optimum of
/// the problem without it.
///
/// df*/dp = ∂L/∂p = ∂f/∂p + yᵀ ∂c/∂p with the multipliers y at the optimum: the design moves with
/// p, but to first order that changes nothing (Fiacco 1983, theorem 3.4.1). The derivatives come
/// from the adjoint. The objective is in the user's sense. `None` if there is no objective.
///
/// # Errors
/// If the simulation or its gradient fails.
pub fn sensitivity(problem: &Problem, outcome: &Outcome) -> Result<Option<f64>, EvaluationFailure> {
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

/// The best optimum of `problem`, in which a parameter has the value `value`, and the names of its numbers. The
/// `runs` start at the optimum before, if `from_last`, and at several starts, the first of which is that of the file.
/// `None` if there are none.
pub fn swept(
    problem: &Problem,
    value: f64,
    mut runs: Vec<Run>,
    from_last: bool,
) -> Option<(Columns, SweptOptimum)> {
    let warm = usize::from(from_last);
    let evaluations = runs
        .iter()
        .map(|run| run.solved.outcome.counts.evaluations)
        .sum();
    // A valley that others reach too is followed.
    let optima = distinct(problem, &runs);
    let first = optima.first().map(|optimum| optimum.first);
    let run = runs.swap_remove(first.or_else(|| best(&runs))?);
    let start = match run.start.checked_sub(warm) {
        None => "the optimum before".to_owned(),
        Some(0) => "the start of the file".to_owned(),
        Some(k) => format!("start {}", k + 1),
    };
    let design = run.design();
    let solved = run.solved;
    let objective = solved.objective();
    let (outcome, history) = (solved.outcome, solved.history);
    let optimum = SweptOptimum {
        value,
        problem: problem.hash.clone(),
        status: outcome.status.verdict().0.to_owned(),
        converged: outcome.converged(),
        evaluations,
        objective,
        design,
        constraints: outcome.constraints,
        start,
    };
    let columns = (history.objective, history.variables, history.constraints);
    Some((columns, optimum))
}
