//! Functions that observe joints: reductions that would lose a reaction are not made, and those that are
//! made give the same values and gradients as the scene as written.

use super::{differences, is_planar, obstacle, parse, run, settings, unlowered};
use crate::reference::documents::{problem as parsed, unlowered_values, value, values};
use crate::reference::gradients::gradients_are_exact;
use crate::reference::models::Numbers;

use flexbody_mathematics::math::Vec3;
use flexbody_mechanics::integrate::{Method, Spacing};
use flexbody_problem::Problem;
use serde_json::Value;

/// A chain of bars in the plane across z that hangs from a block on ground. `welded` bars are one with the
/// one before; the block is welded to ground; a slide runs on the last bar.
fn chain(numbers: &mut Numbers, welded: &[bool], functions: Value) -> Problem {
    let mut bodies = json!({
        "block": {"shape": {"box": {"size": [0.4, 0.4, 0.4]}}, "mass": 3, "place": {"at": [0, 0, 0]}},
        "sleeve": {"shape": {"box": {"size": [0.2, 0.1, 0.1]}}, "mass": 0.5,
                   "place": {"put": [0, 0, 0], "at": "bar 0.end"}}
    });
    let mut joints = json!({
        "foot": {"weld": {"between": ["block", "ground"], "at": [0, 0, 0]}},
        "rail": {"prismatic": {"between": ["sleeve", "bar 0"], "at": "bar 0.end", "axis": [1, 0, 0]}}
    });
    let mut before = "block".to_owned();
    for (i, weld) in welded.iter().enumerate() {
        let name = format!("bar {i}");
        let angle = match i {
            0 => 0.0,
            _ => numbers.next(),
        };
        let at = match i {
            0 => json!([0.2, 0, 0]),
            _ => json!(format!("{before}.end")),
        };
        bodies[&name] = json!({
            "shape": {"box": {"size": [1, 0.1, 0.1]}}, "mass": 1.5 + numbers.next(),
            "points": {"root": [-0.5, 0, 0], "end": [0.5, 0, 0]},
            "place": {"put": "root", "at": at, "turn": {"axis": [0, 0, 1], "angle": angle}}
        });
        let place = json!({"between": [name, before], "at": format!("{name}.root")});
        let joint = match weld {
            true => json!({"weld": place}),
            false => {
                let mut place = place;
                place["axis"] = json!([0, 0, 1]);
                json!({"revolute": place})
            }
        };
        joints[format!("joint {i}")] = joint;
        before = name;
    }
    parse(&json!({
        "version": 1, "name": "chain", "bodies": bodies, "joints": joints,
        "loads": {"spring": {"spring": {"between": ["sleeve", "bar 0"], "at": {"a": [0, 0, 0], "b": "root"},
                                        "rest_length": 0.9, "stiffness": 200, "damping": 1}}},
        "simulation": {"duration": 0.6, "steps": 60, "samples": 60},
        "functions": functions,
        "variables": {
            "mass": {"path": "/bodies/bar 0/mass", "lower": 0.2},
            "angle": {"path": "/bodies/bar 1/place/turn/angle"},
            "duration": {"path": "/simulation/duration", "lower": 0.1},
            "stiffness": {"path": "/loads/spring/spring/stiffness", "lower": 1}
        }
    }))
}

/// Forces along x and y and the moment about z, on either body and in either axes, in several reductions.
fn of_joint(joint: &str, other: &str, held: bool) -> Value {
    let force = |direction: [f64; 3], on: &str, axes: &str| json!({"joint_force": {"joint": joint, "direction": direction, "on": on, "axes": axes}});
    // A hinge bears no moment.
    let moment = |on: &str| match held {
        true => json!({"joint_moment": {"joint": joint, "direction": [0, 0, 1], "on": on}}),
        false => force([0.6, 0.8, 0.0], on, "ground"),
    };
    let own = match joint {
        "foot" => "block".to_owned(),
        "rail" => "sleeve".to_owned(),
        joint => format!("bar {}", &joint[6..]),
    };
    json!({
        (format!("{joint} x")): {"final": force([1.0, 0.0, 0.0], &own, "ground")},
        (format!("{joint} y")): {"ks": {"rho": 0.5, "of": force([0.0, 1.0, 0.0], other, "joint")}},
        (format!("{joint} z")): {"integral": moment(&own)},
        (format!("{joint} other")): {"induced_exponential": {"rho": 0.5, "of": moment(other)}}
    })
}

fn merged(all: &[Value]) -> Value {
    let mut out = json!({});
    for part in all {
        for (name, value) in part.as_object().expect("functions") {
            out[name] = value.clone();
        }
    }
    out
}

const METHODS: [Method; 2] = [Method::Dop853, Method::Radau { stages: 3 }];

