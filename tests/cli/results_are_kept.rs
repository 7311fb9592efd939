//! Results are not lost, and earlier files are not changed, if the disk fails or a signal arrives.

use crate::program::{HAMMER, expect, files, held, json, names, optimum, read, scratch, start};
use std::process::Command;
use std::time::{Duration, Instant};

/// The record is written first. A figure that cannot be written causes a warning.
#[test]
fn a_figure_that_cannot_be_written_costs_no_result() {
    let at = scratch();
    for figure in ["convergence.svg", "energy.svg", "motion.svg"] {
        let out = at.path().join(format!("without {figure}"));
        std::fs::create_dir_all(out.join(figure).join("full")).expect("is made");
        let to = out.to_string_lossy().into_owned();
        let ran = expect(0, at.path(), &[HAMMER, "--output", &to]);
        let told = format!("warning: a figure is missing: cannot write {to}/{figure}: ");
        assert!(ran.err.contains(&told), "{}", ran.err);
        assert!(ran.out.contains("Maximised strike"), "{}", ran.out);
        assert_eq!(optimum(&out)["status"], "converged");
        let found = names(&out);
        for name in ["evaluations.jsonl", "history.csv", "state.json"] {
            assert!(found.contains(&name.to_owned()), "{found:?}");
        }
        assert_eq!(found.len(), 7, "the other figures: {found:?}");
    }
    let out = at.path().join("simulated");
    std::fs::create_dir_all(out.join("energy.svg")).expect("is made");
    let ran = expect(0, at.path(), &["simulate", HAMMER, "--output", "simulated"]);
    assert!(ran.err.contains("a figure is missing"), "{}", ran.err);
    assert!(names(&out).contains(&"simulation.csv".to_owned()));
}

/// A record that cannot be written is reported even if the run is quiet.
#[test]
fn a_record_that_cannot_be_written_is_told() {
    let at = scratch();
    let out = at.path().join("out");
    std::fs::create_dir_all(out.join("optimum.json")).expect("is made");
    let ran = expect(4, at.path(), &[HAMMER, "--output", "out", "--quiet"]);
    assert!(ran.out.contains("Maximised strike"), "{}", ran.out);
    assert!(
        ran.err.contains("cannot write out/optimum.json"),
        "{}",
        ran.err
    );
    // The history is missing with the record. The log of the evaluations restores both.
    assert!(!names(&out).contains(&"history.csv".to_owned()));
    std::fs::remove_dir(out.join("optimum.json")).expect("is removed");
    let ran = expect(0, at.path(), &[HAMMER, "--resume", "out"]);
    assert!(ran.err.contains("are not repeated"), "{}", ran.err);
    assert_eq!(optimum(&out)["status"], "converged");
    // The record can be written, and another file cannot.
    let out = at.path().join("other");
    std::fs::create_dir_all(out.join("history.csv")).expect("is made");
    let ran = expect(4, at.path(), &[HAMMER, "--output", "other"]);
    assert!(ran.out.contains("Maximised strike"), "{}", ran.out);
    assert_eq!(optimum(&out)["status"], "converged");
}

#[cfg(target_os = "linux")]
#[test]
fn a_file_that_the_system_refuses_has_its_own_code() {
    let at = scratch();
    let ran = expect(4, at.path(), &["/proc/self/mem"]);
    assert!(ran.err.contains("/proc/self/mem"), "{}", ran.err);
    expect(
        4,
        at.path(),
        &["compare", "/proc/self/mem", "/proc/self/mem"],
    );
    // A missing file is bad input.
    for missing in [&["no.json"][..], &["plot", "no"], &["compare", "no", "no"]] {
        expect(2, at.path(), missing);
    }
    for job in [&["schema"][..], &["explain", HAMMER], &["simulate", HAMMER]] {
        let full = std::fs::File::create("/dev/full").expect("is opened");
        let mut program = Command::new(env!("CARGO_BIN_EXE_optimize"));
        let ended = program.args(job).stdout(full).output().expect("runs");
        assert_eq!(ended.status.code(), Some(4), "{job:?}");
        let told = String::from_utf8_lossy(&ended.stderr).into_owned();
        assert!(told.contains("cannot write the result"), "{told}");
    }
}

/// The exit code after a signal does not depend on the present work.
#[cfg(unix)]
#[test]
fn a_signal_ends_every_command_with_130() {
    let at = scratch();
    let long = "/simulation={\"duration\": 1e5, \"tolerance\": 1e-10, \"samples\": 10}";
    let jobs = [
        &["simulate", HAMMER, "--set", long][..],
        &["work-precision", HAMMER, "--seconds", "100"],
        &["stability"],
        &[HAMMER, "--set", long],
        &["simulate", HAMMER, "--set", long, "--accuracy", "1e-10"],
    ];
    for (k, job) in jobs.iter().enumerate() {
        let signal = ["-INT", "-TERM"][k % 2];
        let out = format!("out {k}");
        let mut run = start(
            at.path(),
            &[job, &["--output", &out, "--quiet"][..]].concat(),
        );
        let patience = Instant::now();
        while !at.path().join(&out).exists() && patience.elapsed() < Duration::from_secs(60) {
            std::thread::sleep(Duration::from_millis(5));
        }
        for _ in 0..2 {
            // An optimisation ends after its simulation at the first signal, at once at the second.
            std::thread::sleep(Duration::from_millis(100));
            let _ = Command::new("kill")
                .args([signal, &run.id().to_string()])
                .output();
        }
        assert_eq!(run.wait().expect("ends").code(), Some(130), "{job:?}");
    }
}

