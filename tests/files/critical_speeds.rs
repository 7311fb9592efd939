//! Critical speeds of stiff and elastic rotors about any axis, and their derivatives.

use super::steady_rotation::assert_near;
use super::turned_scenes::{rows_of, turned};
use crate::reference::documents::{problem as parsed, read, values};
use crate::reference::gradients::gradients_are_exact;
use flexbody_driver::check;
use serde_json::{Map, Value};
use std::f64::consts::PI;

/// The stiffness of shafts in stretch leaves no round-off in critical speeds and their derivatives.
#[test]
fn critical_speeds_of_stiff_shafts_are_exact() {
    let mut file = read("problems/rotor.json");
    file["functions"] = json!({
        "first": {"critical_speed": {"number": 1}},
        "second": {"critical_speed": {"number": 2}}
    });
    file["objective"] = json!({"minimise": "first"});
    file["constraints"] = json!({});
    gradients_are_exact(&parsed(&file), &json!("rotor"));
    let at_start = values(&file);
    let radius = &mut file["bodies"]["right shaft"]["beam"]["section"]["tube"]["radius"];
    let above = radius.as_f64().expect("a number").next_up();
    *radius = json!(above);
    assert_near(&values(&file), &at_start, 1e-14);
}

/// A rigid rotor on a ball joint, held by springs in rotational symmetry, has the critical speed √(k / (I_t − I_p)) about any
/// axis. Its free spin belongs to none.
#[test]
fn the_critical_speed_is_the_same_about_oblique_axes() {
    // Springs of zero tension from the end of the rotor at 0.3 m to a circle of 0.5 m about it.
    let (mass, along, across, count) = (2.0, 0.02, 0.03, 4);
    let stiffness = 0.5 * f64::from(count) * 1000.0 * 0.3 * 0.3;
    let expected = (stiffness / (across + mass * 0.25 - along)).sqrt();
    let mut file = json!({
        "version": 1, "name": "rotor", "analysis": "modes", "gravity": [0, 0, 0],
        "turning": {"axis": [1, 0, 0], "speed": 20},
        "functions": {"c": {"critical_speed": {"number": 1}}}
    });
    for k in 0..12_u32 {
        let axis = nalgebra::Vector3::new(0.3 + f64::from(k), 1.0 - 0.7 * f64::from(k * k), 0.9);
        let turn = match k {
            0 => nalgebra::Rotation3::identity(),
            _ => nalgebra::Rotation3::new(axis.normalize() * (0.4 * f64::from(k))),
        };
        let at = |x: [f64; 3]| turned(&turn, x);
        file["turning"]["axis"] = at([1.0, 0.0, 0.0]);
        file["bodies"] = json!({"d": {
            "mass": mass, "inertia": {"xx": along, "yy": across, "zz": across},
            "place": {"at": at([0.5, 0.0, 0.0]), "turn": {"matrix": rows_of(&turn)}}}});
        let springs = |from_centre: f64| {
            let mut all = Map::new();
            for s in 0..count {
                let (sin, cos) = (2.0 * PI * f64::from(s) / f64::from(count)).sin_cos();
                let end = at([0.5 + from_centre, 0.5 * cos, 0.5 * sin]);
                let spring = json!({
                    "between": ["d", "ground"], "at": {"a": [from_centre, 0, 0], "b": end},
                    "rest_length": 0.5, "stiffness": 1000});
                all.insert(format!("at {from_centre} {s}"), json!({"spring": spring}));
            }
            all
        };
        file["joints"] = json!({"s": {"spherical": {"between": ["d", "ground"], "at": [0, 0, 0]}}});
        file["loads"] = Value::Object(springs(-0.2));
        assert_near(&values(&file), &[expected], 1e-9);
        // Without the joint, on springs at both ends, it is free along the axis as well.
        file["joints"] = json!({});
        let mut both = springs(-0.2);
        both.extend(springs(0.2));
        file["loads"] = Value::Object(both);
        let in_one_plane = f64::from(count) * 1000.0;
        assert_near(&values(&file), &[(in_one_plane / mass).sqrt()], 1e-9);
    }
}

/// What holds a rotor along its axis does not move the speed of a pair of whirls: the derivative is zero but for round-off, about
/// an oblique axis as well.
#[test]
fn a_derivative_of_a_pair_may_be_zero() {
    let turn = nalgebra::Rotation3::new(nalgebra::Vector3::new(0.3, -0.8, 0.5));
    let at = |x: [f64; 3]| turned(&turn, x);
    let bearing = |between: Value, place: f64| {
        json!({"free": {"between": between, "at": at([0.0, 0.0, place]),
            "axis": at([0.0, 0.0, 1.0]), "cross": at([1.0, 0.0, 0.0])}})
    };
    let support = |joint: &str, stiffness: [f64; 2]| {
        let [across, along] = stiffness;
        json!({"bushing": {"joint": joint, "stiffness": {"diagonal": [across, across, along, 0, 0, 0]}}})
    };
    let file = json!({
        "version": 1, "name": "rotor", "analysis": "modes", "gravity": [0, 0, 0],
        "bodies": {"d": {"mass": 1.9, "inertia": {"xx": 0.2, "yy": 0.2, "zz": 0.26},
            "place": {"at": at([0.0, 0.0, 0.7]), "turn": {"matrix": rows_of(&turn)}}}},
        "joints": {"a": bearing(json!(["ground", "d"]), 0.0), "b": bearing(json!(["d", "ground"]), 1.2)},
        "loads": {"at a": support("a", [1900.0, 1200.0]), "at b": support("b", [1000.0, 1500.0])},
        "turning": {"axis": at([0.0, 0.0, 1.0]), "speed": 15},
        "functions": {"c": {"critical_speed": {"number": 1}}},
        "variables": {
            "mass": {"path": "/bodies/d/mass", "lower": 1, "upper": 3},
            "along": {"path": "/loads/at a/bushing/stiffness/diagonal/2", "lower": 100, "upper": 5000}
        }
    });
    let problem = parsed(&file);
    let [by_mass, along] = &check(&problem, &problem.start()).expect("is found")[..] else {
        panic!("two derivatives");
    };
    assert!(by_mass.relative_difference() < 1e-12, "{by_mass:?}");
    assert!(along.is_round_off(), "{along:?}");
}

