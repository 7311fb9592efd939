//! Loads in problem files: exact gradients in every number of every kind of load, and motions in
//! closed form.

use crate::numbers;

use flexbody_driver::{check, simulate};
use flexbody_problem::Problem;
use numbers::numbers;
use serde_json::Value;

/// Half a second by BDF2 with a start of rising order.
fn bdf(steps: usize) -> Value {
    let method = json!({"bdf": {"order": 2, "start": "rising_order"}});
    json!({"duration": 0.5, "steps": steps, "method": method})
}

/// A slider on a rail, an arm on a hinge, and a box on the arm by a ball joint.
fn scene(load: &Value) -> Value {
    json!({
        "version": 1,
        "name": "loaded",
        "bodies": {
            "slider": {"shape": {"box": {"size": [0.2, 0.1, 0.1]}}, "mass": 2,
                       "velocity": {"linear": [0.4, 0, 0]}},
            "arm": {"shape": {"box": {"size": [1, 0.1, 0.1]}}, "mass": 1,
                    "points": {"root": [-0.5, 0, 0], "tip": [0.5, 0, 0]},
                    "place": {"put": "root", "turn": {"axis": [0, 0, 1], "angle": -0.3}},
                    "velocity": {"linear": [0, 0.5, 0], "angular": [0, 0, 1]}},
            "box": {"shape": {"box": {"size": [0.3, 0.2, 0.4]}}, "mass": 0.7,
                    "points": {"top": [0, 0.1, 0], "side": [0.15, 0, 0.1]},
                    "place": {"put": "top", "at": "arm.tip"},
                    "velocity": {"angular": [0.3, 0.8, -0.4]}}
        },
        "joints": {
            "rail": {"prismatic": {"between": ["slider", "ground"], "at": [0, 0, 0],
                                   "axis": [1, 0, 0]}},
            "hinge": {"revolute": {"between": ["arm", "slider"], "at": "arm.root",
                                   "axis": [0, 0, 1]}},
            "ball": {"spherical": {"between": ["box", "arm"], "at": "arm.tip"}}
        },
        "loads": {"load": load},
        "simulation": bdf(100),
        "functions": {
            "place": {"final": {"position": {"body": "box", "point": "side",
                                             "direction": [0.6, 0.5, 0.4]}}},
            "energy": {"integral": {"energy": "total"}},
            "jerk": {"ks": {"rho": 0.5, "of": {"acceleration": {"body": "box",
                                                                "direction": [0.3, 0.8, 0.2]}}}}
        },
        "variables": {
            "duration": {"path": "/simulation/duration", "lower": 0.1},
            "tip": {"path": "/bodies/arm/points/tip/0"},
            "angle": {"path": "/bodies/arm/place/turn/angle"}
        }
    })
}

/// Gradients in the duration, a length and an angle of the scene, and every number of the load: to
/// 1e-12 of themselves, or to 1e-14 of the function's largest, whose round-off affects the small
/// ones.
fn assert_gradients(load: Value) {
    assert_gradients_of(&json!({"load": load}), bdf(100));
}

fn assert_gradients_of(loads: &Value, simulation: Value) {
    let mut file = scene(&json!({}));
    file["loads"] = loads.clone();
    file["simulation"] = simulation;
    let mut paths = Vec::new();
    numbers(loads, "/loads", &mut paths);
    for path in &paths {
        let start = file
            .pointer(path)
            .and_then(Value::as_f64)
            .expect("a number");
        let mut variable = json!({"path": path});
        if start > 0.0 {
            variable["lower"] = json!(0.1 * start);
        }
        file["variables"][path] = variable;
    }
    let problem = Problem::parse(&file.to_string(), "loaded.json", &[])
        .unwrap_or_else(|faults| panic!("{faults}"));
    assert_eq!(problem.variables.len(), 3 + paths.len());
    let mut moved = 0;
    let found = check(&problem, &problem.start()).expect("runs");
    for derivative in &found {
        let of_function = found.iter().filter(|d| d.function == derivative.function);
        let largest = of_function.fold(0.0_f64, |m, d| m.max(d.complex_step.abs()));
        let difference = (derivative.adjoint - derivative.complex_step).abs();
        moved += usize::from(derivative.complex_step.abs() > 1e-6 * largest);
        let name = &problem.variables[derivative.variable].name;
        let exact = derivative.complex_step.abs();
        assert!(
            difference <= 1e-12 * exact || difference <= 1e-14 * largest,
            "{loads}: {name}: {derivative:?}"
        );
    }
    // Every variable changes a function.
    assert!(moved >= problem.variables.len(), "{loads}: {moved}");
}

