//! Motions that events divide: closed forms, exact derivatives through one, two and five events by every method, equal results
//! of equal machines, energy in jumps, and events that do not come.

use crate::reference::documents::{problem, reversed};
use crate::reference::gradients::gradients_of_expressions_are_exact as gradients_are_exact;
use flexbody_driver::analysed::InCases;
use flexbody_driver::{Simulated, Simulation, check};
use flexbody_problem::Problem;
use nalgebra::{DMatrix, DVector};
use serde_json::Value;

/// All functions of the whole motion, by name.
pub(super) fn whole(problem: &Problem) -> Vec<usize> {
    (problem.composition.first..problem.function_names.len()).collect()
}

pub(super) fn number(problem: &Problem, name: &str) -> usize {
    let mut all = whole(problem).into_iter();
    all.find(|&f| problem.function_names[f] == name)
        .expect("a function")
}

pub(super) fn simulated(problem: &Problem) -> Simulated {
    Simulated::of(problem, &problem.start()).unwrap_or_else(|failure| panic!("{failure}"))
}

pub(super) fn phases(at: &Simulated) -> &InCases<Simulated> {
    match at {
        Simulated::Cases(all) => all,
        _ => panic!("not divided"),
    }
}

/// The phases with their jumps of kinetic energy.
pub(super) fn jumps(at: &Simulated) -> Vec<[f64; 2]> {
    let own = phases(at).each().filter_map(|(case, at)| match at {
        Simulated::Motion(at) => Simulation::jump(at, &case.problem),
        _ => None,
    });
    own.collect()
}

/// A double pendulum with a motor, wind and a spring. Five events: the motor stops at a time, the elbow locks at an angle, it
/// comes free at a time, it lets go at a height, and the spring lets go at a place. The first `count` of them come.
pub(super) fn arms(count: usize, method: &Value) -> Value {
    let position =
        |direction: Value| json!({"position": {"body": "lower", "direction": direction}});
    let mut document = json!({
        "version": 1, "name": "arms", "gravity": [0, -9.81, 0],
        "bodies": {
            "upper": {"shape": {"box": {"size": [1, 0.1, 0.1]}}, "mass": 2,
                "points": {"a": [-0.5, 0, 0], "b": [0.5, 0, 0]}, "place": {"put": "a", "at": [0, 0, 0]}},
            "lower": {"shape": {"box": {"size": [0.8, 0.08, 0.08]}}, "mass": 1,
                "points": {"a": [-0.4, 0, 0], "b": [0.4, 0, 0]},
                "place": {"put": "a", "at": "upper.b", "turn": {"axis": [0, 0, 1], "angle": 0.2}}}
        },
        "joints": {
            "shoulder": {"revolute": {"between": ["upper", "ground"], "at": "upper.a", "axis": [0, 0, 1]}},
            "elbow": {"revolute": {"between": ["lower", "upper"], "at": "upper.b", "axis": [0, 0, 1]}},
            "lock": {"weld": {"between": ["lower", "upper"], "at": "upper.b"}}
        },
        "loads": {
            "motor": {"torque": {"body": "upper", "direction": [0, 0, 1],
                "magnitude": {"harmonic": {"amplitude": 3, "frequency": 0.7, "phase": 0.4}}}},
            "wind": {"force": {"body": "lower", "direction": [1, 0, 0],
                "magnitude": {"harmonic": {"amplitude": 2, "frequency": 1.1, "phase": 0.1}}}},
            "spring": {"spring": {"between": ["lower", "ground"], "at": {"a": "b", "b": [0.5, 1, 0]},
                "rest_length": 0.7, "stiffness": 8, "damping": 0.3}}
        },
        "simulation": {"duration": 0.9},
        "events": {
            "stop": {"when": {"time": 0.15}, "off": ["motor"]},
            "locks": {"when": {"measure": {"angle": {"joint": "shoulder"}}, "reaches": -0.5},
                "on": ["lock"]},
            "free": {"when": {"time": 0.55}, "off": ["lock"]},
            "lets go": {"when": {"measure": position(json!([0, 1, 0])), "reaches": -1.0}, "off": ["elbow"]},
            "snaps": {"when": {"measure": position(json!([1, 0, 0])), "reaches": 0.4}, "off": ["spring"]}
        },
        "functions": {
            "x": {"final": position(json!([1, 0, 0]))},
            "turn": {"final": {"angle": {"joint": "elbow"}}},
            "work": {"integral": {"energy": "kinetic"}},
            "speed": {"mean": {"speed_squared": {"body": "upper", "point": "b"}}},
            "peak": {"ks": {"rho": 2, "of": {"speed_squared": {"body": "lower"}}}},
            "early": {"value": {"at": {"event": "stop"}, "of": position(json!([0, 1, 0]))}}
        },
        "variables": {
            "mass": {"path": "/bodies/lower/mass", "lower": 0.1},
            "torque": {"path": "/loads/motor/torque/magnitude/harmonic/amplitude"},
            "phase": {"path": "/loads/wind/force/magnitude/harmonic/phase"},
            "off": {"path": "/events/stop/when/time", "lower": 0.01},
            "stiffness": {"path": "/loads/spring/spring/stiffness", "lower": 0.1},
            "angle": {"path": "/bodies/lower/place/turn/angle"},
            "gravity": {"path": "/gravity/1"},
            "duration": {"path": "/simulation/duration", "lower": 0.1}
        }
    });
    let Value::Object(simulation) = &mut document["simulation"] else {
        panic!("an object");
    };
    for (key, value) in method.as_object().expect("settings") {
        simulation.insert(key.clone(), value.clone());
    }
    let Value::Object(events) = &mut document["events"] else {
        panic!("an object");
    };
    let names: Vec<String> = events.keys().cloned().collect();
    names[count..].iter().for_each(|name| {
        events.shift_remove(name);
    });
    if count > 1 {
        document["variables"]["lock"] = json!({"path": "/events/locks/when/reaches"});
        document["functions"]["locks at"] = json!({"event_time": "locks"});
        document["functions"]["after"] = json!({"integral": {"of": {"energy": "kinetic"}, "during": {"from": {"event": "locks"}}}});
    } else {
        document["joints"]
            .as_object_mut()
            .expect("joints")
            .shift_remove("lock");
    }
    document
}

