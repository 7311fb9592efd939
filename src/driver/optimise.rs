//! Optimisation of a problem: the optimiser's outcome, its history, and the simulations at both
//! ends.

use super::analysed::Simulated;
use super::chaos;
use super::evaluator::{Evaluator, Judgements, unscaled};
use super::fit;
use super::integration::Integration;
use super::known_evaluations::{KnownEvaluations, bits};
use super::record::record;
use super::resolved;
use super::shared::Shared;
use crate::optimiser::{self, Method, Observer, Options, Outcome, Phase, Row, SavedState, Status};
use crate::problem::{Case, Division, Problem};
use crate::report::evaluations::Work;
use crate::report::history::{Column, History, HistoryRow};
use crate::report::optimum::Optimum;
use std::ops::ControlFlow;
use std::sync::Arc;
use std::time::Duration;

/// Time for the simulations of both ends after an interrupt. A result that takes longer is left out.
const AFTER_INTERRUPT: Duration = Duration::from_millis(400);

/// A finished optimisation before the simulations of its figures.
pub struct Solved {
    /// The optimiser's outcome, in its scaled variables.
    pub outcome: Outcome,
    /// Every iteration.
    pub history: History,
    /// The steps in use at the end.
    pub integration: Integration,
    pub(super) sign: f64,
    pub(super) counts: Work,
    pub(super) unlowered: usize,
    pub(super) without_values: Option<String>,
    pub(super) without_gradients: Option<String>,
}

/// A finished optimisation.
pub struct Optimisation {
    /// The optimiser's outcome, in its scaled variables.
    pub outcome: Outcome,
    /// The record of the end.
    pub optimum: Optimum,
    /// Every iteration.
    pub history: History,
    /// The steps in use at the end.
    pub integration: Integration,
    /// The simulated start, unless it failed.
    pub start: Option<Simulated>,
    /// The simulated optimum, unless it failed.
    pub end: Option<Simulated>,
}

/// Optimises `problem`, from its start or from the state of another run. `log` has the known
/// evaluations. `progress` gets the history after every iteration and may stop the run.
///
/// Returns `None` if the problem has no objective or no variables.
pub fn optimise<'a>(
    problem: &'a Problem,
    file: &str,
    from: Option<&SavedState>,
    log: KnownEvaluations<'a>,
    progress: &mut dyn FnMut(&History) -> ControlFlow<()>,
) -> Option<Optimisation> {
    optimise_over(problem, file, from, log, None, progress)
}

/// As [`optimise`], over ranks, if there are any; the others call [`solve_over`].
pub fn optimise_over<'a>(
    problem: &'a Problem,
    file: &str,
    from: Option<&SavedState>,
    log: KnownEvaluations<'a>,
    ranks: Option<Arc<Shared>>,
    progress: &mut dyn FnMut(&History) -> ControlFlow<()>,
) -> Option<Optimisation> {
    Some(solve_over(problem, from, log, ranks, progress)?.complete(problem, file))
}

/// As [`optimise`], without the simulations of its ends.
pub fn solve<'a>(
    problem: &'a Problem,
    from: Option<&SavedState>,
    log: KnownEvaluations<'a>,
    progress: &mut dyn FnMut(&History) -> ControlFlow<()>,
) -> Option<Solved> {
    solve_over(problem, from, log, None, progress)
}

