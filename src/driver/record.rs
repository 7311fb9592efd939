//! The record of an optimisation: the optimiser's outcome in the user's names, signs and units.

use super::alike::{Message, grouped};
use super::analysed::{AnalysisFailure, Simulated, notes_of_start};
use super::evaluator::unscaled;
use crate::optimiser::{self, Method, Outcome};
use crate::problem::{Problem, Sense};
use crate::report::evaluations::Work;
use crate::report::optimum::{
    Activity, Aggregate, BoundSide, ConstraintValue, Counts, DesignValue, Kkt, KktResiduals,
    Multipliers, Objective, Optimum, ProblemRecord, RowScaling, Scaling, Sense as RecordedSense,
};
use indexmap::IndexMap;

pub(super) fn record(
    problem: &Problem,
    file: &str,
    outcome: &Outcome,
    sign: f64,
    (work, refreshes): (Work, usize),
    (start, end): (&Result<Simulated, AnalysisFailure>, Option<&Simulated>),
) -> Optimum {
    let (status, mut sentence) = outcome.status.verdict();
    if let Some(other) = &outcome.other {
        let (own, replaced) = match outcome.method {
            Method::TrustRegion | Method::LeastSquares => ("trust region", "interior point"),
            Method::InteriorPoint | Method::Auto => ("interior point", "trust region"),
        };
        let (_, why) = other.verdict();
        sentence += &format!(" (by the {own}; the {replaced} ended so: {why})");
    }
    let x = unscaled(problem, &outcome.x);
    let objective = problem
        .objective
        .expect("only a problem with an objective is optimised");
    let maximise = objective.sense == Sense::Maximise;
    let value = sign * outcome.objective;
    let mut warnings = Vec::new();
    let start_objective = match start {
        Ok(start) => Ok(start.value(objective.function)),
        Err(failure) => Err(failure.to_string()),
    };
    let start_objective = start_objective
        .and_then(|value| match value.is_finite() {
            true => Ok(value),
            false => Err(format!("it is {value}")),
        })
        .map_err(|why| warnings.push(format!("the objective is not known at the start: {why}")))
        .ok();
    let mut judged = vec![objective.function];
    for constraint in &problem.constraints {
        if !judged.contains(&constraint.function) {
            judged.push(constraint.function);
        }
    }
    let estimates = match end.map(|end| end.estimate(problem, &judged, false)) {
        Some(Ok(all)) => all,
        Some(Err(failure)) => {
            warnings.push(format!(
                "the errors of objective and constraints are not estimated: {failure}"
            ));
            Vec::new()
        }
        None => Vec::new(),
    };
    let estimate = estimates.first().map(|found| found.value);
    let aggregate = |f: usize| end.and_then(|end| end.aggregate(problem, f, &estimates));
    let error = |f: usize| {
        let found = estimates.iter().find(|found| found.function == f);
        found.map(|found| found.value.error)
    };
    let scales = problem.variables.iter().map(|v| v.scale);
    let bounds = |z: &[f64]| -> IndexMap<String, f64> {
        let names = problem.variables.iter().map(|v| v.name.clone());
        names
            .zip(z.iter().zip(scales.clone()).map(|(z, scale)| z / scale))
            .collect()
    };
    let multipliers = Multipliers {
        constraints: problem
            .constraints
            .iter()
            .zip(&outcome.multipliers.constraints)
            .map(|(c, &y)| (c.name.clone(), y))
            .collect(),
        lower_bounds: bounds(&outcome.multipliers.lower_bounds),
        upper_bounds: bounds(&outcome.multipliers.upper_bounds),
    };
    warnings.extend(match problem.is_rest() || problem.cases.is_some() {
        true => notes_of_start(problem, &x),
        false => notes_of_start(problem, &problem.start()),
    });
    if let Some(end) = end {
        let constrained = problem.constraints.iter().map(|c| c.function);
        let mut used: Vec<usize> = constrained.chain([objective.function]).collect();
        used.sort_unstable();
        used.dedup();
        warnings.extend(end.warnings(problem, &used));
        if let Ok(start) = start {
            warnings.extend(start.far(problem, &used, "at the start"));
        }
    }
    let constraints = constraints(
        problem,
        outcome,
        maximise,
        (start.as_ref().ok(), end),
        (aggregate, error),
    );
    let beyond = constraints.iter();
    warnings.extend(grouped(
        beyond.filter_map(|(name, found)| beyond_margin(problem, name, found)),
    ));
    let scaling = &outcome.scaling;
    let zero = |names: &[String], what: &str| {
        (!names.is_empty()).then(|| format!("at the start {what}: {}", names.join(", ")))
    };
    warnings.extend(zero(
        &scaling.zero_rows,
        "all derivatives of these constraints are zero",
    ));
    warnings.extend(zero(
        &scaling.zero_columns,
        "all derivatives by these variables are zero",
    ));
    Optimum {
        status: status.to_string(),
        message: sentence,
        objective: Objective {
            function: problem.function_names[objective.function].clone(),
            sense: if maximise {
                RecordedSense::Maximise
            } else {
                RecordedSense::Minimise
            },
            value,
            unit: known(problem.function_unit(objective.function)),
            true_maximum: end.and_then(|end| end.maximum(objective.function)),
            aggregate: aggregate(objective.function),
            true_value: end.and_then(|end| end.true_value(objective.function)),
            estimated_error: estimate.map(|e| e.error),
        },
        start_objective,
        design: problem
            .variables
            .iter()
            .zip(&x)
            .map(|(v, &value)| {
                let design = DesignValue {
                    value,
                    start: v.start,
                    lower: Some(v.lower).filter(|b| b.is_finite()),
                    upper: Some(v.upper).filter(|b| b.is_finite()),
                    unit: Some(v.unit.clone()).filter(|unit| !unit.is_empty()),
                };
                (v.name.clone(), design)
            })
            .collect(),
        constraints,
        multipliers,
        sensitivities: IndexMap::new(),
        active_bounds: active_bounds(outcome),
        kkt: Kkt {
            scaled: KktResiduals {
                stationarity: outcome.kkt.relative_stationarity,
                feasibility: outcome.kkt.violation,
                complementarity: outcome.kkt.relative_complementarity,
            },
            unscaled: KktResiduals {
                stationarity: outcome.kkt.stationarity,
                feasibility: outcome.kkt.violation,
                complementarity: outcome.kkt.complementarity,
            },
        },
        scaling: scaling_record(problem, outcome),
        second_order: None,
        gradient_certificate: None,
        fit: None,
        integration: end.and_then(|end| end.integration(refreshes)),
        counts: Counts {
            iterations: outcome.counts.iterations as u64,
            function_evaluations: outcome.counts.evaluations as u64,
            gradient_evaluations: outcome.counts.gradients as u64,
            failed_evaluations: outcome.counts.failures as u64,
            quadratic_programs: outcome.counts.quadratic_programs as u64,
            steps: work.steps as u64,
            recomputed_steps: work.recomputed as u64,
            newton_iterations: work.newton_iterations as u64,
            factorisations: work.factorisations as u64,
            solves: work.solves as u64,
        },
        warnings,
        version: env!("CARGO_PKG_VERSION").to_string(),
        problem: ProblemRecord {
            name: problem.name.clone(),
            file: file.to_string(),
            directory: None,
            sha256: problem.hash.clone(),
            document: problem.document.clone(),
        },
    }
}

