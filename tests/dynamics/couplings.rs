//! Couplings against closed forms: gears on ground, planetary sets by Willis' formula, bevel gears with bearing moments, racks,
//! screws, belts; a hundred turns, derivatives by every method, families, rest and vibrations, starts, redundancy.

use crate::reference::documents::{
    methods, problem as parsed, reversed, run, unlowered_values, value, values, vary,
};
use crate::reference::gradients::gradients_are_exact;
use flexbody_driver::simulate;
use flexbody_problem::Problem;
use serde_json::Value;
use std::f64::consts::{PI, TAU};

/// A disc of revolution about z with these moments.
fn disc(mass: f64, polar: f64, at: [f64; 3]) -> Value {
    json!({"mass": mass, "inertia": {"xx": 0.6 * polar, "yy": 0.6 * polar, "zz": polar}, "place": {"at": at}})
}

fn hinge(between: [&str; 2], at: [f64; 3]) -> Value {
    json!({"revolute": {"between": between, "at": at, "axis": [0, 0, 1]}})
}

pub fn close(found: f64, exact: f64, tolerance: f64, what: &str) {
    let off = (found - exact).abs();
    assert!(
        off <= tolerance * exact.abs().max(1e-3),
        "{what}: {found} {exact} {off:e}"
    );
}

/// Two gears of 20 and 50 teeth on ground; a torque turns the first.
fn two_gears(simulation: Value) -> Value {
    json!({
        "version": 1, "name": "two gears", "gravity": [0, 0, 0],
        "bodies": {"a": disc(2.0, 0.3, [0.0; 3]), "b": disc(5.0, 1.1, [0.35, 0.0, 0.0])},
        "joints": {"a": hinge(["a", "ground"], [0.0; 3]), "b": hinge(["b", "ground"], [0.35, 0.0, 0.0])},
        "couplings": {"mesh": {"gear": {"gears": ["a", "b"], "teeth": [20, 50]}}},
        "loads": {"motor": {"torque": {"body": "a", "direction": [0, 0, 1], "magnitude": 1.4}}},
        "simulation": simulation,
        "functions": {
            "rate a": {"final": {"angle_rate": {"joint": "a"}}},
            "angle a": {"final": {"angle": {"joint": "a"}}},
            "angle b": {"final": {"angle": {"joint": "b"}}},
            "on a": {"final": {"coupling_reaction": {"coupling": "mesh"}}},
            "on b": {"final": {"coupling_reaction": {"coupling": "mesh", "on": "b"}}}
        }
    })
}

/// The equivalent inertia at the first gear is J_a + J_b i², i = z_a/z_b, with outer and inner teeth.
#[test]
fn two_gears_have_an_equivalent_inertia() {
    for (inner, sense) in [(false, -1.0), (true, 1.0)] {
        let mut document = two_gears(json!({"duration": 3, "tolerance": 1e-10}));
        document["couplings"]["mesh"]["gear"]["inner"] = json!(inner);
        let i = 0.4;
        let acceleration = 1.4 / (0.3 + 1.1 * i * i);
        let exact = [
            3.0 * acceleration,
            4.5 * acceleration,
            sense * 4.5 * acceleration * i,
            0.3 * acceleration - 1.4,
            1.1 * sense * acceleration * i,
        ];
        for (found, exact) in values(&document).into_iter().zip(exact) {
            close(found, exact, 1e-9, "gears");
        }
        // The ratio in other words.
        let gear = &mut document["couplings"]["mesh"]["gear"];
        gear.as_object_mut().expect("an object").remove("teeth");
        gear["ratio"] = json!(2.5);
        close(value(&document, "on b"), exact[4], 1e-9, "by a ratio");
        let gear = &mut document["couplings"]["mesh"]["gear"];
        gear.as_object_mut().expect("an object").remove("ratio");
        gear["radii"] = json!([0.1, 0.25]);
        close(value(&document, "on b"), exact[4], 1e-9, "by radii");
    }
}

/// More than a hundred turns of the first gear, by every method; the derivative of an angle by the ratio has all of them:
/// φ_b = −φ_a/i with φ_a = ½ T t²/(J_a + J_b/i²).
#[test]
fn the_relation_holds_after_a_hundred_turns() {
    let methods = [
        json!({"duration": 22, "tolerance": 1e-9}),
        json!({"duration": 22, "steps": 1000, "method": {"radau": {"stages": 3}}}),
        json!({"duration": 22, "steps": 1500, "method": {"bdf": {"order": 2}}}),
        json!({"duration": 22, "steps": 1500, "method": {"generalised_alpha": {"radius": 0.8}}}),
    ];
    for simulation in methods {
        let mut document = two_gears(simulation.clone());
        let gear = &mut document["couplings"]["mesh"]["gear"];
        gear.as_object_mut().expect("an object").remove("teeth");
        gear["ratio"] = json!(2.5);
        vary(&mut document, &["/couplings/mesh/gear/ratio".into()]);
        // Accelerations lose digits by cancellation of the squares of the speeds, which are 60 rad/s.
        let functions = document["functions"].as_object_mut().expect("functions");
        functions.retain(|name, _| !name.starts_with("on "));
        let problem = parsed(&document);
        let motion = simulate(&problem, &problem.start()).expect("a motion");
        let [a, b] = [1, 2].map(|f| motion.at.function(f).value);
        assert!(a > 100.0 * TAU, "{a}");
        assert!((a + 2.5 * b).abs() < 1e-9 * a, "{simulation}: {a} {b}");
        gradients_are_exact(&problem, &simulation);
    }
    let mut document = two_gears(json!({"duration": 22, "tolerance": 1e-10}));
    document["couplings"]["mesh"]["gear"] = json!({"gears": ["a", "b"], "ratio": 2.5});
    vary(&mut document, &["/couplings/mesh/gear/ratio".into()]);
    let problem = parsed(&document);
    let found = flexbody_driver::check(&problem, &problem.start()).expect("derivatives");
    let (i, t2) = (2.5_f64, 22.0_f64.powi(2));
    let inertia = 0.3 + 1.1 / (i * i);
    let angle = 0.5 * 1.4 * t2 / inertia;
    let by_ratio = 0.5 * 1.4 * t2 / (inertia * inertia) * 2.2 / i.powi(3);
    close(found[1].adjoint, by_ratio, 1e-8, "dφ_a/di");
    close(
        found[2].adjoint,
        angle / (i * i) - by_ratio / i,
        1e-8,
        "dφ_b/di",
    );
}

