//! The example of README.md runs and has the answer that is given there.

use flexbody::driver::optimise;
use flexbody::problem::Problem;
use std::ops::ControlFlow;

#[test]
fn the_example_of_the_readme_finds_the_radius_of_gyration() {
    let readme = include_str!("../README.md");
    let (_, example) = readme.split_once("```json\n").expect("an example");
    let (example, _) = example.split_once("```").expect("its end");
    let problem = Problem::parse(example, "README.md", &[]).expect("no faults");
    let done = optimise(&problem, "README.md", &mut |_| ControlFlow::Continue(()))
        .expect("has an objective");
    assert!(done.outcome.converged());
    let pin = done.optimum.design["pin"].value;
    // The angular acceleration m g d cos θ / (I + m d²) is largest at d² = I/m whatever the angle.
    assert!((pin + (1.0_f64 / 12.0).sqrt()).abs() < 2e-5, "{pin}");
}
