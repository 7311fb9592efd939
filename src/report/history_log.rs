//! `history.partial.csv`: the table of iterations of a run under way.

use super::ReportError;
use super::history::History;
use std::fs::File;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

/// The table of a run under way. Each row is appended when it is known; earlier rows do not change.
/// If the process is killed, the last row may be incomplete.
#[derive(Debug)]
pub struct HistoryLog {
    path: PathBuf,
    file: Option<File>,
}

impl HistoryLog {
    /// A new table in the file `path`, written with the first row.
    pub fn new(path: &Path) -> Self {
        Self {
            path: path.to_path_buf(),
            file: None,
        }
    }

    /// Appends the last row of `history`, after the header if it is the first that is appended.
    ///
    /// # Errors
    /// [`ReportError::Write`] with the path, or as [`History::to_csv`].
    pub fn append(&mut self, history: &History) -> Result<(), ReportError> {
        let Some(last) = history.rows.len().checked_sub(1) else {
            return Ok(());
        };
        let fault = |source| ReportError::Write {
            path: self.path.clone(),
            source,
        };
        let (mut text, file) = match &mut self.file {
            Some(file) => (String::new(), file),
            None => {
                let file = new_file(&self.path).map_err(fault)?;
                (history.header()?, self.file.insert(file))
            }
        };
        history.write_row(&mut text, last)?;
        file.write_all(text.as_bytes()).map_err(fault)
    }
}

/// A new file that replaces an existing one. The target of a link there is unchanged.
fn new_file(path: &Path) -> std::io::Result<File> {
    match std::fs::remove_file(path) {
        Err(error) if error.kind() != ErrorKind::NotFound => Err(error),
        _ => File::create_new(path),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::history::{Column, HistoryRow};

    /// A link in place of the table is replaced; what it points to stays.
    #[cfg(unix)]
    #[test]
    fn a_link_is_not_followed() {
        let directory = tempfile::tempdir().expect("a directory");
        let target = directory.path().join("mine");
        std::fs::write(&target, "precious").expect("is written");
        let path = directory.path().join("history.partial.csv");
        for to in [&target, &directory.path().join("nothing")] {
            let _ = std::fs::remove_file(&path);
            std::os::unix::fs::symlink(to, &path).expect("is linked");
            let history = History {
                objective: Column::new("range", None),
                variables: Vec::new(),
                constraints: Vec::new(),
                rows: vec![HistoryRow::default()],
            };
            HistoryLog::new(&path).append(&history).expect("is written");
            assert!(!path.is_symlink() && path.is_file());
            assert_eq!(std::fs::read(&target).expect("is read"), b"precious");
            assert!(!directory.path().join("nothing").exists());
        }
    }

    /// Every row is appended once: earlier rows stay in the same file, which holds the table so
    /// far.
    #[test]
    fn a_table_grows_by_its_last_row() {
        let mut history = History {
            objective: Column::new("range", Some("m")),
            variables: vec![Column::new("mass", Some("kg"))],
            constraints: Vec::new(),
            rows: Vec::new(),
        };
        let directory = tempfile::tempdir().expect("a directory");
        let path = directory.path().join("history.partial.csv");
        std::fs::write(&path, "of an earlier run").expect("is written");
        let mut log = HistoryLog::new(&path);
        let mut first = None;
        for iteration in 0..4 {
            history.rows.push(HistoryRow {
                iteration,
                evaluations: iteration + 1,
                objective: 0.1 + iteration as f64,
                infeasibility: 0.0,
                optimality: f64::NAN,
                barrier: 0.1,
                step_norm: 1.0,
                dual_step: 1.0,
                primal_step: 1.0,
                regularisation: 0.0,
                line_search_trials: 1,
                phase: "regular".into(),
                steps: None,
                refreshes: Some(0),
                design: vec![2.0],
                constraints: Vec::new(),
            });
            log.append(&history).expect("is written");
            let text = std::fs::read_to_string(&path).expect("is read");
            assert_eq!(text, history.to_csv().expect("is a table"));
            let reader = first.get_or_insert_with(|| File::open(&path).expect("is opened"));
            let same = reader.metadata().expect("is there").len();
            assert_eq!(same, text.len() as u64, "the file is the same");
        }
    }
}
