//! `optimize PROBLEM`: the default job.

use super::arguments::{Course, Job};
use super::progress::show;
use super::records::{Records, Start, changed};
use super::starts::several;
use super::{
    DONE, Failure, INTERRUPTED, NOT_REACHED, NUMERICAL_FAILURE, load, print, record, tell,
};
use crate::driver::{self, Optimisation, WarmStart, figures, multi_start};
use crate::optimiser::{Counts, Status};
use crate::problem::Problem;
use crate::report::optimum::Curvature;
use crate::report::{
    History, HistoryLog, ReportError, atomic_write, prepare_directory, summary, write_all,
};
use std::cell::RefCell;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};

/// The record of the optimum.
const OPTIMUM: &str = "optimum.json";
/// The history while the run goes on: the results beside it are still those of an earlier run.
const PARTIAL: &str = "history.partial.csv";
/// What another run can start from.
const STATE: &str = "state.json";
/// The distinct optima of several starts.
const OPTIMA: &str = "optima.csv";

/// Optimises a problem and writes its results.
pub fn optimise(job: &Job, course: &Course) -> Result<u8, Failure> {
    let mut problem = load(job)?;
    let file = job
        .problem
        .file_name()
        .map_or_else(String::new, |n| n.to_string_lossy().into());
    complete(&problem, job)?;
    // What neither objective nor constraint sees costs nothing.
    if let Some(focused) = problem.for_optimisation() {
        problem = focused;
    }
    let state = match &course.from {
        Some(from) => start_from(&mut problem, from)?,
        None => None,
    };
    let starts = match course.starts {
        Some(count) => Some(spread(&problem, count)?),
        None => None,
    };
    let directory = match (&job.output, &course.resume) {
        (Some(directory), _) | (None, Some(directory)) => directory.clone(),
        (None, None) => Path::new("results").join(&problem.name),
    };
    let resume = course.resume.as_deref();
    if let Some(from) = resume.filter(|from| !from.is_dir()) {
        return Err(Failure::bad_input(format!(
            "found no directory {}, expected that of the run to resume; to begin one, leave --resume \
             out",
            from.display()
        )));
    }
    let _held = prepare_directory(&directory).map_err(Failure::bad_input)?;
    let records = Records::new(&directory, resume, starts.is_some())?;
    let stop = Arc::new(AtomicBool::new(false));
    let interrupted = Arc::clone(&stop);
    // A second handler in one process is refused; the first then still ends the run.
    let _ = ctrlc::set_handler(move || {
        // Asked a second time, it ends at once.
        if interrupted.swap(true, Ordering::Relaxed) {
            std::process::exit(i32::from(INTERRUPTED));
        }
    });
    let stopped = || stop.load(Ordering::Relaxed);

    let (problem, mut done, start, optima) = match starts {
        Some(starts) => {
            let (run, optima) = several(&problem, &starts, &records, &stopped, job.quiet)?;
            let done = run.solved.complete(&run.problem, &file);
            (run.problem, done, Start::OneOf(run.start), Some(optima))
        }
        None => {
            let done = one(
                &problem,
                (&file, &directory),
                state.as_ref(),
                &records,
                &stopped,
                job.quiet,
            )?;
            (problem, done, Start::Only, None)
        }
    };
    match &done.outcome.status {
        Status::UndefinedStart { what } => return Err(Failure::new(NUMERICAL_FAILURE, what)),
        Status::IllPosed { what } => return Err(Failure::bad_input(what)),
        _ if !done.outcome.objective.is_finite() => {
            let message = &done.optimum.message;
            let what = format!("{}: {message} before the start had values", problem.name);
            return Err(Failure::new(NOT_REACHED, what));
        }
        _ => {}
    }
    let recorded = write(&problem, &done, optima, &directory)?;
    // What goes wrong from here on loses nothing.
    let checked = match course.second_order {
        true => second_order(&problem, &mut done, &directory, (&records, start), &stopped),
        false => Ok(()),
    };
    if !job.quiet {
        print(&summary(&done.optimum))?;
        tell(&times(&done.outcome.counts));
        tell(&format!("results in {}\n", directory.display()));
    }
    checked?;
    if let (true, Some(end)) = (job.error, &done.end) {
        print(&super::simulate::errors(&problem, &end.at)?)?;
    }
    if stopped() {
        return Ok(INTERRUPTED);
    }
    let second = done.optimum.second_order.as_ref();
    match done.outcome.status {
        Status::Converged if second.is_some_and(|s| s.curvature == Curvature::NoOptimum) => {
            if job.quiet {
                let what = "second order: no local optimum, it improves along a free direction";
                tell(&format!("{}: {what}\n", problem.name));
            }
            Ok(NOT_REACHED)
        }
        Status::Converged => Ok(DONE),
        Status::Interrupted => Ok(INTERRUPTED),
        _ => {
            recorded.map_err(Failure::numerical)?;
            if job.quiet {
                tell(&format!("{}: {}\n", problem.name, done.optimum.message));
            }
            Ok(NOT_REACHED)
        }
    }
}

