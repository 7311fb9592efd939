//! The end of an optimisation as a record, `optimum.json`.

use super::ReportError;
pub use super::certificate::*;
use super::fit::Fit;
use indexmap::IndexMap;
use serde::{Deserialize, Serialize};

/// The record of the end of an optimisation.
///
/// The same run gives the same bytes: there are no dates, times or names of machines. Infinite
/// bounds are left out.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Optimum {
    /// How the run ended, in one word such as `converged`.
    pub status: String,
    /// How the run ended, in a sentence.
    pub message: String,
    /// The objective at the optimum.
    pub objective: Objective,
    /// The objective at the start, unless it is undefined there; a warning then says why.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub start_objective: Option<f64>,
    /// Design variables by name.
    pub design: IndexMap<String, DesignValue>,
    /// Constraints by name.
    pub constraints: IndexMap<String, ConstraintValue>,
    /// Lagrange multipliers of constraints and bounds.
    pub multipliers: Multipliers,
    /// Design variables at a bound, with its side.
    pub active_bounds: IndexMap<String, BoundSide>,
    /// Residuals of the optimality conditions.
    pub kkt: Kkt,
    /// How the optimiser scaled the problem.
    pub scaling: Scaling,
    /// By JSON Pointer: derivatives of the optimal objective by numbers of the problem file that are
    /// not designed, if requested.
    #[serde(default, skip_serializing_if = "IndexMap::is_empty")]
    pub sensitivities: IndexMap<String, Sensitivity>,
    /// Curvature at the optimum, if requested.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub second_order: Option<SecondOrder>,
    /// Gradients against the complex step, unless skipped; older records have none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gradient_certificate: Option<GradientCertificate>,
    /// What the numbers of a fit are worth, if the objective is a misfit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fit: Option<Fit>,
    /// How the motion was integrated at the end.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub integration: Option<Integration>,
    /// Work done.
    pub counts: Counts,
    /// Warnings about the result.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<String>,
    /// Version of flexbody.
    pub version: String,
    /// The problem that was solved.
    pub problem: ProblemRecord,
}

/// Whether the objective is made small or large.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Sense {
    /// Smaller is better.
    Minimise,
    /// Larger is better.
    Maximise,
}

/// A side of an interval.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum BoundSide {
    /// The lower bound.
    Lower,
    /// The upper bound.
    Upper,
    /// Both: equal bounds fix the variable.
    Fixed,
}

/// Which bounds of a constraint are active.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Activity {
    /// None.
    Inactive,
    /// The lower bound.
    Lower,
    /// The upper bound.
    Upper,
    /// Both, because they are equal.
    Equality,
}

/// The objective at the optimum.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Objective {
    /// Name of the function in the problem file.
    pub function: String,
    /// Whether it is minimised or maximised.
    pub sense: Sense,
    /// Value in the user's sense (a maximised function is not negated).
    pub value: f64,
    /// Unit of the value, where it is known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unit: Option<String>,
    /// The largest value over time, if `value` is a smooth aggregate of it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub true_maximum: Option<f64>,
    /// The aggregated quantity, if it is an aggregate.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub aggregate: Option<Aggregate>,
    /// What `value` stands for, if it smooths something else than a maximum: the lowest frequency, the clearance of the
    /// best release.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub true_value: Option<f64>,
    /// Estimated error of `value` by the discretisation in time, absolute.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub estimated_error: Option<f64>,
}

/// A design variable at the optimum, in the units of the problem file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DesignValue {
    /// Value at the optimum.
    pub value: f64,
    /// Value at the start.
    pub start: f64,
    /// Lower bound, if there is one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lower: Option<f64>,
    /// Upper bound, if there is one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub upper: Option<f64>,
    /// Unit, where it is known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unit: Option<String>,
}

/// Derivative of the optimal objective by a number that is not designed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sensitivity {
    /// Value of the number.
    pub value: f64,
    /// Derivative, in the user's sense of the objective.
    pub derivative: f64,
    /// Unit of the number, where it is known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unit: Option<String>,
}

