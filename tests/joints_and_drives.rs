//! Joints and drives in problem files: motions that are known in closed form, and exact gradients in
//! every number of every kind of drive and of the joints that springs of freedom are taken from.

use flexbody::driver::{check, simulate};
use flexbody::problem::Problem;
use serde_json::{Value, json};
use std::f64::consts::{FRAC_PI_4, TAU};

fn problem(file: &Value) -> Problem {
    Problem::parse(&file.to_string(), "scene.json", &[]).unwrap_or_else(|faults| panic!("{faults}"))
}

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

/// A point mass on a rod without mass is the simple pendulum (MBS benchmark library, A01: positions
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

/// Two bodies that are welded move as the one that they make.
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

/// On a cylindrical joint along gravity a body falls freely and keeps its spin.
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

/// Shafts at an angle β, joined by a universal joint whose cross axis starts in their plane's normal:
/// tan φ2 = cos β tan φ1 or its inverse, by where the turn starts (Schmelz, Seherr-Thoss & Aucktor
/// 1992, *Universal Joints and Driveshafts*, section 1.2). The first is driven at a constant rate.
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

/// A slider-crank driven at a constant rate: the place, speed and acceleration of its slider.
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
        // The acceleration as a method sees it: the slope of its velocities.
        agree(
            &method.to_string(),
            &found[2..],
            &exact[2..],
            1e3 * tolerance,
        );
    }
}

/// A mass that is shaken along gravity presses on its drive with m (g + s̈).
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

/// Gradients in the duration, a length and every number of the drives and joints named, against the
/// complex step: to 1e-12 of themselves or of the function's largest.
fn assert_gradients(mut file: Value, sections: &[&str]) {
    let mut paths = vec!["/simulation/duration".to_owned()];
    for section in sections {
        let value = file.pointer(section).expect("a section").clone();
        numbers(&value, section, &mut paths);
    }
    for path in &paths {
        file["variables"][path] = json!({"path": path, "lower": -1e3});
        if path.contains("length") || path.contains("duration") || path.contains("mass") {
            file["variables"][path]["lower"] = json!(1e-3);
        }
    }
    let problem = problem(&file);
    let found = check(&problem, &problem.start()).expect("runs");
    assert_eq!(found.len(), 3 * paths.len());
    for derivative in &found {
        let of_function = found.iter().filter(|d| d.function == derivative.function);
        let largest = of_function.fold(0.0_f64, |m, d| m.max(d.complex_step.abs()));
        let difference = (derivative.adjoint - derivative.complex_step).abs();
        assert!(
            difference <= 1e-12 * largest,
            "{} of function {}: {} against {} (largest {largest:e})",
            problem.variables[derivative.variable].name,
            derivative.function,
            derivative.adjoint,
            derivative.complex_step
        );
    }
    for variable in 0..paths.len() {
        let mut of = found.iter().filter(|d| d.variable == variable);
        assert!(
            of.any(|d| d.complex_step != 0.0),
            "{} moves nothing",
            paths[variable]
        );
    }
}

fn numbers(value: &Value, at: &str, out: &mut Vec<String>) {
    match value {
        Value::Number(_) => out.push(at.to_owned()),
        Value::Array(items) => {
            for (k, item) in items.iter().enumerate() {
                numbers(item, &format!("{at}/{k}"), out);
            }
        }
        Value::Object(entries) => {
            for (key, item) in entries.iter().filter(|(key, _)| *key != "times") {
                numbers(item, &format!("{at}/{key}"), out);
            }
        }
        _ => {}
    }
}

/// An arm that a motor turns, with a slide on it that another moves; a weight hangs from the slide
/// by a rod, a vane by a universal joint, and a box is welded to it.
fn machine(turn: Value, slide: Value, simulation: Value) -> Value {
    json!({
        "version": 1, "name": "machine",
        "bodies": {
            "arm": {"shape": {"box": {"size": [1, 0.1, 0.2]}}, "mass": 1,
                    "points": {"root": [-0.5, 0, 0]}, "place": {"put": "root"}},
            "slide": {"shape": {"box": {"size": [0.2, 0.3, 0.1]}}, "mass": 0.5,
                      "place": {"at": [0.4, 0.1, 0]}},
            "weight": {"shape": "point", "mass": 0.3, "place": {"at": [0.6, -0.6, 0.2]}},
            "box": {"shape": {"box": {"size": [0.1, 0.2, 0.3]}}, "mass": 0.2,
                    "place": {"at": [0.5, 0.3, 0.1]}},
            "vane": {"shape": {"box": {"size": [0.1, 0.4, 0.3]}}, "mass": 0.3,
                     "points": {"top": [0, 0.2, 0]},
                     "place": {"put": "top", "at": [0.4, 0, 0.1]},
                     "velocity": {"angular": [0.5, 0, 0.8]}}
        },
        "joints": {
            "shaft": {"revolute": {"between": ["arm", "ground"], "at": "arm.root",
                                   "axis": [0.1, 0.2, 1]}},
            "guide": {"cylindrical": {"between": ["slide", "arm"], "at": [0.4, 0, 0],
                                      "axis": [1, 0, 0]}},
            "rope": {"rod": {"between": ["weight", "slide"], "at": {"a": [0, 0, 0],
                                                                    "b": [0.1, 0, 0]}}},
            "plate": {"weld": {"between": ["slide", "box"], "at": [0.5, 0.2, 0]}},
            "cardan": {"universal": {"between": ["slide", "vane"], "at": "vane.top",
                                     "axis": [0, 0, 1], "cross": [1, 0, 0]}}
        },
        "drives": {
            "motor": {"joint": "shaft", "turn": turn},
            "spindle": {"joint": "guide", "slide": slide, "turn": {"rate": 0.8}}
        },
        "simulation": simulation,
        "functions": {
            "place": position("weight", [0.6, 0.5, 0.4]),
            "energy": {"integral": {"energy": "total"}},
            "jerk": {"ks": {"rho": 0.5, "of": {"acceleration": {"body": "vane",
                                                                "direction": [0.3, 0.8, 0.2]}}}}
        },
        "variables": {}
    })
}