/// Sun, planet, arm and ring of 24, 18 and 60 teeth and module 0.01.
fn planetary(locked: &str, driven: &str, loaded: &str) -> Value {
    let mut document = json!({
        "version": 1, "name": "planetary", "gravity": [0, 0, 0],
        "bodies": {
            "sun": disc(1.0, 0.02, [0.0; 3]),
            "planet": disc(0.6, 0.004, [0.21, 0.0, 0.0]),
            "arm": disc(2.0, 0.05, [0.0; 3]),
            "ring": disc(4.0, 0.4, [0.0; 3])
        },
        "joints": {
            "sun": hinge(["sun", "ground"], [0.0; 3]),
            "pin": hinge(["planet", "arm"], [0.21, 0.0, 0.0]),
            "arm": hinge(["arm", "ground"], [0.0; 3]),
            "ring": hinge(["ring", "ground"], [0.0; 3])
        },
        "couplings": {
            "inside": {"gear": {"gears": ["sun", "planet"], "carrier": "arm", "teeth": [24, 18]}},
            "outside": {"gear": {"gears": ["planet", "ring"], "carrier": "arm", "teeth": [18, 60], "inner": true}}
        },
        "drives": {"motor": {"joint": driven, "turn": {"rate": 8}}, "lock": {"joint": locked, "turn": {"rate": 0}}},
        "loads": {"load": {"torque": {"body": loaded, "direction": [0, 0, 1], "magnitude": -70}}},
        "simulation": {"duration": 2, "tolerance": 1e-9},
        "functions": {}
    });
    for joint in ["sun", "arm", "ring"] {
        document["functions"][format!("rate {joint}")] =
            json!({"final": {"angle_rate": {"joint": joint}}});
        document["functions"][format!("moment {joint}")] =
            json!({"final": {"joint_moment": {"joint": joint, "direction": [0, 0, 1]}}});
    }
    document
}

/// Willis: (ω_s − ω_c)/(ω_r − ω_c) = −z_r/z_s. Torques on sun, ring and arm are as 1 : z_r/z_s : −(1 + z_r/z_s).
#[test]
fn planetary_sets_follow_willis() {
    let k = 60.0 / 24.0;
    for (locked, driven, loaded) in [
        ("ring", "sun", "arm"),
        ("arm", "sun", "ring"),
        ("sun", "arm", "ring"),
    ] {
        let document = planetary(locked, driven, loaded);
        let rate = |joint: &str| value(&document, &format!("rate {joint}"));
        let [sun, arm, ring] = ["sun", "arm", "ring"].map(rate);
        let what = format!("{locked} locked");
        close(rate(driven), 8.0, 1e-9, &what);
        assert!(rate(locked).abs() < 1e-9, "{what}");
        assert!(
            (sun - arm + k * (ring - arm)).abs() < 1e-8,
            "{what}: {sun} {arm} {ring}"
        );
        let exact = match locked {
            "ring" => 8.0 / (1.0 + k),
            "arm" => -8.0 / k,
            _ => 8.0 * (1.0 + 1.0 / k),
        };
        close(rate(loaded), exact, 1e-8, &what);
        // At steady rates what drives and loads apply to the three is in balance.
        let part = |joint: &str| match joint {
            "sun" => 1.0,
            "ring" => k,
            _ => -(1.0 + k),
        };
        for joint in [locked, driven] {
            let moment = value(&document, &format!("moment {joint}"));
            close(moment, -70.0 * part(joint) / part(loaded), 1e-7, &what);
        }
        assert!(
            value(&document, &format!("moment {loaded}")).abs() < 1e-6,
            "{what}"
        );
    }
}

