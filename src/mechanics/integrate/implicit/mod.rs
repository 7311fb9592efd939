//! Implicit methods on the GGL-stabilised equations: Radau IIA, and one-stage formulas with a
//! memory (BDF, generalised-α).

mod backward_error;
pub mod broyden;
pub mod cost;
mod estimate;
pub mod formula;
pub mod ggl;
pub mod krylov;
pub mod march;
pub mod newton;
pub mod predict;
pub mod radau;
pub mod replayer;
pub mod samples;
mod scales;
pub mod solver;
pub mod split;
mod stage_factors;
pub mod stage_newton;
mod tangent;
pub mod tape;
pub mod turned;

pub use replayer::Replayer;
pub use tape::Tape;

use crate::math::Scalar;
use crate::system::{Numbering, bodies, reduce};
use ggl::StepState;

/// State at a stage, with multipliers, rates, and increments since the start of the step.
#[derive(Clone, Debug)]
pub struct Stage<S> {
    /// Positions.
    pub q: Vec<S>,
    /// Velocities.
    pub v: Vec<S>,
    /// Increment of q since the start of the step. Rates are computed from increments, so they have
    /// no round-off of positions divided by the step.
    pub dq: Vec<S>,
    /// Increment of v since the start of the step.
    pub dv: Vec<S>,
    /// Multipliers λ.
    pub lambda: Vec<S>,
    /// Multipliers μ.
    pub mu: Vec<S>,
    /// Rates q̇.
    pub qdot: Vec<S>,
    /// Rates v̇.
    pub vdot: Vec<S>,
    /// Time \[s\].
    pub time: S,
}

impl<S: Scalar> Stage<S> {
    /// A stage of zeros.
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

    /// The state at which the equations are evaluated.
    pub fn instant(&self) -> StepState<'_, S> {
        StepState {
            q: &self.q,
            v: &self.v,
            lambda: &self.lambda,
            mu: &self.mu,
            qdot: &self.qdot,
            vdot: &self.vdot,
            time: self.time,
        }
    }

    /// Adds a scaled update (δy, h δv, h² δλ / m, h δμ) of a step of size h, where m is the mass by
    /// which the dynamics are divided. The rates do not change.
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

    /// Projects a predicted stage of a step from `from` onto what the mobilities admit.
    fn project_increments(&mut self, numbering: &Numbering, from: &Self) {
        let before = (&from.q[..], &from.v[..]);
        let positions = (&mut self.q[..], &mut self.dq[..]);
        reduce::project_increments(numbering, before, positions, (&mut self.v, &mut self.dv));
    }

    /// Its vectors; the time is the last.
    pub(super) fn parts(&self) -> [&[S]; 9] {
        [
            &self.q,
            &self.v,
            &self.dq,
            &self.dv,
            &self.lambda,
            &self.mu,
            &self.qdot,
            &self.vdot,
            std::slice::from_ref(&self.time),
        ]
    }

    /// Copies the vectors of another stage of the same system.
    pub(super) fn set_parts(&mut self, parts: [&[S]; 9]) {
        for (own, part) in self.parts_mut().into_iter().zip(parts) {
            own.copy_from_slice(part);
        }
    }

    fn parts_mut(&mut self) -> [&mut [S]; 9] {
        [
            &mut self.q,
            &mut self.v,
            &mut self.dq,
            &mut self.dv,
            &mut self.lambda,
            &mut self.mu,
            &mut self.qdot,
            &mut self.vdot,
            std::slice::from_mut(&mut self.time),
        ]
    }

    /// Copies another stage of the same system.
    pub fn set(&mut self, other: &Self) {
        self.set_parts(other.parts());
    }

    /// Whether all numbers are finite.
    pub(super) fn is_finite(&self) -> bool {
        self.parts().into_iter().flatten().all(|x| x.is_finite())
    }

    /// Writes the real part to `out`.
    pub(super) fn real_into(&self, out: &mut Stage<f64>) {
        for (own, part) in out.parts_mut().into_iter().zip(self.parts()) {
            for (own, x) in own.iter_mut().zip(part) {
                *own = x.re();
            }
        }
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
