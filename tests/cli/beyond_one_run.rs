//! Optimisations from another optimum, from many starts, and the check of the curvature.

use crate::program::{HAMMER, expect, files, held, json, read, scratch};

/// A bar that swings fastest if it is hinged at d² = I/m from its centre.
const SWING: &str = include_str!("../data/swing.json");

/// The check follows the record: if it fails, the optimum is there.
#[test]
fn a_check_of_the_curvature_that_fails_loses_nothing() {
    let at = scratch();
    std::fs::write(at.path().join("swing.json"), SWING).expect("is written");
    let run = |code: i32, how: &[&str]| {
        let arguments = [&["swing.json"], how].concat();
        expect(code, at.path(), &arguments)
    };
    run(0, &["--output", "out", "--quiet"]);
    let path = at.path().join("out/evaluations.jsonl");
    let record = || json(&read(&at.path().join("out/optimum.json")));
    let plain = record();
    let before = read(&path).lines().count();
    let ran = run(0, &["--resume", "out", "--second-order"]);
    assert!(
        ran.out.contains("Second order: a strict local optimum"),
        "{}",
        ran.out
    );
    assert_eq!(record()["second_order"]["curvature"], "strict_optimum");
    let text = read(&path);
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(
        lines.len(),
        before + 4,
        "four gradients beside the optimum are recorded"
    );
    // As if the simulation of the first design had failed.
    let design = &json(lines[before])["design"];
    let failed = serde_json::json!({"design": design, "no_gradients": "the bar broke"});
    // Without hashes, as in older versions.
    let bare = |line: &&str| match line.find(",\"chain") {
        Some(hash) => line[..hash].to_owned() + "}\n",
        None => panic!("{line}"),
    };
    let text: String = lines[..before].iter().map(bare).collect();
    let text = text + &failed.to_string() + "\n";
    std::fs::write(&path, text).expect("is written");
    std::fs::remove_file(at.path().join("out/optimum.json")).expect("is removed");
    let ran = run(3, &["--resume", "out", "--second-order"]);
    assert!(ran.err.contains("second order: not checked: ") && ran.err.contains("the bar broke"));
    assert!(ran.out.contains("Minimised swept angle"), "{}", ran.out);
    assert_eq!(record()["design"], plain["design"]);
    assert!(record()["second_order"].is_null());
}

