//! Maxima of a quantity between its samples: turning points of interpolating polynomials.

use crate::integrate::Trajectory;
use crate::integrate::quadrature::ADDED;
use crate::math::Scalar;
use std::ops::Range;

/// Number of samples on either side of an interval that its polynomial uses, without cells.
const BESIDE: usize = 2;
/// Number of bisections that reach the last bit.
const BISECTIONS: usize = 60;

/// A part of the motion and the samples of its polynomial.
#[derive(Clone, Debug)]
struct Stretch {
    samples: Vec<usize>,
    /// Indices of the samples that bound the part.
    part: Range<usize>,
}

/// The parts of a run in order: cells, or the intervals between samples.
fn stretches<S: Scalar>(run: &Trajectory<S>) -> Vec<Stretch> {
    let nodes: Vec<usize> = (0..=run.last()).filter(|&k| run.weights[k] > 0.0).collect();
    let mut all = Vec::new();
    if run.has_cells {
        let mut at = 0;
        for k in 1..=run.grid.steps() {
            for _ in 0..run.grid.cells(k).max(1) {
                let next = at + run.grid.step(k).nodes().min(ADDED);
                let samples = nodes[at..=next].to_vec();
                let part = 0..samples.len() - 1;
                all.push(Stretch { samples, part });
                at = next;
            }
        }
        return all;
    }
    for k in 1..nodes.len() {
        let first = (k - 1).saturating_sub(BESIDE);
        let last = (k + BESIDE).min(nodes.len() - 1);
        all.push(Stretch {
            samples: nodes[first..=last].to_vec(),
            part: k - 1 - first..k - first,
        });
    }
    all
}

/// The polynomial through samples of a stretch.
struct Polynomial {
    /// Pairs (fraction of the duration, value).
    nodes: Vec<(f64, f64)>,
}

impl Polynomial {
    /// Weights of the values in the polynomial at `x`; one per node.
    fn weights(&self, x: f64) -> Vec<f64> {
        let weight = |j: usize| {
            let others = (0..self.nodes.len()).filter(|&i| i != j);
            let xj = self.nodes[j].0;
            others.fold(1.0, |w, i| {
                w * (x - self.nodes[i].0) / (xj - self.nodes[i].0)
            })
        };
        (0..self.nodes.len()).map(weight).collect()
    }

    fn value(&self, x: f64) -> f64 {
        let weights = self.weights(x).into_iter();
        weights.zip(&self.nodes).map(|(w, node)| w * node.1).sum()
    }

    /// Derivative at `x`, computed from differences to the first value.
    fn slope(&self, x: f64) -> f64 {
        let n = self.nodes.len();
        let part = |j: usize| {
            let xj = self.nodes[j].0;
            let sum: f64 = (0..n)
                .filter(|&m| m != j)
                .map(|m| {
                    let others = (0..n).filter(|&i| i != j && i != m);
                    let factor = 1.0 / (xj - self.nodes[m].0);
                    others.fold(factor, |w, i| {
                        w * (x - self.nodes[i].0) / (xj - self.nodes[i].0)
                    })
                })
                .sum();
            sum * (self.nodes[j].1 - self.nodes[0].1)
        };
        (1..n).map(part).sum()
    }

    /// Zero of the derivative between two fractions at which it has different signs.
    fn turn(&self, mut low: f64, mut high: f64) -> f64 {
        let rises = self.slope(low) > 0.0;
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (low + high);
            if (self.slope(middle) > 0.0) == rises {
                low = middle;
            } else {
                high = middle;
            }
        }
        0.5 * (low + high)
    }

    /// The polynomial without the node that is farthest from `x`.
    fn without_farthest(&self, x: f64) -> Self {
        let mut nodes = self.nodes.clone();
        let away = |node: &(f64, f64)| (node.0 - x).abs();
        let farthest =
            (0..nodes.len()).max_by(|&a, &b| away(&nodes[a]).total_cmp(&away(&nodes[b])));
        if let Some(farthest) = farthest {
            nodes.remove(farthest);
        }
        Self { nodes }
    }
}

