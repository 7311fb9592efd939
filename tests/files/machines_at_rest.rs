//! Machines at rest: equilibria against closed forms, stability, free motions, derivatives, families, faults.

use crate::reference::documents::{extended, problem as parsed, value, values};
use crate::reference::gradients::gradients_are_exact;
use flexbody_driver::start::notes;
use flexbody_problem::Problem;
use serde_json::Value;

const GRAVITY: f64 = 9.81;

pub fn rod(length: f64, mass: f64, place: Value) -> Value {
    json!({
        "shape": {"rod": {"length": length, "radius": 0.01}}, "mass": mass,
        "points": {"a": [-0.5 * length, 0, 0], "b": [0.5 * length, 0, 0]}, "place": place
    })
}

fn about_z(angle: f64) -> Value {
    json!({"axis": [0, 0, 1], "angle": angle})
}

fn along(body: &str, point: &str, direction: [f64; 3]) -> Value {
    json!({"final": {"position": {"body": body, "point": point, "direction": direction}}})
}

pub fn hinge(between: [&str; 2], at: Value) -> Value {
    json!({"revolute": {"between": between, "at": at, "axis": [0, 0, 1]}})
}

pub(super) fn notes_of(document: &Value) -> Vec<String> {
    let problem = parsed(document);
    notes(&problem, &problem.start())
}

/// The fault of a document that cannot be read.
pub fn fault(document: &Value) -> String {
    match Problem::parse(&document.to_string(), "rest.json", &[]) {
        Ok(_) => panic!("{document} is read"),
        Err(faults) => faults.to_string(),
    }
}

/// A pendulum with a horizontal force F at its end hangs at tan θ = 2 F / (m g), wherever it is placed.
fn pendulum(angle: f64, force: f64) -> Value {
    json!({
        "version": 1, "name": "pendulum", "analysis": "rest",
        "bodies": {"bar": rod(1.0, 2.0, json!({"put": "a", "turn": about_z(angle)}))},
        "joints": {"pin": hinge(["bar", "ground"], json!([0, 0, 0]))},
        "loads": {"push": {"force": {"body": "bar", "point": "b", "direction": [1, 0, 0], "magnitude": force}}},
        "functions": {
            "x": along("bar", "b", [1.0, 0.0, 0.0]),
            "y": along("bar", "b", [0.0, 1.0, 0.0]),
            "pin": {"final": {"joint_force": {"joint": "pin", "on": "bar", "direction": [0, 1, 0]}}}
        },
        "variables": {
            "push": {"path": "/loads/push/force/magnitude", "lower": 0, "upper": 20},
            "mass": {"path": "/bodies/bar/mass", "lower": 1, "upper": 5}
        }
    })
}

#[test]
fn a_pendulum_hangs_where_its_moments_balance() {
    let force = 5.0;
    let angle = (2.0 * force / (2.0 * GRAVITY)).atan();
    for placed in [-3.0, -1.2, 0.3, 1.5, 2.5] {
        let document = pendulum(placed, force);
        let found = values(&document);
        let expected = [angle.sin(), -angle.cos(), 2.0 * GRAVITY];
        for (found, expected) in found.iter().zip(expected) {
            assert!(
                (found - expected).abs() < 1e-12,
                "{placed}: {found} {expected}"
            );
        }
        let notes = notes_of(&document);
        assert!(
            !notes.iter().any(|note| note.contains("the rest is")),
            "{placed}: {notes:?}"
        );
    }
    let problem = parsed(&pendulum(0.3, force));
    gradients_are_exact(&problem, &json!("pendulum"));
    let at = flexbody_driver::simulate(&problem, &problem.start()).expect("rest");
    let (gradients, _) = at.at.gradients(&problem, &[0]).expect("gradients");
    // d sin θ = cos³ θ d tan θ
    let by_tangent = angle.cos().powi(3);
    let expected = [by_tangent / GRAVITY, -by_tangent * force / (2.0 * GRAVITY)];
    for (found, expected) in gradients[0].iter().zip(expected) {
        assert!((found - expected).abs() < 1e-12, "{found} {expected}");
    }
}

/// A pendulum that is placed upright stays there, and a disturbance grows at √(3 g / 2 L).
#[test]
fn an_upright_pendulum_is_told_as_unstable() {
    let mut document = pendulum(std::f64::consts::FRAC_PI_2, 0.0);
    document["variables"] = json!({});
    assert!((value(&document, "y") - 1.0).abs() < 1e-12);
    let notes = notes_of(&document);
    let time = (2.0 / (3.0 * GRAVITY)).sqrt();
    let expected = format!("grows by a factor of e in {time:.1e} s");
    assert!(
        notes.len() == 1 && notes[0].contains(&expected),
        "{notes:?}"
    );
}