fn constraints(
    problem: &Problem,
    outcome: &Outcome,
    maximise: bool,
    (start, end): (Option<&Simulated>, Option<&Simulated>),
    (aggregate, error): (
        impl Fn(usize) -> Option<Aggregate>,
        impl Fn(usize) -> Option<f64>,
    ),
) -> IndexMap<String, ConstraintValue> {
    let at_start = |function: usize| {
        let value = start?.value(function);
        value.is_finite().then_some(value)
    };
    let active = |name: &str| {
        let found = outcome.active_constraints.iter().find(|a| a.name == name);
        found.map_or(Activity::Inactive, |a| match a.side {
            optimiser::BoundSide::Lower => Activity::Lower,
            optimiser::BoundSide::Upper => Activity::Upper,
            optimiser::BoundSide::Equal => Activity::Equality,
        })
    };
    let values = outcome
        .constraints
        .iter()
        .zip(&outcome.multipliers.constraints);
    problem
        .constraints
        .iter()
        .zip(values)
        .map(|(c, (&value, &y))| {
            // Raising the active bound by one changes the minimised objective by −y.
            let multiplier = if maximise { y } else { -y };
            let constraint = ConstraintValue {
                value,
                start: at_start(c.function),
                lower: Some(c.lower).filter(|b| b.is_finite()),
                upper: Some(c.upper).filter(|b| b.is_finite()),
                unit: known(problem.function_unit(c.function)),
                multiplier,
                active: active(&c.name),
                aggregate: aggregate(c.function),
                estimated_error: error(c.function),
                true_value: end.and_then(|end| end.true_value(c.function)),
            };
            (c.name.clone(), constraint)
        })
        .collect()
}

