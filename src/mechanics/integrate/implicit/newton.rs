//! Newton's method for one implicit step. The iteration matrix is kept while the method converges.

use super::Stage;
use super::backward_error::{BackwardError, NoiseFloor};
use super::broyden::{Broyden, Pace};
use super::formula::History;
use super::ggl::{Equations, StepState};
use super::krylov::{self, Kept, Krylov};
use super::scales::SceneScale;
use super::turned::Turned;
use crate::integrate::failure::IntegrationFailure;
use crate::integrate::settings::{LinearSolver, StepSolver, TO_ROUND_OFF};
use crate::integrate::work::WorkCounts;
use crate::linalg::{Pivots, SolveScalar, SparseLu, SparseMatrix};
use crate::math::Scalar;
use crate::model::Model;
use crate::system::{Numbering, RedundantRows, flexible};
use std::sync::Arc;

/// Below this relative change a stagnating iteration has reached round-off.
const STAGNANT: f64 = 1e-9;
/// A scaled residual below this, relative to the largest coordinate, is round-off.
const ROUND_OFF: f64 = 1e-14;
/// The iteration matrix is renewed above this contraction.
const RENEW: f64 = 0.1;
/// The iteration matrix is renewed after this many steps of one iteration each.
const UNSEEN: usize = 8;
const ITERATIONS: usize = 25;
/// Without finite elements the backward error is asked only after so many iterations.
const UNJUDGED: usize = 4;
/// With finite elements, whose factors are expensive, Broyden's method corrects kept factors. They
/// are renewed within a step above this contraction.
const SLOW: f64 = 0.5;
/// Their assembly and factorisation cost as much as so many iterations.
const ITERATIONS_OF_FACTORS: usize = 4;

/// Data that Newton's method keeps from step to step.
#[derive(Clone, Debug)]
pub struct Memory<S> {
    /// State of the kept factors, with step size and c.
    made: Option<(Stage<S>, [S; 2])>,
    contraction: f64,
    unseen: usize,
    pace: Pace,
    floor: NoiseFloor,
    pivots: Option<Arc<Pivots>>,
}

/// What corrects kept factors.
enum Correction<S> {
    /// Nothing.
    Nothing,
    /// The steps so far.
    Broyden(Broyden<S>),
    /// The present matrix.
    Krylov(Box<Krylov<S>>),
}

/// Newton's method with its workspace.
pub struct Newton<'a, S> {
    equations: Equations<'a, S>,
    numbering: &'a Numbering,
    /// Error of a step at which it ends. It is the relative error of accelerations.
    tolerance: f64,
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
    correction: Correction<S>,
    turned: Turned,
    pace: Pace,
    /// With flexible bodies, whose stiff forces have much round-off. Those without finite elements ask it only where
    /// the iterates approach no further.
    backward: Option<BackwardError>,
    shells: bool,
    floor: NoiseFloor,
    scale: SceneScale,
    residual: Vec<S>,
}

impl<'a, S: SolveScalar> Newton<'a, S> {
    /// Plans the solution of the model's equations.
    pub fn new(model: &'a Model<S>, numbering: &'a Numbering, solver: StepSolver) -> Self {
        let mut equations = Equations::new(model, numbering);
        let length = equations.length();
        let pattern = equations.pattern(&Stage::zero(numbering).instant());
        let shells = flexible::has_shells(model);
        Self {
            correction: match solver.linear {
                _ if S::INFINITESIMAL || !shells => Correction::Nothing,
                LinearSolver::Direct => Correction::Broyden(Broyden::new()),
                LinearSolver::Krylov => {
                    Correction::Krylov(Box::new(Krylov::new(&equations, numbering)))
                }
            },
            equations,
            numbering,
            tolerance: match S::INFINITESIMAL {
                true => TO_ROUND_OFF,
                false => solver.newton,
            },
            factors: SparseLu::new(&pattern),
            matrix: SparseMatrix::new(pattern),
            factored: None,
            made: (Stage::zero(numbering), [S::zero(); 2]),
            contraction: 1.0,
            unseen: 0,
            turned: match shells {
                true => Turned::new(model, numbering),
                false => Turned::default(),
            },
            pace: Pace::default(),
            floor: NoiseFloor::default(),
            backward: (!model.flexible.is_empty()).then(|| BackwardError::new(length)),
            shells,
            scale: SceneScale::of(model),
            residual: vec![S::zero(); length],
        }
    }

    /// The data that is kept from step to step.
    pub fn memory(&mut self) -> Memory<S> {
        Memory {
            made: self.factored.map(|_| self.made.clone()),
            contraction: self.contraction,
            unseen: self.unseen,
            pace: self.pace,
            floor: self.floor,
            pivots: self.factors.pivots(),
        }
    }

