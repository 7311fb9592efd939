//! Histories: the quantity behind a function at the samples of a run, and at instants between them.

use super::{Function, interpolation};
use crate::integrate::Trajectory;
use crate::model::Model;

/// Number of samples on either side of an instant that its polynomial uses.
const BESIDE: usize = 3;
/// Fractions of the duration with a smaller distance are the same instant.
const SAME: f64 = 1e-14;

/// The quantity that `function` reduces, at every instant of a run of `model`; `None` for functions
/// that reduce none, such as a duration.
pub fn history(
    function: &Function<f64>,
    model: &Model<f64>,
    run: &Trajectory<f64>,
) -> Option<Vec<f64>> {
    Some(function.quantity()?.sample(model, run))
}

/// Instants of a run as weighted sums of its samples. Values there are linear in the samples, so the
/// derivatives of the samples give theirs exactly.
#[derive(Clone, Debug)]
pub struct Readings {
    of: Vec<Reading>,
    samples: usize,
}

/// An instant: pairs (sample, weight).
#[derive(Clone, Debug)]
struct Reading {
    value: Weights,
    /// The value by a polynomial with one sample less, for the error.
    coarser: Weights,
    /// The derivative of the polynomial by the fraction of the duration.
    slope: Weights,
}

type Weights = Vec<(usize, f64)>;

impl Readings {
    /// The samples that tables and figures show.
    pub fn shown(run: &Trajectory<f64>) -> Self {
        let shown = run.shown();
        let fractions: Vec<f64> = shown.iter().map(|&k| run.instants[k]).collect();
        Self::at(run, &fractions)
    }

    /// Instants at these fractions of the duration, by polynomials through the shown samples that do
    /// not reach across kinks.
    pub fn at(run: &Trajectory<f64>, fractions: &[f64]) -> Self {
        let shown = run.shown();
        let of = fractions.iter().map(|&at| reading(run, &shown, at));
        Self {
            of: of.collect(),
            samples: run.last() + 1,
        }
    }

    /// The values at the instants, from those of the samples.
    pub fn values(&self, samples: &[f64]) -> Vec<f64> {
        let value = |own: &Reading| sum(&own.value, samples);
        self.of.iter().map(value).collect()
    }

    /// Derivatives of the values by the fraction of the duration.
    pub fn slopes(&self, samples: &[f64]) -> Vec<f64> {
        let slope = |own: &Reading| sum(&own.slope, samples);
        self.of.iter().map(slope).collect()
    }

    /// Largest estimated error of the values by the polynomials between the samples.
    pub fn error(&self, samples: &[f64]) -> f64 {
        let error = |own: &Reading| (sum(&own.value, samples) - sum(&own.coarser, samples)).abs();
        self.of.iter().map(error).fold(0.0, f64::max)
    }

    /// The weights of the samples that stand for weights of the instants.
    pub fn spread(&self, weights: &[f64]) -> Vec<f64> {
        let mut all = vec![0.0; self.samples];
        for (own, weight) in self.of.iter().zip(weights) {
            for &(k, part) in &own.value {
                all[k] += weight * part;
            }
        }
        all
    }

    /// Number of instants.
    pub fn count(&self) -> usize {
        self.of.len()
    }
}

fn sum(of: &[(usize, f64)], samples: &[f64]) -> f64 {
    of.iter().map(|&(k, weight)| weight * samples[k]).sum()
}

/// The instant at the fraction `at`, from the samples `shown`.
fn reading(run: &Trajectory<f64>, shown: &[usize], at: f64) -> Reading {
    let place = |i: usize| run.instants[shown[i]];
    let next = shown.partition_point(|&k| run.instants[k] < at - SAME);
    let next = next.min(shown.len() - 1);
    let exact = (place(next) - at).abs() <= SAME;
    // A single sample has no polynomial.
    if shown.len() == 1 {
        let only = vec![(shown[0], 1.0)];
        return Reading {
            value: only.clone(),
            coarser: only,
            slope: Vec::new(),
        };
    }
    let before = next.saturating_sub(1);
    let part = run.grid.part(place(before));
    let (mut first, mut last) = (before, next.max(1));
    while first > 0 && next - first < BESIDE && run.grid.part(place(first - 1)) == part {
        first -= 1;
    }
    while last + 1 < shown.len() && last + 1 < next + BESIDE && run.grid.part(place(last)) == part {
        last += 1;
    }
    let nodes = &shown[first..=last];
    let slope = interpolation::slope(run, nodes, at);
    if exact {
        let only = vec![(shown[next], 1.0)];
        return Reading {
            value: only.clone(),
            coarser: only,
            slope,
        };
    }
    let away = |i: usize| (place(i) - at).abs();
    let farthest = match away(first) > away(last) {
        true => first,
        false => last,
    };
    let without = |node: usize| -> Vec<usize> {
        let others = nodes.iter().copied();
        others.filter(|&k| k != shown[node]).collect()
    };
    Reading {
        value: interpolation::value(run, nodes, at),
        coarser: interpolation::value(run, &without(farthest), at),
        slope,
    }
}
