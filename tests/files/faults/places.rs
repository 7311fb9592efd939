//! Variables that move a place off its node or interface. The shapes of such bodies are known at these alone, so
//! the file with the moved place is refused, and so is the variable.

use super::super::modal::{modal, pendulum};
use crate::reference::documents::plates;
use flexbody_problem::Problem;
use serde_json::Value;

fn told(file: &Value) -> String {
    match Problem::parse(&file.to_string(), "places.json", &[]) {
        Ok(_) => "sound".into(),
        Err(faults) => faults.to_string(),
    }
}

/// The message about a variable of these numbers of a file.
fn of_variable(file: &Value, paths: &[&str]) -> String {
    let mut file = file.clone();
    let values: Vec<f64> = (paths.iter())
        .map(|path| {
            file.pointer(path)
                .and_then(Value::as_f64)
                .expect("a number")
        })
        .collect();
    let lower = if values[0] > 0.0 {
        0.5 * values[0]
    } else {
        values[0] - 1.0
    };
    file["variables"] = match paths {
        [path] => json!({"moved": {"path": path, "lower": lower}}),
        _ => json!({"moved": {"paths": paths, "lower": lower}}),
    };
    for key in ["objective", "constraints"] {
        file.as_object_mut().expect("an object").remove(key);
    }
    told(&file)
}

/// Each variable is refused by its name, its path and the place that it moves.
fn assert_refused(file: &Value, cases: &[(&[&str], &str)]) {
    assert_eq!(told(file), "sound");
    for (paths, place) in cases {
        let told = of_variable(file, paths);
        for word in ["/variables/moved", paths[0], place, "off its node"] {
            assert!(told.contains(word), "{paths:?}: {told}");
        }
        assert_eq!(told.matches("found").count(), 1, "{told}");
    }
}

fn assert_sound(file: &Value, paths: &[&str]) {
    for path in paths {
        assert_eq!(of_variable(file, &[path]), "sound", "{path}");
    }
}

/// A bar of two beam elements from a hinge to a weight, with loads and functions at its end by coordinates.
fn bar(basis: Value) -> Value {
    let mut file = json!({
        "version": 1, "name": "bar", "materials": {"steel": {"young": 2e11, "poisson": 0.3, "density": 7800}},
        "bodies": {
            "bar": {"elements": {
                "structure": {
                    "mesh": {"straight_beam": {"from": [0, 0, 0], "to": [1, 0, 0], "orientation": [0, 1, 0], "elements": 2}},
                    "material": "steel", "section": {"rectangle": {"width": 0.02, "height": 0.02}}},
                "frame": {"clamped": "start"},
                "points": {"root": {"node": "start"}, "tip": {"node": "end"}}},
                "place": {"put": "root", "at": [0, 0, 0], "turn": {"axis": [0, 0, 1], "angle": 0}}},
            "weight": {"shape": {"sphere": {"radius": 0.05}}, "mass": 1, "place": {"at": [1, 0, 0]}}
        },
        "joints": {
            "hinge": {"revolute": {"between": ["bar", "ground"], "at": "bar.root", "axis": [0, 0, 1]}},
            "weld": {"weld": {"between": ["weight", "bar"], "at": {"a": [0, 0, 0], "b": [1, 0, 0]}}}
        },
        "loads": {
            "spring": {"spring": {"between": ["bar", "ground"], "at": {"a": [1, 0, 0], "b": [1, 1, 0]},
                                  "rest_length": 0.5, "stiffness": 10}},
            "push": {"force": {"body": "bar", "point": [1, 0, 0], "direction": [0, 1, 0], "magnitude": 1}},
            "twist": {"torque": {"body": "bar", "point": [1, 0, 0], "direction": [0, 0, 1], "magnitude": 1}}
        },
        "simulation": {"duration": 0.02, "steps": 8, "method": {"radau": {"stages": 2}}},
        "functions": {
            "y": {"final": {"position": {"body": "bar", "point": [1, 0, 0], "direction": [0, 1, 0]}}},
            "tip": {"final": {"speed_squared": {"body": "bar", "point": "tip"}}}
        }
    });
    if !basis.is_null() {
        file["bodies"]["bar"]["elements"]["basis"] = basis;
    }
    file
}

