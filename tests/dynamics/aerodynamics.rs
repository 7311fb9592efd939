//! Drag and lift of plates: a glide in closed form, derivatives by every method, the same in other descriptions, and faults.

use super::couplings::{OBLIQUE, close, oblique, turned};
use crate::reference::documents::{
    faults_say, methods, problem as parsed, reversed, unlowered_values, values, vary,
};
use crate::reference::gradients::gradients_are_exact;
use serde_json::Value;

const GRAVITY: f64 = 9.81;

fn component(quantity: &str, direction: [f64; 3]) -> Value {
    json!({"final": {quantity: {"body": "wing", "direction": direction}}})
}

/// A wing with a tail, whose pressure point is beside its centre of mass.
fn wing(simulation: Value) -> Value {
    json!({
        "version": 1, "name": "wing", "gravity": [0, -GRAVITY, 0],
        "bodies": {"wing": {"shape": {"box": {"size": [1, 0.02, 0.2]}}, "mass": 1.5,
                            "place": {"at": [0, 10, 0], "turn": {"axis": [0.2, 0.1, 1], "angle": 0.3}},
                            "velocity": {"linear": [8, 1, 0.5], "angular": [0.3, 0.2, 0.4]}}},
        "loads": {
            "lift": {"drag": {"body": "wing", "point": [0.05, 0, 0.02], "coefficient": 0.01, "normal_coefficient": 0.3,
                              "normal": [-0.3, 1, 0.1], "width": 0.01}},
            "tail": {"drag": {"body": "wing", "point": [-0.5, 0, 0], "coefficient": 0.005, "normal_coefficient": 0.05,
                              "normal": [-0.35, 1, 0.1], "width": 0.01}}
        },
        "simulation": simulation,
        "functions": {
            "x": component("position", [1.0, 0.0, 0.0]), "y": component("position", [0.0, 1.0, 0.0]),
            "z": component("position", [0.0, 0.0, 1.0]), "spin": component("angular_velocity", [0.2, 0.4, 1.0]),
            "work": {"integral": {"power": {"load": "lift"}}}, "energy": {"final": {"energy": "total"}}
        }
    })
}

/// A plate that keeps its direction comes to the glide in which its weight is balanced along the chord and along the normal:
/// c |u| u_c = m g sin θ and (c + c_n) |u| u_n = m g cos θ.
#[test]
fn a_plate_glides() {
    let (mass, c, c_n, tilt) = (0.8, 0.02, 0.9, 0.25_f64);
    let found = values(&json!({
        "version": 1, "name": "glide", "gravity": [0, -GRAVITY, 0],
        "bodies": {"wing": {"shape": {"box": {"size": [1, 0.02, 0.2]}}, "mass": mass, "place": {"at": [0, 0, 0]}}},
        "loads": {"lift": {"drag": {"body": "wing", "coefficient": c, "normal_coefficient": c_n,
                                    "normal": [tilt.sin(), tilt.cos(), 0]}}},
        "simulation": {"duration": 60, "tolerance": 1e-10},
        "functions": {"along": component("velocity", [1.0, 0.0, 0.0]), "down": component("velocity", [0.0, -1.0, 0.0])}
    }));
    // The plate falls towards its lower edge, at +x.
    let chord = mass * GRAVITY * tilt.sin() / c;
    let normal = mass * GRAVITY * tilt.cos() / (c + c_n);
    let speed = chord.hypot(normal).sqrt();
    let (chord, normal) = (chord / speed, normal / speed);
    let along = chord * tilt.cos() - normal * tilt.sin();
    let down = chord * tilt.sin() + normal * tilt.cos();
    close(found[0], along, 1e-7, "along");
    close(found[1], down, 1e-7, "down");
    assert!(along > 2.5 * down, "it glides: {along} {down}");
}

/// The air takes energy: what it does is the change of all energy.
#[test]
fn the_air_takes_energy() {
    let mut file = wing(json!({"duration": 0.5, "tolerance": 1e-10}));
    file["functions"]["tail"] = json!({"integral": {"power": {"load": "tail"}}});
    file["functions"]["first"] = json!({"value": {"at": 0, "of": {"energy": "total"}}});
    let found = values(&file);
    let work = found[4] + found[6];
    assert!(work < -1.0, "{found:?}");
    close(found[5] - found[7], work, 1e-6, "energy");
}

