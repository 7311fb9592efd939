//! Contacts with boxes and of wheels: rebounds from faces, edges and the inside, what is kept by free bodies, wheels that roll, lean
//! and agree with spheres, derivatives by every method, and the same in other descriptions.

use super::couplings::{OBLIQUE, close, oblique, turned};
use super::stops::rebound;
use crate::reference::documents::{
    extended, faults_say, methods, problem as parsed, reversed, unlowered_values, values, vary,
};
use crate::reference::gradients::gradients_are_exact;
use serde_json::Value;

const GRAVITY: f64 = 9.81;

fn final_of(quantity: &str, body: &str, direction: [f64; 3]) -> Value {
    json!({"final": {quantity: {"body": body, "direction": direction}}})
}

/// A ball flies to the middle of an edge, to a corner and deep into a face of a box that ground holds: it comes back along the
/// line to the nearest point by the implicit formula of the rebound.
#[test]
fn balls_rebound_from_faces_edges_and_corners() {
    let surface = json!({"box": {"size": [2, 1.2, 0.8], "radius": 0.1}});
    // The nearest point on the box without its rounding, and the direction of the flight.
    for (toward, from) in [
        ([0.2, 0.5, 0.1], [0.0, -1.0, 0.0]),
        ([0.9, 0.5, -0.2], [-0.6, -0.8, 0.0]),
        ([-0.9, 0.5, 0.3], [0.48, -0.64, -0.6]),
    ] {
        for (radius, dissipation) in [(0.0, 0.0), (0.2, 0.3)] {
            let start: Vec<f64> = (0..3).map(|k| toward[k] - from[k]).collect();
            let velocity: Vec<f64> = from.iter().map(|x| 2.0 * x).collect();
            let found = values(&json!({
                "version": 1, "name": "ball", "gravity": [0, 0, 0],
                "bodies": {"ball": {"shape": "point", "mass": 2, "place": {"at": start}, "velocity": {"linear": velocity}}},
                "loads": {"block": {"contact": {
                    "between": ["ball", "ground"], "at": [start, [0, 0, 0]], "radius": radius, "surface": surface,
                    "stiffness": 1e5, "dissipation": dissipation, "width": 1e-3}}},
                "simulation": {"duration": 1.2, "tolerance": 1e-10},
                "functions": {
                    "back": final_of("velocity", "ball", from),
                    "speed": {"final": {"speed": {"body": "ball"}}}
                }
            }));
            let exact = rebound(2.0, dissipation);
            assert!(
                (found[0] + exact).abs() < 1e-6,
                "{toward:?} {found:?} {exact}"
            );
            assert!(
                (found[1] - exact).abs() < 1e-6,
                "{toward:?} {found:?} {exact}"
            );
        }
    }
}

/// A point that a soft face lets in far beyond its edges' rounding comes out again as from a plane.
#[test]
fn points_are_pushed_out_of_boxes() {
    let file = |surface: Value, at: f64| {
        json!({
            "version": 1, "name": "point", "gravity": [0, 0, 0],
            "bodies": {"point": {"shape": "point", "mass": 2, "place": {"at": [0.1, 1, 0.2]}, "velocity": {"linear": [0.1, -2, 0.05]}}},
            "loads": {"soft": {"contact": {
                "between": ["point", "ground"], "at": [[0.1, 1, 0.2], [0, at, 0]], "surface": surface,
                "stiffness": 200, "dissipation": 0.1, "width": 1e-2, "friction": {"coefficient": 0.3, "width": 0.01}}}},
            "simulation": {"duration": 1.4, "tolerance": 1e-10},
            "functions": {
                "depth": {"ks": {"rho": 500, "of": {"penetration": {"load": "soft"}}}},
                "up": final_of("velocity", "point", [0.0, 1.0, 0.0]), "along": final_of("velocity", "point", [1.0, 0.0, 0.0])
            }
        })
    };
    let plane = values(&file(json!({"plane": {"normal": [0, 1, 0]}}), 0.0));
    assert!(plane[0] > 0.15, "{plane:?}");
    for radius in [0.0, 0.05] {
        let found = values(&file(
            json!({"box": {"size": [3, 1.6, 3], "radius": radius}}),
            -0.8,
        ));
        for (a, b) in found.iter().zip(&plane) {
            close(*a, *b, 1e-6, "a box");
        }
    }
}

