//! Bushings against closed forms: coupled stiffness at rest, vibrations, energy and momentum, derivatives by every method,
//! families, rotation on spherical and universal joints; torsion springs with a cubic term.

use crate::reference::documents::{methods, problem as parsed, reversed, values, vary};
use crate::reference::gradients::gradients_are_exact;
use serde_json::Value;
use std::f64::consts::TAU;

fn close(found: f64, exact: f64, tolerance: f64, what: &str) {
    let off = (found - exact).abs();
    assert!(
        off <= tolerance * exact.abs().max(1e-12),
        "{what}: {found} {exact} {off:e}"
    );
}

/// A block of 3 kg on a bushing whose displacement along y and rotation about z are coupled.
fn block(k: f64, kt: f64, mixed: f64) -> Value {
    let mut rows = vec![[0.0; 6]; 6];
    let diagonal = [900.0, k, 700.0, 50.0, 60.0, kt];
    for (i, row) in rows.iter_mut().enumerate() {
        row[i] = diagonal[i];
    }
    (rows[1][5], rows[5][1]) = (mixed, mixed);
    json!({
        "version": 1, "name": "block", "analysis": "rest", "gravity": [0, -1e-3, 0],
        "bodies": {"block": {"mass": 3, "inertia": {"xx": 0.1, "yy": 0.2, "zz": 0.3}}},
        "joints": {"mount": {"free": {"between": ["block", "ground"], "at": [0, 0, 0]}}},
        "loads": {"mount": {"bushing": {"joint": "mount", "stiffness": {"rows": rows}}}},
        "functions": {
            "sag": {"final": {"position": {"body": "block", "direction": [0, 1, 0]}}},
            "tilt": {"final": {"rotation": {"body": "block", "axis": [0, 0, 1]}}},
            "lowest": {"frequency": {"mode": 1}}
        }
    })
}

/// The force −m g along y turns the block too: (y, θ) = K⁻¹ (−m g, 0).
#[test]
fn coupled_stiffness_turns_what_a_force_moves() {
    let (k, kt, mixed) = (800.0_f64, 40.0_f64, 90.0_f64);
    let found = values(&block(k, kt, mixed));
    let weight = -3e-3;
    let determinant = k * kt - mixed * mixed;
    // To first order in the load.
    close(found[0], weight * kt / determinant, 1e-5, "sag");
    close(found[1], -weight * mixed / determinant, 1e-5, "tilt");
    // The two coupled vibrations: M ω² = K with m and J about z.
    let (a, b) = (k / 3.0 + kt / 0.3, determinant / (3.0 * 0.3));
    let slow = (0.5 * (a - (a * a - 4.0 * b).sqrt())).sqrt() / TAU;
    close(found[2], slow, 1e-5, "frequency");
    let alone = values(&block(k, kt, 0.0));
    close(alone[0], weight / k, 1e-9, "sag alone");
    let rates = [900.0 / 3.0, k / 3.0, 700.0 / 3.0, 500.0, 300.0, kt / 0.3];
    let least = rates.into_iter().fold(f64::INFINITY, f64::min);
    close(alone[2], least.sqrt() / TAU, 1e-6, "frequency alone");
}

