//! Implicit methods on the GGL-stabilised equations: Radau IIA, and one-stage formulas with a
//! memory (BDF, generalised-α).

pub mod formula;
pub mod ggl;
pub mod march;
pub mod newton;
pub mod predict;
pub mod radau;
mod scales;
pub mod stage_newton;

use crate::math::{Complex64, Scalar};
use crate::system::{Numbering, bodies, reduce};
use ggl::Instant;

/// State at a stage with its multipliers, rates and its increments since the start of the step.
#[derive(Clone, Debug)]
pub struct Stage<S> {
    /// Positions.
    pub q: Vec<S>,
    /// Velocities.
    pub v: Vec<S>,
    /// Increment of q since the start of the step. Rates are made from increments, so that they do
    /// not carry the round-off of positions divided by the step.
    pub dq: Vec<S>,
    /// Increment of v likewise.
    pub dv: Vec<S>,
    /// Multipliers λ.
    pub lambda: Vec<S>,
    /// Multipliers μ.
    pub mu: Vec<S>,
    /// Rates q̇.
    pub qdot: Vec<S>,
    /// Rates v̇.
    pub vdot: Vec<S>,
    /// Time (s).
    pub time: S,
}

impl<S: Scalar> Stage<S> {
    /// All zero.
    pub fn zero(numbering: &Numbering) -> Self {
        let zeros = |n: usize| vec![S::zero(); n];
        let (nq, nv) = (numbering.positions(), numbering.velocities());
        let nc = numbering.constraints();
        Self {
            q: zeros(nq),
            v: zeros(nv),
            dq: zeros(nq),
            dv: zeros(nv),
            lambda: zeros(nc),
            mu: zeros(nc),
            qdot: zeros(nq),
            vdot: zeros(nv),
            time: S::zero(),
        }
    }

    /// The instant that the equations are evaluated at.
    pub fn instant(&self) -> Instant<'_, S> {
        Instant {
            q: &self.q,
            v: &self.v,
            lambda: &self.lambda,
            mu: &self.mu,
            qdot: &self.qdot,
            vdot: &self.vdot,
            time: self.time,
        }
    }

    /// Moves by a scaled update (δy, h δv, h² δλ / m, h δμ) of a step of size h, the dynamics divided
    /// by the mass m; the rates stay.
    pub fn advance(&mut self, numbering: &Numbering, update: &[S], (h, mass): (S, f64)) {
        let (nv, nc) = (numbering.velocities(), numbering.constraints());
        bodies::advance(numbering, &mut self.q, &mut self.dq, &update[..nv]);
        for i in 0..nv {
            let change = update[nv + i] / h;
            self.v[i] += change;
            self.dv[i] += change;
        }
        for i in 0..nc {
            self.lambda[i] += update[2 * nv + i] * mass / (h * h);
            self.mu[i] += update[2 * nv + nc + i] / h;
        }
    }

    /// Keeps a predicted stage of a step from `from` in what the bodies' mobilities admit.
    fn hold(&mut self, numbering: &Numbering, from: &Self) {
        let before = (&from.q[..], &from.v[..]);
        let positions = (&mut self.q[..], &mut self.dq[..]);
        reduce::hold(numbering, before, positions, (&mut self.v, &mut self.dv));
    }

    /// The real part.
    pub fn real(&self) -> Stage<f64> {
        let part = |all: &[S]| all.iter().map(|x| x.re()).collect();
        Stage {
            q: part(&self.q),
            v: part(&self.v),
            dq: part(&self.dq),
            dv: part(&self.dv),
            lambda: part(&self.lambda),
            mu: part(&self.mu),
            qdot: part(&self.qdot),
            vdot: part(&self.vdot),
            time: self.time.re(),
        }
    }
}

/// What the adjoint needs: the state at the start and the stages of every step, one for a formula,
/// all for Radau IIA; the last stage stands at the step's end.
#[derive(Clone, Debug)]
pub struct Tape<S> {
    /// The start, with the rates there.
    pub start: Stage<S>,
    /// Steps 1 … N.
    pub steps: Vec<Vec<Stage<S>>>,
}

impl<S> Tape<S> {
    /// How many numbers it holds.
    pub fn numbers(&self) -> usize {
        let stage = |x: &Stage<S>| {
            let states = [&x.q, &x.v, &x.dq, &x.dv, &x.lambda, &x.mu, &x.qdot, &x.vdot];
            states.map(Vec::len).into_iter().sum::<usize>() + 1
        };
        let steps: usize = self.steps.iter().flatten().map(stage).sum();
        stage(&self.start) + steps
    }
}

impl Tape<Complex64> {
    /// The real part.
    pub fn real(&self) -> Tape<f64> {
        let step = |stages: &Vec<Stage<Complex64>>| stages.iter().map(Stage::real).collect();
        Tape {
            start: self.start.real(),
            steps: self.steps.iter().map(step).collect(),
        }
    }
}
