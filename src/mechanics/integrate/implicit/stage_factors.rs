//! The factors of the coupled stages of Radau IIA: one real and one complex matrix (Hairer & Wanner 1996, section
//! IV.8).

use super::Stage;
use super::backward_error::BackwardError;
use super::ggl::Equations;
use super::radau::Scheme;
use super::split::SplitMatrix;
use super::turned::Turned;
use crate::integrate::work::WorkCounts;
use crate::linalg::{Pivots, SingularMatrix, SparseLu, SparseMatrix};
use crate::math::{Complex64, Scalar};
use crate::system::{Numbering, RedundantRows, flexible};
use std::sync::Arc;

/// The factors serve up to this relative change of the step size.
const SAME_STEP: f64 = 1e-6;

/// Matrices of the modes of the stages, K(s) = H + s B for an eigenvalue s, and their factors.
pub(super) struct StageFactors<'a> {
    /// The equations in real numbers.
    pub(super) equations: Equations<'a, f64>,
    numbering: &'a Numbering,
    scheme: &'a Scheme,
    split: SplitMatrix,
    /// The matrix of the real eigenvalue, or of the error filter if there is none.
    real_mode: Option<(SparseMatrix<f64>, SparseLu<f64>)>,
    complex_mode: (SparseMatrix<Complex64>, SparseLu<Complex64>),
    /// The stage at which the matrices were evaluated, and the step size if their factors serve.
    at: Stage<f64>,
    step: Option<f64>,
    /// With finite elements: the turns since then.
    turned: Turned,
    real_rhs: Vec<f64>,
    complex_rhs: Vec<Complex64>,
}

impl<'a> StageFactors<'a> {
    /// Plans the factors; `estimates` states whether errors will be filtered.
    pub(super) fn new(
        mut equations: Equations<'a, f64>,
        numbering: &'a Numbering,
        scheme: &'a Scheme,
        estimates: bool,
    ) -> Self {
        let at = Stage::zero(numbering);
        let split = SplitMatrix::new(&mut equations, &at);
        let pattern = split.held.pattern.clone();
        let n = equations.length();
        Self {
            real_mode: (scheme.modes[0].is_real() || estimates).then(|| {
                let matrix = SparseMatrix::new(pattern.clone());
                (matrix, SparseLu::new(&pattern))
            }),
            complex_mode: {
                let factors = SparseLu::new(&pattern);
                (SparseMatrix::new(pattern), factors)
            },
            turned: match flexible::has_shells(equations.model()) {
                true => Turned::new(equations.model(), numbering),
                false => Turned::default(),
            },
            equations,
            numbering,
            scheme,
            split,
            at,
            step: None,
            real_rhs: vec![0.0; n],
            complex_rhs: vec![Complex64::new(0.0, 0.0); n],
        }
    }

    /// Whether there are factors for steps of size h.
    pub(super) fn serve(&self, h: f64) -> bool {
        self.step
            .is_some_and(|made| (made - h).abs() < SAME_STEP * made)
    }

    /// The stage and the step size of the factors.
    pub(super) fn made(&self) -> Option<(Stage<f64>, f64)> {
        self.step.map(|h| (self.at.clone(), h))
    }

    /// Discards the factors.
    pub(super) fn forget(&mut self) {
        self.step = None;
    }

    /// Leaves out redundant rows.
    pub(super) fn leave_out(&mut self, left_out: &RedundantRows) {
        self.equations.leave_out(left_out);
        self.step = None;
    }

    /// Pivots of the real and of the complex matrix.
    pub(super) fn pivots(&mut self) -> [Option<Arc<Pivots>>; 2] {
        let real = self.real_mode.as_mut();
        [
            real.and_then(|(_, factors)| factors.pivots()),
            self.complex_mode.1.pivots(),
        ]
    }

    /// Sets the pivots of the next factors.
    pub(super) fn set_pivots(&mut self, [real, complex]: &[Option<Arc<Pivots>>; 2]) {
        if let Some((matrix, factors)) = &mut self.real_mode {
            factors.set_pivots(&matrix.pattern, real.as_ref());
        }
        let (matrix, factors) = &mut self.complex_mode;
        factors.set_pivots(&matrix.pattern, complex.as_ref());
    }

