//! Problem files as JSON values, for tests of families of scenes.

use flexbody_driver::known_evaluations::KnownEvaluations;
use flexbody_driver::{Optimisation, Simulation, optimise, simulate};
use flexbody_problem::Problem;
use serde_json::{Map, Value};
use std::ops::ControlFlow;
use std::path::Path;

/// Keys that describe the scene; the others describe the study.
const SCENE: [&str; 7] = [
    "version",
    "name",
    "gravity",
    "bodies",
    "joints",
    "loads",
    "initial_velocity",
];

/// A file by its path in the project.
pub fn read(name: &str) -> Value {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(name);
    let text = std::fs::read_to_string(path).expect("a file");
    serde_json::from_str(&text).expect("valid JSON")
}

/// A file of `problems/benchmarks`.
pub fn benchmark(name: &str) -> Value {
    read(&format!("problems/benchmarks/{name}.json"))
}

/// Names of the bodies of a file.
pub fn bodies(file: &Value) -> Vec<String> {
    let bodies = file["bodies"].as_object().expect("bodies");
    bodies.keys().cloned().collect()
}

/// The scene of a file with other settings. Its functions are the final positions of all centres of mass.
pub fn final_positions(file: &Value, simulation: Value) -> Value {
    let function = |(body, k): (String, usize)| {
        let direction: Vec<f64> = (0..3).map(|i| if i == k { 1.0 } else { 0.0 }).collect();
        let position = json!({"final": {"position": {"body": body, "direction": direction}}});
        (format!("{body} {k}"), position)
    };
    let all = bodies(file).into_iter();
    let functions: Map<_, _> = all
        .flat_map(|body| (0..3).map(move |k| (body.clone(), k)))
        .map(function)
        .collect();
    let mut file = file.clone();
    let map = file.as_object_mut().expect("an object");
    map.retain(|key, _| SCENE.contains(&key.as_str()));
    map.insert("simulation".into(), simulation);
    map.insert("functions".into(), functions.into());
    file
}

/// Keys or indices and values of an object or a list.
pub fn children(value: &Value) -> Vec<(String, &Value)> {
    match value {
        Value::Object(object) => object.iter().map(|(k, v)| (k.clone(), v)).collect(),
        Value::Array(items) => {
            let all = items.iter().enumerate();
            all.map(|(k, v)| (k.to_string(), v)).collect()
        }
        _ => Vec::new(),
    }
}

/// The problem in a file without faults.
pub fn problem(file: &Value) -> Problem {
    Problem::parse(&file.to_string(), "scene.json", &[]).unwrap_or_else(|faults| panic!("{faults}"))
}

/// Asserts that a file has faults, and that these say all of the words.
pub fn faults_say(file: &Value, words: &[&str]) {
    let found = Problem::parse(&file.to_string(), "scene.json", &[]);
    let found = found.expect_err("a fault").to_string();
    for word in words {
        assert!(found.contains(word), "{found}");
    }
}

/// The motion at the start of a file.
pub fn run(file: &Value) -> Simulation {
    let problem = problem(file);
    simulate(&problem, &problem.start()).unwrap_or_else(|failure| panic!("{failure}"))
}

/// The values of all functions there.
pub fn values(file: &Value) -> Vec<f64> {
    let motion = run(file);
    let count = problem(file).function_names.len();
    (0..count).map(|f| motion.at.function(f).value).collect()
}

/// [`values`] of the scene without reductions.
pub fn unlowered_values(file: &Value) -> Vec<f64> {
    let mut full = problem(file);
    full.lowering = None;
    let motion = simulate(&full, &full.start()).unwrap_or_else(|failure| panic!("{failure}"));
    let count = full.function_names.len();
    (0..count).map(|f| motion.at.function(f).value).collect()
}

/// Settings of simulations by every kind of method, explicit and implicit, with steps that follow a tolerance and with equal ones.
pub fn methods(duration: f64, steps: u32) -> [Value; 6] {
    let equal = |method: Value| json!({"duration": duration, "steps": steps, "method": method});
    [
        json!({"duration": duration, "tolerance": 1e-7}),
        json!({"duration": duration, "tolerance": 1e-6, "method": {"radau": {"stages": 3}}}),
        equal(json!("dop853")),
        equal(json!({"radau": {"stages": 2}})),
        equal(json!({"bdf": {"order": 2}})),
        equal(json!({"generalised_alpha": {"radius": 0.8}})),
    ]
}

/// The file in other units: what a metre and a kilogram are, with the powers of both of the numbers at some places, also in lists.
pub fn in_units(file: &Value, (metre, kilogram): (f64, f64), places: &[(&str, i32, i32)]) -> Value {
    fn times(value: &mut Value, factor: f64) {
        match value {
            Value::Number(x) => *value = json!(x.as_f64().expect("a number") * factor),
            Value::Array(all) => all.iter_mut().for_each(|own| times(own, factor)),
            Value::Object(all) => all.values_mut().for_each(|own| times(own, factor)),
            _ => {}
        }
    }
    let mut other = file.clone();
    for (place, m, kg) in places {
        let own = other.pointer_mut(place);
        let own = own.unwrap_or_else(|| panic!("nothing at {place}"));
        times(own, metre.powi(*m) * kilogram.powi(*kg));
    }
    other
}

/// The file with the entries of these sections in the opposite order.
pub fn reversed(file: &Value, sections: &[&str]) -> Value {
    let mut other = file.clone();
    for section in sections {
        let all = file[section].as_object().expect("an object").clone();
        other[section] = all.into_iter().rev().collect::<Map<_, _>>().into();
    }
    other
}

/// An object with the entries of another, which replace its own.
pub fn extended(mut own: Value, more: &Value) -> Value {
    let entries = more.as_object().expect("an object").clone();
    own.as_object_mut().expect("an object").extend(entries);
    own
}

/// The value of a function there.
pub fn value(file: &Value, function: &str) -> f64 {
    let names = problem(file).function_names;
    let index = names.iter().position(|name| name == function);
    run(file).at.function(index.expect("a function")).value
}

/// Makes numbers of a file design variables that are named by their paths. Positive ones stay positive.
pub fn vary(file: &mut Value, paths: &[String]) {
    let one = |path: &String| {
        let start = file.pointer(path).and_then(Value::as_f64);
        let start = start.expect("a number");
        let variable = match start > 0.0 {
            true => json!({"path": path, "lower": 0.1 * start}),
            false => json!({"path": path}),
        };
        (path.clone(), variable)
    };
    let all: Map<_, _> = paths.iter().map(one).collect();
    file["variables"] = all.into();
}

/// Optimises a problem from its start.
pub fn optimised(problem: &Problem) -> Optimisation {
    let mut progress = |_: &_| ControlFlow::Continue(());
    let known = KnownEvaluations::default();
    optimise(problem, "", None, known, &mut progress).expect("has an objective")
}

/// The double plate with this mesh, duration, number of steps and method.
pub fn plates(elements: [usize; 2], duration: f64, steps: usize, method: &Value) -> Value {
    let mut document = read("problems/flexible/double_plate.json");
    for body in ["first", "second"] {
        document["bodies"][body]["elements"]["structure"]["mesh"]["plate"]["elements"] =
            json!(elements);
    }
    document["simulation"] = json!({"duration": duration, "steps": steps, "method": method});
    document
}
