//! Newton's method for the coupled stages of Radau IIA, with one real and one complex matrix. They
//! are kept while the method converges (Hairer & Wanner 1996, section IV.8).

use super::Stage;
use super::backward_error::BackwardError;
use super::broyden::{Broyden, Pace};
use super::ggl::Equations;
use super::radau::Scheme;
use super::scales::{Scales, SceneScale};
use super::split::SplitMatrix;
use super::turned::Turned;
use crate::integrate::failure::IntegrationFailure;
use crate::integrate::work::WorkCounts;
use crate::linalg::{Pivots, SingularMatrix, SolveScalar, SparseLu, SparseMatrix};
use crate::math::{Complex64, Scalar};
use crate::model::Model;
use crate::system::{Numbering, RedundantRows, bodies, flexible};
use std::f64::consts::SQRT_2;
use std::sync::Arc;

/// Newton's method stops at this error of the stages, relative to the largest increments of the
/// step.
const TOLERANCE: f64 = 1e-13;
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
/// The kept factors are used up to this relative change of the step size.
const SAME_STEP: f64 = 1e-6;
const ITERATIONS: usize = 20;
/// With finite elements, whose strains stiffen them within a step, kept factors are corrected by Broyden's
/// method, and renewed at the present iterate above this contraction, so often in a step. Infinitesimal parts
/// take them as they are.
const SLOW: f64 = 0.5;
const SLOW_INFINITESIMAL: f64 = 0.25;
const RENEWALS: usize = 6;
/// Their assembly and factorisation cost as much as so many iterations.
const FACTORS: usize = 4;
/// Iterations of their infinitesimal parts.
const RENEWED_INFINITESIMAL_ITERATIONS: usize = 40;
/// A pivot of a multiplier below this indicates a singular position.
const NEARLY_SINGULAR: f64 = 1e-4;
/// Number of iterations in which an infinitesimal part converges after the real part.
const INFINITESIMAL_ITERATIONS: usize = 12;

/// Data that Newton's method keeps from step to step.
#[derive(Clone, Debug)]
pub(crate) struct Memory {
    /// State of the kept factors, and the step size.
    made: Option<(Stage<f64>, f64)>,
    pace: Pace,
    /// Pivots of the real and of the complex matrix.
    pivots: [Option<Arc<Pivots>>; 2],
}

/// Newton's method with its workspace.
pub(crate) struct StageNewton<'a, S> {
    equations: Equations<'a, S>,
    /// The same equations in real numbers, for the matrices.
    real: Equations<'a, f64>,
    numbering: &'a Numbering,
    scheme: &'a Scheme,
    split: SplitMatrix,
    /// The matrix of the real eigenvalue, or of the error filter if there is none.
    real_mode: Option<(SparseMatrix<f64>, SparseLu<f64>)>,
    complex_mode: (SparseMatrix<Complex64>, SparseLu<Complex64>),
    /// Step size of the kept factors.
    factored: Option<f64>,
    /// With finite elements: corrections of the kept factors, the turns since they were made, and the work
    /// with them. The matrix is then renewed within a step.
    broyden: Option<Broyden<S>>,
    turned: Turned,
    pace: Pace,
    /// With finite elements.
    backward: Option<BackwardError>,
    scale: SceneScale,
    residuals: Vec<Vec<S>>,
    updates: Vec<Vec<S>>,
    real_rhs: Vec<f64>,
    complex_rhs: Vec<Complex64>,
    /// Initial guess of a step, and the stage at which the matrices are evaluated.
    predicted: Vec<Stage<S>>,
    middle: Stage<f64>,
    /// The middle stage at the start of an iteration.
    here: Stage<f64>,
    /// Combinations of increments of q and v, for the error.
    combined: [Vec<f64>; 2],
    /// Change (δy, h δv) by round-off in the latest step, if a nearly singular matrix magnified it.
    noise: Option<Vec<f64>>,
}

