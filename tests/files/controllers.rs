//! Controllers with their motors: closed forms of step responses and limits, the balance of energy, derivatives by every
//! method, and families of scenes.

use super::machines_at_rest::{fault, hinge, rod};
use crate::reference::documents::{problem as parsed, values};
use crate::reference::gradients::gradients_are_exact;
use nalgebra::{DMatrix, DVector};
use serde_json::Value;

fn assert_near(found: f64, expected: f64, part: f64) {
    let off = (found - expected).abs();
    assert!(off <= part * expected.abs().max(1e-3), "{found} {expected}");
}

fn final_of(quantity: Value) -> Value {
    json!({ "final": quantity })
}

const ABOUT: f64 = 0.7;

/// A disk on an axle with a controller.
fn disk(controller: Value, duration: f64) -> Value {
    let mut own = controller;
    own["joint"] = json!("axle");
    json!({
        "version": 1, "name": "disk", "gravity": [3, -9.81, 1],
        "bodies": {"disk": {"mass": 5, "inertia": {"xx": 1, "yy": 1, "zz": ABOUT}}},
        "joints": {"axle": hinge(["disk", "ground"], json!([0, 0, 0]))},
        "loads": {"servo": {"controller": own}},
        "simulation": {"duration": duration, "tolerance": 1e-11},
        "functions": {
            "angle": final_of(json!({"angle": {"joint": "axle"}})),
            "rate": final_of(json!({"angle_rate": {"joint": "axle"}})),
            "effort": final_of(json!({"effort": {"load": "servo"}})),
            "error": final_of(json!({"tracking_error": {"load": "servo"}}))
        },
        "variables": {
            "inertia": {"path": "/bodies/disk/inertia/zz", "lower": 0.1, "upper": 1.9}
        }
    })
}

/// The state e^(A t) x of a linear system.
fn linear<const N: usize>(rows: [[f64; N]; N], start: [f64; N], time: f64) -> DVector<f64> {
    let a = DMatrix::from_fn(N, N, |i, k| rows[i][k] * time);
    a.exp() * DVector::from_row_slice(&start)
}

/// Step responses against the exponential of the matrix: the coordinates are what is missing to the final state.
#[test]
fn step_responses_are_those_of_linear_systems() {
    let (p, d, k, r, lag) = (8.0, 1.5, 6.0, 0.4, 0.08);
    let time = 1.3;
    let pd = json!({"reference": r, "proportional": p, "derivative": d});
    let found = values(&disk(pd.clone(), time));
    let x = linear([[0.0, 1.0], [-p / ABOUT, -d / ABOUT]], [-r, 0.0], time);
    assert_near(found[0], r + x[0], 1e-9);
    assert_near(found[1], x[1], 1e-9);
    assert_near(found[2], -p * x[0] - d * x[1], 1e-9);
    assert_near(found[3], -x[0], 1e-9);

    let mut pid = pd.clone();
    pid["integral"] = json!(k);
    let found = values(&disk(pid.clone(), time));
    let rows = [
        [0.0, 1.0, 0.0],
        [-p / ABOUT, -d / ABOUT, 1.0 / ABOUT],
        [-k, 0.0, 0.0],
    ];
    let x = linear(rows, [-r, 0.0, 0.0], time);
    assert_near(found[0], r + x[0], 1e-9);
    assert_near(found[2], -p * x[0] - d * x[1] + x[2], 1e-9);

    pid["motor"] = json!({"lag": lag});
    let found = values(&disk(pid, time));
    let rows = [
        [0.0, 1.0, 0.0, 0.0],
        [0.0, 0.0, 0.0, 1.0 / ABOUT],
        [-k, 0.0, 0.0, 0.0],
        [-p / lag, -d / lag, 1.0 / lag, -1.0 / lag],
    ];
    let x = linear(rows, [-r, 0.0, 0.0, 0.0], time);
    assert_near(found[0], r + x[0], 1e-9);
    assert_near(found[2], x[3], 1e-9);
}

