//! `optimize PROBLEM --starts N`: the best of several optimisations.

use super::{Failure, print};
use crate::driver::multi_start::{self, LocalOptimum, Run};
use crate::driver::{self, Optimisation, journal};
use crate::problem::Problem;
use crate::report::ReportError;
use crate::report::evaluations::{EvaluationLog, EvaluationRecord};
use std::path::{Path, PathBuf};
use std::sync::Mutex;

/// File of the evaluations of the run from start `k`, counted from 1.
fn log_of(directory: &Path, k: usize) -> PathBuf {
    directory.join(format!("evaluations.start_{k}.jsonl"))
}

/// Opens the file of evaluations of every start, and removes those of an earlier call with more.
fn logs(
    problem: &Problem,
    starts: &[Vec<f64>],
    directory: &Path,
) -> Result<Vec<Mutex<EvaluationLog>>, ReportError> {
    let mut stale = starts.len() + 1;
    while std::fs::remove_file(log_of(directory, stale)).is_ok() {
        stale += 1;
    }
    let open = |(k, start): (usize, &Vec<f64>)| {
        let head = journal::head(&multi_start::started_at(problem, start));
        EvaluationLog::create(&log_of(directory, k + 1), &head).map(Mutex::new)
    };
    starts.iter().enumerate().map(open).collect()
}

/// Optimisations from several starts: the best one, after a table of the distinct optima. Every
/// evaluation is on the disk as soon as it is known, in a file for each start.
pub fn several(
    problem: &Problem,
    (file, directory): (&str, &Path),
    count: usize,
    stopped: &(dyn Fn() -> bool + Sync),
    quiet: bool,
) -> Result<(Problem, Optimisation), Failure> {
    let starts = multi_start::starts(problem, count).map_err(|variable| {
        Failure::bad_input(format!(
            "found the variable \"{variable}\" without two bounds, expected \"lower\" and \
             \"upper\" for every variable: starts are spread between them"
        ))
    })?;
    let logs = logs(problem, &starts, directory).map_err(Failure::bad_input)?;
    let unwritable: Mutex<Option<ReportError>> = Mutex::new(None);
    let has_failed = || unwritable.lock().is_ok_and(|error| error.is_some());
    let record = |k: usize, evaluation: EvaluationRecord| {
        let Ok(mut log) = logs[k].lock() else { return };
        if let Err(error) = log.append(&evaluation)
            && let Ok(mut first) = unwritable.lock()
        {
            first.get_or_insert(error);
        }
    };
    let stopped = || stopped() || has_failed();
    let mut runs = driver::multi_start(problem, file, &starts, &stopped, &record);
    if let Ok(Some(error)) = unwritable.into_inner() {
        return Err(Failure::bad_input(error));
    }
    let optima = multi_start::distinct(problem, &runs);
    if !quiet {
        print(&table_of_optima(&runs, &optima))?;
    }
    let best = multi_start::best(&runs).ok_or_else(|| Failure::bad_input("nothing to optimise"))?;
    let run = runs.swap_remove(best);
    Ok((run.problem, run.optimisation))
}

/// Distinct optima, best first.
fn table_of_optima(runs: &[Run], optima: &[LocalOptimum]) -> String {
    let converged: usize = optima.iter().map(|optimum| optimum.found_by).sum();
    let mut text = format!(
        "{} of {} starts converged, to {} distinct optima\n",
        converged,
        runs.len(),
        optima.len()
    );
    for (k, found) in optima.iter().enumerate() {
        let optimum = &runs[found.run].optimisation.optimum;
        let design: Vec<String> = optimum
            .design
            .iter()
            .map(|(name, design)| format!("{name} {:.6}", design.value))
            .collect();
        text.push_str(&format!(
            "{:>4}  {} {:.8e}  from {} of the starts  {}\n",
            k + 1,
            optimum.objective.function,
            optimum.objective.value,
            found.found_by,
            design.join(", ")
        ));
    }
    text.push('\n');
    text
}