#[test]
fn gradients_through_events_are_exact_by_every_method() {
    let methods = [
        json!({"tolerance": 1e-9}),
        json!({"steps": 40, "method": {"radau": {"stages": 3}}}),
        json!({"tolerance": 1e-7, "method": {"radau": {"stages": 2}}}),
        json!({"steps": 60, "method": {"bdf": {"order": 2}}}),
        json!({"steps": 60, "method": {"bdf": {"order": 4}}}),
        json!({"steps": 60, "method": {"generalised_alpha": {"radius": 0.8}}}),
    ];
    for method in &methods {
        for count in [1, 2, 5] {
            let own = problem(&arms(count, method));
            gradients_are_exact(&own, &json!(format!("{count} events by {method}")));
        }
    }
}

/// A motor stops: a wheel of inertia J turns by M t₁ t − M t₁²/2 over J. So do its derivatives.
#[test]
fn a_motor_stops() {
    let document = json!({
        "version": 1, "name": "wheel", "gravity": [0, 0, 0],
        "bodies": {"wheel": {"shape": {"cylinder": {"radius": 0.2, "length": 0.05}}, "mass": 3}},
        "joints": {"axle": {"revolute": {"between": ["wheel", "ground"], "at": [0, 0, 0], "axis": [0, 0, 1]}}},
        "loads": {"motor": {"torque": {"body": "wheel", "direction": [0, 0, 1], "magnitude": 7}}},
        "simulation": {"duration": 2, "tolerance": 1e-10},
        "events": {"stop": {"when": {"time": 0.75}, "off": ["motor"]}},
        "functions": {"turned": {"final": {"rotation": {"body": "wheel", "axis": [0, 0, 1]}}}},
        "variables": {
            "torque": {"path": "/loads/motor/torque/magnitude"},
            "stop": {"path": "/events/stop/when/time", "lower": 0.1},
            "duration": {"path": "/simulation/duration", "lower": 0.1}
        }
    });
    let own = problem(&document);
    let at = simulated(&own);
    let f = number(&own, "turned");
    let Simulated::Motion(first) = phases(&at).list[0].as_ref().expect("a phase") else {
        panic!("a motion");
    };
    let inertia = first.at.scene.model.bodies[0].inertia;
    let about = (0..3).map(|i| inertia[(i, i)]);
    let j = about.fold(0.0, f64::max);
    let (m, t1, t) = (7.0, 0.75, 2.0);
    let turned = m * (t1 * t - 0.5 * t1 * t1) / j;
    // More than a whole turn.
    assert!(
        turned > 40.0 && (at.value(f) - turned).abs() < 1e-8 * turned,
        "{} {turned}",
        at.value(f)
    );
    let exact = [turned / m, m * (t - t1) / j, m * t1 / j];
    for d in check(&own, &own.start())
        .expect("derivatives")
        .iter()
        .filter(|d| d.function == f)
    {
        let exact = exact[d.variable];
        assert!(
            (d.adjoint - exact).abs() < 1e-8 * exact.abs(),
            "{d:?} {exact}"
        );
    }
}

