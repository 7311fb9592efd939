//! Faults and notes that are reported before any work.

use crate::program::{expect, names, scratch};

#[test]
fn a_suite_whose_table_cannot_be_written_is_not_run() {
    let at = scratch();
    std::fs::write(at.path().join("file"), "").expect("is written");
    let case = [
        "stability",
        "--only",
        "mass-ratio/1e-8",
        "--output",
        "file/under",
    ];
    let ran = expect(4, at.path(), &case);
    assert!(ran.err.contains("cannot write file/under"), "{}", ran.err);
    assert_eq!(ran.err.lines().count(), 1, "no case was run: {}", ran.err);
    assert_eq!(names(at.path()), ["file"]);
}

/// All methods are measured over the same duration.
#[test]
fn a_measurement_says_that_it_does_not_end_at_the_event() {
    let at = scratch();
    let throw = r#"{
      "version": 1, "name": "throw",
      "bodies": {"ball": {"shape": "point", "mass": 2, "velocity": {"linear": [3, 4, 0]}}},
      "simulation": {"duration": 3, "steps": 10, "until": {
        "measure": {"position": {"body": "ball", "direction": [0, 1, 0]}}, "reaches": -1.5}}
    }"#;
    std::fs::write(at.path().join("throw.json"), throw).expect("is written");
    let arguments = [
        "work-precision",
        "throw.json",
        "--seconds",
        "0.01",
        "--runs",
        "1",
    ];
    let ran = expect(0, at.path(), &arguments);
    let told = "over the whole duration, 3 s: the event that would end it, the position that reaches \
                -1.5, is left out";
    assert!(
        ran.err.contains(told) && ran.out.contains(told),
        "{}{}",
        ran.err,
        ran.out
    );
}
