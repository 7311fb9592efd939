//! Newton's method for one implicit step, with the iteration matrix kept while it converges.

use super::failure::IntegrationFailure;
use super::ggl::{Equations, Instant};
use super::trajectory::WorkCounts;
use crate::linalg::{SolveScalar, SparseLu, SparseMatrix};
use crate::math::Scalar;
use crate::model::Model;
use crate::system::{Numbering, bodies, initial};

/// Scaled size of the remaining error of a step at which Newton's method stops: relative to the
/// scene's length scale, and in radians.
const TOLERANCE: f64 = 1e-16;
/// Scaled step below which a stagnating iteration has reached round-off.
const ROUND_OFF: f64 = 1e-12;
/// Contraction above which the iteration matrix is renewed.
const RENEW: f64 = 0.2;
const ITERATIONS: usize = 25;

/// The unknowns of a step: where Newton's method starts, and then its solution.
#[derive(Clone, Debug)]
pub struct Unknowns<S> {
    /// Positions.
    pub q: Vec<S>,
    /// Velocities.
    pub v: Vec<S>,
    /// Increment of q since the last instant. Rates are made from increments, so that they do not
    /// carry the round-off of positions divided by the step.
    pub dq: Vec<S>,
    /// Increment of v since the last instant.
    pub dv: Vec<S>,
    /// Multipliers λ.
    pub lambda: Vec<S>,
    /// Multipliers μ.
    pub mu: Vec<S>,
}

/// How rates follow from increments in this step: q̇ = c dq + `qdot`, v̇ = c dv + `vdot`.
#[derive(Clone, Debug)]
pub struct History<S> {
    /// c = a0 / h.
    pub c: S,
    /// History part of q̇.
    pub qdot: Vec<S>,
    /// History part of v̇.
    pub vdot: Vec<S>,
}

impl<S: Scalar> History<S> {
    /// q̇ and v̇ at the given increments.
    pub fn rates(&self, dq: &[S], dv: &[S], qdot: &mut [S], vdot: &mut [S]) {
        for (out, (&x, &past)) in qdot.iter_mut().zip(dq.iter().zip(&self.qdot)) {
            *out = self.c * x + past;
        }
        for (out, (&x, &past)) in vdot.iter_mut().zip(dv.iter().zip(&self.vdot)) {
            *out = self.c * x + past;
        }
    }
}

/// Newton's method with everything that it needs again in every step.
pub struct Newton<'a, S> {
    equations: Equations<'a, S>,
    numbering: &'a Numbering,
    matrix: SparseMatrix<S>,
    factors: SparseLu<S>,
    /// c h of the kept factors, or `None`.
    factored: Option<S>,
    /// Contraction seen with the kept factors.
    contraction: f64,
    length: f64,
    residual: Vec<S>,
    qdot: Vec<S>,
    vdot: Vec<S>,
}

impl<'a, S: SolveScalar> Newton<'a, S> {
    /// Plans the solution of the model's equations.
    pub fn new(model: &'a Model<S>, numbering: &'a Numbering) -> Self {
        let mut equations = Equations::new(model, numbering);
        let order = equations.order();
        let zeros = vec![S::zero(); order.max(numbering.positions())];
        let at = Instant {
            q: &zeros[..numbering.positions()],
            v: &zeros[..numbering.velocities()],
            lambda: &zeros[..numbering.constraints()],
            mu: &zeros[..numbering.constraints()],
            qdot: &zeros[..numbering.positions()],
            vdot: &zeros[..numbering.velocities()],
        };
        let pattern = equations.pattern(&at);
        Self {
            equations,
            numbering,
            factors: SparseLu::new(&pattern),
            matrix: SparseMatrix::new(pattern),
            factored: None,
            contraction: 1.0,
            length: initial::length_scale(model),
            residual: vec![S::zero(); order],
            qdot: vec![S::zero(); numbering.positions()],
            vdot: vec![S::zero(); numbering.velocities()],
        }
    }

