//! The command line: arguments, progress, exit codes.

mod arguments;
mod compare;
mod explain;
mod optimise;
mod progress;
mod records;
mod simulate;
mod starts;
mod stress;
mod work_precision;

use crate::driver::error;
use crate::problem::{Override, Problem};
use crate::report::{Optimum, read_text};
use arguments::{Arguments, Command, Job};
use clap::Parser;
use clap::error::ErrorKind;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Done.
const DONE: u8 = 0;
/// Did not converge, or not to an optimum, or a check or comparison failed.
const NOT_REACHED: u8 = 1;
/// Bad input.
const BAD_INPUT: u8 = 2;
/// A simulation failed.
const NUMERICAL_FAILURE: u8 = 3;
/// Interrupted from the keyboard.
const INTERRUPTED: u8 = 130;

/// Why a command did not do what it was asked to.
struct Failure {
    code: u8,
    message: String,
}

impl Failure {
    fn new(code: u8, message: impl ToString) -> Self {
        Self {
            code,
            message: message.to_string(),
        }
    }

    fn bad_input(message: impl ToString) -> Self {
        Self::new(BAD_INPUT, message)
    }

    fn numerical(message: impl ToString) -> Self {
        Self::new(NUMERICAL_FAILURE, message)
    }
}

/// Runs the command with the given arguments (the first is the program's name).
pub fn run(arguments: impl Iterator<Item = OsString>) -> ExitCode {
    let arguments = match Arguments::try_parse_from(arguments) {
        Ok(arguments) => arguments,
        Err(message) => {
            let shown = message.print();
            let wanted = matches!(
                message.kind(),
                ErrorKind::DisplayHelp | ErrorKind::DisplayVersion
            );
            return ExitCode::from(if wanted && shown.is_ok() {
                DONE
            } else {
                BAD_INPUT
            });
        }
    };
    let done = match arguments.command {
        Some(Command::Simulate {
            job,
            json,
            joint_axes,
        }) => simulate::simulate(&job, json, joint_axes),
        Some(Command::Check { job, tolerance }) => simulate::check(&job, tolerance),
        Some(Command::Explain { job, json }) => explain::explain(&job, json),
        Some(Command::WorkPrecision(asked)) => work_precision::measure(&asked),
        Some(Command::Stress(asked)) => stress::stress(&asked),
        Some(Command::Compare(files)) => compare::compare(&files),
        Some(Command::Plot { directory }) => compare::plot(&directory),
        Some(Command::Schema) => compare::schema(),
        None => match arguments.job {
            Some(job) => optimise::optimise(&job, &arguments.course),
            None => Err(Failure::bad_input("no problem file; see optimize --help")),
        },
    };
    match done {
        Ok(code) => ExitCode::from(code),
        Err(failure) => {
            tell(&format!("{}\n", failure.message.trim_end()));
            ExitCode::from(failure.code)
        }
    }
}

/// Tells of progress or a fault; where nobody can be told, the work goes on.
fn tell(text: &str) {
    use std::io::Write;
    let _ = std::io::stderr().lock().write_all(text.as_bytes());
}

/// Prints a result; a reader that closed the pipe is no failure.
fn print(text: &str) -> Result<(), Failure> {
    use std::io::Write;
    let mut out = std::io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => Err(Failure::bad_input(
            format!("cannot write the result: {error}"),
        )),
        _ => Ok(()),
    }
}

/// Reads the problem file of a job, with the steps that its accuracy needs.
fn load(job: &Job) -> Result<Problem, Failure> {
    let mut overrides = job
        .set
        .iter()
        .map(|text| Override::parse(text))
        .collect::<Result<Vec<_>, _>>()
        .map_err(Failure::bad_input)?;
    let read = |overrides: &[Override]| {
        let mut problem = Problem::load(&job.problem, overrides).map_err(Failure::bad_input)?;
        if job.no_lowering {
            problem.lowering = None;
        }
        if !job.quiet {
            problem.simulation.limits.progress = Some(progress::watched());
        }
        Ok(problem)
    };
    let problem = read(&overrides)?;
    if !job.quiet {
        for redundancy in &problem.redundant {
            tell(&format!("{redundancy}\n"));
        }
    }
    let Some(accuracy) = job.accuracy else {
        return Ok(problem);
    };
    let Some(objective) = problem.stated_objective() else {
        return Err(Failure::bad_input(format!(
            "{}: found --accuracy, expected a problem with an objective; set /simulation/tolerance \
             instead",
            job.problem.display()
        )));
    };
    let reached = error::reach(&mut problem.clone(), objective.function, accuracy)
        .map_err(Failure::numerical)?;
    if !job.quiet {
        tell(&format!("{}\n", reached.describe(accuracy)));
    }
    for text in reached.overrides() {
        overrides.push(Override::parse(&text).map_err(Failure::bad_input)?);
    }
    read(&overrides)
}

/// Reads a record from its file or its directory; also says which file that is.
fn record(path: &Path) -> Result<(PathBuf, Optimum), Failure> {
    let path = if path.is_dir() {
        path.join("optimum.json")
    } else {
        path.to_path_buf()
    };
    let text = read_text(&path).map_err(Failure::bad_input)?;
    match Optimum::from_json(&text) {
        Ok(optimum) => Ok((path, optimum)),
        Err(error) => Err(Failure::bad_input(format!("{}: {error}", path.display()))),
    }
}