/// At its limit of torque a motor accelerates evenly, and along its curve it nears the speed without load.
#[test]
fn limits_of_a_motor_shape_the_start() {
    let time = 0.5;
    let demand = json!({"torque": 2.0, "gear_ratio": 3.0});
    let large = json!({"feed_forward": 6e4, "motor": demand});
    let found = values(&disk(large, time));
    assert_near(found[1], 6.0 / ABOUT * time, 1e-9);
    assert_near(found[2], 6.0, 1e-9);

    let curve = json!({"gear_ratio": 3.0, "curve": {"stall_torque": 2.0, "no_load_speed": 12.0}});
    let found = values(&disk(json!({"feed_forward": 6e4, "motor": curve}), time));
    // J ω' = 6 (1 − ω / 4)
    let speed = 4.0 * (1.0 - (-6.0 / 4.0 / ABOUT * time).exp());
    assert_near(found[1], speed, 1e-9);

    let power = json!({"power": 5.0});
    let found = values(&disk(json!({"feed_forward": 300.0, "motor": power}), 2.0));
    // Most of the time the power is at its limit.
    assert!((found[1] * found[2] - 5.0).abs() < 1e-6, "{found:?}");
    assert_near(0.5 * ABOUT * found[1] * found[1], 10.0, 0.02);
}

/// Without anti-windup the integral of a motor at its limit grows, and the disk swings beyond the reference.
#[test]
fn anti_windup_lessens_the_swing_beyond() {
    let mut file = disk(
        json!({
            "reference": 2.0, "proportional": 20, "derivative": 6, "integral": 15, "motor": {"torque": 1.5}
        }),
        6.0,
    );
    file["functions"] = json!({"most": {"ks": {"of": {"angle": {"joint": "axle"}}, "rho": 2000}}});
    let before = values(&file)[0];
    file["loads"]["servo"]["controller"]["anti_windup"] = json!(0.3);
    let after = values(&file)[0];
    assert!(before > 2.5 && after < 2.2, "{before} {after}");
}

/// A turn, and a length that stands for a metre; whether names come in another order, and sides of the elbow are swapped.
#[derive(Clone, Copy)]
struct Family {
    turn: f64,
    mirror: f64,
    unit: f64,
    reordered: bool,
    swapped: bool,
}

const PLAIN: Family = Family {
    turn: 0.0,
    mirror: 1.0,
    unit: 1.0,
    reordered: false,
    swapped: false,
};

