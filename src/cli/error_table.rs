//! The table of estimated errors of functions and gradients.

use crate::driver::{bases, error};
use crate::problem::Problem;
use crate::report::summary::is_rounding;
use std::fmt::Write;

/// The table of estimated errors.
pub(crate) fn table(problem: &Problem, found: &[error::FunctionError]) -> String {
    let names = |all: &mut dyn Iterator<Item = &String>| {
        let longest = all.map(|name| name.chars().count()).max();
        longest.unwrap_or(0).max(9)
    };
    let f_width = names(&mut problem.function_names.iter());
    let v_width = names(&mut problem.variables.iter().map(|v| &v.name));
    let mut text = format!(
        "estimated discretisation errors\n{:f_width$}  {:v_width$}  {:>16}  {:>9}  {:>9}\n",
        "function", "variable", "value", "error", "relative"
    );
    let mut line = |function: &str, variable: &str, of: &error::Estimate| {
        let relative = of.error / of.value.abs();
        let relative = match relative.is_finite() && !is_rounding(of.error, of.value) {
            true => format!("{relative:.1e}"),
            false => "-".into(),
        };
        let error = match is_rounding(of.error, of.value) {
            true => "rounding".into(),
            false => format!("{:.1e}", of.error),
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

/// The table of the estimated errors of reduced bases; empty if there are none.
pub(crate) fn of_bases(problem: &Problem, found: &[bases::BasisError]) -> String {
    if found.is_empty() {
        return String::new();
    }
    let names = problem.function_names.iter();
    let width = names
        .map(|name| name.chars().count())
        .max()
        .unwrap_or(0)
        .max(9);
    let mut text = format!(
        "estimated errors of reduced bases, by richer ones of this design\n{:width$}  {:>16}  {:>16}  {:>9}  {:>9}\n",
        "function", "value", "richer basis", "error", "relative"
    );
    for found in found {
        let name = &problem.function_names[found.function];
        let relative = found.error() / found.value.abs();
        let relative = match relative.is_finite() {
            true => format!("{relative:.1e}"),
            false => "-".into(),
        };
        let _ = writeln!(
            text,
            "{name:width$}  {:>16.9e}  {:>16.9e}  {:>9.1e}  {relative:>9}",
            found.value,
            found.richer,
            found.error()
        );
    }
    text
}
