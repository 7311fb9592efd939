//! The file of evaluations: read after a run that ended in any way, and appended to.

use super::chain::Chain;
use super::{EvaluationRecord, Found, Head};
use crate::ReportError;
use crate::files::atomic_begin;
use serde_json::error::Category;
use std::fs::File;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Longest time between two synchronisations with the disk.
const SYNCHRONISE: Duration = Duration::from_secs(1);

/// The complete evaluations of an earlier run; a truncated last line is dropped.
#[derive(Clone, Debug, PartialEq)]
pub struct Earlier {
    /// The head: the problem of the evaluations.
    pub head: Head,
    /// Evaluations and choices of steps, in order.
    pub records: Vec<EvaluationRecord>,
}

impl Earlier {
    /// Reads the file of an earlier run. `None` if there is no file or its first line is
    /// incomplete.
    ///
    /// A truncated last line is ignored, and so are steps that were chosen for a missing
    /// evaluation.
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
        let written: Head = serde_json::from_slice(first.trim_ascii_end())
            .map_err(|error| fault(1, damage(&error), "the head of a record of evaluations"))?;
        if !head.fits(&written) {
            return Err(fault(
                1,
                "the evaluations of another problem or start".into(),
                "those of this one; give the same file, the same files that it names, --set and --from, or leave --resume out",
            ));
        }
        if let Some((found, expected)) = head.other_form(&written) {
            return Err(fault(1, found.into(), expected));
        }
        let (mut records, mut complete) = (Vec::new(), 0);
        // The lines of older versions have no hash.
        let mut chain = match written.chained {
            true => Some(Chain::of(&written)?),
            false => None,
        };
        for (k, line) in lines.filter(|line| line.ends_with(b"\n")).enumerate() {
            let line = line.trim_ascii_end();
            let (body, hash) = match &chain {
                Some(_) => Chain::split(line),
                None => (line.into(), None),
            };
            let record: EvaluationRecord = serde_json::from_slice(&body).map_err(|error| {
                let expected = "a whole evaluation, as every line but the last one is";
                fault(k + 2, damage(&error), expected)
            })?;
            if let Some((found, expected)) = record.fault(head) {
                return Err(fault(k + 2, found, expected));
            }
            if let Some(chain) = &mut chain
                && Some(chain.next(&body)) != hash.as_deref()
            {
                return Err(fault(
                    k + 2,
                    "a line whose \"chain\" does not follow from the lines before it".into(),
                    "all lines as they were written: one was changed or is missing here or before; \
                     leave --resume out to begin anew",
                ));
            }
            let chosen = matches!(record.found, Found::Steps(_));
            records.push(record);
            if !chosen {
                complete = records.len();
            }
        }
        records.truncate(complete);
        Ok(Some(Self {
            head: written,
            records,
        }))
    }
}

/// The fault of a line, without its number in the file.
fn damage(error: &serde_json::Error) -> String {
    let text = error.to_string();
    let what = text.split(" at line ").next().unwrap_or_default();
    match error.classify() {
        Category::Eof => format!("a line that breaks off at column {}", error.column()),
        Category::Syntax => format!("no JSON at column {} ({what})", error.column()),
        Category::Data | Category::Io => what.to_owned(),
    }
}

/// The open file.
#[derive(Debug)]
pub struct EvaluationLog {
    path: PathBuf,
    file: File,
    chain: Chain,
    synchronised: Instant,
}

impl EvaluationLog {
    /// Begins a new file with the evaluations of an earlier run, if there is one. Creates the
    /// directory if it is missing. An existing file stays until the new one is complete.
    ///
    /// # Errors
    /// [`ReportError::Write`] with the path.
    pub fn create(
        path: &Path,
        head: &Head,
        earlier: Option<&Earlier>,
    ) -> Result<Self, ReportError> {
        let mut text = serde_json::to_string(head)? + "\n";
        let mut chain = Chain::of(head)?;
        for record in earlier.map_or(&[][..], |earlier| &earlier.records) {
            text.push_str(&chain.line(record)?);
        }
        Ok(Self {
            file: atomic_begin(path, text.as_bytes())?,
            path: path.to_path_buf(),
            chain,
            synchronised: Instant::now(),
        })
    }

