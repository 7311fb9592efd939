//! Settings of the optimiser.

use serde::{Deserialize, Serialize};

/// Algorithm by which the program is solved.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Method {
    /// Primal–dual interior point with a filter line search.
    #[default]
    InteriorPoint,
    /// Trust-region sequential quadratic programming with elastic subproblems.
    TrustRegion,
    /// Trust region with the model of Gauss and Newton, for a sum of squares
    /// ([`Nlp::residuals`](crate::Nlp::residuals)).
    LeastSquares,
    /// Interior point. If it does not converge, the trust region continues from its best point.
    Auto,
}

/// Rule by which the barrier parameter falls.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Barrier {
    /// Fiacco–McCormick: constant until its subproblem is solved, then superlinearly smaller.
    Monotone,
    /// Chosen at each iteration from a predictor step. Monotone if that makes no progress.
    #[default]
    Adaptive,
}

/// Settings of [`solve`](crate::solve).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Options {
    /// Algorithm (default interior point).
    pub method: Method,
    /// Largest KKT residual of a solution (default 1e-6). It applies in scaled units, relative to
    /// the gradients of the run, and in the units of the user: relative to max(1, ‖∇f‖∞) and, for
    /// the sum of the products of multipliers and distances, to max(1, |f|).
    pub tolerance: f64,
    /// Largest violation of a constraint of a solution, in the units of the user (default 1e-6). It
    /// must also be below 1e-4 of the constraint's size, the larger of its bound and of Σ |∂c/∂x_i
    /// x_i|.
    pub constraint_tolerance: f64,
    /// Iterations allowed (default 500).
    pub max_iterations: usize,
    /// Evaluations of the functions allowed (default 3000).
    pub max_evaluations: usize,
    /// Wall time allowed \[s\] (default unlimited).
    pub max_seconds: Option<f64>,
    /// An objective f that changes by this part of max(1, |f|) from the first point to a feasible one
    /// is called unbounded (default −1e20).
    pub unbounded_below: f64,
    /// Size to which the gradients of objective and equalities at the start are scaled, for a change
    /// of the variables by the size of the start (default 2).
    pub scaling_gradient: f64,
    /// Divide each variable that has two bounds by their distance (default false).
    pub scale_variables: bool,
    /// Rule for the barrier parameter (default adaptive).
    pub barrier: Barrier,
    /// Barrier parameter of the first iteration (default: the adaptive rule chooses it, the monotone
    /// rule begins with 0.1).
    pub initial_barrier: Option<f64>,
    /// Least distance of the start from a bound, relative to max(1, |bound|) and to the distance
    /// of the two bounds (default 1e-2).
    pub bound_push: f64,
    /// Number of variables above which the interior point keeps the quasi-Newton matrix in limited
    /// memory (default 20). The trust region does so above fifteen times as many.
    pub dense_limit: usize,
    /// Pairs of steps and gradient differences kept in limited memory (default 30).
    pub memory: usize,
    /// First radius of the trust region in scaled variables (default 1).
    pub initial_radius: f64,
}

impl Options {
    /// The barrier parameter before the first iteration.
    pub(crate) fn first_barrier(&self) -> f64 {
        self.initial_barrier.unwrap_or(0.1)
    }

    /// Number of variables up to which subproblems of the trust region have a dense matrix. They
    /// cost more than the matrix.
    pub(crate) fn dense_subproblems(&self) -> usize {
        15 * self.dense_limit
    }
}

impl Default for Options {
    fn default() -> Self {
        Self {
            method: Method::default(),
            tolerance: 1e-6,
            constraint_tolerance: 1e-6,
            max_iterations: 500,
            max_evaluations: 3000,
            max_seconds: None,
            unbounded_below: -1e20,
            scaling_gradient: 2.0,
            scale_variables: false,
            barrier: Barrier::default(),
            initial_barrier: None,
            bound_push: 1e-2,
            dense_limit: 20,
            memory: 30,
            initial_radius: 1.0,
        }
    }
}
