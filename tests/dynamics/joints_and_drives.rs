//! Joints and drives in problem files: motions in closed form.

use crate::reference::documents::problem;
use flexbody_driver::simulate;
use serde_json::Value;
use std::f64::consts::{FRAC_PI_4, TAU};

/// Values of all functions.
fn values(file: &Value) -> Vec<f64> {
    let problem = problem(file);
    let motion = simulate(&problem, &problem.start()).expect("runs");
    let count = motion.at.scene.functions.len();
    (0..count).map(|f| motion.at.function(f).value).collect()
}

fn agree(what: &str, found: &[f64], exact: &[f64], tolerance: f64) {
    assert_eq!(found.len(), exact.len(), "{what}");
    for (found, exact) in found.iter().zip(exact) {
        let error = (found - exact).abs();
        assert!(
            error <= tolerance,
            "{what}: {found} against {exact}: {error:e}"
        );
    }
}

fn position(body: &str, direction: [f64; 3]) -> Value {
    json!({"final": {"position": {"body": body, "direction": direction}}})
}

fn component(what: &str, body: &str, direction: [f64; 3]) -> Value {
    json!({"final": {what: {"body": body, "direction": direction}}})
}

/// A point mass on a massless rod is the simple pendulum (MBS benchmark library, A01: positions
/// from elliptic functions).
#[test]
fn a_point_mass_on_a_rod_is_a_simple_pendulum() {
    let scene = |duration: f64, method: Value| {
        json!({
            "version": 1, "name": "pendulum",
            "bodies": {"bob": {"shape": "point", "mass": 3, "place": {"at": [-1, 0, 0]}}},
            "joints": {"rod": {"rod": {"between": ["bob", "ground"],
                                       "at": [[-1, 0, 0], [0, 0, 0]]}}},
            "simulation": {"duration": duration, "tolerance": 1e-11, "method": method},
            "functions": {"x": position("bob", [1.0, 0.0, 0.0]),
                          "y": position("bob", [0.0, 1.0, 0.0])}
        })
    };
    for (duration, exact) in [
        (1.0, [0.986_291_751_131_875, -0.165_010_853_125_541]),
        (5.0, [-0.942_305_435_043_757, -0.334_754_338_414_001]),
    ] {
        agree(
            "dop853",
            &values(&scene(duration, json!("dop853"))),
            &exact,
            1e-9,
        );
    }
    let radau = scene(1.0, json!({"radau": {"stages": 3}}));
    agree(
        "radau",
        &values(&radau),
        &[0.986_291_751_131_875, -0.165_010_853_125_541],
        1e-7,
    );
}

/// Two welded bodies move as the single body that they form.
#[test]
fn welded_bodies_move_as_one() {
    let functions = json!({
        "x": {"final": {"position": {"body": "left", "point": "tip", "direction": [1, 0, 0]}}},
        "y": {"final": {"position": {"body": "left", "point": "tip", "direction": [0, 1, 0]}}},
        "z": {"final": {"position": {"body": "left", "point": "tip", "direction": [0, 0, 1]}}}
    });
    let pivot = json!({"spherical": {"between": ["left", "ground"], "at": "left.root"}});
    let start = json!({"angular": [0.5, 1.5, 1.0], "about": [0, 0, 0]});
    let simulation = json!({"duration": 1.5, "tolerance": 1e-12, "method": "dop853"});
    let points = json!({"root": [-0.5, 0, 0], "tip": [1.5, 0, 0]});
    let half = |x: f64| {
        json!({"shape": {"box": {"size": [1, 0.2, 0.4]}}, "mass": 2,
                               "place": {"at": [x, 0, 0]}})
    };
    let mut left = half(0.5);
    left["points"] = points.clone();
    let welded = json!({
        "version": 1, "name": "welded",
        "bodies": {"left": left, "right": half(1.5)},
        "joints": {"pivot": pivot,
                   "weld": {"weld": {"between": ["left", "right"], "at": [1, 0, 0]}}},
        "initial_velocity": start, "simulation": simulation, "functions": functions
    });
    let one = json!({
        "version": 1, "name": "one",
        "bodies": {"left": {"mass": 4, "centre_of_mass": [0.5, 0, 0],
                            "inertia": {"xx": 4.0 * 0.2 / 12.0, "yy": 4.0 * 4.16 / 12.0,
                                        "zz": 4.0 * 4.04 / 12.0},
                            "points": points, "place": {"at": [0.5, 0, 0]}}},
        "joints": {"pivot": pivot},
        "initial_velocity": start, "simulation": simulation, "functions": functions
    });
    agree("weld", &values(&welded), &values(&one), 1e-10);
}