/// A unit, if it is known.
fn known(unit: String) -> Option<String> {
    Some(unit).filter(|unit| !unit.is_empty())
}

/// Part of a bound below which the error of a constraint stands in the table alone.
const NOTABLE: f64 = 1e-3;

/// A warning if the error of a constraint is larger than its distance from the bounds, than a thousandth of the bound and
/// than what the optimiser may violate.
fn beyond_margin(problem: &Problem, name: &str, found: &ConstraintValue) -> Option<Message> {
    let error = found.estimated_error?;
    let given = problem.optimiser.constraint_tolerance;
    let tolerance = given.unwrap_or(optimiser::Options::default().constraint_tolerance);
    let below = found.lower.map(|lower| (found.value - lower, lower));
    let above = found.upper.map(|upper| (upper - found.value, upper));
    let all = below.into_iter().chain(above);
    let (margin, bound) = all.min_by(|a, b| a.0.total_cmp(&b.0))?;
    let allowed = tolerance * bound.abs().max(1.0);
    if -margin <= allowed && error <= margin.max(0.0) + allowed.max(NOTABLE * bound.abs()) {
        return None;
    }
    let unit = match found.unit.as_deref() {
        None | Some("" | "1") => String::new(),
        Some(unit) => format!(" {unit}"),
    };
    let finer = match &problem.statics {
        Some(_) => "a finer mesh",
        None => "a smaller tolerance or more steps",
    };
    let text = match -margin > allowed {
        true => format!("\"{name}\" is violated by {:.2e}{unit}", -margin),
        false => format!(
            "\"{name}\" may be violated: its estimated error of {error:.1e}{unit} exceeds its distance of \
             {:.1e}{unit} from the bound; take {finer}",
            margin.max(0.0)
        ),
    };
    let name = name.to_owned();
    Some(Message {
        name,
        size: error.max(-margin),
        text,
    })
}

fn scaling_record(problem: &Problem, outcome: &Outcome) -> Scaling {
    let found = &outcome.scaling;
    let factors = found.constraints.iter().zip(&found.constraint_gradients);
    let rows = factors.map(|(&factor, &gradient)| RowScaling { factor, gradient });
    let lengths = problem.variables.iter().zip(&found.variables);
    Scaling {
        objective: RowScaling {
            factor: found.objective,
            gradient: found.objective_gradient,
        },
        constraints: problem
            .constraints
            .iter()
            .map(|c| c.name.clone())
            .zip(rows)
            .collect(),
        variables: lengths
            .map(|(v, length)| (v.name.clone(), v.scale * length))
            .collect(),
    }
}

fn active_bounds(outcome: &Outcome) -> IndexMap<String, BoundSide> {
    let side = |a: &optimiser::ActiveBound| match a.side {
        optimiser::BoundSide::Upper => BoundSide::Upper,
        optimiser::BoundSide::Lower => BoundSide::Lower,
        optimiser::BoundSide::Equal => BoundSide::Fixed,
    };
    outcome
        .active_bounds
        .iter()
        .map(|a| (a.name.clone(), side(a)))
        .collect()
}
