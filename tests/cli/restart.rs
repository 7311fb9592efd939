//! Killed, interrupted or resumed runs lose no evaluation and repeat none.

use crate::program::{
    HAMMER, TREBUCHET, changed, expect, json, killed_runs_resume, names, optimum, read, scratch,
};
use std::process::Command;
use std::time::{Duration, Instant};

#[test]
fn a_killed_run_resumes_to_the_same_optimum_and_repeats_no_evaluation() {
    // A tenth of the samples: the work of the optimiser is the same.
    let arguments = [TREBUCHET, "--set", "/simulation/samples=300"];
    killed_runs_resume(&arguments, 0.5, &["evaluations.jsonl"]);
}

/// The log is cut after every line, with a part of the next line. The resumed run writes the same
/// files, byte for byte.
fn goes_on_after_every_line(problem: &str, code: i32, judge: impl Fn(&str)) {
    let at = scratch();
    let directory = at.path().join("out");
    let path = directory.join("evaluations.jsonl");
    let run = |how: &[&str]| {
        let arguments = [&[problem, "--second-order", "--quiet"], how].concat();
        expect(code, at.path(), &arguments);
        crate::program::files(&directory)
    };
    let whole = run(&["--output", "out"]);
    let record = read(&path);
    judge(&record);
    let lines: Vec<&str> = record.split_inclusive('\n').collect();
    assert!(lines.len() > 10, "{record}");
    for k in 0..lines.len() {
        let cut = lines[..k].concat() + &lines[k][..lines[k].len() / 2];
        std::fs::write(&path, cut).expect("is cut");
        let found = run(&["--resume", "out"]);
        for (name, bytes) in &whole {
            assert!(found.get(name) == Some(bytes), "{name} after {k} lines");
        }
    }
}

