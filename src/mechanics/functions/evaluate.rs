//! Values of functions over a run.

use super::flight::Flight;
use super::function::{Function, Reduction, Release};
use super::instant::{Instant, Projectile};
use super::multipliers::{JointMultipliers, Rows};
use super::peak::{self, Maximum, Point};
use super::snapshot::Snapshot;
use super::turning::turns;
use crate::integrate::Trajectory;
use crate::linalg::SolveScalar;
use crate::math::Complex64;
use crate::math::soft_max::{Bound, SoftMax};
use crate::model::Model;
use crate::system::Numbering;
use std::ops::RangeInclusive;

/// Below this sharpness the samples resolve a peak.
const COARSE: f64 = 0.3;

/// A function's value over a run, with data for reports.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Evaluated<S> {
    /// The value.
    pub value: S,
    /// For an aggregate: the largest value over the motion, and over the points of the quantity if it has some.
    pub maximum: Option<Maximum>,
    /// For an aggregate over samples that do not adapt to it: ρ κ h² or ρ s h, whichever is larger, with
    /// the curvature κ and the slope s at the peak and the distance h of the samples. Above about one
    /// the samples do not resolve the peak.
    pub peak_sharpness: f64,
}

impl Function<f64> {
    /// Value over a run of `model`.
    pub fn evaluate(&self, model: &Model<f64>, run: &Trajectory<f64>) -> Evaluated<f64> {
        self.evaluate_in(model, run)
    }
}

impl<S: SolveScalar> Function<S> {
    /// Value over a run of `model`, in any scalar. Those of `f64` and `Complex64` are compiled here.
    pub(super) fn evaluate_in(&self, model: &Model<S>, run: &Trajectory<S>) -> Evaluated<S> {
        match self {
            Function::Reduced { instant, reduction } => reduce(instant, *reduction, model, run),
            Function::OfDesign { value, .. } => Evaluated {
                value: *value,
                maximum: None,
                peak_sharpness: 0.0,
            },
            Function::Duration => Evaluated {
                value: run.time(run.last()),
                maximum: None,
                peak_sharpness: 0.0,
            },
            Function::Clearance {
                projectile,
                release,
                distance,
                top,
            } => {
                let flight = match release {
                    Release::Final => Snapshot::of(model, run, run.last()).flight(projectile),
                    Release::Best { .. } => mean_flight(
                        projectile,
                        &release_weights(release, model, run),
                        model,
                        run,
                    ),
                };
                Evaluated {
                    value: flight.clearance(*distance, *top),
                    maximum: None,
                    peak_sharpness: 0.0,
                }
            }
        }
    }
}

impl Function<Complex64> {
    /// Value over a run of `model`.
    pub fn evaluate(
        &self,
        model: &Model<Complex64>,
        run: &Trajectory<Complex64>,
    ) -> Evaluated<Complex64> {
        self.evaluate_in(model, run)
    }

    /// Σ |w_k Im z_k| of a reduction with the weights w_k over the values z_k of a motion: the size of the terms
    /// whose sum is the imaginary part of the value. Zero for functions that are no such sum.
    pub fn terms_over_motion(&self, model: &Model<Complex64>, run: &Trajectory<Complex64>) -> f64 {
        let Function::Reduced { instant, reduction } = self else {
            return 0.0;
        };
        let turns = turns(instant.watched_rotation(), run);
        let sum = |weight: &dyn Fn(usize) -> f64, values: &[Complex64]| {
            let terms = values.iter().enumerate();
            terms.map(|(k, z)| (z.im * weight(k)).abs()).sum()
        };
        match *reduction {
            Reduction::Final => 0.0,
            Reduction::Integral => {
                let duration = run.time(run.last()).re;
                let weight = |k| duration * run.quadrature_weight(k).re;
                sum(&weight, &sample_in(instant, &turns, model, run))
            }
            Reduction::Ks { rho, .. } | Reduction::InducedExponential { rho } => {
                let values = sample_in(instant, &turns, model, run);
                let soft = SoftMax::new(&values, |k| run.quadrature_weight(k), rho);
                sum(&|k| soft.weights[k].re, &values)
            }
        }
    }
}

