//! BDF against trajectories of independent codes (see `reference`): error, order, constraints,
//! reactions, energy and work.
//!
//! The scenes: a trebuchet of five bodies (2 s), a spatial triple pendulum (3 s) and a chain of
//! sixteen bars (1 s).

mod reference;

use flexbody::integrate::{Method, Settings, Trajectory, simulate};
use flexbody::model::Model;
use flexbody::system::observe::observe;
use reference::{Instant, position_error, reaction_error};

/// Step sizes for the observed order: in the asymptotic range, above round-off.
const SCENES: [(&str, f64, f64); 3] = [
    ("trebuchet", 2.0, 1e-3),
    ("triple_pendulum", 3.0, 1e-3),
    ("chain_16", 1.0, 1e-3),
];

fn run(model: &Model<f64>, duration: f64, h: f64, order: usize) -> Trajectory<f64> {
    let settings = Settings {
        steps: (duration / h).round() as usize,
        method: Method::Bdf { order },
    };
    simulate(model, duration, &settings).expect("runs")
}

fn observed_order(coarse: f64, fine: f64) -> f64 {
    (coarse / fine).log2()
}

#[test]
fn probe() {
    for (name, duration, h) in SCENES {
        let (model, instants) = reference::load(name);
        for order in [1, 2] {
            let mut before = (0.0, 0.0, 0.0);
            for h in [4.0 * h, 2.0 * h, h, h / 2.0, h / 4.0] {
                if (0.1 / h) as usize % 1 != 0 { continue; }
                let t = std::time::Instant::now();
                let run = run(&model, duration, h, order);
                let e = position_error(&run, &instants);
                let r = reaction_error(&model, &run, &instants);
                let d = energy_drift(&model, &run);
                let c = drift(&model, &run);
                println!(
                    "{name} {order} {h:e} pos {e:.3e} ({:.3}) reac {r:.3e} ({:.3}) energy {d:.3e} ({:.3}) c {c:?} {:?} {:?}",
                    observed_order(before.0, e), observed_order(before.1, r), observed_order(before.2, d), run.counts, t.elapsed()
                );
                before = (e, r, d);
            }
        }
    }
}

fn energy_drift(model: &Model<f64>, run: &Trajectory<f64>) -> f64 {
    let energy = |k| {
        let seen = observe(model, &run.numbering, run.q(k), run.v(k));
        seen.kinetic + seen.potential
    };
    (0..=run.steps).fold(0.0, |m: f64, k| m.max((energy(k) - energy(0)).abs()))
}

fn drift(model: &Model<f64>, run: &Trajectory<f64>) -> [f64; 2] {
    let mut worst = [0.0_f64; 2];
    for k in 0..=run.steps {
        let seen = observe(model, &run.numbering, run.q(k), run.v(k));
        worst = [worst[0].max(seen.position_drift), worst[1].max(seen.velocity_drift)];
    }
    worst
}