/// Two bodies that a bushing with all couplings holds together, in free flight or on a hinge.
fn pair(simulation: Value, damped: bool) -> Value {
    let entry = |i: usize, k: usize, size: f64| {
        let mixed = 0.11 * size * ((1 + i * k + i + k) as f64).sin();
        if i == k {
            size * (1.0 + 0.1 * i as f64)
        } else {
            mixed
        }
    };
    let matrix = |size: f64| -> Vec<Vec<f64>> {
        (0..6)
            .map(|i| (0..6).map(|k| entry(i, k, size)).collect())
            .collect()
    };
    let mut document = json!({
        "version": 1, "name": "pair", "gravity": [0, 0, 0],
        "bodies": {
            "base": {"mass": 2, "inertia": {"xx": 0.3, "yy": 0.4, "zz": 0.5},
                     "velocity": {"linear": [0.3, -0.1, 0.2], "angular": [0.2, -0.7, 1.1]}},
            "cap": {"mass": 1.3, "centre_of_mass": [0.1, 0.05, -0.1], "inertia": {"xx": 0.2, "yy": 0.25, "zz": 0.15},
                    "place": {"at": [0.4, 0.3, 0.1], "turn": {"axis": [1, 2, 3], "angle": 0.4}},
                    "velocity": {"linear": [-0.2, 0.4, 0.5], "angular": [0.9, 0.3, -0.6]}}
        },
        "joints": {"mount": {"free": {"between": ["cap", "base"], "at": [0.35, 0.2, 0.15], "axis": [1, 0.5, 0.2],
                                      "cross": [0, 0.3, 1]}}},
        "loads": {"mount": {"bushing": {"joint": "mount", "stiffness": {"rows": matrix(25.0)}, "damping": {"rows": matrix(0.4)}}}},
        "simulation": simulation,
        "functions": {
            "energy": {"final": {"energy": "total"}},
            "start": {"value": {"at": 0, "of": {"energy": "total"}}},
            "spin": {"final": {"angular_momentum": {"direction": [0.3, 0.5, -0.8]}}},
            "spin before": {"value": {"at": 0, "of": {"angular_momentum": {"direction": [0.3, 0.5, -0.8]}}}},
            "push": {"final": {"momentum": {"direction": [0.6, 0, 0.8]}}},
            "place": {"final": {"position": {"body": "cap", "direction": [0.5, 0.5, 0.7]}}}
        }
    });
    if !damped {
        let own = document["loads"]["mount"]["bushing"].as_object_mut();
        own.expect("a bushing").remove("damping");
    }
    document
}

#[test]
fn energy_and_momentum_are_kept() {
    let found = values(&pair(json!({"duration": 4, "tolerance": 1e-11}), false));
    close(found[0], found[1], 1e-9, "energy");
    close(found[2], found[3], 1e-9, "angular momentum");
    let push = 0.6 * (2.0 * 0.3 - 1.3 * 0.2) + 0.8 * (2.0 * 0.2 + 1.3 * 0.5);
    // The velocity of a body is that of its centre of mass.
    close(found[4], push, 1e-9, "momentum");
    let damped = values(&pair(json!({"duration": 4, "tolerance": 1e-11}), true));
    assert!(damped[0] < damped[1], "{damped:?}");
    close(damped[2], damped[3], 1e-9, "angular momentum");
}

#[test]
fn gradients_by_every_method() {
    for simulation in methods(0.7, 100) {
        let mut document = pair(simulation.clone(), true);
        let paths = [
            "/loads/mount/bushing/stiffness/rows/0/0",
            "/loads/mount/bushing/stiffness/rows/1/4",
            "/loads/mount/bushing/stiffness/rows/5/2",
            "/loads/mount/bushing/damping/rows/3/3",
            "/loads/mount/bushing/damping/rows/2/5",
            "/joints/mount/free/at/0",
            "/joints/mount/free/axis/1",
            "/joints/mount/free/cross/0",
            "/bodies/cap/mass",
        ];
        vary(
            &mut document,
            &paths[..7]
                .iter()
                .chain(&paths[8..])
                .map(|path| (*path).to_owned())
                .collect::<Vec<_>>(),
        );
        let functions = document["functions"].as_object_mut().expect("functions");
        functions.retain(|name, _| ["energy", "spin", "place"].contains(&name.as_str()));
        functions.insert(
            "power".into(),
            json!({"integral": {"power": {"load": "mount"}}}),
        );
        // Inner forces change no momentum.
        functions.remove("spin");
        gradients_are_exact(&parsed(&document), &simulation);
    }
    let mut rest = block(800.0, 40.0, 90.0);
    rest["gravity"] = json!([0, -9.81, 0]);
    vary(
        &mut rest,
        &[
            "/loads/mount/bushing/stiffness/rows/1/1",
            "/loads/mount/bushing/stiffness/rows/1/5",
            "/bodies/block/mass",
        ]
        .map(String::from),
    );
    gradients_are_exact(&parsed(&rest), &json!("rest"));
}

