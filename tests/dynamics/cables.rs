//! Cables and winches against closed forms: Atwood's machine, a loose block, rebounds, a winch that drags a body;
//! energy and power, derivatives by every method, families.

use crate::reference::documents::{
    in_units, methods, problem as parsed, reversed, run, unlowered_values, value, values, vary,
};
use crate::reference::gradients::gradients_are_exact;
use crate::stops::rebound;
use serde_json::Value;
use std::f64::consts::PI;

fn near(found: f64, exact: f64, tolerance: f64, what: &str) {
    assert!(
        (found - exact).abs() <= tolerance,
        "{what}: {found} {exact}"
    );
}

fn ground(x: f64, y: f64) -> Value {
    json!({"body": "ground", "point": [x, y, 0]})
}

/// Masses of 3 kg and 2 kg on a cable over a pulley: the acceleration (3 − 2) g / 5, but for the stretch of the cable, and the
/// tension 2 · 3 · 2 g / 5, at which it starts.
#[test]
fn atwoods_machine() {
    let (k, tension) = (1e6, 2.4 * 9.81);
    let mass =
        |x: f64, mass: f64| json!({"shape": "point", "mass": mass, "place": {"at": [x, 0, 0]}});
    let file = json!({
        "version": 1, "name": "atwood",
        "bodies": {"a": mass(-0.5, 3.0), "b": mass(0.5, 2.0)},
        "loads": {"cable": {"cable": {
            "points": [{"body": "a"}, ground(-0.5, 2.0), ground(0.5, 2.0), {"body": "b"}],
            "length": 5.0 - tension / k, "stiffness": k, "width": 1e-6}}},
        "simulation": {"duration": 0.6, "tolerance": 1e-11},
        "functions": {
            "a": {"final": {"position": {"body": "a", "direction": [0, 1, 0]}}},
            "b": {"final": {"position": {"body": "b", "direction": [0, 1, 0]}}},
            "tension": {"mean": {"spring_force": {"load": "cable"}}},
            "length": {"final": {"spring_length": {"load": "cable"}}},
            "energy": {"final": {"energy": "total"}}
        }
    });
    let found = values(&file);
    let fall = 0.5 * 9.81 / 5.0 * 0.36;
    near(found[0], -fall, 1e-7, "a");
    near(found[1], fall, 1e-7, "b");
    near(found[2], tension, 1e-5, "tension");
    near(found[3], 5.0, 1e-7, "length");
    // Of the start: the stretch of the cable.
    near(found[4], 0.5 * tension * tension / k, 1e-8, "energy");
}

/// A block of 3 kg hangs loose on a cable between two pulleys, whose end carries 2 kg: the parts beside it stand at the angle
/// whose cosine is 3/4 from the vertical, with pulleys 0.4 m apart.
#[test]
fn a_loose_block_finds_its_depth() {
    let file = json!({
        "version": 1, "name": "tackle", "analysis": "rest",
        "bodies": {"block": {"shape": "point", "mass": 3, "place": {"at": [0.03, 0.6, 0]}},
                   "weight": {"shape": "point", "mass": 2, "place": {"at": [0.2, 0.1, 0]}}},
        "loads": {"cable": {"cable": {
            "points": [ground(-0.2, 1.0), {"body": "block"}, ground(0.2, 1.0), {"body": "weight"}],
            "length": 1.8, "stiffness": 4e3, "width": 1e-3}}},
        "functions": {
            "tension": {"final": {"spring_force": {"load": "cable"}}},
            "x": {"final": {"position": {"body": "block", "direction": [1, 0, 0]}}},
            "y": {"final": {"position": {"body": "block", "direction": [0, 1, 0]}}}
        }
    });
    let found = values(&file);
    near(found[0], 2.0 * 9.81, 1e-7, "tension");
    near(found[1], 0.0, 1e-7, "x");
    near(found[2], 1.0 - 0.6 / 7.0_f64.sqrt(), 1e-7, "y");
}

/// A body of 2 kg on a rail along x with a cable to x = −1, without gravity.
fn slider(cable: &Value, rate: f64, duration: f64) -> Value {
    json!({
        "version": 1, "name": "cable", "gravity": [0, 0, 0],
        "bodies": {"body": {"mass": 2, "inertia": {"xx": 2, "yy": 2, "zz": 2}, "velocity": {"linear": [rate, 0, 0]}}},
        "joints": {"rail": {"prismatic": {"between": ["body", "ground"], "at": [0, 0, 0], "axis": [1, 0, 0]}}},
        "loads": {"cable": {"cable": cable}},
        "simulation": {"duration": duration, "tolerance": 1e-10},
        "functions": {
            "x": {"final": {"position": {"body": "body", "direction": [1, 0, 0]}}},
            "rate": {"final": {"velocity": {"body": "body", "direction": [1, 0, 0]}}},
            "energy": {"final": {"energy": "total"}}
        }
    })
}