    /// Solves the equations of step `step` of size `h`, starting from and ending in `x`.
    ///
    /// # Errors
    /// Stalled, singular or not finite, with the time and the worst equation by name.
    pub fn solve(
        &mut self,
        x: &mut Unknowns<S>,
        history: &History<S>,
        h: S,
        step: usize,
        counts: &mut WorkCounts,
    ) -> Result<(), IntegrationFailure> {
        let numbering = self.numbering;
        let (nv, nc) = (numbering.velocities(), numbering.constraints());
        let mut previous = f64::INFINITY;
        let mut polish = false;
        for iteration in 1..=ITERATIONS {
            history.rates(&x.dq, &x.dv, &mut self.qdot, &mut self.vdot);
            let at = Instant {
                q: &x.q,
                v: &x.v,
                lambda: &x.lambda,
                mu: &x.mu,
                qdot: &self.qdot,
                vdot: &self.vdot,
            };
            self.equations.residual(&at, h, &mut self.residual);
            // A derivative converges with the exact matrix only.
            let fresh = S::INFINITESIMAL || self.factored != Some(history.c * h);
            if fresh {
                let (equations, matrix) = (&mut self.equations, &mut self.matrix);
                matrix.assemble(|emit| equations.jacobian(&at, h, history.c, emit));
                self.factored = None;
                self.factors.factorise(matrix).map_err(|singular| {
                    IntegrationFailure::Singular {
                        time: h.re() * step as f64,
                        step,
                        place: equations.describe(singular.column),
                    }
                })?;
                counts.factorisations += 1;
                self.factored = Some(history.c * h);
            }
            counts.newton_iterations += 1;
            counts.solves += 1;
            let mut update = std::mem::take(&mut self.residual);
            self.factors.solve(&mut update);
            let size = self.size(&update[..2 * nv]);
            if !size.is_finite() {
                let time = h.re() * step as f64;
                self.residual = update;
                return Err(self.not_finite(&at_residual(&self.residual), time, step));
            }
            for u in &mut update {
                *u = -*u;
            }
            bodies::advance(numbering, &mut x.q, &mut x.dq, &update[..nv]);
            for i in 0..nv {
                let change = update[nv + i] / h;
                x.v[i] += change;
                x.dv[i] += change;
            }
            for i in 0..nc {
                x.lambda[i] += update[2 * nv + i] / (h * h);
                x.mu[i] += update[2 * nv + nc + i] / h;
            }
            self.residual = update;

            let contraction = if iteration > 1 {
                size / previous
            } else {
                self.contraction
            };
            let remaining = size * (contraction / (1.0 - contraction.min(0.9))).min(1.0);
            let stagnant = iteration > 2 && contraction > RENEW && size <= ROUND_OFF;
            if polish || remaining <= TOLERANCE || stagnant {
                if S::INFINITESIMAL && !polish {
                    polish = true;
                    previous = size;
                    continue;
                }
                if iteration > 1 && !stagnant {
                    self.contraction = contraction.clamp(1e-3, 1.0);
                }
                return Ok(());
            }
            if iteration > 1 && contraction > RENEW {
                self.factored = None;
            }
            if fresh {
                self.contraction = 1e-2;
            }
            previous = size;
        }
        Err(self.stalled(x, history, h, step))
    }

    /// Largest scaled change of a position or velocity.
    fn size(&self, update: &[S]) -> f64 {
        let mut size = 0.0_f64;
        for six in update.chunks_exact(6) {
            let linear = six[..3].iter().fold(0.0_f64, |m, x| m.max(x.re().abs()));
            let angular = six[3..].iter().fold(0.0_f64, |m, x| m.max(x.re().abs()));
            if six.iter().any(|x| !x.is_finite()) {
                return f64::NAN;
            }
            size = size.max(linear / self.length).max(angular);
        }
        size
    }

    fn not_finite(&self, residual: &[f64], time: f64, step: usize) -> IntegrationFailure {
        let row = residual.iter().position(|x| !x.is_finite()).unwrap_or(0);
        IntegrationFailure::NotFinite {
            time,
            step,
            worst: self.equations.describe(row),
        }
    }

    fn stalled(
        &mut self,
        x: &Unknowns<S>,
        history: &History<S>,
        h: S,
        step: usize,
    ) -> IntegrationFailure {
        history.rates(&x.dq, &x.dv, &mut self.qdot, &mut self.vdot);
        let at = Instant {
            q: &x.q,
            v: &x.v,
            lambda: &x.lambda,
            mu: &x.mu,
            qdot: &self.qdot,
            vdot: &self.vdot,
        };
        self.equations.residual(&at, h, &mut self.residual);
        let rows = at_residual(&self.residual);
        let worst = (0..rows.len())
            .reduce(|w, i| if rows[i].abs() > rows[w].abs() { i } else { w })
            .unwrap_or(0);
        IntegrationFailure::NewtonStalled {
            time: h.re() * step as f64,
            step,
            iterations: ITERATIONS,
            residual: rows[worst].abs(),
            worst: self.equations.describe(worst),
        }
    }
}

fn at_residual<S: Scalar>(residual: &[S]) -> Vec<f64> {
    residual
        .iter()
        .map(|x| if x.is_finite() { x.re() } else { f64::NAN })
        .collect()
}
