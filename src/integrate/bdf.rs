//! Backward differentiation formulas of constant step, with the start-up of increasing order.

use super::failure::IntegrationFailure;
use super::newton::{History, Newton, Unknowns};
use super::settings::{Method, Settings};
use super::trajectory::Trajectory;
use crate::linalg::SolveScalar;
use crate::math::{Complex64, Scalar};
use crate::model::Model;
use crate::system::kkt::SaddlePoint;
use crate::system::{Numbering, bodies, initial};

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
        lambda: run.lambda(0).to_vec(),
        mu: run.mu(0).to_vec(),
    };
    let mut vdot = vec![S::zero(); numbering.velocities()];
    for k in 1..=settings.steps {
        let a = coefficients(order_of_step(order, k));
        history.c = S::from(a[0]) / h;
        past(&mut history.qdot, &run.q, a, h);
        past(&mut history.vdot, &run.v, a, h);
        predict(&run, k, &mut x);
        newton.solve(&mut x, &history, h, k, &mut counts)?;
        for (out, (&v, &past)) in vdot.iter_mut().zip(x.v.iter().zip(&history.vdot)) {
            *out = history.c * v + past;
        }
        run.q.extend_from_slice(&x.q);
        run.v.extend_from_slice(&x.v);
        run.a.extend_from_slice(&vdot);
        run.lambda.extend_from_slice(&x.lambda);
        run.mu.extend_from_slice(&x.mu);
    }
    run.counts = counts;
    Ok(run)
}

/// (1/h) Σ_{i≥1} a_i x_{k−i}; the last rows of `all` are x_{k−1}, x_{k−2}, …
fn past<S: Scalar>(out: &mut [S], all: &[S], a: &[f64], h: S) {
    let n = out.len();
    for (j, out) in out.iter_mut().enumerate() {
        let mut sum = S::zero();
        for (i, &a) in a.iter().enumerate().skip(1) {
            sum += all[all.len() - i * n + j] * a;
        }
        *out = sum / h;
    }
}

/// Start of Newton's method: cubic extrapolation of q and v once four instants are known, before
/// that a Taylor polynomial; λ and μ are held.
fn predict<S: Scalar>(run: &Trajectory<S>, k: usize, x: &mut Unknowns<S>) {
    let numbering = &run.numbering;
    if k >= 4 {
        extrapolate(&mut x.q, &run.q);
        extrapolate(&mut x.v, &run.v);
        // Brings the extrapolated Euler parameters back to unit length.
        let still = vec![S::zero(); numbering.velocities()];
        bodies::retract(numbering, &mut x.q, &still);
        return;
    }
    let (h, v, a) = (run.h, run.v(k - 1), run.a(k - 1));
    let mut step = vec![S::zero(); v.len()];
    for i in 0..v.len() {
        step[i] = h * (v[i] + h * a[i] * 0.5);
        x.v[i] = v[i] + h * a[i];
    }
    x.q.copy_from_slice(run.q(k - 1));
    bodies::retract(numbering, &mut x.q, &step);
}

/// 4 x_{k−1} − 6 x_{k−2} + 4 x_{k−3} − x_{k−4}.
fn extrapolate<S: Scalar>(out: &mut [S], all: &[S]) {
    let n = out.len();
    let last = all.len() - n;
    for (j, out) in out.iter_mut().enumerate() {
        let at = |i: usize| all[last + j - i * n];
        *out = (at(0) + at(2)) * 4.0 - at(1) * 6.0 - at(3);
    }
}
