//! Evaluations of the scaled program. They are counted, checked and limited, and every failure is
//! recorded.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::Instant;

use nalgebra::{DMatrix, DVector};

use crate::linear::jacobian::Jacobian;
use crate::nlp::{
    Evaluation, EvaluationFailure, Gradients, fault_of_evaluation, fault_of_gradients,
    fault_of_residuals, length_of_evaluation, length_of_gradients,
};
use crate::outcome::FailedDesign;
use crate::program::{Derivatives, EarlyExit, Point, Program};
use crate::status::Status;

/// Largest number of recorded designs with a failed evaluation.
const FAILED_DESIGNS_KEPT: usize = 100;

/// A method ends after so many failures in succession. A step that was halved as often is lost in
/// the tolerances: the point lies at the edge of the region where the functions are defined, or
/// they fail for good.
const MOST_FAILURES: usize = 24;
/// It also ends after so many failures if they are most of its evaluations: it follows the edge.
const AT_THE_EDGE: usize = 60;

/// Scaled residuals and their derivatives in the free variables.
pub(crate) type ScaledResiduals = (DVector<f64>, DMatrix<f64>);

impl Program<'_> {
    /// Values of the scaled functions at `x`.
    pub(crate) fn evaluate(&mut self, x: &DVector<f64>) -> Result<Point, EarlyExit> {
        self.check_limits()?;
        let full = self.to_user(x);
        let clock = Instant::now();
        let mut result = unless_panicked(|| self.nlp.evaluate(&full))?;
        self.counts.evaluation_seconds += clock.elapsed().as_secs_f64();
        self.counts.evaluations += 1;
        if let Ok(e) = &result
            && let Some(what) = length_of_evaluation(self.nlp, e)
        {
            return Err(EarlyExit::Halt(Status::IllPosed { what }));
        }
        if let Ok(e) = &result
            && let Some(fault) = fault_of_evaluation(self.nlp, &self.rows, e)
        {
            result = Err(fault);
        }
        self.unless_interrupted(result.is_err())?;
        let Evaluation {
            objective,
            constraints,
        } = result.map_err(|failure| self.record(full, failure))?;
        self.failures_in_succession = 0;
        let c = self
            .rows
            .iter()
            .map(|&j| constraints[j] * self.scaling.constraints[j]);
        let c = DVector::from_iterator(self.rows.len(), c);
        Ok(Point {
            x: x.clone(),
            f: objective * self.scaling.objective,
            c,
        })
    }

    /// Announces points whose values may be requested next.
    pub(crate) fn foresee(&mut self, points: impl Iterator<Item = DVector<f64>>) {
        let points: Vec<Vec<f64>> = points.map(|x| self.to_user(&x)).collect();
        let clock = Instant::now();
        self.nlp.foresee(&points);
        self.counts.evaluation_seconds += clock.elapsed().as_secs_f64();
    }

    /// Derivatives of the scaled functions at `x`.
    pub(crate) fn gradients(&mut self, x: &DVector<f64>) -> Result<Derivatives, EarlyExit> {
        self.unless_it_fails_for_good()?;
        let full = self.to_user(x);
        let clock = Instant::now();
        let mut result = unless_panicked(|| self.nlp.gradients(&full))?;
        self.counts.evaluation_seconds += clock.elapsed().as_secs_f64();
        self.counts.gradients += 1;
        if let Ok(g) = &result
            && let Some(what) = length_of_gradients(self.nlp, g)
        {
            return Err(EarlyExit::Halt(Status::IllPosed { what }));
        }
        if let Ok(g) = &result
            && let Some(fault) = fault_of_gradients(self.nlp, &self.rows, g)
        {
            result = Err(fault);
        }
        self.unless_interrupted(result.is_err())?;
        let Gradients {
            objective,
            jacobian,
        } = result.map_err(|failure| self.record(full.clone(), failure))?;
        self.failures_in_succession = 0;
        let (free, rows, scaling) = (&self.free, &self.rows, &self.scaling);
        let g = free
            .iter()
            .map(|&i| objective[i] * scaling.objective * scaling.variables[i]);
        let g = DVector::from_iterator(free.len(), g);
        // The place of each variable among the free or the fixed ones.
        let mut place = vec![0; full.len()];
        let mut is_free = vec![false; full.len()];
        for (k, &i) in free.iter().enumerate() {
            (place[i], is_free[i]) = (k, true);
        }
        for (k, &i) in self.fixed.iter().enumerate() {
            place[i] = k;
        }
        let part = |of_free: bool, columns: usize| {
            let row = |&j: &usize| {
                let entries = jacobian.row(j).filter(|&(i, _)| is_free[i] == of_free);
                let unit = |i: usize| if of_free { scaling.variables[i] } else { 1.0 };
                let scaled = |(i, v): (usize, f64)| {
                    let factor = scaling.constraints[j];
                    (place[i], v * factor * unit(i))
                };
                entries.map(scaled).collect()
            };
            Jacobian::from_rows(columns, rows.iter().map(row))
        };
        let a = part(true, free.len());
        let fixed_a = part(false, self.fixed.len());
        let norm = free
            .iter()
            .map(|&i| (objective[i] / self.units_judged[i]).abs())
            .fold(0.0, f64::max);
        let fixed = &self.fixed;
        let fixed_g = fixed.iter().map(|&i| objective[i] * scaling.objective);
        let slopes = Derivatives {
            fixed_g: DVector::from_iterator(fixed.len(), fixed_g),
            fixed_a,
            g,
            a,
        };
        self.measure_rows(x, &slopes);
        if self.gradient_norms.last() != Some(&norm) {
            self.gradient_norms.push(norm);
        }
        Ok(slopes)
    }

    /// Scaled residuals, whose squares sum up to the scaled objective, and their derivatives in the free variables,
    /// at the point `x` of the last gradients.
    pub(crate) fn residuals(
        &mut self,
        x: &DVector<f64>,
    ) -> Result<Option<ScaledResiduals>, EarlyExit> {
        let full = self.to_user(x);
        let clock = Instant::now();
        let mut result = unless_panicked(|| self.nlp.residuals(&full))?;
        self.counts.evaluation_seconds += clock.elapsed().as_secs_f64();
        let n = full.len();
        if let Ok(Some(found)) = &result {
            let (rows, shape) = (found.values.len(), found.jacobian.shape());
            if shape != (rows, n) {
                let what = format!(
                    "the Jacobian of {rows} residuals is {} × {} where {rows} × {n} is expected",
                    shape.0, shape.1
                );
                return Err(EarlyExit::Halt(Status::IllPosed { what }));
            }
            if let Some(fault) = fault_of_residuals(self.nlp, found) {
                result = Err(fault);
            }
        }
        self.unless_interrupted(result.is_err())?;
        let Some(found) = result.map_err(|failure| self.record(full, failure))? else {
            return Ok(None);
        };
        let unit = self.scaling.objective.sqrt();
        let r = DVector::from_vec(found.values) * unit;
        let whole = found.jacobian.to_dense();
        let j = DMatrix::from_fn(r.len(), self.free.len(), |k, c| {
            whole[(k, self.free[c])] * unit * self.scaling.variables[self.free[c]]
        });
        Ok(Some((r, j)))
    }

    /// Ends the run if an evaluation `failed` because it was interrupted.
    fn unless_interrupted(&self, failed: bool) -> Result<(), EarlyExit> {
        match failed && self.nlp.is_interrupted() {
            true => Err(EarlyExit::Halt(Status::Interrupted)),
            false => Ok(()),
        }
    }

    fn record(&mut self, x: Vec<f64>, failure: EvaluationFailure) -> EarlyExit {
        self.counts.failures += 1;
        self.failures_in_succession += 1;
        if self.failed.len() < FAILED_DESIGNS_KEPT {
            self.failed.push(FailedDesign {
                x,
                what: failure.to_string(),
            });
        }
        EarlyExit::Failed(failure)
    }

    /// Lets the next method meet failures of its own.
    pub(crate) fn forgive_failures(&mut self) {
        self.failures_in_succession = 0;
        self.forgiven = self.counts;
    }

    fn unless_it_fails_for_good(&self) -> Result<(), EarlyExit> {
        let failures = self.counts.failures - self.forgiven.failures;
        let evaluations = self.counts.evaluations - self.forgiven.evaluations;
        let mostly = failures > AT_THE_EDGE && 3 * failures > 2 * evaluations;
        match self.failures_in_succession >= MOST_FAILURES || mostly {
            true => Err(EarlyExit::Halt(Status::Stalled)),
            false => Ok(()),
        }
    }

    pub(super) fn check_limits(&self) -> Result<(), EarlyExit> {
        if self.counts.evaluations >= self.allowed.evaluations {
            return Err(EarlyExit::Halt(Status::EvaluationLimit));
        }
        self.unless_it_fails_for_good()?;
        match self.options.max_seconds {
            Some(limit) if self.seconds() >= limit => Err(EarlyExit::Halt(Status::TimeLimit)),
            _ => Ok(()),
        }
    }
}

/// The result of `call`, or the end of the run if it panics.
pub(super) fn unless_panicked<T>(call: impl FnOnce() -> T) -> Result<T, EarlyExit> {
    catch_unwind(AssertUnwindSafe(call)).map_err(|panic| {
        let text = panic.downcast_ref::<String>().map(String::as_str);
        let text = text.or_else(|| panic.downcast_ref::<&str>().copied());
        let what = text.unwrap_or("a message that is no text").into();
        EarlyExit::Halt(Status::Panicked { what })
    })
}
