//! Lagrange multipliers in scaled units and in those of the user.

use nalgebra::DVector;

use crate::linear::jacobian::Jacobian;
use crate::linear::kkt_sparse::SparseKkt;
use crate::program::{Derivatives, Point, Program};
use crate::state::Multipliers;

/// Multipliers of the scaled program: rows, then lower and upper bounds of the variables.
#[derive(Clone, Debug)]
pub(crate) struct ScaledMultipliers {
    pub y: DVector<f64>,
    pub zl: DVector<f64>,
    pub zu: DVector<f64>,
}

impl ScaledMultipliers {
    /// Multipliers of the bounds for the row multipliers `y`. The remaining force on a variable
    /// goes to the bound that it pushes against, unless that bound is far away.
    pub(crate) fn from_rows(
        program: &Program<'_>,
        point: &Point,
        slopes: &Derivatives,
        y: DVector<f64>,
    ) -> Self {
        let force = &slopes.g + slopes.a.tr_mul(&y);
        let n = force.len();
        let near = |distance: f64| distance <= 1.0;
        let zl = DVector::from_fn(n, |i, _| {
            if near(point.x[i] - program.lower[i]) {
                force[i].max(0.0)
            } else {
                0.0
            }
        });
        let zu = DVector::from_fn(n, |i, _| {
            if near(program.upper[i] - point.x[i]) {
                (-force[i]).max(0.0)
            } else {
                0.0
            }
        });
        ScaledMultipliers { y, zl, zu }
    }

    /// Sets multipliers to zero that are smaller than the distance to their bound: what the barrier leaves of the
    /// force of a bound that is not active. Where the objective and its gradients vanish, their products are not
    /// small beside it.
    pub(crate) fn release(&mut self, program: &Program<'_>, point: &Point) {
        for k in 0..self.y.len() {
            let (lower, upper) = (program.row_lower[k], program.row_upper[k]);
            let bound = if self.y[k] > 0.0 { upper } else { lower };
            if lower < upper && self.y[k].abs() < (bound - point.c[k]).abs() {
                self.y[k] = 0.0;
            }
        }
        for i in 0..self.zl.len() {
            if self.zl[i] < point.x[i] - program.lower[i] {
                self.zl[i] = 0.0;
            }
            if self.zu[i] < program.upper[i] - point.x[i] {
                self.zu[i] = 0.0;
            }
        }
    }

    /// Sets multipliers to zero that have the wrong sign for the bounds of their row.
    pub(crate) fn clip(&mut self, program: &Program<'_>) {
        for k in 0..self.y.len() {
            if program.row_upper[k] == f64::INFINITY {
                self.y[k] = self.y[k].min(0.0);
            }
            if program.row_lower[k] == f64::NEG_INFINITY {
                self.y[k] = self.y[k].max(0.0);
            }
        }
    }
}

/// Multipliers of the active rows that balance the force on the variables between their bounds.
pub(crate) fn least_squares(
    program: &Program<'_>,
    point: &Point,
    slopes: &Derivatives,
    y: &DVector<f64>,
) -> Option<DVector<f64>> {
    let distance = |k: usize| {
        let bound = if y[k] > 0.0 {
            program.row_upper[k]
        } else {
            program.row_lower[k]
        };
        (point.c[k] - bound).abs()
    };
    let rows: Vec<usize> = (0..y.len()).filter(|&k| y[k].abs() > distance(k)).collect();
    let inside = |i: usize| {
        let room = (point.x[i] - program.lower[i]).min(program.upper[i] - point.x[i]);
        room > 1e-9 * point.x[i].abs().max(1.0)
    };
    let variables: Vec<usize> = (0..point.x.len()).filter(|&i| inside(i)).collect();
    if rows.is_empty() || variables.is_empty() {
        return None;
    }
    let g = DVector::from_fn(variables.len(), |i, _| -slopes.g[variables[i]]);
    let mut place = vec![usize::MAX; point.x.len()];
    for (k, &i) in variables.iter().enumerate() {
        place[i] = k;
    }
    let row = |&k: &usize| {
        let entries = slopes.a.row(k).map(|(i, v)| (place[i], v));
        entries.filter(|&(i, _)| i != usize::MAX).collect()
    };
    let a = Jacobian::from_rows(variables.len(), rows.iter().map(row));
    let ones = DVector::from_element(variables.len(), 1.0);
    let zeros = DVector::zeros(rows.len());
    // The least-squares solution of Aᵀ y = g is that of [I Aᵀ; A 0] (r, y) = (g, 0).
    let factor = SparseKkt::factor(&ones, None, &a, &zeros, None)?;
    let mut fitted = zeros.clone();
    for _ in 0..3 {
        let rest = &g - a.tr_mul(&fitted);
        fitted += factor.solve(&rest, &zeros).1;
    }
    let mut all = DVector::zeros(y.len());
    for (value, &k) in fitted.iter().zip(&rows) {
        all[k] = *value;
    }
    Some(all)
}

/// Multipliers in the units of the user. Those of fixed variables balance the force on them.
pub(crate) fn user_multipliers(
    program: &Program<'_>,
    slopes: &Derivatives,
    z: &ScaledMultipliers,
) -> Multipliers {
    let unit_f = program.scaling.objective;
    let (n, m) = (
        program.scaling.variables.len(),
        program.scaling.constraints.len(),
    );
    let mut constraints = vec![0.0; m];
    for (k, &j) in program.rows.iter().enumerate() {
        constraints[j] = z.y[k] * program.scaling.constraints[j] / unit_f;
    }
    let (mut lower_bounds, mut upper_bounds) = (vec![0.0; n], vec![0.0; n]);
    for (k, &i) in program.free.iter().enumerate() {
        let unit = unit_f * program.scaling.variables[i];
        lower_bounds[i] = z.zl[k] / unit;
        upper_bounds[i] = z.zu[k] / unit;
    }
    let force = &slopes.fixed_g + slopes.fixed_a.tr_mul(&z.y);
    for (k, &i) in program.fixed.iter().enumerate() {
        lower_bounds[i] = (force[k] / unit_f).max(0.0);
        upper_bounds[i] = (-force[k] / unit_f).max(0.0);
    }
    Multipliers {
        constraints,
        lower_bounds,
        upper_bounds,
    }
}

/// Multipliers of the user, converted to scaled units.
pub(crate) fn scaled_multipliers(program: &Program<'_>, user: &Multipliers) -> ScaledMultipliers {
    let unit_f = program.scaling.objective;
    let row = |&j: &usize| user.constraints[j] * unit_f / program.scaling.constraints[j];
    let y = DVector::from_iterator(program.rows.len(), program.rows.iter().map(row));
    let pick = |v: &[f64]| {
        let scaled = |&i: &usize| v[i] * unit_f * program.scaling.variables[i];
        DVector::from_iterator(program.free.len(), program.free.iter().map(scaled))
    };
    ScaledMultipliers {
        y,
        zl: pick(&user.lower_bounds),
        zu: pick(&user.upper_bounds),
    }
}
