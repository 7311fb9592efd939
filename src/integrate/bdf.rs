//! Backward differentiation formulas of constant step, with the start-up of increasing order.

use super::failure::IntegrationFailure;
use super::newton::{History, Newton, Unknowns};
use super::settings::{Method, Settings};
use super::trajectory::Trajectory;
use crate::linalg::SolveScalar;
use crate::math::{Complex64, Scalar};
use crate::model::Model;
use crate::system::kkt::SaddlePoint;
use crate::system::{Numbering, bodies, initial, redundancy};
use std::collections::VecDeque;

/// Coefficients a_0 … a_m of ẋ_k ≈ (1/h) Σ a_i x_{k−i}.
///
/// # Panics
/// If `order` is not 1 or 2.
pub fn coefficients(order: usize) -> &'static [f64] {
    match order {
        1 => &[1.0, -1.0],
        2 => &[1.5, -2.0, 0.5],
        _ => panic!("settings allow the orders 1 and 2"),
    }
}

/// Order of step k of a formula of order m that starts with order 1: min(k, m).
pub fn order_of_step(order: usize, k: usize) -> usize {
    order.min(k)
}

/// Integrates `model` over `duration` in real numbers.
///
/// # Errors
/// [`IntegrationFailure`] says what failed, when and where.
pub fn simulate(
    model: &Model<f64>,
    duration: f64,
    settings: &Settings,
) -> Result<Trajectory<f64>, IntegrationFailure> {
    march(model, duration, settings)
}

/// Integrates `model` in complex numbers, for complex-step derivatives.
///
/// # Errors
/// As [`simulate`].
pub fn simulate_complex(
    model: &Model<Complex64>,
    duration: Complex64,
    settings: &Settings,
) -> Result<Trajectory<Complex64>, IntegrationFailure> {
    march(model, duration, settings)
}

fn march<S: SolveScalar>(
    model: &Model<S>,
    duration: S,
    settings: &Settings,
) -> Result<Trajectory<S>, IntegrationFailure> {
    if !(duration.is_finite() && duration.re() > 0.0) {
        return Err(IntegrationFailure::Duration {
            duration: duration.re(),
        });
    }
    let Method::Bdf { order } = settings.method;
    let numbering = Numbering::new(model);
    let mut saddle = SaddlePoint::new(model, &numbering);
    let start = initial::solve(model, &numbering, &mut saddle)?;
    let h = duration / settings.steps as f64;
    let mut counts = super::trajectory::WorkCounts {
        steps: settings.steps,
        factorisations: saddle.factorisations,
        solves: saddle.factorisations,
        ..Default::default()
    };
    let mut run = Trajectory::start(numbering.clone(), h, settings, start);
    let mut newton = Newton::new(model, &numbering);
    let mut history = History {
        c: S::zero(),
        qdot: vec![S::zero(); numbering.positions()],
        vdot: vec![S::zero(); numbering.velocities()],
    };
    let mut x = Unknowns {
        q: run.q(0).to_vec(),
        v: run.v(0).to_vec(),
        dq: history.qdot.clone(),
        dv: history.vdot.clone(),
        lambda: run.lambda(0).to_vec(),
        mu: run.mu(0).to_vec(),
    };
    let mut increments = Increments(VecDeque::new());
    let mut vdot = history.vdot.clone();
    let mut qdot = history.qdot.clone();
    for k in 1..=settings.steps {
        let b = increment_coefficients(order_of_step(order, k));
        history.c = S::from(b[0]) / h;
        increments.past(&b, h, &mut history);
        increments.predict(&run, k, &mut x);
        newton.solve(&mut x, &history, h, k, &mut counts)?;
        if let Some(open) = redundancy::opened(model, &numbering, &x.q) {
            return Err(IntegrationFailure::RedundancyLost {
                joint: model.joints[open.joint].name.clone(),
                gap: open.gap,
                time: (h * k as f64).re(),
                step: k,
            });
        }
        history.rates(&x.dq, &x.dv, &mut qdot, &mut vdot);
        run.q.extend_from_slice(&x.q);
        run.dq.extend_from_slice(&x.dq);
        run.v.extend_from_slice(&x.v);
        run.a.extend_from_slice(&vdot);
        run.lambda.extend_from_slice(&x.lambda);
        run.mu.extend_from_slice(&x.mu);
        increments.push(&x);
    }
    run.counts = counts;
    Ok(run)
}

