//! Newton's method for one implicit step, with the iteration matrix kept while it converges.

use super::failure::IntegrationFailure;
use super::ggl::{Equations, Instant};
use super::trajectory::WorkCounts;
use crate::linalg::{SolveScalar, SparseLu, SparseMatrix};
use crate::math::Scalar;
use crate::model::Model;
use crate::system::{Numbering, assembly, bodies};

/// Error left in a step, relative to the largest increments of position, rotation, velocity and
/// angular velocity in it, at which Newton's method stops: the relative error of accelerations.
const TOLERANCE: f64 = 1e-13;
/// Changes below this, relative to the largest position or velocity, are round-off.
const ROUND_OFF: f64 = 8.0 * f64::EPSILON;
/// Relative change below which a stagnating iteration has reached round-off as well.
const STAGNANT: f64 = 1e-9;
/// Contraction above which the iteration matrix is renewed.
const RENEW: f64 = 0.1;
/// Steps of one iteration each after which the iteration matrix is renewed.
const UNSEEN: usize = 8;
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
    /// Steps in a row that took one iteration, which shows no contraction.
    unseen: usize,
    length: f64,
    gravity: f64,
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
            time: S::zero(),
        };
        let pattern = equations.pattern(&at);
        Self {
            equations,
            numbering,
            factors: SparseLu::new(&pattern),
            matrix: SparseMatrix::new(pattern),
            factored: None,
            contraction: 1.0,
            unseen: 0,
            length: assembly::length_scale(model),
            gravity: largest(model.gravity.as_slice()),
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
        let scales = self.scales(x, h.re());
        let mut previous = f64::INFINITY;
        let (mut polish, mut before) = (false, 0.0_f64);
        for iteration in 1..=ITERATIONS {
            history.rates(&x.dq, &x.dv, &mut self.qdot, &mut self.vdot);
            let at = Instant {
                q: &x.q,
                v: &x.v,
                lambda: &x.lambda,
                mu: &x.mu,
                qdot: &self.qdot,
                vdot: &self.vdot,
                time: h * step as f64,
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
            let size = scales.size(&update[..2 * nv], h.re());
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

            let contraction = match iteration {
                1 => self.contraction,
                // A change after none is round-off or an infinitesimal part: no contraction.
                _ if previous == 0.0 => 0.0,
                _ => size / previous,
            };
            // Contraction alternates between positions and multipliers: trust the worse of two.
            let slow = contraction.max(before);
            let remaining = size * (slow / (1.0 - slow.min(0.9))).min(1.0);
            before = contraction;
            let stagnant =
                iteration > 2 && contraction > RENEW && size <= scales.round_off.max(STAGNANT);
            if polish || remaining <= TOLERANCE || stagnant {
                if S::INFINITESIMAL && !polish {
                    polish = true;
                    previous = size;
                    continue;
                }
                if iteration > 1 && !stagnant {
                    self.contraction = contraction.clamp(1e-3, 1.0);
                }
                // Kept factors that are not seen to converge do not serve for long.
                self.unseen = if iteration == 1 { self.unseen + 1 } else { 0 };
                if self.unseen >= UNSEEN {
                    self.factored = None;
                    self.unseen = 0;
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

    /// What changes are judged against in the step of size `h` that starts from `x`: never less
    /// than what gravity moves in a step, so that a model at rest is not judged by its noise.
    fn scales(&self, x: &Unknowns<S>, h: f64) -> Scales {
        let n = self.numbering;
        let (mut shift, mut turn, mut place) = (0.0_f64, 0.0_f64, self.length);
        for body in 0..n.bodies() {
            let (dq, q) = (&x.dq[n.position(body)..], &x.q[n.position(body)..]);
            shift = shift.max(largest(&dq[..3]));
            place = place.max(largest(&q[..3]));
            turn = turn.max(2.0 * largest(&dq[3..7]));
        }
        let gained = h * self.gravity;
        let mut rates = [[0.0_f64, gained], [0.0, gained / self.length]];
        for (six, now) in x.dv.chunks_exact(6).zip(x.v.chunks_exact(6)) {
            for part in 0..2 {
                rates[part][0] = rates[part][0].max(largest(&six[3 * part..3 * part + 3]));
                rates[part][1] = rates[part][1].max(largest(&now[3 * part..3 * part + 3]));
            }
        }
        let gained = rates[0][0].max(gained);
        Scales {
            parts: [[shift, place], [turn, 1.0], rates[0], rates[1]],
            round_off: if gained > 0.0 {
                ROUND_OFF * place / (h * gained)
            } else {
                0.0
            },
        }
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
            time: h * step as f64,
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

/// For positions, rotations, velocities and angular velocities: the largest increment of the step
/// and the largest value.
struct Scales {
    parts: [[f64; 2]; 4],
    /// What the round-off of positions makes of velocity increments, relative to them.
    round_off: f64,
}

impl Scales {
    /// Largest change relative to the increments, round-off left out, of the scaled update (δy,
    /// h δv); NaN if it is not finite.
    fn size<S: Scalar>(&self, update: &[S], h: f64) -> f64 {
        let (positions, velocities) = update.split_at(update.len() / 2);
        let mut size = 0.0_f64;
        for (half, all, scale) in [(0, positions, 1.0), (2, velocities, 1.0 / h)] {
            for six in all.chunks_exact(6) {
                if six.iter().any(|x| !x.is_finite()) {
                    return f64::NAN;
                }
                for part in 0..2 {
                    let change = largest(&six[3 * part..3 * part + 3]) * scale;
                    let [increment, value] = self.parts[half + part];
                    if change > ROUND_OFF * value.max(increment) {
                        size = size.max(change / increment.max(ROUND_OFF * value));
                    }
                }
            }
        }
        size
    }
}

fn largest<S: Scalar>(x: &[S]) -> f64 {
    x.iter().fold(0.0, |m, x| m.max(x.re().abs()))
}

fn at_residual<S: Scalar>(residual: &[S]) -> Vec<f64> {
    residual
        .iter()
        .map(|x| if x.is_finite() { x.re() } else { f64::NAN })
        .collect()
}
