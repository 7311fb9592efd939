//! Derivatives that are zero pass the check, and the certificate of an optimisation has every function.

use flexbody_driver::{KnownEvaluations, certify, check, optimise};
use flexbody_problem::Problem;
use flexbody_report::optimum::CertificateCost;
use std::ops::ControlFlow;

/// A zero derivative is compared with the size of the function, for any terms. Examples: the
/// event's own quantity, and a free fall in its mass.
#[test]
fn what_does_not_change_passes() {
    let arm = r#"{"shape": {"box": {"size": [1, 0.2, 0.3]}}, "mass": 1,
                   "place": {"put": [-0.5, 0, 0], "at": [0, 0, 0]}}"#;
    let swing = format!(
        r#"{{"version": 1, "name": "swing", "gravity": [0.3, -9.81, 0],
        "bodies": {{"arm": {arm}, "tip": {arm}}},
        "joints": {{"pin": {{"revolute": {{"between": ["arm", "ground"], "at": [0, 0, 0],
            "axis": [0, 0, 1]}}}},
            "knee": {{"revolute": {{"between": ["tip", "arm"], "at": [0, 0.1, 0], "axis": [0, 0, 1]}}}}}},
        "simulation": {{"duration": 2, "tolerance": 1e-12, "until": {{"reaches": -0.2,
            "measure": {{"rotation": {{"body": "tip", "axis": [0, 0, 1]}}}}}}}},
        "functions": {{"turned": {{"final": {{"rotation": {{"body": "tip", "axis": [0, 0, 1]}}}}}}}},
        "variables": {{"mass": {{"path": "/bodies/tip/mass", "lower": 0.1}},
            "height": {{"path": "/joints/knee/revolute/at/1"}}}}}}"#
    );
    let spin = r#"{"version": 1, "name": "spin", "gravity": [0, -9.81, 1],
        "bodies": {"a": {"shape": {"box": {"size": [1, 0.2, 0.3]}}, "mass": 1, "place": {"at": [1, 0, 0]},
            "velocity": {"angular": [1, 2, 3]}}},
        "joints": {"r": {"rod": {"between": ["a", "ground"], "at": [[1, 0, 0], [0, 0, 0]]}}},
        "simulation": {"duration": 1, "tolerance": 1e-12},
        "functions": {"x": {"final": {"position": {"body": "a", "direction": [1, 0, 0]}}}},
        "variables": {"m": {"path": "/bodies/a/mass", "lower": 0.1}}}"#;
    // The drive alone moves the slider, and the spring is strong.
    let slider = r#"{"version": 1, "name": "slider",
        "bodies": {"b": {"shape": {"sphere": {"radius": 0.1}}, "mass": 2, "points": {"a": [0.1, 0.2, -0.3]},
            "place": {"put": "a", "turn": {"axis": [1, 2, 3], "angle": 0.7}}}},
        "joints": {"p": {"prismatic": {"between": ["b", "ground"], "at": "b.a", "axis": [1, 0.4, -0.3]}}},
        "drives": {"d": {"joint": "p", "slide": {"polynomial": [-0.16, -0.085, -0.127]}}},
        "loads": {"s": {"spring": {"between": ["b", "ground"], "at": {"a": [0, 0, 0.1], "b": [0.5, 1, 0.3]},
            "rest_length": 0.4, "stiffness": 700}}},
        "simulation": {"duration": 0.8, "tolerance": 1e-9},
        "functions": {"f": {"final": {"acceleration": {"body": "b", "direction": [0.3, 0.5, 0.2]}}}},
        "variables": {"x": {"path": "/bodies/b/points/a/0", "lower": -1, "upper": 1},
            "angle": {"path": "/bodies/b/place/turn/angle", "lower": 0, "upper": 1},
            "k": {"path": "/loads/s/spring/stiffness", "lower": 100, "upper": 1000}}}"#;
    for text in [&swing[..], spin, slider] {
        let problem = Problem::parse(text, "nothing.json", &[]);
        let problem = problem.unwrap_or_else(|faults| panic!("{faults}"));
        for d in check(&problem, &problem.start()).expect("a run") {
            assert!(d.is_round_off(), "{d:?}");
            assert!(d.terms < 1e3, "{d:?}");
        }
    }
}

/// A pendulum by its hinge and gravity: both gradients pass, and the same direction is taken again.
#[test]
fn every_function_is_certified() {
    let text = r#"{"version": 1, "name": "swing", "gravity": [0, -9.81, 0],
        "bodies": {"bar": {"shape": {"rod": {"length": 1, "radius": 0.02}}, "mass": 2,
                           "points": {"pin": [-0.4, 0, 0]}, "place": {"put": "pin", "at": [0, 0, 0]}}},
        "joints": {"hinge": {"revolute": {"between": ["bar", "ground"], "at": "bar.pin",
                                          "axis": [0, 0, 1]}}},
        "simulation": {"duration": 0.4, "tolerance": 1e-9},
        "functions": {"angle": {"final": {"rotation": {"body": "bar", "axis": [0, 0, 1]}}},
                      "energy": {"final": {"energy": "kinetic"}}},
        "variables": {"pin": {"path": "/bodies/bar/points/pin/0", "lower": -0.5, "upper": 0.5},
                      "pull": {"path": "/gravity/1", "lower": -9.9, "upper": -9.7}},
        "objective": {"minimise": "angle"}}"#;
    let problem = Problem::parse(text, "swing.json", &[]);
    let problem = problem.unwrap_or_else(|faults| panic!("{faults}"));
    let mut progress = |_: &_| ControlFlow::Continue(());
    let known = KnownEvaluations::default();
    let done = optimise(&problem, "", None, known, &mut progress).expect("has an objective");
    let found = certify(&problem, &done, 1e-12);
    assert!(found.passed && found.faults().is_empty(), "{found:?}");
    let cost = CertificateCost {
        gradients: 2,
        complex_runs: 2,
    };
    assert_eq!(found.cost, cost);
    for design in [&found.start, &found.optimum] {
        assert_eq!(design.functions.len(), 2);
        for derivative in design.functions.values() {
            assert!(derivative.adjoint.is_some_and(|x| x != 0.0), "{found:?}");
            assert!(
                derivative.difference.is_some_and(|x| x < 1e-12),
                "{found:?}"
            );
        }
    }
    assert_eq!(certify(&problem, &done, 1e-12), found, "the same direction");
}
