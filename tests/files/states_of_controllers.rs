//! States of controllers where bodies do not show them: machines that a drive moves or holds, and heavy ones. Closed forms by
//! every method, in other units, with and without derivatives.

use super::machines_at_rest::hinge;
use crate::reference::documents::{in_units, problem as parsed, values};
use crate::reference::gradients::gradients_are_exact;
use serde_json::Value;
use std::f64::consts::PI;

/// An arm on an axle with a controller; a drive moves it if there is one.
fn arm(controller: Value, drive: Value, duration: f64) -> Value {
    let mut document = json!({
        "version": 1, "name": "arm", "gravity": [0, 0, 0],
        "bodies": {"arm": {"mass": 5, "inertia": {"xx": 0.1, "yy": 0.2, "zz": 0.2}}},
        "joints": {"axle": hinge(["arm", "ground"], json!([0, 0, 0]))},
        "loads": {"servo": {"controller": controller}},
        "simulation": {"duration": duration},
        "functions": {
            "effort": {"final": {"effort": {"load": "servo"}}},
            "square": {"mean_square": {"effort": {"load": "servo"}}}
        }
    });
    document["loads"]["servo"]["controller"]["joint"] = json!("axle");
    if !drive.is_null() {
        document["drives"] = json!({"drive": {"joint": "axle", "turn": drive}});
    }
    document
}

/// Settings that choose their steps.
fn methods() -> [Value; 3] {
    [
        json!({}),
        json!({"tolerance": 1e-9}),
        json!({"method": {"radau": {"stages": 3}}, "tolerance": 1e-7}),
    ]
}

fn assert_values(document: &Value, expected: [f64; 2], part: f64) {
    for settings in methods() {
        for with_variable in [false, true] {
            let mut own = document.clone();
            for (key, value) in settings.as_object().expect("settings") {
                own["simulation"][key] = value.clone();
            }
            if with_variable {
                own["variables"] =
                    json!({"mass": {"path": "/bodies/arm/mass", "lower": 1e-6, "upper": 1e9}});
            }
            for (found, expected) in values(&own).iter().zip(expected) {
                let off = (found - expected).abs();
                assert!(
                    off <= part * expected.abs(),
                    "{settings} {with_variable}: {found} {expected}"
                );
            }
        }
    }
}

/// T Ḟ = p e − F at a constant error e: F = p e (1 − e^(−t/T)).
#[test]
fn a_lag_settles_on_a_driven_joint() {
    for lag in [0.004, 0.1] {
        let servo = json!({
            "reference": {"polynomial": [0.1, 1]}, "proportional": 100, "motor": {"lag": lag}
        });
        let document = arm(servo, json!({"rate": 1}), 2.0);
        let past = |k: f64| 1.0 - f64::exp(-k * 2.0 / lag);
        let square = 100.0 * (2.0 - 2.0 * lag * past(1.0) + 0.5 * lag * past(2.0)) / 2.0;
        assert_values(&document, [10.0 * past(1.0), square], 1e-5);
    }
}

/// F = A (sin ωt − ωT cos ωt + ωT e^(−t/T)) / (1 + ω²T²) for T Ḟ = A sin ωt − F, whatever the wheel weighs and whatever the units.
#[test]
fn a_lag_follows_a_wave_beside_any_inertia() {
    let (lag, omega): (f64, f64) = (0.02, 2.0 * PI);
    let time: f64 = 1.3;
    let wave = |t: f64| {
        let late = omega * lag;
        ((omega * t).sin() - late * (omega * t).cos() + late * (-t / lag).exp())
            / (1.0 + late * late)
    };
    // Simpson's rule.
    let n = 20_000;
    let weight = |k: usize| match k {
        0 => 1.0,
        k if k == n => 1.0,
        k if k % 2 == 1 => 4.0,
        _ => 2.0,
    };
    let at = |k: usize| time * k as f64 / n as f64;
    let sum: f64 = (0..=n).map(|k| weight(k) * wave(at(k)).powi(2)).sum();
    let square = sum / (3.0 * n as f64);
    for amplitude in [1.0, 10.0] {
        let servo = json!({
            "feed_forward": {"harmonic": {"amplitude": amplitude, "frequency": 1}}, "motor": {"lag": lag}
        });
        for inertia in [0.2, 1e3, 1e7] {
            let mut document = arm(servo.clone(), Value::Null, time);
            document["bodies"]["arm"]["inertia"] =
                json!({"xx": inertia, "yy": inertia, "zz": inertia});
            let expected = [amplitude * wave(time), amplitude * amplitude * square];
            assert_values(&document, expected, 1e-5);
            let places = [
                ("/bodies/arm/mass", 0, 1),
                ("/bodies/arm/inertia/xx", 2, 1),
                ("/bodies/arm/inertia/yy", 2, 1),
                ("/bodies/arm/inertia/zz", 2, 1),
                (
                    "/loads/servo/controller/feed_forward/harmonic/amplitude",
                    2,
                    1,
                ),
            ];
            let other = in_units(&document, (1e3, 1e-3), &places);
            let unit = 1e3_f64;
            assert_values(
                &other,
                [expected[0] * unit, expected[1] * unit * unit],
                1e-5,
            );
        }
    }
}

