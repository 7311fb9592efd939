//! Vibrations about the state at an instant of a motion: closed forms, the modes of rest and of steady rotation, derivatives,
//! families, and what has none.

use super::damped_modes::pairs;
use super::machines_at_rest::{fault, hinge, rod};
use super::steady_rotation::table;
use crate::reference::documents::{problem as parsed, values};
use crate::reference::gradients::gradients_are_exact;
use flexbody_driver::not_finite;
use flexbody_driver::{check, simulate};
use nalgebra::DMatrix;
use serde_json::Value;
use std::f64::consts::PI;

const GRAVITY: f64 = 9.81;

fn assert_near(found: f64, expected: f64, part: f64) {
    let off = (found - expected).abs();
    assert!(off <= part * expected.abs(), "{found} {expected}");
}

/// A pendulum that swings: δθ'' + (m g c cos θ / I) δθ = 0 wherever it is, however fast.
fn pendulum(duration: f64) -> Value {
    json!({
        "version": 1, "name": "pendulum", "gravity": [0, -GRAVITY, 0],
        "bodies": {"bar": rod(1.0, 2.0, json!({"put": "a", "turn": {"axis": [0, 0, 1], "angle": -0.9}}))},
        "joints": {"pin": hinge(["bar", "ground"], json!([0, 0, 0]))},
        "simulation": {"duration": duration, "tolerance": 1e-11},
        "functions": {
            "f": {"final": {"frequency": {"mode": 1}}},
            "x": {"final": {"position": {"body": "bar", "point": "b", "direction": [1, 0, 0]}}},
            "y": {"final": {"position": {"body": "bar", "point": "b", "direction": [0, 1, 0]}}}
        },
        "variables": {
            "mass": {"path": "/bodies/bar/mass", "lower": 1, "upper": 5},
            "angle": {"path": "/bodies/bar/place/turn/angle", "lower": -1.5, "upper": 1.5},
            "gravity": {"path": "/gravity/1", "lower": -20, "upper": -1}
        }
    })
}

#[test]
fn a_pendulum_has_the_frequency_of_its_angle() {
    let about = 1.0 / 3.0 + 1e-4 / 4.0;
    for duration in [0.0_f64, 0.05, 0.21, 0.4] {
        let file = pendulum(duration.max(1e-6));
        let found = values(&file);
        let expected = (GRAVITY * 0.5 * -found[2] / about).sqrt() / (2.0 * PI);
        assert_near(found[0], expected, 1e-10);
    }
    gradients_are_exact(&parsed(&pendulum(0.21)), &json!("pendulum"));
}

/// An upright part of the swing grows instead, which is no frequency.
#[test]
fn a_motion_that_does_not_oscillate_is_none() {
    let mut file = pendulum(0.1);
    file["bodies"]["bar"]["place"]["turn"]["angle"] = json!(0.9);
    let problem = parsed(&file);
    let found = simulate(&problem, &problem.start()).expect("a motion");
    let told = not_finite::value(&problem, &found.at, 0, f64::NAN);
    assert!(told.contains("no such vibration"), "{told}");
}

