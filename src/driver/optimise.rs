//! A problem optimised: the optimiser's outcome, its history, and the simulations at both ends.

use super::evaluate::{Evaluator, unscaled};
use super::journal::Journal;
use super::simulate::{Simulation, estimate_errors, simulate};
use crate::integrate::WorkCounts;
use crate::optimiser::{self, Observer, Options, Outcome, Phase, Row, SavedState, Status};
use crate::problem::{Problem, Sense};
use crate::report::history::{Column, History, HistoryRow};
use crate::report::optimum::{
    Activity, ConstraintValue, Counts, DesignValue, Kkt, KktResiduals, Multipliers, Objective,
    Optimum, ProblemRecord, Sense as RecordedSense, Side,
};
use indexmap::IndexMap;
use std::ops::ControlFlow;

/// An optimisation that has ended.
pub struct Optimisation {
    /// The optimiser's outcome, in its scaled variables.
    pub outcome: Outcome,
    /// The record of the end.
    pub optimum: Optimum,
    /// Every iteration.
    pub history: History,
    /// The simulated start, unless it failed.
    pub start: Option<Simulation>,
    /// The simulated optimum, unless it failed.
    pub end: Option<Simulation>,
}

/// Optimises `problem`, from its start or from the state of another run. `journal` holds what is known already; `progress` sees the history after every iteration and may stop the run.
///
/// Returns `None` if the problem has no objective or no variables.
pub fn optimise<'a>(
    problem: &'a Problem,
    file: &str,
    from: Option<&SavedState>,
    journal: Journal<'a>,
    progress: &mut dyn FnMut(&History) -> ControlFlow<()>,
) -> Option<Optimisation> {
    let mut program = Evaluator::new(problem, journal)?;
    if problem.variables.is_empty() {
        return None;
    }
    let mut options = Options::default();
    options.method = problem.optimiser.method.unwrap_or(options.method);
    options.tolerance = problem.optimiser.tolerance.unwrap_or(options.tolerance);
    options.max_iterations = problem
        .optimiser
        .iterations
        .unwrap_or(options.max_iterations);
    let sign = program.sign();
    let mut recorder = Recorder {
        problem,
        sign,
        history: empty_history(problem),
        progress,
    };
    let outcome = match from {
        Some(state) => optimiser::resume(&mut program, &options, &mut recorder, state),
        None => optimiser::solve(&mut program, &options, &mut recorder),
    };
    let history = recorder.history;
    let counts = program.counts;
    let start = simulate(problem, &problem.start()).ok();
    let end = simulate(problem, &unscaled(problem, &outcome.x)).ok();
    let optimum = record(
        problem,
        file,
        &outcome,
        sign,
        counts,
        [start.as_ref(), end.as_ref()],
    );
    Some(Optimisation {
        outcome,
        optimum,
        history,
        start,
        end,
    })
}

/// The history of a problem before its first iteration.
fn empty_history(problem: &Problem) -> History {
    let function = |name: &str, index: usize| Column {
        name: name.to_string(),
        unit: Some(problem.function_unit(index)),
    };
    let objective = problem.objective.map_or(0, |o| o.function);
    let variables = problem.variables.iter();
    History {
        objective: function(&problem.function_names[objective], objective),
        variables: variables
            .map(|v| Column {
                name: v.name.clone(),
                unit: Some(v.unit.clone()).filter(|unit| !unit.is_empty()),
            })
            .collect(),
        constraints: problem
            .constraints
            .iter()
            .map(|c| function(&c.name, c.function))
            .collect(),
        rows: Vec::new(),
    }
}

/// Turns the optimiser's iterations into rows of the history.
struct Recorder<'a> {
    problem: &'a Problem,
    sign: f64,
    history: History,
    progress: &'a mut dyn FnMut(&History) -> ControlFlow<()>,
}

impl Observer for Recorder<'_> {
    fn iteration(&mut self, row: &Row<'_>) -> ControlFlow<()> {
        let design = unscaled(self.problem, row.x);
        self.history.rows.push(HistoryRow {
            iteration: row.iteration,
            evaluations: row.evaluations,
            objective: self.sign * row.objective,
            infeasibility: row.infeasibility,
            optimality: row.optimality,
            barrier: row.barrier,
            step_norm: row.step,
            dual_step: row.dual_step,
            primal_step: row.primal_step,
            regularisation: row.regularisation,
            line_search_trials: row.trials,
            phase: phase_name(row.phase).to_string(),
            design,
            constraints: row.constraints.to_vec(),
        });
        (self.progress)(&self.history)
    }
}

fn phase_name(phase: Phase) -> &'static str {
    match phase {
        Phase::Regular => "regular",
        Phase::Restoration => "restoration",
        Phase::Sqp => "sqp",
    }
}

