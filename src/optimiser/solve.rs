//! Start, choice of method, and verdict of a run.

use nalgebra::DVector;

use super::interior_point::InteriorPoint;
use super::nlp::Nlp;
use super::observer::{Observer, Phase};
use super::options::{Method, Options};
use super::outcome::{Kkt, Outcome, Status};
use super::program::{Point, Program, Progress, Slopes, Trouble};
use super::quasi_newton::QuasiNewton;
use super::start::first_point;
use super::state::SavedState;
use super::trust_region::{Ending, Goal, TrustRegion};
use super::verdict::{
    ScaledMultipliers, active, is_solved, kkt, scaled_multipliers, scaled_residual,
    user_multipliers,
};

/// How often the trust-region method looks for a feasible point where the penalties fail.
const FEASIBILITY_PHASES: usize = 2;

/// Least relative distance from a bound of the start of a resumed run.
const RESUMED_PUSH: f64 = 1e-10;

/// Multipliers above this are replaced by fitted ones when a run ends.
const LARGEST_MULTIPLIER: f64 = 1e20;

/// Minimises f(x) subject to c_L ≤ c(x) ≤ c_U and x_L ≤ x ≤ x_U.
///
/// ```
/// use flexbody::optimiser::{solve, Evaluation, EvaluationFailure, Gradients, Nlp, Options, Silent};
/// use nalgebra::dmatrix;
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
///         Ok(Gradients { objective, jacobian: dmatrix![2.0 * x[0], 2.0 * x[1]] })
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
/// A state that does not fit the program, because the number of variables or constraints has
/// changed, gives its point as far as it goes and is ignored otherwise.
pub fn resume(
    nlp: &mut dyn Nlp,
    options: &Options,
    observer: &mut dyn Observer,
    saved: &SavedState,
) -> Outcome {
    run(nlp, options, observer, Some(saved))
}

/// Where a method ended.
struct Finish {
    status: Status,
    point: Point,
    slopes: Slopes,
    multipliers: ScaledMultipliers,
    scaled: f64,
    b: QuasiNewton,
    barrier: f64,
    radius: f64,
}

fn run(
    nlp: &mut dyn Nlp,
    options: &Options,
    observer: &mut dyn Observer,
    saved: Option<&SavedState>,
) -> Outcome {
    let mut program = Program::new(nlp, options, observer);
    let fits = |s: &&SavedState| {
        s.scaling.constraints.len() == program.scaling.constraints.len()
            && s.x.len() == program.scaling.variables.len()
    };
    let saved = saved.filter(fits);
    if let Some(saved) = saved {
        program.start_from(&saved.x);
    }
    let push = if saved.is_some() {
        RESUMED_PUSH
    } else {
        options.bound_push
    };
    let (mut point, mut slopes) = match first_point(&mut program, push) {
        Ok(first) => first,
        Err(Trouble::Halt(status)) => return without_values(&program, status),
        Err(Trouble::Failed(failure)) => {
            return without_values(
                &program,
                Status::UndefinedStart {
                    what: failure.to_string(),
                },
            );
        }
    };
    program.survey(&slopes);
    match saved {
        Some(saved) => program.adopt_scaling(&saved.scaling, &mut point, &mut slopes),
        None => program.scale(&mut point, &mut slopes),
    }
    let rest = DVector::zeros(point.c.len());
    let without_rows = ScaledMultipliers::from_rows(&program, &point, &slopes, rest);
    let progress = Progress {
        optimality: scaled_residual(&program, &point, &slopes, &without_rows),
        barrier: options.initial_barrier,
        step: 0.0,
        regularisation: 0.0,
        primal_step: 0.0,
        dual_step: 0.0,
        trials: 0,
        phase: if options.method == Method::TrustRegion {
            Phase::Sqp
        } else {
            Phase::Regular
        },
    };
    let interrupted = program.report(&point, &progress).is_err();
    let finish = match options.method {
        _ if interrupted => unfinished(&program, point, slopes),
        Method::InteriorPoint => interior_point(&mut program, point, slopes, saved, push),
        Method::TrustRegion => trust_region(&mut program, point, slopes, saved),
        Method::Auto => {
            let first = interior_point(&mut program, point, slopes, saved, push);
            if first.status == Status::Stalled {
                trust_region(&mut program, first.point, first.slopes, None)
            } else {
                first
            }
        }
    };
    let state = state_of(&program, &finish);
    let finish = best_of(&mut program, finish);
    outcome(&program, finish, state)
}