/// A sample, or a turning point as a weighted sum of samples.
#[derive(Clone, Debug)]
pub(crate) struct Point<S> {
    /// The value.
    pub value: S,
    /// Pairs (sample, weight).
    pub of: Vec<(usize, f64)>,
}

impl Stretch {
    fn polynomial<S: Scalar>(&self, run: &Trajectory<S>, values: &[S]) -> Polynomial {
        let node = |&k: &usize| (run.instants[k], values[k].re());
        Polynomial {
            nodes: self.samples.iter().map(node).collect(),
        }
    }

    /// Turning points inside the part.
    fn turns(&self, polynomial: &Polynomial) -> Vec<f64> {
        let nodes = &polynomial.nodes;
        let slopes: Vec<f64> = (self.part.start..=self.part.end)
            .map(|i| polynomial.slope(nodes[i].0))
            .collect();
        (self.part.start..self.part.end)
            .zip(slopes.windows(2))
            .filter(|(_, slopes)| slopes[0] * slopes[1] < 0.0)
            .map(|(i, _)| polynomial.turn(nodes[i].0, nodes[i + 1].0))
            .collect()
    }
}

/// Samples and turning points of a quantity in order of time, by its polynomials. Between two
/// neighbours the quantity rises or falls.
pub(crate) fn points<S: Scalar>(run: &Trajectory<S>, values: &[S]) -> Vec<Point<S>> {
    let sample = |k: usize| Point {
        value: values[k],
        of: vec![(k, 1.0)],
    };
    let mut all = vec![sample(0)];
    for stretch in stretches(run) {
        let polynomial = stretch.polynomial(run, values);
        let mut turns = stretch.turns(&polynomial).into_iter().peekable();
        for i in stretch.part.start + 1..=stretch.part.end {
            let k = stretch.samples[i];
            while let Some(at) = turns.next_if(|&at| at < run.instants[k]) {
                let weights = polynomial.weights(at);
                let of: Vec<(usize, f64)> = stretch.samples.iter().copied().zip(weights).collect();
                let value = of
                    .iter()
                    .fold(S::zero(), |sum, &(k, w)| sum + values[k] * w);
                all.push(Point { value, of });
            }
            all.push(sample(k));
        }
    }
    all
}

/// The largest value over the motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Maximum {
    /// The value.
    pub value: f64,
    /// Its time \[s\].
    pub time: f64,
    /// Estimated error of the polynomial between the samples.
    pub error: f64,
}

/// The largest value of a quantity over the motion: of its samples, and of the polynomials between
/// them that may exceed the largest sample.
pub(crate) fn maximum<S: Scalar>(run: &Trajectory<S>, values: &[S]) -> Maximum {
    maximum_where(run, values, |_| true)
}

/// As [`maximum`], over the parts of the motion whose samples all satisfy `counts`.
pub(crate) fn maximum_where<S: Scalar>(
    run: &Trajectory<S>,
    values: &[S],
    counts: impl Fn(usize) -> bool,
) -> Maximum {
    let duration = run.time(run.last()).re();
    let mut best = Maximum {
        value: f64::NEG_INFINITY,
        time: 0.0,
        error: 0.0,
    };
    for k in (0..=run.last()).filter(|&k| counts(k)) {
        if values[k].re() > best.value {
            best.value = values[k].re();
            best.time = run.instants[k] * duration;
        }
    }
    for stretch in stretches(run) {
        let all = || stretch.samples.iter().map(|&k| values[k].re());
        let (low, high) = all().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
            (low.min(x), high.max(x))
        });
        let holds = high + (high - low) >= best.value;
        if !holds || !stretch.samples.iter().all(|&k| counts(k)) {
            continue;
        }
        let polynomial = stretch.polynomial(run, values);
        for at in stretch.turns(&polynomial) {
            let value = polynomial.value(at);
            if value > best.value {
                best = Maximum {
                    value,
                    time: at * duration,
                    error: (polynomial.without_farthest(at).value(at) - value).abs(),
                };
            }
        }
    }
    best
}
