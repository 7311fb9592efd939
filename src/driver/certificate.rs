//! Certificate of the gradients of an optimisation: at its start and at its end, one directional
//! derivative of every function by the adjoint and by the complex step.
//!
//! The direction d is random, so an error in any derivative shows. Its size in each variable is the
//! variable's typical change. With the gradient g of a function, the two derivatives differ by |Σ
//! gᵢdᵢ − Im f(x + ihd)/h|. The difference is compared with Σ |gᵢdᵢ|, or with the round-off of the
//! terms of the gradient. At an optimum the gradient may vanish, as that of a sum of squares does. So Σ |gᵢdᵢ|
//! at the start counts as well, and of a sum over the motion the sum of the sizes of its terms.

use super::analysed::{AnalysisFailure, InCases, Simulated, phases};
use super::check::complex_step;
use super::composed::infinitesimal;
use super::evaluate::{Derivative, Evaluated};
use super::event;
use super::frozen::{Stored, complex_design, complex_motion, settings};
use super::not_finite::{body, variable};
use super::optimise::Optimisation;
use super::size::function_size;
use super::statics::{self, StaticDesign, StaticsFailure};
use crate::functions::Function;
use crate::integrate::{IntegrationFailure, Settings, StepSolver};
use crate::math::Complex64;
use crate::math::scalar::COMPLEX_STEP;
use crate::problem::{Division, Problem};
use crate::report::optimum::{
    CertificateCost, CertifiedDerivative, CertifiedDesign, GradientCertificate,
};

/// Largest accepted difference relative to Σ |gᵢdᵢ|: that of `optimize check`.
pub const TOLERANCE: f64 = 1e-10;
/// Seed of the direction.
pub const SEED: u64 = 20_221_113;
/// Round-off of a derivative, relative to the terms that it is the sum of.
const ROUND_OFF: f64 = 64.0 * f64::EPSILON;
/// Largest number of variables that are tested one by one for the error, by a complex run each.
const LOOKED_AT: usize = 64;

/// Certifies the gradients at both ends of an optimisation, on the steps of their simulations.
/// Differences up to `tolerance` pass.
pub fn certify(problem: &Problem, done: &Optimisation, tolerance: f64) -> GradientCertificate {
    let direction = direction(problem, SEED);
    let mut cost = CertificateCost::default();
    let mut sizes = vec![0.0; problem.function_names.len()];
    let mut at = |simulated: &Option<Simulated>| match simulated {
        Some(simulated) => {
            let along = (&direction[..], tolerance, &mut sizes[..]);
            of_design(problem, simulated, along, &mut cost).unwrap_or_else(|failure| {
                CertifiedDesign {
                    faults: vec![format!("a run of the check failed: {failure}")],
                    ..CertifiedDesign::default()
                }
            })
        }
        None => CertifiedDesign {
            faults: vec!["the simulation fails".into()],
            ..CertifiedDesign::default()
        },
    };
    let (start, optimum) = (at(&done.start), at(&done.end));
    let names = problem.variables.iter().map(|v| v.name.clone());
    GradientCertificate {
        seed: SEED,
        direction: names.zip(direction).collect(),
        tolerance,
        passed: start.faults.is_empty() && optimum.faults.is_empty(),
        start,
        optimum,
        cost,
    }
}

/// A direction with a random sign and a random size, between half a typical change and a whole one,
/// in every variable. By the generator SplitMix64 (Steele, Lea & Flood 2014).
fn direction(problem: &Problem, seed: u64) -> Vec<f64> {
    let mut state = seed;
    let mut next = || {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    };
    let along = |variable: &crate::problem::Variable| {
        let bits = next();
        let size = 0.5 + 0.5 * (bits >> 11) as f64 / (1u64 << 53) as f64;
        let sign = if bits & 1 == 0 { 1.0 } else { -1.0 };
        sign * size * variable.scale
    };
    problem.variables.iter().map(along).collect()
}