/// Replaces the point of a run that did not converge by a better one it passed through.
fn best_of(program: &mut Program<'_>, finish: Finish) -> Finish {
    let settled = matches!(finish.status, Status::Converged | Status::Infeasible { .. });
    let limit = program.options.constraint_tolerance;
    // What a violation within the tolerance gains is not counted.
    let y = &finish.multipliers.y;
    let value = |p: &Point| {
        p.f + (0..p.c.len())
            .map(|k| y[k].abs() * program.row_violation(&p.c, k))
            .sum::<f64>()
    };
    let rank = |p: &Point| (program.worst_violation(&p.c).0.max(limit), value(p));
    let found = program.best.clone().filter(|best| {
        let (new, old) = (rank(best), rank(&finish.point));
        !settled && (new.0 < old.0 || (new.0 == old.0 && new.1 < old.1))
    });
    let Some(point) = found else {
        return finish;
    };
    let Ok(slopes) = program.gradients(&point.x) else {
        return finish;
    };
    let y = &finish.multipliers.y;
    let multipliers = ScaledMultipliers::polished(program, &point, &slopes, y);
    let scaled = scaled_residual(program, &point, &slopes, &multipliers);
    Finish {
        point,
        slopes,
        multipliers,
        scaled,
        ..finish
    }
}

fn interior_point(
    program: &mut Program<'_>,
    point: Point,
    slopes: Slopes,
    saved: Option<&SavedState>,
    push: f64,
) -> Finish {
    let mut method = InteriorPoint::new(program, point, slopes, push);
    if let Some(saved) = saved {
        let multipliers = scaled_multipliers(program, &saved.multipliers);
        method.adopt(&multipliers, saved.quasi_newton.clone(), saved.barrier);
    }
    let result = method.run(program);
    let status = status_of(program, result, &method.at.point);
    let mut multipliers = method.multipliers(program);
    let mut scaled = method.optimality();
    let (point, slopes) = (method.at.point, method.at.slopes);
    // Multipliers that grow without limit may hide a point that has finite ones; where the rows
    // cannot be satisfied they say nothing.
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
        let residual = scaled_residual(program, &point, &slopes, &fitted);
        let residuals = kkt(program, &point, &slopes, &fitted, residual);
        if useless || is_solved(&residuals, program.options) {
            (multipliers, scaled) = (fitted, residual);
        }
    }
    Finish {
        status,
        multipliers,
        scaled,
        point,
        slopes,
        b: method.b,
        barrier: method.barrier.mu,
        radius: program.options.initial_radius,
    }
}

fn trust_region(
    program: &mut Program<'_>,
    point: Point,
    slopes: Slopes,
    saved: Option<&SavedState>,
) -> Finish {
    let mut method = TrustRegion::new(program, point, slopes, Goal::Optimum);
    if let Some(saved) = saved {
        method.y = scaled_multipliers(program, &saved.multipliers).y;
        if saved.quasi_newton.order() == method.b.order() {
            method.b = saved.quasi_newton.clone();
        }
        method.radius = saved.radius;
    }
    let mut result = method.run(program, |_, _| false);
    for _ in 0..FEASIBILITY_PHASES {
        let limit = program.options.constraint_tolerance;
        let stuck = matches!(result, Ok(Ending::Stalled | Ending::Infeasible));
        if !stuck || program.worst_violation(&method.point.c).0 <= limit {
            break;
        }
        let (point, slopes) = (method.point.clone(), method.slopes.clone());
        let mut phase = TrustRegion::new(program, point, slopes, Goal::Feasibility);
        result = phase.run(program, |program, p| {
            program.worst_violation(&p.c).0 <= limit
        });
        let (point, slopes) = (phase.point, phase.slopes);
        method = TrustRegion::new(program, point, slopes, Goal::Optimum);
        if !matches!(result, Ok(Ending::Reached)) {
            break;
        }
        result = method.run(program, |_, _| false);
    }
    let status = status_of(program, result, &method.point);
    Finish {
        status,
        multipliers: method.multipliers(program),
        scaled: method.optimality(program),
        point: method.point,
        slopes: method.slopes,
        b: method.b,
        barrier: program.options.initial_barrier,
        radius: method.radius,
    }
}

