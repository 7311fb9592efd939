//! Springs of rest length zero, whose ends may meet: the force −(k + k3 l²) d is smooth there.
//!
//! A mass on such a spring has x(t) = x0 cos ωt + v/ω sin ωt in each direction, ω = √(k/m). With k3 alone and v at x = 0 it
//! turns round where ¼ k3 x⁴ = ½ m v².

use crate::reference::documents::{problem as parsed, run};
use crate::reference::gradients::gradients_are_exact;
use flexbody_mathematics::math::rotation::{from_axis_angle, matrix};
use flexbody_problem::Problem;
use nalgebra::Vector3;
use serde_json::Value;

/// A mass of 2 kg at `at` with a velocity, on a spring to the origin.
fn scene(at: [f64; 3], velocity: [f64; 3], simulation: &Value) -> Value {
    let position = |direction: [f64; 3]| json!({"final": {"position": {"body": "mass", "direction": direction}}});
    json!({
        "version": 1, "name": "mass", "gravity": [0, 0, 0],
        "bodies": {"mass": {"shape": {"sphere": {"radius": 0.1}}, "mass": 2, "place": {"at": at},
                            "velocity": {"linear": velocity}}},
        "loads": {"spring": {"spring": {"between": ["mass", "ground"], "at": {"a": [0, 0, 0], "b": [0, 0, 0]},
                                        "rest_length": 0, "stiffness": 50}}},
        "simulation": simulation,
        "functions": {"x": position([1.0, 0.0, 0.0]), "y": position([0.0, 1.0, 0.0]), "z": position([0.0, 0.0, 1.0]),
                      "force": {"final": {"spring_force": {"load": "spring"}}},
                      "length": {"final": {"spring_length": {"load": "spring"}}}, "energy": {"final": {"energy": "total"}}}
    })
}

fn methods() -> [Value; 4] {
    [
        json!({"duration": 1.3}),
        json!({"duration": 1.3, "tolerance": 1e-9, "method": {"radau": {"stages": 3}}}),
        json!({"duration": 1.3, "tolerance": 1e-9, "method": {"radau": {"stages": 2}}}),
        json!({"duration": 1.3, "steps": 300, "method": "dop853"}),
    ]
}

fn values(document: &Value) -> Vec<f64> {
    let motion = run(document);
    (0..6).map(|k| motion.at.function(k).value).collect()
}

/// From the place of the other end, through it and around it; in the same order of bodies and the other.
#[test]
fn masses_swing_through_the_other_end() {
    let omega = 5.0_f64;
    let (sin, cos) = (1.3 * omega).sin_cos();
    for (i, (at, v)) in [
        ([0.0, 0.0, 0.0], [1.0, 0.0, 0.0]),
        ([0.0, 0.0, 0.0], [0.3, -0.4, 1.2]),
        ([0.5, 0.0, 0.0], [0.0, 0.0, 0.0]),
        ([0.1, 0.2, -0.3], [0.0, 2.0, 1.0]),
        ([0.0, 0.0, 0.0], [0.0, 0.0, 0.0]),
        ([0.0, 0.4, 0.0], [1e-9, 0.0, 0.0]),
    ]
    .into_iter()
    .enumerate()
    {
        for simulation in [&methods()[i % 4], &methods()[(i + 1) % 4]] {
            let mut document = scene(at, v, simulation);
            if i % 2 == 1 {
                document["loads"]["spring"]["spring"]["between"] = json!(["ground", "mass"]);
            }
            let found = values(&document);
            let expected: Vec<f64> = (0..3).map(|k| at[k] * cos + v[k] / omega * sin).collect();
            for k in 0..3 {
                assert!(
                    (found[k] - expected[k]).abs() < 1e-6,
                    "{found:?} {expected:?} {simulation}"
                );
            }
            let length = expected.iter().map(|x| x * x).sum::<f64>().sqrt();
            assert!((found[4] - length).abs() < 1e-6 && (found[3] - 50.0 * length).abs() < 1e-4);
        }
    }
}

