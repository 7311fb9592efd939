//! Every evaluation of an optimisation, `evaluations.jsonl`: one JSON document a line, written as
//! soon as it is known, so that a run that is killed loses the evaluation under way and no other. If
//! the machine fails, the evaluations of the last second may be lost too.

use super::{ReportError, write_all};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use std::collections::BTreeMap;
use std::fs::{File, OpenOptions};
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Longest time for which evaluations are left to the operating system.
const SYNCHRONISE: Duration = Duration::from_secs(1);

/// What the evaluations belong to: the first line.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Head {
    /// SHA-256 of all of the problem's document that the functions may follow from, hexadecimal.
    pub sha256: String,
    /// The design that the run started from.
    pub start: Vec<f64>,
    /// Names of the variables, in the order of every `design`.
    pub variables: Vec<String>,
    /// Names of the functions, objective first, in the order of all `values` and `gradients`.
    pub functions: Vec<String>,
    /// The rest of the document, which another run may change and use the evaluations all the same.
    pub settings: Map<String, Value>,
}

impl Head {
    /// Whether evaluations of `other` are evaluations of this.
    fn fits(&self, other: &Head) -> bool {
        let functions = |head: &Head| Head {
            settings: Map::new(),
            ..head.clone()
        };
        functions(self) == functions(other)
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
    /// What was found there.
    #[serde(flatten)]
    pub found: Found,
}

/// What an evaluation found.
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

/// Steps that follow the error at one design and are kept for others.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StepsInUse {
    /// Name of the method.
    pub method: String,
    /// Why they were chosen.
    pub reason: String,
    /// Ends of the steps, as fractions of the duration from 0 to 1.
    pub ends: Vec<f64>,
}

impl EvaluationRecord {
    /// Whether all lists have the lengths that the head asks for.
    fn fits(&self, head: &Head) -> bool {
        let (n, m) = (head.variables.len(), head.functions.len());
        let found = match &self.found {
            Found::Values(values) => values.len() == m,
            Found::Gradients(rows) => rows.len() == m && rows.iter().all(|row| row.len() == n),
            Found::NoValues(_) | Found::NoGradients(_) | Found::Steps(_) => true,
        };
        found && self.design.len() == n
    }
}

/// What an earlier run left: whole evaluations, without what was cut off after them.
#[derive(Clone, Debug, PartialEq)]
pub struct Earlier {
    /// What they belong to.
    pub head: Head,
    /// Evaluations and choices of steps, in order.
    pub records: Vec<EvaluationRecord>,
    /// Their lines.
    lines: String,
}

impl Earlier {
    /// Reads the file of an earlier run; `None` if it was not begun: there is no file, or its first
    /// line is not whole.
    ///
    /// A last line that was cut off does not count, nor do steps that were chosen for an evaluation
    /// that is missing.
    ///
    /// # Errors
    /// [`ReportError`] if the file cannot be read, is damaged, or does not belong to `head`.
    pub fn read(path: &Path, head: &Head) -> Result<Option<Self>, ReportError> {
        let bytes = match std::fs::read(path) {
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
            found => found.map_err(|source| ReportError::Read {
                path: path.to_path_buf(),
                source,
            })?,
        };
        let fault = |line: usize, found: String, expected: &str| ReportError::Evaluations {
            path: path.to_path_buf(),
            line,
            found,
            expected: expected.to_owned(),
        };
        let mut lines = bytes.split_inclusive(|byte| *byte == b'\n');
        let Some(first) = lines.next().filter(|line| line.ends_with(b"\n")) else {
            return Ok(None);
        };
        let written: Head = serde_json::from_slice(first)
            .map_err(|error| fault(1, error.to_string(), "the head of a record of evaluations"))?;
        if !head.fits(&written) {
            return Err(fault(
                1,
                "the evaluations of another problem or start".into(),
                "those of this one; give the same file, --set and --from, or leave --resume out",
            ));
        }
        let (mut records, mut complete) = (Vec::new(), 0);
        let (mut end, mut whole) = (first.len(), first.len());
        for (k, line) in lines.filter(|line| line.ends_with(b"\n")).enumerate() {
            let record: EvaluationRecord = serde_json::from_slice(line)
                .map_err(|error| fault(k + 2, error.to_string(), "an evaluation"))?;
            if !record.fits(head) {
                let expected = "a number for each variable and function";
                return Err(fault(k + 2, "lists of other lengths".into(), expected));
            }
            end += line.len();
            let chosen = matches!(record.found, Found::Steps(_));
            records.push(record);
            if !chosen {
                (complete, whole) = (records.len(), end);
            }
        }
        records.truncate(complete);
        Ok(Some(Self {
            head: written,
            records,
            lines: String::from_utf8_lossy(&bytes[first.len()..whole]).into_owned(),
        }))
    }
}

/// The open file.
#[derive(Debug)]
pub struct EvaluationLog {
    path: PathBuf,
    file: File,
    synchronised: Instant,
}

