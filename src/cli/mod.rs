//! The command line: arguments, progress, exit codes.

mod aggregates;
mod arguments;
mod cases;
mod compare;
mod earlier;
mod error_table;
mod explain;
mod installation;
pub(crate) mod interrupt;
mod modes;
mod motion;
mod new;
mod one_start;
mod optimise;
mod parameters;
pub(crate) mod progress;
mod range;
mod simulate;
mod stability;
mod starts;
mod statics;
mod unknown_word;
mod work_precision;

use crate::driver;
use crate::driver::accuracy;
use crate::driver::aggregates::{ChosenRho, Unread};
use crate::driver::ends::Ends;
use crate::driver::ranks::Ranks;
use crate::figures;
use crate::library::written::{self, PageError};
use crate::problem::{Override, Problem, visible, visible_lines};
use crate::report::{History, Optimum, ReportError, read_text};
use arguments::{Arguments, Command, Job};
use clap::Parser;
use clap::error::ErrorKind;
use std::ffi::OsString;
use std::fs::File;
use std::io;
use std::io::{IsTerminal, Read};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// The command succeeded.
const DONE: u8 = 0;
/// No convergence to an optimum, or a check or comparison failed.
const NOT_REACHED: u8 = 1;
/// Bad input.
const BAD_INPUT: u8 = 2;
/// A simulation failed.
const NUMERICAL_FAILURE: u8 = 3;
/// The system refused to read or to write a file.
const NO_ACCESS: u8 = 4;
/// Interrupted by a signal.
const INTERRUPTED: u8 = 130;

/// Why a command failed: exit code and message.
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

impl From<ReportError> for Failure {
    fn from(error: ReportError) -> Self {
        let code = match &error {
            ReportError::Write { .. } => NO_ACCESS,
            ReportError::Read { source, .. } => code_of_reading(source),
            ReportError::InUse { .. }
            | ReportError::History { .. }
            | ReportError::Evaluations { .. }
            | ReportError::Positions { .. }
            | ReportError::Optimum(_)
            | ReportError::NotFinite { .. } => BAD_INPUT,
        };
        Self::new(code, error)
    }
}

/// Exit code of a path that cannot be read: bad input if it is no text file, else no access.
fn code_of_reading(error: &io::Error) -> u8 {
    match error.kind() {
        io::ErrorKind::NotFound
        | io::ErrorKind::IsADirectory
        | io::ErrorKind::NotADirectory
        | io::ErrorKind::InvalidData => BAD_INPUT,
        _ => NO_ACCESS,
    }
}

/// Runs the command with the given arguments; the first is the program's name.
pub fn run(arguments: impl Iterator<Item = OsString>) -> ExitCode {
    ExitCode::from(run_over(arguments, None))
}

/// Runs the command; optimisations are spread over ranks, if there are several. Returns the exit code.
pub(crate) fn run_over(arguments: impl Iterator<Item = OsString>, ranks: Option<&dyn Ranks>) -> u8 {
    let mut arguments: Vec<OsString> = arguments.collect();
    // The page of the whole program fits on a screen; the manual has the rest.
    if let [_, only] = &mut arguments[..]
        && (only == "--help" || only == "help")
    {
        *only = "-h".into();
    }
    let first = arguments.get(1).cloned().unwrap_or_default();
    let arguments = match Arguments::try_parse_from(arguments) {
        Ok(arguments) => arguments,
        Err(message) => {
            // The message contains the user's text.
            let rendered = message.render();
            let shown = match visible_lines(&rendered.to_string()) == rendered.to_string() {
                // The page of the whole program is the same by both options.
                true if message.kind() == ErrorKind::DisplayHelp && first == "-h" => {
                    let text = match io::stdout().is_terminal() {
                        true => rendered.ansi().to_string(),
                        false => rendered.to_string(),
                    };
                    let text = text.replace(" (see more with '--help')", "");
                    io::Write::write_all(&mut io::stdout(), text.as_bytes())
                }
                true => message.print(),
                false => {
                    tell(&rendered.to_string());
                    Ok(())
                }
            };
            let wanted = matches!(
                message.kind(),
                ErrorKind::DisplayHelp | ErrorKind::DisplayVersion
            );
            if !wanted && let Some(hint) = unknown_word::meant(Path::new(&first)) {
                tell(&format!("\n  {hint}\n"));
            }
            return match wanted && shown.is_ok() {
                true => DONE,
                false => BAD_INPUT,
            };
        }
    };
    interrupt::listen();
    let done = match arguments.command {
        Some(Command::Completions { shell }) => installation::completions(shell),
        Some(Command::Manual) => installation::manual(),
        Some(Command::New { path, from }) => new::new(&path, from),
        Some(Command::Simulate {
            job,
            from,
            json,
            joint_axes,
        }) => simulate::simulate(&job, from.as_deref(), json, joint_axes),
        Some(Command::Check {
            job,
            from,
            tolerance,
        }) => simulate::check(&job, from.as_deref(), tolerance),
        Some(Command::Explain { job, json }) => explain::explain(&job, json),
        Some(Command::WorkPrecision(asked)) => work_precision::measure(&asked),
        Some(Command::Stability(asked)) => stability::stability(&asked),
        Some(Command::Stress { .. }) => Err(Failure::bad_input(
            "found `optimize stress`, expected `optimize stability`: the suite of extreme scenes is \
             called so now",
        )),
        Some(Command::Compare(files)) => compare::compare(&files),
        Some(Command::Plot { directory }) => compare::plot(&directory),
        Some(Command::Report { directory }) => compare::report(&directory),
        Some(Command::Schema) => compare::schema(),
        None => match arguments.job {
            Some(job) => optimise::optimise(&job, &arguments.course, ranks),
            None => Err(Failure::bad_input("no problem file; see optimize --help")),
        },
    };
    progress::hide_bar();
    match done {
        Ok(code) => code,
        Err(failure) => {
            tell(&format!("{}\n", failure.message.trim_end()));
            failure.code
        }
    }
}

