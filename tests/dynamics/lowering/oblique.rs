//! Scenes in planes that are no coordinate planes: every function of the lowered scene is that of the scene as
//! written, and a plane that would lose one is not used.

use super::{differences, is_planar, obstacle, parse, run, settings};
use crate::reference::models::Numbers;

use flexbody_mathematics::math::{Mat3, Vec3, rotation};
use flexbody_mechanics::integrate::{Method, Spacing};
use flexbody_problem::Problem;
use serde_json::Value;

/// A rotation of space, by axis and angle.
struct Turn {
    axis: Vec3<f64>,
    angle: f64,
    matrix: Mat3<f64>,
}

impl Turn {
    fn any(numbers: &mut Numbers) -> Self {
        let (axis, angle) = (numbers.vector(), 3.0 * numbers.next());
        let matrix = rotation::matrix(&rotation::from_axis_angle(&axis, angle));
        Self {
            axis,
            angle,
            matrix,
        }
    }

    fn of(&self, x: [f64; 3]) -> Value {
        json!(<[f64; 3]>::from(self.matrix * Vec3::from(x)))
    }

    /// The turn of a body by an angle in the plane.
    fn after(&self, angle: f64) -> Value {
        json!([{"axis": [0, 0, 1], "angle": angle},
               {"axis": <[f64; 3]>::from(self.axis), "angle": self.angle}])
    }
}

/// Joints of a tree that keep it in its plane.
const KINDS: [&str; 6] = [
    "revolute",
    "spherical",
    "prismatic",
    "cylindrical",
    "weld",
    "universal",
];

/// A tree of four bars in a plane that is turned in space, with joints of any kind, and with functions of each
/// kind. Reactions are in random directions; moments are along the normal.
fn tree(numbers: &mut Numbers) -> Problem {
    let turn = Turn::any(numbers);
    let mut pick = |n: usize| ((numbers.next() + 1.0) * 0.5 * n as f64) as usize;
    let mut names: Vec<usize> = (0..4).collect();
    names.rotate_left(pick(4));
    let plan: Vec<(&str, usize, bool, usize)> = (0..4)
        .map(|i| {
            (
                KINDS[if i == 0 { 0 } else { pick(6) }],
                pick(i.max(1)),
                pick(2) == 0,
                pick(3),
            )
        })
        .collect();
    let normal = turn.of([0.0, 0.0, 1.0]);
    let (mut bodies, mut joints, mut functions) = (json!({}), json!({}), json!({}));
    for (i, &(kind, parent, swapped, axes)) in plan.iter().enumerate() {
        let name = format!("bar {}", names[i]);
        let parent = match i {
            0 => "ground".to_owned(),
            _ => format!("bar {}", names[parent]),
        };
        let angle = 2.0 * numbers.next();
        bodies[&name] = json!({
            "shape": {"box": {"size": [1, 0.1, 0.2]}}, "mass": 1.5 + numbers.next(),
            "points": {"root": [-0.5, 0, 0], "end": [0.5, 0, 0]},
            "place": {"put": "root", "turn": turn.after(angle),
                      "at": match i { 0 => turn.of([0.3, -0.2, 0.7]), _ => json!(format!("{parent}.end")) }}
        });
        let inside = turn.of([angle.cos(), angle.sin(), 0.0]);
        let mut place = json!({"at": format!("{name}.root"),
            "between": if swapped { [&parent, &name] } else { [&name, &parent] }});
        match kind {
            "revolute" | "cylindrical" => place["axis"] = normal.clone(),
            "prismatic" => place["axis"] = inside,
            "universal" => {
                place["axis"] = normal.clone();
                place["cross"] = inside;
            }
            _ => {}
        }
        let joint = format!("joint {i}");
        joints[&joint] = json!({kind: place});
        let direction: [f64; 3] = numbers.vector().into();
        let axes = ["ground", "joint", "ground"][axes];
        functions[format!("force {i}")] = json!({"final": {"joint_force": {
            "joint": joint, "direction": direction, "axes": axes, "on": if swapped { &parent } else { &name }}}});
        if kind == "prismatic" || kind == "weld" {
            functions[format!("moment {i}")] = json!({"integral": {"joint_moment": {
                "joint": joint, "direction": normal}}});
        }
        if kind == "prismatic" {
            functions[format!("slide {i}")] = json!({"final": {"slide": {"joint": joint}}});
        }
    }
    let last = format!("bar {}", names[3]);
    let direction: [f64; 3] = numbers.vector().into();
    for (name, value) in [
        (
            "place",
            json!({"position": {"body": last, "point": "end", "direction": direction}}),
        ),
        (
            "pull",
            json!({"acceleration": {"body": last, "point": "end", "direction": direction}}),
        ),
        (
            "turn",
            json!({"angular_velocity": {"body": last, "direction": normal}}),
        ),
        ("spring", json!({"spring_force": {"load": "spring"}})),
        ("momentum", json!({"momentum": {"direction": direction}})),
        (
            "spin",
            json!({"angular_momentum": {"direction": normal, "about": [1, 2, 3]}}),
        ),
        ("energy", json!({"energy": "kinetic"})),
    ] {
        functions[name] = json!({"final": value});
    }
    parse(&json!({
        "version": 1, "name": "tree", "gravity": turn.of([3.0, -9.0, 0.0]),
        "bodies": bodies, "joints": joints,
        "loads": {
            "spring": {"spring": {"between": [last, "ground"], "at": {"a": "end", "b": turn.of([0.2, 0.9, 0.7])},
                                  "rest_length": 0.4, "stiffness": 30, "damping": 0.4}},
            "push": {"force": {"body": last, "point": "end", "direction": turn.of([1.0, 2.0, 0.0]), "magnitude": 3}}
        },
        "simulation": {"duration": 0.3, "steps": 20, "samples": 10},
        "functions": functions,
        "variables": {
            "mass": {"path": format!("/bodies/{last}/mass"), "lower": 0.2},
            "angle": {"path": format!("/bodies/{last}/place/turn/0/angle")},
            "stiffness": {"path": "/loads/spring/spring/stiffness", "lower": 1}
        }
    }))
}

