//! Rates of quantities: derivatives in time of the polynomials through their samples. They do not reach across
//! kinks.
//!
//! ```text
//! dx/dt = (dx/dτ) / (dt/dτ),     dt/dτ = T + δT growth(τ)
//! ```
//!
//! with the fraction τ of the duration T. After the last kink dt/dτ changes with the duration.

use super::interpolation;
use crate::integrate::Trajectory;
use crate::math::Scalar;

/// Number of samples of a polynomial, where there are so many.
const NODES: usize = 7;

/// Weights of the samples in dx/dτ at instant k, by polynomials through samples with weights in sums.
fn weights<S: Scalar>(run: &Trajectory<S>, nodes: &[usize], k: usize) -> Vec<(usize, f64)> {
    let place = |i: usize| run.instants[nodes[i]];
    let at = run.instants[k];
    let next = nodes.partition_point(|&node| run.instants[node] < at);
    let next = next.clamp(1, nodes.len() - 1);
    let part = run.grid.part(place(next - 1));
    let (mut first, mut last) = (next - 1, next);
    // The nearer side grows, within the part.
    while last - first + 1 < NODES {
        let before = first > 0 && run.grid.part(place(first - 1)) == part;
        let after = last + 1 < nodes.len() && run.grid.part(place(last)) == part;
        match (before, after) {
            (false, false) => break,
            (true, false) => first -= 1,
            (false, true) => last += 1,
            (true, true) if next - first <= last + 1 - next => first -= 1,
            (true, true) => last += 1,
        }
    }
    interpolation::slope(run, &nodes[first..=last], at)
}

/// The samples of the polynomials.
fn nodes<S: Scalar>(run: &Trajectory<S>) -> Vec<usize> {
    (0..=run.last()).filter(|&k| run.weights[k] > 0.0).collect()
}

/// dt/dτ before and after the instant in its part, from the change of the duration.
fn stretch<S: Scalar>(run: &Trajectory<S>, k: usize) -> (S, f64) {
    // An instant on a kink belongs to the part that ends there.
    let before = run.instants[k.saturating_sub(1)];
    let growth = run.grid.growth(before);
    let real = run.duration.re();
    (
        S::from(real) + (run.duration - S::from(real)) * growth,
        growth,
    )
}

/// dx/dt at all instants.
pub(super) fn rates<S: Scalar>(run: &Trajectory<S>, values: &[S]) -> Vec<S> {
    let nodes = nodes(run);
    if nodes.len() < 2 {
        return vec![S::from(f64::NAN); values.len()];
    }
    let rate = |k: usize| {
        // The weights have the sum zero.
        let weighed = weights(run, &nodes, k).into_iter();
        let sum = weighed.fold(S::zero(), |sum, (j, w)| sum + (values[j] - values[k]) * w);
        sum / stretch(run, k).0
    };
    (0..values.len()).map(rate).collect()
}

/// The weights of the values that stand for weights of their rates.
pub(super) fn spread(run: &Trajectory<f64>, by: &[f64]) -> Vec<f64> {
    let nodes = nodes(run);
    let mut out = vec![0.0; by.len()];
    for k in (0..by.len()).filter(|&k| by[k] != 0.0) {
        let scale = by[k] / stretch(run, k).0;
        for (j, weight) in weights(run, &nodes, k) {
            out[j] += scale * weight;
            out[k] -= scale * weight;
        }
    }
    out
}

/// The derivative of the weighed sum of rates in the duration, at fixed values.
pub(super) fn by_duration(run: &Trajectory<f64>, values: &[f64], by: &[f64]) -> f64 {
    let all = rates(run, values);
    let part = |k: usize| {
        let (width, growth) = stretch(run, k);
        -by[k] * all[k] * growth / width
    };
    (0..by.len()).filter(|&k| by[k] != 0.0).map(part).sum()
}