/// Links of length L between (0, 0) and (1, 0), placed as a V. Link i of n has the slope V / H with the half sum V of the
/// vertical forces at its ends, and the span gives H.
#[test]
fn a_hanging_chain_is_a_catenary_of_bars() {
    let (n, length, mass) = (50, 1.2 / 50.0, 0.1);
    let half = n / 2;
    let fall = (0.5 / (half as f64 * length)).acos();
    let (mut bodies, mut joints) = (serde_json::Map::new(), serde_json::Map::new());
    for i in 0..n {
        let x = i as f64 * length * fall.cos();
        let y = -(i.min(n - i) as f64) * length * fall.sin();
        let angle = if i < half { -fall } else { fall };
        let place = json!({"put": "a", "at": [x, y, 0], "turn": about_z(angle)});
        bodies.insert(format!("link {i}"), rod(length, mass, place));
        let (this, before) = (format!("link {i}"), format!("link {}", i.max(1) - 1));
        let other = if i == 0 { "ground" } else { &before };
        joints.insert(
            format!("pin {i}"),
            hinge([&this, other], json!(format!("{this}.a"))),
        );
    }
    let last = format!("link {}", n - 1);
    joints.insert("end".into(), hinge([&last, "ground"], json!([1, 0, 0])));
    let document = json!({
        "version": 1, "name": "chain", "analysis": "rest", "bodies": bodies, "joints": joints,
        "functions": {
            "sag": along("link 25", "a", [0.0, -1.0, 0.0]),
            "pull": {"final": {"joint_force": {"joint": "pin 0", "on": "link 0", "direction": [-1, 0, 0]}}}
        },
        "variables": {
            "third": {"path": "/bodies/link 3/mass", "lower": 0.01, "upper": 1},
            "gravity": {"path": "/gravity/1", "lower": -20, "upper": -1}
        },
        "gravity": [0, -GRAVITY, 0]
    });
    let slopes = |pull: f64| {
        let vertical = move |i: usize| (half as f64 - i as f64 - 0.5) * mass * GRAVITY;
        (0..n).map(move |i| (vertical(i) / pull).atan())
    };
    let (mut low, mut high) = (1.0, 1e3);
    for _ in 0..200 {
        let pull = 0.5 * (low + high);
        let span: f64 = slopes(pull).map(|angle| length * angle.cos()).sum();
        *(if span < 1.0 { &mut low } else { &mut high }) = pull;
    }
    let sag: f64 = slopes(low)
        .take(half)
        .map(|angle| length * angle.sin())
        .sum();
    let found = values(&document);
    assert!((found[0] - sag).abs() < 1e-10, "{} {sag}", found[0]);
    assert!((found[1] / low - 1.0).abs() < 1e-9, "{} {low}", found[1]);
    let problem = parsed(&document);
    gradients_are_exact(&problem, &json!("chain"));
    // All masses and gravity scale the forces alone.
    let at = flexbody_driver::simulate(&problem, &problem.start()).expect("rest");
    let (gradients, _) = at.at.gradients(&problem, &[0, 1]).expect("gradients");
    assert!(gradients[0][1].abs() < 1e-12, "{}", gradients[0][1]);
    assert!((gradients[1][1] * -GRAVITY / found[1] - 1.0).abs() < 1e-9);
}

/// A mass between two springs at ±1: F = 2 k (ℓ − ℓ0) y / ℓ, ℓ² = 1 + y².
fn truss(force: f64) -> Value {
    let spring = |x: f64| {
        json!({"spring": {"between": ["mass", "ground"], "at": {"a": [0, 0, 0], "b": [x, 0, 0]},
                          "rest_length": f64::hypot(1.0, 0.3), "stiffness": 1000}})
    };
    json!({
        "version": 1, "name": "truss", "analysis": "rest", "gravity": [0, 0, 0],
        "bodies": {"mass": {"shape": {"sphere": {"radius": 0.01}}, "mass": 1, "place": {"at": [0, 0.3, 0]}}},
        "joints": {"guide": {"prismatic": {"between": ["mass", "ground"], "at": "mass", "axis": [0, 1, 0]}}},
        "loads": {"left": spring(-1.0), "right": spring(1.0),
                  "push": {"force": {"body": "mass", "direction": [0, -1, 0], "magnitude": force}}},
        "functions": {"y": {"final": {"position": {"body": "mass", "direction": [0, 1, 0]}}}},
        "variables": {"push": {"path": "/loads/push/force/magnitude", "lower": 0, "upper": 100}}
    })
}

