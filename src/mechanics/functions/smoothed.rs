//! Smooth functions beside what they stand for: maxima over time, largest stresses of points, the best release.

use super::evaluate::{Evaluated, release_weights};
use super::flight::Flight;
use super::function::{Function, Reduction, Release};
use super::instant::Instant;
use super::peak::{self, Maximum};
use super::quantity::Quantity;
use super::samples::{sample_with, turn};
use super::snapshot::Snapshot;
use crate::integrate::Trajectory;
use crate::math::soft_max::{self, Smoothed, ZERO, smoothed};
use crate::model::Model;

/// What a function of a run stands for; `None` if nothing in it is smoothed. `found` is its value.
pub fn of_motion(
    function: &Function<f64>,
    model: &Model<f64>,
    run: &Trajectory<f64>,
    found: &Evaluated<f64>,
) -> Option<Smoothed> {
    let rho = rhos(function);
    if rho.is_empty() {
        return None;
    }
    let stands_for = stands_for(function, model, run, found)?;
    let with = |factor: f64| sharpened(function, factor).evaluate(model, run).value;
    Some(smoothed(found.value, stands_for, rho, with))
}

/// One ρ for all aggregates in a function that keeps it within 1 % of what it stands for; that value too. `None` if there is none.
/// The present ρ, equal ones, do not matter.
pub fn near(
    function: &Function<f64>,
    model: &Model<f64>,
    run: &Trajectory<f64>,
) -> Option<(f64, f64)> {
    let own = *rhos(function).first()?;
    let found = function.evaluate(model, run);
    let (value, scale) = stands_for(function, model, run, &found)?;
    let with = |rho: f64| sharpened(function, rho / own).evaluate(model, run).value;
    Some((soft_max::near((value, scale), with)?, value))
}

/// What a function with aggregates stands for, and the size that differences are relative to.
fn stands_for(
    function: &Function<f64>,
    model: &Model<f64>,
    run: &Trajectory<f64>,
    found: &Evaluated<f64>,
) -> Option<(f64, f64)> {
    let own = match (found.maximum, function) {
        (Some(Maximum { value, .. }), Function::Reduced { of, .. })
            if value.abs() < ZERO * found.value.abs() =>
        {
            (value, size(of, model, run))
        }
        (Some(maximum), _) => (maximum.value, maximum.value.abs()),
        (None, Function::Clearance { top, .. }) => {
            let value = best_clearance(function, model, run)?;
            (value, value.abs().max(top.abs()))
        }
        (
            None,
            Function::Reduced {
                of: Quantity::Of(instant),
                during: None,
                reduction,
            },
        ) => {
            let value = of_largest(instant, *reduction, model, run);
            (value, value.abs())
        }
        (None, Function::Reduced { .. }) => return None,
        (None, Function::LowestFrequency { frequencies, .. }) => {
            let lowest = *frequencies.first()?;
            (lowest, lowest)
        }
        (None, Function::Misfit { .. } | Function::Duration | Function::OfDesign { .. }) => {
            return None;
        }
    };
    Some(own)
}

/// The parameters ρ of a function: that over time, then that over points.
fn rhos(function: &Function<f64>) -> Vec<f64> {
    let (over_time, instant) = match function {
        Function::Reduced { of, reduction, .. } => match reduction {
            Reduction::Ks { rho, .. } | Reduction::InducedExponential { rho } => {
                (Some(*rho), of.instant())
            }
            Reduction::Final | Reduction::Integral | Reduction::Mean | Reduction::Damage { .. } => {
                (None, of.instant())
            }
        },
        Function::Clearance { release, .. } => match release {
            Release::Best { rho, .. } => (Some(*rho), None),
            Release::Final => (None, None),
        },
        Function::LowestFrequency { rho, .. } => (Some(*rho), None),
        Function::Misfit { .. } | Function::Duration | Function::OfDesign { .. } => (None, None),
    };
    let over_points = instant.and_then(|instant| match instant {
        Instant::ShellStress { rho, .. } => Some(*rho),
        Instant::LargestDeformation { largest, .. } => Some(largest.rho),
        _ => None,
    });
    over_time.into_iter().chain(over_points).collect()
}

/// The function with every ρ times a factor.
fn sharpened(function: &Function<f64>, factor: f64) -> Function<f64> {
    let mut out = function.clone();
    match &mut out {
        Function::Reduced { of, reduction, .. } => {
            match reduction {
                Reduction::Ks { rho, .. } | Reduction::InducedExponential { rho } => *rho *= factor,
                Reduction::Final
                | Reduction::Integral
                | Reduction::Mean
                | Reduction::Damage { .. } => {}
            }
            match of {
                Quantity::Of(Instant::ShellStress { rho, .. }) => *rho *= factor,
                Quantity::Of(Instant::LargestDeformation { largest, .. }) => largest.rho *= factor,
                _ => {}
            }
        }
        Function::Clearance { release, .. } => match release {
            Release::Best { rho, .. } => *rho *= factor,
            Release::Final => {}
        },
        Function::LowestFrequency { rho, .. } => *rho *= factor,
        Function::Misfit { .. } | Function::Duration | Function::OfDesign { .. } => {}
    }
    out
}

/// The largest absolute value of a quantity.
fn size(of: &Quantity<f64>, model: &Model<f64>, run: &Trajectory<f64>) -> f64 {
    let values = of.values_and_largest(model, run).1;
    values.into_iter().map(f64::abs).fold(0.0, f64::max)
}

/// The value at the end or the integral, with the largest value of all points at each instant.
fn of_largest(
    instant: &Instant<f64>,
    reduction: Reduction,
    model: &Model<f64>,
    run: &Trajectory<f64>,
) -> f64 {
    let last = run.last();
    let instants = match reduction {
        Reduction::Integral | Reduction::Mean => 0..=last,
        _ => last..=last,
    };
    let largest = |at: &Snapshot<f64>, turns| instant.value_and_largest(at, turns).1;
    let values = sample_with(instant, (model, run), instants, largest);
    match reduction {
        Reduction::Integral | Reduction::Mean => {
            let weighted = values.iter().enumerate();
            let mean: f64 = weighted.map(|(k, x)| x * run.quadrature_weight(k)).sum();
            match reduction {
                Reduction::Mean => mean,
                _ => mean * run.time(last),
            }
        }
        _ => values[0],
    }
}

/// The clearance of a release at the instant of the longest range, between the samples.
fn best_clearance(
    function: &Function<f64>,
    model: &Model<f64>,
    run: &Trajectory<f64>,
) -> Option<f64> {
    let Function::Clearance {
        projectile,
        release: release @ Release::Best { .. },
        distance,
        top,
    } = function
    else {
        return None;
    };
    let known = release_weights(release, model, run);
    let ranges: Vec<f64> = (0..=run.last())
        .map(|k| (known.range).value(&Snapshot::of(model, run, k), turn(&known.turns, k)))
        .collect();
    let points = peak::points(run, &ranges);
    let best = points.iter().max_by(|a, b| a.value.total_cmp(&b.value))?;
    let mut flight = [0.0; 5];
    for &(k, weight) in &best.of {
        let own = Snapshot::of(model, run, k).flight(projectile).to_array();
        flight
            .iter_mut()
            .zip(own)
            .for_each(|(sum, x)| *sum += weight * x);
    }
    Some(Flight::from_array(flight).clearance(*distance, *top))
}