/// A body that meets another and grips it: momentum stays, half of the energy goes.
#[test]
fn energy_falls_where_bodies_are_gripped() {
    let body = |x: f64, speed: f64| {
        json!({"shape": {"box": {"size": [0.2, 0.1, 0.1]}}, "mass": 2, "place": {"at": [x, 0, 0]},
            "velocity": {"linear": [speed, 0, 0]}})
    };
    let document = json!({
        "version": 1, "name": "grip", "gravity": [0, 0, 0],
        "bodies": {"runs": body(0.0, 3.0), "waits": body(1.0, 0.0)},
        "joints": {"grip": {"weld": {"between": ["runs", "waits"], "at": [0.1, 0, 0]}}},
        "simulation": {"duration": 1, "tolerance": 1e-10},
        "events": {"grips": {"when": {
            "measure": {"position": {"body": "runs", "direction": [1, 0, 0]}}, "reaches": 0.8}, "on": ["grip"]}},
        "functions": {
            "x": {"final": {"position": {"body": "waits", "direction": [1, 0, 0]}}},
            "time": {"event_time": "grips"}
        },
        "variables": {
            "mass": {"path": "/bodies/runs/mass", "lower": 0.1}, "speed": {"path": "/bodies/runs/velocity/linear/0"},
            "gap": {"path": "/events/grips/when/reaches"}
        }
    });
    let own = problem(&document);
    let at = simulated(&own);
    let time = 0.8 / 3.0;
    assert!((at.value(number(&own, "time")) - time).abs() < 1e-12);
    assert!((at.value(number(&own, "x")) - (1.0 + 1.5 * (1.0 - time))).abs() < 1e-12);
    let [[before, after]] = jumps(&at)[..] else {
        panic!("one event");
    };
    assert!(
        (before - 9.0).abs() < 1e-12 && (after - 4.5).abs() < 1e-12,
        "{before} {after}"
    );
    gradients_are_exact(&own, &json!("grip"));
}

/// No jump gains energy, and where joints only open there is none.
#[test]
fn energy_never_rises_in_a_jump() {
    let own = problem(&arms(5, &json!({"tolerance": 1e-9})));
    let found = jumps(&simulated(&own));
    assert_eq!(found.len(), 5);
    for (k, [before, after]) in found.into_iter().enumerate() {
        let lost = before - after;
        match k {
            1 => assert!(lost > 0.1 * before, "{before} {after}"),
            _ => assert!(lost.abs() < 1e-8 * before, "{k}: {before} {after}"),
        }
    }
}

/// Events that change nothing change no value: loads go on in time, angles in turns.
#[test]
fn marks_change_nothing() {
    let mut with = arms(1, &json!({"tolerance": 1e-11}));
    with["events"]["stop"] = json!({"when": {"time": 0.31}});
    with["functions"]
        .as_object_mut()
        .expect("functions")
        .shift_remove("early");
    with["variables"]
        .as_object_mut()
        .expect("variables")
        .shift_remove("off");
    let mut without = with.clone();
    without
        .as_object_mut()
        .expect("a document")
        .shift_remove("events");
    let (with, without) = (problem(&with), problem(&without));
    let (at, single) = (simulated(&with), simulated(&without));
    for name in ["x", "turn", "work", "speed", "peak"] {
        let (a, f) = (
            at.value(number(&with, name)),
            without.function_names.iter().position(|own| own == name),
        );
        let b = single.value(f.expect("a function"));
        assert!((a - b).abs() < 1e-8 * b.abs().max(0.1), "{name}: {a} {b}");
    }
}