#[test]
fn gradients_by_every_method() {
    for simulation in methods(0.5, 100) {
        let mut file = wing(simulation.clone());
        let own = "/loads/lift/drag";
        vary(
            &mut file,
            &[
                format!("{own}/coefficient"),
                format!("{own}/normal_coefficient"),
                format!("{own}/width"),
                format!("{own}/normal/1"),
                format!("{own}/normal/2"),
                "/bodies/wing/mass".into(),
            ],
        );
        file["variables"]["tilt"] =
            json!({"path": format!("{own}/normal/0"), "lower": -0.6, "upper": 0.1});
        file["variables"]["place"] =
            json!({"path": format!("{own}/point/0"), "lower": -0.1, "upper": 0.2});
        gradients_are_exact(&parsed(&file), &simulation);
    }
}

#[test]
fn the_same_in_other_descriptions() {
    let mut file = wing(json!({"duration": 0.5, "tolerance": 1e-10}));
    file["bodies"]["wing"]["place"] = json!({"at": [0, 10, 0]});
    file["bodies"]["stone"] = json!({"shape": {"sphere": {"radius": 0.1}}, "mass": 1});
    file["functions"]
        .as_object_mut()
        .expect("functions")
        .remove("energy");
    let reference = values(&file);
    let agree = |found: &[f64], what: &str| {
        for (a, b) in found.iter().zip(&reference) {
            assert!(
                (a - b).abs() < 1e-7 * b.abs().max(0.1),
                "{what}: {found:?} {reference:?}"
            );
        }
    };
    let mut other = turned(&file, &OBLIQUE);
    other["bodies"]["wing"]["velocity"] =
        json!({"linear": oblique([8.0, 1.0, 0.5]), "angular": oblique([0.3, 0.2, 0.4])});
    other["loads"]["lift"]["drag"]["normal"] = json!(oblique([-0.3, 1.0, 0.1]));
    other["loads"]["tail"]["drag"]["normal"] = json!(oblique([-0.35, 1.0, 0.1]));
    agree(&values(&other), "turned");
    agree(
        &values(&reversed(&file, &["bodies", "loads"])),
        "in another order",
    );
    agree(&unlowered_values(&file), "without reductions");
    // A flight in a plane, and one whose normal leaves it.
    for across in [0.0, 0.1] {
        let mut flat = file.clone();
        flat["bodies"]["wing"]["velocity"] = json!({"linear": [8, 1, 0], "angular": [0, 0, 0.4]});
        flat["loads"]["lift"]["drag"]["point"] = json!([0.05, 0, 0]);
        for load in ["lift", "tail"] {
            flat["loads"][load]["drag"]["normal"] = json!([-0.3, 1, across]);
        }
        let lowering = parsed(&flat).lowering.expect("reductions");
        assert_eq!(lowering.plane.is_ok(), across == 0.0);
        for (a, b) in values(&flat).iter().zip(unlowered_values(&flat)) {
            close(*a, b, 1e-7, "in a plane");
        }
    }
    // Welded to another body, turned obliquely, that carries it.
    let mut welded = file;
    welded["bodies"]["pod"] = json!({
        "mass": 0.4, "inertia": {"xx": 0.001, "yy": 0.001, "zz": 0.002},
        "place": {"at": [0.2, 9.9, 0], "turn": {"axis": [1, 2, 0.4], "angle": 0.9}},
        "velocity": {"linear": [8, 1, 0.5], "angular": [0.3, 0.2, 0.4]}
    });
    welded["joints"] = json!({"glue": {"weld": {"between": ["wing", "pod"], "at": [0.1, 10, 0]}}});
    for (a, b) in values(&welded).iter().zip(unlowered_values(&welded)) {
        close(*a, b, 1e-7, "welded");
    }
}

#[test]
fn bad_plates_are_told() {
    let told = |change: &dyn Fn(&mut Value), words: &[&str]| {
        let mut file = wing(json!({"duration": 0.1}));
        change(&mut file["loads"]["lift"]["drag"]);
        faults_say(&file, words);
    };
    told(
        &|drag| {
            drag.as_object_mut().expect("a drag").remove("normal");
        },
        &["/loads/lift/drag", "the normal of the plate"],
    );
    told(
        &|drag| drag["normal"] = json!([0, 0, 0]),
        &["/loads/lift/drag/normal", "not zero"],
    );
    told(
        &|drag| {
            drag.as_object_mut()
                .expect("a drag")
                .remove("normal_coefficient");
        },
        &["/loads/lift/drag/normal", "a normal alone has no force"],
    );
    told(&|drag| drag["faces"] = json!("all"), &["/loads/lift/drag"]);
}
