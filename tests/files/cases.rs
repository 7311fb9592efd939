//! Cases: each is the file with some values replaced; functions over cases against closed forms of their values; families,
//! derivatives, optima, and what is refused.

use crate::reference::documents::{optimised, problem as parsed, read};
use crate::reference::gradients::gradients_are_exact;
use flexbody_driver::integration::Integration;
use flexbody_driver::{Analysed, Simulated};
use flexbody_problem::Problem;
use serde_json::Value;

/// A bar with a payload, held by a spring: two motions and a rest.
fn swing() -> Value {
    let height = json!({"body": "bar", "point": "tip", "direction": [0, 1, 0]});
    json!({
        "version": 1, "name": "swing", "gravity": [0, -9.81, 0],
        "parameters": {"length": 1.0},
        "bodies": {
            "bar": {
                "shape": {"rod": {"length": "= length", "radius": 0.02}}, "mass": 2,
                "points": {"pin": ["= -length/2", 0, 0], "tip": ["= length/2", 0, 0]},
                "place": {"put": "pin", "at": [0, 0, 0], "turn": {"axis": [0, 0, 1], "degrees": -20}}
            },
            "payload": {"shape": {"sphere": {"radius": 0.05}}, "mass": 1, "place": {"at": "bar.tip"}}
        },
        "joints": {
            "hinge": {"revolute": {"between": ["bar", "ground"], "at": "bar.pin", "axis": [0, 0, 1]}},
            "grip": {"weld": {"between": ["payload", "bar"], "at": "bar.tip"}}
        },
        "loads": {
            "spring": {"spring": {"between": ["bar", "ground"], "at": {"a": "tip", "b": [0.5, 1.0, 0]},
                                  "rest_length": 0.5, "stiffness": 100}}
        },
        "simulation": {"duration": 0.5, "steps": 60, "method": {"radau": {"stages": 3}}},
        "cases": {
            "empty": {"set": {"/bodies/payload/mass": 0.2}},
            "full": {"set": {"/bodies/payload/mass": 3, "/simulation/duration": 0.6, "/parameters/length": 1.1}},
            "parked": {"analysis": "rest"}
        },
        "functions": {
            "height": {"final": {"position": height}},
            "energy": {"mean": {"energy": "kinetic"}},
            "tension": {"ks": {"rho": 0.3, "of": {"spring_force": {"load": "spring"}}}},
            "twice": {"expression": "2*height"},
            "worst": {"over_cases": {"function": "height", "by": {"ks": {"rho": 5}}}},
            "least": {"over_cases": {"function": "twice", "cases": "all", "by": {"ks": {"rho": 7, "of": "smallest"}}}},
            "mean energy": {"over_cases": {"function": "energy", "cases": {"empty": 1, "full": 3}, "by": "mean"}},
            "sum": {"over_cases": {"function": "tension", "cases": ["full", "parked"], "by": "sum"}},
            "spread": {"over_cases": {"function": "height", "cases": ["empty", "full"], "by": "deviation"}},
            "both": {"expression": "'mean energy' + 2*'energy in full'"}
        },
        "variables": {
            "stiffness": {"path": "/loads/spring/spring/stiffness", "lower": 20, "upper": 500},
            "rest": {"path": "/loads/spring/spring/rest_length", "lower": 0.1, "upper": 0.9}
        }
    })
}

/// The file of a case alone, with the functions of the machine of these names.
fn alone(file: &Value, case: &str, functions: &[&str]) -> Value {
    let mut file = file.clone();
    let own = file["cases"][case].clone();
    let entries = file.as_object_mut().expect("an object");
    for key in ["cases", "objective", "constraints"] {
        entries.remove(key);
    }
    if own["analysis"] == "rest" {
        entries.remove("simulation");
        entries.insert("analysis".into(), json!("rest"));
    }
    let all = entries["functions"].as_object_mut().expect("functions");
    all.retain(|name, _| functions.contains(&name.as_str()));
    for (path, value) in own["set"].as_object().into_iter().flatten() {
        *file.pointer_mut(path).expect("a path") = value.clone();
    }
    file
}

fn simulated(problem: &Problem) -> Simulated {
    Simulated::of(problem, &problem.start()).unwrap_or_else(|failure| panic!("{failure}"))
}

fn number(problem: &Problem, name: &str) -> usize {
    let names = &problem.function_names;
    let found = names.iter().position(|own| own == name);
    found.unwrap_or_else(|| panic!("no {name} in {names:?}"))
}

