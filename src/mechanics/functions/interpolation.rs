//! Polynomials through samples of a run, as weighted sums of the samples. Places are fractions of the duration.

use crate::integrate::Trajectory;
use crate::math::{Scalar, lagrange};

/// The value at `at` of the polynomial through these samples: pairs (sample, weight).
pub(super) fn value<T: Scalar, S: Scalar>(
    run: &Trajectory<T>,
    samples: &[usize],
    at: S,
) -> Vec<(usize, S)> {
    let place = |i: usize| run.instants[samples[i]];
    let weight = |(j, &k)| (k, lagrange::weight(samples.len(), place, at, j));
    samples.iter().enumerate().map(weight).collect()
}

/// The derivative at `at` of that polynomial.
pub(super) fn slope<T: Scalar>(
    run: &Trajectory<T>,
    samples: &[usize],
    at: f64,
) -> Vec<(usize, f64)> {
    let place = |i: usize| run.instants[samples[i]];
    let weight = |(j, &k)| (k, lagrange::slope(samples.len(), place, at, j));
    samples.iter().enumerate().map(weight).collect()
}
