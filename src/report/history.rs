//! The iterations of an optimisation as a table, `history.csv`.

use super::ReportError;
use super::csv;
use serde::{Deserialize, Serialize};

/// Name and unit of a column.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Column {
    /// Name, as in the problem file.
    pub name: String,
    /// Unit such as `kg` or `m/s`, where it is known; without square brackets.
    pub unit: Option<String>,
}

/// One iteration of an optimisation.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct HistoryRow {
    /// Iteration; the start is 0.
    pub iteration: usize,
    /// Function evaluations until here.
    pub evaluations: usize,
    /// Objective in the user's sense (a maximised function is not negated).
    pub objective: f64,
    /// Largest violation of a constraint.
    pub infeasibility: f64,
    /// Largest scaled residual of the optimality conditions.
    pub optimality: f64,
    /// Barrier parameter μ.
    pub barrier: f64,
    /// Largest component of the step, scaled.
    pub step_norm: f64,
    /// Step length of the dual variables, in [0, 1].
    pub dual_step: f64,
    /// Step length of the primal variables, in [0, 1].
    pub primal_step: f64,
    /// Regularisation that was added to the Hessian.
    pub regularisation: f64,
    /// Trial points of the line search.
    pub line_search_trials: usize,
    /// Kind of step, in the optimiser's words.
    pub phase: String,
    /// Number of time steps of the motion of these functions, if known.
    pub steps: Option<usize>,
    /// How often the steps had been chosen anew. Rows with different numbers have different steps.
    pub refreshes: Option<usize>,
    /// Design variables, in the order of [`History::variables`].
    pub design: Vec<f64>,
    /// Constraint values, in the order of [`History::constraints`].
    pub constraints: Vec<f64>,
}

/// All iterations of an optimisation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct History {
    /// The objective's name and unit.
    pub objective: Column,
    /// Design variables.
    pub variables: Vec<Column>,
    /// Constraints.
    pub constraints: Vec<Column>,
    /// Iterations in order.
    pub rows: Vec<HistoryRow>,
}

pub(super) const OBJECTIVE: &str = "objective: ";
pub(super) const VARIABLE: &str = "variable: ";
pub(super) const CONSTRAINT: &str = "constraint: ";
/// Columns before the design variables; `objective` is followed by its name.
const FIXED: [&str; 14] = [
    "iteration",
    "evaluations",
    OBJECTIVE,
    "infeasibility",
    "optimality",
    "barrier",
    "step norm",
    "dual step",
    "primal step",
    "regularisation",
    "line search trials",
    "phase",
    "time steps",
    "times chosen anew",
];

impl History {
    /// The table as comma separated values (RFC 4180, lines end with a line feed).
    ///
    /// The header names each column, with the unit in square brackets where it is known; the
    /// columns of the problem's own names begin with `objective: `, `variable: ` or
    /// `constraint: `. Numbers are the shortest that read back exactly; a NaN or infinite entry
    /// is written as an empty field and read as NaN; so is a count that is not known.
    ///
    /// # Errors
    /// [`ReportError::History`] if a row has not one entry for each variable and constraint, or
    /// if a unit contains a square bracket.
    pub fn to_csv(&self) -> Result<String, ReportError> {
        let mut text = self.header()?;
        for i in 0..self.rows.len() {
            self.write_row(&mut text, i)?;
        }
        Ok(text)
    }

    pub(super) fn header(&self) -> Result<String, ReportError> {
        let mut header: Vec<String> = Vec::new();
        for fixed in FIXED {
            header.push(match fixed {
                OBJECTIVE => self.objective.heading(OBJECTIVE)?,
                _ => fixed.to_owned(),
            });
        }
        for column in &self.variables {
            header.push(column.heading(VARIABLE)?);
        }
        for column in &self.constraints {
            header.push(column.heading(CONSTRAINT)?);
        }
        let mut text = String::new();
        csv::write_record(&mut text, header.iter().map(String::as_str));
        Ok(text)
    }

    pub(super) fn write_row(&self, text: &mut String, i: usize) -> Result<(), ReportError> {
        let row = &self.rows[i];
        let found = (row.design.len(), row.constraints.len());
        let expected = (self.variables.len(), self.constraints.len());
        if found != expected {
            let count = |(n, m): (usize, usize)| format!("{n} design and {m} constraint values");
            return Err(ReportError::History {
                line: i + 2,
                found: count(found),
                expected: count(expected),
            });
        }
        let fields = row.fields();
        csv::write_record(text, fields.iter().map(String::as_str));
        Ok(())
    }

