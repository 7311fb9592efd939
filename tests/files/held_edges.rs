//! What holds an edge: all of its nodes, or their average, whatever the axes of the body; in motion as at rest.

use super::statics::solved_at;
use crate::reference::documents::{problem as parsed, run};
use serde_json::Value;

const E: f64 = 7e10;

fn plate() -> Value {
    json!({"plate": {"length": 0.6, "width": 0.3, "elements": [6, 4]}})
}

fn panel() -> Value {
    json!({"curved_panel": {"radius": 0.5, "length": 0.4, "angles": [0.2, 1.1], "elements": [5, 4]}})
}

fn sets() -> Value {
    json!({"p": {"node": {"at": [0, 0.5]}}, "q": {"node": {"at": [1, 0.5]}}, "m": {"node": {"at": [0.5, 0.25]}}})
}

/// A body whose edge x0 is held as `held` by a joint to ground, in these axes. Gives its tip along (1, 2, 3) and its
/// strain energy in equilibrium under a load along the edge x1.
fn held(mesh: &Value, frame: Value, held: Value, basis: Value, joint: Value) -> [f64; 2] {
    let points = json!({"root": held, "tip": {"node": "q"}});
    let motion = run(&elements(mesh, frame, points, basis, joint));
    [0, 1].map(|k| motion.at.function(k).value)
}

fn elements(mesh: &Value, frame: Value, points: Value, basis: Value, joint: Value) -> Value {
    json!({
        "version": 1, "name": "edge", "gravity": [0, 0, 0], "start": "equilibrium",
        "materials": {"al": {"young": E, "poisson": 0.3, "density": 2700}},
        "bodies": {"s": {
            "elements": {
                "structure": {"mesh": mesh, "material": "al", "thickness": 0.008, "sets": sets()},
                "frame": frame, "basis": basis, "points": points
            },
            "place": {"put": [0, 0, 0], "at": [0, 0, 0]}
        }},
        "joints": {"w": joint},
        "loads": {"a": {"edge": {"body": "s", "edges": "x1", "direction": [0.3, 0.2, 1], "magnitude": 10}}},
        "simulation": {"duration": 1e-4, "steps": 1, "method": {"bdf": {"order": 2}}},
        "functions": {
            "z": {"final": {"position": {"body": "s", "point": "tip", "direction": [1, 2, 3]}}},
            "U": {"final": {"strain_energy": {"body": "s"}}}
        }
    })
}

fn weld() -> Value {
    json!({"weld": {"between": ["s", "ground"], "at": "s.root"}})
}

fn frames() -> [Value; 4] {
    [
        json!({"clamped": "x0"}),
        json!({"chord": ["p", "q", "x0y0"]}),
        json!({"chord": ["x0y0", "x0y1", "q"]}),
        json!({"chord": ["m", "x1y1", "x0y1"]}),
    ]
}

/// How far apart results are, relative to the first, without the place of the undeformed tip.
fn apart(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[1] / b[1] - 1.0).abs()
}

/// A welded edge is the same in all axes, as its key says: of plates and curved panels, within 1e-4 of the strain
/// energy if it is rigid. The mean rotation is linear in those of nodes, so the average is the same to the rotations
/// of 5e-4 rad. The meanings differ by more than 1 %.
#[test]
fn a_welded_edge_is_the_same_in_all_axes() {
    for mesh in [plate(), panel()] {
        let of = |key: &str, frame: &Value| {
            held(
                &mesh,
                frame.clone(),
                json!({key: "x0"}),
                json!("full"),
                weld(),
            )
        };
        let [rigid, mean] = ["rigid", "mean"].map(|key| {
            let all = frames().map(|frame| of(key, &frame));
            for other in &all[1..] {
                let tolerance = if key == "rigid" { 1e-4 } else { 5e-4 };
                assert!(apart(*other, all[0]) < tolerance, "{key} {all:?}");
                assert!((other[0] - all[0][0]).abs() < 1e-6, "{key} {all:?}");
            }
            all[0]
        });
        assert!(mean[1] > 1.01 * rigid[1], "{rigid:?} {mean:?}");
        // By default a weld holds all nodes.
        for frame in frames() {
            assert!(apart(of("edge", &frame), rigid) < 1e-4);
        }
    }
}

