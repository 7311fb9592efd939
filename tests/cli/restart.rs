//! Runs that are killed, interrupted or resumed lose nothing and repeat nothing.

use crate::program::{HAMMER, TREBUCHET, expect, json, names, optimum, read, scratch};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

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

/// Twenty moments spread over the whole run, early ones among them.
#[test]
fn a_killed_run_resumes_to_the_same_optimum_and_repeats_no_evaluation() {
    let at = scratch();
    let begun = Instant::now();
    assert!(start(at.path(), "whole").wait().expect("ends").success());
    let duration = begun.elapsed();
    let whole = at.path().join("whole");
    let evaluations = read(&whole.join("evaluations.jsonl"));
    let mut in_the_midst = 0;
    for k in 0..20 {
        let output = format!("killed_{k}");
        let directory = at.path().join(&output);
        let mut run = start(at.path(), &output);
        // A fraction of the golden ratio: spread without a pattern.
        let moment = (0.5 + f64::from(k) * 0.618_033_988_749_895).fract();
        std::thread::sleep(duration.mul_f64(moment));
        run.kill().expect("is killed or has ended");
        run.wait().expect("has ended");
        let left = std::fs::read_to_string(directory.join("evaluations.jsonl")).unwrap_or_default();
        let kept = &left[..left.rfind('\n').map_or(0, |end| end + 1)];
        assert!(evaluations.starts_with(kept), "moment {k}");
        in_the_midst += usize::from(kept.lines().count() > 1 && kept != evaluations);
        // Killed before it made its directory, it was not begun.
        let how = if directory.exists() {
            "--resume"
        } else {
            "--output"
        };
        let arguments = [TREBUCHET, "--set", STEPS, how, &output, "--quiet"];
        expect(0, at.path(), &arguments);
        // The same evaluations in the same order, none of them twice.
        let found = read(&directory.join("evaluations.jsonl"));
        assert_eq!(found, evaluations, "moment {k}");
        assert_eq!(optimum(&directory), optimum(&whole), "moment {k}");
        let history = |directory: &Path| read(&directory.join("history.csv"));
        assert_eq!(history(&directory), history(&whole), "moment {k}");
        assert_eq!(names(&directory), names(&whole), "moment {k}");
    }
    assert!(in_the_midst >= 5, "{in_the_midst} runs were killed midway");
}

/// Cut after every line, with the check of the curvature among them.
#[test]
fn a_record_of_any_length_is_gone_on_with() {
    let at = scratch();
    let path = at.path().join("out/evaluations.jsonl");
    let tolerance = [
        "--set",
        "/simulation={\"duration\": 0.6, \"tolerance\": 1e-6}",
    ];
    let run = |how: &[&str]| {
        let arguments = [&[HAMMER, "--second-order", "--quiet"], &tolerance[..], how].concat();
        expect(0, at.path(), &arguments);
        (read(&path), optimum(&at.path().join("out")))
    };
    let (whole, best) = run(&["--output", "out"]);
    let lines: Vec<&str> = whole.split_inclusive('\n').collect();
    assert!(whole.contains("\"steps\"") && lines.len() > 10, "{whole}");
    for k in 0..lines.len() {
        // A part of the next line is there too.
        let cut = lines[..k].concat() + &lines[k][..lines[k].len() / 2];
        std::fs::write(&path, cut).expect("is cut");
        let (found, again) = run(&["--resume", "out"]);
        assert_eq!(found, whole, "after {k} lines");
        assert_eq!(again, best, "after {k} lines");
    }
}

/// A run that was killed before it had written a line is begun anew, and what it left is removed.
#[test]
fn a_run_that_has_just_begun_is_resumed() {
    let at = scratch();
    expect(0, at.path(), &[HAMMER, "--output", "whole", "--quiet"]);
    let whole = read(&at.path().join("whole/evaluations.jsonl"));
    let head = whole.lines().next().expect("a head");
    let directory = at.path().join("out");
    let path = directory.join("evaluations.jsonl");
    let begun = |left: Option<&str>, told: &str| {
        let _ = std::fs::remove_dir_all(&directory);
        std::fs::create_dir(&directory).expect("is made");
        std::fs::write(directory.join(".flexbody-Xy12.tmp"), "half").expect("is written");
        if let Some(left) = left {
            std::fs::write(&path, left).expect("is written");
        }
        let ran = expect(0, at.path(), &[HAMMER, "--resume", "out"]);
        assert!(ran.err.contains(told), "{}", ran.err);
        assert_eq!(read(&path), whole);
        assert_eq!(names(&directory), names(&at.path().join("whole")));
    };
    let anew = "out: no evaluation yet, starts anew\n";
    begun(None, anew);
    begun(Some(""), anew);
    begun(Some(&head[..20]), anew);
    begun(Some(&format!("{head}\n")), anew);
    let three: Vec<&str> = whole.split_inclusive('\n').take(4).collect();
    begun(Some(&three.concat()), "out: 3 evaluations are known");
    let ran = expect(2, at.path(), &[HAMMER, "--resume", "nowhere"]);
    assert!(ran.err.contains("no directory nowhere"), "{}", ran.err);
    assert!(!at.path().join("nowhere").exists());
}

