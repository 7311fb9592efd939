//! Time of a gradient against its memory: `cargo bench --bench memory` prints a table.
//!
//! A double pendulum of rods swings for 2 s in equal steps. Repeated steps are counted. Times are
//! processor times of the thread on Linux, and wall times elsewhere.

mod watch;

use flexbody::{Analysis, Override, Problem, SimulationError};
use std::path::Path;
use watch::fastest;

/// Steps of every run.
const STEPS: usize = 20_000;
/// Memory for the data of a run \[MB\].
const MEGABYTES: [f64; 7] = [1000.0, 60.0, 20.0, 6.0, 2.0, 0.6, 0.1];

fn main() -> Result<(), SimulationError> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("problems/extreme/double_pendulum.json");
    println!("| method | memory (MB) | steps made again / steps | gradient / run |");
    println!("|---|---|---|---|");
    for (method, more) in [
        (r#""dop853""#, r#", "samples": 1"#),
        (r#"{"radau": {"stages": 3}}"#, r#", "samples": 1"#),
        (r#"{"bdf": {"order": 2, "start": "rising_order"}}"#, ""),
    ] {
        let simulation =
            format!(r#"/simulation={{"duration": 2, "steps": {STEPS}, "method": {method}{more}}}"#);
        let simulation = Override::parse(&simulation).expect("an override");
        let mut problem =
            Problem::load(&path, &[simulation]).unwrap_or_else(|faults| panic!("{faults}"));
        let x = problem.start();
        for megabytes in MEGABYTES {
            problem.limit_memory((1e6 * megabytes) as usize);
            let (forwards, at) = fastest(2, || Analysis::new(&problem).at(&x));
            let at = at?;
            let (backwards, found) = fastest(2, || at.gradients_and_work(&[0]));
            let (_, work) = found?;
            println!(
                "| {method} | {megabytes} | {:.2} | {:.2} |",
                work.recomputed as f64 / STEPS as f64,
                backwards / forwards
            );
        }
    }
    Ok(())
}
