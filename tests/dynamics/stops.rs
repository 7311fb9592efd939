//! Stops of joints and distances: rebounds against the implicit formula, penetrations in closed form, energy, families,
//! derivatives, and contacts that come and go between steps.

use crate::reference::documents::{
    methods, problem as parsed, reversed, run, unlowered_values, value, values, vary,
};
use crate::reference::gradients::gradients_are_exact;
use flexbody_driver::simulate;
use serde_json::Value;

/// The root of `f` between two places where it has different signs.
fn root(f: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    let rises = f(high) > 0.0;
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if (f(middle) > 0.0) == rises {
            high = middle;
        } else {
            low = middle;
        }
    }
    0.5 * (low + high)
}

/// The speed of a free rebound by N = f(δ) (1 + a δ̇), whatever f: m v dv / (1 + a v) = −f dδ gives
/// G(v) = G(−v'), G(v) = (a v − ln(1 + a v)) / a² (Marhefka & Orin 1999).
pub fn rebound(v: f64, dissipation: f64) -> f64 {
    let a = 1.5 * dissipation;
    if a == 0.0 {
        return v;
    }
    let g = |v: f64| a * v - (a * v).ln_1p();
    root(|w| g(-w) - g(v), 0.0, (1.0 - 1e-12) / a)
}

/// A body of 2 kg and 2 kg m² on a joint with one degree of freedom, which starts at zero with a rate.
fn one_body(joint: &str, axis: [f64; 3], rate: f64, stop: &Value) -> Value {
    let start = match joint {
        "prismatic" => json!({"slide": {"displacement": 0, "rate": rate}}),
        _ => json!({"turn": {"angle": 0, "rate": rate}}),
    };
    let measured = match joint {
        "prismatic" => json!({"slide_rate": {"joint": "joint"}}),
        _ => json!({"angle_rate": {"joint": "joint"}}),
    };
    json!({
        "version": 1, "name": "stop", "gravity": [0, 0, 0],
        "bodies": {"body": {"mass": 2, "inertia": {"xx": 2, "yy": 2, "zz": 2}}},
        "joints": {"joint": {joint: {"between": ["body", "ground"], "at": [0, 0, 0], "axis": axis, "start": start}}},
        "loads": {"stop": {"stop": stop}},
        "simulation": {"duration": 1, "tolerance": 1e-10},
        "functions": {"rate": {"final": measured}}
    })
}

fn joint_stop(lower: Option<f64>, upper: Option<f64>, dissipation: f64, exponent: f64) -> Value {
    let mut stop = json!({"joint": "joint", "stiffness": 3e3, "dissipation": dissipation, "width": 0.02,
                          "exponent": exponent});
    if let Some(lower) = lower {
        stop["lower"] = json!(lower);
    }
    if let Some(upper) = upper {
        stop["upper"] = json!(upper);
    }
    stop
}

/// Rebounds of one coordinate, by any exponent and dissipation, at the lower and the upper limit.
#[test]
fn rebounds_follow_the_implicit_formula() {
    let mut cases = 0;
    for (joint, axis) in [
        ("prismatic", [0.3, -0.5, 0.8]),
        ("revolute", [0.0, 0.0, 1.0]),
    ] {
        for (dissipation, exponent) in [(0.0, 1.0), (0.1, 1.0), (0.4, 1.5), (0.8, 2.0)] {
            for side in [1.0, -1.0] {
                let rate = 1.7 * side;
                let limits = match side > 0.0 {
                    true => (None, Some(0.5)),
                    false => (Some(-0.5), None),
                };
                let stop = joint_stop(limits.0, limits.1, dissipation, exponent);
                let found = values(&one_body(joint, axis, rate, &stop))[0];
                let exact = -side * rebound(1.7, dissipation);
                assert!(
                    (found - exact).abs() < 1e-7,
                    "{joint} {stop}: {found} {exact}"
                );
                cases += 1;
            }
        }
    }
    assert_eq!(cases, 16);
    // About 1 − c v at small speeds.
    assert!((rebound(1e-3, 0.5) / 1e-3 - (1.0 - 0.5e-3)).abs() < 1e-6);
}