/// The starts of several optimisations.
fn spread(problem: &Problem, count: u32) -> Result<Vec<Vec<f64>>, Failure> {
    multi_start::starts(problem, count as usize).map_err(|variable| {
        Failure::bad_input(format!(
            "found the variable \"{variable}\" without two bounds, expected \"lower\" and \
             \"upper\" for every variable: starts are spread between them"
        ))
    })
}

/// Writes all results; also says why the record of the optimum could not be made, if so.
fn write(
    problem: &Problem,
    done: &Optimisation,
    optima: Option<String>,
    directory: &Path,
) -> Result<Result<(), ReportError>, Failure> {
    let mut files = figures::of_optimisation(problem, done);
    let record = done.optimum.to_json();
    if let Ok(text) = &record {
        files.push((OPTIMUM, text.clone().into_bytes()));
    }
    if let Ok(text) = done.history.to_csv() {
        files.push(("history.csv", text.into_bytes()));
    }
    let state = WarmStart::of(problem, &done.outcome);
    if let Some(text) = state.and_then(|state| serde_json::to_vec(&state).ok()) {
        files.push((STATE, text));
    }
    let several = optima.is_some();
    files.extend(optima.map(|text| (OPTIMA, text.into_bytes())));
    let files: Vec<(PathBuf, Vec<u8>)> = files
        .into_iter()
        .map(|(name, bytes)| (directory.join(name), bytes))
        .collect();
    write_all(&files).map_err(Failure::bad_input)?;
    // The whole history stands beside it now; a file that stays does no harm.
    let _ = std::fs::remove_file(directory.join(PARTIAL));
    if !several {
        // Those of an earlier run.
        let _ = std::fs::remove_file(directory.join(OPTIMA));
    }
    Ok(record.map(drop))
}

/// Checks the curvature of an optimum that is written already, and renews its record.
fn second_order(
    problem: &Problem,
    done: &mut Optimisation,
    directory: &Path,
    (records, start): (&Records, Start),
    stopped: &dyn Fn() -> bool,
) -> Result<(), Failure> {
    if !done.outcome.converged() {
        tell("second order: not checked, as the run did not converge\n");
        return Ok(());
    }
    let opened = records.reopen(start, problem).map_err(Failure::bad_input)?;
    let fault = Mutex::new(None);
    let has_failed = || fault.lock().is_ok_and(|error| error.is_some());
    let ended = || stopped() || has_failed();
    let journal = opened.journal(&fault, true);
    let found = driver::second_order(problem, &done.outcome, &done.integration, journal, &ended);
    if let Ok(Some(error)) = fault.into_inner() {
        return Err(Failure::bad_input(error));
    }
    done.optimum.second_order = found.map_err(|failure| {
        Failure::numerical(format!(
            "second order: not checked: {failure}; the results are without it"
        ))
    })?;
    let text = done.optimum.to_json().map_err(Failure::numerical)?;
    atomic_write(&directory.join(OPTIMUM), text.as_bytes()).map_err(Failure::bad_input)
}

