//! What is left out of a scene changes nothing but round-off: every problem of the package is run
//! lowered and as it is written, with the same steps. What has to stay is named with its reason.

mod reference;

use flexbody::driver::{self, Evaluated};
use flexbody::integrate::{Method, Samples, Settings, Spacing, simulate};
use flexbody::lower::{Obstacle, Plane};
use flexbody::math::{Mat3, Vec3, rotation};
use flexbody::model::{Axes, LoadKind, Mobility, Model};
use flexbody::problem::{Override, Problem};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

fn path(file: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(file)
}

fn load(file: &str, changes: &[&str]) -> Problem {
    let parse = |text: &&str| Override::parse(text).expect("an override");
    let changes: Vec<Override> = changes.iter().map(parse).collect();
    Problem::load(&path(file), &changes).unwrap_or_else(|faults| panic!("{faults}"))
}

/// A problem of the package with its document changed.
fn changed(file: &str, change: impl FnOnce(&mut Value)) -> Problem {
    let text = std::fs::read_to_string(path(file)).expect("a problem file");
    let mut document: Value = serde_json::from_str(&text).expect("JSON");
    change(&mut document);
    parse(&document)
}

fn parse(document: &Value) -> Problem {
    Problem::parse(&document.to_string(), "test.json", &[])
        .unwrap_or_else(|faults| panic!("{faults}"))
}

/// A design simulated with given settings.
fn run(problem: &Problem, settings: &Settings) -> Evaluated {
    let x = problem.start();
    let scene = problem.scene::<f64>(&x);
    let run = simulate(&scene.model, scene.duration, settings)
        .unwrap_or_else(|failure| panic!("{}: {failure}", problem.name));
    Evaluated { x, scene, run }
}

fn unlowered(problem: &Problem) -> Problem {
    let mut problem = problem.clone();
    problem.lowering = None;
    problem
}

fn is_planar(problem: &Problem) -> bool {
    let lowering = problem.lowering.as_ref().expect("a lowered problem");
    lowering.plane.is_ok()
}

fn obstacle(problem: &Problem) -> Obstacle {
    let lowering = problem.lowering.as_ref().expect("a lowered problem");
    let plane = lowering.plane.clone();
    plane.expect_err("a scene that leaves every plane")
}

fn settings(method: Method, spacing: Spacing) -> Settings {
    Settings {
        method,
        spacing,
        samples: Samples::Uniform(50),
        keep_stages: true,
    }
}

fn relative(a: &[f64], b: &[f64]) -> f64 {
    let size = b.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    let off = |(a, b): (&f64, &f64)| (a - b).abs();
    let off = a.iter().zip(b).map(off).fold(0.0, f64::max);
    if off == 0.0 { 0.0 } else { off / size }
}

/// Largest differences of the states, of the functions and of the gradients, lowered and not,
/// relative to the largest.
fn differences(problem: &Problem, settings: &Settings) -> [f64; 3] {
    let full = unlowered(problem);
    let (a, b) = (run(problem, settings), run(&full, settings));
    assert_eq!(a.run.grid, b.run.grid);
    let which: Vec<usize> = (0..a.scene.functions.len()).collect();
    let states = relative(&a.run.q, &b.run.q).max(relative(&a.run.v, &b.run.v));
    let mut worst = [states, 0.0, 0.0];
    for &f in &which {
        let (a, b) = (a.function(f).value, b.function(f).value);
        worst[1] = f64::max(worst[1], relative(&[a], &[b]));
    }
    if !a.x.is_empty() {
        let (of_a, _) = a.gradients(problem, &which).expect("regular");
        let (of_b, _) = b.gradients(&full, &which).expect("regular");
        for (a, b) in of_a.iter().zip(&of_b) {
            worst[2] = f64::max(worst[2], relative(a, b));
        }
    }
    worst
}

const RADAU: Method = Method::Radau { stages: 3 };
const BDF: Method = Method::Bdf {
    order: 2,
    start: flexbody::integrate::Start::Radau,
};

