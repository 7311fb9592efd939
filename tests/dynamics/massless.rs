//! Links without mass: the limit of small masses, and clear faults where their motion is not determined.

use crate::reference::documents::{problem, values};
use crate::reference::gradients::gradients_are_exact;
use flexbody_problem::Problem;
use serde_json::Value;

/// A four-bar linkage whose coupler has this mass, turned about an axis; by this method.
fn linkage(mass: f64, turn: f64, method: &str) -> Value {
    let (s, c) = f64::sin_cos(turn);
    let along = |x: f64, y: f64| json!([x * c, y, -x * s]);
    let axis = json!([s, 0, c]);
    let turned = |angle: f64| json!({"sequence": "yzx", "angles": [turn, angle, 0]});
    let rod = |length: f64, at: Value, angle: f64| {
        json!({"shape": {"rod": {"length": length, "radius": 0.01}}, "mass": 1,
            "points": {"a": [-0.5 * length, 0, 0], "b": [0.5 * length, 0, 0]},
            "place": {"put": "a", "at": at, "turn": turned(angle)}})
    };
    let moment = mass * 0.02;
    let hinge = |between: [&str; 2], at: Value| json!({"revolute": {"between": between, "at": at, "axis": axis}});
    json!({
        "version": 1, "name": "linkage", "gravity": [0, -9.81, 0],
        "bodies": {
            "crank": rod(0.2, along(0.0, 0.0), 1.0),
            "coupler": {"mass": mass, "inertia": {"xx": moment, "yy": moment, "zz": moment},
                "points": {"a": [-0.25, 0, 0], "b": [0.25, 0, 0]},
                "place": {"put": "a", "at": "crank.b", "turn": turned(0.4)}},
            "rocker": rod(0.4, along(0.6, 0.0), 1.7)
        },
        "joints": {
            "o": hinge(["crank", "ground"], along(0.0, 0.0)),
            "p": hinge(["coupler", "crank"], json!({"a": "a", "b": "b"})),
            "q": hinge(["coupler", "rocker"], json!({"a": "b", "b": "b"})),
            "r": hinge(["rocker", "ground"], along(0.6, 0.0))
        },
        "loads": {"spring": {"spring": {"between": ["rocker", "ground"], "at": {"a": "b", "b": along(0.9, 0.5)},
            "rest_length": 0.3, "stiffness": 40, "damping": 1}}},
        "simulation": {"duration": 0.8, "tolerance": 1e-10, "method": method},
        "functions": {
            "turn": {"final": {"rotation": {"body": "crank", "axis": axis}}},
            "fast": {"ks": {"rho": 20, "of": {"speed": {"body": "coupler"}}}},
            "held": {"mean_square": {"joint_force": {"joint": "q", "direction": [0, 1, 0]}}}
        },
        "variables": {
            "crank": {"path": "/bodies/crank/mass", "lower": 0.1, "upper": 3},
            "stiffness": {"path": "/loads/spring/spring/stiffness", "lower": 1, "upper": 100}
        }
    })
}

/// Values at mass zero are those to which small masses tend, in proportion to the mass, and derivatives are exact; by explicit and
/// implicit methods, in any plane.
#[test]
fn a_link_without_mass_is_the_limit_of_light_ones() {
    let mut former: Option<Vec<f64>> = None;
    for (turn, method) in [
        (0.0, "dop853"),
        (0.0, "radau"),
        (0.7, "dop853"),
        (0.7, "radau"),
        (0.7, "bdf"),
    ] {
        let mut document = linkage(0.0, turn, method);
        if method == "radau" {
            document["simulation"]["method"] = json!({"radau": {"stages": 3}});
        }
        if method == "bdf" {
            document["simulation"] =
                json!({"duration": 0.8, "steps": 4000, "method": {"bdf": {"order": 3}}});
        }
        let found = values(&document);
        let tolerance = if method == "bdf" { 1e-5 } else { 1e-7 };
        let same = former.get_or_insert_with(|| found.clone());
        for (x, y) in found.iter().zip(same.iter()) {
            assert!((x / y - 1.0).abs() < tolerance, "{method} {turn}: {x} {y}");
        }
        gradients_are_exact(&problem(&document), &document);
    }
    let exact = former.expect("values");
    let distance = |mass: f64| {
        let found = values(&linkage(mass, 0.0, "dop853"));
        let parts = found.iter().zip(&exact).map(|(x, y)| (x / y - 1.0).abs());
        parts.fold(0.0, f64::max)
    };
    let [light, lighter] = [1e-3, 1e-5].map(distance);
    assert!(
        light < 0.02 && (light / lighter / 100.0 - 1.0).abs() < 0.1,
        "{light} {lighter}"
    );
}

