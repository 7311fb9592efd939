//! Starts in equilibrium with drives that run: bodies that turn or move steadily start stretched and stay so.
//!
//! A bar of length L that turns with ω about its end at the distance R from the axis is stretched by
//! ρ ω² (L³ / 3 + R L² / 2) / E (a linear bar; Timoshenko & Goodier, Theory of Elasticity). Its strains are 1e-4, so second
//! order is below the tolerance.

use super::modal::modal;
use crate::reference::documents::{problem as parsed, run};
use crate::reference::gradients::gradients_are_exact;
use flexbody_driver::start::notes;
use serde_json::Value;

const YOUNG: f64 = 7e10;
const DENSITY: f64 = 2700.0;
const RATE: f64 = 100.0;

fn stretch(young: f64, root: f64) -> f64 {
    DENSITY * RATE * RATE * (1.0 / 3.0 + root / 2.0) / young
}

fn beam(frame: &str) -> Value {
    json!({
        "length": 1, "section": {"rectangle": {"height": 0.01, "width": 0.02}}, "frame": frame,
        "material": {"young": YOUNG, "poisson": 0.3, "density": DENSITY},
        "modes": {"bending_y": 1, "bending_z": 1, "torsion": 0}
    })
}

/// A bar from the origin whose x axis is turned so, on a hinge about `axis` that a motor turns.
fn turning(frame: &str, axis: [f64; 3], turn: Value, gravity: f64) -> Value {
    let size = axis.iter().map(|x| x * x).sum::<f64>().sqrt();
    json!({
        "version": 1, "name": "turning bar", "start": "equilibrium", "gravity": axis.map(|x| -gravity * x / size),
        "bodies": {"bar": {"beam": beam(frame), "place": {"put": "start", "turn": turn}}},
        "joints": {"hub": {"revolute": {"between": ["bar", "ground"], "at": "bar.start", "axis": axis}}},
        "drives": {"motor": {"joint": "hub", "turn": {"rate": RATE}}},
        "simulation": {"duration": 0.002, "steps": 20, "method": {"radau": {"stages": 3}}},
        "functions": functions("bar")
    })
}

fn functions(body: &str) -> Value {
    let along =
        json!({"elastic_displacement": {"body": body, "point": "end", "direction": [1, 0, 0]}});
    json!({
        "tip": {"final": along}, "most": {"ks": {"rho": 1e9, "of": along}},
        "strain": {"final": {"strain_energy": {"body": body}}},
        "least": {"ks": {"rho": 1e9, "bound": "above", "of": {"strain_energy": {"body": body}}}}
    })
}

/// Asserts that the tip is stretched by `expected` in the whole run, and returns the notes of the start.
fn is_steady(document: &Value, expected: f64) -> Vec<String> {
    let motion = run(document);
    let value = |k: usize| motion.at.function(k).value;
    for k in [0, 1] {
        let off = value(k) / expected - 1.0;
        assert!(off.abs() < 2e-3, "{} {expected} {document}", value(k));
    }
    assert!((value(1) / value(0) - 1.0).abs() < 1e-6, "{document}");
    let problem = parsed(document);
    notes(&problem, &problem.start())
}

/// By each frame, about each axis and an oblique one, with gravity along it: no ringing, and no note.
#[test]
fn bars_that_motors_turn_start_stretched() {
    let quarter = std::f64::consts::FRAC_PI_2;
    let oblique = json!({"axis": [0, 1, 0], "angle": 1.0_f64.atan2(3.0)});
    let upright = json!({"axis": [0, 0, 1], "angle": quarter});
    let straight = json!({"axis": [0, 0, 1], "angle": 0});
    for (frame, axis, turn, gravity) in [
        ("chord", [0.0, 0.0, 1.0], &straight, 0.0),
        ("clamped", [0.0, 0.0, 1.0], &straight, 9.81),
        ("chord", [1.0, 0.0, 0.0], &upright, 9.81),
        ("clamped", [0.0, -1.0, 0.0], &straight, 0.0),
        ("chord", [1.0, 2.0, 3.0], &oblique, 9.81),
    ] {
        let document = turning(frame, axis, turn.clone(), gravity);
        let notes = is_steady(&document, stretch(YOUNG, 0.0));
        assert!(notes.is_empty(), "{notes:?}");
    }
    let mut explicit = turning("chord", [0.0, 0.0, 1.0], straight, 0.0);
    explicit["simulation"] = json!({"duration": 1e-4, "steps": 60, "method": "dop853"});
    is_steady(&explicit, stretch(YOUNG, 0.0));
}

