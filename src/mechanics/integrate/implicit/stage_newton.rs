//! Newton's method for the coupled stages of Radau IIA, with factors that are kept while it converges (Hairer &
//! Wanner 1996, section IV.8).

use super::Stage;
use super::backward_error::BackwardError;
use super::broyden::{Broyden, Pace};
use super::ggl::Equations;
use super::radau::Scheme;
use super::scales::{Scales, SceneScale};
use super::stage_factors::StageFactors;
use crate::integrate::failure::IntegrationFailure;
use crate::integrate::settings::TO_ROUND_OFF;
use crate::integrate::work::WorkCounts;
use crate::linalg::{Pivots, SolveScalar};
use crate::math::Scalar;
use crate::model::Model;
use crate::system::{Numbering, RedundantRows, flexible};
use std::f64::consts::SQRT_2;
use std::sync::Arc;

/// Below this relative change a stagnating iteration has reached round-off. Stiff forces magnify
/// the round-off of positions.
const STAGNANT: f64 = 1e-7;
/// A scaled residual below this, relative to the largest coordinate, is round-off.
const ROUND_OFF: f64 = 1e-14;
/// Round-off of a residual relative to the largest coordinate, and largest ratio of changes to the
/// magnified round-off that is still attributed to it: the matrix belongs to another state.
const UNIT: f64 = f64::EPSILON;
const FROM_NOISE: f64 = 100.0;
/// The matrix is nearly singular above this magnification of round-off.
const MAGNIFIED: f64 = 1e3;
/// The matrices are renewed for the next step above this contraction.
const RENEW: f64 = 0.05;
/// The iteration is stopped above this contraction.
const DIVERGENT: f64 = 0.9;
const ITERATIONS: usize = 20;
/// With finite elements, whose strains stiffen them within a step, Broyden's method corrects kept
/// factors. Above this contraction they are renewed at the present iterate, at most so often in a
/// step. Infinitesimal parts use them uncorrected.
const SLOW: f64 = 0.5;
const SLOW_INFINITESIMAL: f64 = 0.25;
const RENEWALS: usize = 6;
/// Without these corrections a run with infinitesimal parts converges more slowly: it may take so many times the
/// iterations and renewals.
const UNCORRECTED: usize = 4;
/// Their assembly and factorisation cost as much as so many iterations.
const ITERATIONS_OF_FACTORS: usize = 4;
/// Iterations of their infinitesimal parts.
const RENEWED_INFINITESIMAL_ITERATIONS: usize = 40;
/// A pivot of a multiplier below this indicates a singular position.
const NEARLY_SINGULAR: f64 = 1e-4;
/// Number of iterations in which an infinitesimal part converges after the real part.
const INFINITESIMAL_ITERATIONS: usize = 12;

/// Data that Newton's method keeps from step to step.
#[derive(Clone, Debug)]
pub struct Memory {
    /// State of the kept factors, and the step size.
    made: Option<(Stage<f64>, f64)>,
    pace: Pace,
    /// Pivots of the real and of the complex matrix.
    pivots: [Option<Arc<Pivots>>; 2],
}

/// Newton's method with its workspace.
pub struct StageNewton<'a, S> {
    equations: Equations<'a, S>,
    numbering: &'a Numbering,
    scheme: &'a Scheme,
    /// Error of the stages at which it ends.
    tolerance: f64,
    factors: StageFactors<'a>,
    /// With finite elements: corrections of the kept factors, and the work with them. The factors are then
    /// renewed within a step.
    broyden: Option<Broyden<S>>,
    pace: Pace,
    /// With flexible bodies, whose stiff forces have much round-off. Those without finite elements ask it only where
    /// the iterates approach no further.
    backward: Option<BackwardError>,
    /// Whether matrices may be renewed in a step that would fail otherwise: it cannot be made smaller.
    insists: bool,
    scale: SceneScale,
    residuals: Vec<Vec<S>>,
    updates: Vec<Vec<S>>,
    /// Initial guess of a step.
    predicted: Vec<Stage<S>>,
    /// The middle stage at the start of an iteration.
    here: Stage<f64>,
    /// Change (δy, h δv) by round-off in the latest step, if a nearly singular matrix magnified it.
    noise: Option<Vec<f64>>,
}

