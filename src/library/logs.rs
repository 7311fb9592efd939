//! The evaluation logs of a run, new or resumed.

use crate::driver::integration::FIRST_DESIGN;
use crate::driver::ranks::StartLog;
use crate::driver::{KnownEvaluations, known_evaluations};
use crate::problem::{Problem, visible};
use crate::report::ReportError;
use crate::report::evaluations::{Earlier, EvaluationLog, EvaluationRecord, Found, StepsInUse};
use std::path::{Path, PathBuf};
use std::sync::Mutex;

/// Log of the only start.
const SINGLE: &str = "evaluations.jsonl";
/// Beginning and end of the names of logs of several starts; the number of the start is between
/// them.
const SEVERAL: (&str, &str) = ("evaluations.start_", ".jsonl");

/// Directory of the logs of a run, if it writes any, and of those of the run that it resumes, if any.
pub(crate) struct Logs<'a> {
    directory: Option<&'a Path>,
    resumed: Option<&'a Path>,
}

/// A start of a run: the only one, or one of several, counted from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Start {
    Only,
    OneOf(usize),
}

impl Start {
    fn file(self) -> String {
        match self {
            Self::Only => SINGLE.to_owned(),
            Self::OneOf(k) => format!("{}{}{}", SEVERAL.0, k + 1, SEVERAL.1),
        }
    }
}

/// The opened log of one start.
pub(crate) struct Opened {
    log: Option<EvaluationLog>,
    earlier: Vec<EvaluationRecord>,
    /// Number of evaluations of an earlier run.
    pub known: usize,
    /// Settings that differ from those of the earlier run.
    pub changes: Vec<String>,
}

impl<'a> Logs<'a> {
    /// The logs of a run in `directory`, which exists. Logs of another run in it are removed,
    /// unless this run is resumed.
    ///
    /// # Errors
    /// A log of another run cannot be removed.
    pub(crate) fn new(
        directory: Option<&'a Path>,
        resumed: Option<&'a Path>,
    ) -> Result<Self, ReportError> {
        let same = |directory: &Path| {
            resumed.is_some_and(
                |from| match (from.canonicalize(), directory.canonicalize()) {
                    (Ok(a), Ok(b)) => a == b,
                    _ => from == directory,
                },
            )
        };
        if let Some(directory) = directory.filter(|own| !same(own)) {
            remove(directory)?;
        }
        Ok(Self { directory, resumed })
    }

    /// Message about an earlier run with `known` evaluations.
    pub(crate) fn resumed(&self, known: usize) -> String {
        match (self.resumed, known) {
            (None, _) => String::new(),
            (Some(from), 0) => format!("{}: no evaluation yet, starts anew\n", shown(from)),
            (Some(from), n) => {
                let from = shown(from);
                format!("{from}: {n} evaluations are known and are not repeated\n")
            }
        }
    }

    /// Opens the log of a start and reads that of an earlier run.
    pub(crate) fn open(&self, start: Start, problem: &Problem) -> Result<Opened, ReportError> {
        self.opened(self.resumed, start, problem)
    }

    /// Opens the log of a start of this run again.
    pub(crate) fn reopen(&self, start: Start, problem: &Problem) -> Result<Opened, ReportError> {
        self.opened(self.directory, start, problem)
    }

    fn opened(
        &self,
        from: Option<&Path>,
        start: Start,
        problem: &Problem,
    ) -> Result<Opened, ReportError> {
        let head = known_evaluations::head(problem);
        let file = start.file();
        let earlier = match from {
            Some(from) => Earlier::read(&from.join(&file), &head)?,
            None => None,
        };
        let create = |directory: &Path| {
            EvaluationLog::create(&directory.join(&file), &head, earlier.as_ref())
        };
        let log = self.directory.map(create).transpose()?;
        let changes = earlier.as_ref().map(|earlier| head.changes(&earlier.head));
        let earlier = earlier.map_or_else(Vec::new, |earlier| earlier.records);
        let evaluation = |record: &&EvaluationRecord| !matches!(record.found, Found::Steps(_));
        Ok(Opened {
            log,
            known: earlier.iter().filter(evaluation).count(),
            earlier,
            changes: changes.unwrap_or_default(),
        })
    }
}

