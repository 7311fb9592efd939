//! Optimisations from several starts, killed, interrupted and resumed.

use crate::program::{HAMMER, TREBUCHET, changed, expect, json, names, optimum, read, scratch};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

const STARTS: &str = "3";
/// Few samples, wide steps and few iterations: what is resumed is the same.
const SHORT: [&str; 4] = [
    "--set",
    "/simulation={\"duration\": 2, \"samples\": 100, \"tolerance\": 1e-6}",
    "--set",
    "/optimiser={\"iterations\": 25}",
];

fn arguments<'a>(how: &[&'a str]) -> Vec<&'a str> {
    [&[TREBUCHET, "--starts", STARTS], &SHORT[..], how].concat()
}

fn start(directory: &Path, output: &str) -> Child {
    Command::new(env!("CARGO_BIN_EXE_optimize"))
        .current_dir(directory)
        .args(arguments(&["--output", output]))
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("the program runs")
}

fn records(directory: &Path) -> Vec<String> {
    let log = |k: usize| directory.join(format!("evaluations.start_{k}.jsonl"));
    let text = |k| std::fs::read_to_string(log(k)).unwrap_or_default();
    (1..=3).map(text).collect()
}

/// Ended starts, starts under way and starts that were not begun among them.
#[test]
fn killed_starts_resume_to_the_same_optimum_and_repeat_no_evaluation() {
    let at = scratch();
    let begun = Instant::now();
    start(at.path(), "whole").wait().expect("ends");
    let duration = begun.elapsed();
    let whole = at.path().join("whole");
    let all = records(&whole);
    let code = match optimum(&whole)["status"] == "converged" {
        true => 0,
        false => 1,
    };
    let mut in_the_midst = 0;
    for k in 0..20 {
        let output = format!("killed_{k}");
        let directory = at.path().join(&output);
        let mut run = start(at.path(), &output);
        let moment = (0.3 + f64::from(k) * 0.618_033_988_749_895).fract();
        std::thread::sleep(duration.mul_f64(moment));
        run.kill().expect("is killed or has ended");
        run.wait().expect("has ended");
        let left = records(&directory);
        for (left, all) in left.iter().zip(&all) {
            let kept = &left[..left.rfind('\n').map_or(0, |end| end + 1)];
            assert!(all.starts_with(kept), "moment {k}");
        }
        in_the_midst +=
            usize::from(left != all && left.iter().any(|left| left.lines().count() > 1));
        let how = if directory.exists() {
            "--resume"
        } else {
            "--output"
        };
        expect(code, at.path(), &arguments(&[how, &output, "--quiet"]));
        assert!(records(&directory) == all, "moment {k}");
        assert_eq!(optimum(&directory), optimum(&whole), "moment {k}");
        assert_eq!(names(&directory), names(&whole), "moment {k}");
    }
    assert!(in_the_midst >= 5, "{in_the_midst} runs were killed midway");
}

/// Starts are counted on: more of them find those of the first run done.
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

/// Every start has its own record; those of an earlier call with more starts are gone.
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
        let first = json(text.lines().nth(1).expect("an evaluation"));
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
