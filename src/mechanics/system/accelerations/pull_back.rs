//! Pull-backs of accelerations and rows in the present state.

use super::Accelerations;
use crate::model::Model;
use crate::system::bodies;
use crate::system::flexible::{self, StateCotangent};
use crate::system::in_motion::InMotion;
use crate::system::joints::{self, JointCotangent, RowCotangents};
use crate::system::loads::{self, LoadCotangent};

impl Accelerations<'_, f64> {
    /// Pulls the cotangent ā of the accelerations back to tangent positions, velocities, time
    /// (returned) and parameters, in the present, factorised state. `a` and `lambda` are the
    /// results of [`Accelerations::accelerations`].
    pub fn pull_back(
        &mut self,
        found: (&[f64], &[f64]),
        a_bar: &[f64],
        state: (&mut [f64], &mut [f64]),
        cot: &mut Model<f64>,
    ) -> f64 {
        self.pull_back_both(found, (a_bar, &[]), state, cot)
    }

    /// As [`Accelerations::pull_back`], with the cotangents of the multipliers too; none if empty.
    pub fn pull_back_both(
        &mut self,
        (a, lambda): (&[f64], &[f64]),
        (a_bar, lambda_bar): (&[f64], &[f64]),
        (y, v): (&mut [f64], &mut [f64]),
        cot: &mut Model<f64>,
    ) -> f64 {
        let mut psi = std::mem::take(&mut self.rhs);
        let (model, numbering) = (self.model, self.numbering);
        let nv = numbering.velocities();
        psi[..nv].copy_from_slice(a_bar);
        match lambda_bar.is_empty() {
            true => psi[nv..].fill(0.0),
            false => psi[nv..].copy_from_slice(lambda_bar),
        }
        self.solve(&mut psi);
        let mut by_time = 0.0;
        let mut out = LoadCotangent {
            y: Some(&mut *y),
            v: Some(&mut *v),
            time: &mut by_time,
            model: cot,
        };
        loads::pull_back(&self.here(), &psi[..nv], &mut out);
        psi.iter_mut().for_each(|x| *x = -*x);
        let (of, here) = ((model, numbering), (&self.motions[..], a));
        bodies::pull_force_balances(of, here, &psi[..nv], Some(&mut *v), cot);
        let mut bars = StateCotangent {
            y: Some(&mut *y),
            v: Some(&mut *v),
        };
        flexible::pull_force_balances(of, here, &psi[..nv], &mut bars, cot);
        // χᵀ (G a + bias) and λᵀ G ψ in one pass.
        let cotangents = RowCotangents {
            acceleration: Some(&psi[nv..]),
            virtual_rate: Some(lambda),
            ..Default::default()
        };
        let moving = (Some(a), Some(&psi[..nv]));
        by_time += self.pull_rows(moving, &cotangents, (y, Some(v)), cot);
        self.rhs = psi;
        by_time
    }

    /// Pulls λᵀ G(q, t) w, which is linear in w, back to tangent positions, the parameters of the
    /// joints and time (returned).
    pub fn pull_rate(
        &mut self,
        w: &[f64],
        lambda: &[f64],
        y: &mut [f64],
        cot: &mut Model<f64>,
    ) -> f64 {
        let cotangents = RowCotangents {
            virtual_rate: Some(lambda),
            ..Default::default()
        };
        self.pull_rows((None, Some(w)), &cotangents, (y, None), cot)
    }

    /// As [`Accelerations::pull_rate`], for χᵀ (G v + Φ_t) at the present velocities.
    pub fn pull_rates(&mut self, chi: &[f64], y: &mut [f64], cot: &mut Model<f64>) -> f64 {
        let cotangents = RowCotangents {
            rate: Some(chi),
            ..Default::default()
        };
        self.pull_rows((None, None), &cotangents, (y, None), cot)
    }

    /// As [`Accelerations::pull_rate`] for χᵀ Φ(q, t).
    pub fn pull_constraints(&mut self, chi: &[f64], y: &mut [f64], cot: &mut Model<f64>) -> f64 {
        let cotangents = RowCotangents {
            value: Some(chi),
            ..Default::default()
        };
        self.pull_rows((None, None), &cotangents, (y, None), cot)
    }

    /// Pulls the cotangents of the rows back with these accelerations and virtual velocities;
    /// `None` for zero.
    fn pull_rows(
        &mut self,
        (a, w): (Option<&[f64]>, Option<&[f64]>),
        cotangents: &RowCotangents,
        (y, v): (&mut [f64], Option<&mut [f64]>),
        cot: &mut Model<f64>,
    ) -> f64 {
        let (model, numbering) = (self.model, self.numbering);
        let mut out = JointCotangent {
            y: Some(y),
            v,
            model: cot,
        };
        // Values also depend on the frames' components across the plane.
        if let (Some(planar), None) = (&mut self.planar, cotangents.value) {
            planar.set_moving(numbering, a, w);
            planar.pull_back(numbering, cotangents, &mut out);
            return 0.0;
        }
        let moving = self.motions.iter().enumerate().map(|(i, motion)| {
            let o = numbering.velocity(i);
            let motion = a.map_or(*motion, |a| motion.accelerated(&a[o..]));
            w.map_or(motion, |w| motion.virtually(&w[o..]))
        });
        self.moving.clear();
        self.moving.extend(moving);
        let at = InMotion::new(model, numbering, &self.moving, self.time);
        joints::pull_back(&at, cotangents, &mut out)
    }
}