/// A machine that is turned, whose joints have their sides swapped, or with its entries in another order moves alike.
#[test]
fn equal_machines_move_alike() {
    let base = arms(5, &json!({"tolerance": 1e-10}));
    let own = problem(&base);
    let at = simulated(&own);
    let reordered = reversed(&base, &["bodies", "joints", "loads", "functions"]);
    let mut swapped = base.clone();
    swapped["joints"]["lock"]["weld"]["between"] = json!(["upper", "lower"]);
    let mut turned = base.clone();
    turn(&mut turned);
    let all = [
        ("reordered", reordered),
        ("swapped", swapped),
        ("turned", turned),
        ("oblique", oblique(&base)),
    ];
    for (what, other) in all {
        let other = problem(&other);
        let found = simulated(&other);
        for f in whole(&own) {
            let name = &own.function_names[f];
            let (a, b) = (at.value(f), found.value(number(&other, name)));
            assert!(
                (a - b).abs() < 1e-7 * a.abs().max(1.0),
                "{what} {name}: {a} {b}"
            );
        }
        gradients_are_exact(&other, &json!(what));
    }
}

/// The machine as a part that is turned about an oblique axis.
fn oblique(base: &Value) -> Value {
    let (axis, angle) = ([1.0, 2.0, -1.5], 0.7_f64);
    let norm = f64::hypot(f64::hypot(axis[0], axis[1]), axis[2]);
    let e = axis.map(|x| x / norm);
    // Rodrigues.
    let turned = |v: [f64; 3]| {
        let dot: f64 = (0..3).map(|i| e[i] * v[i]).sum();
        let cross = |i: usize| e[(i + 1) % 3] * v[(i + 2) % 3] - e[(i + 2) % 3] * v[(i + 1) % 3];
        let one = |i: usize| {
            v[i] * angle.cos() + cross(i) * angle.sin() + e[i] * dot * (1.0 - angle.cos())
        };
        [one(0), one(1), one(2)]
    };
    let mut all = base.clone();
    let mut part = json!({});
    for section in ["bodies", "joints", "loads"] {
        part[section] = base[section].clone();
        all.as_object_mut()
            .expect("a document")
            .shift_remove(section);
    }
    all["parts"] = json!({"arms": part});
    all["use"] = json!({"m": {"part": "arms", "turn": {"axis": axis, "angle": angle}}});
    all["gravity"] = json!(turned([0.0, -9.81, 0.0]));
    for key in ["events", "functions"] {
        rename(&mut all[key], &turned);
    }
    // Numbers of parts are no variables of the machine, and gravity has no single component.
    all["variables"]
        .as_object_mut()
        .expect("variables")
        .retain(|_, own| {
            let path = own["path"].as_str().expect("a path");
            path.starts_with("/events") || path.starts_with("/simulation")
        });
    all
}

/// Gives directions their turned components, and names of bodies, joints and loads those of the use "m".
fn rename(value: &mut Value, turned: &impl Fn([f64; 3]) -> [f64; 3]) {
    match value {
        Value::Array(all) if all.len() == 3 && all.iter().all(Value::is_number) => {
            let v = [0, 1, 2].map(|i| all[i].as_f64().expect("a number"));
            *value = json!(turned(v));
        }
        Value::Array(all) => all.iter_mut().for_each(|own| match own {
            Value::String(name) => *name = format!("m/{name}"),
            own => rename(own, turned),
        }),
        Value::Object(all) => {
            for (key, own) in all {
                match own {
                    Value::String(name) if key == "body" || key == "joint" => {
                        *name = format!("m/{name}")
                    }
                    own => rename(own, turned),
                }
            }
        }
        _ => {}
    }
}

/// Turns the machine by 90° about y: x becomes −z.
fn turn(value: &mut Value) {
    match value {
        Value::Array(all) if all.len() == 3 && all.iter().all(Value::is_number) => {
            let x = all[0].as_f64().expect("a number");
            let z = all[2].clone();
            all[2] = json!(-x);
            all[0] = z;
        }
        Value::Array(all) => all.iter_mut().for_each(turn),
        Value::Object(all) => {
            for (key, own) in all {
                match (&key[..], &mut *own) {
                    ("size", Value::Array(size)) => size.reverse(),
                    _ => turn(own),
                }
            }
        }
        _ => {}
    }
}

