//! What a run leaves behind.

use super::settings::{Method, Settings};
use crate::math::{Complex64, Scalar};
use crate::system::Numbering;
use crate::system::initial::InitialState;

/// Work of a run, in counts that do not depend on the machine.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct WorkCounts {
    /// Time steps.
    pub steps: usize,
    /// Newton iterations.
    pub newton_iterations: usize,
    /// Iteration matrices assembled and factorised.
    pub factorisations: usize,
    /// Linear systems solved.
    pub solves: usize,
}

impl std::ops::AddAssign for WorkCounts {
    fn add_assign(&mut self, other: Self) {
        self.steps += other.steps;
        self.newton_iterations += other.newton_iterations;
        self.factorisations += other.factorisations;
        self.solves += other.solves;
    }
}

/// States at the ends of all steps, t_k = k h, k = 0 … N.
#[derive(Clone, Debug)]
pub struct Trajectory<S> {
    /// Numbering of the states.
    pub numbering: Numbering,
    /// Step size h = T / N (s).
    pub h: S,
    /// Number of steps N.
    pub steps: usize,
    /// The method that made it.
    pub method: Method,
    /// Positions, one row of `numbering.positions()` an instant.
    pub q: Vec<S>,
    /// Increments of the positions in steps 1 … N, one row of `numbering.positions()` a step,
    /// accurate to their own size.
    pub dq: Vec<S>,
    /// Velocities, one row of `numbering.velocities()` an instant.
    pub v: Vec<S>,
    /// Accelerations v̇ as the method sees them.
    pub a: Vec<S>,
    /// Multipliers λ of the constraints.
    pub lambda: Vec<S>,
    /// Multipliers μ of the velocity constraints (zero at t = 0).
    pub mu: Vec<S>,
    /// The consistent start.
    pub initial: InitialState<S>,
    /// Work spent.
    pub counts: WorkCounts,
}

impl<S: Scalar> Trajectory<S> {
    /// A trajectory that holds its start only.
    pub fn start(
        numbering: Numbering,
        h: S,
        settings: &Settings,
        initial: InitialState<S>,
    ) -> Self {
        let steps = settings.steps;
        let room = |first: &[S]| {
            let mut all = Vec::with_capacity(first.len() * (steps + 1));
            all.extend_from_slice(first);
            all
        };
        Self {
            h,
            steps,
            method: settings.method,
            dq: Vec::with_capacity(initial.q.len() * steps),
            q: room(&initial.q),
            v: room(&initial.v),
            a: room(&initial.a),
            lambda: room(&initial.lambda),
            mu: room(&vec![S::zero(); numbering.constraints()]),
            numbering,
            initial,
            counts: WorkCounts {
                steps,
                ..WorkCounts::default()
            },
        }
    }

    /// Time t_k (s).
    pub fn time(&self, k: usize) -> S {
        self.h * k as f64
    }

    /// Positions at t_k.
    pub fn q(&self, k: usize) -> &[S] {
        row(&self.q, self.numbering.positions(), k)
    }

    /// Increment q_k − q_{k−1} of step k ≥ 1.
    pub fn dq(&self, k: usize) -> &[S] {
        row(&self.dq, self.numbering.positions(), k - 1)
    }

    /// Velocities at t_k.
    pub fn v(&self, k: usize) -> &[S] {
        row(&self.v, self.numbering.velocities(), k)
    }

    /// Accelerations at t_k.
    pub fn a(&self, k: usize) -> &[S] {
        row(&self.a, self.numbering.velocities(), k)
    }

    /// Multipliers λ at t_k.
    pub fn lambda(&self, k: usize) -> &[S] {
        row(&self.lambda, self.numbering.constraints(), k)
    }

    /// Multipliers μ at t_k.
    pub fn mu(&self, k: usize) -> &[S] {
        row(&self.mu, self.numbering.constraints(), k)
    }

    /// Weight of instant k in the trapezoidal rule on [0, 1].
    pub fn quadrature_weight(&self, k: usize) -> f64 {
        let end = k == 0 || k == self.steps;
        (if end { 0.5 } else { 1.0 }) / self.steps as f64
    }
}

impl Trajectory<Complex64> {
    /// The real part of a complex run.
    pub fn real(&self) -> Trajectory<f64> {
        let re = |all: &[Complex64]| all.iter().map(|x| x.re).collect();
        Trajectory {
            numbering: self.numbering.clone(),
            h: self.h.re,
            steps: self.steps,
            method: self.method,
            q: re(&self.q),
            dq: re(&self.dq),
            v: re(&self.v),
            a: re(&self.a),
            lambda: re(&self.lambda),
            mu: re(&self.mu),
            initial: InitialState {
                q: re(&self.initial.q),
                v: re(&self.initial.v),
                a: re(&self.initial.a),
                lambda: re(&self.initial.lambda),
                s: re(&self.initial.s),
                sigma: re(&self.initial.sigma),
                iterations: self.initial.iterations,
            },
            counts: self.counts,
        }
    }
}

fn row<S>(all: &[S], width: usize, k: usize) -> &[S] {
    &all[k * width..(k + 1) * width]
}