impl<'a, S: SolveScalar> StageNewton<'a, S> {
    /// Plans the solution. `real` is the real part of `model`; `estimates` states whether errors
    /// will be needed. Without infinitesimal parts it ends at the error `tolerance`.
    pub fn new(
        (model, real): (&'a Model<S>, &'a Model<f64>),
        numbering: &'a Numbering,
        scheme: &'a Scheme,
        (estimates, tolerance): (bool, f64),
    ) -> Self {
        let real = Equations::new(real, numbering);
        let zero = Stage::zero(numbering);
        let n = real.length();
        let shells = flexible::has_shells(model);
        Self {
            equations: Equations::new(model, numbering),
            numbering,
            scheme,
            tolerance: match S::INFINITESIMAL {
                true => TO_ROUND_OFF,
                false => tolerance,
            },
            factors: StageFactors::new(real, numbering, scheme, estimates),
            broyden: shells.then(Broyden::new),
            pace: Pace::default(),
            backward: (!model.flexible.is_empty()).then(|| BackwardError::new(n)),
            insists: !estimates && !model.flexible.is_empty(),
            scale: SceneScale::of(model),
            residuals: vec![vec![S::zero(); n]; scheme.stages()],
            updates: vec![vec![S::zero(); n]; scheme.stages()],
            predicted: vec![Stage::zero(numbering); scheme.stages()],
            here: zero,
            noise: None,
        }
    }

    /// The data that is kept from step to step.
    pub fn memory(&mut self) -> Memory {
        Memory {
            made: self.factors.made(),
            pace: self.pace,
            pivots: self.factors.pivots(),
        }
    }

    /// Restores kept data, and repeats its factorisations.
    pub fn restore(&mut self, kept: &Memory, counts: &mut WorkCounts) {
        self.factors.set_pivots(&kept.pivots);
        self.factors.forget();
        if let Some((middle, h)) = &kept.made {
            // This cannot fail: the same matrices were factorised before.
            let backward = self.backward.as_mut();
            let _ = (self.factors).make(*h, |at| at.set(middle), backward, counts);
        }
        self.pace = kept.pace;
    }

    /// Discards the kept factors.
    pub fn forget(&mut self) {
        self.factors.forget();
    }

    /// Sets the redundant rows that are left out.
    pub fn leave_out(&mut self, left_out: &RedundantRows) {
        if self.equations.leave_out(left_out) {
            self.factors.leave_out(left_out);
        }
    }

    /// Solves the stage equations of a step of size `h`. `stages` are the initial guess and the
    /// result.
    ///
    /// # Errors
    /// No convergence, a singular matrix, or a value that is not finite; with the worst equation by
    /// name.
    pub fn solve(
        &mut self,
        stages: &mut [Stage<S>],
        h: S,
        at: (usize, f64),
        counts: &mut WorkCounts,
    ) -> Result<(), IntegrationFailure> {
        if S::INFINITESIMAL || !self.factors.serve(h.re()) {
            self.factorise(stages, h.re(), at, counts)?;
            return self.iterate(stages, h, at, (self.insists, &mut *counts));
        }
        for (predicted, stage) in self.predicted.iter_mut().zip(&*stages) {
            predicted.set(stage);
        }
        // Kept factors are given up as in a run that chooses its steps, whose repetition has to be equal.
        self.iterate(stages, h, at, (false, &mut *counts))
            .or_else(|_| {
                for (stage, predicted) in stages.iter_mut().zip(&self.predicted) {
                    stage.set(predicted);
                }
                self.factorise(stages, h.re(), at, counts)?;
                self.iterate(stages, h, at, (self.insists, &mut *counts))
            })
    }