/// A point that flies to a post turns back likewise, and one that is held by a rope of distance.
#[test]
fn distances_stop_too() {
    for (lower, upper, start, rate) in [(Some(0.4), None, 1.0, -1.7), (None, Some(1.3), 1.0, 1.7)] {
        let mut stop = json!({"between": ["body", "ground"], "at": [[0, 0, 0], [-1.0, 0, 0]],
                              "stiffness": 3e3, "dissipation": 0.3, "width": 0.02});
        for (key, limit) in [("lower", lower), ("upper", upper)] {
            if let Some(limit) = limit {
                stop[key] = json!(limit);
            }
        }
        let found = values(&one_body("prismatic", [1.0, 0.0, 0.0], rate, &stop))[0];
        let exact: f64 = -f64::signum(rate) * rebound(1.7, 0.3);
        assert!(
            (found - exact).abs() < 1e-7,
            "{start} {stop}: {found} {exact}"
        );
    }
}

/// A pendulum that starts beside its stop at the bottom enters it as deep as its energy allows:
/// ½ k δ² = ½ J ω² + m g l (cos δ − cos φ0), behind the onset.
#[test]
fn a_pendulum_enters_its_stop_as_deep_as_its_energy_allows() {
    let (k, first, rate) = (800.0, -0.8_f64, 0.5);
    let document = json!({
        "version": 1, "name": "pendulum",
        "bodies": {"bar": {"shape": {"rod": {"length": 1, "radius": 0.01}}, "mass": 2,
                           "points": {"a": [-0.5, 0, 0]},
                           "place": {"put": "a", "turn": {"axis": [0, 0, 1], "degrees": -90}}}},
        "joints": {"pin": {"revolute": {"between": ["bar", "ground"], "at": [0, 0, 0], "axis": [0, 0, 1],
                                        "start": {"turn": {"angle": first, "rate": rate}}}}},
        "loads": {"stop": {"stop": {"joint": "pin", "upper": 0, "stiffness": k, "width": 0.01}}},
        "simulation": {"duration": 3, "tolerance": 1e-10,
                       "until": {"measure": {"angle_rate": {"joint": "pin"}}, "reaches": 0}},
        "functions": {"depth": {"final": {"penetration": {"load": "stop"}}},
                      "torque": {"final": {"contact_force": {"load": "stop"}}},
                      "energy": {"final": {"energy": "total"}}}
    });
    // A rod has 1/12 m l² + ¼ m r² about its middle.
    let j = 2.0 * (1.0 / 12.0 + 0.25 * 1e-4 + 0.25);
    let lever = 2.0 * 9.81 * 0.5;
    let found = values(&document);
    let exact = root(
        |x| 0.5 * k * x * x - 0.5 * j * rate * rate - lever * (x.cos() - first.cos()),
        0.0,
        1.0,
    );
    assert!((found[0] - exact).abs() < 1e-8, "{} {exact}", found[0]);
    assert!((found[1] - k * exact).abs() < 1e-5, "{}", found[1]);
    let start = 0.5 * j * rate * rate - lever * first.cos();
    assert!((found[2] - start).abs() < 1e-7, "{} {start}", found[2]);
}

/// A mass on a spring with a bolt at its rest that adds its stiffness on one side alone: the period π √(m/k) + π √(m/(k + k')), whatever
/// the amplitude, and the energy stays.
#[test]
fn a_bolt_on_one_side_of_a_spring() {
    let (mass, soft, bolt) = (2.0_f64, 800.0_f64, 5000.0_f64);
    let period = std::f64::consts::PI * ((mass / soft).sqrt() + (mass / (soft + bolt)).sqrt());
    for speed in [0.5, 3.0] {
        let found = values(&json!({
            "version": 1, "name": "bolt", "gravity": [0, 0, 0],
            "bodies": {"block": {"shape": {"box": {"size": [0.1, 0.1, 0.1]}}, "mass": mass, "place": {"at": [1, 0, 0]},
                                 "velocity": {"linear": [speed, 0, 0]}}},
            "joints": {"rail": {"prismatic": {"between": ["block", "ground"], "at": [1, 0, 0], "axis": [1, 0, 0]}}},
            "loads": {
                "spring": {"spring": {"between": ["block", "ground"], "at": {"a": [0, 0, 0], "b": [0, 0, 0]}, "rest_length": 1, "stiffness": soft}},
                "bolt": {"stop": {"joint": "rail", "lower": 0, "stiffness": bolt, "width": 1e-5}}
            },
            "simulation": {"duration": period, "tolerance": 1e-10},
            "functions": {
                "place": {"final": {"position": {"body": "block", "direction": [1, 0, 0]}}},
                "speed": {"final": {"velocity": {"body": "block", "direction": [1, 0, 0]}}}
            }
        }));
        assert!((found[0] - 1.0).abs() < 1e-6 * speed, "{found:?}");
        assert!((found[1] / speed - 1.0).abs() < 1e-6, "{found:?}");
    }
}