/// The direction, the tolerance, and the largest Σ |gᵢdᵢ| of each function so far.
type Along<'a> = (&'a [f64], f64, &'a mut [f64]);

/// The derivatives of all functions at a design.
fn of_design(
    problem: &Problem,
    simulated: &Simulated,
    along: Along<'_>,
    cost: &mut CertificateCost,
) -> Result<CertifiedDesign, AnalysisFailure> {
    Ok(match simulated {
        Simulated::Motion(simulation) => certified(problem, &simulation.at, along, cost)?,
        Simulated::Statics(at) => certified_statics(problem, at, along, cost)?,
        Simulated::Cases(at) if at.cases.division == Division::Events => {
            let (direction, tolerance, sizes) = along;
            let all = phases::directional(problem, at, direction)?;
            cost.gradients += 1;
            cost.complex_runs += at.cases.list.len() as u64;
            told(problem, all, (tolerance, sizes))
        }
        Simulated::Cases(at) => certified_cases(problem, at, along, cost)?,
    })
}

/// The derivatives of the functions of each case, and from these those of functions over cases.
fn certified_cases(
    problem: &Problem,
    at: &InCases<Simulated>,
    (direction, tolerance, sizes): Along<'_>,
    cost: &mut CertificateCost,
) -> Result<CertifiedDesign, AnalysisFailure> {
    let mut found = CertifiedDesign::default();
    let mut first = 0;
    for (case, simulated) in at.each() {
        let count = case.problem.function_names.len();
        let along = (direction, tolerance, &mut sizes[first..first + count]);
        let own = of_design(&case.problem, simulated, along, cost)?;
        let told = |text: String| case.tell(text);
        found.faults.extend(own.faults.into_iter().map(told));
        found.notes.extend(own.notes.into_iter().map(told));
        let names = problem.function_names[first..].iter().cloned();
        found
            .functions
            .extend(names.zip(own.functions.into_values()));
        first += count;
    }
    let composition = &problem.composition;
    let known = |number: Option<f64>| number.unwrap_or(f64::NAN);
    let pairs: Vec<[f64; 2]> = { found.functions.values() }
        .map(|own| [own.adjoint, own.complex_step].map(known))
        .collect();
    let complex = |k: usize| Complex64::new(at.value(k), COMPLEX_STEP * pairs[k][1]);
    let values: Vec<Complex64> = (0..pairs.len()).map(complex).collect();
    let x = complex_design(&at.x, direction);
    let derivatives = infinitesimal(composition, &x, &values, COMPLEX_STEP);
    for f in composition.first..problem.function_names.len() {
        let partials = composition.partials(f, &at.x, &|k| at.value(k));
        let moving = || partials.by_function.iter().filter(|(_, by)| *by != 0.0);
        let direct = partials.by_variable.iter().zip(direction);
        let direct = direct.map(|(by, along)| by * along);
        let own: f64 = moving().map(|&(k, by)| by * pairs[k][0]).sum();
        let size = direct.clone().map(f64::abs).sum::<f64>()
            + moving().map(|&(k, by)| by.abs() * sizes[k]).sum::<f64>();
        sizes[f] = sizes[f].max(size);
        let judged = Pair {
            adjoint: own + direct.sum::<f64>(),
            complex_step: derivatives[f],
            size: sizes[f],
            terms: at.value(f).abs(),
        };
        let name = &problem.function_names[f];
        if !judged.passes(tolerance) {
            found.faults.push(format!(
                "the derivative of \"{name}\" is {:.15e} by the adjoint and {:.15e} by the complex step",
                judged.adjoint, judged.complex_step
            ));
        }
        found.functions.insert(name.clone(), judged.recorded());
    }
    Ok(found)
}

