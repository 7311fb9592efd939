//! The optima for several values of a parameter as a table, `sweep.csv`.

use super::ReportError;
use super::csv;
use super::history::{CONSTRAINT, Column, OBJECTIVE, VARIABLE, exact};
use serde::{Deserialize, Serialize};

/// The optimum for one value of the parameter.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SweptOptimum {
    /// Value of the parameter.
    pub value: f64,
    /// SHA-256 of the problem with this value, hexadecimal.
    pub problem: String,
    /// How the run ended, in one word.
    pub status: String,
    /// Whether it converged.
    pub converged: bool,
    /// Simulations of all runs for this value.
    pub evaluations: usize,
    /// Objective in the user's sense.
    pub objective: f64,
    /// Values of the variables.
    pub design: Vec<f64>,
    /// Values of the constraints.
    pub constraints: Vec<f64>,
    /// The start of the run that found it, in words.
    #[serde(default)]
    pub start: String,
}

/// The optima along a parameter.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sweep {
    /// JSON Pointer to the parameter.
    pub parameter: String,
    /// The objective's name and unit.
    pub objective: Column,
    /// Design variables.
    pub variables: Vec<Column>,
    /// Constraints.
    pub constraints: Vec<Column>,
    /// The optima, in the order of the values.
    pub optima: Vec<SweptOptimum>,
}

impl Sweep {
    /// Keeps the optima of the first runs that are the same in a sweep over `problems`, each a value
    /// and the SHA-256 of its problem.
    pub fn keep_common<'p>(&mut self, problems: impl Iterator<Item = (f64, &'p str)>) {
        let same = |(found, (value, problem)): &(&SweptOptimum, (f64, &str))| {
            found.value.to_bits() == value.to_bits() && found.problem == *problem
        };
        let common = self.optima.iter().zip(problems).take_while(same).count();
        self.optima.truncate(common);
    }

    /// Comma separated values (RFC 4180), with the columns of `history.csv` for objective, variables
    /// and constraints. Numbers are the shortest that read back exactly; one that is not finite is
    /// an empty field.
    ///
    /// # Errors
    /// [`ReportError::History`] if a unit contains a square bracket.
    pub fn to_csv(&self) -> Result<String, ReportError> {
        let mut header = vec![
            self.parameter.clone(),
            "status".into(),
            "evaluations".into(),
        ];
        header.push(self.objective.heading(OBJECTIVE)?);
        for variable in &self.variables {
            header.push(variable.heading(VARIABLE)?);
        }
        for constraint in &self.constraints {
            header.push(constraint.heading(CONSTRAINT)?);
        }
        header.push("from".into());
        let mut text = String::new();
        csv::write_record(&mut text, header.iter().map(String::as_str));
        for found in &self.optima {
            let mut fields = vec![exact(found.value), found.status.clone()];
            fields.push(found.evaluations.to_string());
            fields.push(exact(found.objective));
            fields.extend(
                found
                    .design
                    .iter()
                    .chain(&found.constraints)
                    .map(|&x| exact(x)),
            );
            fields.push(found.start.clone());
            csv::write_record(&mut text, fields.iter().map(String::as_str));
        }
        Ok(text)
    }

    /// The same for a person: value, objective, evaluations and status.
    pub fn text(&self) -> String {
        let unit = self.objective.unit.as_deref().unwrap_or_default();
        let mut text = format!(
            "{:>14} {:>18} {unit:8} evaluations status, from\n",
            "value", "objective"
        );
        for found in &self.optima {
            text += &format!(
                "{:>14} {:>18.9e} {unit:8} {:>11} {}, {}\n",
                found.value, found.objective, found.evaluations, found.status, found.start
            );
        }
        format!("Optima for {}\n{text}", self.parameter)
    }
}