    /// Restores kept data, and repeats its factorisation.
    pub fn restore(&mut self, kept: &Memory<S>, counts: &mut WorkCounts) {
        self.contraction = kept.contraction;
        self.unseen = kept.unseen;
        self.pace = kept.pace;
        self.floor = kept.floor;
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

    /// Sets the terms of the backward error, and the scales of rows, where the factors were made.
    fn fit(&mut self) {
        if let Correction::Krylov(krylov) = &mut self.correction {
            krylov.fit(&self.matrix);
        }
        if let Some(backward) = &mut self.backward {
            let at = (&self.made.0, self.made.1[0].re());
            backward.fit(&self.equations, self.numbering, at, &[(1.0, &self.matrix)]);
        }
    }

    /// Sets the redundant rows that are left out.
    pub fn leave_out(&mut self, left_out: &RedundantRows) {
        if self.equations.leave_out(left_out) {
            self.factored = None;
        }
    }

    /// Discards the kept factors.
    pub fn forget(&mut self) {
        self.factored = None;
    }

    /// Solves the equations of step `step` of size `h`, which ends at `time`. `x` is the initial
    /// guess and the result.
    ///
    /// # Errors
    /// No convergence, a singular matrix, or a value that is not finite; with the worst equation by
    /// name.
    pub fn solve(
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
        let renew = match &mut self.correction {
            Correction::Nothing => RENEW,
            Correction::Broyden(_) => SLOW,
            Correction::Krylov(krylov) => {
                krylov.begin();
                SLOW
            }
        };
        if let Some(backward) = &mut self.backward {
            backward.begin();
        }
        self.floor.begin();
        // Inexact solutions contract no faster than their forcing terms, which is no round-off.
        let inexact = matches!(self.correction, Correction::Krylov(_));
        let still = if inexact { SLOW } else { RENEW };
        let mut made_here = false;
        for iteration in 1..=ITERATIONS {
            history.rates(x);
            let at = x.instant();
            self.equations.residual(&at, h, &mut self.residual);
            // An infinitesimal part converges only with the exact matrix.
            let residual = (self.residual.iter()).fold(0.0, |m: f64, x| m.max(x.re().abs()));
            let fresh = S::INFINITESIMAL || self.factored != Some(history.c * h);
            if fresh || iteration == 1 {
                if let Correction::Broyden(broyden) = &mut self.correction {
                    broyden.clear();
                }
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
            let judged = self.shells || iteration > UNJUDGED;
            if let Some(backward) = self.backward.as_mut().filter(|_| judged) {
                backward.take(&self.equations, [&self.residual]);
                if self.shells && !S::INFINITESIMAL && iteration > 1 && backward.is_solved() {
                    self.end_step(iteration);
                    return Ok(());
                }
            }
            counts.newton_iterations += 1;
            let mut update = std::mem::take(&mut self.residual);
            let suffices = self.apply_inverse((&at, [h, history.c], fresh), &mut update, counts);
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
            let judge = self.backward.as_ref();
            let standing = judge.is_some_and(BackwardError::is_standing);
            let judge = judge.filter(|_| self.shells);
            let told = |holds: fn(&BackwardError) -> bool| judge.is_some_and(holds);
            // Old factors contract slowly without round-off.
            let slowest = if made_here { still } else { SLOW };
            let small = size <= scales.round_off.max(STAGNANT) || residual <= round_off;
            let stagnant = iteration > 2
                && (standing && contraction > still || small && contraction > slowest);
            let converged = remaining <= self.tolerance
                || told(BackwardError::will_be_solved)
                || remaining <= self.floor.negligible() && told(BackwardError::will_stand);
            if suffices && (polish || converged || stagnant) {
                if S::INFINITESIMAL && !polish {
                    polish = true;
                    previous = size;
                    continue;
                }
                if iteration > 1 && !stagnant {
                    self.contraction = contraction.clamp(1e-3, 1.0);
                }
                if stagnant && standing {
                    self.floor.set(size);
                }
                self.end_step(iteration);
                history.rates(x);
                return Ok(());
            }
            if !suffices || iteration > 1 && contraction > renew {
                self.factored = None;
            }
            if fresh {
                self.contraction = 1e-2;
            }
            previous = size;
        }
        Err(self.stalled(x, history, h, (step, time)))
    }

    /// Applies the inverse of the matrix to a residual at an instant of a step with these h and c, by new or by kept
    /// factors. Returns whether these may serve longer.
    fn apply_inverse(
        &mut self,
        (at, [h, c], fresh): (&StepState<S>, [S; 2], bool),
        residual: &mut Vec<S>,
        counts: &mut WorkCounts,
    ) -> bool {
        let (factors, turned) = (&mut self.factors, &self.turned);
        if let Correction::Krylov(krylov) = &mut self.correction {
            let least = self.backward.as_ref().map_or(0.0, BackwardError::part);
            let forcing = krylov.force(&self.equations, residual, least);
            if !fresh {
                let (equations, matrix) = (&mut self.equations, &mut self.matrix);
                matrix.assemble(|emit| equations.jacobian(at, h, c, emit));
                let mut kept = Kept {
                    factors,
                    turned,
                    matrix,
                    equations,
                };
                let reached = krylov.solve(&mut kept, residual, forcing);
                counts.products += reached.products;
                counts.solves += reached.products;
                return reached.solved;
            }
        }
        counts.solves += 1;
        turned.through(&self.equations, residual, |x| factors.solve(x));
        if let Correction::Broyden(broyden) = &mut self.correction {
            broyden.correct(std::slice::from_mut(residual));
        }
        true
    }

    /// Judges the kept factors after a step of so many iterations.
    fn end_step(&mut self, iterations: usize) {
        // Kept factors whose convergence is unknown are not used for long.
        self.unseen = if iterations == 1 { self.unseen + 1 } else { 0 };
        if self.unseen >= UNSEEN {
            self.factored = None;
            self.unseen = 0;
        }
        let lost = match &self.correction {
            Correction::Nothing => false,
            Correction::Broyden(_) => self.pace.is_lost(iterations, ITERATIONS_OF_FACTORS),
            Correction::Krylov(krylov) => self
                .pace
                .is_lost(krylov.products, krylov::PRODUCTS_OF_FACTORS),
        };
        if lost {
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