/// The derivatives of all functions at a simulated design.
fn certified(
    problem: &Problem,
    at: &Evaluated,
    (direction, tolerance, sizes): Along<'_>,
    cost: &mut CertificateCost,
) -> Result<CertifiedDesign, IntegrationFailure> {
    let which: Vec<usize> = (0..problem.function_names.len()).collect();
    let Some(settings) = settings(problem, at) else {
        return Ok(CertifiedDesign::default());
    };
    let (gradients, _) = at.derivatives(problem, &which)?;
    cost.gradients += 1;
    let rate = match &at.scene.until {
        Some(_) => {
            // The rate of the event, and its shift.
            cost.complex_runs += 2;
            event::rate(&at.scene, &settings, at.run.duration)?
        }
        None => f64::NAN,
    };
    let event = (at.run.duration, rate);
    let complex = complex_step(problem, (&settings, Stored::Steps), event, &at.x, direction)?;
    cost.complex_runs += 1;
    for (f, size) in sizes.iter_mut().enumerate() {
        let own = sum(&gradients[f], direction, |d, by| (d.value * by).abs());
        *size = size.max(own);
    }
    let pair = |f: usize, gradients: &[Vec<Derivative>]| Pair {
        adjoint: sum(&gradients[f], direction, |d, by| d.value * by),
        complex_step: complex.derivatives[f],
        size: sizes[f],
        terms: sum(&gradients[f], direction, |d, by| d.terms * by.abs()).max(function_size(at, f)),
    };
    let mut found = CertifiedDesign::default();
    let (mut same, mut sums) = (None, None);
    for f in which.iter().copied() {
        let name = &problem.function_names[f];
        let mut judged = pair(f, &gradients);
        if !judged.passes(tolerance) && judged.is_finite() {
            // The motion of the complex run differs by round-off, which a sensitive motion magnifies, and by where
            // Newton's method has ended: that of the complex run goes on to round-off.
            if same.is_none() {
                let of_complex = at.with_run(at.scene.clone(), complex.run.clone());
                same = Some(of_complex.derivatives(problem, &which)?.0);
                cost.gradients += 1;
            }
            let on_same = same.as_ref().map_or(judged, |same| pair(f, same));
            if !on_same.passes(tolerance) && sums.is_none() {
                cost.complex_runs += 1;
                let found = sums_of_terms(problem, (&settings, event), at, direction)?;
                sums = Some(found);
            }
            let sum = sums.as_ref().map_or(0.0, |sums| sums[f]);
            let on_same = Pair {
                size: on_same.size.max(sum),
                ..on_same
            };
            if on_same.passes(tolerance) {
                let noise = judged.relative();
                let what = match at.run.solver.newton > StepSolver::default().newton {
                    true => "where Newton's method ends",
                    false => "round-off of the motion",
                };
                found.notes.push(format!(
                    "{what} moves the derivative of \"{name}\" by {noise:.1e} of its gradient"
                ));
                judged = on_same;
            }
        }
        if !judged.passes(tolerance) {
            let gradient = &gradients[f];
            let which = match judged.is_finite() {
                true => {
                    let along = |direction: &[f64]| {
                        cost.complex_runs += 1;
                        let with = (&settings, Stored::Motion);
                        let run = complex_step(problem, with, event, &at.x, direction)?;
                        Ok(run.derivatives[f])
                    };
                    named(problem, differing(gradient, direction, along)?)
                }
                false => not_finite(problem, gradient) + &body(at),
            };
            found.faults.push(format!(
                "the derivative of \"{name}\" is {:.15e} by the adjoint and {:.15e} by the complex \
                 step{which}",
                judged.adjoint, judged.complex_step
            ));
        }
        found.functions.insert(name.clone(), judged.recorded());
    }
    Ok(found)
}

/// The derivatives of all functions of structures at a design.
fn certified_statics(
    problem: &Problem,
    at: &StaticDesign,
    (direction, tolerance, sizes): Along<'_>,
    cost: &mut CertificateCost,
) -> Result<CertifiedDesign, StaticsFailure> {
    let all = statics::check::directional(problem, at, direction)?;
    cost.gradients += 1;
    cost.complex_runs += 1;
    Ok(told(problem, all, (tolerance, sizes)))
}

