//! Functions linearised about a run, for the adjoint.

use super::evaluate::{mean_flight, release_weights, turning, without_negligible};
use super::function::{Function, Reduction, Release};
use super::instant::{Instant, Projectile};
use super::measure::pull_flight;
use super::misfit;
use super::multipliers::Reacting;
use super::quantity::{Quantity, Sampled};
use super::samples::turn;
use super::series::Series;
use super::snapshot::{Snapshot, SnapshotCotangent};
use super::turning::turns;
use super::window::{Edge, Window};
use super::windowed;
use crate::integrate::Trajectory;
use crate::math::Parameters;
use crate::math::soft_max::{Bound, SoftMax};
use crate::model::Model;
use crate::structures::modes::soft_lowest;

/// One instant quantity with a weight at every instant.
struct Weighted {
    instant: Instant<f64>,
    turns: Option<Vec<f64>>,
    weights: Vec<f64>,
}

impl Weighted {
    fn new(instant: Instant<f64>, weights: Vec<f64>, run: &Trajectory<f64>) -> Self {
        Self {
            turns: turns(instant.watched_rotation(), run),
            instant,
            weights: without_negligible(weights),
        }
    }
}

/// A function linearised about a run: its contributions to the cotangents of every instant.
pub struct Linearised<'a> {
    function: &'a Function<f64>,
    /// Its derivative in the duration at fixed states.
    pub by_duration: f64,
    /// The quantities of an instant, in the order of [`Function::instants`]; of a clearance, the range.
    quantities: Vec<Weighted>,
    flight: Option<WeightedFlight>,
    by_barrier: [f64; 2],
    /// In the times or values that give the ends of the window.
    by_ends: [f64; 2],
    /// In the offsets of the series of a misfit.
    by_offsets: Vec<f64>,
    /// In the frequencies of an aggregate of them.
    by_frequencies: Vec<f64>,
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
            quantities: Vec::new(),
            flight: None,
            by_barrier: [0.0; 2],
            by_ends: [0.0; 2],
            by_offsets: Vec::new(),
            by_frequencies: Vec::new(),
        };
        match function {
            Function::Reduced {
                of,
                during: Some(window),
                reduction,
            } => this.during(of, window, *reduction, (model, run)),
            Function::Reduced {
                of,
                reduction: reduction @ Reduction::Damage { .. },
                ..
            } => this.during(of, &Window::whole(), *reduction, (model, run)),
            Function::Reduced { of, reduction, .. } => {
                let instants = 0..=run.last();
                // The value at the end is that of its own instant.
                let sampled = match reduction {
                    Reduction::Final => None,
                    _ => Some(of.sampled((model, run), instants.clone())),
                };
                let values = sampled.as_ref().map_or(&[][..], |own| &own.values);
                let weights = match *reduction {
                    Reduction::Final => instants.map(last).collect(),
                    Reduction::Damage { .. } => unreachable!("it is one over a window"),
                    Reduction::Integral => {
                        this.by_duration =
                            instants.clone().map(|k| values[k] * run.moving[k]).sum();
                        let duration = run.time(run.last());
                        instants
                            .map(|k| duration * run.quadrature_weight(k))
                            .collect()
                    }
                    Reduction::Mean => {
                        this.by_duration =
                            by_weights(run, |k| run.quadrature_weight(k) * values[k]);
                        instants.map(|k| run.quadrature_weight(k)).collect()
                    }
                    Reduction::Ks { rho, bound } => match bound {
                        Bound::Below => {
                            let soft = SoftMax::new(values, |k| run.quadrature_weight(k), rho);
                            this.by_duration = by_weights(run, |k| soft.weights[k] / rho);
                            soft.weights
                        }
                        Bound::Above => {
                            let (soft, points) = turning(values, run, rho);
                            let mut weights = vec![0.0; values.len()];
                            for (weight, point) in soft.weights.iter().zip(&points) {
                                for &(k, part) in &point.of {
                                    weights[k] += weight * part;
                                }
                            }
                            weights
                        }
                    },
                    Reduction::InducedExponential { rho } => {
                        let soft = SoftMax::new(values, |k| run.quadrature_weight(k), rho);
                        let mean = soft.induced_exponential(values);
                        this.by_duration =
                            by_weights(run, |k| soft.weights[k] * (values[k] - mean));
                        let by = |k: usize| soft.weights[k] * (1.0 + rho * (values[k] - mean));
                        instants.map(by).collect()
                    }
                };
                this.weigh(of, (weights, sampled), (model, run));
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
            Function::Misfit { series } => this.misfit(series, (model, run)),
            Function::Duration => this.by_duration = 1.0,
            Function::LowestFrequency { rho, frequencies } => {
                this.by_frequencies = soft_lowest(frequencies, *rho).weights;
            }
            Function::OfDesign { .. } => {}
        }
        this
    }

    /// Σ w_k g(t_k) of the quantity g that `function` reduces, with a weight for every instant of the run of
    /// `model`.
    pub fn history(
        function: &'a Function<f64>,
        weights: &[f64],
        (model, run): (&Model<f64>, &Trajectory<f64>),
    ) -> Self {
        let mut this = Self {
            function,
            by_duration: 0.0,
            quantities: Vec::new(),
            flight: None,
            by_barrier: [0.0; 2],
            by_ends: [0.0; 2],
            by_offsets: Vec::new(),
            by_frequencies: Vec::new(),
        };
        if let Some(of) = function.quantity() {
            this.weigh(of, (weights.to_vec(), None), (model, run));
        }
        this
    }

    /// Adds weights of the values of a quantity; `sampled` has them, if they are known.
    fn weigh(
        &mut self,
        of: &Quantity<f64>,
        (weights, sampled): (Vec<f64>, Option<Sampled<f64>>),
        (model, run): (&Model<f64>, &Trajectory<f64>),
    ) {
        let sampled = sampled.unwrap_or_else(|| match of {
            Quantity::Of(_) => Sampled::default(),
            Quantity::Combined { .. } => of.sampled((model, run), 0..=run.last()),
        });
        let mut all = Vec::new();
        of.spread((run, &sampled), weights, &mut self.by_duration, &mut all);
        let all = all.into_iter();
        let all = all.map(|(instant, weights)| Weighted::new(instant, weights, run));
        self.quantities.extend(all);
    }

    /// A reduction over a window, whose ends may depend on the motion. Nothing, if it has no value.
    fn during(
        &mut self,
        of: &Quantity<f64>,
        window: &Window<f64>,
        reduction: Reduction,
        (model, run): (&Model<f64>, &Trajectory<f64>),
    ) {
        let Some(ends) = window.place(model, run) else {
            return;
        };
        let sampled = of.sampled((model, run), 0..=run.last());
        let by = windowed::derivatives(reduction, run, &ends, &sampled.values);
        self.by_duration += by.by_duration;
        self.weigh(of, (by.by_values, Some(sampled)), (model, run));
        for (i, (edge, end)) in [&window.from, &window.to]
            .into_iter()
            .zip(&ends)
            .enumerate()
        {
            let by_end = by.by_ends[i];
            self.by_ends[i] = by_end * end.by_own;
            self.by_duration += by_end * end.by_duration;
            if let Edge::When(reach) = edge {
                let mut weights = vec![0.0; run.last() + 1];
                for &(k, weight) in &end.by_values {
                    weights[k] += by_end * weight;
                }
                self.weigh(&reach.of, (weights, None), (model, run));
            }
        }
    }

    /// A mean square over data. Nothing, if it has no value.
    fn misfit(&mut self, series: &[Series<f64>], at: (&Model<f64>, &Trajectory<f64>)) {
        let part = 1.0 / misfit::count(series) as f64;
        for own in series {
            let Some(pulled) = own.pull(at, part) else {
                return;
            };
            self.by_duration += pulled.by_duration;
            self.by_offsets.push(pulled.by_offset);
            self.weigh(&own.of, (pulled.by_values, None), at);
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
        self.quantities.push(Weighted {
            instant: release.range,
            turns: release.turns,
            weights: without_negligible(by_range),
        });
        self.flight = Some(WeightedFlight {
            weights: release.weights,
            cot,
        });
    }

    /// Number of its quantities of an instant.
    pub fn quantities(&self) -> usize {
        self.quantities.len()
    }

    /// The joints whose multipliers a quantity needs, if any.
    pub fn reacting(&self, which: usize) -> Option<Reacting> {
        self.quantities[which].instant.reacting()
    }

    /// Whether the function depends on the states of instant k.
    pub fn depends_on(&self, k: usize) -> bool {
        (0..self.quantities.len()).any(|which| self.depends_through(which, k))
            || self.flight.as_ref().is_some_and(|f| f.weights[k] != 0.0)
    }

    /// Whether it depends on the states of instant k through a quantity.
    pub fn depends_through(&self, which: usize, k: usize) -> bool {
        self.quantities[which].weights[k] != 0.0
    }

    /// Adds the derivative in the states of instant k through a quantity to `out`, and that in its parameters
    /// to `own`.
    pub fn pull_quantity(
        &self,
        which: usize,
        k: usize,
        at: &Snapshot<f64>,
        out: &mut SnapshotCotangent,
        own: &mut Function<f64>,
    ) {
        let Weighted {
            instant,
            turns,
            weights,
        } = &self.quantities[which];
        let mut pull = |own: &mut Instant<f64>| {
            instant.pull_back(at, turn(turns, k), weights[k], out, own);
        };
        match own {
            Function::Duration | Function::LowestFrequency { .. } | Function::OfDesign { .. } => {}
            Function::Reduced { .. } | Function::Misfit { .. } => {
                if let Some(own) = own.instant_mut(which) {
                    pull(own);
                }
            }
            Function::Clearance { release, .. } => {
                let mut range = instant.map(&mut |_| 0.0);
                pull(&mut range);
                if let (
                    Instant::Range { projectile, gate },
                    Release::Best {
                        projectile: by,
                        gate: by_gate,
                        ..
                    },
                ) = (range, release)
                {
                    if let (Some(by_gate), Some(gate)) = (by_gate, gate) {
                        by_gate.rotation.add(&gate.rotation);
                    }
                    by.point += projectile.point;
                    by.direction += projectile.direction;
                    by.ground += projectile.ground;
                }
            }
        }
    }

    /// Adds the derivative in the states of instant k through the flight of a projectile to `out`, and that in its
    /// parameters to `own`.
    pub fn pull_flight(
        &self,
        k: usize,
        at: &Snapshot<f64>,
        out: &mut SnapshotCotangent,
        own: &mut Function<f64>,
    ) {
        if let (
            Some(flight),
            Function::Clearance { projectile, .. },
            Function::Clearance { projectile: by, .. },
        ) = (&self.flight, self.function, own)
            && flight.weights[k] != 0.0
        {
            let cot = flight.cot.map(|c| c * flight.weights[k]);
            pull_flight(at, projectile, cot, out, by);
        }
    }

    /// Adds the derivative in the parameters that do not belong to an instant.
    pub fn pull_back_parameters(&self, own: &mut Function<f64>) {
        match own {
            Function::Clearance { distance, top, .. } => {
                *distance += self.by_barrier[0];
                *top += self.by_barrier[1];
            }
            Function::LowestFrequency { frequencies, .. } => {
                for (f, by) in frequencies.iter_mut().zip(&self.by_frequencies) {
                    *f += by;
                }
            }
            Function::OfDesign { value, .. } => *value += 1.0,
            Function::Reduced {
                during: Some(window),
                ..
            } => {
                for (edge, by) in [&mut window.from, &mut window.to]
                    .into_iter()
                    .zip(self.by_ends)
                {
                    match edge {
                        Edge::At(time) => *time += by,
                        Edge::When(reach) => reach.value += by,
                        Edge::Start | Edge::End => {}
                    }
                }
            }
            Function::Misfit { series } => {
                for (own, by) in series.iter_mut().zip(&self.by_offsets) {
                    own.offset += by;
                }
            }
            Function::Reduced { .. } | Function::Duration => {}
        }
    }
}
