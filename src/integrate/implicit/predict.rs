//! Where Newton's method starts in a step, and the polynomials that say so.

use super::Stage;
use super::radau::Scheme;
use crate::linalg::SolveScalar;
use crate::system::{Numbering, bodies};
use std::collections::VecDeque;

/// The end of the last step, that step's size and stages, and the ends of the latest steps, newest
/// first, for a formula.
pub(super) struct Past<S> {
    pub from: Stage<S>,
    pub before: Option<(S, Vec<Stage<S>>)>,
    pub recent: VecDeque<Stage<S>>,
}

/// The collocation polynomial at the fraction θ of a step of size h (beyond the step for θ > 1):
/// positions before their Euler parameters are brought to unit length, velocities, accelerations
/// and multipliers.
pub fn dense<S: SolveScalar>(
    scheme: &Scheme,
    from: &Stage<S>,
    stages: &[Stage<S>],
    h: S,
    theta: f64,
) -> Stage<S> {
    let (w, rate) = scheme.dense_weights(theta);
    let plain = scheme.stage_weights(theta);
    let mut out = from.clone();
    for x in [
        &mut out.lambda,
        &mut out.mu,
        &mut out.vdot,
        &mut out.dq,
        &mut out.dv,
    ] {
        x.fill(S::zero());
    }
    for (i, stage) in stages.iter().enumerate() {
        let add = |out: &mut [S], weight: S, x: &[S]| {
            out.iter_mut()
                .zip(x)
                .for_each(|(out, &x)| *out += weight * x);
        };
        add(&mut out.q, S::from(w[i]), &stage.dq);
        add(&mut out.dq, S::from(w[i]), &stage.dq);
        add(&mut out.v, S::from(w[i]), &stage.dv);
        add(&mut out.dv, S::from(w[i]), &stage.dv);
        add(&mut out.vdot, S::from(rate[i]) / h, &stage.dv);
        add(&mut out.lambda, S::from(plain[i]), &stage.lambda);
        add(&mut out.mu, S::from(plain[i]), &stage.mu);
    }
    out
}

/// Where Newton's method starts: the stages' polynomial of the last step, extrapolated; in the
/// first step a Taylor polynomial.
pub(super) fn predict_stages<S: SolveScalar>(
    numbering: &Numbering,
    scheme: &Scheme,
    past: &Past<S>,
    h: S,
) -> Vec<Stage<S>> {
    let known = past.before.as_ref();
    let stage = |&c: &f64| match known.filter(|(_, stages)| stages.len() == scheme.stages()) {
        Some((before, stages)) => {
            let theta = 1.0 + c * h.re() / before.re();
            let last = &stages[stages.len() - 1];
            let mut far = dense(scheme, &past.from, stages, *before, theta);
            // The polynomial starts where the last step did.
            for (x, d) in [(&mut far.q, &last.dq), (&mut far.dq, &last.dq)] {
                x.iter_mut().zip(d).for_each(|(x, &d)| *x -= d);
            }
            for (x, d) in [(&mut far.v, &last.dv), (&mut far.dv, &last.dv)] {
                x.iter_mut().zip(d).for_each(|(x, &d)| *x -= d);
            }
            bodies::normalise(numbering, &mut far.q, &mut far.dq);
            far
        }
        None => taylor(numbering, &past.from, h * c),
    };
    scheme.nodes.iter().map(stage).collect()
}

/// A Taylor polynomial over the time `h`, multipliers held.
pub(super) fn taylor<S: SolveScalar>(numbering: &Numbering, from: &Stage<S>, h: S) -> Stage<S> {
    let mut out = from.clone();
    out.dq.fill(S::zero());
    let step: Vec<S> = (from.v.iter().zip(&from.vdot))
        .map(|(&v, &a)| h * (v + h * a * 0.5))
        .collect();
    bodies::advance(numbering, &mut out.q, &mut out.dq, &step);
    for (i, &a) in from.vdot.iter().enumerate() {
        out.dv[i] = h * a;
        out.v[i] += h * a;
    }
    out
}

/// Where Newton's method starts for a formula of equal steps: cubic extrapolation of q and v and
/// quadratic of λ and μ once three increments are known, before that a Taylor polynomial.
pub(super) fn predict<S: SolveScalar>(numbering: &Numbering, past: &Past<S>, h: S) -> Stage<S> {
    let (Some(one), Some(two), Some(three)) =
        (past.recent.front(), past.recent.get(1), past.recent.get(2))
    else {
        return taylor(numbering, &past.from, h);
    };
    let mut out = past.from.clone();
    let extrapolate = |out: &mut [S], pick: fn(&Stage<S>) -> &Vec<S>| {
        for (j, out) in out.iter_mut().enumerate() {
            *out = (pick(one)[j] - pick(two)[j]) * 3.0 + pick(three)[j];
        }
    };
    extrapolate(&mut out.dq, |stage| &stage.dq);
    extrapolate(&mut out.dv, |stage| &stage.dv);
    extrapolate(&mut out.lambda, |stage| &stage.lambda);
    extrapolate(&mut out.mu, |stage| &stage.mu);
    out.q.iter_mut().zip(&out.dq).for_each(|(q, &d)| *q += d);
    out.v.iter_mut().zip(&out.dv).for_each(|(v, &d)| *v += d);
    bodies::normalise(numbering, &mut out.q, &mut out.dq);
    out
}
