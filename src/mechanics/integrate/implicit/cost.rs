//! What the factors of a step of finite elements cost.

use super::ggl::Equations;
use super::solver::starting_stage;
use crate::integrate::Trajectory;
use crate::linalg::{SparseLu, SparseMatrix};
use crate::model::Model;
use crate::system::flexible;

/// Size of the matrix of a step, or of a stage, and of its factors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FactorCost {
    /// Unknowns of the matrix.
    pub unknowns: usize,
    /// Entries of the matrix.
    pub entries: usize,
    /// Entries of both factors.
    pub factors: usize,
    /// Floating-point operations of a factorisation.
    pub operations: usize,
}

/// Factorises the matrix of a step at the start of a run. `None` without finite elements, or if it is singular.
pub fn factor_cost(model: &Model<f64>, run: &Trajectory<f64>) -> Option<FactorCost> {
    if !flexible::has_shells(model) {
        return None;
    }
    let numbering = &run.numbering;
    let stage = starting_stage(numbering, &run.initial);
    let h = run.duration * run.grid.width(1);
    let mut equations = Equations::new(model, numbering);
    equations.leave_out(&run.initial.left_out);
    let mut matrix = SparseMatrix::new(equations.pattern(&stage.instant()));
    matrix.assemble(|emit| equations.jacobian(&stage.instant(), h, 1.0 / h, emit));
    let mut factors = SparseLu::new(&matrix.pattern);
    factors.factorise(&matrix).ok()?;
    let (entries, operations) = factors.cost();
    Some(FactorCost {
        unknowns: equations.order(),
        entries: matrix.pattern.entries(),
        factors: entries,
        operations,
    })
}
