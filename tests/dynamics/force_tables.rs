//! Springs and dampers by tables: motions in closed form, energy, equality with numbers, derivatives by every method, families.

use crate::reference::documents::{
    in_units, methods, problem as parsed, reversed, unlowered_values, values, vary,
};
use crate::reference::gradients::gradients_are_exact;
use serde_json::Value;
use std::f64::consts::PI;

const INTERPOLATIONS: [&str; 3] = ["linear", "monotone", "spline"];

/// A body of 2 kg on a rail along x with a load, without gravity.
fn slider(load: &Value, rate: f64, duration: f64, tolerance: f64) -> Value {
    json!({
        "version": 1, "name": "table", "gravity": [0, 0, 0],
        "bodies": {"body": {"mass": 2, "inertia": {"xx": 2, "yy": 2, "zz": 2},
                            "velocity": {"linear": [rate, 0, 0]}}},
        "joints": {"rail": {"prismatic": {"between": ["body", "ground"], "at": [0, 0, 0], "axis": [1, 0, 0]}}},
        "loads": {"load": load},
        "simulation": {"duration": duration, "tolerance": tolerance},
        "functions": {
            "x": {"final": {"position": {"body": "body", "direction": [1, 0, 0]}}},
            "rate": {"final": {"velocity": {"body": "body", "direction": [1, 0, 0]}}},
            "energy": {"final": {"energy": "total"}}
        }
    })
}

fn spring(table: &Value) -> Value {
    json!({"spring": {"between": ["body", "ground"], "at": {"a": [0, 0, 0], "b": [-1, 0, 0]}, "rest_length": 1,
                      "table": table}})
}

fn near(found: f64, exact: f64, tolerance: f64, what: &str) {
    assert!(
        (found - exact).abs() <= tolerance,
        "{what}: {found} {exact}"
    );
}

/// A spring of 200 N/m in tension and 800 N/m in pressure: two half periods π √(m/k), also beyond the table.
#[test]
fn a_spring_with_two_stiffnesses_has_two_half_periods() {
    let (soft, hard) = (10.0_f64, 20.0_f64);
    let period = PI / soft + PI / hard;
    let table =
        json!({"places": [-0.02, 0, 0.03], "forces": [-16, 0, 6], "interpolation": "linear"});
    // Half the amplitude of the first half, in the second.
    for (time, x, rate) in [
        (0.5 * PI / soft, 0.1, 0.0),
        (PI / soft, 0.0, -1.0),
        (PI / soft + 0.5 * PI / hard, -0.05, 0.0),
        (period, 0.0, 1.0),
    ] {
        let found = values(&slider(&spring(&table), 1.0, time, 1e-10));
        near(found[0], x, 1e-8, "x");
        near(found[1], rate, 1e-6, "rate");
        // An error of the rate r changes m r²/2 by m r times itself.
        near(found[2], 1.0, 2e-6, "energy");
    }
}

/// Tables on a straight line are that line, whatever the interpolation; a stiffness beside them adds to it.
#[test]
fn straight_tables_are_numbers() {
    let number = json!({"spring": {"between": ["body", "ground"], "at": {"a": [0, 0, 0], "b": [-1, 0, 0]},
                                   "rest_length": 1, "stiffness": 300, "damping": 4}});
    let exact = values(&slider(&number, 1.0, 0.7, 1e-11));
    for interpolation in INTERPOLATIONS {
        let line = |slope: f64| {
            let places = [-0.04, -0.01, 0.0, 0.02, 0.05];
            json!({"places": places, "forces": places.map(|x| slope * x), "interpolation": interpolation})
        };
        let mut load = spring(&line(250.0));
        load["spring"]["stiffness"] = json!(50);
        load["spring"]["damping_table"] = line(3.0);
        load["spring"]["damping"] = json!(1);
        for (found, exact) in values(&slider(&load, 1.0, 0.7, 1e-11)).iter().zip(&exact) {
            near(*found, *exact, 1e-9, interpolation);
        }
    }
    let number = json!({"damping": {"joint": "rail", "coefficient": 3}});
    let table = json!({"damping": {"joint": "rail", "coefficient": 1,
                                   "table": {"places": [-0.1, 0, 0.3], "forces": [-0.2, 0, 0.6]}}});
    let found = [number, table].map(|load| values(&slider(&load, 1.0, 0.7, 1e-11)));
    near(found[1][0], found[0][0], 1e-9, "damping");
    near(
        found[0][1],
        (-3.0 * 0.7 / 2.0_f64).exp(),
        1e-9,
        "the rate of a damped body",
    );
}