/// The problems, whether they are planar, the methods to try, and what round-off may become: the
/// squeezer magnifies it by turning fast, the stiff pendulum by its spring. The rows of four bars stop before their first singular
/// position, in which they do not determine how round-off goes on (`benchmarks.rs` runs them through
/// it, lowered).
#[test]
fn every_problem_moves_the_same_lowered() {
    let all: [(&str, bool, &[Method], f64); 14] = [
        ("trebuchet", true, &[Method::Dop853, RADAU, BDF], 1e-11),
        (
            "trebuchet_release_time",
            true,
            &[Method::Dop853, RADAU, BDF],
            1e-11,
        ),
        ("trebuchet_release_angle", true, &[Method::Dop853], 1e-11),
        (
            "triple_pendulum",
            false,
            &[Method::Dop853, RADAU, BDF],
            1e-11,
        ),
        (
            "benchmarks/andrews_squeezer",
            true,
            &[Method::Dop853, RADAU],
            1e-9,
        ),
        (
            "benchmarks/balanced_slider_crank",
            true,
            &[Method::Dop853, RADAU],
            1e-11,
        ),
        ("benchmarks/bricard", false, &[Method::Dop853, RADAU], 1e-11),
        ("benchmarks/flyball_governor", false, &[RADAU], 1e-11),
        ("benchmarks/four_bars_1", true, &[Method::Dop853], 1e-11),
        ("benchmarks/four_bars_2", true, &[Method::Dop853], 1e-11),
        ("benchmarks/four_bars_10", true, &[Method::Dop853], 1e-11),
        ("benchmarks/four_bars_40", true, &[Method::Dop853], 1e-11),
        (
            "benchmarks/simple_pendulum",
            true,
            &[Method::Dop853, RADAU],
            1e-11,
        ),
        ("benchmarks/stiff_pendulum", true, &[RADAU], 1e-9),
    ];
    let mut files: Vec<PathBuf> = Vec::new();
    for folder in ["problems", "problems/benchmarks"] {
        let entries = std::fs::read_dir(path(folder)).expect("a folder");
        let entries = entries.map(|entry| entry.expect("an entry").path());
        files.extend(entries.filter(|entry| entry.extension().is_some_and(|kind| kind == "json")));
    }
    let listed = |file: &PathBuf| {
        let file = file
            .strip_prefix(path("problems"))
            .expect("below")
            .with_extension("");
        all.iter().any(|(name, ..)| file == Path::new(name))
    };
    for file in &files {
        assert!(listed(file), "{} is not in the list", file.display());
    }
    for (name, planar, methods, round_off) in all {
        let short: &[&str] = match name.contains("four_bars") {
            true => &["/simulation/duration=0.5"],
            false => &[],
        };
        let problem = load(&format!("problems/{name}.json"), short);
        assert_eq!(is_planar(&problem), planar, "{name}");
        for &method in methods {
            let spacing = match method.is_adaptive() {
                true => {
                    let scene = problem.scene::<f64>(&problem.start());
                    let chosen = settings(method, Spacing::Tolerance(1e-6));
                    let run = simulate(&scene.model, scene.duration, &chosen);
                    Spacing::Frozen(run.expect("a run").grid)
                }
                false => Spacing::Steps(400),
            };
            let found = differences(&problem, &settings(method, spacing));
            for x in found {
                assert!(x <= round_off, "{name} by {}: {x:e}", method.name());
            }
        }
    }
}

/// The trebuchet of five bodies has 15 unknowns and 10 rows a step in the plane, against 30 and 21.
#[test]
fn the_trebuchet_is_planar_and_the_triple_pendulum_is_not() {
    let (model, _) = reference::load("trebuchet");
    let plane = Plane::find(&model).expect("planar");
    assert_eq!(plane.normal, Vec3::z());
    let mut lowered = model.clone();
    plane.apply(&mut lowered);
    let size = |model: &Model<f64>| {
        let numbering = flexbody::system::Numbering::new(model);
        (numbering.unknowns(), numbering.constraints())
    };
    assert_eq!(size(&model), (30, 21));
    assert_eq!(size(&lowered), (15, 10));
    for method in [Method::Dop853, RADAU] {
        let settings = settings(method, Spacing::Steps(400));
        let duration = 1.0;
        let a = simulate(&lowered, duration, &settings).expect("a run");
        let b = simulate(&model, duration, &settings).expect("a run");
        let off = relative(&a.q, &b.q).max(relative(&a.v, &b.v));
        assert!(off <= 1e-11, "{off:e}");
        // No motion leaves the plane.
        for k in 0..=a.last() {
            for body in 0..model.bodies.len() {
                let (q, v) = (&a.q(k)[7 * body..], &a.v(k)[6 * body..]);
                assert_eq!([q[2], q[4], q[5], v[2], v[3], v[4]], [0.0; 6]);
            }
        }
    }
    let (model, _) = reference::load("triple_pendulum");
    let obstacle = Plane::find(&model).expect_err("spatial");
    assert!(obstacle.what.contains("joint \"J3\""), "{obstacle}");
    assert!(!is_planar(&load("problems/triple_pendulum.json", &[])));
}

