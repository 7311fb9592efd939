//! What the command claims: comparisons of runs without an optimum, fixed variables, valleys of a sweep, errors
//! of constraints, other forms of a scene, and ends by a signal.

use crate::program::{
    HAMMER, TREBUCHET, changed, expect, files, json, optimum, read, scratch, start,
};
use serde_json::Value;
use std::path::Path;
use std::process::Command;
use std::time::Duration;

/// Writes a problem file and returns its path.
fn written(directory: &Path, name: &str, document: &Value) -> String {
    let path = directory.join(name);
    std::fs::write(&path, document.to_string()).expect("is written");
    path.to_string_lossy().into_owned()
}

/// Runs that stopped at a limit, or found no feasible design, are not the same optimum, even if equal.
#[test]
fn runs_without_an_optimum_are_not_the_same_optimum() {
    let at = scratch();
    let none = r#"/constraints/light work/upper=1e-9"#;
    for (name, set, status) in [
        (
            "limited",
            r#"/optimiser={"iterations":1}"#,
            "iteration_limit",
        ),
        (
            "evaluations",
            r#"/optimiser={"evaluations":2}"#,
            "evaluation_limit",
        ),
        ("infeasible", none, "infeasible"),
    ] {
        expect(1, at.path(), &[HAMMER, "--set", set, "-q", "-o", name]);
        assert_eq!(optimum(&at.path().join(name))["status"], status);
        let ran = expect(1, at.path(), &["compare", name, name]);
        let told = format!("no two optima: the new run ended as {status}");
        assert!(ran.out.starts_with(&told), "{}", ran.out);
    }
    expect(0, at.path(), &[HAMMER, "-q", "-o", "whole"]);
    for pair in [["limited", "whole"], ["whole", "infeasible"]] {
        let ran = expect(1, at.path(), &["compare", pair[0], pair[1]]);
        assert!(ran.out.starts_with("no two optima: "), "{}", ran.out);
    }
}