fn value(problem: &Problem, name: &str) -> f64 {
    simulated(problem).value(number(problem, name))
}

/// Values and gradients of all functions.
fn evaluated(problem: &Problem) -> (Vec<f64>, Vec<Vec<f64>>) {
    let all: Vec<usize> = (0..problem.function_names.len()).collect();
    let mut integration = Integration::of(problem, Some(&all), true);
    let at = Analysed::with(&mut integration, problem, &problem.start(), &all);
    let (at, _) = at.unwrap_or_else(|failure| panic!("{failure}"));
    let (gradients, _) = at.gradients(problem, &all).expect("gradients");
    (all.iter().map(|&f| at.value(f)).collect(), gradients)
}

/// Path and finding of each fault.
type Told = Vec<(String, String)>;

fn faults(file: &Value) -> Told {
    let found = Problem::parse(&file.to_string(), "scene.json", &[]);
    let list = found.err().map_or_else(Vec::new, |faults| faults.list);
    list.into_iter().map(|own| (own.path, own.found)).collect()
}

const OF_MOTIONS: [&str; 4] = ["height", "energy", "tension", "twice"];

#[test]
fn a_case_is_the_file_with_its_values() {
    let file = swing();
    let all = parsed(&file);
    let (values, gradients) = evaluated(&all);
    for (case, functions) in [
        ("empty", &OF_MOTIONS[..]),
        ("full", &OF_MOTIONS[..]),
        ("parked", &["height", "tension", "twice"][..]),
    ] {
        let own = parsed(&alone(&file, case, functions));
        let (expected, slopes) = evaluated(&own);
        for (name, (value, slope)) in own.function_names.iter().zip(expected.iter().zip(&slopes)) {
            let full = format!("{name} in {case}");
            let Some(f) = all.function_names.iter().position(|own| *own == full) else {
                // Nothing wants it there.
                continue;
            };
            assert_eq!(values[f], *value, "{full}");
            assert_eq!(gradients[f], *slope, "{full}");
        }
    }
    // Each function where it is wanted.
    let wanted = [
        ("height", "empty", true),
        ("height", "parked", true),
        ("energy", "parked", false),
        ("energy", "full", true),
        ("tension", "empty", false),
        ("tension", "parked", true),
    ];
    for (function, case, is_there) in wanted {
        let name = format!("{function} in {case}");
        assert_eq!(all.function_names.contains(&name), is_there, "{name}");
    }
}

#[test]
fn functions_over_cases_are_those_of_their_values() {
    let problem = parsed(&swing());
    let of = |name: &str| value(&problem, name);
    let heights = ["empty", "full", "parked"].map(|case| of(&format!("height in {case}")));
    let ks = |rho: f64, all: &[f64]| all.iter().map(|f| (rho * f).exp()).sum::<f64>().ln() / rho;
    let near = |name: &str, expected: f64| {
        let found = of(name);
        assert!(
            (found - expected).abs() <= 1e-13 * expected.abs(),
            "{name}: {found} {expected}"
        );
    };
    near("worst", ks(5.0, &heights));
    near("least", -ks(7.0, &heights.map(|h| -2.0 * h)));
    near(
        "mean energy",
        (of("energy in empty") + 3.0 * of("energy in full")) / 4.0,
    );
    near("sum", of("tension in full") + of("tension in parked"));
    near("spread", (heights[0] - heights[1]).abs() / 2.0);
    near("both", of("mean energy") + 2.0 * of("energy in full"));
    // The true value beside each.
    let at = simulated(&problem);
    let truth = |name: &str| at.smoothed(number(&problem, name)).expect("smoothed").value;
    let largest = heights.iter().fold(f64::NEG_INFINITY, |a, b| a.max(*b));
    let smallest = heights.iter().fold(f64::INFINITY, |a, b| a.min(*b));
    assert_eq!(truth("worst"), largest);
    assert_eq!(truth("least"), 2.0 * smallest);
    assert!(of("worst") >= largest && of("least") <= 2.0 * smallest);
    assert!(at.smoothed(number(&problem, "spread")).is_none());
    assert_eq!(problem.function_unit(number(&problem, "worst")), "m");
    assert_eq!(problem.function_unit(number(&problem, "spread")), "m");
}