/// Where the wall time went; not a part of the record, which is the same for the same run.
fn times(counts: &Counts) -> String {
    let programs = match counts.quadratic_programs {
        0 => String::new(),
        n => format!(
            ", {n} quadratic programs {:.3} s",
            counts.quadratic_program_seconds
        ),
    };
    format!(
        "Time: {:.3} s, of it simulations and gradients {:.3} s{programs}\n",
        counts.seconds, counts.evaluation_seconds
    )
}

/// Refuses a problem that has nothing to optimise.
fn complete(problem: &Problem, job: &Job) -> Result<(), Failure> {
    let lacking = |what: &str, instead: &str| {
        Err(Failure::bad_input(format!(
            "{}: nothing to optimise: the problem has no {what}; {instead}",
            job.problem.display()
        )))
    };
    if problem.objective.is_none() {
        let what = "\"objective\" and no \"constraints\"";
        return lacking(what, "use optimize simulate or optimize check");
    }
    if problem.variables.is_empty() {
        return lacking("\"variables\"", "use optimize simulate");
    }
    Ok(())
}

/// Moves the start to the design of another optimum; its state, if it is there, of that very design, and
/// fits.
fn start_from(problem: &mut Problem, from: &Path) -> Result<Option<WarmStart>, Failure> {
    let (record, optimum) = record(from)?;
    let mut start = problem.start();
    let mut known = 0;
    for (x, variable) in start.iter_mut().zip(&problem.variables) {
        if let Some(design) = optimum.design.get(&variable.name) {
            *x = design.value;
            known += 1;
        }
    }
    if known == 0 {
        return Err(Failure::bad_input(format!(
            "{}: found the variables {}, expected at least one of {}",
            record.display(),
            optimum
                .design
                .keys()
                .cloned()
                .collect::<Vec<_>>()
                .join(", "),
            problem
                .variables
                .iter()
                .map(|v| v.name.as_str())
                .collect::<Vec<_>>()
                .join(", ")
        )));
    }
    problem.restart(&start);
    let state = std::fs::read(record.with_file_name(STATE)).ok();
    let state = state.and_then(|text| serde_json::from_slice::<WarmStart>(&text).ok());
    Ok(state.filter(|state| state.fits(problem) && state.is_at(&start)))
}

/// One optimisation, its evaluations and iterations on the disk as they happen.
fn one(
    problem: &Problem,
    (file, directory): (&str, &Path),
    state: Option<&WarmStart>,
    records: &Records,
    stopped: &dyn Fn() -> bool,
    quiet: bool,
) -> Result<Optimisation, Failure> {
    let opened = records
        .open(Start::Only, problem)
        .map_err(Failure::bad_input)?;
    if !quiet {
        tell(&records.resumed(opened.known));
        tell(&changed(&opened.changes));
    }
    let mut log = HistoryLog::new(&directory.join(PARTIAL));
    let unwritable: RefCell<Option<ReportError>> = RefCell::new(None);
    let fault = Mutex::new(None);
    let has_failed = || fault.lock().is_ok_and(|error| error.is_some());
    let mut progress = |history: &History| {
        if !quiet {
            show(history);
        }
        if let Err(error) = log.append(history) {
            unwritable.borrow_mut().get_or_insert(error);
        }
        if stopped() || has_failed() || unwritable.borrow().is_some() {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    };
    let journal = opened.journal(&fault, quiet);
    let state = state.map(|warm| &warm.state);
    let done = driver::optimise(problem, file, state, journal, &mut progress);
    match unwritable
        .into_inner()
        .or(fault.into_inner().ok().flatten())
    {
        Some(error) => Err(Failure::bad_input(error)),
        None => done.ok_or_else(|| Failure::bad_input("nothing to optimise")),
    }
}
