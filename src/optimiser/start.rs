//! The first point of a run.

use nalgebra::DVector;

use super::iterate::margin;
use super::nlp::EvaluationFailure;
use super::options::Method;
use super::program::{Point, Program, Slopes, Trouble};

/// Starts tried where the functions are not defined.
const START_TRIALS: usize = 12;

/// Points tried beside one that seems infeasible, and the part of its violation that one of them must
/// be below.
const ESCAPE_TRIALS: usize = 6;
const LESS: f64 = 0.99;

/// Evaluates the start, moved into the interior of the bounds, or points near it.
pub(super) fn first_point(
    program: &mut Program<'_>,
    push: f64,
) -> Result<(Point, Slopes), Trouble> {
    let start = program.start();
    let mut first_failure: Option<EvaluationFailure> = None;
    for trial in 0..START_TRIALS {
        let x = perturbed(program, &start, trial, push);
        let tried = program
            .evaluate(&x)
            .and_then(|p| program.gradients(&x).map(|s| (p, s)));
        match tried {
            Ok(found) => return Ok(found),
            Err(Trouble::Failed(failure)) => {
                first_failure.get_or_insert(failure);
            }
            Err(halt) => return Err(halt),
        }
    }
    let missing = EvaluationFailure {
        what: "the start".into(),
        reason: "no trial".into(),
    };
    Err(Trouble::Failed(first_failure.unwrap_or(missing)))
}

/// A point near `at`, with its slopes, that violates the rows clearly less: where the violation has a
/// maximum or a saddle, its derivatives vanish but it can be reduced.
pub(super) fn less_violated(
    program: &mut Program<'_>,
    at: &Point,
) -> Result<Option<(Point, Slopes)>, Trouble> {
    let now = program.total_violation(&at.c);
    for trial in 1..=ESCAPE_TRIALS {
        let x = perturbed(program, &at.x, trial, program.options.bound_push);
        let point = match program.evaluate(&x) {
            Ok(point) => point,
            Err(Trouble::Failed(_)) => continue,
            Err(halt) => return Err(halt),
        };
        if program.total_violation(&point.c) < LESS * now {
            let slopes = program.gradients(&x)?;
            return Ok(Some((point, slopes)));
        }
    }
    Ok(None)
}

/// The start for `trial` 0, then points at growing distances in alternating directions.
fn perturbed(program: &Program<'_>, start: &DVector<f64>, trial: usize, push: f64) -> DVector<f64> {
    let options = program.options;
    DVector::from_fn(start.len(), |i, _| {
        let (l, u) = (program.lower[i], program.upper[i]);
        let width = u - l;
        let margin = |bound: f64| margin(bound, width, push);
        // Weyl sequence: spreads the directions without a random generator.
        let phase = ((trial * (i + 1)) as f64 * 0.618_033_988_749_895).fract() - 0.5;
        let reach = if width.is_finite() {
            width
        } else {
            start[i].abs().max(1.0)
        };
        let shift = if trial == 0 {
            0.0
        } else {
            reach * phase * (trial as f64 / 6.0).min(1.0)
        };
        let mut x = start[i] + shift;
        if options.method != Method::TrustRegion || trial > 0 {
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