/// The axes of two bevel gears on ground meet at a right angle: the second turns by a/b of the first, with a and b the
/// distances of the teeth from the axes.
fn bevel() -> Value {
    json!({
        "version": 1, "name": "bevel", "gravity": [0, 0, 0],
        "bodies": {
            "a": {"mass": 1, "inertia": {"xx": 0.2, "yy": 0.2, "zz": 0.3}},
            "b": {"mass": 1, "inertia": {"xx": 0.7, "yy": 0.5, "zz": 0.5}}
        },
        "joints": {
            "a": {"revolute": {"between": ["a", "ground"], "at": [0, 0, 0], "axis": [0, 0, 1]}},
            "b": {"revolute": {"between": ["b", "ground"], "at": [0.4, 0, 0], "axis": [1, 0, 0]}}
        },
        "couplings": {"mesh": {"bevel": {"gears": ["a", "b"], "at": [0.12, 0, 0.2]}}},
        "loads": {"motor": {"torque": {"body": "a", "direction": [0, 0, 1], "magnitude": 2}}},
        "simulation": {"duration": 2, "tolerance": 1e-10},
        "functions": {"a": {"final": {"angle": {"joint": "a"}}}, "b": {"final": {"angle": {"joint": "b"}}},
                      "on b": {"final": {"coupling_reaction": {"coupling": "mesh", "on": "b"}}}}
    })
}

#[test]
fn bevel_gears_turn_by_the_distances_of_their_teeth() {
    let i = 0.12 / 0.2;
    let acceleration = 2.0 / (0.3 + 0.7 * i * i);
    let found = values(&bevel());
    close(found[0], 2.0 * acceleration, 1e-9, "first");
    // ω_a e_z × P = a ω_a e_y and ω_b e_x × P = −b ω_b e_y.
    close(found[1], -2.0 * acceleration * i, 1e-9, "second");
    close(
        found[2],
        -0.7 * acceleration * i,
        1e-9,
        "torque on the second",
    );
    let mut by_teeth = bevel();
    by_teeth["couplings"]["mesh"]["bevel"]["teeth"] = json!([30, 50]);
    close(values(&by_teeth)[1], found[1], 1e-9, "by teeth");
}

/// The edge mill: a wheel rolls on a gear that stands still while its arm turns at Ω. Relative to the arm it turns at
/// ω = Ω a/b, and its bearing holds the gyroscopic moment J_x ω Ω, J_x its moment about its axis.
#[test]
fn a_bevel_gear_on_a_turning_arm_loads_its_bearing() {
    let speed = 3.0;
    let document = json!({
        "version": 1, "name": "edge mill", "gravity": [0, 0, 0],
        "bodies": {
            "plate": {"mass": 1, "inertia": {"xx": 0.2, "yy": 0.2, "zz": 0.3}},
            "arm": {"mass": 1, "inertia": {"xx": 0.1, "yy": 0.1, "zz": 0.1}},
            "wheel": {"mass": 4, "inertia": {"xx": 0.7, "yy": 0.5, "zz": 0.5}, "place": {"at": [0.5, 0, 0.2]}}
        },
        "joints": {
            "plate": {"weld": {"between": ["plate", "ground"], "at": [0, 0, 0]}},
            "arm": {"revolute": {"between": ["arm", "ground"], "at": [0, 0, 0.2], "axis": [0, 0, 1]}},
            "axle": {"revolute": {"between": ["wheel", "arm"], "at": [0.5, 0, 0.2], "axis": [1, 0, 0]}}
        },
        "couplings": {"mesh": {"bevel": {"gears": ["plate", "wheel"], "carrier": "arm", "at": [0.5, 0, 0]}}},
        "drives": {"motor": {"joint": "arm", "turn": {"rate": speed}}},
        "simulation": {"duration": 1.7, "tolerance": 1e-10},
        "functions": {
            "turn": {"final": {"angle": {"joint": "axle"}}},
            "lowest": {"final": {"joint_moment": {"joint": "axle", "axes": "joint", "direction": [1, 0, 0]}}},
            "other": {"final": {"joint_moment": {"joint": "axle", "axes": "joint", "direction": [0, 1, 0]}}},
            "pull": {"final": {"joint_force": {"joint": "axle", "axes": "joint", "direction": [0, 0, 1]}}},
            "motor": {"final": {"joint_moment": {"joint": "arm", "direction": [0, 0, 1]}}}
        }
    });
    let found = values(&document);
    let ratio = 0.5 / 0.2;
    // The lowest point of the wheel stands still: Ω e_z × 0.5 e_x = −ω e_x × (−0.2 e_z) gives ω = −Ω a/b.
    close(found[0], -speed * 1.7 * ratio, 1e-9, "turn");
    let gyroscopic = 0.7 * (speed * ratio) * speed;
    close(found[1].hypot(found[2]), gyroscopic, 1e-8, "bearing moment");
    close(found[3], -4.0 * 0.5 * speed * speed, 1e-8, "bearing force");
    assert!(found[4].abs() < 1e-7, "{found:?}");
}

