//! Bounds and scales of variables that differ by many orders of magnitude, by every method: a
//! thrown ball whose optima are known in closed form. A claim of convergence holds in the units of
//! the file.

use flexbody::{Problem, optimise};
use serde_json::{Value, json};
use std::ops::ControlFlow;

/// A ball of 2 kg at (1, 2, 0.5) m that starts with (1, 2, 3) m/s without gravity, for a second.
fn ball(variables: Value, objective: &Value, energy: Option<f64>) -> Value {
    let mut document = json!({
        "version": 1, "name": "ball", "gravity": [0, 0, 0],
        "bodies": {"ball": {
            "shape": {"sphere": {"radius": 0.1}}, "mass": 2, "place": {"at": [1, 2, 0.5]},
            "velocity": {"linear": [1, 2, 3], "angular": [0, 0, 0]}}},
        "simulation": {"duration": 1, "steps": 2},
        "functions": {
            "energy": {"final": {"energy": "kinetic"}},
            "x": {"final": {"position": {"body": "ball", "direction": [1, 0, 0]}}}},
        "objective": objective,
    });
    document["variables"] = variables;
    if let Some(most) = energy {
        document["constraints"] = json!({"effort": {"function": "energy", "upper": most}});
    }
    document
}

/// Asserts the optimum by every method. The trust region may reach its limit if `crawls`.
fn assert_optimum(what: &str, mut document: Value, best: f64, crawls: bool) {
    for method in ["interior_point", "trust_region", "auto"] {
        document["optimiser"] = json!({"method": method});
        let text = document.to_string();
        let problem = Problem::parse(&text, "ball.json", &[]).unwrap_or_else(|f| panic!("{f}"));
        let mut go_on = |_| ControlFlow::Continue(());
        let optimum = optimise(&problem, &mut go_on).expect("an objective");
        let (value, (status, _)) = (optimum.objective(), optimum.status());
        if crawls && method == "trust_region" && status == "iteration_limit" {
            continue;
        }
        assert_eq!(status, "converged", "{what}, {method}: {value}");
        let error = (value - best).abs() / best.abs().max(1.0);
        assert!(error <= 1e-6, "{what}, {method}: {value} for {best}");
    }
}

fn speed(component: usize, bounds: Value) -> Value {
    let path = format!("/bodies/ball/velocity/linear/{component}");
    let mut variable = json!({ "path": path });
    for (key, value) in bounds.as_object().into_iter().flatten() {
        variable[key] = value.clone();
    }
    variable
}

/// Least energy: the least mass, at rest except for the 2 m/s that no variable changes.
#[test]
fn a_wide_bound_hides_no_force_on_other_variables() {
    for upper in [1e4, 1e6, 1e9, 1e12] {
        let variables = json!({
            "m": {"path": "/bodies/ball/mass", "lower": 1, "upper": upper},
            "u": speed(0, json!({"lower": -5, "upper": 5})),
            "w": speed(2, json!({})),
        });
        let document = ball(variables, &json!({"minimise": "energy"}), None);
        assert_optimum(&format!("mass up to {upper:e}"), document, 2.0, false);
    }
}

/// Least x with an energy of at most 20 J: with m = 1 kg, w = 0 and the 2 m/s across, u = −6.
#[test]
fn a_feasible_start_is_not_called_infeasible() {
    for upper in [1e4, 1e7, 1e9] {
        let variables = json!({
            "u": speed(0, json!({})),
            "m": {"path": "/bodies/ball/mass", "lower": 1, "upper": upper},
            "w": speed(2, json!({})),
        });
        let document = ball(variables, &json!({"minimise": "x"}), Some(20.0));
        assert_optimum(&format!("mass up to {upper:e}"), document, -5.0, false);
    }
}

/// A wrong scale of a variable does not turn the start into an optimum.
#[test]
fn a_scale_that_is_wrong_ends_no_run_early() {
    for scale in [1e-12, 1e-6, 1e6] {
        let variables = json!({
            "u": speed(0, json!({"lower": -5, "upper": 5, "scale": scale})),
            "w": speed(2, json!({"lower": -5, "upper": 5})),
        });
        let document = ball(variables, &json!({"minimise": "energy"}), None);
        assert_optimum(&format!("scale {scale:e}"), document, 4.0, true);
    }
}
