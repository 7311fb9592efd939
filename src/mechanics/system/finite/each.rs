//! Work on the elements of a body, side by side where there is enough of it: on the threads of a process, and by the ranks
//! that compute a motion together.

use crate::math::{Packed, Team};
use rayon::prelude::*;

/// Elements from which on a body's work is divided among processors.
pub const SIDE_BY_SIDE: usize = 48;
/// Elements that are one piece of work.
const PIECE: usize = 8;
/// Numbers of results that are kept at once.
const AT_ONCE: usize = 1 << 17;
/// Elements from which on a body's work is divided among ranks, for each of them.
const FOR_A_RANK: usize = 8;
/// Elements of a rank whose results are sent at once.
const SENT: usize = 256;

/// Passes the results of `work` for 0 … count − 1 to `take`, in this order, so that sums are the same on any
/// number of processors.
pub(super) fn each<T: Send>(
    count: usize,
    work: impl Fn(usize) -> T + Sync,
    mut take: impl FnMut(usize, T),
) {
    if count < SIDE_BY_SIDE || rayon::current_num_threads() == 1 {
        (0..count).for_each(|i| take(i, work(i)));
        return;
    }
    let some = (AT_ONCE * 8 / size_of::<T>().max(1)).max(SIDE_BY_SIDE);
    for first in (0..count).step_by(some) {
        let own = first..(first + some).min(count);
        let made = own.into_par_iter().with_min_len(PIECE).map(&work);
        let made: Vec<T> = made.collect();
        for (k, result) in made.into_iter().enumerate() {
            take(first + k, result);
        }
    }
}

/// The same, where each rank of a team makes its share of the results. For results that are sent faster than they are made.
pub(super) fn each_over<T: Send + Packed>(
    team: &Team,
    count: usize,
    work: impl Fn(usize) -> T + Sync,
    mut take: impl FnMut(usize, T),
) {
    if team.is_alone() || count < FOR_A_RANK * team.ranks() {
        return each(count, work, take);
    }
    let some = SENT * team.ranks();
    for first in (0..count).step_by(some) {
        let share = team.share(first..(first + some).min(count));
        let mut made = Vec::with_capacity(share.len());
        each(
            share.len(),
            |k| work(share.start + k),
            |_, own| made.push(own),
        );
        for (k, result) in team.gather(made).into_iter().enumerate() {
            take(first + k, result);
        }
    }
}
