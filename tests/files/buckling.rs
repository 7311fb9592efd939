//! Starts in equilibrium from which a disturbance grows: columns and plates that turn, above the load at which they
//! buckle.

use crate::reference::documents::{problem as parsed, run};
use crate::reference::gradients::gradients_are_exact;
use flexbody_driver::start;
use serde_json::Value;

/// β = ρ A Ω² L⁴ / EI at which a plate that points from a ring of radius L to its axis buckles.
const INWARD: f64 = 32.201_906_99;

/// The plate that points inward, turning with `turn` times the angular velocity at which it buckles.
fn inward(turn: f64, thickness: f64) -> Value {
    let text = include_str!("../../problems/extreme/inward_plate.json");
    let mut document: Value = serde_json::from_str(text).expect("valid JSON");
    let young = 12.0 * 1000.0 * (10.0 / thickness).powi(2) / (INWARD * turn * turn);
    document["materials"]["elastic"]["young"] = json!(young);
    document["bodies"]["plate"]["elements"]["structure"]["thickness"] = json!(thickness);
    document
}

/// Seconds in which a disturbance grows by e, as the note on the start says.
fn growth_time(document: &Value) -> Option<f64> {
    let problem = parsed(document);
    let notes = start::notes(&problem, &problem.start());
    let note = notes.iter().find(|note| note.contains("is not stable"))?;
    let (_, rest) = note.split_once("a factor of e in ").expect("a time");
    let (time, _) = rest.split_once(" s").expect("a unit");
    Some(time.parse().expect("a number"))
}

/// Euler's column: a cantilever with a force against its end buckles at π² EI / 4 L², by each frame, whether beam or
/// shells. A pulling force is never told as unstable.
#[test]
fn columns_that_buckle_are_told() {
    let (width, height, young) = (0.1_f64, 0.02_f64, 1e9);
    let euler = (std::f64::consts::PI / 2.0).powi(2) * young * width * height.powi(3) / 12.0;
    let beam = |frame: &str| {
        json!({"beam": {
            "length": 1, "section": {"rectangle": {"width": width, "height": height}},
            "material": {"young": young, "poisson": 0, "density": 1000}, "frame": frame,
            "modes": {"bending_y": 4, "bending_z": 3, "torsion": 0, "stretch": 2}
        }, "place": {"put": "start", "at": [0, 0, 0]}})
    };
    let shells = json!({"elements": {
        "structure": {"mesh": {"plate": {"length": 1, "width": width, "elements": [6, 1]}},
                      "material": "soft", "thickness": height},
        "frame": {"clamped": "x0"}, "points": {"start": {"edge": "x0"}, "end": {"edge": "x1"}}
    }, "place": {"put": "start", "at": [0, 0, 0]}});
    for body in [beam("clamped"), beam("chord"), shells] {
        let mut document = json!({
            "version": 1, "name": "column", "start": "equilibrium", "gravity": [0, 0, 0],
            "bodies": {"column": body}, "materials": {"soft": {"young": young, "poisson": 0, "density": 1000}},
            "joints": {"wall": {"weld": {"between": ["column", "ground"], "at": "column.start"}}},
            "loads": {"push": {"force": {"body": "column", "point": "end", "direction": [-1, 0, 0], "magnitude": 1}}},
            "simulation": {"duration": 0.01, "steps": 4, "method": {"radau": {"stages": 3}}},
            "functions": {"x": {"final": {"position": {"body": "column", "point": "end", "direction": [1, 0, 0]}}}}
        });
        for part in [-2.0, 0.1, 0.97, 1.03, 2.0, 20.0] {
            document["loads"]["push"]["force"]["magnitude"] = json!(part * euler);
            let told = growth_time(&document);
            assert_eq!(told.is_some(), part > 1.0, "{part}: {told:?} {document}");
        }
    }
}

/// What points to the axis about which it turns is compressed. Above its angular velocity it is told, and departs as
/// fast as the note says.
#[test]
fn disturbances_grow_as_told() {
    for turn in [0.1, 0.5, 0.98, 1.02, 3.0] {
        assert_eq!(growth_time(&inward(turn, 0.01)).is_some(), turn > 1.0);
    }
    let mut document = inward(1.5, 0.01);
    let told = growth_time(&document).expect("a note");
    for angle in [0.0, 0.8, 2.0, 4.0] {
        let mut turned = document.clone();
        let (c, s) = (f64::cos(angle), f64::sin(angle));
        turned["bodies"]["plate"]["place"]["at"] = json!([-c, -s, 0]);
        turned["bodies"]["plate"]["place"]["turn"]["angle"] = json!(angle);
        assert_eq!(growth_time(&turned), Some(told), "{angle}");
    }
    // It starts undeformed, so the small weight disturbs it.
    document["start"] = json!("given");
    let mut at = |duration: f64| {
        document["simulation"]["duration"] = json!(duration);
        document["simulation"]["steps"] = json!((500.0 * duration).round() as usize);
        run(&document).at.function(0).value
    };
    let (early, late) = (at(1.2), at(1.6));
    let seen = 0.4 / (late / early).ln();
    assert!((told / seen - 1.0).abs() < 0.05, "{told} {seen}");
}

