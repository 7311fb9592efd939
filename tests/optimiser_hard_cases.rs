//! Programs that are degenerate, infeasible, unbounded, badly scaled or undefined in places.

mod optimiser_problems;

use flexbody::optimiser::{Method, Options, Outcome, Silent, Status, solve};
use optimiser_problems::dual::Dual;
use optimiser_problems::hock_schittkowski;
use optimiser_problems::problem::{INF, Problem};

const METHODS: [Method; 3] = [Method::InteriorPoint, Method::TrustRegion, Method::Auto];

fn run(mut problem: Problem, method: Method) -> Outcome {
    let options = Options { method, ..Options::default() };
    solve(&mut problem, &options, &mut Silent)
}

/// Solves by every method; each must converge to `best` within `limit` evaluations.
fn solved_by_all(make: impl Fn() -> Problem, limit: usize) {
    for method in METHODS {
        let problem = make();
        let (name, best) = (problem.name, problem.best);
        let outcome = run(problem, method);
        assert!(outcome.converged(), "{name} {method:?}: {:?} {:?}", outcome.status, outcome.kkt);
        let error = (outcome.objective - best).abs() / best.abs().max(1.0);
        assert!(error <= 1e-6, "{name} {method:?}: {} not {best}", outcome.objective);
        assert!(outcome.kkt.violation <= 1e-6, "{name} {method:?}: {:?}", outcome.kkt);
        assert!(outcome.counts.evaluations <= limit, "{name} {method:?}: {:?}", outcome.counts);
    }
}

/// The full step towards the solution raises both objective and violation (Maratos 1978; Nocedal &
/// Wright 2006, example 15.4).
#[test]
fn maratos_effect_does_not_stop_the_steps() {
    let make = || {
        let angle = 1.2_f64;
        Problem::new("Maratos", &[angle.cos(), angle.sin()], -1.0, |x| {
            2.0 * (x[0].powi(2) + x[1].powi(2) - 1.0) - x[0]
        })
        .rows(0, 1, |x| vec![x[0].powi(2) + x[1].powi(2) - 1.0])
    };
    solved_by_all(make, 20);
}

/// Complementarity constraints: no feasible point satisfies the Mangasarian–Fromovitz condition.
#[test]
fn complementarity_constraints_are_solved() {
    let make = || {
        Problem::new("complementarity", &[0.8, 0.3], 1.0, |x| {
            (x[0] - 1.0).powi(2) + (x[1] - 1.0).powi(2)
        })
        .all_within(0.0, INF)
        .rows(1, 0, |x| vec![-(x[0] * x[1])])
    };
    solved_by_all(make, 120);
}

/// The optimum has no multipliers (Kuhn & Tucker 1951): the point may be found, but a run must not
/// claim that conditions hold which do not.
#[test]
fn optimum_without_multipliers_is_not_misjudged() {
    for method in METHODS {
        let problem = Problem::new("Kuhn–Tucker", &[0.0, 0.5], -1.0, |x| -x[0])
            .all_within(0.0, INF)
            .rows(1, 0, |x| vec![(1.0 - x[0]).powi(3) - x[1]]);
        let outcome = run(problem, method);
        assert!(outcome.kkt.violation <= 1e-6, "{method:?}: {:?}", outcome.kkt);
        // A violation v moves the optimum by the cube root of v.
        assert!((outcome.objective + 1.0).abs() <= 1.1e-2, "{method:?}: {}", outcome.objective);
        let force: f64 = outcome.multipliers.constraints.iter().sum();
        if outcome.converged() {
            assert!(outcome.kkt.stationarity <= 1e-3, "{method:?}: {force} {:?}", outcome.kkt);
        } else {
            assert!(
                matches!(outcome.status, Status::Stalled | Status::IterationLimit),
                "{method:?}: {:?}",
                outcome.status
            );
        }
    }
}