fn failure(document: &Value) -> String {
    let own = problem(document);
    match Simulated::of(&own, &own.start()) {
        Ok(_) => panic!("it runs"),
        Err(failure) => failure.to_string(),
    }
}

#[test]
fn what_does_not_come_is_named() {
    let mut document = arms(2, &json!({"tolerance": 1e-9}));
    document["events"]["locks"]["when"]["reaches"] = json!(1.5);
    let text = failure(&document);
    assert!(
        text.starts_with("the event \"locks\" does not come"),
        "{text}"
    );
    // It comes after the time of the one that should follow.
    let mut document = arms(3, &json!({"tolerance": 1e-9}));
    document["events"]["free"]["when"]["time"] = json!(0.2);
    let text = failure(&document);
    assert!(text.contains("the event \"free\" is due"), "{text}");
}

/// A controller that an event stops and another one starts again: between them the disk keeps its rate and the controller its
/// integral. Angle, rate and integral against exponentials of the matrix, and exact derivatives.
#[test]
fn events_stop_and_start_a_controller() {
    let (about, [p, d, k, r], times) = (0.7, [8.0, 1.5, 6.0, 0.4], [0.5, 0.3, 0.5]);
    let document = json!({
        "version": 1, "name": "disk", "gravity": [3, -9.81, 1],
        "bodies": {"disk": {"mass": 5, "inertia": {"xx": 1, "yy": 1, "zz": about}}},
        "joints": {"axle": {"revolute": {"between": ["disk", "ground"], "at": [0, 0, 0], "axis": [0, 0, 1]}}},
        "loads": {"servo": {"controller": {
            "joint": "axle", "reference": r, "proportional": p, "derivative": d, "integral": k, "motor": {"lag": 0.08}}}},
        "events": {
            "stop": {"when": {"time": times[0]}, "off": ["servo"]},
            "go": {"when": {"time": times[0] + times[1]}, "on": ["servo"]}
        },
        "simulation": {"duration": times.iter().sum::<f64>(), "tolerance": 1e-11},
        "functions": {
            "angle": {"final": {"angle": {"joint": "axle"}}},
            "rate": {"final": {"angle_rate": {"joint": "axle"}}},
            "effort": {"final": {"effort": {"load": "servo"}}}
        },
        "variables": {
            "proportional": {"path": "/loads/servo/controller/proportional", "lower": 0.1, "upper": 100},
            "stop": {"path": "/events/stop/when/time", "lower": 0.1, "upper": 0.7}
        }
    });
    let problem = problem(&document);
    let all = simulated(&problem);
    let found = |name: &str| phases(&all).value(number(&problem, name));
    let lag = 0.08;
    let rows = [
        [0.0, 1.0, 0.0, 0.0],
        [0.0, 0.0, 0.0, 1.0 / about],
        [-k, 0.0, 0.0, 0.0],
        [-p / lag, -d / lag, 1.0 / lag, -1.0 / lag],
    ];
    let after =
        |x: DVector<f64>, time: f64| (DMatrix::from_fn(4, 4, |i, j| rows[i][j] * time)).exp() * x;
    let mut x = after(DVector::from_vec(vec![-r, 0.0, 0.0, 0.0]), times[0]);
    x[0] += x[1] * times[1];
    let x = after(x, times[2]);
    for (name, expected) in [("angle", r + x[0]), ("rate", x[1]), ("effort", x[3])] {
        let off = (found(name) - expected).abs();
        assert!(off < 1e-9, "{name} {} {expected}", found(name));
    }
    gradients_are_exact(&problem, &json!("controller"));
}

/// At the top of a throw the height only touches its value: the time of the event has no derivative.
#[test]
fn an_event_that_touches_is_named() {
    let document = json!({
        "version": 1, "name": "throw",
        "bodies": {"ball": {"shape": "point", "mass": 2, "velocity": {"linear": [3, 4, 0]}}},
        "simulation": {"duration": 1},
        "events": {"top": {"when": {
            "measure": {"position": {"body": "ball", "direction": [0, 1, 0]}}, "reaches": 16.0 / (2.0 * 9.81)}}},
        "functions": {"time": {"event_time": "top"}}
    });
    let text = failure(&document);
    assert!(
        text.contains("before top") && text.contains("touches"),
        "{text}"
    );
}

