//! Violations of the rows, and their tolerances.

use nalgebra::DVector;

use crate::constants::HALF_OF_DIGITS;
use crate::program::{Derivatives, Program};

/// Largest violation of a row relative to its size, whatever the tolerance.
const PART_OF_ROW: f64 = 1e-4;

impl Program<'_> {
    /// Largest violation of a row, in the units of the user, and the row's index there.
    pub(crate) fn worst_violation(&self, c: &DVector<f64>) -> (f64, usize) {
        let mut worst = (0.0, self.rows.first().copied().unwrap_or(0));
        for (k, &j) in self.rows.iter().enumerate() {
            let value = c[k] / self.scaling.constraints[j];
            let violation = (self.user_row_lower[j] - value)
                .max(value - self.user_row_upper[j])
                .max(0.0);
            if violation > worst.0 {
                worst = (violation, j);
            }
        }
        worst
    }

    /// Violation that a solution may have in a row of the user: the tolerance, or a small part of
    /// the size of the row if that is less.
    fn allowed_violation(&self, j: usize) -> f64 {
        let tolerance = self.options.constraint_tolerance;
        tolerance.min(PART_OF_ROW * self.row_sizes[j])
    }

    /// Allowed violation of scaled row `k`, or a small part of its bounds if that is less.
    pub(crate) fn allowed(&self, k: usize) -> f64 {
        let allowed = self.allowed_violation(self.rows[k]) * self.scaling.constraints[self.rows[k]];
        let bounds = [self.row_lower[k], self.row_upper[k]].map(f64::abs);
        let sizes = bounds.into_iter().filter(|b| b.is_finite() && *b > 0.0);
        sizes.fold(allowed, |least, b| least.min(PART_OF_ROW * b))
    }

    /// The smallest allowed violation of all rows, in the units of the user.
    pub(crate) fn least_allowed(&self) -> f64 {
        let rows = self.rows.iter();
        rows.map(|&j| self.allowed_violation(j))
            .fold(self.options.constraint_tolerance, f64::min)
    }

    /// The smallest allowed violation among the rows that exceed theirs at `c`, or the tolerance.
    pub(crate) fn least_exceeded(&self, c: &DVector<f64>) -> f64 {
        let exceeded = |k: usize| {
            let j = self.rows[k];
            let allowed = self.allowed_violation(j);
            let violation = self.row_violation(c, k) / self.scaling.constraints[j];
            (violation > allowed).then_some(allowed)
        };
        let all = (0..c.len()).filter_map(exceeded);
        all.fold(self.options.constraint_tolerance, f64::min)
    }

    /// Largest ratio of a row's violation to its allowed violation.
    pub(crate) fn relative_violation(&self, c: &DVector<f64>) -> f64 {
        let ratio = |k: usize| {
            let j = self.rows[k];
            self.row_violation(c, k) / self.scaling.constraints[j] / self.allowed_violation(j)
        };
        (0..c.len()).map(ratio).fold(0.0, f64::max)
    }

    /// Whether no row exceeds its allowed violation.
    pub(crate) fn is_feasible(&self, c: &DVector<f64>) -> bool {
        self.relative_violation(c) <= 1.0
    }

    /// Takes the sizes of the rows from their derivatives at the scaled point `x`. The size is the
    /// larger of the row's bounds and of Σ |∂c/∂x_i x_i|, the change of the row if every variable
    /// changes by its size. A row with zero bounds may be a product that vanishes with one
    /// variable. For such a row every variable changes by the size of the largest.
    pub(crate) fn measure_rows(&mut self, x: &DVector<f64>, slopes: &Derivatives) {
        let largest_x = x.amax();
        for (k, &j) in self.rows.iter().enumerate() {
            let size = |bound: f64| if bound.is_finite() { bound.abs() } else { 0.0 };
            let bound = size(self.user_row_lower[j]).max(size(self.user_row_upper[j]));
            let change = |by: &dyn Fn(usize) -> f64| {
                let changes = slopes.a.row(k).map(|(i, v)| v.abs() * by(i));
                changes.sum::<f64>() / self.scaling.constraints[j]
            };
            let change_by_sizes = change(&|i| x[i].abs());
            let size = match bound > 0.0 {
                true => bound.max(change_by_sizes),
                false => change(&|_| largest_x),
            };
            self.row_changes[j] = change_by_sizes;
            let largest = &mut self.largest_rows[j];
            *largest = largest.max(size);
            self.row_sizes[j] = size.max(HALF_OF_DIGITS * *largest).max(f64::MIN_POSITIVE);
        }
    }

    /// Sum of the violations of the scaled rows.
    pub(crate) fn total_violation(&self, c: &DVector<f64>) -> f64 {
        (0..c.len()).map(|k| self.row_violation(c, k)).sum()
    }

    /// Violation of scaled row `k`.
    pub(crate) fn row_violation(&self, c: &DVector<f64>, k: usize) -> f64 {
        (self.row_lower[k] - c[k])
            .max(c[k] - self.row_upper[k])
            .max(0.0)
    }
}