    /// Simplified Newton iterations with the kept factors. If they `insist`, the matrices are renewed at the last
    /// iterate before they fail.
    fn iterate(
        &mut self,
        stages: &mut [Stage<S>],
        h: S,
        at: (usize, f64),
        (insist, counts): (bool, &mut WorkCounts),
    ) -> Result<(), IntegrationFailure> {
        let numbering = self.numbering;
        let nv = numbering.velocities();
        let last = &stages[stages.len() - 1];
        let known = [&last.q[..], &last.v, &last.dq, &last.dv];
        let scales = self.scale.step(numbering, known, h.re());
        let (mut previous, mut before, mut slowest) = (f64::INFINITY, 0.0_f64, 0.0_f64);
        let (mut renewals, uncorrected) = (0, S::INFINITESIMAL && self.broyden.is_some());
        let patience = if uncorrected { UNCORRECTED } else { 1 };
        let iterations = ITERATIONS * patience;
        let mut insisted = 0;
        if let (Some(broyden), Some(backward)) = (&mut self.broyden, &mut self.backward) {
            broyden.clear();
            backward.begin();
            if !S::INFINITESIMAL {
                stages[(stages.len() - 1) / 2].real_into(&mut self.here);
                self.factors.turn_to(&self.here.q);
            }
        }
        let mut iteration = 0;
        while iteration < iterations {
            iteration += 1;
            let size = self.improve(stages, h, &scales, nv, counts);
            if !size.is_finite() {
                return Err(self.not_finite(at));
            }
            let contraction = match iteration {
                1 => RENEW,
                // A change after a zero one is round-off or an infinitesimal part: no contraction.
                _ if previous == 0.0 => 0.0,
                _ => size / previous,
            };
            // Contraction alternates between positions and multipliers: use the worse of two.
            let pair = contraction.max(before);
            let slow = contraction.min(before) > DIVERGENT || contraction > 10.0;
            before = contraction;
            let remaining = size * (pair / (1.0 - pair.min(0.9))).min(1.0);
            let stands = iteration > 2 && contraction > 0.3;
            let mut stagnant = stands && size <= scales.round_off.max(STAGNANT);
            let mut noise = None;
            if stands && !stagnant && remaining > self.tolerance {
                let gives_up = iteration == iterations || slow;
                let known = self.is_round_off(&scales);
                if known || gives_up {
                    let (change, most) = self.magnified(&scales, h);
                    stagnant = known || size <= FROM_NOISE * most;
                    noise = change;
                }
            }
            let judged = self.backward.as_ref().filter(|_| self.broyden.is_some());
            let solved = judged.is_some_and(BackwardError::will_be_solved);
            if remaining <= self.tolerance || stagnant || solved {
                self.noise = noise;
                if S::INFINITESIMAL {
                    let mut count = INFINITESIMAL_ITERATIONS;
                    if self.broyden.is_some() {
                        self.factorise(stages, h.re(), at, counts)?;
                        count = RENEWED_INFINITESIMAL_ITERATIONS;
                    }
                    for _ in 0..count {
                        self.improve(stages, h, &scales, nv, counts);
                    }
                }
                let lost = match self.broyden {
                    Some(_) => self.pace.is_lost(iteration, ITERATIONS_OF_FACTORS),
                    None => slowest > RENEW,
                };
                if lost {
                    self.factors.forget();
                }
                self.set_rates(stages, h);
                return Ok(());
            }
            if iteration > 1 {
                slowest = slowest.max(contraction);
                let most = if S::INFINITESIMAL {
                    SLOW_INFINITESIMAL
                } else {
                    SLOW
                };
                let renews = renewals < RENEWALS * patience && contraction > most;
                if let (true, Some(broyden)) = (renews, &mut self.broyden) {
                    broyden.clear();
                    self.factorise(stages, h.re(), at, counts)?;
                    renewals += 1;
                } else if slow && !self.is_round_off(&scales) {
                    if !insist || contraction > 1.0 || insisted == RENEWALS {
                        break;
                    }
                    iteration = iterations;
                }
            }
            previous = size;
            if iteration == iterations && insist && insisted < RENEWALS {
                insisted += 1;
                self.factorise(stages, h.re(), at, counts)?;
                (iteration, previous, before) = (0, f64::INFINITY, 0.0);
            }
        }
        self.factors.forget();
        Err(self.stalled(stages, h, at, counts))
    }