/// Random trees: values and gradients of every function are those without reductions, to round-off.
#[test]
fn random_trees_in_oblique_planes_have_the_same_functions_lowered() {
    let mut planar = 0;
    for case in 0..40 {
        let problem = tree(&mut Numbers(100 + case));
        planar += usize::from(is_planar(&problem));
        let method = match case % 4 {
            3 => Method::Radau { stages: 3 },
            _ => Method::Dop853,
        };
        let [states, values, gradients] =
            differences(&problem, &settings(method, Spacing::Steps(20)));
        // Welded bodies are merged, which changes the error of an implicit method.
        let welds = problem
            .lowering
            .as_ref()
            .is_some_and(|own| !own.welded.is_empty());
        let limit = if case % 4 == 3 && welds { 1e-4 } else { 1e-8 };
        assert!(
            states < limit && values < limit && gradients < limit,
            "case {case}: {states:e} {values:e} {gradients:e}"
        );
    }
    assert!(planar >= 30, "{planar}");
}

/// A ball that hangs at rest is held by the opposite of its weight, whatever the plane, the joint and the axes.
#[test]
fn a_ball_at_rest_is_held_by_its_weight_in_any_plane() {
    let mut numbers = Numbers(3);
    for case in 0..12 {
        let turn = Turn::any(&mut numbers);
        let gravity = turn.matrix * Vec3::new(0.0, -7.0, 0.0);
        let mass = 1.0 + case as f64;
        let joint = match case % 3 {
            0 => {
                json!({"revolute": {"between": ["ball", "ground"], "at": [0, 0, 0], "axis": turn.of([0.0, 0.0, 1.0])}})
            }
            1 => {
                json!({"prismatic": {"between": ["ground", "ball"], "at": [0, 0, 0], "axis": turn.of([1.0, 0.0, 0.0])}})
            }
            _ => {
                json!({"cylindrical": {"between": ["ball", "ground"], "at": [0, 0, 0], "axis": turn.of([0.0, 0.0, 1.0])}})
            }
        };
        let force = |k: usize| {
            let mut direction = [0.0; 3];
            direction[k] = 1.0;
            json!({"final": {"joint_force": {"joint": "joint", "direction": direction, "on": "ball"}}})
        };
        let problem = parse(&json!({
            "version": 1, "name": "ball", "gravity": <[f64; 3]>::from(gravity),
            "bodies": {"ball": {"shape": {"sphere": {"radius": 0.1}}, "mass": mass, "place": {"at": turn.of([0.0, -2.0, 0.0])}}},
            "joints": {"joint": joint},
            "simulation": {"duration": 0.1, "steps": 2},
            "functions": {"x": force(0), "y": force(1), "z": force(2)}
        }));
        assert!(is_planar(&problem), "case {case}");
        let at = run(&problem, &settings(Method::Dop853, Spacing::Steps(2)));
        for k in 0..3 {
            let (found, right) = (at.function(k).value, -mass * gravity[k]);
            assert!((found - right).abs() < 1e-9, "case {case}: {found} {right}");
        }
    }
}

