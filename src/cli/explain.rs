//! `optimize explain`.

use super::arguments::Job;
use super::{DONE, Failure, load, no_page, print};
use crate::driver;
use crate::problem::{Division, Problem};
use crate::report::Explanation;
use serde_json::{Map, Value, json};

/// Reports the reductions of a problem's scenes and the reduced scene.
pub(crate) fn explain(job: &Job, json: bool) -> Result<u8, Failure> {
    if job.output.is_some() || job.error {
        let what = "found --output or --error, expected neither: optimize explain writes no files";
        return Err(Failure::bad_input(what));
    }
    no_page(job, "optimize explain")?;
    print(&explained(&load(job)?, json)?)?;
    Ok(DONE)
}

/// The explanation of a problem, and of each of its cases and phases.
fn explained(problem: &Problem, json: bool) -> Result<String, Failure> {
    let Some(cases) = &problem.cases else {
        return match problem.statics {
            Some(_) => super::statics::explained(problem, json),
            None => told(&driver::explain(problem), json),
        };
    };
    let (what, phases) = match cases.division {
        Division::Cases => ("cases", Vec::new()),
        Division::Events => {
            let found = driver::explain_phases(problem).map_err(Failure::numerical)?;
            ("phases", found)
        }
    };
    let (mut all, mut texts) = (Map::new(), String::new());
    for (c, case) in cases.list.iter().enumerate() {
        let text = match phases.get(c) {
            Some(own) => told(own, json)? + &handed_on(&case.problem, json),
            None => explained(&case.problem, json)?,
        };
        match json {
            true => {
                let own: Value = serde_json::from_str(&text).map_err(Failure::numerical)?;
                all.insert(case.name.clone(), own);
            }
            false => texts += &text,
        }
    }
    if !json {
        return Ok(texts);
    }
    let text = serde_json::to_string_pretty(&json!({what: all}));
    Ok(text.map_err(Failure::numerical)? + "\n")
}

/// What an event costs.
fn handed_on(problem: &Problem, json: bool) -> String {
    match problem.next_event() {
        Some(event) if !json => format!(
            "  event \"{event}\": {} numbers of the bodies go on to the next phase; for each function of later phases the \
             backward march has one target more\n",
            13 * problem.body_count() + 1
        ),
        _ => String::new(),
    }
}

fn told(explanation: &Explanation, json: bool) -> Result<String, Failure> {
    match json {
        true => explanation.json().map_err(Failure::numerical),
        false => Ok(explanation.text()),
    }
}
