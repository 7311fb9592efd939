//! Events of machines with flexible bodies, cases, couplings and drives, in other units and mirrored.

use super::phases::{arms, jumps, number, phases, simulated, whole};
use crate::reference::documents::problem;
use crate::reference::gradients::gradients_of_expressions_are_exact as gradients_are_exact;
use flexbody_driver::{Simulated, check};
use flexbody_problem::Problem;
use serde_json::Value;

fn remove(document: &mut Value, section: &str, key: &str) {
    let section = document[section].as_object_mut().expect("a section");
    section.shift_remove(key).expect("an entry");
}

/// [`arms`] whose lower one is an elastic beam.
fn elastic_arms(count: usize, method: &Value) -> Value {
    let mut document = arms(count, method);
    document["bodies"]["lower"] = json!({
        "beam": {
            "length": 0.8, "frame": "clamped",
            "section": {"rectangle": {"width": 0.02, "height": 0.04}},
            "material": {"young": 2e9, "poisson": 0.3, "density": 2700},
            "modes": {"bending_y": 2, "bending_z": 0, "torsion": 0},
            "damping": {"ratio": 0.02}
        },
        "place": {"put": "start", "at": "upper.b", "turn": {"axis": [0, 0, 1], "angle": 0.2}}
    });
    document["loads"]["wind"]["force"]["point"] = json!("end");
    document["loads"]["spring"]["spring"]["at"]["a"] = json!("end");
    document["functions"]["peak"]["ks"]["of"]["speed_squared"]["point"] = json!("end");
    for name in ["x", "early"] {
        let key = if name == "x" { "final" } else { "value" };
        let own = &mut document["functions"][name][key];
        let own = if name == "x" { own } else { &mut own["of"] };
        own["position"]["point"] = json!("end");
    }
    if count > 3 {
        for (event, level) in [("lets go", -0.95), ("snaps", 0.1)] {
            let when = &mut document["events"][event]["when"];
            when["measure"]["position"]["point"] = json!("start");
            when["reaches"] = json!(level);
        }
    }
    document["functions"]["bends"] = json!({"integral": {"strain_energy": {"body": "lower"}}});
    document["variables"]["mass"] =
        json!({"path": "/bodies/lower/beam/material/density", "lower": 100});
    document
}

/// An elastic body keeps its deformation and its rates through events; where it locks, its velocities jump with those of the
/// bodies.
#[test]
fn gradients_of_elastic_bodies_through_events_are_exact() {
    let methods = [
        json!({"steps": 150, "method": {"radau": {"stages": 2}}}),
        json!({"steps": 200, "method": {"bdf": {"order": 2}}}),
        json!({"steps": 200, "method": {"generalised_alpha": {"radius": 0.6}}}),
    ];
    for (count, method) in [(1, 0), (5, 0), (5, 1), (5, 2)] {
        let mut document = elastic_arms(count, &methods[method]);
        for name in ["phase", "gravity", "stiffness"] {
            remove(&mut document, "variables", name);
        }
        let what = format!("{count} events by {}", methods[method]);
        gradients_are_exact(&problem(&document), &json!(what));
    }
    let own = problem(&elastic_arms(5, &methods[0]));
    for (k, [before, after]) in jumps(&simulated(&own)).into_iter().enumerate() {
        match k {
            1 => assert!(before - after > 1e-3 * before, "{before} {after}"),
            _ => assert!(
                (before - after).abs() < 1e-6 * before,
                "{k}: {before} {after}"
            ),
        }
    }
}

/// Events that change nothing change no value of a machine that vibrates.
#[test]
fn marks_change_nothing_of_elastic_bodies() {
    let mut with = elastic_arms(1, &json!({"tolerance": 1e-9}));
    with["events"]["stop"] = json!({"when": {"time": 0.31}});
    remove(&mut with, "functions", "early");
    remove(&mut with, "variables", "off");
    let mut without = with.clone();
    without
        .as_object_mut()
        .expect("a document")
        .shift_remove("events");
    let (with, without) = (problem(&with), problem(&without));
    let (at, single) = (simulated(&with), simulated(&without));
    for name in ["x", "turn", "work", "speed", "peak", "bends"] {
        let f = without.function_names.iter().position(|own| own == name);
        let (a, b) = (
            at.value(number(&with, name)),
            single.value(f.expect("a function")),
        );
        assert!((a - b).abs() < 1e-6 * b.abs().max(0.01), "{name}: {a} {b}");
    }
}