fn to_anchor(length: &Value, stiffness: f64, dissipation: f64, width: f64) -> Value {
    json!({"points": [{"body": "body"}, ground(-1.0, 0.0)], "length": length, "stiffness": stiffness,
           "dissipation": dissipation, "width": width})
}

/// A body that runs into its rope comes back as from a stop, and the slack rope does not push it.
#[test]
fn a_rope_rebounds_and_never_pushes() {
    for dissipation in [0.0, 0.3] {
        let rope = to_anchor(&json!(1.3), 3e3, dissipation, 0.02);
        let found = values(&slider(&rope, 1.7, 0.6));
        near(found[1], -rebound(1.7, dissipation), 1e-7, "rate");
    }
    let rope = to_anchor(&json!(1.3), 3e3, 0.0, 0.02);
    let found = values(&slider(&rope, -1.7, 0.4));
    near(found[1], -1.7, 1e-12, "slack");
}

/// A winch that reels in with a constant speed v drags a body from rest: x = v t − v sin(ω t) / ω against it, and the power
/// that it supplies is all the energy.
#[test]
fn a_winch_drags_a_body() {
    let (k, v) = (800.0_f64, 0.5);
    let omega = (k / 2.0).sqrt();
    // Taut from the start by far more than its onset, where the body is held by another spring's force.
    let (first, time) = (0.1, 0.35 * PI);
    let winch = to_anchor(&json!({"polynomial": [1.0 - first, -v]}), k, 0.0, 1e-3);
    let mut file = slider(&winch, 0.0, time);
    file["loads"]["hold"] =
        json!({"force": {"body": "body", "direction": [1, 0, 0], "magnitude": k * first}});
    file["functions"]["power"] = json!({"integral": {"power": {"load": "cable"}}});
    let found = values(&file);
    near(
        found[0],
        -(v * time - v * (omega * time).sin() / omega),
        1e-8,
        "x",
    );
    near(found[1], -(v - v * (omega * time).cos()), 1e-7, "rate");
    // What cable and force did is the kinetic energy.
    let work = found[3] + k * first * found[0];
    near(work, found[1] * found[1], 1e-6, "work");
}

/// A boom on a hinge, a load on a trolley and a loose block: a cable over pulleys on all of them that a winch shortens.
fn crane(simulation: &Value) -> Value {
    json!({
        "version": 1, "name": "crane",
        "bodies": {
            "boom": {"shape": {"rod": {"length": 2, "radius": 0.03}}, "mass": 4, "points": {"foot": [-1, 0, 0], "tip": [1, 0, 0]},
                     "place": {"put": "foot", "turn": {"axis": [0, 0, 1], "angle": 0.7}}},
            "load": {"shape": {"box": {"size": [0.2, 0.3, 0.2]}}, "mass": 3, "points": {"hook": [0.02, 0.15, 0.01]},
                     "place": {"at": [1.5, 0, 0]}}
        },
        "joints": {"hinge": {"revolute": {"between": ["boom", "ground"], "at": [0, 0, 0], "axis": [0, 0, 1]}}},
        "loads": {
            "hoist": {"cable": {"points": [ground(-1.0, 0.2), {"body": "boom", "point": "tip"}, {"body": "load", "point": "hook"}],
                                "length": {"table": {"times": [0, 0.3, 0.8], "values": [3.9, 3.8, 3.6]}},
                                "stiffness": 3e3, "dissipation": 0.2, "width": 0.05}},
            "stay": {"cable": {"points": [{"body": "boom", "point": [0.8, 0.1, 0]}, ground(-0.9, 1.4), ground(-1.2, 0.0)],
                               "length": 3.66, "stiffness": 5e3, "dissipation": 0.1, "width": 0.03}}
        },
        "simulation": simulation,
        "functions": {
            "load": {"final": {"position": {"body": "load", "point": "hook", "direction": [0.6, 0.8, 0.1]}}},
            "tension": {"integral": {"spring_force": {"load": "hoist"}}},
            "length": {"integral": {"spring_length": {"load": "stay"}}},
            "energy": {"integral": {"energy": "total"}},
            "power": {"integral": {"power": {"load": "hoist"}}}
        }
    })
}

#[test]
fn gradients_by_every_method() {
    for simulation in methods(0.6, 200) {
        let mut document = crane(&simulation);
        let mut paths: Vec<String> = ["stiffness", "dissipation", "width"]
            .iter()
            .flat_map(|key| ["hoist", "stay"].map(|load| format!("/loads/{load}/cable/{key}")))
            .collect();
        paths.extend(
            [
                "/loads/hoist/cable/length/table/values/1",
                "/loads/hoist/cable/length/table/values/2",
                "/loads/hoist/cable/points/0/point/0",
                "/loads/stay/cable/length",
                "/loads/stay/cable/points/0/point/0",
                "/loads/stay/cable/points/1/point/1",
                "/bodies/load/points/hook/1",
                "/bodies/load/mass",
            ]
            .map(String::from),
        );
        vary(&mut document, &paths);
        gradients_are_exact(&parsed(&document), &simulation);
    }
}

