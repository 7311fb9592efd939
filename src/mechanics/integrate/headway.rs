//! Stops a march with adaptive steps that would need too many tries, or rejects too many in a row.

use super::limits::Limits;
use crate::model::Model;

/// Largest number of tries of a run with adaptive steps, and largest number of rejected ones times
/// the number of unknowns of the accelerations. Every `PACE` tries the pace is checked: a run that
/// would need more tries at its present pace is stopped. A nearly locked mechanism rejects a
/// quarter of its tries. So does a fast vibration of one body, but it costs little.
const MOST: usize = 10_000_000;
const MOST_REJECTED: usize = 2_000_000;
const PACE: usize = 5_000;
/// Largest number of rejected tries in a row. Each is a fifth as wide as the one before, so twenty
/// reach the smallest step. If the error is round-off, or irregular, hundreds would be needed.
pub const MOST_IN_A_ROW: usize = 100;

/// The reason why a march ended early.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stop {
    /// The steps became too small.
    TooSmall,
    /// Too many tries in a row were rejected.
    Rejected {
        /// Their number.
        in_a_row: usize,
    },
    /// The latest `tries`, of which `rejected` were rejected, advanced the motion by the fraction
    /// `advance` of its duration. At this pace the run needs too many.
    NoHeadway {
        /// Tries.
        tries: usize,
        /// Rejected ones among them.
        rejected: usize,
        /// Fraction of the duration.
        advance: f64,
    },
    /// The time limit \[s\] was exceeded.
    TimeLimit(f64),
    /// All simulations must end.
    Interrupted,
}

/// Number of unknowns of the accelerations: velocities and multipliers.
fn unknowns<S>(model: &Model<S>) -> usize {
    let velocities = model.bodies.iter().map(|body| body.mobility.unknowns());
    let rows = model.joints.iter().map(|joint| joint.rows().count());
    velocities.chain(rows).sum()
}

/// Counts the tries of a march.
#[derive(Debug)]
pub struct Headway {
    /// Numbers of tries, of rejected ones, and of rejected ones since the last accepted step.
    tries: usize,
    rejected: usize,
    in_a_row: usize,
    /// Fraction of the duration and rejected tries at the last check of the pace.
    looked: (f64, usize),
    /// Largest number of rejected tries.
    most_rejected: usize,
}

impl Headway {
    /// Before the first try.
    pub fn new<S>(model: &Model<S>, limits: &Limits) -> Self {
        Self {
            tries: 0,
            rejected: 0,
            in_a_row: 0,
            looked: (0.0, 0),
            // A time limit replaces the limit on rejected tries.
            most_rejected: match limits.seconds {
                Some(_) => MOST,
                None => MOST_REJECTED / unknowns(model).max(1),
            },
        }
    }

    /// Number of tries, and of rejected ones among them.
    pub fn so_far(&self) -> (usize, usize) {
        (self.tries, self.rejected)
    }

    /// Counts the next try.
    pub fn try_one(&mut self) {
        self.tries += 1;
    }

    /// Counts the latest try as rejected.
    pub fn reject(&mut self) {
        self.rejected += 1;
        self.in_a_row += 1;
    }

    /// Counts the latest try as accepted.
    pub fn accept(&mut self) {
        self.in_a_row = 0;
    }

    /// The reason to stop the march at the fraction `reached` of the duration, if any.
    pub fn look(&mut self, reached: f64) -> Option<Stop> {
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
