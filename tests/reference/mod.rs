//! Scenes and trajectories of independent codes, as models.
//!
//! Made by integrating minimal coordinates with the Gragg–Bulirsch–Stoer method in 80-bit
//! arithmetic at tolerance 1e-17; accurate to 3e-14 m.
#![allow(dead_code)] // each test binary uses a part

use flexbody::integrate::Trajectory;
use flexbody::math::{Mat3, Vec3};
use flexbody::model::{Joint, JointFrame, JointKind, Model, RigidBody};
use flexbody::system::observe::reactions;
use serde_json::Value;

/// One instant of a reference trajectory.
pub struct Instant {
    pub time: f64,
    pub centres: Vec<Vec3<f64>>,
    pub velocities: Vec<Vec3<f64>>,
    pub value: Value,
}

/// Reads `tests/data/<name>_reference.json`.
pub fn load(name: &str) -> (Model<f64>, Vec<Instant>) {
    let path = format!(
        "{}/tests/data/{name}_reference.json",
        env!("CARGO_MANIFEST_DIR")
    );
    let text = std::fs::read_to_string(path).expect("reference file");
    let file: Value = serde_json::from_str(&text).expect("valid JSON");
    let instants = file["trajectory"]
        .as_array()
        .expect("list")
        .iter()
        .map(|at| Instant {
            time: at["t"].as_f64().expect("number"),
            centres: at["com"]
                .as_array()
                .expect("list")
                .iter()
                .map(vector)
                .collect(),
            velocities: at["v"]
                .as_array()
                .expect("list")
                .iter()
                .map(vector)
                .collect(),
            value: at.clone(),
        });
    (model(&file["scene"]), instants.collect())
}

fn vector(value: &Value) -> Vec3<f64> {
    let x: Vec<f64> = serde_json::from_value(value.clone()).expect("three numbers");
    Vec3::new(x[0], x[1], x[2])
}

fn matrix(value: &Value) -> Mat3<f64> {
    let rows: Vec<Vec3<f64>> = value.as_array().expect("rows").iter().map(vector).collect();
    Mat3::from_rows(&[
        rows[0].transpose(),
        rows[1].transpose(),
        rows[2].transpose(),
    ])
}

/// Euler parameters of a rotation matrix whose trace is not −1.
fn orientation(r: &Mat3<f64>) -> [f64; 4] {
    let p0 = 0.5 * (1.0 + r.trace()).sqrt();
    let scale = 0.25 / p0;
    [
        p0,
        (r[(2, 1)] - r[(1, 2)]) * scale,
        (r[(0, 2)] - r[(2, 0)]) * scale,
        (r[(1, 0)] - r[(0, 1)]) * scale,
    ]
}

fn model(scene: &Value) -> Model<f64> {
    let bodies: Vec<RigidBody<f64>> = scene["bodies"]
        .as_array()
        .expect("bodies")
        .iter()
        .map(|body| {
            let r = matrix(&body["R"]);
            RigidBody {
                name: body["name"].as_str().expect("name").into(),
                mass: body["mass"].as_f64().expect("mass"),
                inertia: matrix(&body["inertia_com"]),
                position: vector(&body["com"]),
                orientation: orientation(&r),
                velocity: vector(&body["v"]),
                angular_velocity: r.transpose() * vector(&body["omega"]),
            }
        })
        .collect();
    let joints = scene["joints"]
        .as_array()
        .expect("joints")
        .iter()
        .map(|joint| {
            let kind = match joint["type"].as_str().expect("type") {
                "spherical" => JointKind::Spherical,
                "revolute" => JointKind::Revolute,
                other => panic!("unknown joint {other}"),
            };
            let axis = if joint["axis"].is_null() {
                Vec3::z()
            } else {
                vector(&joint["axis"])
            };
            let axis = axis.normalize();
            let e1 = axis.cross(&Vec3::new(0.3, -0.5, 0.2)).normalize();
            let axes = [e1, axis.cross(&e1), axis];
            let point = vector(&joint["point"]);
            let find = |key: &str| {
                let name = joint[key].as_str().expect("body name");
                bodies.iter().position(|body| body.name == name)
            };
            let frame = |body: Option<usize>| match body {
                None => JointFrame { point, axes },
                Some(body) => {
                    let r = flexbody::math::rotation::matrix(&bodies[body].orientation);
                    JointFrame {
                        point: r.tr_mul(&(point - bodies[body].position)),
                        axes: axes.map(|e| r.tr_mul(&e)),
                    }
                }
            };
            let (body_a, body_b) = (find("body_a").expect("a body"), find("body_b"));
            Joint {
                name: joint["name"].as_str().expect("name").into(),
                kind,
                body_a,
                body_b,
                frame_a: frame(Some(body_a)),
                frame_b: frame(body_b),
            }
        })
        .collect();
    Model {
        gravity: vector(&scene["gravity"]),
        bodies,
        joints,
    }
}

/// Largest distance of a centre of mass from the reference, over all bodies and the reference
/// instants that are ends of steps.
pub fn position_error(run: &Trajectory<f64>, reference: &[Instant]) -> f64 {
    let mut worst = 0.0_f64;
    for at in reference {
        let k = (at.time / run.h).round();
        assert!(
            (k * run.h - at.time).abs() < 1e-9,
            "reference instants are ends of steps"
        );
        let q = run.q(k as usize);
        for (body, centre) in at.centres.iter().enumerate() {
            let r = &q[run.numbering.position(body)..];
            worst = worst.max((Vec3::new(r[0], r[1], r[2]) - centre).norm());
        }
    }
    worst
}

/// Largest difference of a joint's reaction (force [N] or torque about its point [N m], on body A,
/// ground axes) from the reference, relative to the largest reaction at any of its instants.
pub fn reaction_error(model: &Model<f64>, run: &Trajectory<f64>, reference: &[Instant]) -> f64 {
    let (mut worst, mut largest) = (0.0_f64, 0.0_f64);
    for at in reference {
        let k = (at.time / run.h).round() as usize;
        let found = reactions(model, &run.numbering, run.q(k), run.lambda(k));
        for (joint, found) in model.joints.iter().zip(&found) {
            let expected = &at.value["reactions"][&joint.name];
            for (key, found) in [("force", found.force_ground), ("moment", found.torque_ground)] {
                let expected = vector(&expected[key]);
                largest = largest.max(expected.norm());
                worst = worst.max((found - expected).norm());
            }
        }
    }
    worst / largest
}
