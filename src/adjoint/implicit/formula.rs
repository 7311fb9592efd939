//! A backward step of a one-stage formula.

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
use crate::system::RedundantRows;
use crate::system::{Numbering, bodies, flexible};

/// The iteration matrix of the present step, and workspace that all functions share.
pub(super) struct BackwardStage<'a> {
    model: &'a Model<f64>,
    numbering: &'a Numbering,
    equations: Equations<'a, f64>,
    matrix: SparseMatrix<f64>,
    split: SplitMatrix,
    factors: SparseLu<f64>,
    /// With finite elements, if the Krylov solver is chosen.
    kept: Option<KeptFactors>,
    /// By function: the cotangent of the whole stage, and the adjoint.
    totals: Vec<Pair>,
    adjoints: Vec<Vec<f64>>,
    /// Cotangents of the rates by the adjoint, and the derivative of the equations in the state times it.
    own: Pair,
    change: Vec<f64>,
}

/// Longest pause between attempts with kept factors, in steps.
const LONGEST: usize = 63;

/// Factors of a later step that precondition the earlier ones.
struct KeptFactors {
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
    pub(crate) fn new(
        model: &'a Model<f64>,
        numbering: &'a Numbering,
        solver: LinearSolver,
    ) -> Self {
        let mut equations = Equations::new(model, numbering);
        let split = SplitMatrix::new(&mut equations, &Stage::zero(numbering));
        let matrix = split.held.clone();
        let length = equations.length();
        let krylov = solver == LinearSolver::Krylov && flexible::has_shells(model);
        Self {
            kept: krylov.then(|| KeptFactors {
                krylov: Krylov::new(&equations, numbering),
                turned: Turned::new(model, numbering),
                made_at: Vec::new(),
                valid_for: None,
                pace: Pace::default(),
                solves: 0,
                wait: 0,
                pause: 0,
            }),
            model,
            numbering,
            equations,
            factors: SparseLu::new(&matrix.pattern),
            matrix,
            split,
            totals: Vec::new(),
            adjoints: Vec::new(),
            own: pair(numbering),
            change: vec![0.0; length],
        }
    }

    /// The plan without these rows, if any.
    pub(crate) fn leaving_out(&mut self, rows: Option<&RedundantRows>) -> &mut Self {
        if let Some(rows) = rows
            && self.equations.leave_out(rows)
            && let Some(kept) = &mut self.kept
        {
            kept.valid_for = None;
        }
        self
    }

    /// Moves all functions from the end of the step to its start.
    ///
    /// # Errors
    /// The equation with a singular matrix.
    pub(crate) fn step(
        &mut self,
        formula: &Formula,
        stage: &Stage<f64>,
        (h, width, end): (f64, f64, f64),
        sweeps: &mut [Sweep],
        counts: &mut WorkCounts,
    ) -> Result<(), String> {
        let (model, numbering) = (self.model, self.numbering);
        let nv = numbering.velocities();
        let at = stage.instant();
        let c = formula.lead / h;
        let equations = &mut self.equations;
        self.split.assemble(equations, &at, h);
        self.split.fill(formula.lead, &mut self.matrix);
        let (length, order) = (equations.length(), equations.order());
        let (totals, adjoints) = (&mut self.totals, &mut self.adjoints);
        totals.resize_with(sweeps.len(), || pair(numbering));
        adjoints.resize_with(sweeps.len(), || vec![0.0; length]);
        for ((sweep, total), psi) in sweeps.iter().zip(&mut *totals).zip(&mut *adjoints) {
            // By the increment Δ: contributions of the rates and the memory.
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
            equations.scale_columns(h, psi);
            equations.compress(psi);
        }
        self.solve(&stage.q, [h, formula.lead], counts)?;
        let (equations, totals, adjoints) =
            (&mut self.equations, &mut self.totals, &mut self.adjoints);
        for ((sweep, total), psi) in sweeps.iter_mut().zip(totals).zip(adjoints) {
            let (held, change) = (&self.split.held, &mut self.change);
            change.fill(0.0);
            held.multiply_transposed(&psi[..order], &mut change[..order]);
            equations.expand(psi);
            equations.expand(change);
            equations.unscale_columns(h, change);
            equations.scale_rows(h, psi);
            let cot = &mut sweep.of.cot.model;
            let by_time = equations.pull_back_projected(&at, psi, cot, &mut change[..nv]);
            sweep.of.by_duration += end * by_time;

            let own = &mut self.own;
            rates_of(model, numbering, &stage.q, psi, own);
            add(total, c, own);
            move_back(sweep, numbering, stage, change, &total.0);
            add(&mut sweep.rates, 1.0, own);
            sweep.of.by_duration -= width * work(&sweep.rates, stage) / h;
            let rates = [&sweep.rates.0, &sweep.rates.1];
            for (memory, rates) in sweep.memory.iter_mut().zip(rates) {
                for (k, rate) in rates.iter().enumerate() {
                    formula.recall(rate / h, memory, k);
                }
            }
            clear(&mut sweep.rates);
        }
        Ok(())
    }

    /// Solves the transposed equations of a step with this h and lead coefficient, which ends at q.
    fn solve(&mut self, q: &[f64], by: [f64; 2], counts: &mut WorkCounts) -> Result<(), String> {
        let (equations, adjoints) = (&self.equations, &mut self.adjoints);
        if let Some(own) = &mut self.kept
            && own.valid_for.take() == Some(by)
        {
            (own.turned).set(self.numbering, (&own.made_at, q), equations.left_out());
            let mut kept = Kept {
                factors: &mut self.factors,
                turned: &own.turned,
                matrix: &self.matrix,
                equations,
            };
            let reached = own.krylov.solve_transposed(&mut kept, adjoints);
            counts.products += reached.products;
            counts.solves += reached.products;
            let lost = own.pace.is_lost(reached.products, PRODUCTS_OF_FACTORS);
            let costly = !reached.solved || reached.products > PRODUCTS_OF_FACTORS + own.solves;
            own.pause = match costly {
                true => LONGEST.min(2 * own.pause + 1),
                false => 0,
            };
            own.wait = own.pause;
            if reached.solved {
                own.valid_for = (!lost && !costly).then_some(by);
                return Ok(());
            }
        }
        (self.factors)
            .factorise(&self.matrix)
            .map_err(|singular| equations.describe_reduced(singular.column))?;
        counts.factorisations += 1;
        let solves = (self.factors).solve_transposed_refined(&self.matrix, adjoints);
        counts.solves += solves;
        if let Some(own) = &mut self.kept {
            own.krylov.fit(&self.matrix);
            q.clone_into(&mut own.made_at);
            own.valid_for = (own.wait == 0).then_some(by);
            own.wait = own.wait.saturating_sub(1);
            own.solves = solves;
            own.pace = Pace::default();
            own.pace.count(solves);
        }
        Ok(())
    }
}