/// Coefficients b_0 … b_{m−1} of ẋ_k ≈ (1/h) Σ b_i (x_{k−i} − x_{k−i−1}): the partial sums of
/// [`coefficients`].
pub fn increment_coefficients(order: usize) -> Vec<f64> {
    let mut sum = 0.0;
    let partial = coefficients(order)[..order].iter().map(|a| {
        sum += a;
        sum
    });
    partial.collect()
}

/// The latest increments (of q, of v), newest first.
struct Increments<S>(VecDeque<(Vec<S>, Vec<S>)>);

impl<S: Scalar> Increments<S> {
    /// How many are kept: what cubic extrapolation needs.
    const KEPT: usize = 3;

    fn push(&mut self, x: &Unknowns<S>) {
        let (mut dq, mut dv) = match self.0.len() {
            Self::KEPT => self.0.pop_back().unwrap_or_default(),
            _ => (Vec::new(), Vec::new()),
        };
        dq.clone_from(&x.dq);
        dv.clone_from(&x.dv);
        self.0.push_front((dq, dv));
    }

    /// The part of the rates that earlier increments make.
    fn past(&self, b: &[f64], h: S, history: &mut History<S>) {
        history.qdot.fill(S::zero());
        history.vdot.fill(S::zero());
        for (&b, (dq, dv)) in b[1..].iter().zip(&self.0) {
            let b = S::from(b) / h;
            history
                .qdot
                .iter_mut()
                .zip(dq)
                .for_each(|(out, &d)| *out += b * d);
            history
                .vdot
                .iter_mut()
                .zip(dv)
                .for_each(|(out, &d)| *out += b * d);
        }
    }

    /// Start of Newton's method: cubic extrapolation of q and v and quadratic of λ and μ once
    /// three increments are known, before that a Taylor polynomial with λ and μ held.
    fn predict(&self, run: &Trajectory<S>, k: usize, x: &mut Unknowns<S>) {
        let numbering = &run.numbering;
        let (q, v, a) = (run.q(k - 1), run.v(k - 1), run.a(k - 1));
        x.q.copy_from_slice(q);
        x.v.copy_from_slice(v);
        if let (Some((q1, v1)), Some((q2, v2)), Some((q3, v3))) =
            (self.0.front(), self.0.get(1), self.0.get(2))
        {
            extrapolate(&mut x.dq, [q1, q2, q3]);
            extrapolate(&mut x.dv, [v1, v2, v3]);
            x.q.iter_mut().zip(&x.dq).for_each(|(q, &d)| *q += d);
            bodies::normalise(numbering, &mut x.q, &mut x.dq);
            extrapolate(&mut x.lambda, [1, 2, 3].map(|i| run.lambda(k - i)));
            extrapolate(&mut x.mu, [1, 2, 3].map(|i| run.mu(k - i)));
        } else {
            let h = run.h;
            let step: Vec<S> = v
                .iter()
                .zip(a)
                .map(|(&v, &a)| h * (v + h * a * 0.5))
                .collect();
            x.dq.fill(S::zero());
            bodies::advance(numbering, &mut x.q, &mut x.dq, &step);
            x.dv.iter_mut().zip(a).for_each(|(d, &a)| *d = h * a);
        }
        x.v.iter_mut().zip(&x.dv).for_each(|(v, &d)| *v += d);
    }
}

/// 3 d_1 − 3 d_2 + d_3.
fn extrapolate<S: Scalar>(out: &mut [S], [d1, d2, d3]: [&[S]; 3]) {
    for (j, out) in out.iter_mut().enumerate() {
        *out = (d1[j] - d2[j]) * 3.0 + d3[j];
    }
}
