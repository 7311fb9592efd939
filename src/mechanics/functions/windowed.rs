//! Reductions of a quantity over a window of time, by the polynomials between its samples.
//!
//! The window is divided at the samples. Every piece has the nodes of a quadrature rule; values there are
//! linear in the samples. So a reduction is a function of the samples, of the two ends of the window and of
//! the duration, and smooth in all of them.

use super::function::Reduction;
use super::interpolation;
use super::peak::{Maximum, Point, Stretch, peaks, stretches};
use super::window::Placed;
use crate::integrate::Trajectory;
use crate::integrate::quadrature::{NODES, WEIGHTS};
use crate::math::soft_max::{Bound, SoftMax};
use crate::math::{Dual, Scalar};

/// Fractions of the duration with a smaller distance are one place.
const BESIDE: f64 = 1e-9;
/// Most parts of a piece between two samples for an exponential.
const MOST: f64 = 64.0;

/// A node: its value as a sum of samples, and its weight in seconds.
struct Node<S> {
    of: Vec<(usize, S)>,
    seconds: S,
}

/// A reduction over a window, and its derivatives.
pub(super) struct Windowed {
    /// In the values of the quantity, by instant.
    pub by_values: Vec<f64>,
    /// In the fractions of both ends.
    pub by_ends: [f64; 2],
    /// In the duration, at fixed values and fractions.
    pub by_duration: f64,
}

/// A window in a run: its ends as fractions of the duration.
#[derive(Clone, Copy)]
struct Span<S> {
    ends: [S; 2],
    duration: S,
}

/// The weighed sum of samples; weights have the sum one. It is summed relative to the first, so that the derivatives of
/// the weights, whose sum is zero, do not cancel at the size of the values.
pub(super) fn reading<S: Scalar>(of: &[(usize, S)], values: &[S]) -> S {
    let first = values[of[0].0];
    of.iter().fold(first, |sum, &(k, weight)| {
        sum + (values[k] - first) * weight
    })
}

/// The stretch with the fraction `at`; of two that meet there, the earlier.
pub(super) fn stretch_at<'a, T: Scalar>(
    run: &Trajectory<T>,
    all: &'a [Stretch],
    at: f64,
) -> &'a Stretch {
    let end = |own: &Stretch| run.instants[own.samples[own.part.end]];
    let which = all.partition_point(|own| end(own) < at);
    &all[which.min(all.len() - 1)]
}

impl<S: Scalar> Span<S> {
    fn of(run: &Trajectory<S>, ends: &[Placed<S>; 2]) -> Self {
        Self {
            ends: [ends[0].at, ends[1].at],
            duration: run.duration,
        }
    }

    /// The nodes of the window. `parts` is the number of parts of a piece, from the change of the quantity in it.
    fn nodes<T: Scalar>(
        &self,
        run: &Trajectory<T>,
        values: &[S],
        parts: impl Fn(f64) -> f64,
    ) -> Vec<Node<S>> {
        let [from, to] = self.ends;
        let real = self.duration.re();
        let mut all = Vec::new();
        for stretch in stretches(run) {
            for i in stretch.part.clone() {
                let [first, last] = [stretch.samples[i], stretch.samples[i + 1]];
                let [low, high] = [first, last].map(|k| run.instants[k]);
                // A window that ends on a sample moves away from it.
                let starts = from.re() >= low && from.re() < high;
                let ends = to.re() > low && to.re() <= high;
                if from.re() >= high || to.re() <= low {
                    continue;
                }
                let a = if starts { from } else { S::from(low) };
                let b = if ends { to } else { S::from(high) };
                let growth = run.grid.growth(low);
                let seconds = S::from(real) + (self.duration - S::from(real)) * growth;
                let change = (values[last].re() - values[first].re()).abs();
                let count = parts(change).ceil().clamp(1.0, MOST);
                let width = (b - a) / count;
                for part in 0..count as usize {
                    let start = a + width * part as f64;
                    for (x, weight) in NODES.into_iter().zip(WEIGHTS) {
                        all.push(Node {
                            of: interpolation::value(run, &stretch.samples, start + width * x),
                            seconds: seconds * width * weight,
                        });
                    }
                }
            }
        }
        all
    }

