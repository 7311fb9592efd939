//! Checks of a run's end by further evaluations: whether it is a solution, and whether gradients
//! are right.

use nalgebra::DVector;

use crate::constants::{AGREE, STEPS};
use crate::ending::FinalIterate;
use crate::multipliers::{ScaledMultipliers, user_multipliers};
use crate::program::{Derivatives, Point, Program};
use crate::status::Status;

/// A solution very far from the first point is none if the objective falls on from there.
fn unless_it_falls(program: &mut Program<'_>, finish: FinalIterate) -> FinalIterate {
    let doubtful = finish.status == Status::Converged && program.goes_far(&finish.point);
    match doubtful && program.falls_on(&finish.point).unwrap_or(false) {
        true => finish.with_status(Status::Unbounded),
        false => finish,
    }
}

/// The row without which no multipliers exist: its multiplier is huge (a violation within the tolerance
/// changes the objective by more than the root of the tolerance), and its derivative changes by a part of
/// itself within the allowed violation. Then the derivative vanishes where the row holds,
/// as that of x² = 0 does at x = 0.
pub(crate) fn degenerate_row(
    program: &mut Program<'_>,
    point: &Point,
    slopes: &Derivatives,
    multipliers: &ScaledMultipliers,
) -> Option<usize> {
    let y = user_multipliers(program, slopes, multipliers).constraints;
    let rows = 0..program.rows.len();
    let steep = |k: &usize| y[program.rows[*k]].abs();
    let k = rows.max_by(|a, b| steep(a).total_cmp(&steep(b)))?;
    let f = (point.f / program.scaling.objective).abs();
    let f = f.max(program.unit_of_objective());
    if steep(&k) * program.options.constraint_tolerance <= program.options.tolerance.sqrt() * f {
        return None;
    }
    let x = &point.x;
    let steepness: f64 = slopes.a.row(k).map(|(_, v)| v.abs()).sum();
    let length =
        (program.options.tolerance * x.amax().max(1.0)).min(program.allowed(k) / steepness);
    let along = |length: f64| {
        let mut moved = x.clone();
        for (i, slope) in slopes.a.row(k) {
            moved[i] = (x[i] + length * slope.signum()).clamp(program.lower[i], program.upper[i]);
        }
        let expected = slopes.a.row_dot(k, &(&moved - x));
        (moved, expected)
    };
    // The way that bounds block less.
    let (up, down) = (along(length), along(-length));
    let (moved, expected) = if up.1 >= -down.1 { up } else { down };
    let trial = program.evaluate(&moved).ok()?;
    let change = trial.c[k] - point.c[k];
    let rounding = 10.0 * f64::EPSILON * trial.c[k].abs().max(point.c[k].abs());
    let bent = (change - expected).abs() > AGREE * expected.abs() + rounding;
    bent.then_some(program.rows[k])
}

/// No solution has a degenerate row.
fn unless_multipliers_fail(program: &mut Program<'_>, mut finish: FinalIterate) -> FinalIterate {
    if finish.status != Status::Converged {
        return finish;
    }
    let (point, slopes) = (&finish.point, &finish.slopes);
    if let Some(j) = degenerate_row(program, point, slopes, &finish.multipliers) {
        finish.status = Status::Degenerate {
            constraint: program.constraint_name(j),
        };
    }
    finish
}

/// A run without a solution becomes [`Status::Inconsistent`] if its gradients are wrong. A run at a
/// limit is not tested: with a higher limit it must go on as if it had not ended.
fn unless_gradients_are_wrong(program: &mut Program<'_>, mut finish: FinalIterate) -> FinalIterate {
    let undecided = matches!(
        finish.status,
        Status::Stalled | Status::AtPrecision | Status::Infeasible { .. }
    );
    if !undecided {
        return finish;
    }
    if let Some(what) = wrong_gradients(program, &finish.point, &finish.slopes) {
        finish.status = Status::Inconsistent { what };
    }
    finish
}

