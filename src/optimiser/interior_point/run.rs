//! A run of the interior point: restarts in better scale, and its final iterate.

use nalgebra::DVector;

use crate::optimiser::convergence::{is_solved, scaled_residual};
use crate::optimiser::ending::{FinalIterate, Status};
use crate::optimiser::interior_point::iteration::InteriorPoint;
use crate::optimiser::multipliers::{ScaledMultipliers, scaled_multipliers};
use crate::optimiser::options::Method;
use crate::optimiser::program::{Derivatives, Point, Program};
use crate::optimiser::renewal::renewed;
use crate::optimiser::state::SavedState;

/// Least relative distance of the start of a resumed run from a bound.
pub(crate) const RESUMED_PUSH: f64 = 1e-10;

/// Larger multipliers are replaced by fitted ones at the end of a run.
const LARGEST_MULTIPLIER: f64 = 1e20;

pub(crate) fn interior_point(
    program: &mut Program<'_>,
    point: Point,
    slopes: Derivatives,
    saved: Option<&SavedState>,
    push: f64,
) -> FinalIterate {
    let mut method = InteriorPoint::new(program, point, slopes, push);
    if let Some(saved) = saved {
        let multipliers = scaled_multipliers(program, &saved.multipliers);
        method.warm_start(&multipliers, saved.quasi_newton.clone(), saved.barrier);
    }
    let finish = finish_interior_point(program, method);
    renewed(program, finish, |program, (point, slopes)| {
        let method = InteriorPoint::new(program, point, slopes, RESUMED_PUSH);
        finish_interior_point(program, method)
    })
}

fn finish_interior_point(program: &mut Program<'_>, mut method: InteriorPoint) -> FinalIterate {
    let status = method.run(program);
    let mut multipliers = method.multipliers(program);
    let mut scaled = method.optimality();
    let (point, slopes) = (method.at.point, method.at.slopes);
    // Unbounded multipliers may hide finite ones at the same point. They mean nothing if the rows
    // cannot be satisfied.
    let bounded = multipliers
        .y
        .iter()
        .chain(&multipliers.zl)
        .chain(&multipliers.zu);
    let sane = -LARGEST_MULTIPLIER..=LARGEST_MULTIPLIER;
    let useless =
        matches!(status, Status::Infeasible { .. }) || bounded.copied().any(|v| !sane.contains(&v));
    if status == Status::Stalled || useless {
        let zero = DVector::zeros(point.c.len());
        let y = if useless { &zero } else { &multipliers.y };
        let fitted = ScaledMultipliers::polished(program, &point, &slopes, y);
        // A barrier that has not fallen leaves forces of bounds that are not active.
        let mut released = fitted.clone();
        released.release(program, &point);
        for choice in [fitted, released] {
            let residual = scaled_residual(program, &point, &slopes, &choice);
            let solved = is_solved(program, &point, &slopes, &choice, residual);
            if useless || solved {
                (multipliers, scaled) = (choice, residual);
                break;
            }
        }
    }
    FinalIterate {
        status,
        method: Method::InteriorPoint,
        multipliers,
        scaled,
        units: program.units(),
        point,
        slopes,
        b: method.b,
        barrier: method.barrier.mu,
        radius: program.options.initial_radius,
    }
    .judged(program)
}
