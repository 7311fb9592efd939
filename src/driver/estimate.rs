//! Estimated errors of functions, and those of functions that expressions give.

use crate::problem::{Composition, Partials, Problem};

/// A number with its estimated error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The number on the steps in use.
    pub value: f64,
    /// Its estimated error, absolute.
    pub error: f64,
    /// The error of the steps, with its sign.
    pub of_steps: f64,
    /// The error of the samples, with its sign.
    pub of_samples: f64,
}

/// A function's value and, if requested, its gradient in the design variables.
#[derive(Clone, Debug, PartialEq)]
pub struct FunctionError {
    /// The function, by index.
    pub function: usize,
    /// Its value.
    pub value: Estimate,
    /// The largest value over the motion, if it is an aggregate.
    pub maximum: Option<Estimate>,
    /// Its derivatives in the variables; empty if they were not requested.
    pub gradient: Vec<Estimate>,
}

/// Errors of the functions `which` from those of functions of the scene, which `of_scene` estimates.
///
/// The error of f = e(g) is Σ |∂e/∂g_i| δg_i. That of its gradient is Σ |∂e/∂g_i| δ∇g_i and, for each g_i, the change of
/// Σ ∂e/∂g_k ∇g_k with g_i + δg_i.
///
/// # Errors
/// Those of `of_scene`.
pub fn with_expressions<E>(
    (problem, x): (&Problem, &[f64]),
    which: &[usize],
    of_scene: impl FnOnce(&[usize]) -> Result<Vec<FunctionError>, E>,
) -> Result<Vec<FunctionError>, E> {
    let composition = &problem.composition;
    let functions = composition.of_scene(which);
    let found = of_scene(&functions)?;
    if !which.iter().any(|&f| composition.gives(f)) {
        return Ok(found);
    }
    let of = |g: usize| found.iter().find(|own| own.function == g);
    let one = |&f: &usize| match composition.gives(f) {
        false => of(f).cloned(),
        true => Some(of_expression(composition, f, x, &of)),
    };
    Ok(which.iter().filter_map(one).collect())
}

fn of_expression<'a>(
    composition: &Composition,
    f: usize,
    x: &[f64],
    of: &impl Fn(usize) -> Option<&'a FunctionError>,
) -> FunctionError {
    let value = |g: usize| of(g).map_or(f64::NAN, |own| own.value.value);
    let partials = composition.partials(f, x, &value);
    let moving = || partials.by_function.iter().filter(|(_, by)| *by != 0.0);
    let sum = |part: &dyn Fn(&Estimate) -> f64| -> f64 {
        let terms = moving().filter_map(|&(g, by)| Some(by * part(&of(g)?.value)));
        terms.sum()
    };
    let sizes = moving().filter_map(|&(g, by)| Some((by * of(g)?.value.error).abs()));
    let value_of = Estimate {
        value: composition.value(f, x, &value),
        error: sizes.sum(),
        of_steps: sum(&|own| own.of_steps),
        of_samples: sum(&|own| own.of_samples),
    };
    let with_gradient = moving().all(|&(g, _)| of(g).is_some_and(|own| !own.gradient.is_empty()));
    let count = if with_gradient { x.len() } else { 0 };
    let slope = |partials: &Partials, i: usize, part: &dyn Fn(&Estimate) -> f64| -> f64 {
        let terms = partials.by_function.iter().filter(|(_, by)| *by != 0.0);
        let terms = terms.filter_map(|&(g, by)| Some(by * part(&of(g)?.gradient[i])));
        terms.sum()
    };
    let whole = |partials: &Partials, i: usize| {
        partials.by_variable[i] + slope(partials, i, &|own| own.value)
    };
    let moved: Vec<Partials> = moving()
        .map(|&(g, _)| {
            let by = |h: usize| match of(h) {
                Some(own) if h == g => own.value.value + own.value.error,
                _ => value(h),
            };
            composition.partials(f, x, &by)
        })
        .collect();
    let derivative = |i: usize| {
        let own = whole(&partials, i);
        let curved = moved.iter().map(|moved| (whole(moved, i) - own).abs());
        let direct = moving().filter_map(|&(g, by)| Some((by * of(g)?.gradient[i].error).abs()));
        Estimate {
            value: own,
            error: direct.chain(curved).sum(),
            of_steps: slope(&partials, i, &|own| own.of_steps),
            of_samples: slope(&partials, i, &|own| own.of_samples),
        }
    };
    FunctionError {
        function: f,
        value: value_of,
        maximum: None,
        gradient: (0..count).map(derivative).collect(),
    }
}
