//! A backward step of Radau IIA: the coupled system of all stages.

use super::step::Step;
use super::sweep::{Pair, Sweep, add, add_state, clear, copy, move_back, pair, rates_of, work};
use crate::integrate::WorkCounts;
use crate::integrate::implicit::Stage;
use crate::integrate::implicit::ggl::Equations;
use crate::integrate::implicit::radau::Scheme;
use crate::integrate::implicit::split::SplitMatrix;
use crate::linalg::{Emit, KnownPivots, Pattern, SparseLu, SparseMatrix};
use crate::math::slices::add_scaled;
use crate::model::Model;
use crate::system::{Numbering, bodies, flexible};

/// The coupled matrix of the present step, and workspace that all functions share.
pub(super) struct BackwardStage<'a> {
    model: &'a Model<f64>,
    numbering: &'a Numbering,
    scheme: &'a Scheme,
    equations: Equations<'a, f64>,
    blocks: Blocks,
    matrix: SparseMatrix<f64>,
    factors: SparseLu<f64>,
    /// By function: cotangents of the increments, and the adjoint of all stages.
    by: Vec<Vec<Pair>>,
    psi: Vec<Vec<f64>>,
    /// Cotangents of the rates of a stage by its adjoint, and that in velocity numbering.
    own: Pair,
    part: Vec<f64>,
    /// By stage: derivative of its equations in its state, times the adjoint.
    changes: Vec<Vec<f64>>,
}

/// Blocks of the coupled matrix, each in the unknowns of one stage.
struct Blocks {
    /// The matrix of each stage.
    stages: Vec<SplitMatrix>,
    /// Derivatives of the rates of stage i in the increments of stage j; all i for the first j.
    beside: Vec<SparseMatrix<f64>>,
}

impl Blocks {
    fn new(equations: &mut Equations<f64>, scheme: &Scheme, zero: &Stage<f64>) -> Self {
        let one = SplitMatrix::new(equations, zero);
        let count = scheme.stages();
        Self {
            beside: vec![one.rates.clone(); count * count],
            stages: vec![one; count],
        }
    }

    /// Assembles all blocks at the stages of a step of size h.
    fn assemble(&mut self, equations: &mut Equations<f64>, stages: &[Stage<f64>], h: f64) {
        for (i, stage) in stages.iter().enumerate() {
            self.stages[i].assemble(equations, &stage.instant(), h);
            for (j, other) in stages.iter().enumerate().filter(|(j, _)| *j != i) {
                self.beside[i * stages.len() + j]
                    .assemble(|emit| equations.emit_rates(&stage.q, &other.q, emit));
            }
        }
    }

    /// Emits the matrix of all stages.
    fn emit(&self, scheme: &Scheme, emit: &mut dyn Emit<f64>) {
        let count = self.stages.len();
        for (i, own) in self.stages.iter().enumerate() {
            let n = own.held.pattern.order();
            own.held.emit((i * n, i * n), 1.0, emit);
            for j in 0..count {
                let block = match j == i {
                    true => &own.rates,
                    false => &self.beside[i * count + j],
                };
                block.emit((i * n, j * n), scheme.rates[i][j], emit);
            }
        }
    }
}

impl<'a> BackwardStage<'a> {
    pub fn new(model: &'a Model<f64>, numbering: &'a Numbering, scheme: &'a Scheme) -> Self {
        let mut equations = Equations::new(model, numbering);
        let zero = Stage::zero(numbering);
        let blocks = Blocks::new(&mut equations, scheme, &zero);
        let (count, length) = (scheme.stages(), equations.length());
        let order = count * equations.order();
        let one = blocks.stages[0].held.pattern.known_pivots();
        let of_stages = |pivots: &[(usize, usize)]| {
            let n = order / count;
            let stages = |&(row, column): &(usize, usize)| {
                (0..count).map(move |i| (i * n + row, i * n + column))
            };
            pivots.iter().flat_map(stages).collect()
        };
        let known = one.map_or_else(KnownPivots::default, |one| KnownPivots {
            short: of_stages(&one.short),
            inner: of_stages(&one.inner),
        });
        let pattern = Pattern::record(order, |emit| blocks.emit(scheme, emit))
            .with_pivots(known)
            .with_team(flexible::team(model));
        Self {
            model,
            numbering,
            scheme,
            equations,
            blocks,
            factors: SparseLu::new(&pattern),
            matrix: SparseMatrix::new(pattern),
            by: Vec::new(),
            psi: Vec::new(),
            own: pair(numbering),
            part: vec![0.0; length],
            changes: vec![vec![0.0; length]; count],
        }
    }