/// A constraint at the optimum.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ConstraintValue {
    /// Value at the optimum.
    pub value: f64,
    /// Value at the start, where it is known; older records have none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub start: Option<f64>,
    /// Lower bound, if there is one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lower: Option<f64>,
    /// Upper bound, if there is one; equal to the lower one for an equality.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub upper: Option<f64>,
    /// Unit of value and bounds, where it is known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unit: Option<String>,
    /// Change of the objective (user's sense) for a unit change of the active bound:
    /// the multiplier as a sensitivity, d objective / d bound.
    pub multiplier: f64,
    /// Which bound is active.
    pub active: Activity,
    /// The aggregated quantity, if it is an aggregate.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub aggregate: Option<Aggregate>,
    /// Estimated error of `value` by the discretisation, absolute; older records have none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub estimated_error: Option<f64>,
    /// As [`Objective::true_value`].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub true_value: Option<f64>,
}

impl ConstraintValue {
    /// How far the value is beyond its bounds, if that is more than a millionth of the bound (of one, near zero).
    pub fn violation(&self) -> Option<f64> {
        let below = self.lower.map(|lower| (lower - self.value, lower));
        let above = self.upper.map(|upper| (self.value - upper, upper));
        let all = below.into_iter().chain(above);
        let (by, _) = all
            .filter(|(by, bound)| *by > 1e-6 * bound.abs().max(1.0))
            .max_by(|a, b| a.0.total_cmp(&b.0))?;
        Some(by)
    }
}

/// A smooth aggregate and the largest value over time, or over a structure.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Aggregate {
    /// The side of the largest value on which the aggregate always lies; of one over time and points, on which it lies
    /// here.
    pub lies: Lies,
    /// The largest value over time, gate included.
    pub true_maximum: f64,
    /// When it is attained \[s\], in a motion.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub time: Option<f64>,
    /// Where it is attained, in a structure.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub place: Option<String>,
    /// Its estimated error by the discretisation in time, absolute.
    pub error: f64,
    /// The largest value while the gate is more open than closed, without the gate's factor, if
    /// there is a gate.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ungated: Option<f64>,
}

/// A side of the largest value over time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Lies {
    /// Never above it.
    Below,
    /// Never below it.
    Above,
}

/// Lagrange multipliers, unscaled, with the signs of the optimiser's own Lagrangian.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Multipliers {
    /// Of the constraints, by name.
    pub constraints: IndexMap<String, f64>,
    /// Of the lower bounds, by variable.
    pub lower_bounds: IndexMap<String, f64>,
    /// Of the upper bounds, by variable.
    pub upper_bounds: IndexMap<String, f64>,
}

/// Residuals of the optimality conditions, largest components.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Kkt {
    /// In the optimiser's scaled units; these end the run.
    pub scaled: KktResiduals,
    /// In the user's units.
    pub unscaled: KktResiduals,
}

/// One set of optimality residuals.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct KktResiduals {
    /// Gradient of the Lagrangian.
    pub stationarity: f64,
    /// Violation of constraints and bounds.
    pub feasibility: f64,
    /// Products of multipliers and distances to their bounds.
    pub complementarity: f64,
}

/// How the optimiser scaled the problem at the start.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scaling {
    /// Of the objective.
    pub objective: RowScaling,
    /// Of the constraints, by name.
    pub constraints: IndexMap<String, RowScaling>,
    /// Length of one scaled unit of each variable, in the variable's unit, by name.
    pub variables: IndexMap<String, f64>,
}

/// Scaling of one function.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RowScaling {
    /// Factor of the function.
    pub factor: f64,
    /// Largest derivative at the start in scaled variables, before the factor.
    pub gradient: f64,
}

/// Curvature of the minimised Lagrangian along the directions that strictly active bounds and
/// constraints leave free.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SecondOrder {
    /// Eigenvalues of the reduced Hessian in scaled variables, ascending; none at a vertex.
    pub eigenvalues: Vec<f64>,
    /// Estimated error of its entries.
    pub uncertainty: f64,
    /// The verdict.
    pub curvature: Curvature,
    /// A feasible direction along which the objective improves, if there is one: the change of each
    /// variable, in its unit, for a step of length one in scaled variables.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub descent: Option<IndexMap<String, f64>>,
    /// Variables at a bound, and constraints, that are weakly active: their multiplier is zero or
    /// almost zero. The eigenvalues are computed with them left free.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub weakly_active: Vec<String>,
}

