//! Thin rods whose joints leave their own spin free: the message names the rod and what it lacks, however far the
//! placement is from where the joints close.

use flexbody_problem::Problem;
use serde_json::Value;
use std::f64::consts::FRAC_PI_2;

/// A crank turned by a motor, a rod between balls, and a slider; `scale` times as large. The motor starts at an
/// angle of 0.2 + 0.3 sin 1 rad from the placement.
fn slider_crank(scale: f64, rod: Value) -> Value {
    let at = |x: f64| json!([x * scale, 0, 0]);
    let mut rod = rod;
    rod["mass"] = json!(0.1);
    rod["place"] = json!({"at": at(0.25)});
    json!({
        "version": 1, "name": "slider crank",
        "bodies": {
            "crank": {"shape": {"box": {"size": [0.1 * scale, 0.01 * scale, 0.01 * scale]}}, "mass": 0.1, "place": {"at": at(0.05)}},
            "slider": {"shape": {"sphere": {"radius": 0.02 * scale}}, "mass": 0.2, "place": {"at": at(0.4)}},
            "thin": rod
        },
        "joints": {
            "motor": {"revolute": {"between": ["crank", "ground"], "at": at(0.0), "axis": [0, 0, 1]}},
            "b1": {"spherical": {"between": ["thin", "crank"], "at": at(0.1)}},
            "b2": {"spherical": {"between": ["thin", "slider"], "at": at(0.4)}},
            "guide": {"prismatic": {"between": ["slider", "ground"], "at": at(0.4), "axis": [1, 0, 0]}}
        },
        "drives": {"motor": {"joint": "motor", "turn": {"harmonic": {"amplitude": 0.3, "frequency": 1, "mean": 0.2, "phase": 1}}}},
        "simulation": {"duration": 0.1, "steps": 20},
        "functions": {"s": {"final": {"slide": {"joint": "guide"}}}}
    })
}

/// A plank on two rods of length 1 between balls, which lie at the angle `turn` to the x axis.
fn swing(turn: f64, radius: f64) -> Value {
    let (y, x) = turn.sin_cos();
    let rod = |left: f64| {
        json!({"shape": {"rod": {"length": 1, "radius": radius}}, "mass": 0.1,
            "place": {"at": [left + 0.5 * x, 0.5 * y, 0.3], "turn": {"axis": [0, 0, 1], "angle": turn}}})
    };
    let ball = |a: &str, b: &str, at: [f64; 3]| json!({"spherical": {"between": [a, b], "at": at}});
    json!({
        "version": 1, "name": "swing", "gravity": [0, -9.81, 0],
        "bodies": {
            "p": {"shape": {"box": {"size": [1, 0.1, 1]}}, "mass": 2, "place": {"at": [x, y, 0]},
                  "velocity": {"linear": [-0.5 * y, 0.5 * x, 0]}},
            "r0": rod(-0.4), "r1": rod(0.4)
        },
        "joints": {
            "a0": ball("r0", "ground", [-0.4, 0.0, 0.3]), "b0": ball("r0", "p", [x - 0.4, y, 0.3]),
            "a1": ball("r1", "ground", [0.4, 0.0, 0.3]), "b1": ball("r1", "p", [x + 0.4, y, 0.3])
        },
        "simulation": {"duration": 0.1}
    })
}

fn rod(scale: f64) -> Value {
    json!({"shape": {"rod": {"length": 0.3 * scale}}})
}

#[test]
fn a_thin_rod_that_may_spin_is_named() {
    let plain = slider_crank(1.0, rod(1.0));
    let change = |pointer: &str, value: Value| {
        let mut file = plain.clone();
        *file.pointer_mut(pointer).expect("an entry") = value;
        file
    };
    let rate = json!({"rate": 3});
    let far = json!({"polynomial": [1.2, 2]});
    let cases = [
        plain.clone(),
        change("/drives/motor/turn", rate),
        change("/drives/motor/turn", far),
        change("/joints/b1/spherical/between", json!(["crank", "thin"])),
        change("/joints/guide/prismatic/axis", json!([1, 0.2, 0])),
        slider_crank(1e-3, rod(1e-3)),
        slider_crank(1e3, rod(1e3)),
        slider_crank(
            1.0,
            json!({"inertia": {"xx": 0, "yy": 7.5e-4, "zz": 7.5e-4}}),
        ),
    ];
    for (case, file) in cases.iter().enumerate() {
        let told = match Problem::parse(&file.to_string(), "rod.json", &[]) {
            Ok(_) => "sound".to_owned(),
            Err(faults) => faults.to_string(),
        };
        let words = [
            "bodies that can move without inertia: thin",
            "spin about itself",
        ];
        assert!(
            words.iter().all(|word| told.contains(word)),
            "{case}: {told}"
        );
    }
    // Swings on rods between balls, which round-off of their turns gives an inertia.
    for turn in [-FRAC_PI_2, -0.7, -2.0] {
        let told = match Problem::parse(&swing(turn, 0.0).to_string(), "swing.json", &[]) {
            Ok(_) => "sound".to_owned(),
            Err(faults) => faults.to_string(),
        };
        let named =
            told.contains("without inertia: r0, r1") && told.contains("give a thin rod a radius");
        assert!(named, "{turn}: {told}");
        if let Err(faults) = Problem::parse(&swing(turn, 0.01).to_string(), "swing.json", &[]) {
            panic!("{turn}: {faults}");
        }
    }
    // With a radius, or with a joint that holds the spin, it runs.
    let mut thick = rod(1.0);
    thick["shape"]["rod"]["radius"] = json!(0.005);
    let mut held = plain.clone();
    held["joints"]["b2"] = json!({"universal": {"between": ["thin", "slider"], "at": [0.4, 0, 0],
        "axis": [0, 1, 0], "cross": [0, 0, 1]}});
    for file in [slider_crank(1.0, thick), held] {
        if let Err(faults) = Problem::parse(&file.to_string(), "rod.json", &[]) {
            panic!("{faults}");
        }
    }
}