/// A hinge along an edge holds the average by default, and all nodes where the edge is rigid; a spring of torsion
/// carries the load.
#[test]
fn a_hinged_edge_is_the_same_in_all_axes() {
    let joint =
        json!({"revolute": {"between": ["s", "ground"], "at": "s.root", "axis": [0, 1, 0]}});
    let of = |key: &str, frame: &Value| {
        let mesh = plate();
        let mut document = json!({
            "version": 1, "name": "hinge", "gravity": [0, 0, 0],
            "materials": {"al": {"young": E, "poisson": 0.3, "density": 2700}},
            "bodies": {"s": {
                "elements": {
                    "structure": {"mesh": mesh, "material": "al", "thickness": 0.008, "sets": sets()},
                    "frame": frame, "points": {"tip": {"node": "q"}}
                },
                "place": {"put": [0, 0, 0], "at": [0, 0, 0]}
            }},
            "joints": {"w": joint},
            "loads": {"a": {"edge": {"body": "s", "edges": "x1", "direction": [0, 0, 1], "magnitude": 20}}},
            "simulation": {"duration": 0.02, "steps": 20, "method": {"bdf": {"order": 2}}},
            "functions": {"z": {"final": {"position": {"body": "s", "point": "tip", "direction": [0, 0, 1]}}},
                          "U": {"integral": {"strain_energy": {"body": "s"}}}}
        });
        document["bodies"]["s"]["elements"]["points"]["root"] = json!({key: "x0"});
        let motion = run(&document);
        [0, 1].map(|k| motion.at.function(k).value)
    };
    let [mean, edge, rigid] = ["mean", "edge", "rigid"].map(|key| {
        let all = [frames()[0].clone(), frames()[1].clone()].map(|frame| of(key, &frame));
        assert!((all[0][0] / all[1][0] - 1.0).abs() < 1e-4, "{key} {all:?}");
        assert!((all[0][1] / all[1][1] - 1.0).abs() < 2e-3, "{key} {all:?}");
        all[1]
    });
    assert_eq!(mean, edge);
    assert!(
        rigid[1] < mean[1] && rigid[1] > 0.5 * mean[1],
        "{rigid:?} {mean:?}"
    );
}

/// A reduced basis holds the edge as all nodes do.
#[test]
fn a_reduced_body_holds_an_edge_as_all_nodes_do() {
    let basis = || json!({"reduced": {"modes": 12}});
    for key in ["rigid", "mean"] {
        let full = held(
            &plate(),
            frames()[0].clone(),
            json!({key: "x0"}),
            json!("full"),
            weld(),
        );
        let [a, b] = [0, 1].map(|k| {
            held(
                &plate(),
                frames()[k].clone(),
                json!({key: "x0"}),
                basis(),
                weld(),
            )
        });
        assert!(apart(a, b) < 1e-4, "{key} {a:?} {b:?}");
        assert!(apart(a, full) < 2e-3, "{key} {a:?} {full:?}");
    }
}

/// A plate welded at both ends, to ground and to a body with a force beside its middle: all axes and a reduced basis
/// agree. With averages the energy is 10 % larger.
#[test]
fn a_flexure_between_two_welds_is_the_same_in_all_axes() {
    let of = |key: &str, frame: Value, basis: Value| {
        let document = json!({
            "version": 1, "name": "flexure", "gravity": [0, 0, 0], "start": "equilibrium",
            "materials": {"al": {"young": E, "poisson": 0.3, "density": 2700}},
            "bodies": {
                "s": {
                    "elements": {
                        "structure": {"mesh": plate(), "material": "al", "thickness": 0.008, "sets": sets()},
                        "frame": frame, "basis": basis,
                        "points": {"root": {key: "x0"}, "end": {key: "x1"}}
                    },
                    "place": {"put": [0, 0, 0], "at": [0, 0, 0]}
                },
                "b": {"shape": {"box": {"size": [0.1, 0.3, 0.1]}}, "mass": 1, "place": {"at": [0.65, 0.15, 0]}}
            },
            "joints": {
                "w": weld(),
                "v": {"weld": {"between": ["b", "s"], "at": "s.end"}}
            },
            "loads": {"a": {"force": {"body": "b", "point": [0, 0.3, 0], "direction": [0.1, 0.1, 1], "magnitude": 10}}},
            "simulation": {"duration": 1e-4, "steps": 1, "method": {"bdf": {"order": 2}}},
            "functions": {"U": {"final": {"strain_energy": {"body": "s"}}}}
        });
        run(&document).at.function(0).value
    };
    let frames = [
        json!({"clamped": "x0"}),
        json!({"clamped": "x1"}),
        json!({"chord": ["p", "q", "x0y0"]}),
    ];
    let full = frames.clone().map(|frame| of("edge", frame, json!("full")));
    let reduced = frames.map(|frame| of("edge", frame, json!({"reduced": {"modes": 12}})));
    for other in &full[1..] {
        assert!((other / full[0] - 1.0).abs() < 1e-4, "{full:?}");
    }
    for other in reduced {
        assert!((other / full[0] - 1.0).abs() < 3e-3, "{full:?} {reduced:?}");
    }
    let mean = of("mean", json!({"clamped": "x0"}), json!("full"));
    assert!(mean > 1.05 * full[0], "{mean} {full:?}");
}