/// An arm of two links on a slide, with every option of controllers.
fn arm(own: Family, method: Value) -> Value {
    let (u, oblique) = (own.unit, [2.0, -1.0, 1.5]);
    let turn = nalgebra::Rotation3::from_axis_angle(
        &nalgebra::Unit::new_normalize(nalgebra::Vector3::from(oblique)),
        own.turn,
    );
    let vector = |x: [f64; 3], scale: f64| {
        let [x, y, z] = x;
        let moved = turn * nalgebra::Vector3::new(x, own.mirror * y, z) * scale;
        json!([moved.x, moved.y, moved.z])
    };
    // Axes are axial vectors: a mirror turns them round.
    let axis = |x: [f64; 3]| {
        let [x, y, z] = x;
        let moved = match own.mirror < 0.0 {
            true => turn * nalgebra::Vector3::new(-x, y, -z),
            false => turn * nalgebra::Vector3::new(x, y, z),
        };
        json!([moved.x, moved.y, moved.z])
    };
    let inertia = |a: f64, b: f64, c: f64| {
        let s = u * u;
        json!({"xx": a * s, "yy": b * s, "zz": c * s})
    };
    let place =
        |x: [f64; 3]| json!({"at": vector(x, u), "turn": {"axis": oblique, "angle": own.turn}});
    let bodies = [
        (
            "carriage",
            json!({"mass": 4, "inertia": inertia(0.1, 0.1, 0.1), "place": place([0.0, 0.0, 0.0])}),
        ),
        (
            "upper",
            json!({"mass": 2, "inertia": inertia(0.01, 0.1, 0.105), "place": place([0.4, 0.1, 0.0])}),
        ),
        (
            "fore",
            json!({"mass": 1, "inertia": inertia(0.005, 0.04, 0.044), "place": place([1.1, 0.3, 0.1])}),
        ),
    ];
    let (elbow, way) = match own.swapped {
        false => (["fore", "upper"], 1.0),
        true => (["upper", "fore"], -1.0),
    };
    let joints = [
        (
            "rail",
            json!({"prismatic": {"between": ["carriage", "ground"], "at": vector([0.0, 0.0, 0.0], u), "axis": vector([1.0, 0.2, 0.0], 1.0)}}),
        ),
        (
            "shoulder",
            json!({"revolute": {"between": ["upper", "carriage"], "at": vector([0.0, 0.1, 0.0], u), "axis": axis([0.1, 0.0, 1.0])}}),
        ),
        (
            "elbow",
            json!({"revolute": {"between": elbow, "at": vector([0.8, 0.2, 0.0], u), "axis": axis([0.0, 0.2, 1.0])}}),
        ),
    ];
    let (f, m) = (u, u * u);
    let loads = [
        (
            "rail",
            json!({"controller": {
                "joint": "rail", "reference": {"harmonic": {"amplitude": 0.1 * u, "frequency": 0.9, "phase": 0.2}},
                "proportional": 120, "derivative": 40, "feed_forward": 3.0 * f,
                "feedback": [{"joint": "shoulder", "proportional": 5.0 * f, "derivative": 1.0 * f, "reference": 0.1}],
                "motor": {"torque": 60.0 * f, "gear_ratio": 1.2, "rotor_inertia": 0.8}
            }}),
        ),
        (
            "shoulder",
            json!({"controller": {
                "joint": "shoulder", "reference": {"table": {"times": [0, 0.4, 0.8], "values": [0, 0.5, 0.6]}},
                "proportional": 60.0 * m, "derivative": 12.0 * m, "integral": 40.0 * m, "anti_windup": 0.2,
                "gravity_compensation": [
                    {"body": "upper", "mass": 1.9}, {"body": "fore", "point": [0.05 * u, 0.02 * u * own.mirror, 0], "mass": 1.1}
                ],
                "motor": {
                    "torque": 7.0 * m, "gear_ratio": 5, "lag": 0.03, "power": 60.0 * m, "rotor_inertia": 0.01 * m,
                    "curve": {"stall_torque": 9.0 * m, "no_load_speed": 20}
                }
            }}),
        ),
        (
            "elbow",
            json!({"controller": {
                "joint": "elbow", "reference": {"polynomial": [0, 0.6 * way, -0.4 * way]},
                "proportional": 20.0 * m, "derivative": 3.0 * m, "integral": 25.0 * m
            }}),
        ),
        (
            "cable",
            json!({"controller": {
                "between": ["fore", "ground"], "at": [vector([1.3, 0.3, 0.1], u), vector([0.5, 1.5, 0.3], u)],
                "reference": 1.3 * u, "proportional": 8, "derivative": 2, "integral": 5, "motor": {"lag": 0.1}
            }}),
        ),
    ];
    fn ordered<const N: usize>(all: [(&str, Value); N], reordered: bool) -> Value {
        let mut all: Vec<(String, Value)> = all.map(|(name, own)| (name.to_owned(), own)).into();
        if reordered {
            all.reverse();
        }
        Value::Object(all.into_iter().collect())
    }
    let mut simulation = method;
    simulation["duration"] = json!(0.9);
    json!({
        "version": 1, "name": "arm", "gravity": vector([0.5, -9.81, 1.0], u),
        "bodies": ordered(bodies, own.reordered), "joints": ordered(joints, own.reordered),
        "loads": ordered(loads, own.reordered),
        "simulation": simulation,
        "functions": {
            "shoulder": final_of(json!({"angle": {"joint": "shoulder"}})),
            "lift": final_of(json!({"position": {"body": "fore", "direction": vector([0.3, 1.0, 0.2], 1.0)}})),
            "effort": final_of(json!({"effort": {"load": "shoulder"}})),
            "pull": {"mean_square": {"effort": {"load": "cable"}}},
            "drive": {"mean_square": {"effort": {"load": "rail"}}},
            "error": {"mean_square": {"tracking_error": {"load": "shoulder"}}},
            "length": final_of(json!({"tracking_error": {"load": "cable"}})),
            "work": {"integral": {"power": {"load": "shoulder"}}}
        },
        "variables": variables()
    })
}

fn variables() -> Value {
    let at = |path: &str| json!({"path": format!("/loads/{path}"), "lower": -1e9, "upper": 1e9});
    let positive =
        |path: &str| json!({"path": format!("/loads/{path}"), "lower": 1e-6, "upper": 1e9});
    json!({
        "mass": {"path": "/bodies/fore/mass", "lower": 0.1, "upper": 5},
        "amplitude": at("rail/controller/reference/harmonic/amplitude"),
        "rail p": at("rail/controller/proportional"),
        "force": at("rail/controller/feed_forward"),
        "cross p": at("rail/controller/feedback/0/proportional"),
        "cross d": at("rail/controller/feedback/0/derivative"),
        "cross r": at("rail/controller/feedback/0/reference"),
        "rail torque": positive("rail/controller/motor/torque"),
        "node": at("shoulder/controller/reference/table/values/1"),
        "p": at("shoulder/controller/proportional"),
        "d": at("shoulder/controller/derivative"),
        "k": at("shoulder/controller/integral"),
        "windup": positive("shoulder/controller/anti_windup"),
        "balanced": positive("shoulder/controller/gravity_compensation/1/mass"),
        "point": at("shoulder/controller/gravity_compensation/1/point/0"),
        "torque": positive("shoulder/controller/motor/torque"),
        "ratio": positive("shoulder/controller/motor/gear_ratio"),
        "lag": positive("shoulder/controller/motor/lag"),
        "rotor": positive("shoulder/controller/motor/rotor_inertia"),
        "rail rotor": positive("rail/controller/motor/rotor_inertia"),
        "power": positive("shoulder/controller/motor/power"),
        "stall": positive("shoulder/controller/motor/curve/stall_torque"),
        "speed": positive("shoulder/controller/motor/curve/no_load_speed"),
        "elbow k": at("elbow/controller/integral"),
        "elbow way": at("elbow/controller/reference/polynomial/1"),
        "cable r": at("cable/controller/reference"),
        "cable lag": positive("cable/controller/motor/lag")
    })
}