fn reduce<S: SolveScalar>(
    instant: &Instant<S>,
    reduction: Reduction,
    model: &Model<S>,
    run: &Trajectory<S>,
) -> Evaluated<S> {
    let turns = turns(instant.watched_rotation(), run);
    let plain = |value| Evaluated {
        value,
        maximum: None,
        peak_sharpness: 0.0,
    };
    match reduction {
        Reduction::Final => {
            let last = run.last();
            plain(sample_at(instant, &turns, model, run, last..=last)[0])
        }
        Reduction::Integral => {
            let values = sample_in(instant, &turns, model, run);
            let mean = (0..=run.last()).fold(S::zero(), |sum, k| {
                sum + values[k] * run.quadrature_weight(k)
            });
            plain(mean * run.time(run.last()))
        }
        Reduction::Ks { rho, .. } | Reduction::InducedExponential { rho } => {
            let both = |at: &Snapshot<S>, turns| instant.value_and_largest(at, turns);
            let all = sample_with(instant, &turns, (model, run), 0..=run.last(), both);
            let (values, largest): (Vec<S>, Vec<S>) = all.into_iter().unzip();
            let soft = SoftMax::new(&values, |k| run.quadrature_weight(k), rho);
            let value = match reduction {
                Reduction::Ks { bound, .. } => match bound {
                    Bound::Below => soft.ks,
                    Bound::Above => turning(&values, run, rho).0.ks,
                },
                _ => soft.induced_exponential(&values),
            };
            // The number of nodes of cells adapts to the peak.
            let k = soft.peak;
            let near = |from: usize, to: usize| Some(values.get(to)?.re() - values.get(from)?.re());
            let before = k.checked_sub(1).and_then(|before| near(k, before));
            let (before, after) = (before.unwrap_or(0.0), near(k, k + 1).unwrap_or(0.0));
            let bend = match k == 0 || k == run.last() {
                true => 0.0,
                false => before + after,
            };
            // The soft maximum over turning points needs no integral.
            let slope = match reduction {
                Reduction::Ks {
                    bound: Bound::Above,
                    ..
                } => 0.0,
                _ => before.abs().max(after.abs()),
            };
            let sharpness = match run.has_cells {
                true => 0.0,
                false => rho * bend.abs().max(slope),
            };
            Evaluated {
                value,
                maximum: Some(peak::maximum(run, &largest)),
                peak_sharpness: sharpness,
            }
        }
    }
}

/// The soft maximum over the maxima of a quantity minus its minima. It is never below the largest
/// value, because maxima and minima alternate and no minimum exceeds its neighbours. Also the
/// samples and turning points that its weights belong to.
pub(super) fn turning<S: SolveScalar>(
    values: &[S],
    run: &Trajectory<S>,
    rho: f64,
) -> (SoftMax<S>, Vec<Point<S>>) {
    let points = peak::points(run, values);
    let heights: Vec<S> = points.iter().map(|point| point.value).collect();
    let rises = |i: usize| heights[i + 1].re() > heights[i].re();
    let last = heights.len() - 1;
    let sign = |rises: bool| if rises { 1.0 } else { -1.0 };
    // +1 at a maximum, −1 at a minimum, 0 elsewhere. Before the start and after the end the value
    // is −∞.
    let count = |i: usize| {
        let before = sign(i == 0 || rises(i - 1));
        let after = sign(i != last && rises(i));
        S::from(0.5 * (before - after))
    };
    (SoftMax::new(&heights, count, rho), points)
}

/// The value of an integral aggregate whose samples do not resolve its peak (see
/// [`Evaluated::peak_sharpness`]), from the polynomials between them; `None` for other functions.
pub fn between_samples(
    function: &Function<f64>,
    model: &Model<f64>,
    run: &Trajectory<f64>,
) -> Option<f64> {
    let Function::Reduced { instant, reduction } = function else {
        return None;
    };
    let rho = match *reduction {
        Reduction::Ks {
            rho,
            bound: Bound::Below,
        }
        | Reduction::InducedExponential { rho } => rho,
        Reduction::Ks { .. } | Reduction::Final | Reduction::Integral => return None,
    };
    if function.evaluate(model, run).peak_sharpness < COARSE {
        return None;
    }
    let values = sample_in(instant, &turns(instant.watched_rotation(), run), model, run);
    let [sum, moment, top] = peak::exponential_integrals(run, &values, rho);
    Some(match reduction {
        Reduction::InducedExponential { .. } => top + moment / sum,
        _ => top + sum.ln() / rho,
    })
}

/// The largest range without the gate, at instants at which the gate is more than half open; `None`
/// without a gate.
pub fn ungated_maximum(
    function: &Function<f64>,
    model: &Model<f64>,
    run: &Trajectory<f64>,
) -> Option<f64> {
    let Function::Reduced { instant, .. } = function else {
        return None;
    };
    let Instant::Range {
        projectile,
        gate: gate @ Some(_),
    } = instant
    else {
        return None;
    };
    let turns = turns(instant.watched_rotation(), run);
    let free = Instant::Range {
        projectile: *projectile,
        gate: None,
    };
    let open = |k: usize| {
        let at = Snapshot::of(model, run, k);
        at.openness(gate, turn(&turns, k)) > 0.5
    };
    let values = sample(&free, &turns, model, run);
    Some(peak::maximum_where(run, &values, open).value).filter(|most| most.is_finite())
}

