//! When a run has converged: residuals of the optimality conditions, and the tests on them.
//!
//! [`is_solved`] tests a point, [`is_at_precision`] one whose steps are lost in rounding. How a run
//! ended is in `ending`.

use nalgebra::DVector;

use crate::constants::UNIT;
use crate::linear::quasi_newton::QuasiNewton;
use crate::multipliers::{ScaledMultipliers, least_squares};
use crate::outcome::Kkt;
use crate::program::{Derivatives, Point, Program};

/// Size of forces, in the units of the user: that of the gradient or, if it vanishes, of the
/// gradients at other points of the run.
pub(crate) fn unit_of_forces(program: &Program<'_>, slopes: &Derivatives) -> f64 {
    gradient_norm(program, slopes).max(UNIT * program.typical_gradient())
}

/// Norm ‖∇f‖∞ in the units of the user.
pub(crate) fn gradient_norm(program: &Program<'_>, slopes: &Derivatives) -> f64 {
    let gradient = program.free.iter().zip(slopes.g.iter());
    gradient
        .map(|(&i, g)| (g / program.unit_of_force(i)).abs())
        .fold(0.0, f64::max)
}

/// The row whose force |y_k| ‖∇c_k‖∞ is largest, if that exceeds the gradient by 1/√tolerance and other
/// forces balance it to the tolerance. Beside it the objective does not count: at the limit of such
/// points no multipliers exist (conditions of Fritz John).
pub(crate) fn dominant_row(
    program: &Program<'_>,
    slopes: &Derivatives,
    z: &ScaledMultipliers,
) -> Option<usize> {
    let force = |k: usize| z.y[k].abs() * slopes.a.row_amax(k);
    let k = (0..z.y.len()).max_by(|&a, &b| force(a).total_cmp(&force(b)))?;
    let tolerance = program.options.tolerance;
    let left = &slopes.g + slopes.a.tr_mul(&z.y) - &z.zl + &z.zu;
    let dominates = force(k) > slopes.g.amax() / tolerance.sqrt();
    (dominates && left.amax() <= tolerance * force(k)).then(|| program.rows[k])
}

/// Residuals at a point. The caller sets `scaled`.
pub(crate) fn kkt(
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
        // Forces of any size may balance each other, but for their rounding.
        let rounding = f64::EPSILON * (force[i].abs() + z.zl[i] + z.zu[i]);
        stationarity = stationarity.max((residual.abs() + rounding) / unit);
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
pub(crate) fn scaled_residual(
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

impl ScaledMultipliers {
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
}

/// Whether the residuals meet the tolerances in scaled units and relative to the gradients of the
/// run.
pub(crate) fn is_solved_in_scaled_units(program: &Program<'_>, point: &Point, kkt: &Kkt) -> bool {
    let options = program.options;
    let within = |value: f64, limit: f64| value <= limit;
    program.is_feasible(&point.c)
        && within(kkt.relative_stationarity, options.tolerance)
        && within(kkt.relative_complementarity, 0.1 * options.tolerance)
        && within(kkt.scaled, options.tolerance)
}

/// Whether the residuals meet the tolerances in the units of the user: absolutely, or relative to
/// gradient and objective at this point. Other points have no influence.
pub(crate) fn is_solved_in_user_units(
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
/// the gradients of the run, and the step −B⁻¹∇L gains less than the rounding of f.
pub(crate) fn is_at_precision(
    program: &Program<'_>,
    point: &Point,
    slopes: &Derivatives,
    z: &ScaledMultipliers,
    b: &mut QuasiNewton,
) -> bool {
    let kkt = kkt(program, point, slopes, z, 0.0);
    // The unit of a vanishing objective says nothing where f has digits.
    let gap = kkt.complementarity * program.scaling.objective;
    let closed = gap <= program.options.tolerance * point.f.abs();
    if !closed || !is_solved_in_scaled_units(program, point, &kkt) {
        return false;
    }
    let force = &slopes.g + slopes.a.tr_mul(&z.y) - &z.zl + &z.zu;
    let step = b.newton_step(&force);
    step.is_some_and(|step| 0.5 * step.dot(&force) <= f64::EPSILON * point.f.abs())
}

/// Whether the residuals meet all tolerances.
pub(crate) fn is_solved(
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