/// A path as text for messages.
fn shown(path: &Path) -> String {
    visible(&path.display().to_string())
}

/// Writes progress or a fault to standard error. A failure to write is ignored.
fn tell(text: &str) {
    use std::io::Write;
    let text = visible_lines(text);
    progress::bar().suspend(|| {
        let _ = io::stderr().lock().write_all(text.as_bytes());
    });
}

/// Prints a result. A reader that closed the pipe is no failure.
fn print(text: &str) -> Result<(), Failure> {
    use std::io::Write;
    let text = visible_lines(text);
    let written = progress::bar().suspend(|| {
        let mut out = std::io::stdout().lock();
        out.write_all(text.as_bytes()).and_then(|()| out.flush())
    });
    match written {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => Err(Failure::new(
            NO_ACCESS,
            format!("cannot write the result: {error}"),
        )),
        _ => Ok(()),
    }
}

/// Writes figures. If one cannot be written, a warning follows.
fn draw(directory: &Path, figures: Vec<figures::NamedFile>) {
    warn_of_missing(&written::draw(directory, figures));
}

fn warn_of_missing(figures: &[ReportError]) {
    for error in figures {
        tell(&format!("warning: a figure is missing: {error}\n"));
    }
}

/// Reads the problem file of a job and refines its steps to the accuracy of the job.
fn load(job: &Job) -> Result<Problem, Failure> {
    refine(job, read(job)?)
}

/// Reads the problem file of a job.
fn read(job: &Job) -> Result<Problem, Failure> {
    let problem = read_with(job, &overrides(job)?)?;
    if !job.quiet {
        for note in problem.notes_of_input() {
            tell(&format!("{note}\n"));
        }
    }
    Ok(problem)
}

/// Writes the page of designs, and of the optimisation that led to the last, into a directory.
fn write_report(
    directory: &Path,
    problem: &Problem,
    summary: String,
    ends: &Ends,
    of_run: Option<(&Optimum, &History)>,
) -> Result<(), Failure> {
    let written = written::write_page(directory, problem, (summary, &command()), ends, of_run);
    written.map_err(|error| match error {
        PageError::NotFinite(error) => Failure::numerical(error),
        PageError::File(error) => error.into(),
    })
}

/// The words of the command line.
fn command() -> String {
    let words = std::env::args_os().skip(1);
    let words: Vec<String> = words.map(|word| word.to_string_lossy().into()).collect();
    format!("optimize {}", words.join(" "))
}

fn overrides(job: &Job) -> Result<Vec<Override>, Failure> {
    let given = job.set.iter().map(|text| Override::parse(text));
    given.collect::<Result<_, _>>().map_err(Failure::bad_input)
}