/// Cases of a motion with events have the values of files of their own, and exact derivatives.
#[test]
fn events_in_cases_are_those_of_single_files() {
    let base = arms(3, &json!({"tolerance": 1e-9}));
    let mut document = base.clone();
    document["cases"] = json!({
        "light": {"set": {"/bodies/upper/mass": 1.5}},
        "late": {"set": {"/events/free/when/time": 0.6, "/loads/spring/spring/damping": 1.0}}
    });
    document["functions"]["worst"] =
        json!({"over_cases": {"function": "x", "by": {"ks": {"rho": 5}}}});
    let own = problem(&document);
    let at = simulated(&own);
    let value = |name: &str| {
        let f = own.function_names.iter().position(|own| own == name);
        at.value(f.unwrap_or_else(|| panic!("{name} of {:?}", own.function_names)))
    };
    let changes: [(&str, &[(&str, f64)]); 2] = [
        ("light", &[("/bodies/upper/mass", 1.5)]),
        (
            "late",
            &[
                ("/events/free/when/time", 0.6),
                ("/loads/spring/spring/damping", 1.0),
            ],
        ),
    ];
    for (case, set) in changes {
        let mut single = base.clone();
        for (path, number) in set {
            *single.pointer_mut(path).expect("there") = json!(number);
        }
        let single = problem(&single);
        let alone = simulated(&single);
        for f in whole(&single) {
            let name = &single.function_names[f];
            assert_eq!(
                alone.value(f),
                value(&format!("{name} in {case}")),
                "{name} in {case}"
            );
        }
    }
    gradients_are_exact(&own, &json!("cases"));
}