impl<'a, S: SolveScalar> StageNewton<'a, S> {
    /// Plans the solution. `real` is the real part of `model`; `estimates` states whether errors
    /// will be needed.
    pub(crate) fn new(
        model: &'a Model<S>,
        real: &'a Model<f64>,
        numbering: &'a Numbering,
        scheme: &'a Scheme,
        estimates: bool,
    ) -> Self {
        let mut equations = Equations::new(real, numbering);
        let zero = Stage::zero(numbering);
        let split = SplitMatrix::new(&mut equations, &zero);
        let pattern = split.held.pattern.clone();
        let n = equations.length();
        let shells = flexible::has_shells(model);
        let real_mode = (scheme.modes[0].is_real() || estimates).then(|| {
            let matrix = SparseMatrix::new(pattern.clone());
            (matrix, SparseLu::new(&pattern))
        });
        Self {
            equations: Equations::new(model, numbering),
            real: equations,
            numbering,
            scheme,
            split,
            real_mode,
            complex_mode: {
                let factors = SparseLu::new(&pattern);
                (SparseMatrix::new(pattern), factors)
            },
            factored: None,
            broyden: shells.then(Broyden::new),
            turned: match shells {
                true => Turned::new(model, numbering),
                false => Turned::default(),
            },
            pace: Pace::default(),
            backward: shells.then(|| BackwardError::new(n)),
            scale: SceneScale::of(model),
            residuals: vec![vec![S::zero(); n]; scheme.stages()],
            updates: vec![vec![S::zero(); n]; scheme.stages()],
            real_rhs: vec![0.0; n],
            complex_rhs: vec![Complex64::new(0.0, 0.0); n],
            predicted: vec![Stage::zero(numbering); scheme.stages()],
            combined: [vec![0.0; zero.q.len()], vec![0.0; zero.v.len()]],
            here: zero.clone(),
            middle: zero,
            noise: None,
        }
    }

    /// The data that is kept from step to step.
    pub(crate) fn memory(&mut self) -> Memory {
        let real = self.real_mode.as_mut();
        Memory {
            made: self.factored.map(|h| (self.middle.clone(), h)),
            pace: self.pace,
            pivots: [
                real.and_then(|(_, factors)| factors.pivots()),
                self.complex_mode.1.pivots(),
            ],
        }
    }

    /// Restores kept data, and repeats its factorisations.
    pub(crate) fn restore(&mut self, kept: &Memory, counts: &mut WorkCounts) {
        let [real, complex] = &kept.pivots;
        if let Some((matrix, factors)) = &mut self.real_mode {
            factors.set_pivots(&matrix.pattern, real.as_ref());
        }
        let (matrix, factors) = &mut self.complex_mode;
        factors.set_pivots(&matrix.pattern, complex.as_ref());
        self.factored = None;
        if let Some((middle, h)) = &kept.made {
            self.middle.set(middle);
            // This cannot fail: the same matrices were factorised before.
            let _ = self.factorise_there(*h, counts);
        }
        self.pace = kept.pace;
    }

    /// Discards the kept factors.
    pub(crate) fn forget(&mut self) {
        self.factored = None;
    }

    /// Sets the redundant rows that are left out.
    pub(crate) fn leave_out(&mut self, left_out: &RedundantRows) {
        if self.equations.leave_out(left_out) {
            self.real.leave_out(left_out);
            self.factored = None;
        }
    }

    /// Solves the stage equations of a step of size `h`. `stages` are the initial guess and the
    /// result.
    ///
    /// # Errors
    /// No convergence, a singular matrix, or a value that is not finite; with the worst equation by
    /// name.
    pub(crate) fn solve(
        &mut self,
        stages: &mut [Stage<S>],
        h: S,
        at: (usize, f64),
        counts: &mut WorkCounts,
    ) -> Result<(), IntegrationFailure> {
        let kept = self
            .factored
            .is_some_and(|old| (old - h.re()).abs() < SAME_STEP * old);
        if S::INFINITESIMAL || !kept {
            self.factorise(stages, h.re(), at, counts)?;
            return self.iterate(stages, h, at, counts);
        }
        for (predicted, stage) in self.predicted.iter_mut().zip(&*stages) {
            predicted.set(stage);
        }
        self.iterate(stages, h, at, counts).or_else(|_| {
            for (stage, predicted) in stages.iter_mut().zip(&self.predicted) {
                stage.set(predicted);
            }
            self.factorise(stages, h.re(), at, counts)?;
            self.iterate(stages, h, at, counts)
        })
    }

