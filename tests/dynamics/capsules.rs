//! Contacts of capsules: on planes by both ends, on spheres, capsules and boxes where the axis is nearest; derivatives by every method
//! and the same in other descriptions.

use super::couplings::{close, turned};
use super::stops::rebound;
use crate::reference::documents::{
    methods, problem as parsed, reversed, unlowered_values, values, vary,
};
use crate::reference::gradients::gradients_are_exact;
use serde_json::Value;

const LAW: &str = r#"{"stiffness": 2000, "dissipation": 0.2, "width": 0.01, "friction": {"coefficient": 0.4, "width": 0.05}}"#;

fn contact(between: [&str; 2], own: Value) -> Value {
    let mut all: Value = serde_json::from_str(LAW).expect("a law");
    let map = all.as_object_mut().expect("an object");
    map.insert("between".into(), json!(between));
    map.insert("at".into(), json!({"a": [0, 0, 0], "b": [0, 0, 0]}));
    map.extend(own.as_object().expect("an object").clone());
    json!({"contact": all})
}

/// A capsule that falls obliquely.
fn rod(loads: Value, simulation: Value) -> Value {
    json!({
        "version": 1, "name": "rod", "gravity": [0, -9.81, 0],
        "bodies": {"rod": {"shape": {"rod": {"length": 0.8, "radius": 0.1}}, "mass": 2, "place": {"at": [0, 0.5, 0]},
                           "velocity": {"linear": [0.3, -1, 0.1], "angular": [0.2, 0.5, 1]}}},
        "loads": loads,
        "simulation": simulation,
        "functions": {
            "x": {"final": {"position": {"body": "rod", "point": [0.3, 0.1, 0.2], "direction": [0.3, 0.5, 0.8]}}},
            "spin": {"final": {"angular_velocity": {"body": "rod", "direction": [0.2, 0.5, 0.7]}}},
            "energy": {"final": {"energy": "total"}},
            "depth": {"ks": {"rho": 300, "of": {"penetration": {"load": "ground"}}}},
            "force": {"integral": {"contact_force": {"load": "ground"}}},
            "friction": {"integral": {"contact_friction": {"load": "ground"}}},
            "work": {"integral": {"power": {"load": "ground"}}},
            "loss": {"integral": {"slip_power": {"load": "ground"}}}
        }
    })
}

/// On a plane a capsule is two spheres.
#[test]
fn a_capsule_on_a_plane_is_two_spheres() {
    let simulation = json!({"duration": 0.7, "tolerance": 1e-10});
    let plane = json!({"plane": {"normal": [0.1, 1, 0]}});
    let one = contact(
        ["rod", "ground"],
        json!({"radius": 0.1, "half": [0.3, 0, 0], "surface": plane}),
    );
    let end = |x: f64| {
        contact(
            ["rod", "ground"],
            json!({"radius": 0.1, "at": {"a": [x, 0, 0], "b": [0, 0, 0]}, "surface": plane}),
        )
    };
    let found = values(&rod(json!({"ground": one}), simulation.clone()));
    let two = values(&rod(
        json!({"ground": end(0.3), "other": end(-0.3)}),
        simulation.clone(),
    ));
    let other = values(&rod(
        json!({"ground": end(-0.3), "other": end(0.3)}),
        simulation,
    ));
    for k in 0..3 {
        close(found[k], two[k], 1e-9, "the motion");
    }
    for k in 4..8 {
        assert!(two[k] != 0.0 && other[k] != 0.0, "{two:?} {other:?}");
        // The integrals follow a tolerance of their own.
        close(found[k], two[k] + other[k], 1e-6, "the sum of both ends");
    }
    assert!(found[3] >= two[3].max(other[3]) - 1e-9, "{found:?} {two:?}");
}

/// Crossed capsules rebound along the normal by the implicit formula: between their ends, at an end, from a sphere and from the edge of
/// a box. Nothing turns, as the force goes through the centre.
#[test]
fn rebounds_follow_the_implicit_formula() {
    let surfaces = [
        json!({"capsule": {"half": [0, 0, 0.4], "radius": 0.2}}),
        json!({"sphere": {"radius": 0.2}}),
        json!({"box": {"size": [2, 0.4, 3], "radius": 0.05}}),
    ];
    for surface in surfaces {
        for dissipation in [0.0, 0.3] {
            let file = json!({
                "version": 1, "name": "crossed", "gravity": [0, 0, 0],
                "bodies": {"rod": {"shape": {"rod": {"length": 0.8, "radius": 0.1}}, "mass": 2, "place": {"at": [0, 0.5, 0]},
                                   "velocity": {"linear": [0, -2, 0]}}},
                "loads": {"hit": contact(["rod", "ground"], json!({
                    "radius": 0.1, "half": [0.3, 0, 0], "surface": surface, "stiffness": 1e5,
                    "dissipation": dissipation, "width": 1e-3}))},
                "simulation": {"duration": 0.4, "tolerance": 1e-10},
                "functions": {
                    "back": {"final": {"velocity": {"body": "rod", "direction": [0, 1, 0]}}},
                    "speed": {"final": {"speed": {"body": "rod"}}},
                    "energy": {"final": {"energy": "kinetic"}}
                }
            });
            let exact = rebound(2.0, dissipation);
            let found = values(&file);
            close(found[0], exact, 1e-6, "rebound");
            close(found[1], exact, 1e-6, "speed");
            close(found[2], exact * exact, 1e-6, "no spin");
        }
    }
}

