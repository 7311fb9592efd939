//! Scenes and trajectories of independent codes, as models.
//!
//! The trajectories are integrations of minimal coordinates by the Gragg–Bulirsch–Stoer method in
//! 80-bit arithmetic with the tolerance 1e-17. They are accurate to 3e-14 m.
#![allow(dead_code)] // each test binary uses a part

pub mod cases;
pub mod documents;
pub mod flexible;
pub mod gradients;
pub mod models;
pub(crate) mod mutations;
pub mod shells;

use flexbody_mathematics::math::{Mat3, Vec3};
use flexbody_mechanics::integrate::{Method, Multipliers, Settings, Start, Trajectory, simulate};
use flexbody_mechanics::model::{JointKind, Mobility, Model, RigidBody, Role};
use flexbody_mechanics::system::observe::reactions;
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
                mobility: Mobility::spatial(),
                role: Role::Solid,
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
            let find = |key: &str| {
                let name = joint[key].as_str().expect("body name");
                bodies.iter().position(|body| body.name == name)
            };
            models::joint(
                &bodies,
                (joint["name"].as_str().expect("name"), kind),
                (find("body_a").expect("a body"), find("body_b")),
                &vector(&joint["point"]),
                &axis,
            )
        })
        .collect();
    Model {
        gravity: vector(&scene["gravity"]),
        bodies,
        joints,
        loads: Vec::new(),
        flexible: Vec::new(),
    }
}

/// BDF of the given order with a start of rising order.
pub fn rising(order: usize) -> Method {
    Method::Bdf {
        order,
        start: Start::RisingOrder,
    }
}

/// Runs a method with steps of size `h`, sampled at their ends.
pub fn run(model: &Model<f64>, duration: f64, method: Method, h: f64) -> Trajectory<f64> {
    let steps = (duration / h).round() as usize;
    simulate(model, duration, &Settings::steps(method, steps)).expect("runs")
}

/// Runs BDF of order 1 or 2 with steps of size `h`.
pub fn bdf(model: &Model<f64>, duration: f64, h: f64, order: usize) -> Trajectory<f64> {
    run(model, duration, rising(order), h)
}

/// Observed order of an error, from steps of one size and of half of it.
pub fn observed_order(coarse: f64, fine: f64) -> f64 {
    (coarse / fine).log2()
}

/// Largest distance of a centre of mass from the reference [m], and largest difference of its
/// velocity [m/s], over all bodies and the reference instants that are samples of the run.
pub fn motion_error(run: &Trajectory<f64>, reference: &[Instant]) -> (f64, f64) {
    let (mut position, mut velocity) = (0.0_f64, 0.0_f64);
    let mut compared = 0;
    for (k, at) in common(run, reference) {
        compared += 1;
        for body in 0..at.centres.len() {
            let r = &run.q(k)[run.numbering.position(body)..];
            let v = &run.v(k)[run.numbering.velocity(body)..];
            position = position.max((Vec3::new(r[0], r[1], r[2]) - at.centres[body]).norm());
            velocity = velocity.max((Vec3::new(v[0], v[1], v[2]) - at.velocities[body]).norm());
        }
    }
    assert!(compared > 1, "no reference instant is sampled");
    (position, velocity)
}

/// The sampled reference instants, with their samples.
fn common<'a>(
    run: &'a Trajectory<f64>,
    reference: &'a [Instant],
) -> impl Iterator<Item = (usize, &'a Instant)> {
    reference.iter().filter_map(|at| {
        let near = |k: &usize| (run.time(*k) - at.time).abs() < 1e-9;
        Some(((0..=run.last()).find(near)?, at))
    })
}

/// Largest difference of a joint's reaction (force [N] or torque about its point [N m], on body A,
/// ground axes) from the reference, relative to the largest reaction at any of its instants.
pub fn reaction_error(model: &Model<f64>, run: &Trajectory<f64>, reference: &[Instant]) -> f64 {
    let (mut worst, mut largest) = (0.0_f64, 0.0_f64);
    let mut multipliers = Multipliers::new(model, &run.numbering, run);
    for (k, at) in common(run, reference) {
        let lambda = multipliers.at(k);
        let found = reactions(model, &run.numbering, (run.q(k), &lambda), run.time(k));
        for (joint, found) in model.joints.iter().zip(&found) {
            let expected = &at.value["reactions"][&joint.name];
            for (key, found) in [
                ("force", found.force_ground),
                ("moment", found.torque_ground),
            ] {
                let expected = vector(&expected[key]);
                largest = largest.max(expected.norm());
                worst = worst.max((found - expected).norm());
            }
        }
    }
    worst / largest
}
