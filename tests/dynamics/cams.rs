//! Cams: followers against drives with the same course, beads on curves with their energy and vibrations, starts, phases,
//! derivatives by every method, and the same in other descriptions.

use super::couplings::{close, turned};
use super::phases::{simulated, whole};
use crate::reference::documents::{
    methods, problem as parsed, reversed, unlowered_values, values, vary,
};
use crate::reference::gradients::{gradients_are_exact, gradients_of_expressions_are_exact};
use serde_json::Value;
use std::f64::consts::TAU;

fn block(mass: f64) -> Value {
    json!({"mass": mass, "inertia": {"xx": 0.02, "yy": 0.03, "zz": 0.025}})
}

/// A cam that a drive turns by a radian a second moves its follower as a drive with the same table in time does, with the same
/// force on the follower.
#[test]
fn a_follower_moves_as_by_a_drive() {
    let (at, lifts) = (
        [-1.0, 0.0, 0.5, 1.1, 1.6, 2.4],
        [0.3, 0.0, 0.05, 0.4, 0.45, 0.1],
    );
    for interpolation in ["spline", "monotone", "linear"] {
        let table = json!({"at": at, "values": lifts, "interpolation": interpolation});
        let mut file = json!({
            "version": 1, "name": "cam", "gravity": [0, 0, -9.81],
            "bodies": {"cam": block(2.0), "valve": block(0.4)},
            "joints": {
                "shaft": {"revolute": {"between": ["cam", "ground"], "at": [0, 0, 0], "axis": [0, 1, 0]}},
                "guide": {"prismatic": {"between": ["valve", "ground"], "at": [0, 0, 0], "axis": [0, 0, 1]}}
            },
            "couplings": {"lobe": {"cam": {"cam": {"turn": "shaft"}, "follower": {"slide": "guide"}, "profile": table}}},
            "drives": {"shaft": {"joint": "shaft", "turn": {"rate": 1}}},
            "simulation": {"duration": 1.9, "tolerance": 1e-10},
            "functions": {
                "lift": {"final": {"slide": {"joint": "guide"}}},
                "rate": {"final": {"velocity": {"body": "valve", "direction": [0, 0, 1]}}},
                "mean": {"integral": {"slide": {"joint": "guide"}}},
                "work": {"integral": {"square": {"coupling_reaction": {"coupling": "lobe", "on": "guide"}}}}
            }
        });
        let found = values(&file);
        file.as_object_mut().expect("a file").remove("couplings");
        file["drives"]["guide"] = json!({
            "joint": "guide",
            "slide": {"table": {"times": at, "values": lifts, "interpolation": interpolation}}
        });
        file["functions"]["work"] = json!({"integral": {"square": {"joint_force": {"joint": "guide", "axes": "joint", "direction": [0, 0, 1]}}}});
        for (found, exact) in found.iter().zip(values(&file)) {
            close(*found, exact, 1e-7, interpolation);
        }
    }
}

/// A bead on a curve in the plane of x and z: a carriage without inertia slides along x and carries the bead along z.
fn bead(simulation: Value) -> Value {
    json!({
        "version": 1, "name": "bead", "gravity": [0, 0, -9.81],
        "bodies": {
            "carriage": {"mass": 0.3, "inertia": {"xx": 0.01, "yy": 0.01, "zz": 0.01}},
            "bead": block(1.5)
        },
        "joints": {
            "along": {"prismatic": {"between": ["carriage", "ground"], "at": [0, 0, 0], "axis": [1, 0, 0],
                      "start": {"slide": {"displacement": 0.4, "rate": -0.3}}}},
            "up": {"prismatic": {"between": ["bead", "carriage"], "at": [0, 0, 0], "axis": [0, 0, 1]}}
        },
        "couplings": {"wire": {"cam": {
            "cam": {"slide": "along"}, "follower": {"slide": "up"},
            "profile": {"at": [-1.2, -0.8, -0.4, 0, 0.4, 0.8, 1.2], "values": [1.6, 0.64, 0.16, 0, 0.16, 0.64, 1.5]}
        }}},
        "simulation": simulation,
        "functions": {
            "x": {"final": {"slide": {"joint": "along"}}},
            "z": {"final": {"slide": {"joint": "up"}}},
            "rate": {"integral": {"square": {"velocity": {"body": "bead", "direction": [0, 0, 1]}}}},
            "force": {"ks": {"rho": 3, "of": {"coupling_reaction": {"coupling": "wire", "on": "up"}}}}
        }
    })
}

