//! Feasibility: constraints in tiny units, the tolerance, and programs without a feasible point,
//! whose least violation is reported.

use crate::problems;

use flexbody_optimiser::{Method, Options, Outcome, Silent, Status, solve};
use problems::dual::Dual;
use problems::problem::{INF, Problem};

const METHODS: [Method; 3] = [Method::InteriorPoint, Method::TrustRegion, Method::Auto];
const START: [f64; 3] = [1.0, 2.0, 3.0];

fn run(mut problem: Problem, method: Method) -> Outcome {
    let options = Options {
        method,
        ..Options::default()
    };
    solve(&mut problem, &options, &mut Silent)
}

fn energy(x: &[Dual]) -> Dual {
    x.iter().map(|v| v.powi(2)).sum()
}

/// Least x_0 with an energy between the bounds.
fn driven(lower: f64, upper: f64) -> Problem {
    Problem::new("driven", &START, -upper.sqrt(), |x| x[0])
        .bounds(&[-10.0; 3], &[10.0; 3])
        .rows(1, 0, |x| vec![energy(x)])
        .row_bounds(&[lower], &[upper])
}

/// A violation of 1e-6 would be a thousand times these bounds; no solution has it.
#[test]
fn constraints_in_tiny_units_hold() {
    for bound in [1e-3, 1e-6, 1e-9, 1e-12] {
        for method in METHODS {
            for lower in [-INF, bound] {
                let problem = driven(lower, bound);
                let (name, best) = (problem.name, problem.best);
                let outcome = run(problem, method);
                let context = format!("{name} {lower} {bound} {method:?}: {:?}", outcome.status);
                assert!(outcome.converged(), "{context}");
                assert!(outcome.kkt.violation <= 1e-4 * bound, "{context}");
                let error = (outcome.objective - best).abs();
                assert!(error <= 1e-4 * best.abs(), "{context} {error:e}");
            }
        }
    }
    for unit in [1e-3, 1e-6, 1e-9] {
        for method in METHODS {
            let line = |equalities: usize| {
                Problem::new("line", &START, 0.5, energy).rows(
                    1 - equalities,
                    equalities,
                    move |x| vec![unit * (x[0] + x[1] - 1.0)],
                )
            };
            for outcome in [run(line(0), method), run(line(1), method)] {
                let context = format!("{unit} {method:?}: {:?}", outcome.status);
                assert!(outcome.converged(), "{context}");
                assert!(outcome.kkt.violation <= 1e-4 * unit, "{context}");
                assert!((outcome.objective - 0.5).abs() <= 1e-6, "{context}");
            }
        }
    }
}

/// The sphere is approached from outside, so each step leaves a violation.
#[test]
fn the_tolerance_of_constraints_is_kept() {
    for method in [Method::InteriorPoint, Method::TrustRegion] {
        let mut last = usize::MAX;
        for tolerance in [1e-12, 1e-6, 1e-2] {
            let mut problem = Problem::new("sphere", &START, 0.0, |x| 0.0 * x[0])
                .rows(0, 1, |x| vec![energy(x) - 100.0]);
            let options = Options {
                method,
                constraint_tolerance: tolerance,
                ..Options::default()
            };
            let outcome = solve(&mut problem, &options, &mut Silent);
            let context = format!("{tolerance:e} {method:?}: {:?}", outcome.status);
            assert!(outcome.converged(), "{context}");
            assert!(outcome.kkt.violation <= tolerance, "{context}");
            assert!(outcome.counts.evaluations <= last, "{context}");
            last = outcome.counts.evaluations;
        }
    }
}

/// Programs without a feasible point, each with the least value of its largest violation.
fn impossible() -> Vec<(Problem, f64)> {
    let bowl = |start: &[f64]| Problem::new("bowl", start, 0.0, energy);
    let scaled = || {
        let start = START.map(|x| 0.2 * x);
        Problem::new("scaled", &start, 0.0, |x| 25.0 * energy(x)).all_within(-1.0, 1.0)
    };
    let twice =
        |problem: Problem, unit: f64| problem.rows(2, 0, move |x| vec![unit * x[0], unit * x[0]]);
    let three = |product: f64| {
        Problem::new("three", &[5.0, 3.0], 0.0, |x| x[0] * x[0]).rows(0, 3, move |x| {
            let last = if product.is_finite() {
                x[0] * x[1] - product
            } else {
                x[0] + 2.0 * x[1] - 10.0
            };
            vec![x[0] + x[1] - 2.0, x[0] - x[1], last]
        })
    };
    vec![
        (
            scaled()
                .rows(1, 0, |x| vec![5.0 * x[0]])
                .row_bounds(&[6.0], &[INF]),
            1.0,
        ),
        (
            scaled()
                .rows(1, 0, |x| vec![5.0 * x[0]])
                .row_bounds(&[10.0], &[INF]),
            5.0,
        ),
        (
            twice(bowl(&START), 1.0).row_bounds(&[-INF, 2.0], &[1.0, INF]),
            0.5,
        ),
        (
            twice(scaled(), 5.0).row_bounds(&[3.0, -INF], &[INF, 1.0]),
            1.0,
        ),
        // 2 s − 2 = v and 3 − s² = v with x = y = s.
        (three(3.0), 2.0 * (6.0_f64.sqrt() - 1.0) - 2.0),
        // The rows s − 2, d and 1.5 s − 0.5 d − 10 with sum s and difference d.
        (three(INF), 7.0 / 3.0),
    ]
}

#[test]
fn the_least_violation_is_told_soon() {
    for (method, most) in [
        (Method::InteriorPoint, 300),
        (Method::TrustRegion, 30),
        (Method::Auto, 330),
    ] {
        for (k, (problem, least)) in impossible().into_iter().enumerate() {
            let outcome = run(problem, method);
            let context = format!("{k} {method:?}: {:?}", outcome.status);
            let Status::Infeasible { violation, .. } = outcome.status else {
                panic!("{context}");
            };
            assert!((violation - least).abs() <= 1e-5 * least, "{context}");
            assert_eq!(violation, outcome.kkt.violation, "{context}");
            let work = outcome.counts.evaluations;
            assert!(work <= most, "{context}: {work}");
        }
    }
}
