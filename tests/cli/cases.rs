//! A problem with cases, as a user runs it: tables, files, pictures, records, and runs that go on.

use crate::program::{expect, json, names, optimum, read, scratch};
use serde_json::Value;
use std::path::Path;

/// A pendulum that is let go in two motions and held at rest.
const SWING: &str = r#"{
  "version": 1, "name": "swing",
  "bodies": {
    "bar": {"shape": {"rod": {"length": 1, "radius": 0.02}}, "mass": 2,
      "points": {"pin": [-0.5, 0, 0], "tip": [0.5, 0, 0]},
      "place": {"put": "pin", "at": [0, 0, 0], "turn": {"axis": [0, 0, 1], "degrees": -20}}}
  },
  "joints": {"hinge": {"revolute": {"between": ["bar", "ground"], "at": "bar.pin", "axis": [0, 0, 1]}}},
  "loads": {
    "spring": {"spring": {"between": ["bar", "ground"], "at": {"a": "tip", "b": [0.5, 1, 0]},
                          "rest_length": 0.5, "stiffness": 60}},
    "wind": {"force": {"body": "bar", "point": "tip", "direction": [0, -1, 0], "magnitude": 1}}
  },
  "simulation": {"duration": 0.4, "tolerance": 1e-6},
  "cases": {
    "calm": {},
    "storm": {"set": {"/loads/wind/force/magnitude": 20, "/simulation/duration": 0.5}},
    "parked": {"analysis": "rest"}
  },
  "functions": {
    "height": {"final": {"position": {"body": "bar", "point": "tip", "direction": [0, 1, 0]}}},
    "worst": {"over_cases": {"function": "height", "by": {"ks": {"of": "smallest"}}}},
    "spread": {"expression": "('height in calm' - 'height in storm')^2"}
  },
  "variables": {
    "stiffness": {"path": "/loads/spring/spring/stiffness", "lower": 20, "upper": 300},
    "rest": {"path": "/loads/spring/spring/rest_length", "lower": 0.1, "upper": 0.9}
  },
  "objective": {"maximise": "worst"},
  "constraints": {"height": {"function": "height", "upper": 0.4}}
}"#;

fn written(at: &Path) {
    std::fs::write(at.join("swing.json"), SWING).expect("is written");
}

#[test]
fn every_case_is_told_and_has_its_files() {
    let at = scratch();
    written(at.path());
    let told = expect(
        0,
        at.path(),
        &["simulate", "swing.json", "--output", "out", "--report"],
    );
    for text in [
        "swing in calm: 0.4 s",
        "swing in storm: 0.5 s",
        "swing in parked: at rest",
        "swing: 3 cases",
        "worst",
    ] {
        assert!(told.out.contains(text), "{text}: {}", told.out);
    }
    for case in ["calm", "storm"] {
        let files = names(&at.path().join("out").join(case));
        for name in ["motion.svg", "energy.svg", "motion.csv"] {
            assert!(files.iter().any(|own| own == name), "{case}: {files:?}");
        }
    }
    let page = read(&at.path().join("out/report.html"));
    assert!(page.contains("storm") && page.contains("height in parked"));
    let told = expect(
        0,
        at.path(),
        &["simulate", "swing.json", "--json", "--error"],
    );
    let all: Value = json(&told.out);
    let value = |name: &str| all["functions"][name]["value"].as_f64().expect("a value");
    assert_eq!(
        all["cases"]["storm"]["functions"]["height"]["value"],
        value("height in storm")
    );
    assert_eq!(all["cases"]["parked"]["analysis"], "rest");
    let spread = (value("height in calm") - value("height in storm")).powi(2);
    assert!((value("spread") - spread).abs() < 1e-15);
    assert!(
        all["functions"]["worst"]["true_value"].is_number()
            && all["functions"]["worst"]["error"].is_number(),
        "{all}"
    );
    // One by itself.
    let told = expect(
        0,
        at.path(),
        &["simulate", "swing.json", "--case", "storm", "--json"],
    );
    let own: Value = json(&told.out);
    assert_eq!(
        own["functions"]["height"]["value"],
        value("height in storm")
    );
    let told = expect(2, at.path(), &["simulate", "swing.json", "--case", "strom"]);
    assert!(
        told.err
            .contains("found --case strom, expected one of calm, storm, parked"),
        "{}",
        told.err
    );
    let told = expect(2, at.path(), &["work-precision", "swing.json"]);
    assert!(told.err.contains("--case NAME"), "{}", told.err);
    let told = expect(0, at.path(), &["explain", "swing.json"]);
    assert!(
        told.out.contains("swing in calm") && told.out.contains("swing in parked"),
        "{}",
        told.out
    );
    expect(0, at.path(), &["check", "swing.json", "--quiet"]);
}

#[test]
fn an_optimum_of_cases_is_recorded_and_compared() {
    let at = scratch();
    written(at.path());
    expect(
        0,
        at.path(),
        &["swing.json", "--output", "out", "--quiet", "--report"],
    );
    let found = optimum(&at.path().join("out"));
    let constraints = found["constraints"].as_object().expect("constraints");
    let names_of: Vec<&String> = constraints.keys().collect();
    assert_eq!(
        names_of,
        ["height in calm", "height in storm", "height in parked"]
    );
    assert_eq!(found["gradient_certificate"]["passed"], true);
    let functions = found["gradient_certificate"]["optimum"]["functions"]
        .as_object()
        .expect("functions");
    for name in ["height in calm", "height in parked", "worst", "spread"] {
        assert!(functions.contains_key(name), "{name}");
    }
    for file in [
        "convergence.svg",
        "storm/motion.svg",
        "parked/motion.svg",
        "report.html",
    ] {
        assert!(at.path().join("out").join(file).is_file(), "{file}");
    }
    // From its record alone.
    let picture = at.path().join("out/storm/motion.svg");
    let drawn = read(&picture);
    std::fs::remove_file(&picture).expect("removed");
    expect(0, at.path(), &["plot", "out"]);
    assert_eq!(read(&picture), drawn);
    expect(0, at.path(), &["report", "out"]);
    expect(
        0,
        at.path(),
        &["swing.json", "--output", "second", "--quiet"],
    );
    expect(0, at.path(), &["compare", "second", "out"]);
}
