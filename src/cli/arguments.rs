//! The arguments of `optimize`.

use super::new::Starter;
use super::range::{Range, range};
use clap::{Args, Parser, Subcommand};
use std::path::PathBuf;

/// The page of `--help`: the commands that most users need come first.
const PAGE: &str = "\
{about}.

Most used:
  optimize new crank --from linkage  writes crank.json, a problem file to start from
  optimize crank.json --report       finds the best design; record, figures and page in results/crank/
  optimize compare NEW BASELINE      compares two records, for CI

{usage-heading} {usage}

{all-args}

{after-help}";

/// Designs flexible multibody systems by gradient.
#[derive(Debug, Parser)]
#[command(
    name = "optimize",
    version,
    args_conflicts_with_subcommands = true,
    arg_required_else_help = true,
    help_template = PAGE,
    after_help = "More options: `optimize manual | man -l -`. Of a command: `optimize COMMAND --help`.\n\
                  Exit codes: 0 done; 1 not converged, or a check or comparison failed; 2 bad input;\n\
                  3 numerical failure; 4 a file cannot be read or written; 130 interrupted."
)]
pub(crate) struct Arguments {
    /// The command, if it is not the optimisation.
    #[command(subcommand)]
    pub command: Option<Command>,
    /// The optimisation.
    #[command(flatten)]
    pub job: Option<Job>,
    /// Start and options of the optimisation.
    #[command(flatten)]
    pub course: RunOptions,
}

/// Start and options of an optimisation.
#[derive(Args, Debug)]
pub(crate) struct RunOptions {
    /// Continues the run in this directory.
    ///
    /// It was killed, interrupted or reached a limit. Its evaluations are not repeated. Settings of the optimiser may
    /// differ.
    #[arg(long, value_name = "DIR")]
    pub resume: Option<PathBuf>,
    /// Starts from the design in another optimum.json (or its directory).
    ///
    /// Variables are found by their names. Uses the state.json in the same directory if it belongs to this design.
    #[arg(long, value_name = "FILE")]
    pub from: Option<PathBuf>,
    /// Optimises from this many starts and keeps the best.
    ///
    /// They are spread evenly between the bounds. Writes all optima to optima.csv.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pub starts: Option<u32>,
    /// Reports the derivative of the optimal objective by a number of the file.
    ///
    /// The number is not designed. It is given by a JSON Pointer as /bodies/arm/mass. May be repeated.
    #[arg(long, value_name = "PATH", hide_short_help = true)]
    pub sensitivity: Vec<String>,
    /// Optimises for n values of a number of the file from a to b.
    ///
    /// Each starts from the optimum before and from the start of the file, or from all of --starts, and the better is
    /// kept. Writes sweep.csv and sweep.svg instead of the other results.
    #[arg(long, value_name = "PATH=a..b,n", value_parser = range,
          conflicts_with_all = ["resume", "from", "second_order", "sensitivity"])]
    pub sweep: Option<Range>,
    /// Checks whether the optimum is a minimum of second order.
    ///
    /// By differences of gradients. Exit code 1 if it is not.
    #[arg(long, hide_short_help = true)]
    pub second_order: bool,
    /// Rewrites report.html after every iteration: open it in a browser to watch the run.
    ///
    /// At most once a second, with the convergence so far. A browser that has it open shows the newest every two seconds;
    /// at the end it is the report.
    #[arg(long, conflicts_with_all = ["starts", "sweep"])]
    pub watch: bool,
    /// Ranks of `optimize-mpi` compute every motion together, if bodies have 16 shells or more.
    ///
    /// Each has a part of the factors of the equations and of the forces of elements. The results are the same to the byte. It saves
    /// memory for factors, and takes longer than one rank in the scenes that were measured.
    #[arg(long, hide_short_help = true)]
    pub share_bodies: bool,
    /// Skips the certificate of the gradients.
    ///
    /// It compares one directional derivative of every function by the adjoint with the complex step, at start and
    /// optimum; exit code 1 if they differ.
    #[arg(long, hide_short_help = true)]
    pub no_certificate: bool,
}