/// The truss bears a load below its limit, snaps through above it, and the message says so.
#[test]
fn a_shallow_truss_snaps_through_at_its_limit_load() {
    let rest = f64::hypot(1.0, 0.3);
    let force = |y: f64| 2000.0 * (rest / f64::hypot(1.0, y) - 1.0) * y;
    // The limit is at ℓ³ = ℓ0.
    let limit = force((rest.powf(2.0 / 3.0) - 1.0).sqrt());
    for part in [0.5, 0.9, 0.99] {
        let y = value(&truss(part * limit), "y");
        assert!(
            y > 0.0 && (force(y) / (part * limit) - 1.0).abs() < 1e-9,
            "{part}: {y}"
        );
        assert_eq!(notes_of(&truss(part * limit)).len(), 0, "{part}");
        gradients_are_exact(&parsed(&truss(part * limit)), &json!(part));
    }
    for part in [1.01, 1.5] {
        let y = value(&truss(part * limit), "y");
        assert!(
            y < -0.3 && (force(y) / (part * limit) - 1.0).abs() < 1e-9,
            "{part}: {y}"
        );
        let notes = notes_of(&truss(part * limit));
        assert!(
            notes.len() == 1 && notes[0].contains("snaps through"),
            "{notes:?}"
        );
    }
}

/// A lamp arm on a spring of rest length zero is balanced at every angle if k h a = m g l (Carwardine's lamp). Then it stays as
/// placed, and what would move it is no derivative; else it falls to one side.
#[test]
fn a_balanced_lamp_is_neutral() {
    let lamp = |stiffness: f64| {
        json!({
            "version": 1, "name": "lamp", "analysis": "rest",
            "bodies": {"arm": {
                "mass": 2, "inertia": {"xx": 0.01, "yy": 0.1, "zz": 0.1},
                "points": {"pivot": [-0.4, 0, 0], "hook": [-0.2, 0, 0]},
                "place": {"put": "pivot", "turn": about_z(0.4)}
            }},
            "joints": {"pivot": hinge(["arm", "ground"], json!([0, 0, 0]))},
            "loads": {"spring": {"spring": {"between": ["arm", "ground"], "at": {"a": "hook", "b": [0, 0.3, 0]},
                                            "rest_length": 0, "stiffness": stiffness}}},
            "functions": {"height": {"final": {"position": {"body": "arm", "direction": [0, 1, 0]}}}},
            "variables": {"stiffness": {"path": "/loads/spring/spring/stiffness", "lower": 1, "upper": 1e4}}
        })
    };
    let balanced = 2.0 * GRAVITY * 0.4 / (0.3 * 0.2);
    let document = lamp(balanced);
    assert!((value(&document, "height") - 0.4 * 0.4_f64.sin()).abs() < 1e-9);
    let notes = notes_of(&document);
    assert!(
        notes.len() == 1 && notes[0].contains("neutral: arm can move"),
        "{notes:?}"
    );
    let problem = parsed(&document);
    let at = flexbody_driver::simulate(&problem, &problem.start()).expect("rest");
    let failure = at.at.gradients(&problem, &[0]).expect_err("no derivative");
    assert!(
        failure.to_string().contains("nothing holds arm"),
        "{failure}"
    );
    for (part, height) in [(0.9, -0.4), (1.1, 0.4)] {
        let found = value(&lamp(part * balanced), "height");
        assert!((found - height).abs() < 1e-9, "{part}: {found}");
    }
}

/// A point mass has no rotation that would be free.
#[test]
fn a_point_mass_does_not_turn() {
    let notes = notes_of(&json!({
        "version": 1, "name": "bob", "analysis": "rest",
        "bodies": {
            "bar": rod(1.0, 2.0, json!({"put": "a"})),
            "bob": {"shape": "point", "mass": 0.5, "place": {"at": "bar.b"}}
        },
        "joints": {
            "pin": hinge(["bar", "ground"], json!([0, 0, 0])),
            "seat": {"spherical": {"between": ["bob", "bar"], "at": "bar.b"}}
        },
        "functions": {"y": along("bar", "b", [0.0, 1.0, 0.0])}
    }));
    assert!(
        notes.iter().all(|note| !note.contains("neutral")),
        "{notes:?}"
    );
}