fn methods() -> [Value; 5] {
    [
        json!({"method": "dop853", "tolerance": 1e-9}),
        json!({"method": {"radau": {"stages": 3}}, "tolerance": 1e-9}),
        json!({"method": {"radau": {"stages": 2}}, "steps": 120}),
        json!({"method": {"bdf": {"order": 2}}, "steps": 200}),
        json!({"method": {"generalised_alpha": {"radius": 0.8}}, "steps": 200}),
    ]
}

#[test]
fn derivatives_by_every_method() {
    for method in methods() {
        let file = arm(Family { turn: 0.7, ..PLAIN }, method.clone());
        gradients_are_exact(&parsed(&file), &method);
    }
}

#[test]
fn methods_agree() {
    let exact = values(&arm(PLAIN, json!({"method": "dop853", "tolerance": 1e-12})));
    let radau = values(&arm(
        PLAIN,
        json!({"method": {"radau": {"stages": 3}}, "tolerance": 1e-11}),
    ));
    for (a, b) in exact.iter().zip(&radau) {
        assert_near(*b, *a, 1e-7);
    }
    for method in [
        json!({"method": {"bdf": {"order": 2}}, "steps": 4000}),
        json!({"method": {"generalised_alpha": {"radius": 0.8}}, "steps": 4000}),
    ] {
        for (a, b) in exact.iter().zip(values(&arm(PLAIN, method))) {
            assert_near(b, *a, 1e-3);
        }
    }
}

#[test]
fn families_move_alike() {
    let method = json!({"tolerance": 1e-11});
    let plain = values(&arm(PLAIN, method.clone()));
    let families = [
        Family { turn: 1.1, ..PLAIN },
        Family {
            mirror: -1.0,
            ..PLAIN
        },
        Family {
            unit: 1000.0,
            ..PLAIN
        },
        Family {
            reordered: true,
            ..PLAIN
        },
        Family {
            swapped: true,
            ..PLAIN
        },
        Family {
            turn: -2.0,
            mirror: -1.0,
            unit: 0.01,
            reordered: true,
            swapped: true,
        },
    ];
    for own in families {
        let found = values(&arm(own, method.clone()));
        let u = own.unit;
        let m = u * u;
        let units = [1.0, u, m, m, u * u, 1.0, u, m];
        for (k, ((found, plain), unit)) in found.iter().zip(&plain).zip(units).enumerate() {
            let off = (found / unit - plain).abs();
            assert!(
                off < 1e-7 * plain.abs().max(1.0),
                "{k}: {found} {plain} {unit}"
            );
        }
    }
}

/// What controllers give is what the machine has: kinetic and potential energy.
#[test]
fn energy_is_the_work_of_controllers() {
    let mut file = arm(PLAIN, json!({"tolerance": 1e-11}));
    file["functions"] = json!({"energy": final_of(json!({"energy": "total"}))});
    for load in ["rail", "shoulder", "elbow", "cable"] {
        file["functions"][load] = json!({"integral": {"power": {"load": load}}});
    }
    file["variables"] = json!({"mass": {"path": "/bodies/fore/mass", "lower": 0.1, "upper": 5}});
    let found = values(&file);
    file["simulation"]["duration"] = json!(1e-9);
    let start = values(&file)[0];
    let work: f64 = found[1..].iter().sum();
    assert!(work.abs() > 1.0, "{found:?}");
    assert_near(found[0] - start, work, 1e-8);
}

