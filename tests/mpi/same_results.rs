//! Results do not depend on the number of ranks.

use crate::program::{
    TREBUCHET, alone, crane_of_twelve, optimum, over, same_files, trebuchet_of_five, two_plates,
};
use std::path::Path;

/// Coarse steps and few iterations shorten the runs.
const SHORT: [&str; 4] = [
    "--set",
    "/simulation={\"duration\": 2, \"samples\": 100, \"tolerance\": 1e-6}",
    "--set",
    "/optimiser={\"iterations\": 12}",
];

/// Runs a problem alone and over one to four ranks: the exit code, what is printed and every file are the same.
fn over_one_to_four(at: &Path, arguments: &[&str]) {
    let one = alone(at, &[arguments, &["--output", "alone"]].concat());
    for ranks in 1..=4 {
        let output = format!("over_{ranks}");
        let ran = over(ranks, at, &[arguments, &["--output", &output]].concat());
        assert_eq!(ran.code, one.code, "{}", ran.err);
        assert_eq!(ran.out, one.out);
        same_files(&at.join("alone"), &at.join(&output));
    }
}

#[test]
fn sixteen_starts() {
    let at = tempfile::tempdir().expect("a directory");
    let arguments = [&[TREBUCHET, "--starts", "16"], &SHORT[..]].concat();
    over_one_to_four(at.path(), &arguments);
}

/// Every value starts from the optimum before and from the start of the file; the latter are run ahead.
#[test]
fn a_sweep() {
    let at = tempfile::tempdir().expect("a directory");
    let range = "/functions/clearance/clearance/barrier/distance=55..65,5";
    let arguments = [&[TREBUCHET, "--sweep", range], &SHORT[..]].concat();
    over_one_to_four(at.path(), &arguments);
}

#[test]
fn a_sweep_from_three_starts() {
    let at = tempfile::tempdir().expect("a directory");
    let range = "/functions/clearance/clearance/barrier/distance=55..65,3";
    let arguments = [&[TREBUCHET, "--sweep", range, "--starts", "3"], &SHORT[..]].concat();
    over_one_to_four(at.path(), &arguments);
}

#[test]
fn twelve_cases() {
    let at = tempfile::tempdir().expect("a directory");
    let problem = crane_of_twelve(at.path());
    over_one_to_four(at.path(), &[&problem]);
    let record = optimum(&at.path().join("over_3"));
    assert_eq!(record["status"], "converged");
    assert_eq!(record["gradient_certificate"]["passed"], true);
}

/// Steps, their changes and events go from rank to rank.
#[test]
fn cases_in_motion() {
    let at = tempfile::tempdir().expect("a directory");
    let problem = trebuchet_of_five(at.path());
    over_one_to_four(at.path(), &[&problem, "--second-order"]);
}

/// All ranks compute every motion together: their elements and the factors of their matrices are divided.
#[test]
fn bodies_of_one_motion() {
    let at = tempfile::tempdir().expect("a directory");
    let problem = two_plates(at.path(), [16, 1], 1);
    over_one_to_four(at.path(), &[&problem, "--share-bodies"]);
    let record = optimum(&at.path().join("over_2"));
    assert_eq!(record["gradient_certificate"]["passed"], true);
}

/// Nothing of it can be spread.
#[test]
fn one_start_without_cases() {
    let at = tempfile::tempdir().expect("a directory");
    let arguments = [&[TREBUCHET], &SHORT[..]].concat();
    over_one_to_four(at.path(), &arguments);
    let ran = over(
        2,
        at.path(),
        &[&arguments[..], &["--output", "told"]].concat(),
    );
    assert!(ran.err.contains("nothing to spread"), "{}", ran.err);
}

/// Other commands run on rank 0 alone.
#[test]
fn other_commands() {
    let at = tempfile::tempdir().expect("a directory");
    for command in ["simulate", "check"] {
        let arguments = &[command, TREBUCHET];
        let (one, three) = (alone(at.path(), arguments), over(3, at.path(), arguments));
        assert_eq!((three.code, three.out), (one.code, one.out));
    }
}

/// A limit on the evaluations ends a run; the next goes on over another number of ranks.
#[test]
fn a_run_resumes_over_another_number_of_ranks() {
    let at = tempfile::tempdir().expect("a directory");
    let problem = crane_of_twelve(at.path());
    alone(at.path(), &[&problem, "--output", "whole"]);
    let limit = [
        "--set",
        "/optimiser={\"evaluations\": 5}",
        "--output",
        "cut",
    ];
    let cut = over(3, at.path(), &[&[&problem[..]], &limit[..]].concat());
    assert_eq!(cut.code, 1, "{}", cut.err);
    let ran = over(2, at.path(), &[&problem, "--resume", "cut"]);
    assert_eq!(ran.code, 0, "{}", ran.err);
    assert!(ran.err.contains("are not repeated"), "{}", ran.err);
    let (whole, cut) = (at.path().join("whole"), at.path().join("cut"));
    assert_eq!(optimum(&whole), optimum(&cut));
}

/// A case that fails is named, wherever it runs.
#[test]
fn a_failing_case_is_named() {
    let at = tempfile::tempdir().expect("a directory");
    let problem = crane_of_twelve(at.path());
    let broken = "/cases/position 7/set=\
                  {\"/bodies/jib/place/turn/degrees\": 50, \"/loads/payload/force/magnitude\": 1e300}";
    let arguments = [&problem, "--set", broken, "--output", "out"];
    let one = alone(at.path(), &arguments);
    assert!(one.err.contains("position 7"), "{}", one.err);
    for ranks in [2, 3] {
        let ran = over(ranks, at.path(), &arguments);
        assert_eq!(ran.code, one.code, "{}", ran.err);
        assert!(ran.err.contains(one.err.trim_end()), "{}", ran.err);
    }
}
