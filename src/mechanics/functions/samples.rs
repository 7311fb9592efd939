//! Values of an instant quantity at the instants of a run.

use super::instant::Instant;
use super::multipliers::{Reactions, Rows};
use super::snapshot::Snapshot;
use super::turning::turns;
use crate::integrate::Trajectory;
use crate::linalg::SolveScalar;
use crate::model::Model;
use crate::system::Numbering;
use std::ops::RangeInclusive;

/// Values of an instant quantity at all instants of a run.
pub fn sample(instant: &Instant<f64>, model: &Model<f64>, run: &Trajectory<f64>) -> Vec<f64> {
    sample_at(instant, (model, run), 0..=run.last())
}

/// Values of an instant quantity at some instants of a run.
pub(super) fn sample_at<S: SolveScalar>(
    instant: &Instant<S>,
    of: (&Model<S>, &Trajectory<S>),
    instants: RangeInclusive<usize>,
) -> Vec<S> {
    let value = |at: &Snapshot<S>, turns| instant.value(at, turns);
    sample_with(instant, of, instants, value)
}

/// What `of` takes from some instants of a run. Multipliers are computed if the quantity needs them.
pub(super) fn sample_with<S: SolveScalar, T>(
    instant: &Instant<S>,
    (model, run): (&Model<S>, &Trajectory<S>),
    instants: RangeInclusive<usize>,
    of: impl Fn(&Snapshot<S>, f64) -> T,
) -> Vec<T> {
    let turns = turns(instant.watched_rotation(), run);
    // The model may have rows that were left out of the run.
    let numbering = instant.reacting().map(|_| Numbering::new(model));
    let reacting = numbering.as_ref().zip(instant.reacting());
    let mut reactions = reacting.map(|(numbering, of)| Reactions::new(model, numbering, of));
    let value = |k: usize| {
        let at = Snapshot {
            reactions: (reactions.as_mut()).map_or(Rows::none(), |own| own.at(run, k)),
            ..Snapshot::of(model, run, k)
        };
        of(&at, turn(&turns, k))
    };
    instants.map(value).collect()
}

/// Turns at instant k; zero if none are counted.
pub(super) fn turn(turns: &Option<Vec<f64>>, k: usize) -> f64 {
    turns.as_ref().map_or(0.0, |turns| turns[k])
}
