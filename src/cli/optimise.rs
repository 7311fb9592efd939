//! `optimize PROBLEM`: the default job.

use super::arguments::Job;
use super::{DONE, Failure, INTERRUPTED, NOT_REACHED, NUMERICAL_FAILURE, load, print};
use crate::driver::{self, figures};
use crate::optimiser::Status;
use crate::report::{History, atomic_write, summary, write_all};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Optimises a problem and writes its results.
pub fn optimise(job: &Job) -> Result<u8, Failure> {
    let problem = load(job)?;
    let file = job
        .problem
        .file_name()
        .map_or_else(String::new, |n| n.to_string_lossy().into());
    let lacking = |what: &str, instead: &str| {
        Failure::bad_input(format!(
            "{}: nothing to optimise: the problem has no {what}; {instead}",
            job.problem.display()
        ))
    };
    if problem.objective.is_none() {
        return Err(lacking(
            "\"objective\"",
            "use optimize simulate or optimize check",
        ));
    }
    if problem.variables.is_empty() {
        return Err(lacking("\"variables\"", "use optimize simulate"));
    }
    let directory = job
        .output
        .clone()
        .unwrap_or_else(|| Path::new("results").join(&problem.name));
    std::fs::create_dir_all(&directory).map_err(|error| {
        Failure::bad_input(format!(
            "cannot make the directory {}: {error}",
            directory.display()
        ))
    })?;

    let stop = Arc::new(AtomicBool::new(false));
    let asked = Arc::clone(&stop);
    // A second handler in one process is refused; the first then still ends the run.
    let _ = ctrlc::set_handler(move || asked.store(true, Ordering::Relaxed));

    let mut unwritable = None;
    let mut progress = |history: &History| {
        if !job.quiet {
            show(history);
        }
        let saved = history
            .to_csv()
            .and_then(|text| atomic_write(&directory.join("history.csv"), text.as_bytes()));
        if let Err(error) = saved {
            unwritable = Some(error);
            return ControlFlow::Break(());
        }
        if stop.load(Ordering::Relaxed) {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    };
    let done = driver::optimise(&problem, &file, &mut progress)
        .ok_or_else(|| lacking("objective or variables", "use optimize simulate"))?;
    if let Some(error) = unwritable {
        return Err(Failure::bad_input(error));
    }

    if let Status::UndefinedStart { what } = done.outcome.status {
        return Err(Failure::new(NUMERICAL_FAILURE, what));
    }

    let mut files = figures::of_optimisation(&problem, &done);
    let record = done.optimum.to_json();
    if let Ok(text) = &record {
        files.push(("optimum.json", text.clone().into_bytes()));
    }
    if let Ok(text) = done.history.to_csv() {
        files.push(("history.csv", text.into_bytes()));
    }
    let files: Vec<(PathBuf, Vec<u8>)> = files
        .into_iter()
        .map(|(name, bytes)| (directory.join(name), bytes))
        .collect();
    write_all(&files).map_err(Failure::bad_input)?;
    if !job.quiet {
        print(&summary(&done.optimum))?;
        eprintln!("results in {}", directory.display());
    }
    match done.outcome.status {
        Status::Converged => Ok(DONE),
        Status::Interrupted => Ok(INTERRUPTED),
        _ => {
            record.map_err(Failure::numerical)?;
            if job.quiet {
                eprintln!("{}: {}", problem.name, done.optimum.message);
            }
            Ok(NOT_REACHED)
        }
    }
}

/// One line an iteration, with the column heads every twenty lines.
fn show(history: &History) {
    let Some(row) = history.rows.last() else {
        return;
    };
    if history.rows.len() % 20 == 1 {
        eprintln!(
            "iter      objective    inf_pr    inf_du  lg(mu)     ||d||  lg(rg)  alpha_du  alpha_pr \
             ls  evals"
        );
    }
    let logarithm = |x: f64| {
        if x > 0.0 {
            format!("{:.1}", x.log10())
        } else {
            "-".to_string()
        }
    };
    let mark = match row.phase.as_str() {
        "restoration" => "r",
        "sqp" => "s",
        _ => " ",
    };
    eprintln!(
        "{:>4}{mark} {:>13.6e}  {:>8.2e}  {:>8.2e}  {:>6}  {:>8.2e}  {:>6}  {:>8.2e}  {:>8.2e} \
         {:>2}  {:>5}",
        row.iteration,
        row.objective,
        row.infeasibility,
        row.optimality,
        logarithm(row.barrier),
        row.step_norm,
        logarithm(row.regularisation),
        row.dual_step,
        row.primal_step,
        row.line_search_trials,
        row.evaluations
    );
}
