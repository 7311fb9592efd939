//! References of a work-precision measurement.

use super::Campaign;
use super::bench::Bench;
use super::exact::{Reference, distance, gradient_error, positions};
use crate::integrate::choice::{NON_STIFF, STIFF};
use crate::integrate::{
    IntegrationFailure, Method, Samples, Settings, Spacing, StepSolver, simulate,
};

/// Tolerance of the explicit reference.
const EXPLICIT: f64 = 1e-13;
/// Tolerances of the implicit reference. The first that succeeds is used.
const IMPLICIT: [f64; 3] = [1e-11, 1e-10, 1e-9];
/// Ratio of the tolerances of the run that checks a stiff reference and of the reference.
const LOOSER: f64 = 10.0;
/// Number of samples of the reference for functions that are sums over the motion.
const SAMPLES: usize = 20_000;

/// One run that could be the reference.
struct Candidate {
    name: String,
    tolerance: f64,
    positions: Vec<[f64; 3]>,
    gradient: Option<Vec<f64>>,
}

/// The reference: positions of a file if the plan has them, and a run with a tight tolerance by the
/// method that suits the scene. Both are compared with a run by another method or, if the scene is
/// stiff, by the same method with a larger tolerance.
///
/// # Errors
/// No run reaches the end.
pub fn reference(
    bench: &Bench,
    plan: &Campaign,
    stiff: bool,
) -> Result<Reference, IntegrationFailure> {
    let implicit = |tolerances: &[f64]| {
        let mut found = candidate(bench, STIFF, tolerances[0]);
        for &tolerance in &tolerances[1..] {
            found = found.or_else(|_| candidate(bench, STIFF, tolerance));
        }
        found
    };
    let (best, check) = match stiff {
        false => {
            let best = candidate(bench, NON_STIFF, EXPLICIT)?;
            (best, implicit(&IMPLICIT).ok())
        }
        true => {
            let best = implicit(&IMPLICIT)?;
            let check = candidate(bench, STIFF, LOOSER * best.tolerance).ok();
            (best, check)
        }
    };
    let own: Vec<_> = best.positions.iter().copied().enumerate().collect();
    let mut description = best.name.clone();
    let (positions, mut difference) = match &plan.reference {
        Some((file, positions)) => {
            let difference = distance(positions, &best.positions);
            description = format!("{file}; {} is {difference:.1e} m away", best.name);
            (positions.clone(), difference)
        }
        None => (own, f64::NAN),
    };
    let mut gradient_difference = f64::NAN;
    match &check {
        Some(check) => {
            let away = distance(&positions, &check.positions);
            // The error with a larger tolerance bounds that with a tight one.
            difference = if difference.is_nan() {
                away
            } else {
                difference
            };
            description += &format!("; {} is {away:.1e} m away", check.name);
            if let (Some(a), Some(b)) = (&best.gradient, &check.gradient) {
                gradient_difference = gradient_error(b, a);
                description += &format!(", its gradient {gradient_difference:.1e} off relatively");
            }
        }
        None => description += "; no other method reached the end to check it",
    }
    Ok(Reference {
        positions,
        gradient: best.gradient,
        difference,
        gradient_difference,
        description,
    })
}

fn candidate(
    bench: &Bench,
    method: Method,
    tolerance: f64,
) -> Result<Candidate, IntegrationFailure> {
    let settings = Settings {
        method,
        solver: StepSolver::default(),
        spacing: Spacing::Tolerance(tolerance),
        samples: match bench.sums() {
            true => Samples::Uniform(SAMPLES),
            false => Samples::Uniform(1),
        },
        limits: bench.limits(),
        memory: 0,
        derivatives: bench.has_gradient(),
    };
    let (model, duration) = (&bench.scene.model, bench.scene.duration);
    let chosen = simulate(model, duration, &settings)?;
    // The error with halved steps is smaller by two to the power of the order.
    let halves = Settings {
        spacing: Spacing::Frozen(chosen.grid.halved()),
        ..settings
    };
    drop(chosen);
    let run = simulate(model, duration, &halves)?;
    Ok(Candidate {
        name: format!(
            "{} with halves of the steps of tolerance {tolerance:.0e} ({} steps)",
            method.name(),
            run.grid.steps()
        ),
        tolerance,
        positions: positions(&run),
        gradient: bench.gradient(run)?,
    })
}