/// Planes, welds, bodies that cannot move and those that cannot turn, with functions of every joint or of
/// one: the same values and gradients.
#[test]
fn reactions_are_the_same_lowered() {
    let mut numbers = Numbers(8);
    let angles = json!({
        "slide": {"final": {"slide": {"joint": "rail"}}},
        "length": {"integral": {"spring_length": {"load": "spring"}}},
        "force": {"ks": {"rho": 0.3, "bound": "above", "of": {"spring_force": {"load": "spring"}}}},
        "spin": {"final": {"angular_momentum": {"direction": [0.2, 0.1, 1], "about": [1, 2, 3]}}}
    });
    let joints = [
        ("foot", "ground"),
        ("rail", "bar 0"),
        ("joint 0", "block"),
        ("joint 1", "bar 0"),
        ("joint 2", "bar 1"),
    ];
    for i in 0..joints.len() + 2 {
        // An implicit method errs otherwise for merged bodies than for their parts.
        let explicit = i % 2 == 0;
        let welded = [false, explicit, explicit && i % 3 != 0];
        let own = |(joint, other): (&str, &str)| {
            let held = match joint {
                "foot" | "rail" => true,
                "joint 0" => welded[0],
                "joint 1" => welded[1],
                _ => welded[2],
            };
            of_joint(joint, other, held)
        };
        let functions = match i.checked_sub(joints.len()) {
            None => own(joints[i]),
            Some(0) => {
                let all: Vec<Value> = joints.into_iter().map(own).collect();
                merged(&all)
            }
            Some(_) => angles.clone(),
        };
        let problem = chain(&mut numbers, &welded, functions);
        assert!(is_planar(&problem), "case {i}");
        let settings = settings(METHODS[i % 2], Spacing::Steps(60));
        let [_, values, gradients] = differences(&problem, &settings);
        assert!(
            values < 1e-9 && gradients < 1e-9,
            "case {i}: {values:e} {gradients:e}"
        );
    }
}

/// A weld whose reaction is observed stays, others vanish; so do bodies that cannot move.
#[test]
fn only_what_is_observed_is_kept() {
    let mut numbers = Numbers(8);
    let welded = [false, true, true];
    let lowering = |problem: &Problem| problem.lowering.clone().expect("is lowered");
    let one = chain(&mut numbers, &welded, of_joint("joint 1", "bar 0", true));
    assert_eq!(lowering(&one).welded.welds.len(), 1);
    assert!(!lowering(&one).fixed.is_empty());
    let none = chain(&mut numbers, &welded, json!({"duration": "duration"}));
    assert_eq!(lowering(&none).welded.welds.len(), 2);
    let foot = chain(&mut numbers, &welded, of_joint("foot", "ground", true));
    assert_eq!(lowering(&foot).welded.welds.len(), 2);
    assert!(lowering(&foot).fixed.is_empty());
    let told: Vec<String> = lowering(&foot)
        .kept()
        .iter()
        .map(|own| own.to_string())
        .collect();
    let told = told.join("\n");
    assert!(
        told.contains("a function observes the reaction of joint \"foot\""),
        "{told}"
    );
}

/// A moment across the plane needs the scene in space.
#[test]
fn a_moment_across_the_plane_keeps_space() {
    let mut numbers = Numbers(8);
    let across = json!({"bend": {"final": {"joint_moment": {"joint": "joint 1",
        "direction": [1, 0, 0.5]}}}});
    let problem = chain(&mut numbers, &[false, false, false], across);
    assert!(!is_planar(&problem));
    let what = obstacle(&problem).what;
    assert_eq!(
        what,
        "a function observes a moment across the plane of joint \"joint 1\""
    );
    let settings = settings(Method::Dop853, Spacing::Steps(60));
    let [states, ..] = differences(&problem, &settings);
    assert!(states < 1e-9);
    assert!(unlowered(&problem).lowering.is_none());
}

