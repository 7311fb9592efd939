//! Joints that close turned or tilted at an event, joints that open under the feedback of a controller, and what is told of
//! such motions.

use super::phases::{jumps, number, simulated};
use crate::reference::documents::problem;
use crate::reference::gradients::gradients_of_expressions_are_exact as gradients_are_exact;
use flexbody_driver::check;
use flexbody_mathematics::math::rotation::{from_axis_angle, matrix, of_matrix};
use nalgebra::Vector3;
use serde_json::Value;

fn hinge(axis: Value) -> Value {
    json!({"revolute": {"between": ["disk", "ground"], "at": [0, 0, 0], "axis": axis}})
}

fn last(quantity: Value) -> Value {
    json!({ "final": quantity })
}

/// A disk that turns about one hinge, until another one holds it.
fn disk(spin: f64, loads: Value) -> Value {
    json!({
        "version": 1, "name": "disk", "gravity": [0, 0, 0],
        "bodies": {"disk": {"mass": 5, "inertia": {"xx": 1, "yy": 1, "zz": 0.7}, "velocity": {"angular": [0, 0, spin]}}},
        "joints": {"first": hinge(json!([0, 0, 1])), "second": hinge(json!([0, 0, 1]))},
        "loads": loads,
        "simulation": {"duration": 1, "tolerance": 1e-11},
        "events": {"swap": {"when": {"time": 0.5}, "off": ["first"], "on": ["second"]}},
        "functions": {"angle": last(json!({"angle": {"joint": "second"}}))},
        "variables": {
            "spin": {"path": "/bodies/disk/velocity/angular/2"},
            "time": {"path": "/events/swap/when/time", "lower": 0.1}
        }
    })
}

/// A spring of a hinge that closes after three turns is not wound by them: x of the oscillator from x = 0, and x is the angle.
#[test]
fn angles_count_from_where_a_joint_closes() {
    let spin = 40.0;
    let spring = json!({"torsion_spring": {"joint": "second", "stiffness": 3, "rest_angle": 0.5}});
    let controller =
        json!({"controller": {"joint": "second", "reference": 0.5, "proportional": 3}});
    for (load, quantity, sign) in [
        (spring, json!({"spring_torque": {"load": "load"}}), 3.0),
        (
            controller,
            json!({"tracking_error": {"load": "load"}}),
            -1.0,
        ),
    ] {
        let mut document = disk(spin, json!({ "load": load }));
        document["functions"]["load"] = last(quantity);
        let own = problem(&document);
        let at = simulated(&own);
        let rate = (3.0_f64 / 0.7).sqrt();
        let (s, c) = (rate * 0.5).sin_cos();
        let angle = 0.5 * (1.0 - c) + spin / rate * s;
        let found = ["angle", "load"].map(|name| at.value(number(&own, name)));
        assert!((found[0] - angle).abs() < 1e-8 * angle, "{found:?} {angle}");
        let load = sign * (angle - 0.5);
        assert!(
            (found[1] - load).abs() < 1e-8 * load.abs(),
            "{found:?} {load}"
        );
        gradients_are_exact(&own, &load.into());
    }
}

/// A body that tumbles is caught by a hinge that lies oblique in both bodies then: its angle is the integral of its rate, also
/// after a later event.
#[test]
fn the_angle_of_a_hinge_that_closes_tilted_grows_by_its_rate() {
    let spring = json!({"torsion_spring": {"joint": "second", "stiffness": 3}});
    let mut document = disk(2.0, json!({ "load": spring }));
    document["joints"] = json!({"first": {"spherical": {"between": ["disk", "ground"], "at": [0, 0, 0]}},
        "second": hinge(json!([0.5, 0.3, 1]))});
    document["bodies"]["disk"]["velocity"]["angular"] = json!([2, -1, 3]);
    document["events"]["mark"] = json!({"when": {"time": 0.7}});
    let rate = json!({"angle_rate": {"joint": "second"}});
    document["functions"]["grown"] =
        json!({"mean": {"of": rate, "during": {"from": {"event": "swap"}}}});
    document["functions"]["torque"] = last(json!({"spring_torque": {"load": "load"}}));
    let own = problem(&document);
    let at = simulated(&own);
    let [angle, grown, torque] =
        ["angle", "grown", "torque"].map(|name| at.value(number(&own, name)));
    assert!(
        angle.abs() > 0.3 && (angle - 0.5 * grown).abs() < 1e-9,
        "{angle} {grown}"
    );
    assert!((torque - 3.0 * angle).abs() < 1e-9, "{torque} {angle}");
    gradients_are_exact(&own, &json!("tilted"));
}

