//! The gradients of the shipped problems, differentiated twice along one and the same motion: by the
//! adjoint and by the complex step, as `optimize check` does it.
//!
//! Two measures: of itself, and of the function's gradient in scaled variables, which is what an
//! optimisation sees. Single derivatives are small rests of terms hundreds of times as large, or of the
//! triple pendulum, whose motion magnifies the round-off of every step; these agree less well with
//! themselves, to what is stated, and as well as the others with the gradient. Coarse steps, at which
//! Newton's method works hardest, are checked as well.

use flexbody::driver::{CheckedDerivative, check};
use flexbody::problem::Problem;
use std::path::Path;

/// Largest difference of a derivative, relative to itself and to its function's gradient.
fn largest_difference(name: &str, simulation: &str) -> [f64; 2] {
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
    let scaled = |d: &CheckedDerivative, x: f64| x * problem.variables[d.variable].scale;
    let mut largest = [0.0_f64; 2];
    for derivative in &found {
        assert!(
            derivative.complex_step != 0.0 && !derivative.is_round_off(),
            "{derivative:?}"
        );
        let difference = derivative.relative_difference();
        assert!(difference.is_finite(), "{derivative:?}");
        let of_function = found.iter().filter(|d| d.function == derivative.function);
        let gradient = of_function.fold(0.0_f64, |m, d| m.hypot(scaled(d, d.complex_step)));
        let off = scaled(derivative, derivative.adjoint - derivative.complex_step).abs();
        largest[0] = largest[0].max(difference);
        largest[1] = largest[1].max(off / gradient);
    }
    largest
}

const BDF2: &str = r#"{"steps": 2000, "method": {"bdf": {"order": 2}}}"#;
const RADAU: &str = r#"{"tolerance": 1e-6, "samples": 200, "method": {"radau": {"stages": 3}}}"#;

#[test]
fn at_full_size() {
    for (name, simulation, of_itself) in [
        ("trebuchet", r#"{"samples": 2000}"#, 1e-11),
        ("trebuchet", BDF2, 1e-11),
        // The derivative in the arm's angle is the small one: 1e-14 of the gradient.
        ("trebuchet", RADAU, 2e-11),
        ("trebuchet_release_time", "{}", 1e-12),
        ("trebuchet_release_time", BDF2, 1e-12),
        ("trebuchet_release_time", RADAU, 1e-12),
        ("triple_pendulum", "{}", 3e-11),
        ("triple_pendulum", BDF2, 3e-11),
        ("triple_pendulum", RADAU, 3e-11),
    ] {
        let [itself, gradient] = largest_difference(name, simulation);
        println!("{name} {simulation}: {itself:.1e}, of the gradient {gradient:.1e}");
        assert!(itself <= of_itself, "{name} {simulation}: {itself:e}");
        assert!(
            gradient <= 1e-12,
            "{name} {simulation}: {gradient:e} of the gradient"
        );
    }
}

#[test]
fn at_coarse_steps() {
    for name in ["trebuchet", "trebuchet_release_time", "triple_pendulum"] {
        for steps in [50, 150, 300] {
            let simulation =
                format!(r#"{{"steps": {steps}, "method": {{"bdf": {{"order": 2}}}}}}"#);
            let [itself, gradient] = largest_difference(name, &simulation);
            println!("{name} in {steps} steps: {itself:.1e}, of the gradient {gradient:.1e}");
            assert!(itself <= 3e-11, "{name} in {steps} steps: {itself:e}");
            assert!(
                gradient <= 1e-12,
                "{name} in {steps} steps: {gradient:e} of the gradient"
            );
        }
    }
}