/// A tilted capsule that a guide lets fall on a box without slip comes back with its speed, whatever the friction.
#[test]
fn friction_takes_nothing_without_slip() {
    for mu in [0.0, 1.0] {
        let found = values(&json!({
            "version": 1, "name": "drop", "gravity": [0, 0, 0],
            "bodies": {"rod": {"shape": {"rod": {"length": 0.8, "radius": 0.1}}, "mass": 1, "place": {"at": [0, 0.8, 0]},
                               "velocity": {"linear": [0, -2, 0]}}},
            "joints": {"guide": {"prismatic": {"between": ["rod", "ground"], "at": [0, 0.8, 0], "axis": [0, 1, 0]}}},
            "loads": {"hit": contact(["rod", "ground"], json!({
                "radius": 0.1, "half": [0.3, 0.2, 0], "surface": {"box": {"size": [2, 0.4, 2], "radius": 0.01}}, "stiffness": 1e5,
                "dissipation": 0, "width": 1e-2, "friction": {"coefficient": mu, "width": 1e-3}}))},
            "simulation": {"duration": 0.4, "tolerance": 1e-9},
            "functions": {
                "back": {"final": {"velocity": {"body": "rod", "direction": [0, 1, 0]}}},
                "loss": {"integral": {"slip_power": {"load": "hit"}}}
            }
        }));
        close(found[0], 2.0, 1e-6, "rebound");
        assert!(found[1].abs() < 1e-9, "{found:?}");
    }
}

/// A capsule against a sphere is the sphere against the capsule.
#[test]
fn sides_change() {
    let bodies = json!({
        "rod": {"shape": {"rod": {"length": 0.8, "radius": 0.1}}, "mass": 2, "place": {"at": [0, 0.5, 0]},
                "velocity": {"linear": [0.3, -1, 0.1], "angular": [0.2, 0.5, 1]}},
        "ball": {"shape": {"sphere": {"radius": 0.15}}, "mass": 1, "place": {"at": [0.2, 0.1, 0.05]}, "velocity": {"angular": [1, 2, 3]}}
    });
    let file = |load: Value| {
        let mut file = rod(
            json!({"ground": load}),
            json!({"duration": 0.5, "tolerance": 1e-11}),
        );
        file["bodies"] = bodies.clone();
        file["gravity"] = json!([0, 0, 0]);
        file
    };
    let one = values(&file(contact(
        ["rod", "ball"],
        json!({"radius": 0.1, "half": [0.3, 0, 0], "surface": {"sphere": {"radius": 0.15}}}),
    )));
    let other = values(&file(contact(
        ["ball", "rod"],
        json!({"radius": 0.15, "surface": {"capsule": {"half": [0.3, 0, 0], "radius": 0.1}}}),
    )));
    assert!(one[4] > 0.1, "{one:?}");
    for (a, b) in one.iter().zip(&other) {
        close(*a, *b, 1e-8, "the sides");
    }
}

/// A rod that falls on a rail, a free box and a ball.
fn heap(simulation: Value) -> Value {
    let mut file = rod(
        json!({
            "ground": contact(["rod", "ground"], json!({
                "radius": 0.1, "half": [0.3, 0.05, 0], "surface": {"capsule": {"half": [0.2, 0.03, 0.6], "radius": 0.05}},
                "at": {"a": [0, 0, 0], "b": [0.1, 0.25, 0]}})),
            "block": contact(["rod", "box"], json!({
                "radius": 0.1, "half": [0.3, 0.05, 0], "surface": {"box": {"size": [0.4, 0.3, 0.5], "radius": 0.02}}})),
            "stone": contact(["rod", "ball"], json!({
                "radius": 0.1, "half": [0.3, 0.05, 0], "surface": {"sphere": {"radius": 0.1}}})),
            "floor": contact(["rod", "ground"], json!({
                "radius": 0.1, "half": [0.3, 0.05, 0], "surface": {"plane": {"normal": [0, 1, 0.1]}}}))
        }),
        simulation,
    );
    file["bodies"]["box"] = json!({"shape": {"box": {"size": [0.4, 0.3, 0.5]}}, "mass": 1.5, "place": {"at": [-0.15, 0.22, 0.1],
                                   "turn": {"axis": [1, 0.3, 0.2], "angle": 0.4}}, "velocity": {"linear": [0, 1, 0]}});
    file["bodies"]["ball"] = json!({"shape": {"sphere": {"radius": 0.1}}, "mass": 1, "place": {"at": [0.25, 0.75, 0.05]},
                                    "velocity": {"linear": [0, -3, 0], "angular": [1, 2, 3]}});
    file
}