impl Opened {
    /// The known evaluations of the log. The first failure to write is stored in `fault`. Choices
    /// of steps are reported to `tell`, if it is given.
    pub(crate) fn known_evaluations(
        self,
        fault: &Mutex<Option<ReportError>>,
        tell: Option<fn(&str)>,
    ) -> KnownEvaluations<'_> {
        self.start_log(fault, tell).into()
    }

    /// The evaluations of an earlier run.
    pub(crate) fn earlier(&self) -> &[EvaluationRecord] {
        &self.earlier
    }

    /// As [`Opened::known_evaluations`], for a start that another process may run.
    pub(crate) fn start_log(
        self,
        fault: &Mutex<Option<ReportError>>,
        tell: Option<fn(&str)>,
    ) -> StartLog<'_> {
        let earlier = self.earlier;
        let Some(mut log) = self.log else {
            return StartLog {
                earlier,
                record: Box::new(|_| {}),
            };
        };
        let record = move |evaluation: EvaluationRecord| {
            // The first choice of equal steps needs no report.
            let told = |steps: &StepsInUse| !steps.ends.is_empty() || steps.reason != FIRST_DESIGN;
            if let (Some(tell), Found::Steps(steps)) = (tell, &evaluation.found)
                && told(steps)
            {
                let count = match steps.ends.len() {
                    0 => "equal".into(),
                    ends => (ends - 1).to_string(),
                };
                tell(&match steps.cases.is_empty() {
                    true => format!("{count} steps by {}: {}\n", steps.method, steps.reason),
                    false => format!("steps: {}\n", steps.reason),
                });
            }
            if let Err(error) = log.append(&evaluation)
                && let Ok(mut first) = fault.lock()
            {
                first.get_or_insert(error);
            }
        };
        StartLog {
            earlier,
            record: Box::new(record),
        }
    }
}

/// Message about the differences from the resumed run.
pub(crate) fn changed(changes: &[String]) -> String {
    changes
        .iter()
        .map(|change| format!("changed since the resumed run: {change}\n"))
        .collect()
}

/// Why a directory has no run that can be resumed, if so: there is none in it, or one of the other kind.
/// `several` states whether the resumed run has several starts.
///
/// # Errors
/// The directory cannot be read.
pub(crate) fn without_run(from: &Path, several: bool) -> Result<Option<String>, ReportError> {
    if !from.is_dir() {
        return Ok(Some(format!(
            "found no directory {}, expected that of the run to resume; to begin one, leave --resume \
             out",
            shown(from)
        )));
    }
    let (single, multiple) = files(from)?.into_iter().partition::<Vec<_>, _>(|file| {
        let name = file.file_name();
        name.is_some_and(|name| name == SINGLE)
    });
    let (wanted, others, advice) = match several {
        true => (&multiple, &single, "leave --starts out"),
        false => (&single, &multiple, "give --starts N"),
    };
    if !wanted.is_empty() {
        return Ok(None);
    }
    Ok(Some(match others.first() {
        Some(file) => format!(
            "found {}, expected the record of {}: {advice} to resume it",
            shown(file),
            if several { "several starts" } else { SINGLE },
        ),
        None => format!(
            "found no record of a run in {}, expected {}; to begin a run, leave --resume out",
            shown(from),
            if several {
                Start::OneOf(0).file()
            } else {
                SINGLE.to_owned()
            },
        ),
    }))
}

fn shown(path: &Path) -> String {
    visible(&path.display().to_string())
}

/// All logs in a directory.
fn files(directory: &Path) -> Result<Vec<PathBuf>, ReportError> {
    let entries = std::fs::read_dir(directory).map_err(|source| ReportError::Read {
        path: directory.to_path_buf(),
        source,
    })?;
    let is_record = |path: &PathBuf| {
        let name = path.file_name().map(|name| name.to_string_lossy());
        name.is_some_and(|name| {
            name == SINGLE || (name.starts_with(SEVERAL.0) && name.ends_with(SEVERAL.1))
        })
    };
    let mut all: Vec<PathBuf> = entries
        .flatten()
        .map(|entry| entry.path())
        .filter(is_record)
        .collect();
    all.sort();
    Ok(all)
}

fn remove(directory: &Path) -> Result<(), ReportError> {
    for path in files(directory)? {
        std::fs::remove_file(&path).map_err(|source| ReportError::Write { path, source })?;
    }
    Ok(())
}
