//! Modes of machines, as a user asks for them.

use super::program::{expect, json, scratch};
use serde_json::Value;
use std::f64::consts::PI;
use std::path::Path;

/// The committed rotor with fewer speeds.
fn rotor(directory: &Path) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("problems/rotor.json");
    let mut file: Value = json(&std::fs::read_to_string(path).expect("a problem"));
    file["modes"] = serde_json::json!({"count": 5, "speeds": [0, 300, 900]});
    std::fs::write(directory.join("rotor.json"), file.to_string()).expect("is written");
}

#[test]
fn modes_of_a_rotor_are_told_and_drawn() {
    let scratch = scratch();
    let directory = scratch.path();
    rotor(directory);
    let found = json(&expect(0, directory, &["simulate", "rotor.json", "--json"]).out);
    assert_eq!(found["analysis"], "modes");
    assert_eq!(found["speed"], 400.0);
    assert!(found.get("energy").is_none(), "{found}");
    let critical = found["functions"]["critical speed"]["value"]
        .as_f64()
        .expect("a number");
    let diagram = found["campbell"].as_array().expect("a list");
    assert_eq!(diagram.len(), 3);
    for (at, speed) in diagram.iter().zip([0.0, 300.0, 900.0]) {
        assert_eq!(at["speed"], speed);
        let modes = at["modes"].as_array().expect("a list");
        assert_eq!(modes.len(), 5);
        let lowest = |sense: &str| {
            let whirls = modes.iter().filter(|mode| mode["whirl"] == sense);
            let all = whirls.map(|mode| mode["fixed_frame_frequency"].as_f64().expect("a number"));
            all.reduce(f64::min)
        };
        match speed {
            0.0 => assert_eq!(lowest("forward"), None),
            _ => {
                let (forward, backward) = (lowest("forward"), lowest("backward"));
                let (forward, backward) = (forward.expect("one"), backward.expect("one"));
                assert!(backward < forward, "{backward} {forward}");
                // Below the critical speed whirl is faster than the machine.
                assert_eq!(forward * 2.0 * PI > speed, speed < critical, "{at}");
            }
        }
    }
    let text = expect(0, directory, &["simulate", "rotor.json", "--output", "out"]).out;
    for part in [
        "in steady rotation",
        "modes at 400 rad/s",
        "backward",
        "at 900 rad/s",
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }
    for file in ["motion.svg", "modes.svg", "campbell.svg"] {
        let figure = std::fs::read_to_string(directory.join("out").join(file)).expect(file);
        assert!(figure.starts_with("<svg"), "{file}");
    }
    let modes = std::fs::read_to_string(directory.join("out/modes.svg")).expect("a figure");
    assert!(
        modes.contains("mode 1") && modes.contains("disc"),
        "{modes}"
    );
}

/// A machine with fewer modes than the table has room for, and one without any.
#[test]
fn a_table_has_the_modes_that_there_are() {
    let scratch = scratch();
    let directory = scratch.path();
    let pendulum = |joint: &str| {
        serde_json::json!({
            "version": 1, "name": "bar", "analysis": "modes",
            "bodies": {"bar": {"shape": {"rod": {"length": 1, "radius": 0.01}}, "mass": 2,
                "points": {"a": [0, 0, 0.5]}, "place": {"put": [-0.5, 0, 0], "turn": {"axis": [0, 0, 1], "angle": -PI / 2.0}}}},
            "joints": {"pin": {joint: {"between": ["bar", "ground"], "at": [0, 0, 0]}}}
        })
    };
    let mut hinged = pendulum("revolute");
    hinged["joints"]["pin"]["revolute"]["axis"] = serde_json::json!([0, 0, 1]);
    for (name, file, count) in [("hinged", hinged, 1), ("fixed", pendulum("weld"), 0)] {
        let path = format!("{name}.json");
        std::fs::write(directory.join(&path), file.to_string()).expect("is written");
        let found = json(&expect(0, directory, &["simulate", &path, "--json"]).out);
        let modes = found["modes"].as_array().expect("a list");
        assert_eq!(modes.len(), count, "{found}");
        if let Some(mode) = modes.first() {
            let exact = (1.5 * 9.81_f64 / (1.0 + 0.75e-4)).sqrt() / (2.0 * PI);
            let f = mode["frequency"].as_f64().expect("a number");
            assert!((f / exact - 1.0).abs() < 1e-9, "{f} {exact}");
        }
    }
}
