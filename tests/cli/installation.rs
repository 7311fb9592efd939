//! Completions, the manual page, and a record in the place of a problem.

use crate::program::{HAMMER, expect, json, optimum, scratch};

#[test]
fn shells_and_man_learn_all_commands() {
    let at = scratch();
    let commands = [
        "new", "simulate", "check", "explain", "compare", "plot", "report", "schema",
    ];
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let text = expect(0, at.path(), &["completions", shell]).out;
        for word in commands.iter().chain(&["starts"]) {
            assert!(text.contains(word), "{shell}: {word}");
        }
    }
    let page = expect(0, at.path(), &["manual"]).out;
    assert!(page.contains(".TH optimize 1"), "{page}");
    for command in commands {
        let title = format!(".SH \"OPTIMIZE {}\"", command.to_uppercase());
        assert!(page.contains(&title), "{title}");
    }
    assert!(!page.contains("OPTIMIZE STRESS"), "a hidden command");
    expect(2, at.path(), &["completions", "tcsh"]);
}

#[test]
fn a_record_is_not_taken_for_a_faulty_problem() {
    let at = scratch();
    expect(0, at.path(), &[HAMMER, "--output", "out"]);
    for arguments in [&["out/optimum.json"][..], &["simulate", "out/optimum.json"]] {
        let ran = expect(2, at.path(), arguments);
        assert!(
            ran.err.contains("found the record of an optimum"),
            "{}",
            ran.err
        );
        assert!(ran.err.contains("optimize report out"), "{}", ran.err);
        assert_eq!(ran.err.lines().count(), 1, "{}", ran.err);
    }
}

/// `simulate` and `check` at the design of an optimum give its values.
#[test]
fn a_design_of_a_record_is_simulated() {
    let at = scratch();
    expect(0, at.path(), &[HAMMER, "--output", "out"]);
    let record = optimum(&at.path().join("out"));
    let name = record["objective"]["function"].as_str().expect("a name");
    let ran = expect(
        0,
        at.path(),
        &["simulate", HAMMER, "--from", "out", "--json"],
    );
    let value = json(&ran.out)["functions"][name]["value"]
        .as_f64()
        .expect("a number");
    let own = record["objective"]["value"].as_f64().expect("a number");
    assert!((value - own).abs() <= 1e-6 * own.abs(), "{value} {own}");
    let ran = expect(0, at.path(), &["simulate", HAMMER, "--json"]);
    let first = json(&ran.out)["functions"][name]["value"]
        .as_f64()
        .expect("a number");
    assert!((first - own).abs() > 1e-3 * own.abs(), "{first} {own}");
    expect(
        0,
        at.path(),
        &["check", HAMMER, "--from", "out/optimum.json"],
    );
    expect(2, at.path(), &["check", HAMMER, "--from", "nowhere"]);
}
