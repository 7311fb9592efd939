//! Optimisations that start or end where a derivative vanishes or does not exist: norms of zero, certificates at
//! minima, and records of stationary starts.

use crate::reference::documents::{optimised, problem};
use flexbody_driver::{certificate, certify};
use flexbody_optimiser::Status;
use serde_json::Value;

/// A ball of 2 kg that a force from rest moves along x for 1 s. Its speed is |F| t / m.
fn pushed(lower: f64, upper: f64, start: f64, speed: Value, study: Value) -> Value {
    let mut file = json!({
        "version": 1, "name": "pushed", "gravity": [0, 0, 0],
        "bodies": {"ball": {"shape": {"sphere": {"radius": 0.1}}, "mass": 2}},
        "loads": {"push": {"force": {"body": "ball", "direction": [1, 0, 0], "magnitude": start}}},
        "simulation": {"duration": 1, "steps": 8},
        "functions": {
            "speed": speed,
            "energy": {"final": {"energy": "kinetic"}}},
        "variables": {"F": {"path": "/loads/push/force/magnitude", "lower": lower, "upper": upper}}
    });
    for (key, value) in study.as_object().expect("an object") {
        file[key] = value.clone();
    }
    file
}

/// At rest the speed is least and has no derivative. Its largest value is at a bound of the force: by 2 N it
/// is 1 m/s at the end and 0.5 m on average over 1 s.
#[test]
fn a_largest_speed_is_not_claimed_at_rest() {
    let of = json!({"speed": {"body": "ball"}});
    let reductions = [
        (json!({"final": of}), 1.0),
        (json!({"integral": of}), 0.5),
        (json!({"induced_exponential": {"rho": 500, "of": of}}), 1.0),
    ];
    for (speed, right) in reductions {
        for method in ["interior_point", "trust_region", "auto"] {
            for (lower, upper) in [(-0.5, 2.0), (0.0, 2.0), (-2.0, 0.0), (-2.0, 1e-3)] {
                let study =
                    json!({"objective": {"maximise": "speed"}, "optimiser": {"method": method}});
                let problem = problem(&pushed(lower, upper, 0.0, speed.clone(), study));
                let done = optimised(&problem);
                let context = format!("{method}, {lower}…{upper}: {:?}", done.optimum.message);
                assert_eq!(done.outcome.status, Status::Converged, "{context}");
                // The other bound may be a local optimum.
                let force = done.optimum.design["F"].value.abs();
                assert!(
                    (force - lower.abs()).abs().min((force - upper).abs()) < 1e-6,
                    "{context}"
                );
                let found = done.optimum.objective.value;
                let value = right * force / 2.0;
                assert!(
                    found > 0.0 && (found - value).abs() < 5e-2 * value,
                    "{context}: {found}"
                );
                let warnings = done.optimum.warnings.join("; ");
                let told = "the speed of \"speed\" is zero, where it has a kink and no derivative";
                // The interior point moves a start at a bound inside.
                let at_rest = method == "trust_region" || lower == -0.5;
                assert!(!at_rest || warnings.contains(told), "{context}: {warnings}");
            }
        }
    }
}

/// A least speed that must be above zero is found from rest: m v²/2 with v = 0.4 m/s.
#[test]
fn a_row_on_a_speed_is_fulfilled_from_rest() {
    for method in ["interior_point", "trust_region", "auto"] {
        for lower in [-2.0, 0.0] {
            let study = json!({
                "objective": {"minimise": "energy"}, "optimiser": {"method": method},
                "constraints": {"fast": {"function": "speed", "lower": 0.4}}});
            let speed = json!({"final": {"speed": {"body": "ball"}}});
            let done = optimised(&problem(&pushed(lower, 2.0, 0.0, speed, study)));
            let found = done.optimum.objective.value;
            assert_eq!(done.outcome.status, Status::Converged, "{method}, {lower}");
            assert!((found - 0.16).abs() < 1e-6, "{method}, {lower}: {found}");
        }
    }
}

/// A speed that may be zero, and is, decides nothing: the energy is least at rest, and that is an optimum.
#[test]
fn a_row_that_is_far_from_its_bound_may_be_at_rest() {
    for method in ["interior_point", "trust_region"] {
        let study = json!({
            "objective": {"minimise": "energy"}, "optimiser": {"method": method},
            "constraints": {"slow": {"function": "speed", "upper": 0.4}}});
        let speed = json!({"final": {"speed": {"body": "ball"}}});
        let done = optimised(&problem(&pushed(-1.0, 2.0, 0.0, speed, study)));
        assert_eq!(done.outcome.status, Status::Converged, "{method}");
        assert!(done.optimum.objective.value.abs() < 1e-9, "{method}");
    }
}

/// A least speed of zero is a kink: no gradient shows it, and the run says so instead of a claim.
#[test]
fn a_least_speed_of_zero_is_not_claimed_but_named() {
    for method in ["interior_point", "trust_region"] {
        let study = json!({"objective": {"minimise": "speed"}, "optimiser": {"method": method}});
        let speed = json!({"final": {"speed": {"body": "ball"}}});
        let done = optimised(&problem(&pushed(-1.0, 2.0, 0.7, speed, study)));
        assert_ne!(done.outcome.status, Status::Converged, "{method}");
        assert!(done.optimum.objective.value.abs() < 1e-4, "{method}");
        let warnings = done.optimum.warnings.join("; ");
        assert!(
            warnings.contains("the speed of \"speed\" is zero"),
            "{method}: {warnings}"
        );
    }
}

/// At a smooth stationary start the derivatives are zero there; nothing is said of other designs.
#[test]
fn a_stationary_start_is_not_called_independent() {
    let speed = json!({"final": {"speed": {"body": "ball"}}});
    let study = json!({"objective": {"minimise": "energy"}});
    let done = optimised(&problem(&pushed(-1.0, 1.0, 0.0, speed, study)));
    let warnings = done.optimum.warnings.join("; ");
    let told = "at the start all derivatives by these variables are zero: F";
    assert!(warnings.contains(told), "{warnings}");
}

/// A bar that swings about a pin; the least swept angle is where the pin has d² = I/m. At the optimum every
/// derivative vanishes, and at a start there as well. The certificate passes; a wrong gradient would not, as
/// `driver::certificate` tests.
#[test]
fn gradients_that_vanish_are_confirmed() {
    let swing: Value = serde_json::from_str(include_str!("../data/swing.json")).expect("JSON");
    let angle = json!({"rotation": {"body": "bar", "axis": [0, 0, 1]}});
    for reduction in [
        json!({"final": angle}),
        json!({"integral": angle}),
        json!({"induced_exponential": {"rho": 3, "of": angle}}),
        json!({"ks": {"rho": 20, "of": angle}}),
        json!({"integral": {"energy": "kinetic"}}),
        json!({"final": {"speed_squared": {"body": "bar"}}}),
    ] {
        for simulation in [
            json!({"duration": 0.4, "steps": 200}),
            json!({"duration": 1.1, "tolerance": 1e-10}),
        ] {
            let mut file = swing.clone();
            file["functions"] = json!({"swept angle": reduction});
            file["simulation"] = simulation;
            let mut problem = problem(&file);
            for from in ["the start", "the optimum"] {
                let done = optimised(&problem);
                let found = certify(&problem, &done, certificate::TOLERANCE);
                assert!(
                    found.passed,
                    "{reduction}, from {from}: {:?}",
                    found.faults()
                );
                problem.restart(&[done.optimum.design["pin"].value]);
            }
        }
    }
}