/// A motor turns a rigid hub that carries the bar at 0.5 m, by a weld and by a hinge with the same axis. The bar follows the
/// hub, whatever hangs between.
#[test]
fn bars_behind_a_driven_hub_start_stretched() {
    for joint in [
        json!({"weld": {"between": ["bar", "hub"], "at": "bar.start"}}),
        json!({"revolute": {"between": ["bar", "hub"], "at": "bar.start", "axis": [0, 0, 1]}}),
        json!({"revolute": {"between": ["hub", "bar"], "at": "bar.start", "axis": [0, 1, 0]}}),
    ] {
        let mut document = turning(
            "clamped",
            [0.0, 0.0, 1.0],
            json!({"axis": [0, 0, 1], "angle": 0}),
            0.0,
        );
        document["bodies"] = json!({
            "hub": {"shape": {"box": {"size": [0.1, 0.1, 0.1]}}, "mass": 1},
            "bar": {"beam": beam("clamped"), "place": {"put": "start", "at": [0.5, 0, 0]}}
        });
        document["joints"] = json!({
            "axle": {"revolute": {"between": ["hub", "ground"], "at": [0, 0, 0], "axis": [0, 0, 1]}},
            "root": joint
        });
        document["drives"]["motor"]["joint"] = json!("axle");
        let notes = is_steady(&document, stretch(YOUNG, 0.5));
        assert!(notes.is_empty(), "{notes:?}");
    }
}

/// A slide at constant speed leaves the bar as it is, and with a turn it is a screw.
#[test]
fn screws_are_steady_too() {
    let mut document = turning(
        "chord",
        [0.0, 0.0, 1.0],
        json!({"axis": [0, 0, 1], "angle": 0}),
        9.81,
    );
    document["joints"]["hub"] = json!({"cylindrical": document["joints"]["hub"]["revolute"]});
    document["drives"]["lift"] = json!({"joint": "hub", "slide": {"polynomial": [0, -3]}});
    let notes = is_steady(&document, stretch(YOUNG, 0.0));
    assert!(notes.is_empty(), "{notes:?}");
    document["drives"]["motor"] = json!({"joint": "hub", "turn": {"rate": 0}});
    document["gravity"] = json!([0, 0, 0]);
    let motion = run(&document);
    assert!(motion.at.function(2).value.abs() < 1e-16);
    assert!(notes_of(&document).is_empty());
}

fn notes_of(document: &Value) -> Vec<String> {
    let problem = parsed(document);
    notes(&problem, &problem.start())
}

/// A plate of shells on a driven edge, and a body from a file: the strain energy stays what it is at the start.
#[test]
fn shells_and_modal_bodies_start_stretched() {
    let plate = json!({
        "elements": {
            "structure": {"mesh": {"plate": {"length": 1, "width": 0.2, "elements": [3, 1]}},
                          "material": "soft", "thickness": 0.02, "sets": {"end": {"node": {"at": [1, 0.5]}}}},
            "frame": {"clamped": "x0"}, "points": {"root": {"edge": "x0"}, "end": {"node": "end"}}
        },
        "place": {"put": "root"}
    });
    let mut document = turning(
        "chord",
        [0.0, 0.0, 1.0],
        json!({"axis": [0, 0, 1], "angle": 0}),
        0.0,
    );
    document["materials"] = json!({"soft": {"young": 1e10, "poisson": 0, "density": DENSITY}});
    document["bodies"] = json!({"bar": plate});
    document["joints"]["hub"]["revolute"]["at"] = json!("bar.root");
    let notes = is_steady(&document, stretch(1e10, 0.0));
    assert!(notes.is_empty(), "{notes:?}");

    let mut document = turning(
        "chord",
        [0.0, 0.0, 1.0],
        json!({"axis": [0, 0, 1], "angle": 0}),
        0.0,
    );
    document["bodies"] =
        json!({"bar": {"modal": modal(json!({"clamped": "start"})), "place": {"put": "start"}}});
    document["drives"]["motor"]["turn"]["rate"] = json!(5);
    document["simulation"]["duration"] = json!(0.02);
    let motion = run(&document);
    let (last, least) = (motion.at.function(2).value, motion.at.function(3).value);
    assert!(
        last > 0.0 && (least / last - 1.0).abs() < 1e-5,
        "{last} {least}"
    );
}