/// Four bars on hinges, of which three hinges hold what one could: in space the motion determines forces in the
/// plane, and no moments across it.
#[test]
fn what_hinges_share_is_refused_and_the_rest_is_right() {
    let bar = |length: f64| {
        json!({"shape": {"box": {"size": [length, 0.1, 0.1]}}, "mass": length,
            "points": {"a": [-0.5 * length, 0, 0], "b": [0.5 * length, 0, 0]}})
    };
    let mut bodies = json!({"crank": bar(1.0), "rod": bar(2.0), "rocker": bar(1.5)});
    bodies["crank"]["place"] =
        json!({"put": "a", "at": [0, 0, 0], "turn": {"axis": [0, 0, 1], "angle": 1.1}});
    bodies["rod"]["place"] =
        json!({"put": "a", "at": "crank.b", "turn": {"axis": [0, 0, 1], "angle": 0.2}});
    bodies["rocker"]["place"] =
        json!({"put": "a", "at": "rod.b", "turn": {"axis": [0, 0, 1], "angle": -1.3}});
    let hinge = |a: &str, b: &str, at: &str| json!({"revolute": {"between": [a, b], "at": at, "axis": [0, 0, 1]}});
    let problem = parse(&json!({
        "version": 1, "name": "ring", "bodies": bodies,
        "joints": {
            "first": hinge("crank", "ground", "crank.a"), "second": hinge("rod", "crank", "rod.a"),
            "third": hinge("rocker", "rod", "rod.b"), "fourth": hinge("rocker", "ground", "rocker.b")
        },
        "simulation": {"duration": 0.4, "steps": 80},
        "functions": {
            "x": {"final": {"joint_force": {"joint": "second", "direction": [1, 0, 0]}}},
            "y": {"ks": {"rho": 0.5, "of": {"joint_force": {"joint": "third", "direction": [0, 1, 0], "axes": "joint"}}}}
        },
        "variables": {"mass": {"path": "/bodies/rod/mass", "lower": 0.1},
                      "angle": {"path": "/bodies/crank/place/turn/angle"}}
    }));
    let settings = settings(Method::Dop853, Spacing::Steps(80));
    let [_, values, gradients] = differences(&problem, &settings);
    assert!(
        values < 1e-9 && gradients < 1e-8,
        "{values:e} {gradients:e}"
    );
    let mut shared = problem;
    let mut document = shared.document.clone();
    document["functions"] =
        json!({"bend": {"final": {"joint_moment": {"joint": "second", "direction": [1, 0, 0]}}}});
    shared = parse(&document);
    let at = run(&shared, &settings);
    assert!(at.function(0).value.is_nan());
    let told = flexbody_driver::not_finite::value(&shared, &at, 0, f64::NAN);
    assert!(told.contains("shares it with others"), "{told}");
}

/// The moment on a body is about the joint's point on it, where a slide has moved the points apart and whichever body is the first,
/// also where a drive moves them.
#[test]
fn moments_are_about_the_point_of_their_body() {
    let function = |part: &str, on: &str, direction: [f64; 3]| json!({"final": {part: {"joint": "slide", "direction": direction, "on": on}}});
    for driven in [true, false] {
        let of = |between: [&str; 2], sign: f64| {
            let mut file = json!({
                "version": 1, "name": "slide", "gravity": [0.3, -9.81, 1.1],
                "bodies": {
                    "frame": {"mass": 3, "inertia": {"xx": 1, "yy": 1, "zz": 1}},
                    "carriage": {"mass": 2, "inertia": {"xx": 0.3, "yy": 0.4, "zz": 0.5}, "centre_of_mass": [0.1, 0.2, -0.1]}
                },
                "joints": {
                    "hinge": {"revolute": {"between": ["frame", "ground"], "at": [0, 0, 0], "axis": [0, 0, 1]}},
                    "slide": {"prismatic": {"between": between, "at": [0.2, 0.1, 0], "axis": [1, 0.2, 0.1]}}
                },
                "simulation": {"duration": 0.4, "tolerance": 1e-10}, "functions": {},
                "variables": {
                    "mass": {"path": "/bodies/carriage/mass", "lower": 1, "upper": 3},
                    "at": {"path": "/joints/slide/prismatic/at/1", "lower": 0, "upper": 1}
                }
            });
            match driven {
                true => {
                    file["drives"] = json!({"push": {"joint": "slide", "slide": {"polynomial": [0.0, sign, sign]}}});
                }
                false => {
                    file["joints"]["slide"]["prismatic"]["start"] =
                        json!({"slide": {"displacement": 0, "rate": sign}});
                }
            }
            for on in ["frame", "carriage"] {
                for (axis, k) in ["x", "y", "z"].into_iter().zip(0..) {
                    let mut direction = [0.0; 3];
                    direction[k] = 1.0;
                    file["functions"][format!("{on} moment {axis}")] =
                        function("joint_moment", on, direction);
                    file["functions"][format!("{on} force {axis}")] =
                        function("joint_force", on, direction);
                }
            }
            file
        };
        let (one, other) = (
            of(["carriage", "frame"], 1.0),
            of(["frame", "carriage"], -1.0),
        );
        let found = values(&one);
        for (a, b) in found.iter().zip(values(&other)) {
            assert!(
                (a - b).abs() < 1e-6 * a.abs().max(10.0),
                "{driven}: {a} {b}"
            );
        }
        for (a, b) in found.iter().zip(unlowered_values(&one)) {
            assert!(
                (a - b).abs() < 1e-6 * a.abs().max(10.0),
                "{driven}: {a} {b}"
            );
        }
        // The bodies act on each other with one wrench: moments about two points differ by F × the way between them.
        let vector =
            |of: &str| Vec3::from_fn(|k, _| value(&one, &format!("{of} {}", ["x", "y", "z"][k])));
        let [force, other_force] = ["carriage force", "frame force"].map(vector);
        let [moment, other_moment] = ["carriage moment", "frame moment"].map(vector);
        assert!((force + other_force).norm() < 1e-9 * force.norm());
        let along = moment + other_moment;
        assert!(along.norm() > 1.0, "{along}");
        assert!(along.dot(&force).abs() < 1e-6 * along.norm() * force.norm());
        let problem = parsed(&one);
        gradients_are_exact(&problem, &json!(driven));
    }
}