    /// Simplified Newton iterations with the kept factors.
    fn iterate(
        &mut self,
        stages: &mut [Stage<S>],
        h: S,
        at: (usize, f64),
        counts: &mut WorkCounts,
    ) -> Result<(), IntegrationFailure> {
        let numbering = self.numbering;
        let nv = numbering.velocities();
        let last = &stages[stages.len() - 1];
        let known = [&last.q[..], &last.v, &last.dq, &last.dv];
        let scales = self.scale.step(numbering, known, h.re());
        let (mut previous, mut before, mut slowest) = (f64::INFINITY, 0.0_f64, 0.0_f64);
        let mut renewals = 0;
        if let (Some(broyden), Some(backward)) = (&mut self.broyden, &mut self.backward) {
            broyden.clear();
            backward.begin();
            if !S::INFINITESIMAL {
                stages[(stages.len() - 1) / 2].real_into(&mut self.here);
                let turn = (&self.middle.q[..], &self.here.q[..]);
                self.turned.set(numbering, turn, self.real.left_out());
            }
        }
        for iteration in 1..=ITERATIONS {
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
            if stands && !stagnant && remaining > TOLERANCE {
                let gives_up = iteration == ITERATIONS || slow;
                let known = self.is_round_off(&scales);
                if known || gives_up {
                    let (change, most) = self.magnified(&scales, h);
                    stagnant = known || size <= FROM_NOISE * most;
                    noise = change;
                }
            }
            let solved = self
                .backward
                .as_ref()
                .is_some_and(BackwardError::will_be_solved);
            if remaining <= TOLERANCE || stagnant || solved {
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
                    Some(_) => self.pace.is_lost(iteration, FACTORS),
                    None => slowest > RENEW,
                };
                if lost {
                    self.factored = None;
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
                let renews = renewals < RENEWALS && contraction > most;
                if let (true, Some(broyden)) = (renews, &mut self.broyden) {
                    broyden.clear();
                    self.factorise(stages, h.re(), at, counts)?;
                    renewals += 1;
                } else if slow && !self.is_round_off(&scales) {
                    break;
                }
            }
            previous = size;
        }
        self.factored = None;
        Err(self.stalled(stages, h, at, counts))
    }

