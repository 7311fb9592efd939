//! BDF against trajectories of independent codes: error, order, constraints.

mod reference;

use flexbody::integrate::{Method, Settings, simulate};

#[test]
fn trebuchet_bdf2() {
    for (name, duration) in [
        ("trebuchet", 2.0),
        ("triple_pendulum", 3.0),
        ("chain_16", 1.0),
    ] {
        let (model, instants) = reference::load(name);
        for steps in [500, 1000, 2000].map(|n| (n as f64 * duration) as usize) {
            let t = std::time::Instant::now();
            let settings = Settings {
                steps,
                method: Method::Bdf { order: 2 },
            };
            let run = simulate(&model, duration, &settings).expect("runs");
            println!(
                "{name} {steps} {:?} {:e} {:?}",
                t.elapsed(),
                reference::position_error(&run, &instants),
                run.counts
            );
        }
    }
}