/// A drive that comes on takes its joint on from where it is, another one later; between them the joint is free. Turns are
/// counted.
#[test]
fn drives_come_on_where_their_joints_are() {
    let (about, torque, [t1, t2, t3, t]) = (0.5, 40.0, [0.7, 1.5, 1.9, 2.6]);
    let (rate, amplitude, frequency) = (9.0, 0.8, 0.6);
    let document = json!({
        "version": 1, "name": "driven wheel", "gravity": [0, -9.81, 0],
        "bodies": {"wheel": {"mass": 5, "inertia": {"xx": 1, "yy": 1, "zz": about}}},
        "joints": {"axle": {"revolute": {"between": ["wheel", "ground"], "at": [0, 0, 0], "axis": [0, 0, 1]}}},
        "loads": {"motor": {"torque": {"body": "wheel", "direction": [0, 0, 1], "magnitude": torque}}},
        "drives": {
            "runs": {"joint": "axle", "turn": {"rate": rate}},
            "swings": {"joint": "axle", "turn": {"harmonic": {"amplitude": amplitude, "frequency": frequency}}}
        },
        "events": {
            "catch": {"when": {"time": t1}, "on": ["runs"]},
            "free": {"when": {"time": t2}, "off": ["runs", "motor"]},
            "swing": {"when": {"time": t3}, "on": ["swings"]}
        },
        "simulation": {"duration": t, "tolerance": 1e-11},
        "functions": {
            "angle": {"final": {"angle": {"joint": "axle"}}},
            "caught": {"value": {"at": {"event": "free"}, "of": {"angle": {"joint": "axle"}}}},
            "holds": {"value": {"at": {"event": "free"}, "of": {"joint_moment": {"joint": "axle", "direction": [0, 0, 1]}}}},
            "rate": {"final": {"angle_rate": {"joint": "axle"}}}
        },
        "variables": {
            "torque": {"path": "/loads/motor/torque/magnitude", "lower": 1},
            "catch": {"path": "/events/catch/when/time", "lower": 0.1, "upper": 1.2},
            "free": {"path": "/events/free/when/time", "lower": 1.3, "upper": 1.7},
            "swing": {"path": "/events/swing/when/time", "lower": 1.8, "upper": 2.2},
            "rate": {"path": "/drives/runs/turn/rate"},
            "amplitude": {"path": "/drives/swings/turn/harmonic/amplitude"}
        }
    });
    let own = problem(&document);
    let at = simulated(&own);
    let value = |name: &str| at.value(number(&own, name));
    let wave = |t: f64| amplitude * (std::f64::consts::TAU * frequency * t).sin();
    let caught = 0.5 * torque / about * t1 * t1 + rate * (t2 - t1);
    let angle = caught + rate * (t3 - t2) + wave(t) - wave(t3);
    let wave_rate = amplitude
        * std::f64::consts::TAU
        * frequency
        * (std::f64::consts::TAU * frequency * t).cos();
    let expected = [
        ("angle", angle),
        ("caught", caught),
        ("holds", -torque),
        ("rate", wave_rate),
    ];
    for (name, expected) in expected {
        let off = (value(name) - expected).abs();
        assert!(
            off < 1e-8 * expected.abs(),
            "{name} {} {expected}",
            value(name)
        );
    }
    assert!(caught > 20.0);
    let found = check(&own, &own.start()).expect("derivatives");
    let of = |name: &str, variable: &str| {
        let f = number(&own, name);
        let i = own
            .variables()
            .iter()
            .position(|v| v.name == variable)
            .expect("a variable");
        found
            .iter()
            .find(|d| (d.function, d.variable) == (f, i))
            .expect("a derivative")
            .adjoint
    };
    let by_catch = torque / about * t1 - rate;
    assert!((of("angle", "catch") - by_catch).abs() < 1e-8 * by_catch.abs());
    assert!((of("angle", "rate") - (t3 - t1)).abs() < 1e-8);
    // Where the derivative of a value is zero, the gradient has others.
    gradients_are_exact(&own, &json!("drives"));
}

/// A gear goes on coupling while loads and joints elsewhere change, over turns.
#[test]
fn couplings_hold_through_events() {
    let wheel = |radius: f64, x: f64| json!({"shape": {"cylinder": {"radius": radius, "length": 0.02}}, "mass": 2, "place": {"at": [x, 0, 0]}});
    let hinge = |name: &str, x: f64| json!({"revolute": {"between": [name, "ground"], "at": [x, 0, 0], "axis": [0, 0, 1]}});
    let base = json!({
        "version": 1, "name": "gears", "gravity": [0, 0, 0],
        "bodies": {"large": wheel(0.2, 0.0), "small": wheel(0.1, 0.3), "disk": wheel(0.1, 0.3)},
        "joints": {
            "large hinge": hinge("large", 0.0), "small hinge": hinge("small", 0.3), "disk hinge": hinge("disk", 0.3),
            "clutch": {"weld": {"between": ["disk", "small"], "at": [0.3, 0, 0]}}
        },
        "couplings": {"mesh": {"gear": {"gears": ["large", "small"], "teeth": [40, 20]}}},
        "loads": {"motor": {"torque": {"body": "large", "direction": [0, 0, 1], "magnitude": 3}}},
        "events": {
            "engage": {"when": {"time": 0.8}, "on": ["clutch"]},
            "stop": {"when": {"time": 1.5}, "off": ["motor"]}
        },
        "simulation": {"duration": 2, "tolerance": 1e-10},
        "functions": {
            "large": {"final": {"angle": {"joint": "large hinge"}}},
            "small": {"final": {"angle": {"joint": "small hinge"}}},
            "disk": {"final": {"angle": {"joint": "disk hinge"}}}
        },
        "variables": {
            "motor": {"path": "/loads/motor/torque/magnitude", "lower": 0.1},
            "mass": {"path": "/bodies/disk/mass", "lower": 0.1},
            "engage": {"path": "/events/engage/when/time", "lower": 0.1, "upper": 1.2}
        }
    });
    let own = problem(&base);
    let at = simulated(&own);
    let value = |name: &str| at.value(number(&own, name));
    // Inertias that the motor feels: that of the large wheel, then of the small ones at twice the speed.
    let (m, large, small) = (3.0, 0.5 * 2.0 * 0.04, 0.5 * 2.0 * 0.01);
    let (alone, joined) = (large + 4.0 * small, large + 8.0 * small);
    let rate = m / alone * 0.8 * alone / joined;
    let (first, then) = (0.5 * m / alone * 0.64, 0.7_f64);
    let end =
        first + rate * then + 0.5 * m / joined * then * then + (rate + m / joined * then) * 0.5;
    assert!(end > 20.0);
    let off = |name: &str, expected: f64| {
        let own = value(name);
        assert!(
            (own - expected).abs() < 1e-8 * expected.abs(),
            "{name} {own} {expected}"
        );
    };
    off("large", end);
    off("small", -2.0 * end);
    off("disk", -2.0 * (end - first));
    gradients_are_exact(&own, &json!("gears"));
    let mut opened = base.clone();
    opened["couplings"]["mesh"]["gear"]["carrier"] = json!("ground");
    opened["events"]["stop"]["off"] = json!(["small hinge"]);
    let Err(found) = Problem::parse(&opened.to_string(), "gears.json", &[]) else {
        panic!("a gear without its hinge");
    };
    assert!(
        found
            .to_string()
            .contains("which no joints join to \"ground\" in all phases of the motion"),
        "{found}"
    );
}

