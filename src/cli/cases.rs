//! `optimize simulate` of a problem with cases.

use super::aggregates::{add_smoothed, told};
use super::arguments::Job;
use super::error_table::add_errors;
use super::{DONE, Failure, draw, motion, print, shown, statics, tell, write_report};
use crate::driver::analysed::InCases;
use crate::driver::ends::Ends;
use crate::driver::modes::{ToldModes, told as told_modes};
use crate::driver::{Simulated, Simulation};
use crate::figures::{self, tables, tables::ReactionAxes};
use crate::problem::{Case, Division, Problem};
use crate::report::{prepare_directory, with_space, write_all};
use serde_json::{Map, Value, json};
use std::fmt::Write;
use std::path::Path;

/// Analyses all cases of a problem's start. The directory for the results is held by the caller.
pub(super) fn simulate(
    job: &Job,
    problem: &Problem,
    json: bool,
    axes: ReactionAxes,
) -> Result<u8, Failure> {
    let found = Simulated::of(problem, &problem.start()).map_err(Failure::numerical)?;
    let Simulated::Cases(all) = &found else {
        return Err(Failure::numerical("a problem without cases"));
    };
    // Its modes are found once.
    let text = match job.report || !(json || job.quiet) {
        true => summary(problem, all)?,
        false => String::new(),
    };
    if json {
        let value = as_json(job, problem, all)?;
        let text = serde_json::to_string_pretty(&value).map_err(Failure::numerical)?;
        print(&(text + "\n"))?;
    } else {
        if !job.quiet {
            print(&text)?;
        }
        if job.error {
            print(&motion::errors(problem, &found)?)?;
        }
    }
    if let Some(directory) = &job.output {
        write_files(job, directory, problem, &found, axes)?;
        if job.report {
            write_report(directory, problem, text, &Ends::of(&found), None)?;
        }
        if !job.quiet {
            tell(&format!("results in {}\n", shown(directory)));
        }
    }
    // One origin may spoil several functions, and one of a phase may have no value where none of the whole motion needs it.
    let first = match all.cases.division {
        Division::Events => problem.composition.first,
        Division::Cases => 0,
    };
    let mut lost: Vec<String> = (first..problem.function_names.len())
        .filter(|&f| !all.value(f).is_finite())
        .map(|f| all.not_finite_value(problem, f))
        .collect();
    lost.sort();
    lost.dedup();
    match lost.is_empty() {
        true => Ok(DONE),
        false => {
            let what = format!("{}: not finite: {}", problem.name, lost.join("; "));
            Err(Failure::numerical(what))
        }
    }
}

/// Writes tables and figures of a design: of cases each into a directory of its name, of phases those of the whole motion.
fn write_files(
    job: &Job,
    directory: &Path,
    problem: &Problem,
    found: &Simulated,
    axes: ReactionAxes,
) -> Result<(), Failure> {
    match found {
        Simulated::Motion(at) => motion::write_files(job, directory, (problem, at), axes)?,
        Simulated::Statics(at) => statics::write_files(job, directory, problem, at)?,
        Simulated::Cases(all) if all.cases.division == Division::Events => {
            let tables = tables::of_phases(&phases(all), axes).into_iter();
            let tables: Vec<_> = tables
                .map(|(name, bytes)| (directory.join(name), bytes))
                .collect();
            write_all(&tables)?;
            draw(directory, figures::of_phases(problem, &Ends::of(found)));
        }
        Simulated::Cases(all) => {
            for (case, at) in all.each() {
                let own = directory.join(&case.name);
                let _held = prepare_directory(&own)?;
                write_files(job, &own, &case.problem, at, axes)?;
            }
        }
    }
    Ok(())
}

/// The phases of a motion that events divide.
fn phases(all: &InCases<Simulated>) -> Vec<(&Problem, &Simulation)> {
    fn phase<'a>((case, at): (&'a Case, &'a Simulated)) -> Option<(&'a Problem, &'a Simulation)> {
        match at {
            Simulated::Motion(at) => Some((&case.problem, at)),
            Simulated::Statics(_) | Simulated::Cases(_) => None,
        }
    }
    all.each().filter_map(phase).collect()
}

/// Each case, then the functions over cases.
fn summary(problem: &Problem, all: &InCases<Simulated>) -> Result<String, Failure> {
    let of_case = |case: &Case, at: &Simulated| -> Result<String, Failure> {
        Ok(match at {
            Simulated::Motion(at) => {
                let told = modes(case, at)?;
                motion::summary(&case.problem, at, told.as_ref())
            }
            Simulated::Statics(at) => statics::summary(&case.problem, at),
            Simulated::Cases(all) => summary(&case.problem, all)?,
        })
    };
    let each: Vec<String> = all.side_by_side(of_case)?;
    let mut text = each.concat();
    let names = || {
        problem
            .function_names
            .iter()
            .enumerate()
            .skip(problem.composition.first)
    };
    let width = names().map(|(_, name)| name.chars().count()).max();
    let Some(width) = width else {
        return Ok(text);
    };
    let what = match all.cases.division {
        Division::Cases => "cases",
        Division::Events => "phases",
    };
    let _ = writeln!(text, "{}: {} {what}", problem.name, all.cases.list.len());
    for (f, name) in names() {
        let unit = with_space(Some(&problem.function_unit(f)));
        let _ = write!(text, "  {name:width$}  {:>16.9e}{unit}", all.value(f));
        text += &told(all.smoothed(f), false);
        text.push('\n');
    }
    Ok(text)
}

/// The modes that a case asks for.
fn modes(case: &Case, at: &Simulation) -> Result<Option<ToldModes>, Failure> {
    told_modes(&case.problem, &at.at.x).map_err(Failure::numerical)
}

/// Each case as by itself, and all functions.
fn as_json(job: &Job, problem: &Problem, all: &InCases<Simulated>) -> Result<Value, Failure> {
    let of_case = |case: &Case, at: &Simulated| -> Result<(String, Value), Failure> {
        let own = match at {
            Simulated::Motion(at) => {
                let told = modes(case, at)?;
                motion::as_json(&case.problem, at, (job.error, told.as_ref()))?
            }
            Simulated::Statics(at) => statics::as_json(&case.problem, at, None),
            Simulated::Cases(all) => as_json(job, &case.problem, all)?,
        };
        Ok((case.name.clone(), own))
    };
    let cases: Map<String, Value> = all.side_by_side(of_case)?.into_iter().collect();
    let which: Vec<usize> = (0..problem.function_names.len()).collect();
    let errors = match job.error {
        true => Some(
            all.estimate(problem, &which, true)
                .map_err(Failure::numerical)?,
        ),
        false => None,
    };
    let mut functions = Map::new();
    for (f, name) in problem.function_names.iter().enumerate() {
        let mut own = json!({"value": all.value(f), "unit": problem.function_unit(f)});
        if let Some(largest) = all.maximum(f) {
            own["true_maximum"] = json!({"value": largest});
        }
        if let Some(smoothed) = all.smoothed(f) {
            add_smoothed(&mut own, &smoothed, all.maximum(f).is_some());
        }
        if let Some(errors) = &errors {
            add_errors(&mut own, problem, &errors[f]);
        }
        functions.insert(name.clone(), own);
    }
    let what = match all.cases.division {
        Division::Cases => "cases",
        Division::Events => "phases",
    };
    Ok(json!({"name": problem.name, what: cases, "functions": functions}))
}