/// The poles of the closed loop: the roots of J s³ + d s² + p s + k.
#[test]
fn poles_are_those_of_the_closed_loop() {
    let (p, d, k) = (8.0, 1.5, 6.0);
    let own = json!({"reference": 0.4, "proportional": p, "derivative": d, "integral": k});
    let mut file = disk(own, 1e-6);
    file["functions"] = json!({
        "f": final_of(json!({"frequency": {"mode": 1}})),
        "z": final_of(json!({"damping_ratio": {"mode": 1}}))
    });
    let found = values(&file);
    let matrix = DMatrix::from_row_slice(
        3,
        3,
        &[
            0.0,
            1.0,
            0.0,
            -p / ABOUT,
            -d / ABOUT,
            1.0 / ABOUT,
            -k,
            0.0,
            0.0,
        ],
    );
    let poles = matrix.complex_eigenvalues();
    let pole = poles.iter().find(|s| s.im > 0.0).expect("an oscillation");
    assert_near(found[0], pole.im / std::f64::consts::TAU, 1e-9);
    assert_near(found[1], -pole.re / pole.norm(), 1e-9);
    gradients_are_exact(&parsed(&file), &json!("poles"));
}

/// A pendulum that a motor holds at rest: by its gain as by a spring, and without an error by an integral.
fn held(controller: Value) -> Value {
    let mut own = controller;
    own["joint"] = json!("pin");
    json!({
        "version": 1, "name": "held", "analysis": "rest", "gravity": [0, -9.81, 0],
        "bodies": {"bar": rod(1.0, 2.0, json!({"put": "a"}))},
        "joints": {"pin": hinge(["bar", "ground"], json!([0, 0, 0]))},
        "loads": {"servo": {"controller": own}},
        "functions": {
            "angle": final_of(json!({"angle": {"joint": "pin"}})),
            "effort": final_of(json!({"effort": {"load": "servo"}})),
            "error": final_of(json!({"tracking_error": {"load": "servo"}}))
        },
        "variables": {
            "mass": {"path": "/bodies/bar/mass", "lower": 1, "upper": 5},
            "reference": {"path": "/loads/servo/controller/reference", "lower": -1, "upper": 1}
        }
    })
}

#[test]
fn motors_hold_a_pendulum_at_rest() {
    let weight = 2.0 * 9.81 * 0.5;
    let own = json!({"reference": 0.3, "proportional": 80, "derivative": 3, "motor": {"lag": 0.1}});
    let file = held(own);
    let found = values(&file);
    let torque = 80.0 * (0.3 - found[0]);
    assert_near(found[1], torque, 1e-10);
    assert_near(torque, weight * found[0].cos(), 1e-10);
    gradients_are_exact(&parsed(&file), &json!("proportional"));

    let own = json!({"reference": 0.3, "proportional": 80, "integral": 5, "motor": {"lag": 0.1, "torque": 90}});
    let file = held(own);
    let found = values(&file);
    assert_near(found[0], 0.3, 1e-12);
    assert_near(found[2], 0.0, 1e-9);
    assert_near(found[1], weight * 0.3_f64.cos(), 1e-10);
}

#[test]
fn vibrations_about_rest_are_those_of_the_closed_loop() {
    let mut file = held(json!({"reference": 0.3, "proportional": 80, "derivative": 3}));
    file["functions"] = json!({
        "angle": final_of(json!({"angle": {"joint": "pin"}})),
        "f": {"frequency": {"mode": 1}}, "z": {"damping_ratio": {"mode": 1}}
    });
    let found = values(&file);
    let about = 2.0 * (1.0 / 3.0 + 1e-4 / 4.0);
    // The torque of the weight is −m g c cos φ, so its stiffness is −m g c sin φ.
    let stiffness = 80.0 - 9.81 * found[0].sin();
    let speed = (stiffness / about).sqrt();
    assert_near(found[1], speed / std::f64::consts::TAU, 1e-9);
    assert_near(found[2], 3.0 / (2.0 * about * speed), 1e-9);
    gradients_are_exact(&parsed(&file), &json!("modes"));
}