/// A mast on a torsion spring, and a mass that a drive moves out along its arm: (J + m r²) f² 4π² = k with the drive held.
fn mast(unit: f64, axes: [[f64; 3]; 2], reordered: bool) -> Value {
    let length = |x: f64| x * unit;
    let [axis, out] = axes;
    let inertia = |size: f64| {
        let own = size * unit * unit;
        json!({"xx": own, "yy": own, "zz": own})
    };
    let at: Vec<f64> = out.iter().map(|x| length(0.3 * x)).collect();
    let mast = ("mast", json!({"mass": 5, "inertia": inertia(0.4)}));
    let trolley = (
        "trolley",
        json!({"mass": 2, "inertia": inertia(0.05), "place": {"at": at}}),
    );
    let bodies: serde_json::Map<String, Value> = match reordered {
        false => [mast, trolley],
        true => [trolley, mast],
    }
    .into_iter()
    .map(|(name, own)| (name.to_owned(), own))
    .collect();
    let between = match reordered {
        false => ["trolley", "mast"],
        true => ["mast", "trolley"],
    };
    let way = if reordered { -1.0 } else { 1.0 };
    json!({
        "version": 1, "name": "mast", "gravity": [0, 0, 0], "bodies": bodies,
        "joints": {
            "axle": {"revolute": {"between": ["mast", "ground"], "at": [0, 0, 0], "axis": axis}},
            "arm": {"prismatic": {"between": between, "at": [0, 0, 0], "axis": out}}
        },
        "loads": {"twist": {"torsion_spring": {
            "joint": "axle", "stiffness": 80.0 * unit * unit, "damping": 1.5 * unit * unit
        }}},
        "drives": {"trolley": {"joint": "arm", "slide": {"polynomial": [0, way * length(0.5)]}}},
        "simulation": {"duration": 1, "tolerance": 1e-10},
        "functions": {
            "f": {"final": {"frequency": {"mode": 1}}},
            "half": {"value": {"at": 0.4, "of": {"frequency": {"mode": 1}}}},
            "z": {"final": {"damping_ratio": {"mode": 1}}},
            "mean": {"mean": {"frequency": {"mode": 1}}},
            "least": {"ks": {"of": {"frequency": {"mode": 1}}, "rho": 40, "bound": "above"}}
        },
        "variables": {
            "mass": {"path": "/bodies/trolley/mass", "lower": 1, "upper": 5},
            "stiffness": {"path": "/loads/twist/torsion_spring/stiffness", "lower": 1, "upper": 1e9},
            "damping": {"path": "/loads/twist/torsion_spring/damping", "lower": 0.1, "upper": 1e9},
            "speed": {"path": "/drives/trolley/slide/polynomial/1", "lower": -1e4, "upper": 1e4}
        }
    })
}

#[test]
fn a_driven_trolley_changes_the_frequency_of_its_mast() {
    let expected = |out: f64| {
        let about = 0.45 + 2.0 * out * out;
        let rate: f64 = 1.5 / (2.0 * about);
        let speed = (80.0 / about - rate * rate).sqrt();
        [speed / (2.0 * PI), rate / rate.hypot(speed)]
    };
    let skew = {
        let (a, b) = (2.0 / 3.0, 1.0 / 3.0);
        [[a, b, a], [-b, -a, a]]
    };
    let mut first: Option<Vec<f64>> = None;
    for (unit, axes, reordered) in [
        (1.0, [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0]], false),
        (1.0, [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0]], true),
        (1.0, skew, false),
        (1000.0, skew, true),
    ] {
        let file = mast(unit, axes, reordered);
        let found = values(&file);
        let [f, z] = expected(0.8);
        assert_near(found[0], f, 1e-9);
        assert_near(found[2], z, 1e-9);
        assert_near(found[1], expected(0.5)[0], 1e-9);
        // The highest of them is that of the start.
        let highest = expected(0.3)[0];
        assert!(
            (1.0 - 1e-12..1.01).contains(&(found[4] / highest)),
            "{found:?} {highest}"
        );
        match &first {
            None => first = Some(found),
            Some(first) => {
                for (a, b) in found.iter().zip(first) {
                    assert_near(*a, *b, 1e-8);
                }
            }
        }
        // Both orders, and oblique axes in millimetres.
        if (unit == 1.0) != (axes == skew) {
            gradients_are_exact(&parsed(&file), &json!([unit, axes, reordered]));
        }
    }
}