fn axle(axis: &str) -> String {
    format!(
        r#"/joints/axle={{"revolute": {{"between": ["arm", "ground"], "at": "arm.axle", "axis": {axis}}}}}"#
    )
}

#[test]
fn an_axle_tilted_by_a_nanoradian_keeps_the_scene_spatial() {
    let planar = load("problems/trebuchet.json", &[&axle("[0, 0, 1]")]);
    assert!(is_planar(&planar));
    let tilted = load("problems/trebuchet.json", &[&axle("[1e-9, 0, 1]")]);
    let found = obstacle(&tilted);
    assert!(
        found.to_string().contains("the axis of joint \"axle\""),
        "{found}"
    );
    assert!(
        (found.size - 1e-9).abs() < 1e-15 && found.unit == "rad",
        "{found:?}"
    );
    assert_eq!(found.variable, None);
    let scene = tilted.scene::<f64>(&tilted.start());
    assert!(
        scene
            .model
            .bodies
            .iter()
            .all(|body| body.mobility == Mobility::Spatial)
    );
}

#[test]
fn a_variable_that_breaks_the_plane_is_named() {
    let problem = changed("problems/trebuchet.json", |document| {
        document["gravity"] = json!([0, -9.81, 0]);
        document["variables"]["crosswind"] =
            json!({"path": "/gravity/2", "lower": -0.1, "upper": 0.1, "scale": 0.1});
    });
    let found = obstacle(&problem);
    assert_eq!(found.variable.as_deref(), Some("crosswind"));
    assert!(
        found.to_string().contains("gravity leaves the plane"),
        "{found}"
    );
    // A variable that moves gravity in the plane breaks nothing.
    let problem = changed("problems/trebuchet.json", |document| {
        document["gravity"] = json!([0, -9.81, 0]);
        document["variables"]["pull"] =
            json!({"path": "/gravity/1", "lower": -10, "upper": -9, "scale": 0.1});
    });
    assert!(is_planar(&problem));
}

/// The model turned as a whole about the origin.
fn turned(model: &Model<f64>, r: &Mat3<f64>, p: &[f64; 4]) -> Model<f64> {
    let mut model = model.clone();
    model.gravity = r * model.gravity;
    for body in &mut model.bodies {
        body.position = r * body.position;
        body.velocity = r * body.velocity;
        body.orientation = product(p, &body.orientation);
    }
    for joint in &mut model.joints {
        if joint.body_b.is_none() {
            joint.frame_b.point = r * joint.frame_b.point;
            joint.frame_b.axes = joint.frame_b.axes.map(|axis| r * axis);
        }
        joint.left_out.clear();
    }
    for load in &mut model.loads {
        match &mut load.kind {
            LoadKind::Force {
                direction,
                axes: Axes::Ground,
                ..
            }
            | LoadKind::Torque {
                direction,
                axes: Axes::Ground,
                ..
            } => *direction = r * *direction,
            LoadKind::Spring {
                body_b: None,
                point_b,
                ..
            } => *point_b = r * *point_b,
            _ => {}
        }
    }
    flexbody::system::redundancy::leave_out(&mut model);
    model
}

/// The Euler parameters of the turn `b` followed by `a`.
fn product(a: &[f64; 4], b: &[f64; 4]) -> [f64; 4] {
    let (u, w) = (Vec3::new(a[1], a[2], a[3]), Vec3::new(b[1], b[2], b[3]));
    let v = w * a[0] + u * b[0] + u.cross(&w);
    [a[0] * b[0] - u.dot(&w), v.x, v.y, v.z]
}