/// The swing has two equal optima, one on each side of the centre.
#[test]
fn many_starts_find_both_optima() {
    let at = scratch();
    std::fs::write(at.path().join("swing.json"), SWING).expect("is written");
    let ran = expect(
        0,
        at.path(),
        &["swing.json", "--starts", "6", "--output", "out"],
    );
    assert!(
        ran.out.contains("starts converged, to 2 distinct optima"),
        "{}",
        ran.out
    );
    let again = expect(
        0,
        at.path(),
        &["swing.json", "--starts", "6", "--output", "again"],
    );
    assert_eq!(ran.out, again.out);
    let open = SWING.replace(r#", "upper": 0.5"#, "");
    std::fs::write(at.path().join("open.json"), open).expect("is written");
    let ran = expect(2, at.path(), &["open.json", "--starts", "6"]);
    assert!(
        ran.err.contains("\"pin\" without two bounds"),
        "{}",
        ran.err
    );
}

#[test]
fn a_start_from_another_optimum_is_warm() {
    let at = scratch();
    let evaluations = |directory: &str| {
        let record = json(&read(&at.path().join(directory).join("optimum.json")));
        record["counts"]["function_evaluations"]
            .as_u64()
            .expect("a count")
    };
    expect(0, at.path(), &[HAMMER, "--output", "cold", "--quiet"]);
    let change = ["--set", "/constraints/light work/upper=5.1", "--quiet"];
    expect(
        0,
        at.path(),
        &[&[HAMMER, "--output", "changed"], &change[..]].concat(),
    );
    let warm = [HAMMER, "--from", "cold", "--output", "warm"];
    expect(0, at.path(), &[&warm[..], &change[..]].concat());
    assert!(evaluations("warm") < evaluations("changed"));
    let objective = |directory: &str| {
        let record = json(&read(&at.path().join(directory).join("optimum.json")));
        record["objective"]["value"].as_f64().expect("a number")
    };
    let (warm, cold) = (objective("warm"), objective("changed"));
    assert!((warm - cold).abs() < 1e-6 * cold, "{warm} {cold}");
    std::fs::write(at.path().join("swing.json"), SWING).expect("is written");
    let ran = expect(2, at.path(), &["swing.json", "--from", "cold"]);
    assert!(
        ran.err
            .contains("found the variables head mass, reach, expected"),
        "{}",
        ran.err
    );
}

#[test]
fn limits_of_the_file_end_the_run_by_name() {
    let at = scratch();
    for (setting, status) in [
        ("/optimiser={\"evaluations\": 3}", "evaluation_limit"),
        ("/optimiser={\"seconds\": 1e-3}", "time_limit"),
        ("/optimiser={\"iterations\": 2}", "iteration_limit"),
    ] {
        let arguments = [HAMMER, "--set", setting, "--output", "out", "--quiet"];
        let ran = expect(1, at.path(), &arguments);
        assert!(ran.err.contains("limit"), "{}", ran.err);
        let record = json(&read(&at.path().join("out/optimum.json")));
        assert_eq!(record["status"], status);
    }
    // The strike is maximised. Its negative decreases by 0.22 m/s, beyond this limit.
    let floor = "/optimiser={\"unbounded_below\": -1e-3}";
    let arguments = [HAMMER, "--set", floor, "--output", "out", "--quiet"];
    let ran = expect(1, at.path(), &arguments);
    assert!(ran.err.contains("without bound"), "{}", ran.err);
    for setting in [
        "/optimiser={\"evaluations\": 0}",
        "/optimiser={\"seconds\": 0}",
        "/optimiser={\"constraint_tolerance\": 0}",
        "/optimiser={\"unbounded_below\": 0}",
        "/optimiser={\"unbounded_below\": 1e20}",
        "/optimiser={\"unbounded_below\": \"low\"}",
    ] {
        let ran = expect(2, at.path(), &[HAMMER, "--set", setting]);
        assert!(ran.err.contains("/optimiser/"), "{}", ran.err);
    }
}

/// The time of the quadratic programs is reported, and their number recorded.
#[test]
fn the_time_of_the_quadratic_programs_is_told() {
    let at = scratch();
    let method = "/optimiser={\"method\": \"trust_region\"}";
    let ran = expect(0, at.path(), &[HAMMER, "--set", method, "--output", "out"]);
    let line = ran.err.lines().find(|line| line.starts_with("Time: "));
    let line = line.unwrap_or_else(|| panic!("{}", ran.err));
    assert!(line.contains(" quadratic programs "), "{line}");
    let record = json(&read(&at.path().join("out/optimum.json")));
    assert!(record["counts"]["quadratic_programs"].as_u64() > Some(0));
}

/// The design in the file counts, not the state in the same directory.
#[test]
fn a_start_from_an_edited_optimum_is_at_its_design() {
    let at = scratch();
    expect(0, at.path(), &[HAMMER, "--output", "cold", "--quiet"]);
    let path = at.path().join("cold/optimum.json");
    let mut record = json(&read(&path));
    let wanted = [1.5, 0.3];
    for (name, value) in ["head mass", "reach"].into_iter().zip(wanted) {
        record["design"][name]["value"] = value.into();
    }
    std::fs::write(&path, record.to_string()).expect("is edited");
    let warm = [HAMMER, "--from", "cold", "--output", "warm", "--quiet"];
    expect(0, at.path(), &warm);
    let evaluations = read(&at.path().join("warm/evaluations.jsonl"));
    let mut lines = evaluations.lines().skip(1).map(json);
    let first = lines.find(|line| line["values"].is_array());
    let design = &first.expect("an evaluation")["design"];
    for (k, wanted) in wanted.into_iter().enumerate() {
        let x = design[k].as_f64().expect("a number");
        assert!((x - wanted).abs() < 1e-14, "{design}");
    }
}

/// The energy of a ball is maximised from rest, where it is least: the start is stationary.
const REST: &str = r#"{
  "version": 1, "name": "rest", "gravity": [0, 0, 0],
  "bodies": {"ball": {"shape": "point", "mass": 2, "velocity": {"linear": [0, 0, 0]}}},
  "simulation": {"duration": 1, "steps": 10},
  "functions": {"energy": {"final": {"energy": "kinetic"}}},
  "variables": {"along": {"path": "/bodies/ball/velocity/linear/0", "lower": -2, "upper": 3}},
  "objective": {"maximise": "energy"}
}"#;