#[test]
fn rank_deficient_jacobian_is_solved() {
    let make = || {
        Problem::new("rank deficient", &[3.0, -1.0], 0.5, |x| {
            (x[0] - 2.0).powi(2) + (x[1] - 1.0).powi(2)
        })
        .rows(0, 2, |x| vec![x[0] - x[1], (x[0] - x[1]) * x[0]])
    };
    solved_by_all(make, 30);
}

#[test]
fn redundant_equalities_are_solved() {
    let make = || {
        Problem::new("redundant", &[4.0, 4.0, -1.0], 4.0 / 3.0, |x| {
            x[0].powi(2) + x[1].powi(2) + x[2].powi(2)
        })
        .rows(0, 3, |x| {
            let sum = x[0] + x[1] + x[2] - 2.0;
            vec![sum, 2.0 * sum, -1.0 * sum]
        })
    };
    solved_by_all(make, 20);
}

fn named_infeasible(make: impl Fn() -> Problem, least: f64) {
    for method in METHODS {
        let problem = make();
        let name = problem.name;
        let outcome = run(problem, method);
        match &outcome.status {
            Status::Infeasible { constraint, violation } => {
                assert!(constraint.starts_with("c["), "{name} {method:?}: {constraint}");
                assert!((violation - least).abs() <= 1e-3 * least, "{name} {method:?}: {violation}");
            }
            other => panic!("{name} {method:?}: {other:?} {:?}", outcome.kkt),
        }
    }
}

#[test]
fn contradictory_linear_constraints_are_named() {
    let make = || {
        Problem::new("contradiction", &[1.0, 1.0], 0.0, |x| x[0].powi(2) + x[1])
            .all_within(0.0, 1.0)
            .rows(1, 0, |x| vec![x[0] + x[1] - 3.0])
    };
    named_infeasible(make, 1.0);
}

#[test]
fn nonlinear_constraint_without_a_root_is_named() {
    let make = || {
        Problem::new("no root", &[2.0, 1.0], 0.0, |x| x[0] + x[1].powi(2))
            .rows(0, 1, |x| vec![x[0].powi(2) + x[1].powi(2) + 0.5])
    };
    named_infeasible(make, 0.5);
}

#[test]
fn unbounded_programs_are_named() {
    for method in METHODS {
        let linear = Problem::new("linear", &[1.0, 1.0], 0.0, |x| x[0] + x[1])
            .rows(1, 0, |x| vec![1.0 - x[0]]);
        let concave = Problem::new("concave", &[1.0], 0.0, |x| -(x[0].powi(2)));
        for problem in [linear, concave] {
            let name = problem.name;
            let outcome = run(problem, method);
            assert_eq!(outcome.status, Status::Unbounded, "{name} {method:?}: {:?}", outcome.kkt);
        }
    }
}

/// Steps from x = 1 overshoot into x ≤ 0, where the functions are not numbers; the optimum x = 1e-3
/// lies beside that region.
#[test]
fn undefined_region_beside_the_optimum_is_avoided() {
    let best = 1.0 + 1e3_f64.ln();
    let make = || {
        Problem::new("logarithm", &[1.0, 0.0], best, |x| {
            1e3 * x[0] - x[0].ln() + (x[1] - 1.0).powi(2)
        })
        .rows(1, 0, |x| vec![x[0].sqrt() + x[1]])
    };
    for method in METHODS {
        let outcome = run(make(), method);
        assert!(outcome.counts.failures > 0, "{method:?}: nothing failed");
        assert_eq!(outcome.failed_designs.len(), outcome.counts.failures);
        assert!(outcome.failed_designs.iter().all(|d| d.x[0] <= 0.0 && !d.what.is_empty()));
    }
    solved_by_all(make, 80);
}