/// The same machine with lengths in mm, masses in g, forces in mN, and mirrored in x: equal motions.
#[test]
fn other_units_and_mirrored_machines_move_alike() {
    let base = arms(5, &json!({"tolerance": 1e-10}));
    let own = problem(&base);
    let at = simulated(&own);
    let mut small = base.clone();
    for body in ["upper", "lower"] {
        let body = &mut small["bodies"][body];
        scale(&mut body["shape"]["box"]["size"], 1e3);
        scale(&mut body["points"], 1e3);
        scale(&mut body["mass"], 1e3);
    }
    scale(&mut small["gravity"], 1e3);
    // N m are 1e9 g mm²/s²; N are 1e6 g mm/s²; N/m are 1e3 g/s².
    scale(
        &mut small["loads"]["motor"]["torque"]["magnitude"]["harmonic"]["amplitude"],
        1e9,
    );
    scale(
        &mut small["loads"]["wind"]["force"]["magnitude"]["harmonic"]["amplitude"],
        1e6,
    );
    let spring = &mut small["loads"]["spring"]["spring"];
    scale(&mut spring["at"]["b"], 1e3);
    scale(&mut spring["rest_length"], 1e3);
    scale(&mut spring["stiffness"], 1e3);
    scale(&mut spring["damping"], 1e3);
    for event in ["lets go", "snaps"] {
        scale(&mut small["events"][event]["when"]["reaches"], 1e3);
    }
    small["functions"]["peak"]["ks"]["rho"] = json!(2e-6);
    let mut mirrored = base.clone();
    mirror(&mut mirrored);
    let energy = 1e9;
    let all = [
        (
            "units",
            small,
            [1e3, 1.0, energy, 1e6, 1e6, 1e3, 1.0, energy],
        ),
        (
            "mirrored",
            mirrored,
            [-1.0, -1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0],
        ),
    ];
    for (what, other, factors) in all {
        let other = problem(&other);
        let found = simulated(&other);
        for (f, factor) in whole(&own).into_iter().zip(factors) {
            let name = &own.function_names[f];
            let (a, b) = (at.value(f) * factor, found.value(number(&other, name)));
            let size = a.abs().max(factor.abs());
            assert!((a - b).abs() < 1e-7 * size, "{what} {name}: {a} {b}");
        }
        gradients_are_exact(&other, &json!(what));
    }
}

