//! The optimiser solves problems of Hock & Schittkowski (1981) from first derivatives alone.

mod optimiser_problems;

use flexbody::optimiser::{Options, Silent, solve};
use optimiser_problems::hock_schittkowski;

#[test]
fn interior_point_finds_the_known_optima() {
    let names = [
        "HS1", "HS5", "HS6", "HS7", "HS10", "HS12", "HS21", "HS24", "HS35", "HS39", "HS43", "HS48",
        "HS53", "HS60",
    ];
    for mut problem in hock_schittkowski() {
        if !names.contains(&problem.name) {
            continue;
        }
        let outcome = solve(&mut problem, &Options::default(), &mut Silent);
        assert!(
            outcome.converged(),
            "{}: {:?}",
            problem.name,
            outcome.status
        );
        let error = (outcome.objective - problem.best).abs() / problem.best.abs().max(1.0);
        assert!(
            error <= 1e-6,
            "{}: objective {}",
            problem.name,
            outcome.objective
        );
        assert!(
            outcome.kkt.violation <= 1e-6,
            "{}: {:?}",
            problem.name,
            outcome.kkt
        );
        assert!(
            outcome.counts.evaluations <= 60,
            "{}: {:?}",
            problem.name,
            outcome.counts
        );
    }
}
