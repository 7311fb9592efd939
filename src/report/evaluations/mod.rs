//! Every evaluation of an optimisation, `evaluations.jsonl`: one JSON document a line, written as
//! soon as it is known. A killed run loses only the evaluation under way. If the machine fails, the
//! evaluations of the last second may be lost too.

mod chain;
mod log;

pub use log::{Earlier, EvaluationLog};

use crate::integrate::{Grid, Method, WorkCounts};
use crate::system::RedundantRows;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use std::collections::BTreeMap;

/// The head of the file, its first line: the problem of the evaluations.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Head {
    /// SHA-256, hexadecimal, of those parts of the problem's document that may affect the
    /// functions.
    pub sha256: String,
    /// The design that the run started from.
    pub start: Vec<f64>,
    /// Names of the variables, in the order of every `design`.
    pub variables: Vec<String>,
    /// Names of the functions, objective first, in the order of all `values` and `gradients`.
    pub functions: Vec<String>,
    /// The rest of the document. Another run may change it and still use the evaluations.
    pub settings: Map<String, Value>,
    /// Whether every line ends with the hash of itself and all lines before it; older versions
    /// wrote none.
    #[serde(default, skip_serializing_if = "is_false")]
    pub chained: bool,
    /// Whether the scene was reduced before it was integrated; older versions wrote nothing.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lowered: Option<bool>,
}

fn is_false(yes: &bool) -> bool {
    !yes
}

impl Head {
    /// Whether evaluations of `other` are valid for this.
    fn fits(&self, other: &Head) -> bool {
        let lowered = other.lowered;
        let with = |head: &Head| Head {
            lowered,
            ..head.without_settings()
        };
        with(self) == with(other)
    }

    /// What `--no-lowering` says of the evaluations of `other`, if they are those of the scene in another form:
    /// found and expected.
    fn other_form(&self, other: &Head) -> Option<(&'static str, &'static str)> {
        match (self.lowered?, other.lowered?) {
            (true, false) => Some((
                "evaluations of the scene as written",
                "those of the reduced scene; give --no-lowering, or leave --resume out",
            )),
            (false, true) => Some((
                "evaluations of the reduced scene",
                "those of the scene as written; leave --no-lowering out, or leave --resume out",
            )),
            _ => None,
        }
    }

    /// The parts of the document that determine the evaluations.
    fn without_settings(&self) -> Head {
        Head {
            settings: Map::new(),
            chained: true,
            ..self.clone()
        }
    }

    /// The settings that differ from those of `earlier`, as `POINTER was OLD, is NEW`.
    pub fn changes(&self, earlier: &Head) -> Vec<String> {
        let all = |head: &Head| {
            let mut leaves = BTreeMap::new();
            flatten(&Value::Object(head.settings.clone()), "", &mut leaves);
            leaves
        };
        let (new, old) = (all(self), all(earlier));
        let text = |value: Option<&Value>| value.map_or("left out".into(), Value::to_string);
        let mut names: Vec<&String> = old.keys().chain(new.keys()).collect();
        names.sort();
        names.dedup();
        names
            .into_iter()
            .filter(|name| old.get(*name) != new.get(*name))
            .map(|name| {
                let (was, is) = (text(old.get(name)), text(new.get(name)));
                format!("{name} was {was}, is {is}")
            })
            .collect()
    }
}

/// The values of a document that are no objects, by JSON Pointer.
fn flatten(value: &Value, pointer: &str, leaves: &mut BTreeMap<String, Value>) {
    match value {
        Value::Object(map) => {
            for (key, inner) in map {
                let key = key.replace('~', "~0").replace('/', "~1");
                flatten(inner, &format!("{pointer}/{key}"), leaves);
            }
        }
        leaf => {
            leaves.insert(pointer.to_owned(), leaf.clone());
        }
    }
}

/// One evaluation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EvaluationRecord {
    /// The design, in the units of the problem file.
    pub design: Vec<f64>,
    /// Its results.
    #[serde(flatten)]
    pub found: Found,
    /// Time of the event in the last motion so far, if the scene ends at one \[s\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub event: Option<f64>,
    /// The same by case, of a problem with cases.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub events_of_cases: Vec<Option<f64>>,
    /// Its work.
    #[serde(default, skip_serializing_if = "Work::is_none")]
    pub work: Work,
}

/// Work of an evaluation; zero for one that failed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Work {
    /// Time steps.
    pub steps: usize,
    /// Steps of the motion that a gradient repeated because memory is limited.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub recomputed: usize,
    /// Newton iterations of all steps.
    pub newton_iterations: usize,
    /// Factorisations of matrices, forward and backward.
    pub factorisations: usize,
    /// Solves with a factorised matrix, forward and backward.
    pub solves: usize,
}

impl Work {
    fn is_none(&self) -> bool {
        *self == Self::default()
    }
}

impl From<WorkCounts> for Work {
    fn from(counts: WorkCounts) -> Self {
        Self {
            steps: counts.steps,
            recomputed: counts.recomputed,
            newton_iterations: counts.newton_iterations,
            factorisations: counts.factorisations,
            solves: counts.solves,
        }
    }
}

impl std::ops::AddAssign for Work {
    fn add_assign(&mut self, other: Self) {
        self.steps += other.steps;
        self.recomputed += other.recomputed;
        self.newton_iterations += other.newton_iterations;
        self.factorisations += other.factorisations;
        self.solves += other.solves;
    }
}

