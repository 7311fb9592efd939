//! A run of the trust region: phases without the objective, and its final iterate.

use crate::optimiser::ending::{Claim, Ending, FinalIterate, status_of};
use crate::optimiser::multipliers::scaled_multipliers;
use crate::optimiser::options::Method;
use crate::optimiser::program::{Derivatives, EarlyExit, Point, Program};
use crate::optimiser::renewal::renewed;
use crate::optimiser::state::SavedState;
use crate::optimiser::trust_region::steering::{Goal, TrustRegion};

/// How often the trust-region method looks for a feasible point after the penalties failed.
const FEASIBILITY_PHASES: usize = 2;

pub(crate) fn trust_region(
    program: &mut Program<'_>,
    point: Point,
    slopes: Derivatives,
    saved: Option<&SavedState>,
) -> FinalIterate {
    let mut method = TrustRegion::new(program, point, slopes, Goal::Optimum);
    if let Some(saved) = saved {
        method.y = scaled_multipliers(program, &saved.multipliers).y;
        if saved.quasi_newton.order() == method.b.order() {
            method.b = saved.quasi_newton.clone();
        }
        method.radius = saved.radius;
    }
    let finish = finish_trust_region(program, method);
    renewed(program, finish, |program, (point, slopes)| {
        let method = TrustRegion::new(program, point, slopes, Goal::Optimum);
        finish_trust_region(program, method)
    })
}

fn finish_trust_region(program: &mut Program<'_>, mut method: TrustRegion) -> FinalIterate {
    let mut result = optimise(program, &mut method);
    for _ in 0..FEASIBILITY_PHASES {
        let stuck = matches!(result, Ok(Ending::Stalled | Ending::Infeasible));
        if !stuck || program.is_feasible(&method.point.c) {
            break;
        }
        let (point, slopes) = (method.point.clone(), method.slopes.clone());
        let mut phase = TrustRegion::new(program, point, slopes, Goal::Feasibility);
        result = phase.run(program, |program, p| program.is_feasible(&p.c));
        let (point, slopes) = (phase.point, phase.slopes);
        method = TrustRegion::new(program, point, slopes, Goal::Optimum);
        if !matches!(result, Ok(Ending::Reached)) {
            break;
        }
        result = optimise(program, &mut method);
    }
    let status = status_of(program, result, &method.point);
    FinalIterate {
        status,
        method: Method::TrustRegion,
        multipliers: method.multipliers(program),
        scaled: method.optimality(program),
        claim: Claim::Untested,
        units: program.units(),
        point: method.point,
        slopes: method.slopes,
        b: method.b,
        barrier: program.options.initial_barrier,
        radius: method.radius,
    }
}

/// Runs the trust region, and again in better units if those of the start do not suit its end.
fn optimise(program: &mut Program<'_>, method: &mut TrustRegion) -> Result<Ending, EarlyExit> {
    loop {
        let ending = method.run(program, |_, _| false)?;
        if !matches!(ending, Ending::Misscaled | Ending::Stalled) {
            return Ok(ending);
        }
        let Some(factor) = method.better_scale(program) else {
            return Ok(ending);
        };
        program.rescale(factor);
        let slopes = program.gradients(&method.point.x)?;
        method.rescale(factor, slopes);
    }
}
