//! `optimize work-precision`.

use super::arguments::{Job, Measurement};
use super::{DONE, Failure, draw, no_page, print, read, refine, refuse_cases, shown, tell};
use crate::driver::work_precision::{Campaign, work_precision};
use crate::figures::plots;
use crate::problem::Problem;
use crate::report::positions::positions_from_csv;
use crate::report::{PrecisionRow, prepare_directory, read_text, write_all};
use std::path::{Path, PathBuf};

/// Measures all methods on the start of a problem and writes the results.
pub(crate) fn measure(asked: &Measurement) -> Result<u8, Failure> {
    let job: &Job = &asked.job;
    if job.error {
        let what = "found --error, expected none: optimize work-precision measures errors itself";
        return Err(Failure::bad_input(what));
    }
    no_page(job, "optimize work-precision")?;
    let problem = read(job)?;
    refuse_cases(&problem, &job.problem, "work-precision")?;
    if problem.statics.is_some() {
        return super::statics::measure(job, &problem, asked.function.as_deref(), asked.runs);
    }
    if problem.is_rest() {
        let what =
            "found a machine at rest, expected a motion: at rest there is no step to measure";
        return Err(Failure::bad_input(what));
    }
    let plan = plan(asked, &problem)?;
    let directory = match &job.output {
        Some(directory) => directory.clone(),
        None => Path::new("results/work-precision").join(&problem.name),
    };
    let _held = prepare_directory(&directory)?;
    let problem = refine(job, problem)?;
    let without_event = without_event(&problem);
    if let (Some(note), false) = (&without_event, job.quiet) {
        tell(&format!("{note}\n"));
    }
    let mut seen = |row: &PrecisionRow| {
        if !job.quiet {
            tell(&line(row));
        }
    };
    let mut measured =
        work_precision(&problem, &problem.start(), &plan, &mut seen).map_err(Failure::numerical)?;
    measured.notes.extend(without_event);
    if !job.quiet {
        print(&measured.text())?;
    }
    let files: Vec<(PathBuf, Vec<u8>)> = [
        ("work_precision.csv", measured.to_csv()),
        ("orders.csv", measured.orders_csv()),
        ("summary.txt", measured.text()),
    ]
    .into_iter()
    .map(|(name, text)| (directory.join(name), text.into_bytes()))
    .collect();
    write_all(&files)?;
    let figure = plots::work_precision(&measured).map_err(Failure::numerical)?;
    draw(
        &directory,
        vec![("work_precision.svg", figure.into_bytes())],
    );
    if !job.quiet {
        tell(&format!("results in {}\n", shown(&directory)));
    }
    Ok(DONE)
}

/// Message about a scene that ends at an event.
fn without_event(problem: &Problem) -> Option<String> {
    let scene = problem.scene::<f64>(&problem.start());
    let until = scene.until?;
    Some(format!(
        "the motion is measured over the whole duration, {} s: the event that would end it, the {} that \
         reaches {}, is left out",
        scene.duration,
        until.describe(),
        until.value
    ))
}

fn plan(asked: &Measurement, problem: &Problem) -> Result<Campaign, Failure> {
    let function = match &asked.function {
        Some(name) => {
            let Some(index) = problem.function_names.iter().position(|own| own == name) else {
                return Err(Failure::bad_input(format!(
                    "found --function {name:?}, expected one of the functions {}",
                    problem.function_names.join(", ")
                )));
            };
            Some(index)
        }
        None => match problem.stated_objective() {
            Some(objective) => Some(objective.function),
            None => (!problem.function_names.is_empty()).then_some(0),
        },
    };
    let reference = match &asked.reference {
        Some(path) => {
            let text = read_text(path)?;
            let scene = problem.scene::<f64>(&problem.start());
            let names = scene.model.bodies.iter().map(|body| body.name.clone());
            let names: Vec<String> = names.collect();
            let positions = positions_from_csv(path, &text, &names, scene.duration)?;
            let file = path.file_name().unwrap_or(path.as_os_str());
            Some((file.to_string_lossy().into_owned(), positions))
        }
        None => None,
    };
    Ok(Campaign {
        seconds: asked.seconds,
        halvings: asked.halvings,
        runs: asked.runs as usize,
        function,
        reference,
    })
}

fn line(row: &PrecisionRow) -> String {
    let spacing = match (row.step, row.tolerance) {
        (Some(step), _) => format!("h = {step:.3e} s"),
        (None, Some(tolerance)) => format!("tol = {tolerance:.0e}"),
        (None, None) => String::new(),
    };
    let gradient = row
        .gradient_error
        .map_or_else(String::new, |error| format!("  gradient {error:.1e}"));
    format!(
        "{:22} {spacing:16} {:>8} steps  {:>9.3} ms  error {:.1e} m{gradient}\n",
        row.method,
        row.counts.steps,
        1e3 * row.cpu_seconds,
        row.error
    )
}
