mod reference;
use flexbody::integrate::*;
use std::time::Instant;
#[test]
fn probe() {
    for (name, t) in [("trebuchet", 2.0), ("triple_pendulum", 3.0), ("chain_16", 1.0)] {
        let (model, reference) = reference::load(name);
        for tol in [1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12,1e-13] {
            let s = Settings { method: Method::Dop853, spacing: Spacing::Tolerance(tol), samples: Samples::Uniform(1), keep_stages: false };
            let mut best = f64::INFINITY; let mut run = None;
            for _ in 0..5 { let t0 = Instant::now(); run = Some(simulate(&model, t, &s).unwrap()); best = best.min(t0.elapsed().as_secs_f64()); }
            let run = run.unwrap();
            let mut s2 = s.clone(); s2.samples = Samples::Uniform((t / 0.01_f64).round() as usize);
            let r2 = simulate(&model, t, &s2).unwrap();
            let e = reference::motion_error(&run, &reference);
            let e2 = reference::motion_error(&r2, &reference);
            println!("{name} tol {tol:.0e} steps {} rej {} evals {} final {:.1e} all {:.1e} v {:.1e} time {:.2} ms, {:.2} us/eval fact {} solves {}", run.counts.steps, run.counts.rejected, run.counts.evaluations, e.0, e2.0, e2.1, best*1e3, best*1e6/run.counts.evaluations as f64, run.counts.factorisations, run.counts.solves);
        }
    }
}