/// What nothing holds is named.
#[test]
fn what_nothing_holds_is_named() {
    let document = json!({
        "version": 1, "name": "loose", "analysis": "rest",
        "bodies": {
            "held": rod(1.0, 1.0, json!({"put": "a", "turn": about_z(-1.0)})),
            "loose": {"shape": {"box": {"size": [0.1, 0.2, 0.3]}}, "mass": 1, "place": {"at": [2, 0, 0]}}
        },
        "joints": {"pin": hinge(["held", "ground"], json!([0, 0, 0]))}
    });
    let text = fault(&document);
    assert!(
        text.contains("nothing holds loose against gravity"),
        "{text}"
    );
    // Without a force it may stay where it is.
    let mut weightless = document;
    weightless["gravity"] = json!([0, 0, 0]);
    let notes = notes_of(&weightless);
    assert!(
        notes.len() == 1 && notes[0].contains("neutral"),
        "{notes:?}"
    );
}

/// A cantilever of n beams with a force across its end, P L² / EI = `part`: the place of the end.
fn elastica(n: usize, part: f64) -> Vec<f64> {
    let (width, height, young) = (0.02, 0.002, 2e11);
    let stiffness = young * width * f64::powi(height, 3) / 12.0;
    let length = 1.0 / n as f64;
    let (mut bodies, mut joints) = (serde_json::Map::new(), serde_json::Map::new());
    let mut other = "ground".to_owned();
    let mut place = json!({"put": "start"});
    for i in 0..n {
        let this = format!("part {i}");
        let beam = json!({
            "length": length, "section": {"rectangle": {"width": width, "height": height}}, "frame": "chord",
            "material": {"young": young, "poisson": 0.3, "density": 7800},
            "modes": {"bending_y": 2, "bending_z": 0, "torsion": 0, "stretch": 5}
        });
        bodies.insert(this.clone(), json!({"beam": beam, "place": place}));
        let weld = json!({"between": [this, other], "at": format!("{this}.start")});
        joints.insert(format!("weld {i}"), json!({"weld": weld}));
        place = json!({"put": "start", "at": format!("{this}.end")});
        other = this;
    }
    let end = json!({"force": {"body": other, "point": "end", "direction": [0, 1, 0], "magnitude": part * stiffness}});
    values(&json!({
        "version": 1, "name": "elastica", "analysis": "rest", "gravity": [0, 0, 0],
        "bodies": bodies, "joints": joints, "loads": {"end": end},
        "functions": {"x": along(&other, "end", [1.0, 0.0, 0.0]), "y": along(&other, "end", [0.0, 1.0, 0.0])}
    }))
}

/// Divided beams go to the elastica with the square of their number, whatever it turns (Mattiasson 1981, Int. J. Numer.
/// Methods Eng. 17, 145, table I).
#[test]
fn a_cantilever_of_many_beams_is_an_elastica() {
    for (part, across, shortened) in [(1.0, 0.30172, 0.05643), (10.0, 0.81061, 0.55500)] {
        let [coarse, fine] = [16, 32].map(|n| elastica(n, part));
        for (k, exact) in [1.0 - shortened, across].into_iter().enumerate() {
            let errors = [&coarse, &fine].map(|found| found[k] - exact);
            assert!(
                errors[0].abs() < 3e-3 && errors[1].abs() < 8e-4,
                "{part}: {errors:?}"
            );
            let limit = (4.0 * fine[k] - coarse[k]) / 3.0;
            assert!((limit - exact).abs() < 2e-5, "{part}: {limit} {exact}");
        }
    }
}

