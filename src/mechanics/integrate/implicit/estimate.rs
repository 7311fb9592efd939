//! The estimated error of a step of Radau IIA.

use super::Stage;
use super::predict::dense;
use super::radau::Scheme;
use super::stage_factors::StageFactors;
use super::stage_newton::StageNewton;
use crate::integrate::scale::{Scale, Speeds};
use crate::integrate::work::WorkCounts;
use crate::linalg::SolveScalar;
use crate::model::Model;
use crate::system::accelerations::Accelerations;
use crate::system::{BodyMotion, InMotion, Numbering, RedundantRows, bodies, flexible, joints};

/// Round-off in an estimated error relative to that in the stages, and its upper bound.
const MORE_NOISE: f64 = 30.0;
const MOST_NOISE: f64 = 1e-6;

/// Estimates errors; keeps its workspace between steps.
pub(super) struct Estimate<'a> {
    model: &'a Model<f64>,
    numbering: &'a Numbering,
    scheme: &'a Scheme,
    /// True rates at the start of a step.
    field: Accelerations<'a, f64>,
    /// The start, the stages and the middle of the step.
    from: Stage<f64>,
    stages: Vec<Stage<f64>>,
    middle: Stage<f64>,
    motions: Vec<BodyMotion<f64>>,
    rows: Vec<f64>,
    /// Combinations of increments of q and v.
    combined: [Vec<f64>; 2],
    /// The estimated error (δy, h δv), and what follows it in a vector of the equations.
    filtered: Vec<f64>,
}

impl<'a> Estimate<'a> {
    pub fn new(model: &'a Model<f64>, numbering: &'a Numbering, scheme: &'a Scheme) -> Self {
        let zero = Stage::zero(numbering);
        Self {
            model,
            numbering,
            scheme,
            field: Accelerations::new(model, numbering),
            stages: vec![zero.clone(); scheme.stages()],
            combined: [vec![0.0; zero.q.len()], vec![0.0; zero.v.len()]],
            filtered: vec![0.0; 2 * (numbering.velocities() + numbering.constraints())],
            middle: zero.clone(),
            from: zero,
            motions: Vec::new(),
            rows: vec![0.0; numbering.constraints()],
        }
    }

    /// Sets the redundant rows that are left out.
    pub fn leave_out(&mut self, left_out: &RedundantRows) {
        self.field.leave_out(left_out);
    }

    /// Adds the work so far to `counts`.
    pub fn count(&self, counts: &mut WorkCounts) {
        counts.factorisations += self.field.factorisations;
        counts.solves += self.field.solves;
    }

    /// Estimated error of the last step of `newton`, relative to the scene's scale.
    pub fn error<S: SolveScalar>(
        &mut self,
        newton: &mut StageNewton<S>,
        (from, stages): (&Stage<S>, &[Stage<S>]),
        h: f64,
        scale: &Scale,
    ) -> f64 {
        let numbering = self.numbering;
        from.real_into(&mut self.from);
        for (own, stage) in self.stages.iter_mut().zip(stages) {
            stage.real_into(own);
        }
        if !true_rates(&mut self.field, &mut self.from) {
            return f64::NAN;
        }
        self.filter(newton.factors(), h);
        let (v, nv) = (&self.from.v, self.from.v.len());
        let end = &self.stages[self.stages.len() - 1].v;
        let speeds = scale.speeds(numbering, &v[..], end);
        let size = |x: &[f64]| scale.tangent_square(&x[..nv], &x[nv..], h, &speeds).sqrt();
        let mut error = size(&self.filtered[..2 * nv]);
        if let Some(noise) = newton.noise().map(size) {
            // Round-off in the stages does not depend on the step size.
            error -= error.min((MORE_NOISE * noise).min(MOST_NOISE));
        }
        if (self.model.joints.iter()).all(|joint| joint.drives.is_empty()) {
            return error;
        }
        error.max(self.drift(h, (scale, &speeds)))
    }

