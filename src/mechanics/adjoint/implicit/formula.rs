//! A backward step of a one-stage formula.
//!
//! The matrix of a step depends on the motion alone. With finite elements that of the step before is made beside the
//! solutions of the present step, and functions stand side by side.

use super::step::Step;
use super::sweep::{Pair, Sweep, add, add_state, clear, move_back, pair, rates_of, work};
use crate::integrate::implicit::Stage;
use crate::integrate::implicit::broyden::Pace;
use crate::integrate::implicit::formula::Formula;
use crate::integrate::implicit::ggl::Equations;
use crate::integrate::implicit::krylov::{Kept, Krylov, PRODUCTS_OF_FACTORS};
use crate::integrate::implicit::split::SplitMatrix;
use crate::integrate::implicit::turned::Turned;
use crate::integrate::{LinearSolver, WorkCounts};
use crate::linalg::{SparseLu, SparseMatrix};
use crate::math::slices::add_scaled;
use crate::model::Model;
use crate::system::{Numbering, bodies, flexible};
use rayon::prelude::*;

/// Iteration matrices of steps, and workspace of all functions.
pub(super) struct BackwardStage<'a> {
    model: &'a Model<f64>,
    numbering: &'a Numbering,
    /// The matrix of a step of even number, or of each step.
    even: StepMatrix<'a>,
    /// That of a step of odd number, with finite elements.
    odd: Option<StepMatrix<'a>>,
    /// With finite elements, if the Krylov solver is chosen.
    kept: Option<KeptFactors>,
    functions: Vec<OfFunction<'a>>,
    adjoints: Vec<Vec<f64>>,
}

/// The iteration matrix of a step.
struct StepMatrix<'a> {
    equations: Equations<'a, f64>,
    split: SplitMatrix,
    matrix: SparseMatrix<f64>,
    /// None if factors of a later step are kept.
    factors: Option<SparseLu<f64>>,
    /// The step for which it was made, and the equation whose pivot is missing.
    made: (usize, Result<(), String>),
}

/// Workspace of a function.
struct OfFunction<'a> {
    equations: Equations<'a, f64>,
    /// The cotangent of the whole stage.
    total: Pair,
    /// Cotangents of the rates by the adjoint, and the derivative of the equations in the state times it.
    own: Pair,
    change: Vec<f64>,
}

/// Longest pause between attempts with kept factors, in steps.
const LONGEST: usize = 63;

/// Factors of a later step that precondition the earlier ones.
struct KeptFactors {
    factors: SparseLu<f64>,
    krylov: Krylov<f64>,
    turned: Turned,
    /// The positions where they were made.
    made_at: Vec<f64>,
    /// h and the lead coefficient for which they serve; none if they serve no longer.
    valid_for: Option<[f64; 2]>,
    pace: Pace,
    /// Solutions with new factors in their own step.
    solves: usize,
    /// Steps until kept factors are tried again, and the latest pause. It grows while kept factors cost more than
    /// new ones.
    wait: usize,
    pause: usize,
}

impl<'a> BackwardStage<'a> {
    pub fn new(model: &'a Model<f64>, numbering: &'a Numbering, solver: LinearSolver) -> Self {
        let krylov = solver == LinearSolver::Krylov && flexible::has_shells(model);
        let mut equations = Equations::new(model, numbering);
        let split = SplitMatrix::new(&mut equations, &Stage::zero(numbering));
        let pattern = split.held.pattern.clone();
        let matrix = |split: SplitMatrix, factors: Option<SparseLu<f64>>| StepMatrix {
            equations: Equations::new(model, numbering),
            matrix: split.held.clone(),
            factors,
            split,
            made: (0, Ok(())),
        };
        let factors = (!krylov).then(|| SparseLu::new(&pattern));
        let odd = flexible::has_shells(model).then(|| {
            let others = factors.as_ref().map(|factors| factors.another(&pattern));
            matrix(split.clone(), others)
        });
        Self {
            model,
            numbering,
            odd,
            kept: krylov.then(|| KeptFactors {
                factors: SparseLu::new(&pattern),
                krylov: Krylov::new(&equations, numbering),
                turned: Turned::new(model, numbering),
                made_at: Vec::new(),
                valid_for: None,
                pace: Pace::default(),
                solves: 0,
                wait: 0,
                pause: 0,
            }),
            even: matrix(split, factors),
            functions: Vec::new(),
            adjoints: Vec::new(),
        }
    }

