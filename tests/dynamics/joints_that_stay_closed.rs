//! Joints that an event has closed and that stay closed through the next one, in a plane of any position: the reductions turn their
//! axes, and the motion goes on as if the second event were none.

use super::phases::{simulated, whole};
use crate::reference::documents::problem;
use crate::reference::gradients::gradients_of_expressions_are_exact as gradients_are_exact;
use nalgebra::{Rotation3, Unit, Vector3};
use serde_json::Value;

/// An arm on a hinge with a plate welded to its end, and a block that a joint holds to `to` from 0.3 s on. An event at 0.6 s is a mark.
/// All of it is turned about `axis` by `angle`.
fn machine(kind: &str, to: &str, (axis, angle): ([f64; 3], f64), marked: bool) -> Value {
    let turn = Rotation3::from_axis_angle(&Unit::new_normalize(Vector3::from(axis)), angle);
    let at = |x: f64, y: f64, z: f64| {
        let own: [f64; 3] = (turn * Vector3::new(x, y, z)).into();
        json!(own)
    };
    let turn = json!({"axis": axis, "angle": angle});
    let body = |size: [f64; 3], mass: f64, place: Value, velocity: Value| json!({"shape": {"box": {"size": size}}, "mass": mass, "place": {"at": place, "turn": turn}, "velocity": velocity});
    let still = json!({"linear": [0, 0, 0]});
    let thrown = json!({"linear": at(0.2, 0.7, 0.0), "angular": at(0.0, 0.0, 1.5)});
    let place = json!({"between": ["block", to], "at": at(0.9, 0.1, 0.0)});
    let mut joint = place;
    if kind == "prismatic" {
        joint["axis"] = at(0.6, 0.8, 0.0);
    }
    let mut events = json!({"catch": {"when": {"time": 0.3}, "on": ["lock"]}});
    if marked {
        events["mark"] = json!({"when": {"time": 0.6}});
    }
    let position = |direction: Value| json!({"final": {"position": {"body": "block", "direction": direction}}});
    json!({
        "version": 1, "name": "caught", "gravity": at(1.0, -9.0, 0.0),
        "bodies": {
            "arm": body([1.0, 0.1, 0.2], 1.0, at(0.5, 0.0, 0.0), still.clone()),
            "plate": body([0.1, 0.4, 0.2], 0.5, at(1.0, 0.1, 0.0), still),
            "block": body([0.3, 0.2, 0.2], 2.0, at(1.2, 0.3, 0.0), thrown)
        },
        "joints": {
            "hinge": {"revolute": {"between": ["arm", "ground"], "at": at(0.0, 0.0, 0.0), "axis": at(0.0, 0.0, 1.0)}},
            "seam": {"weld": {"between": ["plate", "arm"], "at": at(1.0, 0.0, 0.0)}},
            "lock": {kind: joint}
        },
        "events": events,
        "simulation": {"duration": 0.9, "tolerance": 1e-11},
        "functions": {
            "x": position(at(1.0, 0.0, 0.0)),
            "y": position(at(0.0, 1.0, 0.0)),
            "turn": {"final": {"angle": {"joint": "hinge"}}},
            "moment": {"final": {"joint_moment": {"joint": "lock", "direction": at(0.0, 0.0, 1.0)}}}
        },
        "variables": {
            "mass": {"path": "/bodies/block/mass", "lower": 1, "upper": 4},
            "catch": {"path": "/events/catch/when/time", "lower": 0.2, "upper": 0.4}
        }
    })
}

fn values(document: &Value) -> Vec<f64> {
    let problem = problem(document);
    let at = simulated(&problem);
    whole(&problem).into_iter().map(|f| at.value(f)).collect()
}

const TURNS: [([f64; 3], f64); 3] = [
    ([1.0, 1.0, 1.0], 0.5),
    ([0.2, -1.0, 0.4], 2.0),
    ([0.045, 0.448, -0.893], 2.029),
];

#[test]
fn a_second_event_changes_nothing() {
    for kind in ["weld", "prismatic"] {
        for to in ["arm", "plate"] {
            let straight = ([0.0, 0.0, 1.0], 0.0);
            let expected = values(&machine(kind, to, straight, false));
            for turn in [straight].into_iter().chain(TURNS) {
                let found = values(&machine(kind, to, turn, true));
                for (found, expected) in found.iter().zip(&expected) {
                    assert!(
                        (found - expected).abs() < 1e-8 * (1.0 + expected.abs()),
                        "{kind} to {to}, {turn:?}: {found} {expected}"
                    );
                }
            }
        }
    }
}

#[test]
fn gradients_through_a_second_event_are_exact() {
    for kind in ["weld", "prismatic"] {
        for turn in TURNS {
            let context = json!([kind, turn.0, turn.1]);
            gradients_are_exact(&problem(&machine(kind, "plate", turn, true)), &context);
        }
    }
}
