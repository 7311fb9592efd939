//! Newton's method for one implicit step. The iteration matrix is kept while the method converges.

use super::Stage;
use super::backward_error::BackwardError;
use super::broyden::{Broyden, Pace};
use super::formula::Formula;
use super::ggl::Equations;
use super::scales::SceneScale;
use super::turned::Turned;
use crate::integrate::failure::IntegrationFailure;
use crate::integrate::work::WorkCounts;
use crate::linalg::{Pivots, SolveScalar, SparseLu, SparseMatrix};
use crate::math::Scalar;
use crate::model::Model;
use crate::system::{Numbering, RedundantRows, flexible};
use std::sync::Arc;

/// Newton's method stops at this error of a step, relative to its largest increments of position,
/// rotation, velocity and angular velocity. It is the relative error of accelerations.
const TOLERANCE: f64 = 1e-13;
/// Below this relative change a stagnating iteration has reached round-off.
const STAGNANT: f64 = 1e-9;
/// A scaled residual below this, relative to the largest coordinate, is round-off.
const ROUND_OFF: f64 = 1e-14;
/// The iteration matrix is renewed above this contraction.
const RENEW: f64 = 0.1;
/// The iteration matrix is renewed after this many steps of one iteration each.
const UNSEEN: usize = 8;
const ITERATIONS: usize = 25;
/// With finite elements, whose factors are expensive, Broyden's method corrects kept factors. They
/// are renewed within a step above this contraction.
const SLOW: f64 = 0.5;
/// Their assembly and factorisation cost as much as so many iterations.
const FACTORS: usize = 4;

/// Rates as functions of the increments in this step: q̇ = c dq + `qdot`, v̇ = c dv + `vdot`.
#[derive(Clone, Debug)]
pub(crate) struct History<S> {
    /// c, the formula's lead coefficient divided by h.
    pub c: S,
    /// Part of q̇ from the memory.
    pub qdot: Vec<S>,
    /// Part of v̇ from the memory.
    pub vdot: Vec<S>,
}

impl<S: Scalar> History<S> {
    /// A history without memory.
    pub(crate) fn new(numbering: &Numbering) -> Self {
        Self {
            c: S::zero(),
            qdot: vec![S::zero(); numbering.positions()],
            vdot: vec![S::zero(); numbering.velocities()],
        }
    }

    /// Sets the history of a formula in a step of size h, from its memory of q and of v:
    /// h ẏ = c Δ + Σ e_j m_j.
    pub(crate) fn set(&mut self, formula: &Formula, memory: &[Vec<Vec<S>>; 2], h: S) {
        self.c = S::from(formula.lead) / h;
        for (rates, memory) in [&mut self.qdot, &mut self.vdot].into_iter().zip(memory) {
            rates.fill(S::zero());
            for (e, m) in formula.past().iter().zip(memory) {
                let e = S::from(*e) / h;
                rates.iter_mut().zip(m).for_each(|(out, &m)| *out += e * m);
            }
        }
    }

    /// Sets q̇ and v̇ from the increments.
    fn rates(&self, x: &mut Stage<S>) {
        for (out, (&d, &past)) in x.qdot.iter_mut().zip(x.dq.iter().zip(&self.qdot)) {
            *out = self.c * d + past;
        }
        for (out, (&d, &past)) in x.vdot.iter_mut().zip(x.dv.iter().zip(&self.vdot)) {
            *out = self.c * d + past;
        }
    }
}

/// Data that Newton's method keeps from step to step.
#[derive(Clone, Debug)]
pub(crate) struct Memory<S> {
    /// State of the kept factors, with step size and c.
    made: Option<(Stage<S>, [S; 2])>,
    contraction: f64,
    unseen: usize,
    pace: Pace,
    pivots: Option<Arc<Pivots>>,
}

/// Newton's method with its workspace.
pub(crate) struct Newton<'a, S> {
    equations: Equations<'a, S>,
    numbering: &'a Numbering,
    matrix: SparseMatrix<S>,
    factors: SparseLu<S>,
    /// c h of the kept factors; `None` without factors.
    factored: Option<S>,
    /// State of the kept factors, with step size and c.
    made: (Stage<S>, [S; 2]),
    /// Contraction with the kept factors.
    contraction: f64,
    /// Number of steps in a row with one iteration, which gives no contraction.
    unseen: usize,
    /// With finite elements: corrections of the kept factors, the turns since they were made, and the work
    /// with them.
    broyden: Option<Broyden<S>>,
    turned: Turned,
    pace: Pace,
    /// With finite elements.
    backward: Option<BackwardError>,
    scale: SceneScale,
    residual: Vec<S>,
}

