//! A run of the trust region: phases without the objective, and its final iterate.

use crate::ending::FinalIterate;
use crate::multipliers::scaled_multipliers;
use crate::options::Method;
use crate::program::{Derivatives, Point, Program};
use crate::renewal::renewed;
use crate::state::SavedState;
use crate::status::Status;
use crate::trust_region::steering::{Goal, TrustRegion};

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
    let optimise = |program: &mut Program<'_>, method: &mut TrustRegion| {
        let ending = method.iterate(program, |_, _| false);
        ending.unwrap_or_else(Status::from)
    };
    let mut status = optimise(program, &mut method);
    let stuck = matches!(status, Status::Stalled | Status::Infeasible { .. });
    if stuck && !program.is_feasible(&method.point.c) {
        let (point, slopes) = (method.point, method.slopes);
        let mut phase = TrustRegion::new(program, point, slopes, Goal::Feasibility);
        let ending = phase.iterate(program, |program, p| program.is_feasible(&p.c));
        status = ending.unwrap_or_else(Status::from);
        method = TrustRegion::new(program, phase.point, phase.slopes, Goal::Optimum);
        if status == Status::Converged {
            status = optimise(program, &mut method);
        }
    }
    FinalIterate {
        status,
        method: Method::TrustRegion,
        multipliers: method.multipliers(program),
        scaled: method.optimality(program),
        units: program.units(),
        point: method.point,
        slopes: method.slopes,
        b: method.b,
        barrier: program.options.first_barrier(),
        radius: method.radius,
    }
    .judged(program)
}
