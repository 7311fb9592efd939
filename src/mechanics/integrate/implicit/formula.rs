//! One-stage formulas with a memory: backward differentiation and generalised-α.
//!
//! Let Δ = y_k − y_{k−1} be the increment and m_j memory vectors of the size of increments. Then
//!
//! ```text
//! h ẏ_k = c Δ + Σ_j e_j m_j,        m_i' = f_i Δ + Σ_j F_ij m_j
//! ```
//!
//! With increments instead of values, rates have no round-off of values divided by the step, and
//! one backward march suffices for all formulas.

use super::Stage;
use crate::integrate::settings::{Method, Start};
use crate::math::Scalar;
use crate::system::Numbering;

/// Largest number of memory vectors of a formula.
const MOST: usize = 5;

/// Coefficients of a step; they do not depend on its size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Formula {
    /// c.
    pub lead: f64,
    /// Number m of memory vectors.
    slots: usize,
    past: [f64; MOST],
    memory: [(f64, [f64; MOST]); MOST],
}

impl Formula {
    /// Backward differentiation of order m: h ẏ = Σ_{j=1..m} ∇ʲy / j (Gear 1971), with
    /// ∇ʲy = Σ_l (−1)ˡ C(j−1, l) Δ_{k−l}. The memory has `kept` − 1 earlier increments.
    fn bdf(order: usize, kept: usize) -> Self {
        let weight = |l: usize| -> f64 {
            let sign = if l.is_multiple_of(2) { 1.0 } else { -1.0 };
            (l + 1..=order)
                .map(|j| sign * binomial(j - 1, l) / j as f64)
                .sum()
        };
        let slots = kept - 1;
        let shifted = |i: usize| {
            let mut row = [0.0; MOST];
            if i > 0 {
                row[i - 1] = 1.0;
            }
            (if i == 0 { 1.0 } else { 0.0 }, row)
        };
        // Beyond the order the weights are empty sums.
        Self {
            lead: weight(0),
            slots,
            past: std::array::from_fn(|j| weight(j + 1)),
            memory: std::array::from_fn(shifted),
        }
    }

    /// Generalised-α with spectral radius ρ∞ (Jansen, Whiting & Hulbert 2000). The equations hold
    /// at the step's end, as in Arnold & Brüls (2007). The memory is h times the algorithmic rates
    /// w and the rates ẏ:
    ///
    /// ```text
    /// Δ = h (1−γ) w + h γ w',     (1−α_m) w' + α_m w = (1−α_f) ẏ' + α_f ẏ
    /// α_m = (3ρ∞ − 1) / (2 (ρ∞ + 1)),     α_f = ρ∞ / (ρ∞ + 1),     γ = ½ + α_f − α_m
    /// ```
    fn generalised_alpha(radius: f64) -> Self {
        let alpha_m = (3.0 * radius - 1.0) / (2.0 * (radius + 1.0));
        let alpha_f = radius / (radius + 1.0);
        let gamma = 0.5 + alpha_f - alpha_m;
        let keep = -(1.0 - gamma) / gamma;
        let lead = (1.0 - alpha_m) / ((1.0 - alpha_f) * gamma);
        let mut past = [0.0; MOST];
        past[0] = ((1.0 - alpha_m) * keep + alpha_m) / (1.0 - alpha_f);
        past[1] = -alpha_f / (1.0 - alpha_f);
        let mut first = [0.0; MOST];
        first[0] = keep;
        let mut memory = [(0.0, [0.0; MOST]); MOST];
        memory[0] = (1.0 / gamma, first);
        memory[1] = (lead, past);
        Self {
            lead,
            slots: 2,
            past,
            memory,
        }
    }

    /// e_j.
    pub fn past(&self) -> &[f64] {
        &self.past[..self.slots]
    }

    /// (f_i, F_i1 … F_im) for each memory vector; the other entries of a row are zero.
    pub fn memory(&self) -> &[(f64, [f64; MOST])] {
        &self.memory[..self.slots]
    }

    /// Updates component k of the memory after a step with the increment `delta`.
    pub fn remember<S: Scalar>(&self, delta: S, memory: &mut [Vec<S>], k: usize) {
        let mut old = [S::zero(); MOST];
        for (old, m) in old.iter_mut().zip(&*memory) {
            *old = m[k];
        }
        for ((f, row), m) in self.memory().iter().zip(memory) {
            let terms = row.iter().zip(&old).filter(|(f, _)| **f != 0.0);
            m[k] = terms.fold(delta * *f, |sum, (&f, &m)| sum + m * f);
        }
    }

    /// The transpose of [`Formula::remember`] and of the rates: replaces component k of the
    /// cotangents of the memory after the step by that before it. `rate` is the cotangent of h
    /// times the rates.
    pub fn recall(&self, rate: f64, memory: &mut [Vec<f64>], k: usize) {
        let mut later = [0.0; MOST];
        for (later, m) in later.iter_mut().zip(&*memory) {
            *later = m[k];
        }
        for (j, m) in memory.iter_mut().enumerate() {
            let terms = self.memory().iter().zip(&later);
            m[k] = terms.fold(self.past[j] * rate, |sum, ((_, row), later)| {
                sum + row[j] * later
            });
        }
    }

