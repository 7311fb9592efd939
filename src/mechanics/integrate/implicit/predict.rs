//! Initial guesses of Newton's method, and their polynomials.

use super::Stage;
use super::radau::Scheme;
use crate::integrate::settings::Method;
use crate::linalg::SolveScalar;
use crate::math::Scalar;
use crate::math::slices::add_scaled;
use crate::system::{Numbering, bodies};

/// Largest number of steps that the guess of a formula extrapolates, and the number with which it begins.
const RECENT: usize = 8;
const FEW: usize = 3;

/// Number of steps that a method keeps for its guesses.
pub(super) fn recent(method: Method) -> usize {
    match method {
        Method::Radau { .. } => 0,
        Method::Dop853 | Method::Bdf { .. } | Method::GeneralisedAlpha { .. } => RECENT,
    }
}

/// What the guess of a formula extrapolates: the increments of a step, and the multipliers at its end.
#[derive(Clone, Debug)]
struct Recent<S> {
    dq: Vec<S>,
    dv: Vec<S>,
    lambda: Vec<S>,
    mu: Vec<S>,
}

impl<S: Scalar> Recent<S> {
    fn of(stage: &Stage<S>) -> Self {
        Self {
            dq: stage.dq.clone(),
            dv: stage.dv.clone(),
            lambda: stage.lambda.clone(),
            mu: stage.mu.clone(),
        }
    }

    fn set(&mut self, stage: &Stage<S>) {
        self.dq.copy_from_slice(&stage.dq);
        self.dv.copy_from_slice(&stage.dv);
        self.lambda.copy_from_slice(&stage.lambda);
        self.mu.copy_from_slice(&stage.mu);
    }
}

/// The history before the next step.
#[derive(Clone, Debug)]
pub struct Past<S> {
    /// The end of the last step.
    pub(super) from: Stage<S>,
    /// Size of the last step, if it was one of Radau IIA.
    before: Option<S>,
    stages: Vec<Stage<S>>,
    /// The latest steps, newest first, and their number; none for Radau IIA.
    recent: Vec<Recent<S>>,
    known: usize,
    /// A tangent step of the positions.
    tangent: Vec<S>,
}

impl<S: SolveScalar> Past<S> {
    /// The history of a method at the first step, which starts at `from`. A step has at most `stages` stages.
    pub fn new(numbering: &Numbering, from: Stage<S>, (method, stages): (Method, usize)) -> Self {
        let zero = Stage::zero(numbering);
        Self {
            from,
            before: None,
            stages: vec![zero.clone(); stages],
            recent: vec![Recent::of(&zero); recent(method)],
            known: 0,
            tangent: zero.v,
        }
    }

    /// Forgets the increments of earlier steps, whose size may differ from that of the next one.
    pub fn forget_increments(&mut self) {
        self.known = 0;
    }

    /// Moves past a step of size h with the first `count` of the `stages`. `stages` becomes
    /// workspace for the next step.
    pub fn advance(&mut self, h: S, stages: &mut Vec<Stage<S>>, count: usize) {
        self.from.set(&stages[count - 1]);
        if let Some(oldest) = self.recent.last_mut() {
            oldest.set(&self.from);
            self.recent.rotate_right(1);
            self.known = (self.known + 1).min(RECENT);
        }
        self.before = (count == stages.len()).then_some(h);
        std::mem::swap(&mut self.stages, stages);
    }

    /// Initial guess of a step of size h of Radau IIA: extrapolation of the stages' polynomial of
    /// the last step. In the first step: a Taylor polynomial.
    pub fn predict_stages(
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
    pub fn taylor(&mut self, numbering: &Numbering, h: S, out: &mut Stage<S>) {
        self.go_on(numbering, h, out, S::one());
    }

    /// The motion over the time `h` with constant velocities and multipliers: for light parts, whose
    /// accelerations last much shorter than a step.
    pub fn coast(&mut self, numbering: &Numbering, h: S, out: &mut Stage<S>) {
        self.go_on(numbering, h, out, S::zero());
    }

    /// Stages of a step of size h of Radau IIA by [`Past::coast`].
    pub fn coast_stages(
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
    pub fn predict(&mut self, numbering: &Numbering, h: S, out: &mut Stage<S>) {
        if self.known < FEW {
            return self.taylor(numbering, h, out);
        }
        out.set(&self.from);
        let recent = &self.recent;
        let go_on = |part: fn(&Recent<S>) -> &Vec<S>, out: &mut [S]| {
            let all: [&[S]; RECENT] = std::array::from_fn(|i| &part(&recent[i])[..]);
            extrapolate(&all[..self.known], out);
        };
        go_on(|recent| &recent.dq, &mut out.dq);
        go_on(|recent| &recent.dv, &mut out.dv);
        go_on(|recent| &recent.lambda, &mut out.lambda);
        go_on(|recent| &recent.mu, &mut out.mu);
        out.q.iter_mut().zip(&out.dq).for_each(|(q, &d)| *q += d);
        out.v.iter_mut().zip(&out.dv).for_each(|(v, &d)| *v += d);
        bodies::normalise(numbering, &mut out.q, &mut out.dq);
    }
}

/// Extrapolates vectors x_i at equal steps, newest first, by one step.
///
/// The polynomial through k of them gives x_0 + ∇x + … + ∇ᵏ⁻¹x = Σ_i (−1)ⁱ C(k, i+1) x_i. Its error in the newest one
/// was ∇ᵏx. The k with the smallest sum of squares of it is taken, below the number of vectors.
fn extrapolate<S: Scalar>(recent: &[&[S]], out: &mut [S]) {
    let mut errors = [0.0; RECENT];
    for j in 0..out.len() {
        let mut differences = [0.0; RECENT];
        for (difference, x) in differences.iter_mut().zip(recent) {
            *difference = x[j].re();
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
    let mut weight = -1.0;
    out.fill(S::zero());
    for (i, x) in recent[..count].iter().enumerate() {
        weight *= -((count - i) as f64) / (i + 1) as f64;
        add_scaled(out, S::from(weight), x);
    }
}

/// The collocation polynomial at the fraction θ of a step of size h (beyond the step for θ > 1):
/// positions before their Euler parameters are normalised, velocities, accelerations, multipliers.
pub fn dense<S: SolveScalar>(
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

#[cfg(test)]
mod tests {
    use super::*;

    /// The increments of a cubic are a parabola, and extrapolated exactly. Those that alternate are best
    /// extrapolated by the last one of all guesses, the polynomial through one value.
    #[test]
    fn extrapolation_takes_the_best_polynomial() {
        let next = |x: &dyn Fn(f64) -> f64, count: usize| {
            let values: Vec<[f64; 1]> = (1..=count).map(|i| [x(-(i as f64))]).collect();
            let recent: Vec<&[f64]> = values.iter().map(|x| &x[..]).collect();
            let mut out = [0.0];
            extrapolate(&recent, &mut out);
            out[0]
        };
        let parabola = |t: f64| 2.0 - 0.5 * t + 0.25 * t * t;
        for count in 4..=RECENT {
            assert!((next(&parabola, count) - 2.0).abs() < 1e-13);
        }
        assert_eq!(next(&|t: f64| (t.abs() % 2.0) * 2.0 - 1.0, RECENT), 1.0);
    }
}
