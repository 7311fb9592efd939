//! The committed problems and the map from their designs to scenes.

use flexbody_mathematics::math::scalar::COMPLEX_STEP;
use flexbody_mathematics::math::{Complex64, Dual, Vec3, rotation};
use flexbody_mechanics::functions::{Bound, Function, Instant, Quantity, Reduction, Release};
use flexbody_mechanics::integrate::Spacing;
use flexbody_mechanics::model::JointKind;
use flexbody_problem::*;
use std::path::Path;

fn committed(name: &str) -> Problem {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("problems")
        .join(name);
    Problem::load(&path, &[]).unwrap_or_else(|faults| panic!("{faults}"))
}

fn close(a: Vec3<f64>, b: [f64; 3]) -> bool {
    (a - Vec3::from(b)).abs().max() < 1e-12
}

/// Derivatives of all parameters of the scene by every variable: dual numbers against the complex
/// step. Their values equal those of the scene in f64.
fn derivatives_agree(problem: &Problem, x: &[f64]) {
    let value = problem.scene(x).parameters();
    for (k, variable) in problem.variables.iter().enumerate() {
        let mut dual: Vec<Dual> = x.iter().map(|&x| Dual::from(x)).collect();
        dual[k].du = 1.0;
        let mut complex: Vec<Complex64> = x.iter().map(|&x| Complex64::from(x)).collect();
        complex[k].im = COMPLEX_STEP;
        let dual = problem.scene(&dual).parameters();
        let complex = problem.scene(&complex).parameters();
        for i in 0..value.len() {
            assert_eq!(dual[i].re, value[i]);
            let step = complex[i].im / COMPLEX_STEP;
            let gap = (dual[i].du - step).abs();
            assert!(
                gap <= 1e-13 * dual[i].du.abs().max(1.0),
                "{}: {i}",
                variable.name
            );
        }
        let moved = dual.iter().any(|parameter| parameter.du != 0.0);
        assert!(moved, "{} moves nothing", variable.name);
    }
}

/// Derivatives of all parameters of the scene by every variable: dual numbers against central
/// differences.
fn derivatives_are_slopes(problem: &Problem, x: &[f64]) {
    for k in 0..x.len() {
        let mut dual: Vec<Dual> = x.iter().map(|&x| Dual::from(x)).collect();
        dual[k].du = 1.0;
        let dual = problem.scene(&dual).parameters();
        let h = 1e-6 * x[k].abs().max(1e-3);
        let at = |step: f64| {
            let mut moved = x.to_vec();
            moved[k] += step;
            problem.scene(&moved).parameters()
        };
        let (before, after) = (at(-h), at(h));
        for i in 0..dual.len() {
            let slope = (after[i] - before[i]) / (2.0 * h);
            let scale = dual[i]
                .du
                .abs()
                .max(1e-4 * dual[i].re.abs() / x[k].abs().max(1e-3))
                .max(1.0);
            assert!(
                (dual[i].du - slope).abs() < 1e-6 * scale,
                "{k} {i}: {} {slope}",
                dual[i].du
            );
        }
    }
}

