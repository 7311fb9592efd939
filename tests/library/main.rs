//! The library as its users see it: its examples run, and its results are consistent.

#[path = "../../examples/gradients.rs"]
mod gradients;
#[path = "../../examples/optimiser.rs"]
mod optimiser;
#[path = "../../examples/own_objective.rs"]
mod own_objective;
#[path = "../../examples/rosenbrock.rs"]
mod rosenbrock;
#[path = "../../examples/simulate.rs"]
mod simulate;

use flexbody::{Analysis, Problem, optimise};
use std::ops::ControlFlow;
use std::path::Path;

#[test]
fn the_examples_run() {
    simulate::main().expect("runs");
    gradients::main().expect("runs");
    optimiser::main();
    rosenbrock::main();
    own_objective::main().expect("runs");
}

fn trebuchet() -> Problem {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("problems/trebuchet_release_time.json");
    Problem::load(&path, &[]).unwrap_or_else(|faults| panic!("{faults}"))
}

/// The gradient of [`Analysis`] is that of its values with frozen steps.
#[test]
fn values_are_smooth_and_gradients_are_theirs() {
    let problem = trebuchet();
    let mut analysis = Analysis::new(&problem);
    let x = problem.start();
    let gradient = analysis
        .at(&x)
        .expect("runs")
        .gradients(&[0])
        .expect("regular");
    for (i, variable) in problem.variables().iter().enumerate() {
        let h = 1e-4 * variable.scale;
        let mut value = |by: f64| {
            let mut moved = x.clone();
            moved[i] += by;
            analysis.at(&moved).expect("runs").values()[0]
        };
        let difference =
            (8.0 * (value(h) - value(-h)) - (value(2.0 * h) - value(-2.0 * h))) / (12.0 * h);
        let error = (difference - gradient[0][i]).abs();
        assert!(
            error <= 1e-6 * gradient[0][i].abs().max(1.0 / variable.scale),
            "{}: {error}",
            variable.name
        );
    }
}

#[test]
fn an_optimisation_is_seen_and_can_be_stopped() {
    let problem = trebuchet();
    let mut objectives = Vec::new();
    let whole = optimise(&problem, &mut |iteration| {
        objectives.push(iteration.objective);
        ControlFlow::Continue(())
    });
    let whole = whole.expect("an objective");
    assert!(whole.converged(), "{:?}", whole.status());
    assert!(
        (whole.objective() - 856.58952).abs() < 1e-4,
        "{}",
        whole.objective()
    );
    let at_end = Analysis::new(&problem)
        .at(&whole.design())
        .expect("runs")
        .values()[0];
    assert!((at_end - whole.objective()).abs() < 1e-4);
    assert!(objectives.len() > 5);
    let stopped = optimise(&problem, &mut |iteration| match iteration.number {
        0..3 => ControlFlow::Continue(()),
        _ => ControlFlow::Break(()),
    });
    assert_eq!(stopped.expect("an objective").status().0, "interrupted");
    let record = whole.to_json().expect("finite");
    assert!(record.contains("\"status\": \"converged\""));
}
