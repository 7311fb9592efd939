//! Scale factors of the functions, and the units in which their derivatives count as small.

use nalgebra::DVector;

use super::outcome::Scaling;
use super::program::{Point, Program, Slopes};

/// An objective whose gradient at the start is below `FLAT` is multiplied until it is `LIFTED`, lest
/// a start on a plateau be taken for a solution.
const FLAT: f64 = 1.0;
const LIFTED: f64 = 1.0;
const LARGEST_LIFT: f64 = 1e12;

/// Least factor by which a scale is changed on the way.
const WORTHWHILE: f64 = 10.0;

/// Points that count as the first ones of a run.
const FIRST_POINTS: usize = 12;

/// Gradients among those of the first points that do not count because they are too large.
const LARGEST_LEFT_OUT: usize = 2;

impl Program<'_> {
    /// Sets the scale factors of functions from unscaled derivatives `slopes` and rescales both.
    pub fn scale(&mut self, point: &mut Point, slopes: &mut Slopes) {
        let limit = self.options.scaling_gradient;
        let norm = slopes.g.amax();
        self.scaling.objective = if norm > limit {
            limit / norm
        } else if norm > 0.0 && norm < FLAT {
            (LIFTED / norm).min(LARGEST_LIFT)
        } else {
            1.0
        };
        for (k, &j) in self.rows.iter().enumerate() {
            let norm = slopes.a.row(k).amax();
            self.scaling.constraints[j] = if norm > limit {
                (limit / norm).max(1e-8)
            } else {
                1.0
            };
        }
        self.apply_scaling(point, slopes);
    }

    /// Uses scale factors and typical gradient of an earlier run on the same objective.
    pub fn adopt_scaling(&mut self, saved: &Scaling, point: &mut Point, slopes: &mut Slopes) {
        // So many that later points cannot lower it.
        self.gradient_norms = vec![saved.typical_gradient; LARGEST_LEFT_OUT + 1];
        self.scaling.objective = saved.objective;
        self.scaling.constraints.clone_from(&saved.constraints);
        self.apply_scaling(point, slopes);
    }

    /// Factor by which the scale of the objective has to change to suit a point of gradient `g` and
    /// curvature `curvature`, both scaled, at which the run has arrived; `None` if it suits.
    pub fn better_scale(&self, point: &Point, g: &DVector<f64>, curvature: f64) -> Option<f64> {
        let size = point.x.amax().max(1.0);
        let limit = self.options.scaling_gradient / g.amax().max(curvature * size);
        let factor = limit.min(1.0 / self.scaling.objective);
        (factor.is_finite() && factor >= WORTHWHILE).then_some(factor)
    }

    /// Multiplies the scale of the objective by `factor`.
    pub fn rescale(&mut self, factor: f64) {
        self.scaling.objective *= factor;
        if let Some(best) = &mut self.best {
            best.f *= factor;
        }
    }

    fn apply_scaling(&mut self, point: &mut Point, slopes: &mut Slopes) {
        point.f *= self.scaling.objective;
        slopes.g *= self.scaling.objective;
        slopes.fixed_g *= self.scaling.objective;
        for (k, &j) in self.rows.iter().enumerate() {
            let factor = self.scaling.constraints[j];
            self.row_lower[k] *= factor;
            self.row_upper[k] *= factor;
            point.c[k] *= factor;
            slopes.a.row_mut(k).scale_mut(factor);
            slopes.fixed_a.row_mut(k).scale_mut(factor);
        }
    }

    /// Records gradients and zero rows and columns for the scaling report, before scaling.
    pub fn survey(&mut self, slopes: &Slopes) {
        let unit = |k: usize| self.scaling.variables[self.free[k]];
        let in_user_units = |v: f64, k: usize| (v / unit(k)).abs();
        let n = self.free.len();
        self.scaling.objective_gradient = (0..n)
            .map(|k| in_user_units(slopes.g[k], k))
            .fold(0.0, f64::max);
        self.scaling.constraint_gradients = vec![0.0; self.scaling.constraints.len()];
        for (r, &j) in self.rows.iter().enumerate() {
            let norm = (0..n)
                .map(|k| in_user_units(slopes.a[(r, k)], k))
                .fold(0.0, f64::max);
            self.scaling.constraint_gradients[j] = norm;
            if norm == 0.0 {
                let name = self.nlp().constraint_name(j);
                self.scaling.zero_rows.push(name);
            }
        }
        for k in 0..n {
            if slopes.is_idle(k) {
                let name = self.nlp().variable_name(self.free[k]);
                self.scaling.zero_columns.push(name);
            }
        }
    }

    /// The unit in which derivatives of the objective count as small, in the units of the user: the
    /// third largest ‖∇f‖∞ of the first dozen of points, or the median of all points if that is
    /// larger. It grows with the objective, neither a cliff nor a plateau at the start decides it,
    /// and a long tail of points near the optimum does not lower it.
    pub fn typical_gradient(&self) -> f64 {
        let largest = |norms: &[f64], most: usize| {
            let mut norms: Vec<f64> = norms.iter().copied().filter(|v| *v > 0.0).collect();
            norms.sort_by(|a, b| b.total_cmp(a));
            norms
                .get(most.min(norms.len().saturating_sub(1) / 2))
                .copied()
                .unwrap_or(0.0)
        };
        let all = &self.gradient_norms;
        let early = largest(&all[..all.len().min(FIRST_POINTS)], LARGEST_LEFT_OUT);
        let typical = early.max(largest(all, usize::MAX));
        if typical > 0.0 { typical } else { 1.0 }
    }
}

/// Sets derivatives to zero that are nothing but rounding: over the `reach` of its variable each
/// changes the function by less than the rounding of its largest change.
pub(super) fn drop_rounding(slopes: &mut DVector<f64>, reach: &DVector<f64>) {
    let largest = slopes.component_mul(reach).amax();
    for (slope, reach) in slopes.iter_mut().zip(reach.iter()) {
        if slope.abs() * reach <= f64::EPSILON * largest {
            *slope = 0.0;
        }
    }
}