#[test]
fn derivatives_are_exact_in_all_cases() {
    gradients_are_exact(&parsed(&swing()), &json!("swing"));
    // By a parameter that numbers, cases and expressions depend on.
    let mut file = swing();
    file["cases"]["full"]["set"] =
        json!({"/bodies/payload/mass": 3, "/bodies/bar/mass": "= 2*weight"});
    file["parameters"]["weight"] = json!(1.5);
    file["functions"]["priced"] = json!({"expression": "worst/length + 'height in full'*weight"});
    file["variables"]["length"] = json!({"path": "/parameters/length", "lower": 0.5, "upper": 2});
    file["variables"]["weight"] = json!({"path": "/parameters/weight", "lower": 0.5, "upper": 2});
    gradients_are_exact(&parsed(&file), &json!("parameters"));
}

#[test]
fn structures_have_cases_too() {
    let plate = |length: f64, pressure: f64| {
        json!({
            "version": 1, "name": "plate",
            "materials": {"steel": {"young": 2.1e11, "poisson": 0.3, "density": 7800}},
            "structures": {"plate": {
                "mesh": {"plate": {"length": length, "width": 0.5, "elements": [4, 2]}},
                "material": "steel", "thickness": 0.01,
                "supports": {"wall": {"nodes": "x0"}}
            }},
            "load_cases": {"wind": {"w": {"pressure": {"faces": "all", "pressure": pressure}}}},
            "functions": {
                "work": {"compliance": {"case": "wind"}},
                "first": {"frequency": {"mode": 1}},
                "mass": "mass"
            },
            "variables": {"thickness": {"path": "/structures/plate/thickness", "lower": 0.001, "upper": 0.1}}
        })
    };
    let single = parsed(&plate(1.0, 500.0));
    let (values, slopes) = evaluated(&single);
    let mut file = plate(1.0, 500.0);
    file["cases"] = json!({
        "breeze": {},
        "storm": {"set": {"/load_cases/wind/w/pressure/pressure": 2000}}
    });
    file["functions"]["worst"] =
        json!({"over_cases": {"function": "work", "by": {"ks": {"rho": 1e4}}}});
    file["objective"] = json!({"minimise": "mass"});
    file["constraints"] = json!({"work": {"function": "work", "upper": 1}, "first": {"function": "first in breeze", "lower": 1}});
    let problem = parsed(&file);
    let (all, gradients) = evaluated(&problem);
    for (name, expected) in [("work in breeze", 0), ("first in breeze", 1), ("mass", 2)] {
        let f = number(&problem, name);
        let place = number(&single, ["work", "first", "mass"][expected]);
        assert_eq!(
            (all[f], &gradients[f]),
            (values[place], &slopes[place]),
            "{name}"
        );
    }
    // Linear: four times the pressure, sixteen times the work.
    let ratio = all[number(&problem, "work in storm")] / all[number(&problem, "work in breeze")];
    assert!((ratio - 16.0).abs() < 1e-9, "{ratio}");
    let names: Vec<&str> = problem
        .constraints
        .iter()
        .map(|own| own.name.as_str())
        .collect();
    assert_eq!(names, ["work in breeze", "work in storm", "first"]);
    gradients_are_exact(&problem, &json!("plate"));
}

/// A spring of stiffness k that holds masses m_c at rest is stretched by m_c g/k: the heaviest decides.
#[test]
fn the_worst_case_decides_the_optimum() {
    let each = json!({
        "version": 1, "name": "scale", "analysis": "rest", "gravity": [0, -9.81, 0],
        "bodies": {"pan": {"shape": {"sphere": {"radius": 0.1}}, "mass": 1, "place": {"at": [0, -1, 0]}}},
        "joints": {"guide": {"prismatic": {"between": ["pan", "ground"], "at": [0, -1, 0], "axis": [0, 1, 0]}}},
        "loads": {"spring": {"spring": {"between": ["pan", "ground"], "at": {"a": [0, 0, 0], "b": [0, 0, 0]},
                                        "rest_length": 1, "stiffness": "= k"}}},
        "cases": {
            "light": {"set": {"/bodies/pan/mass": 1}},
            "heavy": {"set": {"/bodies/pan/mass": 7}},
            "middle": {"set": {"/bodies/pan/mass": 4}}
        },
        "functions": {
            "height": {"final": {"position": {"body": "pan", "direction": [0, 1, 0]}}},
            "lowest": {"over_cases": {"function": "height", "by": {"ks": {"rho": 1e4, "of": "smallest"}}}}
        },
        "parameters": {"k": 500},
        "variables": {"stiffness": {"path": "/parameters/k", "lower": 100, "upper": 5000}},
        "objective": {"minimise": {"expression": "k"}},
        "constraints": {"height": {"function": "height", "lower": -1.05}}
    });
    let mut smooth = each.clone();
    smooth["constraints"] = json!({"lowest": {"function": "lowest", "lower": -1.05}});
    let exact = 7.0 * 9.81 / 0.05;
    for (file, part) in [(&each, 1e-6), (&smooth, 1e-3)] {
        let problem = parsed(file);
        let done = optimised(&problem);
        assert!(done.outcome.converged(), "{:?}", done.outcome.status);
        let found = done.optimum.design["stiffness"].value;
        assert!((found - exact).abs() <= part * exact, "{found} {exact}");
    }
    // Of three constraints one is active.
    let problem = parsed(&each);
    let done = optimised(&problem);
    let constraints = &done.optimum.constraints;
    assert_eq!(constraints.len(), 3);
    assert!(constraints["height in heavy"].multiplier.abs() > 1e-3);
    assert!(constraints["height in light"].multiplier.abs() < 1e-3);
}