#[test]
fn beads_keep_their_energy_and_their_curve() {
    let mut file = bead(json!({"duration": 3, "tolerance": 1e-11}));
    file["functions"]["energy"] = json!({"final": {"energy": "total"}});
    file["functions"]["first"] = json!({"value": {"at": 0, "of": {"energy": "total"}}});
    file["functions"]["first x"] = json!({"value": {"at": 0, "of": {"slide": {"joint": "along"}}}});
    file["functions"]["first z"] = json!({"value": {"at": 0, "of": {"slide": {"joint": "up"}}}});
    file["functions"]["first rate"] =
        json!({"value": {"at": 0, "of": {"velocity": {"body": "bead", "direction": [0, 0, 1]}}}});
    let found = values(&file);
    close(found[4], found[5], 1e-9, "energy");
    close(found[6], 0.4, 1e-12, "the start");
    close(found[7], 0.16, 1e-12, "the height of the start");
    // The slope at a point is that of the parabola through its neighbours.
    close(found[8], -0.3 * (0.64 / 0.8), 1e-9, "the rate of the start");
    let radau = json!({"duration": 3, "tolerance": 1e-10, "method": {"radau": {"stages": 3}}});
    for (a, b) in found.iter().zip(values(&bead(radau))) {
        close(b, *a, 1e-6, "radau");
    }
}

/// About the bottom a bead with the carriage vibrates with the curvature of the curve: (m + M) ω² = M g f''.
#[test]
fn beads_rest_and_vibrate_in_the_valley() {
    let mut file = bead(Value::Null);
    file.as_object_mut().expect("a file").remove("simulation");
    file["analysis"] = json!("rest");
    file["joints"]["along"]["prismatic"]
        .as_object_mut()
        .expect("a joint")
        .remove("start");
    file["functions"] = json!({
        "x": {"final": {"slide": {"joint": "along"}}},
        "frequency": {"frequency": {"mode": 1}}
    });
    vary(
        &mut file,
        &[
            "/couplings/wire/cam/profile/values/2",
            "/bodies/bead/mass",
            "/bodies/carriage/mass",
        ]
        .map(String::from),
    );
    let found = values(&file);
    let square: f64 = 1.5 * 9.81 * 2.0 / 1.8;
    assert!(found[0].abs() < 1e-8, "{found:?}");
    close(found[1], square.sqrt() / TAU, 1e-7, "frequency");
    gradients_are_exact(&parsed(&file), &json!("rest"));
}

#[test]
fn gradients_by_every_method() {
    for simulation in methods(0.8, 120) {
        let mut file = bead(simulation.clone());
        let values = "/couplings/wire/cam/profile/values";
        vary(
            &mut file,
            &[
                format!("{values}/1"),
                format!("{values}/3"),
                format!("{values}/4"),
                "/bodies/bead/mass".into(),
                "/joints/along/prismatic/start/slide/displacement".into(),
                "/joints/along/prismatic/start/slide/rate".into(),
                "/gravity/2".into(),
            ],
        );
        file["variables"]["/gravity/2"] = json!({"path": "/gravity/2", "lower": -12, "upper": -5});
        gradients_are_exact(&parsed(&file), &simulation);
    }
}