/// A body falls on a damper of the force of a hinge in its table: its terminal velocity is where that is its weight.
#[test]
fn a_damper_sets_the_terminal_velocity() {
    let table = json!({"places": [0, 1, 3], "forces": [0, 5, 35], "interpolation": "linear"});
    let load = json!({"damping": {"joint": "rail", "table": table}});
    let mut file = slider(&load, 0.0, 12.0, 1e-10);
    file["gravity"] = json!([10, 0, 0]);
    near(values(&file)[1], 2.0, 1e-8, "terminal velocity");
}

/// Undamped springs by tables keep the energy.
#[test]
fn energy_is_kept() {
    for interpolation in INTERPOLATIONS {
        let table = json!({"places": [-0.3, -0.1, 0, 0.1, 0.25], "forces": [-90, -12, 0, 9, 60],
                           "interpolation": interpolation});
        for time in [0.3, 1.1, 4.0] {
            let found = values(&slider(&spring(&table), 1.5, time, 1e-10));
            near(found[2], 2.25, 1e-6, interpolation);
        }
    }
}

/// A pendulum with a spring and a torsion spring, with tables of all kinds.
fn machine(simulation: &Value, interpolation: &str) -> Value {
    let table = |places: [f64; 4], forces: [f64; 4]| json!({"places": places, "forces": forces, "interpolation": interpolation});
    json!({
        "version": 1, "name": "machine",
        "bodies": {
            "slider": {"shape": {"box": {"size": [0.2, 0.1, 0.1]}}, "mass": 2, "velocity": {"linear": [0.4, 0, 0]}},
            "arm": {"shape": {"rod": {"length": 1, "radius": 0.02}}, "mass": 1, "points": {"root": [-0.5, 0, 0], "tip": [0.5, 0, 0]},
                    "place": {"put": "root", "turn": {"axis": [0, 0, 1], "angle": -0.9}}}
        },
        "joints": {
            "rail": {"prismatic": {"between": ["slider", "ground"], "at": [0, 0, 0], "axis": [1, 0, 0]}},
            "hinge": {"revolute": {"between": ["arm", "slider"], "at": [0, 0, 0], "axis": [0, 0, 1]}}
        },
        "loads": {
            "spring": {"spring": {"between": ["arm", "ground"], "at": {"a": "tip", "b": [0.9, 0.3, 0]}, "rest_length": 0.8,
                                  "table": table([-0.3, 0.0, 0.2, 0.6], [-9.0, 0.0, 9.0, 20.0]),
                                  "damping_table": table([-1.0, 0.0, 0.5, 1.5], [-1.0, 0.0, 0.2, 1.4])}},
            "torsion": {"torsion_spring": {"joint": "hinge", "rest_angle": 0.1, "stiffness": 1,
                                           "table": table([-1.0, -0.2, 0.1, 1.0], [-4.0, -0.6, 0.2, 7.0]),
                                           "damping_table": table([-1.0, 0.0, 0.8, 2.0], [-0.3, 0.0, 0.1, 0.9])}},
            "damper": {"damping": {"joint": "rail", "table": table([-1.0, 0.0, 0.3, 0.9], [-2.0, 0.0, 0.2, 1.4])}}
        },
        "simulation": simulation,
        "functions": {
            "tip": {"final": {"position": {"body": "arm", "point": "tip", "direction": [0.6, 0.8, 0]}}},
            "rate": {"final": {"velocity": {"body": "slider", "direction": [1, 0, 0]}}},
            "force": {"integral": {"spring_force": {"load": "spring"}}},
            "torque": {"integral": {"spring_torque": {"load": "torsion"}}},
            "energy": {"integral": {"energy": "total"}},
            "power": {"integral": {"power": {"load": "damper"}}}
        }
    })
}

#[test]
fn gradients_by_every_method() {
    for (k, simulation) in methods(0.6, 150).into_iter().enumerate() {
        let mut document = machine(&simulation, INTERPOLATIONS[k % 3]);
        let mut paths = Vec::new();
        for (load, kind, keys) in [
            ("spring", "spring", &["table", "damping_table"][..]),
            ("torsion", "torsion_spring", &["table", "damping_table"]),
            ("damper", "damping", &["table"]),
        ] {
            for key in keys {
                let path = |i: usize| format!("/loads/{load}/{kind}/{key}/forces/{i}");
                paths.extend([0, 2, 3].map(path));
            }
        }
        paths.extend(["/loads/spring/spring/rest_length", "/bodies/arm/mass"].map(String::from));
        vary(&mut document, &paths);
        gradients_are_exact(&parsed(&document), &simulation);
    }
}

