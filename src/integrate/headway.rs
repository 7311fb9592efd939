//! When a march whose steps follow the error is given up: too many tries to come, or too many in a row
//! that are rejected.

use super::limits::Limits;
use crate::model::Model;

/// Most tries of a run whose steps follow the error, and most of them that are rejected, times the
/// unknowns of the accelerations. The pace is looked at every so many tries: a run that would need more
/// at its latest pace is given up at once. A mechanism that is nearly locked rejects a quarter of its
/// tries; so may a fast vibration of one body, which costs little.
const MOST: usize = 10_000_000;
const MOST_REJECTED: usize = 2_000_000;
const PACE: usize = 5_000;
/// Most tries in a row that are rejected. One that fails is a fifth as wide as the one before, and twenty of
/// those are below the smallest step; where the error is round-off, or jumps about, it would take hundreds.
pub(crate) const MOST_IN_A_ROW: usize = 100;

/// Why a march ended before the end of its motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Stop {
    /// The steps became too small.
    TooSmall,
    /// So many tries in a row were rejected.
    Rejected {
        /// Their number.
        in_a_row: usize,
    },
    /// The latest `tries`, `rejected` of them rejected, advanced the motion by the fraction `advance`
    /// of its duration; at this pace it would need too many.
    NoHeadway {
        /// Tries.
        tries: usize,
        /// Rejected ones among them.
        rejected: usize,
        /// Fraction of the duration.
        advance: f64,
    },
    /// It took longer than it may \[s\].
    TimeLimit(f64),
}

/// Unknowns of the accelerations: velocities and multipliers.
fn unknowns<S>(model: &Model<S>) -> usize {
    let velocities = model.bodies.iter().map(|body| body.mobility.unknowns());
    let rows = model.joints.iter().map(|joint| joint.rows().count());
    velocities.chain(rows).sum()
}

/// Counts the tries of a march.
#[derive(Debug)]
pub(crate) struct Headway {
    /// Tries, rejected ones among them, and those since the last step that was made.
    tries: usize,
    rejected: usize,
    in_a_row: usize,
    /// Fraction of the duration and rejected tries when the pace was looked at.
    looked: (f64, usize),
    /// Most rejected tries.
    most_rejected: usize,
}

impl Headway {
    /// Before the first try.
    pub(crate) fn new<S>(model: &Model<S>, limits: &Limits) -> Self {
        Self {
            tries: 0,
            rejected: 0,
            in_a_row: 0,
            looked: (0.0, 0),
            // Who says how long it may take says so instead.
            most_rejected: match limits.seconds {
                Some(_) => MOST,
                None => MOST_REJECTED / unknowns(model).max(1),
            },
        }
    }

    /// Tries so far, and rejected ones among them.
    pub(crate) fn so_far(&self) -> (usize, usize) {
        (self.tries, self.rejected)
    }

    /// Counts a try to come.
    pub(crate) fn try_one(&mut self) {
        self.tries += 1;
    }

    /// Counts the latest try as rejected.
    pub(crate) fn reject(&mut self) {
        self.rejected += 1;
        self.in_a_row += 1;
    }

    /// The latest try was a step.
    pub(crate) fn accept(&mut self) {
        self.in_a_row = 0;
    }

    /// Why the march is given up at the fraction `reached` of the duration, if it is.
    pub(crate) fn look(&mut self, reached: f64) -> Option<Stop> {
        if self.in_a_row >= MOST_IN_A_ROW {
            let in_a_row = self.in_a_row;
            return Some(Stop::Rejected { in_a_row });
        }
        if !self.tries.is_multiple_of(PACE) {
            return None;
        }
        let rest = 1.0 - reached;
        let advance = reached - self.looked.0;
        let rejected = self.rejected - self.looked.1;
        let too_many = |latest: usize, so_far: usize, most: usize| {
            latest as f64 * rest > advance * most.saturating_sub(so_far) as f64
        };
        if too_many(PACE, self.tries, MOST) || too_many(rejected, self.rejected, self.most_rejected)
        {
            return Some(Stop::NoHeadway {
                tries: PACE,
                rejected,
                advance,
            });
        }
        self.looked = (reached, self.rejected);
        None
    }
}