/// A mass on a spring in motion, at rest and for its modes: ω² = k/m, and ζ = c/(2 √(k m)).
#[test]
fn frequencies_of_cases_are_those_of_their_masses() {
    let file = json!({
        "version": 1, "name": "sprung", "analysis": "modes", "gravity": [0, -9.81, 0],
        "bodies": {"pan": {"shape": {"sphere": {"radius": 0.1}}, "mass": 1, "place": {"at": [0, -1, 0]}}},
        "joints": {"guide": {"prismatic": {"between": ["pan", "ground"], "at": [0, -1, 0], "axis": [0, 1, 0]}}},
        "loads": {"spring": {"spring": {"between": ["pan", "ground"], "at": {"a": [0, 0, 0], "b": [0, 0, 0]},
                                        "rest_length": 1, "stiffness": 500, "damping": 3}}},
        "cases": {
            "light": {"set": {"/bodies/pan/mass": 2}},
            "heavy": {"analysis": "rest", "set": {"/bodies/pan/mass": 8}},
            "let go": {"analysis": "motion", "set": {"/simulation": {"duration": 0.1, "steps": 20}}}
        },
        "functions": {
            "first": {"frequency": {"mode": 1}},
            "ratio": {"damping_ratio": {"mode": 1}},
            "fall": {"final": {"position": {"body": "pan", "direction": [0, 1, 0]}}},
            "least": {"over_cases": {"function": "first", "cases": ["light", "heavy"], "by": {"ks": {"rho": 40, "of": "smallest"}}}},
            "worst": {"expression": "'ratio in light' + 0*'fall in let go'/1"}
        },
        "variables": {
            "stiffness": {"path": "/loads/spring/spring/stiffness", "lower": 100, "upper": 1000},
            "damping": {"path": "/loads/spring/spring/damping", "lower": 1, "upper": 10}
        }
    });
    let problem = parsed(&file);
    let of = |name: &str| value(&problem, name);
    let omega = |mass: f64| (500.0_f64 / mass).sqrt() / std::f64::consts::TAU;
    for (name, expected) in [
        ("first in light", omega(2.0)),
        ("first in heavy", omega(8.0)),
        ("ratio in light", 3.0 / (2.0 * 1000.0_f64.sqrt())),
    ] {
        assert!(
            (of(name) / expected - 1.0).abs() < 1e-9,
            "{name}: {} {expected}",
            of(name)
        );
    }
    assert!(
        !problem
            .function_names
            .contains(&"first in let go".to_owned())
    );
    let f = number(&problem, "least");
    assert_eq!(
        simulated(&problem).smoothed(f).expect("smoothed").value,
        of("first in heavy")
    );
    let all = flexbody_driver::check(&problem, &problem.start()).expect("derivatives");
    for own in all {
        let off = (own.adjoint - own.complex_step).abs();
        assert!(
            off <= 1e-11 * own.complex_step.abs() || own.is_round_off(),
            "{own:?}"
        );
    }
}