/// A torque on a pinion moves a rack: J φ̈ + m r s̈ = T, s = r φ to the side where they meet.
#[test]
fn a_pinion_moves_its_rack() {
    for (y, sense) in [(-0.15, 1.0), (0.15, -1.0)] {
        let document = json!({
            "version": 1, "name": "rack", "gravity": [0, 0, 0],
            "bodies": {"pinion": disc(1.0, 0.08, [0.0; 3]),
                       "rack": {"shape": {"box": {"size": [1, 0.1, 0.1]}}, "mass": 3, "place": {"at": [0.2, y, 0]}}},
            "joints": {"pinion": hinge(["pinion", "ground"], [0.0; 3]),
                       "rail": {"prismatic": {"between": ["rack", "ground"], "at": [0.2, y, 0], "axis": [1, 0, 0]}}},
            "couplings": {"mesh": {"rack_and_pinion": {"rack": "rack", "pinion": "pinion", "at": [0, y, 0]}}},
            "loads": {"motor": {"torque": {"body": "pinion", "direction": [0, 0, 1], "magnitude": 0.6}}},
            "simulation": {"duration": 5, "tolerance": 1e-10},
            "functions": {"turn": {"final": {"angle": {"joint": "pinion"}}}, "slide": {"final": {"slide": {"joint": "rail"}}},
                          "force": {"final": {"coupling_reaction": {"coupling": "mesh", "on": "rack"}}}}
        });
        let acceleration = 0.6 / (0.08 + 3.0 * 0.15 * 0.15);
        let found = values(&document);
        close(found[0], 12.5 * acceleration, 1e-9, "turn");
        close(found[1], sense * 12.5 * acceleration * 0.15, 1e-9, "slide");
        close(found[2], sense * 3.0 * acceleration * 0.15, 1e-9, "force");
    }
}

/// A nut falls on its screw: s̈ = −g/(1 + J (2π/l)²/m), of either hand.
#[test]
fn a_screw_falls_slowly() {
    for lead in [0.05, -0.08] {
        let mut document = json!({
            "version": 1, "name": "screw", "gravity": [0, 0, -9.81],
            "bodies": {"nut": disc(2.0, 0.003, [0.0; 3])},
            "joints": {"thread": {"cylindrical": {"between": ["nut", "ground"], "at": [0, 0, 0], "axis": [0, 0, 1]}}},
            "couplings": {"thread": {"screw": {"joint": "thread", "lead": lead}}},
            "simulation": {"duration": 2, "tolerance": 1e-10},
            "functions": {"slide": {"final": {"slide": {"joint": "thread"}}}, "turn": {"final": {"angle": {"joint": "thread"}}},
                          "torque": {"final": {"coupling_reaction": {"coupling": "thread"}}},
                          "force": {"final": {"coupling_reaction": {"coupling": "thread", "motion": "slide"}}}}
        });
        let inertia = 0.003 * (TAU / lead).powi(2);
        let acceleration = -9.81 / (1.0 + inertia / 2.0);
        let found = values(&document);
        close(found[0], 2.0 * acceleration, 1e-9, "slide");
        close(found[1], 2.0 * acceleration * TAU / lead, 1e-9, "turn");
        close(found[2], 0.003 * acceleration * TAU / lead, 1e-9, "torque");
        close(found[3], 2.0 * (acceleration + 9.81), 1e-9, "force");
        // Sides exchanged and the axis turned back, the thread has the same hand.
        document["joints"]["thread"]["cylindrical"]["between"] = json!(["ground", "nut"]);
        document["joints"]["thread"]["cylindrical"]["axis"] = json!([0, 0, -1]);
        close(-values(&document)[0], found[0], 1e-9, "turned back");
    }
}

/// Pulleys turn the same way with an open belt and opposite ways with a crossed one, whatever way their axes point.
#[test]
fn belts_turn_pulleys() {
    for (crossed, sense) in [(false, 1.0), (true, -1.0)] {
        for flipped in [1.0, -1.0] {
            let mut document = two_gears(json!({"duration": 1.5, "tolerance": 1e-10}));
            document["joints"]["b"]["revolute"]["axis"] = json!([0, 0, flipped]);
            document["couplings"] = json!({"mesh": {"belt": {"pulleys": ["a", "b"], "radii": [0.1, 0.2], "crossed": crossed}}});
            let acceleration = 1.4 / (0.3 + 1.1 * 0.25);
            let found = values(&document);
            close(found[1], 1.125 * acceleration, 1e-9, "first");
            close(
                found[2],
                flipped * sense * 0.5 * 1.125 * acceleration,
                1e-9,
                "second",
            );
        }
    }
}