    /// Appends an evaluation in one write. The operating system has it when this returns. The disk
    /// has it if the last synchronisation was more than a second ago.
    ///
    /// # Errors
    /// [`ReportError::Write`] with the path.
    pub fn append(&mut self, record: &EvaluationRecord) -> Result<(), ReportError> {
        let line = self.chain.line(record)?;
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
        // A failure of the disk here loses data only if the machine fails too.
        let _ = self.synchronise();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evaluations::{StepsInUse, Work};

    fn head(sha256: &str, iterations: usize) -> Head {
        let settings =
            serde_json::json!({"name": "throw", "optimiser": {"iterations": iterations}});
        Head {
            sha256: sha256.into(),
            start: vec![1.0],
            variables: vec!["mass".into()],
            functions: vec!["range".into()],
            settings: settings.as_object().expect("an object").clone(),
            chained: true,
            lowered: None,
        }
    }

    fn record(x: f64) -> EvaluationRecord {
        EvaluationRecord {
            design: vec![x],
            found: Found::Values(vec![x * x]),
            event: Some(0.3 + x.abs()),
            events_of_cases: Vec::new(),
            work: Work {
                solves: 7,
                ..Work::default()
            },
        }
    }

    fn steps() -> EvaluationRecord {
        EvaluationRecord {
            design: vec![3.0],
            found: Found::Steps(StepsInUse {
                method: "dop853".into(),
                reason: "first design".into(),
                method_reason: None,
                cells: Vec::new(),
                ends: vec![0.0, 1.0],
                kinks: Vec::new(),
                equal: false,
                left_out: Vec::new(),
                cases: Vec::new(),
            }),
            event: None,
            events_of_cases: Vec::new(),
            work: Work::default(),
        }
    }

    /// Wherever a file is cut, every complete evaluation before the cut reads back with every bit.
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

    /// Damage within a record is reported with its line and what was expected.
    #[test]
    fn damaged_lines_are_refused_by_name() {
        let directory = tempfile::tempdir().expect("a directory");
        let path = directory.path().join("evaluations.jsonl");
        let mut log = EvaluationLog::create(&path, &head("a", 5), None).expect("is written");
        log.append(&steps()).expect("is written");
        log.append(&record(2.0)).expect("is written");
        let whole = std::fs::read_to_string(&path).expect("is read");
        let refused = |from: &str, to: &str, told: &str| {
            assert!(whole.contains(from), "{from}");
            std::fs::write(&path, whole.replacen(from, to, 1)).expect("is written");
            let error = Earlier::read(&path, &head("a", 5)).expect_err("is refused");
            let (_, text) = error.to_string().split_once("jsonl:").map_or_else(
                || panic!("{error}"),
                |(file, text)| (file.to_owned(), text.to_owned()),
            );
            assert_eq!(text, told);
        };
        let rise = "expected ends of steps that rise from 0 to 1";
        let ends = "[0.0,1.0]";
        let cases = [
            ("[0.0,0.7,0.5,1.0]", "a step from 0.7 to 0.5"),
            ("[0.0,0.0,1.0]", "a step from 0.0 to 0.0"),
            ("[0.0,0.9]", "steps from 0.0 to 0.9"),
            ("[0.0]", "a single end"),
        ];
        for (to, found) in cases {
            refused(ends, to, &format!("2: found {found}, {rise}"));
        }
        refused(
            "dop853",
            "euler",
            "2: found the method \"euler\", expected the name of a method, such as dop853, radau3 or bdf2",
        );
        let line = "a whole evaluation, as every line but the last one is";
        let second = whole.lines().nth(1).expect("a line");
        refused(
            &second[second.find("\"reason\"").expect("a reason")..],
            "\"rea",
            &format!("2: found a line that breaks off at column 47, expected {line}"),
        );
        refused(
            "{\"design\":[3.0]",
            "{design:[3.0]",
            &format!("2: found no JSON at column 2 (key must be a string), expected {line}"),
        );
        refused(
            "\"values\"",
            "\"worth\"",
            &format!("3: found no variant of enum Found found in flattened data, expected {line}"),
        );
        refused(
            "\"event\":2.3",
            "\"event\":-2.3",
            "3: found an event at -2.3 s, expected a time after the start",
        );
        refused(
            "\"values\":[4.0]",
            "\"values\":[4.0,1.0]",
            "3: found lists of other lengths, expected a number for each variable and function",
        );
    }

    /// Any change of a line within a record makes that line or the next one invalid. Lines of older
    /// versions are read as they are.
    #[test]
    fn changed_lines_are_refused_and_lines_without_hashes_read() {
        let directory = tempfile::tempdir().expect("a directory");
        let path = directory.path().join("evaluations.jsonl");
        let mut log = EvaluationLog::create(&path, &head("a", 5), None).expect("is written");
        let all = [steps(), record(1.0), record(2.0), record(3.0), record(4.0)];
        for record in &all {
            log.append(record).expect("is written");
        }
        let whole = std::fs::read_to_string(&path).expect("is read");
        let lines: Vec<&str> = whole.split_inclusive('\n').collect();
        let read = |lines: &[&str]| {
            std::fs::write(&path, lines.concat()).expect("is written");
            Earlier::read(&path, &head("a", 5))
        };
        for k in 1..lines.len() - 1 {
            let mut removed = lines.clone();
            removed.remove(k);
            let mut swapped = lines.clone();
            swapped.swap(k, k + 1);
            let mut twice = lines.clone();
            twice.insert(k, lines[k]);
            let other = lines[k].replacen("[", "[ ", 1);
            let mut edited = lines.clone();
            edited[k] = &other;
            let cases = [(removed, k), (swapped, k), (twice, k + 1), (edited, k)];
            for (changed, first) in cases {
                let error = read(&changed).expect_err("is refused").to_string();
                let told = format!(
                    ":{}: found a line whose \"chain\" does not follow",
                    first + 1
                );
                assert!(error.contains(&told), "{k} {error}");
            }
        }
        // As older versions wrote them.
        let plain = |line: &str| {
            let (body, _) = Chain::split(line.trim_end().as_bytes());
            String::from_utf8_lossy(&body).into_owned() + "\n"
        };
        let mut old: Vec<String> = lines.iter().map(|line| plain(line)).collect();
        old[0] = old[0].replace(",\"chained\":true", "");
        assert!(!old.concat().contains("chain"));
        let old: Vec<&str> = old.iter().map(String::as_str).collect();
        let found = read(&old).expect("is read").expect("begun");
        assert_eq!(found.records, all);
        EvaluationLog::create(&path, &head("a", 5), Some(&found)).expect("is written");
        assert_eq!(std::fs::read_to_string(&path).expect("is read"), whole);
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