    /// Assembles and factorises for steps of size h at the stage that `set` writes; fits the backward errors
    /// to the matrices.
    ///
    /// # Errors
    /// A singular matrix.
    pub(super) fn make(
        &mut self,
        h: f64,
        set: impl FnOnce(&mut Stage<f64>),
        backward: Option<&mut BackwardError>,
        counts: &mut WorkCounts,
    ) -> Result<(), SingularMatrix> {
        set(&mut self.at);
        let Self {
            scheme,
            split,
            real_mode,
            complex_mode,
            ..
        } = self;
        self.turned.clear();
        split.assemble(&mut self.equations, &self.at.instant(), h);
        if let Some(backward) = backward {
            let largest = scheme.modes.iter().map(|mode| mode.value.norm());
            let rates = largest.fold(0.0, f64::max);
            let at = (&self.at, h);
            let parts = [(1.0, &split.held), (rates, &split.rates)];
            backward.fit(&self.equations, self.numbering, at, &parts);
        }
        // The matrix is affine in the eigenvalue.
        let mut found = Ok(());
        for mode in &scheme.modes {
            counts.factorisations += 1;
            let factors = if let (true, Some((matrix, factors))) = (mode.is_real(), &mut *real_mode)
            {
                split.fill(mode.value.re, matrix);
                factors.factorise(matrix)
            } else {
                let (matrix, factors) = &mut *complex_mode;
                split.fill(mode.value, matrix);
                factors.factorise(matrix)
            };
            found = found.and(factors);
        }
        if let (false, Some((matrix, factors))) = (scheme.modes[0].is_real(), real_mode) {
            split.fill(1.0 / scheme.error.0, matrix);
            counts.factorisations += 1;
            found = found.and(factors.factorise(matrix));
        }
        self.step = found.is_ok().then_some(h);
        found
    }

    /// Turns the factors with the bodies, which are at q now.
    pub(super) fn turn_to(&mut self, q: &[f64]) {
        let turn = (&self.at.q[..], q);
        self.turned
            .set(self.numbering, turn, self.equations.left_out());
    }

    /// Adds the updates by one part of the residuals: x_i −= Σ r_i K⁻¹ Σ l_j F_j over the modes and
    /// the conjugates of complex ones.
    pub(super) fn update<S: Scalar>(
        &mut self,
        residuals: &[Vec<S>],
        updates: &mut [Vec<S>],
        part: impl Fn(S) -> f64,
        whole: impl Fn(f64) -> S,
    ) {
        for mode in &self.scheme.modes {
            if let (true, Some((_, factors))) = (mode.is_real(), &mut self.real_mode) {
                self.real_rhs.fill(0.0);
                for (residual, l) in residuals.iter().zip(&mode.left) {
                    for (out, &x) in self.real_rhs.iter_mut().zip(residual) {
                        *out += l.re * part(x);
                    }
                }
                let rhs = &mut self.real_rhs;
                self.turned
                    .through(&self.equations, rhs, |x| factors.solve(x));
                for (update, r) in updates.iter_mut().zip(&mode.right) {
                    for (out, &x) in update.iter_mut().zip(&self.real_rhs) {
                        *out -= whole(r.re * x);
                    }
                }
            } else {
                self.complex_rhs.fill(Complex64::new(0.0, 0.0));
                for (residual, l) in residuals.iter().zip(&mode.left) {
                    for (out, &x) in self.complex_rhs.iter_mut().zip(residual) {
                        *out += l * part(x);
                    }
                }
                let (rhs, factors) = (&mut self.complex_rhs, &mut self.complex_mode.1);
                self.turned
                    .through(&self.equations, rhs, |x| factors.solve(x));
                for (update, r) in updates.iter_mut().zip(&mode.right) {
                    for (out, x) in update.iter_mut().zip(&self.complex_rhs) {
                        *out -= whole(2.0 * (r * x).re);
                    }
                }
            }
        }
    }

    /// Solves with the real matrix, in place.
    pub(super) fn filter(&mut self, rhs: &mut [f64]) {
        if let Some((_, factors)) = &mut self.real_mode {
            self.turned
                .through(&self.equations, rhs, |x| factors.solve(x));
        }
    }

    /// The smallest pivot of a multiplier, and its column. Stiff forces also cause small pivots, but in the rows
    /// of bodies.
    pub(super) fn smallest_pivot(&mut self) -> (f64, usize) {
        let first = self.equations.order() - 2 * self.numbering.constraints();
        let complex = self.complex_mode.1.smallest_pivot(first);
        let real = self.real_mode.as_mut();
        let real = real.map_or(complex, |(_, factors)| factors.smallest_pivot(first));
        if real.0 < complex.0 { real } else { complex }
    }
}
