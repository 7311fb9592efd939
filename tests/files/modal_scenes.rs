//! Bodies from files in scenes: starts of joints, torques, fast rotation, and files of few digits.

use super::modal::{YOUNG, beam, data, modal, pendulum};
use crate::reference::documents::{problem as parsed, run, value, values};
use flexbody_problem::Problem;
use serde_json::Value;

/// The pendulum of the files with a tenth of the stiffness, so that it bends visibly.
fn soft() -> Value {
    let mut body = modal(json!({"clamped": "start"}));
    body["young_factor"] = json!(0.1);
    pendulum("modal", body)
}

/// Joints that start with an angle and a rate move the body as a placement and velocities do.
#[test]
fn joints_start_with_bodies_of_files() {
    let (angle, rate) = (0.3, 2.0);
    let mut started = soft();
    started["bodies"]["arm"]["place"]["turn"] = json!({"axis": [0, 0, 1], "angle": 0});
    started["bodies"]["weight"]["place"]["turn"] = json!({"axis": [0, 0, 1], "angle": 0});
    started["joints"]["root"]["revolute"]["axis"] = json!([0, 0, 1]);
    let mut placed = started.clone();
    started["joints"]["root"]["revolute"]["start"] =
        json!({"turn": {"angle": angle, "rate": rate}});
    for body in ["arm", "weight"] {
        placed["bodies"][body]["place"]["turn"]["angle"] = json!(angle);
    }
    placed["initial_velocity"] = json!({"angular": [0, 0, rate], "linear": [0, 0, 0]});
    let [a, b] = [values(&started), values(&placed)];
    for (a, b) in a.iter().zip(&b) {
        assert!((a - b).abs() <= 1e-9 * b.abs(), "{a} {b}");
    }
    // The start of the coordinates would be that of another placement.
    started["bodies"]["arm"]["modal"]["start"] = json!({"coordinates": vec![0.0; 20]});
    let faults = Problem::parse(&started.to_string(), "modal", &[]).expect_err("two starts");
    assert!(
        faults
            .to_string()
            .contains("started with undeformed bodies"),
        "{faults}"
    );
}

/// A torque turns the interface that it names, as it turns the section of a beam.
#[test]
fn torques_turn_interfaces() {
    let twisted = |key: &str, body: Value| {
        let mut document = pendulum(key, body);
        document["loads"] = json!({"twist": {"torque":
            {"body": "arm", "point": "end", "direction": [0, 0.3, 1], "magnitude": 10}}});
        values(&document)
    };
    let mut files = modal(json!({"clamped": "start"}));
    files["young_factor"] = json!(0.1);
    let found = twisted("modal", files);
    let reference = twisted("beam", beam("clamped", YOUNG / 10.0));
    let largest = reference[1].abs().max(reference[2].abs());
    for k in [1, 2] {
        let off = (found[k] - reference[k]).abs();
        assert!(off < 0.03 * largest, "{off:e} of {largest:e}");
    }
    // It must say where.
    let mut whole = soft();
    whole["loads"] =
        json!({"twist": {"torque": {"body": "arm", "direction": [0, 0, 1], "magnitude": 1}}});
    let faults = Problem::parse(&whole.to_string(), "modal", &[]).expect_err("no point");
    let told = faults.to_string();
    assert!(told.contains("a torque on the body of files"), "{told}");
    assert!(told.contains("the interface that it turns"), "{told}");
}

/// A stiffness matrix does not stiffen by rotation: a body that spins with more than a tenth of its lowest
/// frequency gives a warning, a slower one is not, and neither is a beam of von Karman's strain.
#[test]
fn fast_rotation_of_linear_strain_is_told() {
    let spun = |mut document: Value, rate: f64| {
        document["initial_velocity"] = json!({"angular": [0, 0, rate], "linear": [0, 0, 0]});
        document["joints"]["root"]["revolute"]["axis"] = json!([0, 0, 1]);
        document["simulation"]["duration"] = json!(0.02);
        run(&document).warning
    };
    let told = spun(soft(), 6.0).expect("a warning");
    assert!(told.contains("\"arm\" turns with"), "{told}");
    assert!(told.contains("its strain is linear"), "{told}");
    assert_eq!(spun(soft(), 1.0), None);
    let mut stiffens = beam("clamped", YOUNG / 10.0);
    stiffens["strain"] = json!("von_karman");
    stiffens.as_object_mut().expect("a beam")["modes"] =
        json!({"bending_y": 2, "bending_z": 2, "torsion": 1});
    assert_eq!(spun(pendulum("beam", stiffens), 6.0), None);
}

