//! What ranks and rank 0 write to each other. A rank asks, rank 0 answers each letter once: so no two of them ever wait to
//! send to each other.

use crate::cli::progress::progress;
use crate::driver::packed::PackedRun;
use crate::optimiser::SavedState;
use crate::problem::{Faults, Problem};
use crate::report::evaluations::EvaluationRecord;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// What a rank tells rank 0.
#[derive(Serialize, Deserialize)]
pub(super) struct Letter {
    /// What happened since the last letter, in order.
    pub events: Vec<Event>,
    /// How many starts it could begin.
    pub free: usize,
    /// How many run.
    pub running: usize,
    /// The announcement that it knows; 0 for none.
    pub announced: u64,
    /// Whether it got a signal to end.
    pub interrupted: bool,
}

/// What happened in a start.
#[derive(Serialize, Deserialize)]
pub(super) enum Event {
    /// A design was evaluated, or steps were chosen.
    Record(u64, Box<EvaluationRecord>),
    /// It has ended. None if there is nothing to optimise.
    Done(u64, Option<Box<PackedRun>>),
}

/// What rank 0 answers.
#[derive(Serialize, Deserialize)]
pub(super) enum Reply {
    /// Problems whose starts will be handed out, and the number of this announcement.
    Problems(u64, Vec<Description>),
    /// Starts to begin, if any, and whether all that run shall end.
    Tasks(Vec<Task>, bool),
    /// An optimisation that ranks share.
    Shared(Box<SharedProblem>),
    /// There is no more work.
    End,
}

/// A start to run.
#[derive(Clone, Serialize, Deserialize)]
pub(super) struct Task {
    pub id: u64,
    /// Its problem, by the order of the announcement.
    pub of: usize,
    pub start: usize,
    pub design: Vec<f64>,
    /// What is left of the time limit of all starts \[s\].
    pub seconds: Option<f64>,
    /// Known evaluations.
    pub earlier: Vec<EvaluationRecord>,
}

/// A problem that ranks share.
#[derive(Serialize, Deserialize)]
pub(super) struct SharedProblem {
    pub description: Description,
    pub start: Vec<f64>,
    /// Ranks from 0 on that share it.
    pub ranks: usize,
    /// Whether they compute its motions together, each with so much memory for gradients \[bytes\]; else they have their own
    /// cases.
    pub together: Option<usize>,
    pub state: Option<SavedState>,
    pub earlier: Vec<EvaluationRecord>,
}

/// All that makes a problem.
#[derive(Clone, Serialize, Deserialize)]
pub(super) struct Description {
    document: String,
    /// The path of its file, from which it names others.
    file: String,
    hash: String,
    is_lowered: bool,
    memory: Option<usize>,
}

/// Why a rank has no problem.
#[derive(Debug, thiserror::Error)]
pub(super) enum Unread {
    #[error(transparent)]
    Faults(#[from] Faults),
    #[error(
        "{file}: found files beside it that differ from those of rank 0, expected the same on all nodes"
    )]
    Differs { file: String },
}

impl Description {
    pub fn of(problem: &Problem, file: &Path) -> Self {
        Self {
            document: problem.document.to_string(),
            file: file.to_string_lossy().into_owned(),
            hash: problem.hash.clone(),
            is_lowered: problem.is_lowered(),
            memory: problem.simulation.memory,
        }
    }

    /// The problem, as it is optimised.
    ///
    /// # Errors
    /// A file that it names cannot be read, or is another one here.
    pub fn problem(&self) -> Result<Problem, Unread> {
        let mut problem = Problem::parse(&self.document, &self.file, &[])?;
        if problem.hash != self.hash {
            let file = self.file.clone();
            return Err(Unread::Differs { file });
        }
        let progress = progress();
        problem.change_all(&|own| {
            if !self.is_lowered {
                own.lowering = None;
            }
            own.simulation.memory = self.memory;
            own.simulation.limits.progress = Some(progress.clone());
        });
        Ok(problem.for_optimisation().unwrap_or(problem))
    }
}
