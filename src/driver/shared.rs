//! One optimisation over processes, called ranks: the cases of a design are spread over them, or they compute every motion
//! together.
//!
//! Every rank runs the same optimiser. A case belongs to one rank, which simulates and differentiates it; its numbers then
//! go to all ranks, and functions over cases follow from them in the order of the file. So every rank has the same bits,
//! whatever the number of ranks. What depends on a clock, a signal or a disk is no choice of one rank: it travels with the
//! numbers, and all ranks act on it after the same exchange.

use crate::event_times::Events;
use crate::integrate::WorkCounts;
use crate::math::Team;
use crate::report::evaluations::{StepsInUse, Work};
use serde::{Deserialize, Serialize};
use std::fmt;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Instant;

/// A way between the ranks.
pub trait Exchange: Send + Sync {
    /// The number of this rank, from 0.
    fn rank(&self) -> usize;

    /// How many there are.
    fn ranks(&self) -> usize;

    /// Gives a message to all ranks and takes one from each, in the order of ranks.
    ///
    /// # Errors
    /// [`Lost`], if a rank no longer answers.
    fn all(&self, own: Message) -> Result<Vec<Message>, Lost>;
}

/// A rank no longer answers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("interrupted: a rank no longer answers")]
pub struct Lost;

/// What a rank tells all others at one design.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Message {
    /// Number of the exchange.
    number: u64,
    /// The bits of the design.
    design: Vec<u64>,
    /// Whether the run shall end.
    ends: bool,
    /// Wall time of the run by the clock of this rank \[s\].
    seconds: f64,
    content: Content,
}

/// Numbers of the cases of a rank.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) enum Content {
    Values(Vec<CaseValues>),
    Gradients(Vec<CaseGradients>),
    /// By case: why its gradients are refused, if they are.
    Refusals(Vec<(usize, Option<String>)>),
    /// All compute the motion of this design together.
    Together,
    /// The run has ended.
    End,
}

/// A case after its analysis.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct CaseValues {
    pub case: usize,
    /// When its motions ended at events.
    pub events: Events,
    pub refreshes: usize,
    pub unlowered: usize,
    /// Its steps, if they were chosen now.
    pub steps: Option<StepsInUse>,
    /// Why they were chosen anew, if the record has to tell it.
    pub reason: Option<String>,
    /// Values of its functions, or why there are none.
    pub found: Result<Elsewhere, String>,
}

/// The values of a case that another rank has.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Elsewhere {
    /// The design.
    #[serde(skip)]
    pub x: Vec<f64>,
    /// Values of the functions of its problem that are wanted.
    pub values: Vec<(usize, f64)>,
    /// The origin of those that are not finite.
    pub(crate) not_finite: Vec<(usize, String)>,
    /// The work of the analysis.
    pub(crate) work: Work,
}

impl Elsewhere {
    /// The value of a function of its problem; NaN if it is not wanted.
    pub fn value(&self, f: usize) -> f64 {
        let own = self.values.iter().find(|(own, _)| *own == f);
        own.map_or(f64::NAN, |(_, value)| *value)
    }

    /// The work of the analysis.
    pub(crate) fn counts(&self) -> WorkCounts {
        counts(self.work)
    }

    /// The origin of a value that is not finite.
    pub(crate) fn not_finite_value(&self, f: usize) -> String {
        let own = self.not_finite.iter().find(|(own, _)| *own == f);
        own.map_or_else(String::new, |(_, why)| why.clone())
    }
}

/// The counts that records keep.
pub(crate) fn counts(work: Work) -> WorkCounts {
    WorkCounts {
        steps: work.steps,
        recomputed: work.recomputed,
        newton_iterations: work.newton_iterations,
        factorisations: work.factorisations,
        solves: work.solves,
        ..WorkCounts::default()
    }
}

/// Derivatives of the wanted functions of a case.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct CaseGradients {
    pub case: usize,
    /// Functions without derivative, and why.
    pub kinks: Vec<(usize, String)>,
    /// A row for each function and the work, or why there are none.
    pub found: Result<(Vec<Vec<f64>>, Work), String>,
}

/// What all ranks know alike after an exchange.
#[derive(Debug, Default)]
struct Agreed {
    exchanges: u64,
    over: bool,
    seconds: f64,
    /// Whether this rank wishes the end.
    wish: bool,
}

