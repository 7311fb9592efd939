mod reference;
use flexbody::integrate::*;
use std::time::Instant;
#[test]
fn probe() {
    let bdf = |order| Method::Bdf { order, start: Start::Radau };
    let methods = [Method::Dop853, Method::Radau{stages:2}, Method::Radau{stages:3}, bdf(1), bdf(2), bdf(3), bdf(4), bdf(5), bdf(6), Method::Bdf{order:5,start:Start::RisingOrder}, Method::GeneralisedAlpha{radius:0.8}];
    for (name, t, ns) in [("trebuchet", 2.0, [400, 800, 1600, 3200]), ("triple_pendulum", 3.0, [600, 1200, 2400, 4800])] {
        let (model, reference) = reference::load(name);
        for m in methods {
            let mut last = f64::NAN;
            for n in ns {
                let n = if m == Method::Dop853 { n / 8 } else { n };
                let mut s = Settings::steps(m, n);
                if m.is_adaptive() { s.samples = Samples::Uniform(1); }
                let t0 = Instant::now();
                match simulate(&model, t, &s) {
                  Ok(run) => {
                    let time = t0.elapsed().as_secs_f64();
                    let e = reference::motion_error(&run, &reference);
                    println!("{name} {} n {n} err {:.2e} order {:.2} v {:.1e} time {:.1} ms newton {:.2} fact {} ", m.name(), e.0, (last/e.0).log2(), e.1, time*1e3, run.counts.newton_iterations as f64/n as f64, run.counts.factorisations);
                    last = e.0;
                  }
                  Err(f) => println!("{name} {} n {n} {f}", m.name()),
                }
            }
        }
        for stages in [2,3] { for tol in [1e-4,1e-6,1e-8,1e-10] {
            let s = Settings { method: Method::Radau{stages}, spacing: Spacing::Tolerance(tol), samples: Samples::Uniform(1), keep_stages: false };
            let t0 = Instant::now();
            match simulate(&model, t, &s) {
              Ok(run) => { let e = reference::motion_error(&run, &reference);
                println!("{name} radau{stages} tol {tol:.0e} err {:.2e} steps {} rej {} newton {} fact {} time {:.1} ms", e.0, run.counts.steps, run.counts.rejected, run.counts.newton_iterations, run.counts.factorisations, t0.elapsed().as_secs_f64()*1e3); }
              Err(f) => println!("{name} radau{stages} tol {tol:.0e} {f}"),
            } } }
    }
}