/// Verdict of the curvature.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Curvature {
    /// Strictly active bounds and constraints leave no direction free.
    NoFreeDirection,
    /// The curvature is positive along all free directions.
    StrictOptimum,
    /// The curvature is negative along a feasible direction.
    NoOptimum,
    /// The curvature is zero within its error along some direction, and negative along none.
    Flat,
    /// The curvature is negative, but only along directions that weakly active bounds exclude.
    NotDecided,
}

/// How the motion was integrated.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Integration {
    /// Name of the method.
    pub method: String,
    /// Why it was chosen.
    pub reason: String,
    /// Number of steps of the motion at the end.
    pub steps: u64,
    /// How often the steps were chosen anew because their error was too large.
    pub refreshes: u64,
}

/// Work done.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Counts {
    /// Iterations of the optimiser.
    pub iterations: u64,
    /// Simulations requested by the optimiser.
    pub function_evaluations: u64,
    /// Gradients.
    pub gradient_evaluations: u64,
    /// Simulations that failed and shortened a step.
    pub failed_evaluations: u64,
    /// Quadratic programs solved by the trust region.
    #[serde(default)]
    pub quadratic_programs: u64,
    /// Time steps of all simulations.
    pub steps: u64,
    /// Steps that gradients repeated because memory is limited.
    #[serde(default)]
    pub recomputed_steps: u64,
    /// Newton iterations of all time steps.
    pub newton_iterations: u64,
    /// Factorisations of matrices, forward and backward.
    pub factorisations: u64,
    /// Solves with a factorised matrix, forward and backward.
    pub solves: u64,
}

impl Counts {
    /// All counts with their names, in order.
    pub fn named(&self) -> [(&'static str, u64); 10] {
        [
            ("iterations", self.iterations),
            ("function evaluations", self.function_evaluations),
            ("gradient evaluations", self.gradient_evaluations),
            ("failed evaluations", self.failed_evaluations),
            ("quadratic programs", self.quadratic_programs),
            ("time steps", self.steps),
            ("recomputed steps", self.recomputed_steps),
            ("Newton iterations", self.newton_iterations),
            ("factorisations", self.factorisations),
            ("solves", self.solves),
        ]
    }
}

/// The problem that was solved.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ProblemRecord {
    /// Name of the problem.
    pub name: String,
    /// Name of the problem file, without directories.
    pub file: String,
    /// If the document names files of bodies: its directory, from that of the record.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub directory: Option<String>,
    /// SHA-256 of the document, hexadecimal.
    pub sha256: String,
    /// The document itself, with everything that was set on the command line.
    pub document: serde_json::Value,
}

impl Optimum {
    /// The record as JSON text, indented, ended by a line feed.
    ///
    /// # Errors
    /// [`ReportError::NotFinite`] with the place of a number that is NaN or infinite.
    pub fn to_json(&self) -> Result<String, ReportError> {
        let value = serde_json::to_value(self)?;
        // An absent value is left out, so a null outside the document is a number that JSON cannot
        // hold.
        if let Some(pointer) = first_null(&value, String::new()) {
            return Err(ReportError::NotFinite { pointer });
        }
        Ok(serde_json::to_string_pretty(&value)? + "\n")
    }

    /// Reads back what [`Optimum::to_json`] wrote.
    ///
    /// # Errors
    /// [`ReportError::Optimum`] with line and column.
    pub fn from_json(text: &str) -> Result<Optimum, ReportError> {
        Ok(serde_json::from_str(text)?)
    }
}

/// JSON Pointer of the first null outside the problem's document.
fn first_null(value: &serde_json::Value, pointer: String) -> Option<String> {
    use serde_json::Value;
    match value {
        Value::Null => Some(pointer),
        _ if pointer == "/problem/document" => None,
        Value::Object(map) => map.iter().find_map(|(key, inner)| {
            let key = key.replace('~', "~0").replace('/', "~1");
            first_null(inner, format!("{pointer}/{key}"))
        }),
        Value::Array(items) => items
            .iter()
            .enumerate()
            .find_map(|(i, inner)| first_null(inner, format!("{pointer}/{i}"))),
        _ => None,
    }
}
