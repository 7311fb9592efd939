//! Maxima of a quantity between its samples: turning points of interpolating polynomials.

use crate::integrate::Trajectory;
use crate::integrate::quadrature::{ADDED, NODES, WEIGHTS};
use crate::math::{Scalar, lagrange};
use std::ops::Range;

/// Number of samples on either side of an interval that its polynomial uses, without cells.
const BESIDE: usize = 2;
/// Fewest and most parts of an interval between samples for an exponential, and the exponent below
/// which it is negligible: e^-72 is ε².
const FEWEST: f64 = 4.0;
const MOST: f64 = 400.0;
const COLD: f64 = -72.0;
/// Number of bisections that reach the last bit.
const BISECTIONS: usize = 60;

/// A part of the motion and the samples of its polynomial.
#[derive(Clone, Debug)]
pub(super) struct Stretch {
    pub samples: Vec<usize>,
    /// Indices of the samples that bound the part.
    pub part: Range<usize>,
}

/// The parts of a run in order: cells, or the intervals between samples.
pub(super) fn stretches<S: Scalar>(run: &Trajectory<S>) -> Vec<Stretch> {
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
    // Polynomials do not reach across kinks.
    let part_of = |node: usize| run.grid.part(run.instants[nodes[node]]);
    for k in 1..nodes.len() {
        let part = part_of(k - 1);
        let mut first = (k - 1).saturating_sub(BESIDE);
        while part_of(first) < part {
            first += 1;
        }
        let mut last = (k + BESIDE).min(nodes.len() - 1);
        while last > k && part_of(last - 1) > part {
            last -= 1;
        }
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
        let count = self.nodes.len();
        let weight = |j| lagrange::weight(count, |i| self.nodes[i].0, x, j);
        (0..count).map(weight).collect()
    }

    fn value(&self, x: f64) -> f64 {
        let weights = self.weights(x).into_iter();
        weights.zip(&self.nodes).map(|(w, node)| w * node.1).sum()
    }

    /// Derivative at `x`, computed from differences to the first value.
    fn slope(&self, x: f64) -> f64 {
        let count = self.nodes.len();
        let part = |j: usize| {
            let weight = lagrange::slope(count, |i| self.nodes[i].0, x, j);
            weight * (self.nodes[j].1 - self.nodes[0].1)
        };
        (1..count).map(part).sum()
    }

    /// Zero between two fractions at which the polynomial has different signs, or the nearer end.
    fn zero(&self, low: f64, high: f64) -> f64 {
        bisect(|x| self.value(x), low, high)
    }

    /// Zero of the derivative between two fractions at which it has different signs.
    fn turn(&self, low: f64, high: f64) -> f64 {
        bisect(|x| self.slope(x), low, high)
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
pub struct Point<S> {
    /// The value.
    pub value: S,
    /// Pairs (sample, weight).
    pub of: Vec<(usize, f64)>,
}

impl Stretch {
    fn polynomial<T: Scalar, S: Scalar>(&self, run: &Trajectory<T>, values: &[S]) -> Polynomial {
        let node = |&k: &usize| (run.instants[k], values[k].re());
        Polynomial {
            nodes: self.samples.iter().map(node).collect(),
        }
    }

    /// Estimated error of the polynomial at `at`: by how much it changes without its farthest sample. None at samples.
    pub fn error<T: Scalar, S: Scalar>(&self, run: &Trajectory<T>, values: &[S], at: f64) -> f64 {
        let polynomial = self.polynomial(run, values);
        if polynomial.nodes.iter().any(|node| node.0 == at) {
            return 0.0;
        }
        (polynomial.without_farthest(at).value(at) - polynomial.value(at)).abs()
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

/// Samples and turning points of a quantity in order of time, by its polynomials, each with its fraction of the
/// duration. Between two neighbours the quantity rises or falls.
pub(super) fn peaks<T: Scalar, S: Scalar>(
    run: &Trajectory<T>,
    values: &[S],
) -> Vec<(f64, Point<S>)> {
    let sample = |k: usize| {
        let point = Point {
            value: values[k],
            of: vec![(k, 1.0)],
        };
        (run.instants[k], point)
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
                all.push((at, Point { value, of }));
            }
            all.push(sample(k));
        }
    }
    all
}

/// [`peaks`] without their fractions.
pub fn points<S: Scalar>(run: &Trajectory<S>, values: &[S]) -> Vec<Point<S>> {
    peaks(run, values)
        .into_iter()
        .map(|(_, point)| point)
        .collect()
}

/// A crossing of zero: its fraction of the duration, the value there as a sum of samples, and the slope of its
/// polynomial.
pub(super) struct Crossing {
    pub at: f64,
    pub of: Vec<(usize, f64)>,
    pub slope: f64,
}

/// The first crossing of zero by the polynomials of a quantity, upwards (`rises`), downwards or both. A quantity that
/// only touches zero does not cross it.
pub(super) fn first_crossing<S: Scalar>(
    run: &Trajectory<S>,
    values: &[S],
    rises: Option<bool>,
) -> Option<Crossing> {
    let wanted = |from: f64, to: f64| {
        let up = from < 0.0 && to >= 0.0;
        let down = from > 0.0 && to <= 0.0;
        (up && rises != Some(false)) || (down && rises != Some(true))
    };
    for stretch in stretches(run) {
        let polynomial = stretch.polynomial(run, values);
        let nodes = &polynomial.nodes;
        let bounds = stretch.part.start..=stretch.part.end;
        let mut places: Vec<f64> = bounds.map(|i| nodes[i].0).collect();
        places.extend(stretch.turns(&polynomial));
        places.sort_by(f64::total_cmp);
        let pairs = places.windows(2);
        let mut spans = pairs.map(|pair| (pair[0], pair[1]));
        let found = spans.find(|&(a, b)| wanted(polynomial.value(a), polynomial.value(b)));
        if let Some((low, high)) = found {
            let at = polynomial.zero(low, high);
            let weights = polynomial.weights(at);
            return Some(Crossing {
                at,
                of: stretch.samples.iter().copied().zip(weights).collect(),
                slope: polynomial.slope(at),
            });
        }
    }
    None
}

/// The first time at which a quantity g that starts on the side `side` of zero is on the other one, by
/// its samples and by the turning points of its polynomials: the fraction of the duration at which its
/// polynomial is zero. Values within `noise` are zero. Otherwise the smallest distance from zero, and
/// the fraction where it comes so near.
pub fn crossing<S: Scalar>(
    run: &Trajectory<S>,
    values: &[S],
    (side, noise): (f64, f64),
) -> Result<f64, (f64, f64)> {
    let mut last = (values[0].re() * side, run.instants[0]);
    let mut nearest = (f64::INFINITY, 0.0);
    for stretch in stretches(run) {
        let all = || stretch.samples.iter().map(|&k| values[k].re() * side);
        let (low, high) = all().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
            (low.min(x), high.max(x))
        });
        let polynomial = stretch.polynomial(run, values);
        // Far from zero the polynomial does not turn there.
        let turns = match low - (high - low) > nearest.0.max(noise) {
            true => Vec::new(),
            false => stretch.turns(&polynomial),
        };
        let at_turn = |&at: &f64| (polynomial.value(at) * side, at);
        let at_node = |&k: &usize| (values[k].re() * side, run.instants[k]);
        let nodes = &stretch.samples[stretch.part.start + 1..=stretch.part.end];
        let mut points: Vec<(f64, f64)> = turns
            .iter()
            .map(at_turn)
            .chain(nodes.iter().map(at_node))
            .collect();
        points.sort_by(|a, b| a.1.total_cmp(&b.1));
        for (value, at) in points {
            if value < -noise && last.0 > noise {
                return Ok(polynomial.zero(last.1, at));
            }
            if value.abs() < nearest.0 && last.0.abs() > noise {
                nearest = (value.abs(), at);
            }
            // A value of zero is on neither side.
            if value.abs() > noise || last.0.abs() <= noise {
                last = (value, at);
            }
        }
    }
    Err(nearest)
}

