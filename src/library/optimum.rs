//! Optimisation of a problem from one start or several, with logs that a later run resumes.

use super::logs::{Logs, Start, without_run};
use super::written::{PageError, draw_optimisation, write, write_page};
use crate::driver::ends::Ends;
use crate::driver::multi_start::{LocalOptimum, Run};
use crate::driver::{
    self, KnownEvaluations, Optimisation, Simulated, WarmStart, certificate, multi_start,
};
use crate::figures::report_page::page;
use crate::optimiser::Status;
use crate::problem::Problem;
use crate::report::history::HistoryRow;
use crate::report::{
    FoundOptimum, History, ReportError, optima_csv, path_between, prepare_directory, summary,
};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

/// Most starts of an optimisation.
const MOST_STARTS: usize = 1_000_000;

/// One iteration of an optimisation.
#[derive(Clone, Debug, PartialEq)]
pub struct Iteration {
    /// Its number, from 0 at the start.
    pub number: usize,
    /// Simulations so far.
    pub evaluations: usize,
    /// The objective in the user's sense.
    pub objective: f64,
    /// Largest violation of a constraint, in its unit.
    pub infeasibility: f64,
    /// Largest residual of the optimality conditions, scaled.
    pub optimality: f64,
    /// The design: one number per variable.
    pub design: Vec<f64>,
    /// Values of the constraints.
    pub constraints: Vec<f64>,
}

impl Iteration {
    fn of(row: &HistoryRow) -> Self {
        Self {
            number: row.iteration,
            evaluations: row.evaluations,
            objective: row.objective,
            infeasibility: row.infeasibility,
            optimality: row.optimality,
            design: row.design.clone(),
            constraints: row.constraints.clone(),
        }
    }
}

/// How a problem is optimised.
#[derive(Clone, Copy, Debug, Default)]
pub struct OptimisationOptions<'a> {
    /// Number of starts, spread between the bounds of the variables; `None` for that of the file alone.
    pub starts: Option<usize>,
    /// Directory of the logs, from which an interrupted run is resumed; `None` for no files.
    pub directory: Option<&'a Path>,
    /// Directory of an interrupted run whose evaluations are known.
    pub resume: Option<&'a Path>,
    /// Whether the gradients at the end are compared with the complex step.
    pub certificate: bool,
    /// The problem file, for the record.
    pub file: Option<&'a Path>,
}