/// All functions with their derivatives along a direction, computed twice, Σ |gᵢdᵢ| and the size of their terms.
fn told(
    problem: &Problem,
    all: Vec<[f64; 4]>,
    (tolerance, sizes): (f64, &mut [f64]),
) -> CertifiedDesign {
    let mut found = CertifiedDesign::default();
    let functions = problem.function_names.iter().zip(all).zip(sizes);
    for ((name, [adjoint, complex_step, own, terms]), size) in functions {
        *size = size.max(own);
        let judged = Pair {
            adjoint,
            complex_step,
            size: *size,
            terms,
        };
        if !judged.passes(tolerance) {
            found.faults.push(format!(
                "the derivative of \"{name}\" is {adjoint:.15e} by the adjoint and {complex_step:.15e} by \
                 the complex step; optimize check names the variable"
            ));
        }
        found.functions.insert(name.clone(), judged.recorded());
    }
    found
}

/// For every function: the sum of the sizes of the terms over the motion of which its derivative along a
/// direction is the sum.
fn sums_of_terms(
    problem: &Problem,
    (settings, event): (&Settings, (f64, f64)),
    at: &Evaluated,
    direction: &[f64],
) -> Result<Vec<f64>, IntegrationFailure> {
    let moved = complex_design(&at.x, direction);
    let (scene, run) = complex_motion(problem, (settings, Stored::Motion), event, &moved)?;
    let terms = |f: &Function<Complex64>| f.terms_over_motion(&scene.model, &run) / COMPLEX_STEP;
    let mut all: Vec<f64> = scene.functions.iter().map(terms).collect();
    for f in all.len()..problem.function_names.len() {
        let partials = at.partials(f).by_function.into_iter();
        all.push(partials.map(|(g, by)| (by * all[g]).abs()).sum());
    }
    Ok(all)
}

fn sum(gradient: &[Derivative], direction: &[f64], of: fn(&Derivative, f64) -> f64) -> f64 {
    let terms = gradient.iter().zip(direction);
    terms.map(|(derivative, &by)| of(derivative, by)).sum()
}

/// A directional derivative, computed twice.
#[derive(Clone, Copy, Debug)]
struct Pair {
    adjoint: f64,
    complex_step: f64,
    /// Σ |gᵢdᵢ|: the largest so far.
    size: f64,
    /// Size of the terms of the derivative, or of the function itself.
    terms: f64,
}

impl Pair {
    fn difference(&self) -> f64 {
        (self.adjoint - self.complex_step).abs()
    }

    /// The difference relative to the gradient, if that is not zero.
    fn relative(&self) -> f64 {
        match self.difference() {
            0.0 => 0.0,
            difference => difference / self.size,
        }
    }

    fn is_finite(&self) -> bool {
        self.adjoint.is_finite() && self.complex_step.is_finite()
    }

    /// As the record has it.
    fn recorded(&self) -> CertifiedDerivative {
        let finite = |x: f64| Some(x).filter(|x| x.is_finite());
        CertifiedDerivative {
            adjoint: finite(self.adjoint),
            complex_step: finite(self.complex_step),
            difference: finite(self.relative()),
        }
    }

    /// False if a number is NaN.
    fn passes(&self, tolerance: f64) -> bool {
        self.difference() <= ROUND_OFF * self.terms || self.relative() <= tolerance
    }
}

/// The variable in which a gradient differs most from the derivatives `along` parts of the direction: one complex run each.
/// None if there are too many.
fn differing(
    gradient: &[Derivative],
    direction: &[f64],
    mut along: impl FnMut(&[f64]) -> Result<f64, IntegrationFailure>,
) -> Result<Option<usize>, IntegrationFailure> {
    if gradient.len() > LOOKED_AT {
        return Ok(None);
    }
    let mut most: Option<(f64, usize)> = None;
    for (i, derivative) in gradient.iter().enumerate() {
        let only = |j: usize| if i == j { direction[i] } else { 0.0 };
        let part: Vec<f64> = (0..gradient.len()).map(only).collect();
        let by = (along(&part)? - derivative.value * direction[i]).abs();
        if most.is_none_or(|(largest, _)| by > largest) {
            most = Some((by, i));
        }
    }
    Ok(most.map(|(_, i)| i))
}

