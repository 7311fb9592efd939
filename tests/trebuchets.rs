use flexbody::driver::optimise;
use flexbody::problem::{Override, Problem};
use std::ops::ControlFlow;
use std::path::Path;

fn problem(file: &str, set: &[String]) -> Problem {
    let overrides: Vec<Override> = set.iter().map(|s| Override::parse(s).unwrap()).collect();
    Problem::load(&Path::new(env!("CARGO_MANIFEST_DIR")).join("problems").join(file), &overrides).unwrap_or_else(|e| panic!("{e}"))
}

#[test]
fn probe() {
    for (file, best) in [("trebuchet_release_time.json", 856.58952), ("trebuchet.json", 849.8985)] {
        for steps in [200, 300, 400, 600, 1000, 2000] {
            let t = std::time::Instant::now();
            let problem = problem(file, &[format!("/simulation/steps={steps}")]);
            let done = optimise(&problem, file, &mut |_| ControlFlow::Continue(())).unwrap();
            let o = &done.optimum;
            println!("{file} {steps} {} {:.6} off {:.4} % kkt {:?} design {:?} active {:?} constraints {:?} mult {:?} counts {:?} {:?}", o.status, o.objective.value, 100.0 * (o.objective.value / best - 1.0),
               o.kkt.scaled, o.design.values().map(|d| d.value).collect::<Vec<_>>(), o.active_bounds, o.constraints.values().map(|c| (c.value, c.active)).collect::<Vec<_>>(), o.constraints.values().map(|c| c.multiplier).collect::<Vec<_>>(), o.counts, t.elapsed());
        }
    }
}
