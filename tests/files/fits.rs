//! Fits of motions to measured values: numbers, their covariance, what is not determined, and faults of data.

use crate::reference::documents::optimised;
use flexbody_driver::{Optimisation, certify, check};
use flexbody_optimiser::{Method, Status};
use flexbody_problem::Problem;
use flexbody_report::fit::VarianceFrom;
use flexbody_report::summary;
use rayon::prelude::*;
use serde_json::Value;
use std::path::{Path, PathBuf};

fn committed() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("problems/fit_pendulum.json")
}

fn parse(document: &Value) -> Problem {
    let found = Problem::parse(&document.to_string(), "fit.json", &[]);
    found.unwrap_or_else(|faults| panic!("{faults}"))
}

fn certified(problem: &Problem, done: &Optimisation) {
    let found = certify(problem, done, flexbody_driver::certificate::TOLERANCE);
    assert!(found.passed, "{:?}", found.faults());
}

/// Normal numbers without a pattern, by SplitMix64 and Box & Muller.
struct Noise(u64);

impl Noise {
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (((z ^ (z >> 31)) >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
    }

    fn normal(&mut self) -> f64 {
        let radius = (-2.0 * self.uniform().ln()).sqrt();
        radius * (std::f64::consts::TAU * self.uniform()).cos()
    }
}

/// The series of the misfit of a document, with the data at its own numbers plus noise.
fn with_data(document: &Value, times: &[f64], mut noise: impl FnMut() -> f64) -> Value {
    let blank: Vec<Value> = times.iter().map(|t| json!([t, 0.0])).collect();
    let mut document = document.clone();
    let series = |document: &Value| -> Vec<String> {
        let all = &document["functions"]["misfit"]["misfit"]["series"];
        all.as_object().expect("series").keys().cloned().collect()
    };
    let names = series(&document);
    for name in &names {
        document["functions"]["misfit"]["misfit"]["series"][name]["table"] = json!(blank);
    }
    let problem = parse(&document);
    let at = flexbody_driver::Evaluated::new(&problem, &problem.start()).expect("runs");
    let flexbody_mechanics::functions::Function::Misfit { series } = &at.scene.functions[0] else {
        panic!("a misfit");
    };
    for (name, own) in names.iter().zip(series) {
        let values = own.values(&at.scene.model, &at.run).expect("inside");
        let rows = times.iter().zip(values);
        let rows: Vec<Value> = rows.map(|(t, y)| json!([t, y + noise()])).collect();
        document["functions"]["misfit"]["misfit"]["series"][name]["table"] = json!(rows);
    }
    document
}

/// The same with other numbers at the start.
fn from(document: &Value, numbers: &[(&str, f64)]) -> Value {
    let mut document = document.clone();
    for (pointer, value) in numbers {
        *document.pointer_mut(pointer).expect("a place") = json!(value);
    }
    document
}

/// A damped pendulum whose angle is measured.
fn pendulum() -> Value {
    json!({
        "version": 1, "name": "pendulum", "gravity": [0, -9.81, 0],
        "bodies": {"bar": {"shape": {"rod": {"length": 1, "radius": 0.02}}, "mass": 2,
            "points": {"pin": [-0.4, 0, 0]},
            "place": {"put": "pin", "at": [0, 0, 0], "turn": {"axis": [0, 0, 1], "angle": -0.5}}}},
        "joints": {"hinge": {"revolute": {"between": ["bar", "ground"], "at": "bar.pin", "axis": [0, 0, 1]}}},
        "loads": {"damper": {"damping": {"joint": "hinge", "coefficient": 0.2}}},
        "simulation": {"duration": 3, "tolerance": 1e-9},
        "functions": {"misfit": {"misfit": {"series": {"angle": {
            "of": {"rotation": {"body": "bar", "axis": [0, 0, 1]}}, "standard_deviation": 0.01}}}}},
        "variables": {
            "pin": {"path": "/bodies/bar/points/pin/0", "lower": -0.5, "upper": -0.2},
            "damping": {"path": "/loads/damper/damping/coefficient", "lower": 0, "upper": 2},
            "angle": {"path": "/bodies/bar/place/turn/angle", "lower": -1.5, "upper": 0}},
        "objective": {"minimise": "misfit"}
    })
}

const PIN: &str = "/bodies/bar/points/pin/0";
const DAMPING: &str = "/loads/damper/damping/coefficient";
const ANGLE: &str = "/bodies/bar/place/turn/angle";

fn times(count: usize, step: f64) -> Vec<f64> {
    (1..=count).map(|k| k as f64 * step).collect()
}

/// The committed problem: least squares are chosen, take about ten evaluations, and find the numbers behind the
/// data to three standard deviations.
#[test]
fn the_double_pendulum_is_fitted() {
    let problem = Problem::load(&committed(), &[]).expect("no faults");
    let done = optimised(&problem);
    assert_eq!(done.outcome.method, Method::LeastSquares);
    assert_eq!(done.outcome.status, Status::Converged);
    assert!(
        done.outcome.counts.evaluations <= 20,
        "{:?}",
        done.outcome.counts
    );
    let fit = done.optimum.fit.as_ref().expect("a fit");
    assert_eq!(
        (fit.data, fit.freedom, fit.variance),
        (492, 486, VarianceFrom::Given)
    );
    assert!(fit.undetermined.is_empty());
    let truth = [
        ("lower mass", 0.3),
        ("shoulder damping", 0.006),
        ("elbow damping", 0.003),
        ("upper angle", -0.6),
        ("lower angle", -1.1),
        ("offset", 0.03),
    ];
    for (name, value) in truth {
        let deviation = fit.standard_deviations[name].expect("determined");
        let error = done.optimum.design[name].value - value;
        assert!(
            error.abs() < 3.0 * deviation,
            "{name}: {error} of {deviation}"
        );
        assert!(deviation < 0.1 * value.abs(), "{name}: {deviation}");
    }
    let reduced = fit.reduced_chi_square.expect("enough data");
    assert!((0.8..1.2).contains(&reduced), "{reduced}");
    certified(&problem, &done);
    let text = summary(&done.optimum);
    assert!(
        text.contains("Fit of 6 numbers to 492 measured values"),
        "{text}"
    );
}

/// Derivatives of a misfit in every number, the offset and the duration too, are exact.
#[test]
fn derivatives_are_exact() {
    let mut document = with_data(&pendulum(), &times(20, 0.13), || 0.0);
    document["functions"]["misfit"]["misfit"]["series"]["angle"]["offset"] = json!(0.1);
    document["variables"]["offset"] =
        json!({"path": "/functions/misfit/misfit/series/angle/offset", "lower": 0, "upper": 0.3});
    document["variables"]["duration"] = json!({"path": "/simulation/duration", "lower": 2.9});
    let document = from(&document, &[(PIN, -0.35), (DAMPING, 0.3)]);
    let problem = parse(&document);
    for derivative in check(&problem, &problem.start()).expect("runs") {
        let exact = derivative.relative_difference() < 1e-10;
        assert!(exact || derivative.differs_by_round_off(), "{derivative:?}");
    }
}

/// Exact data: the residuals vanish, and neither gradients nor accuracy raise an alarm.
#[test]
fn exact_data_raise_no_alarm() {
    let document = with_data(&pendulum(), &times(25, 0.1), || 0.0);
    let problem = parse(&from(
        &document,
        &[(PIN, -0.3), (DAMPING, 0.5), (ANGLE, -0.8)],
    ));
    let done = optimised(&problem);
    assert_eq!(done.outcome.status, Status::Converged);
    assert!(
        done.optimum.objective.value < 1e-12,
        "{:?}",
        done.optimum.objective
    );
    assert!((done.optimum.design["pin"].value + 0.4).abs() < 1e-7);
    assert!(
        done.optimum.warnings.is_empty(),
        "{:?}",
        done.optimum.warnings
    );
    certified(&problem, &done);
    // A start at the solution too.
    let problem = parse(&document);
    let done = optimised(&problem);
    assert_eq!(done.outcome.status, Status::Converged);
    certified(&problem, &done);
}

/// The motion does not depend on mass and damping in proportion: this is said by name, and the others are known.
#[test]
fn numbers_that_the_data_do_not_determine_are_named() {
    let mut noise = Noise(3);
    let mut document = with_data(&pendulum(), &times(40, 0.07), || 0.01 * noise.normal());
    document["variables"]["mass"] = json!({"path": "/bodies/bar/mass", "lower": 0.1, "upper": 10});
    let problem = parse(&from(&document, &[(DAMPING, 0.3)]));
    let done = optimised(&problem);
    assert_eq!(done.outcome.status, Status::Converged);
    let fit = done.optimum.fit.as_ref().expect("a fit");
    let names: Vec<&str> = fit.undetermined[0].keys().map(String::as_str).collect();
    assert_eq!(fit.undetermined.len(), 1);
    assert_eq!(names, ["damping", "mass"]);
    let value = |name: &str| done.optimum.design[name].value;
    let ratio = fit.undetermined[0]["damping"] / fit.undetermined[0]["mass"];
    assert!((ratio / (value("damping") / value("mass")) - 1.0).abs() < 1e-6);
    assert_eq!(fit.standard_deviations["mass"], None);
    assert!(fit.standard_deviations["pin"].is_some_and(|own| own > 0.0));
    assert!(summary(&done.optimum).contains("The data do not see the change damping"));
}

/// A number at a bound is held: it has no standard deviation, and those of others are smaller.
#[test]
fn bounds_are_kept() {
    let mut noise = Noise(4);
    let mut document = with_data(&pendulum(), &times(40, 0.07), || 0.01 * noise.normal());
    document["variables"]["damping"]["lower"] = json!(0.3);
    let problem = parse(&from(&document, &[(DAMPING, 0.5)]));
    let done = optimised(&problem);
    assert_eq!(done.outcome.status, Status::Converged);
    assert_eq!(done.optimum.design["damping"].value, 0.3);
    let fit = done.optimum.fit.as_ref().expect("a fit");
    assert_eq!(
        (fit.standard_deviations["damping"], fit.freedom),
        (Some(0.0), 38)
    );
}

/// A double pendulum: over 200 draws of noise, the scatter of each number is what the fits say, to 10 %. The scatter of 200
/// draws is itself known to 5 %, so not every set of draws passes.
#[test]
fn the_covariance_is_the_scatter_of_draws() {
    let text = std::fs::read_to_string(committed()).expect("a file");
    let mut document: Value = serde_json::from_str(&text).expect("a document");
    document["simulation"] = json!({"duration": 2.0, "tolerance": 1e-7});
    let series = "/functions/misfit/misfit/series";
    for name in ["upper bar", "lower bar"] {
        let own = document.pointer_mut(&format!("{series}/{name}"));
        let own = own.and_then(Value::as_object_mut).expect("a series");
        own.shift_remove("file");
    }
    let truth = [
        ("lower mass", 0.3),
        ("shoulder damping", 0.006),
        ("elbow damping", 0.003),
        ("upper angle", -0.6),
        ("lower angle", -1.1),
        ("offset", 0.03),
    ];
    for (name, value) in truth {
        let own = &document["variables"][name];
        let paths = own["paths"].as_array().cloned();
        for path in paths.unwrap_or_else(|| vec![own["path"].clone()]) {
            let path = path.as_str().expect("a path");
            *document.pointer_mut(path).expect("a place") = json!(value);
        }
    }
    // No damping is at its bound in any draw.
    for (name, value) in [("shoulder damping", 0.06), ("elbow damping", 0.03)] {
        document["loads"][name]["damping"]["coefficient"] = json!(value);
    }
    let truth = truth.map(|(name, value)| match name {
        "shoulder damping" | "elbow damping" => (name, 10.0 * value),
        _ => (name, value),
    });
    let exact = with_data(&document, &times(40, 0.045), || 0.0);
    const DRAWS: u64 = 200;
    let draw = |draw: u64| -> [[f64; 2]; 6] {
        let mut noise = Noise(700_001 + 1000 * draw);
        let mut drawn = exact.clone();
        for name in ["upper bar", "lower bar"] {
            let rows = drawn.pointer_mut(&format!("{series}/{name}/table"));
            for row in rows.and_then(Value::as_array_mut).expect("rows") {
                let y = row[1].as_f64().expect("a number");
                row[1] = json!(y + 0.01 * noise.normal());
            }
        }
        let done = optimised(&parse(&drawn));
        let (counts, kkt) = (&done.outcome.counts, &done.outcome.kkt);
        assert_eq!(done.outcome.status, Status::Converged, "{counts:?} {kkt:?}");
        let fit = done.optimum.fit.as_ref().expect("a fit");
        truth.map(|(name, value)| {
            let error = done.optimum.design[name].value - value;
            [error * error, fit.covariance[name][name]]
        })
    };
    let all: Vec<[[f64; 2]; 6]> = (0..DRAWS).into_par_iter().map(draw).collect();
    for (i, (name, _)) in truth.iter().enumerate() {
        let [scatter, said] = [0, 1].map(|k| all.iter().map(|own| own[i][k]).sum::<f64>());
        let ratio = (said / scatter).sqrt();
        assert!((ratio - 1.0).abs() < 0.1, "{name}: {ratio}");
    }
}

/// A sum of misfits with fixed factors is solved as least squares, and ends where another method does.
#[test]
fn a_sum_of_misfits_is_solved_as_least_squares() {
    let mut noise = Noise(8);
    let data = |document: &Value, noise: &mut Noise| {
        let own = with_data(document, &times(30, 0.09), || 0.01 * noise.normal());
        own["functions"]["misfit"].clone()
    };
    let mut document = pendulum();
    let angle = data(&document, &mut noise);
    document["functions"]["misfit"]["misfit"]["series"]["angle"] = json!({
        "of": {"velocity": {"body": "bar", "point": [0.5, 0, 0], "direction": [1, 0, 0]}},
        "standard_deviation": 0.02});
    let speed = data(&document, &mut noise);
    document["functions"] = json!({"angle": angle, "speed": speed});
    document["parameters"] = json!({"part": 0.25});
    document["objective"] = json!({"minimise": {"expression": "2*angle + part*(speed + angle)/2"}});
    let start = from(&document, &[(PIN, -0.35), (DAMPING, 0.3), (ANGLE, -0.6)]);
    let problem = parse(&start);
    let done = optimised(&problem);
    assert_eq!(done.outcome.method, Method::LeastSquares);
    assert_eq!(done.outcome.status, Status::Converged);
    assert!(done.outcome.counts.evaluations <= 12);
    certified(&problem, &done);
    let fit = done.optimum.fit.as_ref().expect("a fit");
    assert_eq!((fit.data, fit.freedom), (60, 57));
    let names: Vec<&str> = fit.series.keys().map(String::as_str).collect();
    assert_eq!(names, ["angle: angle", "speed: angle"]);
    for (name, value) in [("pin", -0.4), ("damping", 0.2), ("angle", -0.5)] {
        let deviation = fit.standard_deviations[name].expect("determined");
        let error = done.optimum.design[name].value - value;
        assert!(
            error.abs() < 3.0 * deviation,
            "{name}: {error} of {deviation}"
        );
    }
    let mut other = start.clone();
    other["optimiser"] = json!({"method": "interior_point", "tolerance": 1e-9});
    let other = optimised(&parse(&other));
    let (f, g) = (done.outcome.objective, other.outcome.objective);
    assert!((f / g - 1.0).abs() < 1e-8, "{f} {g}");
    assert!(other.outcome.counts.evaluations > done.outcome.counts.evaluations);
    // With a difference, a product or a variable factor it is no such sum.
    let mut wrong = start.clone();
    wrong["optimiser"] = json!({"method": "least_squares"});
    parse(&wrong);
    for text in [
        "angle - speed",
        "angle*speed",
        "angle + 1",
        "angle + 0*speed",
    ] {
        wrong["objective"]["minimise"]["expression"] = json!(text);
        let faults = Problem::parse(&wrong.to_string(), "fit.json", &[]).expect_err(text);
        assert!(faults.to_string().contains("fixed factors"), "{faults}");
    }
}

/// Young's modulus and damping of a beam from the motion of its tip.
#[test]
fn stiffness_and_damping_of_a_beam_follow_from_its_tip() {
    let document = json!({
        "version": 1, "name": "beam", "gravity": [0, -9.81, 0],
        "bodies": {"beam": {"beam": {"length": 1,
            "material": {"young": 7e10, "poisson": 0.3, "density": 2700},
            "section": {"rectangle": {"height": 0.01, "width": 0.02}}, "frame": "clamped",
            "modes": {"bending_y": 2, "bending_z": 0, "torsion": 0},
            "damping": {"ratio": 0.02}}, "place": {"put": "start", "at": [0, 0, 0]}}},
        "joints": {"root": {"revolute": {"between": ["beam", "ground"], "at": "beam.start", "axis": [0, 0, 1]}}},
        "drives": {"held": {"joint": "root", "turn": {"polynomial": [0]}}},
        "simulation": {"duration": 0.6, "tolerance": 1e-7},
        "functions": {"misfit": {"misfit": {"series": {"tip": {
            "of": {"elastic_displacement": {"body": "beam", "point": "end", "direction": [0, 1, 0]}},
            "standard_deviation": 1e-4}}}}},
        "variables": {
            "young": {"path": "/bodies/beam/beam/material/young", "lower": 1e10, "upper": 3e11},
            "damping": {"path": "/bodies/beam/beam/damping/ratio", "lower": 0, "upper": 0.5}},
        "objective": {"minimise": "misfit"}
    });
    let mut noise = Noise(5);
    let data = with_data(&document, &times(60, 0.0095), || 1e-4 * noise.normal());
    let start = [
        ("/bodies/beam/beam/material/young", 6.5e10),
        ("/bodies/beam/beam/damping/ratio", 0.005),
    ];
    let problem = parse(&from(&data, &start));
    let done = optimised(&problem);
    assert_eq!(done.outcome.status, Status::Converged);
    assert!(
        done.outcome.counts.evaluations <= 20,
        "{:?}",
        done.outcome.counts
    );
    let fit = done.optimum.fit.as_ref().expect("a fit");
    for (name, value) in [("young", 7e10), ("damping", 0.02)] {
        let deviation = fit.standard_deviations[name].expect("determined");
        let error = done.optimum.design[name].value - value;
        assert!(
            error.abs() < 3.0 * deviation,
            "{name}: {error} of {deviation}"
        );
        assert!(deviation < 0.1 * value, "{name}: {deviation}");
    }
    certified(&problem, &done);
}

/// Coulomb friction of a hinge from the decay of a swing.
#[test]
fn friction_follows_from_a_swing() {
    let mut document = pendulum();
    document["loads"] =
        json!({"rub": {"friction": {"joint": "hinge", "size": 0.3, "width": 0.05}}});
    document["variables"] = json!({
        "friction": {"path": "/loads/rub/friction/size", "lower": 0, "upper": 3},
        "angle": {"path": ANGLE, "lower": -1.5, "upper": 0}});
    let mut noise = Noise(6);
    let data = with_data(&document, &times(40, 0.07), || 0.01 * noise.normal());
    let problem = parse(&from(&data, &[("/loads/rub/friction/size", 0.05)]));
    let done = optimised(&problem);
    assert_eq!(done.outcome.status, Status::Converged);
    assert!(
        done.outcome.counts.evaluations <= 20,
        "{:?}",
        done.outcome.counts
    );
    let fit = done.optimum.fit.as_ref().expect("a fit");
    let deviation = fit.standard_deviations["friction"].expect("determined");
    let error = done.optimum.design["friction"].value - 0.3;
    assert!(error.abs() < 3.0 * deviation, "{error} of {deviation}");
}

/// A fault of data, with its place: in the table of the document.
#[test]
fn faults_of_tables_are_told_with_their_place() {
    let cases: [(Value, &str, &str); 6] = [
        (
            json!([]),
            "/functions/misfit/misfit/series/angle/table",
            "at least one row",
        ),
        (
            json!([[0.1]]),
            "/functions/misfit/misfit/series/angle/table/0",
            "[time, value]",
        ),
        (
            json!([[0.2, 1], [0.1, 1]]),
            "/functions/misfit/misfit/series/angle/table/1/0",
            "in their order",
        ),
        (
            json!([[0.1, 1, 0]]),
            "/functions/misfit/misfit/series/angle/table/0/2",
            "above zero",
        ),
        (
            json!([[0.1, 1], [3.5, 1]]),
            "/functions/misfit/misfit/series/angle/table/1/0",
            "inside of the motion",
        ),
        (
            json!([[-0.1, 1]]),
            "/functions/misfit/misfit/series/angle/table/0/0",
            "inside of the motion",
        ),
    ];
    for (table, path, expected) in cases {
        let mut document = pendulum();
        document["functions"]["misfit"]["misfit"]["series"]["angle"]["table"] = table;
        let text = serde_json::to_string_pretty(&document).expect("text");
        let faults = Problem::parse(&text, "fit.json", &[]).expect_err("a fault");
        let fault = &faults.list[0];
        assert_eq!(fault.path, path, "{faults}");
        assert!(
            fault.expected.contains(expected) && fault.line > 1,
            "{faults}"
        );
    }
    let faults = Problem::parse(&pendulum().to_string(), "fit.json", &[]).expect_err("a fault");
    assert!(
        faults
            .to_string()
            .contains("neither \"table\" nor \"file\""),
        "{faults}"
    );
    let mut document = with_data(&pendulum(), &[0.1], || 0.0);
    document["optimiser"] = json!({"method": "least_squares"});
    document["objective"] = json!({"maximise": "misfit"});
    let faults = Problem::parse(&document.to_string(), "fit.json", &[]).expect_err("a fault");
    assert!(faults.to_string().contains("fixed factors"), "{faults}");
}

/// The same in a file of values: with file, line and column.
#[test]
fn faults_of_files_are_told_with_their_place() {
    let cases = [
        ("time,angle\n0.1,1\n", "data.csv:1:1", "a column \"value\""),
        ("time,value\n", "data.csv:1:1", "lines of numbers"),
        ("time,value\n0.1,one\n", "data.csv:2:5", "a finite number"),
        (
            "# angles\ntime,value\n0.1,1\n0.2\n",
            "data.csv:4:1",
            "as many as columns",
        ),
        (
            "time;value\n0.2;1\n0.1;1\n",
            "data.csv:3:1",
            "in their order",
        ),
        (
            "time,value\n0.1,1\n9,1\n",
            "data.csv:3:1",
            "inside of the motion",
        ),
        (
            "time,value,standard_deviation\n0.1,1,-1\n",
            "data.csv:2:7",
            "above zero",
        ),
    ];
    let directory = tempfile::tempdir().expect("a directory");
    let mut document = pendulum();
    document["functions"]["misfit"]["misfit"]["series"]["angle"]["file"] =
        json!({"path": "data.csv"});
    let path = directory.path().join("fit.json");
    std::fs::write(&path, document.to_string()).expect("is written");
    let faults = Problem::load(&path, &[]).expect_err("a fault").to_string();
    assert!(
        faults.contains("no file") && faults.contains("fit.json:1:"),
        "{faults}"
    );
    for (text, place, expected) in cases {
        std::fs::write(directory.path().join("data.csv"), text).expect("is written");
        let faults = Problem::load(&path, &[]).expect_err("a fault").to_string();
        assert!(faults.contains(place), "{place} is not in {faults}");
        assert!(faults.contains(expected), "{expected} is not in {faults}");
    }
    let sound = "\u{feff}\"time\"; \"value\"; weight\r\n0.1; -1; 4\r\n\r\n0.1; 2; 1\r\n";
    std::fs::write(directory.path().join("data.csv"), sound).expect("is written");
    let problem = Problem::load(&path, &[]).expect("no faults");
    let at = flexbody_driver::Evaluated::new(&problem, &problem.start()).expect("runs");
    let flexbody_mechanics::functions::Function::Misfit { series } = &at.scene.functions[0] else {
        panic!("a misfit");
    };
    assert_eq!(series[0].data.values, [-1.0, 2.0]);
    assert_eq!(series[0].data.weights, [200.0, 100.0]);
    // Another text gives another hash.
    let hash = problem.hash.clone();
    std::fs::write(directory.path().join("data.csv"), sound.replace('4', "3")).expect("is written");
    assert_ne!(Problem::load(&path, &[]).expect("no faults").hash, hash);
}

/// A portal frame whose frequencies are known at its own numbers.
fn frame() -> Value {
    let function = |mode: usize| json!({"frequency": {"mode": mode}});
    json!({
        "version": 1, "name": "frame",
        "materials": {"steel": {"young": 2.1e11, "poisson": 0.3, "density": 7850}},
        "structures": {"portal": {
            "mesh": {"frame": {
                "points": {"a": [0, 0, 0], "b": [0, 0, 1], "c": [1.2, 0, 1], "d": [1.2, 0, 0]},
                "members": {
                    "left": {"between": ["a", "b"], "orientation": [0, 1, 0], "elements": 2},
                    "beam": {"between": ["b", "c"], "orientation": [0, 1, 0], "elements": 3},
                    "right": {"between": ["c", "d"], "orientation": [0, 1, 0], "elements": 2}
                }
            }},
            "material": "steel", "line_mass": 0.5,
            "section": {"rectangle": {"width": 0.04, "height": 0.06}},
            "supports": {"feet": {"nodes": ["a", "d"]}}
        }},
        "functions": {"first": function(1), "second": function(2), "third": function(3)},
        "variables": {
            "young": {"path": "/materials/steel/young", "lower": 1e10, "upper": 1e12},
            "line mass": {"path": "/structures/portal/line_mass", "lower": 0, "upper": 50}
        }
    })
}

/// The stiffness of a frame from its frequencies; with one number more, what they do not determine.
#[test]
fn frequencies_of_a_frame_give_its_stiffness() {
    let mut document = frame();
    let problem = parse(&document);
    let at = flexbody_driver::Simulated::of(&problem, &problem.start()).expect("runs");
    let numbers: Vec<Value> = ["first", "second", "third"]
        .iter()
        .enumerate()
        .map(|(f, name)| {
            let exact = at.value(f);
            json!({"function": name, "value": exact * (1.0 + 1e-4 * (f as f64 - 1.0)),
                   "standard_deviation": 1e-3 * exact})
        })
        .collect();
    document["functions"]["misfit"] = json!({"misfit": {"numbers": numbers}});
    document["objective"] = json!({"minimise": "misfit"});
    let start = from(&document, &[("/materials/steel/young", 1.6e11)]);
    let mut only = start.clone();
    let variables = only["variables"].as_object_mut().expect("variables");
    variables.shift_remove("line mass");
    let problem = parse(&only);
    let done = optimised(&problem);
    assert_eq!(done.outcome.status, Status::Converged);
    assert_eq!(done.outcome.method, Method::LeastSquares);
    assert!(
        done.outcome.counts.evaluations <= 20,
        "{:?}",
        done.outcome.counts
    );
    let fit = done.optimum.fit.as_ref().expect("a fit");
    let young = &done.optimum.design["young"];
    let deviation = fit.standard_deviations["young"].expect("determined");
    assert!(
        (young.value - 2.1e11).abs() < deviation,
        "{young:?} {deviation}"
    );
    // d ln f = ½ d ln E for all three.
    let expected = 2.0 * 1e-3 / 3.0_f64.sqrt() * young.value;
    assert!(
        (deviation / expected - 1.0).abs() < 1e-3,
        "{deviation} {expected}"
    );
    assert_eq!(fit.numbers.len(), 3);
    certified(&problem, &done);
    // Mass and stiffness in proportion: the own mass is fixed, so the line mass is known but not well.
    let problem = parse(&from(&start, &[("/structures/portal/line_mass", 2.0)]));
    for derivative in flexbody_driver::analysed::check(&problem, &problem.start()).expect("runs") {
        let exact = derivative.relative_difference() < 1e-9;
        assert!(
            exact || derivative.differs_by_round_off() || derivative.is_round_off(),
            "{derivative:?}"
        );
    }
    let mut wrong = document.clone();
    wrong["functions"]["misfit"]["misfit"]["numbers"][0]["function"] = json!("fourth");
    let faults = Problem::parse(&wrong.to_string(), "frame.json", &[]).expect_err("a fault");
    assert!(faults.to_string().contains("\"fourth\""), "{faults}");
}