#[test]
fn variables_of_places_on_elements_are_refused() {
    for basis in [Value::Null, json!({"reduced": {"modes": 2}})] {
        let file = bar(basis);
        assert_refused(
            &file,
            &[
                (&["/joints/weld/weld/at/b/0"], "/joints/weld"),
                (&["/loads/spring/spring/at/a/1"], "/loads/spring"),
                (&["/loads/push/force/point/2"], "/loads/push"),
                (&["/loads/twist/torque/point/0"], "/loads/twist"),
                (&["/functions/y/final/position/point/0"], "/functions/y"),
                (
                    &["/joints/weld/weld/at/b/0", "/loads/push/force/point/0"],
                    "/joints/weld",
                ),
            ],
        );
        assert_sound(
            &file,
            &[
                "/joints/weld/weld/at/a/0",
                "/loads/spring/spring/at/b/1",
                "/bodies/bar/place/at/0",
                "/bodies/bar/place/turn/angle",
                "/bodies/weight/mass",
                "/materials/steel/density",
            ],
        );
    }
}

/// Places in ground coordinates: the variable moves the place, or the body under it.
#[test]
fn variables_that_move_a_body_under_its_places_are_refused() {
    let mut file = bar(Value::Null);
    file["joints"]["weld"]["weld"]["at"] = json!([1, 0, 0]);
    file["loads"]["push"] =
        json!({"force": {"body": "bar", "at": [1, 0, 0], "direction": [0, 1, 0], "magnitude": 1}});
    assert_refused(
        &file,
        &[
            (&["/joints/weld/weld/at/0"], "/joints/weld"),
            (&["/bodies/bar/place/at/0"], "/joints/weld"),
            (&["/bodies/bar/place/turn/angle"], "/joints/weld"),
        ],
    );
    file["joints"]["weld"]["weld"]["at"] = json!("bar.tip");
    assert_refused(
        &file,
        &[
            (&["/bodies/bar/place/at/2"], "/loads/push"),
            (&["/loads/push/force/at/1"], "/loads/push"),
        ],
    );
    // All that moves together stays at its nodes.
    assert_eq!(
        of_variable(&file, &["/bodies/bar/place/at/2", "/loads/push/force/at/2"]),
        "sound"
    );
}

/// The same of shells whose hinge is at an edge, and of bodies from files.
#[test]
fn variables_of_places_on_shells_and_bodies_from_files_are_refused() {
    let mut file = plates([2, 1], 0.02, 10, &json!({"bdf": {"order": 2}}));
    file["joints"]["hinge"]["revolute"]["at"] = json!([1, 0, 0]);
    assert_refused(
        &file,
        &[(&["/joints/hinge/revolute/at/0"], "/joints/hinge")],
    );

    let mut file = pendulum("modal", modal(json!({"clamped": "start"})));
    file["joints"]["end"]["weld"]["at"] = json!({"a": [0, 0, 0], "b": [1, 0, 0]});
    file["loads"]["push"]["force"]["point"] = json!([0.55, 0, 0]);
    file["functions"]["end"]["final"]["position"]["point"] = json!([1, 0, 0]);
    file["bodies"]["arm"]["modal"]["scale"] = json!(1);
    file["bodies"]["arm"]["modal"]["young_factor"] = json!(1);
    assert_refused(
        &file,
        &[
            (&["/joints/end/weld/at/b/0"], "/joints/end"),
            (&["/loads/push/force/point/1"], "/loads/push"),
            (&["/functions/end/final/position/point/2"], "/functions/end"),
            (&["/bodies/arm/modal/scale"], "/joints/end"),
        ],
    );
    assert_sound(
        &file,
        &[
            "/bodies/arm/place/turn/angle",
            "/bodies/arm/modal/young_factor",
        ],
    );
    let mut named = pendulum("modal", modal(json!({"chord": ["start", "end"]})));
    named["bodies"]["arm"]["modal"]["scale"] = json!(1);
    assert_sound(
        &named,
        &["/bodies/arm/modal/scale", "/bodies/arm/place/at/0"],
    );
}

/// Of very many faults the first are told, and how many there are.
#[test]
fn very_many_faults_are_counted() {
    let body = |k: usize| (format!("b{k}"), json!({"mass": -1, "weight": 2}));
    let bodies: serde_json::Map<String, Value> = (0..60).map(body).collect();
    let file = json!({
        "version": 1, "name": "many", "bodies": bodies, "simulation": {"duration": 1},
        "functions": {"t": "duration"}
    });
    let found = told(&file);
    let told_of = found.matches("/bodies/b").count();
    assert!((30..=41).contains(&told_of), "{found}");
    assert!(found.trim_end().ends_with("more faults"), "{found}");
}