/// Carts on a table that a drive turns have the modes of its steady rotation, centrifugal and gyroscopic terms with them.
#[test]
fn a_motion_that_turns_steadily_has_the_modes_of_steady_rotation() {
    for (stiffness, damping, masses, speed) in [
        ([300.0, 170.0], [2.0, 5.0], [0.5, 2.0], 5.0),
        ([40.0, 30.0], [0.2, 0.1], [0.01, 2.0], 12.0),
    ] {
        let rest = table(stiffness, damping, masses, speed);
        let mut file = rest.clone();
        let object = file.as_object_mut().expect("an object");
        for key in ["analysis", "turning"] {
            object.remove(key);
        }
        file["drives"]["motor"]["turn"]["rate"] = json!(speed);
        file["simulation"] = json!({"duration": 0.31, "tolerance": 1e-10});
        for (_, function) in file["functions"].as_object_mut().expect("functions") {
            *function = json!({"final": function.clone()});
        }
        file["variables"]["speed"]["path"] = json!("/drives/motor/turn/rate");
        for (found, expected) in values(&file).iter().zip(values(&rest)) {
            assert_near(*found, expected, 1e-9);
        }
        gradients_are_exact(&parsed(&file), &json!(speed));
    }
}

/// Two carts between springs pass their balance: the frequencies stay those of rest.
#[test]
fn a_motion_of_linear_springs_keeps_the_modes_of_rest() {
    let cart = |x: f64, mass: f64| json!({"shape": {"box": {"size": [0.2, 0.1, 0.1]}}, "mass": mass, "place": {"at": [x, 0, 0]}, "velocity": {"linear": [1, 0, 0]}});
    let rail = |body: &str| json!({"prismatic": {"between": [body, "ground"], "at": body, "axis": [1, 0, 0]}});
    let spring = |a: &str, b: &str, end: f64, k: f64, c: f64| json!({"spring": {"between": [a, b], "at": {"a": [0, 0, 0], "b": [end, 0, 0]}, "rest_length": 1, "stiffness": k, "damping": c}});
    let file = json!({
        "version": 1, "name": "carts", "gravity": [0, -9.81, 0],
        "bodies": {"one": cart(1.0, 2.0), "two": cart(2.0, 3.0)},
        "joints": {"first": rail("one"), "second": rail("two")},
        "loads": {
            "left": spring("one", "ground", 0.0, 100.0, 3.0),
            "middle": spring("two", "one", 0.0, 50.0, 1.0),
            "right": spring("two", "ground", 3.0, 70.0, 2.0)
        },
        "simulation": {"duration": 0.7},
        "functions": {
            "f1": {"final": {"frequency": {"mode": 1}}}, "z1": {"final": {"damping_ratio": {"mode": 1}}},
            "f2": {"final": {"frequency": {"mode": 2}}}, "z2": {"final": {"damping_ratio": {"mode": 2}}}
        }
    });
    let expected = pairs(
        &DMatrix::from_row_slice(2, 2, &[2.0, 0.0, 0.0, 3.0]),
        &DMatrix::from_row_slice(2, 2, &[4.0, -1.0, -1.0, 3.0]),
        &DMatrix::from_row_slice(2, 2, &[150.0, -50.0, -50.0, 120.0]),
    );
    for (found, expected) in values(&file).iter().zip(expected.concat()) {
        assert_near(*found, expected, 1e-9);
    }
}

/// An arm of two beams that drives hold: its frequencies depend on the angle of its elbow. They are those of the arm at rest
/// with the drives at these angles.
fn arm(elbow: &Value) -> Value {
    let beam = |at: f64| {
        json!({
            "beam": {
                "length": 0.6, "section": {"rectangle": {"height": 0.02, "width": 0.01}},
                "material": {"young": 7e10, "poisson": 0.3, "density": 2700},
                "modes": {"bending_y": 2, "bending_z": 2, "torsion": 1}
            },
            "place": {"put": "start", "at": [at, 0, 0]}
        })
    };
    json!({
        "version": 1, "name": "arm", "gravity": [0, -9.81, 0],
        "bodies": {
            "upper": beam(0.0), "lower": beam(0.6),
            "load": {"shape": {"sphere": {"radius": 0.03}}, "mass": 0.4, "place": {"at": [1.2, 0, 0]}}
        },
        "joints": {
            "shoulder": hinge(["upper", "ground"], json!([0, 0, 0])),
            "elbow": hinge(["lower", "upper"], json!([0.6, 0, 0])),
            "wrist": {"weld": {"between": ["load", "lower"], "at": [1.2, 0, 0]}}
        },
        "drives": {
            "shoulder": {"joint": "shoulder", "turn": {"polynomial": [0]}},
            "elbow": {"joint": "elbow", "turn": elbow}
        },
        "variables": {
            "height": {"path": "/bodies/upper/beam/section/rectangle/height", "lower": 0.01, "upper": 0.05},
            "load": {"path": "/bodies/load/mass", "lower": 0.1, "upper": 1}
        }
    })
}

