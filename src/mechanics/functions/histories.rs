//! Histories: the quantity behind a function at the samples of a run, and at instants between them.

use super::Function;
use super::evaluate::sample;
use super::turning::turns;
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
    let instant = function.instant()?;
    let turns = turns(instant.watched_rotation(), run);
    Some(sample(instant, &turns, model, run))
}

/// Instants of a run as weighted sums of its samples. Values there are linear in the samples, so the
/// derivatives of the samples give theirs exactly.
#[derive(Clone, Debug)]
pub struct Readings {
    /// By instant: pairs (sample, weight).
    of: Vec<Vec<(usize, f64)>>,
    /// The same by a polynomial with one sample less, for the error.
    coarser: Vec<Vec<(usize, f64)>>,
    samples: usize,
}

impl Readings {
    /// The samples that tables and figures show.
    pub fn shown(run: &Trajectory<f64>) -> Self {
        let of: Vec<_> = run.shown().into_iter().map(|k| vec![(k, 1.0)]).collect();
        Self {
            coarser: of.clone(),
            of,
            samples: run.last() + 1,
        }
    }

    /// Instants at these fractions of the duration, by polynomials through the shown samples that do
    /// not reach across kinks.
    pub fn at(run: &Trajectory<f64>, fractions: &[f64]) -> Self {
        let shown = run.shown();
        let (of, coarser) = fractions.iter().map(|&at| reading(run, &shown, at)).unzip();
        Self {
            of,
            coarser,
            samples: run.last() + 1,
        }
    }

    /// The values at the instants, from those of the samples.
    pub fn values(&self, samples: &[f64]) -> Vec<f64> {
        self.of.iter().map(|of| sum(of, samples)).collect()
    }

    /// Largest estimated error of the values by the polynomials between the samples.
    pub fn error(&self, samples: &[f64]) -> f64 {
        let both = self.of.iter().zip(&self.coarser);
        let error =
            |(of, coarser): (&Vec<_>, &Vec<_>)| (sum(of, samples) - sum(coarser, samples)).abs();
        both.map(error).fold(0.0, f64::max)
    }

    /// The weights of the samples that stand for weights of the instants.
    pub fn spread(&self, weights: &[f64]) -> Vec<f64> {
        let mut all = vec![0.0; self.samples];
        for (of, weight) in self.of.iter().zip(weights) {
            for &(k, part) in of {
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

type Weights = Vec<(usize, f64)>;

/// The weights of the samples `shown` at the fraction `at`, and those without the farthest one.
fn reading(run: &Trajectory<f64>, shown: &[usize], at: f64) -> (Weights, Weights) {
    let place = |i: usize| run.instants[shown[i]];
    let next = shown.partition_point(|&k| run.instants[k] < at - SAME);
    let next = next.min(shown.len() - 1);
    if next == 0 || (place(next) - at).abs() <= SAME {
        let exact = vec![(shown[next], 1.0)];
        return (exact.clone(), exact);
    }
    let part = run.grid.part(place(next - 1));
    let (mut first, mut last) = (next - 1, next);
    while first > 0 && next - first < BESIDE && run.grid.part(place(first - 1)) == part {
        first -= 1;
    }
    while last + 1 < shown.len() && last - next + 1 < BESIDE && run.grid.part(place(last)) == part {
        last += 1;
    }
    let nodes: Vec<usize> = (first..=last).collect();
    let away = |i: usize| (place(i) - at).abs();
    let farthest = match away(first) > away(last) {
        true => first,
        false => last,
    };
    let fewer: Vec<usize> = nodes.iter().copied().filter(|&i| i != farthest).collect();
    let lagrange = |nodes: &[usize]| -> Weights {
        let weight = |&j: &usize| {
            let others = nodes.iter().filter(|&&i| i != j);
            let weight = others.fold(1.0, |w, &i| w * (at - place(i)) / (place(j) - place(i)));
            (shown[j], weight)
        };
        nodes.iter().map(weight).collect()
    };
    (lagrange(&nodes), lagrange(&fewer))
}
