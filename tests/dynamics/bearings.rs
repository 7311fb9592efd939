//! Friction of bearings and guides by the force across their axis: a loaded shaft that runs down, a block on its guide, derivatives by
//! every method, the same in other descriptions, and faults.

use super::couplings::{OBLIQUE, close, oblique, turned};
use crate::reference::documents::{
    faults_say, methods, problem as parsed, reversed, unlowered_values, values, vary,
};
use crate::reference::gradients::gradients_are_exact;
use serde_json::Value;

const GRAVITY: f64 = 9.81;

/// A rotor between two bearings of 1e6 N/m, each with half of its weight.
fn rotor(simulation: Value) -> Value {
    let bearing = |joint: &str| {
        json!({"bushing": {
            "joint": joint, "stiffness": {"diagonal": [1e6, 1e6, 1e5, 0, 0, 0]}, "damping": {"diagonal": [800, 800, 800, 0, 0, 0]},
            "friction": {"coefficient": 0.1, "radius": 0.03, "width": 0.1, "load_width": 0.5}}})
    };
    let joint = |at: f64| json!({"free": {"between": ["rotor", "ground"], "at": [0, 0, at], "axis": [0, 0, 1]}});
    json!({
        "version": 1, "name": "rotor", "gravity": [0, -GRAVITY, 0],
        "bodies": {"rotor": {"mass": 20, "inertia": {"xx": 0.3, "yy": 0.3, "zz": 0.25},
                             "place": {"at": [0, -20.0 * GRAVITY / 2e6, 0]}, "velocity": {"angular": [0, 0, 30]}}},
        "joints": {"left": joint(-0.3), "right": joint(0.3)},
        "loads": {"left": bearing("left"), "right": bearing("right")},
        "simulation": simulation,
        "functions": {
            "spin": {"final": {"angular_velocity": {"body": "rotor", "direction": [0, 0, 1]}}},
            "place": {"final": {"position": {"body": "rotor", "point": [0.1, 0, 0.2], "direction": [0.4, 1, 0.3]}}},
            "loss": {"integral": {"power": {"load": "left"}}}
        }
    })
}

/// The shaft runs down by the torque μ ρ m g of both bearings, which take the energy.
#[test]
fn a_shaft_runs_down_by_its_weight() {
    let time = 1.5;
    let found = values(&rotor(json!({"duration": time, "tolerance": 1e-9})));
    let half = 10.0 * GRAVITY;
    let load = half.hypot(0.5) - 0.5;
    let spin = 30.0 - 2.0 * 0.1 * 0.03 * load * time / 0.25;
    // The torque lifts the shaft a little out of its bearings.
    close(found[0], spin, 2e-5 * spin, "spin");
    let lost = 0.5 * 0.25 * (30.0_f64.powi(2) - spin * spin);
    close(
        found[2],
        -0.5 * lost,
        1e-4 * lost,
        "half of the energy in each bearing",
    );
}

/// A block slides along a guide under a force across it: it stops from v0 after v0 / (μ F / m), and the force is that of both pads.
#[test]
fn a_guide_brakes_by_the_force_across() {
    let (mass, push, mu) = (2.0, 50.0, 0.3);
    let pad = |joint: &str| {
        json!({"bushing": {
            "joint": joint, "stiffness": {"diagonal": [1e6, 1e6, 0, 0, 0, 10]}, "damping": {"diagonal": [500, 500, 0, 0, 0, 1]},
            "friction": {"motion": "slide", "coefficient": mu, "width": 1e-3, "load_width": 0.01}}})
    };
    let joint = |at: f64| json!({"free": {"between": ["block", "ground"], "at": [0, 0, at], "axis": [0, 0, 1]}});
    let found = values(&json!({
        "version": 1, "name": "guide", "gravity": [0, 0, 0],
        "bodies": {"block": {"shape": {"box": {"size": [0.1, 0.1, 0.4]}}, "mass": mass, "place": {"at": [push / 2e6, 0, 0]},
                             "velocity": {"linear": [0, 0, 1.5]}}},
        "joints": {"front": joint(0.1), "back": joint(-0.1)},
        "loads": {"front": pad("front"), "back": pad("back"),
                  "push": {"force": {"body": "block", "direction": [1, 0, 0], "magnitude": push}}},
        "simulation": {"duration": 0.01, "tolerance": 1e-9},
        "functions": {"speed": {"final": {"velocity": {"body": "block", "direction": [0, 0, 1]}}}}
    }));
    // The pads stay on ground, and the block between them: both press to the same side.
    let exact = 1.5 - mu * (push - 0.02) / mass * 0.01;
    close(found[0], exact, 1e-4, "speed");
}

#[test]
fn gradients_by_every_method() {
    for simulation in methods(0.02, 100) {
        let mut file = rotor(simulation.clone());
        let own = "/loads/left/bushing";
        vary(
            &mut file,
            &[
                format!("{own}/friction/coefficient"),
                format!("{own}/friction/radius"),
                format!("{own}/friction/width"),
                format!("{own}/friction/load_width"),
                format!("{own}/stiffness/diagonal/0"),
                format!("{own}/damping/diagonal/1"),
                "/bodies/rotor/mass".into(),
            ],
        );
        gradients_are_exact(&parsed(&file), &simulation);
    }
}