#[test]
fn any_normal_will_do() {
    let names = [
        "trebuchet",
        "benchmarks/four_bars_2",
        "benchmarks/balanced_slider_crank",
        "benchmarks/andrews_squeezer",
    ];
    for name in names {
        let problem = load(&format!("problems/{name}.json"), &[]);
        let scene = problem.unlowered_scene::<f64>(&problem.start());
        // The four bars are level, and their motion not determined, soon after.
        let duration = scene.duration.min(0.5);
        for (axis, angle) in [
            (Vec3::x(), 0.5 * std::f64::consts::PI),
            (Vec3::y(), 0.5 * std::f64::consts::PI),
            (Vec3::new(1.0, 2.0, -0.5), 0.7),
            (Vec3::new(-0.3, 0.4, 1.0), 2.9),
        ] {
            let p = rotation::from_axis_angle(&axis.normalize(), angle);
            let r = rotation::matrix(&p);
            let model = turned(&scene.model, &r, &p);
            let plane = Plane::find(&model).unwrap_or_else(|found| panic!("{name}: {found}"));
            let normal = r * Vec3::z();
            assert!(plane.normal.cross(&normal).norm() < 1e-14);
            let mut lowered = model.clone();
            plane.apply(&mut lowered);
            let chosen = settings(Method::Dop853, Spacing::Tolerance(1e-6));
            let grid = simulate(&lowered, duration, &chosen).expect("a run").grid;
            let same = settings(Method::Dop853, Spacing::Frozen(grid));
            let a = simulate(&lowered, duration, &same).expect("a run");
            let b = simulate(&model, duration, &same).expect("a run");
            let off = relative(&a.q, &b.q).max(relative(&a.v, &b.v));
            let round_off = if name.contains("four_bars") {
                1e-9
            } else {
                1e-11
            };
            assert!(
                off <= round_off,
                "{name} about {axis:?} by {angle:.2}: {off:e}"
            );
        }
    }
}

/// Two bars in parallel planes: the motion is planar, the hinge carries moments across the plane.
fn bars_in_parallel_planes(hinge: &str) -> Value {
    let axis = match hinge {
        "revolute" => json!({"between": ["first", "second"], "at": "first.end", "axis": [0, 0, 1]}),
        _ => json!({"between": ["first", "second"], "at": "first.end"}),
    };
    json!({
        "version": 1, "name": "bars",
        "bodies": {
            "first": {"shape": {"box": {"size": [1, 0.1, 0.1]}}, "mass": 1,
                "points": {"pin": [-0.5, 0, 0], "end": [0.5, 0, 0.05]},
                "place": {"put": "pin", "at": [0, 0, 0]}},
            "second": {"shape": {"box": {"size": [1, 0.1, 0.1]}}, "mass": 2,
                "points": {"pin": [-0.5, 0, -0.05]},
                "place": {"put": "pin", "at": "first.end"}}
        },
        "joints": {
            "pin": {"revolute": {"between": ["first", "ground"], "at": "first.pin", "axis": [0, 0, 1]}},
            "hinge": {hinge: axis}
        },
        "simulation": {"duration": 1},
        "functions": {"height": {"final": {"position": {"body": "second", "direction": [0, 1, 0]}}}}
    })
}

#[test]
fn moments_across_the_plane_are_recovered() {
    let problem = parse(&bars_in_parallel_planes("revolute"));
    assert!(is_planar(&problem));
    let lowered = driver::simulate(&problem, &[]).expect("a run");
    let written = driver::simulate(&unlowered(&problem), &[]).expect("a run");
    assert_eq!(lowered.at.run.grid.steps(), written.at.run.grid.steps());
    for k in [0, 300, 1000] {
        let (a, b) = (lowered.reactions(k), written.reactions(k));
        let moment = b[1].torque_ground.fixed_rows::<2>(0).norm();
        assert!(moment > 1e-3, "{moment}");
        for (a, b) in a.iter().zip(&b) {
            let size = b.force_ground.norm() + b.torque_ground.norm();
            let off = (a.force_ground - b.force_ground).norm()
                + (a.torque_ground - b.torque_ground).norm();
            assert!(off <= 1e-9 * size, "{off:e} of {size}");
        }
    }
    // A ball does not hold the second bar upright.
    let found = obstacle(&parse(&bars_in_parallel_planes("spherical")));
    assert!(
        found.what.contains("joint \"hinge\" tilts a body"),
        "{found}"
    );
}