/// A cam of turns: a planar crank whose angle moves another, over a turn and a half.
fn levers() -> Value {
    json!({
        "version": 1, "name": "levers", "gravity": [0, -3, 0],
        "bodies": {
            "crank": {"mass": 1, "centre_of_mass": [0.2, 0, 0], "inertia": {"xx": 0.1, "yy": 0.2, "zz": 0.2}},
            "lever": {"mass": 2, "centre_of_mass": [0.1, 0.1, 0], "inertia": {"xx": 0.1, "yy": 0.2, "zz": 0.2}, "place": {"at": [1, 0, 0]}}
        },
        "joints": {
            "crank": {"revolute": {"between": ["ground", "crank"], "at": [0, 0, 0], "axis": [0, 0, 1],
                      "start": {"turn": {"angle": 0.5, "rate": 9}}}},
            "lever": {"revolute": {"between": ["lever", "ground"], "at": [1, 0, 0], "axis": [0, 0, -1]}}
        },
        "couplings": {"link": {"cam": {
            "cam": {"turn": "crank"}, "follower": {"turn": "lever"},
            "profile": {"at": [-1, 0, 1.5, 3, 5, 7, 9, 12], "values": [0.2, 0, 0.8, 1.1, 4.2, 4.4, 6.8, 7]}
        }}},
        "simulation": {"duration": 0.9, "tolerance": 1e-10},
        "functions": {
            "crank": {"final": {"angle": {"joint": "crank"}}},
            "lever": {"final": {"angle": {"joint": "lever"}}},
            "energy": {"integral": {"energy": "kinetic"}},
            "moment": {"integral": {"square": {"coupling_reaction": {"coupling": "link", "on": "lever"}}}}
        }
    })
}

#[test]
fn the_same_in_other_descriptions() {
    let (c, s) = (0.8, 0.6);
    let oblique = [
        [c, -s * 0.8, s * 0.6],
        [s, c * 0.8, -c * 0.6],
        [0.0, 0.6, 0.8],
    ];
    for file in [bead(json!({"duration": 0.9, "tolerance": 1e-10})), levers()] {
        let reference = values(&file);
        let agree = |found: &[f64], what: &str| {
            for (a, b) in found.iter().zip(&reference) {
                close(*a, *b, 1e-6, what);
            }
        };
        let mut free = file.clone();
        if free["functions"].get("rate").is_some() {
            let across = json!(oblique.map(|row| row[2]));
            free["functions"]["rate"]["integral"]["square"]["velocity"]["direction"] = across;
            let mut moved = turned(&file, &oblique);
            moved["functions"]["rate"] = free["functions"]["rate"].clone();
            agree(&values(&moved), "turned");
        } else {
            agree(&values(&turned(&file, &oblique)), "turned");
        }
        agree(
            &values(&reversed(&file, &["bodies", "joints"])),
            "in another order",
        );
        agree(&unlowered_values(&file), "without reductions");
    }
    let found = values(&levers());
    assert!(found[0] > 7.0 && found[1] > 4.0, "{found:?}");
}

/// Followers start where their cams put them, led by starts and drives of many turns, through one cam and two.
#[test]
fn followers_start_where_their_cams_are() {
    let profile =
        json!({"at": [-20, -10, -4, 0, 4, 8, 14], "values": [-20, -10, -4, 0, 4.5, 8, 14]});
    let mut file = levers();
    file["couplings"]["link"]["cam"]["profile"] = profile.clone();
    file["bodies"]["third"] = file["bodies"]["lever"].clone();
    file["bodies"]["third"]["place"] = json!({"at": [2, 0, 0]});
    file["joints"]["third"] =
        json!({"revolute": {"between": ["third", "ground"], "at": [2, 0, 0], "axis": [0, 0, 1]}});
    file["couplings"]["more"] = json!({"cam": {"cam": {"turn": "lever"}, "follower": {"turn": "third"}, "profile": profile}});
    file["simulation"]["duration"] = json!(0.001);
    let at_start = |joint: &str| json!({"value": {"at": 0, "of": {"angle": {"joint": joint}}}});
    file["functions"] =
        json!({"a": at_start("crank"), "b": at_start("lever"), "c": at_start("third")});
    for start in [0.0, 4.0, 8.0, -10.0] {
        let expected = if start == 4.0 { 4.5 } else { start };
        for driven in [false, true] {
            let mut own = file.clone();
            let joint = own["joints"]["crank"]["revolute"]
                .as_object_mut()
                .expect("a joint");
            joint.remove("start");
            match driven {
                true => {
                    own["drives"] =
                        json!({"m": {"joint": "crank", "turn": {"polynomial": [start, 1]}}})
                }
                false => {
                    own["joints"]["crank"]["revolute"]["start"] = json!({"turn": {"angle": start}})
                }
            }
            let found = values(&own);
            assert!((found[0] - start).abs() < 1e-9, "{start} {found:?}");
            assert!((found[1] - expected).abs() < 1e-9, "{start} {found:?}");
            assert!((found[2] - expected).abs() < 0.5, "{start} {found:?}");
        }
    }
}