/// Names the variable in which derivatives differ most.
fn named(problem: &Problem, differs: Option<usize>) -> String {
    match differs {
        Some(i) => format!("; they differ most in {}", variable(problem, i)),
        None => "; optimize check names the variable".into(),
    }
}

/// Names the first variable in which a derivative is not finite.
fn not_finite(problem: &Problem, gradient: &[Derivative]) -> String {
    let first = gradient.iter().position(|d| !d.value.is_finite());
    first.map_or_else(String::new, |i| {
        format!("; not finite in {}", variable(problem, i))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_difference_is_judged_beside_the_gradient_and_its_round_off() {
        let pair = |adjoint: f64, complex_step: f64| Pair {
            adjoint,
            complex_step,
            size: 1.0,
            terms: 10.0,
        };
        assert!(pair(0.5, 0.5 + 1e-14).passes(0.0), "round-off");
        assert!(!pair(0.5, 0.5 + 1e-12).passes(1e-13));
        assert!(pair(0.5, 0.5 + 1e-12).passes(1e-11));
        // Small relative to the gradient, and completely wrong.
        assert!(!pair(1e-9, -1e-9).passes(1e-10));
        for wrong in [f64::NAN, f64::INFINITY] {
            assert!(!pair(wrong, 0.5).passes(1e-3) && !pair(0.5, wrong).passes(1e-3));
        }
    }

    /// A gradient that is wrong in one variable, by little beside the others.
    #[test]
    fn the_variable_that_differs_is_found() {
        let exact = [3.0, -2e-3, 1e3];
        let direction = [0.5, 2.0, -0.1];
        let along = |part: &[f64]| Ok(part.iter().zip(&exact).map(|(d, g)| d * g).sum());
        for wrong in 0..3 {
            let mut gradient = exact.map(|value| Derivative {
                value,
                terms: value.abs(),
            });
            gradient[wrong].value *= 1.0 + 1e-6;
            assert_eq!(differing(&gradient, &direction, along), Ok(Some(wrong)));
        }
        let many = vec![Derivative::default(); LOOKED_AT + 1];
        let never = |_: &[f64]| panic!("too many runs");
        assert_eq!(differing(&many, &[0.0; LOOKED_AT + 1], never), Ok(None));
    }

    /// Variables are named with their place in the file.
    #[test]
    fn variables_are_named_with_their_place() {
        let text = r#"{"version": 1, "name": "fall", "gravity": [0, -9.81, 0],
            "bodies": {"ball": {"shape": {"sphere": {"radius": 0.1}}, "mass": 2}},
            "simulation": {"duration": 0.4},
            "functions": {"y": {"final": {"position": {"body": "ball", "direction": [0, 1, 0]}}}},
            "variables": {"mass": {"path": "/bodies/ball/mass", "lower": 1, "upper": 3},
                          "pull": {"path": "/gravity/1", "lower": -9.9, "upper": -9.7}}}"#;
        let problem = Problem::parse(text, "fall.json", &[]);
        let problem = problem.unwrap_or_else(|faults| panic!("{faults}"));
        let most = "; they differ most in \"pull\" (/gravity/1)";
        assert_eq!(named(&problem, Some(1)), most);
        let mut gradient = vec![Derivative::default(); 2];
        assert_eq!(not_finite(&problem, &gradient), "");
        gradient[0].value = f64::NAN;
        let first = "; not finite in \"mass\" (/bodies/ball/mass)";
        assert_eq!(not_finite(&problem, &gradient), first);
    }
}
