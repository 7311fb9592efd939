//! Residuals in the units of the user, and the judgement of a point.

use nalgebra::{DMatrix, DVector};

use super::jacobian::Jacobian;
use super::kkt_sparse::SparseKkt;
use super::outcome::{ActiveBound, BoundSide, Kkt};
use super::program::{Derivatives, Point, Program};
use super::quasi_newton::QuasiNewton;
use super::state::Multipliers;

/// Multipliers of the scaled program: rows, then lower and upper bounds of the variables.
#[derive(Clone, Debug)]
pub(super) struct ScaledMultipliers {
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

    /// As [`ScaledMultipliers::from_rows`], with the better of two choices: `y`, or the
    /// least-squares multipliers of the rows that are active by `y`.
    pub(crate) fn polished(
        program: &Program<'_>,
        point: &Point,
        slopes: &Derivatives,
        y: &DVector<f64>,
    ) -> Self {
        let mut given = Self::from_rows(program, point, slopes, y.clone());
        given.clip(program);
        let Some(mut estimate) = least_squares(program, point, slopes, y) else {
            return given;
        };
        let before = estimate.clone();
        let mut fitted = Self::from_rows(program, point, slopes, estimate.clone());
        fitted.clip(program);
        estimate -= &fitted.y;
        if estimate.amax() > 1e-8 * before.amax() {
            return given;
        }
        let worst = |z: &Self| {
            let k = kkt(program, point, slopes, z, 0.0);
            k.relative_stationarity.max(k.relative_complementarity)
        };
        if worst(&fitted) < worst(&given) {
            fitted
        } else {
            given
        }
    }