/// The jib of the crane as a stiff bar: the pull of the rope balances the payload and half the weight about the foot.
#[test]
fn the_crane_pulls_as_statics_says() {
    let mut file = read("problems/crane.json");
    file["bodies"]["jib"]["beam"]["material"]["young"] = json!(2.1e17);
    let problem = parsed(&file);
    let (values, _) = evaluated(&problem);
    let mass = values[number(&problem, "mass")];
    for (degrees, force) in [
        (15.0, 1e4),
        (30.0, 1.2e4),
        (45.0, 1.6e4),
        (60.0, 2.5e4),
        (75.0, 4e4),
    ] {
        let (sin, cos) = f64::to_radians(degrees).sin_cos();
        let (eye, top) = ([9.0 * cos, 9.0 * sin], [0.0, 4.0]);
        let rope = [top[0] - eye[0], top[1] - eye[1]];
        let arm = (eye[0] * rope[1] - eye[1] * rope[0]).abs() / rope[0].hypot(rope[1]);
        let moment = (force * 12.0 + mass * 9.81 * 6.0) * cos;
        let found = values[number(&problem, &format!("pull in {degrees}deg"))];
        assert!(
            (found * arm / moment - 1.0).abs() < 1e-7,
            "{degrees}: {found} {}",
            moment / arm
        );
    }
    let mut file = read("problems/crane.json");
    file["functions"]["stress"]["final"]["largest_fibre_stress"]["rho"] = json!(4e-6);
    file["functions"]["worst stress"]["over_cases"]["by"]["ks"]["rho"] = json!(1e-6);
    gradients_are_exact(&parsed(&file), &json!("crane"));
}

/// Orders of cases and functions, and the number of threads, do not change a bit.
#[test]
fn orders_and_threads_do_not_matter() {
    let file = swing();
    let problem = parsed(&file);
    let (values, gradients) = evaluated(&problem);
    let mut other = file.clone();
    for key in ["cases", "functions"] {
        let entries = file[key].as_object().expect("entries");
        let reversed: Vec<(String, Value)> = entries.clone().into_iter().rev().collect();
        other[key] = Value::Object(reversed.into_iter().collect());
    }
    let turned = parsed(&other);
    let one = rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .build()
        .expect("a pool");
    let (again, slopes) = one.install(|| evaluated(&turned));
    for (f, name) in problem.function_names.iter().enumerate() {
        let g = number(&turned, name);
        let close = |a: f64, b: f64| (a - b).abs() <= 1e-14 * a.abs().max(1e-9);
        assert!(close(values[f], again[g]), "{name}");
        assert!(
            gradients[f]
                .iter()
                .zip(&slopes[g])
                .all(|(a, b)| close(*a, *b)),
            "{name}"
        );
    }
}

#[test]
fn cases_that_nothing_wants_are_not_computed() {
    let problem = parsed(&swing());
    let counts = |names: &[&str]| {
        let asked: Vec<usize> = names.iter().map(|name| number(&problem, name)).collect();
        let mut integration = Integration::of(&problem, Some(&asked), true);
        let at = Analysed::with(&mut integration, &problem, &problem.start(), &asked);
        at.unwrap_or_else(|failure| panic!("{failure}"))
            .0
            .counts()
            .steps
    };
    assert_eq!(counts(&["height in empty"]), 60);
    assert_eq!(counts(&["mean energy"]), 120);
    assert_eq!(counts(&["height in parked"]), 0);
    assert_eq!(counts(&["worst", "spread"]), 120);
}

#[test]
fn a_case_that_fails_is_named() {
    let mut file = swing();
    file["cases"]["full"]["set"] =
        json!({"/loads/spring/spring/stiffness": 100, "/bodies/bar/mass": 2});
    file["variables"] =
        json!({"rest": {"path": "/loads/spring/spring/rest_length", "lower": 0.1, "upper": 0.9}});
    file["loads"]["push"] =
        json!({"force": {"body": "bar", "direction": [0, 1, 0], "magnitude": 1}});
    file["cases"]["full"]["set"]["/loads/push/force/magnitude"] = json!(1e40);
    let problem = parsed(&file);
    let failure = Simulated::of(&problem, &problem.start())
        .err()
        .expect("a failure")
        .to_string();
    assert!(failure.starts_with("in the case \"full\": "), "{failure}");
}