/// Two rods on springs in space: in another order, with the ends of joints exchanged, turned about the vertical by an angle,
/// in another unit of mass.
pub fn machine(reversed: bool, swapped: bool, angle: f64, mass: f64) -> Value {
    let (s, c) = f64::sin_cos(angle);
    let turned = |[x, y, z]: [f64; 3]| json!([x * c + z * s, y, z * c - x * s]);
    let ends = |a: &'static str, b: &'static str| if swapped { [b, a] } else { [a, b] };
    let rod = |at: [f64; 3], turn: Value| {
        json!({
            "shape": {"rod": {"length": 1, "radius": 0.02}}, "mass": 2.0 * mass,
            "points": {"a": [-0.5, 0, 0], "b": [0.5, 0, 0]},
            "place": {"put": "a", "relative_to": "base", "at": at, "turn": turn}
        })
    };
    let mut all = vec![
        (
            "base",
            json!({"shape": {"box": {"size": [0.2, 0.2, 0.2]}}, "mass": mass,
                        "place": {"turn": {"axis": [0, 1, 0], "angle": angle}}}),
        ),
        (
            "first",
            rod([0.0, 0.0, 0.0], json!({"axis": [0, 1, 1], "angle": 0.4})),
        ),
        (
            "second",
            rod([0.0, 1.0, 0.0], json!({"axis": [1, 0, 1], "angle": -0.7})),
        ),
    ];
    if reversed {
        all.reverse();
    }
    let all = all.into_iter().map(|(name, body)| (name.to_owned(), body));
    let bodies: serde_json::Map<String, Value> = all.collect();
    let spring = |other: &str, at: Value, stiffness: f64| {
        json!({"spring": {"between": ["first", other], "at": {"a": "b", "b": at},
                          "rest_length": 0.3, "stiffness": stiffness * mass}})
    };
    json!({
        "version": 1, "name": "machine", "analysis": "rest", "bodies": bodies,
        "joints": {
            "floor": {"weld": {"between": ["base", "ground"], "at": "base"}},
            "ball": {"spherical": {"between": ends("first", "base"), "at": "first.a"}},
            "cross": {"universal": {"between": ends("second", "base"), "at": "second.a",
                                    "axis": turned([0.0, 0.0, 1.0]), "cross": [0, 1, 0]}}
        },
        "loads": {"middle": spring("second", json!("b"), 40.0), "near": spring("base", json!([0.1, 0.5, 0]), 60.0)},
        "functions": {"span": {"final": {"distance": {"body": "first", "point": "b", "relative_to": "second", "from": "b"}}}}
    })
}

#[test]
fn equal_machines_rest_alike() {
    let span = value(&machine(false, false, 0.0, 1.0), "span");
    let others = [
        machine(true, false, 0.0, 1.0),
        machine(false, true, 0.0, 1.0),
        machine(true, true, 0.8, 1.0),
        machine(false, false, -2.0, 1e3),
        machine(false, false, 0.0, 1e-4),
    ];
    for (k, other) in others.iter().enumerate() {
        let found = value(other, "span");
        assert!((found / span - 1.0).abs() < 1e-9, "{k}: {found} {span}");
    }
}

/// A misspelt analysis is one fault, not also that of a missing simulation.
#[test]
fn a_misspelt_analysis_is_one_fault() {
    let mut file = pendulum(0.3, 2.0);
    file["analysis"] = json!("rset");
    file["functions"] = json!({"f": {"frequency": {"mode": 1}}});
    let text = fault(&file);
    assert!(text.contains("did you mean \"rest\"?"), "{text}");
    assert!(
        !text.contains("simulation") && !text.contains("/functions"),
        "{text}"
    );
}

/// Without time: no simulation, velocities, functions of time.
#[test]
fn what_needs_time_is_refused() {
    let with = |pointer: &str, new: Value| {
        let mut document = pendulum(0.3, 1.0);
        let (place, key) = pointer.rsplit_once('/').expect("a pointer");
        document.pointer_mut(place).expect("a place")[key] = new;
        fault(&document)
    };
    let cases = [
        (
            "/simulation",
            json!({"duration": 1}),
            "\"simulation\" beside \"analysis\": \"rest\"",
        ),
        (
            "/start",
            json!("equilibrium"),
            "\"start\" beside \"analysis\": \"rest\"",
        ),
        (
            "/initial_velocity",
            json!({"linear": [1, 0, 0]}),
            "\"initial_velocity\" beside",
        ),
        (
            "/bodies/bar/velocity",
            json!({"angular": [0, 0, 1]}),
            "a velocity beside",
        ),
        (
            "/joints/pin/revolute/start",
            json!({"turn": {"rate": 1}}),
            "a rate beside",
        ),
        (
            "/functions/x",
            json!({"integral": {"energy": "total"}}),
            "a function of time",
        ),
        ("/functions/x", json!("duration"), "a function of time"),
        (
            "/functions/x",
            json!({"final": {"of": {"energy": "total"}, "during": [0, 1]}}),
            "a function of time",
        ),
        ("/analysis", json!("motion"), "no \"simulation\""),
        ("/analysis", json!("still"), "\"still\""),
    ];
    for (pointer, new, expected) in cases {
        let text = with(pointer, new);
        assert!(text.contains(expected), "{pointer}: {text}");
    }
}