/// As [`solve`], over ranks, if there are any. All call it with the same problem, state and known evaluations, and end
/// with the same result.
pub fn solve_over<'a>(
    problem: &'a Problem,
    from: Option<&SavedState>,
    log: KnownEvaluations<'a>,
    ranks: Option<Arc<Shared>>,
    progress: &mut dyn FnMut(&History) -> ControlFlow<()>,
) -> Option<Solved> {
    let together = ranks.as_ref().and_then(|ranks| ranks.together());
    let together = together.map(|own| problem.together(&own.team, (&own.over, own.memory)));
    let alone = problem;
    let problem = together.as_ref().unwrap_or(alone);
    let mut program = Evaluator::shared(problem, log, ranks.clone())?;
    if problem.variables.is_empty() {
        return None;
    }
    let sign = program.sign();
    let mut recorder = Recorder {
        problem,
        sign,
        history: empty_history(problem),
        judgements: program.judgements.clone(),
        ranks: ranks.clone(),
        progress,
    };
    let options = options(problem);
    let mut run = |options: &Options, observer: &mut dyn Observer| match from {
        Some(state) => optimiser::resume(&mut program, options, observer, state),
        None => optimiser::solve(&mut program, options, observer),
    };
    let mut outcome = run(&options, &mut recorder);
    if outcome.status == Status::TimeLimit && !outcome.objective.is_finite() {
        // The start is always evaluated, so there are values to record.
        let untimed = Options {
            max_seconds: None,
            ..options
        };
        outcome = run(&untimed, &mut StartOnly(&mut recorder));
        if outcome.status == Status::Interrupted {
            outcome.status = Status::TimeLimit;
        }
    }
    if let Some(ranks) = ranks {
        ranks.end(&outcome.x);
        program.integration.leave_ranks(&alone.simulation.limits);
    }
    Some(Solved {
        outcome,
        history: recorder.history,
        sign,
        counts: program.counts(),
        unlowered: program.unlowered,
        without_values: program.without_values,
        without_gradients: program.without_gradients,
        integration: program.integration,
    })
}

/// The optimiser's settings that the file gives.
fn options(problem: &Problem) -> Options {
    let given = &problem.optimiser;
    let default = Options::default();
    let usual = match fit::fitted(problem) {
        Some(_) => Method::LeastSquares,
        None => default.method,
    };
    Options {
        method: given.method.unwrap_or(usual),
        tolerance: given.tolerance.unwrap_or(default.tolerance),
        constraint_tolerance: given
            .constraint_tolerance
            .unwrap_or(default.constraint_tolerance),
        max_iterations: given.iterations.unwrap_or(default.max_iterations),
        max_evaluations: given.evaluations.unwrap_or(default.max_evaluations),
        max_seconds: given.seconds,
        unbounded_below: given.unbounded_below.unwrap_or(default.unbounded_below),
        ..default
    }
}

impl Solved {
    /// The objective in the user's sense.
    pub fn objective(&self) -> f64 {
        self.sign * self.outcome.objective
    }

    /// Simulates both ends and makes the record.
    pub fn complete(self, problem: &Problem, file: &str) -> Optimisation {
        let refreshes = self.integration.refreshes;
        problem.simulation.limits.allow(AFTER_INTERRUPT);
        // With the steps of its values.
        let mut whole = self.integration.clone();
        whole.see_whole();
        let x = unscaled(problem, &self.outcome.x);
        let (start, end) = rayon::join(
            || Simulated::of(problem, &problem.start()),
            || Simulated::with(&mut whole, problem, &x).ok(),
        );
        let mut optimum = record(
            problem,
            file,
            &self.outcome,
            self.sign,
            (self.counts, refreshes),
            (&start, end.as_ref()),
        );
        if let Some(end) = &end {
            let all: Vec<usize> = requested(problem).collect();
            let ended = !matches!(self.outcome.status, Status::Interrupted | Status::TimeLimit);
            let start = start.as_ref().ok().filter(|_| ended);
            optimum
                .warnings
                .extend(doubtful(problem, (start, end), &all));
        }
        if let Some(end) = &end {
            match fit::of_end(problem, &self.outcome, end) {
                Ok(found) => optimum.fit = found,
                Err(failure) => (optimum.warnings).push(format!(
                    "the worth of the fitted numbers is not known: {failure}"
                )),
            }
        }
        if self.unlowered > 0 {
            optimum.warnings.push(format!(
                "{} designs do not fulfil the conditions of the reduction of the scene and ran without it",
                self.unlowered
            ));
        }
        if let (Status::Stalled, Some(reason)) = (&self.outcome.status, &self.without_values) {
            optimum.warnings.push(format!(
                "{} designs had no values, the latest because: {reason}",
                self.outcome.counts.failures
            ));
        }
        if let Some(reason) = self.without_gradients {
            optimum.warnings.push(format!(
                "some designs had no gradients, the latest because: {reason}"
            ));
        }
        Optimisation {
            outcome: self.outcome,
            optimum,
            history: self.history,
            integration: self.integration,
            start: start.ok(),
            end,
        }
    }
}

