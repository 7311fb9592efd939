//! Trust-region sequential quadratic programming with an exact penalty function.
//!
//! Byrd, Lopez-Calva & Nocedal (2012), *A line search exact penalty method using steering rules*,
//! for the penalties; Fletcher (1987), *Practical Methods of Optimization*, section 14.4, for the
//! trust region and the second-order correction.

use nalgebra::{DMatrix, DVector};

use crate::constants::{HALF_OF_DIGITS, SUCCESSIVE, SUFFICIENT};
use crate::convergence::{dominant_row, is_solved, kkt, scaled_residual};
use crate::ending::infeasible;
use crate::least_squares::model::SquaresModel;
use crate::linear::quasi_newton::QuasiNewton;
use crate::multipliers::ScaledMultipliers;
use crate::observer::Phase;
use crate::program::{Derivatives, EarlyExit, Point, Program, Progress};
use crate::quadratic::elastic::ElasticQp;
use crate::status::Status;
use crate::trust_region::steering::{Goal, Model, TrustRegion};

impl TrustRegion {
    pub(crate) fn new(
        program: &Program<'_>,
        point: Point,
        slopes: Derivatives,
        goal: Goal,
    ) -> TrustRegion {
        let (n, m) = (point.x.len(), point.c.len());
        let options = program.options;
        let point_size = point.x.amax().max(1.0);
        let mut b = QuasiNewton::new(n, options.dense_subproblems(), options.memory);
        if goal == Goal::Feasibility {
            b.set_scale(1e-4 * slopes.a.amax().max(1e-8));
        }
        TrustRegion {
            qp: ElasticQp::new(n, &program.row_lower, &program.row_upper),
            point,
            slopes,
            y: DVector::zeros(m),
            b,
            radius: options.initial_radius * point_size,
            goal,
            penalty: DVector::from_element(m, 1.0),
            dominated: 0,
            squares: None,
        }
    }

    /// Uses the residuals `r` and their derivatives `j` at the present point.
    pub(crate) fn fit(&mut self, program: &Program<'_>, (r, j): (DVector<f64>, DMatrix<f64>)) {
        let squares = SquaresModel::new(r, j);
        self.radius = program.options.initial_radius * squares.first_radius(&self.point.x);
        self.squares = Some(squares);
    }

    /// Length of a step in the units of the radius.
    fn length(&self, d: &DVector<f64>) -> f64 {
        match &self.squares {
            Some(squares) => squares.length(d),
            None => d.amax(),
        }
    }

    /// Whether the residuals of a fit are orthogonal to all that the variables can change, to `tolerance` relative to
    /// their size (Bates & Watts 1981), or where they vanish to that of the first ones. `model` foretells what is left
    /// to gain. Gradients in the units of the user say less: their round-off is that of large residuals.
    fn is_fitted(&self, program: &Program<'_>, model: &Model, tolerance: f64) -> bool {
        let Some(squares) = &self.squares else {
            return false;
        };
        let first = program.first.as_ref();
        let first = first.map_or(0.0, |(_, f)| f * program.scaling.objective);
        let (worth, f) = (tolerance.powi(2), self.point.f);
        let nothing = f.abs() <= worth * worth * first.abs();
        let z = self.multipliers(program);
        let force = &self.slopes.g + self.slopes.a.tr_mul(&z.y) - &z.zl + &z.zu;
        let gap = kkt(program, &self.point, &self.slopes, &z, 0.0).relative_complementarity;
        program.is_feasible(&self.point.c)
            && gap <= tolerance
            && (nothing
                || model.predicted <= worth * f.abs() && squares.is_orthogonal(&force, tolerance))
    }

    pub(crate) fn weight(&self) -> f64 {
        if self.goal == Goal::Optimum { 1.0 } else { 0.0 }
    }

    /// Multipliers of the whole program at the present point.
    pub(crate) fn multipliers(&self, program: &Program<'_>) -> ScaledMultipliers {
        ScaledMultipliers::polished(program, &self.point, &self.slopes, &self.y)
    }

