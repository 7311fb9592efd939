//! The gradients of the shipped problems, differentiated twice along one and the same motion: by the
//! adjoint and by the complex step, as `optimize check` does it.
//!
//! At full size all agree to 1e-12 of themselves but few of the trebuchet with the aggregated range,
//! whose derivatives in small masses and the angle are small rests of terms hundreds of times as
//! large; these agree to 5e-12. Coarse steps, at which Newton's method works hardest, are checked
//! as well.

use flexbody::driver::check;
use flexbody::problem::{Override, Problem};
use std::path::Path;

fn largest_difference(name: &str, steps: usize) -> f64 {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("problems/{name}.json"));
    let steps = Override::parse(&format!("/simulation/steps={steps}")).expect("an override");
    let problem = Problem::load(&path, &[steps]).expect("no faults");
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

#[test]
fn at_full_size() {
    for (name, steps, tolerance) in [
        ("trebuchet", 2000, 5e-12),
        ("trebuchet_release_time", 2000, 1e-12),
        ("triple_pendulum", 3000, 1e-12),
    ] {
        let difference = largest_difference(name, steps);
        assert!(difference <= tolerance, "{name}: {difference:e}");
    }
}

#[test]
fn at_coarse_steps() {
    for name in ["trebuchet", "trebuchet_release_time", "triple_pendulum"] {
        for steps in [50, 150, 300] {
            let difference = largest_difference(name, steps);
            assert!(
                difference <= 2e-11,
                "{name} in {steps} steps: {difference:e}"
            );
        }
    }
}