#[test]
fn gradients_of_explicit_steps() {
    let table = json!({"table": {"times": [0, 0.1, 0.25, 0.4, 0.6],
                                 "values": [0, 0.05, -0.04, 0.1, 0.05]}});
    let polynomial = json!({"polynomial": [0, 1.5, -2, 1]});
    let simulation = json!({"duration": 0.5, "tolerance": 1e-8, "samples": 60});
    let file = machine(polynomial, table, simulation);
    assert_gradients(file, &["/drives", "/bodies/weight", "/bodies/slide/mass"]);
}

#[test]
fn gradients_of_implicit_steps() {
    let harmonic = |amplitude: f64| json!({"harmonic": {"amplitude": amplitude, "frequency": 1.1, "phase": 0.4, "mean": -0.02}});
    for method in [
        json!({"radau": {"stages": 2}}),
        json!({"bdf": {"order": 2}}),
        json!({"generalised_alpha": {"radius": 0.8}}),
    ] {
        let simulation = json!({"duration": 0.4, "steps": 40, "method": method});
        let mut file = machine(harmonic(0.4), harmonic(0.05), simulation);
        file["joints"]["rope"]["rod"]["length"] = json!(0.75);
        assert_gradients(
            file,
            &["/drives", "/joints/rope/rod/length", "/bodies/weight"],
        );
    }
}

/// What drives and joints cannot be told, and where.
#[test]
fn faults_are_named() {
    let harmonic = json!({"harmonic": {"amplitude": 0.1, "frequency": 1}});
    let simulation = json!({"duration": 0.1, "steps": 4});
    let good = machine(harmonic.clone(), harmonic, simulation);
    let fault = |path: &str, value: Value| {
        let mut file = good.clone();
        match file.pointer_mut(path) {
            Some(place) => *place = value,
            None => {
                let (parent, key) = path.rsplit_once('/').expect("a path");
                file.pointer_mut(parent).expect("a parent")[key] = value;
            }
        }
        let faults = Problem::parse(&file.to_string(), "scene.json", &[]);
        faults
            .err()
            .unwrap_or_else(|| panic!("{path} is no fault"))
            .to_string()
    };
    let expect = |text: String, parts: &[&str]| {
        for part in parts {
            assert!(text.contains(part), "\"{part}\" is not in:\n{text}");
        }
    };
    expect(
        fault("/drives/motor/joint", json!("shaf")),
        &["/drives/motor/joint", "\"shaf\"", "did you mean \"shaft\""],
    );
    expect(
        fault("/drives/motor/joint", json!("rope")),
        &[
            "\"rope\", which is rod",
            "revolute or planar or cylindrical",
        ],
    );
    expect(
        fault("/drives/motor", json!({"joint": "shaft"})),
        &[
            "/drives/motor",
            "a drive without motion",
            "\"turn\" or \"slide\"",
        ],
    );
    expect(
        fault(
            "/drives/second",
            json!({"joint": "shaft", "turn": {"rate": 1}}),
        ),
        &["/drives/second/joint", "which \"motor\" drives"],
    );
    expect(
        fault("/drives/motor/turn", json!({"polynomial": []})),
        &["/drives/motor/turn/polynomial", "no coefficient"],
    );
    expect(
        fault(
            "/drives/motor/turn",
            json!({"table": {"times": [0, 0], "values": [1]}}),
        ),
        &["2 times and 1 values", "times that increase"],
    );
    expect(
        fault("/joints/plate/weld/between/1", json!("weight")),
        &["/joints/plate/weld/between/1", "point mass"],
    );
    expect(
        fault(
            "/joints/rope/rod/at",
            json!({"a": [0, 0, 0], "b": [0.2, -0.7, 0.2]}),
        ),
        &["/joints/rope/rod/at", "ends at the same place"],
    );
    expect(
        fault("/joints/cardan/universal/cross", json!([0, 0, 2])),
        &["/joints/cardan/universal/cross", "perpendicular"],
    );
    // A second hinge on the shaft's axis, with a motor of its own.
    let mut twice = good.clone();
    twice["joints"]["hinge"] = json!({"revolute": {"between": ["arm", "ground"],
                                                   "at": "arm.root", "axis": [0.1, 0.2, 1]}});
    twice["drives"]["other"] = json!({"joint": "hinge", "turn": {"rate": 1}});
    let faults = Problem::parse(&twice.to_string(), "scene.json", &[]);
    expect(
        faults.expect_err("is driven twice").to_string(),
        &["/drives/other/joint", "leave free"],
    );
}