    /// Sets the estimated error (δy, h δv) of a step of size h from its start and its stages, filtered by the real
    /// matrix.
    fn filter(&mut self, factors: &mut StageFactors, h: f64) {
        let all = (self.model, self.numbering, self.scheme);
        let out = (&mut self.combined, &mut self.filtered[..]);
        let h = (h, factors.equations.mass());
        embedded(all, (&self.from, &self.stages), h, out);
        factors.filter(&mut self.filtered);
    }

    /// Violation of the constraints at the middle of a step, relative to the scene's scale. The
    /// stages satisfy them. For a prescribed motion this is the only visible error.
    fn drift(&mut self, h: f64, (scale, speeds): (&Scale, &Speeds)) -> f64 {
        let (model, numbering) = (self.model, self.numbering);
        let middle = &mut self.middle;
        dense(self.scheme, &self.from, &self.stages, h, 0.5, middle);
        bodies::bring_to_unit(numbering, &mut middle.q);
        BodyMotion::all(numbering, &middle.q, &middle.v, &mut self.motions);
        let time = self.from.time + 0.5 * h;
        let at = InMotion::new(model, numbering, &self.motions, time);
        let largest = |rows: &[f64]| rows.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        joints::values(&at, &mut self.rows);
        let open = largest(&self.rows) / scale.length;
        joints::rates(&at, &mut self.rows);
        open.max(largest(&self.rows) / speeds.of_bodies[0])
    }
}

/// Sets the rates and multipliers of a stage to those of the index-1 equations; false if these are singular.
pub(super) fn true_rates<S: SolveScalar>(
    field: &mut Accelerations<S>,
    stage: &mut Stage<S>,
) -> bool {
    let Stage {
        q,
        v,
        qdot,
        vdot,
        lambda,
        time,
        ..
    } = stage;
    bodies::rates(field.numbering, q, v, qdot);
    field.set_state(q, v, *time);
    let regular = field.factorise().is_ok();
    if regular {
        field.accelerations(vdot, lambda);
    }
    regular
}

/// Sets the right-hand side B (b̂_0 h ẏ_n + Σ e_i Z_i) / (b̂_0 h) of the estimated error K δ in the equations of motion, and 0
/// in the constraints (Hairer & Wanner 1996, eq. IV.8.19 and 20), for a step of size h of equations scaled by a mass.
pub(super) fn embedded<S: SolveScalar>(
    (model, numbering, scheme): (&Model<S>, &Numbering, &Scheme),
    (from, stages): (&Stage<S>, &[Stage<S>]),
    (h, mass): (f64, f64),
    ([dq, dv], out): (&mut [Vec<S>; 2], &mut [S]),
) {
    let nv = numbering.velocities();
    let (first, weights) = &scheme.error;
    let start = |out: &mut [S], rates: &[S]| {
        let rates = out.iter_mut().zip(rates);
        rates.for_each(|(out, &x)| *out = x * (first * h));
    };
    start(dq, &from.qdot);
    start(dv, &from.vdot);
    let add = |out: &mut [S], e: f64, increments: &[S]| {
        let increments = out.iter_mut().zip(increments);
        increments.for_each(|(out, &z)| *out += z * e);
    };
    for (stage, &e) in stages.iter().zip(weights) {
        add(dq, e, &stage.dq);
        add(dv, e, &stage.dv);
    }
    let end = &stages[stages.len() - 1].q;
    out.fill(S::zero());
    let (f1, rest) = out.split_at_mut(nv);
    bodies::velocity_of_rates(numbering, end, dq, f1);
    f1.iter_mut().for_each(|x| *x = *x / *first);
    // Rows of the dynamics are scaled by h² / m, those of the kinematics by h.
    bodies::mass_product(model, numbering, dv, &mut rest[..nv]);
    flexible::add_mass_product_at(model, numbering, end, dv, &mut rest[..nv]);
    let scale = h / (first * mass);
    rest[..nv].iter_mut().for_each(|x| *x = *x * scale);
}
