//! Gradients of problems against the complex step.

use flexbody::driver::check;
use flexbody::problem::Problem;
use serde_json::Value;

/// Asserts that every derivative of every function at the start agrees with the complex step to 1e-12 of the
/// function's gradient, whose entries are multiplied by their variables. `context` names the case.
pub fn gradients_are_exact(problem: &Problem, context: &Value) {
    let found = check(problem, &problem.start()).expect("runs");
    let (functions, variables) = (problem.function_names.len(), problem.variables.len());
    assert_eq!(found.len(), functions * variables);
    for f in 0..functions {
        let scaled = |i: usize, x: f64| x * problem.variables[i].start.abs();
        let of: Vec<_> = found.iter().filter(|d| d.function == f).collect();
        let gradient = of
            .iter()
            .fold(0.0_f64, |m, d| m.hypot(scaled(d.variable, d.complex_step)));
        assert!(gradient > 0.0);
        for d in of {
            let off = scaled(d.variable, d.adjoint - d.complex_step).abs() / gradient;
            assert!(off <= 1e-12, "{context} {d:?}: {off:e}");
        }
    }
}