    /// Values in order of time between which the quantity rises or falls: at the ends of the window, and at
    /// samples and turning points inside. Each as a sum of samples.
    fn points<T: Scalar>(&self, run: &Trajectory<T>, values: &[S]) -> Vec<(f64, Point<S>)> {
        let all = stretches(run);
        let edge = |end: S| {
            let of = interpolation::value(run, &stretch_at(run, &all, end.re()).samples, end);
            let point = Point {
                value: reading(&of, values),
                of: of.iter().map(|&(k, weight)| (k, weight.re())).collect(),
            };
            (end.re(), point)
        };
        let [from, to] = self.ends.map(edge);
        // An end of the window stands for a sample at the same place: between two equal values the quantity neither
        // rises nor falls.
        let (low, high) = (from.0 + BESIDE, to.0 - BESIDE);
        let inside = peaks(run, values).into_iter();
        let inside = inside.filter(|(at, _)| *at > low && *at < high);
        std::iter::once(from).chain(inside).chain([to]).collect()
    }

    /// The reduction and, if `by_values` is given, its derivatives in the samples.
    fn reduce<T: Scalar>(
        &self,
        reduction: Reduction,
        run: &Trajectory<T>,
        values: &[S],
        by_values: Option<&mut [f64]>,
    ) -> S {
        let mut to = by_values;
        let mut give = |of: &[(usize, S)], weight: f64| {
            if let Some(to) = &mut to {
                for &(k, part) in of {
                    to[k] += weight * part.re();
                }
            }
        };
        match reduction {
            Reduction::Final => {
                let at = self.ends[1];
                let of = interpolation::value(
                    run,
                    &stretch_at(run, &stretches(run), at.re()).samples,
                    at,
                );
                give(&of, 1.0);
                reading(&of, values)
            }
            Reduction::Damage { slope, strength } => {
                let points = self.points(run, values);
                let all: Vec<S> = points
                    .iter()
                    .map(|(_, point)| signed_power(point.value / strength, slope))
                    .collect();
                for (i, (_, point)) in points.iter().enumerate() {
                    let turn = 0.5 * turns_between(&all, i);
                    let steep = (point.value.re() / strength).abs().powf(slope - 1.0);
                    let by = turn * slope * steep / strength;
                    let of = point.of.iter().map(|&(k, w)| (k, S::from(w)));
                    give(&of.collect::<Vec<_>>(), by);
                }
                let weigh =
                    |sum, (i, &power): (usize, &S)| sum + power * (0.5 * turns_between(&all, i));
                all.iter().enumerate().fold(S::zero(), weigh)
            }
            Reduction::Integral | Reduction::Mean => {
                let nodes = self.nodes(run, values, |_| 1.0);
                let length = match reduction {
                    Reduction::Mean => length(&nodes),
                    _ => S::one(),
                };
                let sum = |sum, node: &Node<S>| sum + reading(&node.of, values) * node.seconds;
                for node in &nodes {
                    give(&node.of, (node.seconds / length).re());
                }
                nodes.iter().fold(S::zero(), sum) / length
            }
            Reduction::Ks {
                rho,
                bound: Bound::Above,
            } => {
                let points = self.points(run, values);
                let heights: Vec<S> = points.iter().map(|(_, point)| point.value).collect();
                let soft = SoftMax::new(&heights, |i| S::from(turns_at(&heights, i)), rho);
                for (weight, (_, point)) in soft.weights.iter().zip(&points) {
                    let of = point.of.iter().map(|&(k, w)| (k, S::from(w)));
                    give(&of.collect::<Vec<_>>(), weight.re());
                }
                soft.ks
            }
            Reduction::Ks { rho, .. } | Reduction::InducedExponential { rho } => {
                let nodes = self.nodes(run, values, |change| rho * change);
                let length = length(&nodes);
                let heights: Vec<S> = nodes.iter().map(|node| reading(&node.of, values)).collect();
                let soft = SoftMax::new(&heights, |i| nodes[i].seconds / length, rho);
                if matches!(reduction, Reduction::Ks { .. }) {
                    for (node, weight) in nodes.iter().zip(&soft.weights) {
                        give(&node.of, weight.re());
                    }
                    return soft.ks;
                }
                let mean = soft.induced_exponential(&heights);
                for ((node, weight), &height) in nodes.iter().zip(&soft.weights).zip(&heights) {
                    let by = *weight * (S::one() + (height - mean) * rho);
                    give(&node.of, by.re());
                }
                mean
            }
        }
    }
}

