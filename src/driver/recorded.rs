//! The designs of a record, simulated again.

use super::analysed::Simulated;
use super::ends::Ends;
use super::integration::Integration;
use super::optimise::requested;
use super::warm_start::WarmStart;
use crate::problem::Problem;
use crate::report::Optimum;
use crate::report::optimum::DesignValue;
use std::path::{Path, PathBuf};

/// Why the designs of a record cannot be simulated again.
#[derive(Debug, thiserror::Error)]
pub enum RecordedError {
    /// The document in the record is not a problem that this version can read.
    #[error("{0}")]
    Problem(crate::problem::Faults),
    /// The record lacks a variable of its own problem.
    #[error("the record has no value for the variable \"{0}\"")]
    Design(String),
}

/// The problem of a record, with the start and the end of its optimisation.
pub struct Recorded {
    /// The problem, without what neither objective nor constraints need.
    pub problem: Problem,
    start: Option<Simulated>,
    end: Option<Simulated>,
    converged: bool,
}

impl Recorded {
    /// Simulates the designs of a record that lies in `directory`. With the state of its end the motions are those of
    /// the run, on the same steps.
    ///
    /// # Errors
    /// If the record does not hold a readable problem and a value of each of its variables.
    pub fn of(
        optimum: &Optimum,
        state: Option<&WarmStart>,
        directory: &Path,
    ) -> Result<Self, RecordedError> {
        let text = optimum.problem.document.to_string();
        // Paths of files of bodies are relative to the problem file.
        let file = match &optimum.problem.directory {
            Some(beside) => directory.join(beside).join(&optimum.problem.file),
            None => PathBuf::from(&optimum.problem.file),
        };
        let file = file.display().to_string();
        let mut problem = Problem::parse(&text, &file, &[]).map_err(RecordedError::Problem)?;
        let recorded = |of: fn(&DesignValue) -> f64| {
            let variables = problem.variables.iter();
            let values = variables.map(|v| {
                let found = optimum.design.get(&v.name).map(of);
                found.ok_or_else(|| RecordedError::Design(v.name.clone()))
            });
            values.collect::<Result<Vec<f64>, _>>()
        };
        let (first, design) = (recorded(|d| d.start)?, recorded(|d| d.value)?);
        if state.is_some_and(|state| state.as_written) {
            problem.change_all(&|own| own.lowering = None);
        }
        let mut problem = problem.for_optimisation().unwrap_or(problem);
        problem.restart(&first);
        let start = Simulated::of(&problem, &first).ok();
        let requested: Vec<usize> = requested(&problem).collect();
        let mut integration = Integration::of(&problem, Some(&requested), true);
        let kept = state.filter(|state| state.fits(&problem));
        if let Some(kept) = kept.and_then(WarmStart::kept_steps) {
            integration.restore(kept);
            integration.see_whole();
        } else {
            integration = Integration::of(&problem, None, false);
        }
        let end = Simulated::with(&mut integration, &problem, &design).ok();
        Ok(Self {
            problem,
            start,
            end,
            converged: optimum.status == "converged",
        })
    }

    /// Both designs, as far as they could be simulated.
    pub fn ends(&self) -> Ends<'_> {
        Ends::new(self.start.as_ref(), self.end.as_ref(), self.converged)
    }
}
