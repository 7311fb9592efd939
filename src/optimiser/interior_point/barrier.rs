//! Choice of the barrier parameter.

use crate::interior_point::direction::{Direction, NewtonSystem};
use crate::interior_point::iterate::{Iterate, Layout};
use crate::linear::quasi_newton::QuasiNewton;
use crate::options::{Barrier, Options};

/// A barrier subproblem is solved when its residual is below this multiple of μ (Wächter & Biegler 2006,
/// eq. 7).
const SUBPROBLEM: f64 = 10.0;
/// Superlinear decrease μ ← min(0.2 μ, μ^1.5) of the monotone rule
/// (eq. 8, there with a range of values).
const LINEAR: f64 = 0.2;
const POWER: f64 = 1.5;
/// Residuals kept for the progress test of the adaptive rule. The newest must be below the largest.
/// With two instead of six, the bed takes 3 % more evaluations.
const HISTORY: usize = 6;

/// The adaptive μ is at least this part of the residual of the conditions, as far as that is below
/// one: a smaller μ lets the iterates run into the bounds. Ten times more costs 4 %.
const FLOOR: f64 = 1e-5;

/// State of the rule.
#[derive(Clone, Debug)]
pub(crate) struct BarrierRule {
    pub mu: f64,
    least: f64,
    /// Whether the next iteration has the μ of the user.
    given: bool,
    /// Whether μ is chosen anew at each iteration.
    free: bool,
    /// Whether the adaptive rule may return after the monotone rule took over. It returns once: a
    /// trebuchet with a flexible arm takes 44 simulations without that, 37 with it, and without a limit
    /// two problems of the bed are lost.
    may_return: bool,
    history: Vec<f64>,
}

impl BarrierRule {
    pub(crate) fn new(options: &Options) -> BarrierRule {
        BarrierRule {
            mu: options.first_barrier(),
            given: options.initial_barrier.is_some(),
            least: 1e-6 * options.tolerance,
            free: options.barrier == Barrier::Adaptive,
            may_return: options.barrier == Barrier::Adaptive,
            history: Vec::new(),
        }
    }

    /// μ_min.
    pub(crate) fn least(&self) -> f64 {
        self.least
    }

    /// Whether μ can fall no further.
    pub(crate) fn is_least(&self) -> bool {
        self.mu <= self.least
    }

    /// Updates μ for the iteration that starts at `at`; returns whether it changed.
    pub(crate) fn update(&mut self, at: &Iterate, layout: &Layout, b: &mut QuasiNewton) -> bool {
        let before = self.mu;
        if at.products(layout).is_empty() {
            self.mu = self.least;
            return before != self.mu;
        }
        if std::mem::take(&mut self.given) {
            return false;
        }
        if self.free {
            self.choose(at, layout, b);
        } else {
            self.lower(at, layout);
        }
        before != self.mu
    }

    /// Monotone rule: lowers μ while its subproblem is solved.
    fn lower(&mut self, at: &Iterate, layout: &Layout) {
        while self.mu > self.least && at.residual(layout, self.mu) <= SUBPROBLEM * self.mu {
            if std::mem::take(&mut self.may_return) {
                self.free = true;
                self.history.clear();
            }
            self.mu = (LINEAR * self.mu).min(self.mu.powf(POWER)).max(self.least);
        }
    }

    /// Adaptive rule: chooses μ from the longest step towards μ = 0 (Mehrotra's probe). If the
    /// residual has not fallen, the monotone rule takes over (Nocedal, Wächter & Waltz 2009).
    fn choose(&mut self, at: &Iterate, layout: &Layout, b: &mut QuasiNewton) {
        let error = at.residual(layout, 0.0);
        let worst = self.history.iter().copied().fold(0.0, f64::max);
        let average = average(&at.products(layout));
        if self.history.len() == HISTORY && error >= worst {
            self.free = false;
            self.mu = (0.8 * average).max(self.least);
            return;
        }
        if self.history.len() == HISTORY {
            self.history.remove(0);
        }
        self.history.push(error);
        let centring =
            match NewtonSystem::new(at, layout, b, nalgebra::DVector::zeros(layout.len())) {
                Some(system) => {
                    let r = layout.residual(&at.point.c, &at.s);
                    let probe = system.step(at, layout, b, 0.0, &r);
                    (probed(at, layout, &probe) / average)
                        .powi(3)
                        .clamp(1e-6, 1.0)
                }
                None => LINEAR,
            };
        let floor = (FLOOR * error.min(1.0)).max(self.least);
        self.mu = (centring * average).max(floor);
    }
}

fn average(products: &[f64]) -> f64 {
    products.iter().sum::<f64>() / products.len() as f64
}

/// Average complementarity after the longest step along `probe`.
fn probed(at: &Iterate, layout: &Layout, probe: &Direction) -> f64 {
    let primal = probe.primal_limit(at, layout, 1.0);
    let dual = probe.dual_limit(at, 1.0);
    let mut moved = at.clone();
    moved.point.x += &probe.x * primal;
    moved.s += &probe.s * primal;
    moved.zl += &probe.zl * dual;
    moved.zu += &probe.zu * dual;
    average(&moved.products(layout)).max(0.0)
}