/// Drives are held as they are at t = 0.
#[test]
fn drives_are_held() {
    let document = json!({
        "version": 1, "name": "crank", "analysis": "rest",
        "bodies": {
            "crank": rod(0.3, 1.0, json!({"put": "a"})),
            "bob": rod(0.5, 1.0, json!({"put": "a", "at": "crank.b", "turn": about_z(0.2)}))
        },
        "joints": {"pin": hinge(["crank", "ground"], json!([0, 0, 0])), "hook": hinge(["bob", "crank"], json!("crank.b"))},
        "drives": {"motor": {"joint": "pin", "turn": {"harmonic": {"amplitude": 1, "frequency": 3, "phase": 0.6}}}},
        "functions": {"x": along("bob", "b", [1.0, 0.0, 0.0]), "y": along("bob", "b", [0.0, 1.0, 0.0])},
        "variables": {"phase": {"path": "/drives/motor/turn/harmonic/phase", "lower": 0, "upper": 1}}
    });
    let angle = 0.6_f64.sin();
    let found = values(&document);
    assert!((found[0] - 0.3 * angle.cos()).abs() < 1e-11, "{}", found[0]);
    assert!(
        (found[1] - 0.3 * angle.sin() + 0.5).abs() < 1e-11,
        "{}",
        found[1]
    );
    gradients_are_exact(&parsed(&document), &json!("crank"));
}

/// Beams from (−1, 0) and (1, 0) to a hinge at (0, h) with the force P there: the thrust is P / 2h, and the crown sinks by
/// P ℓ³ / (2 EA h²) with the length ℓ of a beam.
#[test]
fn a_three_hinged_arch_pushes_its_supports() {
    let (rise, push, young, width): (f64, f64, f64, f64) = (0.5, 100.0, 7e10, 0.05);
    let length = f64::hypot(1.0, rise);
    let beam = |at: Value, angle: f64| {
        json!({"beam": {
            "length": length, "section": {"rectangle": {"width": width, "height": width}}, "frame": "chord",
            "material": {"young": young, "poisson": 0.3, "density": 2700},
            "modes": {"bending_y": 2, "bending_z": 0, "torsion": 0, "stretch": 2}
        }, "place": {"put": "start", "at": at, "turn": about_z(angle)}})
    };
    let angle = rise.atan();
    let document = json!({
        "version": 1, "name": "arch", "analysis": "rest", "gravity": [0, 0, 0],
        "bodies": {
            "left": beam(json!([-1, 0, 0]), angle),
            "right": beam(json!([1, 0, 0]), std::f64::consts::PI - angle)
        },
        "joints": {
            "west": hinge(["left", "ground"], json!("left.start")),
            "east": hinge(["right", "ground"], json!("right.start")),
            "crown": hinge(["left", "right"], json!({"a": "end", "b": "end"}))
        },
        "loads": {"push": {"force": {"body": "left", "point": "end", "direction": [0, -1, 0], "magnitude": push}}},
        "functions": {
            "thrust": {"final": {"joint_force": {"joint": "west", "on": "left", "direction": [1, 0, 0]}}},
            "crown": along("left", "end", [0.0, 1.0, 0.0])
        },
        "variables": {"push": {"path": "/loads/push/force/magnitude", "lower": 0, "upper": 1e3},
                      "young": {"paths": ["/bodies/left/beam/material/young", "/bodies/right/beam/material/young"], "lower": 1e9, "upper": 1e12}}
    });
    let found = values(&document);
    let expected = push / (2.0 * rise);
    assert!(
        (found[0] / expected - 1.0).abs() < 1e-4,
        "{} {expected}",
        found[0]
    );
    let sinks = push * length.powi(3) / (2.0 * young * width * width * rise * rise);
    assert!(
        ((rise - found[1]) / sinks - 1.0).abs() < 1e-3,
        "{} {sinks}",
        rise - found[1]
    );
    gradients_are_exact(&parsed(&document), &json!("arch"));
}

/// Shells of a body.
fn plate(thickness: f64, place: Value) -> Value {
    json!({
        "elements": {
            "structure": {
                "mesh": {"plate": {"length": 1, "width": 0.5, "elements": [3, 1]}},
                "material": "aluminium", "thickness": thickness,
                "sets": {"start": {"node": {"at": [0, 0.5]}}, "end": {"node": {"at": [1, 0.5]}}}
            },
            "frame": {"chord": ["start", "end", "x0y0"]},
            "points": {"root": {"edge": "x0"}, "end": {"edge": "x1"}}
        },
        "place": place
    })
}