/// A machine in space with all kinds: a motor turns a bevel pair; its shaft drives a planetary set by a belt, whose ring
/// moves a rack; a screw hangs on a relation with the rack; springs, gravity and an arm that sways.
fn machine(simulation: Value) -> Value {
    json!({
        "version": 1, "name": "machine", "gravity": [0.4, -3, -9],
        "bodies": {
            "motor": {"mass": 1, "inertia": {"xx": 0.04, "yy": 0.05, "zz": 0.05}, "place": {"at": [-0.4, 0, 0.3]}},
            "shaft": disc(1.5, 0.03, [0.0, 0.0, 0.1]),
            "sun": disc(1.0, 0.02, [0.5, 0.0, 0.0]),
            "planet": disc(0.6, 0.004, [0.71, 0.0, 0.0]),
            "arm": {"mass": 2, "centre_of_mass": [0.05, 0.02, 0], "inertia": {"xx": 0.04, "yy": 0.05, "zz": 0.05},
                    "place": {"at": [0.5, 0, 0]}},
            "ring": disc(4.0, 0.4, [0.5, 0.0, 0.0]),
            "rack": {"shape": {"box": {"size": [1, 0.1, 0.1]}}, "mass": 1.2, "place": {"at": [0.5, -0.5, 0]}},
            "nut": {"mass": 0.7, "inertia": {"xx": 0.01, "yy": 0.01, "zz": 0.012}, "place": {"at": [1.4, 0, 0]}}
        },
        "joints": {
            "motor": {"revolute": {"between": ["motor", "ground"], "at": [-0.4, 0, 0.3], "axis": [1, 0, 0],
                                   "start": {"turn": {"rate": 3}}}},
            "shaft": hinge(["shaft", "ground"], [0.0, 0.0, 0.1]),
            "sun": hinge(["ground", "sun"], [0.5, 0.0, 0.0]),
            "pin": hinge(["arm", "planet"], [0.71, 0.0, 0.0]),
            "arm": {"revolute": {"between": ["arm", "ground"], "at": [0.5, 0, 0], "axis": [0, 0, -2]}},
            "ring": hinge(["ring", "ground"], [0.5, 0.0, 0.0]),
            "rail": {"prismatic": {"between": ["rack", "ground"], "at": [0.5, -0.5, 0], "axis": [1, 0, 0]}},
            "thread": {"cylindrical": {"between": ["nut", "ground"], "at": [1.4, 0, 0], "axis": [0, 0.6, 0.8]}}
        },
        "couplings": {
            "bevel": {"bevel": {"gears": ["motor", "shaft"], "at": [-0.2, 0, 0.1]}},
            "belt": {"belt": {"pulleys": ["shaft", "sun"], "radii": [0.05, 0.08]}},
            "inside": {"gear": {"gears": ["sun", "planet"], "carrier": "arm", "radii": [0.12, 0.09]}},
            "outside": {"gear": {"gears": ["planet", "ring"], "carrier": "arm", "teeth": [18, 60], "inner": true}},
            "rack": {"rack_and_pinion": {"rack": "rack", "pinion": "ring", "at": [0.5, -0.45, 0], "radius": 0.4}},
            "screw": {"screw": {"joint": "thread", "lead": 0.3}},
            "lever": {"relation": {"terms": [{"joint": "rail", "slide": 0.7}, {"joint": "thread", "slide": -1.3}]}}
        },
        "loads": {
            "torque": {"torque": {"body": "motor", "direction": [1, 0, 0], "magnitude": 0.8}},
            "spring": {"torsion_spring": {"joint": "arm", "stiffness": 6, "damping": 0.05}},
            "pull": {"spring": {"between": ["rack", "ground"], "at": {"a": [0.2, 0, 0], "b": [1.5, -0.7, 0.2]}, "stiffness": 30,
                                "rest_length": 0.5}}
        },
        "simulation": simulation,
        "functions": {
            "slide": {"final": {"slide": {"joint": "thread"}}},
            "angle": {"integral": {"angle": {"joint": "arm"}}},
            "energy": {"integral": {"energy": "kinetic"}},
            "mesh": {"ks": {"rho": 2, "of": {"coupling_reaction": {"coupling": "inside", "on": "planet"}}}},
            "force": {"integral": {"coupling_reaction": {"coupling": "rack", "on": "rack"}}},
            "bearing": {"final": {"joint_force": {"joint": "arm", "direction": [1, 0, 0]}}}
        }
    })
}

#[test]
fn gradients_by_every_method() {
    for simulation in methods(0.8, 120) {
        let mut document = machine(simulation.clone());
        let paths = [
            "/couplings/bevel/bevel/at/0",
            "/couplings/belt/belt/radii/1",
            "/couplings/inside/gear/radii/0",
            "/couplings/outside/gear/teeth/1",
            "/couplings/rack/rack_and_pinion/radius",
            "/couplings/screw/screw/lead",
            "/couplings/lever/relation/terms/0/slide",
            "/couplings/lever/relation/terms/1/slide",
            "/bodies/rack/mass",
            "/bodies/arm/centre_of_mass/0",
            "/joints/motor/revolute/start/turn/rate",
            "/loads/spring/torsion_spring/stiffness",
        ];
        vary(&mut document, &paths.map(String::from));
        // The place of the teeth stays in the plane of both axes.
        document["variables"]["/couplings/bevel/bevel/at/0"] =
            json!({"path": "/couplings/bevel/bevel/at/0", "lower": -0.3, "upper": -0.1});
        gradients_are_exact(&parsed(&document), &simulation);
    }
}

/// The methods agree, energy is kept, and the bodies are connected: one degree of freedom is left.
#[test]
fn methods_agree_and_energy_is_kept() {
    let mut document = machine(json!({"duration": 0.8, "tolerance": 1e-10}));
    let reference = values(&document);
    document["simulation"] =
        json!({"duration": 0.8, "tolerance": 1e-8, "method": {"radau": {"stages": 3}}});
    for (a, b) in values(&document).into_iter().zip(&reference) {
        assert!((a - b).abs() < 1e-5 * b.abs().max(0.1), "{a} {b}");
    }
    document["loads"]["spring"]["torsion_spring"]["damping"] = json!(0);
    let loads = document["loads"].as_object_mut().expect("an object");
    loads.remove("torque");
    document["functions"] = json!({"energy": {"final": {"energy": "total"}}, "start": {"value": {"at": 0, "of": {"energy": "total"}}}});
    document["simulation"] = json!({"duration": 3, "tolerance": 1e-10});
    let found = values(&document);
    assert!(
        (found[0] - found[1]).abs() < 1e-6 * found[1].abs().max(1.0),
        "{found:?}"
    );
}

