//! Values of functions over a run.

use super::flight::Flight;
use super::function::{Function, Reduction, Release};
use super::instant::{Instant, Projectile};
use super::misfit;
use super::peak::{self, Maximum, Point};
use super::quantity::Quantity;
use super::samples::{sample, sample_at, turn};
use super::snapshot::Snapshot;
use super::turning::turns;
use super::window::Window;
use super::windowed::{self, turns_at};
use crate::integrate::Trajectory;
use crate::linalg::SolveScalar;
use crate::math::soft_max::{Bound, SoftMax};
use crate::math::{Complex64, Parameters};
use crate::model::Model;
use crate::structures::modes::soft_lowest;

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
            Function::Reduced {
                of,
                during,
                reduction,
            } => match during {
                None => reduce(of, *reduction, model, run),
                Some(window) => reduce_during(of, window, *reduction, (model, run)),
            },
            Function::LowestFrequency { rho, frequencies } => Evaluated {
                value: -soft_lowest(frequencies, *rho).ks,
                maximum: None,
                peak_sharpness: 0.0,
            },
            Function::OfDesign { value, .. } => Evaluated {
                value: *value,
                maximum: None,
                peak_sharpness: 0.0,
            },
            Function::Misfit { series } => Evaluated {
                value: misfit::mean_square(series, (model, run)),
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
        if let Function::Misfit { series } = self {
            return misfit::terms(series, (model, run));
        }
        let Function::Reduced {
            of,
            during,
            reduction,
        } = self
        else {
            return 0.0;
        };
        let values = || of.sample_in((model, run), 0..=run.last());
        let sum = |weight: &dyn Fn(usize) -> f64, values: &[Complex64]| {
            let terms = values.iter().enumerate();
            terms.map(|(k, z)| (z.im * weight(k)).abs()).sum()
        };
        if let Some(window) = during {
            let real = run.real();
            let real_model = model.map(&mut |x| x.re);
            let window = window.map(&mut |x| x.re);
            let Some(ends) = window.place(&real_model, &real) else {
                return 0.0;
            };
            let values = values();
            let plain: Vec<f64> = values.iter().map(|z| z.re).collect();
            let by = windowed::derivatives(*reduction, &real, &ends, &plain);
            return sum(&|k| by.by_values[k], &values);
        }
        match *reduction {
            Reduction::Final | Reduction::Damage { .. } => 0.0,
            Reduction::Integral | Reduction::Mean => {
                let scale = match reduction {
                    Reduction::Mean => 1.0,
                    _ => run.time(run.last()).re,
                };
                let weight = |k| scale * run.quadrature_weight(k).re;
                sum(&weight, &values())
            }
            Reduction::Ks { rho, .. } | Reduction::InducedExponential { rho } => {
                let values = values();
                let soft = SoftMax::new(&values, |k| run.quadrature_weight(k), rho);
                sum(&|k| soft.weights[k].re, &values)
            }
        }
    }
}

/// The reduction over a window; NaN if the window is not inside the motion, or empty.
fn reduce_during<S: SolveScalar>(
    of: &Quantity<S>,
    window: &Window<S>,
    reduction: Reduction,
    (model, run): (&Model<S>, &Trajectory<S>),
) -> Evaluated<S> {
    let Some(ends) = window.place(model, run) else {
        return Evaluated {
            value: S::from(f64::NAN),
            maximum: None,
            peak_sharpness: 0.0,
        };
    };
    let aggregate = matches!(
        reduction,
        Reduction::Ks { .. } | Reduction::InducedExponential { .. }
    );
    let (values, largest) = match aggregate {
        true => of.values_and_largest(model, run),
        false => (of.sample_in((model, run), 0..=run.last()), Vec::new()),
    };
    Evaluated {
        value: windowed::value(reduction, run, &ends, &values),
        maximum: aggregate.then(|| windowed::maximum(run, &ends, &largest)),
        peak_sharpness: 0.0,
    }
}

fn reduce<S: SolveScalar>(
    of: &Quantity<S>,
    reduction: Reduction,
    model: &Model<S>,
    run: &Trajectory<S>,
) -> Evaluated<S> {
    let plain = |value| Evaluated {
        value,
        maximum: None,
        peak_sharpness: 0.0,
    };
    match reduction {
        Reduction::Damage { .. } => reduce_during(of, &Window::whole(), reduction, (model, run)),
        Reduction::Final => {
            let last = run.last();
            plain(of.sample_in((model, run), last..=last)[0])
        }
        Reduction::Integral | Reduction::Mean => {
            let values = of.sample_in((model, run), 0..=run.last());
            let mean = (0..=run.last()).fold(S::zero(), |sum, k| {
                sum + values[k] * run.quadrature_weight(k)
            });
            plain(match reduction {
                Reduction::Mean => mean,
                _ => mean * run.time(run.last()),
            })
        }
        Reduction::Ks { rho, .. } | Reduction::InducedExponential { rho } => {
            let (values, largest) = of.values_and_largest(model, run);
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
    let count = |i: usize| S::from(turns_at(&heights, i));
    (SoftMax::new(&heights, count, rho), points)
}

/// The value of an integral aggregate whose samples do not resolve its peak (see
/// [`Evaluated::peak_sharpness`]), from the polynomials between them; `None` for other functions.
pub fn between_samples(
    function: &Function<f64>,
    model: &Model<f64>,
    run: &Trajectory<f64>,
) -> Option<f64> {
    let Function::Reduced {
        of,
        during: None,
        reduction,
    } = function
    else {
        return None;
    };
    let rho = match *reduction {
        Reduction::Ks {
            rho,
            bound: Bound::Below,
        }
        | Reduction::InducedExponential { rho } => rho,
        Reduction::Ks { .. }
        | Reduction::Final
        | Reduction::Integral
        | Reduction::Mean
        | Reduction::Damage { .. } => {
            return None;
        }
    };
    if function.evaluate(model, run).peak_sharpness < COARSE {
        return None;
    }
    let values = of.sample(model, run);
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
    let instant = function.instant()?;
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
    let values = sample(&free, model, run);
    Some(peak::maximum_where(run, &values, open).value).filter(|most| most.is_finite())
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
    let values = sample_at(&range, (model, run), 0..=run.last());
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
