//! Simulates a pendulum and prints where its end is: `cargo run --release --example simulate`.

use flexbody::{Problem, simulate};
use std::error::Error;

const PENDULUM: &str = r#"{
    "version": 1, "name": "pendulum",
    "bodies": {"bar": {
        "shape": {"box": {"size": [1, 0.1, 0.1]}}, "mass": 1,
        "points": {"end": [-0.5, 0, 0]}, "place": {"put": "end", "at": [0, 0, 0]}
    }},
    "joints": {"hinge": {"revolute": {"between": ["bar", "ground"], "at": [0, 0, 0], "axis": [0, 0, 1]}}},
    "simulation": {"duration": 2, "tolerance": 1e-9, "samples": 20},
    "functions": {"lowest": {"final": {"position": {"body": "bar", "direction": [0, 1, 0]}}}}
}"#;

/// Runs the example.
pub fn main() -> Result<(), Box<dyn Error>> {
    let problem = Problem::parse(PENDULUM, "pendulum.json", &[])?;
    let motion = simulate(&problem, &problem.start())?;
    for (k, time) in motion.times().into_iter().enumerate() {
        let bar = motion.body("bar", k).ok_or("no such body")?;
        let [x, y, _] = bar.position;
        println!("{time:5.2} s  {x:9.5} m  {y:9.5} m");
    }
    let drift = motion.energy_drift();
    println!(
        "the energy drifts by {drift:.1e} J in {} steps",
        motion.work().steps
    );
    assert!(drift < 1e-7);
    Ok(())
}