    /// Moves all functions from the end of the step to its start.
    ///
    /// # Errors
    /// The equation with a singular matrix.
    pub fn step(
        &mut self,
        step: &Step,
        sweeps: &mut [Sweep],
        counts: &mut WorkCounts,
    ) -> Result<(), String> {
        let (model, numbering, scheme) = (self.model, self.numbering, self.scheme);
        let (nv, n) = (numbering.velocities(), self.equations.order());
        let (stages, h, growth) = (step.stages(), step.size, step.growth);
        let equations = &mut self.equations;
        if let Some(rows) = step.left_out {
            equations.leave_out(rows);
        }
        self.blocks.assemble(equations, stages, h);
        let blocks = &self.blocks;
        self.matrix.assemble(|emit| blocks.emit(scheme, emit));
        self.factors
            .factorise(&self.matrix)
            .map_err(|singular| equations.describe_reduced(singular.column % n))?;
        counts.factorisations += 1;
        let last = stages.len() - 1;
        let (order, part) = (self.matrix.pattern.order(), &mut self.part);
        self.psi.resize_with(sweeps.len(), || vec![0.0; order]);
        self.by
            .resize_with(sweeps.len(), || vec![pair(numbering); stages.len()]);
        for ((sweep, psi), by) in sweeps.iter_mut().zip(&mut self.psi).zip(&mut self.by) {
            // The first memory vector of a formula is the increment of the step.
            let newest = &mut sweep.increments[last];
            let newest = [&mut newest.0, &mut newest.1];
            for (memory, increment) in sweep.memory.iter_mut().zip(newest) {
                if let Some(newest) = memory.first_mut() {
                    add_scaled(increment, 1.0, newest);
                    newest.fill(0.0);
                    memory.rotate_left(1);
                }
            }
            // By the increments Z_j: their own contribution and that of the rates.
            for (by, own) in by.iter_mut().zip(&sweep.increments) {
                copy(by, own);
            }
            spread(scheme, last, &sweep.rates, h, by);
            for (j, (stage, by)) in stages.iter().zip(&*by).enumerate() {
                let total = &mut self.own;
                copy(total, by);
                if j == last {
                    add_state(total, &sweep.of);
                }
                part.fill(0.0);
                bodies::tangent_of_cotangent(numbering, &stage.q, &total.0, &mut part[..nv]);
                part[nv..2 * nv].copy_from_slice(&total.1);
                part.iter_mut().for_each(|x| *x = -*x);
                equations.scale_columns(h, part);
                equations.compress(part);
                psi[j * n..(j + 1) * n].copy_from_slice(&part[..n]);
            }
        }
        counts.solves += (self.factors).solve_transposed_refined(&self.matrix, &mut self.psi);
        for ((sweep, psi), by) in sweeps.iter_mut().zip(&self.psi).zip(&mut self.by) {
            let mut slope = 0.0;
            for (i, (stage, change)) in stages.iter().zip(&mut self.changes).enumerate() {
                let reduced = &psi[i * n..(i + 1) * n];
                change.fill(0.0);
                let held = &self.blocks.stages[i].held;
                held.multiply_transposed(reduced, &mut change[..n]);
                equations.expand(change);
                equations.unscale_columns(h, change);
                part[..n].copy_from_slice(reduced);
                equations.expand(part);
                equations.scale_rows(h, part);
                let cot = &mut sweep.of.cot.model;
                let held = &mut change[..nv];
                let by_time = equations.pull_back_projected(&stage.instant(), part, cot, held);
                sweep.of.by_duration += (step.rate - growth * (1.0 - scheme.nodes[i])) * by_time;
                let own = &mut self.own;
                rates_of(model, numbering, &stage.q, part, own);
                spread(scheme, i, own, h, by);
                slope += work(own, stage);
            }
            slope += work(&sweep.rates, &stages[last]);
            sweep.of.by_duration -= growth * slope / h;
            add_state(&mut by[last], &sweep.of);
            for ((stage, change), total) in stages.iter().zip(&self.changes).zip(&*by) {
                move_back(sweep, numbering, stage, change, &total.0);
            }
            sweep.of.q.add(1.0, &sweep.before.0);
            sweep.of.v.add(1.0, &sweep.before.1);
            clear(&mut sweep.before);
            clear(&mut sweep.rates);
            sweep.increments.iter_mut().for_each(clear);
        }
        Ok(())
    }
}

/// Adds the cotangent of the rates of stage i to those of the increments.
fn spread(scheme: &Scheme, i: usize, rates: &Pair, h: f64, by: &mut [Pair]) {
    for (by, d) in by.iter_mut().zip(&scheme.rates[i]) {
        add(by, d / h, rates);
    }
}