/// About rest the states of controllers move with the machine: an integral with its anti-windup, a lag, and a motor near its
/// limit, whose gain is less there.
#[test]
fn vibrations_about_rest_have_states() {
    let about = 2.0 * (1.0 / 3.0 + 1e-4 / 4.0);
    let (p, d, k, lag, wind, most) = (80.0, 3.0, 50.0, 0.04, 0.3, 12.0);
    let reference = 0.3_f64;
    // The stiffness of the weight.
    let weight = 9.81 * reference.sin();
    let torque = 9.81 * reference.cos();
    let gain = (1.0 - (torque / most).powi(8)).powf(9.0 / 8.0);
    assert!(gain < 0.9, "{gain}");
    for (with_lag, wound) in [(false, false), (true, false), (false, true), (true, true)] {
        let mut own = json!({"reference": reference, "proportional": p, "derivative": d, "integral": k,
                             "motor": {"torque": most}});
        if with_lag {
            own["motor"]["lag"] = json!(lag);
        }
        if wound {
            own["anti_windup"] = json!(wind);
        }
        let mut file = held(own);
        file["functions"] =
            json!({"f": {"frequency": {"mode": 1}}, "z": {"damping_ratio": {"mode": 1}}});
        let at = |path: &str| json!({"path": format!("/loads/servo/controller/{path}"), "lower": 0.001, "upper": 900});
        file["variables"]["p"] = at("proportional");
        file["variables"]["d"] = at("derivative");
        file["variables"]["k"] = at("integral");
        file["variables"]["most"] = at("motor/torque");
        if with_lag {
            file["variables"]["lag"] = at("motor/lag");
        }
        if wound {
            file["variables"]["wind"] = at("anti_windup");
        }
        let found = values(&file);
        // States: the angle, its rate, the integral, the torque.
        let demand = [-p, -d, 1.0];
        let excess = if wound { (gain - 1.0) / wind } else { 0.0 };
        let integral = [
            -k + excess * demand[0],
            excess * demand[1],
            excess * demand[2],
            0.0,
        ];
        let (direct, held) = match with_lag {
            true => (0.0, 1.0),
            false => (gain, 0.0),
        };
        let rows = [
            [0.0, 1.0, 0.0, 0.0],
            [
                (direct * demand[0] + weight) / about,
                direct * demand[1] / about,
                direct * demand[2] / about,
                held / about,
            ],
            integral,
            [
                gain * demand[0] / lag,
                gain * demand[1] / lag,
                gain * demand[2] / lag,
                -1.0 / lag,
            ],
        ];
        let matrix = DMatrix::from_fn(4, 4, |i, k| rows[i][k]);
        let poles = matrix.complex_eigenvalues();
        let oscillates = poles.iter().filter(|s| s.im > 1e-9);
        let pole = oscillates
            .min_by(|a, b| a.norm().total_cmp(&b.norm()))
            .expect("an oscillation");
        assert_near(found[0], pole.im / std::f64::consts::TAU, 1e-8);
        assert_near(found[1], -pole.re / pole.norm(), 1e-8);
        gradients_are_exact(&parsed(&file), &json!([with_lag, wound]));
        // Those of the motion that begins with this rest.
        file["functions"]["told"] = file["functions"]["f"].clone();
        assert_eq!(values(&file)[2], found[0]);
    }
}

/// Rotors turn with their joints from the start, however these get their rates.
#[test]
fn rotors_start_with_their_joints() {
    let own = json!({"feed_forward": 0, "motor": {"gear_ratio": 5, "rotor_inertia": 0.01}});
    let mut file = disk(own, 0.1);
    file["functions"] = json!({
        "rate": final_of(json!({"angle_rate": {"joint": "axle"}})), "energy": final_of(json!({"energy": "kinetic"}))
    });
    let energy = 0.5 * (ABOUT + 0.25) * 4.0;
    for start in ["joint", "body", "all", "gear"] {
        let mut own = file.clone();
        match start {
            "body" => own["bodies"]["disk"]["velocity"] = json!({"angular": [0, 0, 2]}),
            "all" => own["initial_velocity"] = json!({"angular": [0, 0, 2]}),
            _ => own["joints"]["axle"]["revolute"]["start"] = json!({"turn": {"rate": 2}}),
        }
        let mut expected = energy;
        if start == "gear" {
            own["bodies"]["wheel"] = json!({"mass": 1, "inertia": {"xx": 1, "yy": 1, "zz": 0.3}, "place": {"at": [1, 0, 0]}});
            own["joints"]["other"] = hinge(["wheel", "ground"], json!([1, 0, 0]));
            own["couplings"] =
                json!({"mesh": {"gear": {"gears": ["disk", "wheel"], "teeth": [10, 20]}}});
            expected += 0.5 * 0.3;
        }
        let found = values(&own);
        assert_near(found[0], 2.0, 1e-9);
        assert_near(found[1], expected, 1e-9);
    }
}