/// A problem file and common options.
#[derive(Args, Clone, Debug)]
pub(crate) struct Job {
    /// Problem file (JSON).
    pub problem: PathBuf,
    /// Directory for the results.
    ///
    /// Default: results/<name of the problem>, for `work-precision` results/work-precision/<name>; `simulate` writes
    /// files only if this is given.
    #[arg(long, short)]
    pub output: Option<PathBuf>,
    /// No progress and no summary.
    #[arg(long, short)]
    pub quiet: bool,
    /// Changes one value of the file for this run, as in /bodies/arm/mass=42.
    ///
    /// By a JSON Pointer and a JSON value. May be repeated.
    #[arg(long, value_name = "PATH=VALUE")]
    pub set: Vec<String>,
    /// Limits the memory for the data that gradients need: 500MB, 2GiB.
    ///
    /// A gradient repeats steps that are not stored, at most twenty times. The memory for this is used even if the limit
    /// is smaller; see `optimize explain`. Default: half of the available memory.
    #[arg(long, value_name = "SIZE", value_parser = bytes, hide_short_help = true)]
    pub memory: Option<usize>,
    /// Takes one case of the file alone, without objective: to simulate, check, explain or measure it.
    #[arg(long, value_name = "NAME", hide_short_help = true)]
    pub case: Option<String>,
    /// Integrates the scene as written, without reductions.
    #[arg(long, hide_short_help = true)]
    pub no_lowering: bool,
    /// Reports the estimated error of every function and of its gradient.
    ///
    /// The error of the discretisation in time, by a second simulation with steps of half the size; that of bases of
    /// flexible bodies, by one with all nodes and more functions of beams; and what the smoothing of contacts, stops, cables,
    /// friction and drag changes, by one with half the widths.
    #[arg(long)]
    pub error: bool,
    /// Writes the fields of structures to fields.vtu, for ParaView and meshio.
    ///
    /// Of shells that move it writes fields_0000.vtu and so on, at most 101 instants, and their list fields.pvd.
    #[arg(long, hide_short_help = true)]
    pub vtu: bool,
    /// Writes report.html beside the results, one page to open or to send.
    ///
    /// It shows the machine in motion, tables and curves, in any browser, without a network.
    #[arg(long)]
    pub report: bool,
    /// Refines steps, samples and reduced bases to this relative error of the objective.
    ///
    /// The error is estimated at the start. They are never coarser than in the file.
    #[arg(long, value_name = "ERROR", value_parser = positive, hide_short_help = true)]
    pub accuracy: Option<f64>,
}

/// The other commands.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Write a problem file to start from.
    New {
        /// The file, with or without .json. Its name becomes that of the problem.
        path: PathBuf,
        /// The machine.
        #[arg(long, value_enum, default_value_t = Starter::Pendulum)]
        from: Starter,
    },
    /// Simulate the start, or a recorded design: functions, energy, drift.
    ///
    /// With --output it draws the motion and writes simulation.csv (energy, momentum, drift, joint reactions), motion.csv
    /// (all bodies) and functions.csv (all quantities) over time.
    Simulate {
        /// The problem.
        #[command(flatten)]
        job: Job,
        /// Takes the design of an optimum.json (or its directory), by names of variables.
        #[arg(long, value_name = "FILE")]
        from: Option<PathBuf>,
        /// Prints JSON.
        #[arg(long)]
        json: bool,
        /// Writes joint reactions in the axes e1, e2, e3 of each joint on its first body instead of
        /// ground axes; e3 is the joint's axis.
        #[arg(long)]
        joint_axes: bool,
    },
    /// Compare every derivative by the adjoint with the complex step.
    Check {
        /// The problem.
        #[command(flatten)]
        job: Job,
        /// Takes the design of an optimum.json (or its directory), by names of variables.
        #[arg(long, value_name = "FILE")]
        from: Option<PathBuf>,
        /// Largest relative difference that passes.
        #[arg(long, default_value_t = 1e-10, value_parser = positive)]
        tolerance: f64,
    },
    /// Report what the scene contains, and what is left out and why.
    ///
    /// Reductions, and the reduced scene: unknowns, elimination, method, memory, and the dependencies of the functions.
    Explain {
        /// The problem.
        #[command(flatten)]
        job: Job,
        /// Prints JSON.
        #[arg(long)]
        json: bool,
    },
    /// Measure error against run time for all methods and steps.
    ///
    /// All orders and tolerances. Writes work_precision.csv, orders.csv and work_precision.svg.
    WorkPrecision(Measurement),
    /// Run the program on extreme scenes and check its results.
    ///
    /// Writes stability.md and stability.csv. Exit code 1 if a result is wrong without a warning.
    Stability(Suite),
    /// The former name of `stability`.
    #[command(hide = true, disable_help_flag = true)]
    Stress {
        /// The remaining arguments.
        #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
        rest: Vec<std::ffi::OsString>,
    },
    /// Compare two records; exit code 1 if they differ beyond tolerance.
    Compare(Comparison),
    /// Draw the figures of a result directory again, from its record.
    Plot {
        /// Directory with optimum.json and history.csv.
        directory: PathBuf,
    },
    /// Write report.html into a result directory, from its record.
    ///
    /// It shows the machine in motion, tables and curves.
    Report {
        /// Directory with optimum.json and history.csv.
        directory: PathBuf,
    },
    /// Print completions for a shell.
    Completions {
        /// The shell.
        shell: clap_complete::Shell,
    },
    /// Print the manual page, in the format of man.
    Manual,
    /// Print the JSON Schema of problem files.
    Schema,
}

