//! A backward step of a one-stage formula.

use super::sweep::{Pair, Sweep, add, add_state, clear, move_back, pair, rates_of, work};
use crate::integrate::WorkCounts;
use crate::integrate::implicit::Stage;
use crate::integrate::implicit::formula::Formula;
use crate::integrate::implicit::ggl::Equations;
use crate::integrate::implicit::split::SplitMatrix;
use crate::linalg::{SparseLu, SparseMatrix};
use crate::math::slices::add_scaled;
use crate::model::Model;
use crate::system::RedundantRows;
use crate::system::{Numbering, bodies};

/// The iteration matrix of the present step, and workspace that all functions share.
pub(super) struct BackwardStage<'a> {
    model: &'a Model<f64>,
    numbering: &'a Numbering,
    equations: Equations<'a, f64>,
    matrix: SparseMatrix<f64>,
    split: SplitMatrix,
    factors: SparseLu<f64>,
    /// By function: the cotangent of the whole stage, and the adjoint.
    totals: Vec<Pair>,
    adjoints: Vec<Vec<f64>>,
    /// Cotangents of the rates by the adjoint, and the derivative of the equations in the state times it.
    own: Pair,
    change: Vec<f64>,
}

impl<'a> BackwardStage<'a> {
    pub(crate) fn new(model: &'a Model<f64>, numbering: &'a Numbering) -> Self {
        let mut equations = Equations::new(model, numbering);
        let split = SplitMatrix::new(&mut equations, &Stage::zero(numbering));
        let matrix = split.held.clone();
        let length = equations.length();
        Self {
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
        if let Some(rows) = rows {
            self.equations.leave_out(rows);
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
        self.factors
            .factorise(&self.matrix)
            .map_err(|singular| equations.describe_reduced(singular.column))?;
        counts.factorisations += 1;
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
        counts.solves += (self.factors).solve_transposed_refined(&self.matrix, adjoints);
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
}
