//! The outcome of a run, made of its final iterate.

use crate::convergence::unit_of_forces;
use crate::ending::FinalIterate;
use crate::multipliers::user_multipliers;
use crate::nlp::Nlp;
use crate::options::Method;
use crate::outcome::{ActiveBound, BoundSide, Counts, Kkt, Outcome};
use crate::program::{Derivatives, Program};
use crate::state::{SavedState, Scaling};
use crate::status::Status;

/// State at the last point, which may differ from the best.
pub(crate) fn state_of(program: &Program<'_>, finish: &FinalIterate) -> SavedState {
    SavedState {
        x: program.to_user(&finish.point.x),
        objective: finish.point.f / program.scaling.objective,
        multipliers: user_multipliers(program, &finish.slopes, &finish.multipliers),
        scaling: Scaling {
            typical_gradient: program.typical_gradient(),
            ..program.scaling.clone()
        },
        quasi_newton: finish.b.stored(),
        barrier: finish.barrier,
        radius: finish.radius,
    }
}

pub(crate) fn outcome(program: &Program<'_>, finish: FinalIterate, state: SavedState) -> Outcome {
    let kkt = finish.kkt(program);
    let FinalIterate {
        status,
        method,
        point,
        slopes,
        multipliers,
        ..
    } = finish;
    let x = program.to_user(&point.x);
    let constraints = program.user_constraints(&point.c);
    let user = user_multipliers(program, &slopes, &multipliers);
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
    let gradient = unit_of_forces(program, &slopes);
    let steep = steepness(program, &slopes);
    let mut counts = program.counts;
    counts.seconds = program.seconds();
    Outcome {
        status,
        method,
        other: program.other.clone().map(Box::new),
        objective: point.f / program.scaling.objective,
        active_bounds: active(&x, (&lower, &upper), of_bound, (|_| 1.0, gradient), |i| {
            nlp.variable_name(i)
        }),
        active_constraints: active(
            &constraints,
            (&row_lower, &row_upper),
            of_row,
            (|j: usize| steep[j], gradient),
            |j| nlp.constraint_name(j),
        ),
        kkt,
        counts,
        failed_designs: program.failed.clone(),
        scaling: state.scaling.clone(),
        state: Some(state),
        constraints,
        multipliers: user,
        x,
    }
}

pub(crate) fn without_values(program: &Program<'_>, status: Status) -> Outcome {
    let mut counts = program.counts;
    counts.seconds = program.seconds();
    Outcome {
        x: program.to_user(&program.start()),
        counts,
        failed_designs: program.failed.clone(),
        scaling: program.scaling.clone(),
        ..untried(program.nlp(), status)
    }
}

/// The outcome of a run without any evaluation.
pub(crate) fn untried(nlp: &dyn Nlp, status: Status) -> Outcome {
    Outcome {
        status,
        method: Method::default(),
        other: None,
        x: nlp.start(),
        objective: f64::NAN,
        constraints: vec![f64::NAN; nlp.constraints()],
        multipliers: Default::default(),
        kkt: Kkt {
            violation: f64::NAN,
            stationarity: f64::NAN,
            relative_stationarity: f64::NAN,
            complementarity: f64::NAN,
            relative_complementarity: f64::NAN,
            scaled: f64::NAN,
        },
        active_bounds: Vec::new(),
        active_constraints: Vec::new(),
        counts: Counts::default(),
        failed_designs: Vec::new(),
        scaling: Scaling::default(),
        state: None,
    }
}

/// Norms ‖∇c_j‖∞ of all rows, in the units of the user, no less than 1e-300.
pub(crate) fn steepness(program: &Program<'_>, slopes: &Derivatives) -> Vec<f64> {
    let mut all = vec![1e-300; program.scaling.constraints.len()];
    for (k, &j) in program.rows.iter().enumerate() {
        for (column, value) in slopes.a.row(k) {
            let variable = program.scaling.variables[program.free[column]];
            let unit = program.scaling.constraints[j] * variable;
            all[j] = (value / unit).abs().max(all[j]);
        }
    }
    all
}

/// Active entries: their distance to a bound is less than 1e-6 of max(1, |bound|), or as a distance in
/// the variables less than 1e-6 or small relative to their force as a part of `gradient`. One unit of
/// a variable changes entry i by `steepness(i)`.
pub(crate) fn active(
    values: &[f64],
    bounds: (&[f64], &[f64]),
    multipliers: impl Fn(usize) -> (f64, f64),
    (steepness, gradient): (impl Fn(usize) -> f64, f64),
    name: impl Fn(usize) -> String,
) -> Vec<ActiveBound> {
    let mut found = Vec::new();
    for i in 0..values.len() {
        let (l, u) = (bounds.0[i], bounds.1[i]);
        let (zl, zu) = multipliers(i);
        let steep = steepness(i);
        let close = |distance: f64, bound: f64, z: f64| {
            let (far, near) = (distance / steep, bound.abs().max(1.0));
            bound.is_finite()
                && (distance <= 1e-6 * near || far <= (1e-3 * z * steep / gradient).max(1e-6))
                && (z > 0.0 || distance <= 1e-9 * near)
        };
        let (side, multiplier) = if l == u {
            (BoundSide::Equal, zl.max(zu))
        } else if close(values[i] - l, l, zl) {
            (BoundSide::Lower, zl)
        } else if close(u - values[i], u, zu) {
            (BoundSide::Upper, zu)
        } else {
            continue;
        };
        found.push(ActiveBound {
            name: name(i),
            side,
            multiplier,
        });
    }
    found
}
