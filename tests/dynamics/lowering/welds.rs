//! Bodies that are welded to ground, or to each other.

use super::*;
use flexbody_driver as driver;

/// A stand that is welded to ground, with a bracket welded to it, carries the trebuchet.
#[test]
fn what_is_welded_to_ground_has_no_unknowns() {
    for (file, joint, place) in [
        ("problems/trebuchet.json", "axle", [-4.0, 0.0, 0.0]),
        (
            "problems/triple_pendulum.json",
            "first hinge",
            [0.0, 0.0, 0.0],
        ),
    ] {
        let problem = changed(file, |document| {
            let bodies = &mut document["bodies"];
            let solid = json!({"box": {"size": [1, 2, 3]}});
            bodies["stand"] = json!({"shape": solid, "mass": 7, "place": {"at": [1, -5, 0]}});
            bodies["bracket"] = json!({"shape": solid, "mass": 3, "place": {"at": [2, -6, 0]}});
            let joints = &mut document["joints"];
            let kind = joints[joint].as_object_mut().expect("a joint");
            for (_, kind) in kind.iter_mut() {
                for end in kind["between"].as_array_mut().expect("two ends") {
                    if end == "ground" {
                        *end = json!("stand");
                    }
                }
                kind["at"] = json!(place);
            }
            joints["foot"] = json!({"weld": {"between": ["bracket", "ground"], "at": [2, -6, 0]}});
            joints["seam"] = json!({"weld": {"between": ["stand", "bracket"], "at": [2, -5, 0]}});
        });
        let bare = load(file, &[]);
        assert_eq!(size(&problem), size(&bare), "{file}");
        assert_eq!(is_planar(&problem), is_planar(&bare));
        // Newton's method leaves up to 1e-13 per implicit step.
        for (method, limit) in [(Method::Dop853, 1e-11), (RADAU, 3e-11), (BDF, 3e-11)] {
            let found = differences(&problem, &settings(method, Spacing::Steps(300)));
            for x in found {
                assert!(x <= limit, "{file} by {}: {x:e}", method.name());
            }
        }
    }
}

/// A spatial double pendulum. The second link carries a bracket, and this a hammer, rotated and off
/// its centre, with a ball on it. A spring acts on the hammer, a torque on the bracket.
pub fn carried(change: impl FnOnce(&mut Value)) -> Problem {
    let mut document = json!({
        "version": 1, "name": "carried",
        "bodies": {
            "first": {"shape": {"box": {"size": [1, 0.1, 0.2]}}, "mass": 1,
                "points": {"pin": [-0.5, 0, 0], "end": [0.5, 0, 0]},
                "place": {"put": "pin", "at": [0, 0, 0]}},
            "second": {"shape": {"box": {"size": [0.8, 0.1, 0.2]}}, "mass": 2,
                "points": {"pin": [-0.4, 0, 0], "end": [0.4, 0, 0]},
                "place": {"put": "pin", "at": "first.end"}},
            "bracket": {"shape": {"box": {"size": [0.2, 0.3, 0.1]}}, "mass": 0.7,
                "points": {"seat": [0, 0.1, 0.02], "tip": [0.1, -0.1, 0]},
                "place": {"put": "seat", "at": "second.end", "turn": {"axis": [1, 2, 3], "angle": 0.6}}},
            "hammer": {"shape": {"box": {"size": [0.3, 0.2, 0.4]}}, "mass": 1.5,
                "points": {"handle": [0.1, 0, -0.1], "eye": [0, 0.2, 0.1]},
                "place": {"put": "handle", "at": "bracket.tip", "turn": {"axis": [0, 1, -1], "angle": -0.4}}},
            "ball": {"shape": {"box": {"size": [0.1, 0.2, 0.3]}}, "mass": 0.5,
                "points": {"held": [0, 0.2, 0]},
                "place": {"put": "held", "at": "hammer.eye"}}
        },
        "joints": {
            "pin": {"revolute": {"between": ["first", "ground"], "at": "first.pin", "axis": [0, 0, 1]}},
            "hinge": {"revolute": {"between": ["second", "first"], "at": "first.end", "axis": [0, 1, 1]}},
            "seam": {"weld": {"between": ["bracket", "second"], "at": "second.end"}},
            "clamp": {"weld": {"between": ["bracket", "hammer"], "at": "bracket.tip"}},
            "holder": {"universal": {"between": ["ball", "hammer"], "at": "hammer.eye",
                "axis": [1, 0, 0], "cross": [0, 1, 0]}}
        },
        "loads": {
            "spring": {"spring": {"between": ["hammer", "ground"], "at": {"a": "eye", "b": [0, 2, 0]},
                "stiffness": 20, "damping": 0.3, "rest_length": 1}},
            "push": {"force": {"body": "hammer", "point": "handle", "direction": [1, 1, 0],
                "axes": "body", "magnitude": 3}},
            "turn": {"torque": {"body": "bracket", "direction": [1, 0, 0], "axes": "body", "magnitude": 0.2}}
        },
        "simulation": {"duration": 1},
        "functions": {
            "height": {"ks": {"rho": 5, "of": {"position": {"body": "bracket", "point": "tip",
                "direction": [0, 1, 0]}}}},
            "pull": {"ks": {"rho": 0.1, "of": {"acceleration": {"body": "hammer", "point": "eye",
                "direction": [0, 1, 0]}}}},
            "energy": {"final": {"energy": "total"}},
            "turned": {"final": {"rotation": {"body": "hammer", "axis": [0, 0, 1]}}},
            "speed": {"final": {"speed": {"body": "ball"}}}
        },
        "variables": {
            "mass": {"path": "/bodies/hammer/mass", "lower": 0.1, "upper": 3},
            "size": {"path": "/bodies/bracket/shape/box/size/0", "lower": 0.1, "upper": 1},
            "seat": {"path": "/bodies/bracket/points/seat/1", "lower": 0.05, "upper": 0.2},
            "handle": {"path": "/bodies/hammer/points/handle/2", "lower": -0.2, "upper": 0.1},
            "angle": {"path": "/bodies/hammer/place/turn/angle", "lower": -0.6, "upper": 0.6},
            "length": {"path": "/bodies/second/points/end/0", "lower": 0.3, "upper": 0.6}
        }
    });
    change(&mut document);
    parse(&document)
}