/// Three masses joined by springs whose numbers have three digits: a rigid motion leaves 1e-3 of the forces, which
/// the digits explain. Σ ω² of the free vibrations is the trace of K/m within what the digits say.
#[test]
fn few_digits_suffice_where_entries_do_not_cancel() {
    let directory = tempfile::tempdir().expect("a directory");
    let places = [[0.0, 0.0], [1.1, 0.2], [0.3, 0.9]];
    let mut stiffness = [[0.0_f64; 9]; 9];
    for (a, b, k) in [(0, 1, 1234.5), (0, 2, 987.6), (1, 2, 2345.6)] {
        let [x, y] = [0, 1].map(|i| places[b][i] - places[a][i]);
        for (i, d) in [x, y].into_iter().enumerate() {
            for (j, e) in [x, y].into_iter().enumerate() {
                let value = k * d * e / (x * x + y * y);
                for (p, q, sign) in [(a, a, 1.0), (b, b, 1.0), (a, b, -1.0), (b, a, -1.0)] {
                    stiffness[3 * p + i][3 * q + j] += sign * value;
                }
            }
        }
    }
    let mut text = String::new();
    for (name, matrix) in [("KAAX", Some(&stiffness)), ("MAAX", None)] {
        text += &format!("DMIG    {name:<8}{:>8}{:>8}{:>8}\n", 0, 6, 1);
        for j in 0..9 {
            for i in j..9 {
                let value = match matrix {
                    Some(matrix) => matrix[i][j],
                    None => f64::from(u8::from(i == j)) * 2.0,
                };
                let written = format!("{value:.2e}").replace("e", "+").replace("+-", "-");
                if value != 0.0 {
                    text += &format!(
                        "DMIG    {name:<8}{:>8}{:>8}{:>8}{:>8}{:>8}{written:>8}\n",
                        j / 3 + 1,
                        j % 3 + 1,
                        "",
                        i / 3 + 1,
                        i % 3 + 1
                    );
                }
            }
        }
    }
    let path = |name: &str| directory.path().join(name);
    std::fs::write(path("all.pch"), text).expect("written");
    let nodes: String = (places.iter().enumerate())
        .map(|(k, [x, y])| format!("{} {x} {y} 0\n", k + 1))
        .collect();
    std::fs::write(path("nodes"), nodes).expect("written");
    let problem = parsed(&json!({
        "version": 1, "name": "triangle", "gravity": [0, 0, 0],
        "bodies": {"triangle": {"modal": {
            "source": {"dmig": {"nodes": path("nodes"), "file": path("all.pch")}},
            "interfaces": {"a": 1, "b": 2, "c": 3}, "frame": {"chord": ["a", "b", "c"]}}}},
        "simulation": {"duration": 0.2, "steps": 10, "method": {"radau": {"stages": 3}}}
    }));
    let told = problem.flexible_bodies(&[]).concat();
    assert!(
        told.contains("the digits of its files leave a stiffness uncertain by"),
        "{told}"
    );
    let trace: f64 = (0..9).map(|k| stiffness[k][k] / 2.0).sum();
    let free = told.split(", free ").nth(1).expect("free frequencies");
    let free = free.split(" Hz").next().expect("a list");
    let sum: f64 = (free.split(", "))
        .map(|f| f.parse::<f64>().expect("a number") * std::f64::consts::TAU)
        .map(|w| w * w)
        .sum();
    assert!((sum / trace - 1.0).abs() < 5e-3, "{sum} {trace}");
}

/// A bar of four cubic elements on a ball at its clamped end, which a force of 20 N that follows it swings: the end is
/// 0.0724 m aside after 0.05 s, as that of bars of 8 and 16 elements and of a beam of assumed modes. Its inertia about
/// its own axis is small, so sums of masses that are not those of a body would make the inertia of the deformed bar
/// negative.
#[test]
fn a_coarse_bar_on_a_ball_runs() {
    let body = json!({"source": {"matrix_market": {"nodes": data("coarse_bar.nodes"), "stiffness": data("coarse_bar_k.mtx"), "mass": data("coarse_bar_m.mtx")}},
        "interfaces": {"a": 1, "z": 5}, "frame": {"clamped": "a"}, "modes": 5, "damping": {"ratio": 0.1}});
    let file = json!({
        "version": 1, "name": "bar", "gravity": [0, 0, 0], "bodies": {"b": {"modal": body, "place": {"put": "a", "at": [0, 0, 0]}}},
        "joints": {"h": {"spherical": {"between": ["b", "ground"], "at": "b.a"}}},
        "loads": {"f": {"force": {"body": "b", "point": "z", "direction": [0, 1, 0], "axes": "body", "magnitude": 20}}},
        "simulation": {"duration": 0.05, "tolerance": 1e-4, "method": {"radau": {"stages": 3}}},
        "functions": {"y": {"final": {"position": {"body": "b", "point": "z", "direction": [0, 1, 0]}}}}
    });
    let y = value(&file, "y");
    assert!((y / 0.0724 - 1.0).abs() < 5e-3, "{y}");
}
