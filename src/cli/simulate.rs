//! `optimize simulate` and `optimize check`.

use super::arguments::Job;
use super::earlier::start_from;
use super::motion::{all, as_json, errors_of_motion, summary, write_files};
use super::{
    DONE, Failure, NOT_REACHED, load, no_page, print, read, refine, shown, tell, write_report,
};
use crate::driver::ends::Ends;
use crate::driver::{self, CheckedDerivative, Simulation, Verdict, not_finite};
use crate::figures::tables::ReactionAxes;
use crate::library;
use crate::problem::Problem;
use crate::report::prepare_directory;
use std::fmt::Write;
use std::path::Path;

/// Simulates the start of a problem.
pub(crate) fn simulate(
    job: &Job,
    from: Option<&Path>,
    json: bool,
    joint_axes: bool,
) -> Result<u8, Failure> {
    let mut problem = read(job)?;
    if let Some(from) = from {
        start_from(&mut problem, from)?;
    }
    // The directory is locked and known to be writable before the simulation.
    let _held = match &job.output {
        Some(directory) => Some(prepare_directory(directory)?),
        None => None,
    };
    expect_directory(job)?;
    let problem = refine(job, problem)?;
    let axes = match joint_axes {
        true => ReactionAxes::Joint,
        false => ReactionAxes::Ground,
    };
    if problem.cases.is_some() {
        return super::cases::simulate(job, &problem, json, axes);
    }
    if problem.statics.is_some() {
        return super::statics::simulate(job, &problem, json);
    }
    let start = problem.start();
    let simulation = match job.error {
        // Their derivatives are told, too.
        true => driver::simulate_for_gradients(&problem, &start),
        false => driver::simulate(&problem, &start),
    };
    let simulation = simulation.map_err(Failure::numerical)?;
    let told = driver::modes::told(&problem, &start).map_err(Failure::numerical)?;
    let told = told.as_ref();
    if json {
        let all = as_json(&problem, &simulation, (job.error, told))?;
        let text = serde_json::to_string_pretty(&all).map_err(Failure::numerical)?;
        print(&(text + "\n"))?;
    } else {
        if !job.quiet {
            print(&summary(&problem, &simulation, told))?;
        }
        if job.error {
            print(&errors_of_motion(&problem, &simulation)?)?;
        }
    }
    if let Some(directory) = &job.output {
        write_files(job, directory, (&problem, &simulation), axes)?;
        if job.report {
            let text = summary(&problem, &simulation, told);
            let ends = Ends::of_motion(&simulation);
            write_report(directory, &problem, text, &ends, None)?;
        }
        if !job.quiet {
            tell(&format!("results in {}\n", shown(directory)));
        }
    }
    all_finite(&problem, &simulation)?;
    Ok(DONE)
}

/// Fails by the names of functions whose values are not finite.
fn all_finite(problem: &Problem, simulation: &Simulation) -> Result<(), Failure> {
    let value = |f: usize| simulation.at.function(f).value;
    let lost: Vec<String> = (0..problem.function_names.len())
        .filter(|&f| !value(f).is_finite())
        .map(|f| not_finite::value(problem, &simulation.at, f, value(f)))
        .collect();
    match lost.is_empty() {
        true => Ok(()),
        false => {
            let what = format!("{}: not finite: {}", problem.name, lost.join("; "));
            Err(Failure::numerical(what))
        }
    }
}

/// Refuses files that nothing says where to write.
pub(super) fn expect_directory(job: &Job) -> Result<(), Failure> {
    if let (true, Some(directory)) = (job.report, &job.output)
        && directory.join("optimum.json").is_file()
    {
        return Err(Failure::bad_input(format!(
            "{0}: found the result of an optimisation, expected another directory for the page of a simulation; \
             `optimize report {0}` writes the page of the optimisation",
            shown(directory)
        )));
    }
    let asked = [("--vtu", job.vtu), ("--report", job.report)];
    let found = asked
        .iter()
        .find(|(_, asked)| *asked && job.output.is_none());
    found.map_or(Ok(()), |(option, _)| {
        let what = format!("found {option} without --output, expected a directory for the files");
        Err(Failure::bad_input(what))
    })
}

