//! Names of a user in messages: they cannot move the cursor or forge a line.

use crate::program::{HAMMER, changed, expect, names, optimize, read, scratch};
use serde_json::Value;

/// The first invisible character, except line ends.
fn unseen(text: &str) -> Option<char> {
    let turns = |c: char| matches!(c, '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    text.chars()
        .find(|&c| (c.is_control() && c != '\n') || turns(c))
}

/// Replaces every name of one kind.
fn renamed(document: &mut Value, kind: &str, to: &str) {
    match kind {
        "name" => document["name"] = to.into(),
        kind => {
            let object = document[kind].as_object_mut().expect("names");
            let (_, first) = object.clone().into_iter().next().expect("one");
            object.insert(to.to_owned(), first);
        }
    }
}

const KINDS: [&str; 6] = [
    "name",
    "bodies",
    "joints",
    "functions",
    "variables",
    "constraints",
];

#[test]
fn characters_that_are_not_seen_are_refused_by_place() {
    let at = scratch();
    let tricks = [
        "\u{1b}[2J\u{1b}[31mred",
        "a\r\nstrike  9.99e9",
        "tab\there",
        "c1 \u{9b}31m",
        "turned \u{202e}ssam",
        "two\u{2028}lines",
        "nothing\0",
    ];
    for kind in KINDS {
        for trick in tricks {
            let problem = changed(at.path(), "tricky.json", |document| {
                renamed(document, kind, trick)
            });
            for job in [&[][..], &["simulate"], &["check"], &["explain"]] {
                let ran = expect(2, at.path(), &[job, &[&problem]].concat());
                assert_eq!(unseen(&ran.err), None, "{kind} {trick:?}: {:?}", ran.err);
                assert!(ran.err.contains("found the character U+"), "{}", ran.err);
                assert!(ran.err.contains(&format!("/{kind}")), "{}", ran.err);
                assert!(
                    !ran.err.lines().any(|line| line.starts_with("strike")),
                    "{}",
                    ran.err
                );
            }
        }
    }
    assert_eq!(names(at.path()), ["tricky.json"]);
}

/// Arguments, paths and unknown keys are repeated in messages.
#[test]
fn what_was_typed_is_shown_with_escapes() {
    let at = scratch();
    let evil = "no\u{1b}[31m\nforged: done";
    let cases: [&[&str]; 9] = [
        &[evil],
        &["simulate", evil],
        &["compare", evil, evil],
        &["plot", evil],
        &[HAMMER, "--resume", evil],
        &[HAMMER, "--from", evil],
        &[HAMMER, "--set", evil],
        &["work-precision", HAMMER, "--function", evil],
        &[HAMMER, "--set", "/gravi\u{1b}[31mty=3"],
    ];
    for case in cases {
        let ran = expect(2, at.path(), case);
        assert_eq!(unseen(&ran.err), None, "{case:?}: {:?}", ran.err);
        assert!(
            !ran.err.lines().any(|line| line.starts_with("forged")),
            "{case:?}: {}",
            ran.err
        );
        assert!(ran.err.contains("\\u{1b}[31m"), "{case:?}: {}", ran.err);
    }
    for case in [
        &["--\u{1b}[31mred"][..],
        &["check", HAMMER, "--tolerance", "\u{1b}[31m"],
    ] {
        let ran = expect(2, at.path(), case);
        assert_eq!(unseen(&ran.err), None, "{case:?}: {:?}", ran.err);
    }
    let output = format!("out {evil}");
    let ran = expect(0, at.path(), &["simulate", HAMMER, "--output", &output]);
    assert_eq!(unseen(&ran.err), None, "{:?}", ran.err);
    assert_eq!(ran.err.lines().count(), 1, "{}", ran.err);
}

/// A name that fills the screen is rejected and shown in part.
#[test]
fn a_name_that_is_too_long_is_shown_in_part() {
    let at = scratch();
    let long = "ä".repeat(10_000);
    for kind in KINDS {
        let problem = changed(at.path(), "long.json", |document| {
            renamed(document, kind, &long)
        });
        let ran = optimize(at.path(), &["simulate", &problem]);
        assert_eq!(
            ran.code,
            2,
            "{kind}: {}",
            ran.err.chars().take(500).collect::<String>()
        );
        let whole = ran.err.chars().count();
        assert!(whole < 4000, "{kind}: {whole} characters");
        assert!(
            ran.err
                .contains("expected a text of at most 200 characters"),
            "{}",
            ran.err
        );
    }
}

/// Letters of any script are valid, and tables are aligned by characters.
#[test]
fn names_in_any_script_are_names() {
    let at = scratch();
    let renames = [
        ("strike", "удар молота"),
        ("effort", "仕事量"),
        ("light work", "کار سبک"),
        ("head mass", "Masse à tête ½"),
        ("reach", "πλάτος"),
    ];
    let mut text = read(std::path::Path::new(HAMMER));
    for (from, to) in renames {
        text = text.replace(&format!("\"{from}\""), &format!("\"{to}\""));
    }
    std::fs::write(at.path().join("any.json"), &text).expect("is written");
    let ran = expect(0, at.path(), &["any.json", "--output", "out"]);
    for (_, name) in renames.iter().filter(|(from, _)| *from != "effort") {
        assert!(ran.out.contains(name), "{name}: {}", ran.out);
    }
    let ran = expect(0, at.path(), &["check", "any.json"]);
    let rows = ran
        .out
        .lines()
        .take_while(|line| !line.contains(" derivatives, "));
    let widths: Vec<usize> = rows.map(|line| line.trim_end().chars().count()).collect();
    assert!(
        widths.len() > 4 && widths.iter().all(|w| *w == widths[0]),
        "{}",
        ran.out
    );
    let record = read(&at.path().join("out/optimum.json"));
    assert!(record.contains("仕事量") && record.contains("удар молота"));
    let ran = expect(0, at.path(), &["compare", "out", "out"]);
    assert!(ran.out.contains("same optimum"), "{}", ran.out);
}
