//! Starts of joints between bodies of finite elements, and torques at their points.

use crate::reference::documents::plates;
use crate::reference::documents::{problem as parsed, values};
use crate::reference::gradients::{scaled_gradients_are_exact, thick_and_soft};
use flexbody_mechanics::system::flexible::strain_energy;
use flexbody_mechanics::system::nearest::nearest;
use flexbody_mechanics::system::{BodyMotion, Numbering};
use serde_json::Value;
use std::f64::consts::FRAC_PI_2;

fn upright(angle: f64) -> Value {
    json!([{"axis": [1, 0, 0], "angle": FRAC_PI_2}, {"axis": [0, 0, 1], "angle": angle}])
}

fn two(duration: f64) -> Value {
    let mut document = plates([2, 1], duration, 5, &json!({"radau": {"stages": 3}}));
    document
        .as_object_mut()
        .expect("an object")
        .remove("variables");
    for body in ["first", "second"] {
        let body = document["bodies"][body].as_object_mut().expect("a body");
        body.remove("velocity");
    }
    document
}

/// Joints that start as given make the same motion as plates that are placed, with their velocities.
#[test]
fn plates_start_with_their_joints() {
    let mut started = two(0.01);
    started["joints"]["root"]["revolute"]["start"] = json!({"turn": {"angle": 0.3, "rate": 8}});
    started["joints"]["hinge"]["revolute"]["start"] = json!({"turn": {"angle": -0.5, "rate": 1}});
    let mut placed = two(0.01);
    placed["bodies"]["first"]["place"]["turn"] = upright(0.3);
    placed["bodies"]["first"]["velocity"] = json!({"linear": [0, 0, 0], "angular": [0, 0, 8]});
    placed["bodies"]["second"]["place"]["turn"] = upright(-0.2);
    let (sine, cosine) = 0.3_f64.sin_cos();
    placed["bodies"]["second"]["velocity"] =
        json!({"linear": [-8.0 * sine, 8.0 * cosine, 0], "angular": [0, 0, 9]});
    for (k, (a, b)) in values(&started).iter().zip(values(&placed)).enumerate() {
        assert!((a - b).abs() < 1e-9 * b.abs().max(1.0), "{k}: {a} {b}");
    }
}

/// Three plates in a loop: one joint starts, the others follow, and no plate is deformed. Derivatives in the start
/// are exact.
#[test]
fn a_loop_of_plates_starts_with_one_joint() {
    // So long that the plates bend: energies that are nearly zero have derivatives with few digits.
    let mut document = two(0.03);
    thick_and_soft(&mut document);
    document["bodies"]["third"] = document["bodies"]["first"].clone();
    document["bodies"]["first"]["place"]["turn"] = upright(1.2);
    document["bodies"]["second"]["place"]["turn"] = upright(0.1);
    document["bodies"]["third"]["place"] =
        json!({"put": "hinge", "at": "second.tip", "turn": upright(1.3)});
    let joint =
        |of: [&str; 2], at: &str| json!({"revolute": {"between": of, "at": at, "axis": [0, 0, 1]}});
    document["joints"]["knee"] = joint(["third", "second"], "second.tip");
    document["joints"]["base"] = joint(["third", "ground"], "third.root");
    document["joints"]["root"]["revolute"]["start"] = json!({"turn": {"angle": 0.2, "rate": 3}});
    document["variables"] = json!({
        "angle": {"path": "/joints/root/revolute/start/turn/angle", "lower": 0, "upper": 0.5},
        "rate": {"path": "/joints/root/revolute/start/turn/rate", "lower": 0, "upper": 5},
        "thickness": {"path": "/bodies/first/elements/structure/thickness", "lower": 0.01, "upper": 0.1},
    });
    let problem = parsed(&document);
    let x = problem.start();
    let scene = problem.scene(&x);
    assert!(scene.unstarted.is_none(), "{:?}", scene.unstarted);
    let (model, numbering) = (&scene.model, Numbering::new(&scene.model));
    let start = nearest(model).expect("closes");
    let mut motions = Vec::new();
    BodyMotion::all(&numbering, &start.q, &start.v, &mut motions);
    for body in &model.flexible {
        let energy = strain_energy(body, &motions);
        assert!(energy < 1e-12, "{energy:e} J");
    }
    assert!((motions[0].omega.norm() - 3.0).abs() < 1e-9);
    scaled_gradients_are_exact(&problem, &x, &json!("a loop of plates"));
}

/// A torque at the edge of a cantilever plate deflects it by M L² / 2 E I; derivatives by the torque are exact.
#[test]
fn a_torque_bends_a_plate() {
    let text = include_str!("../../problems/extreme/cantilever_plate.json");
    let mut document: Value = serde_json::from_str(text).expect("valid JSON");
    let (thickness, moment) = (1.0, 1.0);
    document["bodies"]["plate"]["elements"]["structure"]["thickness"] = json!(thickness);
    document["loads"] = json!({"turn": {"torque": {
        "body": "plate", "point": "end", "direction": [0, -1, 0], "magnitude": moment
    }}});
    document["variables"]["moment"] =
        json!({"path": "/loads/turn/torque/magnitude", "lower": 0, "upper": 2});
    document["functions"]
        .as_object_mut()
        .expect("functions")
        .remove("kinetic energy");
    let stiffness = 1e9 * 0.25 * f64::powi(thickness, 3) / 12.0;
    let exact = moment / (2.0 * stiffness);
    let found = values(&document)[0];
    assert!((found - exact).abs() < 1e-6 * exact, "{found} {exact}");
    let problem = parsed(&document);
    scaled_gradients_are_exact(&problem, &problem.start(), &json!("a torque"));
}