/// The closed loop alone tells whether a rest with states of controllers is stable, at every reference.
#[test]
fn closed_loops_are_stable_or_not() {
    let at = |reference: f64, rotor: f64, d: f64, k: f64| {
        let own = json!({"reference": reference, "proportional": 400, "derivative": d, "integral": k,
                         "motor": {"gear_ratio": 50, "rotor_inertia": rotor}});
        let mut file = held(own);
        file["variables"]["reference"]["lower"] = json!(-2);
        file["variables"]["reference"]["upper"] = json!(2);
        file["functions"]["f"] = json!({"frequency": {"mode": 1}});
        file["functions"]["z"] = json!({"damping_ratio": {"mode": 1}});
        let own = parsed(&file);
        let growth = own.stability_at_rest(&own.start()).expect("a rest").growth;
        (growth, values(&file))
    };
    for rotor in [0.0, 1e-4] {
        for k in -15..15 {
            let reference = 0.1 * f64::from(k);
            let (growth, found) = at(reference, rotor, 30.0, 900.0);
            assert_eq!(growth, None, "{reference}");
            assert_near(found[0], reference, 1e-9);
            assert!(found[4] > 0.5, "{found:?}");
        }
    }
    let (growth, found) = at(-0.3, 1e-4, 1.0, 12000.0);
    let about = 2.0 * (1.0 / 3.0 + 1e-4 / 4.0) + 0.25;
    let matrix = DMatrix::from_row_slice(
        3,
        3,
        &[
            0.0,
            1.0,
            0.0,
            (-400.0 + 9.81 * (-0.3_f64).sin()) / about,
            -1.0 / about,
            1.0 / about,
            -12000.0,
            0.0,
            0.0,
        ],
    );
    let poles = matrix.complex_eigenvalues();
    let fastest = poles.iter().map(|s| s.re).fold(f64::NEG_INFINITY, f64::max);
    assert_near(growth.expect("a growth"), fastest, 1e-8);
    assert!(found[4] < -0.2, "{found:?}");
}

/// At rest the angle of a joint has the turns that its loads count.
#[test]
fn angles_at_rest_have_their_turns() {
    for reference in [7.0, 10.0, -7.0] {
        let mut file = held(json!({"reference": reference, "proportional": 50}));
        file["variables"]["reference"]["upper"] = json!(20);
        file["variables"]["reference"]["lower"] = json!(-20);
        let found = values(&file);
        assert_near(found[0] + found[2], reference, 1e-9);
    }
}

/// At rest a motor that its limits do not let hold the machine is told.
#[test]
fn weak_motors_are_told_at_rest() {
    let own = json!({"reference": 0.3, "proportional": 80, "integral": 5, "motor": {"torque": 9}});
    let told = fault(&held(own.clone()));
    for words in ["/loads/servo", "9.371", "a motor that holds the machine"] {
        assert!(told.contains(words), "{told}");
    }
    let mut strong = own;
    strong["motor"]["gear_ratio"] = json!(2);
    assert_near(values(&held(strong))[1], 9.81 * 0.3_f64.cos(), 1e-10);
}

/// A rotor is felt with the square of its gear, by motors of joints that turn and slide; it has no weight, and its energy is
/// that of the machine.
#[test]
fn rotors_are_felt_through_their_gears() {
    let (inertia, ratio) = (0.002, 9.0);
    let all = ABOUT + inertia * ratio * ratio;
    let own =
        json!({"feed_forward": 2.5, "motor": {"gear_ratio": ratio, "rotor_inertia": inertia}});
    let mut file = disk(own, 1.3);
    file["functions"] = json!({
        "angle": final_of(json!({"angle": {"joint": "axle"}})),
        "rate": final_of(json!({"angle_rate": {"joint": "axle"}})),
        "energy": final_of(json!({"energy": "kinetic"})),
        "work": {"integral": {"power": {"load": "servo"}}}
    });
    file["variables"]["rotor"] =
        json!({"path": "/loads/servo/controller/motor/rotor_inertia", "lower": 0, "upper": 1});
    file["variables"]["ratio"] =
        json!({"path": "/loads/servo/controller/motor/gear_ratio", "lower": 1, "upper": 20});
    let found = values(&file);
    let rate = 2.5 * 1.3 / all;
    assert_near(found[0], 0.5 * rate * 1.3, 1e-9);
    assert_near(found[1], rate, 1e-9);
    assert_near(found[2], 0.5 * all * rate * rate, 1e-9);
    assert_near(found[2], found[3], 1e-8);
    gradients_are_exact(&parsed(&file), &json!("rotor"));
    // In vibrations about rest.
    let own = json!({"reference": 0.3, "proportional": 80, "motor": {"gear_ratio": ratio, "rotor_inertia": inertia}});
    let mut file = held(own);
    file["functions"] = json!({"angle": final_of(json!({"angle": {"joint": "pin"}})), "f": {"frequency": {"mode": 1}}});
    let found = values(&file);
    let about = 2.0 * (1.0 / 3.0 + 1e-4 / 4.0) + inertia * ratio * ratio;
    let speed = ((80.0 - 9.81 * found[0].sin()) / about).sqrt();
    assert_near(found[1], speed / std::f64::consts::TAU, 1e-9);
    gradients_are_exact(&parsed(&file), &json!("rotor at rest"));
}

