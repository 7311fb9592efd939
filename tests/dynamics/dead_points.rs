//! Drives of joints at dead points of linkages: the message names them, at the start and during the motion.
//!
//! A slider of a crank r and a rod l, on the line of the crank's axle, cannot move at first where both are stretched
//! (x = r + l) or folded (x = l − r); a rocker where crank and coupler are in line.

use crate::reference::documents::problem as parsed;
use flexbody_driver::simulate;
use flexbody_problem::Problem;
use serde_json::Value;

fn bar(length: f64, at: [f64; 2], angle: f64) -> Value {
    json!({"shape": {"box": {"size": [length, 0.05, 0.05]}}, "mass": 1,
           "points": {"a": [-length / 2.0, 0, 0], "b": [length / 2.0, 0, 0]},
           "place": {"put": "a", "at": [at[0], at[1], 0], "turn": {"axis": [0, 0, 1], "angle": angle}}})
}

fn hinge(between: [&str; 2], at: Value) -> Value {
    json!({"revolute": {"between": between, "at": at, "axis": [0, 0, 1]}})
}

/// A crank of 0.3 m at an angle, a rod of 1 m, and a slider that is driven.
fn slider_crank(angle: f64, slide: Value) -> Value {
    let (sin, cos) = angle.sin_cos();
    let (x, y) = (0.3 * cos, 0.3 * sin);
    let rod = -y.asin();
    let end = x + rod.cos();
    json!({
        "version": 1, "name": "slider crank", "gravity": [0, 0, 0],
        "bodies": {"crank": bar(0.3, [0.0, 0.0], angle), "rod": bar(1.0, [x, y], rod),
                   "slider": {"shape": {"box": {"size": [0.1, 0.1, 0.1]}}, "mass": 1, "place": {"at": [end, 0, 0]}}},
        "joints": {"axle": hinge(["crank", "ground"], json!([0, 0, 0])), "big": hinge(["rod", "crank"], json!("crank.b")),
                   "small": hinge(["rod", "slider"], json!("rod.b")),
                   "guide": {"prismatic": {"between": ["slider", "ground"], "at": [end, 0, 0], "axis": [1, 0, 0]}}},
        "drives": {"push": {"joint": "guide", "slide": slide}},
        "simulation": {"duration": 1}
    })
}

fn faults(document: &Value) -> String {
    let faults = Problem::parse(&document.to_string(), "linkage.json", &[]).expect_err("a fault");
    faults.to_string()
}

#[test]
fn drives_that_start_at_dead_points_are_told_so() {
    let pi = std::f64::consts::PI;
    for (angle, slide) in [
        (0.0, json!({"rate": -0.5})),
        (0.0, json!({"polynomial": [0, 0, -0.5]})),
        (pi, json!({"rate": 0.5})),
        (0.0, json!({"polynomial": [0]})),
    ] {
        let text = faults(&slider_crank(angle, slide));
        assert!(text.contains("joint \"guide\" at a dead point"), "{text}");
    }
    // A rocker at its end: crank 0.3 and coupler 1 in line to (x, y), the rocker of 0.6 from (1, 0).
    let x = (1.3_f64.powi(2) - 0.36 + 1.0) / 2.0;
    let y = (1.69 - x * x).sqrt();
    let along = y.atan2(x);
    let text = faults(&json!({
        "version": 1, "name": "four bar",
        "bodies": {"crank": bar(0.3, [0.0, 0.0], along), "coupler": bar(1.0, [0.3 * along.cos(), 0.3 * along.sin()], along),
                   "rocker": bar(0.6, [1.0, 0.0], y.atan2(x - 1.0))},
        "joints": {"axle": hinge(["crank", "ground"], json!([0, 0, 0])), "big": hinge(["coupler", "crank"], json!("crank.b")),
                   "small": hinge(["rocker", "coupler"], json!({"a": "b", "b": "b"})),
                   "pivot": hinge(["rocker", "ground"], json!([1, 0, 0]))},
        "drives": {"swing": {"joint": "pivot", "turn": {"rate": -1}}},
        "simulation": {"duration": 1}
    }));
    assert!(text.contains("joint \"pivot\" at a dead point"), "{text}");
    // Driven twice is something else.
    let mut twice = slider_crank(1.0, json!({"rate": 0.1}));
    twice["drives"]["turn"] = json!({"joint": "axle", "turn": {"rate": 1}});
    let text = faults(&twice);
    assert!(
        !text.contains("dead point") && text.contains("leave free"),
        "{text}"
    );
}

#[test]
fn drives_to_dead_points_are_named() {
    for method in [json!("dop853"), json!({"radau": {"stages": 3}})] {
        let mut document = slider_crank(1.0, json!({"rate": 0.5}));
        document["simulation"]["method"] = method;
        let problem = parsed(&document);
        let failure = simulate(&problem, &problem.start())
            .err()
            .expect("a failure")
            .to_string();
        assert!(
            failure.contains("a dead point of the drive of joint \"guide\""),
            "{failure}"
        );
    }
    // The crank drives through all dead points of the slider.
    let mut document = slider_crank(1.0, json!({"rate": 0.5}));
    document["drives"]["push"] = json!({"joint": "axle", "turn": {"rate": 9}});
    document["functions"] = json!({"angle": {"final": {"angle": {"joint": "axle"}}}});
    let problem = parsed(&document);
    let motion = simulate(&problem, &problem.start()).expect("a motion");
    assert!((motion.at.function(0).value - 9.0).abs() < 1e-9);
}
