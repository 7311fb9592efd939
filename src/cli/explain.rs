//! `optimize explain`.

use super::arguments::Job;
use super::{DONE, Failure, load, no_page, print};
use crate::driver;
use crate::problem::Problem;
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
    for case in &cases.list {
        let text = explained(&case.problem, json)?;
        match json {
            true => {
                let own: Value = serde_json::from_str(&text).map_err(Failure::numerical)?;
                all.insert(case.name.clone(), own);
            }
            false => print(&text)?,
        }
    }
    if json {
        let text = serde_json::to_string_pretty(&json!({"cases": all}));
        print(&(text.map_err(Failure::numerical)? + "\n"))?;
    }
    Ok(DONE)
}

fn explained(problem: &Problem, json: bool) -> Result<String, Failure> {
    if problem.statics.is_some() {
        return super::statics::explained(problem, json);
    }
    let explanation = driver::explain(problem);
    match json {
        true => explanation.json().map_err(Failure::numerical),
        false => Ok(explanation.text()),
    }
}
