//! A quadratic subproblem, its solution, and how Clarabel is set.

use std::borrow::Cow;

use clarabel::solver::{DefaultSettings, DefaultSettingsBuilder};
use nalgebra::{DMatrix, DVector};

use crate::linear::jacobian::Jacobian;
use crate::linear::quasi_newton::Spectrum;

/// Tolerance of Clarabel, in scaled units.
const TOLERANCE: f64 = 1e-10;

/// Positive definite matrix of a subproblem.
pub(crate) enum Hessian<'a> {
    Dense(Cow<'a, DMatrix<f64>>),
    Split(Spectrum),
}

impl Hessian<'_> {
    /// σ I of order `n`.
    pub(crate) fn multiple(sigma: f64, n: usize, dense: bool) -> Self {
        if dense {
            return Hessian::Dense(Cow::Owned(DMatrix::from_diagonal_element(n, n, sigma)));
        }
        Hessian::Split(Spectrum {
            sigma,
            vectors: DMatrix::zeros(n, 0),
            values: DVector::zeros(0),
        })
    }

    /// A bound on its entries.
    pub(crate) fn amax(&self) -> f64 {
        match self {
            Hessian::Dense(b) => b.amax(),
            Hessian::Split(b) => b.values.amax().max(b.sigma),
        }
    }

    pub(crate) fn multiply(&self, d: &DVector<f64>) -> DVector<f64> {
        match self {
            Hessian::Dense(b) => b.as_ref() * d,
            Hessian::Split(b) => {
                let mut part = b.vectors.tr_mul(d);
                for (v, lambda) in part.iter_mut().zip(b.values.iter()) {
                    *v *= lambda - b.sigma;
                }
                d * b.sigma + &b.vectors * part
            }
        }
    }
}

/// Data of one subproblem.
pub(crate) struct QpData<'a> {
    pub g: &'a DVector<f64>,
    pub b: &'a Hessian<'a>,
    pub a: &'a Jacobian,
    /// Distances c_U − c and c − c_L of every row; infinite where there is no bound.
    pub above: &'a DVector<f64>,
    pub below: &'a DVector<f64>,
    pub penalty: &'a DVector<f64>,
    /// Box; finite.
    pub lower: &'a DVector<f64>,
    pub upper: &'a DVector<f64>,
}

/// Solution of a subproblem.
#[derive(Clone, Debug)]
pub(crate) struct QpStep {
    pub d: DVector<f64>,
    /// Multipliers of the rows, positive at upper bounds.
    pub y: DVector<f64>,
}

/// Settings of Clarabel.
pub(crate) fn settings() -> Option<DefaultSettings<f64>> {
    DefaultSettingsBuilder::default()
        .verbose(false)
        .presolve_enable(false)
        .max_iter(100)
        .tol_gap_abs(TOLERANCE)
        .tol_gap_rel(TOLERANCE)
        .tol_feas(TOLERANCE)
        .build()
        .ok()
}