/// A turn about an oblique axis.
pub const OBLIQUE: [[f64; 3]; 3] = [[0.8, -0.48, 0.36], [0.6, 0.64, -0.48], [0.0, 0.6, 0.8]];

/// A vector that is turned by it.
pub fn oblique(x: [f64; 3]) -> [f64; 3] {
    OBLIQUE.map(|row| row.iter().zip(x).map(|(a, b)| a * b).sum::<f64>())
}

/// A document whose vectors are turned by a rotation matrix, and mirrored in a plane if it is not proper.
pub fn turned(document: &Value, matrix: &[[f64; 3]; 3]) -> Value {
    let apply = |x: &Value| -> Value {
        let x: Vec<f64> = x
            .as_array()
            .expect("a vector")
            .iter()
            .map(|x| x.as_f64().expect("a number"))
            .collect();
        let row = |r: &[f64; 3]| r.iter().zip(&x).map(|(a, b)| a * b).sum::<f64>();
        json!([row(&matrix[0]), row(&matrix[1]), row(&matrix[2])])
    };
    fn visit(value: &mut Value, key: &str, apply: &dyn Fn(&Value) -> Value) {
        const VECTORS: [&str; 5] = ["at", "axis", "direction", "gravity", "b"];
        match value {
            Value::Array(all) if VECTORS.contains(&key) && all.len() == 3 => *value = apply(value),
            Value::Object(map) => {
                for (key, value) in map {
                    visit(value, key, apply);
                }
            }
            _ => {}
        }
    }
    let mut out = document.clone();
    let [x, y, z] = matrix;
    let quaternion = json!({"matrix": [x, y, z]});
    visit(&mut out, "", &apply);
    for body in out["bodies"].as_object_mut().expect("bodies").values_mut() {
        body["place"]["turn"] = quaternion.clone();
    }
    out
}

/// The same motion of the machine turned obliquely, in other lengths, in another order, with the sides of joints
/// exchanged, and without reductions.
#[test]
fn the_same_in_other_descriptions() {
    let mut document = machine(json!({"duration": 0.8, "tolerance": 1e-10}));
    document["functions"]
        .as_object_mut()
        .expect("an object")
        .remove("bearing");
    let reference = values(&document);
    let agree = |found: &[f64], what: &str| {
        for (a, b) in found.iter().zip(&reference) {
            assert!(
                (a - b).abs() < 1e-6 * b.abs().max(0.1),
                "{what}: {found:?} {reference:?}"
            );
        }
    };
    let (c, s) = (0.8, 0.6);
    let oblique = [
        [c, -s * 0.8, s * 0.6],
        [s, c * 0.8, -c * 0.6],
        [0.0, 0.6, 0.8],
    ];
    agree(&values(&turned(&document, &oblique)), "turned");
    let other = reversed(&document, &["bodies", "joints", "couplings"]);
    agree(&values(&other), "in another order");
    let mut exchanged = document.clone();
    for (joint, between) in [
        ("sun", ["sun", "ground"]),
        ("pin", ["planet", "arm"]),
        ("ring", ["ground", "ring"]),
    ] {
        exchanged["joints"][joint]["revolute"]["between"] = json!(between);
    }
    exchanged["couplings"]["outside"]["gear"]["gears"] = json!(["ring", "planet"]);
    exchanged["couplings"]["outside"]["gear"]["teeth"] = json!([60, 18]);
    exchanged["couplings"]["belt"]["belt"]["pulleys"] = json!(["sun", "shaft"]);
    exchanged["couplings"]["belt"]["belt"]["radii"] = json!([0.08, 0.05]);
    agree(&values(&exchanged), "sides exchanged");
    agree(&unlowered_values(&document), "without reductions");
}

