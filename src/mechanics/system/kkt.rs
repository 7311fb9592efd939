//! The saddle-point systems [B Gᵀ; G 0] of projections and accelerations, and their transposed
//! derivatives.

use super::attachment;
use super::bodies::BodyMotion;
use super::constraint::RowGradient;
use super::flexible;
use super::in_motion::InMotion;
use super::joints;
use super::numbering::Numbering;
use super::reduce::{emit_reduced, through, unreduced};
use super::redundant_rows::RedundantRows;
use crate::linalg::{
    Emit, KnownPivots, Pattern, Pivots, SingularMatrix, SolveScalar, SparseLu, SparseMatrix,
};
use crate::math::{Mat3, Scalar};
use crate::model::Model;
use std::sync::Arc;

/// Emits Gᵀ at (`row`, `column`), in velocity numbering.
pub fn emit_transposed_gradients<S: Scalar>(
    model: &Model<S>,
    numbering: &Numbering,
    gradients: &[RowGradient<S>],
    (row, column): (usize, usize),
    scale: S,
    emit: &mut dyn Emit<S>,
) {
    for (j, joint) in model.joints.iter().enumerate() {
        for (i, kind) in numbering.rows(j).zip(joint.rows()) {
            let (g, at) = (&gradients[i], row + numbering.velocity(joint.body_a));
            if let Some(k) = kind.ground_component() {
                emit.add(at + k, column + i, g.force[k] * scale);
            } else if kind.has_force() {
                emit.add_column(at, column + i, &(g.force * scale));
            }
            emit.add_column(at + 3, column + i, &(g.torque_a * scale));
            if let Some(body) = joint.body_b {
                let at = row + numbering.velocity(body);
                if let Some(k) = kind.ground_component() {
                    emit.add(at + k, column + i, g.force[k] * -scale);
                } else if kind.has_force() {
                    emit.add_column(at, column + i, &(g.force * -scale));
                }
                emit.add_column(at + 3, column + i, &(g.torque_b * scale));
            }
            if let Some(modes) = &joint.modes {
                for (slot, x) in attachment::elastic_gradient(modes, numbering, g.local()) {
                    emit.add(row + slot, column + i, x * scale);
                }
            }
        }
    }
}

/// Emits G at (`row`, `column`).
pub fn emit_gradients<S: Scalar>(
    model: &Model<S>,
    numbering: &Numbering,
    gradients: &[RowGradient<S>],
    (row, column): (usize, usize),
    emit: &mut dyn Emit<S>,
) {
    let mut transposed = Transposed(emit);
    let at = (column, row);
    emit_transposed_gradients(model, numbering, gradients, at, S::one(), &mut transposed);
}

/// Emits every entry with row and column exchanged.
struct Transposed<'a, S>(&'a mut dyn Emit<S>);

impl<S: Scalar> Emit<S> for Transposed<'_, S> {
    fn add(&mut self, row: usize, column: usize, value: S) {
        self.0.add(column, row, value);
    }
}

/// Emits the derivative of Gᵀλ in the tangent positions, times `scale`, at (`row`, `column`).
pub fn emit_reaction_jacobian<S: Scalar>(
    at: &InMotion<S>,
    lambda: &[S],
    (row, column): (usize, usize),
    scale: S,
    emit: &mut dyn Emit<S>,
) {
    let numbering = at.numbering;
    for (j, joint) in at.model.joints.iter().enumerate() {
        let lambda = &lambda[numbering.rows(j)];
        let k = joints::reaction_jacobian(joint, (at.motions, at.time), lambda);
        let slides = joint.rows().any(|kind| kind.depends_on_distance());
        let stretches = joint.rows().any(|kind| kind.follows_distance());
        let turns = joint.rows().any(|kind| kind.couples_rotations());
        let a = numbering.velocity(joint.body_a);
        let (ra, ca) = (row + a, column + a);
        emit.add_block(ra + 3, ca + 3, &(k.a_by_a * scale));
        if slides {
            emit.add_block(ra, ca + 3, &(k.force_by_a * scale));
            emit.add_block(ra + 3, ca, &(k.a_by_position * scale));
        }
        if stretches {
            emit.add_block(ra, ca, &(k.force_by_position * scale));
        }
        if let Some(body) = joint.body_b {
            let b = numbering.velocity(body);
            let (rb, cb) = (row + b, column + b);
            emit.add_block(rb + 3, cb + 3, &(k.b_by_b * scale));
            if slides {
                emit.add_block(rb, ca + 3, &(k.force_by_a * -scale));
                emit.add_block(ra + 3, cb, &(k.a_by_position * -scale));
            }
            if stretches {
                emit.add_block(ra, cb, &(k.force_by_position * -scale));
                emit.add_block(rb, ca, &(k.force_by_position * -scale));
                emit.add_block(rb, cb, &(k.force_by_position * scale));
                emit.add_block(ra, cb + 3, &(k.force_by_b * scale));
                emit.add_block(rb, cb + 3, &(k.force_by_b * -scale));
                emit.add_block(rb + 3, ca, &(k.b_by_position * scale));
                emit.add_block(rb + 3, cb, &(k.b_by_position * -scale));
            }
            if turns {
                emit.add_block(ra + 3, cb + 3, &(k.a_by_b * scale));
                emit.add_block(rb + 3, ca + 3, &(k.b_by_a * scale));
            }
        }
        let Some(modes) = &joint.modes else { continue };
        if let (Some((slot, x)), [lambda]) = (joints::curvature(joint, at), lambda) {
            emit.add(row + slot, column + slot, x * *lambda * scale);
        }
        for (slot, by_a, by_b) in joints::elastic_reactions(joint, modes, at, lambda) {
            let body_b = joint.body_b.map(|body| (body, by_b));
            for (body, by) in [(joint.body_a, by_a)].into_iter().chain(body_b) {
                let place = numbering.velocity(body) + 3;
                emit.add_column(row + place, column + slot, &(by * scale));
                emit.add_row(row + slot, column + place, &(by * scale));
            }
        }
    }
}

