//! What a gradient costs in how much memory: `cargo bench --bench memory` prints a table.
//!
//! A double pendulum of rods swings for 2 s in equal steps. Steps made again are counted; times are the
//! processor time of the thread where the system tells it (Linux) and wall time elsewhere.

mod watch;

use flexbody::adjoint::gradients;
use flexbody::integrate::{
    IntegrationFailure, Method, Samples, Settings, Start, Tape, Trajectory, simulate,
};
use flexbody::problem::Problem;
use std::path::Path;
use watch::fastest;

/// Steps of every run, and memory in parts of what all of them take.
const STEPS: usize = 20_000;
const PARTS: [usize; 7] = [1, 2, 4, 10, 30, 100, 1000];

fn main() -> Result<(), IntegrationFailure> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("problems/extreme/double_pendulum.json");
    let problem = Problem::load(&path, &[]).unwrap_or_else(|faults| panic!("{faults}"));
    let scene = problem.scene(&problem.start());
    let bdf = Method::Bdf {
        order: 2,
        start: Start::RisingOrder,
    };
    println!(
        "| method | memory (MB) | steps kept | checkpoints | steps made again / steps | gradient / run |"
    );
    println!("|---|---|---|---|---|---|");
    for method in [Method::Dop853, Method::Radau { stages: 3 }, bdf] {
        let mut settings = Settings::steps(method, STEPS);
        settings.samples = Samples::Uniform(1);
        settings.memory = usize::MAX;
        let whole = simulate(&scene.model, scene.duration, &settings)?.bytes()[1];
        for part in PARTS {
            settings.memory = whole / part + whole / (100 * part);
            let run = || simulate(&scene.model, scene.duration, &settings);
            let (forwards, found) = fastest(2, run);
            let found = found?;
            let (backwards, adjoint) = fastest(2, || gradients(&scene, &found, &[0]));
            let counts = adjoint?.counts;
            let (kept, checkpoints) = kept(&found);
            println!(
                "| {} | {:.2} | {kept} | {checkpoints} | {:.2} | {:.2} |",
                method.name(),
                settings.memory as f64 / 1e6,
                counts.recomputed as f64 / STEPS as f64,
                backwards / forwards
            );
        }
    }
    Ok(())
}

/// Steps that a run keeps, and most checkpoints.
fn kept(run: &Trajectory<f64>) -> (usize, usize) {
    let steps = run.grid.steps();
    let schedule = match &run.tape {
        Tape::Explicit(tape) => tape.schedule(steps),
        Tape::Implicit(tape) => tape.schedule(steps),
    };
    let checkpoints = match schedule.keeps_all() {
        true => 0,
        false => schedule.checkpoints(),
    };
    (steps - schedule.head(), checkpoints)
}