#[test]
fn what_cases_cannot_do_is_told_by_place() {
    let change = |of: &dyn Fn(&mut Value)| {
        let mut file = swing();
        of(&mut file);
        faults(&file)
    };
    let over = |own: Value| change(&|file| file["functions"]["worst"]["over_cases"] = own.clone());
    let named = |name: &str| change(&|file| file["cases"][name] = file["cases"]["empty"].clone());
    let all: Vec<(Told, &str, &str)> = vec![
        (named("Empty"), "/cases/Empty", "\"Empty\" after \"empty\""),
        (named("half in a"), "/cases/half in a", "\"half in a\""),
        (
            change(&|file| file["cases"]["empty"]["set"]["/bodies/payload/mas"] = json!(1)),
            "/cases/empty/set/~1bodies~1payload~1mas",
            "the key \"mas\"",
        ),
        (
            change(&|file| file["cases"]["empty"]["set"]["/bodies/crate/mass"] = json!(1)),
            "/cases/empty/set/~1bodies~1crate~1mass",
            "nothing at this path (/bodies/crate/mass)",
        ),
        (
            change(&|file| file["cases"]["empty"]["set"]["/bodies/payload/mass"] = json!("heavy")),
            "/cases/empty/set/~1bodies~1payload~1mass",
            "\"heavy\"",
        ),
        (
            change(&|file| file["cases"]["empty"]["set"]["bodies.payload.mass"] = json!(1)),
            "/cases/empty/set/bodies.payload.mass",
            "\"bodies.payload.mass\"",
        ),
        (
            change(&|file| {
                file["cases"]["full"]["set"]["/loads/spring/spring/stiffness"] = json!(1)
            }),
            "/cases/full/set/~1loads~1spring~1spring~1stiffness",
            "a number that the design variable \"stiffness\" gives",
        ),
        (
            change(&|file| file["cases"]["full"]["set"]["/functions/height"] = json!("mass")),
            "/cases/full/set/~1functions~1height",
            "a value of \"functions\", which all cases have in common",
        ),
        (
            change(&|file| file["cases"]["a/b"] = json!({})),
            "/cases/a~1b",
            "\"a/b\"",
        ),
        (
            over(json!({"function": "heigth", "by": "mean"})),
            "/functions/worst/over_cases/function",
            "\"heigth\"",
        ),
        (
            over(json!({"function": "spread", "by": "mean"})),
            "/functions/worst/over_cases/function",
            "\"spread\", which is one over cases itself",
        ),
        (
            over(json!({"function": "height", "cases": ["emty"], "by": "mean"})),
            "/functions/worst/over_cases/cases/0",
            "\"emty\"",
        ),
        (
            over(json!({"function": "height", "cases": ["full", "full"], "by": "mean"})),
            "/functions/worst/over_cases/cases/1",
            "\"full\" once more",
        ),
        (
            over(json!({"function": "height", "cases": {"full": -1}, "by": "mean"})),
            "/functions/worst/over_cases/cases/full",
            "-1",
        ),
        (
            over(json!({"function": "height", "cases": {"full": 1}, "by": {"ks": {"rho": 1}}})),
            "/functions/worst/over_cases/cases",
            "weights",
        ),
        (
            over(json!({"function": "height", "cases": [], "by": "sum"})),
            "/functions/worst/over_cases/cases",
            "no case",
        ),
        (
            over(json!({"function": "height", "cases": ["full"], "by": "deviation"})),
            "/functions/worst/over_cases/by",
            "the deviation of one case, which is zero",
        ),
        (
            change(&|file| file["objective"] = json!({"minimise": "height"})),
            "/objective/minimise",
            "\"height\", which has a value in each case",
        ),
        (
            change(&|file| file["objective"] = json!({"minimise": "height in fulll"})),
            "/objective/minimise",
            "\"height in fulll\"",
        ),
        (
            change(&|file| {
                file["functions"]["wrong"] = json!({"expression": "worst + height"});
            }),
            "/functions/wrong/expression",
            "the name \"height\"",
        ),
        (
            change(&|file| {
                file["constraints"] = json!({"low": {"function": "height"}});
            }),
            "/constraints/low",
            "no bound",
        ),
        (
            change(&|file| {
                file["cases"] = json!({});
            }),
            "/functions/worst/over_cases",
            "a function over cases",
        ),
        (
            // What needs time, in a case at rest.
            over(json!({"function": "energy", "by": "mean"})),
            "/functions/energy",
            "a function of time, of a machine at rest",
        ),
    ];
    for (found, path, text) in all {
        let named = found
            .iter()
            .any(|(own, found)| own == path && found.contains(text));
        assert!(named, "{path} {text}: {found:?}");
    }
    // One of a case names it.
    let mut file = swing();
    file["cases"]["full"]["set"]["/bodies/payload/mass"] = json!(-1);
    let told = Problem::parse(&file.to_string(), "swing.json", &[])
        .expect_err("a fault")
        .to_string();
    assert!(told.contains("this is in the case \"full\""), "{told}");
}