#[test]
fn an_arm_in_slow_motion_has_the_modes_of_its_pose() {
    let modes = |wrapped: bool| {
        let all = [1, 2, 3].map(|mode| json!({"frequency": {"mode": mode}}));
        let all = all.map(|own| if wrapped { json!({"final": own}) } else { own });
        json!({"f1": all[0], "f2": all[1], "f3": all[2]})
    };
    let mut moving = arm(&json!({"polynomial": [0, 0.002]}));
    moving["simulation"] = json!({
        "duration": 0.2, "steps": 40, "method": {"radau": {"stages": 3}}
    });
    moving["start"] = json!("equilibrium");
    moving["functions"] = modes(true);
    let mut posed = arm(&json!({"polynomial": [0.0004]}));
    posed["analysis"] = json!("rest");
    posed["functions"] = modes(false);
    for (found, expected) in values(&moving).iter().zip(values(&posed)) {
        assert_near(*found, expected, 1e-5);
    }
    gradients_are_exact(&parsed(&moving), &json!("arm"));
}

/// Equal rates have no derivatives, by name.
#[test]
fn equal_rates_have_no_derivatives() {
    let mut file = mast(1.0, [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0]], false);
    let bodies = file["bodies"].clone();
    for (name, own) in bodies.as_object().expect("bodies") {
        file["bodies"][format!("{name} too")] = own.clone();
    }
    for (joint, other) in [("axle", "axle too"), ("arm", "arm too")] {
        let mut copy = file["joints"][joint].clone();
        for (_, own) in copy.as_object_mut().expect("a joint") {
            for end in own["between"].as_array_mut().expect("two") {
                if end != "ground" {
                    *end = json!(format!("{} too", end.as_str().expect("a name")));
                }
            }
        }
        file["joints"][other] = copy;
    }
    let mut twist = file["loads"]["twist"].clone();
    twist["torsion_spring"]["joint"] = json!("axle too");
    file["loads"]["twist too"] = twist;
    let mut drive = file["drives"]["trolley"].clone();
    drive["joint"] = json!("arm too");
    file["drives"]["trolley too"] = drive;
    file["functions"] = json!({"f": {"final": {"frequency": {"mode": 1}}}});
    let problem = parsed(&file);
    let found = check(&problem, &problem.start()).expect("a motion");
    assert!(
        found
            .iter()
            .all(|own| own.adjoint.is_nan() && own.complex_step.is_nan())
    );
}

#[test]
fn vibrations_stand_where_they_mean_something() {
    let mut bare = pendulum(0.2);
    bare["functions"]["f"] = json!({"frequency": {"mode": 1}});
    let told = fault(&bare);
    assert!(told.contains("\"final\" or \"value\""), "{told}");
    let mut event = pendulum(0.2);
    event["simulation"]["until"] = json!({"measure": {"frequency": {"mode": 1}}, "reaches": 0.5});
    let told = fault(&event);
    assert!(told.contains("a vibration as an event"), "{told}");
    let mut rest = pendulum(0.2);
    let object = rest.as_object_mut().expect("an object");
    object.remove("simulation");
    rest["analysis"] = json!("rest");
    let told = fault(&rest);
    assert!(told.contains("of a machine at rest"), "{told}");
}