fn read_with(job: &Job, overrides: &[Override]) -> Result<Problem, Failure> {
    let read = |overrides: &[Override]| Problem::load(&job.problem, overrides);
    let mut chosen = |rho: &ChosenRho| {
        if !job.quiet {
            tell(&format!(
                "{rho}, chosen to be within 1 % at the start or of a limit\n"
            ));
        }
    };
    let mut problem = driver::aggregates::read(&read, overrides, &mut chosen).map_err(|unread| {
        let faults = match unread {
            Unread::Faults(faults) => faults,
            Unread::NotChosen { .. } => {
                return Failure::bad_input(format!("{}: {unread}", shown(&job.problem)));
            }
        };
        // A file that cannot be opened has another exit code than a faulty text.
        let mut byte = [0];
        let unread = File::open(&job.problem).and_then(|mut file| file.read(&mut byte));
        let unread = unread.err();
        let code = unread.map_or(BAD_INPUT, |error| code_of_reading(&error));
        match job.problem.is_file() && record(&job.problem).is_ok() {
            true => Failure::bad_input(format!(
                "{0}: found the record of an optimum, expected a problem; `optimize PROBLEM --from {0}` and `simulate` take its design, \
                 `optimize report {1}` shows it",
                shown(&job.problem),
                shown(job.problem.parent().unwrap_or(Path::new(".")))
            )),
            false => Failure::new(code, match unknown_word::meant(&job.problem) {
                Some(hint) => format!("{faults}\n  {hint}"),
                None => faults.to_string(),
            }),
        }
    })?;
    if let Some(name) = &job.case {
        problem = one_case(&problem, name, &job.problem)?;
    }
    if job.vtu && problem.statics.is_none() && !problem.has_shells() {
        return Err(Failure::bad_input(format!(
            "{}: found --vtu, expected a problem of structures or a body with \"elements\"",
            shown(&job.problem)
        )));
    }
    let progress = progress::progress();
    problem.change_all(&|own| {
        if job.no_lowering {
            own.lowering = None;
        }
        own.simulation.memory = job.memory;
        own.simulation.limits.progress = Some(progress.clone());
    });
    if !job.quiet {
        progress::watch();
    }
    Ok(problem)
}

/// The problem of a case.
fn one_case(problem: &Problem, name: &str, file: &Path) -> Result<Problem, Failure> {
    problem.case(name).cloned().ok_or_else(|| {
        let names = problem.case_names();
        let expected = match names.is_empty() {
            true => "none: the file has no \"cases\"".to_owned(),
            false => format!("one of {}", names.join(", ")),
        };
        let file = shown(file);
        Failure::bad_input(format!("{file}: found --case {name}, expected {expected}"))
    })
}

/// Refuses a problem of several cases, of which a command takes one.
fn refuse_cases(problem: &Problem, file: &Path, command: &str) -> Result<(), Failure> {
    match problem.case_names().as_slice() {
        [] => Ok(()),
        names => Err(Failure::bad_input(format!(
            "{}: found several cases, expected --case NAME: {command} takes one of {}",
            shown(file),
            names.join(", ")
        ))),
    }
}

/// Refuses --report where no page is written.
fn no_page(job: &Job, command: &str) -> Result<(), Failure> {
    match job.report {
        true => Err(Failure::bad_input(format!(
            "found --report, expected none: {command} writes no page"
        ))),
        false => Ok(()),
    }
}

/// Refines the steps of a problem to the accuracy of the job.
fn refine(job: &Job, problem: Problem) -> Result<Problem, Failure> {
    let Some(asked) = job.accuracy else {
        return Ok(problem);
    };
    if problem.statics.is_some() {
        return Err(Failure::bad_input(format!(
            "{}: found --accuracy, expected none: structures have no time steps; set the numbers of \
             elements, and see --error",
            shown(&job.problem)
        )));
    }
    refuse_cases(&problem, &job.problem, "--accuracy")?;
    let Some(objective) = problem.stated_objective() else {
        return Err(Failure::bad_input(format!(
            "{}: found --accuracy, expected a problem with an objective; set /simulation/tolerance \
             instead",
            shown(&job.problem)
        )));
    };
    let mut problem = problem;
    let (which, of) = accuracy::judged(&problem, objective.function);
    let reached = accuracy::reach(&mut problem, &which, asked).map_err(Failure::numerical)?;
    if !job.quiet {
        tell(&format!("{}\n", reached.describe(asked, of)));
    }
    let mut overrides = overrides(job)?;
    for text in reached.overrides() {
        overrides.push(Override::parse(&text).map_err(Failure::bad_input)?);
    }
    read_with(job, &overrides)
}

/// Reads a record from its file or its directory; also returns the path of the file.
fn record(path: &Path) -> Result<(PathBuf, Optimum), Failure> {
    let path = if path.is_dir() {
        let found = path.join("optimum.json");
        if !found.exists() {
            let stopped = path.join("evaluations.jsonl").exists();
            let shown = shown(path);
            return Err(Failure::bad_input(match stopped {
                true => format!(
                    "{shown}: found a run without an end, expected an optimum.json; --resume {shown} goes on with it"
                ),
                false => format!(
                    "{shown}: found no optimum.json, expected the result of an optimisation"
                ),
            }));
        }
        found
    } else {
        path.to_path_buf()
    };
    let text = read_text(&path)?;
    match Optimum::from_json(&text) {
        Ok(optimum) => Ok((path, optimum)),
        Err(error) => Err(Failure::bad_input(format!("{}: {error}", shown(&path)))),
    }
}
