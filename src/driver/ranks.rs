//! What a command asks of processes that work on one optimisation together, called ranks.

use super::known_evaluations::KnownEvaluations;
use super::multi_start::Run;
use super::shared::Shared;
use crate::optimiser::SavedState;
use crate::problem::Problem;
use crate::report::evaluations::EvaluationRecord;
use std::path::Path;
use std::sync::Arc;

/// The log of a start: what it knows, and the receiver of what is new.
pub struct StartLog<'j> {
    /// Evaluations of an earlier run.
    pub earlier: Vec<EvaluationRecord>,
    /// Takes new ones.
    pub record: Box<dyn FnMut(EvaluationRecord) + 'j>,
}

impl<'j> From<StartLog<'j>> for KnownEvaluations<'j> {
    fn from(log: StartLog<'j>) -> Self {
        Self::new(log.earlier, log.record)
    }
}

/// Gives the log of a start, by its number and problem, or `None` if there can be none.
pub type OpenLog<'j> = dyn Fn(usize, &Problem) -> Option<StartLog<'j>> + 'j;

/// The ranks, seen from the one that reads, writes and reports.
pub trait Ranks {
    /// Tells the file that the problems are read from.
    fn read_from(&self, file: &Path);

    /// Announces problems, each with starts from which it will be optimised. Free ranks may begin with them, those of the
    /// first problem first.
    fn announce(&self, problems: Vec<(Problem, Vec<Vec<f64>>)>);

    /// Optimises problem `of` of those announced from the start `first`, if there is one, and from the announced ones: as
    /// [`multi_start`](super::multi_start()). `first` has the number 0 then.
    fn multi_start(
        &self,
        of: usize,
        first: Option<Vec<f64>>,
        stopped: &dyn Fn() -> bool,
        open: Option<&OpenLog<'_>>,
    ) -> Vec<Run>;

    /// The ranks that share a problem: its cases, or where it has none and `bodies` says so the elements of its bodies; `None`
    /// if it has too few. They begin with the same state and the same known evaluations.
    fn share(
        &self,
        problem: &Problem,
        bodies: bool,
        state: Option<&SavedState>,
        earlier: &[EvaluationRecord],
    ) -> Option<Arc<Shared>>;
}