/// Two welded links without mass are one; a link of a chain in space likewise.
#[test]
fn links_without_mass_may_be_welded() {
    let whole = values(&linkage(0.0, 0.3, "dop853"));
    let mut document = linkage(0.0, 0.3, "dop853");
    document["bodies"]["rider"] = json!({"mass": 0, "place": {"at": "coupler"}});
    document["joints"]["weld"] =
        json!({"weld": {"between": ["rider", "coupler"], "at": "coupler"}});
    let found = values(&document);
    for (x, y) in found.iter().zip(&whole) {
        assert!((x / y - 1.0).abs() < 1e-9, "{x} {y}");
    }
}

/// A linkage in space: the coupler has a spherical joint at the crank and a universal one at the rocker, so that it cannot spin.
fn in_space(mass: f64, universal: bool) -> Value {
    let mut document = linkage(mass, 0.0, "dop853");
    document["bodies"]["coupler"]["place"] =
        json!({"put": "a", "at": "crank.b", "turn": {"sequence": "yzx", "angles": [0.3, 0.4, 0]}});
    document["bodies"]["rocker"]["place"] = json!({"put": "b", "at": "coupler.b", "turn": {"sequence": "yzx", "angles": [0.4, 1.7, 0]}});
    let joints = document["joints"].as_object_mut().expect("joints");
    joints["p"] =
        json!({"spherical": {"between": ["coupler", "crank"], "at": {"a": "a", "b": "b"}}});
    joints["q"] = match universal {
        true => json!({"universal": {"between": ["coupler", "rocker"], "at": {"a": "b", "b": "b"},
            "axis": [0, 1, 0], "cross": [0, 0, 1]}}),
        false => {
            json!({"spherical": {"between": ["coupler", "rocker"], "at": {"a": "b", "b": "b"}}})
        }
    };
    joints["r"] = json!({"revolute": {"between": ["rocker", "ground"], "at": "rocker.a", "axis": [0.38941834, 0, 0.92106099]}});
    document["functions"]["turn"] =
        json!({"final": {"position": {"body": "rocker", "point": "b", "direction": [0, 1, 0]}}});
    document
}

/// Also in space; a rod that can spin about itself is refused, with or without mass.
#[test]
fn a_link_without_mass_moves_in_space() {
    let document = in_space(0.0, true);
    let exact = values(&document);
    let light = values(&in_space(1e-5, true));
    for (x, y) in light.iter().zip(&exact) {
        assert!((x / y - 1.0).abs() < 1e-3, "{x} {y}");
    }
    gradients_are_exact(&problem(&document), &document);
    let text = refused(&in_space(0.0, false));
    assert!(text.contains("without inertia: coupler,"), "{text}");
}

/// Joints of a loop start as given, also those of a link without mass.
#[test]
fn joints_of_links_without_mass_start_as_given() {
    for joint in ["o", "p", "r"] {
        let at = |mass: f64| {
            let mut document = linkage(mass, 0.4, "dop853");
            document["joints"][joint]["revolute"]["start"] =
                json!({"turn": {"angle": 0.2, "rate": 1.5}});
            document["functions"]["rate"] =
                json!({"value": {"at": 0, "of": {"angle_rate": {"joint": joint}}}});
            let found = values(&document);
            assert!((found[3] - 1.5).abs() < 1e-9, "{joint} {found:?}");
            found
        };
        for (x, y) in at(0.0).iter().zip(at(1e-6)) {
            assert!((x / y - 1.0).abs() < 1e-3, "{joint} {x} {y}");
        }
    }
}

