//! Joints and drives in problem files: exact gradients in every number of every kind of drive, by
//! several methods, and the faults of wrong entries.

use crate::numbers;
use crate::reference::documents::problem;

use flexbody_driver::check;
use flexbody_problem::Problem;
use numbers::numbers;
use serde_json::Value;

fn position(body: &str, direction: [f64; 3]) -> Value {
    json!({"final": {"position": {"body": body, "direction": direction}}})
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

/// A motor turns an arm. A second one moves a slide on it. A weight hangs on the slide by a rod, a
/// vane by a universal joint, and a box is welded to it.
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
    for interpolation in ["linear", "monotone", "spline"] {
        let table = json!({"table": {"times": [0, 0.1, 0.25, 0.4, 0.6],
                                     "values": [0, 0.05, -0.04, 0.1, 0.05],
                                     "interpolation": interpolation}});
        let polynomial = json!({"polynomial": [0, 1.5, -2, 1]});
        let simulation = json!({"duration": 0.5, "tolerance": 1e-8, "samples": 60});
        let file = machine(polynomial, table, simulation);
        assert_gradients(file, &["/drives", "/bodies/weight", "/bodies/slide/mass"]);
    }
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

/// Faults of joints and drives, with their places.
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
    // A second hinge on the shaft's axis, with its own motor.
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