/// Equal bounds take a variable out of the optimisation: the optimum is that of the file without it.
#[test]
fn equal_bounds_fix_a_variable() {
    let at = scratch();
    for (k, (fixed, value)) in [("head mass", 2.0), ("reach", 0.4)].into_iter().enumerate() {
        for method in ["interior_point", "trust_region"] {
            let method = json(&format!(r#"{{"method": "{method}", "tolerance": 1e-8}}"#));
            let both = changed(at.path(), "both.json", |document| {
                document["optimiser"] = method.clone();
                document["constraints"]["light work"]["upper"] = 6.5.into();
                document["variables"][fixed]["lower"] = value.into();
                document["variables"][fixed]["upper"] = value.into();
            });
            let one = changed(at.path(), "one.json", |document| {
                document["optimiser"] = method.clone();
                document["constraints"]["light work"]["upper"] = 6.5.into();
                let variables = document["variables"].as_object_mut();
                variables.expect("an object").remove(fixed);
            });
            let ran = expect(0, at.path(), &[&both, "-o", "both"]);
            expect(0, at.path(), &[&one, "-q", "-o", "one"]);
            let [both, one] = ["both", "one"].map(|name| optimum(&at.path().join(name)));
            assert_eq!(both["design"][fixed]["value"], value, "{k}");
            assert_eq!(both["active_bounds"][fixed], "fixed");
            let row = ran.out.lines().find(|line| line.contains(fixed));
            assert!(row.is_some_and(|row| row.contains("fixed")), "{}", ran.out);
            let value = |record: &Value| record["objective"]["value"].as_f64().expect("a number");
            let (a, b) = (value(&both), value(&one));
            assert!(
                (a - b).abs() <= 1e-6 * b.abs(),
                "{fixed}: {a} instead of {b}"
            );
        }
    }
    // Nothing is left to design: the start is the optimum.
    let all = changed(at.path(), "all.json", |document| {
        document["variables"]["head mass"]["lower"] = 2.0.into();
        document["variables"]["head mass"]["upper"] = 2.0.into();
        document["variables"]["reach"]["lower"] = 0.4.into();
        document["variables"]["reach"]["upper"] = 0.4.into();
        document["constraints"]["light work"]["upper"] = 1e3.into();
    });
    expect(0, at.path(), &[&all, "-q", "-o", "all"]);
    assert_eq!(
        optimum(&at.path().join("all"))["counts"]["function_evaluations"],
        1
    );
}

/// A ball of 1 kg between two valleys of a spring, E = ½ k (|x| − 1)² − m g x with k = 5 N/m. At g = −6 m/s²
/// there is the left valley alone. At g = 0.3 m/s² the left one has E = 0.291 J at x = −0.94 m, the
/// right one E = −0.309 J at x = 1.06 m: E = −m g (± 1 + m g/2k).
#[test]
fn a_sweep_leaves_a_valley_that_the_start_of_the_file_avoids() {
    let at = scratch();
    let ball = json(
        r#"{"version": 1, "name": "valleys", "gravity": [0.3, 0, 0],
        "bodies": {"ball": {"shape": {"sphere": {"radius": 0.1}}, "mass": 1, "place": {"at": [0.9, 0, 0]}}},
        "loads": {"spring": {"spring": {"between": ["ball", "ground"],
            "at": {"a": [0, 0, 0], "b": [0, 0, 0]}, "rest_length": 1, "stiffness": 5}}},
        "simulation": {"duration": 1e-6, "steps": 2},
        "functions": {"E": {"final": {"energy": "potential"}}},
        "variables": {"x": {"path": "/bodies/ball/place/at/0", "lower": -4, "upper": 4.1}},
        "objective": {"minimise": "E"}, "optimiser": {"method": "interior_point"}}"#,
    );
    let file = written(at.path(), "valleys.json", &ball);
    // The optimum before alone leads to the left valley.
    let before = [
        &file,
        "--set",
        "/bodies/ball/place/at/0=-1",
        "-q",
        "-o",
        "left",
    ];
    expect(0, at.path(), &before);
    let left = &optimum(&at.path().join("left"))["objective"]["value"];
    assert!(
        (left.as_f64().expect("a number") - 0.291).abs() < 1e-6,
        "{left}"
    );
    let sweep = ["--sweep", "/gravity/0=-6..0.6,23", "-q", "-o", "out"];
    for more in [&[][..], &["--starts", "3"]] {
        expect(0, at.path(), &[&[&file[..]], &sweep[..], more].concat());
        let table = read(&at.path().join("out/sweep.csv"));
        let rows: Vec<Vec<&str>> = table
            .lines()
            .map(|line| line.split(',').collect())
            .collect();
        assert_eq!(rows[0].last(), Some(&"from"));
        assert_eq!(rows[1].last(), Some(&"the start of the file"));
        assert_eq!(rows[2].last(), Some(&"the optimum before"));
        for row in &rows[1..] {
            let [g, value] = [0, 3].map(|k| row[k].parse::<f64>().expect("a number"));
            let right = -g.abs() * (1.0 + g.abs() / 10.0);
            assert!((value - right).abs() < 1e-6, "{row:?}");
        }
        // Between −0.3 and 0.3 m/s² the best valley changes; at 0 both are.
        let before = |row: &&Vec<&str>| row.last() == Some(&"the optimum before");
        assert!(!rows[21..23].iter().all(|row| before(&row)), "{table}");
    }
}

/// A loose tolerance of the steps is told beside a constraint that it may violate; a tight one is not.
#[test]
fn errors_of_constraints_are_told_where_they_exceed_the_margin() {
    let at = scratch();
    // So few steps do not resolve the gradient.
    let coarse = ["--set", "/simulation/tolerance=0.001", "-o", "coarse"];
    let refused = expect(3, at.path(), &[&[TREBUCHET][..], &coarse].concat());
    assert!(
        refused.err.contains("do not resolve the gradient"),
        "{}",
        refused.err
    );
    for (tolerance, told) in [(1e-4, true), (1e-10, false)] {
        let set = format!("/simulation/tolerance={tolerance}");
        let ran = expect(
            0,
            at.path(),
            &[TREBUCHET, "--set", &set, "--no-certificate", "-o", "out"],
        );
        let record = optimum(&at.path().join("out"));
        let row = &record["constraints"]["clear the barrier"];
        let [value, error] =
            ["value", "estimated_error"].map(|key| row[key].as_f64().expect("a number"));
        assert!(ran.out.contains("est. error"), "{}", ran.out);
        let warned = record["warnings"]
            .to_string()
            .contains("\\\"clear the barrier\\\" may be violated");
        assert_eq!(
            warned, told,
            "{tolerance}: {value} with an error of {error}: {record}"
        );
        assert_eq!(
            error > value + 1e-6,
            told,
            "{tolerance}: {value} with an error of {error}"
        );
    }
}

/// Evaluations of a scene as written are not mixed with those of the reduced one, in either order.
#[test]
fn a_run_is_not_resumed_in_another_form_of_the_scene() {
    let at = scratch();
    let form = |written: bool| if written { &["--no-lowering"][..] } else { &[] };
    for written in [false, true] {
        let new = [&[HAMMER, "-q", "-o", "out"], form(written)].concat();
        expect(0, at.path(), &new);
        let before = files(&at.path().join("out"));
        let same = [&[HAMMER, "-q", "--resume", "out"], form(written)].concat();
        expect(0, at.path(), &same);
        assert!(files(&at.path().join("out")) == before);
        let other = [&[HAMMER, "-q", "--resume", "out"], form(!written)].concat();
        let ran = expect(2, at.path(), &other);
        assert!(
            ran.err
                .contains("evaluations.jsonl:1: found evaluations of the"),
            "{}",
            ran.err
        );
        assert!(ran.err.contains("--no-lowering"), "{}", ran.err);
        assert!(files(&at.path().join("out")) == before);
    }
}

/// The figures that are drawn again are those of the run, whatever made its steps: the energies too.
#[test]
fn plots_drawn_again_are_those_of_the_run() {
    let at = scratch();
    let loose = r#"/simulation={"duration": 0.6, "tolerance": 1e-4}"#;
    let cases: [&[&str]; 4] = [
        &["--set", loose],
        &["--set", loose, "--no-lowering"],
        &["--set", loose, "--starts", "3"],
        &[
            "--set",
            loose,
            "--set",
            r#"/optimiser={"method": "trust_region"}"#,
        ],
    ];
    for more in cases {
        expect(
            0,
            at.path(),
            &[&[HAMMER, "-q", "-o", "drawn"], more].concat(),
        );
        let before = files(&at.path().join("drawn"));
        expect(0, at.path(), &["plot", "drawn"]);
        for (name, bytes) in files(&at.path().join("drawn")) {
            assert!(before[&name] == bytes, "{name}: {more:?}");
        }
    }
}

/// A signal ends a simulation under way: alone, this one takes minutes. Nothing was evaluated, so nothing is recorded.
#[cfg(unix)]
#[test]
fn a_signal_ends_a_long_simulation() {
    let at = scratch();
    for (name, more) in [
        ("one", &[][..]),
        ("several", &["--starts", "2"]),
        ("sweep", &["--sweep", "/gravity/1=-10..-9,2"]),
    ] {
        let file = changed(at.path(), "long.json", |document| {
            document["gravity"] = json("[0, -9.81, 0]");
            document["simulation"] =
                json(r#"{"duration": 2e4, "tolerance": 1e-9, "method": "dop853"}"#);
        });
        let mut run = start(at.path(), &[&[&file[..], "-o", name], more].concat());
        std::thread::sleep(Duration::from_millis(400));
        assert!(
            run.try_wait().expect("is known").is_none(),
            "{name} has ended"
        );
        let sent = Command::new("kill")
            .args(["-TERM", &run.id().to_string()])
            .status();
        assert!(sent.expect("kill runs").success());
        for _ in 0..600 {
            if run.try_wait().expect("is known").is_some() {
                break;
            }
            std::thread::sleep(Duration::from_millis(50));
        }
        let ended = run.try_wait().expect("is known");
        let _ = run.kill();
        assert_eq!(ended.and_then(|status| status.code()), Some(130), "{name}");
        let log = at.path().join(name).join("evaluations.jsonl");
        if let Ok(log) = std::fs::read_to_string(log) {
            assert!(!log.contains("no_values"), "{log}");
        }
    }
}

/// Where no derivative ever moved a variable, the end is not called an optimum.
#[test]
fn what_no_derivative_moves_may_be_a_saddle() {
    let at = scratch();
    let file = |x: f64| {
        let document = json(&format!(
            r#"{{
                "version": 1, "name": "saddle", "analysis": "rest", "gravity": [0, 0, 0], "parameters": {{"x": {x}, "y": 0}},
                "bodies": {{"box": {{"shape": {{"box": {{"size": [1, 1, 1]}}}}, "mass": 1}}}},
                "joints": {{"weld": {{"weld": {{"between": ["box", "ground"], "at": [0, 0, 0]}}}}}},
                "functions": {{"f": {{"expression": "(y-1)^2-x^2+x^4"}}}},
                "variables": {{"x": {{"path": "/parameters/x", "lower": -2, "upper": 2}},
                               "y": {{"path": "/parameters/y", "lower": -2, "upper": 2}}}},
                "objective": {{"minimise": "f"}}
            }}"#
        ));
        written(at.path(), "saddle.json", &document)
    };
    let told = "no derivative moved x: this may be a saddle point or a maximum by it";
    let ran = expect(0, at.path(), &[&file(0.0), "-o", "saddle"]);
    assert!(
        ran.err.contains(told) || ran.out.contains(told),
        "{}{}",
        ran.out,
        ran.err
    );
    let ran = expect(0, at.path(), &[&file(0.1), "-o", "minimum"]);
    let optimum = optimum(&at.path().join("minimum"));
    let x = optimum["design"]["x"]["value"].as_f64().expect("a number");
    assert!((x - 0.5_f64.sqrt()).abs() < 1e-5, "{x}");
    assert!(!ran.err.contains(told) && !ran.out.contains(told));
}