/// A ball hits a free box off its centre: momentum and energy are kept.
fn free(simulation: Value) -> Value {
    json!({
        "version": 1, "name": "free", "gravity": [0, 0, 0],
        "bodies": {
            "box": {"shape": {"box": {"size": [0.6, 0.3, 0.4]}}, "mass": 2,
                    "place": {"at": [0, 0.5, 0], "turn": {"axis": [0.3, 0.2, 1], "angle": 0.5}},
                    "velocity": {"linear": [0.1, 0.2, -0.1], "angular": [0.5, 0.3, -1]}},
            "ball": {"shape": {"sphere": {"radius": 0.1}}, "mass": 0.7, "place": {"at": [0.15, 1.1, 0.12]},
                     "velocity": {"linear": [0, -3, 0], "angular": [1, -2, 3]}}
        },
        "loads": {"hit": {"contact": {
            "between": ["ball", "box"], "at": {"a": [0, 0, 0], "b": [0, 0, 0]}, "radius": 0.1,
            "surface": {"box": {"size": [0.6, 0.3, 0.4], "radius": 0.02}}, "stiffness": 2000, "width": 0.01,
            "friction": {"coefficient": 0.4, "width": 0.05}}}},
        "simulation": simulation,
        "functions": {
            "place": {"final": {"position": {"body": "box", "point": [0.3, 0, 0.1], "direction": [0.6, 0.7, 0.4]}}},
            "ball": final_of("position", "ball", [0.6, 0.7, 0.4]),
            "spin": final_of("angular_velocity", "box", [0.2, 0.5, 0.7]),
            "force": {"integral": {"contact_force": {"load": "hit"}}},
            "work": {"integral": {"power": {"load": "hit"}}},
            "energy": {"final": {"energy": "kinetic"}}
        }
    })
}

#[test]
fn free_boxes_keep_momentum_and_energy() {
    let mut file = free(json!({"duration": 0.5, "tolerance": 1e-11}));
    file["loads"]["hit"]["contact"]["friction"]["coefficient"] = json!(0);
    file["functions"] = json!({
        "energy": {"final": {"energy": "total"}}, "first": {"value": {"at": 0, "of": {"energy": "total"}}},
        "p": {"final": {"momentum": {"direction": [0.3, 1, 0.2]}}}, "first p": {"value": {"at": 0, "of": {"momentum": {"direction": [0.3, 1, 0.2]}}}},
        "h": {"final": {"angular_momentum": {"direction": [0.3, 1, 0.2]}}},
        "first h": {"value": {"at": 0, "of": {"angular_momentum": {"direction": [0.3, 1, 0.2]}}}},
        "force": {"ks": {"rho": 1, "of": {"contact_force": {"load": "hit"}}}}
    });
    let found = values(&file);
    assert!(found[6] > 10.0, "{found:?}");
    for pair in [0, 2, 4] {
        close(found[pair], found[pair + 1], 1e-8, "what is kept");
    }
}

fn wheel(simulation: Value, lean: f64) -> Value {
    // A ring of 0.3 m with a tyre of 0.05 m, whose axis leans.
    let height = 0.3 * lean.cos() + 0.05;
    json!({
        "version": 1, "name": "wheel",
        "gravity": [0, 0, -GRAVITY],
        "bodies": {"wheel": {
            "mass": 3, "inertia": {"xx": 0.15, "yy": 0.27, "zz": 0.15},
            "place": {"at": [0, 0, height], "turn": {"axis": [1, 0, 0], "angle": lean}},
            "velocity": {"linear": [1.5, 0, 0], "angular": [0, 2, 0]}}},
        "loads": {"road": {"contact": {
            "between": ["wheel", "ground"], "at": {"a": [0, 0, 0], "b": [0, 0, 0]}, "radius": 0.05,
            "wheel": {"axis": [0, lean.cos(), lean.sin()], "radius": 0.3},
            "surface": {"plane": {"normal": [0, 0, 1]}}, "stiffness": 2e4, "dissipation": 0.5, "width": 1e-4,
            "friction": {"coefficient": 0.6, "width": 0.01}}}},
        "simulation": simulation,
        "functions": {
            "x": final_of("position", "wheel", [1.0, 0.0, 0.0]),
            "y": final_of("position", "wheel", [0.0, 1.0, 0.0]),
            "z": {"integral": {"position": {"body": "wheel", "direction": [0, 0, 1]}}},
            "spin": final_of("angular_velocity", "wheel", [0.0, 1.0, 0.0]),
            "turn": final_of("angular_velocity", "wheel", [0.0, 0.0, 1.0]),
            "force": {"integral": {"contact_force": {"load": "road"}}},
            "friction": {"integral": {"contact_friction": {"load": "road"}}}
        }
    })
}

