//! `optimize PROBLEM`: the default job.

use super::arguments::{Course, Job};
use super::progress::show;
use super::starts::several;
use super::{
    DONE, Failure, INTERRUPTED, NOT_REACHED, NUMERICAL_FAILURE, load, print, record, tell,
};
use crate::driver::{self, Journal, Optimisation, WarmStart, figures, journal};
use crate::optimiser::{Counts, Status};
use crate::problem::Problem;
use crate::report::evaluations::{EvaluationLog, EvaluationRecord, Found};
use crate::report::{History, atomic_write, summary, write_all};
use std::cell::RefCell;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Every evaluation of the run.
const EVALUATIONS: &str = "evaluations.jsonl";
/// The history while the run goes on: the results beside it are still those of an earlier run.
const PARTIAL: &str = "history.partial.csv";
/// What another run can start from.
const STATE: &str = "state.json";

/// Optimises a problem and writes its results.
pub fn optimise(job: &Job, course: &Course) -> Result<u8, Failure> {
    let mut problem = load(job)?;
    let file = job
        .problem
        .file_name()
        .map_or_else(String::new, |n| n.to_string_lossy().into());
    complete(&problem, job)?;
    let state = match &course.from {
        Some(from) => start_from(&mut problem, from)?,
        None => None,
    };
    let directory = match (&job.output, &course.resume) {
        (Some(directory), _) | (None, Some(directory)) => directory.clone(),
        (None, None) => Path::new("results").join(&problem.name),
    };
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

    let (problem, mut done) = match course.starts {
        Some(count) => {
            // Before the work, not after it.
            std::fs::create_dir_all(&directory).map_err(|error| {
                Failure::bad_input(format!(
                    "cannot make the directory {}: {error}",
                    directory.display()
                ))
            })?;
            several(
                &problem,
                (&file, &directory),
                count as usize,
                &stopped,
                job.quiet,
            )?
        }
        None => {
            let resume = course.resume.as_deref();
            let start = (state.as_ref(), resume);
            let done = one(&problem, &file, start, &directory, &stopped, job.quiet)?;
            (problem, done)
        }
    };
    match &done.outcome.status {
        Status::UndefinedStart { what } => return Err(Failure::new(NUMERICAL_FAILURE, what)),
        Status::IllPosed { what } => return Err(Failure::bad_input(what)),
        _ => {}
    }
    if course.second_order && done.outcome.converged() {
        done.optimum.second_order =
            driver::second_order(&problem, &done.outcome).map_err(Failure::numerical)?;
    }

    let mut files = figures::of_optimisation(&problem, &done);
    let record = done.optimum.to_json();
    if let Ok(text) = &record {
        files.push(("optimum.json", text.clone().into_bytes()));
    }
    if let Ok(text) = done.history.to_csv() {
        files.push(("history.csv", text.into_bytes()));
    }
    let state = WarmStart::of(&problem, &done.outcome);
    if let Some(text) = state.and_then(|state| serde_json::to_vec(&state).ok()) {
        files.push((STATE, text));
    }
    let files: Vec<(PathBuf, Vec<u8>)> = files
        .into_iter()
        .map(|(name, bytes)| (directory.join(name), bytes))
        .collect();
    write_all(&files).map_err(Failure::bad_input)?;
    // The whole history stands beside it now; a file that stays does no harm.
    let _ = std::fs::remove_file(directory.join(PARTIAL));
    if !job.quiet {
        print(&summary(&done.optimum))?;
        tell(&times(&done.outcome.counts));
        tell(&format!("results in {}\n", directory.display()));
    }
    if let (true, Some(end)) = (job.error, &done.end) {
        print(&super::simulate::errors(&problem, &end.at)?)?;
    }
    if stopped() {
        return Ok(INTERRUPTED);
    }
    match done.outcome.status {
        Status::Converged => Ok(DONE),
        Status::Interrupted => Ok(INTERRUPTED),
        _ => {
            record.map_err(Failure::numerical)?;
            if job.quiet {
                tell(&format!("{}: {}\n", problem.name, done.optimum.message));
            }
            Ok(NOT_REACHED)
        }
    }
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
        return lacking("\"objective\"", "use optimize simulate or optimize check");
    }
    if problem.variables.is_empty() {
        return lacking("\"variables\"", "use optimize simulate");
    }
    Ok(())
}

/// Moves the start to the design of another optimum; its state, if it is there and fits.
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
    Ok(state.filter(|state| state.fits(problem)))
}

/// One optimisation, its evaluations and iterations on the disk as they happen.
fn one(
    problem: &Problem,
    file: &str,
    (state, resume): (Option<&WarmStart>, Option<&Path>),
    directory: &Path,
    stopped: &dyn Fn() -> bool,
    quiet: bool,
) -> Result<Optimisation, Failure> {
    let head = journal::head(problem);
    let path = directory.join(EVALUATIONS);
    let (mut log, earlier) = match resume {
        Some(from) if from == directory => EvaluationLog::resume(&path, &head),
        Some(from) => {
            EvaluationLog::read(&from.join(EVALUATIONS), &head).and_then(|(earlier, _)| {
                let mut log = EvaluationLog::create(&path, &head)?;
                earlier.iter().try_for_each(|known| log.append(known))?;
                Ok((log, earlier))
            })
        }
        None => EvaluationLog::create(&path, &head).map(|log| (log, Vec::new())),
    }
    .map_err(Failure::bad_input)?;
    let unwritable = RefCell::new(None);
    let mut record = |evaluation: EvaluationRecord| {
        if let (false, Found::Steps(steps)) = (quiet, &evaluation.found) {
            let count = steps.ends.len().saturating_sub(1);
            tell(&format!(
                "{count} steps by {}: {}\n",
                steps.method, steps.reason
            ));
        }
        if let Err(error) = log.append(&evaluation) {
            unwritable.borrow_mut().get_or_insert(error);
        }
    };
    let mut progress = |history: &History| {
        if !quiet {
            show(history);
        }
        let saved = history
            .to_csv()
            .and_then(|text| atomic_write(&directory.join(PARTIAL), text.as_bytes()));
        if let Err(error) = saved {
            unwritable.borrow_mut().get_or_insert(error);
        }
        if stopped() || unwritable.borrow().is_some() {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    };
    let journal = Journal::new(earlier, &mut record);
    let state = state.map(|warm| &warm.state);
    let done = driver::optimise(problem, file, state, journal, &mut progress);
    let synchronised = log.synchronise().err();
    match unwritable.into_inner().or(synchronised) {
        Some(error) => Err(Failure::bad_input(error)),
        None => done.ok_or_else(|| Failure::bad_input("nothing to optimise")),
    }
}