/// In another order, and as a matrix whose rows are a diagonal.
#[test]
fn the_same_in_other_descriptions() {
    let document = pair(json!({"duration": 1, "tolerance": 1e-10}), true);
    let reference = values(&document);
    let other = reversed(&document, &["bodies"]);
    for (a, b) in values(&other).into_iter().zip(&reference) {
        assert!((a - b).abs() < 1e-7 * b.abs().max(0.1), "{a} {b}");
    }
    let mut plain = document.clone();
    plain["loads"]["mount"]["bushing"] =
        json!({"joint": "mount", "stiffness": {"diagonal": [10, 20, 30, 4, 5, 6]}});
    let mut rows = plain.clone();
    let matrix: Vec<Vec<i32>> = (0..6)
        .map(|i| {
            (0..6)
                .map(|k| if i == k { [10, 20, 30, 4, 5, 6][i] } else { 0 })
                .collect()
        })
        .collect();
    rows["loads"]["mount"]["bushing"]["stiffness"] = json!({"rows": matrix});
    for (a, b) in values(&rows).into_iter().zip(values(&plain)) {
        assert!((a - b).abs() < 1e-12 * b.abs().max(0.1), "{a} {b}");
    }
}

/// Rotation on a ball: a disc swings with √(k/J) about any axis for small angles; sin φ cos φ for large ones, as
/// V = ½ k sin² φ.
#[test]
fn balls_and_crosses_have_torsion() {
    for (kind, cross) in [("spherical", false), ("universal", true)] {
        let mut joint = json!({"between": ["disc", "ground"], "at": [0, 0, 0]});
        if cross {
            joint["axis"] = json!([1, 0, 0]);
            joint["cross"] = json!([0, 1, 0]);
        }
        let document = json!({
            "version": 1, "name": "ball", "gravity": [0, 0, 0],
            "bodies": {"disc": {"mass": 1, "inertia": {"xx": 0.2, "yy": 0.2, "zz": 0.2},
                                "velocity": {"angular": [0.9, 0, 0]}}},
            "joints": {"ball": {kind: joint}},
            "loads": {"torsion": {"bushing": {"joint": "ball", "stiffness": {"diagonal": [0, 0, 0, 5, 5, 5]}}}},
            "simulation": {"duration": 3, "tolerance": 1e-10,
                           "until": {"measure": {"angular_velocity": {"body": "disc", "direction": [1, 0, 0]}}, "reaches": 0}},
            "functions": {"turn": {"final": {"rotation": {"body": "disc", "axis": [1, 0, 0]}}}}
        });
        // ½ J ω² = ½ k sin² φ.
        let exact = (0.9 * (0.2_f64 / 5.0).sqrt()).asin();
        close(values(&document)[0], exact, 1e-7, kind);
    }
}

/// A disc on k x + k3 x³ turns back where ½ J ω² = ½ k x² + ¼ k3 x⁴, after more than a turn, with derivatives.
#[test]
fn torsion_springs_have_a_cubic_term() {
    let (k, k3, inertia, rate) = (0.1_f64, 0.02_f64, 0.5_f64, 9.0_f64);
    let mut document = json!({
        "version": 1, "name": "cubic", "gravity": [0, 0, 0],
        "bodies": {"disc": {"mass": 1, "inertia": {"xx": inertia, "yy": inertia, "zz": inertia}}},
        "joints": {"axle": {"revolute": {"between": ["disc", "ground"], "at": [0, 0, 0], "axis": [0, 0, 1],
                                         "start": {"turn": {"angle": 0, "rate": rate}}}}},
        "loads": {"spring": {"torsion_spring": {"joint": "axle", "stiffness": k, "cubic": k3}}},
        "simulation": {"duration": 9, "tolerance": 1e-10,
                       "until": {"measure": {"angle_rate": {"joint": "axle"}}, "reaches": 0}},
        "functions": {"turn": {"final": {"angle": {"joint": "axle"}}},
                      "torque": {"final": {"spring_torque": {"load": "spring"}}}}
    });
    let energy: f64 = 0.5 * inertia * rate * rate;
    let square = (-k + (k * k + 4.0 * k3 * energy).sqrt()) / k3;
    let x = square.sqrt();
    let found = values(&document);
    assert!(x > TAU, "{x}");
    close(found[0], x, 1e-8, "angle");
    close(found[1], k * x + k3 * x * square, 1e-8, "torque");
    document["simulation"] = json!({"duration": 2, "tolerance": 1e-8});
    vary(
        &mut document,
        &[
            "/loads/spring/torsion_spring/stiffness",
            "/loads/spring/torsion_spring/cubic",
        ]
        .map(String::from),
    );
    document["functions"]["energy"] = json!({"integral": {"energy": "potential"}});
    gradients_are_exact(&parsed(&document), &json!("cubic"));
}
