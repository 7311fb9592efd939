//! `optimize PROBLEM --starts N`: the best of several optimisations.

use super::progress::Counter;
use super::{Failure, INTERRUPTED, print, tell};
use crate::driver;
use crate::driver::multi_start::{self, LocalOptimum, Run};
use crate::driver::ranks::{Ranks, StartLog};
use crate::library::logs::{Logs, Start, changed};
use crate::library::optimum::found_optima;
use crate::problem::Problem;
use crate::report::{ReportError, optima_csv};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// The starts of several optimisations.
pub(super) fn spread(problem: &Problem, count: u32) -> Result<Vec<Vec<f64>>, Failure> {
    multi_start::starts(problem, count as usize).map_err(|variable| {
        Failure::bad_input(format!(
            "found the variable \"{variable}\" without two bounds, expected \"lower\" and \
             \"upper\" for every variable: starts are spread between them"
        ))
    })
}

/// Optimisations from several starts: the best one, and the distinct optima as comma separated
/// values. Prints a table of them. Every evaluation is written at once, to one log per start. The
/// first failure to write ends the run and is returned with the results so far.
pub(crate) fn several(
    problem: &Problem,
    starts: &[Vec<f64>],
    records: &Logs,
    stopped: &(dyn Fn() -> bool + Sync),
    (quiet, ranks): (bool, Option<&dyn Ranks>),
) -> Result<(Run, String, Option<ReportError>), Failure> {
    let fault: Mutex<Option<ReportError>> = Mutex::new(None);
    let told = AtomicBool::new(quiet);
    let known = AtomicUsize::new(0);
    // A start that begins when all processors had one follows one that has ended.
    let processors = std::thread::available_parallelism().map_or(1, usize::from);
    let begun = AtomicUsize::new(0);
    let counter = (!quiet).then(|| Counter::new("starts done", starts.len()));
    let open = |k: usize, problem: &Problem| -> Option<StartLog<'_>> {
        if begun.fetch_add(1, Ordering::Relaxed) >= processors
            && let Some(counter) = &counter
        {
            counter.one();
        }
        match records.open(Start::OneOf(k), problem) {
            Ok(opened) => {
                known.fetch_add(opened.known, Ordering::Relaxed);
                // The changes are the same for all starts.
                if !opened.changes.is_empty() && !told.swap(true, Ordering::Relaxed) {
                    tell(&changed(&opened.changes));
                }
                Some(opened.start_log(&fault, None))
            }
            Err(error) => {
                if let Ok(mut first) = fault.lock() {
                    first.get_or_insert(error);
                }
                None
            }
        }
    };
    let has_failed = || fault.lock().is_ok_and(|error| error.is_some());
    let ended = || stopped() || has_failed();
    let mut runs = match ranks {
        Some(ranks) => {
            ranks.announce(vec![(problem.clone(), starts.to_vec())]);
            ranks.multi_start(0, None, &ended, Some(&open))
        }
        None => {
            let known = |k: usize, problem: &Problem| Some(open(k, problem)?.into());
            driver::multi_start(problem, starts, &ended, &known)
        }
    };
    drop(counter);
    let lost = fault.lock().ok().and_then(|mut first| first.take());
    if !quiet {
        tell(&records.resumed(known.load(Ordering::Relaxed)));
    }
    let optima = multi_start::distinct(problem, &runs);
    if !quiet {
        print(&table_of_optima((&runs, starts.len()), &optima))?;
    }
    let found = found_optima(&runs, &optima);
    match multi_start::best(&runs) {
        Some(best) => {
            let run = runs.swap_remove(best);
            let history = &run.solved.history;
            let text = optima_csv(&history.objective, &history.variables, &found);
            Ok((run, text.map_err(Failure::numerical)?, lost))
        }
        None if lost.is_some() => {
            Err(lost.map_or_else(|| Failure::bad_input("nothing to optimise"), Failure::from))
        }
        None if stopped() => {
            let what = "interrupted before the first evaluation";
            Err(Failure::new(INTERRUPTED, what))
        }
        None => Err(Failure::bad_input("nothing to optimise")),
    }
}

/// Variables of an optimum that its line shows.
const MOST_SHOWN: usize = 8;

/// Distinct optima, best first.
fn table_of_optima((runs, starts): (&[Run], usize), optima: &[LocalOptimum]) -> String {
    let converged: usize = optima.iter().map(|optimum| optimum.found_by).sum();
    let left_out = match starts - runs.len() {
        0 => String::new(),
        n => format!(" ({n} not begun)"),
    };
    let mut text = format!(
        "{converged} of {starts} starts converged{left_out}, to {} distinct optima\n",
        optima.len()
    );
    for (k, found) in optima.iter().enumerate() {
        let run = &runs[found.run];
        let names = run.problem.variables.iter().map(|v| &v.name);
        let all = names.zip(run.design());
        let mut design: Vec<String> = all
            .take(MOST_SHOWN)
            .map(|(name, x)| format!("{name} {x:.6}"))
            .collect();
        let rest = run.problem.variables.len().saturating_sub(MOST_SHOWN);
        if rest > 0 {
            design.push(format!("and {rest} more in optima.csv"));
        }
        text.push_str(&format!(
            "{:>4}  {} {:.8e}  from {} of the starts  {}\n",
            k + 1,
            objective(&run.problem),
            run.solved.objective(),
            found.found_by,
            design.join(", ")
        ));
    }
    text.push('\n');
    text
}

fn objective(problem: &Problem) -> &str {
    let name = |o: crate::problem::Objective| problem.function_names[o.function].as_str();
    problem.objective.map_or("", name)
}
