//! A run of the trust region: phases without the objective, and its final iterate.

use crate::ending::{FinalIterate, unfinished};
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
    kind: Method,
) -> FinalIterate {
    let mut method = match of_kind(program, (point, slopes), kind) {
        Ok(method) => method,
        Err(unable) => return *unable,
    };
    if let Some(saved) = saved {
        method.y = scaled_multipliers(program, &saved.multipliers).y;
        if saved.quasi_newton.order() == method.b.order() {
            method.b = saved.quasi_newton.clone();
        }
        method.radius = saved.radius;
    }
    let finish = finish_trust_region(program, method, kind);
    renewed(program, finish, |program, first| {
        match of_kind(program, first, kind) {
            Ok(method) => finish_trust_region(program, method, kind),
            Err(unable) => *unable,
        }
    })
}

/// The state of the method `kind` at a point, or why it cannot begin there.
fn of_kind(
    program: &mut Program<'_>,
    (point, slopes): (Point, Derivatives),
    kind: Method,
) -> Result<TrustRegion, Box<FinalIterate>> {
    if kind != Method::LeastSquares {
        return Ok(TrustRegion::new(program, point, slopes, Goal::Optimum));
    }
    let status = match program.residuals(&point.x) {
        Ok(Some(squares)) => {
            let mut method = TrustRegion::new(program, point, slopes, Goal::Optimum);
            method.fit(program, squares);
            return Ok(method);
        }
        Ok(None) => Status::IllPosed {
            what: "the objective has no residuals, which least squares need".into(),
        },
        Err(trouble) => trouble.into(),
    };
    let unable = unfinished(program, point, slopes);
    Err(Box::new(unable.with_status(status)))
}

fn finish_trust_region(
    program: &mut Program<'_>,
    mut method: TrustRegion,
    kind: Method,
) -> FinalIterate {
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
        method = match of_kind(program, (phase.point, phase.slopes), kind) {
            Ok(method) => method,
            Err(unable) => return *unable,
        };
        if status == Status::Converged {
            status = optimise(program, &mut method);
        }
    }
    let finish = FinalIterate {
        status,
        method: kind,
        multipliers: method.multipliers(program),
        scaled: method.optimality(program),
        units: program.units(),
        point: method.point,
        slopes: method.slopes,
        b: method.b,
        barrier: program.options.first_barrier(),
        radius: method.radius,
    };
    // A fit has its own conditions.
    match (kind, &finish.status) {
        (Method::LeastSquares, Status::Converged) => finish,
        _ => finish.judged(program),
    }
}