/// It is left: the largest energy is that of 3 m/s.
#[test]
fn a_stationary_start_that_is_no_optimum_is_left() {
    let at = scratch();
    std::fs::write(at.path().join("rest.json"), REST).expect("is written");
    expect(
        0,
        at.path(),
        &["rest.json", "--output", "out", "--second-order"],
    );
    let found = json(&read(&at.path().join("out/optimum.json")));
    let energy = found["objective"]["value"].as_f64().expect("a number");
    assert!((energy - 9.0).abs() < 1e-6, "{energy}");
}

/// The angular momentum m x v of a ball is a saddle at rest, to which a start on its ridge leads.
const SADDLE: &str = r#"{
  "version": 1, "name": "saddle", "gravity": [0, 0, 0],
  "bodies": {"ball": {
    "shape": "point", "mass": 2, "velocity": {"linear": [0, 1, 0]}, "place": {"put": [0, 0, 0], "at": [1, 0, 0]}
  }},
  "simulation": {"duration": 1, "steps": 4},
  "functions": {"spin": {"final": {"angular_momentum": {"direction": [0, 0, 1]}}}},
  "variables": {
    "along": {"path": "/bodies/ball/velocity/linear/1", "lower": -2, "upper": 3},
    "aside": {"path": "/bodies/ball/place/at/0", "lower": -2, "upper": 3}
  },
  "objective": {"minimise": "spin"}
}"#;

#[test]
fn a_stationary_point_that_is_no_optimum_fails_the_check() {
    let at = scratch();
    std::fs::write(at.path().join("saddle.json"), SADDLE).expect("is written");
    let run = |code: i32, how: &[&str]| {
        let arguments = [&["saddle.json", "--output", "out"], how].concat();
        expect(code, at.path(), &arguments)
    };
    run(0, &[]);
    let ran = run(1, &["--second-order"]);
    assert!(
        ran.out.contains("Second order: no local optimum"),
        "{}",
        ran.out
    );
    assert!(ran.out.contains("it improves along along "), "{}", ran.out);
    let found = json(&read(&at.path().join("out/optimum.json")));
    let descent = found["second_order"]["descent"]["along"].as_f64();
    assert!(descent.expect("a number").abs() > 0.1, "{found}");
    let ran = run(1, &["--second-order", "--quiet"]);
    assert!(ran.err.contains("no local optimum"), "{}", ran.err);
}

#[test]
fn a_time_limit_that_is_over_at_once_leaves_the_values_of_the_start() {
    let at = scratch();
    let limit = ["--set", "/optimiser={\"seconds\": 1e-9}", "--output", "out"];
    let ran = expect(1, at.path(), &[&[HAMMER][..], &limit].concat());
    assert!(!(ran.out + &ran.err).contains("NaN"));
    let record = json(&read(&at.path().join("out/optimum.json")));
    assert_eq!(record["status"], "time_limit");
    for name in ["head mass", "reach"] {
        let design = &record["design"][name];
        let [x, start] = ["value", "start"].map(|key| design[key].as_f64().expect("a number"));
        assert!((x - start).abs() <= 1e-15, "{design}");
    }
    let [value, start] = [&record["objective"]["value"], &record["start_objective"]]
        .map(|number| number.as_f64().expect("a number"));
    assert!((value - start).abs() <= 1e-9 * start.abs(), "{record}");
}

/// A second run in the same directory is rejected while the first one runs, and changes nothing.
#[test]
fn a_directory_has_one_run_at_a_time() {
    let at = scratch();
    let directory = at.path().join("out");
    let run = |code: i32, how: &[&str]| {
        let arguments = [&[HAMMER, "--quiet"], how].concat();
        expect(code, at.path(), &arguments)
    };
    run(0, &["--output", "out"]);
    let before = files(&directory);
    let held = held(&directory);
    for how in [["--output", "out"], ["--resume", "out"]] {
        let ran = run(2, &how);
        assert!(
            ran.err.contains("out: found a run that is writing"),
            "{}",
            ran.err
        );
        assert!(files(&directory) == before);
    }
    // Its log may be read.
    run(0, &["--resume", "out", "--output", "other"]);
    drop(held);
    run(0, &["--resume", "out"]);
    assert!(files(&directory) == before);
}