/// At rest a support holds all nodes of its set: a rigid edge in motion is the same, in linear strains of small loads.
#[test]
fn a_rigid_edge_is_a_support() {
    for mesh in [plate(), panel()] {
        let still = json!({
            "version": 1, "name": "rest",
            "materials": {"al": {"young": E, "poisson": 0.3, "density": 2700}},
            "structures": {"s": {"mesh": mesh, "material": "al", "thickness": 0.008, "sets": sets(),
                                 "supports": {"root": {"nodes": ["x0"]}}}},
            "load_cases": {"c": {"a": {"edge": {"edges": "x1", "force": [6, 4, 20]}}}},
            "functions": {"U": {"strain_energy": {"case": "c"}}}
        });
        let problem = parsed(&still);
        let rest = solved_at(&problem, &problem.start()).function(0).value;
        // The load of 10 N/m along (0.3, 0.2, 1).
        let factor = 0.5 / 1.13_f64.sqrt();
        let frame = json!({"chord": ["p", "q", "x0y0"]});
        let moving = held(&mesh, frame, json!({"rigid": "x0"}), json!("full"), weld());
        let rest = rest * factor * factor;
        assert!((moving[1] / rest - 1.0).abs() < 1e-3, "{moving:?} {rest}");
    }
}

/// Axes that are clamped at an edge which no point holds make it rigid, and a note says so: of an edge that is free, or
/// held by single nodes. No note where a point holds the edge, where one node is clamped, in chord axes, nor where a
/// reduced basis is clamped at a rigid edge.
#[test]
fn an_edge_that_axes_alone_make_rigid_is_told() {
    let told = |frame: &Value, points: Value, basis: Value, joint: Value| {
        let mut document = elements(&plate(), frame.clone(), points, basis, joint);
        document["loads"] = json!({});
        document["functions"] = json!({"U": {"final": {"strain_energy": {"body": "s"}}}});
        parsed(&document).notes_of_input().join("\n")
    };
    let x0 = json!({"clamped": "x0"});
    let full = json!("full");
    let ball = json!({"spherical": {"between": ["s", "ground"], "at": "s.root"}});
    let at = |held: Value| json!({"root": held, "tip": {"node": "m"}});
    for (frame, held, joint) in [
        (&x0, json!({"rigid": "x1"}), weld()),
        (&x0, json!({"mean": "y0"}), weld()),
        (&x0, json!({"edge": "y1"}), ball.clone()),
        (&x0, json!({"node": "x0y0"}), ball.clone()),
        (&json!({"clamped": "y1"}), json!({"rigid": "x0"}), weld()),
        (
            &json!({"clamped": "x1"}),
            json!({"mean": "x0"}),
            ball.clone(),
        ),
    ] {
        let notes = told(frame, at(held), full.clone(), joint);
        let set = frame["clamped"].as_str().unwrap_or_default();
        assert!(
            notes.contains(&format!("clamped at \"{set}\"")),
            "{frame}: {notes}"
        );
    }
    let reduced = json!({"reduced": {"modes": 2}});
    for (frame, held, basis, joint) in [
        (&x0, json!({"rigid": "x0"}), &full, weld()),
        (&x0, json!({"mean": "x0"}), &full, weld()),
        (&x0, json!({"edge": "x0"}), &full, weld()),
        (&x0, json!({"edge": "x0"}), &full, ball),
        (
            &json!({"chord": ["p", "q", "x0y0"]}),
            json!({"rigid": "x0"}),
            &full,
            weld(),
        ),
        (
            &json!({"clamped": "y0"}),
            json!({"rigid": "x0"}),
            &reduced,
            weld(),
        ),
    ] {
        let notes = told(frame, at(held), basis.clone(), joint);
        assert_eq!(notes, "", "{frame}");
    }
}