/// The integral of an error that a drive makes: F = p e + k ∫ e with e = c − t.
#[test]
fn an_integral_grows_on_a_driven_joint() {
    let servo = json!({"reference": 0.4, "proportional": 3, "integral": 50});
    let document = arm(servo, json!({"rate": 1}), 1.5);
    let effort = |t: f64| 3.0 * (0.4 - t) + 50.0 * (0.4 * t - 0.5 * t * t);
    // A polynomial of degree 4: Boole's rule is exact.
    let weights = [7.0, 32.0, 12.0, 32.0, 7.0];
    let nodes = weights.iter().enumerate();
    let square = nodes.map(|(k, w)| w / 90.0 * effort(1.5 * k as f64 / 4.0).powi(2));
    assert_values(&document, [effort(1.5), square.sum()], 1e-6);
}

/// Without an effort there is no size of one, and a state that stays zero takes no steps.
#[test]
fn states_that_stay_zero_cost_nothing() {
    let steps = |controller: Value| {
        let document = arm(controller, json!({"rate": 1}), 2.0);
        crate::reference::documents::run(&document)
            .at
            .run
            .grid
            .steps()
    };
    let idle = json!({"feed_forward": 0, "motor": {"lag": 1e-3}});
    assert!(steps(idle) < 12);
    // The error is round-off of the drive.
    let follows =
        json!({"reference": {"polynomial": [0, 1]}, "proportional": 1e3, "motor": {"lag": 0.1}});
    assert!(steps(follows) < 60);
}

/// Two links with an integral on a hinge that rests far from where it was placed. Its vibrations do not depend on which body is the
/// first, and without a gain of the integral they are those of a motor with the same effort.
#[test]
fn vibrations_about_a_turned_hinge_are_those_of_its_motor() {
    let of = |between: [&str; 2], sign: f64, integral: Value, forward: f64| {
        let mut servo = json!({
            "joint": "knee", "reference": 0.8 * sign, "proportional": 50, "derivative": 2, "feed_forward": forward
        });
        if !integral.is_null() {
            servo["integral"] = integral;
        }
        let bar = |length: f64| json!({"box": {"size": [length, 0.1, 0.1]}});
        json!({
            "version": 1, "name": "two", "gravity": [0.7, -9.81, 0.4], "analysis": "rest",
            "bodies": {
                "thigh": {"shape": bar(0.4), "mass": 2, "points": {"e": [0.2, 0, 0]}, "place": {"at": [0.2, 0, 0]}},
                "shank": {"shape": bar(0.5), "mass": 1, "points": {"a": [-0.25, 0, 0]}, "place": {"put": "a", "at": "thigh.e"}}
            },
            "joints": {
                "hip": hinge(["thigh", "ground"], json!([0, 0, 0])),
                "knee": {"revolute": {"between": between, "at": "shank.a", "axis": [0, 1, 1]}}
            },
            "loads": {
                "spring": {"torsion_spring": {"joint": "hip", "stiffness": 100}},
                "servo": {"controller": servo}
            },
            "functions": {
                "f1": {"frequency": {"mode": 1, "damped": true}}, "z1": {"damping_ratio": {"mode": 1}},
                "f2": {"frequency": {"mode": 2, "damped": true}},
                "effort": {"final": {"effort": {"load": "servo"}}}
            },
            "variables": {"mass": {"path": "/bodies/shank/mass", "lower": 0.5, "upper": 2}}
        })
    };
    let near = |a: &[f64], b: &[f64], part: f64| {
        for (a, b) in a.iter().zip(b) {
            assert!((a - b).abs() < part * b.abs(), "{a} {b}");
        }
    };
    let first = ["shank", "thigh"];
    let with = values(&of(first, 1.0, json!(100), 0.0));
    let other = values(&of(["thigh", "shank"], -1.0, json!(100), 0.0));
    near(&other[..3], &with[..3], 1e-8);
    let document = of(first, 1.0, json!(100), 0.0);
    gradients_are_exact(&parsed(&document), &json!("a turned hinge"));
    // A weak integral only holds the effort.
    let weak = values(&of(first, 1.0, json!(1e-7), 0.0));
    let motor = values(&of(first, 1.0, Value::Null, weak[3]));
    near(&weak[..3], &motor[..3], 1e-6);
}

/// A slide far from where it began is no singular position: the same motion as about a joint a metre away.
#[test]
fn a_slide_may_begin_near_the_origin() {
    let slider = |at: f64, motor: Value| {
        json!({
            "version": 1, "name": "slider", "gravity": [0, 0, 0],
            "bodies": {"block": {"shape": {"sphere": {"radius": 0.1}}, "mass": 0.3}},
            "joints": {"slide": {"prismatic": {"between": ["block", "ground"], "at": [at, 0, 0], "axis": [1, 0, 0],
                                               "start": {"slide": {"displacement": -0.005, "rate": -0.5}}}}},
            "loads": {"servo": {"controller": {"joint": "slide", "proportional": 200, "derivative": 8, "reference": 0.3, "motor": motor}}},
            "simulation": {"duration": 1, "tolerance": 1e-11},
            "functions": {
                "slide": {"final": {"slide": {"joint": "slide"}}},
                "rate": {"final": {"slide_rate": {"joint": "slide"}}},
                "effort": {"final": {"effort": {"load": "servo"}}},
                "acceleration": {"final": {"acceleration": {"body": "block", "direction": [1, 0, 0]}}}
            }
        })
    };
    for motor in [
        json!({"gear_ratio": 5, "lag": 0.06, "rotor_inertia": 0.02}),
        json!({"lag": 0.06}),
    ] {
        let [near, far] = [0.0, 1.0].map(|at| values(&slider(at, motor.clone())));
        for (near, far) in near.iter().zip(&far) {
            assert!(
                (near - far).abs() <= 1e-7 * far.abs(),
                "{motor}: {near} {far}"
            );
        }
    }
}
