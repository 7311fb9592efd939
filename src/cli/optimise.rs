//! `optimize PROBLEM`: the default job.

use super::arguments::{Job, RunOptions};
use super::earlier::start_from;
use super::one_start::one;
use super::parameters::{Parameter, add_sensitivities, parameter, sweep};
use super::starts::{several, spread};
use super::{
    DONE, Failure, INTERRUPTED, NOT_REACHED, NUMERICAL_FAILURE, interrupt, print, read, refine,
    shown, tell, warn_of_missing, write_report,
};
use crate::driver::ends::Ends;
use crate::driver::ranks::Ranks;
use crate::driver::{self, Optimisation, WarmStart, certificate};
use crate::figures;
use crate::library::logs::{Logs, Start, without_run};
use crate::library::written::{OPTIMUM, REPORT, draw_optimisation, write};
use crate::optimiser::{Counts, Status};
use crate::problem::Problem;
use crate::report::optimum::Curvature;
use crate::report::{
    ReportError, atomic_write, path_between, prepare_directory, summary, write_all,
};
use std::path::Path;
use std::sync::Mutex;
use std::time::Instant;

/// What one start finds. A variable that never moved, as all derivatives by it are zero, may be at a maximum.
fn of_one_start_only(done: &Optimisation) -> String {
    let stays =
        |name: &&String| (done.optimum.design.get(*name)).is_some_and(|x| x.value == x.start);
    let zero = done.outcome.scaling.zero_columns.iter();
    let unmoved: Vec<&str> = zero.filter(stays).map(String::as_str).collect();
    match unmoved.is_empty() {
        true => "a local optimum, as one start finds it: --starts 4 seeks better ones from other starts\n".into(),
        false => format!(
            "no derivative moved {}: this may be a saddle point or a maximum by it; --starts 4 seeks better points from other \
             starts\n",
            unmoved.join(", ")
        ),
    }
}

/// Optimises a problem and writes its results.
pub(crate) fn optimise(
    job: &Job,
    course: &RunOptions,
    ranks: Option<&dyn Ranks>,
) -> Result<u8, Failure> {
    let problem = read(job)?;
    complete(&problem, job)?;
    if let Some(ranks) = ranks {
        ranks.read_from(&job.problem);
    }
    if let Some(range) = &course.sweep {
        return sweep(job, &problem, range, course.starts.unwrap_or(1), ranks);
    }
    let parameters = course.sensitivity.iter();
    let parameters = parameters.map(|path| parameter(job, &problem, path));
    let parameters: Vec<Parameter> = parameters.collect::<Result<_, _>>()?;
    let begin = |problem: Problem| -> Result<_, Failure> {
        // Parts on which neither objective nor constraints depend are not simulated.
        let mut problem = problem.for_optimisation().unwrap_or(problem);
        let state = match &course.from {
            Some(from) => start_from(&mut problem, from)?,
            None => None,
        };
        let starts = match course.starts {
            Some(count) => Some(spread(&problem, count)?),
            None => None,
        };
        Ok((problem, state, starts))
    };
    begin(problem.clone())?;
    let directory = match (&job.output, &course.resume) {
        (Some(directory), _) | (None, Some(directory)) => directory.clone(),
        (None, None) => Path::new("results").join(&problem.name),
    };
    let resume = course.resume.as_deref();
    if let Some(from) = resume
        && let Some(why) = without_run(from, course.starts.is_some())?
    {
        return Err(Failure::bad_input(why));
    }
    let _held = prepare_directory(&directory)?;
    let (problem, state, starts) = begin(refine(job, problem)?)?;
    let records = Logs::new(Some(&directory), resume)?;
    if course.watch && !job.quiet {
        tell(&format!(
            "open {} in a browser to watch the run\n",
            shown(&directory.join(REPORT))
        ));
    }
    interrupt::heed();
    let stopped = interrupt::asked;
    let file = job
        .problem
        .file_name()
        .map_or_else(String::new, |n| n.to_string_lossy().into());
    let (problem, mut done, start, optima, lost) = match starts {
        Some(starts) => {
            let found = several(&problem, &starts, &records, &stopped, (job.quiet, ranks))?;
            let (run, optima, lost) = found;
            let done = run.solved.complete(&run.problem, &file);
            let start = Start::OneOf(run.start);
            (run.problem, done, start, Some(optima), lost)
        }
        None => {
            let (done, lost) = one(
                &problem,
                (&file, &directory),
                state.as_ref(),
                &records,
                &stopped,
                (job.quiet, course.watch),
                (ranks, course.share_bodies),
            )?;
            (problem, done, Start::Only, None, lost)
        }
    };
    if problem.names_files() {
        let beside = job.problem.parent().unwrap_or(Path::new(""));
        done.optimum.problem.directory = path_between(&directory, beside);
    }
    match (&done.outcome.status, &lost) {
        (Status::UndefinedStart { what }, None) => {
            return Err(Failure::new(NUMERICAL_FAILURE, what));
        }
        (Status::IllPosed { what }, None) => return Err(Failure::bad_input(what)),
        _ if !done.outcome.objective.is_finite() => {
            if let Some(lost) = lost {
                return Err(lost.into());
            }
            let message = &done.optimum.message;
            let what = format!("{}: {message} before the start had values", problem.name);
            let code = if stopped() { INTERRUPTED } else { NOT_REACHED };
            return Err(Failure::new(code, what));
        }
        _ => {}
    }
    let of_one_start = matches!(start, Start::Only) && done.outcome.status == Status::Converged;
    let state = WarmStart::of(&problem, &done.outcome, &done.integration);
    add_sensitivities(&mut done, &parameters);
    let (recorded, refused) = write(&done, state, optima.as_deref(), &directory);
    let mut unwritten = lost.or(refused);
    // The results are on the disk now: later failures lose nothing.
    let checked = match (course.second_order, &unwritten) {
        (true, None) => second_order(&problem, &mut done, &directory, (&records, start), &stopped),
        _ => Ok(()),
    };
    let begun = Instant::now();
    if !course.no_certificate && !stopped() {
        let found = driver::certify(&problem, &done, certificate::TOLERANCE);
        done.optimum.gradient_certificate = Some(found);
        if recorded && unwritten.is_none() {
            unwritten = renew(&done, &directory)?;
        }
    }
    let certified = begun.elapsed().as_secs_f64();
    // A failure to write is reported even if the run is quiet.
    if !job.quiet || unwritten.is_some() {
        print(&summary(&done.optimum))?;
        tell(&times(&done.outcome.counts, certified));
        if let Some(driver::Simulated::Motion(end)) = &done.end
            && let Some(note) = end.many_steps(&problem)
        {
            tell(&format!("{note}\n"));
        }
        if of_one_start {
            tell(&of_one_start_only(&done));
        }
    }
    // Figures of an earlier run belong to its record, which stays if no new one was written.
    if recorded {
        warn_of_missing(&draw_optimisation(&directory, &problem, &done));
    }
    let has_page = recorded && (job.report || course.watch);
    if recorded && !has_page {
        let _ = std::fs::remove_file(directory.join(REPORT));
    }
    if has_page {
        let ends = Ends::of_optimisation(&done);
        let of_run = Some((&done.optimum, &done.history));
        write_report(&directory, &problem, summary(&done.optimum), &ends, of_run)?;
    }
    match (&done.end, recorded && job.vtu) {
        (Some(driver::Simulated::Statics(end)), true) => {
            let fields = figures::statics::fields::fields(end).into_bytes();
            write_all(&[(directory.join("fields.vtu"), fields)])?;
        }
        (Some(driver::Simulated::Motion(end)), true) => {
            write_all(&figures::shell_fields::series(&directory, &problem, end))?;
        }
        // `optimize simulate --from` writes those of cases.
        (Some(driver::Simulated::Cases(_)) | None, _) | (_, false) => {}
    }
    if let Some(error) = unwritten {
        return Err(error.into());
    }
    if !job.quiet {
        tell(&format!("results in {}\n", shown(&directory)));
        if has_page {
            tell(&format!("page: {}\n", shown(&directory.join(REPORT))));
        }
    }
    checked?;
    if let (true, Some(end)) = (job.error, &done.end) {
        print(&super::motion::errors(&problem, end)?)?;
    }
    if stopped() {
        return Ok(INTERRUPTED);
    }
    if let Some(certificate) = &done.optimum.gradient_certificate
        && !certificate.passed
    {
        for fault in certificate.faults() {
            tell(&format!("{}: gradients: {fault}\n", problem.name));
        }
        return Ok(NOT_REACHED);
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
            done.optimum.to_json().map_err(Failure::numerical)?;
            if job.quiet {
                tell(&format!("{}: {}\n", problem.name, done.optimum.message));
            }
            Ok(NOT_REACHED)
        }
    }
}