/// Without reductions to a plane, in another order, with sides exchanged, and turned.
#[test]
fn the_same_in_other_descriptions() {
    let document = machine(&json!({"duration": 0.6, "tolerance": 1e-10}), "spline");
    let reference = values(&document);
    let agree = |found: &[f64], what: &str| {
        for (a, b) in found.iter().zip(&reference) {
            assert!(
                (a - b).abs() < 1e-7 * b.abs().max(0.1),
                "{what}: {found:?} {reference:?}"
            );
        }
    };
    agree(&unlowered_values(&document), "without reductions");
    let other = reversed(&document, &["bodies", "joints", "loads"]);
    agree(&values(&other), "in another order");
    let mut exchanged = document.clone();
    exchanged["loads"]["spring"]["spring"]["between"] = json!(["ground", "arm"]);
    exchanged["loads"]["spring"]["spring"]["at"] = json!({"a": [0.9, 0.3, 0], "b": "tip"});
    agree(&values(&exchanged), "sides exchanged");
    // The whole machine turned about the vertical axis.
    let (c, s) = (0.6, 0.8);
    let mut turned = document.clone();
    turned["joints"]["rail"]["prismatic"]["axis"] = json!([c, 0, s]);
    turned["joints"]["hinge"]["revolute"]["axis"] = json!([-s, 0, c]);
    for body in ["slider", "arm"] {
        let own = if body == "arm" { -0.9 } else { 0.0 };
        let own = json!({"sequence": "yzx", "angles": [-f64::atan2(s, c), own, 0]});
        turned["bodies"][body]["place"]["turn"] = own;
    }
    turned["bodies"]["slider"]["velocity"]["linear"] = json!([0.4 * c, 0, 0.4 * s]);
    turned["loads"]["spring"]["spring"]["at"]["b"] = json!([0.9 * c, 0.3, 0.9 * s]);
    turned["functions"]["tip"]["final"]["position"]["direction"] = json!([0.6 * c, 0.8, 0.6 * s]);
    turned["functions"]["rate"]["final"]["velocity"]["direction"] = json!([c, 0, s]);
    agree(&values(&turned), "turned");
    // Millimetres and tonnes; feet and pounds.
    let places = [
        ("/gravity", 1, 0),
        ("/bodies/slider/shape", 1, 0),
        ("/bodies/slider/mass", 0, 1),
        ("/bodies/slider/velocity", 1, 0),
        ("/bodies/arm/shape", 1, 0),
        ("/bodies/arm/mass", 0, 1),
        ("/bodies/arm/points", 1, 0),
        ("/loads/spring/spring/at", 1, 0),
        ("/loads/spring/spring/rest_length", 1, 0),
        ("/loads/spring/spring/table/places", 1, 0),
        ("/loads/spring/spring/table/forces", 1, 1),
        ("/loads/spring/spring/damping_table/places", 1, 0),
        ("/loads/spring/spring/damping_table/forces", 1, 1),
        ("/loads/torsion/torsion_spring/stiffness", 2, 1),
        ("/loads/torsion/torsion_spring/table/forces", 2, 1),
        ("/loads/torsion/torsion_spring/damping_table/forces", 2, 1),
        ("/loads/damper/damping/table/places", 1, 0),
        ("/loads/damper/damping/table/forces", 1, 1),
    ];
    let mut file = document.clone();
    file["gravity"] = json!([0, -9.81, 0]);
    let reference = values(&file);
    for (metre, kilogram) in [(1e3, 1e-3), (1.0 / 0.3048, 1.0 / 0.45359237)] {
        let found = values(&in_units(&file, (metre, kilogram), &places));
        let joule = kilogram * metre * metre;
        let scales = [metre, metre, kilogram * metre, joule, joule, joule];
        for ((found, scale), exact) in found.iter().zip(scales).zip(&reference) {
            near(
                found / scale,
                *exact,
                1e-7 * exact.abs().max(0.1),
                "in other units",
            );
        }
    }
}