/// Limits beyond a turn: the angle counts from the start of the joint.
#[test]
fn limits_count_turns() {
    let stop = joint_stop(Some(-9.0), Some(7.5), 0.2, 1.0);
    for (rate, limit) in [(4.0, 7.5), (-4.0, -9.0)] {
        let mut document = one_body("revolute", [0.0, 0.0, 1.0], rate, &stop);
        document["simulation"]["duration"] = json!(4);
        document["functions"]["angle"] = json!({"final": {"angle": {"joint": "joint"}}});
        let found = values(&document);
        let back = rebound(4.0, 0.2);
        assert!((found[0] + rate.signum() * back).abs() < 1e-6, "{found:?}");
        // It reached the limit and turned back.
        let reached = found[1] - found[0] * (4.0 - (limit / rate).abs());
        assert!((reached - limit).abs() < 0.3, "{found:?} {limit}");
    }
}

/// What a stop takes is what the motion loses: the work of its force is the change of the kinetic energy, also between.
#[test]
fn energy_is_in_balance() {
    let stop = joint_stop(None, Some(0.5), 0.4, 1.5);
    for duration in [0.3, 1.0] {
        let mut document = one_body("prismatic", [1.0, 0.0, 0.0], 1.7, &stop);
        document["simulation"]["duration"] = json!(duration);
        document["functions"] = json!({
            "work": {"integral": {"power": {"load": "stop"}}},
            "kinetic": {"final": {"energy": "kinetic"}},
            "total": {"final": {"energy": "total"}}
        });
        let [work, kinetic, total] = values(&document)[..] else {
            panic!("three functions")
        };
        let start = 0.5 * 2.0 * 1.7_f64.powi(2);
        assert!(
            (kinetic - start - work).abs() < 1e-7 * start,
            "{work} {kinetic}"
        );
        assert!(
            total < start && total >= kinetic,
            "{total} {kinetic} {start}"
        );
    }
}

/// An arm with a stop and a bump stop of distance, on a slider with stops at both ends, in a plane.
fn machine(simulation: Value) -> Value {
    json!({
        "version": 1, "name": "machine",
        "bodies": {
            "slider": {"shape": {"box": {"size": [0.2, 0.1, 0.1]}}, "mass": 2},
            "arm": {"shape": {"box": {"size": [1, 0.1, 0.1]}}, "mass": 1,
                    "points": {"root": [-0.5, 0, 0], "tip": [0.5, 0, 0]},
                    "place": {"put": "root", "turn": {"axis": [0, 0, 1], "angle": -0.3}}}
        },
        "joints": {
            "rail": {"prismatic": {"between": ["slider", "ground"], "at": [0, 0, 0], "axis": [1, 0, 0],
                                   "start": {"slide": {"displacement": 0, "rate": 1.5}}}},
            "hinge": {"revolute": {"between": ["arm", "slider"], "at": "arm.root", "axis": [0, 0, 1]}}
        },
        "loads": {
            "ends": {"stop": {"joint": "rail", "lower": -0.15, "upper": 0.2, "stiffness": 4000, "dissipation": 0.2,
                              "width": 0.02, "exponent": 1.2}},
            "hinge": {"stop": {"joint": "hinge", "lower": -0.45, "stiffness": 900, "dissipation": 0.1, "width": 0.05}},
            "bump": {"stop": {"between": ["ground", "arm"], "at": {"a": [0.75, -0.95, 0], "b": [0.5, 0, 0]}, "lower": 0.25,
                              "stiffness": 2000, "dissipation": 0.3, "width": 0.03}}
        },
        "simulation": simulation,
        "functions": {
            "place": {"final": {"position": {"body": "arm", "point": "tip", "direction": [0.6, 0.8, 0]}}},
            "energy": {"integral": {"energy": "total"}},
            "deepest": {"ks": {"rho": 50, "of": {"penetration": {"load": "ends"}}}},
            "hinge": {"integral": {"contact_force": {"load": "hinge"}}},
            "bump": {"ks": {"rho": 0.02, "of": {"contact_force": {"load": "bump"}}}},
            "work": {"integral": {"power": {"load": "ends"}}}
        }
    })
}

