//! Rest under loads that are small beside the stiffness of the machine, or of a part of it: linear in the loads, and in balance.

use super::steady_rotation::assert_near;
use crate::reference::documents::{problem as parsed, value, values};
use flexbody_driver::check;
use serde_json::Value;

/// A machine `b` that is welded to the ground at `root` and pulled at `tip` across its length.
fn cantilever(mut body: Value, [root, tip, measure]: [&str; 3], magnitude: f64) -> Value {
    body["place"] = json!({"put": root});
    json!({
        "version": 1, "name": "small", "analysis": "rest", "gravity": [0, 0, 0],
        "materials": {"aluminium": {"young": 70e9, "poisson": 0.3, "density": 2700}},
        "bodies": {"b": body},
        "joints": {"w": {"weld": {"between": ["b", "ground"], "at": format!("b.{root}")}}},
        "loads": {"f": {"force": {"body": "b", "point": tip, "direction": [0, 1, 1], "magnitude": magnitude}}},
        "functions": {
            "y": {"final": {measure: {"body": "b", "point": tip, "direction": [0, 1, 0]}}},
            "z": {"final": {measure: {"body": "b", "point": tip, "direction": [0, 0, 1]}}},
            "ry": {"final": {"joint_force": {"joint": "w", "direction": [0, 1, 0]}}},
            "rz": {"final": {"joint_force": {"joint": "w", "direction": [0, 0, 1]}}}
        },
        "variables": {"force": {"path": "/loads/f/force/magnitude", "lower": 0, "upper": 1e3}}
    })
}

/// Values over the load are those of the usual one, and reactions balance the load.
fn assert_linear(scene: impl Fn(f64) -> Value, (usual, tolerance): (f64, f64), small: &[f64]) {
    let over = |load: f64| {
        let all = values(&scene(load));
        [0, 1, 2, 3].map(|k| all[k] / load)
    };
    let [y, z, ..] = over(usual);
    let pull = -0.5_f64.sqrt();
    for &load in small {
        let found = over(load);
        assert_near(&found[..2], &[y, z], tolerance);
        assert_near(&found[2..], &[pull, pull], 1e-9);
    }
}

/// The same of derivatives, of values that are proportional to the load.
fn assert_slopes(document: &Value, load: f64) {
    let problem = parsed(document);
    let found = values(document);
    for own in check(&problem, &problem.start()).expect("derivatives") {
        let expected = found[own.function] / load;
        assert_near(&[own.adjoint, own.complex_step], &[expected; 2], 1e-8);
    }
}

/// Bending is 1e9 times softer than stretch, and loads are as small as round-off of that.
#[test]
fn beams_and_plates_rest_in_proportion_to_small_loads() {
    let beam = |load: f64| {
        let section = json!({"given": {
            "ea": 1e8, "ei_y": 1e6, "ei_z": 1e3, "gj": 1e3, "mass_per_length": 1, "inertia_y": 1e-4, "inertia_z": 1e-4
        }});
        let body = json!({"beam": {"length": 1, "section": section, "strain": "linear"}});
        cantilever(body, ["start", "end", "position"], load)
    };
    assert_linear(beam, (1e-2, 1e-8), &[1e-4, 1e-5, 1e-6, 1e-9]);
    assert_slopes(&beam(1e-6), 1e-6);
    let pulled = beam(1e-5 * 2.0_f64.sqrt());
    assert_near(&values(&pulled)[..2], &[1e-5 / 3e6, 1e-5 / 3e3], 1e-9);
    let plate = |load: f64| {
        let body = json!({"elements": {
            "structure": {
                "mesh": {"plate": {"length": 1, "width": 0.2, "elements": [4, 1]}},
                "material": "aluminium", "thickness": 0.001
            },
            "frame": {"clamped": "x0"},
            "points": {"root": {"rigid": "x0"}, "tip": {"mean": "x1"}}
        }});
        cantilever(body, ["root", "tip", "elastic_displacement"], load)
    };
    assert_linear(plate, (1e-6, 1e-6), &[1e-8, 1e-10]);
    assert_slopes(&plate(1e-8), 1e-8);
}

/// A light body under a large load sets no step of a heavy one that moves by itself.
#[test]
fn light_bodies_do_not_keep_heavy_ones_from_their_rest() {
    // Masses, loads and stiffnesses of two sliders.
    for [light, heavy] in [
        [[1e-6, 1e3, 1e6], [10.0, 1e-2, 1.0]],
        [[1e-3, 1e2, 1e6], [1e3, 1e-4, 1.0]],
        [[1e-3, 1e4, 1e6], [10.0, 1e-4, 1.0]],
    ] {
        let mut file = json!({
            "version": 1, "name": "two", "analysis": "rest", "gravity": [0, 0, 0],
            "bodies": {}, "joints": {}, "loads": {}, "functions": {}
        });
        for (name, [mass, force, stiffness], y) in [("light", light, 0.0), ("heavy", heavy, 1.0)] {
            file["bodies"][name] = json!({
                "shape": {"box": {"size": [0.1, 0.1, 0.1]}}, "mass": mass, "place": {"at": [0, y, 0]}
            });
            file["joints"][name] = json!({
                "prismatic": {"between": [name, "ground"], "at": [0, y, 0], "axis": [1, 0, 0]}
            });
            file["loads"][format!("pull on {name}")] = json!({
                "force": {"body": name, "direction": [1, 0, 0], "magnitude": force}
            });
            file["loads"][format!("spring of {name}")] = json!({"spring": {
                "between": [name, "ground"], "at": [[0, y, 0], [-1, y, 0]], "rest_length": 1, "stiffness": stiffness
            }});
            file["functions"][name] = json!({"final": {"slide": {"joint": name}}});
        }
        for (name, [_, force, stiffness]) in [("light", light), ("heavy", heavy)] {
            assert_near(&[value(&file, name)], &[force / stiffness], 1e-9);
        }
    }
}
