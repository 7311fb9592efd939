//! `optimize new`: every starter is a problem that is solved at once, and nothing is overwritten.

use crate::program::{expect, json, optimum, read, scratch};

const STARTERS: [&str; 6] = ["pendulum", "linkage", "trebuchet", "arm", "plate", "frame"];

#[test]
fn every_starter_is_solved_as_it_is() {
    let at = scratch();
    for kind in STARTERS {
        let name = format!("my {kind}");
        let ran = expect(0, at.path(), &["new", &name, "--from", kind]);
        assert!(ran.err.contains("optimize simulate"), "{}", ran.err);
        let file = format!("{name}.json");
        let text = read(&at.path().join(&file));
        let remarks = text.matches("\"description\"").count();
        assert!(remarks > 2, "{kind}: {remarks}");
        let document = json(&text);
        assert_eq!(document["name"], name.as_str());
        assert!(document["description"].is_string(), "{kind}");
        expect(0, at.path(), &["simulate", &file]);
        expect(0, at.path(), &[&file, "--output", kind]);
        let found = optimum(&at.path().join(kind));
        assert_eq!(found["status"], "converged", "{kind}");
        assert_eq!(found["gradient_certificate"]["passed"], true, "{kind}");
    }
}

/// The hinge of the pendulum is its radius of gyration 1/√12 m from the centre.
#[test]
fn the_pendulum_has_a_known_answer() {
    let at = scratch();
    expect(0, at.path(), &["new", "swing.json"]);
    expect(0, at.path(), &["swing.json", "--output", "out"]);
    let pin = optimum(&at.path().join("out"))["design"]["pin"]["value"].as_f64();
    let known = -1.0 / 12f64.sqrt();
    assert!((pin.expect("a number") - known).abs() < 1e-6, "{pin:?}");
}

#[test]
fn nothing_is_overwritten_and_faults_name_what_is_wrong() {
    let at = scratch();
    expect(0, at.path(), &["new", "own"]);
    let before = read(&at.path().join("own.json"));
    let ran = expect(2, at.path(), &["new", "own", "--from", "frame"]);
    assert!(ran.err.contains("own.json is there already"), "{}", ran.err);
    assert_eq!(read(&at.path().join("own.json")), before);
    let ran = expect(2, at.path(), &["new", "other", "--from", "fram"]);
    assert!(ran.err.contains("frame"), "{}", ran.err);
    let ran = expect(4, at.path(), &["new", "no/such/folder/own"]);
    assert!(
        ran.err.contains("no/such/folder is no folder"),
        "{}",
        ran.err
    );
    for wrong in [".", "crank.txt"] {
        let ran = expect(2, at.path(), &["new", wrong]);
        assert!(
            ran.err.contains("such as crank or crank.json"),
            "{}",
            ran.err
        );
    }
    let ran = expect(0, at.path(), &["new", "two words"]);
    assert!(
        ran.err.contains("optimize 'two words.json' --report"),
        "{}",
        ran.err
    );
}
