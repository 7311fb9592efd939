//! Scale factors of the functions, and the units of their derivatives.

use std::ops::RangeInclusive;
use std::time::Instant;

use nalgebra::DVector;

use crate::constants::{FAR, UNIT};
use crate::evaluations::unless_panicked;
use crate::linear::curvature::Curvature;
use crate::program::{Derivatives, EarlyExit, Point, Program};
use crate::state::Scaling;
use crate::status::Status;

/// Largest factor of a function. A gradient that is smaller by this factor is rounding. A thousandfold
/// limit makes far starts end at the limit of evaluations, a tenfold one costs HS25 twice its evaluations.
const LARGEST_LIFT: f64 = 1e12;

/// A restart keeps the units of the variables if the size of the point is between these. Always to
/// change them costs one problem of the bed; never to, far starts in the tests. A start below the first part of
/// the largest may be in another unit: without that, variables in units from 1e-6 to 1e6 stall.
const NEAR_ONE: RangeInclusive<f64> = 1e-3..=1e3;

/// Number of largest gradients of a run that are ignored: those of a start on a cliff. With none the bed
/// takes 4 % less, and such a start loosens the conditions.
const LARGEST_LEFT_OUT: usize = 2;

/// Units of a scaled program.
#[derive(Clone, Debug)]
pub(crate) struct Units {
    pub objective: f64,
    constraints: Vec<f64>,
    variables: Vec<f64>,
    /// [`Program::length`].
    length: f64,
}

