//! `optimize stability`, as a user runs it.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn command(directory: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_optimize"))
        .arg("stability")
        .args(arguments)
        .current_dir(directory)
        .output()
        .expect("the program starts")
}

#[test]
fn one_case_is_run_alone_and_written_where_it_is_asked_for() {
    let scratch = tempfile::tempdir().expect("a scratch directory");
    let case = "stiffness/10/dop853 in 1000";
    let done = command(scratch.path(), &["--only", case]);
    let text = String::from_utf8_lossy(&done.stdout);
    assert_eq!(done.status.code(), Some(0), "{text}");
    assert_eq!(text, "1 cases: 1 refused\n");
    let told = String::from_utf8_lossy(&done.stderr);
    assert!(told.contains("the explicit steps are too large"), "{told}");
    // A part of the table does not replace the whole table.
    let files = |at: &Path| std::fs::read_dir(at).expect("a directory").count();
    assert_eq!(files(scratch.path()), 0);

    let out: PathBuf = scratch.path().join("out");
    let arguments = ["--only", case, "--quiet", "--output", "out"];
    let done = command(scratch.path(), &arguments);
    assert_eq!(done.status.code(), Some(0));
    assert!(done.stdout.is_empty() && done.stderr.is_empty());
    assert_eq!(files(&out), 2);
    let table = std::fs::read_to_string(out.join("stability.md")).expect("a table");
    assert!(
        table.contains("| stiffness | 1 | 0 | 0 | 1 | 0 | 0 | 0 |"),
        "{table}"
    );
}

#[test]
fn a_case_that_does_not_end_is_said_to_have_been_stopped() {
    let scratch = tempfile::tempdir().expect("a scratch directory");
    let arguments = [
        "--only",
        "many-steps/1e6/bdf2 in 1000000",
        "--seconds",
        "0.01",
    ];
    let done = command(scratch.path(), &arguments);
    assert_eq!(done.status.code(), Some(1));
    assert_eq!(done.stdout, b"1 cases: 1 time limit\n");
}

#[test]
fn a_name_of_no_case_is_bad_input() {
    let done = command(Path::new("."), &["--only", "mass"]);
    assert_eq!(done.status.code(), Some(2));
    let told = String::from_utf8_lossy(&done.stderr);
    assert!(
        told.contains("found --only \"mass\"") && told.contains("mass-ratio, "),
        "{told}"
    );
}

/// The former name of the command was `stress`.
#[test]
fn the_former_name_of_the_command_names_the_new_one() {
    for more in [&[][..], &["--only", "damping"], &["--help"]] {
        let done = Command::new(env!("CARGO_BIN_EXE_optimize"))
            .arg("stress")
            .args(more)
            .output()
            .expect("the program starts");
        assert_eq!(done.status.code(), Some(2), "{more:?}");
        let told = String::from_utf8_lossy(&done.stderr);
        assert!(told.contains("expected `optimize stability`"), "{told}");
    }
}
