//! `--sensitivity PATH` and `--sweep PATH=a..b,n`.

use crate::program::{HAMMER, TREBUCHET, expect, json, names, read, scratch, start};
use crate::statics::written;
use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

const TIGHT: [&str; 3] = [
    "--no-certificate",
    "--set",
    "/optimiser={\"tolerance\": 1e-9}",
];

/// The optimal objective of a problem with changes.
fn optimum(at: &Path, problem: &str, changes: &[&str]) -> f64 {
    let sets = changes.iter().flat_map(|change| ["--set", change]);
    let sets: Vec<&str> = sets.collect();
    let arguments = [&[problem, "--quiet", "--output", "out"], &TIGHT[..], &sets].concat();
    expect(0, at, &arguments);
    let record = json(&read(&at.join("out/optimum.json")));
    record["objective"]["value"].as_f64().expect("a number")
}

/// The sensitivity is the difference of optima: of a maximised objective with an active constraint,
/// and of a minimised one of a structure.
#[test]
fn sensitivities_are_differences_of_optima() {
    let at = scratch();
    written(at.path());
    let active = "/constraints/light work/upper=4";
    let idle = "/constraints/light work/upper=5";
    let same = "/name=plate";
    for (problem, change, path, value) in [
        (HAMMER, idle, "/bodies/handle/density", 700.0),
        (HAMMER, active, "/bodies/handle/density", 700.0),
        (HAMMER, active, "/bodies/handle/shape/rod/radius", 0.02),
        (
            "plate.json",
            same,
            "/load_cases/pressure/p/pressure/pressure",
            1e5,
        ),
    ] {
        let arguments = [
            problem,
            "--set",
            change,
            "--sensitivity",
            path,
            "--output",
            "own",
        ];
        let ran = expect(0, at.path(), &[&arguments[..], &TIGHT].concat());
        assert!(
            ran.out
                .contains(&format!("Sensitivity of the optimum to {path}:")),
            "{}",
            ran.out
        );
        let record = json(&read(&at.path().join("own/optimum.json")));
        let found = &record["sensitivities"][path];
        assert_eq!(found["value"].as_f64(), Some(value));
        let found = found["derivative"].as_f64().expect("a number");
        let step = 2e-3 * value;
        let moved = |by: f64| {
            optimum(
                at.path(),
                problem,
                &[change, &format!("{path}={}", value + by)],
            )
        };
        let difference = (moved(step) - moved(-step)) / (2.0 * step);
        assert!(difference != 0.0, "{path}");
        let error = (found - difference).abs() / difference.abs();
        assert!(error < 1e-3, "{path}: {found} instead of {difference}");
    }
}

#[test]
fn paths_that_cannot_be_parameters_are_refused_before_any_work() {
    let at = scratch();
    for (option, path, expected) in [
        (
            "--sensitivity",
            "/bodies/head/mass",
            "which the variable \"head mass\" designs",
        ),
        (
            "--sensitivity",
            "/bodies/handle/densty",
            "did you mean /bodies/handle/density?",
        ),
        (
            "--sensitivity",
            "/name",
            "expected the path of a physical number",
        ),
        (
            "--sweep",
            "/bodies/head/mass=1..2,3",
            "which the variable \"head mass\" designs",
        ),
        (
            "--sweep",
            "/bodies/handle/densty=1..2,3",
            "did you mean \"density\"?",
        ),
        ("--sweep", "/bodies/handle/density=-1..2,3", "density"),
        (
            "--sweep",
            "/bodies/handle/density=1..2",
            "expected PATH=a..b,n",
        ),
    ] {
        let ran = expect(2, at.path(), &[HAMMER, option, path, "--output", "out"]);
        assert!(ran.err.contains(expected), "{option} {path}: {}", ran.err);
        assert!(!at.path().join("out").exists(), "{option} {path}");
    }
}

#[test]
fn a_sweep_finds_the_optimum_for_every_value() {
    let at = scratch();
    let range = "/constraints/light work/upper=4..6,5";
    let arguments = [HAMMER, "--sweep", range, "--output", "swept"];
    let ran = expect(0, at.path(), &[&arguments[..], &TIGHT].concat());
    assert!(
        ran.out.contains("Optima for /constraints/light work/upper"),
        "{}",
        ran.out
    );
    let table = read(&at.path().join("swept/sweep.csv"));
    let rows: Vec<Vec<&str>> = table
        .lines()
        .map(|line| line.split(',').collect())
        .collect();
    assert_eq!(rows.len(), 6, "{table}");
    assert_eq!(rows[0][..2], ["/constraints/light work/upper", "status"]);
    assert!(rows[0][3].starts_with("objective: strike"), "{table}");
    for (row, value) in rows[1..].iter().zip([4.0, 4.5, 5.0, 5.5, 6.0]) {
        assert_eq!(row[0].parse(), Ok(value));
        assert_eq!(row[1], "converged");
        let alone = optimum(
            at.path(),
            HAMMER,
            &[&format!("/constraints/light work/upper={value}")],
        );
        let found: f64 = row[3].parse().expect("a number");
        assert!(
            (found - alone).abs() <= 1e-6 * alone.abs(),
            "{found} instead of {alone}"
        );
    }
    assert!(read(&at.path().join("swept/sweep.svg")).starts_with("<svg"));
    assert!(!at.path().join("swept/optimum.json").exists());
}

/// The optima so far are a table. The same command continues behind them and ends with the files of
/// a sweep that was not interrupted; a command with another value begins anew.
#[cfg(unix)]
#[test]
fn an_interrupted_sweep_leaves_a_table_and_continues() {
    let at = scratch();
    let range = "/bodies/counterweight/shape/box/size/0=3.7..4.3,4";
    let sweep = |output| [TREBUCHET, "--sweep", range, "--output", output];
    expect(0, at.path(), &sweep("whole"));
    let mut run = start(at.path(), &sweep("cut"));
    let table = at.path().join("cut/sweep.csv");
    let patience = Instant::now();
    while !table.exists() && patience.elapsed() < Duration::from_secs(60) {
        std::thread::sleep(Duration::from_millis(2));
    }
    let sent = Command::new("kill")
        .args(["-INT", &run.id().to_string()])
        .status();
    assert!(sent.expect("kill runs").success());
    assert_eq!(run.wait().expect("ends").code(), Some(130));
    let whole = read(&at.path().join("whole/sweep.csv"));
    let cut = read(&table);
    assert!(whole.starts_with(&cut), "{cut}");
    let rows = cut.lines().count();
    assert!((2..5).contains(&rows), "{cut}");
    let files = names(&at.path().join("cut"));
    assert_eq!(files, ["sweep.csv", "sweep.partial.json", "sweep.svg"]);
    let ran = expect(0, at.path(), &sweep("cut"));
    let known = format!("continues after {} of 4 optima", rows - 1);
    assert!(ran.err.contains(&known), "{}", ran.err);
    assert_eq!(read(&table), whole);
    assert_eq!(names(&at.path().join("cut")), ["sweep.csv", "sweep.svg"]);
}