/// Without reductions, in another order, from the other end, and turned about the vertical axis.
#[test]
fn the_same_in_other_descriptions() {
    let document = crane(&json!({"duration": 0.6, "tolerance": 1e-10}));
    let reference = values(&document);
    let agree = |found: &[f64], what: &str| {
        for (a, b) in found.iter().zip(&reference) {
            assert!(
                (a - b).abs() < 1e-6 * b.abs().max(0.1),
                "{what}: {found:?} {reference:?}"
            );
        }
    };
    agree(&unlowered_values(&document), "without reductions");
    let other = reversed(&document, &["bodies", "loads"]);
    agree(&values(&other), "in another order");
    let mut backward = document.clone();
    for load in ["hoist", "stay"] {
        let points = &mut backward["loads"][load]["cable"]["points"];
        points.as_array_mut().expect("points").reverse();
    }
    agree(&values(&backward), "from the other end");
    let (c, s) = (0.6, 0.8);
    let about = -f64::atan2(s, c);
    let mut turned = document.clone();
    for (body, angle) in [("boom", 0.7), ("load", 0.0)] {
        turned["bodies"][body]["place"]["turn"] =
            json!({"sequence": "yzx", "angles": [about, angle, 0]});
    }
    turned["bodies"]["load"]["place"]["at"] = json!([1.5 * c, 0, 1.5 * s]);
    turned["joints"]["hinge"]["revolute"]["axis"] = json!([-s, 0, c]);
    for load in ["hoist", "stay"] {
        for point in turned["loads"][load]["cable"]["points"]
            .as_array_mut()
            .expect("points")
        {
            if point["body"] == "ground" {
                let at = |k: usize| point["point"][k].as_f64().expect("a number");
                point["point"] = json!([c * at(0), at(1), s * at(0)]);
            }
        }
    }
    let direction = [0.6 * c - 0.1 * s, 0.8, 0.6 * s + 0.1 * c];
    turned["functions"]["load"]["final"]["position"]["direction"] = json!(direction);
    agree(&values(&turned), "turned");
    // Millimetres and tonnes; feet and pounds.
    for units in [(1e3, 1e-3), (1.0 / 0.3048, 1.0 / 0.45359237)] {
        let mut file = document.clone();
        file["gravity"] = json!([0, -9.81, 0]);
        let reference = values(&file);
        let mut places = vec![
            ("/gravity", 1, 0),
            ("/bodies/boom/shape", 1, 0),
            ("/bodies/boom/mass", 0, 1),
            ("/bodies/boom/points", 1, 0),
            ("/bodies/load/shape", 1, 0),
            ("/bodies/load/mass", 0, 1),
            ("/bodies/load/points", 1, 0),
            ("/bodies/load/place/at", 1, 0),
            ("/loads/hoist/cable/length/table/values", 1, 0),
            ("/loads/stay/cable/length", 1, 0),
        ];
        for load in ["hoist", "stay"] {
            let path = |key: &str| &*format!("/loads/{load}/cable/{key}").leak();
            places.extend([
                (path("points"), 1, 0),
                (path("stiffness"), 0, 1),
                (path("dissipation"), -1, 0),
                (path("width"), 1, 0),
            ]);
        }
        let found = values(&in_units(&file, units, &places));
        let (metre, kilogram) = units;
        let newton = kilogram * metre;
        let scales = [metre, newton, metre, newton * metre, newton * metre];
        for ((found, scale), exact) in found.iter().zip(scales).zip(&reference) {
            near(
                found / scale,
                *exact,
                1e-6 * exact.abs().max(0.1),
                "in other units",
            );
        }
    }
}

/// A cable that is taut for a thousandth of the time is not missed: a ball flies past the end of its rope.
#[test]
fn no_jerk_is_missed_between_steps() {
    let file = json!({
        "version": 1, "name": "rope", "gravity": [0, 0, 0],
        "bodies": {"ball": {"shape": "point", "mass": 1, "place": {"at": [1, 0.3, 0]}, "velocity": {"linear": [20, 5, 0]}}},
        "loads": {"rope": {"cable": {"points": [{"body": "ball"}, ground(0.0, 0.0)], "length": 9, "stiffness": 1e6, "width": 0.01}}},
        "simulation": {"duration": 0.6},
        "functions": {"speed": {"final": {"speed": {"body": "ball"}}},
                      "distance": {"final": {"spring_length": {"load": "rope"}}}}
    });
    let motion = run(&file);
    near(
        motion.at.function(0).value,
        20.0_f64.hypot(5.0),
        1e-4,
        "speed",
    );
    assert!(value(&file, "distance") < 9.0);
}
