//! The iteration matrix as a sum: the derivative in the state, and that in the rates, which is constant
//! in rigid scenes.

use super::Stage;
use super::ggl::{Equations, StepState};
use crate::linalg::SparseMatrix;
use crate::math::Scalar;

/// The iteration matrix K = H + c h B of equations whose rates change by c times the change of the
/// state. H is the matrix with fixed rates. B = (1, M), scaled, is in the rows of kinematics and
/// dynamics. One assembly of H serves every c.
#[derive(Clone, Debug)]
pub struct SplitMatrix {
    /// H.
    pub held: SparseMatrix<f64>,
    /// B, in its own pattern.
    pub rates: SparseMatrix<f64>,
    /// Slots of its entries in H.
    slots: Vec<usize>,
}

impl SplitMatrix {
    /// Plans the matrix of `equations`; `zero` is any of their stages.
    pub fn new(equations: &mut Equations<f64>, zero: &Stage<f64>) -> Self {
        let whole = equations.pattern(&zero.instant());
        let held = SparseMatrix::new(equations.pattern_of_held(&whole, &zero.instant()));
        let mut rates = SparseMatrix::new(equations.pattern_of_rates(&zero.q));
        rates.assemble(|emit| equations.emit_own_rates(&zero.q, emit));
        Self {
            slots: held.pattern.slots_of(&rates.pattern),
            held,
            rates,
        }
    }

    /// Assembles H at an instant in a step of size h.
    pub fn assemble(&mut self, equations: &mut Equations<f64>, at: &StepState<f64>, h: f64) {
        self.held
            .assemble(|emit| equations.held_jacobian(at, h, emit));
        if equations.mass_varies() {
            self.rates
                .assemble(|emit| equations.emit_own_rates(at.q, emit));
        }
    }

    /// Sets `out`, which has the pattern of H, to H + c h B.
    pub fn fill<S: Scalar>(&self, ch: S, out: &mut SparseMatrix<S>) {
        for (out, &value) in out.values.iter_mut().zip(&self.held.values) {
            *out = S::from(value);
        }
        for (&slot, &value) in self.slots.iter().zip(&self.rates.values) {
            out.values[slot] += ch * value;
        }
    }
}