/// Every fault of an event is told at its place.
#[test]
fn faults_of_events_are_told() {
    let base = arms(3, &json!({"tolerance": 1e-9}));
    let faults: [(&str, Value, &str); 9] = [
        (
            "/events/stop/off",
            json!(["moter"]),
            "the name of a joint, load or drive",
        ),
        (
            "/events/stop/off",
            json!(["motor", "motor"]),
            "each name once",
        ),
        (
            "/events/stop/on",
            json!(["lock"]),
            "what is off before this event",
        ),
        (
            "/events/free/off",
            json!(["motor"]),
            "what is on before this event",
        ),
        (
            "/events/stop/when/time",
            json!(0.95),
            "a time before the end at 0.9 s",
        ),
        (
            "/events/free/when/time",
            json!(0.1),
            "a time after that of the event before it",
        ),
        (
            "/functions/peak/ks/during",
            json!([0.1, 0.2]),
            "of the whole motion or between events",
        ),
        (
            "/functions/early/value/at/event",
            json!("stopp"),
            "the name of an event",
        ),
        (
            "/functions/locks at",
            json!({"event_time": "lock"}),
            "the name of an event",
        ),
    ];
    for (place, value, expected) in faults {
        let mut document = base.clone();
        let (parent, key) = place.rsplit_once('/').expect("a pointer");
        document.pointer_mut(parent).expect("there")[key] = value;
        let Err(found) = Problem::parse(&document.to_string(), "arms.json", &[]) else {
            panic!("{place} is no fault");
        };
        assert!(found.to_string().contains(expected), "{place}: {found}");
    }
    let mut rests = base.clone();
    rests["analysis"] = json!("rest");
    rests
        .as_object_mut()
        .expect("a document")
        .shift_remove("simulation");
    let Err(found) = Problem::parse(&rests.to_string(), "arms.json", &[]) else {
        panic!("it rests");
    };
    assert!(
        found.to_string().contains("events of a machine at rest"),
        "{found}"
    );
}

/// What opens has no reaction, and a load that is off no force and no energy.
#[test]
fn what_is_off_bears_nothing() {
    let mut document = arms(5, &json!({"tolerance": 1e-9}));
    document["functions"] = json!({
        "elbow": {"final": {"joint_force": {"joint": "elbow", "direction": [0, 1, 0]}}},
        "spring": {"final": {"spring_force": {"load": "spring"}}},
        "before": {"value": {"at": {"event": "lets go"}, "of": {"joint_force": {"joint": "elbow", "direction": [0, 1, 0]}}}},
        "pulls": {"value": {"at": {"event": "snaps"}, "of": {"spring_force": {"load": "spring"}}}}
    });
    let own = problem(&document);
    let at = simulated(&own);
    for (name, bears) in [
        ("elbow", false),
        ("spring", false),
        ("before", true),
        ("pulls", true),
    ] {
        let value = at.value(number(&own, name));
        assert_eq!(value.abs() > 0.1, bears, "{name}: {value}");
        assert!(bears || value == 0.0, "{name}: {value}");
    }
}

/// A body that an event meets in the origin has no size but its way.
#[test]
fn events_in_the_origin_do_not_end_the_motion() {
    let file = json!({
        "version": 1, "name": "thrown", "gravity": [0, -10, 0],
        "bodies": {"b": {"shape": {"sphere": {"radius": 0.1}}, "mass": 1, "velocity": {"linear": [0, 2, 0]}}},
        "events": {"e": {"when": {"measure": {"position": {"body": "b", "direction": [0, 1, 0]}}, "reaches": 0}}},
        "simulation": {"duration": 1},
        "functions": {"y": {"final": {"position": {"body": "b", "direction": [0, 1, 0]}}}}
    });
    let own = problem(&file);
    let found = simulated(&own).value(number(&own, "y"));
    assert!((found + 3.0).abs() < 1e-6, "{found}");
}