/// The motion is the same up to round-off if the steps' errors are below it. An implicit method has
/// another error for a merged body than for its parts, whose centres of mass it integrates. Both
/// converge to the same motion, with the order of the samples (three for Radau).
fn same_as_written(problem: &Problem, steps: usize) {
    let found = differences(problem, &settings(Method::Dop853, Spacing::Steps(steps)));
    assert!(found.iter().all(|&x| x <= 1e-11), "{found:?}");
    for (method, gain) in [(RADAU, 6.0), (BDF, 3.0)] {
        let at = |steps: usize| differences(problem, &settings(method, Spacing::Steps(steps)));
        let (coarse, fine) = (at(steps), at(2 * steps));
        for (coarse, fine) in coarse.iter().zip(&fine) {
            let name = method.name();
            assert!(
                *fine <= f64::max(coarse / gain, 1e-10),
                "{name}: {coarse:e} {fine:e}"
            );
        }
    }
}

fn kept(problem: &Problem) -> Vec<String> {
    let lowering = problem.lowering.as_ref().expect("a lowered problem");
    lowering.kept().iter().map(|own| own.to_string()).collect()
}

/// Three welded bodies have six unknowns and no rows between them. Motion, functions, reactions,
/// and gradients in variables of the welds and of the merged bodies are the same.
#[test]
fn bodies_that_are_welded_to_each_other_are_one() {
    let problem = carried(|_| {});
    assert_eq!(size(&unlowered(&problem)), (30, 26));
    assert_eq!(size(&problem), (18, 14), "{:?}", kept(&problem));
    same_as_written(&problem, 200);
    let derivatives = driver::check(&problem, &problem.start()).expect("a run");
    for derivative in derivatives {
        assert!(derivative.relative_difference() <= 1e-10, "{derivative:?}");
    }
}

