//! A problem optimised: the optimiser's outcome, its history, and the simulations at both ends.

use super::evaluate::{Evaluator, unscaled};
use super::journal::Journal;
use super::record::record;
use super::simulate::{Simulation, simulate, simulate_with};
use crate::optimiser::{self, Observer, Options, Outcome, Phase, Row, SavedState};
use crate::problem::Problem;
use crate::report::history::{Column, History, HistoryRow};
use crate::report::optimum::Optimum;
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
    options.max_evaluations = problem
        .optimiser
        .evaluations
        .unwrap_or(options.max_evaluations);
    options.max_seconds = problem.optimiser.seconds;
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
    // With the steps that its values were found with.
    let refreshes = program.integration.refreshes;
    program.integration.see_whole();
    let end = simulate_with(
        &mut program.integration,
        problem,
        &unscaled(problem, &outcome.x),
    )
    .ok();
    let optimum = record(
        problem,
        file,
        &outcome,
        sign,
        (counts, refreshes),
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