/// Two free masses that start at one place part by the reduced mass; a cubic spring turns them round at the closed form.
#[test]
fn two_masses_and_cubic_springs() {
    let mut document = scene([0.0, 0.0, 0.0], [3.0, 0.0, 0.0], &methods()[0]);
    document["bodies"]["other"] = json!({"shape": {"sphere": {"radius": 0.1}}, "mass": 1});
    document["loads"]["spring"]["spring"]["between"] = json!(["mass", "other"]);
    let omega = (50.0_f64 * 1.5).sqrt();
    let found = values(&document);
    let expected = 3.0 / omega * (1.3 * omega).sin();
    assert!(
        (found[4] - expected.abs()).abs() < 1e-6,
        "{found:?} {expected}"
    );

    let mut document = scene([0.0, 0.0, 0.0], [0.0, 3.0, 0.0], &methods()[1]);
    let spring = &mut document["loads"]["spring"]["spring"];
    (spring["stiffness"], spring["cubic"]) = (json!(0), json!(400));
    document["functions"]["x"] =
        json!({"ks": {"rho": 1e7, "of": {"position": {"body": "mass", "direction": [0, 1, 0]}}}});
    let motion = run(&document);
    let most = motion.at.function(0).maximum.expect("an aggregate").value;
    let turn = (2.0 * 2.0 * 9.0 / 400.0_f64).powf(0.25);
    assert!((most / turn - 1.0).abs() < 1e-5, "{most} {turn}");
    assert!((motion.at.function(5).value / 9.0 - 1.0).abs() < 1e-6);
}

/// Derivatives of motions from and through the other end, by both stiffnesses and the velocity.
#[test]
fn derivatives_are_exact_where_ends_meet() {
    for simulation in [
        json!({"duration": 0.9, "steps": 40, "method": "dop853"}),
        json!({"duration": 0.9, "steps": 50, "method": {"radau": {"stages": 2}}}),
        json!({"duration": 0.9, "steps": 80, "method": {"bdf": {"order": 2}}}),
    ] {
        let mut document = scene([0.0, 0.0, 0.0], [0.3, -0.4, 1.2], &simulation);
        document["loads"]["spring"]["spring"]["cubic"] = json!(30);
        document["variables"] = json!({
            "stiffness": {"path": "/loads/spring/spring/stiffness", "lower": 0, "upper": 1e3},
            "cubic": {"path": "/loads/spring/spring/cubic", "lower": 0, "upper": 1e3},
            "mass": {"path": "/bodies/mass/mass", "lower": 0.1, "upper": 1e3},
            "speed": {"path": "/bodies/mass/velocity/linear/0", "lower": -9, "upper": 9}
        });
        gradients_are_exact(&parsed(&document), &simulation);
    }
}

/// A rest length or a damper has a direction, which ends at one place do not give.
#[test]
fn other_springs_whose_ends_meet_are_refused() {
    for key in ["rest_length", "damping"] {
        let mut document = scene([0.0, 0.0, 0.0], [1.0, 0.0, 0.0], &methods()[0]);
        document["loads"]["spring"]["spring"][key] = json!(0.1);
        let faults = Problem::parse(&document.to_string(), "mass.json", &[]).expect_err("a fault");
        let text = faults.to_string();
        assert!(
            text.contains("ends at the same place") && text.contains("damping"),
            "{text}"
        );
    }
}

/// Ends are at one place where they are but for round-off: the end of a body that is turned about an oblique axis, and the same
/// place in ground axes by another sum.
#[test]
fn ends_that_meet_but_for_round_off_are_refused() {
    let (at, end) = (Vector3::new(0.3, 0.1, -0.2), Vector3::new(0.5, 0.1, 0.07));
    let turned = from_axis_angle(&Vector3::new(1.0, 2.0, 3.0), 0.7);
    let place: Vec<f64> = (at + matrix(&turned) * end).iter().copied().collect();
    for (kind, mut load) in [
        ("spring", json!({"rest_length": 0.3, "stiffness": 50})),
        (
            "stop",
            json!({"lower": 0.3, "stiffness": 50, "width": 0.01}),
        ),
        ("controller", json!({"reference": 0.3, "proportional": 50})),
    ] {
        let mut refused = |apart: f64| {
            let mut other = place.clone();
            other[0] += apart;
            load["between"] = json!(["body", "ground"]);
            load["at"] = json!({"a": end.as_slice(), "b": other});
            let document = json!({
                "version": 1, "name": "turned",
                "bodies": {"body": {"mass": 2, "inertia": {"xx": 1, "yy": 1, "zz": 1},
                    "place": {"at": at.as_slice(), "turn": {"axis": [1, 2, 3], "angle": 0.7}}}},
                "loads": {"load": {(kind): load}},
                "simulation": {"duration": 0.1}
            });
            let faults = Problem::parse(&document.to_string(), "turned.json", &[]).err();
            faults.is_some_and(|faults| faults.to_string().contains("ends at the same place"))
        };
        assert!(refused(0.0) && refused(1e-15) && !refused(1e-9), "{kind}");
    }
}