impl<'a, S: SolveScalar> Newton<'a, S> {
    /// Plans the solution of the model's equations.
    pub(crate) fn new(model: &'a Model<S>, numbering: &'a Numbering) -> Self {
        let mut equations = Equations::new(model, numbering);
        let length = equations.length();
        let pattern = equations.pattern(&Stage::zero(numbering).instant());
        let shells = flexible::has_shells(model);
        Self {
            equations,
            numbering,
            factors: SparseLu::new(&pattern),
            matrix: SparseMatrix::new(pattern),
            factored: None,
            made: (Stage::zero(numbering), [S::zero(); 2]),
            contraction: 1.0,
            unseen: 0,
            broyden: (!S::INFINITESIMAL && shells).then(Broyden::new),
            turned: match shells {
                true => Turned::new(model, numbering),
                false => Turned::default(),
            },
            pace: Pace::default(),
            backward: shells.then(|| BackwardError::new(length)),
            scale: SceneScale::of(model),
            residual: vec![S::zero(); length],
        }
    }

    /// The data that is kept from step to step.
    pub(crate) fn memory(&mut self) -> Memory<S> {
        Memory {
            made: self.factored.map(|_| self.made.clone()),
            contraction: self.contraction,
            unseen: self.unseen,
            pace: self.pace,
            pivots: self.factors.pivots(),
        }
    }

    /// Restores kept data, and repeats its factorisation.
    pub(crate) fn restore(&mut self, kept: &Memory<S>, counts: &mut WorkCounts) {
        self.contraction = kept.contraction;
        self.unseen = kept.unseen;
        self.pace = kept.pace;
        self.factors
            .set_pivots(&self.matrix.pattern, kept.pivots.as_ref());
        self.factored = None;
        let Some((stage, [h, c])) = &kept.made else {
            return;
        };
        let (equations, matrix) = (&mut self.equations, &mut self.matrix);
        matrix.assemble(|emit| equations.jacobian(&stage.instant(), *h, *c, emit));
        counts.factorisations += 1;
        if self.factors.factorise(matrix).is_ok() {
            self.factored = Some(*c * *h);
            self.made.0.set(stage);
            self.made.1 = [*h, *c];
            self.fit();
        }
    }

    /// Sets the terms of the backward error where the factors were made.
    fn fit(&mut self) {
        if let Some(backward) = &mut self.backward {
            let at = (&self.made.0, self.made.1[0].re());
            backward.fit(&self.equations, self.numbering, at, &[(1.0, &self.matrix)]);
        }
    }

    /// Sets the redundant rows that are left out.
    pub(crate) fn leave_out(&mut self, left_out: &RedundantRows) {
        if self.equations.leave_out(left_out) {
            self.factored = None;
        }
    }

    /// Discards the kept factors.
    pub(crate) fn forget(&mut self) {
        self.factored = None;
    }