/// Integrals over the motion, in fractions of the duration, of e^{ρ(g − m)} and of (g − m) e^{ρ(g − m)}
/// for a quantity g and its largest value m, by its polynomials between the samples; and m.
pub fn exponential_integrals<S: Scalar>(run: &Trajectory<S>, values: &[S], rho: f64) -> [f64; 3] {
    let top = maximum(run, values).value;
    let (mut sum, mut moment) = (0.0, 0.0);
    for stretch in stretches(run) {
        let polynomial = stretch.polynomial(run, values);
        let nodes = &polynomial.nodes;
        for i in stretch.part.clone() {
            let ((from, a), (end, b)) = (nodes[i], nodes[i + 1]);
            if rho * (a.max(b) + (a - b).abs() - top) < COLD {
                continue;
            }
            let parts = (rho * (a - b).abs()).ceil().clamp(FEWEST, MOST);
            let width = (end - from) / parts;
            for part in 0..parts as usize {
                let start = from + width * part as f64;
                for (x, weight) in NODES.into_iter().zip(WEIGHTS) {
                    let away = polynomial.value(start + width * x) - top;
                    let term = weight * width * (rho * away).exp();
                    sum += term;
                    moment += term * away;
                }
            }
        }
    }
    [sum, moment, top]
}

/// The largest value over the motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Maximum {
    /// The value.
    pub value: f64,
    /// Its time \[s\].
    pub time: f64,
    /// Estimated error of the polynomial between the samples.
    pub error: f64,
}

/// The largest value of a quantity over the motion: of its samples, and of the polynomials between
/// them that may exceed the largest sample.
pub fn maximum<S: Scalar>(run: &Trajectory<S>, values: &[S]) -> Maximum {
    maximum_where(run, values, |_| true)
}

/// As [`maximum`], over the parts of the motion whose samples all satisfy `counts`.
pub fn maximum_where<S: Scalar>(
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
                    error: stretch.error(run, values, at),
                };
            }
        }
    }
    best
}

/// Zero of f between two places at which it has different signs, or the nearer end.
fn bisect(f: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    let positive = f(low) > 0.0;
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (low + high);
        if (f(middle) > 0.0) == positive {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}
