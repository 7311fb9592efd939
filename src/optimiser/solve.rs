//! Start, choice of method, and verdict of a run.

use nalgebra::DVector;

use crate::constants::HALF_OF_DIGITS;
use crate::convergence::scaled_residual;
use crate::doubts::{doubted, wrong_gradients};
use crate::ending::{FinalIterate, best_of, unfinished, without_freedom};
use crate::interior_point::run::interior_point;
use crate::least_violation::least_violation;
use crate::multipliers::ScaledMultipliers;
use crate::nlp::Nlp;
use crate::observer::{Observer, Phase};
use crate::options::{Method, Options};
use crate::outcome::Outcome;
use crate::program::{Derivatives, EarlyExit, Point, Program, Progress};
use crate::report::{outcome, state_of, untried, without_values};
use crate::start::{Neighbourhood, first_point, left_start, look_around};
use crate::state::SavedState;
use crate::status::Status;
use crate::trust_region::run::trust_region;
use crate::well_posed;

/// Share of iterations, and half as much of evaluations, after which [`Method::Auto`] changes from the interior point
/// to the trust region. A run that needs as much is likely to need all, and one with three
/// evaluations an iteration crawls.
const FIRST_SHARE: f64 = 0.7;

/// Minimises f(x) subject to c_L ≤ c(x) ≤ c_U and x_L ≤ x ≤ x_U.
///
/// ```
/// use flexbody_optimiser::{
///     Evaluation, EvaluationFailure, Gradients, Jacobian, Nlp, Options, Silent, solve,
/// };
///
/// /// Minimise (x − 2)² + y² subject to x² + y² ≤ 1.
/// struct Disc;
///
/// impl Nlp for Disc {
///     fn variables(&self) -> usize { 2 }
///     fn constraints(&self) -> usize { 1 }
///     fn variable_bounds(&self) -> (Vec<f64>, Vec<f64>) {
///         (vec![f64::NEG_INFINITY; 2], vec![f64::INFINITY; 2])
///     }
///     fn constraint_bounds(&self) -> (Vec<f64>, Vec<f64>) {
///         (vec![f64::NEG_INFINITY], vec![1.0])
///     }
///     fn start(&self) -> Vec<f64> { vec![0.0, 0.5] }
///     fn evaluate(&mut self, x: &[f64]) -> Result<Evaluation, EvaluationFailure> {
///         let objective = (x[0] - 2.0).powi(2) + x[1] * x[1];
///         Ok(Evaluation { objective, constraints: vec![x[0] * x[0] + x[1] * x[1]] })
///     }
///     fn gradients(&mut self, x: &[f64]) -> Result<Gradients, EvaluationFailure> {
///         let objective = vec![2.0 * (x[0] - 2.0), 2.0 * x[1]];
///         Ok(Gradients { objective, jacobian: Jacobian::dense(1, 2, vec![2.0 * x[0], 2.0 * x[1]]) })
///     }
/// }
///
/// let outcome = solve(&mut Disc, &Options::default(), &mut Silent);
/// assert!(outcome.converged());
/// assert!((outcome.x[0] - 1.0).abs() < 1e-6);
/// assert!((outcome.multipliers.constraints[0] - 1.0).abs() < 1e-4);
/// ```
pub fn solve(nlp: &mut dyn Nlp, options: &Options, observer: &mut dyn Observer) -> Outcome {
    run(nlp, options, observer, None)
}

/// As [`solve`], continuing from the point, multipliers and quasi-Newton matrix of an earlier run.
///
/// A state with other numbers of variables or constraints is ignored. A state of another objective
/// gives its point alone. A damaged state ([`SavedState::fault`]) ends the run as
/// [`Status::IllPosed`].
pub fn resume(
    nlp: &mut dyn Nlp,
    options: &Options,
    observer: &mut dyn Observer,
    saved: &SavedState,
) -> Outcome {
    run(nlp, options, observer, Some(saved))
}