#[test]
fn the_trebuchet_has_the_masses_inertias_and_places_of_the_reference() {
    let problem = committed("trebuchet.json");
    let scene = problem.scene(&problem.start());
    // Mass, principal inertia about x, y, z and centre of mass.
    let expected = [
        (
            "counterweight",
            400.0,
            [566.6666666666667, 566.6666666666667, 1066.6666666666667],
            [0.0, -4.0, 0.0],
        ),
        (
            "link",
            5.0,
            [1.7708333333333335, 0.20833333333333334, 1.7708333333333335],
            [0.0, -1.0, 0.0],
        ),
        (
            "arm",
            40.0,
            [14.166666666666668, 1346.6666666666667, 1334.1666666666667],
            [-10.0, 0.0, 0.0],
        ),
        (
            "sling",
            0.006,
            [0.018125, 0.000145, 0.01802],
            [-17.0, 0.0, 0.0],
        ),
        ("stone", 0.01, [0.0016666666666666668; 3], [-13.5, 0.0, 0.0]),
    ];
    assert_eq!(scene.model.bodies.len(), expected.len());
    for (body, (name, mass, inertia, centre)) in scene.model.bodies.iter().zip(expected) {
        assert_eq!(body.name, name);
        assert_eq!(body.mass, mass);
        let relative = body.inertia.diagonal().component_div(&Vec3::from(inertia));
        assert!(close(relative, [1.0; 3]), "{name}: {}", body.inertia);
        assert_eq!(
            body.inertia
                - flexbody_mathematics::math::Mat3::from_diagonal(&body.inertia.diagonal()),
            flexbody_mathematics::math::Mat3::zeros()
        );
        assert!(close(body.position, centre), "{name}: {}", body.position);
        assert!(close(body.velocity, [0.0; 3]) && close(body.angular_velocity, [0.0; 3]));
    }
    let sling = rotation::matrix(&scene.model.bodies[3].orientation);
    assert!(close(sling * Vec3::x(), [0.0, 1.0, 0.0]));
    assert_eq!(scene.duration, 2.0);
    assert_eq!(problem.simulation.spacing, Spacing::Tolerance(1e-9));
    assert_eq!(problem.simulation.samples, Some(2000));
    assert_eq!(problem.start(), [400.0, 5.0, 40.0, 0.006, 0.01, 0.0]);
    assert_eq!(problem.variables[0].unit, "kg");
    assert_eq!(problem.variables[0].scale, 100.0);
    let objective = problem.objective.expect("an objective");
    assert_eq!((objective.function, objective.sense), (0, Sense::Maximise));
    assert_eq!(problem.constraints[0].function, 1);
    assert_eq!(
        (problem.constraints[0].lower, problem.constraints[0].upper),
        (0.0, f64::INFINITY)
    );
    match &scene.functions[..] {
        [
            Function::Reduced {
                of:
                    Quantity::Of(Instant::Range {
                        projectile,
                        gate: Some(gate),
                    }),
                reduction,
                ..
            },
            Function::Clearance {
                release: Release::Best { rho, .. },
                distance,
                top,
                ..
            },
        ] => {
            assert_eq!(
                *reduction,
                Reduction::Ks {
                    rho: 0.3,
                    bound: Bound::Below
                }
            );
            assert_eq!(
                (
                    projectile.body,
                    projectile.ground,
                    gate.rotation.body,
                    gate.width
                ),
                (4, -10.0, 3, 0.15)
            );
            assert!(close(projectile.direction, [1.0, 0.0, 0.0]));
            assert_eq!((*rho, *distance, *top), (0.3, 60.0, 73.5));
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn every_joint_is_closed_and_its_frames_are_orthonormal_at_any_design() {
    for name in [
        "trebuchet.json",
        "trebuchet_release_time.json",
        "triple_pendulum.json",
    ] {
        let problem = committed(name);
        let mut x = problem.start();
        // All variables except points of bodies: these move the bodies but not the ground side of
        // joints.
        for (x, variable) in x.iter_mut().zip(&problem.variables) {
            *x += 0.1 * (variable.upper - *x);
        }
        let scene = problem.scene(&x);
        for joint in &scene.model.joints {
            let ground =
                |body: Option<usize>, frame: &flexbody_mechanics::model::JointFrame<f64>| match body
                {
                    None => (frame.point, frame.axes),
                    Some(body) => {
                        let body = &scene.model.bodies[body];
                        let r = rotation::matrix(&body.orientation);
                        (body.position + r * frame.point, frame.axes.map(|e| r * e))
                    }
                };
            let (point_a, axes_a) = ground(Some(joint.body_a), &joint.frame_a);
            let (point_b, axes_b) = ground(joint.body_b, &joint.frame_b);
            assert!((point_a - point_b).abs().max() < 1e-13, "{}", joint.name);
            for i in 0..3 {
                assert!((axes_a[i] - axes_b[i]).abs().max() < 1e-14);
                assert!(
                    (axes_a[i].cross(&axes_a[(i + 1) % 3]) - axes_a[(i + 2) % 3])
                        .abs()
                        .max()
                        < 1e-14
                );
            }
        }
    }
}

#[test]
fn the_arm_turns_and_what_hangs_on_it_stays_upright() {
    let problem = committed("trebuchet.json");
    let mut x = problem.start();
    x[5] = 0.4;
    let bodies = problem.scene(&x).model.bodies;
    let right = Vec3::new(-4.0 + 4.0 * 0.4_f64.cos(), 4.0 * 0.4_f64.sin(), 0.0);
    assert!(close(bodies[1].position - right, [0.0, -1.0, 0.0]));
    assert!(close(bodies[0].position - right, [0.0, -4.0, 0.0]));
    assert!(close(
        rotation::matrix(&bodies[0].orientation) * Vec3::x(),
        [1.0, 0.0, 0.0]
    ));
    assert!((rotation::twist(&bodies[2].orientation, &Vec3::z()) - 0.4).abs() < 1e-15);
}

#[test]
fn the_release_time_problem_ends_at_the_release() {
    let problem = committed("trebuchet_release_time.json");
    assert_eq!(problem.variables.len(), 7);
    let mut x = problem.start();
    assert_eq!(x[6], 1.165);
    x[6] = 1.02;
    let scene = problem.scene(&x);
    assert_eq!(scene.duration, 1.02);
    assert!(matches!(
        &scene.functions[1],
        Function::Clearance {
            release: Release::Final,
            ..
        }
    ));
}

#[test]
fn the_triple_pendulum_turns_as_one_body() {
    let problem = committed("triple_pendulum.json");
    let scene = problem.scene(&problem.start());
    let expected = [
        (1.0, [0.5, 0.0, 0.0], -0.5),
        (2.0, [2.0, 0.0, 0.0], -2.0),
        (3.0, [4.5, 0.0, 0.0], -4.5),
    ];
    for (body, (mass, centre, v)) in scene.model.bodies.iter().zip(expected) {
        assert_eq!(body.mass, mass);
        assert!(close(body.position, centre) && close(body.velocity, [0.0, 0.0, v]));
        assert!(close(body.angular_velocity, [0.0, 1.0, 0.0]));
    }
    let axis = scene.model.joints[2].frame_a.axes[2];
    assert!(close(axis, [0.0, 0.5, 0.75_f64.sqrt()]));
    assert_eq!(scene.model.joints[0].kind, JointKind::Spherical);
    assert_eq!(scene.model.joints[0].body_b, None);
}

#[test]
fn derivatives_of_the_committed_problems_agree() {
    for name in [
        "trebuchet.json",
        "trebuchet_release_time.json",
        "triple_pendulum.json",
    ] {
        let problem = committed(name);
        let mut x = problem.start();
        derivatives_agree(&problem, &x);
        for (x, variable) in x.iter_mut().zip(&problem.variables) {
            *x += 0.1 * (variable.upper - *x);
        }
        derivatives_agree(&problem, &x);
        derivatives_are_slopes(&problem, &x);
    }
}

/// A document that uses every key that can hold a physical number.
const EVERYTHING: &str = r#"{
  "version": 1, "name": "everything",
  "gravity": [0.1, -9.81, 0.2],
  "bodies": {
    "box": {"shape": {"box": {"size": [1, 2, 3]}}, "density": 2,
      "points": {"corner": [0.5, 1, 1.5]},
      "place": {"put": [0.1, 0.2, 0.3], "at": [1, 2, 3],
        "turn": [{"axis": [1, 2, 0.5], "angle": 0.4}, {"axis": [0, 1, 0.3], "angle": -1.1}]}},
    "cylinder": {"shape": {"cylinder": {"radius": 0.4, "length": 2}}, "mass": 3,
      "place": {"at": "box.corner", "turn": {"axis": [0.2, 1, 0.1], "angle": 0.3}, "relative_to": "box"},
      "velocity": {"linear": [1, 2, 3], "angular": [0.1, 0.2, 0.3]}},
    "sphere": {"shape": {"sphere": {"radius": 0.3}}, "density": 5},
    "rod": {"shape": {"rod": {"length": 2, "radius": 0.1}}, "density": 7, "place": {"at": "sphere"}},
    "free": {"mass": 2, "centre_of_mass": [0.1, 0.2, 0.3],
      "inertia": {"xx": 2, "yy": 3, "zz": 4, "xy": 0.1, "xz": 0.2, "yz": 0.3},
      "points": {"tip": [1, 0, 0]}, "place": {"put": "tip", "at": [0, 5, 0], "turn": {"axis": [0.1, 0.2, 1], "angle": 1}}}
  },
  "initial_velocity": {"linear": [1, 0.5, 0.2], "angular": [0.3, 1, 0.4], "about": [0.5, 0.6, 0.7]},
  "joints": {
    "ball": {"spherical": {"between": ["box", "cylinder"], "at": "box.corner"}},
    "hinge": {"revolute": {"between": ["free", "box"], "at": [3, 4, 5], "axis": [1, 0.2, 0.3]}},
    "slider": {"prismatic": {"between": ["ground", "sphere"], "at": {"a": [1, 2, 3], "b": [0.1, 0.2, 0.3]}, "axis": [0.3, 1, 0.2]}},
    "plane": {"planar": {"between": ["rod", "free"], "at": "free.tip", "axis": {"body": "rod", "axis": [0.1, 0.2, 1]}}}
  },
  "simulation": {"duration": 2, "steps": 10, "method": {"bdf": {"order": 1}}},
  "functions": {
    "range": {"ks": {"rho": 1, "of": {"range": {"body": "box", "point": [0.1, 0.2, 0.3], "direction": [2, 0.02038735983690112, 0], "ground": -1,
      "gate": {"body": "rod", "axis": [0, 0, 2], "below": 1, "width": 0.1}}}}},
    "clearance": {"clearance": {"release": "range", "barrier": {"distance": 5, "top": 2}}},
    "place": {"final": {"position": {"body": "free", "point": "tip", "direction": [1, 2, 3]}}},
    "speed": {"integral": {"speed": {"body": "free", "point": [1, 2, 3]}}},
    "velocity": {"final": {"velocity": {"body": "rod", "direction": [1, 0, 0]}}},
    "pull": {"induced_exponential": {"rho": 2, "of": {"acceleration": {"body": "rod", "direction": [0, 1, 0]}}}},
    "energy": {"final": {"energy": "total"}},
    "turn": {"final": {"rotation": {"body": "rod", "axis": [1, 2, 3]}}}
  }
}"#;

/// [`EVERYTHING`] with a design variable at every number that admits one.
fn everything() -> (serde_json::Value, Problem) {
    let mut document: serde_json::Value = serde_json::from_str(EVERYTHING).expect("JSON");
    let structure = structure::walk(&document, schema());
    assert!(structure.findings.is_empty(), "{:?}", structure.findings);
    let open = structure
        .numbers
        .iter()
        .filter(|(_, number)| number.barred.is_none());
    let variables: serde_json::Map<_, _> = open
        .map(|(path, number)| {
            let mut variable = serde_json::json!({"path": path});
            if let Some((least, _)) = number.least {
                variable["lower"] = (least + 1e-3).into();
            }
            (path.clone(), variable)
        })
        .collect();
    document["variables"] = variables.into();
    let problem = Problem::parse(&document.to_string(), "everything.json", &[]);
    (
        document,
        problem.unwrap_or_else(|faults| panic!("{faults}")),
    )
}

#[test]
fn every_physical_number_can_be_a_design_variable_and_its_derivatives_agree() {
    let (_, problem) = everything();
    // 3 gravity; 17 + 12 + 2 + 3 + 20 bodies; 9 velocity; 6 + 9 + 3 joints; 1 duration;
    // 7 range, 2 barrier, 3 position, 3 speed, 3 + 3 + 3 directions and axes.
    let names: Vec<&str> = problem.variables.iter().map(|v| v.name.as_str()).collect();
    for path in [
        "/gravity/0",
        "/bodies/box/density",
        "/bodies/box/shape/box/size/2",
        "/bodies/box/points/corner/1",
        "/bodies/box/place/put/0",
        "/bodies/box/place/at/1",
        "/bodies/box/place/turn/1/angle",
        "/bodies/cylinder/mass",
        "/bodies/cylinder/velocity/angular/2",
        "/bodies/rod/shape/rod/radius",
        "/bodies/free/inertia/yz",
        "/bodies/free/centre_of_mass/0",
        "/initial_velocity/about/2",
        "/joints/hinge/revolute/at/0",
        "/joints/slider/prismatic/at/a/1",
        "/joints/plane/planar/axis/axis/0",
        "/simulation/duration",
        "/functions/range/ks/of/range/direction/0",
        "/functions/clearance/clearance/barrier/top",
        "/functions/turn/final/rotation/axis/1",
    ] {
        assert!(names.contains(&path), "{path}");
    }
    for path in [
        "/version",
        "/simulation/steps",
        "/functions/range/ks/rho",
        "/functions/range/ks/of/range/gate/width",
    ] {
        assert!(!names.contains(&path), "{path}");
    }
    derivatives_agree(&problem, &problem.start());
    derivatives_are_slopes(&problem, &problem.start());
}

#[test]
fn ground_named_first_is_body_b() {
    let (_, problem) = everything();
    let joint = &problem.scene(&problem.start()).model.joints[2];
    assert_eq!(
        (joint.kind, joint.body_a, joint.body_b),
        (JointKind::Prismatic, 2, None)
    );
    assert!(
        close(joint.frame_a.point, [0.1, 0.2, 0.3]) && close(joint.frame_b.point, [1.0, 2.0, 3.0])
    );
}

#[test]
fn a_problem_is_made_again_from_its_document() {
    let problem = committed("trebuchet.json");
    let again = Problem::parse(&problem.document.to_string(), "record", &[]).expect("a problem");
    assert_eq!((again.hash.len(), &again.hash), (64, &problem.hash));
    let heavier = Override::parse("/bodies/arm/mass=50").expect("an override");
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("problems/trebuchet.json");
    let other = Problem::load(&path, &[heavier]).expect("a problem");
    assert_eq!(other.start()[2], 50.0);
    assert_ne!(other.hash, problem.hash);
}

#[test]
fn the_drawing_follows_the_design() {
    let (_, problem) = everything();
    let drawing = problem.drawing(&problem.start());
    assert_eq!((drawing.ground, drawing.snapshots), (Some(-1.0), 12));
    assert_eq!(
        drawing.barrier,
        Some(BarrierLine {
            distance: 5.0,
            top: 2.0
        })
    );
    assert!(matches!(drawing.outlines[2], Outline::Sphere(r) if r == 0.3));
    match &drawing.outlines[0] {
        Outline::Hull(points) => {
            assert!(points.len() == 8 && points.iter().all(|p| close(p.abs(), [0.5, 1.0, 1.5])))
        }
        other => panic!("{other:?}"),
    }
    let trebuchet = committed("trebuchet.json");
    let traces = trebuchet.drawing(&trebuchet.start()).traces;
    let found: Vec<_> = traces.iter().map(|own| (own.body, own.point)).collect();
    assert_eq!(found, [(4, Vec3::zeros())]);
    assert!(traces[0].name == "stone" && traces[0].by.is_empty());
}

#[test]
fn the_worked_example_of_the_reference_is_sound_and_its_fault_is_the_one_shown() {
    let page = include_str!("../../docs/problem-file.md");
    let block = |kind: &str| {
        let (_, rest) = page.split_once(&format!("```{kind}\n")).expect("a block");
        rest.split_once("```").expect("the end of the block").0
    };
    let text = block("json");
    let problem = Problem::parse(text, "hammer.json", &[]).unwrap_or_else(|f| panic!("{f}"));
    derivatives_agree(&problem, &problem.start());
    let wrong = text.replace(r#"["head", "handle"]"#, r#"["haed", "handle"]"#);
    let faults = Problem::parse(&wrong, "hammer.json", &[]).expect_err("an unknown body");
    assert_eq!(faults.to_string(), block("text").trim_end());
}