/// The rate of such a drive is zero at the start up to the round-off of its sine. If it starts with
/// an error of 1e-9, it opens its joint.
#[test]
fn a_harmonic_drive_may_start_from_rest() {
    let driven = |phase: f64| {
        carried(|document| {
            document["drives"]["motor"] = json!({"joint": "hinge", "turn": {"harmonic":
                {"amplitude": 0.2, "frequency": 1, "phase": phase, "mean": 0.2}}});
        })
    };
    let problem = driven(-std::f64::consts::FRAC_PI_2);
    assert_eq!(size(&problem), (18, 15), "{:?}", kept(&problem));
    let found = differences(&problem, &settings(Method::Dop853, Spacing::Steps(200)));
    assert!(found.iter().all(|&x| x <= 1e-11), "{found:?}");
    let told = kept(&driven(-std::f64::consts::FRAC_PI_2 + 1e-9)).join("\n");
    assert!(told.contains("opens by the velocities"), "{told}");
}

#[test]
fn reactions_of_what_was_merged_are_recovered() {
    let problem = changed_steps(carried(|_| {}));
    let lowered = driver::simulate(&problem, &problem.start()).expect("a run");
    let written = driver::simulate(&unlowered(&problem), &problem.start()).expect("a run");
    for k in [0, 70, 200] {
        let (a, b) = (lowered.reactions(k), written.reactions(k));
        for (a, b) in a.iter().zip(&b) {
            let size = b.force_ground.norm() + b.torque_ground.norm();
            assert!(size > 1e-3);
            let off = (a.force_ground - b.force_ground).norm()
                + (a.torque_ground - b.torque_ground).norm();
            assert!(off <= 1e-9 * size, "{off:e} of {size}");
        }
        let (a, b) = (&lowered.observations[k], &written.observations[k]);
        assert!((a.kinetic + a.potential - b.kinetic - b.potential).abs() <= 1e-10);
        assert!((a.angular_momentum - b.angular_momentum).norm() <= 1e-10);
        assert!(
            a.position_drift <= 1e-12 && a.velocity_drift <= 1e-11,
            "{a:?}"
        );
    }
}

fn changed_steps(mut problem: Problem) -> Problem {
    problem.simulation.spacing = Spacing::Steps(200);
    problem
}

/// A weld is kept if its neighbours open at the start, if loads act through it, or if its bodies
/// differ.
#[test]
fn a_weld_that_cannot_be_merged_stays_with_the_reason() {
    let told = |problem: &Problem, what: &str| {
        let kept = kept(problem);
        assert!(
            kept.iter().any(|own| own.contains(what)),
            "{what}: {kept:?}"
        );
    };
    // Another joint between the same bodies.
    let problem = carried(|document| {
        document["joints"]["bolt"] = json!({"spherical": {"between": ["bracket", "hammer"],
            "at": "bracket.tip"}});
    });
    assert_eq!(size(&problem).0, 24);
    told(
        &problem,
        "weld \"clamp\" between bodies that move: joint \"bolt\" joins them too",
    );
    // The rotations of two bodies with different orientations are observed.
    let problem = carried(|document| {
        document["functions"]["other"] =
            json!({"final": {"rotation": {"body": "bracket", "axis": [0, 0, 1]}}});
    });
    assert_eq!(size(&problem).0, 24);
    told(&problem, "the rotations of bodies");
    // Velocities that the hinge does not allow.
    let problem = carried(|document| {
        document["bodies"]["first"]["velocity"] = json!({"linear": [0, 1, 0]});
    });
    assert_eq!(size(&problem).0, 30);
    told(
        &problem,
        "joint \"pin\" opens by the velocities that the bodies are placed with",
    );
    // A design that opens a loop in its placement.
    let problem = carried(|document| {
        document["joints"]["stay"] = json!({"rod": {"between": ["second", "ground"],
            "at": {"a": "end", "b": [1.5, 1, 0.5]}, "length": 1.3}});
    });
    assert_eq!(size(&problem).0, 30);
    told(
        &problem,
        "joint \"stay\" is open where the bodies are placed",
    );
}

/// Welds that close a loop of welded bodies vanish, too.
#[test]
fn a_loop_of_welds_is_one_body() {
    let problem = carried(|document| {
        document["joints"]["brace"] = json!({"weld": {"between": ["hammer", "second"],
            "at": [1.5, 0, 0]}});
    });
    assert_eq!(size(&problem), (18, 14), "{:?}", kept(&problem));
    let found = differences(&problem, &settings(Method::Dop853, Spacing::Steps(200)));
    assert!(found.iter().all(|&x| x <= 1e-11), "{found:?}");
}