/// With the check of the curvature and adaptive steps.
#[test]
fn a_record_of_any_length_is_gone_on_with() {
    let at = scratch();
    let problem = changed(at.path(), "hammer.json", |document| {
        document["simulation"] = json(r#"{"duration": 0.6, "tolerance": 1e-6}"#);
    });
    goes_on_after_every_line(&problem, 0, |record| {
        assert!(record.contains("\"ends\""), "{record}");
    });
}

/// The first guess of an event's time depends on the run before, which a resumed run has not made.
#[test]
fn a_run_that_ends_at_an_event_is_gone_on_with() {
    let at = scratch();
    for steps in ["\"steps\": 60", "\"tolerance\": 1e-6"] {
        let problem = changed(at.path(), "hammer.json", |document| {
            let until = r#"{"measure": {"rotation": {"body": "handle", "axis": [0, 0, 1]}}, "reaches": -1.2}"#;
            document["simulation"] =
                json(&format!(r#"{{"duration": 3, {steps}, "until": {until}}}"#));
        });
        goes_on_after_every_line(&problem, 0, |record| {
            assert!(record.contains("\"event\""), "{record}");
        });
    }
}

/// Each case has steps and an event of its own.
#[test]
fn a_run_of_cases_is_gone_on_with() {
    let at = scratch();
    let until =
        r#"{"measure": {"rotation": {"body": "handle", "axis": [0, 0, 1]}}, "reaches": -1.2}"#;
    let problem = changed(at.path(), "hammer.json", |document| {
        document["simulation"] = json(r#"{"duration": 0.6, "tolerance": 1e-6}"#);
        let whole = json(&format!(
            r#"{{"duration": 3, "tolerance": 1e-6, "until": {until}}}"#
        ));
        document["cases"] = json("{\"timed\": {}, \"turned\": {\"set\": {}}}");
        document["cases"]["turned"]["set"]["/simulation"] = whole;
        let names: Vec<String> = { document["functions"].as_object() }
            .expect("functions")
            .keys()
            .cloned()
            .collect();
        let objective = document["objective"].as_object().expect("an objective");
        let (sense, function) = objective.iter().next().expect("a sense");
        let (sense, function) = (sense.clone(), function.clone());
        assert!(
            names.iter().any(|name| function == name.as_str()),
            "{function}"
        );
        document["functions"]["both"] = json("{}");
        document["functions"]["both"]["over_cases"] = json("{\"by\": \"mean\"}");
        document["functions"]["both"]["over_cases"]["function"] = function;
        document["objective"] = json("{}");
        document["objective"][sense] = json("\"both\"");
    });
    goes_on_after_every_line(&problem, 0, |record| {
        assert!(
            record.contains("\"events_of_cases\"") && record.contains("\"cases\""),
            "{record}"
        );
    });
}

/// Each phase of a motion has its own steps.
#[test]
fn a_run_of_phases_is_gone_on_with() {
    let latch = concat!(env!("CARGO_MANIFEST_DIR"), "/problems/latch.json");
    goes_on_after_every_line(latch, 0, |record| {
        assert!(record.contains("a step's error of"), "{record}");
    });
}

/// A run that was killed before its first evaluation starts again, and its files are removed. A
/// directory without a run is not changed.
#[test]
fn a_run_that_has_just_begun_is_resumed() {
    let at = scratch();
    expect(0, at.path(), &[HAMMER, "--output", "whole", "--quiet"]);
    let whole = read(&at.path().join("whole/evaluations.jsonl"));
    let head = whole.lines().next().expect("a head");
    let directory = at.path().join("out");
    let path = directory.join("evaluations.jsonl");
    let begun = |left: &str, told: &str| {
        let _ = std::fs::remove_dir_all(&directory);
        std::fs::create_dir(&directory).expect("is made");
        std::fs::write(directory.join(".flexbody-Xy12.tmp"), "half").expect("is written");
        std::fs::write(&path, left).expect("is written");
        let ran = expect(0, at.path(), &[HAMMER, "--resume", "out"]);
        assert!(ran.err.contains(told), "{}", ran.err);
        assert_eq!(read(&path), whole);
        assert_eq!(names(&directory), names(&at.path().join("whole")));
    };
    let anew = "out: no evaluation yet, starts anew\n";
    begun("", anew);
    begun(&head[..20], anew);
    begun(&format!("{head}\n"), anew);
    let three: Vec<&str> = whole.split_inclusive('\n').take(5).collect();
    begun(&three.concat(), "out: 3 evaluations are known");
    let ran = expect(2, at.path(), &[HAMMER, "--resume", "nowhere"]);
    assert!(ran.err.contains("no directory nowhere"), "{}", ran.err);
    assert!(!at.path().join("nowhere").exists());
    std::fs::create_dir_all(at.path().join("empty/below")).expect("is made");
    for starts in [&[][..], &["--starts", "2"]] {
        for output in [&[][..], &["--output", "other"]] {
            let arguments = [&[HAMMER, "--resume", "empty"], starts, output].concat();
            let ran = expect(2, at.path(), &arguments);
            let told = "found no record of a run in empty, expected evaluations";
            assert!(ran.err.contains(told), "{}", ran.err);
            assert!(
                names(&at.path().join("empty")).is_empty() && !at.path().join("other").exists()
            );
        }
    }
}

/// Limits, names and figures do not affect the functions. Differences are reported.
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
        // A difference is reported once.
        let ran = expect(0, at.path(), &again);
        assert!(!ran.err.contains("changed since"), "{}", ran.err);
    }
}

/// Another method uses other designs. Known ones are not evaluated again.
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

/// The work is that of the first run, and is counted once.
#[test]
fn a_run_that_has_ended_is_resumed_without_a_simulation() {
    let at = scratch();
    expect(0, at.path(), &[HAMMER, "--output", "out", "--quiet"]);
    let before = crate::program::files(&at.path().join("out"));
    expect(0, at.path(), &[HAMMER, "--resume", "out", "--quiet"]);
    assert!(crate::program::files(&at.path().join("out")) == before);
    let record = optimum(&at.path().join("out"));
    assert!(record["counts"]["steps"].as_u64() > Some(1000), "{record}");
}

/// A file that the problem names is a part of it: with other data the evaluations are those of another problem.
#[test]
fn a_run_is_not_resumed_with_other_data() {
    let at = scratch();
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/problems/");
    for name in ["fit_pendulum.json", "fit_pendulum.csv"] {
        std::fs::copy(format!("{root}{name}"), at.path().join(name)).expect("is copied");
    }
    let limit = ["--set", "/optimiser={\"evaluations\":3}"];
    let problem = "fit_pendulum.json";
    let first = [&[problem, "--output", "out"], &limit[..]].concat();
    expect(1, at.path(), &first);
    let data = read(&at.path().join("fit_pendulum.csv"));
    std::fs::write(at.path().join("fit_pendulum.csv"), format!("{data}\n")).expect("is written");
    let ran = expect(2, at.path(), &[problem, "--resume", "out"]);
    let told = "the evaluations of another problem or start";
    assert!(ran.err.contains(told), "{}", ran.err);
    std::fs::write(at.path().join("fit_pendulum.csv"), data).expect("is written");
    expect(0, at.path(), &[problem, "--resume", "out"]);
}
