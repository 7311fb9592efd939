//! `optimize explain`.

use super::arguments::Job;
use super::{DONE, Failure, load, no_page, print};
use crate::driver;

/// Reports the reductions of a problem's scenes and the reduced scene.
pub(crate) fn explain(job: &Job, json: bool) -> Result<u8, Failure> {
    if job.output.is_some() || job.error {
        let what = "found --output or --error, expected neither: optimize explain writes no files";
        return Err(Failure::bad_input(what));
    }
    no_page(job, "optimize explain")?;
    let problem = load(job)?;
    if problem.statics.is_some() {
        return super::statics::explain(&problem, json);
    }
    let explanation = driver::explain(&problem);
    match json {
        true => print(&explanation.json().map_err(Failure::numerical)?)?,
        false => print(&explanation.text())?,
    }
    Ok(DONE)
}
