//! Functions linearised about a run, for the adjoint.

use super::evaluate::{mean_flight, release_weights, sample, turn, turning, without_negligible};
use super::function::{Function, Reduction, Release};
use super::instant::{Instant, Projectile};
use super::measure::pull_flight;
use super::snapshot::{Snapshot, SnapshotCotangent};
use super::turning::turns;
use crate::integrate::Trajectory;
use crate::math::Parameters;
use crate::math::soft_max::{Bound, SoftMax};
use crate::model::Model;

/// One instant quantity with a weight at every instant.
struct Weighted {
    instant: Instant<f64>,
    turns: Option<Vec<f64>>,
    weights: Vec<f64>,
}

/// A function linearised about a run: its contributions to the cotangents of every instant.
pub struct Linearised<'a> {
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

/// The derivative in the duration through the weights w of a mean over the motion, whose derivatives
/// in them, times w, are `by`. Weights before the last kink shrink as the motion gets longer.
fn by_weights(run: &Trajectory<f64>, by: impl Fn(usize) -> f64) -> f64 {
    let weighed = (0..=run.last()).filter(|&k| run.weights[k] != run.moving[k]);
    let change = |k: usize| by(k) * (run.moving[k] / run.weights[k] - 1.0) / run.duration;
    weighed.map(change).sum()
}

impl<'a> Linearised<'a> {
    /// Linearises `function` about a run of `model`.
    pub fn new(function: &'a Function<f64>, model: &Model<f64>, run: &Trajectory<f64>) -> Self {
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
                        this.by_duration =
                            instants.clone().map(|k| values[k] * run.moving[k]).sum();
                        let duration = run.time(run.last());
                        instants
                            .map(|k| duration * run.quadrature_weight(k))
                            .collect()
                    }
                    Reduction::Ks { rho, bound } => {
                        let values = sample(instant, &turns, model, run);
                        match bound {
                            Bound::Below => {
                                let soft = SoftMax::new(&values, |k| run.quadrature_weight(k), rho);
                                this.by_duration = by_weights(run, |k| soft.weights[k] / rho);
                                soft.weights
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
                        this.by_duration =
                            by_weights(run, |k| soft.weights[k] * (values[k] - mean));
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

    /// Σ w_k g(t_k) of the quantity g that `function` reduces, with a weight for every instant of the run.
    pub fn history(function: &'a Function<f64>, weights: &[f64], run: &Trajectory<f64>) -> Self {
        let quantity = function.instant().map(|instant| Weighted {
            instant: instant.clone(),
            turns: turns(instant.watched_rotation(), run),
            weights: weights.to_vec(),
        });
        Self {
            function,
            by_duration: 0.0,
            quantity,
            flight: None,
            by_barrier: [0.0; 2],
        }
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
        self.by_duration = by_weights(run, |k| by_range[k]);
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
    pub fn depends_on(&self, k: usize) -> bool {
        self.quantity.as_ref().is_some_and(|q| q.weights[k] != 0.0)
            || self.flight.as_ref().is_some_and(|f| f.weights[k] != 0.0)
    }

    /// Adds the derivative in the states of instant k to `out`, and that in the function's
    /// parameters to `own`.
    pub fn pull_back(
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
    pub fn pull_back_parameters(&self, own: &mut Function<f64>) {
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