/// Writes the record of an optimum again; returns the error of writing, if any.
fn renew(done: &Optimisation, directory: &Path) -> Result<Option<ReportError>, Failure> {
    match done.optimum.to_json() {
        Ok(text) => Ok(atomic_write(&directory.join(OPTIMUM), text.as_bytes()).err()),
        // The status of the optimum says already what the record lacks.
        Err(error) if done.outcome.converged() => Err(Failure::numerical(error)),
        Err(_) => Ok(None),
    }
}

/// Checks the curvature of a recorded optimum, and updates its record.
fn second_order(
    problem: &Problem,
    done: &mut Optimisation,
    directory: &Path,
    (records, start): (&Logs, Start),
    stopped: &dyn Fn() -> bool,
) -> Result<(), Failure> {
    if !done.outcome.converged() {
        tell("second order: not checked, as the run did not converge\n");
        return Ok(());
    }
    let opened = records.reopen(start, problem)?;
    let fault = Mutex::new(None);
    let has_failed = || fault.lock().is_ok_and(|error| error.is_some());
    let ended = || stopped() || has_failed();
    let known = opened.known_evaluations(&fault, None);
    let found = driver::second_order(problem, &done.outcome, &done.integration, known, &ended);
    if let Ok(Some(error)) = fault.into_inner() {
        return Err(error.into());
    }
    done.optimum.second_order = found.map_err(|failure| {
        Failure::numerical(format!(
            "second order: not checked: {failure}; the results are without it"
        ))
    })?;
    renew(done, directory)?.map_or(Ok(()), |error| Err(error.into()))
}

/// Report of the wall time. It is not part of the record, which is the same for equal runs.
fn times(counts: &Counts, certified: f64) -> String {
    let programs = match counts.quadratic_programs {
        0 => String::new(),
        n => format!(
            ", {n} quadratic programs {:.3} s",
            counts.quadratic_program_seconds
        ),
    };
    format!(
        "Time: {:.3} s, of it simulations and gradients {:.3} s{programs}; gradient certificate \
         {certified:.3} s\n",
        counts.seconds, counts.evaluation_seconds
    )
}

/// Rejects a problem without variables or without objective and constraints.
fn complete(problem: &Problem, job: &Job) -> Result<(), Failure> {
    let lacking = |what: &str, instead: &str| {
        Err(Failure::bad_input(format!(
            "{}: nothing to optimise: the problem has no {what}; {instead}",
            shown(&job.problem)
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
