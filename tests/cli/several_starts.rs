//! Killed, interrupted and resumed optimisations from several starts.

use crate::program::{
    HAMMER, TREBUCHET, changed, expect, json, killed_runs_resume, optimum, read, scratch,
};
use std::process::Command;
use std::time::{Duration, Instant};

/// Few samples, wide steps and few iterations shorten the runs.
const SHORT: [&str; 4] = [
    "--set",
    "/simulation={\"duration\": 2, \"samples\": 100, \"tolerance\": 1e-6}",
    "--set",
    "/optimiser={\"iterations\": 25}",
];

/// The kills leave finished, unfinished and new starts.
#[test]
fn killed_starts_resume_to_the_same_optimum_and_repeat_no_evaluation() {
    let records = [1, 2, 3].map(|k| format!("evaluations.start_{k}.jsonl"));
    let arguments = [&[TREBUCHET, "--starts", "3"], &SHORT[..]].concat();
    killed_runs_resume(&arguments, 0.3, &records.each_ref().map(String::as_str));
}

/// A run with more starts uses the results of one with fewer.
#[test]
fn more_starts_go_on_with_fewer() {
    let at = scratch();
    let run = |n: &str, how: &str, to: &str| {
        let arguments = [HAMMER, "--starts", n, how, to, "--second-order"];
        expect(0, at.path(), &arguments)
    };
    let whole = run("4", "--output", "whole");
    run("2", "--output", "out");
    let before = read(&at.path().join("out/evaluations.start_1.jsonl"));
    let ran = run("4", "--resume", "out");
    assert!(
        ran.err
            .contains("evaluations are known and are not repeated"),
        "{}",
        ran.err
    );
    let table = |text: &str| text.lines().take_while(|line| !line.is_empty()).count();
    assert_eq!(
        ran.out.lines().take(table(&ran.out)).collect::<Vec<_>>(),
        whole
            .out
            .lines()
            .take(table(&whole.out))
            .collect::<Vec<_>>()
    );
    assert!(read(&at.path().join("out/evaluations.start_1.jsonl")).starts_with(&before));
    assert_eq!(
        optimum(&at.path().join("out")),
        optimum(&at.path().join("whole"))
    );
}

#[cfg(unix)]
#[test]
fn interrupted_starts_write_the_best_and_exit_with_130() {
    let at = scratch();
    let mut run = Command::new(env!("CARGO_BIN_EXE_optimize"))
        .current_dir(at.path())
        .args([TREBUCHET, "--starts", "200", "--output", "out", "--quiet"])
        .spawn()
        .expect("the program runs");
    let patience = Instant::now();
    let second = at.path().join("out/evaluations.start_2.jsonl");
    while !second.exists() && patience.elapsed() < Duration::from_secs(60) {
        std::thread::sleep(Duration::from_millis(5));
    }
    let sent = Command::new("kill")
        .args(["-INT", &run.id().to_string()])
        .status();
    assert!(sent.expect("kill runs").success());
    assert_eq!(run.wait().expect("ends").code(), Some(130));
    let record = json(&read(&at.path().join("out/optimum.json")));
    let status = record["status"].as_str().expect("a word");
    assert!(["interrupted", "converged"].contains(&status), "{status}");
    assert!(!at.path().join("out/evaluations.start_150.jsonl").exists());
}

/// Every start has its own log. Logs of an earlier run with more starts are removed.
#[test]
fn every_start_keeps_its_evaluations() {
    let at = scratch();
    let log = |k: usize| at.path().join(format!("out/evaluations.start_{k}.jsonl"));
    let problem = changed(at.path(), "bounded.json", |document| {
        for (_, variable) in document["variables"].as_object_mut().expect("variables") {
            for side in ["lower", "upper"] {
                assert!(variable[side].is_number(), "{variable}");
            }
        }
    });
    let starts = |n: &str| {
        let arguments = [&problem, "--starts", n, "--output", "out", "--quiet"];
        expect(0, at.path(), &arguments);
    };
    starts("3");
    let mut beginnings = Vec::new();
    for k in 1..=3 {
        let text = read(&log(k));
        let head = json(text.lines().next().expect("a head"));
        beginnings.push(head["start"].clone());
        let first = json(text.lines().nth(2).expect("an evaluation"));
        assert!(first["values"].is_array(), "{first}");
        assert!(text.lines().count() > 5);
    }
    assert!(beginnings[0] != beginnings[1] && beginnings[1] != beginnings[2]);
    starts("2");
    assert!(log(2).exists() && !log(3).exists());
    let ran = expect(2, at.path(), &[&problem, "--resume", "out"]);
    assert!(
        ran.err.contains("give --starts N to resume it"),
        "{}",
        ran.err
    );
    expect(0, at.path(), &[&problem, "--output", "out", "--quiet"]);
    assert!(!log(1).exists() && !log(2).exists());
    let ran = expect(
        2,
        at.path(),
        &[&problem, "--starts", "2", "--resume", "out"],
    );
    assert!(
        ran.err.contains("leave --starts out to resume it"),
        "{}",
        ran.err
    );
}

/// A ball without gravity has its least energy, zero, at rest. Every start ends there, with a
/// different speed by round-off.
const REST: &str = r#"{
  "version": 1, "name": "rest", "gravity": [0, 0, 0],
  "bodies": {"ball": {"shape": "point", "mass": 2, "velocity": {"linear": [1, 0, 0]}}},
  "simulation": {"duration": 1, "steps": 10},
  "functions": {"energy": {"final": {"energy": "kinetic"}}},
  "variables": {"along": {"path": "/bodies/ball/velocity/linear/0", "lower": -2, "upper": 3},
                "aside": {"path": "/bodies/ball/velocity/linear/2", "lower": -4, "upper": 1}},
  "objective": {"minimise": "energy"}
}"#;

#[test]
fn an_optimum_of_zero_is_one_optimum_and_is_written() {
    let at = scratch();
    std::fs::write(at.path().join("rest.json"), REST).expect("is written");
    let arguments = ["rest.json", "--starts", "6", "--output", "out"];
    let ran = expect(0, at.path(), &arguments);
    let told = "6 of 6 starts converged, to 1 distinct optima";
    assert!(ran.out.contains(told), "{}", ran.out);
    let table = read(&at.path().join("out/optima.csv"));
    let lines: Vec<&str> = table.lines().collect();
    assert_eq!(lines.len(), 2, "{table}");
    assert_eq!(
        lines[0],
        "optimum,best start,starts,objective: energy [J],variable: along [m/s],variable: aside [m/s]"
    );
    assert!(lines[1].starts_with("1,1,6,"), "{table}");
    std::fs::remove_file(at.path().join("out/optima.csv")).expect("is removed");
    expect(0, at.path(), &[&arguments[..], &["--quiet"]].concat());
    assert_eq!(read(&at.path().join("out/optima.csv")), table);
    // A run with a single start has no table of optima.
    let single = ["rest.json", "--output", "out", "--quiet"];
    expect(0, at.path(), &single);
    assert!(!at.path().join("out/optima.csv").exists());
}

/// The time limit applies to all starts together.
#[test]
fn starts_share_the_time() {
    let at = scratch();
    let limit = "/optimiser={\"seconds\": 1e-3}";
    let arguments = [HAMMER, "--starts", "60", "--set", limit, "--output", "out"];
    let ran = expect(1, at.path(), &arguments);
    assert!(ran.out.contains("not begun)"), "{}", ran.out);
    assert_eq!(optimum(&at.path().join("out"))["status"], "time_limit");
    assert!(!at.path().join("out/evaluations.start_60.jsonl").exists());
}