/// A loop of a crank, a rod and a rocker on two hinges, a universal joint and a ball. Loads beside the plane of
/// the joints press the loop across it, and the motion determines how.
fn ring(direction: [f64; 3]) -> Problem {
    let bar = |length: f64, height: f64| {
        json!({"shape": {"box": {"size": [length, 0.1, 0.1]}}, "mass": length,
            "points": {"a": [-0.5 * length, 0, height], "b": [0.5 * length, 0, height]}})
    };
    let mut bodies = json!({"crank": bar(1.0, 0.0), "rod": bar(2.0, 0.0), "rocker": bar(1.5, 0.0)});
    for (name, at, angle) in [
        ("crank", json!([0, 0, 0]), 1.1),
        ("rod", json!("crank.b"), 0.2),
        ("rocker", json!("rod.b"), -1.3),
    ] {
        bodies[name]["place"] =
            json!({"put": "a", "at": at, "turn": {"axis": [0, 0, 1], "angle": angle}});
    }
    let joint = |a: &str, b: &str, at: &str| json!({"between": [a, b], "at": at});
    let hinge = |a: &str, b: &str, at: &str| {
        let mut place = joint(a, b, at);
        place["axis"] = json!([0, 0, 1]);
        json!({"revolute": place})
    };
    let mut cross = joint("rocker", "rod", "rod.b");
    cross["axis"] = json!([0, 0, 1]);
    cross["cross"] = json!({"body": "rod", "axis": [1, 0, 0]});
    parse(&json!({
        "version": 1, "name": "ring", "bodies": bodies,
        "joints": {
            "first": hinge("crank", "ground", "crank.a"), "second": hinge("rod", "crank", "rod.a"),
            "third": {"universal": cross}, "fourth": {"spherical": joint("rocker", "ground", "rocker.b")}
        },
        "loads": {"push": {"force": {"body": "rod", "point": [0, 0, 0.3], "direction": [1, 0, 0], "magnitude": 9}}},
        "simulation": {"duration": 0.2, "steps": 20},
        "functions": {"force": {"final": {"joint_force": {"joint": "second", "direction": direction}}}}
    }))
}

/// In a loop a force across the plane is that of the scene in space, or the plane is refused for it.
#[test]
fn a_force_across_the_plane_of_a_loop_keeps_space() {
    let settings = settings(Method::Dop853, Spacing::Steps(20));
    let inside = ring([0.8, -0.6, 0.0]);
    assert!(is_planar(&inside));
    let [_, values, _] = differences(&inside, &settings);
    assert!(values < 1e-9, "{values:e}");
    let across = ring([0.1, 0.0, 1.0]);
    assert!(!is_planar(&across));
    let what = obstacle(&across).what;
    assert_eq!(
        what,
        "a function observes a force across the plane of joint \"second\""
    );
    let [_, values, _] = differences(&across, &settings);
    assert!(values < 1e-9, "{values:e}");
}
