//! Several optimisations of one problem from spread starts, and the distinct optima they find.

use super::evaluator::unscaled;
use super::known_evaluations::KnownEvaluations;
use super::optimise::{Solved, solve};
use crate::optimiser::Options;
use crate::problem::{Problem, Sense, Variable};
use rayon::prelude::*;
use std::ops::ControlFlow;
use std::time::Instant;

/// Designs closer than this part of each variable's bounds are the same optimum.
const SAME_DESIGN: f64 = 1e-3;
/// The same for the objective, relative to the larger of its value and of the improvement by the
/// runs.
const SAME_OBJECTIVE: f64 = 1e-6;

/// One of several optimisations.
pub struct Run {
    /// The number of its start, from 0.
    pub start: usize,
    /// The problem with its start.
    pub problem: Problem,
    /// Its result.
    pub solved: Solved,
}

impl Run {
    /// The design that it ended at, in the units of the problem file.
    pub fn design(&self) -> Vec<f64> {
        unscaled(&self.problem, &self.solved.outcome.x)
    }
}

/// An optimum that at least one run found.
pub struct LocalOptimum {
    /// The run with the best value there, and the first run that ended there.
    pub run: usize,
    pub first: usize,
    /// How many runs ended there.
    pub found_by: usize,
}

/// The starts: that of the file, then points of a scrambled Sobol sequence (Burley 2020) between
/// the bounds.
///
/// # Errors
/// The name of a variable without two bounds.
pub fn starts(problem: &Problem, count: usize) -> Result<Vec<Vec<f64>>, String> {
    let open = |v: &&Variable| !(v.lower.is_finite() && v.upper.is_finite());
    if count > 1
        && let Some(variable) = problem.variables.iter().find(open)
    {
        return Err(variable.name.clone());
    }
    let spread = (1..count).map(|k| {
        let place = |(i, v): (usize, &Variable)| {
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

/// Optimises from every start, in parallel. Runs are in the order of the starts. `stopped` is
/// called before every run and after every iteration. `open` gives the log of a start, by its
/// number and problem, or `None` if there can be none; the start is then left out. The time limit
/// of the problem is that of all runs together. Starts that have not begun by then are left out,
/// except the first.
pub fn multi_start<'j>(
    problem: &Problem,
    starts: &[Vec<f64>],
    stopped: &(dyn Fn() -> bool + Sync),
    open: &'j (dyn Fn(usize, &Problem) -> Option<KnownEvaluations<'j>> + Sync),
) -> Vec<Run> {
    let begun = Instant::now();
    let run = |(start, design): (usize, &Vec<f64>)| {
        if stopped() {
            return None;
        }
        let problem = begin(problem, (start, design), begun)?;
        let log = open(start, &problem)?;
        run(start, problem, log, stopped)
    };
    starts.par_iter().enumerate().filter_map(run).collect()
}

/// The problem of a start, with what is left of the time limit of all runs, which began at `begun`. None if nothing is
/// left, except for the first start.
pub fn begin(
    problem: &Problem,
    (start, design): (usize, &[f64]),
    begun: Instant,
) -> Option<Problem> {
    let mut problem = started_at(problem, design);
    if let Some(seconds) = &mut problem.optimiser.seconds {
        *seconds = (*seconds - begun.elapsed().as_secs_f64()).max(0.0);
        if *seconds == 0.0 && start > 0 {
            return None;
        }
    }
    Some(problem)
}

/// Optimises from one start, until `stopped`.
pub fn run(
    start: usize,
    problem: Problem,
    log: KnownEvaluations<'_>,
    stopped: &dyn Fn() -> bool,
) -> Option<Run> {
    let mut progress = |_: &_| {
        if stopped() {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    };
    let solved = solve(&problem, None, log, &mut progress)?;
    Some(Run {
        start,
        problem,
        solved,
    })
}

/// Distinct optima of the converged runs, best first.
pub fn distinct(problem: &Problem, runs: &[Run]) -> Vec<LocalOptimum> {
    let size = improvement(runs);
    let worth = |run: usize| {
        let value = runs[run].solved.objective();
        match problem.objective.map(|o| o.sense) {
            Some(Sense::Maximise) => -value,
            _ => value,
        }
    };
    let mut found: Vec<LocalOptimum> = Vec::new();
    for (k, run) in runs.iter().enumerate() {
        if !run.solved.outcome.converged() {
            continue;
        }
        let known = found
            .iter_mut()
            .find(|other| same(problem, size, run, &runs[other.run]));
        match known {
            Some(other) => {
                other.found_by += 1;
                if worth(k) < worth(other.run) {
                    other.run = k;
                }
            }
            None => found.push(LocalOptimum {
                run: k,
                first: k,
                found_by: 1,
            }),
        }
    }
    found.sort_by(|a, b| worth(a.run).total_cmp(&worth(b.run)));
    found
}

/// The run with the best design: of the converged ones, else of the feasible ones, else the one
/// with the least violation.
pub fn best(runs: &[Run]) -> Option<usize> {
    let rank = |run: &Run| {
        let violation = run.solved.outcome.kkt.violation;
        let value = run.solved.outcome.objective;
        let value = if value.is_nan() { f64::INFINITY } else { value };
        let given = run.problem.optimiser.constraint_tolerance;
        let feasible = violation <= given.unwrap_or(Options::default().constraint_tolerance);
        let open = if feasible { 0.0 } else { violation };
        (!run.solved.outcome.converged(), open, value)
    };
    (0..runs.len()).min_by(|&a, &b| {
        let (a, b) = (rank(&runs[a]), rank(&runs[b]));
        let feasible = a.1.total_cmp(&b.1);
        a.0.cmp(&b.0).then(feasible).then(a.2.total_cmp(&b.2))
    })
}

/// Improvement of the objective by the converged runs: the median, which one bad start does not
/// change.
fn improvement(runs: &[Run]) -> f64 {
    let converged = runs.iter().filter(|run| run.solved.outcome.converged());
    let change = |run: &Run| {
        let first = run.solved.history.rows.first()?.objective;
        Some((first - run.solved.objective()).abs()).filter(|change| change.is_finite())
    };
    let mut changes: Vec<f64> = converged.filter_map(change).collect();
    changes.sort_by(f64::total_cmp);
    changes.get(changes.len() / 2).copied().unwrap_or(0.0)
}

/// Whether two runs ended at the same optimum. `size` is a significant change of the objective.
fn same(problem: &Problem, size: f64, a: &Run, b: &Run) -> bool {
    let (f, g) = (a.solved.objective(), b.solved.objective());
    let close = (f - g).abs() <= SAME_OBJECTIVE * f.abs().max(g.abs()).max(size);
    let designs = a.design().into_iter().zip(b.design());
    close
        && problem.variables.iter().zip(designs).all(|(v, (x, y))| {
            let range = if v.lower.is_finite() && v.upper.is_finite() {
                v.upper - v.lower
            } else {
                v.scale
            };
            (x - y).abs() <= SAME_DESIGN * range
        })
}