#[test]
fn gradients_of_forces_and_torques() {
    let courses = [
        json!(3.0),
        json!({"harmonic": {"amplitude": 4.0, "frequency": 1.7, "phase": 0.4}}),
        json!({"table": {"times": [0, 0.1, 0.3, 0.6], "values": [1, 2.5, 3, 6]}}),
        json!({"table": {"times": [0, 0.1, 0.3, 0.6], "values": [1, 2.5, 3, 2],
                         "interpolation": "linear"}}),
        json!({"table": {"times": [0, 0.1, 0.3, 0.6], "values": [1, 2.5, 3, 2],
                         "interpolation": "spline"}}),
    ];
    for magnitude in courses {
        for axes in ["ground", "body"] {
            let direction = json!([0.3, 0.9, 0.5]);
            assert_gradients(json!({"force": {
                "body": "box", "point": [0.1, 0.05, -0.1], "direction": direction, "axes": axes,
                "magnitude": magnitude}}));
            assert_gradients(json!({"torque": {
                "body": "box", "direction": direction, "axes": axes, "magnitude": magnitude}}));
        }
    }
    assert_gradients(json!({"force": {
        "body": "arm", "at": [0.4, 0.2, 0.1], "direction": [0.2, 1, 0], "magnitude": 5}}));
}

#[test]
fn gradients_of_springs() {
    assert_gradients(json!({"spring": {
        "between": ["box", "ground"], "at": {"a": "side", "b": [0.2, 0.7, 0.3]},
        "rest_length": 0.6, "stiffness": 40, "cubic": 30, "damping": 0.8}}));
    assert_gradients(json!({"spring": {
        "between": ["ground", "arm"], "at": [[0.1, 0.9, 0.1], [0.3, -0.2, 0]],
        "rest_length": 0.7, "stiffness": 50, "damping": 1.1}}));
    assert_gradients(json!({"spring": {
        "between": ["slider", "box"], "at": {"a": [0, 0.05, 0], "b": "side"},
        "rest_length": 0.9, "stiffness": 60}}));
    assert_gradients(json!({"torsion_spring": {
        "joint": "hinge", "rest_angle": 0.4, "stiffness": 12, "damping": 0.3}}));
}

#[test]
fn gradients_of_damping_and_friction() {
    for joint in ["rail", "hinge", "ball"] {
        assert_gradients(json!({"damping": {"joint": joint, "coefficient": 0.9}}));
    }
    for joint in ["rail", "hinge"] {
        assert_gradients(json!({"friction": {"joint": joint, "size": 1.5, "width": 0.3}}));
    }
}

#[test]
fn gradients_of_drag() {
    assert_gradients(json!({"drag": {
        "body": "box", "point": [0.1, 0.05, -0.1], "coefficient": 0.9, "width": 0.3}}));
}

/// A fall from rest with drag has the velocity v tanh(g t / v), v² = m g / c.
#[test]
fn a_fall_with_drag_comes_to_its_terminal_velocity() {
    let (mass, coefficient): (f64, f64) = (2.0, 0.5);
    for (duration, method) in [
        (0.7_f64, json!("dop853")),
        (20.0, json!({"radau": {"stages": 3}})),
    ] {
        let file = json!({
            "version": 1, "name": "fall",
            "bodies": {"drop": {"shape": "point", "mass": mass}},
            "loads": {"air": {"drag": {"body": "drop", "coefficient": coefficient}}},
            "simulation": {"duration": duration, "method": method},
            "functions": {"v": {"final": {"velocity": {"body": "drop", "direction": [0, -1, 0]}}}}
        });
        let problem = Problem::parse(&file.to_string(), "fall.json", &[])
            .unwrap_or_else(|faults| panic!("{faults}"));
        let found = simulate(&problem, &[]).expect("runs").at.function(0).value;
        let terminal = (mass * 9.81 / coefficient).sqrt();
        let exact = terminal * (9.81 * duration / terminal).tanh();
        assert!((found - exact).abs() < 1e-6, "{found} {exact}");
    }
}