/// Options of `work-precision`.
#[derive(Args, Debug)]
pub(crate) struct Measurement {
    /// The problem.
    #[command(flatten)]
    pub job: Job,
    /// CPU time of the runs of one method with equal steps, or with adaptive ones [s].
    #[arg(long, default_value_t = 8.0, value_parser = positive)]
    pub seconds: f64,
    /// Largest number of halvings of a method's equal step. With many --seconds, the measured steps
    /// do not depend on the speed of the machine.
    #[arg(long, value_name = "N", default_value_t = crate::driver::work_precision::HALVINGS, value_parser = clap::value_parser!(u32).range(1..=22))]
    pub halvings: u32,
    /// Number of runs of which the fastest counts. One more run comes first and does not count.
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub runs: u32,
    /// Table of exact positions (CSV: time,body,x,y,z in s and m). The rows at the end of the
    /// motion are compared. Without it, a run with a tight tolerance is the reference.
    #[arg(long, value_name = "FILE")]
    pub reference: Option<PathBuf>,
    /// Function whose gradient is measured [default: the objective, or the first function].
    #[arg(long, value_name = "NAME")]
    pub function: Option<String>,
}

/// Options of `stability`.
#[derive(Args, Debug)]
pub(crate) struct Suite {
    /// Directory for the table [default: results/stability; none if only some cases are run].
    #[arg(long, short)]
    pub output: Option<PathBuf>,
    /// Only the case of this name, or those whose names begin with it: mass-ratio, mass-ratio/1e-8.
    #[arg(long, value_name = "CASE")]
    pub only: Option<String>,
    /// Longest time of a case [s].
    #[arg(long, default_value_t = crate::driver::stability::LIMIT, value_parser = positive)]
    pub seconds: f64,
    /// No progress and no summary.
    #[arg(long, short)]
    pub quiet: bool,
}

/// Two records.
#[derive(Args, Debug)]
pub(crate) struct Comparison {
    /// New record: optimum.json, or its directory.
    pub new: PathBuf,
    /// Record to compare with: optimum.json, or its directory.
    pub baseline: PathBuf,
}

/// A size of memory in bytes, with a unit of 1000 or 1024.
fn bytes(text: &str) -> Result<usize, String> {
    let expected = || "expected a size such as 500MB or 2GiB".to_owned();
    let digits = text.find(|c: char| !c.is_ascii_digit() && c != '.');
    let (number, unit) = text.split_at(digits.unwrap_or(text.len()));
    let number: f64 = number.parse().map_err(|_| expected())?;
    let unit = match unit.trim().to_ascii_lowercase().as_str() {
        "" | "b" => 1.0,
        "kb" | "k" => 1e3,
        "mb" | "m" => 1e6,
        "gb" | "g" => 1e9,
        "tb" | "t" => 1e12,
        "kib" => 1024.0,
        "mib" => 1024.0 * 1024.0,
        "gib" => 1024.0 * 1024.0 * 1024.0,
        "tib" => 1024.0 * 1024.0 * 1024.0 * 1024.0,
        _ => return Err(expected()),
    };
    let size = number * unit;
    match (1.0..1e18).contains(&size) {
        true => Ok(size as usize),
        false => Err(expected()),
    }
}

fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(x) if x.is_finite() && x > 0.0 => Ok(x),
        _ => Err("expected a positive number".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_of_memory_are_read() {
        for (text, size) in [
            ("500MB", 500_000_000),
            ("1.5 kb", 1500),
            ("2GiB", 2 << 30),
            ("7", 7),
        ] {
            assert_eq!(bytes(text), Ok(size));
        }
        for text in ["", "MB", "-1MB", "1XB", "0", "1e9", "nan", "9999999999TB"] {
            assert!(bytes(text).is_err(), "{text}");
        }
    }
}