/// What is wrong with the derivatives at a point: the derivative of a function along one direction
/// differs from its central differences. These must agree for two steps, and the differences to
/// either side must come nearer to each other with the step: then the function is smooth here.
pub(crate) fn wrong_gradients(
    program: &mut Program<'_>,
    at: &Point,
    slopes: &Derivatives,
) -> Option<String> {
    let size = at.x.amax().max(1.0);
    // At a stationary point slopes vanish but for what convergence and rounding leave, and so does their ratio.
    let least_part = program.options.tolerance.sqrt();
    let direction = DVector::from_fn(at.x.len(), |i, _| {
        let room = (at.x[i] - program.lower[i]).min(program.upper[i] - at.x[i]);
        // Weyl sequence: no derivative has a zero share.
        let phase = ((i + 1) as f64 * 0.618_033_988_749_895).fract() - 0.5;
        if room > 2.0 * STEPS[0] * size {
            phase.signum() * (0.5 + phase.abs())
        } else {
            0.0
        }
    });
    let mut differences: Vec<[Point; 2]> = Vec::new();
    for step in &STEPS[..2] {
        let length = step * size;
        let ahead = program.evaluate(&(&at.x + &direction * length));
        let behind = program.evaluate(&(&at.x - &direction * length));
        let (Ok(ahead), Ok(behind)) = (ahead, behind) else {
            return None;
        };
        differences.push([ahead, behind]);
    }
    let disagrees = |value: &dyn Fn(&Point) -> f64, of: f64, slope: f64, gradient: f64| {
        let here = value(at);
        let difference = |k: usize| {
            let (length, [ahead, behind]) = (STEPS[k] * size, &differences[k]);
            let (ahead, behind) = (value(ahead), value(behind));
            let bend = (ahead - here) - (here - behind);
            (0.5 * (ahead - behind) / length, (bend / length).abs())
        };
        let ((coarse, coarse_bend), (fine, fine_bend)) = (difference(0), difference(1));
        let gap = (fine - slope).abs();
        let rounding = 1e3 * f64::EPSILON * here.abs().max(of) / (STEPS[1] * size);
        let least = (AGREE * fine.abs().max(slope.abs())).max(least_part * gradient);
        let wrong = gap > least && gap > rounding;
        let smooth = fine_bend <= 0.5 * coarse_bend + rounding;
        (wrong && smooth && (coarse - fine).abs() <= AGREE * gap).then_some(fine)
    };
    let unit = program.scaling.objective;
    let slope = slopes.g.dot(&direction);
    let objective = disagrees(&|p| p.f, 0.0, slope, slopes.g.amax())
        .map(|fine| ("the objective".into(), slope / unit, fine / unit));
    let row = |k: usize| {
        let j = program.rows[k];
        let (unit, slope) = (
            program.scaling.constraints[j],
            slopes.a.row_dot(k, &direction),
        );
        // A row that vanishes has the rounding of what it is compared with.
        let bounds = [program.row_lower[k].abs(), program.row_upper[k].abs()];
        let of = bounds
            .into_iter()
            .filter(|b| b.is_finite())
            .fold(0.0, f64::max);
        let fine = disagrees(&|p| p.c[k], of, slope, slopes.a.row_amax(k))?;
        Some((program.constraint_name(j), slope / unit, fine / unit))
    };
    let found = objective.or_else(|| (0..program.rows.len()).find_map(row));
    found.map(|(name, slope, fine)| {
        format!(
            "along one direction the slope of {name} is {fine:.4e} by values and {slope:.4e} by gradients"
        )
    })
}

/// The final iterate after all checks.
pub(crate) fn doubted(program: &mut Program<'_>, finish: FinalIterate) -> FinalIterate {
    // A claim is tested even where the run used all of its evaluations.
    if finish.status == Status::Converged {
        program.set_budget(1.0, f64::INFINITY);
    }
    let finish = unless_it_falls(program, finish);
    let finish = unless_multipliers_fail(program, finish);
    unless_gradients_are_wrong(program, finish)
}
