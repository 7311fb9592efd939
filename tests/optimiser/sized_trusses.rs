//! Trusses of least weight in the units of their sources and in others.

use flexbody_optimiser::{Method, Options, Silent, solve};

use crate::problems::sized_truss::{SizedTruss, UNITS, trusses};

/// Evaluations of functions and gradients, and the weight in pounds.
fn run(mut truss: SizedTruss, method: Method) -> (usize, f64) {
    let (name, unit) = (truss.name, truss.units);
    let options = Options {
        method,
        ..Options::default()
    };
    let outcome = solve(&mut truss, &options, &mut Silent);
    assert!(outcome.converged(), "{name}: {:?}", outcome.status);
    let counts = outcome.counts;
    (
        counts.evaluations + counts.gradients,
        outcome.objective / unit.pound,
    )
}

#[test]
fn published_weights_are_reached_in_any_unit_with_the_same_evaluations() {
    for (k, truss) in trusses().into_iter().enumerate() {
        let (name, published) = (truss.name, truss.published);
        let (plain, weight) = run(truss, Method::InteriorPoint);
        assert!(plain <= 70, "{name}: {plain}");
        assert!(
            (weight / published - 1.0).abs() <= 2e-4,
            "{name}: {weight} where {published} is published"
        );
        for unit in UNITS {
            let (found, weight) = run(trusses().remove(k).in_units(unit), Method::InteriorPoint);
            let ratio = found as f64 / plain as f64;
            let name = format!("{name} in {}", unit.name);
            assert!((0.8..=1.2).contains(&ratio), "{name}: {found} and {plain}");
            assert!((weight / published - 1.0).abs() <= 2e-4, "{name}: {weight}");
        }
    }
}