/// Why derivatives of the functions `which` at the end mean little: a chaotic motion, or steps that do not resolve them beside
/// those at the start.
fn doubtful(
    problem: &Problem,
    (start, end): (Option<&Simulated>, &Simulated),
    which: &[usize],
) -> Vec<String> {
    match end {
        Simulated::Motion(end) => {
            let chaotic = chaos::of_motion(problem, &end.at, which);
            let unresolved = match (&chaotic, start) {
                (None, Some(Simulated::Motion(start))) => {
                    resolved::at_the_end(problem, (&start.at, &end.at), which)
                }
                _ => None,
            };
            let told = chaotic.map(|found| found.to_string()).or(unresolved);
            told.into_iter().collect()
        }
        Simulated::Statics(_) => Vec::new(),
        Simulated::Cases(ends) if ends.cases.division == Division::Events => Vec::new(),
        Simulated::Cases(ends) => {
            let wanted = (ends.cases).wanted(&problem.composition.of_scene(which));
            let starts = match start {
                Some(Simulated::Cases(starts)) => &starts.list[..],
                _ => &[],
            };
            let of_case = |(c, (case, end)): (usize, (&Case, &Simulated))| {
                let start = starts.get(c).and_then(Option::as_ref);
                let told = doubtful(&case.problem, (start, end), &wanted[c]);
                told.into_iter()
                    .map(|why| case.tell(why))
                    .collect::<Vec<_>>()
            };
            ends.each().enumerate().flat_map(of_case).collect()
        }
    }
}

/// The functions of the objective and of the constraints.
pub fn requested(problem: &Problem) -> impl Iterator<Item = usize> {
    let objective = problem.objective.map(|own| own.function);
    let constraints = problem.constraints.iter().map(|own| own.function);
    objective.into_iter().chain(constraints)
}

/// The history of a problem before its first iteration.
fn empty_history(problem: &Problem) -> History {
    let function = |name: &str, index: usize| Column {
        name: name.to_string(),
        unit: Some(problem.function_unit(index)).filter(|unit| !unit.is_empty()),
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
    judgements: Judgements,
    /// The ranks over which cases are spread.
    ranks: Option<Arc<Shared>>,
    progress: &'a mut dyn FnMut(&History) -> ControlFlow<()>,
}

/// Ends a run at its start.
struct StartOnly<'a, 'b>(&'a mut Recorder<'b>);

impl Observer for StartOnly<'_, '_> {
    fn iteration(&mut self, row: &Row<'_>) -> ControlFlow<()> {
        // The run ends for any return value of the observer.
        let _ = self.0.iteration(row);
        ControlFlow::Break(())
    }
}

impl Observer for Recorder<'_> {
    fn iteration(&mut self, row: &Row<'_>) -> ControlFlow<()> {
        let design = unscaled(self.problem, row.x);
        let judged = self.judgements.borrow().get(&bits(&design)).copied();
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
            steps: judged.and_then(|judged| judged.steps),
            refreshes: judged.map(|judged| judged.refreshes),
            design,
            constraints: row.constraints.to_vec(),
        });
        match ((self.progress)(&self.history), &self.ranks) {
            // All ranks end after their next exchange.
            (ControlFlow::Break(()), Some(ranks)) => {
                ranks.wish_end();
                ControlFlow::Continue(())
            }
            (course, _) => course,
        }
    }
}

fn phase_name(phase: Phase) -> &'static str {
    match phase {
        Phase::Regular => "regular",
        Phase::Restoration => "restoration",
        Phase::Sqp => "sqp",
    }
}