/// By every method, in all numbers of the stops; all of them are met.
#[test]
fn gradients_by_every_method() {
    for simulation in methods(0.6, 300) {
        let mut document = machine(simulation.clone());
        let of = |load: &str, keys: &[&str]| -> Vec<String> {
            let path = |key: &&str| format!("/loads/{load}/stop/{key}");
            keys.iter().map(path).collect()
        };
        let law = ["stiffness", "dissipation", "width"];
        let mut paths = of("ends", &["lower", "upper"]);
        paths.extend(of("hinge", &["lower"]));
        paths.extend(of("bump", &["lower", "at/a/1", "at/b/0"]));
        for load in ["ends", "hinge", "bump"] {
            paths.extend(of(load, &law));
        }
        paths.push("/bodies/arm/mass".into());
        vary(&mut document, &paths);
        gradients_are_exact(&parsed(&document), &simulation);
    }
}

/// Reductions to a plane and their absence, bodies and joints in another order, and bodies of joints exchanged.
#[test]
fn the_same_in_other_descriptions() {
    let document = machine(json!({"duration": 0.6, "tolerance": 1e-10}));
    let reference = values(&document);
    let agree = |found: &[f64], what: &str| {
        for (a, b) in found.iter().zip(&reference) {
            assert!(
                (a - b).abs() < 1e-6 * b.abs().max(0.1),
                "{what}: {found:?} {reference:?}"
            );
        }
    };
    let problem = parsed(&document);
    assert!(
        problem
            .lowering
            .as_ref()
            .is_some_and(|lowering| lowering.plane.is_ok())
    );
    agree(&unlowered_values(&document), "without reductions");
    let other = reversed(&document, &["bodies", "joints", "loads"]);
    agree(&values(&other), "in another order");
    let mut exchanged = document.clone();
    exchanged["joints"]["hinge"]["revolute"]["between"] = json!(["slider", "arm"]);
    let stop = &mut exchanged["loads"]["hinge"]["stop"];
    stop["upper"] = json!(0.45);
    stop.as_object_mut().expect("an object").remove("lower");
    exchanged["loads"]["bump"]["stop"]["between"] = json!(["arm", "ground"]);
    exchanged["loads"]["bump"]["stop"]["at"] = json!({"a": [0.5, 0, 0], "b": [0.75, -0.95, 0]});
    agree(&values(&exchanged), "sides exchanged");
}

/// A light body flies through the reach of a post in a thousandth of the time. Steps that pass over it are repeated; given
/// steps fail with its name.
#[test]
fn no_contact_is_missed_between_steps() {
    let mut document = json!({
        "version": 1, "name": "post", "gravity": [0, 0, 0],
        "bodies": {"ball": {"shape": "point", "mass": 1, "place": {"at": [-20, 0.05, 0]},
                            "velocity": {"linear": [20, 0, 0]}}},
        "loads": {"post": {"stop": {"between": ["ball", "ground"], "at": {"a": [0, 0, 0], "b": [0, 0, 0]}, "lower": 0.1,
                                    "stiffness": 1e6, "width": 0.01}}},
        "simulation": {"duration": 2},
        "functions": {"y": {"final": {"velocity": {"body": "ball", "direction": [0, 1, 0]}}},
                      "speed": {"final": {"speed": {"body": "ball"}}}}
    });
    let found = values(&document);
    assert!(
        found[0].abs() > 5.0 && (found[1] - 20.0).abs() < 1e-5,
        "{found:?}"
    );
    document["simulation"]["method"] = json!({"radau": {"stages": 3}});
    let implicit = values(&document);
    assert!(
        (implicit[0] - found[0]).abs() < 1e-4,
        "{implicit:?} {found:?}"
    );
    for method in [json!("dop853"), json!({"bdf": {"order": 2}})] {
        document["simulation"] = json!({"duration": 2, "steps": 5, "method": method});
        let problem = parsed(&document);
        let failure = simulate(&problem, &problem.start())
            .err()
            .expect("too few steps");
        assert!(
            failure.to_string().contains("contact of load \"post\""),
            "{failure}"
        );
    }
}