/// Angles of cams are counted through events, whose derivatives are exact.
#[test]
fn cams_go_on_through_events() {
    let undivided = values(&levers());
    let mut file = levers();
    file["bodies"]["weight"] = block(1.0);
    file["joints"]["hook"] = json!({"weld": {"between": ["weight", "ground"], "at": [0, 0, 0]}});
    file["loads"] =
        json!({"push": {"force": {"body": "weight", "direction": [1, 0, 0], "magnitude": 1}}});
    file["events"] = json!({"nothing": {"when": {"time": 0.5}, "off": ["push"]}});
    let divided = parsed(&file);
    let phases = simulated(&divided);
    for (f, exact) in whole(&divided).into_iter().zip(&undivided) {
        close(phases.value(f), *exact, 1e-7, "two phases");
    }
    vary(
        &mut file,
        &[
            "/couplings/link/cam/profile/values/3",
            "/couplings/link/cam/profile/values/5",
            "/bodies/crank/mass",
        ]
        .map(String::from),
    );
    gradients_of_expressions_are_exact(&parsed(&file), &json!("events"));
}

/// Cams of parts have the joints of their part.
#[test]
fn parts_have_cams() {
    let file = levers();
    let part = json!({
        "bodies": file["bodies"], "joints": file["joints"], "couplings": file["couplings"]
    });
    let document = json!({
        "version": 1, "name": "parts", "gravity": [0, -3, 0],
        "parts": {"pair": part},
        "use": {"left": {"part": "pair"}, "right": {"part": "pair", "at": [0, 0, 2]}},
        "simulation": file["simulation"],
        "functions": {"left": {"final": {"angle": {"joint": "left/lever"}}}, "right": {"final": {"angle": {"joint": "right/lever"}}}}
    });
    let exact = values(&file)[1];
    for found in values(&document) {
        close(found, exact, 1e-7, "a part");
    }
}

#[test]
fn bad_cams_are_told() {
    let told = |pointer: &str, value: Value, words: &[&str]| {
        let mut file = bead(json!({"duration": 0.1}));
        *file.pointer_mut(pointer).expect("a place") = value;
        let text = file.to_string();
        let found = flexbody_problem::Problem::parse(&text, "bead.json", &[]).expect_err("a fault");
        let found = found.to_string();
        for word in words {
            assert!(found.contains(word), "{found}");
        }
    };
    let cam = "/couplings/wire/cam";
    told(
        &format!("{cam}/cam"),
        json!({"slide": "alongs"}),
        &["/couplings/wire/cam/cam/slide", "\"alongs\"", "along"],
    );
    told(
        &format!("{cam}/cam"),
        json!({"turn": "along"}),
        &["/couplings/wire/cam/cam/turn", "prismatic"],
    );
    told(
        &format!("{cam}/follower"),
        json!({"slide": "along"}),
        &["follower", "another motion"],
    );
    let mut file = bead(json!({"duration": 0.1}));
    file["joints"]["up"]["prismatic"]["start"] = json!({"slide": {"displacement": 0.2}});
    let found = flexbody_problem::Problem::parse(&file.to_string(), "bead.json", &[]);
    let found = found.expect_err("a fault").to_string();
    assert!(
        found.contains("a follower with a start of its own"),
        "{found}"
    );
    told(
        &format!("{cam}/profile/at/2"),
        json!(-0.9),
        &["at that increase"],
    );
    told(
        &format!("{cam}/profile/values"),
        json!([1, 2]),
        &["7 at and 2 values"],
    );
}