/// Values of an instant quantity at all instants of a run.
pub fn sample(
    instant: &Instant<f64>,
    turns: &Option<Vec<f64>>,
    model: &Model<f64>,
    run: &Trajectory<f64>,
) -> Vec<f64> {
    sample_in(instant, turns, model, run)
}

/// [`sample`] in any scalar.
pub(super) fn sample_in<S: SolveScalar>(
    instant: &Instant<S>,
    turns: &Option<Vec<f64>>,
    model: &Model<S>,
    run: &Trajectory<S>,
) -> Vec<S> {
    sample_at(instant, turns, model, run, 0..=run.last())
}

/// Values of an instant quantity at some instants of a run.
fn sample_at<S: SolveScalar>(
    instant: &Instant<S>,
    turns: &Option<Vec<f64>>,
    model: &Model<S>,
    run: &Trajectory<S>,
    instants: RangeInclusive<usize>,
) -> Vec<S> {
    let value = |at: &Snapshot<S>, turns| instant.value(at, turns);
    sample_with(instant, turns, (model, run), instants, value)
}

/// What `of` takes from some instants of a run. Multipliers are computed if the quantity needs them.
pub(super) fn sample_with<S: SolveScalar, T>(
    instant: &Instant<S>,
    turns: &Option<Vec<f64>>,
    (model, run): (&Model<S>, &Trajectory<S>),
    instants: RangeInclusive<usize>,
    of: impl Fn(&Snapshot<S>, f64) -> T,
) -> Vec<T> {
    // The model may have rows that were left out of the run.
    let numbering = instant.reacting_joint().map(|_| Numbering::new(model));
    let joint = numbering.as_ref().zip(instant.reacting_joint());
    let mut joint = joint.map(|(numbering, j)| JointMultipliers::new(model, numbering, j));
    let value = |k: usize| {
        let at = Snapshot {
            joint: (joint.as_mut()).map_or(Rows::none(), |joint| joint.at(run, k)),
            ..Snapshot::of(model, run, k)
        };
        of(&at, turn(turns, k))
    };
    instants.map(value).collect()
}

pub(super) fn turn(turns: &Option<Vec<f64>>, k: usize) -> f64 {
    turns.as_ref().map_or(0.0, |turns| turns[k])
}

/// Softmax weights and sampled gated ranges of a release around the best instant.
pub(super) struct ReleaseWeights<S> {
    pub weights: Vec<S>,
    pub range: Instant<S>,
    pub turns: Option<Vec<f64>>,
    pub rho: f64,
    /// Instant of the longest range.
    peak: usize,
}

pub(super) fn release_weights<S: SolveScalar>(
    release: &Release<S>,
    model: &Model<S>,
    run: &Trajectory<S>,
) -> ReleaseWeights<S> {
    let Release::Best {
        rho,
        projectile,
        gate,
    } = release
    else {
        unreachable!("asked for the best release only");
    };
    let range = Instant::Range {
        projectile: *projectile,
        gate: *gate,
    };
    let turns = turns(range.watched_rotation(), run);
    let values = sample_in(&range, &turns, model, run);
    let soft = SoftMax::new(&values, |k| run.quadrature_weight(k), *rho);
    ReleaseWeights {
        weights: without_negligible(soft.weights),
        range,
        turns,
        rho: *rho,
        peak: soft.peak,
    }
}

/// The mean flight Σ w_k z_k. It is summed relative to the best flight, so that derivatives of the
/// weights, whose sum is zero, do not cancel at the size of z.
pub(super) fn mean_flight<S: SolveScalar>(
    projectile: &Projectile<S>,
    release: &ReleaseWeights<S>,
    model: &Model<S>,
    run: &Trajectory<S>,
) -> Flight<S> {
    let flight = |k| Snapshot::of(model, run, k).flight(projectile).to_array();
    let best = flight(release.peak);
    let mut away = [S::zero(); 5];
    for (k, &w) in release.weights.iter().enumerate() {
        if w.re() == 0.0 {
            continue;
        }
        let z = flight(k);
        for i in 0..5 {
            away[i] += (z[i] - best[i]) * w;
        }
    }
    Flight::from_array(std::array::from_fn(|i| best[i] + away[i]))
}

/// Weights below this part of the largest are negligible: their derivatives would have to be 1/ε
/// times as large to change the last digit.
const NEGLIGIBLE: f64 = f64::EPSILON * f64::EPSILON;

/// The weights with zeros for negligible ones. Most weights of a soft maximum are negligible, and
/// the adjoint skips their instants.
pub(super) fn without_negligible<S: SolveScalar>(mut weights: Vec<S>) -> Vec<S> {
    let largest = weights.iter().fold(0.0_f64, |m, w| m.max(w.re().abs()));
    for w in &mut weights {
        if w.re().abs() < NEGLIGIBLE * largest {
            *w = S::zero();
        }
    }
    weights
}