/// The start, where the observer asked to stop at once.
fn unfinished(program: &Program<'_>, point: Point, slopes: Slopes) -> Finish {
    let y = DVector::zeros(point.c.len());
    let multipliers = ScaledMultipliers::from_rows(program, &point, &slopes, y);
    let options = program.options;
    Finish {
        status: Status::Interrupted,
        b: QuasiNewton::new(point.x.len(), options.dense_limit, options.memory),
        scaled: scaled_residual(program, &point, &slopes, &multipliers),
        multipliers,
        point,
        slopes,
        barrier: options.initial_barrier,
        radius: options.initial_radius,
    }
}

fn status_of(program: &Program<'_>, result: Result<Ending, Trouble>, at: &Point) -> Status {
    match result {
        Ok(Ending::Reached) => Status::Converged,
        Ok(Ending::Unbounded) => Status::Unbounded,
        Ok(Ending::Infeasible) => {
            let (violation, j) = program.worst_violation(&at.c);
            Status::Infeasible {
                constraint: program.constraint_name(j),
                violation,
            }
        }
        Ok(Ending::Stalled) | Err(Trouble::Failed(_)) => Status::Stalled,
        Err(Trouble::Halt(status)) => status,
    }
}

/// State at the last point, which need not be the best.
fn state_of(program: &Program<'_>, finish: &Finish) -> SavedState {
    SavedState {
        x: program.to_user(&finish.point.x),
        multipliers: user_multipliers(program, &finish.multipliers),
        scaling: program.scaling.clone(),
        quasi_newton: finish.b.stored(),
        barrier: finish.barrier,
        radius: finish.radius,
    }
}

fn outcome(program: &Program<'_>, finish: Finish, state: SavedState) -> Outcome {
    let Finish {
        mut status,
        point,
        slopes,
        multipliers,
        scaled,
        ..
    } = finish;
    let kkt = kkt(program, &point, &slopes, &multipliers, scaled);
    // A method that can go no further has converged if the conditions hold all the same.
    if matches!(status, Status::Converged | Status::Stalled) {
        let solved = is_solved(&kkt, program.options);
        status = if solved {
            Status::Converged
        } else {
            Status::Stalled
        };
    }
    let x = program.to_user(&point.x);
    let mut constraints = vec![0.0; program.scaling.constraints.len()];
    for (k, &j) in program.rows.iter().enumerate() {
        constraints[j] = point.c[k] / program.scaling.constraints[j];
    }
    let user = user_multipliers(program, &multipliers);
    let nlp = program.nlp();
    let (lower, upper) = nlp.variable_bounds();
    let (row_lower, row_upper) = nlp.constraint_bounds();
    let of_bound = |i: usize| (user.lower_bounds[i], user.upper_bounds[i]);
    let of_row = |j: usize| {
        (
            (-user.constraints[j]).max(0.0),
            user.constraints[j].max(0.0),
        )
    };
    let mut counts = program.counts;
    counts.seconds = program.seconds();
    Outcome {
        status,
        objective: point.f / program.scaling.objective,
        active_bounds: active(&x, (&lower, &upper), of_bound, |i| nlp.variable_name(i)),
        active_constraints: active(&constraints, (&row_lower, &row_upper), of_row, |j| {
            nlp.constraint_name(j)
        }),
        kkt,
        counts,
        failed_designs: program.failed.clone(),
        scaling: program.scaling.clone(),
        state: Some(state),
        constraints,
        multipliers: user,
        x,
    }
}

fn without_values(program: &Program<'_>, status: Status) -> Outcome {
    let mut counts = program.counts;
    counts.seconds = program.seconds();
    Outcome {
        status,
        x: program.to_user(&program.start()),
        objective: f64::NAN,
        constraints: vec![f64::NAN; program.scaling.constraints.len()],
        multipliers: Default::default(),
        kkt: Kkt::default(),
        active_bounds: Vec::new(),
        active_constraints: Vec::new(),
        counts,
        failed_designs: program.failed.clone(),
        scaling: program.scaling.clone(),
        state: None,
    }
}