/// Limits, names and figures are no part of the functions; what differs is told.
#[test]
fn a_run_at_its_limit_goes_on_with_a_higher_one() {
    let at = scratch();
    let end = |directory: &str| {
        let directory = at.path().join(directory);
        let evaluations = read(&directory.join("evaluations.jsonl"));
        let (_, evaluations) = evaluations.split_once('\n').expect("a head");
        let mut record = optimum(&directory);
        record.as_object_mut().expect("an object").remove("problem");
        (evaluations.to_owned(), record)
    };
    expect(0, at.path(), &[HAMMER, "--output", "whole", "--quiet"]);
    for (limit, few) in [
        ("iterations", "2"),
        ("evaluations", "3"),
        ("seconds", "1e-3"),
    ] {
        let [low, high] = [few, "1000"].map(|n| format!("/optimiser={{\"{limit}\": {n}}}"));
        let limited = [HAMMER, "--set", &low, "--output", "out", "--quiet"];
        expect(1, at.path(), &limited);
        let (part, _) = end("out");
        let again = [
            HAMMER,
            "--set",
            &high,
            "--set",
            "/name=\"maul\"",
            "--resume",
            "out",
        ];
        let ran = expect(0, at.path(), &again);
        let few: f64 = few.parse().expect("a number");
        let count = |n: f64| {
            if limit == "seconds" {
                format!("{n}")
            } else {
                format!("{n:.0}")
            }
        };
        let told = format!(
            "changed since the resumed run: /optimiser/{limit} was {}",
            count(few)
        );
        assert!(
            ran.err.contains(&told) && ran.err.contains("is 1000"),
            "{}",
            ran.err
        );
        let named = "/name was \"hammer\", is \"maul\"";
        assert!(ran.err.contains(named), "{}", ran.err);
        let (evaluations, record) = end("out");
        assert!(evaluations.starts_with(&part) && evaluations.len() > part.len());
        assert_eq!((evaluations, record), end("whole"), "{limit}");
        // What was told once is not told again.
        let ran = expect(0, at.path(), &again);
        assert!(!ran.err.contains("changed since"), "{}", ran.err);
    }
}

/// Another method asks for other designs; where it asks for known ones, nothing is repeated.
#[test]
fn another_method_takes_the_evaluations_over() {
    let at = scratch();
    expect(0, at.path(), &[HAMMER, "--output", "out", "--quiet"]);
    let path = at.path().join("out/evaluations.jsonl");
    let method = "/optimiser={\"method\": \"trust_region\"}";
    let ran = expect(0, at.path(), &[HAMMER, "--set", method, "--resume", "out"]);
    let told = "/optimiser/method was left out, is \"trust_region\"";
    assert!(ran.err.contains(told), "{}", ran.err);
    let text = read(&path);
    let mut lines: Vec<&str> = text.lines().collect();
    let all = lines.len();
    let kind = |line: &&str| line.contains("\"values\"");
    let resumed = lines.iter().filter(|line| kind(line)).count();
    lines.sort_unstable();
    lines.dedup();
    assert_eq!(lines.len(), all, "no evaluation stands there twice");
    let fresh = [HAMMER, "--set", method, "--output", "fresh", "--quiet"];
    expect(0, at.path(), &fresh);
    let [a, b] = ["out", "fresh"].map(|directory| {
        let record = optimum(&at.path().join(directory));
        record["objective"]["value"].as_f64().expect("a number")
    });
    assert!((a - b).abs() <= 1e-6 * b.abs() && resumed > 5, "{a} {b}");
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
