//! Several optimisations of one problem from spread starts, and the distinct optima they find.

use super::journal::Journal;
use super::optimise::{Optimisation, optimise};
use crate::problem::{Problem, Sense};
use crate::report::evaluations::EvaluationRecord;
use rayon::prelude::*;
use std::ops::ControlFlow;

/// Designs closer than this part of each variable's bounds are the same optimum.
const SAME_DESIGN: f64 = 1e-3;
/// As for designs, for the objective, relative.
const SAME_OBJECTIVE: f64 = 1e-6;

/// Largest violation of a design that counts as feasible.
const FEASIBLE: f64 = 1e-6;

/// One of several optimisations.
pub struct Run {
    /// The problem with its start.
    pub problem: Problem,
    /// What became of it.
    pub optimisation: Optimisation,
}

/// An optimum that at least one run found.
pub struct LocalOptimum {
    /// The run that found it first.
    pub run: usize,
    /// How many runs ended there.
    pub found_by: usize,
}

/// The starts: that of the file, then points of a scrambled Sobol sequence (Burley 2020) between
/// the bounds.
///
/// # Errors
/// The name of a variable without two bounds.
pub fn starts(problem: &Problem, count: usize) -> Result<Vec<Vec<f64>>, String> {
    let open = |v: &&crate::problem::Variable| !(v.lower.is_finite() && v.upper.is_finite());
    if count > 1
        && let Some(variable) = problem.variables.iter().find(open)
    {
        return Err(variable.name.clone());
    }
    let spread = (1..count).map(|k| {
        let place = |(i, v): (usize, &crate::problem::Variable)| {
            let t = f64::from(sobol_burley::sample(k as u32 - 1, i as u32, 0));
            v.lower + t * (v.upper - v.lower)
        };
        problem.variables.iter().enumerate().map(place).collect()
    });
    Ok(std::iter::once(problem.start()).chain(spread).collect())
}

/// The problem with another start.
pub fn started_at(problem: &Problem, start: &[f64]) -> Problem {
    let mut problem = problem.clone();
    problem.restart(start);
    problem
}

/// Optimises from every start, in parallel; runs are in the order of the starts. `stopped` is
/// asked after every iteration of every run; `record` receives every evaluation with the number of
/// its start, as soon as it is known.
pub fn multi_start(
    problem: &Problem,
    file: &str,
    starts: &[Vec<f64>],
    stopped: &(dyn Fn() -> bool + Sync),
    record: &(dyn Fn(usize, EvaluationRecord) + Sync),
) -> Vec<Run> {
    let run = |(k, start): (usize, &Vec<f64>)| {
        let problem = started_at(problem, start);
        let mut write = |evaluation| record(k, evaluation);
        let journal = Journal::new(Vec::new(), &mut write);
        let mut progress = |_: &_| {
            if stopped() {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        };
        let optimisation = optimise(&problem, file, None, journal, &mut progress)?;
        Some(Run {
            problem,
            optimisation,
        })
    };
    starts.par_iter().enumerate().filter_map(run).collect()
}

/// Distinct optima of the converged runs, best first.
pub fn distinct(problem: &Problem, runs: &[Run]) -> Vec<LocalOptimum> {
    let mut found: Vec<LocalOptimum> = Vec::new();
    for (k, run) in runs.iter().enumerate() {
        if !run.optimisation.outcome.converged() {
            continue;
        }
        let known = found
            .iter_mut()
            .find(|other| same(problem, run, &runs[other.run]));
        match known {
            Some(other) => other.found_by += 1,
            None => found.push(LocalOptimum {
                run: k,
                found_by: 1,
            }),
        }
    }
    let worth = |o: &LocalOptimum| {
        let value = runs[o.run].optimisation.optimum.objective.value;
        match problem.objective.map(|o| o.sense) {
            Some(Sense::Maximise) => -value,
            _ => value,
        }
    };
    found.sort_by(|a, b| worth(a).total_cmp(&worth(b)));
    found
}

/// The run whose design is best: of the converged ones, else of the feasible ones, else the one
/// that violates its constraints least.
pub fn best(runs: &[Run]) -> Option<usize> {
    let rank = |run: &Run| {
        let violation = run.optimisation.outcome.kkt.violation;
        let value = run.optimisation.outcome.objective;
        let value = if value.is_nan() { f64::INFINITY } else { value };
        let feasible = violation <= FEASIBLE;
        let open = if feasible { 0.0 } else { violation };
        (!run.optimisation.outcome.converged(), open, value)
    };
    (0..runs.len()).min_by(|&a, &b| {
        let (a, b) = (rank(&runs[a]), rank(&runs[b]));
        let feasible = a.1.total_cmp(&b.1);
        a.0.cmp(&b.0).then(feasible).then(a.2.total_cmp(&b.2))
    })
}

fn same(problem: &Problem, a: &Run, b: &Run) -> bool {
    let (a, b) = (&a.optimisation.optimum, &b.optimisation.optimum);
    let (f, g) = (a.objective.value, b.objective.value);
    let close = (f - g).abs() <= SAME_OBJECTIVE * f.abs().max(g.abs());
    close
        && problem.variables.iter().all(|v| {
            let range = if v.lower.is_finite() && v.upper.is_finite() {
                v.upper - v.lower
            } else {
                v.scale
            };
            let (x, y) = (&a.design[&v.name], &b.design[&v.name]);
            (x.value - y.value).abs() <= SAME_DESIGN * range
        })
}
