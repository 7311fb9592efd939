//! Estimated errors of functions and gradients, as a table and in JSON.

use crate::driver::compared::Compared;
use crate::driver::error;
use crate::problem::Problem;
use crate::report::summary::is_rounding;
use serde_json::{Value, json};
use std::fmt::Write;

/// The table of estimated errors.
pub(crate) fn table(problem: &Problem, found: &[error::FunctionError]) -> String {
    let f_width = width(problem.function_names.iter());
    let v_width = width(problem.variables.iter().map(|v| &v.name));
    let mut text = format!(
        "estimated discretisation errors\n{:f_width$}  {:v_width$}  {:>16}  {:>9}  {:>9}\n",
        "function", "variable", "value", "error", "relative"
    );
    let mut line = |function: &str, variable: &str, of: &error::Estimate| {
        let (error, relative) = match is_rounding(of.error, of.value) {
            true => ("rounding".into(), "-".into()),
            false => (format!("{:.1e}", of.error), relative(of.error, of.value)),
        };
        let _ = writeln!(
            text,
            "{function:f_width$}  {variable:v_width$}  {:>16.9e}  {error:>9}  {relative:>9}",
            of.value
        );
    };
    for found in found {
        let name = &problem.function_names[found.function];
        line(name, "", &found.value);
        if let Some(maximum) = &found.maximum {
            line(name, "(maximum)", maximum);
        }
        for (variable, derivative) in problem.variables.iter().zip(&found.gradient) {
            line(name, &variable.name, derivative);
        }
    }
    text
}

/// Adds the estimated errors of a function and of its gradient to its entry.
pub(super) fn add_errors(own: &mut Value, problem: &Problem, found: &error::FunctionError) {
    own["error"] = json!(found.value.error);
    if let Some(maximum) = &found.maximum {
        let between_samples = own["true_maximum"]["error"].as_f64().unwrap_or(0.0);
        own["true_maximum"]["error"] = json!(maximum.error + between_samples);
    }
    let gradient = problem.variables.iter().zip(&found.gradient);
    let gradient = gradient.map(|(variable, derivative)| {
        let both = json!({"value": derivative.value, "error": derivative.error});
        (variable.name.clone(), both)
    });
    own["gradient"] = Value::Object(gradient.collect());
}

/// Width of a column of names.
fn width<'a>(names: impl Iterator<Item = &'a String>) -> usize {
    let longest = names.map(|name| name.chars().count()).max();
    longest.unwrap_or(0).max(9)
}

/// An error as a part of its value, or a dash.
fn relative(error: f64, value: f64) -> String {
    let part = error / value.abs();
    match part.is_finite() {
        true => format!("{part:.1e}"),
        false => "-".into(),
    }
}

/// The table of the errors of bases; empty if there are none.
pub(crate) fn of_bases(problem: &Problem, found: &[Compared]) -> String {
    let heading = "errors of bases, against all nodes and more functions of beams";
    compared(problem, found, [heading, "finer", "error"])
}

/// The table of the changes by half of the widths of loads; empty if there are none.
pub(crate) fn of_smoothing(problem: &Problem, found: &[Compared]) -> String {
    let heading = "changes by the smoothing of loads, with half the widths of stops, contacts, cables, friction and drag";
    compared(problem, found, [heading, "sharper", "change"])
}

/// The table of functions beside those of another run.
fn compared(problem: &Problem, found: &[Compared], [heading, other, error]: [&str; 3]) -> String {
    if found.is_empty() {
        return String::new();
    }
    let width = width(problem.function_names.iter());
    let mut text = format!(
        "{heading}\n{:width$}  {:>16}  {other:>16}  {error:>9}  {:>9}\n",
        "function", "value", "relative"
    );
    let mut line = |name: &str, value: f64, other: f64| {
        let error = (value - other).abs();
        let relative = relative(error, value);
        let _ = writeln!(
            text,
            "{name:width$}  {value:>16.9e}  {other:>16.9e}  {error:>9.1e}  {relative:>9}",
        );
    };
    for found in found {
        line(
            &problem.function_names[found.function],
            found.value,
            found.other,
        );
        if let Some([value, other]) = found.maximum {
            line("(maximum)", value, other);
        }
    }
    text
}