/// Why an optimisation has no result.
#[derive(Debug, thiserror::Error)]
pub enum OptimisationError {
    /// The problem or an option is not one of an optimisation.
    #[error("{0}")]
    Input(String),
    /// The functions have no values at the start.
    #[error("{0}")]
    Undefined(String),
    /// Interrupted before the start had values.
    #[error("interrupted before the start had values")]
    Interrupted,
    /// A file.
    #[error(transparent)]
    File(#[from] ReportError),
    /// The page.
    #[error(transparent)]
    Page(#[from] PageError),
}

/// Finds the best design from the problem's start. It calls `progress` at every iteration, which
/// may stop the run. `None` if the problem has no variables, or neither objective nor constraints.
pub fn optimise(
    problem: &Problem,
    progress: &mut dyn FnMut(Iteration) -> ControlFlow<()>,
) -> Option<Optimum> {
    let mut seen = |history: &History| report(history, progress);
    let found = driver::optimise(problem, "", None, KnownEvaluations::default(), &mut seen)?;
    Some(Optimum {
        problem: problem.clone(),
        done: found,
        optima: None,
        beside: None,
    })
}

fn report(
    history: &History,
    progress: &mut dyn FnMut(Iteration) -> ControlFlow<()>,
) -> ControlFlow<()> {
    let Some(row) = history.rows.last() else {
        return ControlFlow::Continue(());
    };
    progress(Iteration::of(row))
}

/// As [`optimise`], from one start or several, with logs. `stopped` is asked at every iteration whether the
/// run must end; `progress` is called at every iteration of a run from one start.
///
/// # Errors
/// [`OptimisationError`]. A file that cannot be written ends the run.
pub fn optimise_with(
    problem: &Problem,
    options: &OptimisationOptions,
    stopped: &(dyn Fn() -> bool + Sync),
    progress: &mut dyn FnMut(Iteration) -> ControlFlow<()>,
) -> Result<Optimum, OptimisationError> {
    let lacking = |what: &str| {
        let what = format!("nothing to optimise: the problem has no {what}");
        Err(OptimisationError::Input(what))
    };
    if problem.objective.is_none() {
        return lacking("objective and no constraints");
    }
    if problem.variables.is_empty() {
        return lacking("variables");
    }
    // Parts on which neither objective nor constraints depend are not simulated.
    let focused = problem.for_optimisation();
    let problem = focused.as_ref().unwrap_or(problem);
    let starts = match options.starts {
        None => None,
        Some(count) if !(1..=MOST_STARTS).contains(&count) => {
            let what = format!("found {count} starts, expected 1 to {MOST_STARTS}");
            return Err(OptimisationError::Input(what));
        }
        Some(count) => Some(multi_start::starts(problem, count).map_err(|variable| {
            OptimisationError::Input(format!(
                "found the variable \"{variable}\" without two bounds, expected both for every variable: starts \
                 are spread between them"
            ))
        })?),
    };
    if let Some(from) = options.resume
        && let Some(why) = without_run(from, starts.is_some())?
    {
        return Err(OptimisationError::Input(why));
    }
    let _held = options.directory.map(prepare_directory).transpose()?;
    let logs = Logs::new(options.directory, options.resume)?;
    let name = options.file.and_then(Path::file_name);
    let name = name.map_or_else(String::new, |name| name.to_string_lossy().into());
    let mut found = match starts {
        None => from_one(problem, &name, &logs, stopped, progress)?,
        Some(starts) => from_several(problem, (&starts, &name), &logs, stopped)?,
    };
    found.beside = options.file.and_then(Path::parent).map(Path::to_path_buf);
    match &found.done.outcome.status {
        Status::UndefinedStart { what } => return Err(OptimisationError::Undefined(what.clone())),
        Status::IllPosed { what } => return Err(OptimisationError::Input(what.clone())),
        _ if !found.done.outcome.objective.is_finite() => {
            return Err(OptimisationError::Interrupted);
        }
        _ => {}
    }
    if options.certificate && !stopped() {
        let certificate = driver::certify(&found.problem, &found.done, certificate::TOLERANCE);
        found.done.optimum.gradient_certificate = Some(certificate);
    }
    Ok(found)
}

fn from_one(
    problem: &Problem,
    file: &str,
    logs: &Logs,
    stopped: &(dyn Fn() -> bool + Sync),
    progress: &mut dyn FnMut(Iteration) -> ControlFlow<()>,
) -> Result<Optimum, OptimisationError> {
    let fault = Mutex::new(None);
    let has_failed = || fault.lock().is_ok_and(|error| error.is_some());
    let mut seen = |history: &History| match stopped() || has_failed() {
        true => ControlFlow::Break(()),
        false => report(history, progress),
    };
    let known = logs
        .open(Start::Only, problem)?
        .known_evaluations(&fault, None);
    let done = driver::optimise(problem, file, None, known, &mut seen);
    if let Ok(Some(error)) = fault.into_inner() {
        return Err(error.into());
    }
    match done {
        Some(done) => Ok(Optimum {
            problem: problem.clone(),
            done,
            optima: None,
            beside: None,
        }),
        None => Err(OptimisationError::Input("nothing to optimise".to_owned())),
    }
}

fn from_several(
    problem: &Problem,
    (starts, file): (&[Vec<f64>], &str),
    logs: &Logs,
    stopped: &(dyn Fn() -> bool + Sync),
) -> Result<Optimum, OptimisationError> {
    let fault: Mutex<Option<ReportError>> = Mutex::new(None);
    let open = |k: usize, problem: &Problem| match logs.open(Start::OneOf(k), problem) {
        Ok(opened) => Some(opened.known_evaluations(&fault, None)),
        Err(error) => {
            if let Ok(mut first) = fault.lock() {
                first.get_or_insert(error);
            }
            None
        }
    };
    let has_failed = || fault.lock().is_ok_and(|error| error.is_some());
    let ended = || stopped() || has_failed();
    let mut runs = driver::multi_start(problem, starts, &ended, &open);
    let optima = found_optima(&runs, &multi_start::distinct(problem, &runs));
    let best = multi_start::best(&runs).map(|best| runs.swap_remove(best));
    drop(runs);
    if let Ok(Some(error)) = fault.into_inner() {
        return Err(error.into());
    }
    let Some(run) = best else {
        return Err(OptimisationError::Interrupted);
    };
    Ok(Optimum {
        done: run.solved.complete(&run.problem, file),
        problem: run.problem,
        optima: Some(optima),
        beside: None,
    })
}

/// The distinct optima of several runs, for their table.
pub(crate) fn found_optima(runs: &[Run], optima: &[LocalOptimum]) -> Vec<FoundOptimum> {
    let found = optima.iter().map(|optimum| {
        let run = &runs[optimum.run];
        FoundOptimum {
            start: run.start + 1,
            starts: optimum.found_by,
            objective: run.solved.objective(),
            design: run.design(),
        }
    });
    found.collect()
}

/// The end of an optimisation.
pub struct Optimum {
    problem: Problem,
    done: Optimisation,
    optima: Option<Vec<FoundOptimum>>,
    /// The folder of the problem file.
    beside: Option<PathBuf>,
}

impl Optimum {
    /// Whether the first-order conditions hold to the tolerances.
    pub fn converged(&self) -> bool {
        self.done.optimum.status == "converged"
    }

    /// The end of the run: a word such as `converged`, and a sentence.
    pub fn status(&self) -> (&str, &str) {
        (&self.done.optimum.status, &self.done.optimum.message)
    }

    /// The objective in the user's sense.
    pub fn objective(&self) -> f64 {
        self.done.optimum.objective.value
    }

    /// The design: one number per variable.
    pub fn design(&self) -> Vec<f64> {
        let design = self.done.optimum.design.values();
        design.map(|own| own.value).collect()
    }

    /// The whole record, as the command writes it to `optimum.json`; `None` if it contains a number
    /// that is not finite.
    pub fn to_json(&self) -> Option<String> {
        self.done.optimum.to_json().ok()
    }

    /// The iterations.
    pub fn history(&self) -> impl Iterator<Item = Iteration> + '_ {
        self.done.history.rows.iter().map(Iteration::of)
    }

    /// The distinct optima of several starts, best first: number of the start, number of starts that found it,
    /// objective, design. Empty for one start.
    pub fn optima(&self) -> impl Iterator<Item = (usize, usize, f64, &[f64])> {
        let all = self.optima.iter().flatten();
        all.map(|own| (own.start, own.starts, own.objective, &own.design[..]))
    }

    /// The summary that the command prints.
    pub fn summary(&self) -> String {
        summary(&self.done.optimum)
    }

    /// The page of the result; `by` says what made it.
    ///
    /// # Errors
    /// A number of the record is not finite.
    pub fn page(&self, by: &str) -> Result<String, PageError> {
        let ends = Ends::of_optimisation(&self.done);
        let of_run = Some((&self.done.optimum, &self.done.history));
        let made = (of_run, super::made::made(by));
        Ok(page(&self.problem, self.summary(), &ends, made)?)
    }

    /// Writes record, history and figures into a directory and, if `page` says what made it, the page.
    /// Returns what could not be drawn.
    ///
    /// # Errors
    /// A file cannot be written, or a number of the record is not finite.
    pub fn save(
        &mut self,
        directory: &Path,
        page: Option<&str>,
    ) -> Result<Vec<String>, OptimisationError> {
        if self.to_json().is_none() {
            let what = "a number of the record is not finite: it is not written".to_owned();
            return Err(OptimisationError::Undefined(what));
        }
        let _held = prepare_directory(directory)?;
        if let (true, Some(beside)) = (self.problem.names_files(), &self.beside) {
            self.done.optimum.problem.directory = path_between(directory, beside);
        }
        let done = &self.done;
        let state = WarmStart::of(&self.problem, &done.outcome, &done.integration);
        let history = &done.history;
        let optima = self.optima.as_ref();
        let optima = optima.map(|own| optima_csv(&history.objective, &history.variables, own));
        let (_, refused) = write(done, state, optima.transpose()?.as_deref(), directory);
        if let Some(error) = refused {
            return Err(error.into());
        }
        let missing = draw_optimisation(directory, &self.problem, done);
        if let Some(by) = page {
            let ends = Ends::of_optimisation(done);
            let of_run = Some((&done.optimum, history));
            write_page(
                directory,
                &self.problem,
                (self.summary(), by),
                &ends,
                of_run,
            )?;
        }
        Ok(missing.iter().map(ToString::to_string).collect())
    }
}

/// The page of a simulated design; `by` says what made it.
///
/// # Errors
/// The simulation fails, or a number is not finite.
pub fn page_of_design(problem: &Problem, x: &[f64], by: &str) -> Result<String, OptimisationError> {
    let undefined =
        |failure: driver::AnalysisFailure| OptimisationError::Undefined(failure.to_string());
    let simulated = Simulated::of(problem, x).map_err(undefined)?;
    let ends = Ends::of(&simulated);
    let made = (None, super::made::made(by));
    Ok(page(problem, String::new(), &ends, made).map_err(PageError::from)?)
}
