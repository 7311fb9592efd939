//! One table: position error, time of a simulation, time of its gradients.
//!
//! `cargo bench --bench work_precision`. Times are the processor time of the thread where the
//! system tells it (Linux) and wall time elsewhere: the least of several runs after a first one.
//! The gradients are in every parameter of the scene: masses, inertias, joint frames, the start,
//! gravity and the duration.

mod scenes;
mod watch;

use flexbody::adjoint;
use scenes::{Case, NAMES};
use watch::fastest;

/// Runs of which the fastest counts.
const RUNS: usize = 10;

fn main() {
    println!(
        "{:15} {:7} {:>8} {:>6} {:>9}  {:>9} {:>6} {:>6}  {:>9} {:>6}  {:>9} {:>6}",
        "scene",
        "method",
        "unknowns",
        "steps",
        "error [m]",
        "forward",
        "Newton",
        "LU",
        "gradient",
        "ratio",
        "three",
        "ratio"
    );
    for name in NAMES {
        for h in [2e-3, 1e-3, 5e-4] {
            row(&Case::new(name, h));
        }
        for tolerance in [1e-5, 1e-7, 1e-9, 1e-11] {
            row(&Case::explicit(name, tolerance));
        }
    }
    println!();
    println!("times in s; Newton iterations and factorisations (LU) a step of the simulation;");
    println!("gradient of one function, of three; ratio to the simulation");
}

fn row(case: &Case) {
    let run = case.simulate();
    let (forward, _) = fastest(RUNS, || case.simulate());
    let gradient = |which: &[usize]| {
        let gradients = || adjoint::gradients(&case.scene, &run, which).expect("regular");
        fastest(RUNS, gradients).0
    };
    let (one, three) = (gradient(&[0]), gradient(&[0, 1, 2]));
    let per_step = |count: usize| count as f64 / run.grid.steps() as f64;
    println!(
        "{:15} {:7} {:>8} {:>6} {:>9.1e}  {:>9.5} {:>6.2} {:>6.2}  {:>9.5} {:>6.2}  {:>9.5} {:>6.2}",
        case.name,
        run.method.name().replace(" with rising order", ""),
        2 * (run.numbering.velocities() + run.numbering.constraints()),
        run.grid.steps(),
        case.error,
        forward,
        per_step(run.counts.newton_iterations),
        per_step(run.counts.factorisations),
        one,
        one / forward,
        three,
        three / forward
    );
}
