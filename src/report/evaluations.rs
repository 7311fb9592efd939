//! Every evaluation of an optimisation, `evaluations.jsonl`: one JSON document a line, written as
//! soon as it is known, so that a run that is killed loses the evaluation under way and no other. If
//! the machine fails, the evaluations of the last second may be lost too.

use super::{ReportError, read_text, write_all};
use serde::{Deserialize, Serialize};
use std::fs::{File, OpenOptions};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Longest time for which evaluations are left to the operating system.
const SYNCHRONISE: Duration = Duration::from_secs(1);

/// What the evaluations belong to: the first line.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Head {
    /// SHA-256 of the problem's document, hexadecimal.
    pub sha256: String,
    /// The design that the run started from.
    pub start: Vec<f64>,
    /// Names of the variables, in the order of every `design`.
    pub variables: Vec<String>,
    /// Names of the functions, objective first, in the order of all `values` and `gradients`.
    pub functions: Vec<String>,
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

/// The open file.
#[derive(Debug)]
pub struct EvaluationLog {
    path: PathBuf,
    file: File,
    synchronised: Instant,
}

impl EvaluationLog {
    /// Starts a file anew, in a directory that is made if need be.
    ///
    /// # Errors
    /// [`ReportError::Write`] with the path.
    pub fn create(path: &Path, head: &Head) -> Result<Self, ReportError> {
        let line = serde_json::to_string(head)? + "\n";
        write_all(&[(path.to_path_buf(), line.into_bytes())])?;
        Self::open(path)
    }

    /// Opens the file of an earlier run and returns what it holds. A last line that was cut off
    /// is removed.
    ///
    /// # Errors
    /// As [`EvaluationLog::read`], and if the file cannot be written.
    pub fn resume(path: &Path, head: &Head) -> Result<(Self, Vec<EvaluationRecord>), ReportError> {
        let (records, whole) = Self::read(path, head)?;
        let log = Self::open(path)?;
        log.file
            .set_len(whole as u64)
            .map_err(|source| log.unwritable(source))?;
        Ok((log, records))
    }

    /// What the file of an earlier run holds, and the length of its whole lines in bytes.
    ///
    /// # Errors
    /// [`ReportError`] if the file cannot be read, is damaged, or belongs to another problem.
    pub fn read(path: &Path, head: &Head) -> Result<(Vec<EvaluationRecord>, usize), ReportError> {
        let text = read_text(path)?;
        let fault = |line: usize, found: String, expected: &str| ReportError::Evaluations {
            path: path.to_path_buf(),
            line,
            found,
            expected: expected.to_owned(),
        };
        let whole = text.rfind('\n').map_or(0, |end| end + 1);
        let mut lines = text[..whole].lines();
        let first = lines.next().unwrap_or_default();
        let written: Head = serde_json::from_str(first)
            .map_err(|error| fault(1, error.to_string(), "the head of a record of evaluations"))?;
        if written != *head {
            return Err(fault(
                1,
                "the evaluations of another problem or start".into(),
                "those of this one; give the same file, --set and --from, or leave --resume out",
            ));
        }
        let records = lines
            .enumerate()
            .map(|(k, line)| {
                let record: EvaluationRecord = serde_json::from_str(line)
                    .map_err(|error| fault(k + 2, error.to_string(), "an evaluation"))?;
                if record.fits(head) {
                    Ok(record)
                } else {
                    let found = "lists of other lengths".to_owned();
                    Err(fault(
                        k + 2,
                        found,
                        "a number for each variable and function",
                    ))
                }
            })
            .collect::<Result<_, _>>()?;
        Ok((records, whole))
    }

    fn open(path: &Path) -> Result<Self, ReportError> {
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

    /// Waits until the disk has all evaluations.
    ///
    /// # Errors
    /// [`ReportError::Write`] with the path.
    pub fn synchronise(&mut self) -> Result<(), ReportError> {
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

#[cfg(test)]
mod tests {
    use super::*;

    fn head(sha256: &str) -> Head {
        Head {
            sha256: sha256.into(),
            start: vec![1.0],
            variables: vec!["mass".into()],
            functions: vec!["range".into()],
        }
    }

    fn record(x: f64) -> EvaluationRecord {
        EvaluationRecord {
            design: vec![x],
            found: Found::Values(vec![x * x]),
        }
    }

    #[test]
    fn whole_lines_survive_a_cut_and_every_bit_comes_back() {
        let directory = tempfile::tempdir().expect("a directory");
        let path = directory.path().join("evaluations.jsonl");
        let mut log = EvaluationLog::create(&path, &head("a")).expect("is written");
        let all = [record(0.1 + 0.2), record(1e-310), record(-7.0)];
        for record in &all {
            log.append(record).expect("is written");
        }
        let text = read_text(&path).expect("is read");
        std::fs::write(&path, &text[..text.len() - 5]).expect("is cut");
        let (mut log, found) = EvaluationLog::resume(&path, &head("a")).expect("is resumed");
        assert_eq!(found, all[..2]);
        log.append(&all[2]).expect("is written");
        let (_, found) = EvaluationLog::resume(&path, &head("a")).expect("is resumed");
        assert_eq!(found, all);
    }

    #[test]
    fn the_evaluations_of_another_problem_are_refused() {
        let directory = tempfile::tempdir().expect("a directory");
        let path = directory.path().join("evaluations.jsonl");
        EvaluationLog::create(&path, &head("a")).expect("is written");
        let error = EvaluationLog::resume(&path, &head("b")).expect_err("is refused");
        assert!(error.to_string().contains("another problem"), "{error}");
    }
}