/// An upright wheel of the radius R slips until it rolls: J ω + m R v is kept, v = ω R at the end, also in space.
#[test]
fn a_wheel_slips_until_it_rolls() {
    let mut file = wheel(json!({"duration": 3, "tolerance": 1e-9}), 0.0);
    let loads = &mut file["loads"]["road"]["contact"];
    loads["stiffness"] = json!(1e5);
    let (r, m, j) = (0.35, 3.0, 0.27);
    let exact = (j * 2.0 + m * r * 1.5) / (j + m * r * r);
    let found = values(&file);
    assert!((found[3] - exact).abs() < 2e-3 * exact, "{found:?} {exact}");
    let mut speed = file.clone();
    speed["functions"] = json!({"v": final_of("velocity", "wheel", [1.0, 0.0, 0.0]), "w": final_of("angular_velocity", "wheel", [0.0, 1.0, 0.0])});
    let [v, w] = values(&speed)[..] else {
        panic!("two values")
    };
    assert!((v - w * r).abs() < 1e-6, "{v} {w}");
    let plane = parsed(&file).lowering.expect("reductions").plane.is_ok();
    assert!(plane, "an upright wheel rolls in a plane");
    for (a, b) in found.iter().zip(unlowered_values(&file)) {
        assert!((a - b).abs() < 1e-7 * a.abs().max(1e-2), "{a} {b}");
    }
}

/// A wheel whose circle is a point is a sphere.
#[test]
fn a_small_wheel_is_a_sphere() {
    let mut file = wheel(json!({"duration": 1, "tolerance": 1e-10}), 0.3);
    file["bodies"]["wheel"]["place"]["at"] = json!([0, 0, 0.35]);
    let own = &mut file["loads"]["road"]["contact"];
    own["radius"] = json!(0.35);
    own["wheel"]["radius"] = json!(1e-9);
    let small = values(&file);
    let own = file["loads"]["road"]["contact"]
        .as_object_mut()
        .expect("a contact");
    own.remove("wheel");
    for (a, b) in small.iter().zip(values(&file)) {
        assert!((a - b).abs() < 1e-6 * b.abs().max(0.1), "{a} {b}");
    }
}

/// A leaning wheel turns to the side to which it leans; its energy only falls by what the contact takes.
#[test]
fn a_leaning_wheel_steers_itself() {
    let mut file = wheel(json!({"duration": 0.8, "tolerance": 1e-9}), 0.2);
    file["bodies"]["wheel"]["velocity"]["angular"] = json!([0, 8, 0]);
    file["bodies"]["wheel"]["velocity"]["linear"] = json!([2.8, 0, 0]);
    file["functions"]["energy"] = json!({"final": {"energy": "total"}});
    file["functions"]["first"] = json!({"value": {"at": 0, "of": {"energy": "total"}}});
    file["functions"]["work"] = json!({"integral": {"power": {"load": "road"}}});
    file["functions"]["kinetic"] = json!({"final": {"energy": "kinetic"}});
    file["functions"]["first kinetic"] = json!({"value": {"at": 0, "of": {"energy": "kinetic"}}});
    file["functions"]["fall"] =
        json!({"final": {"position": {"body": "wheel", "direction": [0, 0, 3.0 * GRAVITY]}}});
    file["functions"]["first fall"] = json!({"value": {"at": 0, "of": {"position": {"body": "wheel", "direction": [0, 0, 3.0 * GRAVITY]}}}});
    let found = values(&file);
    // A turn of the upper side to −y about x: it runs to −y.
    assert!(found[1] < -0.02, "{found:?}");
    assert!(found[7] <= found[8] + 1e-7, "{found:?}");
    let change = found[10] - found[11] + found[12] - found[13];
    assert!((change - found[9]).abs() < 1e-5, "{change} {found:?}");
}

#[test]
fn gradients_by_every_method() {
    for simulation in methods(0.4, 300) {
        let mut file = free(simulation.clone());
        let own = "/loads/hit/contact";
        vary(
            &mut file,
            &[
                format!("{own}/surface/box/size/0"),
                format!("{own}/surface/box/size/1"),
                format!("{own}/surface/box/radius"),
                format!("{own}/radius"),
                format!("{own}/at/b/1"),
                "/bodies/box/mass".into(),
            ],
        );
        gradients_are_exact(&parsed(&file), &simulation);
        let mut file = wheel(simulation.clone(), 0.25);
        file["loads"]["road"]["contact"]["width"] = json!(0.01);
        file["loads"]["road"]["contact"]["stiffness"] = json!(2000);
        let own = "/loads/road/contact";
        vary(
            &mut file,
            &[
                format!("{own}/wheel/radius"),
                format!("{own}/wheel/axis/2"),
                format!("{own}/radius"),
                format!("{own}/surface/plane/normal/2"),
                format!("{own}/at/a/1"),
                "/bodies/wheel/mass".into(),
            ],
        );
        let at = format!("{own}/at/a/1");
        file["variables"][&at] = json!({"path": at, "lower": -0.1, "upper": 0.1});
        gradients_are_exact(&parsed(&file), &simulation);
    }
}