/// The trebuchet with its arm and its counterweight in two parts each.
#[test]
fn welded_bodies_in_the_plane_are_one() {
    let problem = changed("problems/trebuchet.json", |document| {
        document["bodies"]["plate"] = json!({"shape": {"box": {"size": [0.5, 0.7, 0.2]}}, "mass": 90,
            "place": {"at": "arm.axle", "relative_to": "arm"}});
        document["joints"]["rivet"] =
            json!({"weld": {"between": ["plate", "arm"], "at": "arm.axle"}});
        document["variables"]["plate"] =
            json!({"path": "/bodies/plate/mass", "lower": 50, "upper": 200});
    });
    let bare = load("problems/trebuchet.json", &[]);
    assert!(is_planar(&problem));
    assert_eq!(size(&problem), size(&bare), "{:?}", kept(&problem));
    same_as_written(&problem, 400);
}

/// A variable that changes the placement of a stand and of what it carries does not let it move.
#[test]
fn a_variable_may_move_what_is_welded_to_ground() {
    for planar in [true, false] {
        let axis = if planar {
            json!([0, 0, 1])
        } else {
            json!([0, 1, 1])
        };
        let problem = parse(&json!({
            "version": 1, "name": "stand",
            "bodies": {
                "stand": {"shape": {"box": {"size": [1, 2, 3]}}, "mass": 7,
                    "points": {"top": [0.2, 1, 0]},
                    "place": {"at": [1, -2, 0], "turn": {"axis": [0, 0, 1], "angle": 0.1}}},
                "first": {"shape": {"box": {"size": [1, 0.1, 0.2]}}, "mass": 1,
                    "points": {"pin": [-0.5, 0, 0], "end": [0.5, 0, 0]},
                    "place": {"put": "pin", "at": "stand.top"}},
                "second": {"shape": {"box": {"size": [0.8, 0.1, 0.2]}}, "mass": 2,
                    "points": {"pin": [-0.4, 0, 0], "end": [0.4, 0, 0]},
                    "place": {"put": "pin", "at": "first.end"}}
            },
            "joints": {
                "foot": {"weld": {"between": ["stand", "ground"], "at": [1, -3, 0]}},
                "pin": {"revolute": {"between": ["first", "stand"], "at": "stand.top",
                    "axis": {"body": "stand", "axis": [0, 0, 1]}}},
                "hinge": {"revolute": {"between": ["second", "first"], "at": "first.end", "axis": axis}}
            },
            "loads": {"spring": {"spring": {"between": ["second", "stand"],
                "at": {"a": "end", "b": [0.5, 0, 0]}, "stiffness": 3, "rest_length": 1}}},
            "simulation": {"duration": 1},
            "functions": {
                "x": {"final": {"position": {"body": "second", "direction": [1, 0.3, 0]}}},
                "stand": {"final": {"position": {"body": "stand", "point": "top", "direction": [1, 2, 0]}}},
                "speed": {"ks": {"rho": 1, "of": {"speed": {"body": "second", "point": "end"}}}},
                "energy": {"final": {"energy": "total"}}
            },
            "variables": {
                "place": {"path": "/bodies/stand/place/at/0", "lower": 0, "upper": 2},
                "turn": {"path": "/bodies/stand/place/turn/angle", "lower": -1, "upper": 1},
                "height": {"path": "/bodies/stand/points/top/1", "lower": 0.5, "upper": 1.5}
            }
        }));
        assert_eq!(is_planar(&problem), planar);
        assert_eq!(
            size(&problem).0,
            if planar { 6 } else { 12 },
            "{:?}",
            kept(&problem)
        );
        for method in [Method::Dop853, RADAU, BDF] {
            let found = differences(&problem, &settings(method, Spacing::Steps(200)));
            assert!(
                found.iter().all(|&x| x <= 1e-11),
                "{planar} {}: {found:?}",
                method.name()
            );
        }
        let derivatives = driver::check(&problem, &problem.start()).expect("a run");
        for derivative in derivatives {
            assert!(derivative.relative_difference() <= 1e-10, "{derivative:?}");
        }
    }
}
