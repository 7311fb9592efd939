//! The optimiser's own time and memory for many variables.
//!
//! `cargo bench --bench optimiser` prints a table: own time of an iteration without the evaluations,
//! and the largest memory that the optimiser held; `-- 1000` is for 1000 variables alone. `-- truss 60 22` solves a ground structure of 20,000
//! bars, `-- truss 60 22 curvature` does so with second derivatives, and `-- truss 60 22 criteria` takes
//! 500 steps of the optimality criteria.

mod report;
#[path = "../../tests/optimiser/problems/separable.rs"]
mod separable;
#[path = "../../tests/optimiser/problems/truss.rs"]
mod truss;

use flexbody::optimiser::{Method, Nlp, Options, Outcome, Silent, solve};

use separable::{Rows, Separable};

fn run(nlp: &mut dyn Nlp, method: Method, max_iterations: usize) -> (Outcome, u64) {
    let options = Options {
        method,
        max_iterations,
        ..Options::default()
    };
    let mut outcome = None;
    let memory = allocation_counter::measure(|| {
        outcome = Some(solve(nlp, &options, &mut Silent));
    });
    (outcome.expect("a run ends"), memory.bytes_max)
}

fn row(kind: &str, n: usize, method: Method, most: usize) {
    let rows = match kind {
        "two rows" => Rows::Two,
        _ => Rows::Sparse(1000.min(n / 3)),
    };
    let (outcome, bytes) = run(&mut Separable { n, rows }, method, most);
    let counts = outcome.counts;
    let own = counts.seconds - counts.evaluation_seconds;
    let iterations = counts.iterations.max(1);
    println!(
        "{:14} {kind:12} {n:7} {iterations:6} {:12.3} {:10.3} {:9.1}  {:?}",
        format!("{method:?}"),
        1e3 * own / iterations as f64,
        own,
        bytes as f64 / 1e6,
        outcome.status,
    );
}

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    if arguments.iter().any(|a| a == "truss") {
        report::report();
        return;
    }
    let most = 30;
    let only: Option<usize> = arguments.iter().find_map(|a| a.parse().ok());
    println!("method         rows         variables  its  ms each  own s  MB");
    for kind in ["two rows", "sparse rows"] {
        for n in [10, 100, 300, 1000, 10_000, 100_000] {
            if only.is_some_and(|only| only != n) {
                continue;
            }
            row(kind, n, Method::InteriorPoint, most);
        }
        for n in [10, 100, 300, 1000] {
            if only.is_some_and(|only| only != n) {
                continue;
            }
            row(kind, n, Method::TrustRegion, most);
        }
    }
}