    /// Moves all functions from the end of the step to its start. The matrix of the step before, if that is a step of
    /// a formula too, may be made meanwhile.
    ///
    /// # Errors
    /// The equation with a singular matrix.
    pub fn step(
        &mut self,
        (formula, step): (&Formula, &Step),
        before: Option<(&Formula, &Step)>,
        sweeps: &mut [Sweep],
        counts: &mut WorkCounts,
    ) -> Result<(), String> {
        let (model, numbering) = (self.model, self.numbering);
        let (matrix, other) = match &mut self.odd {
            Some(odd) if step.number % 2 == 1 => (odd, Some(&mut self.even)),
            odd => (&mut self.even, odd.as_mut()),
        };
        if matrix.made.0 != step.number {
            matrix.make(formula, step);
        }
        let length = matrix.equations.length();
        self.functions.resize_with(sweeps.len(), || OfFunction {
            equations: Equations::new(model, numbering),
            total: pair(numbering),
            own: pair(numbering),
            change: vec![0.0; length],
        });
        (self.adjoints).resize_with(sweeps.len(), || vec![0.0; length]);
        let team = flexible::team(model);
        let mut moving = Moving {
            model,
            numbering,
            side_by_side: other.is_some() && sweeps.len() > 1 && team.is_alone(),
            matrix,
            kept: &mut self.kept,
            functions: &mut self.functions,
            adjoints: &mut self.adjoints,
        };
        match (other, before) {
            (Some(other), Some((of_other, before))) => {
                let moved = || moving.step((formula, step), sweeps, counts);
                team.join(moved, || other.make(of_other, before)).0
            }
            _ => moving.step((formula, step), sweeps, counts),
        }
    }
}

impl StepMatrix<'_> {
    /// Assembles the matrix of a step, and factorises it unless factors are kept.
    fn make(&mut self, formula: &Formula, step: &Step) {
        if let Some(rows) = step.left_out {
            self.equations.leave_out(rows);
        }
        let at = step.last().instant();
        self.split.assemble(&mut self.equations, &at, step.size);
        self.split.fill(formula.lead, &mut self.matrix);
        let found = match &mut self.factors {
            Some(factors) => (factors.factorise(&self.matrix))
                .map_err(|singular| self.equations.describe_reduced(singular.column)),
            None => Ok(()),
        };
        self.made = (step.number, found);
    }
}

/// All functions, and what moves them over a step.
struct Moving<'s, 'a> {
    model: &'a Model<f64>,
    numbering: &'a Numbering,
    side_by_side: bool,
    matrix: &'s mut StepMatrix<'a>,
    kept: &'s mut Option<KeptFactors>,
    functions: &'s mut [OfFunction<'a>],
    adjoints: &'s mut [Vec<f64>],
}

