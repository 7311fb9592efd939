//! Friction of contacts that falls with slip: the way of a block that stops, stick and slip of a block on a spring, derivatives by
//! every method.

use super::couplings::close;
use crate::reference::documents::{faults_say, methods, problem as parsed, run, values, vary};
use crate::reference::gradients::gradients_are_exact;
use serde_json::Value;

const STIFFNESS: f64 = 1e4;

/// A block of 2 kg on the floor under 10 m/s².
fn block(friction: Value, simulation: Value) -> Value {
    json!({
        "version": 1, "name": "block", "gravity": [0, -10, 0],
        "bodies": {"block": {"shape": "point", "mass": 2, "place": {"at": [0, -20.0 / STIFFNESS, 0]}, "velocity": {"linear": [1, 0, 0]}}},
        "loads": {"floor": {"contact": {"between": ["block", "ground"], "at": {"a": [0, 0, 0], "b": [0, 0, 0]},
                                        "surface": {"plane": {"normal": [0, 1, 0]}}, "stiffness": STIFFNESS, "width": 1e-4,
                                        "friction": friction}}},
        "simulation": simulation,
        "functions": {"x": {"final": {"position": {"body": "block", "direction": [1, 0, 0]}}},
                      "friction": {"integral": {"contact_friction": {"load": "floor"}}},
                      "loss": {"integral": {"slip_power": {"load": "floor"}}}}
    })
}

/// The way of a block that stops from 1 m/s is ∫ v dv / (μ(v) g), with the rooted friction; a falling friction stops it earlier.
#[test]
fn a_block_stops_by_the_integral_of_its_friction() {
    let (low, high, speed, width) = (0.3_f64, 0.6_f64, 0.2_f64, 0.01_f64);
    let friction = json!({"coefficient": low, "width": width, "stribeck": {"coefficient": high, "speed": speed}});
    let file = block(friction, json!({"duration": 1, "tolerance": 1e-11}));
    let found = values(&file)[0];
    let n = 200_000;
    let of = |v: f64| {
        let mu = low + (high - low) * (-(v / speed).powi(2)).exp();
        (v * v + width * width).sqrt() / (10.0 * mu)
    };
    let step = 1.0 / f64::from(n);
    let way: f64 = (0..n).map(|k| of((f64::from(k) + 0.5) * step) * step).sum();
    close(found, way, 1e-7, "the way");
    // Friction takes all of the energy.
    let loss = values(&file)[2];
    close(loss, 1.0, 1e-7, "the energy");
    let plain = values(&block(
        json!({"coefficient": low, "width": width}),
        json!({"duration": 1, "tolerance": 1e-11}),
    ))[0];
    assert!(found < plain - 1e-3, "{found} {plain}");
}

/// A block that a moving end pulls by a spring sticks until the spring pulls with μ_s m g, slips and sticks again: the largest tension is
/// that of the static friction, and slips are sudden.
#[test]
fn a_pulled_block_sticks_and_slips() {
    let (low, high) = (0.2, 0.5);
    let mut file = block(
        json!({"coefficient": low, "width": 1e-3, "stribeck": {"coefficient": high, "speed": 0.02}}),
        json!({"duration": 3, "tolerance": 1e-7, "method": {"radau": {"stages": 3}}}),
    );
    file["bodies"]["block"]["velocity"] = json!({"linear": [0, 0, 0]});
    file["bodies"]["hand"] =
        json!({"shape": {"sphere": {"radius": 0.05}}, "mass": 1, "place": {"at": [0.5, 0, 0]}});
    file["joints"] = json!({"guide": {"prismatic": {"between": ["hand", "ground"], "at": [0.5, 0, 0], "axis": [1, 0, 0]}}});
    file["drives"] = json!({"pull": {"joint": "guide", "slide": {"rate": 0.1}}});
    file["loads"]["spring"] = json!({"spring": {"between": ["hand", "block"], "at": {"a": [0, 0, 0], "b": [0, 0, 0]}, "rest_length": 0.5,
                                                "stiffness": 100}});
    file["functions"] = json!({
        "most": {"ks": {"rho": 500, "of": {"spring_force": {"load": "spring"}}}},
        "fast": {"ks": {"rho": 500, "of": {"speed": {"body": "block"}}}}
    });
    let motion = run(&file);
    let [most, fast] = [0, 1].map(|k| motion.at.function(k).value);
    assert!((most - high * 20.0).abs() < 0.03 * high * 20.0, "{most}");
    // It sticks for about a second each: the slips are much faster than the hand.
    assert!(fast > 0.25, "{fast}");
}

#[test]
fn gradients_by_every_method() {
    for simulation in methods(0.3, 300) {
        let mut file = block(
            json!({"coefficient": 0.3, "width": 0.05, "stribeck": {"coefficient": 0.5, "speed": 0.4}}),
            simulation.clone(),
        );
        vary(
            &mut file,
            &[
                "coefficient",
                "width",
                "stribeck/coefficient",
                "stribeck/speed",
            ]
            .map(|key| format!("/loads/floor/contact/friction/{key}")),
        );
        gradients_are_exact(&parsed(&file), &simulation);
    }
}

#[test]
fn a_static_coefficient_below_the_sliding_one_is_told() {
    let friction =
        json!({"coefficient": 0.3, "width": 0.05, "stribeck": {"coefficient": 0.2, "speed": 0.4}});
    let file = block(friction, json!({"duration": 0.1}));
    let place = "/loads/floor/contact/friction/stribeck/coefficient";
    faults_say(&file, &[place, "at least the sliding"]);
}
