//! The curvature at an optimum, against differences of the function, and with bounds without force.

use crate::reference::documents::optimised;
use flexbody_driver::evaluate::Evaluated;
use flexbody_driver::{KnownEvaluations, Optimisation, second_order};
use flexbody_problem::Problem;
use flexbody_report::optimum::{Curvature, SecondOrder};

/// A bar that swings fastest if it is hinged at d² = I/m from its centre.
const SWING: &str = include_str!("../data/swing.json");

fn solved(problem: &Problem) -> Optimisation {
    let done = optimised(problem);
    assert!(done.outcome.converged());
    done
}

fn curvature(problem: &Problem, done: &Optimisation) -> SecondOrder {
    let (outcome, integration) = (&done.outcome, &done.integration);
    second_order(
        problem,
        outcome,
        integration,
        KnownEvaluations::default(),
        &|| false,
    )
    .expect("runs")
    .expect("is not stopped")
}

#[test]
fn the_curvature_is_that_of_the_function() {
    let problem = Problem::parse(SWING, "swing.json", &[]).expect("no faults");
    let done = solved(&problem);
    let found = curvature(&problem, &done);
    assert_eq!(found.curvature, Curvature::StrictOptimum);
    assert!(found.weakly_active.is_empty());
    // The second difference of the function, with steps of the fourth root of round-off.
    let scale = problem.variables[0].scale;
    let x = done.optimum.design["pin"].value;
    let h = 2e-3;
    let f = |s: f64| {
        let at = Evaluated::new(&problem, &[x + s * h * scale]).expect("runs");
        at.function(0).value
    };
    let difference = (f(1.0) - 2.0 * f(0.0) + f(-1.0)) / (h * h);
    assert_eq!(found.eigenvalues.len(), 1);
    let error = (found.eigenvalues[0] - difference).abs();
    assert!(error < 1e-3 * difference, "{found:?} {difference}");
    assert!(
        difference > 0.0 && found.uncertainty < 1e-3 * difference,
        "{found:?}"
    );
}

/// A bound through the optimum has no force; a bound away from it does.
#[test]
fn a_bound_without_force_leaves_its_direction_free() {
    let free = Problem::parse(SWING, "swing.json", &[]).expect("no faults");
    let free_end = solved(&free);
    let best = free_end.optimum.design["pin"].value;
    let expected = curvature(&free, &free_end).eigenvalues[0];
    let bounded = |upper: f64| {
        let text = SWING.replace(
            r#""upper": 0.5"#,
            &format!(r#""upper": {upper}, "scale": 0.5"#),
        );
        let problem = Problem::parse(&text, "swing.json", &[]).expect("no faults");
        curvature(&problem, &solved(&problem))
    };
    assert!(best < -0.2 && free.variables[0].scale == 0.5);
    let touched = bounded(best);
    assert_eq!(touched.weakly_active, ["pin"], "{touched:?}");
    assert_eq!(touched.curvature, Curvature::StrictOptimum);
    // The differences are inside the bound, a few 1e-4 of the scale from the optimum.
    let error = (touched.eigenvalues[0] - expected).abs();
    assert!(
        error < 1e-2 * expected && error < 10.0 * touched.uncertainty,
        "{touched:?} {expected}"
    );
    let held = bounded(best - 0.05);
    assert_eq!(held.curvature, Curvature::NoFreeDirection, "{held:?}");
    assert!(held.eigenvalues.is_empty() && held.weakly_active.is_empty());
}