/// When a joint opens, feedback by it ends: the effort is that of the errors that are left.
#[test]
fn feedback_ends_where_its_joint_opens() {
    let bar = |place: Value| {
        json!({"shape": {"box": {"size": [1, 0.1, 0.2]}}, "mass": 2,
            "points": {"a": [-0.5, 0, 0], "b": [0.5, 0, 0]}, "place": place})
    };
    let document = json!({
        "version": 1, "name": "arms",
        "bodies": {"upper": bar(json!({"put": "a"})), "lower": bar(json!({"put": "a", "at": "upper.b"}))},
        "joints": {
            "shoulder": {"revolute": {"between": ["upper", "ground"], "at": "upper.a", "axis": [0, 0, 1]}},
            "elbow": {"revolute": {"between": ["lower", "upper"], "at": "upper.b", "axis": [0, 0.3, 1]}}
        },
        "loads": {"servo": {"controller": {"joint": "shoulder", "proportional": 30, "derivative": 2,
            "feedback": [{"joint": "elbow", "proportional": 9, "derivative": 1}]}}},
        "simulation": {"duration": 0.6},
        "events": {"opens": {"when": {"time": 0.3}, "off": ["elbow"]}},
        "functions": {
            "effort": last(json!({"effort": {"load": "servo"}})),
            "angle": last(json!({"angle": {"joint": "shoulder"}})),
            "rate": last(json!({"angle_rate": {"joint": "shoulder"}}))
        },
        "variables": {
            "gain": {"path": "/loads/servo/controller/feedback/0/proportional"},
            "time": {"path": "/events/opens/when/time", "lower": 0.1}
        }
    });
    let own = problem(&document);
    let at = simulated(&own);
    let [effort, angle, rate] =
        ["effort", "angle", "rate"].map(|name| at.value(number(&own, name)));
    let left = -30.0 * angle - 2.0 * rate;
    assert!((effort - left).abs() < 1e-9 * left.abs(), "{effort} {left}");
    gradients_are_exact(&own, &json!("opens"));
}

/// The states of a controller have no kinetic energy.
#[test]
fn a_controller_that_goes_off_takes_no_kinetic_energy() {
    let servo = json!({"joint": "first", "reference": 1, "proportional": 3, "integral": 40, "motor": {"lag": 0.02}});
    let mut document = disk(0.0, json!({"servo": {"controller": servo}}));
    document["events"]["swap"] = json!({"when": {"time": 0.5}, "off": ["servo"]});
    let found = jumps(&simulated(&problem(&document)));
    let [[before, after]] = found[..] else {
        panic!("{found:?}");
    };
    assert!(
        before > 1.0 && (before - after).abs() < 1e-12 * before,
        "{before} {after}"
    );
}

/// Of a function that a phase spoils the reason is told. One that no function of the whole motion needs spoils nothing.
#[test]
fn reactions_that_joints_share_are_told() {
    let mut document = disk(1.0, json!({}));
    document["joints"]["second"]["revolute"]["at"] = json!([0, 0, 1]);
    document["events"]["swap"] = json!({"when": {"time": 0.5}, "on": ["second"]});
    let force = json!({"joint_force": {"joint": "first", "direction": [0, 0, 1]}});
    document["functions"] = json!({"before": {"value": {"at": {"event": "swap"}, "of": force}}});
    let own = problem(&document);
    assert!(simulated(&own).value(number(&own, "before")).is_finite());
    let of = check(&own, &own.start()).expect("derivatives");
    assert!(of.iter().all(|d| d.adjoint.is_finite()), "{of:?}");

    document["functions"]["after"] = last(force);
    let own = problem(&document);
    let text = simulated(&own).not_finite_value(&own, number(&own, "after"));
    let parts = ["after swap", "joint \"first\" shares it with others"];
    assert!(parts.iter().all(|part| text.contains(part)), "{text}");
}

/// Euler parameters from a matrix are those of its rotation, up to their sign, whichever of them is the largest.
#[test]
fn euler_parameters_follow_from_a_matrix() {
    let axes = [[1.0, 0.2, -0.1], [0.1, -1.0, 0.3], [0.2, 0.1, 1.0]];
    for (axis, angle) in axes
        .iter()
        .flat_map(|axis| [0.0, 0.4, 3.1, -2.9].map(|angle| (axis, angle)))
    {
        let p = from_axis_angle(&Vector3::from_row_slice(axis), angle);
        let found = of_matrix(&matrix(&p));
        let cosine: f64 = p.iter().zip(&found).map(|(a, b)| a * b).sum();
        assert!((cosine.abs() - 1.0).abs() < 1e-14, "{p:?} {found:?}");
    }
}
