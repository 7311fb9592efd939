//! Faults of a program or of the options that are found before any evaluation.

use crate::nlp::Nlp;
use crate::options::{Method, Options};
use crate::status::Status;

/// Largest number of variables for the trust region. Above it the subproblems take much longer than
/// the iterations of the interior point.
pub(crate) const LARGEST_TRUST_REGION: usize = 2000;

/// Status of a run on `nlp` that cannot begin. `None` if the program and the options make sense.
pub(crate) fn fault(nlp: &dyn Nlp, options: &Options) -> Option<Status> {
    let ill_posed = |what| Some(Status::IllPosed { what });
    if let Some(what) = fault_of_options(options).or_else(|| fault_of_lengths(nlp)) {
        return ill_posed(what);
    }
    let n = nlp.variables();
    let of_trust_region = matches!(options.method, Method::TrustRegion | Method::LeastSquares);
    if of_trust_region && n > LARGEST_TRUST_REGION {
        return ill_posed(format!(
            "the trust region is meant for at most {LARGEST_TRUST_REGION} variables and the \
             program has {n}; use the interior point"
        ));
    }
    let start = nlp.start();
    if let Some(i) = start.iter().position(|v| !v.is_finite()) {
        let name = nlp.variable_name(i);
        return ill_posed(format!("{name} starts at {}", start[i]));
    }
    let variables = (0..nlp.variables()).map(|i| nlp.variable_name(i));
    let rows = (0..nlp.constraints()).map(|j| nlp.constraint_name(j));
    let all: Vec<(String, f64, f64)> = [
        named(variables, nlp.variable_bounds()),
        named(rows, nlp.constraint_bounds()),
    ]
    .concat();
    let mut crossed: Option<Status> = None;
    for (name, lower, upper) in all {
        if lower.is_nan() || upper.is_nan() {
            return ill_posed(format!("{name} has a bound that is not a number"));
        }
        if lower == f64::INFINITY || upper == f64::NEG_INFINITY {
            return ill_posed(format!("{name} has the bounds {lower} and {upper}"));
        }
        if lower > upper {
            crossed.get_or_insert(Status::Infeasible {
                constraint: name,
                violation: 0.5 * lower - 0.5 * upper,
            });
        }
    }
    crossed
}

fn named(
    names: impl Iterator<Item = String>,
    (lower, upper): (Vec<f64>, Vec<f64>),
) -> Vec<(String, f64, f64)> {
    let bounds = lower.into_iter().zip(upper);
    names
        .zip(bounds)
        .map(|(name, (l, u))| (name, l, u))
        .collect()
}

fn fault_of_lengths(nlp: &dyn Nlp) -> Option<String> {
    let (n, m) = (nlp.variables(), nlp.constraints());
    let (lower, upper) = nlp.variable_bounds();
    let (row_lower, row_upper) = nlp.constraint_bounds();
    let lists = [
        ("the start", nlp.start().len(), n),
        ("the list of lower bounds of variables", lower.len(), n),
        ("the list of upper bounds of variables", upper.len(), n),
        (
            "the list of lower bounds of constraints",
            row_lower.len(),
            m,
        ),
        (
            "the list of upper bounds of constraints",
            row_upper.len(),
            m,
        ),
    ];
    lists
        .iter()
        .find(|(_, found, expected)| found != expected)
        .map(|(what, found, expected)| {
            format!("{what} has {found} entries where {expected} are expected")
        })
}

fn fault_of_options(options: &Options) -> Option<String> {
    let positive = [
        ("tolerance", options.tolerance),
        ("constraint_tolerance", options.constraint_tolerance),
        ("scaling_gradient", options.scaling_gradient),
        ("initial_barrier", options.first_barrier()),
        ("bound_push", options.bound_push),
        ("initial_radius", options.initial_radius),
    ];
    let bad = |v: f64| !(v.is_finite() && v > 0.0);
    if let Some((name, value)) = positive.iter().find(|(_, v)| bad(*v)) {
        return Some(format!(
            "the option {name} is {value} and must be positive and finite"
        ));
    }
    if options.unbounded_below.is_nan() {
        return Some("the option unbounded_below is not a number".into());
    }
    let seconds = options.max_seconds.filter(|s| s.is_nan() || *s < 0.0)?;
    Some(format!(
        "the option max_seconds is {seconds} and must not be negative"
    ))
}
