//! A run of the interior point: restarts in better scale, and its final iterate.

use nalgebra::DVector;

use crate::constants::HALF_OF_DIGITS;
use crate::convergence::{is_solved, scaled_residual};
use crate::ending::FinalIterate;
use crate::interior_point::iteration::InteriorPoint;
use crate::multipliers::{ScaledMultipliers, scaled_multipliers};
use crate::options::Method;
use crate::program::{Derivatives, Point, Program};
use crate::renewal::renewed;
use crate::state::SavedState;

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
        let method = InteriorPoint::new(program, point, slopes, HALF_OF_DIGITS);
        finish_interior_point(program, method)
    })
}

fn finish_interior_point(program: &mut Program<'_>, mut method: InteriorPoint) -> FinalIterate {
    let status = method.run(program);
    let mut multipliers = method.multipliers(program);
    let mut scaled = method.optimality();
    let (point, slopes) = (&method.at.point, &method.at.slopes);
    // The forces of dependent rows and bounds may balance each other at any size. Where their rounding
    // exceeds the tolerance, none may do as well.
    let balanced = multipliers.zl.amax().max(multipliers.zu.amax());
    if f64::EPSILON * balanced > program.options.tolerance * slopes.g.amax() {
        let zero = DVector::zeros(point.c.len());
        let fitted = ScaledMultipliers::polished(program, point, slopes, &zero);
        let residual = scaled_residual(program, point, slopes, &fitted);
        if is_solved(program, point, slopes, &fitted, residual) {
            (multipliers, scaled) = (fitted, residual);
        }
    }
    FinalIterate {
        status,
        method: Method::InteriorPoint,
        multipliers,
        scaled,
        units: program.units(),
        point: method.at.point,
        slopes: method.at.slopes,
        b: method.b,
        barrier: method.barrier.mu,
        radius: program.options.initial_radius,
    }
    .judged(program)
}