fn is_zero(count: &usize) -> bool {
    *count == 0
}

/// Results of an evaluation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Found {
    /// Values of the functions.
    Values(Vec<f64>),
    /// Gradients of the functions, function by function.
    Gradients(Vec<Vec<f64>>),
    /// Why there are no values.
    NoValues(String),
    /// Why there are no gradients.
    NoGradients(String),
    /// The steps that are in use from this design on.
    Steps(StepsInUse),
}

/// Largest number of cells of a step in a record.
const MOST_CELLS: u32 = 4096;

/// Method and steps that were chosen at one design and are kept for later ones.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StepsInUse {
    /// Name of the method.
    pub method: String,
    /// Why they were chosen.
    pub reason: String,
    /// Why this method, if it is not used for its usual purpose.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub method_reason: Option<String>,
    /// Ends of the steps, as fractions of the duration from 0 to 1. None if they are equal; their
    /// number is then that of the problem.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub ends: Vec<f64>,
    /// Kinks of loads and drives at which steps end. None if there are none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub kinks: Vec<f64>,
    /// Whether the steps are equal between kinks, as the problem gives them.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub equal: bool,
    /// Cells of the steps for sums over the motion. None if each step has one.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub cells: Vec<u32>,
    /// Redundant constraint rows that are left out. None if all are imposed.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub left_out: Vec<RowsLeftOut>,
    /// Of a problem with cases: those of each.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub cases: Vec<Option<StepsInUse>>,
}

/// Constraint rows that are left out from a step on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RowsLeftOut {
    /// The step, counted from 1.
    pub from: usize,
    /// Numbers of the rows, counted from 0.
    pub rows: Vec<usize>,
    /// Number of all rows.
    pub of: usize,
}

impl StepsInUse {
    /// The steps with their redundant rows. `None` if they are equal, or not valid for any motion.
    pub fn grid(&self) -> Option<Grid> {
        let grid = Grid::from_ends(self.ends.clone())?.with_cells(self.cells.clone());
        let mut grid = grid.with_kinks(self.kinks.clone(), self.equal)?;
        for RowsLeftOut { from, rows, of } in &self.left_out {
            grid.leave_out_from(*from, &RedundantRows::from_rows(rows, *of)?);
        }
        Some(grid)
    }

    /// What was found and expected, if no motion can have such steps.
    fn fault(&self) -> Option<(String, &'static str)> {
        if !self.cases.is_empty() {
            return self.cases.iter().flatten().find_map(Self::fault);
        }
        if Method::named(&self.method).is_none() {
            let found = format!("the method {:?}", self.method);
            return Some((
                found,
                "the name of a method, such as dop853, radau3 or bdf2",
            ));
        }
        let steps = self.ends.len().saturating_sub(1);
        if !self.cells.is_empty() && self.cells.len() != steps {
            let found = format!("cells of {} steps, ends of {steps}", self.cells.len());
            return Some((found, "a number of cells for each step"));
        }
        if let Some(cells) = self.cells.iter().find(|&&cells| cells > MOST_CELLS) {
            return Some((format!("{cells} cells in a step"), "at most 4096"));
        }
        let row = |left_out: &RowsLeftOut| {
            let beyond = left_out.rows.iter().find(|row| **row >= left_out.of);
            beyond.map(|row| format!("row {row} of {}", left_out.of))
        };
        if let Some(found) = self.left_out.iter().find_map(row) {
            return Some((found, "numbers of rows, counted from 0"));
        }
        if self.ends.is_empty() {
            return None;
        }
        if let Some(grid) = Grid::from_ends(self.ends.clone()) {
            return match grid.with_kinks(self.kinks.clone(), self.equal) {
                Some(_) => None,
                None => Some((format!("kinks at {:?}", self.kinks), "ends of steps")),
            };
        }
        let falls = self.ends.windows(2).find(|pair| pair[0] >= pair[1]);
        let found = match (falls, &self.ends[..]) {
            (Some(pair), _) => format!("a step from {:?} to {:?}", pair[0], pair[1]),
            (None, [first, .., last]) => format!("steps from {first:?} to {last:?}"),
            (None, _) => "a single end".into(),
        };
        Some((found, "ends of steps that rise from 0 to 1"))
    }
}

impl EvaluationRecord {
    /// What was found and expected, if the evaluation does not fit the head: lists of other
    /// lengths, or steps that no motion has.
    fn fault(&self, head: &Head) -> Option<(String, &'static str)> {
        let (n, m) = (head.variables.len(), head.functions.len());
        let fits = match &self.found {
            Found::Values(values) => values.len() == m,
            Found::Gradients(rows) => rows.len() == m && rows.iter().all(|row| row.len() == n),
            Found::Steps(steps) => {
                if let Some(fault) = steps.fault() {
                    return Some(fault);
                }
                true
            }
            Found::NoValues(_) | Found::NoGradients(_) => true,
        };
        let mut events = self
            .event
            .iter()
            .chain(self.events_of_cases.iter().flatten());
        if let Some(event) = events.find(|event| event.is_nan() || **event <= 0.0) {
            return Some((format!("an event at {event} s"), "a time after the start"));
        }
        if fits && self.design.len() == n {
            return None;
        }
        let expected = "a number for each variable and function";
        Some(("lists of other lengths".into(), expected))
    }
}
