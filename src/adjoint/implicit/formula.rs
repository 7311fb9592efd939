//! A step of a formula, backwards.

use super::sweep::{Sweep, add, move_back, rates_of, work, zero};
use crate::integrate::WorkCounts;
use crate::integrate::implicit::Stage;
use crate::integrate::implicit::formula::Formula;
use crate::integrate::implicit::ggl::Equations;
use crate::linalg::{REFINED_SOLVES, SparseLu, SparseMatrix};
use crate::model::Model;
use crate::system::{Numbering, bodies};

/// The iteration matrix, which every step fills again.
pub(super) struct Plan<'a> {
    model: &'a Model<f64>,
    numbering: &'a Numbering,
    equations: Equations<'a, f64>,
    matrix: SparseMatrix<f64>,
    /// The matrix with the rates held.
    held: SparseMatrix<f64>,
    factors: SparseLu<f64>,
}

impl<'a> Plan<'a> {
    pub fn new(model: &'a Model<f64>, numbering: &'a Numbering) -> Self {
        let mut equations = Equations::new(model, numbering);
        let pattern = equations.pattern(&Stage::zero(numbering).instant());
        Self {
            model,
            numbering,
            equations,
            factors: SparseLu::new(&pattern),
            held: SparseMatrix::new(pattern.clone()),
            matrix: SparseMatrix::new(pattern),
        }
    }

    /// Moves all functions from the end of the step to its start.
    ///
    /// # Errors
    /// What the equations are singular in.
    pub fn step(
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
        self.matrix
            .assemble(|emit| equations.jacobian(&at, h, c, emit));
        self.held
            .assemble(|emit| equations.jacobian(&at, h, 0.0, emit));
        self.factors
            .factorise(&self.matrix)
            .map_err(|singular| equations.describe_reduced(singular.column))?;
        counts.factorisations += 1;
        for sweep in sweeps {
            // By the increment Δ: the rates' and the memory's part.
            let mut by_increment = zero(&sweep.rates);
            add(&mut by_increment, c, &sweep.rates);
            for ((f, _), later) in formula.memory.iter().zip(&sweep.memory) {
                add(&mut by_increment, *f, later);
            }
            let mut total = (sweep.of.q.value.clone(), sweep.of.v.value.clone());
            add(&mut total, 1.0, &by_increment);
            let mut psi = vec![0.0; equations.length()];
            bodies::tangent_of_cotangent(numbering, &stage.q, &total.0, &mut psi[..nv]);
            psi[nv..2 * nv].copy_from_slice(&total.1);
            psi.iter_mut().for_each(|x| *x = -*x);
            equations.scale_columns(h, &mut psi);
            equations.compress(&mut psi);
            let reduced = &mut psi[..equations.order()];
            self.factors.solve_transposed_refined(&self.matrix, reduced);
            let mut change = self.held.multiply_transposed(reduced);
            equations.expand(&mut psi);
            change.resize(psi.len(), 0.0);
            equations.expand(&mut change);
            equations.unscale_columns(h, &mut change);
            equations.scale_rows(h, &mut psi);
            counts.solves += REFINED_SOLVES;
            let cot = &mut sweep.of.cot.model;
            let by_time = equations.pull_back_held(&at, &psi, cot, &mut change[..nv]);
            sweep.of.by_duration += end * by_time;

            let own = rates_of(model, numbering, &stage.q, &psi);
            add(&mut total, c, &own);
            move_back(&mut sweep.of, numbering, stage, &change, &total.0);
            add(&mut sweep.rates, 1.0, &own);
            sweep.of.by_duration -= width * work(&sweep.rates, stage) / h;
            let earlier = (0..sweep.memory.len()).map(|j| {
                let mut out = zero(&own);
                add(&mut out, formula.past[j] / h, &sweep.rates);
                for ((_, row), later) in formula.memory.iter().zip(&sweep.memory) {
                    add(&mut out, row[j], later);
                }
                out
            });
            sweep.memory = earlier.collect();
            sweep.rates = zero(&own);
        }
        Ok(())
    }
}
