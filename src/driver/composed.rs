//! Functions that expressions give: derivatives and true values from those of the functions that they name.

use crate::math::Complex64;
use crate::math::soft_max::Smoothed;
use crate::problem::{Composition, Partials, Problem};

/// A derivative in a variable: the sum over the parameters of the scene that it moves.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Derivative {
    /// The sum.
    pub value: f64,
    /// The sum of the sizes of the terms; its last digits are round-off.
    pub terms: f64,
}

/// ∇f = Σ ∂e/∂g_i ∇g_i + ∂e/∂x, with the sizes of its terms; `row` gives ∇g_i.
pub fn derivatives<'a>(
    partials: &Partials,
    row: &impl Fn(usize) -> &'a [Derivative],
) -> Vec<Derivative> {
    let direct = partials.by_variable.iter().map(|&value| Derivative {
        value,
        terms: value.abs(),
    });
    let mut sum: Vec<Derivative> = direct.collect();
    for &(g, by) in partials.by_function.iter().filter(|(_, by)| *by != 0.0) {
        for (sum, own) in sum.iter_mut().zip(row(g)) {
            sum.value += by * own.value;
            sum.terms += (by * own.terms).abs();
        }
    }
    sum
}

/// What an expression stands for, if a function that it names is smoothed: its value at their true values. `one` gives
/// what a function of the scene stands for, and its value.
pub fn smoothed(
    composition: &Composition,
    f: usize,
    x: &[f64],
    one: &impl Fn(usize) -> (Option<Smoothed>, f64),
) -> Option<Smoothed> {
    let functions = composition.of_scene(&[f]).into_owned();
    let all: Vec<(Option<Smoothed>, f64)> = functions.iter().map(|&g| one(g)).collect();
    if all.iter().all(|(own, _)| own.is_none()) {
        return None;
    }
    let truth = |g: usize| {
        let place = functions.binary_search(&g);
        place.map_or(f64::NAN, |k| {
            let (own, value) = &all[k];
            own.as_ref().map_or(*value, |own| own.value)
        })
    };
    let value = composition.value(f, x, &truth);
    value.is_finite().then_some(Smoothed { value, far: None })
}

/// Derivatives of all functions along the imaginary part of `x`, divided by `step`, from the values of those of the scene.
pub fn infinitesimal(
    composition: &Composition,
    x: &[Complex64],
    values: &[Complex64],
    step: f64,
) -> Vec<f64> {
    let count = values.len() + composition.list.len();
    let of = |g: usize| values[g];
    let value = |f: usize| match f < values.len() {
        true => values[f],
        false => composition.value(f, x, &of),
    };
    (0..count).map(|f| value(f).im / step).collect()
}

/// An expression whose value is not finite, in words: the values of the functions of the scene that it needs.
pub fn not_finite(problem: &Problem, f: usize, value: f64, of: &dyn Fn(usize) -> f64) -> String {
    const TOLD: usize = 6;
    let functions = problem.composition.of_scene(&[f]).into_owned();
    let named = functions.iter().take(TOLD);
    let named: Vec<String> = named
        .map(|&g| format!("\"{}\" is {:.6e}", problem.function_names[g], of(g)))
        .collect();
    let name = &problem.function_names[f];
    match named.is_empty() {
        true => format!("the expression of the function \"{name}\" is {value}"),
        false => format!(
            "the expression of the function \"{name}\" is {value} where {}",
            named.join(", ")
        ),
    }
}