/// Machines that nothing lets move rest as their motion starts in equilibrium: panels that motors hold unfolded under their
/// weight, and two plates that are bolted to a T.
#[test]
fn what_cannot_move_rests_as_its_motion_starts() {
    let flat = json!({"x": 90});
    let panels = json!({
        "bodies": {
            "inner": plate(0.01, json!({"put": "root", "turn": flat})),
            "outer": plate(0.01, json!({"put": "root", "at": "inner.end", "turn": flat}))
        },
        "joints": {
            "hinge": {"revolute": {"between": ["inner", "ground"], "at": "inner.root", "axis": [0, 0, 1]}},
            "fold": {"revolute": {"between": ["outer", "inner"], "at": {"a": "root", "b": "end"}, "axis": [0, 0, 1]}}
        },
        "drives": {
            "first": {"joint": "hinge", "turn": {"polynomial": [0.2]}},
            "second": {"joint": "fold", "turn": {"polynomial": [-0.1]}}
        }
    });
    let bolted = json!({
        "bodies": {
            "inner": plate(0.01, json!({"put": "root", "turn": flat})),
            "outer": plate(0.01, json!({"put": "root", "at": "inner.end", "turn": [flat, {"z": 90}]}))
        },
        "joints": {
            "wall": {"weld": {"between": ["inner", "ground"], "at": "inner.root"}},
            "bolts": {"weld": {"between": ["outer", "inner"], "at": {"a": "root", "b": "end"}}}
        },
        "loads": {"side": {"force": {"body": "outer", "point": "end", "direction": [1, 0, 0.3], "magnitude": 20}}}
    });
    for (mut document, sag) in [(panels, 1e-2), (bolted, 1e-3)] {
        document["version"] = json!(1);
        document["name"] = json!("plates");
        document["materials"] = json!({"aluminium": {"young": 7e10, "poisson": 0.3, "density": 2700, "yield_stress": 1e8}});
        document["functions"] = json!({
            "y": along("outer", "end", [0.0, 1.0, 0.0]),
            "strain": {"final": {"strain_energy": {"body": "inner"}}},
            "stress": {"ks": {"rho": 50, "of": {"von_mises": {"body": "inner", "rho": 50}}}}
        });
        document["variables"] = json!({
            "thickness": {"paths": [
                "/bodies/inner/elements/structure/thickness", "/bodies/outer/elements/structure/thickness"
            ], "lower": 0.001, "upper": 0.1},
            "young": {"path": "/materials/aluminium/young", "lower": 1e10, "upper": 1e11}
        });
        let mut rest = document.clone();
        rest["analysis"] = json!("rest");
        document["start"] = json!("equilibrium");
        document["simulation"] =
            json!({"duration": 1e-7, "steps": 1, "method": {"radau": {"stages": 2}}});
        let (found, expected) = (values(&rest), values(&document));
        for (found, expected) in found.iter().zip(&expected) {
            assert!(
                (found / expected - 1.0).abs() < 1e-6,
                "{found} {expected} {rest}"
            );
        }
        assert!(found[1] > sag, "{found:?}");
        gradients_are_exact(&parsed(&rest), &rest);
        assert_eq!(notes_of(&rest).len(), 0, "{:?}", notes_of(&rest));
    }
}

/// Two joints at one place of an oblique beam share a frame there, in scenes and in their derivatives. Round-off of the
/// place differs between them.
#[test]
fn joints_at_one_place_of_a_beam_share_it() {
    for k in 0..12 {
        let angle = 0.3 + 0.5 * f64::from(k);
        let axis = [0.3 + 0.1 * f64::from(k), 0.7, -0.5];
        let document = json!({
            "version": 1, "name": "mast", "analysis": "rest",
            "bodies": {
                "mast": {"beam": {
                    "length": 1.3, "section": {"rectangle": {"width": 0.05, "height": 0.04}},
                    "material": {"young": 7e9, "poisson": 0.3, "density": 2700},
                    "modes": {"bending_y": 2, "bending_z": 2, "torsion": 1}
                }, "place": {"put": "start", "at": [0.1, -0.2, 0.7], "turn": {"axis": axis, "angle": angle}}},
                "left": rod(0.7, 1.0, json!({"put": "a", "at": "mast.end", "turn": {"axis": [1, 2, 0], "angle": angle}})),
                "right": rod(0.4, 2.0, json!({"put": "a", "at": "mast.end", "turn": {"axis": [0, 1, 3], "angle": -angle}}))
            },
            "joints": {
                "foot": {"weld": {"between": ["mast", "ground"], "at": "mast.start"}},
                "one": {"universal": {"between": ["left", "mast"], "at": "left.a", "axis": [1, 0, 0], "cross": [0, 0, 1]}},
                "two": {"spherical": {"between": ["right", "mast"], "at": "right.a"}}
            },
            "functions": {"y": along("mast", "end", [0.0, 1.0, 0.0])},
            "variables": {"left": {"path": "/bodies/left/mass", "lower": 0.1, "upper": 9},
                          "young": {"path": "/bodies/mast/beam/material/young", "lower": 1e9, "upper": 1e11}}
        });
        gradients_are_exact(&parsed(&document), &document);
    }
}

