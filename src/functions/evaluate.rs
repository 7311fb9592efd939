//! Values of functions over a run, and their linearisation for the adjoint.

use super::flight::Flight;
use super::function::{Function, Reduction, Release};
use super::instant::{Instant, Projectile};
use super::measure::{Snapshot, SnapshotCotangent, pull_flight};
use super::multipliers::{JointMultipliers, Rows};
use super::peak::{self, Maximum, Point};
use super::turning::turns;
use crate::integrate::{Trajectory, quadrature};
use crate::linalg::SolveScalar;
use crate::math::Parameters;
use crate::math::soft_max::{Bound, SoftMax};
use crate::model::Model;
use crate::system::Numbering;
use std::ops::RangeInclusive;

/// A function's value over a run, with data for reports.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Evaluated<S> {
    /// The value.
    pub value: S,
    /// For an aggregate: the largest value over the motion.
    pub maximum: Option<Maximum>,
    /// For an aggregate over equally spaced samples: ρ κ h², with the curvature κ at the peak and
    /// the distance h of the samples. Above about one the samples do not resolve the peak.
    pub peak_sharpness: f64,
}

impl<S: SolveScalar> Function<S> {
    /// Value over a run of `model`.
    pub(crate) fn evaluate(&self, model: &Model<S>, run: &Trajectory<S>) -> Evaluated<S> {
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
            let values = sample(instant, &turns, model, run);
            let mean = (0..=run.last()).fold(S::zero(), |sum, k| {
                sum + values[k] * run.quadrature_weight(k)
            });
            plain(mean * run.time(run.last()))
        }
        Reduction::Ks { rho, .. } | Reduction::InducedExponential { rho } => {
            let values = sample(instant, &turns, model, run);
            let soft = SoftMax::new(&values, |k| run.quadrature_weight(k), rho);
            let value = match reduction {
                Reduction::Ks { bound, .. } => match bound {
                    Bound::Below => soft.ks,
                    Bound::Above => turning(&values, run, rho).0.ks,
                },
                _ => soft.induced_exponential(&values),
            };
            let k = soft.peak.clamp(1, run.last().max(2) - 1);
            // Nodes of cells have unequal distances, and their number adapts to the peak.
            let even = quadrature::order(&run.instants) > 2;
            let bend = values.get(k + 1).filter(|_| even).map_or(0.0, |next| {
                (next.re() - 2.0 * values[k].re() + values[k - 1].re()).abs()
            });
            Evaluated {
                value,
                maximum: Some(peak::maximum(run, &values)),
                peak_sharpness: rho * bend,
            }
        }
    }
}

/// The soft maximum over the maxima of a quantity minus its minima. It is never below the largest
/// value, because maxima and minima alternate and no minimum exceeds its neighbours. Also the
/// samples and turning points that its weights belong to.
fn turning<S: SolveScalar>(
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
        0.5 * (before - after)
    };
    (SoftMax::new(&heights, count, rho), points)
}

/// The largest range without the gate, at instants at which the gate is more than half open; `None`
/// without a gate.
pub(crate) fn ungated_maximum<S: SolveScalar>(
    function: &Function<S>,
    model: &Model<S>,
    run: &Trajectory<S>,
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
        at.openness(gate, turn(&turns, k)).re() > 0.5
    };
    let values = sample(&free, &turns, model, run);
    Some(peak::maximum_where(run, &values, open).value).filter(|most| most.is_finite())
}

/// Values of an instant quantity at all instants of a run.
pub(crate) fn sample<S: SolveScalar>(
    instant: &Instant<S>,
    turns: &Option<Vec<f64>>,
    model: &Model<S>,
    run: &Trajectory<S>,
) -> Vec<S> {
    sample_at(instant, turns, model, run, 0..=run.last())
}

/// Values of an instant quantity at some instants of a run. Multipliers are computed if it needs them.
fn sample_at<S: SolveScalar>(
    instant: &Instant<S>,
    turns: &Option<Vec<f64>>,
    model: &Model<S>,
    run: &Trajectory<S>,
    instants: RangeInclusive<usize>,
) -> Vec<S> {
    // Rows that were left out of the run may stand in the model.
    let numbering = instant.reacting_joint().map(|_| Numbering::new(model));
    let joint = numbering.as_ref().zip(instant.reacting_joint());
    let mut joint = joint.map(|(numbering, j)| JointMultipliers::new(model, numbering, j));
    let value = |k: usize| {
        let at = Snapshot {
            joint: (joint.as_mut()).map_or(Rows::none(), |joint| joint.at(run, k)),
            ..Snapshot::of(model, run, k)
        };
        instant.value(&at, turn(turns, k))
    };
    instants.map(value).collect()
}

