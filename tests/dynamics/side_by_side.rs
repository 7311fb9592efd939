//! Parallel simulations, elements and fronts do not change the results of a run.

use crate::reference::documents::plates;
use crate::reference::documents::problem as parsed;
use flexbody::Analysis;
use flexbody_driver::{KnownEvaluations, optimise, second_order};
use flexbody_problem::Problem;
use serde_json::Value;
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

/// Values and gradients of all functions of a scene on this number of processors, to the last bit, and the
/// products of the Krylov solver, forwards and backwards.
fn analysed(file: &Value, threads: usize) -> (Vec<u64>, [usize; 2]) {
    let problem = parsed(file);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    pool.expect("threads").install(|| {
        let at = Analysis::new(&problem).at(&problem.start());
        let at = at.unwrap_or_else(|failure| panic!("{failure}"));
        let which: Vec<usize> = (0..problem.function_names.len()).collect();
        let gradients = at.gradients_and_work(&which);
        let (gradients, work) = gradients.unwrap_or_else(|failure| panic!("{failure}"));
        let all = (at.values().into_iter()).chain(gradients.into_iter().flatten());
        let products = [at.work().products, work.products];
        (all.map(f64::to_bits).collect(), products)
    })
}

/// 52 elements a plate, more than one processor takes together; the fronts are divided, too.
#[test]
fn elements_in_motion_do_not_depend_on_the_number_of_processors() {
    for method in [
        json!({"bdf": {"order": 2}}),
        json!({"radau": {"stages": 2}}),
    ] {
        let by_steps = method["bdf"].is_object();
        let steps = if by_steps { 6 } else { 2 };
        let mut file = plates([13, 4], 1e-3 * steps as f64, steps, &method);
        file["variables"] = json!({"h": {
            "path": "/bodies/second/elements/structure/thickness",
            "lower": 0.001, "upper": 0.01
        }});
        let solvers: &[&str] = match by_steps {
            true => &["direct", "krylov"],
            false => &["direct"],
        };
        for solver in solvers {
            file["simulation"]["linear_solver"] = json!(solver);
            let [one, three] = [1, 3].map(|threads| analysed(&file, threads));
            assert_eq!(one, three, "{method} {solver}");
            assert_eq!(*solver == "krylov", one.1.iter().all(|&count| count > 0));
        }
    }
}