/// The same hit and the same wheel turned obliquely, in another order, and without reductions.
#[test]
fn the_same_in_other_descriptions() {
    let mut file = wheel(json!({"duration": 0.5, "tolerance": 1e-10}), 0.0);
    file["bodies"]["second"] =
        json!({"shape": {"sphere": {"radius": 0.1}}, "mass": 1, "place": {"at": [0, 3, 0]}});
    // The integral of the friction has a kink where slip ends.
    let functions = file["functions"].as_object_mut().expect("functions");
    functions.remove("friction");
    let reference = values(&file);
    let agree = |found: &[f64], what: &str| {
        for (a, b) in found.iter().zip(&reference) {
            assert!(
                (a - b).abs() < 1e-4 * b.abs().max(0.1),
                "{what}: {found:?} {reference:?}"
            );
        }
    };
    let mut other = turned(&file, &OBLIQUE);
    other["bodies"]["wheel"]["velocity"] =
        json!({"linear": oblique([1.5, 0.0, 0.0]), "angular": oblique([0.0, 2.0, 0.0])});
    other["loads"]["road"]["contact"]["surface"]["plane"]["normal"] =
        json!(oblique([0.0, 0.0, 1.0]));
    agree(&values(&other), "turned");
    agree(&values(&reversed(&file, &["bodies"])), "in another order");
    agree(&unlowered_values(&file), "without reductions");
    let mut file = free(json!({"duration": 0.4, "tolerance": 1e-10}));
    let found = values(&file);
    let reversed = values(&reversed(&file, &["bodies"]));
    for (a, b) in found.iter().zip(&reversed) {
        close(*a, *b, 1e-6, "in another order");
    }
    // A box that a weld holds on another body, which merges with it.
    file["bodies"]["case"] = json!({
        "mass": 0.1, "inertia": {"xx": 0.001, "yy": 0.001, "zz": 0.001},
        "place": {"at": [0.1, 0.5, 0.2], "turn": {"axis": [1, 2, 0.4], "angle": 0.9}}
    });
    file["joints"] = json!({"glue": {"weld": {"between": ["case", "box"], "at": [0, 0.5, 0]}}});
    for (a, b) in values(&file).iter().zip(unlowered_values(&file)) {
        close(*a, b, 1e-6, "welded");
    }
}

#[test]
fn bad_boxes_and_wheels_are_told() {
    let told = |file: Value, words: &[&str]| faults_say(&file, words);
    let mut file = free(json!({"duration": 0.1}));
    file["loads"]["hit"]["contact"]["surface"]["box"]["radius"] = json!(0.16);
    told(
        file,
        &["/loads/hit/contact/surface/box/size/1", "twice the radius"],
    );
    let mut file = free(json!({"duration": 0.1}));
    file["loads"]["hit"]["contact"]["wheel"] = json!({"axis": [0, 1, 0], "radius": 0.1});
    told(file, &["/loads/hit/contact/wheel", "a plane"]);
    // A wheel that lies on its side touches everywhere.
    let mut file = wheel(json!({"duration": 0.1}), 0.0);
    file["loads"]["road"]["contact"]["wheel"]["axis"] = json!([0, 0, 1]);
    told(
        file,
        &["/loads/road/contact/wheel/axis", "a wheel that stands"],
    );
}

/// Nothing turns a point mass: it is no wheel, and has no surface but a ball about itself.
#[test]
fn a_point_mass_has_no_wheel_and_no_surface() {
    let file = |between: [&str; 2], more: Value| {
        let own = json!({"between": between, "at": {"a": [0, 0, 0], "b": [0, 0, 0]}, "stiffness": 1000, "width": 0.001});
        json!({
            "version": 1, "name": "point", "gravity": [0, 0, 0],
            "bodies": {
                "P": {"shape": "point", "mass": 1, "place": {"at": [0, 0.2, 0]}},
                "S": {"shape": {"sphere": {"radius": 0.1}}, "mass": 1, "place": {"at": [0.4, 0, 0.3]}}
            },
            "loads": {"x": {"contact": extended(own, &more)}},
            "simulation": {"duration": 0.1},
            "functions": {"T": "duration"}
        })
    };
    let plane = json!({"plane": {"normal": [0, 1, 0]}});
    let wheel = json!({"wheel": {"axis": [0, 0, 1], "radius": 0.2}, "surface": plane});
    faults_say(
        &file(["P", "ground"], wheel),
        &["a wheel of \"P\"", "nothing turns a point mass"],
    );
    for surface in [plane, json!({"box": {"size": [1, 1, 0.1]}})] {
        let own = json!({"radius": 0.1, "surface": surface});
        faults_say(&file(["S", "P"], own), &["a surface of \"P\""]);
    }
    let ball = json!({"radius": 0.1, "surface": {"sphere": {"radius": 0.1}}});
    assert_eq!(values(&file(["S", "P"], ball)), [0.1]);
}