    /// Iterates until the conditions, or `reached`, hold or no step helps.
    pub(crate) fn iterate(
        &mut self,
        program: &mut Program<'_>,
        mut reached: impl FnMut(&Program<'_>, &Point) -> bool,
    ) -> Result<Status, EarlyExit> {
        let tiny = 1e-13;
        let mut refused = false;
        let mut lost = 0;
        let mut failed = 0;
        loop {
            if self.goal == Goal::Optimum
                && (program.is_unbounded(&self.point)
                    || program.goes_far(&self.point) && program.falls_on(&self.point)?)
            {
                return Ok(Status::Unbounded);
            }
            let Some(model) = self.solve_model(program) else {
                if self.b.is_empty() && self.radius < 1e-6 {
                    return Ok(self.end(program, SUFFICIENT));
                }
                self.b.reset();
                if let Some(squares) = &mut self.squares {
                    squares.reset();
                }
                self.radius *= 0.1;
                continue;
            };
            self.y.copy_from(&model.step.y);
            if model.irreducible
                && let ending @ Status::Infeasible { .. } = self.end(program, HALF_OF_DIGITS)
            {
                return Ok(ending);
            }
            let ending = match &self.squares {
                Some(_) => {
                    let fitted = self.is_fitted(program, &model, program.options.tolerance);
                    fitted.then_some(Status::Converged)
                }
                None => self.ending(program),
            };
            if let Some(ending) = ending {
                return Ok(ending);
            }
            let size = self.length(&model.step.d);
            let stays = program.within_bounds(&self.point.x + &model.step.d) == self.point.x;
            let rounding = f64::EPSILON * self.merit(program, &self.point).abs().max(1e-8);
            lost = if model.predicted <= rounding {
                lost + 1
            } else {
                0
            };
            // What is left to gain is below a thousandth of a standard deviation of every number.
            let nearly = self.is_fitted(program, &model, program.options.tolerance.sqrt());
            if model.predicted <= 0.0 || stays || lost >= SUCCESSIVE || self.radius < tiny {
                return Ok(match nearly {
                    true => Status::Converged,
                    false => self.end(program, SUFFICIENT),
                });
            }
            program.next_iteration()?;
            let (ratio, trials) = self.attempt(program, &model, refused)?;
            // Noise of the functions hides it.
            if nearly && ratio <= SUFFICIENT && ratio != f64::NEG_INFINITY {
                return Ok(Status::Converged);
            }
            let boundary = size >= 0.99 * self.radius;
            let radius = self.radius;
            if ratio < 0.25 {
                // One failed evaluation is no evidence against the model. A second one shows a
                // region.
                failed = if ratio == f64::NEG_INFINITY {
                    failed + 1
                } else {
                    0
                };
                let shrink = match (failed, ratio) {
                    (1, _) => 0.9,
                    (0, r) if r < -1e3 => 0.1,
                    _ => 0.4,
                };
                self.radius = shrink * size.min(self.radius);
            } else {
                failed = 0;
                if ratio > 0.5 && boundary {
                    self.radius *= 2.5;
                }
            }
            if ratio != f64::NEG_INFINITY {
                refused = ratio <= SUFFICIENT;
            }
            let scaled = self.optimality(program);
            let progress = Progress {
                optimality: scaled,
                barrier: 0.0,
                step: size,
                regularisation: radius,
                primal_step: if ratio > SUFFICIENT { 1.0 } else { 0.0 },
                dual_step: 1.0,
                trials,
                phase: if self.goal == Goal::Optimum {
                    Phase::Sqp
                } else {
                    Phase::Restoration
                },
            };
            let point = self.point.clone();
            program.report(&point, &progress)?;
            if ratio > SUFFICIENT && reached(program, &self.point) {
                return Ok(Status::Converged);
            }
            // A fit is judged by its next model.
            if self.squares.is_none()
                && let Some(ending) = self.ending(program)
            {
                return Ok(ending);
            }
        }
    }

    /// Classifies a point without further steps. It is infeasible only if the linearised violation
    /// cannot be reduced by more than `share` in a box of the size of the point.
    fn end(&mut self, program: &mut Program<'_>, share: f64) -> Status {
        if program.is_feasible(&self.point.c) {
            return Status::Stalled;
        }
        let (radius, goal) = (self.radius, self.goal);
        self.radius = self.point.x.amax().max(1.0);
        self.goal = Goal::Optimum;
        let c = self.point.c.clone();
        let kept = std::mem::replace(&mut self.penalty, DVector::from_element(c.len(), 1.0));
        let step = self.solve_qp(program, 0.0, &c);
        (self.radius, self.goal, self.penalty) = (radius, goal, kept);
        let now = program.total_violation(&c);
        match step {
            Some(step) if now - self.linear_violation(program, &step.d) <= share * now => {
                infeasible(program, &self.point)
            }
            _ => Status::Stalled,
        }
    }

    /// Largest scaled residual of the optimality conditions.
    pub(crate) fn optimality(&self, program: &Program<'_>) -> f64 {
        let z = self.multipliers(program);
        scaled_residual(program, &self.point, &self.slopes, &z)
    }

    /// How the run ends at this point, if it does.
    fn ending(&mut self, program: &Program<'_>) -> Option<Status> {
        if self.goal == Goal::Feasibility {
            return None;
        }
        let z = self.multipliers(program);
        let scaled = scaled_residual(program, &self.point, &self.slopes, &z);
        if is_solved(program, &self.point, &self.slopes, &z, scaled) {
            return Some(Status::Converged);
        }
        let dominant =
            dominant_row(program, &self.slopes, &z).filter(|_| program.is_feasible(&self.point.c));
        self.dominated = dominant.map_or(0, |_| self.dominated + 1);
        let constraint = program.constraint_name(dominant?);
        // Each point is tested twice, and each step halves the distance at most.
        (self.dominated > 4 * SUCCESSIVE).then_some(Status::Degenerate { constraint })
    }

    /// Exact penalty function w f + Σ ν_j violation_j.
    fn merit(&self, program: &Program<'_>, at: &Point) -> f64 {
        let violation: f64 = (0..at.c.len())
            .map(|k| self.penalty[k] * program.row_violation(&at.c, k))
            .sum();
        self.weight() * at.f + violation
    }

    /// Tries the step, then its second-order correction; returns the ratio of actual and predicted
    /// reduction and the number of points tried. The state moves if the ratio is acceptable.
    fn attempt(
        &mut self,
        program: &mut Program<'_>,
        model: &Model,
        learn: bool,
    ) -> Result<(f64, usize), EarlyExit> {
        let here = self.merit(program, &self.point);
        let rounding = 10.0 * f64::EPSILON * here.abs();
        let x = program.within_bounds(&self.point.x + &model.step.d);
        let trial = match program.evaluate(&x) {
            Ok(trial) => trial,
            Err(EarlyExit::Failed(_)) => return Ok((f64::NEG_INFINITY, 1)),
            Err(halt) => return Err(halt),
        };
        let ratio = |at: f64| (here - at + rounding) / (model.predicted + rounding);
        let first = ratio(self.merit(program, &trial));
        if first > SUFFICIENT {
            let accepted = self.accept(program, trial)?;
            return Ok((if accepted { first } else { f64::NEG_INFINITY }, 1));
        }
        let worse = program.total_violation(&trial.c) > 0.0;
        if learn && !worse && self.squares.is_none() {
            self.learn(program, &trial)?;
        }
        if !worse || self.goal == Goal::Feasibility {
            return Ok((first, 1));
        }
        let c = &trial.c - &self.slopes.a * &model.step.d;
        let Some(corrected) = self.solve_qp(program, self.weight(), &c) else {
            return Ok((first, 1));
        };
        let x = program.within_bounds(&self.point.x + &corrected.d);
        let second = match program.evaluate(&x) {
            Ok(second) => second,
            Err(EarlyExit::Failed(_)) => return Ok((first, 2)),
            Err(halt) => return Err(halt),
        };
        let gain = ratio(self.merit(program, &second));
        if gain > SUFFICIENT && self.accept(program, second)? {
            return Ok((gain, 2));
        }
        Ok((first, 2))
    }

    /// Adds the curvature between the point and a refused point to the matrix, after the second
    /// refused step in succession. A matrix from few pairs refuses many steps before it knows a
    /// curved valley.
    fn learn(&mut self, program: &mut Program<'_>, trial: &Point) -> Result<(), EarlyExit> {
        let slopes = match program.gradients(&trial.x) {
            Ok(slopes) => slopes,
            Err(EarlyExit::Failed(_)) => return Ok(()),
            Err(halt) => return Err(halt),
        };
        let weight = self.weight();
        let force = |s: &Derivatives| &s.g * weight + s.a.tr_mul(&self.y);
        let change = force(&slopes) - force(&self.slopes);
        self.b.update(&trial.x - &self.point.x, change);
        Ok(())
    }

    /// Moves to `trial` unless its gradients fail.
    fn accept(&mut self, program: &mut Program<'_>, trial: Point) -> Result<bool, EarlyExit> {
        let slopes = match program.gradients(&trial.x) {
            Ok(slopes) => slopes,
            Err(EarlyExit::Failed(_)) => return Ok(false),
            Err(halt) => return Err(halt),
        };
        let weight = self.weight();
        let force = |s: &Derivatives| &s.g * weight + s.a.tr_mul(&self.y);
        let change = force(&slopes) - force(&self.slopes);
        let s = &trial.x - &self.point.x;
        if self.squares.is_some() {
            let residuals = match program.residuals(&trial.x) {
                Ok(Some(residuals)) => residuals,
                Ok(None) | Err(EarlyExit::Failed(_)) => return Ok(false),
                Err(halt) => return Err(halt),
            };
            let of_objective = &slopes.g - &self.slopes.g;
            let of_rows = &change - &of_objective;
            if let Some(squares) = &mut self.squares {
                squares.judge(&self.slopes.g, &s, trial.f - self.point.f);
                squares.advance(residuals, &s, (&of_objective, &of_rows));
            }
        }
        self.b.update(s, change);
        self.point = trial;
        self.slopes = slopes;
        Ok(true)
    }
}