    /// Multipliers of the program whose objective is multiplied by `factor`.
    pub(crate) fn times(mut self, factor: f64) -> Self {
        self.y *= factor;
        self.zl *= factor;
        self.zu *= factor;
        self
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

/// Entries up to which the multipliers come from a singular value decomposition.
const LARGEST_SVD: usize = 40_000;

/// Multipliers of the active rows that balance the force on the variables between their bounds.
fn least_squares(
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
    let fitted = if variables.len() * rows.len() > LARGEST_SVD {
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
        let factor = SparseKkt::factor(&ones, None, &a, &zeros)?;
        let mut y = zeros.clone();
        for _ in 0..3 {
            let rest = &g - a.tr_mul(&y);
            y += factor.solve(&rest, &zeros).1;
        }
        y
    } else {
        let a = DMatrix::from_fn(variables.len(), rows.len(), |i, k| {
            slopes.a[(rows[k], variables[i])]
        });
        a.svd(true, true).solve(&g, 1e-12).ok()?
    };
    let mut all = DVector::zeros(y.len());
    for (value, &k) in fitted.iter().zip(&rows) {
        all[k] = *value;
    }
    Some(all)
}

/// Unit of forces where the gradient vanishes, as a part of the typical gradient.
const UNIT: f64 = 0.1;

/// Size of forces, in the units of the user: that of the gradient or, if it vanishes, of the
/// gradients at other points of the run.
pub(super) fn unit_of_forces(program: &Program<'_>, slopes: &Derivatives) -> f64 {
    gradient_norm(program, slopes).max(UNIT * program.typical_gradient())
}

/// Norm ‖∇f‖∞ in the units of the user.
pub(super) fn gradient_norm(program: &Program<'_>, slopes: &Derivatives) -> f64 {
    let gradient = program.free.iter().zip(slopes.g.iter());
    gradient
        .map(|(&i, g)| (g / program.unit_of_force(i)).abs())
        .fold(0.0, f64::max)
}

/// Residuals at a point. The caller sets `scaled`.
pub(super) fn kkt(
    program: &Program<'_>,
    point: &Point,
    slopes: &Derivatives,
    z: &ScaledMultipliers,
    scaled: f64,
) -> Kkt {
    let unit_f = program.scaling.objective;
    let force = slopes.a.tr_mul(&z.y);
    let mut stationarity = 0.0_f64;
    let mut complementarity = 0.0_f64;
    for (i, &user) in program.free.iter().enumerate() {
        let unit = program.unit_of_force(user);
        let residual = slopes.g[i] + force[i] - z.zl[i] + z.zu[i];
        stationarity = stationarity.max(residual.abs() / unit);
        let mut product = |multiplier: f64, distance: f64| {
            if multiplier > 0.0 {
                complementarity += multiplier * distance.max(0.0) / unit_f;
            }
        };
        product(z.zl[i], point.x[i] - program.lower[i]);
        product(z.zu[i], program.upper[i] - point.x[i]);
    }
    for k in 0..z.y.len() {
        let distance = if z.y[k] > 0.0 {
            program.row_upper[k] - point.c[k]
        } else {
            point.c[k] - program.row_lower[k]
        };
        if z.y[k] != 0.0 {
            complementarity += z.y[k].abs() * distance.abs() / unit_f;
        }
    }
    let least = program.unit_of_objective();
    Kkt {
        violation: program.worst_violation(&point.c).0,
        stationarity,
        relative_stationarity: stationarity / unit_of_forces(program, slopes),
        complementarity,
        relative_complementarity: complementarity / (point.f / unit_f).abs().max(least),
        scaled,
    }
}

/// Largest residual of the conditions in scaled units; forces and complementarity are divided by
/// the size of the multipliers.
pub(super) fn scaled_residual(
    program: &Program<'_>,
    point: &Point,
    slopes: &Derivatives,
    z: &ScaledMultipliers,
) -> f64 {
    let force = &slopes.g + slopes.a.tr_mul(&z.y) - &z.zl + &z.zu;
    let size = (z.y.lp_norm(1) + z.zl.lp_norm(1) + z.zu.lp_norm(1))
        / (z.y.len() + z.zl.len()).max(1) as f64;
    let violation = (0..z.y.len())
        .map(|k| program.row_violation(&point.c, k))
        .fold(0.0, f64::max);
    let between = |value: &DVector<f64>, lower: &DVector<f64>, upper: &DVector<f64>, k: usize| {
        (
            (value[k] - lower[k]).max(0.0),
            (upper[k] - value[k]).max(0.0),
        )
    };
    let product = |multiplier: f64, distance: f64| {
        if multiplier > 0.0 {
            multiplier * distance
        } else {
            0.0
        }
    };
    let rows = (0..z.y.len()).map(|k| {
        let (below, above) = between(&point.c, &program.row_lower, &program.row_upper, k);
        product(-z.y[k], below).max(product(z.y[k], above))
    });
    let variables = (0..z.zl.len()).map(|i| {
        let (below, above) = between(&point.x, &program.lower, &program.upper, i);
        product(z.zl[i], below).max(product(z.zu[i], above))
    });
    let complementarity = rows.chain(variables).fold(0.0, f64::max);
    (force.amax().max(complementarity) / (size.max(100.0) / 100.0)).max(violation)
}

/// A gradient below the first part of the typical gradient counts as vanishing. A remaining force
/// up to the second part of the gradient shows that multipliers balance it.
const VANISHING: f64 = 1e-5;
const BALANCED: f64 = 0.1;

/// A change of x by this number of rounding errors changes its last digits only.
const LAST_DIGITS: f64 = 10.0;

/// Judgement of the residuals at a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Verdict {
    /// They are too large.
    Unsolved,
    /// They are small only in scaled units and relative to the gradients of the run.
    SolvedInScaledUnits,
    /// They meet the tolerances in the units of the user as well.
    Solved,
}

/// Judges a point. It is unsolved if multipliers balance a gradient that does not vanish, but the
/// remaining force is not small relative to this gradient.
pub(super) fn judge(
    program: &Program<'_>,
    point: &Point,
    slopes: &Derivatives,
    z: &ScaledMultipliers,
    scaled: f64,
) -> Verdict {
    let force = &slopes.g + slopes.a.tr_mul(&z.y) - &z.zl + &z.zu;
    let (left, gradient) = (force.amax(), slopes.g.amax());
    let typical = program.typical_gradient() * program.scaling.objective;
    let balanced = left > program.options.tolerance * gradient
        && left <= BALANCED * gradient
        && gradient > VANISHING * typical;
    let kkt = kkt(program, point, slopes, z, scaled);
    if balanced || !is_solved_in_scaled_units(program, point, &kkt) {
        Verdict::Unsolved
    } else if is_solved_in_user_units(program, point, slopes, &kkt) {
        Verdict::Solved
    } else {
        Verdict::SolvedInScaledUnits
    }
}

/// Whether the residuals meet the tolerances in scaled units and relative to the gradients of the
/// run.
pub(super) fn is_solved_in_scaled_units(program: &Program<'_>, point: &Point, kkt: &Kkt) -> bool {
    let options = program.options;
    let within = |value: f64, limit: f64| value <= limit;
    program.is_feasible(&point.c)
        && within(kkt.relative_stationarity, options.tolerance)
        && within(kkt.relative_complementarity, 0.1 * options.tolerance)
        && within(kkt.scaled, options.tolerance)
}

/// Whether the residuals meet the tolerances in the units of the user: absolutely, or relative to
/// gradient and objective at this point. Other points have no influence.
pub(super) fn is_solved_in_user_units(
    program: &Program<'_>,
    point: &Point,
    slopes: &Derivatives,
    kkt: &Kkt,
) -> bool {
    let tolerance = program.options.tolerance;
    let f = point.f / program.scaling.objective;
    program.is_feasible(&point.c)
        && kkt.stationarity <= tolerance * gradient_norm(program, slopes).max(1.0)
        && kkt.complementarity <= tolerance * f.abs().max(1.0)
}

/// Whether the objective can show no further gain: the residuals meet the tolerances relative to
/// the gradients of the run and the step −B⁻¹∇L gains less than the rounding of f; or they meet them
/// in the units of the user and the step changes only the last digits of x. A run that starts at its
/// solution has no gradients to compare with.
pub(super) fn is_at_precision(
    program: &Program<'_>,
    point: &Point,
    slopes: &Derivatives,
    z: &ScaledMultipliers,
    b: &mut QuasiNewton,
) -> bool {
    let kkt = kkt(program, point, slopes, z, 0.0);
    let relative = is_solved_in_scaled_units(program, point, &kkt);
    if !relative && !is_solved_in_user_units(program, point, slopes, &kkt) {
        return false;
    }
    let force = &slopes.g + slopes.a.tr_mul(&z.y) - &z.zl + &z.zu;
    b.newton_step(&force).is_some_and(|step| {
        relative && 0.5 * step.dot(&force) <= f64::EPSILON * point.f.abs()
            || step.amax() <= LAST_DIGITS * f64::EPSILON * point.x.amax()
    })
}

/// Whether [`judge`] gives [`Verdict::Solved`], at a point where no step makes progress.
pub(super) fn is_solved_at_end(
    program: &Program<'_>,
    point: &Point,
    slopes: &Derivatives,
    z: &ScaledMultipliers,
    scaled: f64,
) -> bool {
    let kkt = kkt(program, point, slopes, z, scaled);
    is_solved_in_scaled_units(program, point, &kkt)
        && is_solved_in_user_units(program, point, slopes, &kkt)
}

/// Multipliers in the units of the user. Those of fixed variables balance the force on them.
pub(super) fn user_multipliers(
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
pub(super) fn scaled_multipliers(program: &Program<'_>, user: &Multipliers) -> ScaledMultipliers {
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

/// Norms ‖∇c_j‖∞ of all rows, in the units of the user, no less than 1e-300.
pub(super) fn steepness(program: &Program<'_>, slopes: &Derivatives) -> Vec<f64> {
    let mut all = vec![1e-300; program.scaling.constraints.len()];
    for (k, &j) in program.rows.iter().enumerate() {
        for (column, value) in slopes.a.row(k) {
            let variable = program.scaling.variables[program.free[column]];
            let unit = program.scaling.constraints[j] * variable;
            all[j] = (value / unit).abs().max(all[j]);
        }
    }
    all
}

/// Active entries: their distance to a bound, as a distance in the variables, is less than 1e-6 of
/// max(1, |bound|), or small relative to their force as a part of `gradient`. One unit of a
/// variable changes entry i by `steepness(i)`.
pub(super) fn active(
    values: &[f64],
    bounds: (&[f64], &[f64]),
    multipliers: impl Fn(usize) -> (f64, f64),
    (steepness, gradient): (impl Fn(usize) -> f64, f64),
    name: impl Fn(usize) -> String,
) -> Vec<ActiveBound> {
    let mut found = Vec::new();
    for i in 0..values.len() {
        let (l, u) = (bounds.0[i], bounds.1[i]);
        let (zl, zu) = multipliers(i);
        let steep = steepness(i);
        let close = |distance: f64, bound: f64, z: f64| {
            let (far, near) = (distance / steep, bound.abs().max(1.0));
            bound.is_finite()
                && (distance.min(far) <= 1e-6 * near || far <= 1e-3 * z * steep / gradient)
                && (z > 0.0 || distance <= 1e-9 * near)
        };
        let (side, multiplier) = if l == u {
            (BoundSide::Equal, zl.max(zu))
        } else if close(values[i] - l, l, zl) {
            (BoundSide::Lower, zl)
        } else if close(u - values[i], u, zu) {
            (BoundSide::Upper, zu)
        } else {
            continue;
        };
        found.push(ActiveBound {
            name: name(i),
            side,
            multiplier,
        });
    }
    found
}