/// A body on a cylindrical joint along gravity falls freely and keeps its spin.
#[test]
fn a_body_on_a_cylindrical_joint_falls_and_spins() {
    let file = json!({
        "version": 1, "name": "screw",
        "bodies": {"nut": {"shape": {"box": {"size": [0.3, 0.2, 0.4]}}, "mass": 2,
                           "points": {"edge": [0.15, 0, 0]},
                           "velocity": {"linear": [0, 1, 0], "angular": [0, 3, 0]}}},
        "joints": {"rail": {"cylindrical": {"between": ["nut", "ground"], "at": [0, 0, 0],
                                            "axis": [0, 1, 0]}}},
        "simulation": {"duration": 0.7, "tolerance": 1e-12},
        "functions": {
            "y": position("nut", [0.0, 1.0, 0.0]),
            "x": {"final": {"position": {"body": "nut", "point": "edge", "direction": [1, 0, 0]}}},
            "z": {"final": {"position": {"body": "nut", "point": "edge", "direction": [0, 0, 1]}}}
        }
    });
    let (t, r): (f64, f64) = (0.7, 0.15);
    let exact = [
        t - 0.5 * 9.81 * t * t,
        r * (3.0 * t).cos(),
        -r * (3.0 * t).sin(),
    ];
    agree("cylindrical", &values(&file), &exact, 1e-11);
}

/// Shafts at an angle β, connected by a universal joint whose cross axis starts along the normal of
/// their plane: tan φ2 = cos β tan φ1 or its inverse, depending on the initial angle (Schmelz,
/// Seherr-Thoss & Aucktor 1992, *Universal Joints and Driveshafts*, section 1.2). The first has a
/// constant rate.
#[test]
fn a_universal_joint_passes_a_driven_turn_on() {
    let (rate, duration, beta) = (4.0, 1.1, FRAC_PI_4);
    let along = [beta.cos(), beta.sin(), 0.0];
    let file = json!({
        "version": 1, "name": "shafts", "gravity": [0, 0, 0],
        "bodies": {
            "in": {"shape": {"box": {"size": [1, 0.2, 0.1]}}, "mass": 1, "place": {"at": [-0.5, 0, 0]}},
            "out": {"shape": {"box": {"size": [1, 0.2, 0.1]}}, "mass": 2,
                    "points": {"side": [0, 0.1, 0]},
                    "place": {"at": [0.5 * along[0], 0.5 * along[1], 0],
                              "turn": {"axis": [0, 0, 1], "angle": beta}}}
        },
        "joints": {
            "bearing in": {"revolute": {"between": ["in", "ground"], "at": [-1, 0, 0],
                                        "axis": [1, 0, 0]}},
            "bearing out": {"cylindrical": {"between": ["out", "ground"],
                                            "at": along, "axis": along}},
            "cross": {"universal": {"between": ["in", "out"], "at": [0, 0, 0],
                                    "axis": {"body": "in", "axis": [0, 1, 0]},
                                    "cross": {"body": "out", "axis": [0, 0, 1]}}}
        },
        "drives": {"motor": {"joint": "bearing in", "turn": {"rate": rate}}},
        "simulation": {"duration": duration, "tolerance": 1e-11},
        "functions": {"side": {"final": {"position": {"body": "out", "point": "side",
                                                      "direction": [0, 0, 1]}}}}
    });
    // The yoke of the input is (0, cos φ1, sin φ1); that of the output, (0, 0, 1) turned by φ2
    // about its shaft, stays perpendicular to it.
    let phi: f64 = rate * duration;
    let turn = (phi.sin()).atan2(phi.cos() * beta.cos());
    // cos φ1 · (−sin φ2 cos β) + sin φ1 cos φ2 = 0 → tan φ2 = tan φ1 / cos β.
    assert!((turn.tan() - phi.tan() / beta.cos()).abs() < 1e-12);
    let exact = [0.1 * turn.sin()];
    agree("universal", &values(&file), &exact, 1e-9);
}

/// A slider-crank driven at a constant rate: position, speed and acceleration of its slider.
fn slider_crank(method: &Value, spacing: (&str, f64)) -> Value {
    let (r, l) = (0.2_f64, 0.5_f64);
    let angle = 0.3_f64;
    let rod = -(r * angle.sin() / l).asin();
    let mut file = json!({
        "version": 1, "name": "slider-crank",
        "bodies": {
            "crank": {"shape": {"rod": {"length": r, "radius": 0.02}}, "mass": 0.4,
                      "points": {"root": [-0.5 * r, 0, 0], "tip": [0.5 * r, 0, 0]},
                      "place": {"put": "root", "turn": {"axis": [0, 0, 1], "angle": angle}}},
            "rod": {"shape": {"rod": {"length": l, "radius": 0.02}}, "mass": 0.7,
                    "points": {"root": [-0.5 * l, 0, 0], "tip": [0.5 * l, 0, 0]},
                    "place": {"put": "root", "at": "crank.tip",
                              "turn": {"axis": [0, 0, 1], "angle": rod}}},
            "slider": {"shape": {"box": {"size": [0.1, 0.1, 0.1]}}, "mass": 1,
                       "place": {"at": "rod.tip"}}
        },
        "joints": {
            "shaft": {"revolute": {"between": ["crank", "ground"], "at": "crank.root",
                                   "axis": [0, 0, 1]}},
            "pin": {"revolute": {"between": ["rod", "crank"], "at": "crank.tip", "axis": [0, 0, 1]}},
            "eye": {"spherical": {"between": ["rod", "slider"], "at": "rod.tip"}},
            "rail": {"prismatic": {"between": ["slider", "ground"], "at": "rod.tip",
                                   "axis": [1, 0, 0]}}
        },
        "drives": {"motor": {"joint": "shaft", "turn": {"rate": 12}}},
        "simulation": {"duration": 1.3, "method": method},
        "functions": {
            "place": position("slider", [1.0, 0.0, 0.0]),
            "speed": component("velocity", "slider", [1.0, 0.0, 0.0]),
            "acceleration": component("acceleration", "slider", [1.0, 0.0, 0.0])
        }
    });
    file["simulation"][spacing.0] = match spacing.0 {
        "steps" => json!(spacing.1 as usize),
        _ => json!(spacing.1),
    };
    file
}