/// A blade of 1 m with its root at the origin, on a hub that a drive turns: a beam in a frame, or shells.
fn blade(frame: &str, young: f64) -> Value {
    match frame {
        "shells" => json!({"elements": {
            "structure": {"mesh": {"plate": {"length": 1, "width": 0.1, "elements": [4, 1]}},
                          "material": "soft", "thickness": 0.02},
            "frame": {"clamped": "x0"}, "points": {"start": {"edge": "x0"}, "end": {"edge": "x1"}}
        }}),
        _ => json!({"beam": {
            "length": 1, "section": {"rectangle": {"width": 0.1, "height": 0.02}},
            "material": {"young": young, "poisson": 0, "density": 1000}, "frame": frame,
            "modes": {"bending_y": 4, "bending_z": 4, "torsion": 0, "stretch": 2}
        }}),
    }
}

/// The blade on a hub of this mass at `place` along it. The hub turns about its z axis with `part` of the lowest angular
/// frequency of the blade; the whole is turned by an angle about an axis.
fn turning(
    frame: &str,
    young: f64,
    (mass, place): (f64, f64),
    part: f64,
    (axis, angle): ([f64; 3], f64),
) -> Value {
    let spin = part * 3.516 * f64::sqrt(young * 0.02 * 0.02 / (12.0 * 1000.0));
    let axis = nalgebra::Unit::new_normalize(nalgebra::Vector3::from(axis));
    let turn = nalgebra::Rotation3::from_axis_angle(&axis, angle);
    let at = |x: [f64; 3]| json!((turn * nalgebra::Vector3::from(x)).as_slice());
    let (centre, up) = (at([place, 0.0, 0.0]), at([0.0, 0.0, 1.0]));
    let mut body = blade(frame, young);
    body["place"] =
        json!({"put": "start", "at": [0, 0, 0], "turn": {"axis": axis.as_slice(), "angle": angle}});
    json!({
        "version": 1, "name": "blade", "start": "equilibrium", "gravity": [0, 0, 0],
        "bodies": {
            "blade": body,
            "hub": {"shape": {"cylinder": {"radius": 0.1, "length": 0.2}}, "mass": mass,
                    "points": {"centre": [0, 0, 0]}, "place": {"put": "centre", "at": centre}}
        },
        "materials": {"soft": {"young": young, "poisson": 0, "density": 1000}},
        "joints": {
            "axle": {"revolute": {"between": ["hub", "ground"], "at": centre, "axis": up}},
            "root": {"weld": {"between": ["blade", "hub"], "at": "blade.start"}}
        },
        "drives": {"motor": {"joint": "axle", "turn": {"polynomial": [0, spin]}}},
        "initial_velocity": {"angular": at([0.0, 0.0, spin])},
        "simulation": {"duration": 0.001, "steps": 2, "method": {"radau": {"stages": 2}}},
        "functions": {"x": {"final": {"position": {"body": "blade", "point": "end", "direction": at([1.0, 0.0, 0.0])}}}}
    })
}

const TURNS: [([f64; 3], f64); 2] = [([0.0, 0.0, 1.0], 0.0), ([0.3, -1.0, 0.7], 1.1)];

/// What points outward from a hub that a drive turns is stretched, so no start is told as unstable: soft and stiff, in any
/// axes, with hubs of any mass, about the origin or not.
#[test]
fn what_rotation_stretches_is_stable() {
    for frame in ["clamped", "chord", "shells"] {
        for (young, mass, place) in [
            (1e7, 0.01, -1.0),
            (1e9, 10.0, -1.0),
            (1e9, 10.0, 0.0),
            (1e9, 100.0, -1.0),
            (1e13, 1.0, 0.0),
        ] {
            for (part, turn) in [(0.3, TURNS[0]), (0.3, TURNS[1]), (1.5, TURNS[0])] {
                let document = turning(frame, young, (mass, place), part, turn);
                assert_eq!(growth_time(&document), None, "{document}");
            }
        }
    }
}

/// What points inward is told from the same speed on in any axes, and its growth has the units of its stiffness.
#[test]
fn what_rotation_compresses_is_told() {
    for frame in ["clamped", "chord", "shells"] {
        for part in [0.5, 2.0, 3.0] {
            let mut all = Vec::new();
            for (young, turn) in [(1e9, TURNS[0]), (1e9, TURNS[1]), (1e7, TURNS[1])] {
                let document = turning(frame, young, (10.0, 1.0), part, turn);
                let told = growth_time(&document);
                assert_eq!(told.is_some(), part > 1.0, "{document}");
                all.extend(told.map(|time| time * f64::sqrt(young)));
            }
            let mean = all.iter().sum::<f64>() / all.len() as f64;
            // The note has two digits.
            assert!(all.iter().all(|x| (x / mean - 1.0).abs() < 0.06), "{all:?}");
        }
    }
}

/// Derivatives of the start of a plate on a ring that a drive turns: accelerations and velocities are given, so their
/// changes are round-off.
#[test]
fn driven_starts_have_exact_derivatives() {
    for turn in [0.5, 1.5] {
        let mut document = inward(turn, 0.1);
        document["simulation"]["duration"] = json!(0.02);
        document["simulation"]["steps"] = json!(4);
        gradients_are_exact(&parsed(&document), &json!(turn));
    }
}