#[test]
fn gradients_by_every_method() {
    for simulation in methods(0.3, 300) {
        let mut file = heap(simulation.clone());
        vary(
            &mut file,
            &[
                "/loads/ground/contact/half/0".into(),
                "/loads/ground/contact/half/1".into(),
                "/loads/ground/contact/radius".into(),
                "/loads/ground/contact/surface/capsule/half/1".into(),
                "/loads/ground/contact/at/b/0".into(),
                "/loads/block/contact/half/0".into(),
                "/loads/block/contact/surface/box/size/1".into(),
                "/loads/stone/contact/half/1".into(),
                "/loads/floor/contact/half/1".into(),
                "/loads/floor/contact/radius".into(),
                "/bodies/rod/mass".into(),
            ],
        );
        gradients_are_exact(&parsed(&file), &simulation);
    }
}

#[test]
fn the_same_in_other_descriptions() {
    let oblique = [[0.8, -0.48, 0.36], [0.6, 0.64, -0.48], [0.0, 0.6, 0.8]];
    let apply = |x: &Value| {
        let x: Vec<f64> = x
            .as_array()
            .expect("a vector")
            .iter()
            .filter_map(Value::as_f64)
            .collect();
        json!(oblique.map(|row| row.iter().zip(&x).map(|(a, b)| a * b).sum::<f64>()))
    };
    let mut file = heap(json!({"duration": 0.3, "tolerance": 1e-10}));
    file["bodies"]["box"]["place"] = json!({"at": [-0.15, 0.22, 0.1]});
    file["loads"]
        .as_object_mut()
        .expect("loads")
        .remove("block");
    let reference = values(&file);
    let agree = |found: &[f64], what: &str| {
        for (a, b) in found.iter().zip(&reference) {
            assert!(
                (a - b).abs() < 2e-6 * b.abs().max(0.1),
                "{what}: {found:?} {reference:?}"
            );
        }
    };
    let mut other = turned(&file, &oblique);
    for body in ["rod", "box", "ball"] {
        for key in ["linear", "angular"] {
            let own = file["bodies"][body]["velocity"][key].clone();
            if own.is_array() {
                other["bodies"][body]["velocity"][key] = apply(&own);
            }
        }
    }
    for load in ["ground", "stone", "floor"] {
        let (from, to) = (
            &file["loads"][load]["contact"],
            &mut other["loads"][load]["contact"],
        );
        to["half"] = apply(&from["half"]);
        to["at"]["a"] = from["at"]["a"].clone();
    }
    for pointer in [
        "/loads/ground/contact/surface/capsule/half",
        "/loads/floor/contact/surface/plane/normal",
    ] {
        let own = file.pointer(pointer).expect("a vector");
        *other.pointer_mut(pointer).expect("a vector") = apply(own);
    }
    agree(&values(&other), "turned");
    agree(&values(&reversed(&file, &["bodies"])), "in another order");
    agree(&unlowered_values(&file), "without reductions");
}

/// A capsule that lies along another touches in the middle, and does not fall over as its place of contact jumps.
#[test]
fn parallel_capsules_touch_smoothly() {
    let simulation = json!({"duration": 0.5, "tolerance": 1e-8});
    let mut file = rod(
        json!({"ground": contact(["rod", "ground"], json!({
            "radius": 0.1, "half": [0.3, 0, 0], "surface": {"capsule": {"half": [0.5, 0, 0], "radius": 0.1}}}))}),
        simulation,
    );
    file["bodies"]["rod"]["place"] = json!({"at": [0, 0.195, 0]});
    file["bodies"]["rod"]["velocity"] = json!({"angular": [0, 0, 1e-3]});
    file["functions"] = json!({
        "x": {"final": {"position": {"body": "rod", "direction": [1, 0, 0]}}},
        "z": {"final": {"position": {"body": "rod", "direction": [0, 0, 1]}}},
        "spin": {"final": {"angular_velocity": {"body": "rod", "direction": [0, 0, 1]}}}
    });
    let found = values(&file);
    assert!(found[0].abs() < 1e-3 && found[1].abs() < 1e-9, "{found:?}");
    assert!(found[2].abs() < 0.1, "{found:?}");
}
