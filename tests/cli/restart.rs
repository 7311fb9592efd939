//! Runs that are killed, interrupted or resumed lose nothing and repeat nothing.

use crate::program::{HAMMER, expect, json, names, read, scratch};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

const TREBUCHET: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/problems/trebuchet.json");
/// A tenth of the steps: the work of the optimiser is the same.
const STEPS: &str = "/simulation/steps=200";

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
    let mut resumed = 0;
    for k in 0..20 {
        let output = format!("killed_{k}");
        let directory = at.path().join(&output);
        let mut run = start(at.path(), &output);
        // A fraction of the golden ratio: spread without a pattern.
        let moment = (0.5 + f64::from(k) * 0.618_033_988_749_895).fract();
        std::thread::sleep(duration.mul_f64(moment));
        run.kill().expect("is killed or has ended");
        run.wait().expect("has ended");
        let Ok(left) = std::fs::read_to_string(directory.join("evaluations.jsonl")) else {
            continue;
        };
        let kept = &left[..left.rfind('\n').map_or(0, |end| end + 1)];
        assert!(evaluations.starts_with(kept), "moment {k}");
        let arguments = [TREBUCHET, "--set", STEPS, "--resume", &output, "--quiet"];
        expect(0, at.path(), &arguments);
        // The same evaluations in the same order, none of them twice.
        assert_eq!(
            read(&directory.join("evaluations.jsonl")),
            evaluations,
            "moment {k}"
        );
        assert_eq!(optimum(&directory), optimum(&whole), "moment {k}");
        resumed += 1;
    }
    assert!(
        resumed >= 15,
        "only {resumed} runs had begun when they were killed"
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