/// A mass that no case changes has one value: it may be minimised, and limits one constraint.
#[test]
fn a_mass_that_no_case_changes_is_one() {
    let mut file = swing();
    file["cases"] = json!({
        "down": {"set": {"/bodies/bar/place/turn/degrees": -40}},
        "up": {"set": {"/bodies/bar/place/turn/degrees": 10, "/gravity": [0, -5, 0]}}
    });
    file["functions"] = json!({
        "mass": "mass",
        "dear": {"expression": "3*mass"},
        "height": {"final": {"position": {"body": "bar", "point": "tip", "direction": [0, 1, 0]}}},
        "worst": {"over_cases": {"function": "height", "by": {"ks": {"rho": 10}}}},
        "all": {"expression": "worst*2 + 0.1*dear"}
    });
    file["objective"] = json!({"minimise": "dear"});
    file["constraints"] = json!({"heavy": {"function": "mass", "upper": 10}, "high": {"function": "height", "upper": 3}});
    file["variables"] = json!({"mass": {"path": "/bodies/bar/mass", "lower": 0.5, "upper": 5}});
    let problem = parsed(&file);
    assert_eq!(value(&problem, "mass"), 3.0);
    assert_eq!(value(&problem, "dear"), 9.0);
    let names: Vec<&str> = problem
        .constraints
        .iter()
        .map(|own| own.name.as_str())
        .collect();
    assert_eq!(names, ["heavy", "high in down", "high in up"]);
    gradients_are_exact(&problem, &json!("mass"));
    file["cases"]["up"]["set"]["/bodies/payload/mass"] = json!(2);
    assert!(
        faults(&file)
            .iter()
            .any(|(path, _)| path == "/objective/minimise")
    );
}

/// The nearest feasible design of all cases, where the file has no objective.
#[test]
fn without_objective_the_nearest_design_holds_in_all_cases() {
    let mut file = swing();
    file["constraints"] = json!({"tension": {"function": "tension", "upper": 60}});
    let problem = parsed(&file);
    let done = optimised(&problem);
    assert!(done.outcome.converged(), "{:?}", done.outcome.status);
    assert_eq!(done.optimum.constraints.len(), 3);
    assert!(
        done.optimum
            .constraints
            .values()
            .all(|own| own.value <= 60.0 + 1e-5)
    );
    let moved = done.optimum.objective.value;
    assert!(moved > 1e-4, "the start is not feasible: {moved}");
}

/// A case of modes leaves out the velocities of a motion.
#[test]
fn a_case_of_modes_leaves_out_velocities() {
    let mut file = json!({
        "version": 1, "name": "arm",
        "bodies": {"a": {
            "shape": {"rod": {"length": 0.5, "radius": 0.01}}, "mass": 2, "points": {"p": [-0.25, 0, 0]},
            "place": {"put": "p", "at": [0, 0, 0], "turn": {"z": -90}}, "velocity": {"linear": [0, 0, 0], "angular": [0, 0, 0]}
        }},
        "joints": {"j": {"revolute": {
            "between": ["a", "ground"], "at": "a.p", "axis": [0, 0, 1], "start": {"turn": {"angle": 0.1, "rate": 0.2}}
        }}},
        "simulation": {"duration": 0.4},
        "cases": {"swings": {"set": {}}, "rings": {"analysis": "modes", "set": {}}},
        "functions": {"f": {"frequency": {"mode": 1}}}
    });
    file["functions"]["e"] = json!({"final": {"energy": "kinetic"}});
    file["functions"]["f of rings"] =
        json!({"over_cases": {"function": "f", "by": "sum", "cases": ["rings"]}});
    let problem = parsed(&file);
    // A rod that swings about its end: ω² = g l/2 / (l²/3 + r²/4).
    let (l, r) = (0.5_f64, 0.01_f64);
    let square = 0.5 * 9.81 * l / (l * l / 3.0 + r * r / 4.0);
    let exact = square.sqrt() / (2.0 * std::f64::consts::PI);
    let found = value(&problem, "f of rings");
    assert!((found - exact).abs() < 1e-9 * exact, "{found} {exact}");
}