    /// Reads back what [`History::to_csv`] wrote.
    ///
    /// # Errors
    /// [`ReportError::History`] with the line, what was found and what was expected.
    pub fn from_csv(text: &str) -> Result<History, ReportError> {
        let records = csv::parse(text)
            .map_err(|bad| fault(bad.line, "a quote out of place", "quotes as in RFC 4180"))?;
        let Some((header, rows)) = records.split_first() else {
            return Err(fault(1, "an empty file", "a header"));
        };
        let mut history = History {
            objective: Column::new("", None),
            variables: Vec::new(),
            constraints: Vec::new(),
            rows: Vec::new(),
        };
        for (i, heading) in header.fields.iter().enumerate() {
            let wrong =
                |expected: &str| fault(header.line, &format!("column {heading:?}"), expected);
            match FIXED.get(i) {
                Some(&OBJECTIVE) => {
                    let rest = heading.strip_prefix(OBJECTIVE);
                    history.objective = Column::parse(rest.ok_or_else(|| wrong(OBJECTIVE))?);
                }
                Some(fixed) if heading == fixed => {}
                Some(fixed) => return Err(wrong(&format!("column {fixed:?}"))),
                None => {
                    if let Some(rest) = heading.strip_prefix(CONSTRAINT) {
                        history.constraints.push(Column::parse(rest));
                    } else if let Some(rest) = heading.strip_prefix(VARIABLE)
                        && history.constraints.is_empty()
                    {
                        history.variables.push(Column::parse(rest));
                    } else {
                        return Err(wrong("the variables, then the constraints"));
                    }
                }
            }
        }
        if header.fields.len() < FIXED.len() {
            let found = format!("{} columns", header.fields.len());
            return Err(fault(
                header.line,
                &found,
                &format!("at least {}", FIXED.len()),
            ));
        }
        for record in rows {
            if record.fields.len() != header.fields.len() {
                let found = format!("{} fields", record.fields.len());
                let expected = format!("{} as in the header", header.fields.len());
                return Err(fault(record.line, &found, &expected));
            }
            history
                .rows
                .push(HistoryRow::parse(record, history.variables.len())?);
        }
        Ok(history)
    }
}

impl Column {
    /// A column by name and unit.
    pub fn new(name: &str, unit: Option<&str>) -> Column {
        Column {
            name: name.to_owned(),
            unit: unit.map(str::to_owned),
        }
    }

    /// `NAME [UNIT]`. A name without unit that ends with a bracket gets `[]`, so it reads back
    /// unambiguously.
    pub(super) fn heading(&self, prefix: &str) -> Result<String, ReportError> {
        let unit = match &self.unit {
            Some(unit) if unit.contains(['[', ']']) => {
                return Err(fault(
                    1,
                    &format!("unit {unit:?}"),
                    "a unit without brackets",
                ));
            }
            Some(unit) => format!(" [{unit}]"),
            None if self.name.ends_with(']') => " []".to_owned(),
            None => String::new(),
        };
        Ok(format!("{prefix}{}{unit}", self.name))
    }

    fn parse(heading: &str) -> Column {
        match heading
            .strip_suffix(']')
            .and_then(|rest| rest.rsplit_once(" ["))
        {
            Some((name, "")) => Column::new(name, None),
            Some((name, unit)) => Column::new(name, Some(unit)),
            None => Column::new(heading, None),
        }
    }
}

impl HistoryRow {
    fn fields(&self) -> Vec<String> {
        let mut fields = vec![self.iteration.to_string(), self.evaluations.to_string()];
        fields.extend(
            [
                self.objective,
                self.infeasibility,
                self.optimality,
                self.barrier,
                self.step_norm,
                self.dual_step,
                self.primal_step,
                self.regularisation,
            ]
            .map(exact),
        );
        fields.push(self.line_search_trials.to_string());
        fields.push(self.phase.clone());
        let known = |count: Option<usize>| count.map_or_else(String::new, |n| n.to_string());
        fields.extend([self.steps, self.refreshes].map(known));
        fields.extend(
            self.design
                .iter()
                .chain(&self.constraints)
                .map(|&v| exact(v)),
        );
        fields
    }

    fn parse(record: &csv::Record, variables: usize) -> Result<HistoryRow, ReportError> {
        let count = |i: usize| -> Result<usize, ReportError> {
            let field: &str = &record.fields[i];
            field
                .parse()
                .map_err(|_| fault(record.line, &format!("{field:?}"), "a count"))
        };
        let known = |i: usize| match record.fields[i].is_empty() {
            true => Ok(None),
            false => count(i).map(Some),
        };
        let number = |i: usize| -> Result<f64, ReportError> {
            let field: &str = &record.fields[i];
            match field.parse::<f64>() {
                _ if field.is_empty() => Ok(f64::NAN),
                Ok(value) if value.is_finite() => Ok(value),
                _ => Err(fault(
                    record.line,
                    &format!("{field:?}"),
                    "a finite number or nothing",
                )),
            }
        };
        let split = FIXED.len() + variables;
        Ok(HistoryRow {
            iteration: count(0)?,
            evaluations: count(1)?,
            objective: number(2)?,
            infeasibility: number(3)?,
            optimality: number(4)?,
            barrier: number(5)?,
            step_norm: number(6)?,
            dual_step: number(7)?,
            primal_step: number(8)?,
            regularisation: number(9)?,
            line_search_trials: count(10)?,
            phase: record.fields[11].clone(),
            steps: known(12)?,
            refreshes: known(13)?,
            design: (FIXED.len()..split).map(number).collect::<Result<_, _>>()?,
            constraints: (split..record.fields.len())
                .map(number)
                .collect::<Result<_, _>>()?,
        })
    }
}

/// The shortest decimal that reads back as the same number; empty if it is not finite.
pub(super) fn exact(value: f64) -> String {
    if value.is_finite() {
        format!("{value:?}")
    } else {
        String::new()
    }
}

fn fault(line: usize, found: &str, expected: &str) -> ReportError {
    ReportError::History {
        line,
        found: found.to_owned(),
        expected: expected.to_owned(),
    }
}