/// Ranks that compute every motion together.
#[derive(Clone, Debug)]
pub struct Together {
    /// The ranks.
    pub team: Team,
    /// Whether they must end, as all know it at the same step.
    pub over: Arc<AtomicBool>,
    /// Memory that the tape of each may take \[bytes\]: all have to repeat the same steps.
    pub memory: usize,
}

/// The ranks that share a run.
pub struct Shared {
    exchange: Box<dyn Exchange>,
    together: Option<Together>,
    begun: Instant,
    agreed: Mutex<Agreed>,
}

impl fmt::Debug for Shared {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (rank, ranks) = (self.exchange.rank(), self.exchange.ranks());
        write!(f, "rank {rank} of {ranks}")
    }
}

impl Shared {
    /// The ranks of a way between them: they compute motions `together`, or have their own cases.
    pub fn new(exchange: Box<dyn Exchange>, together: Option<Together>) -> Arc<Self> {
        Arc::new(Self {
            exchange,
            together,
            begun: Instant::now(),
            agreed: Mutex::default(),
        })
    }

    fn agreed(&self) -> MutexGuard<'_, Agreed> {
        self.agreed.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Whether a case belongs to this rank. Cases go around, so that neighbours in the file, which are often alike, are
    /// on different ranks.
    pub(crate) fn owns(&self, case: usize) -> bool {
        case % self.exchange.ranks() == self.exchange.rank()
    }

    /// How the ranks compute motions together, if they do.
    pub(crate) fn together(&self) -> Option<&Together> {
        self.together.as_ref()
    }

    /// Whether all ranks know that the run must end.
    pub(crate) fn is_over(&self) -> bool {
        let over = |own: &Together| own.over.load(Ordering::Relaxed);
        self.agreed().over || self.together.as_ref().is_some_and(over)
    }

    /// Before a motion that all compute together: whether they do.
    ///
    /// # Errors
    /// The run must end.
    pub(crate) fn meet(&self, x: &[f64], ends: bool) -> Result<(), Lost> {
        match self.together {
            Some(_) => self.all(x, ends, Content::Together).map(drop),
            None => Ok(()),
        }
    }

    /// Wall time of the run by the clock of rank 0, as all ranks know it \[s\].
    pub(crate) fn seconds(&self) -> f64 {
        self.agreed().seconds
    }

    /// Makes all ranks end at the next exchange.
    pub(crate) fn wish_end(&self) {
        self.agreed().wish = true;
    }

    /// Whether this rank wishes the end.
    pub(crate) fn wishes_end(&self) -> bool {
        self.agreed().wish
    }

    /// Gives `content` to all ranks, and returns that of each. Without communication once the run is over.
    ///
    /// # Errors
    /// The run must end, or a rank no longer answers.
    ///
    /// # Panics
    /// If the ranks are not at the same design: their numbers would belong to different ones.
    pub(crate) fn all(
        &self,
        x: &[f64],
        ends: bool,
        content: Content,
    ) -> Result<Vec<Content>, Lost> {
        let mut agreed = self.agreed();
        if agreed.over {
            return Err(Lost);
        }
        agreed.exchanges += 1;
        let own = Message {
            number: agreed.exchanges,
            design: x.iter().map(|x| x.to_bits()).collect(),
            ends: ends || agreed.wish,
            seconds: self.begun.elapsed().as_secs_f64(),
            content,
        };
        let (number, design) = (own.number, own.design.clone());
        let all = self.exchange.all(own).inspect_err(|_| agreed.over = true)?;
        for (rank, told) in all.iter().enumerate() {
            let same = told.number == number && told.design == design;
            let kind = std::mem::discriminant(&told.content);
            assert!(
                same && kind == std::mem::discriminant(&all[0].content),
                "rank {rank} is at another design than rank {}: are their processors or programs different?",
                self.exchange.rank()
            );
        }
        agreed.seconds = all[0].seconds;
        agreed.over = all.iter().any(|told| told.ends);
        match agreed.over {
            true => Err(Lost),
            false => Ok(all.into_iter().map(|told| told.content).collect()),
        }
    }

    /// All ranks end their runs here, at the same design.
    pub(crate) fn end(&self, x: &[f64]) {
        // If the run is over, all know it.
        let _ = self.all(x, false, Content::End);
    }
}