    /// Solves the equations of step `step` of size `h`, which ends at `time`. `x` is the initial
    /// guess and the result.
    ///
    /// # Errors
    /// No convergence, a singular matrix, or a value that is not finite; with the worst equation by
    /// name.
    pub(crate) fn solve(
        &mut self,
        x: &mut Stage<S>,
        history: &History<S>,
        h: S,
        (step, time): (usize, f64),
        counts: &mut WorkCounts,
    ) -> Result<(), IntegrationFailure> {
        let numbering = self.numbering;
        let nv = numbering.velocities();
        let scales = self
            .scale
            .step(numbering, [&x.q, &x.v, &x.dq, &x.dv], h.re());
        // Changes by round-off, which a nearly singular matrix can magnify to any size.
        let round_off = ROUND_OFF * scales.place().max(1.0);
        let mut previous = f64::INFINITY;
        let (mut polish, mut before) = (false, 0.0_f64);
        let renew = if self.broyden.is_some() { SLOW } else { RENEW };
        if let Some(backward) = &mut self.backward {
            backward.begin();
        }
        let mut made_here = false;
        for iteration in 1..=ITERATIONS {
            history.rates(x);
            let at = x.instant();
            self.equations.residual(&at, h, &mut self.residual);
            // An infinitesimal part converges only with the exact matrix.
            let residual = (self.residual.iter()).fold(0.0, |m: f64, x| m.max(x.re().abs()));
            let fresh = S::INFINITESIMAL || self.factored != Some(history.c * h);
            if let (true, Some(broyden)) = (fresh || iteration == 1, &mut self.broyden) {
                broyden.clear();
                let turn = (&self.made.0.q[..], &x.q[..]);
                match fresh {
                    true => self.turned.clear(),
                    false => self.turned.set(numbering, turn, self.equations.left_out()),
                }
            }
            if fresh {
                made_here = true;
                self.pace = Pace::default();
                let (equations, matrix) = (&mut self.equations, &mut self.matrix);
                matrix.assemble(|emit| equations.jacobian(&at, h, history.c, emit));
                self.factored = None;
                self.factors.factorise(matrix).map_err(|singular| {
                    IntegrationFailure::Singular {
                        time,
                        step,
                        place: equations.describe_reduced(singular.column),
                    }
                })?;
                counts.factorisations += 1;
                self.factored = Some(history.c * h);
                self.made.0.set(x);
                self.made.1 = [h, history.c];
                self.fit();
            }
            if let Some(backward) = &mut self.backward {
                backward.take(&self.equations, [&self.residual]);
                if !S::INFINITESIMAL && iteration > 1 && backward.is_solved() {
                    self.end_step(iteration);
                    return Ok(());
                }
            }
            counts.newton_iterations += 1;
            counts.solves += 1;
            let mut update = std::mem::take(&mut self.residual);
            let factors = &mut self.factors;
            let turned = &self.turned;
            turned.through(&self.equations, &mut update, |x| factors.solve(x));
            if let Some(broyden) = &mut self.broyden {
                broyden.correct(std::slice::from_mut(&mut update));
            }
            let size = scales.size(&update[..2 * nv], h.re());
            if !size.is_finite() {
                self.residual = update;
                return Err(self.not_finite(&at_residual(&self.residual), time, step));
            }
            for u in &mut update {
                *u = -*u;
            }
            x.advance(numbering, &update, (h, self.equations.mass()));
            self.residual = update;

            let contraction = match iteration {
                // One iteration shows no contraction: that of factors about to be renewed.
                1 => self.contraction.max(RENEW),
                // A change after a zero one is round-off or an infinitesimal part: no contraction.
                _ if previous == 0.0 => 0.0,
                _ => size / previous,
            };
            // Contraction alternates between positions and multipliers: use the worse of two.
            let slow = contraction.max(before);
            let remaining = size * (slow / (1.0 - slow.min(0.9))).min(1.0);
            before = contraction;
            let standing = self
                .backward
                .as_ref()
                .is_some_and(BackwardError::is_standing);
            // Old factors contract slowly without round-off.
            let slowest = if made_here { RENEW } else { SLOW };
            let small = size <= scales.round_off.max(STAGNANT) || residual <= round_off;
            let stagnant = iteration > 2
                && (standing && contraction > RENEW || small && contraction > slowest);
            let solved = self
                .backward
                .as_ref()
                .is_some_and(BackwardError::will_be_solved);
            if polish || remaining <= TOLERANCE || stagnant || solved {
                if S::INFINITESIMAL && !polish {
                    polish = true;
                    previous = size;
                    continue;
                }
                if iteration > 1 && !stagnant {
                    self.contraction = contraction.clamp(1e-3, 1.0);
                }
                self.end_step(iteration);
                history.rates(x);
                return Ok(());
            }
            if iteration > 1 && contraction > renew {
                self.factored = None;
            }
            if fresh {
                self.contraction = 1e-2;
            }
            previous = size;
        }
        Err(self.stalled(x, history, h, (step, time)))
    }

    /// Judges the kept factors after a step of so many iterations.
    fn end_step(&mut self, iterations: usize) {
        // Kept factors whose convergence is unknown are not used for long.
        self.unseen = if iterations == 1 { self.unseen + 1 } else { 0 };
        if self.unseen >= UNSEEN {
            self.factored = None;
            self.unseen = 0;
        }
        if self.broyden.is_some() && self.pace.is_lost(iterations, FACTORS) {
            self.factored = None;
        }
    }

    fn not_finite(&self, residual: &[f64], time: f64, step: usize) -> IntegrationFailure {
        let row = residual.iter().position(|x| !x.is_finite()).unwrap_or(0);
        IntegrationFailure::NotFinite {
            time,
            step,
            worst: self.equations.describe(row),
        }
    }

    fn stalled(
        &mut self,
        x: &mut Stage<S>,
        history: &History<S>,
        h: S,
        (step, time): (usize, f64),
    ) -> IntegrationFailure {
        history.rates(x);
        let at = x.instant();
        self.equations.residual(&at, h, &mut self.residual);
        let rows = at_residual(&self.residual);
        let worst = (0..rows.len())
            .reduce(|w, i| if rows[i].abs() > rows[w].abs() { i } else { w })
            .unwrap_or(0);
        IntegrationFailure::NewtonStalled {
            time,
            step,
            iterations: ITERATIONS,
            residual: rows[worst].abs(),
            worst: self.equations.describe(worst),
        }
    }
}

fn at_residual<S: Scalar>(residual: &[S]) -> Vec<f64> {
    residual
        .iter()
        .map(|x| if x.is_finite() { x.re() } else { f64::NAN })
        .collect()
}