/// The upper left block B: linear and angular 3 × 3 blocks of a body.
pub struct BodyBlocks<S> {
    /// Linear.
    pub linear: S,
    /// Angular.
    pub angular: Mat3<S>,
}

/// The terms of flexible bodies in the upper left block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Metric {
    /// Their mass matrix.
    Mass,
    /// The second derivative of the displacement that the assembly makes least.
    Displacement,
}

/// Summary of the elimination of a matrix of the index-1 equations.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EliminationSummary {
    /// Order of the matrix: unknowns of the bodies, and rows.
    pub order: usize,
    /// Bodies in the order of elimination; `None` if a sparse factorisation is used.
    pub bodies: Option<Vec<usize>>,
    /// Joints that close loops, eliminated last; empty if a sparse factorisation is used.
    pub closing: Vec<usize>,
    /// Numbers of entries of the sparse matrix and of its factors.
    pub fill: Option<(usize, usize)>,
    /// Number of floating-point operations of a factorisation.
    pub operations: usize,
}

/// The matrix [B + (Gᵀs)_y, Gᵀ; G, 0] in the unknowns of the bodies, and its factors. Vectors have
/// length n_v + n_c.
pub struct SaddlePoint<S> {
    numbering: Numbering,
    matrix: SparseMatrix<S>,
    factors: SparseLu<S>,
    gradients: Vec<RowGradient<S>>,
    /// Redundant rows, which are not imposed.
    left_out: RedundantRows,
    /// Number of factorisations so far.
    pub factorisations: usize,
}

impl<S: SolveScalar> SaddlePoint<S> {
    /// Plans the matrix for a model.
    pub fn new(model: &Model<S>, numbering: &Numbering) -> Self {
        let motions = vec![BodyMotion::ground(); numbering.bodies()];
        let mut gradients = Vec::new();
        let at = InMotion::new(model, numbering, &motions, S::zero());
        joints::gradients(&at, &mut gradients);
        let zeros = vec![S::zero(); numbering.constraints()];
        let left_out = RedundantRows::of(model, numbering);
        let order = numbering.unknowns() + numbering.constraints();
        let block = |_| BodyBlocks {
            linear: S::one(),
            angular: Mat3::identity(),
        };
        let pattern = Pattern::record(order, |emit: &mut dyn Emit<S>| {
            emit_reduced(numbering, 1, emit, |emit| {
                let rows = (&gradients[..], &left_out);
                emit_saddle_point(&at, rows, &zeros, (block, Metric::Mass), emit);
            });
        });
        let nodal = flexible::nodal_unknowns(model, numbering);
        let pattern = pattern.with_pivots(KnownPivots {
            short: Vec::new(),
            inner: nodal.into_iter().map(|i| (i, i)).collect(),
        });
        let factors = SparseLu::new(&pattern);
        Self {
            numbering: numbering.clone(),
            matrix: SparseMatrix::new(pattern),
            factors,
            gradients,
            left_out,
            factorisations: 0,
        }
    }

    /// Redundant rows, which are not imposed.
    pub fn left_out(&self) -> &RedundantRows {
        &self.left_out
    }

