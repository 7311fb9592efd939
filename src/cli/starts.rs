//! `optimize PROBLEM --starts N`: the best of several optimisations.

use super::{Failure, print};
use crate::driver::multi_start::{self, LocalOptimum, Run};
use crate::driver::{self, Optimisation};
use crate::problem::Problem;

/// Optimisations from several starts: the best one, after a table of the distinct optima.
pub fn several(
    problem: &Problem,
    file: &str,
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
    let mut runs = driver::multi_start(problem, file, &starts, stopped);
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