fn run(
    nlp: &mut dyn Nlp,
    options: &Options,
    observer: &mut dyn Observer,
    saved: Option<&SavedState>,
) -> Outcome {
    if let Some(status) = well_posed::fault(nlp, options) {
        return untried(nlp, status);
    }
    let (n, m) = (nlp.variables(), nlp.constraints());
    let saved = saved.filter(|s| s.x.len() == n && s.scaling.constraints.len() == m);
    if let Some(fault) = saved.and_then(|s| s.fault(n, m)) {
        let what = format!("the saved state is damaged: {fault}");
        return untried(nlp, Status::IllPosed { what });
    }
    let mut program = Program::new(nlp, options, observer);
    if let Some(saved) = saved {
        program.start_from(&saved.x);
    }
    if saved.is_none() {
        program.measure_start();
    }
    let push = if saved.is_some() {
        // So near a bound that the start stays where it was.
        HALF_OF_DIGITS
    } else {
        options.bound_push
    };
    let (mut point, mut slopes) = match first_point(&mut program, push) {
        Ok(first) => first,
        Err(EarlyExit::Halt(status)) => return without_values(&program, status),
        Err(EarlyExit::Failed(failure)) => {
            return without_values(
                &program,
                Status::UndefinedStart {
                    what: failure.to_string(),
                },
            );
        }
    };
    program.record_scale(&slopes);
    let saved = saved.filter(|s| s.is_of(point.f));
    match saved {
        Some(saved) => program.adopt_scaling(&saved.scaling, &mut point, &mut slopes),
        None => {
            program.measure_mixed(&mut point, &mut slopes);
            program.scale(&mut point, &mut slopes);
        }
    }
    let rest = DVector::zeros(point.c.len());
    let without_rows = ScaledMultipliers::from_rows(&program, &point, &slopes, rest);
    let progress = Progress {
        optimality: scaled_residual(&program, &point, &slopes, &without_rows),
        barrier: options.first_barrier(),
        phase: match options.method {
            Method::TrustRegion | Method::LeastSquares => Phase::Sqp,
            Method::InteriorPoint | Method::Auto => Phase::Regular,
        },
        ..Progress::default()
    };
    let interrupted = program.report(&point, &progress).is_err();
    let finish = if interrupted {
        unfinished(&program, point, slopes)
    } else if program.free.is_empty() {
        without_freedom(&program, point, slopes)
    } else {
        let first = (point, slopes);
        match options.method {
            Method::Auto => auto(&mut program, first, saved, push),
            method => attempt(&mut program, method, first, saved, push),
        }
    };
    let state = state_of(&program, &finish);
    program.forgive_failures();
    let finish = best_of(&mut program, finish);
    let finish = doubted(&mut program, finish);
    outcome(&program, finish, state)
}

/// Runs one method. If it ends at a point that looks infeasible to first order only, it runs again
/// from a nearby point with a smaller violation.
fn attempt(
    program: &mut Program<'_>,
    method: Method,
    first: (Point, Derivatives),
    saved: Option<&SavedState>,
    push: f64,
) -> FinalIterate {
    let run = |program: &mut Program<'_>, (point, slopes), saved| match method {
        Method::TrustRegion | Method::LeastSquares => {
            trust_region(program, point, slopes, saved, method)
        }
        Method::InteriorPoint | Method::Auto => interior_point(program, point, slopes, saved, push),
    };
    let mut finish = run(program, first, saved);
    if saved.is_none() && program.counts.iterations <= 1 && finish.status == Status::Converged {
        finish = match left_start(program, &finish.point) {
            Some(next) => run(program, next, None),
            None => finish,
        };
        if program.counts.iterations == 0
            && let Some(what) = wrong_gradients(program, &finish.point, &finish.slopes)
        {
            finish.status = Status::Inconsistent { what };
        }
    }
    escaped(program, finish, |program, first| run(program, first, None))
}

