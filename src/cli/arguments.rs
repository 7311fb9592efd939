//! The arguments of `optimize`.

use super::new::Starter;
use super::range::{Range, range};
use clap::{Args, Parser, Subcommand};
use std::path::PathBuf;

/// Designs flexible multibody systems by gradient.
///
/// `optimize PROBLEM` finds the best design and writes its record and figures to
/// results/<name of the problem>/.
#[derive(Debug, Parser)]
#[command(
    name = "optimize",
    version,
    args_conflicts_with_subcommands = true,
    arg_required_else_help = true,
    after_help = "Exit codes: 0 done; 1 not converged, or a check (gradients, --second-order) or \
                  comparison failed; \
                  2 bad input; 3 numerical failure; 4 a file cannot be read or written; \
                  130 interrupted by a signal."
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
    /// Continues the run in this directory that was killed, interrupted or reached a limit. Its
    /// evaluations are not repeated. Settings of the optimiser may differ.
    #[arg(long, value_name = "DIR")]
    pub resume: Option<PathBuf>,
    /// Starts from the design in another optimum.json (or its directory), by names of variables.
    /// Uses the state.json in the same directory if it belongs to this design.
    #[arg(long, value_name = "FILE")]
    pub from: Option<PathBuf>,
    /// Optimises from this many starts, spread evenly between the bounds, and keeps the best.
    /// Writes all optima to optima.csv.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pub starts: Option<u32>,
    /// Reports the derivative of the optimal objective by a number of the file that is not designed,
    /// by a JSON Pointer as /bodies/arm/mass. May be repeated.
    #[arg(long, value_name = "PATH")]
    pub sensitivity: Vec<String>,
    /// Optimises for n values of a number of the file from a to b, each from the optimum before and
    /// from the start of the file, or from all of --starts, and keeps the better. Writes sweep.csv
    /// and sweep.svg instead of the other results.
    #[arg(long, value_name = "PATH=a..b,n", value_parser = range,
          conflicts_with_all = ["resume", "from", "second_order", "sensitivity"])]
    pub sweep: Option<Range>,
    /// Checks by differences of gradients whether the optimum is a minimum of second order. Exit
    /// code 1 if it is not.
    #[arg(long)]
    pub second_order: bool,
    /// Rewrites report.html with the convergence so far after every iteration, at most once a second. A browser that has it
    /// open shows the newest every two seconds; at the end it is the report.
    #[arg(long, conflicts_with_all = ["starts", "sweep"])]
    pub watch: bool,
    /// Skips the certificate of the gradients. It compares one directional derivative of every
    /// function by the adjoint with the complex step, at start and optimum; exit code 1 if they
    /// differ.
    #[arg(long)]
    pub no_certificate: bool,
}

/// A problem file and common options.
#[derive(Args, Clone, Debug)]
pub(crate) struct Job {
    /// Problem file (JSON).
    pub problem: PathBuf,
    /// Directory for the results [default: results/<name of the problem>, for `work-precision`
    /// results/work-precision/<name>; `simulate` writes files only if this is given].
    #[arg(long, short)]
    pub output: Option<PathBuf>,
    /// No progress and no summary.
    #[arg(long, short)]
    pub quiet: bool,
    /// Changes one value of the file for this run, by a JSON Pointer and a JSON value, as in
    /// /bodies/arm/mass=42. May be repeated.
    #[arg(long, value_name = "PATH=VALUE")]
    pub set: Vec<String>,
    /// Limits the memory for the data that gradients need: 500MB, 2GiB. A gradient repeats steps
    /// that are not stored, at most twenty times. The memory for this is used even if the limit is
    /// smaller; see `optimize explain` [default: half of the available memory].
    #[arg(long, value_name = "SIZE", value_parser = bytes)]
    pub memory: Option<usize>,
    /// Integrates the scene as written, without reductions.
    #[arg(long)]
    pub no_lowering: bool,
    /// Reports the estimated discretisation error of every function and of its gradient, by a
    /// second simulation with steps of half the size; and that of bases of flexible bodies, by one with all nodes and
    /// more functions of beams.
    #[arg(long)]
    pub error: bool,
    /// Writes the fields of structures to fields.vtu beside the results, for ParaView and meshio. Of shells that
    /// move it writes fields_0000.vtu and so on, at most 101 instants, and their list fields.pvd.
    #[arg(long)]
    pub vtu: bool,
    /// Writes report.html beside the results: one page for any browser, without a network, that shows the machine in
    /// motion, tables and curves.
    #[arg(long)]
    pub report: bool,
    /// Refines steps, samples and reduced bases until the estimated relative error of the objective at the start is
    /// below this value. They are never coarser than in the file.
    #[arg(long, value_name = "ERROR", value_parser = positive)]
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
    /// Simulate the problem's start and report its functions, energy and constraint drift. With
    /// --output it draws the motion and writes simulation.csv (energy, momentum, drift, joint
    /// reactions), motion.csv (all bodies) and functions.csv (all quantities) over time.
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
    /// Report the contents of the scene, which reductions are made and why, and the reduced scene:
    /// unknowns, elimination, method, memory, and the dependencies of the functions.
    Explain {
        /// The problem.
        #[command(flatten)]
        job: Job,
        /// Prints JSON.
        #[arg(long)]
        json: bool,
    },
    /// Measure error against run time for all methods, orders, steps and tolerances. Writes
    /// work_precision.csv, orders.csv and work_precision.svg.
    WorkPrecision(Measurement),
    /// Run the program on extreme scenes and check its results. Writes stability.md and
    /// stability.csv. Exit code 1 if a result is wrong without a warning.
    Stability(Suite),
    /// The former name of `stability`.
    #[command(hide = true, disable_help_flag = true)]
    Stress {
        /// The remaining arguments.
        #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
        rest: Vec<std::ffi::OsString>,
    },
    /// Compare two records of optimal designs; exit code 1 if they differ beyond tolerance.
    Compare(Comparison),
    /// Draw the figures of a result directory again, from its record.
    Plot {
        /// Directory with optimum.json and history.csv.
        directory: PathBuf,
    },
    /// Write report.html into a result directory, from its record: the machine in motion, tables and curves.
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