/// All kinds of load at once by every method, with equal and adaptive steps. Explicit methods need
/// only forces, implicit ones also their Jacobians.
#[test]
fn gradients_by_every_method() {
    let loads = json!({
        "force": {"force": {
            "body": "box", "point": [0.1, 0.05, -0.1], "direction": [0.3, 0.9, 0.5], "axes": "body",
            "magnitude": {"harmonic": {"amplitude": 4.0, "frequency": 1.7, "phase": 0.4}}}},
        "torque": {"torque": {
            "body": "box", "direction": [0.3, 0.9, 0.5],
            "magnitude": {"table": {"times": [0, 0.1, 0.3, 0.6], "values": [1, 2.5, 3, 6]}}}},
        "spring": {"spring": {
            "between": ["box", "ground"], "at": {"a": "side", "b": [0.2, 0.7, 0.3]},
            "rest_length": 0.6, "stiffness": 40, "cubic": 30, "damping": 0.8}},
        "torsion": {"torsion_spring": {
            "joint": "hinge", "rest_angle": 0.4, "stiffness": 12, "damping": 0.3}},
        "damping": {"damping": {"joint": "ball", "coefficient": 0.2}},
        "friction": {"friction": {"joint": "rail", "size": 1.5, "width": 0.3}}
    });
    let methods = [
        json!("dop853"),
        json!({"radau": {"stages": 2}}),
        json!({"radau": {"stages": 3}}),
        json!({"bdf": {"order": 2}}),
        json!({"bdf": {"order": 3, "start": "rising_order"}}),
        json!({"generalised_alpha": {"radius": 0.8}}),
    ];
    let fixed = methods
        .iter()
        .map(|m| json!({"duration": 0.5, "steps": 60, "method": m}));
    let adaptive = methods[..3].iter();
    let adaptive = adaptive.map(|m| json!({"duration": 0.5, "tolerance": 1e-7, "method": m}));
    for simulation in fixed.chain(adaptive) {
        assert_gradients_of(&loads, simulation);
    }
}

/// A body of 2 kg and 0.1 kg m² about z on a rail along x or a hinge about z, without gravity.
fn one_body(joint: &str, axis: [f64; 3], velocity: Value, load: Value, function: Value) -> f64 {
    let file = json!({
        "version": 1, "name": "one", "gravity": [0, 0, 0],
        "bodies": {"body": {"mass": 2, "inertia": {"xx": 0.1, "yy": 0.1, "zz": 0.1},
                            "velocity": velocity}},
        "joints": {"joint": {joint: {"between": ["body", "ground"], "at": [0, 0, 0],
                                     "axis": axis}}},
        "loads": {"load": load},
        "simulation": {"duration": 1, "steps": 4000},
        "functions": {"f": {"final": function}}
    });
    let problem = Problem::parse(&file.to_string(), "one.json", &[])
        .unwrap_or_else(|faults| panic!("{faults}"));
    let run = simulate(&problem, &[]).expect("runs");
    run.at.function(0).value
}

fn along(joint: &str) -> ([f64; 3], Value, Value) {
    let x = json!({"position": {"body": "body", "direction": [1, 0, 0]}});
    let turn = json!({"rotation": {"body": "body", "axis": [0, 0, 1]}});
    match joint {
        "prismatic" => ([1.0, 0.0, 0.0], json!({"linear": [1, 0, 0]}), x),
        _ => ([0.0, 0.0, 1.0], json!({"angular": [0, 0, 1]}), turn),
    }
}