    /// The formula of step k ≥ 1 of a method; `None` if Radau IIA makes the step.
    pub fn of_step(method: Method, k: usize) -> Option<Self> {
        match method {
            Method::Dop853 | Method::Radau { .. } => None,
            Method::Bdf { order, start } => match start {
                Start::Radau if k < order => None,
                Start::Radau => Some(Self::bdf(order, order)),
                Start::RisingOrder => Some(Self::bdf(order.min(k), order)),
            },
            Method::GeneralisedAlpha { radius } => Some(Self::generalised_alpha(radius)),
        }
    }
}

/// Number of memory vectors of a method.
pub fn memory_size(method: Method) -> usize {
    match method {
        Method::Dop853 | Method::Radau { .. } => 0,
        Method::Bdf { order, .. } => order - 1,
        Method::GeneralisedAlpha { .. } => 2,
    }
}

/// Whether the memory starts with h times the initial rates (otherwise it starts empty).
pub fn remembers_start(method: Method) -> bool {
    matches!(method, Method::GeneralisedAlpha { .. })
}

fn binomial(n: usize, k: usize) -> f64 {
    (0..k).fold(1.0, |product, i| product * (n - i) as f64 / (i + 1) as f64)
}

/// Rates as functions of the increments in this step: q̇ = c dq + `qdot`, v̇ = c dv + `vdot`.
#[derive(Clone, Debug)]
pub struct History<S> {
    /// c, the formula's lead coefficient divided by h.
    pub c: S,
    /// Part of q̇ from the memory.
    pub qdot: Vec<S>,
    /// Part of v̇ from the memory.
    pub vdot: Vec<S>,
}

impl<S: Scalar> History<S> {
    /// A history without memory.
    pub fn new(numbering: &Numbering) -> Self {
        Self {
            c: S::zero(),
            qdot: vec![S::zero(); numbering.positions()],
            vdot: vec![S::zero(); numbering.velocities()],
        }
    }

    /// Sets the history of a formula in a step of size h, from its memory of q and of v:
    /// h ẏ = c Δ + Σ e_j m_j.
    pub fn set(&mut self, formula: &Formula, memory: &[Vec<Vec<S>>; 2], h: S) {
        self.c = S::from(formula.lead) / h;
        for (rates, memory) in [&mut self.qdot, &mut self.vdot].into_iter().zip(memory) {
            rates.fill(S::zero());
            for (e, m) in formula.past().iter().zip(memory) {
                let e = S::from(*e) / h;
                rates.iter_mut().zip(m).for_each(|(out, &m)| *out += e * m);
            }
        }
    }

    /// Sets q̇ and v̇ from the increments.
    pub(super) fn rates(&self, x: &mut Stage<S>) {
        for (out, (&d, &past)) in x.qdot.iter_mut().zip(x.dq.iter().zip(&self.qdot)) {
            *out = self.c * d + past;
        }
        for (out, (&d, &past)) in x.vdot.iter_mut().zip(x.dv.iter().zip(&self.vdot)) {
            *out = self.c * d + past;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bdf_coefficients_are_the_known_ones() {
        let bdf = |order| Formula::bdf(order, order);
        assert_eq!(bdf(1).lead, 1.0);
        assert_eq!((bdf(2).lead, bdf(2).past()), (1.5, &[-0.5][..]));
        assert!((bdf(3).lead - 11.0 / 6.0).abs() < 1e-15);
        // BDF6 in values begins 147/60, −360/60, 450/60.
        let six = bdf(6);
        assert!((six.lead - 147.0 / 60.0).abs() < 1e-14);
        assert!((six.past[0] - six.lead + 360.0 / 60.0).abs() < 1e-13);
        assert!((six.past[1] - six.past[0] - 450.0 / 60.0).abs() < 1e-13);
    }

    /// Polynomials of the formula's order are differentiated exactly.
    #[test]
    fn formulas_are_exact_for_polynomials() {
        for order in 1..=6 {
            let formula = Formula::bdf(order, order);
            let y = |t: f64| t.powi(order as i32);
            let t = 3.0;
            let delta = |l: usize| y(t - l as f64) - y(t - l as f64 - 1.0);
            let past: f64 = (1..order).map(|l| formula.past[l - 1] * delta(l)).sum();
            let rate = formula.lead * delta(0) + past;
            let exact = order as f64 * t.powi(order as i32 - 1);
            assert!((rate - exact).abs() < 1e-10 * exact, "order {order}");
        }
        let formula = Formula::generalised_alpha(0.8);
        // y = t: exact if the memory holds exact rates.
        let rate = formula.lead + formula.past().iter().sum::<f64>();
        assert!((rate - 1.0).abs() < 1e-15);
    }
}