/// A machine with a screw comes to the same rest at every size: lengths, gravity and the lead grow alike.
#[test]
fn couplings_come_to_rest_at_every_size() {
    let file = |l: f64| {
        let size = |of: [f64; 3]| json!(of.map(|x| x * l));
        json!({
            "version": 1, "name": "arm", "analysis": "rest", "gravity": [0, -9.81 * l, 0],
            "bodies": {
                "arm": {"shape": {"box": {"size": size([0.8, 0.1, 0.06])}}, "mass": 2, "place": {"at": size([0.4, 0.0, 0.0])}},
                "nut": {"shape": {"box": {"size": size([0.2, 0.1, 0.1])}}, "mass": 0.7, "place": {"at": size([0.5, 0.1, 0.2])}}
            },
            "joints": {
                "h": {"revolute": {"between": ["arm", "ground"], "at": [0, 0, 0], "axis": [0, 0, 1]}},
                "cy": {"cylindrical": {"between": ["nut", "arm"], "at": size([0.5, 0.1, 0.2]), "axis": [1, 0, 0]}}
            },
            "loads": {"x": {"spring": {
                "between": ["nut", "ground"], "at": {"a": [0, 0, 0], "b": size([0.5, 0.8, 0.2])}, "rest_length": 0.2 * l, "stiffness": 60
            }}},
            "couplings": {"sc": {"screw": {"joint": "cy", "lead": 0.05 * l}}},
            "functions": {"a": {"final": {"angle": {"joint": "h"}}}}
        })
    };
    let of_metre = value(&file(1.0), "a");
    for l in [100.0, 0.3, 0.1, 0.01, 1e-3] {
        let found = value(&file(l), "a");
        assert!((found - of_metre).abs() < 1e-6, "{l}: {found} {of_metre}");
    }
}

/// A twisted beam comes to the same rest at every size, alone and as the start of a motion: torques grow as its volume.
#[test]
fn twisted_beams_come_to_rest_at_every_size() {
    let file = |l: f64, analysis: Value| {
        let document = json!({
            "version": 1, "name": "beam", "gravity": [0, 0, 0],
            "bodies": {"beam": {"beam": {
                "length": l, "section": {"rectangle": {"width": 0.03 * l, "height": 0.03 * l}},
                "material": {"young": 1e8, "density": 1000}, "strain": "linear",
                "modes": {"bending_y": 1, "bending_z": 2, "torsion": 1}
            }}},
            "joints": {"root": {"weld": {"between": ["beam", "ground"], "at": "beam.start"}}},
            "loads": {"twist": {"torque": {"body": "beam", "point": "end", "direction": [1, 0.1, 0.2], "magnitude": l.powi(3)}}},
            "functions": {"energy": {"final": {"strain_energy": {"body": "beam"}}}}
        });
        extended(document, &analysis)
    };
    let at_rest = |_: f64| json!({"analysis": "rest"});
    let as_start = |l: f64| json!({"start": "equilibrium", "simulation": {"duration": 1e-6 * l}});
    for analysis in [at_rest as fn(f64) -> Value, as_start] {
        let energy = |l: f64| value(&file(l, analysis(l)), "energy") / l.powi(3);
        let of_metre = energy(1.0);
        for l in [100.0, 0.1, 0.01, 1e-3, 1e-5] {
            let found = energy(l);
            let off = (found - of_metre).abs();
            assert!(off < 1e-7 * of_metre, "{}: {found} {of_metre}", analysis(l));
        }
    }
}