/// Planar sets are reduced to their plane, also in millimetres and mirrored, with the same motion.
#[test]
fn planar_sets_stay_in_their_plane() {
    let mut document = planetary("ring", "sun", "arm");
    document["drives"]
        .as_object_mut()
        .expect("an object")
        .remove("motor");
    document["loads"]["spring"] = json!({"torsion_spring": {"joint": "pin", "stiffness": 40}});
    let problem = parsed(&document);
    assert!(
        problem
            .lowering
            .as_ref()
            .is_some_and(|own| own.plane.is_ok())
    );
    let motion = |problem: &Problem| {
        let found = simulate(problem, &problem.start()).expect("a motion");
        (0..6)
            .map(|f| found.at.function(f).value)
            .collect::<Vec<f64>>()
    };
    let reference = motion(&problem);
    let mut full = problem.clone();
    full.lowering = None;
    let agree = |found: Vec<f64>, factors: [f64; 2], what: &str| {
        for (k, (a, b)) in found.iter().zip(&reference).enumerate() {
            let exact = b * factors[k % 2];
            assert!(
                (a - exact).abs() < 1e-6 * exact.abs().max(1.0),
                "{what}: {found:?} {reference:?}"
            );
        }
    };
    agree(motion(&full), [1.0, 1.0], "without reductions");
    // Mirrored in the plane across x: all turn the other way.
    let mut mirrored = document.clone();
    mirrored["bodies"]["planet"]["place"]["at"] = json!([-0.21, 0, 0]);
    mirrored["joints"]["pin"]["revolute"]["at"] = json!([-0.21, 0, 0]);
    mirrored["loads"]["load"]["torque"]["magnitude"] = json!(70);
    agree(motion(&parsed(&mirrored)), [-1.0, -1.0], "mirrored");
    // In millimetres and tonnes, torques are in N mm.
    let mut small = document.clone();
    for body in small["bodies"]
        .as_object_mut()
        .expect("bodies")
        .values_mut()
    {
        body["mass"] = json!(body["mass"].as_f64().expect("a mass") * 1e-3);
        for key in ["xx", "yy", "zz"] {
            body["inertia"][key] = json!(body["inertia"][key].as_f64().expect("a moment") * 1e3);
        }
    }
    small["bodies"]["planet"]["place"]["at"] = json!([210, 0, 0]);
    small["joints"]["pin"]["revolute"]["at"] = json!([210, 0, 0]);
    small["loads"]["load"]["torque"]["magnitude"] = json!(-70e3);
    small["loads"]["spring"]["torsion_spring"]["stiffness"] = json!(40e3);
    agree(motion(&parsed(&small)), [1.0, 1e3], "in millimetres");
}

/// A spring at the second gear holds a torque on the first: φ_b = T i_b/k; vibrations with √(k i²/(J_a + J_b i²)).
#[test]
fn at_rest_and_in_vibration() {
    let mut document = two_gears(Value::Null);
    let map = document.as_object_mut().expect("an object");
    map.remove("simulation");
    map.insert("analysis".into(), json!("rest"));
    document["loads"]["spring"] = json!({"torsion_spring": {"joint": "b", "stiffness": 3}});
    document["functions"] = json!({
        "a": {"final": {"angle": {"joint": "a"}}},
        "b": {"final": {"angle": {"joint": "b"}}},
        "on b": {"final": {"coupling_reaction": {"coupling": "mesh", "on": "b"}}},
        "frequency": {"frequency": {"mode": 1}}
    });
    vary(
        &mut document,
        &[
            "/couplings/mesh/gear/teeth/0",
            "/loads/spring/torsion_spring/stiffness",
            "/bodies/a/inertia/zz",
        ]
        .map(String::from),
    );
    let i = 0.4_f64;
    let b = -1.4 / i / 3.0;
    let exact = [
        -b / i,
        b,
        3.0 * b,
        (3.0 * i * i / (0.3 + 1.1 * i * i)).sqrt() / TAU,
    ];
    for (found, exact) in values(&document).into_iter().zip(exact) {
        close(found, exact, 1e-9, "rest");
    }
    gradients_are_exact(&parsed(&document), &json!("rest"));
}

/// All follow the rate of one joint. A relation with a constant is assembled.
#[test]
fn starts_follow_couplings() {
    let mut document = planetary("ring", "sun", "arm");
    document["drives"]
        .as_object_mut()
        .expect("an object")
        .remove("motor");
    document["loads"] = json!({});
    document["joints"]["arm"]["revolute"]["start"] = json!({"turn": {"angle": 0.3, "rate": 2}});
    let motion = run(&document);
    close(motion.at.function(0).value, 7.0, 1e-9, "sun");
    close(motion.at.function(2).value, 2.0, 1e-9, "arm");
    let mut document = two_gears(json!({"duration": 0.001}));
    document["loads"] = json!({});
    let functions = document["functions"].as_object_mut().expect("functions");
    functions.retain(|name, _| !name.starts_with("on "));
    document["couplings"] = json!({"lever": {"relation": {"terms": [{"joint": "a", "turn": 2}, {"joint": "b", "turn": 1}],
                                                          "constant": 0.5}}});
    let found = values(&document);
    // The nearest position in the metric of the inertia, of finite angles.
    assert!((2.0 * found[1] + found[2] - 0.5).abs() < 1e-9, "{found:?}");
    assert!(found[1] > 0.0 && found[2] > 0.0, "{found:?}");
    // From a start of several turns.
    document["joints"]["a"]["revolute"]["start"] = json!({"turn": {"angle": 4.0 * PI}});
    document["couplings"]["lever"]["relation"]["constant"] = json!(8.0 * PI + 0.25);
    let found = values(&document);
    assert!(
        (2.0 * found[1] + found[2] - 8.0 * PI - 0.25).abs() < 1e-9,
        "{found:?}"
    );
}

