//! Thin rods whose joints leave their own spin free: the message names the rod and what it lacks, however far the
//! placement is from where the joints close.

use flexbody::problem::Problem;
use serde_json::Value;

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