fn scale(value: &mut Value, by: f64) {
    match value {
        Value::Number(own) => *value = json!(own.as_f64().expect("a number") * by),
        Value::Array(all) => all.iter_mut().for_each(|own| scale(own, by)),
        Value::Object(all) => all.values_mut().for_each(|own| scale(own, by)),
        _ => {}
    }
}

/// Mirrors the machine in the plane x = 0: turns about z change their sign.
fn mirror(document: &mut Value) {
    for body in ["upper", "lower"] {
        let points = document["bodies"][body]["points"]
            .as_object_mut()
            .expect("points");
        points.values_mut().for_each(|own| scale(&mut own[0], -1.0));
    }
    let paths = [
        "/bodies/lower/place/turn/angle",
        "/loads/motor/torque/direction/2",
        "/loads/wind/force/direction/0",
        "/loads/spring/spring/at/b/0",
        "/events/locks/when/reaches",
        "/events/snaps/when/reaches",
    ];
    for path in paths {
        scale(document.pointer_mut(path).expect(path), -1.0);
    }
}

/// Two events at one time are refused, whichever is the first in the file; the same height twice is not.
#[test]
fn events_at_once_are_named() {
    let height = |level: f64| json!({"measure": {"position": {"body": "ball", "direction": [0, 1, 0]}}, "reaches": level});
    let way = |level: f64| json!({"measure": {"position": {"body": "ball", "direction": [1, 0, 0]}}, "reaches": level});
    let throw = |first: Value, second: Value| {
        json!({
            "version": 1, "name": "throw", "gravity": [0, -10, 0],
            "bodies": {"ball": {"shape": "point", "mass": 2, "velocity": {"linear": [4, 6, 0]}}},
            "simulation": {"duration": 1.5},
            "events": {"one": {"when": first}, "two": {"when": second}},
            "functions": {"time": {"event_time": "two"}}
        })
    };
    // At t = 0.5 s it is at (2, 1.75).
    let pairs = [
        (height(1.75), way(2.0)),
        (way(2.0), height(1.75)),
        (json!({"time": 0.5}), way(2.0)),
        (way(2.0), json!({"time": 0.5})),
    ];
    for (first, second) in pairs {
        let own = problem(&throw(first, second));
        let Err(found) = Simulated::of(&own, &own.start()) else {
            panic!("it runs");
        };
        let text = found.to_string();
        assert!(
            text.starts_with("the events \"one\" and \"two\" come at once, at t = 5.000000e-1 s"),
            "{text}"
        );
    }
    let own = problem(&throw(height(1.0), height(1.0)));
    let at = simulated(&own);
    assert_eq!(phases(&at).list.len(), 3);
    let time = 1.0;
    assert!((at.value(number(&own, "time")) - time).abs() < 1e-9);
}

/// The power of a drive counts while it is on: two drives turn a box, one after the other, by jerks of its speed.
#[test]
fn a_drive_that_is_off_has_no_power() {
    let document = json!({
        "version": 1, "name": "two drives", "gravity": [0, 0, 0],
        "bodies": {"b": {"shape": {"box": {"size": [1, 1, 0.1]}}, "mass": 6}},
        "joints": {"h": {"revolute": {"between": ["b", "ground"], "at": [0, 0, 0], "axis": [0, 0, 1]}}},
        "drives": {
            "first": {"joint": "h", "turn": {"polynomial": [0, 0, 0.5]}},
            "second": {"joint": "h", "turn": {"polynomial": [0, 1, 1]}}
        },
        "simulation": {"duration": 2, "tolerance": 1e-10},
        "events": {"e": {"when": {"time": 1}, "off": ["first"], "on": ["second"]}},
        "functions": {
            "work of first": {"integral": {"power": {"drive": "first"}}},
            "work of second": {"integral": {"power": {"drive": "second"}}}
        }
    });
    let own = problem(&document);
    let at = simulated(&own);
    // ∫ J φ̈ φ̇ with φ̈ = φ̇ = t, then φ̈ = 2 and φ̇ = 1 + 2 (t − 1).
    for (name, exact) in [("work of first", 0.5), ("work of second", 8.0)] {
        let found = at.value(number(&own, name));
        assert!((found - exact).abs() < 1e-8, "{name}: {found}");
    }
}