#[test]
fn undefined_start_is_moved_or_named() {
    let make = || {
        Problem::new("undefined start", &[-1.0], 1.0, |x| x[0] - x[0].ln()).all_within(-5.0, 5.0)
    };
    solved_by_all(make, 40);
    for method in METHODS {
        let nowhere = Problem::new("nowhere", &[0.3], 0.0, |x| (-(x[0].powi(2)) - 1.0).ln());
        let outcome = run(nowhere, method);
        match outcome.status {
            Status::UndefinedStart { what } => assert!(what.contains("objective"), "{what}"),
            other => panic!("{method:?}: {other:?}"),
        }
        let row = Problem::new("nowhere", &[0.3], 0.0, |x| x[0])
            .rows(1, 0, |x| vec![(-(x[0].powi(2)) - 1.0).sqrt()]);
        match run(row, method).status {
            Status::UndefinedStart { what } => assert!(what.contains("c[0]"), "{what}"),
            other => panic!("{method:?}: {other:?}"),
        }
    }
}

/// One row is 1e8 times larger than its neighbour; the violation is judged in its own units.
#[test]
fn constraint_scaled_by_1e8_is_solved() {
    let make = || {
        Problem::new("scaled row", &[1.0, 5.0, 5.0, 1.0], 17.0140173, |x| {
            x[0] * x[3] * (x[0] + x[1] + x[2]) + x[2]
        })
        .all_within(1.0, 5.0)
        .rows(1, 1, |x| {
            let squares: Dual = x.iter().map(|v| v.powi(2)).sum();
            vec![1e8 * (x[0] * x[1] * x[2] * x[3] - 25.0), squares - 40.0]
        })
    };
    solved_by_all(make, 40);
}

/// 200 variables and 100 constraints, half of them equalities. The optimum is checked by its own
/// multipliers and by agreement of the methods.
fn large(n: usize) -> Problem {
    let start = vec![0.5; n];
    Problem::new("large", &start, f64::NAN, move |x| {
        let target = |i: usize| 1.5 * ((i as f64) * 0.7).sin();
        let pull: Dual = (0..n).map(|i| (x[i] - target(i)).powi(2)).sum();
        let chain: Dual = (1..n).map(|i| (x[i] - x[i - 1]).powi(4)).sum();
        pull + 0.1 * chain
    })
    .all_within(-1.0, 1.2)
    .rows(n / 4, n / 4, move |x| {
        let disc = |k: usize| 1.5 - x[4 * k].powi(2) - x[4 * k + 1].powi(2);
        let curve = |k: usize| x[4 * k + 2] + x[4 * k + 3] * x[4 * k] - 0.2;
        (0..n / 4).map(disc).chain((0..n / 4).map(curve)).collect()
    })
}

#[test]
fn two_hundred_variables_and_a_hundred_constraints_are_solved() {
    let interior = run(large(200), Method::InteriorPoint);
    let trust = run(large(200), Method::TrustRegion);
    let limited = {
        let options = Options { dense_limit: 0, ..Options::default() };
        solve(&mut large(200), &options, &mut Silent)
    };
    for outcome in [&interior, &trust, &limited] {
        assert!(outcome.converged(), "{:?} {:?}", outcome.status, outcome.kkt);
        assert!(outcome.counts.evaluations <= 150, "{:?}", outcome.counts);
        let error = (outcome.objective - interior.objective).abs() / interior.objective;
        assert!(error <= 1e-6, "{} {}", outcome.objective, interior.objective);
    }
}

/// A run that is told of convergence satisfies the conditions; none of the problems misleads it.
#[test]
fn claims_of_convergence_are_true() {
    for method in METHODS {
        for mut problem in hock_schittkowski() {
            let options = Options { method, ..Options::default() };
            let outcome = solve(&mut problem, &options, &mut Silent);
            if outcome.converged() {
                let kkt = outcome.kkt;
                let name = problem.name;
                assert!(kkt.violation <= 1e-6, "{name} {method:?}: {kkt:?}");
                assert!(kkt.relative_stationarity <= 1e-6, "{name} {method:?}: {kkt:?}");
                assert!(kkt.relative_complementarity <= 1e-6, "{name} {method:?}: {kkt:?}");
            }
        }
    }
}
