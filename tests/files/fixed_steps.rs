//! Steps of one size in flexible scenes: estimated errors against many steps, and Newton's method at round-off.

use super::modal::data;
use crate::reference::documents::{problem, read, run};
use flexbody_driver::error::estimate;
use serde_json::Value;

/// A beam that falls about a hinge.
fn beam() -> Value {
    json!({
        "version": 1, "name": "beam", "gravity": [0, -9.81, 0],
        "bodies": {"b": {"beam": {"length": 1, "section": {"rectangle": {"width": 0.02, "height": 0.004}},
            "material": {"young": 7e10, "poisson": 0.3, "density": 2700}, "modes": {"bending_y": 0, "bending_z": 2, "torsion": 0, "stretch": 1}},
            "place": {"put": "start", "at": [0, 0, 0]}}},
        "joints": {"h": {"revolute": {"between": ["b", "ground"], "at": "b.start", "axis": [0, 0, 1]}}},
        "functions": {"tip": {"final": {"position": {"body": "b", "point": "end", "direction": [0, 1, 0]}}}},
        "variables": {"size": {"path": "/bodies/b/beam/section/rectangle/height", "lower": 1e-4, "upper": 10}}
    })
}

/// A bar by the matrices of files.
fn modal() -> Value {
    let mut file = beam();
    file["bodies"]["b"] = json!({"modal": {"source": {"matrix_market": {"nodes": data("beam.nodes"), "stiffness": data("beam_k.mtx"), "mass": data("beam_m.mtx")}},
        "interfaces": {"start": 1, "end": 21}, "frame": {"clamped": "start"}, "modes": 2, "scale": 1}, "place": {"put": "start", "at": [0, 0, 0]}});
    file["variables"]["size"]["path"] = json!("/bodies/b/modal/scale");
    file
}

/// A plate of two shells.
fn plate() -> Value {
    let mut file = beam();
    file["materials"] = json!({"al": {"young": 7e10, "poisson": 0.3, "density": 2700}});
    file["bodies"]["b"] = json!({"elements": {"structure": {"mesh": {"plate": {"length": 1, "width": 0.2, "elements": [2, 1]}}, "material": "al", "thickness": 0.01},
        "frame": {"clamped": "x0"}, "points": {"start": {"edge": "x0"}, "end": {"edge": "x1"}}},
        "place": {"put": "start", "at": [0, 0, 0], "turn": {"axis": [1, 0, 0], "angle": -std::f64::consts::FRAC_PI_2}}});
    file["variables"]["size"]["path"] = json!("/bodies/b/elements/structure/thickness");
    file
}

fn with(mut file: Value, method: Value, steps: usize) -> Value {
    file["simulation"] = json!({"duration": 0.1, "steps": steps, "method": method});
    file
}

/// Value and derivative of the tip with their estimated errors.
fn estimated(file: &Value) -> [[f64; 2]; 2] {
    let found = estimate(&problem(file), &run(file).at, &[0], true).expect("runs");
    [found[0].value, found[0].gradient[0]].map(|one| [one.value, one.error])
}

/// Errors of the tip of three kinds of bodies by four methods, of the value and of the derivative, against 800 or 400
/// steps by Radau IIA with three stages. No true error is above ten times its estimate, nine tenths are not above three
/// times. (BDF of order 1 damps vibrations alike at all of these steps, and so hides errors of derivatives.)
#[test]
fn errors_of_flexible_motions_are_estimated() {
    let radau = |stages: usize| json!({"radau": {"stages": stages}});
    let methods = [
        (json!({"bdf": {"order": 2}}), 80),
        (json!({"generalised_alpha": {"radius": 0.8}}), 80),
        (radau(2), 20),
        (radau(3), 10),
    ];
    let (mut within, mut all, mut table) = (0, 0, String::new());
    for (name, file, many) in [
        ("beam", beam(), 1600),
        ("modal", modal(), 1600),
        ("plate", plate(), 800),
    ] {
        let truth = estimated(&with(file.clone(), radau(3), many / 2));
        for (method, steps) in &methods {
            let found = estimated(&with(file.clone(), method.clone(), *steps));
            for (what, (found, truth)) in
                ["value", "derivative"].iter().zip(found.iter().zip(&truth))
            {
                let error = (found[0] - truth[0]).abs();
                let noise = truth[1] + 1e-9 * truth[0].abs();
                if error < 10.0 * noise {
                    continue;
                }
                let ratio = found[1] / error;
                all += 1;
                within += usize::from(ratio >= 1.0 / 3.0);
                table += &format!(
                    "{name} {method} {what}: {error:.2e}, estimated {:.2e}\n",
                    found[1]
                );
                assert!(ratio >= 0.1, "{table}");
            }
        }
    }
    assert!(
        all >= 20 && 10 * within >= 9 * all,
        "{within} of {all}\n{table}"
    );
}

/// A bracket whose stiff modes have much round-off and contract slowly: with every number of steps Newton's method ends,
/// and the joints are closed to 1e-7 m and to 2e-5 of the speeds, 8 m/s at 6 Hz.
#[test]
fn newton_ends_at_round_off() {
    let mut file = read("problems/flexible/modal_bracket.json");
    let place = data("").replace("tests/data/modal/", "problems/flexible/");
    file["bodies"]["bracket"]["modal"]["source"] = json!({"dmig": {
        "nodes": format!("{place}modal_bracket.nodes"), "file": format!("{place}modal_bracket.pch")}});
    let cases = [
        (1, 3, 50),
        (2, 3, 50),
        (2, 3, 200),
        (6, 2, 200),
        (6, 3, 200),
        (6, 2, 400),
        (6, 3, 400),
    ];
    for (frequency, stages, steps) in cases {
        // Wider swings at 6 Hz throw the weight through the singular position of its joint.
        let amplitude = if frequency == 6 { 0.2 } else { 0.4 };
        let swing = json!({"harmonic": {"amplitude": amplitude, "frequency": frequency}});
        file["drives"]["swing"]["turn"] = swing;
        file["simulation"] =
            json!({"duration": 0.5, "steps": steps, "method": {"radau": {"stages": stages}}});
        let motion = run(&file);
        assert_eq!(motion.at.run.grid.steps(), steps);
        let (position, velocity) = motion.constraint_drift();
        let told = format!("{frequency} {stages} {steps}: {position:e} {velocity:e}");
        assert!(position < 1e-7 && velocity < 1.5e-4, "{told}");
    }
}
