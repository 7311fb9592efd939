//! The gradients of the shipped problems, differentiated twice along one and the same motion: by the
//! adjoint and by the complex step, as `optimize check` does it.
//!
//! Nearly all agree to 1e-12 of themselves. The others are small rests of terms hundreds of times as
//! large, or of the triple pendulum, whose motion magnifies the round-off of every step; these agree
//! to what is stated. Coarse steps, at which Newton's method works hardest, are checked as well.

use flexbody::driver::check;
use flexbody::problem::Problem;
use std::path::Path;

fn largest_difference(name: &str, simulation: &str) -> f64 {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("problems/{name}.json"));
    let text = std::fs::read_to_string(path).expect("a problem");
    let mut document: serde_json::Value = serde_json::from_str(&text).expect("valid JSON");
    let duration = document["simulation"]["duration"].clone();
    document["simulation"] = serde_json::from_str(simulation).expect("valid JSON");
    document["simulation"]["duration"] = duration;
    let problem = Problem::parse(&document.to_string(), name, &[]).expect("no faults");
    let found = check(&problem, &problem.start()).expect("runs");
    assert_eq!(
        found.len(),
        problem.function_names.len() * problem.variables.len()
    );
    let mut largest = 0.0_f64;
    for derivative in &found {
        assert!(
            derivative.complex_step != 0.0 && !derivative.is_round_off(),
            "{derivative:?}"
        );
        let difference = derivative.relative_difference();
        assert!(difference.is_finite(), "{derivative:?}");
        largest = largest.max(difference);
    }
    largest
}

const BDF2: &str = r#"{"steps": 2000, "method": {"bdf": {"order": 2}}}"#;
const RADAU: &str = r#"{"tolerance": 1e-6, "samples": 200, "method": {"radau": {"stages": 3}}}"#;

#[test]
fn at_full_size() {
    for (name, simulation, tolerance) in [
        ("trebuchet", r#"{"samples": 2000}"#, 5e-12),
        ("trebuchet", BDF2, 5e-12),
        ("trebuchet", RADAU, 1e-11),
        ("trebuchet_release_time", "{}", 1e-12),
        ("trebuchet_release_time", BDF2, 1e-12),
        ("trebuchet_release_time", RADAU, 1e-12),
        ("triple_pendulum", "{}", 5e-12),
        ("triple_pendulum", BDF2, 1e-12),
        ("triple_pendulum", RADAU, 5e-12),
    ] {
        let difference = largest_difference(name, simulation);
        println!("{name} {simulation}: {difference:e}");
        assert!(
            difference <= tolerance,
            "{name} {simulation}: {difference:e}"
        );
    }
}

#[test]
fn at_coarse_steps() {
    for name in ["trebuchet", "trebuchet_release_time", "triple_pendulum"] {
        for steps in [50, 150, 300] {
            let simulation =
                format!(r#"{{"steps": {steps}, "method": {{"bdf": {{"order": 2}}}}}}"#);
            let difference = largest_difference(name, &simulation);
            assert!(
                difference <= 2e-11,
                "{name} in {steps} steps: {difference:e}"
            );
        }
    }
}