/// Motions of one coordinate in closed form, with unit rate at the start, by BDF2 with 4000 steps,
/// to 2e-6.
#[test]
fn motions_in_closed_form() {
    let m: f64 = 2.0;
    let j: f64 = 0.1;
    let pi = std::f64::consts::PI;
    let cases: Vec<(&str, Value, f64)> = vec![
        (
            "prismatic",
            json!({"force": {"body": "body", "direction": [3, 0, 0], "magnitude": 4}}),
            1.0 + 0.5 * 4.0 / m,
        ),
        (
            "prismatic",
            // ẍ = (A/m) sin(2π t): x = t (1 + A/(2π m)) − A/(4π² m) sin(2π t).
            json!({"force": {"body": "body", "direction": [1, 0, 0],
                   "magnitude": {"harmonic": {"amplitude": 5, "frequency": 1}}}}),
            1.0 + 5.0 / (2.0 * pi * m),
        ),
        (
            "prismatic",
            // Level, smooth step 3 s² − 2 s³ from 0 to 4 over 1 s: ∫∫ = 4 (1/4 − 1/10).
            json!({"force": {"body": "body", "direction": [1, 0, 0],
                   "magnitude": {"table": {"times": [0, 1], "values": [0, 4]}}}}),
            1.0 + 4.0 * 0.15 / m,
        ),
        (
            "revolute",
            json!({"torque": {"body": "body", "direction": [0, 0, 2], "magnitude": 0.3}}),
            1.0 + 0.5 * 0.3 / j,
        ),
        (
            // Spring along the rail, from a point 1 m behind, at rest length at the start.
            "prismatic",
            json!({"spring": {"between": ["body", "ground"], "at": [[0, 0, 0], [-1, 0, 0]],
                   "rest_length": 1, "stiffness": 18}}),
            (3.0_f64).sin() / 3.0,
        ),
        (
            // Critically damped: x = t exp(−ω t), ω = 3.
            "prismatic",
            json!({"spring": {"between": ["ground", "body"], "at": [[-1, 0, 0], [0, 0, 0]],
                   "rest_length": 1, "stiffness": 18, "damping": 12}}),
            (-3.0_f64).exp(),
        ),
        (
            // m v' = −c v²: x = (m/c) ln(1 + c t / m).
            "prismatic",
            json!({"drag": {"body": "body", "coefficient": 3, "width": 1e-4}}),
            m / 3.0 * (1.0 + 3.0 / m).ln(),
        ),
        (
            // About a rest angle a: φ = a + (1/ω) sin ω t − a cos ω t, ω = 2.
            "revolute",
            json!({"torsion_spring": {"joint": "joint", "rest_angle": 0.5, "stiffness": 0.4}}),
            0.5 + 0.5 * (2.0_f64).sin() - 0.5 * (2.0_f64).cos(),
        ),
        (
            "prismatic",
            json!({"damping": {"joint": "joint", "coefficient": 3}}),
            m / 3.0 * (1.0 - (-3.0 / m).exp()),
        ),
        (
            "revolute",
            json!({"damping": {"joint": "joint", "coefficient": 0.2}}),
            0.5 * (1.0 - (-2.0_f64).exp()),
        ),
        (
            // v' = −(μ/m) tanh(v/w): sinh(v/w) = sinh(1/w) exp(−μ t/(m w)); w = 1, μ = 2:
            // x = ∫ asinh(sinh 1 · e^{−t}) dt, by Simpson's rule below.
            "prismatic",
            json!({"friction": {"joint": "joint", "size": 2, "width": 1}}),
            simpson(|t| ((1.0_f64).sinh() * (-t).exp()).asinh()),
        ),
        (
            "revolute",
            json!({"friction": {"joint": "joint", "size": 0.1, "width": 1}}),
            simpson(|t| ((1.0_f64).sinh() * (-t).exp()).asinh()),
        ),
    ];
    for (joint, load, exact) in cases {
        let (axis, velocity, function) = along(joint);
        let found = one_body(joint, axis, velocity, load.clone(), function);
        assert!(
            (found - exact).abs() <= 2e-6,
            "{load}: {found} against {exact}"
        );
    }
}

/// ∫ f over [0, 1] by Simpson's rule, to round-off for smooth f.
fn simpson(f: impl Fn(f64) -> f64) -> f64 {
    let n = 2000;
    let h = 1.0 / f64::from(n);
    let weight = |i| match i {
        i if i == 0 || i == n => 1.0,
        i if i % 2 == 1 => 4.0,
        _ => 2.0,
    };
    (0..=n)
        .map(|i| weight(i) * f(f64::from(i) * h))
        .sum::<f64>()
        * h
        / 3.0
}

/// Springs conserve the total energy to the order of the formula (at most 1.2e-4 J of about 10 J at
/// 2000 steps). Dampers reduce it.
#[test]
fn springs_keep_energy_and_dampers_take_it() {
    let drift = |load: Value, steps: usize| {
        let mut file = scene(&load);
        file["simulation"] = bdf(steps);
        let problem = Problem::parse(&file.to_string(), "loaded.json", &[])
            .unwrap_or_else(|faults| panic!("{faults}"));
        let start = problem.start();
        let motion = simulate(&problem, &start).expect("runs");
        let seen = &motion.observations;
        let total = |k: usize| seen[k].kinetic + seen[k].potential;
        total(seen.len() - 1) - total(0)
    };
    let springs = [
        json!({"spring": {"between": ["box", "ground"], "at": {"a": "side", "b": [0.2, 0.7, 0.3]},
               "rest_length": 0.6, "stiffness": 40, "cubic": 30}}),
        json!({"torsion_spring": {"joint": "hinge", "rest_angle": 0.4, "stiffness": 12}}),
    ];
    for spring in springs {
        let (coarse, fine) = (drift(spring.clone(), 1000), drift(spring.clone(), 2000));
        assert!(
            fine.abs() < 2e-4 && (3.5..4.5).contains(&(coarse / fine)),
            "{spring}: {fine:e}"
        );
    }
    for joint in ["rail", "hinge", "ball"] {
        let taken = drift(
            json!({"damping": {"joint": joint, "coefficient": 0.9}}),
            1000,
        );
        assert!(taken < -1e-2, "{joint}: {taken}");
    }
}
