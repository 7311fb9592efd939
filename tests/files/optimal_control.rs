//! Published optimal controls.

use crate::reference::documents::{optimised, problem, values};
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

/// The switches of a rest-to-rest slew with one mode of frequency ω are antisymmetric about T/2, as those of
/// [`two_masses_slew_in_the_shortest_time`]: with the inertia J, the angle θ and the torque M,
/// (T/2)² − 2 (T/2 − t_1)² = J θ / M (Singh, Kabamba & McClamroch 1989, J. Guidance 12, 71–81). The arm of the file also
/// feels its rotation.
#[test]
fn an_elastic_arm_slews_in_the_shortest_time() {
    let file = benchmark("arm_slew");
    let done = optimised(&problem(&file));
    assert_eq!(done.outcome.status, Status::Converged);
    let design = &done.history.rows.last().expect("iterations").design;
    let [brakes, pushes, stops, end] = design[..] else {
        panic!("four instants")
    };
    assert!((pushes - 0.5 * end).abs() < 1e-6, "{design:?}");
    assert!((brakes + stops - end).abs() < 1e-6, "{design:?}");
    // The frequency at rest, and the inertia.
    let mut own = file.clone();
    let map = own.as_object_mut().expect("a file");
    map.remove("events");
    map.insert("loads".into(), json!({}));
    map.remove("variables");
    map.remove("objective");
    map.remove("constraints");
    own["functions"] = json!({
        "f": {"value": {"at": 0, "of": {"frequency": {"mode": 1}}}},
    });
    own["simulation"]["duration"] = json!(0.01);
    let omega = std::f64::consts::TAU * values(&own)[0];
    let inertia = 2700.0 * 9e-5 / 3.0 + 0.5 * 4.0 * 0.01;
    let square = inertia * std::f64::consts::FRAC_PI_2 / 0.2;
    let half = |inner: f64| (square + 2.0 * inner * inner).sqrt();
    let off = |inner: f64| 1.0 - 2.0 * (omega * inner).cos() + (omega * half(inner)).cos();
    let (mut low, mut high) = (0.05, 0.08);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        match off(middle) * off(low) > 0.0 {
            true => low = middle,
            false => high = middle,
        }
    }
    assert!(
        (0.5 * end - half(low)).abs() < 2e-3,
        "{end} {}",
        2.0 * half(low)
    );
    assert!((0.5 * end - brakes - low).abs() < 2e-3, "{design:?} {low}");
}

/// The curve of the fastest descent is a cycloid (Johann Bernoulli 1696): from (0, 10) to (10, 5) m in 1.801603 s with
/// g = 9.80665 m/s², the value of dymos' example. A curve by 17 nodes is nearly as fast, and cannot be faster.
#[test]
fn a_bead_falls_along_the_brachistochrone() {
    let file = benchmark("brachistochrone");
    let done = optimised(&problem(&file));
    assert_eq!(done.outcome.status, Status::Converged);
    let last = done.history.rows.last().expect("iterations");
    let least = 1.801_603_123;
    assert!(
        last.objective > least && last.objective < least + 5e-5,
        "{}",
        last.objective
    );
    // The distances of the cycloid from (10, 10) at the nodes.
    let at = &file["couplings"]["wire"]["cam"]["profile"]["at"];
    let (a, end) = (5.0 / (1.0 - 3.508_368_768_524_f64.cos()), 3.508_368_768_524);
    let place = |t: f64| (a * (t - t.sin()) - 10.0, -a * (1.0 - t.cos()));
    let nodes = at.as_array().expect("nodes").iter().skip(2);
    for (k, (node, at)) in last.design[1..].iter().zip(nodes).take(14).enumerate() {
        let at = at.as_f64().expect("a number");
        let (mut low, mut high) = (1e-9, end);
        for _ in 0..100 {
            let middle: f64 = 0.5 * (low + high);
            let (x, y) = place(middle);
            match (-y).atan2(-x) < at {
                true => low = middle,
                false => high = middle,
            }
        }
        let (x, y) = place(low);
        let exact = 10.0 - x.hypot(y);
        assert!((node - exact).abs() < 0.02, "{k}: {node} {exact}");
    }
}