/// After a drive has gone off its joint may bear more than it: a weld beside it shares all reactions. That is no matter of the drive,
/// and what has no value in a phase is told without a panic.
#[test]
fn a_weld_beside_the_joint_of_a_drive_that_was_on() {
    let file = |on: bool| {
        let mut file = json!({
            "version": 1, "name": "latched", "gravity": [0, 0, 0],
            "bodies": {"b": {"shape": {"box": {"size": [0.4, 0.1, 0.1]}}, "mass": 1, "points": {"e": [-0.2, 0, 0]},
                             "place": {"put": "e", "at": [0.2, 0.1, 0]}}},
            "joints": {
                "f": {"revolute": {"between": ["b", "ground"], "at": "b.e", "axis": [0, 0, 1]}},
                "lk": {"weld": {"between": ["b", "ground"], "at": "b.e"}}
            },
            "drives": {"m": {"joint": "f", "turn": {"rate": 1}}},
            "events": {"e1": {"when": {"time": 0.2}, "off": ["m"]}, "e2": {"when": {"time": 0.5}, "on": ["lk"]}},
            "simulation": {"duration": 1},
            "functions": {
                "W": {"integral": {"power": {"drive": "m"}}},
                "a": {"final": {"angle": {"joint": "f"}}},
                "mean": {"over_cases": {"function": "a", "by": "mean"}}
            },
            "cases": {"falls": {"set": {"/gravity": [0, -3, 0]}}},
            "variables": {"mass": {"path": "/bodies/b/mass", "lower": 0.5, "upper": 2}},
            "objective": {"minimise": "mean"}
        });
        if on {
            file["functions"]["R"] =
                json!({"integral": {"joint_moment": {"joint": "f", "direction": [0, 0, 1]}}});
        }
        file
    };
    let own = problem(&file(false));
    let at = Simulated::of(&own, &own.start()).expect("a motion");
    let work = own
        .function_names
        .iter()
        .position(|name| name.starts_with('W'));
    let work = at.value(work.expect("a function"));
    // The drive turns the box by 0.2 rad against gravity; its rate does not change.
    let lift = 0.2 * 3.0 * 0.2_f64.sin();
    assert!((work - lift).abs() < 1e-6, "{work} {lift}");
    assert!(check(&own, &own.start()).is_ok());
    let own = problem(&file(true));
    let found = check(&own, &own.start()).expect("derivatives");
    let unknown = found.iter().filter(|own| own.adjoint.is_nan());
    let unknown: Vec<&str> = unknown
        .map(|found| own.function_names[found.function].as_str())
        .collect();
    assert_eq!(unknown, ["R in falls"]);
}

/// A joint moves as it starts until an event puts on its drive.
#[test]
fn a_drive_that_comes_on_later_leaves_the_start_free() {
    let file = json!({
        "version": 1, "name": "late", "gravity": [0, 0, 0],
        "bodies": {"cart": {"shape": {"box": {"size": [0.1, 0.1, 0.1]}}, "mass": 1}},
        "joints": {"rail": {"prismatic": {
            "between": ["cart", "ground"], "at": [0, 0, 0], "axis": [1, 0, 0], "start": {"slide": {"rate": 0.5}}
        }}},
        "drives": {"late": {"joint": "rail", "slide": {"rate": 0.2}}},
        "events": {"starts": {"when": {"time": 0.5}, "on": ["late"]}},
        "simulation": {"duration": 1},
        "functions": {"x": {"final": {"position": {"body": "cart", "direction": [1, 0, 0]}}}}
    });
    let own = problem(&file);
    let found = simulated(&own).value(number(&own, "x"));
    assert!((found - 0.35).abs() < 1e-10, "{found}");
}
