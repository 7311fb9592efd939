//! Parallel simulations do not change the results of a run.

use flexbody::driver::{KnownEvaluations, optimise, second_order};
use flexbody::problem::Problem;
use std::ops::ControlFlow;
use std::path::Path;

/// Result of a run on this number of processors: its rows, its record and, if wanted, its
/// curvature.
fn run(file: &str, threads: usize, curvature: bool) -> (usize, String) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(file);
    let problem = Problem::load(&path, &[]).unwrap_or_else(|faults| panic!("{faults}"));
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    pool.expect("threads").install(|| {
        let mut go_on = |_: &_| ControlFlow::Continue(());
        let found = optimise(
            &problem,
            file,
            None,
            KnownEvaluations::default(),
            &mut go_on,
        );
        let found = found.expect("an objective");
        let second = curvature.then(|| {
            let (outcome, integration) = (&found.outcome, &found.integration);
            second_order(
                &problem,
                outcome,
                integration,
                KnownEvaluations::default(),
                &|| false,
            )
        });
        let optimum = &found.optimum;
        let told = format!(
            "{:?}\n{:?} {:?}\n{:?}\n{second:?}",
            found.history.rows, optimum.counts, optimum.objective, found.outcome.failed_designs,
        );
        (found.outcome.counts.failures, told)
    })
}

/// Steps to designs that cannot be assembled, and the gradients of a second-order check.
#[test]
fn runs_do_not_depend_on_the_number_of_processors() {
    for (file, curvature, fails) in [
        ("problems/extreme/locking_linkage.json", false, true),
        ("problems/trebuchet.json", true, false),
    ] {
        let [one, three] = [1, 3].map(|threads| run(file, threads, curvature));
        assert_eq!(one.0 > 0, fails, "{file}: {} failures", one.0);
        assert!(one == three, "{file}:\n{}\n{}", one.1, three.1);
    }
}