/// The directory is locked before any computation.
#[test]
fn the_lock_comes_before_the_accuracy() {
    let at = scratch();
    let held = held(&at.path().join("out"));
    for job in [&[][..], &["work-precision"], &["simulate"]] {
        let arguments = [job, &[HAMMER, "--accuracy", "1e-7", "--output", "out"]].concat();
        let ran = expect(2, at.path(), &arguments);
        assert!(ran.err.starts_with("out: found a run"), "{}", ran.err);
        assert_eq!(ran.err.lines().count(), 1, "{}", ran.err);
    }
    drop(held);
}

/// A log with a line removed leads to another run: it is rejected, and nothing changes.
#[test]
fn a_record_with_a_line_removed_is_not_resumed() {
    let at = scratch();
    expect(0, at.path(), &[HAMMER, "--output", "out", "--quiet"]);
    let path = at.path().join("out/evaluations.jsonl");
    let whole = read(&path);
    let lines: Vec<&str> = whole.split_inclusive('\n').collect();
    assert_eq!(json(lines[0])["chained"], true);
    for k in [1, 2, lines.len() / 2, lines.len() - 2] {
        let mut rest = lines.clone();
        rest.remove(k);
        std::fs::write(&path, rest.concat()).expect("is written");
        let before = files(at.path());
        let ran = expect(2, at.path(), &[HAMMER, "--resume", "out"]);
        let told = format!("evaluations.jsonl:{}: found a line whose \"chain\"", k + 1);
        assert!(ran.err.contains(&told), "{}", ran.err);
        assert!(files(at.path()) == before);
    }
}

/// A link in place of a result file is replaced, not followed.
#[cfg(unix)]
#[test]
fn links_among_the_results_are_not_followed() {
    let at = scratch();
    let mine = at.path().join("mine");
    std::fs::write(&mine, "precious").expect("is written");
    let out = at.path().join("out");
    expect(0, at.path(), &[HAMMER, "--output", "out", "--quiet"]);
    let results = names(&out);
    for name in results
        .iter()
        .map(String::as_str)
        .chain(["history.partial.csv"])
    {
        let _ = std::fs::remove_file(out.join(name));
        std::os::unix::fs::symlink(&mine, out.join(name)).expect("is linked");
    }
    expect(0, at.path(), &[HAMMER, "--output", "out", "--quiet"]);
    assert_eq!(read(&mine), "precious");
    assert_eq!(names(&out), results);
    for name in &results {
        assert!(!out.join(name).is_symlink(), "{name}");
    }
}

/// The record of an optimum by the labelled inertia says so among its warnings; by the full inertia it has none of that.
#[test]
fn an_optimum_by_the_labelled_inertia_says_so() {
    let at = scratch();
    for (inertia, labelled) in [("paper", true), ("full", false)] {
        let problem = serde_json::json!({
            "version": 1, "name": "plate", "gravity": [0, 0, -9.81],
            "materials": {"soft": {"young": 1e8, "poisson": 0.3, "density": 1000}},
            "bodies": {"plate": {"elements": {
                "structure": {"mesh": {"plate": {"length": 1, "width": 0.5, "elements": [1, 1]}}, "material": "soft",
                              "thickness": 0.03},
                "frame": {"clamped": "x0"}, "points": {"root": {"edge": "x0"}}, "inertia": inertia
            }}},
            "joints": {"root": {"weld": {"between": ["plate", "ground"], "at": "plate.root"}}},
            "simulation": {"duration": 0.02, "steps": 4, "method": {"bdf": {"order": 2}}},
            "functions": {"energy": {"final": {"strain_energy": {"body": "plate"}}}},
            "variables": {"thickness": {"path": "/bodies/plate/elements/structure/thickness", "lower": 0.01, "upper": 0.05}},
            "objective": {"minimise": "energy"}
        });
        std::fs::write(at.path().join("plate.json"), problem.to_string()).expect("is written");
        expect(
            0,
            at.path(),
            &["plate.json", "--output", inertia, "--quiet"],
        );
        let record = optimum(&at.path().join(inertia));
        // A record without warnings has no list of them.
        let warnings = record["warnings"].as_array().cloned().unwrap_or_default();
        let told = warnings.iter().any(|warning| {
            let text = warning.as_str().unwrap_or_default();
            text.contains("\"plate\" is that of equations 13 and 14 of Kennedy & Boopathy (2016)")
        });
        assert_eq!(told, labelled, "{warnings:?}");
    }
}