    /// Whether the residuals are round-off. A nearly singular matrix may turn them into changes of
    /// any size.
    fn is_round_off(&mut self, scales: &Scales) -> bool {
        if let (None, Some(backward)) = (&self.broyden, &mut self.backward) {
            backward.begin();
            backward.take(&self.equations, &self.residuals);
        }
        let limit = ROUND_OFF * scales.place().max(1.0);
        let all = self.residuals.iter().flatten();
        let standing = (self.backward.as_ref()).is_some_and(BackwardError::is_standing);
        standing || all.fold(0.0, |m: f64, x| m.max(x.re().abs())) <= limit
    }

    /// Effect of round-off in the constraints: the largest change (δy, h δv) of a stage, and its
    /// size relative to the increments. The change is normal to the motion that the joints allow.
    /// It is `None` if the matrix does not magnify: round-off of large coordinates then belongs to
    /// the error of the step.
    fn magnified(&mut self, scales: &Scales, h: S) -> (Option<Vec<f64>>, f64) {
        let n = 2 * self.numbering.velocities();
        let unit = UNIT * scales.place().max(1.0);
        for residual in &mut self.residuals {
            residual.fill(S::zero());
            for (i, x) in residual[n..].iter_mut().enumerate() {
                // Irregular signs, so that no combination of rows is missed.
                let sign = (SQRT_2 * (i + 1) as f64).fract() - 0.5;
                *x = S::from(unit.copysign(sign));
            }
        }
        for update in &mut self.updates {
            update.fill(S::zero());
        }
        self.factors
            .update(&self.residuals, &mut self.updates, Scalar::re, S::from);
        let mut all = vec![0.0_f64; n];
        let mut size = 0.0_f64;
        for update in &self.updates {
            size = size.max(scales.size(&update[..n], h.re()));
            let both = all.iter_mut().zip(&update[..n]);
            both.for_each(|(most, x)| *most = most.max(x.re().abs()));
        }
        let largest = all.iter().fold(0.0_f64, |m, &x| m.max(x));
        ((largest > MAGNIFIED * unit).then_some(all), size)
    }