    /// Sets the redundant rows from the next factorisation on.
    pub fn leave_out(&mut self, left_out: &RedundantRows) {
        self.left_out.clone_from(left_out);
    }

    /// Assembles and factorises at the given positions, multipliers s and body blocks.
    ///
    /// # Errors
    /// [`SingularMatrix`]: redundant constraints, or a motion without inertia.
    pub fn factorise(
        &mut self,
        at: &InMotion<S>,
        multipliers: &[S],
        block: impl Fn(usize) -> BodyBlocks<S>,
        metric: Metric,
    ) -> Result<(), SingularMatrix> {
        let (gradients, left_out) = (&mut self.gradients, &self.left_out);
        joints::gradients(at, gradients);
        left_out.clear_gradients(gradients);
        self.matrix.assemble(|emit| {
            emit_reduced(at.numbering, 1, emit, |emit| {
                let rows = (&gradients[..], left_out);
                emit_saddle_point(at, rows, multipliers, (block, metric), emit);
            });
        });
        self.factorisations += 1;
        let found = self.factors.factorise(&self.matrix);
        found.map_err(|singular| SingularMatrix {
            column: unreduced(at.numbering, 1, singular.column),
        })
    }

    /// The pivots in use.
    pub fn pivots(&mut self) -> Option<Arc<Pivots>> {
        self.factors.pivots()
    }

    /// Sets pivots that were in use for the same system.
    pub fn set_pivots(&mut self, pivots: Option<&Arc<Pivots>>) {
        self.factors.set_pivots(&self.matrix.pattern, pivots);
    }

    /// Summary of the elimination of the matrix.
    ///
    /// # Panics
    /// The matrix was not factorised.
    pub fn elimination(&mut self) -> EliminationSummary {
        let (factor_entries, operations) = self.factors.cost();
        let pattern = &self.matrix.pattern;
        EliminationSummary {
            order: pattern.order(),
            bodies: None,
            closing: Vec::new(),
            fill: Some((pattern.entries(), factor_entries)),
            operations,
        }
    }

    /// Solves the system in place.
    pub fn solve(&mut self, rhs: &mut [S]) {
        self.left_out.clear(&mut rhs[self.numbering.velocities()..]);
        let factors = &mut self.factors;
        through(&self.numbering, 1, rhs, |rhs| factors.solve(rhs));
    }

    /// Solves the transposed system in place, with one step of iterative refinement.
    pub fn solve_transposed(&mut self, rhs: &mut [S]) {
        self.left_out.clear(&mut rhs[self.numbering.velocities()..]);
        let (factors, matrix) = (&mut self.factors, &self.matrix);
        through(&self.numbering, 1, rhs, |rhs| {
            factors.solve_transposed_refined(matrix, &mut [rhs]);
        });
    }
}

fn emit_saddle_point<S: Scalar>(
    here: &InMotion<S>,
    (gradients, left_out): (&[RowGradient<S>], &RedundantRows),
    multipliers: &[S],
    (block, metric): (impl Fn(usize) -> BodyBlocks<S>, Metric),
    emit: &mut dyn Emit<S>,
) {
    let (model, numbering) = (here.model, here.numbering);
    let n = numbering.velocities();
    for body in 0..numbering.bodies() {
        let BodyBlocks { linear, angular } = block(body);
        let at = numbering.velocity(body);
        emit.add_identity(at, at, linear);
        emit.add_block(at + 3, at + 3, &angular);
    }
    match metric {
        Metric::Mass => {
            flexible::emit_mass((model, numbering), here.motions, (0, 0), S::one(), emit);
        }
        Metric::Displacement => flexible::emit_displacement(model, numbering, emit),
    }
    emit_reaction_jacobian(here, multipliers, (0, 0), S::one(), emit);
    emit_transposed_gradients(model, numbering, gradients, (0, n), S::one(), emit);
    emit_gradients(model, numbering, gradients, (n, 0), emit);
    emit_left_out(numbering, left_out, &[(n, n)], emit);
}

/// Emits λ_i = 0 for redundant rows at each of `places`, and zeros for the other rows, so that the
/// pattern serves every choice. Emits nothing if no row is redundant.
pub fn emit_left_out<S: Scalar>(
    numbering: &Numbering,
    left_out: &RedundantRows,
    places: &[(usize, usize)],
    emit: &mut dyn Emit<S>,
) {
    if left_out.is_empty() {
        return;
    }
    for i in 0..numbering.constraints() {
        let value = if left_out.contains(i) { 1.0 } else { 0.0 };
        for (row, column) in places {
            emit.add(row + i, column + i, S::from(value));
        }
    }
}
