//! Initial guesses of Newton's method, and their polynomials.

use super::Stage;
use super::radau::Scheme;
use crate::linalg::SolveScalar;
use crate::math::Scalar;
use crate::system::{Numbering, bodies};

/// Largest number of steps whose ends the guess of a formula extrapolates, and the number with which it begins.
pub(super) const RECENT: usize = 8;
const FEW: usize = 3;

/// The history before the next step.
#[derive(Clone, Debug)]
pub(crate) struct Past<S> {
    /// The end of the last step.
    pub(super) from: Stage<S>,
    /// Size of the last step, if it was one of Radau IIA.
    before: Option<S>,
    stages: Vec<Stage<S>>,
    /// Ends of the latest steps, newest first, and their number.
    recent: [Stage<S>; RECENT],
    known: usize,
    /// A tangent step of the positions.
    tangent: Vec<S>,
}

impl<S: SolveScalar> Past<S> {
    /// The history at the first step, which starts at `from`. A step has at most `stages` stages.
    pub(crate) fn new(numbering: &Numbering, from: Stage<S>, stages: usize) -> Self {
        let zero = Stage::zero(numbering);
        Self {
            from,
            before: None,
            stages: vec![zero.clone(); stages],
            recent: std::array::from_fn(|_| zero.clone()),
            known: 0,
            tangent: zero.v,
        }
    }

    /// Moves past a step of size h with the first `count` of the `stages`. `stages` becomes
    /// workspace for the next step.
    pub(crate) fn advance(&mut self, h: S, stages: &mut Vec<Stage<S>>, count: usize) {
        self.from.set(&stages[count - 1]);
        self.recent.rotate_right(1);
        self.recent[0].set(&self.from);
        self.known = (self.known + 1).min(RECENT);
        self.before = (count == stages.len()).then_some(h);
        std::mem::swap(&mut self.stages, stages);
    }

    /// Initial guess of a step of size h of Radau IIA: extrapolation of the stages' polynomial of
    /// the last step. In the first step: a Taylor polynomial.
    pub(crate) fn predict_stages(
        &mut self,
        numbering: &Numbering,
        scheme: &Scheme,
        h: S,
        out: &mut [Stage<S>],
    ) {
        for (&c, far) in scheme.nodes.iter().zip(out) {
            let Some(before) = self.before else {
                self.taylor(numbering, h * c, far);
                continue;
            };
            let theta = 1.0 + c * h.re() / before.re();
            dense(scheme, &self.from, &self.stages, before, theta, far);
            // The polynomial starts at the start of the last step.
            let last = &self.stages[self.stages.len() - 1];
            for (x, d) in [(&mut far.q, &last.dq), (&mut far.dq, &last.dq)] {
                x.iter_mut().zip(d).for_each(|(x, &d)| *x -= d);
            }
            for (x, d) in [(&mut far.v, &last.dv), (&mut far.dv, &last.dv)] {
                x.iter_mut().zip(d).for_each(|(x, &d)| *x -= d);
            }
            bodies::normalise(numbering, &mut far.q, &mut far.dq);
        }
    }

    /// A Taylor polynomial over the time `h`, with constant multipliers.
    pub(crate) fn taylor(&mut self, numbering: &Numbering, h: S, out: &mut Stage<S>) {
        self.go_on(numbering, h, out, S::one());
    }

    /// The motion over the time `h` with constant velocities and multipliers: for light parts, whose
    /// accelerations last much shorter than a step.
    pub(crate) fn coast(&mut self, numbering: &Numbering, h: S, out: &mut Stage<S>) {
        self.go_on(numbering, h, out, S::zero());
    }

    /// Stages of a step of size h of Radau IIA by [`Past::coast`].
    pub(crate) fn coast_stages(
        &mut self,
        numbering: &Numbering,
        scheme: &Scheme,
        h: S,
        out: &mut [Stage<S>],
    ) {
        for (&c, far) in scheme.nodes.iter().zip(out) {
            self.coast(numbering, h * c, far);
        }
    }

    /// The motion over the time `h` with this part of the accelerations.
    fn go_on(&mut self, numbering: &Numbering, h: S, out: &mut Stage<S>, part: S) {
        let from = &self.from;
        out.set(from);
        out.dq.fill(S::zero());
        let rates = from.v.iter().zip(&from.vdot);
        for (step, (&v, &a)) in self.tangent.iter_mut().zip(rates) {
            *step = h * (v + h * (a * part) * 0.5);
        }
        bodies::advance(numbering, &mut out.q, &mut out.dq, &self.tangent);
        for (i, &a) in from.vdot.iter().enumerate() {
            out.dv[i] = h * (a * part);
            out.v[i] += h * (a * part);
        }
    }

    /// Initial guess of a formula with equal steps: extrapolation of the increments of q and v and of λ and μ. Before three
    /// increments are known: a Taylor polynomial.
    pub(crate) fn predict(&mut self, numbering: &Numbering, h: S, out: &mut Stage<S>) {
        if self.known < FEW {
            return self.taylor(numbering, h, out);
        }
        out.set(&self.from);
        let recent = &self.recent[..self.known];
        extrapolate(recent, |stage| &stage.dq, &mut out.dq);
        extrapolate(recent, |stage| &stage.dv, &mut out.dv);
        extrapolate(recent, |stage| &stage.lambda, &mut out.lambda);
        extrapolate(recent, |stage| &stage.mu, &mut out.mu);
        out.q.iter_mut().zip(&out.dq).for_each(|(q, &d)| *q += d);
        out.v.iter_mut().zip(&out.dv).for_each(|(v, &d)| *v += d);
        bodies::normalise(numbering, &mut out.q, &mut out.dq);
    }
}

/// Extrapolates a part x of the recent stages, newest first, by one step.
///
/// The polynomial through k values gives x_0 + ∇x + … + ∇ᵏ⁻¹x = Σ_i (−1)ⁱ C(k, i+1) x_i. Its error in the newest value was
/// ∇ᵏx. The guess takes the k with the smallest sum of squares of it.
fn extrapolate<S: Scalar>(recent: &[Stage<S>], part: fn(&Stage<S>) -> &Vec<S>, out: &mut [S]) {
    let mut errors = [0.0; RECENT];
    for j in 0..out.len() {
        let mut differences = [0.0; RECENT];
        for (x, stage) in differences.iter_mut().zip(recent) {
            *x = part(stage)[j].re();
        }
        for k in 1..recent.len() {
            for i in 0..recent.len() - k {
                differences[i] -= differences[i + 1];
            }
            errors[k] += differences[0] * differences[0];
        }
    }
    let least = |a: &usize, b: &usize| errors[*a].total_cmp(&errors[*b]);
    let count = (1..recent.len()).min_by(least).unwrap_or(1);
    let mut weight = 1.0;
    out.fill(S::zero());
    for (i, stage) in recent[..count].iter().enumerate() {
        weight *= -((count - i) as f64) / (i + 1) as f64;
        for (out, &x) in out.iter_mut().zip(part(stage)) {
            *out -= x * weight;
        }
    }
}

/// The collocation polynomial at the fraction θ of a step of size h (beyond the step for θ > 1):
/// positions before their Euler parameters are normalised, velocities, accelerations, multipliers.
pub(crate) fn dense<S: SolveScalar>(
    scheme: &Scheme,
    from: &Stage<S>,
    stages: &[Stage<S>],
    h: S,
    theta: f64,
    out: &mut Stage<S>,
) {
    let (w, rate) = scheme.dense_weights(theta);
    let plain = scheme.stage_weights(theta);
    out.set(from);
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
}
