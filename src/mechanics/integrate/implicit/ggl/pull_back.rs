//! The pull-back of the equations: derivatives of ψᵀF with respect to the parameters and time.

use super::{Equations, StepState};
use crate::model::Model;
use crate::system::bodies::{self, BodyMotion};
use crate::system::flexible::{self, StateCotangent};
use crate::system::in_motion::InMotion;
use crate::system::joints::{self, JointCotangent, RowCotangents};
use crate::system::loads::{self, LoadCotangent};
use crate::system::reduce;

impl Equations<'_, f64> {
    /// Pulls the adjoint ψ (unscaled, of F1 … F4) back to the parameters in `cot`. Returns the
    /// derivative of ψᵀF in time.
    pub fn pull_back(&mut self, at: &StepState<f64>, psi: &[f64], cot: &mut Model<f64>) -> f64 {
        self.pull_back_projected(at, psi, cot, &mut [])
    }

    /// As [`Equations::pull_back`]. If `held` is not empty, adds to these tangent positions the
    /// part of F_yᵀψ that the mobilities do not admit, through positions that stay as placed.
    pub fn pull_back_projected(
        &mut self,
        at: &StepState<f64>,
        psi: &[f64],
        cot: &mut Model<f64>,
        held: &mut [f64],
    ) -> f64 {
        self.visit(at);
        let wanted = !held.is_empty() && self.numbering.keeps_placed();
        let (model, numbering) = (self.model, self.numbering);
        let [_, f2, f3, f4] = self.starts();
        let y = &mut self.placed;
        y.clear();
        y.resize(if wanted { held.len() } else { 0 }, 0.0);
        let (psi1, psi2, psi3, psi4) = (&psi[..f2], &psi[f2..f3], &psi[f3..f4], &psi[f4..]);
        let (of, here_at) = ((model, numbering), (&self.motions[..], at.vdot));
        bodies::pull_force_balances(of, here_at, psi2, None, cot);
        let mut bars = StateCotangent {
            y: wanted.then_some(&mut y[..]),
            v: None,
        };
        flexible::pull_force_balances(of, here_at, psi2, &mut bars, cot);
        for (minus, psi) in self.loads.iter_mut().zip(psi2) {
            *minus = -psi;
        }
        let mut by_time = 0.0;
        let mut out = LoadCotangent {
            y: wanted.then_some(&mut y[..]),
            v: None,
            time: &mut by_time,
            model: cot,
        };
        let here = InMotion::new(model, numbering, &self.motions, at.time);
        loads::pull_back(&here, &self.loads, &mut out);
        let mut pull = |motions: &[BodyMotion<f64>], cotangents: &RowCotangents| {
            let mut out = JointCotangent {
                y: wanted.then_some(&mut y[..]),
                v: None,
                model: cot,
            };
            let here = InMotion::new(model, numbering, motions, at.time);
            by_time += joints::pull_back(&here, cotangents, &mut out);
        };
        // λᵀ G ψ_2 with Φ and G v; μᵀ G ψ_1 only if the motion has μ.
        let (motions, moving) = (&self.motions, &mut self.moving);
        let mut virtually = |psi: &[f64], cotangents: &RowCotangents| {
            let at = |(i, motion): (usize, &BodyMotion<f64>)| {
                motion.virtually(&psi[numbering.velocity(i)..])
            };
            moving.clear();
            moving.extend(motions.iter().enumerate().map(at));
            pull(moving, cotangents);
        };
        let cotangents = RowCotangents {
            value: Some(psi3),
            rate: Some(psi4),
            acceleration: None,
            virtual_rate: Some(at.lambda),
        };
        virtually(psi2, &cotangents);
        if at.mu.iter().any(|&x| x != 0.0) {
            let cotangents = RowCotangents {
                virtual_rate: Some(at.mu),
                ..Default::default()
            };
            virtually(psi1, &cotangents);
        }
        if wanted {
            reduce::constrain_cotangent(numbering, y);
            held.iter_mut().zip(&*y).for_each(|(held, y)| *held += y);
        }
        by_time
    }
}