impl<'a> Moving<'_, 'a> {
    /// Does some work for each function.
    fn each(
        &mut self,
        sweeps: &mut [Sweep],
        work: impl Fn(&StepMatrix<'a>, &mut Sweep, &mut OfFunction<'a>, &mut Vec<f64>) + Sync,
    ) {
        let (matrix, side_by_side) = (&*self.matrix, self.side_by_side);
        let (functions, adjoints) = (&mut *self.functions, &mut *self.adjoints);
        if side_by_side {
            let all = sweeps.par_iter_mut().zip(functions).zip(adjoints);
            all.for_each(|((sweep, own), psi)| work(matrix, sweep, own, psi));
        } else {
            let all = sweeps.iter_mut().zip(functions).zip(adjoints);
            all.for_each(|((sweep, own), psi)| work(matrix, sweep, own, psi));
        }
    }

    fn step(
        &mut self,
        (formula, step): (&Formula, &Step),
        sweeps: &mut [Sweep],
        counts: &mut WorkCounts,
    ) -> Result<(), String> {
        let (model, numbering, stage) = (self.model, self.numbering, step.last());
        let (h, nv) = (step.size, numbering.velocities());
        let c = formula.lead / h;
        if let Some(rows) = step.left_out {
            let mut changed = false;
            for own in &mut *self.functions {
                changed |= own.equations.leave_out(rows);
            }
            if let Some(kept) = self.kept.as_mut().filter(|_| changed) {
                kept.valid_for = None;
            }
        }
        self.each(sweeps, |matrix, sweep, own, psi| {
            // By the increment Δ: contributions of the rates and the memory.
            let total = &mut own.total;
            clear(total);
            add(total, c, &sweep.rates);
            let [memory_q, memory_v] = &sweep.memory;
            for ((f, _), (q, v)) in (formula.memory().iter()).zip(memory_q.iter().zip(memory_v)) {
                add_scaled(&mut total.0, *f, q);
                add_scaled(&mut total.1, *f, v);
            }
            add_state(total, &sweep.of);
            psi.fill(0.0);
            bodies::tangent_of_cotangent(numbering, &stage.q, &total.0, &mut psi[..nv]);
            psi[nv..2 * nv].copy_from_slice(&total.1);
            psi.iter_mut().for_each(|x| *x = -*x);
            matrix.equations.scale_columns(h, psi);
            matrix.equations.compress(psi);
        });
        self.solve(&stage.q, [h, formula.lead], counts)?;
        self.each(sweeps, |matrix, sweep, of, psi| {
            let order = matrix.equations.order();
            let (equations, change) = (&mut of.equations, &mut of.change);
            change.fill(0.0);
            let held = &matrix.split.held;
            held.multiply_transposed(&psi[..order], &mut change[..order]);
            equations.expand(psi);
            equations.expand(change);
            equations.unscale_columns(h, change);
            equations.scale_rows(h, psi);
            let cot = &mut sweep.of.cot.model;
            let at = stage.instant();
            let by_time = equations.pull_back_projected(&at, psi, cot, &mut change[..nv]);
            sweep.of.by_duration += step.rate * by_time;

            let (total, own) = (&mut of.total, &mut of.own);
            rates_of(model, numbering, &stage.q, psi, own);
            add(total, c, own);
            move_back(sweep, numbering, stage, change, &total.0);
            add(&mut sweep.rates, 1.0, own);
            sweep.of.by_duration -= step.growth * work(&sweep.rates, stage) / h;
            let rates = [&sweep.rates.0, &sweep.rates.1];
            for (memory, rates) in sweep.memory.iter_mut().zip(rates) {
                for (k, rate) in rates.iter().enumerate() {
                    formula.recall(rate / h, memory, k);
                }
            }
            clear(&mut sweep.rates);
        });
        Ok(())
    }

    /// Solves the transposed equations of a step with this h and lead coefficient, which ends at q.
    fn solve(&mut self, q: &[f64], by: [f64; 2], counts: &mut WorkCounts) -> Result<(), String> {
        let (own, adjoints) = (&mut *self.matrix, &mut *self.adjoints);
        own.made.1.clone()?;
        if let Some(factors) = &mut own.factors {
            counts.factorisations += 1;
            counts.solves += factors.solve_transposed_refined(&own.matrix, adjoints);
        }
        let Some(kept) = self.kept else {
            return Ok(());
        };
        let equations = &own.equations;
        if kept.valid_for.take() == Some(by) {
            (kept.turned).set(self.numbering, (&kept.made_at, q), equations.left_out());
            let mut used = Kept {
                factors: &mut kept.factors,
                turned: &kept.turned,
                matrix: &own.matrix,
                equations,
            };
            let reached = kept.krylov.solve_transposed(&mut used, adjoints);
            counts.products += reached.products;
            counts.solves += reached.products;
            let lost = kept.pace.is_lost(reached.products, PRODUCTS_OF_FACTORS);
            let costly = !reached.solved || reached.products > PRODUCTS_OF_FACTORS + kept.solves;
            kept.pause = match costly {
                true => LONGEST.min(2 * kept.pause + 1),
                false => 0,
            };
            kept.wait = kept.pause;
            if reached.solved {
                kept.valid_for = (!lost && !costly).then_some(by);
                return Ok(());
            }
        }
        (kept.factors.factorise(&own.matrix))
            .map_err(|singular| equations.describe_reduced(singular.column))?;
        counts.factorisations += 1;
        let solves = kept.factors.solve_transposed_refined(&own.matrix, adjoints);
        counts.solves += solves;
        kept.krylov.fit(&own.matrix);
        q.clone_into(&mut kept.made_at);
        kept.valid_for = (kept.wait == 0).then_some(by);
        kept.wait = kept.wait.saturating_sub(1);
        kept.solves = solves;
        kept.pace = Pace::default();
        kept.pace.count(solves);
        Ok(())
    }
}
