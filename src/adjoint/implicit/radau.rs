//! A step of Radau IIA, backwards: the coupled system of all stages.

use super::sweep::{Pair, Sweep, add, move_back, rates_of, work, zero};
use crate::integrate::WorkCounts;
use crate::integrate::implicit::Stage;
use crate::integrate::implicit::ggl::Equations;
use crate::integrate::implicit::radau::Scheme;
use crate::linalg::{Emit, Pattern, REFINED_SOLVES, SparseLu, SparseMatrix};
use crate::model::Model;
use crate::system::{Numbering, bodies};

/// The coupled matrix, which every step fills again.
pub(super) struct Plan<'a> {
    model: &'a Model<f64>,
    numbering: &'a Numbering,
    scheme: &'a Scheme,
    equations: Equations<'a, f64>,
    matrix: SparseMatrix<f64>,
    /// The matrix of one stage with the rates held.
    held: SparseMatrix<f64>,
    factors: SparseLu<f64>,
}

impl<'a> Plan<'a> {
    pub fn new(model: &'a Model<f64>, numbering: &'a Numbering, scheme: &'a Scheme) -> Self {
        let mut equations = Equations::new(model, numbering);
        let zeros = vec![Stage::zero(numbering); scheme.stages()];
        let held = SparseMatrix::new(equations.pattern(&zeros[0].instant()));
        let order = scheme.stages() * equations.order();
        let pattern = Pattern::record(order, |emit: &mut dyn Emit<f64>| {
            emit_stages(&mut equations, scheme, &zeros, 1.0, emit);
        });
        Self {
            model,
            numbering,
            scheme,
            equations,
            factors: SparseLu::new(&pattern),
            held,
            matrix: SparseMatrix::new(pattern),
        }
    }

    /// Moves all functions from the end of the step to its start.
    ///
    /// # Errors
    /// What the equations are singular in.
    pub fn step(
        &mut self,
        stages: &[Stage<f64>],
        (h, width, end): (f64, f64, f64),
        sweeps: &mut [Sweep],
        counts: &mut WorkCounts,
    ) -> Result<(), String> {
        let (model, numbering, scheme) = (self.model, self.numbering, self.scheme);
        let (nv, n) = (numbering.velocities(), self.equations.order());
        let equations = &mut self.equations;
        self.matrix
            .assemble(|emit| emit_stages(equations, scheme, stages, h, emit));
        self.factors
            .factorise(&self.matrix)
            .map_err(|singular| equations.describe_reduced(singular.column % n))?;
        counts.factorisations += 1;
        let last = stages.len() - 1;
        for sweep in sweeps {
            // The step leaves its increment in front of a formula's memory.
            if !sweep.memory.is_empty() {
                let newest = sweep.memory.remove(0);
                add(&mut sweep.increments[last], 1.0, &newest);
                sweep.memory.push(zero(&newest));
            }
            // By the increments Z_j: their own and the rates' part.
            let mut by: Vec<Pair> = sweep.increments.clone();
            spread(scheme, last, &sweep.rates, h, &mut by);
            let mut psi = Vec::with_capacity(stages.len() * n);
            let mut part = vec![0.0; equations.length()];
            for (j, (stage, by)) in stages.iter().zip(&by).enumerate() {
                let mut total = by.clone();
                if j == last {
                    let end = (sweep.of.q.value.clone(), sweep.of.v.value.clone());
                    add(&mut total, 1.0, &end);
                }
                part.fill(0.0);
                bodies::tangent_of_cotangent(numbering, &stage.q, &total.0, &mut part[..nv]);
                part[nv..2 * nv].copy_from_slice(&total.1);
                part.iter_mut().for_each(|x| *x = -*x);
                equations.scale_columns(h, &mut part);
                equations.compress(&mut part);
                psi.extend_from_slice(&part[..n]);
            }
            self.factors
                .solve_transposed_refined(&self.matrix, &mut psi);
            counts.solves += REFINED_SOLVES;
            let mut slope = 0.0;
            let mut changes: Vec<Vec<f64>> = Vec::with_capacity(stages.len());
            for (i, stage) in stages.iter().enumerate() {
                let reduced = &psi[i * n..(i + 1) * n];
                let at = stage.instant();
                self.held
                    .assemble(|emit| equations.jacobian(&at, h, 0.0, emit));
                let mut change = self.held.multiply_transposed(reduced);
                change.resize(part.len(), 0.0);
                equations.expand(&mut change);
                equations.unscale_columns(h, &mut change);
                changes.push(change);
                part[..n].copy_from_slice(reduced);
                equations.expand(&mut part);
                equations.scale_rows(h, &mut part);
                let cot = &mut sweep.of.cot.model;
                let held = &mut changes[i][..nv];
                let by_time = equations.pull_back_held(&stage.instant(), &part, cot, held);
                sweep.of.by_duration += (end - width * (1.0 - scheme.nodes[i])) * by_time;
                let own = rates_of(model, numbering, &stage.q, &part);
                spread(scheme, i, &own, h, &mut by);
                slope += work(&own, stage);
            }
            slope += work(&sweep.rates, &stages[last]);
            sweep.of.by_duration -= width * slope / h;
            add(
                &mut by[last],
                1.0,
                &(sweep.of.q.value.clone(), sweep.of.v.value.clone()),
            );
            for ((stage, change), total) in stages.iter().zip(&changes).zip(&by) {
                move_back(&mut sweep.of, numbering, stage, change, &total.0);
            }
            let before = std::mem::replace(&mut sweep.before, zero(&by[0]));
            sweep.of.q.add(1.0, &before.0);
            sweep.of.v.add(1.0, &before.1);
            sweep.rates = zero(&by[0]);
            sweep.increments = by.iter().map(zero).collect();
        }
        Ok(())
    }
}

/// Hands the cotangent of the rates of stage i on to the increments.
fn spread(scheme: &Scheme, i: usize, rates: &Pair, h: f64, by: &mut [Pair]) {
    for (by, d) in by.iter_mut().zip(&scheme.rates[i]) {
        add(by, d / h, rates);
    }
}

/// Emits the matrix of all stages, scaled as the equations of one.
fn emit_stages(
    equations: &mut Equations<f64>,
    scheme: &Scheme,
    stages: &[Stage<f64>],
    h: f64,
    emit: &mut dyn Emit<f64>,
) {
    let n = equations.order();
    for (i, stage) in stages.iter().enumerate() {
        let at = stage.instant();
        let own = &mut At(emit, i * n, i * n);
        equations.jacobian(&at, h, scheme.rates[i][i] / h, own);
        for (j, other) in stages.iter().enumerate() {
            if j != i {
                let beside = &mut At(emit, i * n, j * n);
                equations.emit_rates(&at, &other.q, scheme.rates[i][j], beside);
            }
        }
    }
}

/// Emits every entry further down and to the right.
struct At<'a>(&'a mut dyn Emit<f64>, usize, usize);

impl Emit<f64> for At<'_> {
    fn add(&mut self, row: usize, column: usize, value: f64) {
        self.0.add(row + self.1, column + self.2, value);
    }
}
