//! Published optimal controls.

use crate::reference::documents::{optimised, problem};
use flexbody_optimiser::Status;
use serde_json::Value;
use std::path::Path;

fn benchmark(name: &str) -> Value {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"));
    let path = path.join(format!("problems/benchmarks/{name}.json"));
    let text = std::fs::read_to_string(path).expect("a file");
    serde_json::from_str(&text).expect("JSON")
}

/// The time-optimal slew of two masses on a spring: switches at 1.003, 2.109 and 3.215 s, end at 4.218 s (Liu & Wie 1992,
/// *Robust time-optimal control of uncertain flexible spacecraft*, J. Guidance 15). In the closed form
/// the switches are antisymmetric about the middle, and the mode of frequency √2 is at rest at the end:
/// 1 − 2 cos ω(T/2 − t_1) + cos ωT/2 = 0, with (T/2)² − 2 (T/2 − t_1)² = 2.
#[test]
fn two_masses_slew_in_the_shortest_time() {
    let own = problem(&benchmark("two_mass_slew"));
    let done = optimised(&own);
    assert_eq!(done.outcome.status, Status::Converged);
    let design = &done.history.rows.last().expect("iterations").design;
    let half = |inner: f64| (2.0 + 2.0 * inner * inner).sqrt();
    let (mut low, mut high) = (1.0_f64, 1.2_f64);
    let omega = std::f64::consts::SQRT_2;
    let off = |inner: f64| 1.0 - 2.0 * (omega * inner).cos() + (omega * half(inner)).cos();
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        match off(middle) * off(low) > 0.0 {
            true => low = middle,
            false => high = middle,
        }
    }
    let half_time = half(low);
    let exact = [half_time - low, half_time, half_time + low, 2.0 * half_time];
    for ((own, exact), published) in design.iter().zip(exact).zip([1.003, 2.109, 3.215, 4.218]) {
        assert!((own - exact).abs() < 1e-8, "{own} {exact}");
        assert!((own - published).abs() < 5e-4, "{own} {published}");
    }
}

/// The reach of two links with the least effort, against the conditions of Pontryagin, solved by collocation to 1e-8: 44.916750
/// N² m² s. Torques of straight lines between 21 nodes are nearly as good, and cannot be better.
#[test]
fn two_links_reach_with_the_least_effort() {
    let own = problem(&benchmark("two_link_reach"));
    let done = optimised(&own);
    assert_eq!(done.outcome.status, Status::Converged);
    let last = done.history.rows.last().expect("iterations");
    let least = 44.916_749_6;
    assert!(
        last.objective > least && last.objective < least * (1.0 + 2e-5),
        "{}",
        last.objective
    );
    // The torques at the start, nearly.
    for (node, torque) in [(0, 4.874_301), (21, 10.535_248)] {
        let found = last.design[node];
        assert!((found - torque).abs() < 0.03 * torque, "{found} {torque}");
    }
}