#[test]
fn the_same_in_other_descriptions() {
    let file = rotor(json!({"duration": 0.3, "tolerance": 1e-10}));
    let reference = values(&file);
    let agree = |found: &[f64], what: &str| {
        for (a, b) in found.iter().zip(&reference) {
            assert!(
                (a - b).abs() < 1e-6 * b.abs().max(1e-2),
                "{what}: {found:?} {reference:?}"
            );
        }
    };
    let mut other = turned(&file, &OBLIQUE);
    other["bodies"]["rotor"]["velocity"] = json!({"angular": oblique([0.0, 0.0, 30.0])});
    agree(&values(&other), "turned");
    agree(
        &values(&reversed(&file, &["joints", "loads"])),
        "in another order",
    );
    agree(&unlowered_values(&file), "without reductions");
}

/// A shaft on bearings of ground lies still in their springs and keeps its spin, however fast it turns: their damping does not turn
/// with it. That of the shaft's own axes throws it out above its critical speed, √(2k/m) = 316 rad/s.
#[test]
fn bearings_on_ground_do_not_turn_with_the_shaft() {
    let spin = 900.0;
    let of = |change: &dyn Fn(&mut Value)| {
        let mut file = rotor(json!({"duration": 0.6, "tolerance": 1e-9}));
        file["bodies"]["rotor"]["velocity"]["angular"] = json!([0, 0, spin]);
        file["bodies"]["rotor"]["place"] = json!({"at": [0, 0, 0]});
        for side in ["left", "right"] {
            let bearing = file["loads"][side]["bushing"]
                .as_object_mut()
                .expect("a bushing");
            bearing.remove("friction");
            change(&mut file["loads"][side]["bushing"]);
        }
        file["functions"] = json!({
            "spin": {"final": {"angular_velocity": {"body": "rotor", "direction": [0, 0, 1]}}},
            "sag": {"final": {"position": {"body": "rotor", "direction": [0, 1, 0]}}},
            "side": {"final": {"position": {"body": "rotor", "direction": [1, 0, 0]}}}
        });
        file
    };
    let sag = -20.0 * GRAVITY / 2e6;
    let still = |file: &Value, what: &str| {
        let [found, sagged, side] = values(file)[..] else {
            panic!("three values")
        };
        close(found, spin, 1e-9 * spin, what);
        close(sagged, sag, 1e-11, what);
        close(side, 0.0, 1e-11, what);
    };
    still(&of(&|_| ()), "by default");
    still(&of(&|bearing| bearing["axes"] = json!("second")), "by name");
    let mut other = of(&|bearing| bearing["axes"] = json!("first"));
    for side in ["left", "right"] {
        other["joints"][side]["free"]["between"] = json!(["ground", "rotor"]);
    }
    still(&other, "in another order");
    let mut housed = of(&|bearing| bearing["axes"] = json!("second"));
    housed["bodies"]["housing"] = json!({"mass": 3, "inertia": {"xx": 1, "yy": 1, "zz": 1}});
    housed["joints"]["fast"] = json!({"weld": {"between": ["housing", "ground"], "at": [0, 0, 0]}});
    for side in ["left", "right"] {
        housed["joints"][side]["free"]["between"] = json!(["rotor", "housing"]);
    }
    still(&housed, "in a housing");
    let thrown = values(&of(&|bearing| bearing["axes"] = json!("first")));
    assert!(thrown[2].hypot(thrown[1] - sag) > 1e-3, "{thrown:?}");
}

/// A shaft in bearings of a carrier that swings: axes of either body, with friction, by every method.
#[test]
fn gradients_with_the_axes_of_either_body() {
    for axes in ["first", "second"] {
        for method in methods(0.2, 60) {
            let mut file = rotor(method);
            file["bodies"]["carrier"] =
                json!({"mass": 30, "inertia": {"xx": 2, "yy": 3, "zz": 2.5}});
            file["joints"]["swing"] = json!({"revolute": {"between": ["carrier", "ground"], "at": [0, 1, 0.2], "axis": [1, 0.3, 0.2]}});
            for side in ["left", "right"] {
                file["joints"][side]["free"]["between"] = json!(["rotor", "carrier"]);
                file["loads"][side]["bushing"]["axes"] = json!(axes);
                file["loads"][side]["bushing"]["stiffness"] =
                    json!({"diagonal": [2e4, 3e4, 1e4, 0, 0, 0]});
            }
            let paths = [
                "/joints/left/free/at/0",
                "/joints/left/free/axis/1",
                "/loads/left/bushing/stiffness/diagonal/1",
                "/loads/right/bushing/damping/diagonal/0",
                "/loads/left/bushing/friction/coefficient",
                "/bodies/carrier/mass",
            ];
            vary(&mut file, &paths.map(str::to_owned));
            gradients_are_exact(&parsed(&file), &json!({"axes": axes}));
        }
    }
}

#[test]
fn bad_bearings_are_told() {
    let told = |change: &dyn Fn(&mut Value), words: &[&str]| {
        let mut file = rotor(json!({"duration": 0.1}));
        change(&mut file["loads"]["left"]["bushing"]["friction"]);
        faults_say(&file, words);
    };
    let own = "/loads/left/bushing/friction";
    told(
        &|friction| {
            friction.as_object_mut().expect("friction").remove("radius");
        },
        &[own, "the radius of the bearing"],
    );
    told(
        &|friction| friction["motion"] = json!("slide"),
        &[&format!("{own}/radius"), "no radius"],
    );
    let mut file = rotor(json!({"duration": 0.1}));
    file["joints"]["left"] =
        json!({"spherical": {"between": ["rotor", "ground"], "at": [0, 0, -0.3]}});
    faults_say(&file, &[own, "a \"free\" joint"]);
    told(
        &|friction| friction["width"] = json!(0),
        &[&format!("{own}/width")],
    );
}