/// In equilibrium a link without mass takes its loads to its neighbours, flexible ones too: an arch of a beam, such a link and a
/// strut, which rests as it starts.
#[test]
fn links_without_mass_start_in_equilibrium() {
    let arch = |mass: f64| {
        let moment = 0.01 * mass;
        json!({
            "version": 1, "name": "arch",
            "bodies": {
                "beam": {"beam": {"length": 1, "section": {"rectangle": {"width": 0.02, "height": 0.01}},
                    "material": {"young": 7e9, "density": 2700}, "modes": {"bending_y": 3, "bending_z": 0, "torsion": 0},
                    "damping": {"ratio": 0.02}}, "place": {"put": "start", "at": [0, 0, 0]}},
                "link": {"mass": mass, "inertia": {"xx": moment, "yy": moment, "zz": moment},
                    "points": {"load": [0.1, 0.05, 0]}, "place": {"at": [1, 0, 0]}},
                "strut": {"shape": {"box": {"size": [0.1, 0.3, 0.1]}}, "mass": 0.5, "place": {"at": [1.2, -0.1, 0]}}
            },
            "joints": {
                "root": {"weld": {"between": ["beam", "ground"], "at": "beam.start"}},
                "tip": {"revolute": {"between": ["link", "beam"], "at": "beam.end", "axis": [0, 0, 1]}},
                "knee": {"revolute": {"between": ["link", "strut"], "at": [1.2, 0.05, 0], "axis": [0, 0, 1]}},
                "foot": {"revolute": {"between": ["strut", "ground"], "at": [1.2, -0.25, 0], "axis": [0, 0, 1]}}
            },
            "loads": {
                "push": {"force": {"body": "link", "point": "load", "direction": [0, -1, 0], "magnitude": 1}},
                "twist": {"torque": {"body": "link", "direction": [0, 0, 1], "magnitude": 0.5}}
            },
            "start": "equilibrium", "simulation": {"duration": 0.2},
            "functions": {
                "height": {"final": {"position": {"body": "link", "point": "load", "direction": [0, 1, 0]}}},
                "force": {"final": {"joint_force": {"joint": "tip", "direction": [0, 1, 0]}}},
                "strain": {"mean": {"strain_energy": {"body": "beam"}}},
                "still": {"final": {"speed_squared": {"body": "strut"}}}
            },
            "variables": {
                "push": {"path": "/loads/push/force/magnitude", "lower": 0.1, "upper": 2},
                "young": {"path": "/bodies/beam/beam/material/young", "lower": 1e9, "upper": 1e10}
            }
        })
    };
    let document = arch(0.0);
    let [height, force, strain, still] = values(&document)[..] else {
        panic!("four values");
    };
    assert!(still < 1e-15, "{still}");
    let light = values(&arch(1e-6));
    for (x, y) in [height, force, strain].iter().zip(&light) {
        assert!((x / y - 1.0).abs() < 1e-4, "{x} {y}");
    }
    // An end piece without mass that is welded to a beam.
    let mut document = arch(0.0);
    document["joints"] = json!({
        "root": document["joints"]["root"],
        "tip": {"weld": {"between": ["link", "beam"], "at": "beam.end"}}
    });
    document["bodies"]
        .as_object_mut()
        .expect("bodies")
        .shift_remove("strut");
    document["functions"]
        .as_object_mut()
        .expect("functions")
        .shift_remove("still");
    let welded = values(&document);
    let stiffness = 7e9 * 0.02 * 0.01_f64.powi(3) / 12.0;
    // Its weight, 1 N at 0.1 m beyond its tip, and 0.5 N m at the tip.
    let (weight, twist) = (2700.0 * 0.02 * 0.01 * 9.81, 0.5 - 0.1);
    let sag = (weight / 8.0 + 1.0 / 3.0 - twist / 2.0) / stiffness;
    let slope = (weight / 6.0 + 0.5 - twist) / stiffness;
    let exact = 0.05 - sag - 0.1 * slope;
    assert!(
        (welded[0] - exact).abs() < 0.02 * sag,
        "{} {exact} {sag}",
        welded[0]
    );
}

/// What is said of a file that cannot be read.
fn refused(document: &Value) -> String {
    let faults = Problem::parse(&document.to_string(), "linkage.json", &[]);
    faults.expect_err("a fault").to_string()
}

/// A link without mass that hangs on one joint, is free, or is held by springs alone: its motion is not determined, and this is
/// told by name. Its own mass is not negative, and no variable.
#[test]
fn free_links_without_mass_are_refused() {
    let mut document = linkage(0.0, 0.0, "dop853");
    document["bodies"]["tail"] =
        json!({"mass": 0, "points": {"a": [-0.1, 0, 0]}, "place": {"put": "a", "at": "rocker.b"}});
    let hinge =
        json!({"revolute": {"between": ["tail", "rocker"], "at": "rocker.b", "axis": [0, 0, 1]}});
    let slider =
        json!({"prismatic": {"between": ["tail", "ground"], "at": "rocker.b", "axis": [1, 0, 0]}});
    document["loads"]["tail"] = json!({"spring": {"between": ["tail", "ground"], "at": {"a": "a", "b": [0, 0, 0]}, "rest_length": 0.3, "stiffness": 40}});
    for joint in [Some(hinge), Some(slider), None] {
        match joint {
            Some(joint) => document["joints"]["end"] = joint,
            None => {
                let joints = document["joints"].as_object_mut().expect("joints");
                joints.shift_remove("end");
            }
        }
        let text = refused(&document);
        let named = text.contains("without inertia: tail,");
        assert!(
            named && text.contains("a body without mass needs joints"),
            "{text}"
        );
    }
    document["bodies"]["tail"]["mass"] = json!(-1);
    assert!(refused(&document).contains("/bodies/tail/mass"));
    let mut document = linkage(0.0, 0.0, "dop853");
    document["variables"]["coupler"] =
        json!({"path": "/bodies/coupler/mass", "lower": 0, "upper": 1});
    let text = refused(&document);
    assert!(text.contains("a lower bound above 0 kg"), "{text}");
}