    /// The latest factors.
    pub(super) fn factors(&mut self) -> &mut StageFactors<'a> {
        &mut self.factors
    }

    /// Change (δy, h δv) by round-off in the latest step, if a nearly singular matrix magnified it.
    pub fn noise(&self) -> Option<&[f64]> {
        self.noise.as_deref()
    }

    /// Makes one iteration; returns the size of the change.
    fn improve(
        &mut self,
        stages: &mut [Stage<S>],
        h: S,
        scales: &Scales,
        nv: usize,
        counts: &mut WorkCounts,
    ) -> f64 {
        self.set_rates(stages, h);
        for (stage, residual) in stages.iter().zip(&mut self.residuals) {
            self.equations.residual(&stage.instant(), h, residual);
        }
        if let (Some(_), Some(backward)) = (&self.broyden, &mut self.backward) {
            backward.take(&self.equations, &self.residuals);
            if !S::INFINITESIMAL && backward.is_solved() {
                return 0.0;
            }
        }
        for update in &mut self.updates {
            update.fill(S::zero());
        }
        self.factors
            .update(&self.residuals, &mut self.updates, Scalar::re, S::from);
        if S::INFINITESIMAL {
            let (residuals, updates) = (&self.residuals, &mut self.updates);
            (self.factors).update(
                residuals,
                updates,
                Scalar::infinitesimal,
                S::of_infinitesimal,
            );
        }
        if let (false, Some(broyden)) = (S::INFINITESIMAL, &mut self.broyden) {
            broyden.correct(&mut self.updates);
        }
        counts.newton_iterations += 1;
        counts.solves += self.scheme.modes.len();
        let mut size = 0.0_f64;
        let mass = self.equations.mass();
        for (stage, update) in stages.iter_mut().zip(&self.updates) {
            let own = scales.size(&update[..2 * nv], h.re());
            size = if own.is_nan() { own } else { size.max(own) };
            stage.advance(self.numbering, update, (h, mass));
        }
        size
    }

    /// Sets the rates of the stages from their increments, h Ẏ_i = Σ D_ij Z_j.
    fn set_rates(&self, stages: &mut [Stage<S>], h: S) {
        for i in 0..stages.len() {
            let mut qdot = std::mem::take(&mut stages[i].qdot);
            let mut vdot = std::mem::take(&mut stages[i].vdot);
            qdot.fill(S::zero());
            vdot.fill(S::zero());
            for (stage, &d) in stages.iter().zip(&self.scheme.rates[i]) {
                let d = S::from(d) / h;
                qdot.iter_mut()
                    .zip(&stage.dq)
                    .for_each(|(out, &z)| *out += d * z);
                vdot.iter_mut()
                    .zip(&stage.dv)
                    .for_each(|(out, &z)| *out += d * z);
            }
            stages[i].qdot = qdot;
            stages[i].vdot = vdot;
        }
    }

    /// Makes new factors at the middle stage.
    fn factorise(
        &mut self,
        stages: &mut [Stage<S>],
        h: f64,
        (step, time): (usize, f64),
        counts: &mut WorkCounts,
    ) -> Result<(), IntegrationFailure> {
        self.set_rates(stages, S::from(h));
        self.pace = Pace::default();
        let middle = &stages[(stages.len() - 1) / 2];
        let backward = self.backward.as_mut();
        (self.factors)
            .make(h, |at| middle.real_into(at), backward, counts)
            .map_err(|singular| IntegrationFailure::Singular {
                time,
                step,
                place: self.factors.equations.describe_reduced(singular.column),
            })
    }

    fn not_finite(&self, (step, time): (usize, f64)) -> IntegrationFailure {
        let row = (self.residuals.iter())
            .find_map(|residual| residual.iter().position(|x| !x.is_finite()))
            .unwrap_or(0);
        IntegrationFailure::NotFinite {
            time,
            step,
            worst: self.equations.describe(row),
        }
    }

    /// The reason why the iterations failed, and whether the matrix is nearly singular at their
    /// end.
    fn stalled(
        &mut self,
        stages: &mut [Stage<S>],
        h: S,
        (step, time): (usize, f64),
        counts: &mut WorkCounts,
    ) -> IntegrationFailure {
        let mut near = String::new();
        if stages.iter().all(Stage::is_finite) {
            if let Err(singular) = self.factorise(stages, h.re(), (step, time), counts) {
                return singular;
            }
            self.factors.forget();
            let (pivot, column) = self.factors.smallest_pivot();
            if pivot < NEARLY_SINGULAR {
                let place = self.equations.describe_reduced(column);
                near = format!(
                    "; the iteration matrix is nearly singular there (pivot {pivot:.1e} of 1), at {place}"
                );
            }
        }
        self.set_rates(stages, h);
        let (mut worst, mut largest) = (0, 0.0_f64);
        for (stage, residual) in stages.iter().zip(&mut self.residuals) {
            self.equations.residual(&stage.instant(), h, residual);
            for (row, x) in residual.iter().enumerate() {
                if x.re().abs() > largest || x.re().is_nan() {
                    (worst, largest) = (row, x.re().abs());
                }
            }
        }
        IntegrationFailure::NewtonStalled {
            time,
            step,
            iterations: ITERATIONS,
            residual: largest,
            worst: self.equations.describe(worst) + &near,
        }
    }
}