/// Checks all gradients of a problem at its start.
pub(crate) fn check(job: &Job, from: Option<&Path>, tolerance: f64) -> Result<u8, Failure> {
    if job.output.is_some() {
        let what = "found --output, expected none: optimize check writes no files";
        return Err(Failure::bad_input(what));
    }
    no_page(job, "optimize check")?;
    let mut problem = load(job)?;
    if let Some(from) = from {
        start_from(&mut problem, from)?;
    }
    if let Some(focused) = problem.focused(&all(&problem)) {
        problem = focused;
    }
    if problem.variables.is_empty() {
        return Err(Failure::bad_input(format!(
            "{}: nothing to check: the problem has no variables",
            shown(&job.problem)
        )));
    }
    let chaos = match problem.has_scene() {
        false => None,
        true => driver::chaos(&problem, &problem.start()),
    };
    let derivatives = match (driver::check(&problem, &problem.start()), &chaos) {
        (Ok(derivatives), _) => derivatives,
        // Runs that differ by round-off diverge, and the steps of one do not suit the other.
        (Err(_), Some(chaos)) => return Err(Failure::numerical(chaos)),
        (Err(failure), None) => return Err(Failure::numerical(failure)),
    };
    // A value that is not finite may have derivatives that are.
    if problem.has_scene() {
        let found = driver::simulate(&problem, &problem.start());
        all_finite(&problem, &found.map_err(Failure::numerical)?)?;
    }
    // Where the finer run fails, the two derivatives still agree or not.
    let unresolved = library::unresolved(&problem, &problem.start());
    let names = |all: &mut dyn Iterator<Item = &String>| {
        all.map(|name| name.chars().count())
            .max()
            .unwrap_or(0)
            .max(8)
    };
    let f_width = names(&mut problem.function_names.iter());
    let v_width = names(&mut problem.variables.iter().map(|v| &v.name));
    let mut text = format!(
        "{:f_width$}  {:v_width$}  {:>23}  {:>23}  {:>10}\n",
        "function", "variable", "adjoint", "complex step", "difference"
    );
    let mut worst = 0.0_f64;
    let mut failed = 0;
    for d in &derivatives {
        let difference = d.relative_difference();
        let verdict = d.verdict(tolerance);
        failed += usize::from(verdict == Verdict::Differ);
        worst = match verdict {
            _ if difference.is_nan() => f64::NAN,
            Verdict::Agree | Verdict::Differ => worst.max(difference),
            Verdict::Nothing | Verdict::RoundOff | Verdict::Noise => worst,
        };
        let verdict = match verdict {
            Verdict::Nothing => "  zero but for round-off".to_string(),
            Verdict::Agree => String::new(),
            Verdict::RoundOff => "  differs by round-off of larger terms".to_string(),
            Verdict::Noise => {
                let moved = d.noise();
                format!("  differs by what Newton's method leaves, {moved:.1e}")
            }
            Verdict::Differ if !problem.has_scene() => "  exceeds the tolerance".to_string(),
            Verdict::Differ => {
                let moved = d.noise();
                format!(
                    "  exceeds the tolerance; where Newton's method stops moves it by {moved:.1e}"
                )
            }
        };
        let _ = writeln!(
            text,
            "{:f_width$}  {:v_width$}  {:>23.15e}  {:>23.15e}  {:>10.1e}{verdict}",
            problem.function_names[d.function],
            problem.variables[d.variable].name,
            d.adjoint,
            d.complex_step,
            difference,
        );
    }
    let _ = writeln!(
        text,
        "{} derivatives, largest relative difference {worst:.1e}, {failed} above {tolerance:.1e}",
        derivatives.len()
    );
    let noise = derivatives
        .iter()
        .filter(|d| !d.is_round_off())
        .map(CheckedDerivative::noise)
        .fold(0.0, f64::max);
    if problem.has_scene() {
        let _ = writeln!(
            text,
            "where Newton's method stops moves the derivatives by up to {noise:.1e}"
        );
    }
    if let Some(chaos) = &chaos {
        let _ = writeln!(text, "warning: {chaos}");
    }
    if let Some((advice, refused)) = unresolved.split_last() {
        for own in refused {
            let _ = writeln!(text, "refused: {own}");
        }
        let _ = writeln!(text, "{advice}");
    }
    let failed = failed > 0 || !unresolved.is_empty();
    if !job.quiet || failed {
        print(&text)?;
    }
    Ok(if failed { NOT_REACHED } else { DONE })
}