#[test]
fn a_driven_slider_crank_moves_as_its_geometry_says() {
    let (r, l, w) = (0.2_f64, 0.5_f64, 12.0_f64);
    let phi = 0.3 + w * 1.3;
    let (s, c) = phi.sin_cos();
    let root = (l * l - r * r * s * s).sqrt();
    let by_phi = -r * s - r * r * s * c / root;
    let by_phi2 = -r * c - r * r * (c * c - s * s) / root - (r * r * s * c).powi(2) / root.powi(3);
    let exact = [r * c + root, w * by_phi, w * w * by_phi2];
    for (method, spacing, tolerance) in [
        (json!("dop853"), ("tolerance", 1e-10), 1e-9),
        (json!({"radau": {"stages": 3}}), ("tolerance", 1e-10), 1e-7),
        (json!({"bdf": {"order": 2}}), ("steps", 20_000.0), 3e-3),
        (
            json!({"generalised_alpha": {"radius": 0.8}}),
            ("steps", 20_000.0),
            3e-3,
        ),
    ] {
        let found = values(&slider_crank(&method, spacing));
        agree(&method.to_string(), &found[..2], &exact[..2], tolerance);
        // The acceleration of a method is the slope of its velocities.
        agree(
            &method.to_string(),
            &found[2..],
            &exact[2..],
            1e3 * tolerance,
        );
    }
}

/// A mass that is shaken along gravity loads its drive with m (g + s̈).
#[test]
fn a_drive_bears_weight_and_inertia() {
    let (amplitude, frequency, mass, duration) = (0.02, 3.0, 2.5, 0.43);
    let file = json!({
        "version": 1, "name": "shaker",
        "bodies": {"mass": {"shape": {"box": {"size": [0.1, 0.1, 0.1]}}, "mass": mass}},
        "joints": {"table": {"prismatic": {"between": ["mass", "ground"], "at": [0, 0, 0],
                                           "axis": [0, 1, 0]}}},
        "drives": {"shaker": {"joint": "table",
                              "slide": {"harmonic": {"amplitude": amplitude,
                                                     "frequency": frequency}}}},
        "simulation": {"duration": duration, "tolerance": 1e-10},
        "functions": {"y": position("mass", [0.0, 1.0, 0.0])}
    });
    let problem = problem(&file);
    let motion = simulate(&problem, &problem.start()).expect("runs");
    let reaction = motion.reactions(motion.at.run.last())[0];
    let omega = TAU * frequency;
    let s = amplitude * (omega * duration).sin();
    assert!((motion.at.function(0).value - s).abs() < 1e-12);
    let force = mass * (9.81 - omega * omega * s);
    let found = reaction.force_ground.y;
    assert!(
        (found - force).abs() <= 1e-9 * force.abs(),
        "{found} against {force}"
    );
}

/// A nut on a cylindrical joint comes to rest by damping, along and about the axis independently.
#[test]
fn damping_acts_on_one_motion_of_a_cylindrical_joint() {
    let file = json!({
        "version": 1, "name": "nut", "gravity": [0, 0, 0],
        "bodies": {"nut": {"mass": 2, "inertia": {"xx": 0.3, "yy": 0.5, "zz": 0.4},
                           "velocity": {"linear": [0, 1, 0], "angular": [0, 3, 0]}}},
        "joints": {"rail": {"cylindrical": {"between": ["nut", "ground"], "at": [0, 0, 0],
                                            "axis": [0, 1, 0]}}},
        "loads": {
            "brake": {"damping": {"joint": "rail", "motion": "slide", "coefficient": 1.6}},
            "bearing": {"damping": {"joint": "rail", "coefficient": 0.2}}
        },
        "simulation": {"duration": 0.7, "tolerance": 1e-12},
        "functions": {
            "speed": component("velocity", "nut", [0.0, 1.0, 0.0]),
            "angle": {"final": {"rotation": {"body": "nut", "axis": [0, 1, 0]}}}
        }
    });
    let (along, about): (f64, f64) = (1.6 / 2.0, 0.2 / 0.5);
    let exact = [
        (-along * 0.7).exp(),
        3.0 / about * (1.0 - (-about * 0.7).exp()),
    ];
    agree("damping", &values(&file), &exact, 1e-11);
}