fn turn(turns: &Option<Vec<f64>>, k: usize) -> f64 {
    turns.as_ref().map_or(0.0, |turns| turns[k])
}

/// Softmax weights and sampled gated ranges of a release around the best instant.
struct ReleaseWeights<S> {
    weights: Vec<S>,
    range: Instant<S>,
    turns: Option<Vec<f64>>,
    rho: f64,
    /// Instant of the longest range.
    peak: usize,
}

fn release_weights<S: SolveScalar>(
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
    let values = sample(&range, &turns, model, run);
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
fn mean_flight<S: SolveScalar>(
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

/// One instant quantity with a weight at every instant.
struct Weighted {
    instant: Instant<f64>,
    turns: Option<Vec<f64>>,
    weights: Vec<f64>,
}

/// Weights below this part of the largest are negligible: their derivatives would have to be 1/ε
/// times as large to change the last digit.
const NEGLIGIBLE: f64 = f64::EPSILON * f64::EPSILON;

/// The weights with zeros for negligible ones. Most weights of a soft maximum are negligible, and
/// the adjoint skips their instants.
fn without_negligible<S: SolveScalar>(mut weights: Vec<S>) -> Vec<S> {
    let largest = weights.iter().fold(0.0_f64, |m, w| m.max(w.re().abs()));
    for w in &mut weights {
        if w.re().abs() < NEGLIGIBLE * largest {
            *w = S::zero();
        }
    }
    weights
}

/// A function linearised about a run: its contributions to the cotangents of every instant.
pub(crate) struct Linearised<'a> {
    function: &'a Function<f64>,
    /// Its derivative in the duration at fixed states.
    pub by_duration: f64,
    quantity: Option<Weighted>,
    flight: Option<WeightedFlight>,
    by_barrier: [f64; 2],
}

/// Cotangents of a projectile's flight: `cot` times a weight at every instant.
struct WeightedFlight {
    weights: Vec<f64>,
    cot: [f64; 5],
}

impl<'a> Linearised<'a> {
    /// Linearises `function` about a run of `model`.
    pub(crate) fn new(
        function: &'a Function<f64>,
        model: &Model<f64>,
        run: &Trajectory<f64>,
    ) -> Self {
        let last = |k| if k == run.last() { 1.0 } else { 0.0 };
        let mut this = Self {
            function,
            by_duration: 0.0,
            quantity: None,
            flight: None,
            by_barrier: [0.0; 2],
        };
        match function {
            Function::Reduced { instant, reduction } => {
                let turns = turns(instant.watched_rotation(), run);
                let instants = 0..=run.last();
                let weights = match *reduction {
                    Reduction::Final => instants.map(last).collect(),
                    Reduction::Integral => {
                        let values = sample(instant, &turns, model, run);
                        this.by_duration = instants
                            .clone()
                            .map(|k| values[k] * run.quadrature_weight(k))
                            .sum();
                        let duration = run.time(run.last());
                        instants
                            .map(|k| duration * run.quadrature_weight(k))
                            .collect()
                    }
                    Reduction::Ks { rho, bound } => {
                        let values = sample(instant, &turns, model, run);
                        match bound {
                            Bound::Below => {
                                SoftMax::new(&values, |k| run.quadrature_weight(k), rho).weights
                            }
                            Bound::Above => {
                                let (soft, points) = turning(&values, run, rho);
                                let mut weights = vec![0.0; values.len()];
                                for (weight, point) in soft.weights.iter().zip(&points) {
                                    for &(k, part) in &point.of {
                                        weights[k] += weight * part;
                                    }
                                }
                                weights
                            }
                        }
                    }
                    Reduction::InducedExponential { rho } => {
                        let values = sample(instant, &turns, model, run);
                        let soft = SoftMax::new(&values, |k| run.quadrature_weight(k), rho);
                        let mean = soft.induced_exponential(&values);
                        let by = |k: usize| soft.weights[k] * (1.0 + rho * (values[k] - mean));
                        instants.map(by).collect()
                    }
                };
                this.quantity = Some(Weighted {
                    instant: instant.clone(),
                    turns,
                    weights: without_negligible(weights),
                });
            }
            Function::Clearance {
                projectile,
                release,
                distance,
                ..
            } => match release {
                Release::Final => {
                    let flight = Snapshot::of(model, run, run.last()).flight(projectile);
                    let (cot, by_barrier) = flight.clearance_derivative(*distance);
                    this.by_barrier = by_barrier;
                    let weights = (0..=run.last()).map(last).collect();
                    this.flight = Some(WeightedFlight { weights, cot });
                }
                Release::Best { .. } => this.at_best_release(projectile, *distance, model, run),
            },
            Function::Duration => this.by_duration = 1.0,
            Function::OfDesign { .. } => {}
        }
        this
    }

    /// dc = c_z · Σ (w_k dz_k + z_k dw_k) with dw_k = ρ w_k (dR_k − Σ w dR): the mean state depends
    /// on the states and on the weights.
    fn at_best_release(
        &mut self,
        projectile: &Projectile<f64>,
        distance: f64,
        model: &Model<f64>,
        run: &Trajectory<f64>,
    ) {
        let Function::Clearance { release, .. } = self.function else {
            unreachable!("only a clearance has a release");
        };
        let release = release_weights(release, model, run);
        let mean = mean_flight(projectile, &release, model, run);
        let (cot, by_barrier) = mean.clearance_derivative(distance);
        let mean = mean.to_array();
        let away = |k: usize| {
            let z = Snapshot::of(model, run, k).flight(projectile).to_array();
            (0..5).map(|i| cot[i] * (z[i] - mean[i])).sum::<f64>()
        };
        let weighted = release.weights.iter().enumerate();
        let mut by_range: Vec<f64> = weighted
            .map(|(k, &w)| if w > 0.0 { w * away(k) } else { 0.0 })
            .collect();
        // Their sum vanishes except for the round-off of the mean, which ρ dR would magnify.
        let sum: f64 = by_range.iter().sum();
        for (by, w) in by_range.iter_mut().zip(&release.weights) {
            *by = release.rho * (*by - w * sum);
        }
        self.by_barrier = by_barrier;
        self.quantity = Some(Weighted {
            instant: release.range,
            turns: release.turns,
            weights: without_negligible(by_range),
        });
        self.flight = Some(WeightedFlight {
            weights: release.weights,
            cot,
        });
    }

    /// Whether the function depends on the states of instant k.
    pub(crate) fn depends_on(&self, k: usize) -> bool {
        self.quantity.as_ref().is_some_and(|q| q.weights[k] != 0.0)
            || self.flight.as_ref().is_some_and(|f| f.weights[k] != 0.0)
    }

    /// Adds the derivative in the states of instant k to `out`, and that in the function's
    /// parameters to `own`.
    pub(crate) fn pull_back(
        &self,
        k: usize,
        at: &Snapshot<f64>,
        out: &mut SnapshotCotangent,
        own: &mut Function<f64>,
    ) {
        let mut pull = |own: &mut Instant<f64>| {
            if let Some(Weighted {
                instant,
                turns,
                weights,
            }) = &self.quantity
                && weights[k] != 0.0
            {
                instant.pull_back(at, turn(turns, k), weights[k], out, own);
            }
        };
        match own {
            Function::Duration | Function::OfDesign { .. } => {}
            Function::Reduced { instant, .. } => pull(instant),
            Function::Clearance {
                projectile: by_projectile,
                release: by_release,
                ..
            } => {
                if let (
                    Some(weighted),
                    Release::Best {
                        projectile: by,
                        gate: by_gate,
                        ..
                    },
                ) = (&self.quantity, by_release)
                {
                    let mut range = weighted.instant.map(&mut |_| 0.0);
                    pull(&mut range);
                    if let Instant::Range { projectile, gate } = range {
                        if let (Some(by_gate), Some(gate)) = (by_gate, gate) {
                            by_gate.rotation.add(&gate.rotation);
                        }
                        by.point += projectile.point;
                        by.direction += projectile.direction;
                        by.ground += projectile.ground;
                    }
                }
                if let (Some(flight), Function::Clearance { projectile, .. }) =
                    (&self.flight, self.function)
                {
                    let weight = flight.weights[k];
                    if weight != 0.0 {
                        let cot = flight.cot.map(|c| c * weight);
                        pull_flight(at, projectile, cot, out, by_projectile);
                    }
                }
            }
        }
    }

    /// Adds the derivative in the parameters that do not belong to an instant.
    pub(crate) fn pull_back_parameters(&self, own: &mut Function<f64>) {
        match own {
            Function::Clearance { distance, top, .. } => {
                *distance += self.by_barrier[0];
                *top += self.by_barrier[1];
            }
            Function::OfDesign { value, .. } => *value += 1.0,
            Function::Reduced { .. } | Function::Duration => {}
        }
    }
}