impl EvaluationLog {
    /// Starts a file anew, in a directory that is made if need be, with the evaluations of an earlier
    /// run if there is one. Until it is whole, a file that stands there stays.
    ///
    /// # Errors
    /// [`ReportError::Write`] with the path.
    pub fn create(
        path: &Path,
        head: &Head,
        earlier: Option<&Earlier>,
    ) -> Result<Self, ReportError> {
        let lines = earlier.map_or("", |earlier| &earlier.lines);
        let text = serde_json::to_string(head)? + "\n" + lines;
        write_all(&[(path.to_path_buf(), text.into_bytes())])?;
        let file = OpenOptions::new().append(true).open(path);
        Ok(Self {
            path: path.to_path_buf(),
            synchronised: Instant::now(),
            file: file.map_err(|source| ReportError::Write {
                path: path.to_path_buf(),
                source,
            })?,
        })
    }

    /// Appends an evaluation, in one piece: the operating system has it when this returns, and the
    /// disk has it if the last time that the file was synchronised is more than a second ago.
    ///
    /// # Errors
    /// [`ReportError::Write`] with the path.
    pub fn append(&mut self, record: &EvaluationRecord) -> Result<(), ReportError> {
        let line = serde_json::to_string(record)? + "\n";
        self.file
            .write_all(line.as_bytes())
            .map_err(|source| self.unwritable(source))?;
        if self.synchronised.elapsed() >= SYNCHRONISE {
            self.synchronise()?;
        }
        Ok(())
    }

    fn synchronise(&mut self) -> Result<(), ReportError> {
        self.synchronised = Instant::now();
        self.file
            .sync_data()
            .map_err(|source| self.unwritable(source))
    }

    fn unwritable(&self, source: std::io::Error) -> ReportError {
        ReportError::Write {
            path: self.path.clone(),
            source,
        }
    }
}

impl Drop for EvaluationLog {
    fn drop(&mut self) {
        // What the disk refuses now is lost only if the machine fails too.
        let _ = self.synchronise();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn head(sha256: &str, iterations: usize) -> Head {
        let settings =
            serde_json::json!({"name": "throw", "optimiser": {"iterations": iterations}});
        Head {
            sha256: sha256.into(),
            start: vec![1.0],
            variables: vec!["mass".into()],
            functions: vec!["range".into()],
            settings: settings.as_object().expect("an object").clone(),
        }
    }

    fn record(x: f64) -> EvaluationRecord {
        EvaluationRecord {
            design: vec![x],
            found: Found::Values(vec![x * x]),
        }
    }

    fn steps() -> EvaluationRecord {
        EvaluationRecord {
            design: vec![3.0],
            found: Found::Steps(StepsInUse {
                method: "dop853".into(),
                reason: "first design".into(),
                ends: vec![0.0, 1.0],
            }),
        }
    }

    /// Wherever a file is cut, what is whole before the cut comes back with every bit.
    #[test]
    fn whole_evaluations_survive_every_cut() {
        let directory = tempfile::tempdir().expect("a directory");
        let path = directory.path().join("evaluations.jsonl");
        let all = [
            steps(),
            record(0.1 + 0.2),
            steps(),
            record(1e-310),
            record(-7.0),
        ];
        let mut log = EvaluationLog::create(&path, &head("a", 5), None).expect("is written");
        for record in &all {
            log.append(record).expect("is written");
        }
        let bytes = std::fs::read(&path).expect("is read");
        let ends = (1..=bytes.len()).filter(|&k| bytes[k - 1] == b'\n');
        let ends: Vec<usize> = ends.collect();
        let around =
            |cut: &usize| cut.is_multiple_of(11) || ends.iter().any(|end| end.abs_diff(*cut) < 2);
        for cut in (0..=bytes.len()).filter(around) {
            std::fs::write(&path, &bytes[..cut]).expect("is cut");
            let found = Earlier::read(&path, &head("a", 5)).expect("is read");
            let whole = match ends.iter().filter(|end| **end <= cut).count() {
                0 => {
                    assert_eq!(found, None, "{cut}");
                    continue;
                }
                1 | 2 => 0,
                3 | 4 => 2,
                lines => lines - 1,
            };
            let found = found.expect("has a head");
            assert_eq!(found.records, all[..whole], "{cut}");
            let mut log =
                EvaluationLog::create(&path, &head("a", 5), Some(&found)).expect("is written");
            for record in &all[whole..] {
                log.append(record).expect("is written");
            }
            assert!(std::fs::read(&path).expect("is read") == bytes, "{cut}");
        }
        std::fs::remove_file(&path).expect("is removed");
        assert_eq!(Earlier::read(&path, &head("a", 5)).expect("is none"), None);
    }

    #[test]
    fn the_evaluations_of_another_problem_are_refused_and_other_settings_told() {
        let directory = tempfile::tempdir().expect("a directory");
        let path = directory.path().join("evaluations.jsonl");
        EvaluationLog::create(&path, &head("a", 5), None).expect("is written");
        let error = Earlier::read(&path, &head("b", 5)).expect_err("is refused");
        assert!(error.to_string().contains("another problem"), "{error}");
        let mut more = head("a", 9);
        more.settings.insert("plot".into(), "xy".into());
        let found = Earlier::read(&path, &more)
            .expect("is read")
            .expect("begun");
        assert_eq!(
            more.changes(&found.head),
            [
                "/optimiser/iterations was 5, is 9",
                "/plot was left out, is \"xy\""
            ]
        );
        assert!(found.head.changes(&found.head).is_empty());
    }
}
