//! Parts of a motion between kinks of loads and drives.

use std::cmp::Ordering;

/// Fractions that are nearer to a kink are the kink. A step across one at this distance errs by its
/// square.
pub(super) const NEAR: f64 = 1e-10;

/// The fractions of kinks in ascending order, each once, away from the start and the end.
pub(super) fn distinct(mut kinks: Vec<f64>) -> Vec<f64> {
    kinks.retain(|&at| at > NEAR && at < 1.0 - NEAR);
    kinks.sort_by(f64::total_cmp);
    kinks.dedup_by(|next, kept| *next - *kept <= 2.0 * NEAR);
    kinks
}

/// Start and end of the parts between kinks.
pub(super) fn parts(kinks: &[f64]) -> Vec<[f64; 2]> {
    let starts = std::iter::once(0.0).chain(kinks.iter().copied());
    let ends = kinks.iter().copied().chain([1.0]);
    starts.zip(ends).map(|(from, end)| [from, end]).collect()
}

/// `count` things shared among parts of these sizes, so that the largest share of size of one is
/// small; at least one to each part.
pub(super) fn shared(count: usize, sizes: &[f64]) -> Vec<usize> {
    let total: f64 = sizes.iter().sum();
    let share = |size: &f64| ((count as f64 * size / total).round() as usize).max(1);
    let mut shares: Vec<usize> = sizes.iter().map(share).collect();
    let wanted = count.max(sizes.len());
    let largest = |of: &dyn Fn(usize) -> f64| {
        (0..sizes.len()).max_by(|&a, &b| of(a).total_cmp(&of(b)).then(b.cmp(&a)))
    };
    loop {
        let now: usize = shares.iter().sum();
        let changed = match now.cmp(&wanted) {
            Ordering::Equal => return shares,
            Ordering::Less => largest(&|i| sizes[i] / shares[i] as f64).map(|i| (i, shares[i] + 1)),
            Ordering::Greater => largest(&|i| match shares[i] {
                1 => f64::NEG_INFINITY,
                more => -sizes[i] / (more - 1) as f64,
            })
            .map(|i| (i, shares[i] - 1)),
        };
        match changed {
            Some((i, more)) => shares[i] = more,
            None => return shares,
        }
    }
}
