//! The smooth nonlinear program that the optimiser solves.

use serde::{Deserialize, Serialize};
use std::time::Instant;

use crate::linear::curvature::Curvature;
use crate::linear::jacobian::Jacobian;

/// A smooth nonlinear program, minimise f(x) subject to c_L ≤ c(x) ≤ c_U and x_L ≤ x ≤ x_U.
///
/// A row with c_L = c_U is an equality. An infinite bound is absent; a row without bounds is
/// ignored, whatever its values. The optimiser requests first derivatives at a point whose values it
/// requested last or shortly before. It needs no second derivatives, but the interior point uses them where the
/// program gives them.
pub trait Nlp {
    /// Number of variables n.
    fn variables(&self) -> usize;

    /// Number of constraint rows m.
    fn constraints(&self) -> usize;

    /// Bounds x_L and x_U of the variables, each of length n.
    fn variable_bounds(&self) -> (Vec<f64>, Vec<f64>);

    /// Bounds c_L and c_U of the constraint rows, each of length m.
    fn constraint_bounds(&self) -> (Vec<f64>, Vec<f64>);

    /// Point from which to start, of length n; it need not respect the bounds.
    fn start(&self) -> Vec<f64>;

    /// Name of variable `i`, used in verdicts and warnings.
    fn variable_name(&self, i: usize) -> String {
        format!("x[{i}]")
    }

    /// Name of constraint row `j`, used in verdicts and warnings.
    fn constraint_name(&self, j: usize) -> String {
        format!("c[{j}]")
    }

    /// Units of the user in one unit of variable `i`, if the program scales its variables itself.
    /// Endings are judged in the units of the user.
    fn variable_unit(&self, _i: usize) -> f64 {
        1.0
    }

    /// Whether the run must end: an evaluation that has just failed says nothing of its point then.
    fn is_interrupted(&self) -> bool {
        false
    }

    /// Wall time since `started` \[s\], by which the run is limited. Processes that solve the same program side by side
    /// must know it alike, or one would end before the others.
    fn seconds_since(&self, started: Instant) -> f64 {
        started.elapsed().as_secs_f64()
    }

    /// Objective and constraints at `x`.
    ///
    /// # Errors
    /// [`EvaluationFailure`] if the functions are undefined or their simulation fails. The
    /// optimiser then shortens its step. It treats a value that is not finite in the same way.
    fn evaluate(&mut self, x: &[f64]) -> Result<Evaluation, EvaluationFailure>;

    /// Announces that values will be requested at the first of `points` and, if they are undefined
    /// there, at the next ones. An implementation may compute them side by side beforehand, or
    /// ignore the call. It must not change any result.
    fn foresee(&mut self, _points: &[Vec<f64>]) {}

    /// Gradient of the objective and Jacobian of the constraints at `x`.
    ///
    /// # Errors
    /// [`EvaluationFailure`] as for [`Nlp::evaluate`].
    fn gradients(&mut self, x: &[f64]) -> Result<Gradients, EvaluationFailure>;

    /// Residuals r of an objective f = Σ r_k² and their derivatives, at the point `x` of the last requested
    /// gradients; `None`, as by default, if the objective is no such sum.
    ///
    /// # Errors
    /// [`EvaluationFailure`] as for [`Nlp::evaluate`].
    fn residuals(&mut self, _x: &[f64]) -> Result<Option<Residuals>, EvaluationFailure> {
        Ok(None)
    }

    /// Second derivatives of f + yᵀc for the multipliers `y` of the rows, at the point `x` of the
    /// last requested gradients. Without them, as by default, they are approximated from gradients.
    fn curvature(&mut self, _x: &[f64], _y: &[f64]) -> Option<Curvature> {
        None
    }
}

/// Values of the functions at one point.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Evaluation {
    /// Objective f.
    pub objective: f64,
    /// Constraint values c, of length m.
    pub constraints: Vec<f64>,
}

