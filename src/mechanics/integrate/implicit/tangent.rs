//! The estimated error of a step of Radau IIA in the tangent.
//!
//! A derivative of the motion may vibrate where the motion rests, and steps that pass over these vibrations damp them
//! away: the exact adjoint of such steps is the exact derivative of a wrong number, and halved steps agree with it. So
//! steps for derivatives are chosen by a run whose numbers have an infinitesimal part, the tangent in a direction of
//! the design, and the error of both parts bounds the step (see `driver/integration/tangent.rs`).

use super::Stage;
use super::estimate::{embedded, true_rates};
use super::radau::Scheme;
use super::stage_newton::StageNewton;
use crate::integrate::scale::Scale;
use crate::integrate::work::WorkCounts;
use crate::linalg::SolveScalar;
use crate::model::Model;
use crate::system::accelerations::Accelerations;
use crate::system::{Numbering, RedundantRows, bodies};

/// Error of the tangent in a step, relative to its largest size so far, that counts as much as an error of one of the
/// motion: 1e-6 is allowed at a tolerance of 1e-9. A tenth of it triples the steps of a throw by a flexible arm at 1e-5,
/// whose derivatives have four digits without.
const OF_MOTION: f64 = 1e3;

/// Estimates errors of the tangent; keeps its workspace between steps.
pub(super) struct TangentError<'a, S> {
    model: &'a Model<S>,
    numbering: &'a Numbering,
    scheme: &'a Scheme,
    field: Accelerations<'a, S>,
    from: Stage<S>,
    combined: [Vec<S>; 2],
    difference: Vec<S>,
    /// The estimated error (δy, h δv), and what follows it in a vector of the equations.
    filtered: Vec<f64>,
    /// The largest size of the tangent at the starts of steps.
    largest: f64,
}

impl<'a, S: SolveScalar> TangentError<'a, S> {
    /// For a model with an infinitesimal part.
    pub(super) fn new(model: &'a Model<S>, numbering: &'a Numbering, scheme: &'a Scheme) -> Self {
        let zero = Stage::zero(numbering);
        let n = 2 * (numbering.velocities() + numbering.constraints());
        Self {
            model,
            numbering,
            scheme,
            field: Accelerations::new(model, numbering),
            combined: [vec![S::zero(); zero.q.len()], vec![S::zero(); zero.v.len()]],
            from: zero,
            difference: vec![S::zero(); n],
            filtered: vec![0.0; n],
            largest: 0.0,
        }
    }

    /// Sets the redundant rows that are left out.
    pub(super) fn leave_out(&mut self, left_out: &RedundantRows) {
        self.field.leave_out(left_out);
    }

    /// Adds the work so far to `counts`.
    pub(super) fn count(&self, counts: &mut WorkCounts) {
        counts.factorisations += self.field.factorisations;
        counts.solves += self.field.solves;
    }

    /// Estimated error of the tangent in the last step of `newton`, to be compared with the tolerance of the motion.
    pub(super) fn error(
        &mut self,
        newton: &mut StageNewton<S>,
        (from, stages): (&Stage<S>, &[Stage<S>]),
        h: f64,
        scale: &Scale,
    ) -> f64 {
        let numbering = self.numbering;
        self.from.set(from);
        if !true_rates(&mut self.field, &mut self.from) {
            return f64::NAN;
        }
        let all = (self.model, numbering, self.scheme);
        let factors = newton.factors();
        let equations = (h, factors.equations.mass());
        let out = (&mut self.combined, &mut self.difference[..]);
        embedded(all, (&self.from, stages), equations, out);
        for (own, x) in self.filtered.iter_mut().zip(&self.difference) {
            *own = x.infinitesimal();
        }
        factors.filter(&mut self.filtered);
        let end = &stages[stages.len() - 1];
        let nv = numbering.velocities();
        let speeds = scale.speeds(numbering, &from.v, &end.v);
        // Velocities of vibrations count by the positions that they move.
        let still = vec![0.0; nv];
        let size = |y: &[f64]| scale.tangent_square(y, &still, h, &speeds).sqrt();
        let of_state = |stage: &Stage<S>| {
            let part = |all: &[S]| -> Vec<f64> { all.iter().map(|x| x.infinitesimal()).collect() };
            let real: Vec<f64> = stage.q.iter().map(|x| x.re()).collect();
            let mut y = vec![0.0; nv];
            bodies::velocity_of_rates(numbering, &real, &part(&stage.q), &mut y);
            size(&y)
        };
        self.largest = self.largest.max(of_state(from));
        match self.largest.max(of_state(end)) {
            0.0 => 0.0,
            all => size(&self.filtered[..nv]) / (OF_MOTION * all),
        }
    }
}
