//! The first point of a run.

use nalgebra::DVector;

use crate::constants::SMALL_PART;
use crate::interior_point::iterate::margin;
use crate::nlp::EvaluationFailure;
use crate::options::Method;
use crate::program::{Derivatives, EarlyExit, Point, Program};

/// Distances of the points tried near one that seems infeasible or at which the functions are
/// undefined, relative to the size of the point if there are no bounds.
const REACHES: [f64; 7] = [0.2, 1.0, 5.0, 0.5, 50.0, 500.0, 1e-3];

/// Evaluates the start, moved into the interior of the bounds, or points near it.
pub(crate) fn first_point(
    program: &mut Program<'_>,
    push: f64,
) -> Result<(Point, Derivatives), EarlyExit> {
    let start = program.start();
    let mut first_failure: Option<EvaluationFailure> = None;
    for trial in 0..=REACHES.len() {
        let reach = if trial > 0 { REACHES[trial - 1] } else { 0.0 };
        let x = perturbed(program, &start, trial, push, reach);
        let tried = program
            .evaluate(&x)
            .and_then(|p| program.gradients(&x).map(|s| (p, s)));
        match tried {
            Ok(found) => return Ok(found),
            Err(EarlyExit::Failed(failure)) => {
                first_failure.get_or_insert(failure);
            }
            Err(halt) => return Err(halt),
        }
    }
    let missing = EvaluationFailure {
        what: "the start".into(),
        reason: "no trial".into(),
    };
    Err(EarlyExit::Failed(first_failure.unwrap_or(missing)))
}

/// The violation around a point at which its derivatives show no descent.
pub(crate) enum Neighbourhood {
    /// It is clearly less at this point. The first point was a maximum, a saddle or one of several
    /// minima.
    Less(Box<(Point, Derivatives)>),
    /// It is constant. Derivatives give no direction.
    Flat,
    /// It rises.
    More,
}

/// Tries points around `at`, near and far. At a maximum, at a saddle and on a plateau of the
/// violation its derivatives vanish too.
pub(crate) fn look_around(
    program: &mut Program<'_>,
    at: &Point,
) -> Result<Neighbourhood, EarlyExit> {
    let now = program.total_violation(&at.c);
    let mut largest = 0.0_f64;
    for trial in 1..=REACHES.len() {
        let x = perturbed(
            program,
            &at.x,
            trial,
            program.options.bound_push,
            REACHES[trial - 1],
        );
        let point = match program.evaluate(&x) {
            Ok(point) => point,
            Err(EarlyExit::Failed(_)) => continue,
            Err(halt) => return Err(halt),
        };
        let change = program.total_violation(&point.c) - now;
        if change < -SMALL_PART * now {
            let slopes = program.gradients(&x)?;
            return Ok(Neighbourhood::Less(Box::new((point, slopes))));
        }
        largest = largest.max(change.abs());
    }
    Ok(if largest <= SMALL_PART * now {
        Neighbourhood::Flat
    } else {
        Neighbourhood::More
    })
}

/// A feasible point near a start that seems solved at which the objective is lower: the start is a
/// maximum or a saddle, or its gradients are wrong.
pub(crate) fn left_start(program: &mut Program<'_>, at: &Point) -> Option<(Point, Derivatives)> {
    let push = program.options.bound_push;
    let lost = program.options.tolerance * at.f.abs();
    for trial in 1..=2 {
        let x = perturbed(program, &at.x, trial, push, push);
        let point = program.evaluate(&x).ok()?;
        if point.f < at.f - lost && program.is_feasible(&point.c) {
            let slopes = program.gradients(&x).ok()?;
            return Some((point, slopes));
        }
    }
    None
}

/// The start for `trial` 0, then points in changing directions. Their distance is up to the part
/// `part` of the distance of two bounds or of the size of the start.
fn perturbed(
    program: &Program<'_>,
    start: &DVector<f64>,
    trial: usize,
    push: f64,
    part: f64,
) -> DVector<f64> {
    let options = program.options;
    DVector::from_fn(start.len(), |i, _| {
        let (l, u) = (program.lower[i], program.upper[i]);
        let width = u - l;
        let margin = |bound: f64| margin(bound, width, push);
        // Weyl sequence: spreads the directions without a random generator.
        let phase = ((trial * (i + 1)) as f64 * 0.618_033_988_749_895).fract() - 0.5;
        let reach = if width.is_finite() {
            width * part.min(1.0)
        } else {
            start[i].abs().max(1.0) * part
        };
        let shift = if trial == 0 { 0.0 } else { reach * phase };
        let mut x = start[i] + shift;
        let inside = !matches!(options.method, Method::TrustRegion | Method::LeastSquares);
        if inside || trial > 0 {
            x = if l.is_finite() {
                x.max(l + margin(l))
            } else {
                x
            };
            x = if u.is_finite() {
                x.min(u - margin(u))
            } else {
                x
            };
        }
        x
    })
}