/// First derivatives of the functions at one point.
#[derive(Clone, Debug, PartialEq)]
pub struct Gradients {
    /// Gradient ∇f, of length n.
    pub objective: Vec<f64>,
    /// Jacobian ∂c/∂x, m × n. Rows that touch few variables may be sparse.
    pub jacobian: Jacobian,
}

/// Residuals of a sum of squares at one point.
#[derive(Clone, Debug, PartialEq)]
pub struct Residuals {
    /// Residuals r, of any number N.
    pub values: Vec<f64>,
    /// Jacobian ∂r/∂x, N × n.
    pub jacobian: Jacobian,
}

/// The functions could not be evaluated at a point.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, thiserror::Error)]
#[error("{what} is not defined: {reason}")]
pub struct EvaluationFailure {
    /// Function that failed, by name.
    pub what: String,
    /// Why it failed.
    pub reason: String,
}

/// Finds the first value that is not finite, among the objective and `rows`.
pub(crate) fn fault_of_evaluation(
    nlp: &dyn Nlp,
    rows: &[usize],
    e: &Evaluation,
) -> Option<EvaluationFailure> {
    if !e.objective.is_finite() {
        return Some(not_finite("the objective".into(), e.objective));
    }
    let j = *rows.iter().find(|&&j| !e.constraints[j].is_finite())?;
    Some(not_finite(nlp.constraint_name(j), e.constraints[j]))
}

/// As [`fault_of_evaluation`], for derivatives.
pub(crate) fn fault_of_gradients(
    nlp: &dyn Nlp,
    rows: &[usize],
    g: &Gradients,
) -> Option<EvaluationFailure> {
    if let Some(i) = g.objective.iter().position(|v| !v.is_finite()) {
        let what = format!(
            "the derivative of the objective in {}",
            nlp.variable_name(i)
        );
        return Some(not_finite(what, g.objective[i]));
    }
    for &j in rows {
        for (i, value) in g.jacobian.row(j) {
            if !value.is_finite() {
                let (row, column) = (nlp.constraint_name(j), nlp.variable_name(i));
                return Some(not_finite(
                    format!("the derivative of {row} in {column}"),
                    value,
                ));
            }
        }
    }
    None
}

/// As [`fault_of_evaluation`], for residuals and their derivatives.
pub(crate) fn fault_of_residuals(nlp: &dyn Nlp, r: &Residuals) -> Option<EvaluationFailure> {
    if let Some(k) = r.values.iter().position(|v| !v.is_finite()) {
        return Some(not_finite(format!("the residual {k}"), r.values[k]));
    }
    let entries = (0..r.values.len()).flat_map(|k| r.jacobian.row(k).map(move |(i, v)| (k, i, v)));
    let (k, i, value) = { entries }.find(|(_, _, v)| !v.is_finite())?;
    let column = nlp.variable_name(i);
    Some(not_finite(
        format!("the derivative of the residual {k} in {column}"),
        value,
    ))
}

fn not_finite(what: String, value: f64) -> EvaluationFailure {
    EvaluationFailure {
        what,
        reason: format!("its value is {value}"),
    }
}

/// Names the list of values whose length is wrong.
pub(crate) fn length_of_evaluation(nlp: &dyn Nlp, e: &Evaluation) -> Option<String> {
    wrong_length(
        "list of constraints",
        e.constraints.len(),
        nlp.constraints(),
    )
}

/// Names the list of derivatives whose length is wrong.
pub(crate) fn length_of_gradients(nlp: &dyn Nlp, g: &Gradients) -> Option<String> {
    let (n, m) = (nlp.variables(), nlp.constraints());
    wrong_length("gradient of the objective", g.objective.len(), n).or_else(|| {
        let (rows, columns) = g.jacobian.shape();
        let shape = (rows, columns) == (m, n);
        (!shape).then(|| format!("the Jacobian is {rows} × {columns} where {m} × {n} is expected"))
    })
}

fn wrong_length(what: &str, found: usize, expected: usize) -> Option<String> {
    (found != expected)
        .then(|| format!("the {what} has {found} entries where {expected} are expected"))
}