/// One word and one sentence for how the run ended.
fn verdict(status: &Status) -> (&'static str, String) {
    match status {
        Status::Converged => ("converged", "the optimality conditions hold".into()),
        Status::Infeasible {
            constraint,
            violation,
        } => (
            "infeasible",
            format!(
                "no feasible design was found: \"{constraint}\" is violated by {violation:.3e}, \
                 and no small change reduces the violation"
            ),
        ),
        Status::Unbounded => ("unbounded", "the objective improves without bound".into()),
        Status::UndefinedStart { what } => (
            "undefined_start",
            format!("the start cannot be evaluated: {what}"),
        ),
        Status::Stalled => (
            "stalled",
            "no further progress; the best design that was found is kept".into(),
        ),
        Status::IterationLimit => ("iteration_limit", "the iteration limit was reached".into()),
        Status::EvaluationLimit => (
            "evaluation_limit",
            "the evaluation limit was reached".into(),
        ),
        Status::TimeLimit => ("time_limit", "the time limit was reached".into()),
        Status::Interrupted => (
            "interrupted",
            "interrupted; the best design so far is kept".into(),
        ),
    }
}

fn record(
    problem: &Problem,
    file: &str,
    outcome: &Outcome,
    sign: f64,
    work: WorkCounts,
    ends: [Option<&Simulation>; 2],
) -> Optimum {
    let (status, sentence) = verdict(&outcome.status);
    let x = unscaled(problem, &outcome.x);
    let objective = problem
        .objective
        .expect("only a problem with an objective is optimised");
    let maximise = objective.sense == Sense::Maximise;
    let at_end = ends[1].map(|end| end.at.function(objective.function));
    let value = sign * outcome.objective;
    let start_objective =
        ends[0].map_or(value, |start| start.at.function(objective.function).value);
    let estimate = ends[1].and_then(|end| {
        estimate_errors(problem, &end.at, &[objective.function])?
            .into_iter()
            .next()
    });
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
    let mut warnings = Vec::new();
    if let Some(end) = &at_end
        && end.peak_sharpness > 1.0
    {
        warnings.push(format!(
            "the peak of \"{}\" is narrower than a step (rho x curvature x h^2 = {:.1}): refine \
             the steps or lower rho",
            problem.function_names[objective.function], end.peak_sharpness
        ));
    }
    let scaling = &outcome.scaling;
    let zero = |names: &[String], what: &str| {
        (!names.is_empty()).then(|| format!("{what} at the start: {}", names.join(", ")))
    };
    warnings.extend(zero(
        &scaling.zero_rows,
        "no variable changes these constraints",
    ));
    warnings.extend(zero(
        &scaling.zero_columns,
        "nothing depends on these variables",
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
            unit: Some(problem.function_unit(objective.function)),
            true_maximum: at_end
                .and_then(|end| end.maximum)
                .map(|(maximum, _)| maximum),
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
        constraints: constraints(problem, outcome, maximise),
        multipliers,
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
        second_order: None,
        counts: Counts {
            iterations: outcome.counts.iterations as u64,
            function_evaluations: outcome.counts.evaluations as u64,
            gradient_evaluations: outcome.counts.gradients as u64,
            failed_evaluations: outcome.counts.failures as u64,
            steps: work.steps as u64,
            newton_iterations: work.newton_iterations as u64,
            factorisations: work.factorisations as u64,
            solves: work.solves as u64,
        },
        warnings,
        version: env!("CARGO_PKG_VERSION").to_string(),
        problem: ProblemRecord {
            name: problem.name.clone(),
            file: file.to_string(),
            sha256: problem.hash.clone(),
            document: problem.document.clone(),
        },
    }
}

fn constraints(
    problem: &Problem,
    outcome: &Outcome,
    maximise: bool,
) -> IndexMap<String, ConstraintValue> {
    let active = |name: &str| {
        let found = outcome.active_constraints.iter().find(|a| a.name == name);
        found.map_or(Activity::Inactive, |a| match a.side {
            optimiser::Side::Lower => Activity::Lower,
            optimiser::Side::Upper => Activity::Upper,
            optimiser::Side::Equal => Activity::Equality,
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
                lower: Some(c.lower).filter(|b| b.is_finite()),
                upper: Some(c.upper).filter(|b| b.is_finite()),
                unit: Some(problem.function_unit(c.function)),
                multiplier,
                active: active(&c.name),
            };
            (c.name.clone(), constraint)
        })
        .collect()
}

fn active_bounds(outcome: &Outcome) -> IndexMap<String, Side> {
    let side = |a: &optimiser::ActiveBound| match a.side {
        optimiser::Side::Upper => Side::Upper,
        optimiser::Side::Lower | optimiser::Side::Equal => Side::Lower,
    };
    outcome
        .active_bounds
        .iter()
        .map(|a| (a.name.clone(), side(a)))
        .collect()
}
