//! Scenes that move in a plane.

use super::*;
use flexbody_driver as driver;
use flexbody_mathematics::math::{Mat3, Vec3, rotation};
use flexbody_mechanics::lower::Plane;
use flexbody_mechanics::model::{Axes, LoadKind, Mobility, Model};

/// In the plane, the trebuchet of five bodies has 15 unknowns and 10 rows, against 30 and 21 in
/// space.
#[test]
fn the_trebuchet_is_planar_and_the_triple_pendulum_is_not() {
    let (model, _) = reference::load("trebuchet");
    let plane = Plane::of(&model).expect("planar");
    assert_eq!(plane.normal, Vec3::z());
    let mut lowered = model.clone();
    plane.apply(&mut lowered);
    let size = |model: &Model<f64>| {
        let numbering = flexbody_mechanics::system::Numbering::new(model);
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
        // The motion stays in the plane.
        for k in 0..=a.last() {
            for body in 0..model.bodies.len() {
                let (q, v) = (&a.q(k)[7 * body..], &a.v(k)[6 * body..]);
                assert_eq!([q[2], q[4], q[5], v[2], v[3], v[4]], [0.0; 6]);
            }
        }
    }
    let (model, _) = reference::load("triple_pendulum");
    let obstacle = &Plane::of(&model).expect_err("spatial").obstacles[0];
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
            .all(|body| body.mobility == Mobility::spatial())
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
    // A variable that changes gravity in the plane violates no condition.
    let problem = changed("problems/trebuchet.json", |document| {
        document["gravity"] = json!([0, -9.81, 0]);
        document["variables"]["pull"] =
            json!({"path": "/gravity/1", "lower": -10, "upper": -9, "scale": 0.1});
    });
    assert!(is_planar(&problem));
}

/// The whole model, rotated about the origin.
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
        joint.redundant.clear();
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
    flexbody_mechanics::system::redundancy::leave_out(&mut model);
    model
}

/// The Euler parameters of the rotation `b` followed by `a`.
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
        // Soon after, the four bars are in line, and their motion is not determined.
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
            let plane = Plane::of(&model).unwrap_or_else(|kept| panic!("{name}: {kept}"));
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

/// Two bars in parallel planes: the motion is planar, and the hinge carries moments across the
/// plane.
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
    // A ball joint does not hold the second bar upright.
    let found = obstacle(&parse(&bars_in_parallel_planes("spherical")));
    assert!(
        found.what.contains("joint \"hinge\" tilts a body"),
        "{found}"
    );
}

/// A cart that slides along x and can roll about it, with an arm that rotates about z.
fn cart() -> Value {
    json!({
        "version": 1, "name": "cart",
        "bodies": {
            "cart": {"shape": {"box": {"size": [1, 0.2, 0.3]}}, "mass": 1, "place": {"at": [0, 0, 0]}},
            "arm": {"shape": {"box": {"size": [1, 0.1, 0.2]}}, "mass": 1,
                "points": {"a": [-0.5, 0, 0]}, "place": {"put": "a", "at": [0, 0, 0]}}
        },
        "joints": {
            "rail": {"cylindrical": {"between": ["cart", "ground"], "at": [0, 0, 0], "axis": [1, 0, 0]}},
            "pin": {"revolute": {"between": ["arm", "cart"], "at": [0, 0, 0], "axis": [0, 0, 1]}}
        },
        "simulation": {"duration": 1}
    })
}

/// Planarity does not depend on the order of the joints or on the signs of their axes.
#[test]
fn the_plane_does_not_depend_on_the_order_of_joints() {
    let read = |file: &str| -> Value {
        let text = std::fs::read_to_string(path(file)).expect("a problem file");
        serde_json::from_str(&text).expect("JSON")
    };
    for (mut document, planar) in [
        (cart(), true),
        (read("problems/trebuchet.json"), true),
        (read("problems/benchmarks/balanced_slider_crank.json"), true),
        (read("problems/benchmarks/andrews_squeezer.json"), true),
        (read("problems/triple_pendulum.json"), false),
    ] {
        let name = document["name"].clone();
        // The sections that name joints.
        let of_names = ["loads", "drives", "variables", "objective", "constraints"];
        let joints = document["joints"].as_object().expect("joints").clone();
        let mut normals = Vec::new();
        for shift in 0..joints.len() {
            for sign in [1.0, -1.0] {
                let order = joints.iter().cycle().skip(shift).take(joints.len());
                // The keys of a map are sorted, so the names determine the order.
                let renamed = order.enumerate().map(|(i, (_, joint))| {
                    let mut joint = joint.clone();
                    for kind in joint.as_object_mut().expect("a joint").values_mut() {
                        if let Some(Value::Array(axis)) = kind.get_mut("axis") {
                            axis.iter_mut()
                                .for_each(|x| *x = json!(sign * x.as_f64().expect("a number")));
                        }
                    }
                    (format!("j{i:02}"), joint)
                });
                document["joints"] = Value::Object(renamed.collect());
                document
                    .as_object_mut()
                    .expect("a problem")
                    .retain(|key, _| !of_names.contains(&key.as_str()));
                let problem = parse(&document);
                let lowering = problem.lowering.as_ref().expect("a lowered problem");
                assert_eq!(
                    lowering.plane.is_ok(),
                    planar,
                    "{name} from {shift} by {sign}"
                );
                normals.extend(lowering.plane.as_ref().ok().map(|plane| plane.normal));
            }
        }
        assert!(
            normals.iter().all(|normal| *normal == normals[0]),
            "{name}: {normals:?}"
        );
    }
}
