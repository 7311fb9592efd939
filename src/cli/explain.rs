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
    let problem = load(job)?;
    let Some(cases) = &problem.cases else {
        print(&explained(&problem, json)?)?;
        return Ok(DONE);
    };
    let mut all = Map::new();
    let phases = match cases.division {
        Division::Cases => Vec::new(),
        Division::Events => driver::explain_phases(&problem).map_err(Failure::numerical)?,
    };
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
            false => print(&text)?,
        }
    }
    if json {
        let what = match cases.division {
            Division::Cases => "cases",
            Division::Events => "phases",
        };
        let text = serde_json::to_string_pretty(&json!({what: all}));
        print(&(text.map_err(Failure::numerical)? + "\n"))?;
    }
    Ok(DONE)
}

fn explained(problem: &Problem, json: bool) -> Result<String, Failure> {
    if problem.statics.is_some() {
        return super::statics::explained(problem, json);
    }
    told(&driver::explain(problem), json)
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