/// A ball at the end of a spatial double pendulum.
fn ball_on_a_double_pendulum(at: Value, function: Value) -> Value {
    json!({
        "version": 1, "name": "ball",
        "bodies": {
            "first": {"shape": {"box": {"size": [1, 0.1, 0.2]}}, "mass": 1,
                "points": {"pin": [-0.5, 0, 0], "end": [0.5, 0, 0]},
                "place": {"put": "pin", "at": [0, 0, 0]}},
            "second": {"shape": {"box": {"size": [1, 0.1, 0.2]}}, "mass": 2,
                "points": {"pin": [-0.5, 0, 0], "end": [0.5, 0, 0]},
                "place": {"put": "pin", "at": "first.end"}},
            "ball": {"shape": {"box": {"size": [0.1, 0.2, 0.3]}}, "mass": 0.5,
                "points": {"held": at},
                "place": {"put": "held", "at": "second.end"}}
        },
        "joints": {
            "pin": {"revolute": {"between": ["first", "ground"], "at": "first.pin", "axis": [0, 0, 1]}},
            "hinge": {"revolute": {"between": ["second", "first"], "at": "first.end", "axis": [0, 1, 1]}},
            "holder": {"spherical": {"between": ["ball", "second"], "at": "second.end"}}
        },
        "simulation": {"duration": 1},
        "functions": {"asked": function},
        "variables": {
            "mass": {"path": "/bodies/ball/mass", "lower": 0.1, "upper": 1},
            "length": {"path": "/bodies/second/points/end/0", "lower": 0.3, "upper": 0.6}
        }
    })
}

#[test]
fn a_ball_held_at_its_centre_is_a_point() {
    let height =
        json!({"ks": {"rho": 5, "of": {"position": {"body": "ball", "direction": [0, 1, 0]}}}});
    let turn = json!({"final": {"rotation": {"body": "ball", "axis": [0, 0, 1]}}});
    let point = |problem: &Problem| {
        let scene = problem.scene::<f64>(&problem.start());
        scene.model.bodies[2].mobility == Mobility::Point
    };
    let problem = parse(&ball_on_a_double_pendulum(json!([0, 0, 0]), height.clone()));
    assert!(!is_planar(&problem) && point(&problem));
    for method in [Method::Dop853, RADAU, BDF] {
        let found = differences(&problem, &settings(method, Spacing::Steps(200)));
        assert!(
            found.iter().all(|&x| x <= 1e-11),
            "{}: {found:?}",
            method.name()
        );
    }
    let derivatives = driver::check(&problem, &problem.start()).expect("a run");
    for derivative in derivatives {
        assert!(derivative.relative_difference() <= 1e-12, "{derivative:?}");
    }
    assert!(!point(&parse(&ball_on_a_double_pendulum(
        json!([0, 0, 0]),
        turn
    ))));
    assert!(!point(&parse(&ball_on_a_double_pendulum(
        json!([0, 0.01, 0]),
        height
    ))));
}

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
        let size = |problem: &Problem| {
            let model = problem.scene::<f64>(&problem.start()).model;
            let numbering = flexbody::system::Numbering::new(&model);
            (numbering.unknowns(), numbering.constraints())
        };
        assert_eq!(size(&problem), size(&bare), "{file}");
        assert_eq!(is_planar(&problem), is_planar(&bare));
        for method in [Method::Dop853, RADAU, BDF] {
            let found = differences(&problem, &settings(method, Spacing::Steps(300)));
            for x in found {
                assert!(x <= 1e-11, "{file} by {}: {x:e}", method.name());
            }
        }
    }
}

#[test]
fn an_explanation_counts_what_is_left() {
    let problem = load("problems/trebuchet.json", &[]);
    let found = driver::explain(&problem).expect("a run");
    assert_eq!((found.written.velocities, found.written.rows), (30, 21));
    assert_eq!((found.lowered.velocities, found.lowered.rows), (15, 10));
    assert_eq!(found.lowered.stabilised, 50);
    assert!(
        4 * found.lowered.operations < found.written.operations,
        "{found:?}"
    );
    assert_eq!(found.lowered.order.len(), 5);
    assert_eq!(found.functions[0].variables.len(), 6);
    assert!(found.idle_variables.is_empty());
    let loops = driver::explain(&load("problems/benchmarks/four_bars_2.json", &[])).expect("a run");
    assert_eq!(
        (loops.lowered.order.len(), loops.lowered.closing.len()),
        (5, 2)
    );
    let spatial = driver::explain(&load("problems/triple_pendulum.json", &[])).expect("a run");
    assert_eq!(spatial.written, spatial.lowered);
    assert!(
        spatial.kept[0].contains("off the normal"),
        "{:?}",
        spatial.kept
    );
}
