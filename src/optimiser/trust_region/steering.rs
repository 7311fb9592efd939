//! The subproblem of a trust region, with penalties that lead towards feasible points
//! (Byrd, Lopez-Calva & Nocedal 2012) and fall again to ten times the multipliers.

use std::borrow::Cow;

use nalgebra::DVector;

use crate::constants::HALF_OF_DIGITS;
use crate::least_squares::model::SquaresModel;
use crate::least_squares::subproblem::Fitting;
use crate::linear::quasi_newton::QuasiNewton;
use crate::program::{Derivatives, Point, Program};
use crate::quadratic::data::{Hessian, QpData, QpStep};
use crate::quadratic::elastic::ElasticQp;

/// Share of the best possible reduction of the linearised violation that a step must reach.
const STEERING: f64 = 0.1;

/// What the iteration minimises.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Goal {
    /// Objective and violation.
    Optimum,
    /// Violation alone. Steps keep the share 0.01 of every distance to a bound.
    Feasibility,
}

/// State of the iteration.
pub(crate) struct TrustRegion {
    pub point: Point,
    pub slopes: Derivatives,
    /// Multipliers of the rows from the last subproblem.
    pub y: DVector<f64>,
    pub b: QuasiNewton,
    /// The model of a sum of squares, which takes the place of `b`.
    pub(crate) squares: Option<SquaresModel>,
    pub radius: f64,
    pub(crate) goal: Goal,
    pub(crate) penalty: DVector<f64>,
    /// Successive tests at which a row dominated.
    pub(crate) dominated: usize,
    pub(crate) qp: ElasticQp,
}

/// Trial of one subproblem.
pub(crate) struct Model {
    pub step: QpStep,
    pub predicted: f64,
    /// Whether no step in the trust region reduces the linearised violation.
    pub irreducible: bool,
}

impl TrustRegion {
    /// Subproblem with steering of the penalties.
    pub(crate) fn solve_model(&mut self, program: &mut Program<'_>) -> Option<Model> {
        let c = self.point.c.clone();
        let mut step = self.solve_qp(program, self.weight(), &c)?;
        let now = program.total_violation(&c);
        let mut left = self.linear_violation(program, &step.d);
        let ahead = &c + &self.slopes.a * &step.d;
        let small = 0.01
            * program
                .least_exceeded(&c)
                .min(program.least_exceeded(&ahead));
        let mut irreducible =
            self.goal == Goal::Feasibility && left >= (1.0 - HALF_OF_DIGITS) * now;
        if self.goal == Goal::Optimum && left > small {
            let kept = std::mem::replace(&mut self.penalty, DVector::from_element(c.len(), 1.0));
            let best = self.solve_qp(program, 0.0, &c);
            self.penalty = kept;
            let best = best.map_or(left, |s| self.linear_violation(program, &s.d));
            irreducible = best >= (1.0 - HALF_OF_DIGITS) * now;
            for _ in 0..10 {
                let target = if best <= small {
                    10.0 * small
                } else {
                    now - STEERING * (now - best)
                };
                if left <= target {
                    break;
                }
                for k in 0..c.len() {
                    if self.linear_row_violation(program, &step.d, k) > 0.1 * small {
                        self.penalty[k] *= 10.0;
                    }
                }
                step = self.solve_qp(program, self.weight(), &c)?;
                left = self.linear_violation(program, &step.d);
            }
        }
        if self.goal == Goal::Optimum && left <= small {
            // Penalties that outlive the points which needed them make steps follow curved rows closely: the swing-up
            // of a cart-pole ends at the limit of iterations. The multipliers of one step may mislead.
            for (penalty, y) in self.penalty.iter_mut().zip(step.y.iter()) {
                *penalty = penalty.min((10.0 * y.abs()).max(0.4 * *penalty).max(1.0));
            }
        }
        let d = &step.d;
        let bd = match &self.squares {
            Some(squares) => squares.hessian() * d,
            None => self.b.multiply(d),
        };
        let violation: f64 = (0..c.len())
            .map(|k| {
                let change =
                    program.row_violation(&c, k) - self.linear_row_violation(program, d, k);
                self.penalty[k] * change
            })
            .sum();
        let predicted = violation - self.weight() * self.slopes.g.dot(d) - 0.5 * d.dot(&bd);
        Some(Model {
            step,
            predicted,
            irreducible,
        })
    }

    fn linear_row_violation(&self, program: &Program<'_>, d: &DVector<f64>, k: usize) -> f64 {
        let value = self.point.c[k] + self.slopes.a.row_dot(k, d);
        (program.row_lower[k] - value)
            .max(value - program.row_upper[k])
            .max(0.0)
    }

    pub(crate) fn linear_violation(&self, program: &Program<'_>, d: &DVector<f64>) -> f64 {
        (0..self.point.c.len())
            .map(|k| self.linear_row_violation(program, d, k))
            .sum()
    }

    pub(crate) fn solve_qp(
        &mut self,
        program: &mut Program<'_>,
        weight: f64,
        c: &DVector<f64>,
    ) -> Option<QpStep> {
        let steering = 1e-4 * self.slopes.a.amax() / self.radius.max(1e-8);
        let of_steering = weight != self.weight();
        if let Some(squares) = &self.squares {
            let subproblem = Fitting {
                squares,
                slopes: &self.slopes,
                x: &self.point.x,
                c,
                penalty: &self.penalty,
                radius: self.radius,
                of_rows_alone: of_steering.then_some(steering),
            };
            return subproblem.solve(program, &mut self.qp);
        }
        let keep = if self.goal == Goal::Feasibility {
            0.99
        } else {
            1.0
        };
        let x = &self.point.x;
        let radius = self.radius;
        let lower = DVector::from_fn(x.len(), |i, _| {
            (keep * (program.lower[i] - x[i])).clamp(-radius, 0.0)
        });
        let upper = DVector::from_fn(x.len(), |i, _| {
            (keep * (program.upper[i] - x[i])).clamp(0.0, radius)
        });
        let n = x.len();
        let dense = self.b.is_dense();
        let b = match (of_steering, dense) {
            (true, _) => Hessian::multiple(steering, n, dense),
            (false, true) => Hessian::Dense(Cow::Borrowed(self.b.dense())),
            (false, false) => Hessian::Split(self.b.spectrum()),
        };
        let g = &self.slopes.g * weight;
        let data = QpData {
            g: &g,
            b: &b,
            a: &self.slopes.a,
            above: &(&program.row_upper - c),
            below: &(c - &program.row_lower),
            penalty: &self.penalty,
            lower: &lower,
            upper: &upper,
        };
        self.qp.solve(&data, &mut program.counts)
    }
}
