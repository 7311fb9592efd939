//! Runs that are killed, interrupted or resumed lose nothing and repeat nothing.

use crate::program::{HAMMER, expect, json, names, read, scratch};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

const TREBUCHET: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/problems/trebuchet.json");
/// A tenth of the steps: the work of the optimiser is the same.
const STEPS: &str = "/simulation/samples=300";

fn start(directory: &Path, output: &str) -> Child {
    Command::new(env!("CARGO_BIN_EXE_optimize"))
        .current_dir(directory)
        .args([TREBUCHET, "--set", STEPS, "--output", output])
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("the program runs")
}

/// The optimum without the work of its simulations, which a resumed run has less of.
fn optimum(directory: &Path) -> serde_json::Value {
    let mut record = json(&read(&directory.join("optimum.json")));
    for work in ["steps", "newton_iterations", "factorisations", "solves"] {
        record["counts"]
            .as_object_mut()
            .expect("counts")
            .remove(work);
    }
    record
}

/// Twenty moments spread over the whole run, early ones among them.
#[test]
fn a_killed_run_resumes_to_the_same_optimum_and_repeats_no_evaluation() {
    let at = scratch();
    let begun = Instant::now();
    assert!(start(at.path(), "whole").wait().expect("ends").success());
    let duration = begun.elapsed();
    let whole = at.path().join("whole");
    let evaluations = read(&whole.join("evaluations.jsonl"));
    let mut begun_anew = 0;
    for k in 0..20 {
        let output = format!("killed_{k}");
        let directory = at.path().join(&output);
        let mut run = start(at.path(), &output);
        // A fraction of the golden ratio: spread without a pattern.
        let moment = (0.5 + f64::from(k) * 0.618_033_988_749_895).fract();
        std::thread::sleep(duration.mul_f64(moment));
        run.kill().expect("is killed or has ended");
        run.wait().expect("has ended");
        let left = std::fs::read_to_string(directory.join("evaluations.jsonl"));
        // Killed before its first evaluation, it has lost none, and begins anew.
        let arguments = match &left {
            Ok(_) => [TREBUCHET, "--set", STEPS, "--resume", &output, "--quiet"],
            Err(_) => {
                assert!(!directory.join("optimum.json").exists());
                begun_anew += 1;
                [TREBUCHET, "--set", STEPS, "--output", &output, "--quiet"]
            }
        };
        let left = left.unwrap_or_default();
        let kept = &left[..left.rfind('\n').map_or(0, |end| end + 1)];
        assert!(evaluations.starts_with(kept), "moment {k}");
        expect(0, at.path(), &arguments);
        // The same evaluations in the same order, none of them twice.
        assert_eq!(
            read(&directory.join("evaluations.jsonl")),
            evaluations,
            "moment {k}"
        );
        assert_eq!(optimum(&directory), optimum(&whole), "moment {k}");
    }
    assert!(
        begun_anew <= 5,
        "{begun_anew} runs had no evaluation when they were killed"
    );
}

#[cfg(unix)]
#[test]
fn an_interrupted_run_writes_everything_and_exits_with_130() {
    let at = scratch();
    let mut run = Command::new(env!("CARGO_BIN_EXE_optimize"))
        .current_dir(at.path())
        .args([TREBUCHET, "--output", "out", "--quiet"])
        .spawn()
        .expect("the program runs");
    let history = at.path().join("out/history.partial.csv");
    let patience = Instant::now();
    while !history.exists() && patience.elapsed() < Duration::from_secs(60) {
        std::thread::sleep(Duration::from_millis(5));
    }
    let sent = Command::new("kill")
        .args(["-INT", &run.id().to_string()])
        .status();
    assert!(sent.expect("kill runs").success());
    assert_eq!(run.wait().expect("ends").code(), Some(130));
    let record = json(&read(&at.path().join("out/optimum.json")));
    assert_eq!(record["status"], "interrupted");
    assert!(names(&at.path().join("out")).contains(&"convergence.svg".to_owned()));
}

#[test]
fn a_record_of_another_problem_is_not_resumed() {
    let at = scratch();
    expect(0, at.path(), &[HAMMER, "--output", "out", "--quiet"]);
    let before = crate::program::files(&at.path().join("out"));
    let other = [HAMMER, "--set", "/bodies/head/mass=3", "--resume", "out"];
    let ran = expect(2, at.path(), &other);
    assert!(
        ran.err
            .contains("evaluations.jsonl:1: found the evaluations of another problem"),
        "{}",
        ran.err
    );
    assert_eq!(crate::program::files(&at.path().join("out")), before);
    let ran = expect(2, at.path(), &[HAMMER, "--resume", "nowhere"]);
    assert!(ran.err.contains("nowhere"), "{}", ran.err);
    assert!(!at.path().join("nowhere").exists());
}

#[test]
fn a_run_that_has_ended_is_resumed_without_a_simulation() {
    let at = scratch();
    expect(0, at.path(), &[HAMMER, "--output", "out", "--quiet"]);
    let evaluations = read(&at.path().join("out/evaluations.jsonl"));
    expect(0, at.path(), &[HAMMER, "--resume", "out", "--quiet"]);
    assert_eq!(read(&at.path().join("out/evaluations.jsonl")), evaluations);
    let record = json(&read(&at.path().join("out/optimum.json")));
    assert_eq!(record["counts"]["steps"], 0);
}

/// The record is there before the first evaluation is.
#[test]
fn a_run_without_an_evaluation_can_be_resumed() {
    let at = scratch();
    expect(0, at.path(), &[HAMMER, "--output", "out", "--quiet"]);
    let path = at.path().join("out/evaluations.jsonl");
    let whole = read(&path);
    let head = whole.lines().next().expect("a head").to_owned() + "\n";
    std::fs::write(&path, head).expect("is written");
    expect(0, at.path(), &[HAMMER, "--resume", "out", "--quiet"]);
    assert_eq!(read(&path), whole);
}

/// Every start has its own record; those of an earlier call with more starts are gone.
#[test]
fn every_start_keeps_its_evaluations() {
    let at = scratch();
    let log = |k: usize| at.path().join(format!("out/evaluations.start_{k}.jsonl"));
    let problem = crate::program::changed(at.path(), "bounded.json", |document| {
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
        let first = json(text.lines().nth(1).expect("an evaluation"));
        assert!(first["values"].is_array(), "{first}");
        assert!(text.lines().count() > 5);
    }
    assert!(beginnings[0] != beginnings[1] && beginnings[1] != beginnings[2]);
    starts("2");
    assert!(log(2).exists() && !log(3).exists());
    let ran = expect(2, at.path(), &[HAMMER, "--resume", "out"]);
    assert!(ran.err.contains("evaluations.jsonl"), "{}", ran.err);
}
