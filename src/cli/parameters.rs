//! Parameters that are not designed: `--sensitivity PATH` and `--sweep PATH=a..b,n`.

use super::arguments::Job;
use super::progress::Counter;
use super::range::Range;
use super::starts::spread;
use super::{
    DONE, Failure, INTERRUPTED, NOT_REACHED, interrupt, no_page, overrides, print, read_with,
    shown, tell,
};
use crate::driver::ranks::Ranks;
use crate::driver::{self, KnownEvaluations, Optimisation};
use crate::figures::plots;
use crate::problem::{Override, Problem};
use crate::report::optimum::Sensitivity;
use crate::report::{Sweep, prepare_directory, write_all};
use serde_json::{Value, json};
use std::path::Path;

/// A problem with one more variable: the number at a path.
pub(super) struct Parameter {
    path: String,
    problem: Problem,
}

/// The value of a number in the file and its overrides.
fn number(problem: &Problem, path: &str) -> Option<f64> {
    problem.document.pointer(path).and_then(Value::as_f64)
}

/// Refuses a path that a variable designs.
fn not_designed(problem: &Problem, option: &str, path: &str) -> Result<(), Failure> {
    let owner = (problem.variables.iter()).find(|v| v.paths.iter().any(|own| own == path));
    let Some(owner) = owner else { return Ok(()) };
    Err(Failure::bad_input(format!(
        "found {option} {path}, which the variable \"{}\" designs, expected a number that is not \
         designed",
        owner.name
    )))
}

/// The problem of a job with the number at `path` as its last variable.
pub(super) fn parameter(job: &Job, problem: &Problem, path: &str) -> Result<Parameter, Failure> {
    not_designed(problem, "--sensitivity", path)?;
    let name = path.replace('~', "~0").replace('/', "~1");
    let mut all = overrides(job)?;
    all.push(Override {
        path: format!("/variables/{name}"),
        value: match number(problem, path) {
            // A bound at the value itself fulfils every condition of the number.
            Some(value) => json!({"path": path, "lower": value}),
            None => json!({"path": path}),
        },
    });
    let problem = read_with(job, &all).map_err(|failure| {
        let message = format!("--sensitivity {path}: {}", failure.message);
        Failure::new(failure.code, message)
    })?;
    let path = path.to_owned();
    Ok(Parameter { path, problem })
}

/// Adds the sensitivities of an optimum to its record. A failure becomes a warning.
pub(super) fn add_sensitivities(done: &mut Optimisation, parameters: &[Parameter]) {
    for Parameter { path, problem } in parameters {
        let warn = |why: &str| format!("no sensitivity to {path}: {why}");
        if !done.outcome.converged() {
            let warning = warn("the run did not converge");
            done.optimum.warnings.push(warning);
            continue;
        }
        let focused = problem.for_optimisation();
        let problem = focused.as_ref().unwrap_or(problem);
        let Some(own) = problem.variables.last() else {
            continue;
        };
        match driver::sensitivity(problem, &done.outcome) {
            Ok(Some(derivative)) if derivative.is_finite() => {
                let found = Sensitivity {
                    value: own.start,
                    derivative,
                    unit: Some(own.unit.clone()).filter(|unit| !unit.is_empty()),
                };
                done.optimum.sensitivities.insert(path.clone(), found);
            }
            Ok(_) => done.optimum.warnings.push(warn("it is not finite")),
            Err(failure) => done.optimum.warnings.push(warn(&failure.to_string())),
        }
    }
}

/// A number as JSON. A whole one may be meant for a count.
fn as_json(value: f64) -> Value {
    if value.fract() == 0.0 && value.abs() < 1e15 {
        Value::from(value as i64)
    } else {
        Value::from(value)
    }
}

/// The optima so far as a table.
const TABLE: &str = "sweep.csv";
/// The same with all that a rerun needs to continue; removed at the end.
const PARTIAL: &str = "sweep.partial.json";

/// The sweep that was interrupted in a directory, as far as it is one over `problems` (values and
/// hashes). A file that cannot be read counts as none.
fn begun<'p>(
    directory: &Path,
    path: &str,
    problems: impl Iterator<Item = (f64, &'p str)>,
) -> Option<Sweep> {
    let text = std::fs::read(directory.join(PARTIAL)).ok()?;
    let found = serde_json::from_slice::<Sweep>(&text).ok();
    let mut found = found.filter(|sweep| sweep.parameter == path)?;
    found.keep_common(problems);
    (!found.optima.is_empty()).then_some(found)
}

/// Writes table, figure and partial sweep, all of them or none.
fn write(found: &Sweep, directory: &Path) -> Result<(), Failure> {
    let mut files = vec![(directory.join(TABLE), found.to_csv()?.into_bytes())];
    // Without a finite objective there is nothing to draw.
    if let Ok(figure) = plots::sweep(found) {
        files.push((directory.join("sweep.svg"), figure.into_bytes()));
    }
    let partial = serde_json::to_vec(found).map_err(Failure::numerical)?;
    files.push((directory.join(PARTIAL), partial));
    Ok(write_all(&files)?)
}