fn length<S: Scalar>(nodes: &[Node<S>]) -> S {
    nodes.iter().fold(S::zero(), |sum, node| sum + node.seconds)
}

/// +1 at a maximum of values between which a quantity rises or falls, −1 at a minimum, 0 elsewhere. Before the
/// first and after the last it is −∞.
pub(super) fn turns_at<S: Scalar>(heights: &[S], i: usize) -> f64 {
    let rises = |i: usize| heights[i + 1].re() > heights[i].re();
    let sign = |rises: bool| if rises { 1.0 } else { -1.0 };
    let before = sign(i == 0 || rises(i - 1));
    let after = sign(i + 1 != heights.len() && rises(i));
    0.5 * (before - after)
}

/// As [`turns_at`], and ±½ at the first and the last.
fn turns_between<S: Scalar>(heights: &[S], i: usize) -> f64 {
    let last = heights.len() - 1;
    let change = |i: usize| match (heights[i + 1].re(), heights[i].re()) {
        (after, before) if after == before => 0.0,
        (after, before) => (after - before).signum(),
    };
    let before = if i == 0 { 0.0 } else { change(i - 1) };
    let after = if i == last { 0.0 } else { change(i) };
    0.5 * (before - after)
}

/// sign(x) |x|^m.
fn signed_power<S: Scalar>(x: S, m: f64) -> S {
    match x.re() {
        0.0 => S::zero(),
        re => ((x * re.signum()).ln() * m).exp() * re.signum(),
    }
}

/// The reduction of a quantity with these values over the window with these ends.
pub(super) fn value<S: Scalar>(
    reduction: Reduction,
    run: &Trajectory<S>,
    ends: &[Placed<S>; 2],
    values: &[S],
) -> S {
    Span::of(run, ends).reduce(reduction, run, values, None)
}

/// Its derivatives.
pub(super) fn derivatives(
    reduction: Reduction,
    run: &Trajectory<f64>,
    ends: &[Placed<f64>; 2],
    values: &[f64],
) -> Windowed {
    let mut by_values = vec![0.0; values.len()];
    let real = Span::of(run, ends);
    real.reduce(reduction, run, values, Some(&mut by_values));
    let lifted: Vec<Dual> = values.iter().map(|&x| Dual::from(x)).collect();
    let by = |which: usize| {
        let seed = |i: usize, x: f64| Dual::new(x, if i == which { 1.0 } else { 0.0 });
        let span = Span {
            ends: [seed(0, real.ends[0]), seed(1, real.ends[1])],
            duration: seed(2, real.duration),
        };
        span.reduce(reduction, run, &lifted, None).infinitesimal()
    };
    Windowed {
        by_values,
        by_ends: [by(0), by(1)],
        by_duration: by(2),
    }
}

/// The largest value in the window.
pub(super) fn maximum<S: Scalar>(
    run: &Trajectory<S>,
    ends: &[Placed<S>; 2],
    values: &[S],
) -> Maximum {
    let points = Span::of(run, ends).points(run, values).into_iter();
    let points = points.map(|(at, point)| (at, point.value.re()));
    let (at, value) = points.fold((0.0, f64::NEG_INFINITY), |best, point| {
        if point.1 > best.1 { point } else { best }
    });
    Maximum {
        value,
        time: at * run.duration.re(),
        error: stretch_at(run, &stretches(run), at).error(run, values, at),
    }
}