/// A slider that lies on its stop sinks in by m g / k and vibrates with √(k/m), with derivatives.
#[test]
fn at_rest_and_in_vibration() {
    let document = json!({
        "version": 1, "name": "lying", "analysis": "rest",
        "bodies": {"body": {"shape": {"box": {"size": [0.1, 0.1, 0.1]}}, "mass": 2}},
        "joints": {"rail": {"prismatic": {"between": ["body", "ground"], "at": [0, 0, 0], "axis": [0, 1, 0]}}},
        "loads": {"stop": {"stop": {"joint": "rail", "lower": 0, "stiffness": 4e3, "dissipation": 0.3, "width": 0.002}}},
        "functions": {"depth": {"final": {"penetration": {"load": "stop"}}},
                      "force": {"final": {"contact_force": {"load": "stop"}}},
                      "frequency": {"frequency": {"mode": 1}}},
        "variables": {"stiffness": {"path": "/loads/stop/stop/stiffness", "lower": 1, "upper": 1e5},
                      "mass": {"path": "/bodies/body/mass", "lower": 1, "upper": 3},
                      "lower": {"path": "/loads/stop/stop/lower", "lower": -1, "upper": 1, "scale": 1},
                      "width": {"path": "/loads/stop/stop/width", "lower": 1e-4, "upper": 1}}
    });
    let weight = 2.0 * 9.81;
    let found = values(&document);
    assert!((found[0] - weight / 4e3).abs() < 1e-12, "{found:?}");
    assert!((found[1] - weight).abs() < 1e-9, "{found:?}");
    let frequency = (4e3_f64 / 2.0).sqrt() / std::f64::consts::TAU;
    assert!((found[2] - frequency).abs() < 1e-9, "{found:?} {frequency}");
    // Within the onset, where the stiffness depends on the depth and its derivative on the curvature.
    let mut soft = document.clone();
    soft["loads"]["stop"]["stop"]["width"] = json!(0.02);
    soft["loads"]["stop"]["stop"]["exponent"] = json!(1.5);
    soft["loads"]["stop"]["stop"]["stiffness"] = json!(6e4);
    assert!(value(&soft, "depth") < 0.01);
    gradients_are_exact(&parsed(&soft), &json!("rest"));
}

/// Motions of more than fifty contacts keep their energy, and their derivatives agree.
#[test]
fn fifty_contacts() {
    let stop =
        json!({"joint": "joint", "lower": -0.1, "upper": 0.1, "stiffness": 3e3, "width": 0.02});
    let mut document = one_body("prismatic", [1.0, 0.0, 0.0], 2.0, &stop);
    document["simulation"] = json!({"duration": 10, "tolerance": 1e-10});
    document["functions"] = json!({
        "energy": {"final": {"energy": "total"}},
        "force": {"integral": {"contact_force": {"load": "stop"}}}
    });
    let paths = [
        "/loads/stop/stop/stiffness",
        "/loads/stop/stop/upper",
        "/bodies/body/mass",
    ];
    vary(&mut document, &paths.map(String::from));
    let motion = run(&document);
    // Each contact turns 2 m v = 8 N s.
    let contacts = motion.at.function(1).value / 8.0;
    assert!(contacts > 50.0, "{contacts}");
    let energy = motion.at.function(0).value;
    assert!((energy / 4.0 - 1.0).abs() < 1e-5, "{energy}");
    document["functions"]
        .as_object_mut()
        .expect("an object")
        .remove("energy");
    gradients_are_exact(&parsed(&document), &json!("fifty contacts"));
}
