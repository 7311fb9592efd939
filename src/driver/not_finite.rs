//! Origin of a number that is not finite.

use super::composed;
use super::evaluate::Evaluated;
use crate::functions::series::Series;
use crate::functions::{Function, Instant, Reacting};
use crate::problem::Problem;

/// A function whose value is not finite, and the time from which on its data are not.
pub fn value(problem: &Problem, at: &Evaluated, f: usize, value: f64) -> String {
    if at.composition.gives(f) {
        let of = |g: usize| at.value(g);
        let needed = at.composition.of_scene(&[f]).into_owned();
        return match needed.iter().find(|&&g| !of(g).is_finite()) {
            Some(&g) => self::value(problem, at, g, of(g)),
            None => composed::not_finite(problem, f, value, &of),
        };
    }
    let name = &problem.function_names[f];
    let own = match &at.scene.functions[f] {
        Function::Reduced { of, during, .. } => {
            let (model, run) = (&at.scene.model, &at.run);
            let all = of.sample(model, run);
            let first = all.iter().position(|x| !x.is_finite());
            let not_inside = || {
                let window = during.as_ref()?;
                let outside = window.times(model, run).is_none();
                outside.then(|| format!(": {}", window.missed(model, run)))
            };
            let unlike = |k: usize| {
                let (what, time) = (of.describe(), run.time(k));
                let instants = at.scene.functions[f].instants();
                let why: String = instants.iter().map(|own| shared(at, own)).collect();
                format!(": its {what} is not finite from t = {time:.6e} s on{why}")
            };
            first.map(unlike).or_else(not_inside)
        }
        Function::Misfit { series } => {
            let missed = |own: &Series<f64>| own.missed(&at.scene.model, &at.run);
            series.iter().find_map(missed).map(|time| {
                let end = at.run.duration;
                format!(": a datum is at {time} s of the motion, which lasts from 0 to {end} s")
            })
        }
        Function::Clearance { .. }
        | Function::Duration
        | Function::LowestFrequency { .. }
        | Function::OfDesign { .. } => None,
    };
    format!(
        "the function \"{name}\" is {value}{}{}",
        own.unwrap_or_default(),
        body(at)
    )
}

/// Why a reaction may not be determined.
fn shared(at: &Evaluated, instant: &Instant<f64>) -> String {
    let joints = &at.scene.model.joints;
    match instant.reacting() {
        Some(Reacting::All) => ", as it has no such vibration then".to_owned(),
        Some(Reacting::Joint(joint)) if joints.iter().any(|joint| !joint.redundant.is_empty()) => {
            format!(
                ", as joint \"{}\" shares it with others in a way that the motion does not determine; a \
             joint with fewer constraints, such as a spherical or cylindrical one, would",
                joints[joint].name
            )
        }
        _ => String::new(),
    }
}

/// A derivative that is not finite.
pub(super) fn derivative(
    problem: &Problem,
    at: &Evaluated,
    (f, i): (usize, usize),
    value: f64,
) -> String {
    format!(
        "the derivative of the function \"{}\" in the variable {} is {value}{}",
        problem.function_names[f],
        variable(problem, i),
        body(at)
    )
}

/// A variable by name, and the numbers of the scene that it changes.
pub(super) fn variable(problem: &Problem, i: usize) -> String {
    let variable = &problem.variables[i];
    format!("\"{}\" ({})", variable.name, variable.paths.join(", "))
}

/// The first body whose motion is not finite, and the time from which on. Empty if all motions are
/// finite.
pub(super) fn body(at: &Evaluated) -> String {
    let run = &at.run;
    let lost = (0..=run.last()).find_map(|k| {
        let component = run.v(k).iter().position(|v| !v.is_finite())?;
        Some((k, run.numbering.body_of_velocity(component)))
    });
    lost.map_or_else(String::new, |(k, body)| {
        let (name, time) = (&at.scene.model.bodies[body].name, run.time(k));
        let step = (1..=run.grid.steps()).find(|&n| run.grid.ends()[n] >= run.instants[k]);
        let step = step.map_or_else(String::new, |n| format!(" (step {n})"));
        format!("; body \"{name}\" is not finite from t = {time:.6e} s on{step}")
    })
}
