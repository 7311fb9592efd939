//! What a later run needs to continue from where an earlier one ended.

use serde::{Deserialize, Serialize};

use super::outcome::{Multipliers, Scaling};
use super::quasi_newton::QuasiNewton;

/// State of the solver, in a form that can be stored.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SavedState {
    /// Point, in the units of the user.
    pub x: Vec<f64>,
    /// Multipliers, in the units of the user.
    pub multipliers: Multipliers,
    /// Scale factors that belong to the quasi-Newton matrix.
    pub scaling: Scaling,
    /// Quasi-Newton matrix in scaled variables without the fixed ones.
    pub quasi_newton: QuasiNewton,
    /// Barrier parameter.
    pub barrier: f64,
    /// Radius of the trust region.
    pub radius: f64,
}