/// What a relation with a constant leads starts where it puts it, over any number of turns, and drives are starts: the wheel
/// that meshes with a driven one stays where it is placed, wherever the drive begins.
#[test]
fn couplings_lead_from_starts_and_drives() {
    let mut document = two_gears(json!({"duration": 0.001}));
    document["loads"] = json!({});
    document["functions"] = json!({
        "a": {"value": {"at": 0, "of": {"angle": {"joint": "a"}}}}, "b": {"value": {"at": 0, "of": {"angle": {"joint": "b"}}}}
    });
    let meshed = document["couplings"].clone();
    for start in [0.3, 1.3, 1.5, 1.6, 2.5, 3.5, 7.0, -9.0] {
        document["couplings"] = json!({"lever": {"relation": {"terms": [{"joint": "a", "turn": 1}, {"joint": "b", "turn": -1}],
                                                              "constant": 0}}});
        for driven in [false, true] {
            let mut own = document.clone();
            match driven {
                true => {
                    own["drives"] = json!({"m": {"joint": "a", "turn": {"polynomial": [start]}}})
                }
                false => {
                    own["joints"]["a"]["revolute"]["start"] = json!({"turn": {"angle": start}})
                }
            }
            for found in values(&own) {
                close(found, start, 1e-9, "a relation");
            }
        }
        document["couplings"] = meshed.clone();
        let mut own = document.clone();
        own["drives"] = json!({"m": {"joint": "a", "turn": {"polynomial": [start]}}});
        let found = values(&own);
        close(found[0], start, 1e-9, "a driven gear");
        assert!(found[1].abs() < 1e-9, "{found:?}");
    }
}

/// A second coupling of the same two gears, or drives of both, leave a row over, which is named; a ratio that contradicts
/// them cannot move.
#[test]
fn redundant_couplings_are_named() {
    let mut document = two_gears(json!({"duration": 1}));
    document["couplings"]["again"] =
        json!({"relation": {"terms": [{"joint": "b", "turn": 5}, {"joint": "a", "turn": 2}]}});
    let reference = values(&two_gears(json!({"duration": 1})));
    let found = values(&document);
    for k in 0..3 {
        close(found[k], reference[k], 1e-8, "twice");
    }
    let problem = parsed(&document);
    let notes = problem.redundant.iter().map(|own| own.joint.as_str());
    let notes: Vec<&str> = notes.collect();
    assert_eq!(notes, ["again (a)"]);
}

/// A pair of gears and their rack as a part that is used twice, the second time turned and with another ratio.
#[test]
fn parts_have_couplings() {
    let part = json!({
        "parameters": {"ratio": 2.5},
        "bodies": {"a": disc(2.0, 0.3, [0.0; 3]), "b": disc(5.0, 1.1, [0.35, 0.0, 0.0])},
        "joints": {"a": hinge(["a", "ground"], [0.0; 3]), "b": hinge(["b", "ground"], [0.35, 0.0, 0.0])},
        "couplings": {"mesh": {"gear": {"gears": ["a", "b"], "ratio": "= ratio"}}},
        "loads": {"motor": {"torque": {"body": "a", "direction": [0, 0, 1], "magnitude": 1.4}}}
    });
    let document = json!({
        "version": 1, "name": "parts", "gravity": [0, 0, 0],
        "parts": {"pair": part},
        "use": {"left": {"part": "pair"},
                "right": {"part": "pair", "at": [1, 2, 3], "turn": {"x": 40}, "parameters": {"ratio": 4}}},
        "simulation": {"duration": 2, "tolerance": 1e-10},
        "functions": {"left": {"final": {"angle": {"joint": "left/b"}}}, "right": {"final": {"angle": {"joint": "right/b"}}}}
    });
    for (found, ratio) in values(&document).into_iter().zip([2.5, 4.0]) {
        let acceleration = 1.4 / (0.3 + 1.1 / (ratio * ratio));
        close(found, -2.0 * acceleration / ratio, 1e-9, "a part");
    }
}

/// Two gears and a spring on an arm that turns steadily: with i = z_a/z_b and the inertia I of arm and places,
/// ω² = k/(m22 − m12²/m11), m11 = I + J_a + J_b, m12 = J_a − i J_b, m22 = J_a + i² J_b, whatever the speed.
#[test]
fn vibrations_in_steady_rotation() {
    let mut document = json!({
        "version": 1, "name": "turning", "analysis": "modes", "gravity": [0, 0, 0],
        "turning": {"axis": [0, 0, 1], "speed": 5},
        "bodies": {"arm": disc(1.0, 0.2, [0.0; 3]), "a": disc(2.0, 0.3, [0.2, 0.0, 0.0]), "b": disc(3.0, 0.5, [-0.3, 0.0, 0.0])},
        "joints": {"arm": hinge(["arm", "ground"], [0.0; 3]), "a": hinge(["a", "arm"], [0.2, 0.0, 0.0]),
                   "b": hinge(["b", "arm"], [-0.3, 0.0, 0.0])},
        "couplings": {"mesh": {"gear": {"gears": ["a", "b"], "teeth": [20, 30]}}},
        "loads": {"spring": {"torsion_spring": {"joint": "a", "stiffness": 40}}},
        "functions": {"frequency": {"frequency": {"mode": 1}}}
    });
    let i = 20.0 / 30.0;
    let (m11, m12, m22) = (
        0.2 + 2.0 * 0.04 + 3.0 * 0.09 + 0.8,
        0.3 - 0.5 * i,
        0.3 + 0.5 * i * i,
    );
    let exact = (40.0_f64 / (m22 - m12 * m12 / m11)).sqrt() / TAU;
    close(values(&document)[0], exact, 1e-9, "frequency");
    vary(
        &mut document,
        &[
            "/couplings/mesh/gear/teeth/0".into(),
            "/bodies/b/mass".into(),
        ],
    );
    gradients_are_exact(&parsed(&document), &json!("turning"));
}