    /// Whether the residuals are round-off. A nearly singular matrix may turn them into changes of
    /// any size.
    fn is_round_off(&self, scales: &Scales) -> bool {
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
        self.update(Scalar::re, S::from);
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

    /// Change (δy, h δv) by round-off in the latest step, if a nearly singular matrix magnified it.
    pub(crate) fn noise(&self) -> Option<&[f64]> {
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
        if let Some(backward) = &mut self.backward {
            backward.take(&self.equations, &self.residuals);
            if !S::INFINITESIMAL && backward.is_solved() {
                return 0.0;
            }
        }
        for update in &mut self.updates {
            update.fill(S::zero());
        }
        self.update(Scalar::re, S::from);
        if S::INFINITESIMAL {
            self.update(Scalar::infinitesimal, S::of_infinitesimal);
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

    /// Adds the updates by one part of the residuals: x_i −= Σ r_i K⁻¹ Σ l_j F_j over the modes and
    /// the conjugates of complex ones.
    fn update(&mut self, part: impl Fn(S) -> f64, whole: impl Fn(f64) -> S) {
        for mode in &self.scheme.modes {
            if let (true, Some((_, factors))) = (mode.is_real(), &mut self.real_mode) {
                self.real_rhs.fill(0.0);
                for (residual, l) in self.residuals.iter().zip(&mode.left) {
                    for (out, &x) in self.real_rhs.iter_mut().zip(residual) {
                        *out += l.re * part(x);
                    }
                }
                let rhs = &mut self.real_rhs;
                self.turned.back(rhs);
                self.real.through(rhs, |x| factors.solve(x));
                self.turned.forth(rhs);
                for (update, r) in self.updates.iter_mut().zip(&mode.right) {
                    for (out, &x) in update.iter_mut().zip(&self.real_rhs) {
                        *out -= whole(r.re * x);
                    }
                }
            } else {
                self.complex_rhs.fill(Complex64::new(0.0, 0.0));
                for (residual, l) in self.residuals.iter().zip(&mode.left) {
                    for (out, &x) in self.complex_rhs.iter_mut().zip(residual) {
                        *out += l * part(x);
                    }
                }
                let (rhs, factors) = (&mut self.complex_rhs, &mut self.complex_mode.1);
                self.turned.back(rhs);
                self.real.through(rhs, |x| factors.solve(x));
                self.turned.forth(rhs);
                for (update, r) in self.updates.iter_mut().zip(&mode.right) {
                    for (out, x) in update.iter_mut().zip(&self.complex_rhs) {
                        *out -= whole(2.0 * (r * x).re);
                    }
                }
            }
        }
    }

    /// Assembles and factorises at the middle stage.
    fn factorise(
        &mut self,
        stages: &mut [Stage<S>],
        h: f64,
        (step, time): (usize, f64),
        counts: &mut WorkCounts,
    ) -> Result<(), IntegrationFailure> {
        self.set_rates(stages, S::from(h));
        stages[(stages.len() - 1) / 2].real_into(&mut self.middle);
        self.factorise_there(h, counts)
            .map_err(|singular| IntegrationFailure::Singular {
                time,
                step,
                place: self.real.describe_reduced(singular.column),
            })
    }

    /// Assembles and factorises at the stored middle stage.
    fn factorise_there(&mut self, h: f64, counts: &mut WorkCounts) -> Result<(), SingularMatrix> {
        let Self {
            split,
            real_mode,
            complex_mode,
            ..
        } = self;
        self.pace = Pace::default();
        self.turned.clear();
        split.assemble(&mut self.real, &self.middle.instant(), h);
        if let Some(backward) = &mut self.backward {
            let largest = self.scheme.modes.iter().map(|mode| mode.value.norm());
            let rates = largest.fold(0.0, f64::max);
            let at = (&self.middle, h);
            let parts = [(1.0, &split.held), (rates, &split.rates)];
            backward.fit(&self.real, self.numbering, at, &parts);
        }
        // The matrix is affine in the eigenvalue.
        let mut found = Ok(());
        for mode in &self.scheme.modes {
            counts.factorisations += 1;
            let factors = if let (true, Some((matrix, factors))) = (mode.is_real(), &mut *real_mode)
            {
                split.fill(mode.value.re, matrix);
                factors.factorise(matrix)
            } else {
                let (matrix, factors) = &mut *complex_mode;
                split.fill(mode.value, matrix);
                factors.factorise(matrix)
            };
            found = found.and(factors);
        }
        if let (false, Some((matrix, factors))) = (self.scheme.modes[0].is_real(), real_mode) {
            split.fill(1.0 / self.scheme.error.0, matrix);
            counts.factorisations += 1;
            found = found.and(factors.factorise(matrix));
        }
        self.factored = found.is_ok().then_some(h);
        found
    }

    /// Estimated error (δy, h δv) of a step of size h. The difference of the embedded formula is
    /// filtered by the real matrix: (K δ) = B (b̂_0 h ẏ_n + Σ e_i Z_i) / (b̂_0 h) in the equations
    /// of motion, and 0 in the constraints (Hairer & Wanner 1996, eq. IV.8.19 and 20). `rates` are
    /// the rates (q̇, v̇) at the start.
    pub(crate) fn error(
        &mut self,
        stages: &[Stage<f64>],
        (qdot, vdot): (&[f64], &[f64]),
        h: f64,
    ) -> &[f64] {
        let numbering = self.numbering;
        let nv = numbering.velocities();
        let (first, weights) = &self.scheme.error;
        let [dq, dv] = &mut self.combined;
        let start = |out: &mut [f64], rates: &[f64]| {
            let rates = out.iter_mut().zip(rates);
            rates.for_each(|(out, x)| *out = first * h * x);
        };
        start(dq, qdot);
        start(dv, vdot);
        for (stage, e) in stages.iter().zip(weights) {
            dq.iter_mut()
                .zip(&stage.dq)
                .for_each(|(out, z)| *out += e * z);
            dv.iter_mut()
                .zip(&stage.dv)
                .for_each(|(out, z)| *out += e * z);
        }
        let end = &stages[stages.len() - 1].q;
        self.real_rhs.fill(0.0);
        let (f1, rest) = self.real_rhs.split_at_mut(nv);
        bodies::velocity_of_rates(numbering, end, dq, f1);
        f1.iter_mut().for_each(|x| *x /= *first);
        // Rows of the dynamics are scaled by h² / m, those of the kinematics by h.
        bodies::mass_product(self.real.model(), numbering, dv, &mut rest[..nv]);
        let model = self.real.model();
        flexible::add_mass_product_at(model, numbering, end, dv, &mut rest[..nv]);
        let scale = h / (first * self.real.mass());
        rest[..nv].iter_mut().for_each(|x| *x *= scale);
        if let Some((_, factors)) = &mut self.real_mode {
            let rhs = &mut self.real_rhs;
            self.turned.back(rhs);
            self.real.through(rhs, |x| factors.solve(x));
            self.turned.forth(rhs);
        }
        &self.real_rhs[..2 * nv]
    }

    fn not_finite(&self, (step, time): (usize, f64)) -> IntegrationFailure {
        let row = (self.residuals.iter())
            .find_map(|residual| residual.iter().position(|x| !x.is_finite()))
            .unwrap_or(0);
        IntegrationFailure::NotFinite {
            time,
            step,
            worst: self.real.describe(row),
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
            self.factored = None;
            // Stiff forces also cause small pivots, but in the rows of bodies.
            let first = self.real.order() - 2 * self.numbering.constraints();
            let complex = self.complex_mode.1.smallest_pivot(first);
            let real = self.real_mode.as_mut();
            let real = real.map_or(complex, |(_, factors)| factors.smallest_pivot(first));
            let (pivot, column) = if real.0 < complex.0 { real } else { complex };
            if pivot < NEARLY_SINGULAR {
                let place = self.real.describe_reduced(column);
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
            worst: self.real.describe(worst) + &near,
        }
    }
}
