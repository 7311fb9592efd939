//! Gradients of problems against the complex step.

use flexbody_driver::{Simulated, check};
use flexbody_problem::Problem;
use serde_json::Value;

/// Asserts that every derivative of every function at the start agrees with the complex step to 1e-12 of the
/// function's gradient, whose entries are multiplied by their variables. `context` names the case.
pub fn gradients_are_exact(problem: &Problem, context: &Value) {
    let sizes: Vec<f64> = problem.variables.iter().map(|v| v.start.abs()).collect();
    let all = 0..problem.function_names.len();
    gradients_agree(problem, all, (&problem.start(), &sizes), context);
}

/// The same at the design `x`, for entries multiplied by the scales of their variables.
pub fn scaled_gradients_are_exact(problem: &Problem, x: &[f64], context: &Value) {
    let scales: Vec<f64> = problem.variables.iter().map(|v| v.scale).collect();
    gradients_agree(
        problem,
        0..problem.function_names.len(),
        (x, &scales),
        context,
    );
}

/// The same at the start, for the functions that expressions of others give, as those of all phases of a motion.
pub fn gradients_of_expressions_are_exact(problem: &Problem, context: &Value) {
    let scales: Vec<f64> = problem.variables.iter().map(|v| v.scale).collect();
    let own = problem.composition.first..problem.function_names.len();
    gradients_agree(problem, own, (&problem.start(), &scales), context);
}

fn gradients_agree(
    problem: &Problem,
    which: std::ops::Range<usize>,
    (x, sizes): (&[f64], &[f64]),
    context: &Value,
) {
    let found = check(problem, x).unwrap_or_else(|failure| panic!("{context}: {failure}"));
    let (functions, variables) = (problem.function_names.len(), problem.variables.len());
    assert_eq!(found.len(), functions * variables);
    for f in which {
        let of: Vec<_> = found.iter().filter(|d| d.function == f).collect();
        let gradient = of
            .iter()
            .fold(0.0_f64, |m, d| m.hypot(d.complex_step * sizes[d.variable]));
        assert!(gradient > 0.0, "{context}: {}", problem.function_names[f]);
        for d in of {
            let off = ((d.adjoint - d.complex_step) * sizes[d.variable]).abs() / gradient;
            assert!(off <= 1e-12, "{context} {d:?}: {off:e}");
        }
    }
}

/// Asserts that every derivative at the start agrees with a difference of five values to 1e-7 of the function, or of `floor` if
/// that is larger, for a change of a variable by itself. `context` names the case.
pub fn gradients_are_slopes(problem: &Problem, floor: f64, context: &Value) {
    let x = problem.start();
    let at = |x: &[f64]| Simulated::of(problem, x).expect("an analysis");
    for derivative in check(problem, &x).expect("derivatives") {
        let (f, i) = (derivative.function, derivative.variable);
        let step = 1e-4 * x[i].abs();
        let moved = |by: f64| {
            let mut x = x.clone();
            x[i] += by;
            at(&x).value(f)
        };
        let difference = (8.0 * (moved(step) - moved(-step)) - moved(2.0 * step)
            + moved(-2.0 * step))
            / (12.0 * step);
        let off = (derivative.adjoint - difference).abs() * x[i].abs();
        assert!(
            off < 1e-7 * at(&x).value(f).abs().max(floor),
            "{context}: {derivative:?} {difference}"
        );
    }
}

/// Makes the plates of a document thick and soft, so that all derivatives are of one size, with five variables:
/// two bands of the second, the first, modulus and density.
pub fn thick_and_soft(document: &mut Value) {
    document["bodies"]["second"]["elements"]["structure"]["thickness"] =
        json!({"per": "band", "along": "x", "value": 0.04});
    document["bodies"]["first"]["elements"]["structure"]["thickness"] = json!(0.05);
    document["materials"]["aluminium"]["young"] = json!(7e7);
    document["variables"] = json!({
        "bands": {"path": "/bodies/second/elements/structure/thickness/value", "lower": 0.01, "upper": 0.1},
        "thickness": {"path": "/bodies/first/elements/structure/thickness", "lower": 0.01, "upper": 0.1},
        "modulus": {"path": "/materials/aluminium/young", "lower": 1e7, "upper": 1e8},
        "density": {"path": "/materials/aluminium/density", "lower": 2000, "upper": 3000},
    });
}
