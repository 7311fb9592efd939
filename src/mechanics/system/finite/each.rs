//! Work on the elements of a body, side by side where there is enough of it.

use rayon::prelude::*;

/// Elements from which on a body's work is divided among processors.
pub const SIDE_BY_SIDE: usize = 48;
/// Elements that are one piece of work.
const PIECE: usize = 8;
/// Numbers of results that are kept at once.
const AT_ONCE: usize = 1 << 17;

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