/// What becomes of a final iterate that looks infeasible to first order: the end of a further run
/// from a point that is feasible or less infeasible, or the point of the least violation.
fn escaped(
    program: &mut Program<'_>,
    mut finish: FinalIterate,
    run: impl Fn(&mut Program<'_>, (Point, Derivatives)) -> FinalIterate,
) -> FinalIterate {
    for may_leave in [true, false] {
        if !matches!(finish.status, Status::Infeasible { .. }) {
            return finish;
        }
        if let Some(best) = program.feasible_best() {
            finish = match program.renew(best) {
                Ok(first) => run(program, first),
                Err(trouble) => {
                    finish.restore_units(program);
                    finish.with_status(trouble.into())
                }
            };
            continue;
        }
        let around = if may_leave {
            look_around(program, &finish.point)
        } else {
            Ok(Neighbourhood::More)
        };
        match around {
            Ok(Neighbourhood::Less(first)) => finish = run(program, *first),
            Ok(Neighbourhood::Flat) => return finish.with_status(Status::Stalled),
            Ok(Neighbourhood::More) | Err(EarlyExit::Failed(_)) => {
                let (point, slopes, least) =
                    least_violation(program, finish.point.clone(), finish.slopes.clone());
                if program.is_feasible(&point.c) {
                    finish = run(program, (point, slopes));
                } else {
                    let at_least = finish.infeasible_at(program, point, slopes);
                    return match least {
                        true => at_least,
                        false => at_least.with_status(Status::Stalled),
                    };
                }
            }
            Err(EarlyExit::Halt(status)) => return finish.with_status(status),
        }
    }
    if matches!(finish.status, Status::Infeasible { .. }) && program.feasible_best().is_some() {
        return finish.with_status(Status::Stalled);
    }
    finish
}

/// The interior point with a part of the work. If it ends without a solution, the trust region from
/// the start, or from the best point if the start led nowhere and work is left. The better end
/// counts, and the outcome names its method.
fn auto(
    program: &mut Program<'_>,
    first: (Point, Derivatives),
    saved: Option<&SavedState>,
    push: f64,
) -> FinalIterate {
    program.set_budget(FIRST_SHARE, 0.5 * FIRST_SHARE);
    let (start, units) = (first.clone(), program.units());
    let mut kept = attempt(program, Method::InteriorPoint, first, saved, push);
    program.set_budget(1.0, 1.0);
    for from_best in [false, true] {
        let hopeless = matches!(
            kept.status,
            Status::Stalled
                | Status::IterationLimit
                | Status::EvaluationLimit
                | Status::AtPrecision
                | Status::Degenerate { .. }
                | Status::Infeasible { .. }
        );
        let large = program.free.len() > well_posed::LARGEST_TRUST_REGION;
        if !hopeless || large {
            break;
        }
        // At the best point the rows cannot be improved.
        if from_best && matches!(kept.status, Status::Infeasible { .. }) {
            break;
        }
        program.set_units(&units);
        program.forgive_failures();
        let place = match program.best.clone().filter(|_| from_best) {
            None => start.clone(),
            Some(best) => match program.gradients(&best.x) {
                Ok(slopes) => (best, slopes),
                Err(_) => break,
            },
        };
        let next = attempt(program, Method::TrustRegion, place, None, push);
        // A verdict is preferred to none. Without a verdict the better point is kept.
        let undecided = matches!(
            next.status,
            Status::Stalled | Status::IterationLimit | Status::EvaluationLimit
        );
        let keep = match kept.status {
            Status::Infeasible { .. } => undecided,
            Status::AtPrecision => undecided || next.is_worse_than(&kept, program),
            Status::Degenerate { .. } => next.status != Status::Converged,
            _ => false,
        };
        let (ended, replaced) = match keep {
            true => (kept, next),
            false => (next, kept),
        };
        kept = ended;
        if kept.method != replaced.method {
            program.other = Some(replaced.status);
        }
        kept.restore_units(program);
    }
    kept
}