/// The rotor of the problems about oblique axes: its stretch and the motions along the axis have no part in what the rotation
/// stiffens but round-off, and are no critical speeds.
#[test]
fn elastic_rotors_are_the_same_about_oblique_axes() {
    let rotor = read("problems/rotor.json");
    let mut file = json!({
        "version": 1, "name": "turned", "analysis": "modes", "gravity": [0, 0, 0],
        "parts": {"rotor": {"bodies": rotor["bodies"], "joints": rotor["joints"], "drives": rotor["drives"]}},
        "functions": {"c": {"critical_speed": {"number": 1}}}
    });
    let mut first = None;
    for k in 0..10_u32 {
        let k = f64::from(k);
        let axis = nalgebra::Vector3::new(0.3 + k, 1.0 - 0.7 * k * k, 0.9 - k).normalize();
        let angle = 0.37 * k;
        let along = turned(&nalgebra::Rotation3::new(axis * angle), [1.0, 0.0, 0.0]);
        file["turning"] = json!({"axis": along, "speed": 400});
        file["use"] = json!({"a": {"part": "rotor", "turn": {"axis": [axis.x, axis.y, axis.z], "angle": angle}}});
        let found = values(&file);
        assert_near(&found, first.get_or_insert_with(|| found.clone()), 1e-9);
    }
}

/// A heavy disc at the end of a shaft that weighs next to nothing, whose own vibrations are a million times faster: the speeds of
/// the shaft itself grow as it becomes lighter, and the first one stays.
#[test]
fn a_light_shaft_does_not_hide_what_it_carries() {
    let (length, stiffness, mass, along, across) = (0.5_f64, 4000.0, 10.0, 0.2, 0.1);
    let [force, both, moment] = [12.0, -6.0, 4.0].map(|x| x * stiffness);
    let [a, b, c] = [
        force / length.powi(3),
        both / length.powi(2),
        moment / length,
    ];
    // (a − m s) (c − (I_t − I_p) s) = b², s = Ω²
    let half = 0.5 * (a * (across - along) + c * mass);
    let by_square = mass * (across - along);
    let squared = (half - (half * half - by_square * (a * c - b * b)).sqrt()) / by_square;
    let expected = squared.sqrt();
    let mut file = json!({
        "version": 1, "name": "rotor", "analysis": "modes", "gravity": [0, 0, 0],
        "bodies": {
            "shaft": {"beam": {"length": length, "section": {"given": {
                "ea": 1e9, "ei_y": stiffness, "ei_z": stiffness, "gj": 4000}},
                "modes": {"bending_y": 3, "bending_z": 3, "torsion": 1}},
                "place": {"put": "start"}},
            "disc": {"mass": mass, "inertia": {"xx": along, "yy": across, "zz": across},
                "place": {"at": "shaft.end"}}
        },
        "joints": {
            "bearing": {"revolute": {"between": ["shaft", "ground"], "at": "shaft.start", "axis": [1, 0, 0]}},
            "seat": {"weld": {"between": ["disc", "shaft"], "at": "shaft.end"}}
        },
        "drives": {"motor": {"joint": "bearing", "turn": {"rate": 10}}},
        "turning": {"axis": [1, 0, 0], "speed": 60},
        "functions": {
            "first": {"critical_speed": {"number": 1}},
            "second": {"critical_speed": {"number": 2}}
        }
    });
    let mut of_shaft = None;
    for light in [1e-3, 1e-4, 1e-5] {
        let section = &mut file["bodies"]["shaft"]["beam"]["section"]["given"];
        section["mass_per_length"] = json!(light);
        section["inertia_y"] = json!(1e-4 * light);
        section["inertia_z"] = json!(1e-4 * light);
        let [first, second] = values(&file)[..] else {
            panic!("two speeds");
        };
        let off = first / expected - 1.0;
        assert!(off.abs() < 0.1 * light, "{light}: {first} {expected}");
        let by_mass = second * f64::sqrt(light);
        let before = *of_shaft.get_or_insert(by_mass);
        assert!((by_mass / before - 1.0).abs() < 1e-5, "{light}: {second}");
    }
    let stiffness = ["ei_y", "ei_z"].map(|key| format!("/bodies/shaft/beam/section/given/{key}"));
    file["variables"] = json!({
        "mass": {"path": "/bodies/disc/mass", "lower": 1},
        "stiffness": {"paths": stiffness, "lower": 100}
    });
    gradients_are_exact(&parsed(&file), &json!("light shaft"));
}