impl Program<'_> {
    /// Sets the scale factors of the functions from the derivatives `slopes`, and converts point
    /// and slopes. No factor depends on a unit of the user: the gradients of objective and
    /// equalities get the size `scaling_gradient`, inequalities a gradient and bounds of at most
    /// one. Their slacks start with multipliers of one, and at distances of a hundred these would
    /// outweigh the objective in the filter.
    pub(crate) fn scale(&mut self, point: &mut Point, slopes: &mut Derivatives) {
        let wanted = self.options.scaling_gradient;
        let factor = |wanted: f64, size: f64| match size > 0.0 {
            true => (wanted / size).min(LARGEST_LIFT),
            false => 1.0,
        };
        let mut units = self.units();
        units.objective = factor(wanted, slopes.g.amax() / self.scaling.objective);
        for (k, &j) in self.rows.iter().enumerate() {
            let violation = self.row_violation(&point.c, k);
            let norm = slopes.a.row_amax(k).max(violation / FAR);
            let norm = norm / self.scaling.constraints[j];
            let bounds = [self.user_row_lower[j], self.user_row_upper[j]];
            units.constraints[j] = if bounds[0] < bounds[1] {
                let finite = bounds.iter().filter(|b| b.is_finite());
                factor(1.0, finite.fold(norm, |size, b| size.max(b.abs())))
            } else {
                factor(wanted, norm)
            };
        }
        self.change_units(&units, point, slopes);
    }

    /// Uses scale factors and typical gradient of an earlier run with the same objective.
    pub(crate) fn adopt_scaling(
        &mut self,
        saved: &Scaling,
        point: &mut Point,
        slopes: &mut Derivatives,
    ) {
        // So many entries that later points cannot lower it.
        self.gradient_norms = vec![saved.typical_gradient; LARGEST_LEFT_OUT + 1];
        let ratio = |&i: &usize| saved.variables[i] / self.scaling.variables[i];
        let units = Units {
            objective: saved.objective,
            constraints: saved.constraints.clone(),
            variables: saved.variables.clone(),
            length: self.length * self.free.iter().map(ratio).fold(0.0, f64::max),
        };
        self.change_units(&units, point, slopes);
    }

    /// The units in use.
    pub(crate) fn units(&self) -> Units {
        Units {
            objective: self.scaling.objective,
            constraints: self.scaling.constraints.clone(),
            variables: self.scaling.variables.clone(),
            length: self.length,
        }
    }

    /// The units in use with all variables measured in `size` of their present units.
    fn measured_by(&self, size: f64) -> Units {
        let mut units = self.units();
        units.length *= size;
        units.variables.iter_mut().for_each(|unit| *unit *= size);
        units
    }

    /// Makes the size of the start the unit of the variables, so that theirs does not matter.
    pub(crate) fn measure_start(&mut self) {
        let size = self.start().amax();
        if size > 0.0 {
            self.set_units(&self.measured_by(size));
        }
    }

    /// Makes the size of a variable its own unit where that is far below the others and a function
    /// depends on it in proportion, as much as on others and as it must change. So variables in mixed units get the same size, and one that
    /// happens to start near zero keeps the unit of all.
    pub(crate) fn measure_mixed(&mut self, point: &mut Point, slopes: &mut Derivatives) {
        let x = &point.x;
        let mut share = DVector::zeros(x.len());
        let mut compare = |row: &mut dyn Iterator<Item = (usize, f64)>, violation: f64| {
            let changes: Vec<(usize, f64)> = row.map(|(k, v)| (k, (v * x[k]).abs())).collect();
            let least = violation.max(f64::MIN_POSITIVE);
            let largest = changes.iter().fold(least, |a, c| a.max(c.1));
            for (k, change) in changes {
                share[k] = change.max(share[k] * largest) / largest;
            }
        };
        compare(&mut slopes.g.iter().copied().enumerate(), 0.0);
        for k in 0..self.rows.len() {
            compare(&mut slopes.a.row(k), self.row_violation(&point.c, k));
        }
        let mut units = self.units();
        let size = x.amax();
        for (k, &i) in self.free.iter().enumerate() {
            let part = x[k].abs() / size;
            if part < *NEAR_ONE.start() && share[k] > NEAR_ONE.start().sqrt() {
                units.variables[i] *= part;
            }
        }
        self.change_units(&units, point, slopes);
    }

    /// Changes to `units`, with bounds and the best point. The caller converts the current point.
    pub(crate) fn set_units(&mut self, units: &Units) {
        if let Some(best) = &mut self.best {
            best.f *= units.objective / self.scaling.objective;
        }
        self.scaling.objective = units.objective;
        for (k, &j) in self.rows.iter().enumerate() {
            let factor = units.constraints[j] / self.scaling.constraints[j];
            self.row_lower[k] *= factor;
            self.row_upper[k] *= factor;
            if let Some(best) = &mut self.best {
                best.c[k] *= factor;
            }
        }
        self.scaling.constraints.clone_from(&units.constraints);
        let stretch = self.stretch(units);
        self.length = units.length;
        self.scaling.variables.clone_from(&units.variables);
        let best = self.best.as_mut().map(|best| &mut best.x);
        let first = self.first.as_mut().map(|(x, _)| x);
        let points = best.into_iter().chain(first);
        for x in points.chain([&mut self.lower, &mut self.upper]) {
            x.component_div_assign(&stretch);
        }
    }

    /// Factors by which the units of the free variables are longer in `units`.
    fn stretch(&self, units: &Units) -> DVector<f64> {
        let ratio = |&i: &usize| units.variables[i] / self.scaling.variables[i];
        DVector::from_iterator(self.free.len(), self.free.iter().map(ratio))
    }

    /// Converts program, point and slopes to `units`.
    fn change_units(&mut self, units: &Units, point: &mut Point, slopes: &mut Derivatives) {
        let objective = units.objective / self.scaling.objective;
        let stretch = self.stretch(units);
        point.x.component_div_assign(&stretch);
        point.f *= objective;
        slopes.g.component_mul_assign(&stretch);
        slopes.g *= objective;
        slopes.a.scale_columns(&stretch);
        slopes.fixed_g *= objective;
        for (k, &j) in self.rows.iter().enumerate() {
            let factor = units.constraints[j] / self.scaling.constraints[j];
            point.c[k] *= factor;
            slopes.a.scale_row(k, factor);
            slopes.fixed_a.scale_row(k, factor);
        }
        self.set_units(units);
    }

    /// New units at a point where a method stalled. The size of the point becomes the unit of the
    /// variables if it is far from one. Functions are scaled by their derivatives there; earlier
    /// derivatives are forgotten. Returns the point and its derivatives in these units.
    pub(crate) fn renew(&mut self, mut point: Point) -> Result<(Point, Derivatives), EarlyExit> {
        let size = point.x.amax();
        if size > 0.0 && !NEAR_ONE.contains(&size) {
            self.set_units(&self.measured_by(size));
            point.x /= size;
        }
        self.gradient_norms.clear();
        let mut slopes = self.gradients(&point.x)?;
        self.scale(&mut point, &mut slopes);
        Ok((point, slopes))
    }

    /// Second derivatives of the scaled Lagrangian at `x` for the multipliers `y`, if the program gives them.
    pub(crate) fn curvature(
        &mut self,
        x: &DVector<f64>,
        y: &DVector<f64>,
    ) -> Result<Option<Curvature>, EarlyExit> {
        let full = self.to_user(x);
        let unit_f = self.scaling.objective;
        let mut user = vec![0.0; self.scaling.constraints.len()];
        for (k, &j) in self.rows.iter().enumerate() {
            user[j] = y[k] * self.scaling.constraints[j] / unit_f;
        }
        let clock = Instant::now();
        let found = unless_panicked(|| self.nlp.curvature(&full, &user))?;
        self.counts.evaluation_seconds += clock.elapsed().as_secs_f64();
        let Some(found) = found else {
            return Ok(None);
        };
        if let Some(what) = found.fault(full.len()) {
            return Err(EarlyExit::Halt(Status::IllPosed { what }));
        }
        Ok(Some(found.scaled(
            &self.free,
            &self.scaling.variables,
            unit_f,
        )))
    }

    /// Records gradients and zero rows and columns for the scaling report, before scaling.
    pub(crate) fn record_scale(&mut self, slopes: &Derivatives) {
        let unit = |k: usize| self.scaling.variables[self.free[k]];
        let in_user_units = |v: f64, k: usize| (v / unit(k)).abs();
        let n = self.free.len();
        self.scaling.objective_gradient = (0..n)
            .map(|k| in_user_units(slopes.g[k], k))
            .fold(0.0, f64::max);
        self.scaling.constraint_gradients = vec![0.0; self.scaling.constraints.len()];
        for (r, &j) in self.rows.iter().enumerate() {
            let norm = (slopes.a.row(r))
                .map(|(k, v)| in_user_units(v, k))
                .fold(0.0, f64::max);
            self.scaling.constraint_gradients[j] = norm;
            if norm == 0.0 && n > 0 {
                let name = self.nlp().constraint_name(j);
                self.scaling.zero_rows.push(name);
            }
        }
        for (k, idle) in slopes.idle().into_iter().enumerate() {
            if idle {
                let name = self.nlp().variable_name(self.free[k]);
                self.scaling.zero_columns.push(name);
            }
        }
    }

    /// Unit of the gradient of the objective, in the units of the user: the third largest ‖∇f‖∞ of the
    /// run, or the median of fewer than five. It scales with the objective. Neither a steep nor a flat
    /// start determines it, and many points near the optimum do not lower it.
    pub(crate) fn typical_gradient(&self) -> f64 {
        let mut norms: Vec<f64> = self.gradient_norms.clone();
        norms.retain(|v| *v > 0.0);
        norms.sort_by(|a, b| b.total_cmp(a));
        let median = norms.len().saturating_sub(1) / 2;
        let typical = norms.get(median.min(LARGEST_LEFT_OUT));
        typical.copied().unwrap_or(1.0)
    }

    /// Unit of an objective that vanishes, in the unit of the user: that of forces times a tenth of a unit of the
    /// variables. Ten times more makes a false claim.
    pub(crate) fn unit_of_objective(&self) -> f64 {
        UNIT * self.typical_gradient() * UNIT * self.length
    }
}