/// Derivatives of a start by the rate of the motor, stiffness, density and a length against the complex step.
#[test]
fn starts_with_motors_have_exact_derivatives() {
    let mut document = turning(
        "clamped",
        [1.0, 2.0, 3.0],
        json!({"axis": [0, 1, 0], "angle": 1.0_f64.atan2(3.0)}),
        9.81,
    );
    document["drives"]["motor"]["turn"] = json!({"polynomial": [0, RATE, 30]});
    document["simulation"]["steps"] = json!(6);
    document["functions"] = json!({
        "tip": {"final": {"elastic_displacement": {"body": "bar", "point": "end", "direction": [1, 0, 0]}}},
        "strain": {"integral": {"strain_energy": {"body": "bar"}}}
    });
    document["variables"] = json!({
        "rate": {"path": "/drives/motor/turn/polynomial/1", "lower": 1, "upper": 1e3},
        "acceleration": {"path": "/drives/motor/turn/polynomial/2", "lower": 1, "upper": 1e3},
        "young": {"path": "/bodies/bar/beam/material/young", "lower": 1e9, "upper": 1e12},
        "density": {"path": "/bodies/bar/beam/material/density", "lower": 1, "upper": 1e5},
        "length": {"path": "/bodies/bar/beam/length", "lower": 0.1, "upper": 10}
    });
    gradients_are_exact(&parsed(&document), &document["simulation"]);
}

/// What is not steady is said with the vibration that follows; √(T/U) of the rate that a rising ω leaves out is checked
/// against its closed form. The stretch follows ω², so its rate is 2α/ω of it, and its first mode (sin πx/2L, of frequency
/// π/2 √(E/ρ) / L) has nearly all of it: 2 α / (ω Ω).
#[test]
fn unsteady_drives_are_told() {
    let straight = json!({"axis": [0, 0, 1], "angle": 0});
    let mut document = turning("chord", [0.0, 0.0, 1.0], straight.clone(), 0.0);
    document["drives"]["motor"]["turn"] = json!({"polynomial": [0, RATE, 2000]});
    document["bodies"]["bar"]["beam"]["modes"]["bending_y"] = json!(0);
    let told = notes_of(&document);
    let mode = std::f64::consts::FRAC_PI_2 * (YOUNG / DENSITY).sqrt();
    let expected = 2.0 * 4000.0 / (RATE * mode);
    let said = told[0]
        .split("by about ")
        .nth(1)
        .and_then(|rest| rest.split(' ').next());
    let said: f64 = said.expect("a part").parse().expect("a number");
    assert!(told[0].contains("\"hub\" accelerates"), "{told:?}");
    assert!((said / expected - 1.0).abs() < 0.02, "{said} {expected}");

    // Gravity across the axis turns as seen from the bar.
    let mut document = turning("chord", [0.0, 0.0, 1.0], straight, 0.0);
    document["gravity"] = json!([0, -9.81, 0]);
    let told = notes_of(&document);
    assert!(told.len() == 1 && told[0].contains("steadily"), "{told:?}");

    // A second axis.
    document["gravity"] = json!([0, 0, 0]);
    document["bodies"]["ring"] = json!({"shape": {"box": {"size": [0.1, 0.1, 0.1]}}, "mass": 1});
    document["joints"]["hub"]["revolute"]["between"] = json!(["bar", "ring"]);
    document["joints"]["tilt"] =
        json!({"revolute": {"between": ["ring", "ground"], "at": [0, 0, 0], "axis": [1, 0, 0]}});
    document["drives"]["tilt"] = json!({"joint": "tilt", "turn": {"rate": 20}});
    let told = notes_of(&document);
    assert!(told.len() == 1 && told[0].contains("steadily"), "{told:?}");
}
