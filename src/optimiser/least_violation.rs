//! The least violation of the worst row, if no point satisfies all rows.

use nalgebra::DVector;

use crate::constants::SMALL_PART;
use crate::linear::jacobian::Jacobian;
use crate::observer::Phase;
use crate::program::{Derivatives, EarlyExit, Point, Program, Progress};
use crate::quadratic::data::{Hessian, QpData};
use crate::quadratic::elastic::ElasticQp;

/// The one-sided rows of a program: row, side (1 above, −1 below), and the unit of its violation.
struct Sides(Vec<(usize, f64, f64)>);

impl Sides {
    fn of(program: &Program<'_>) -> Sides {
        let mut all = Vec::new();
        for (k, &j) in program.rows.iter().enumerate() {
            let unit = program.scaling.constraints[j];
            if program.row_upper[k].is_finite() {
                all.push((k, 1.0, unit));
            }
            if program.row_lower[k].is_finite() {
                all.push((k, -1.0, unit));
            }
        }
        Sides(all)
    }

    /// Value beyond the bound, in the units of the user; negative inside.
    fn excess(&self, program: &Program<'_>, c: &DVector<f64>, side: usize) -> f64 {
        let (k, sign, unit) = self.0[side];
        let bound = if sign > 0.0 {
            program.row_upper[k]
        } else {
            program.row_lower[k]
        };
        sign * (c[k] - bound) / unit
    }
}

/// Descends from `point` until the largest violation of a row, in the units of the user, is least
/// to first order. Each trust-region step minimises t subject to excess + ∇excess·d ≤ t (Madsen &
/// Schjær-Jacobsen 1978). Returns the last point, and whether the violation is least there. It is
/// not known to be if a limit ends the search.
pub(crate) fn least_violation(
    program: &mut Program<'_>,
    mut point: Point,
    mut slopes: Derivatives,
) -> (Point, Derivatives, bool) {
    let sides = Sides::of(program);
    let mut radius = point.x.amax().max(1.0);
    let mut least = false;
    loop {
        let worst = program.worst_violation(&point.c).0;
        if program.is_feasible(&point.c) || program.next_iteration().is_err() {
            break;
        }
        let Some((d, promised)) = step(program, &sides, &point, &slopes, worst, radius) else {
            least = true;
            break;
        };
        let gain = worst - promised;
        if gain <= SMALL_PART * worst {
            least = true;
            break;
        }
        let x = program.within_bounds(&point.x + &d);
        let size = d.amax();
        let tried = program
            .evaluate(&x)
            .and_then(|p| program.gradients(&x).map(|s| (p, s)));
        let accepted = match tried {
            Ok(found) => {
                let better = worst - program.worst_violation(&found.0.c).0;
                if better > 0.0 {
                    (point, slopes) = found;
                    if better > 0.75 * gain {
                        radius *= 2.0;
                    }
                    true
                } else {
                    false
                }
            }
            Err(EarlyExit::Failed(_)) => false,
            Err(EarlyExit::Halt(_)) => break,
        };
        if !accepted {
            radius = 0.25 * size.min(radius);
        }
        let progress = Progress {
            optimality: gain,
            step: size,
            regularisation: radius,
            primal_step: if accepted { 1.0 } else { 0.0 },
            trials: 1,
            phase: Phase::Restoration,
            ..Progress::default()
        };
        if program.report(&point, &progress).is_err() {
            break;
        }
    }
    (point, slopes, least)
}

/// Step in x and its predicted largest violation.
fn step(
    program: &mut Program<'_>,
    sides: &Sides,
    point: &Point,
    slopes: &Derivatives,
    worst: f64,
    radius: f64,
) -> Option<(DVector<f64>, f64)> {
    let (n, m) = (point.x.len(), sides.0.len());
    // The last variable is t = worst·(1 − τ), 0 ≤ τ ≤ 1, on the scale of the box.
    let row = |&(k, sign, unit): &(usize, f64, f64)| {
        let entries = slopes.a.row(k).map(|(i, v)| (i, sign * v / unit));
        entries.chain([(n, worst / radius)]).collect()
    };
    let a = Jacobian::from_rows(n + 1, sides.0.iter().map(row));
    let mut above = DVector::zeros(m);
    for side in 0..m {
        above[side] = worst - sides.excess(program, &point.c, side);
    }
    let mut g = DVector::zeros(n + 1);
    g[n] = -worst / radius;
    let infinite = DVector::from_element(m, f64::INFINITY);
    let lower = DVector::from_fn(n + 1, |i, _| match i {
        i if i < n => (program.lower[i] - point.x[i]).clamp(-radius, 0.0),
        _ => 0.0,
    });
    let upper = DVector::from_fn(n + 1, |i, _| match i {
        i if i < n => (program.upper[i] - point.x[i]).clamp(0.0, radius),
        _ => radius,
    });
    // It makes the step unique, and does not decide.
    let sigma = SMALL_PART * worst / (radius * radius);
    let b = Hessian::multiple(sigma, n + 1, n <= program.options.dense_subproblems());
    let data = QpData {
        g: &g,
        b: &b,
        a: &a,
        above: &above,
        below: &infinite,
        // No multiplier exceeds one: the forces on t balance.
        penalty: &DVector::from_element(m, 2.0),
        lower: &lower,
        upper: &upper,
    };
    let zero = DVector::zeros(m);
    let none = DVector::from_element(m, f64::NEG_INFINITY);
    let found = ElasticQp::new(n + 1, &none, &zero).solve(&data, &mut program.counts)?;
    let d = found.d.rows(0, n).into_owned();
    let promised = (0..m)
        .map(|side| {
            let row = a.row(side).filter(|&(i, _)| i < n);
            worst - above[side] + row.map(|(i, v)| v * d[i]).sum::<f64>()
        })
        .fold(0.0, f64::max);
    Some((d, promised))
}
