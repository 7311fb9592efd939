//! Gradients of the shipped problems along the same motion by the adjoint and by the complex step,
//! as in `optimize check`.
//!
//! Differences are relative to the derivative itself, and to the function's gradient in scaled
//! variables, which an optimisation uses. Some derivatives are small differences of terms hundreds
//! of times as large, and the motion of the triple pendulum magnifies the round-off of every step.
//! These agree relative to themselves only to the stated tolerance, and relative to the gradient as
//! well as others. Coarse steps, the hardest for Newton's method, are checked, too.

use flexbody_driver::{CheckedDerivative, chaos, check};
use flexbody_problem::Problem;
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
        // The derivative in the arm's angle is small: 1e-14 of the gradient.
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

/// A problem of the package with another duration and tolerance, and the total energy as an
/// additional function.
fn with_energy(name: &str, duration: Option<f64>, tolerance: f64) -> Problem {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("problems/{name}.json"));
    let text = std::fs::read_to_string(path).expect("a problem");
    let mut document: serde_json::Value = serde_json::from_str(&text).expect("valid JSON");
    document["simulation"]["tolerance"] = tolerance.into();
    if let Some(duration) = duration {
        document["simulation"]["duration"] = duration.into();
    }
    document["functions"]["energy"] = json!({"final": {"energy": "total"}});
    Problem::parse(&document.to_string(), name, &[]).unwrap_or_else(|faults| panic!("{faults}"))
}

/// A double pendulum over a long duration is chaotic, even if its functions are exact, such as the
/// energy. The smaller the errors of the steps, the later its derivatives become meaningless.
#[test]
fn chaos_is_named_with_its_time() {
    let start = [
        "/bodies/upper/place/turn/angle",
        "/bodies/lower/place/turn/angle",
    ];
    for (angles, duration) in [([2.0, 2.5], 50.0), ([2.5, 1.0], 60.0), ([1.8, -1.0], 80.0)] {
        let mut before = 0.0;
        for tolerance in [1e-6, 1e-9, 1e-12] {
            let problem = with_energy("extreme/double_pendulum", Some(duration), tolerance);
            let mut document = problem.document.clone();
            for (path, angle) in start.iter().zip(angles) {
                *document.pointer_mut(path).expect("an angle") = angle.into();
            }
            let text = document.to_string();
            let problem = Problem::parse(&text, "pendulum.json", &[]).expect("no faults");
            let found = chaos(&problem, &problem.start());
            let found = found.unwrap_or_else(|| panic!("{angles:?}, {tolerance:e}: not named"));
            println!("{angles:?} {duration} s, {tolerance:.0e}: {found}");
            assert!(found.from > before && found.from < duration, "{found}");
            assert!(found.to_string().contains("chaotic"), "{found}");
            before = found.from;
        }
        // The same motion as long as it is determined.
        let short = with_energy("extreme/double_pendulum", Some(2.0), 1e-9);
        assert_eq!(chaos(&short, &short.start()), None);
    }
}

/// The problems of the package are not chaotic over their durations.
#[test]
fn the_shipped_problems_are_not_called_chaotic() {
    for name in [
        "trebuchet",
        "trebuchet_release_angle",
        "trebuchet_release_time",
        "triple_pendulum",
        "extreme/damped_oscillator",
        "extreme/door",
        "extreme/double_pendulum",
        "extreme/dumbbell",
        "extreme/pendulum",
        "extreme/spring_pendulum",
        "extreme/tumbling_top",
        "extreme/wheel",
    ] {
        for tolerance in [1e-6, 1e-9, 1e-12] {
            let problem = with_energy(name, None, tolerance);
            assert_eq!(
                chaos(&problem, &problem.start()),
                None,
                "{name}, {tolerance:e}"
            );
        }
    }
}