/// Optimises for each value of a parameter, each from the last optimum before and from so many `starts` of the
/// problem, the first of which is that of the file. Writes the optima so far after each value, so that an
/// interrupted sweep leaves them and the next one continues.
pub(super) fn sweep(
    job: &Job,
    base: &Problem,
    range: &Range,
    starts: u32,
    ranks: Option<&dyn Ranks>,
) -> Result<u8, Failure> {
    not_designed(base, "--sweep", &range.path)?;
    no_page(job, "--sweep")?;
    if job.accuracy.is_some() {
        return Err(Failure::bad_input(
            "found --accuracy with --sweep, expected one of them: the steps of a sweep stay equal",
        ));
    }
    // All values are read before the first run.
    let given = overrides(job)?;
    let problem = |value: f64| {
        let mut all = given.clone();
        all.push(Override {
            path: range.path.clone(),
            value: as_json(value),
        });
        read_with(job, &all)
    };
    let problems: Vec<Problem> = range.values().map(problem).collect::<Result<_, _>>()?;
    let directory = match &job.output {
        Some(directory) => directory.clone(),
        None => Path::new("results").join(&base.name),
    };
    let problems: Vec<Problem> = problems
        .into_iter()
        .map(|problem| problem.for_optimisation().unwrap_or(problem))
        .collect();
    let _held = prepare_directory(&directory)?;
    interrupt::heed();
    let hashes = problems.iter().map(|problem| problem.hash.as_str());
    let mut found = begun(&directory, &range.path, range.values().zip(hashes));
    let known = found.as_ref().map_or(0, |sweep| sweep.optima.len());
    if known > 0 && !job.quiet {
        let all = problems.len();
        tell(&format!("continues after {known} of {all} optima\n"));
    }
    let counter = (!job.quiet).then(|| Counter::new("values", problems.len() - known));
    if let Some(ranks) = ranks {
        let left = problems.iter().skip(known);
        let started = left.map(|problem| Ok((problem.clone(), spread(problem, starts)?)));
        ranks.announce(started.collect::<Result<_, Failure>>()?);
    }
    for (k, (value, problem)) in range.values().zip(problems).skip(known).enumerate() {
        let last = found.iter().flat_map(|sweep| &sweep.optima);
        let last = last.rev().find(|optimum| optimum.converged);
        let last = last.map(|optimum| optimum.design.clone());
        let from_last = last.is_some();
        let runs = match ranks {
            Some(ranks) => ranks.multi_start(k, last, &interrupt::asked, None),
            None => {
                let all: Vec<_> = last.into_iter().chain(spread(&problem, starts)?).collect();
                let unknown = |_: usize, _: &Problem| Some(KnownEvaluations::default());
                driver::multi_start(&problem, &all, &interrupt::asked, &unknown)
            }
        };
        let swept = driver::swept(&problem, value, runs, from_last);
        if interrupt::asked() {
            let table = directory.join(TABLE);
            tell(&match found.map_or(0, |sweep| sweep.optima.len()) {
                0 => "interrupted before the first optimum\n".to_owned(),
                done => format!(
                    "interrupted: {done} optima are in {}; the same command continues\n",
                    shown(&table)
                ),
            });
            return Ok(INTERRUPTED);
        }
        let Some((columns, optimum)) = swept else {
            return Err(Failure::bad_input("nothing to optimise"));
        };
        if !job.quiet {
            tell(&format!(
                "{} = {value}: {} {}, from {}\n",
                range.path, optimum.status, optimum.objective, optimum.start
            ));
        }
        let (objective, variables, constraints) = columns;
        let sweep = found.get_or_insert_with(|| Sweep {
            parameter: range.path.clone(),
            objective,
            variables,
            constraints,
            optima: Vec::new(),
        });
        sweep.optima.push(optimum);
        write(sweep, &directory)?;
        if let Some(counter) = &counter {
            counter.one();
        }
    }
    drop(counter);
    let Some(found) = found else {
        return Err(Failure::bad_input("nothing to optimise"));
    };
    // A partial sweep that stays does no harm: its optima are those of the table.
    let _ = std::fs::remove_file(directory.join(PARTIAL));
    if !job.quiet {
        print(&found.text())?;
        tell(&format!("results in {}\n", shown(&directory)));
    }
    let failed = found.optima.iter().filter(|at| !at.converged).count();
    if failed > 0 {
        let all = found.optima.len();
        tell(&format!(
            "{}: {failed} of {all} runs did not converge\n",
            base.name
        ));
        return Ok(NOT_REACHED);
    }
    Ok(DONE)
}