/// A drive follows an S-curve within its limits.
#[test]
fn an_s_curve_leads_a_joint() {
    let way =
        json!({"s_curve": {"from": 0.1, "to": 1.6, "start": 0.2, "speed": 1.2, "acceleration": 4}});
    let mut own =
        json!({"reference": way, "proportional": 900, "derivative": 120, "integral": 500});
    let found = values(&disk(own.clone(), 3.0));
    assert_near(found[0], 1.6, 0.05);
    // Weak gains: the effort of strong ones is what is left of large terms.
    own["reference"]["s_curve"]["to"] = json!(1.1);
    (own["proportional"], own["derivative"], own["integral"]) = (json!(20), json!(4), json!(10));
    let mut file = disk(own, 1.5);
    let at = |key: &str| json!({"path": format!("/loads/servo/controller/reference/s_curve/{key}"), "lower": 0.01, "upper": 9});
    file["variables"] = json!({"to": at("to"), "start": at("start"), "speed": at("speed"), "acceleration": at("acceleration")});
    gradients_are_exact(&parsed(&file), &json!("S-curve"));
    file["loads"]["servo"]["controller"]["reference"]["s_curve"]["to"] = json!(0.1);
    assert!(fault(&file).contains("a way from"));
}

/// Angles are counted over turns.
#[test]
fn a_servo_turns_many_times() {
    let course = json!({"rate": 12.0});
    let own = json!({"reference": course, "proportional": 40, "derivative": 20, "integral": 10});
    let found = values(&disk(own, 6.0));
    assert_near(found[0], 72.0, 1e-3);
}

#[test]
fn bad_controllers_are_told() {
    let told = |own: Value, words: &[&str]| {
        let mut file = disk(json!({"proportional": 1}), 1.0);
        file["loads"]["servo"]["controller"] = own;
        file["variables"] = json!({"mass": {"path": "/bodies/disk/mass", "lower": 1, "upper": 9}});
        let found = fault(&file);
        for word in words {
            assert!(found.contains(word), "{found}");
        }
    };
    told(
        json!({"proportional": 1}),
        &["/loads/servo/controller", "nothing that is controlled"],
    );
    told(
        json!({"joint": "axle", "between": ["disk", "ground"]}),
        &["\"joint\" and \"between\""],
    );
    told(json!({"joint": "axel"}), &["\"axel\"", "axle"]);
    told(
        json!({"joint": "axle", "motion": "slide"}),
        &["\"slide\"", "revolute"],
    );
    told(
        json!({"joint": "axle", "anti_windup": 0.1, "motor": {"torque": 1}}),
        &["anti_windup", "integral"],
    );
    told(
        json!({"joint": "axle", "anti_windup": 0.1, "integral": 2}),
        &["anti_windup", "limits"],
    );
    told(
        json!({"joint": "axle", "feedback": [{"joint": "knee"}]}),
        &["feedback/0", "\"knee\""],
    );
    told(
        json!({"joint": "axle", "gravity_compensation": [{"body": "ground", "mass": 1}]}),
        &["gravity_compensation/0", "ground"],
    );
    told(
        json!({"between": ["disk", "ground"], "at": [[1, 0, 0], [3, 0, 0]], "motor": {"rotor_inertia": 1}}),
        &["motor/rotor_inertia", "a rotor turns with a joint"],
    );
    told(
        json!({"joint": "axle", "motor": {"torque": 0}}),
        &["torque", "above 0"],
    );
    told(
        json!({"joint": "axle", "reference": {"table": {"times": [0, 0], "values": [1, 2]}}}),
        &["reference", "times that increase"],
    );
    let mut file = disk(json!({"proportional": 1}), 1.0);
    file["functions"]["effort"]["final"]["effort"]["load"] = json!("servos");
    assert!(fault(&file).contains("a load that is a controller"));
}
