//! Verdicts that must not be given too soon: unbounded, infeasible, a limit; and what extreme numbers
//! and rounding end as.

#[path = "optimiser_problems/least_squares.rs"]
mod least_squares;
mod optimiser_problems;
#[path = "optimiser_problems/scaled.rs"]
mod scaled;

use flexbody::optimiser::{Method, Options, Outcome, Silent, Status, solve};
use least_squares::least_squares;
use optimiser_problems::dual::Dual;
use optimiser_problems::hock_schittkowski;
use optimiser_problems::problem::{INF, Problem};
use scaled::Scaled;

const METHODS: [Method; 3] = [Method::InteriorPoint, Method::TrustRegion, Method::Auto];

fn with(method: Method) -> Options {
    Options {
        method,
        ..Options::default()
    }
}

fn run(mut problem: Problem, method: Method) -> Outcome {
    solve(&mut problem, &with(method), &mut Silent)
}

/// All of these have a least value and feasible points.
#[test]
fn published_programs_are_neither_unbounded_nor_infeasible() {
    for method in METHODS {
        for problem in hock_schittkowski() {
            let name = problem.name;
            let status = run(problem, method).status;
            let wrong = matches!(status, Status::Unbounded | Status::Infeasible { .. });
            assert!(!wrong, "{name} {method:?}: {status:?}");
        }
    }
}

/// A large constant, a small curvature or a start on a plateau do not make an objective unbounded.
#[test]
fn bounded_objectives_are_not_called_unbounded() {
    let made: [fn() -> Problem; 5] = [
        || Problem::new("flat", &[1.0], -1e9, |x| 1e-13 * x[0].powi(2) - 1e9),
        || Problem::new("constant", &[1.0], -1e21, |x| x[0].powi(2) - 1e21),
        || Problem::new("well", &[5.4], -1.0, |x| -((-(x[0].powi(2))).exp())),
        || {
            Problem::new("deep well", &[5.4], -1e9 - 1.0, |x| {
                -((-(x[0].powi(2))).exp()) - 1e9
            })
            .all_within(-6.0, 6.0)
        },
        || {
            Problem::new("steep", &[1.0, 2.0], 0.0, |x| {
                1e300 * (x[0].powi(2) + (x[1] - 1.0).powi(2))
            })
        },
    ];
    for method in METHODS {
        for make in made {
            let problem = make();
            let (name, best) = (problem.name, problem.best);
            let outcome = run(problem, method);
            assert!(
                outcome.converged(),
                "{name} {method:?}: {:?}",
                outcome.status
            );
            let error = (outcome.objective - best).abs();
            assert!(
                error <= 1e-9 * best.abs().max(1.0),
                "{name} {method:?}: {error:e}"
            );
        }
    }
}

/// At these starts the violation has a maximum or a saddle; feasible points are a hundred to a
/// thousand away.
#[test]
fn distant_feasible_points_are_found() {
    for method in METHODS {
        let one =
            || Problem::new("one", &[0.0], 1e3, |x| x[0]).rows(0, 1, |x| vec![x[0] * x[0] - 1e6]);
        let saddle = || {
            Problem::new("saddle", &[0.0, 0.0], 2e4, |x| x[0] * x[0] + x[1] * x[1]).rows(
                1,
                0,
                |x| vec![x[0] * x[1] - 1e4],
            )
        };
        let outcome = run(one(), method);
        assert!(outcome.converged(), "{method:?}: {:?}", outcome.status);
        assert!(
            (outcome.x[0].abs() - 1e3).abs() <= 1e-6,
            "{method:?}: {:?}",
            outcome.x
        );
        let outcome = run(saddle(), method);
        assert!(outcome.converged(), "{method:?}: {:?}", outcome.status);
        assert!(
            (outcome.objective - 2e4).abs() <= 1e-2,
            "{method:?}: {}",
            outcome.objective
        );
    }
}

/// Far from its bump the row does not change at all: that no point is feasible is not known.
#[test]
fn a_plateau_of_the_violation_is_not_called_infeasible() {
    for start in [0.0, 10.0, 20.0, 36.0] {
        for method in METHODS {
            let outcome = run(
                Problem::new("bump", &[start], 0.0, |x| x[0].powi(2))
                    .rows(1, 0, |x| vec![(-((x[0] - 30.0).powi(2))).exp() - 0.5]),
                method,
            );
            let context = format!("{start} {method:?}: {:?}", outcome.status);
            if outcome.converged() {
                assert!(outcome.kkt.violation <= 1e-6, "{context}");
            } else {
                assert_eq!(outcome.status, Status::Stalled, "{context}");
            }
        }
    }
}

/// Huge numbers, no variables, more equalities than variables: every run ends under a name.
#[test]
fn extreme_programs_end_by_name() {
    let square = |x: &[Dual]| x[0].powi(2) + (x[1] - 1.0).powi(2);
    for method in METHODS {
        for bound in [1e300, 1.7e308] {
            let outcome = run(
                Problem::new("bounds", &[1.0, 2.0], 0.0, square).all_within(-bound, bound),
                method,
            );
            assert!(outcome.converged(), "{method:?}: {:?}", outcome.status);
        }
        let far = Problem::new("row", &[1.0, 2.0], 0.0, square)
            .rows(1, 0, |x| vec![x[0] + x[1]])
            .row_bounds(&[1e300], &[INF]);
        assert!(!run(far, method).converged());
        let steep = Problem::new("row", &[1.0, 2.0], 0.0, square)
            .rows(1, 0, |x| vec![1e300 * (x[0] + x[1] - 2.0)]);
        let outcome = run(steep, method);
        assert!(
            !outcome.converged() || outcome.kkt.violation <= 1e-6,
            "{method:?}"
        );
        let none = || Problem::new("none", &[], 3.0, |_| Dual::from(3.0));
        assert!(run(none(), method).converged());
        let row = |value: f64| none().rows(1, 0, move |_| vec![Dual::from(value)]);
        assert!(run(row(1.0), method).converged());
        let outcome = run(row(-1.0), method);
        assert!(
            matches!(outcome.status, Status::Infeasible { .. }),
            "{:?}",
            outcome.status
        );
        let equalities = |product: f64| {
            Problem::new("equalities", &[5.0, 3.0], 1.0, |x| x[0] * x[0]).rows(0, 3, move |x| {
                vec![x[0] + x[1] - 2.0, x[0] - x[1], x[0] * x[1] - product]
            })
        };
        let outcome = run(equalities(1.0), method);
        assert!(outcome.converged(), "{method:?}: {:?}", outcome.status);
        let outcome = run(equalities(3.0), method);
        assert!(outcome.kkt.violation > 0.1, "{method:?}");
        assert!(!outcome.converged(), "{method:?}");
    }
}

/// The rounding of an objective of 1e13 is above what the tolerance asks for: that is said, at a point
/// that is as good as can be.
#[test]
fn the_precision_of_the_objective_is_named() {
    let all = || least_squares().into_iter();
    for method in METHODS {
        for name in ["BROWNDEN", "JENSMP"] {
            let inner = all().find(|p| p.name == name).expect("is coded");
            let best = inner.best;
            let mut problem = Scaled { inner, factor: 1e8 };
            let outcome = solve(&mut problem, &with(method), &mut Silent);
            let context = format!("{name} {method:?}: {:?}", outcome.status);
            assert!(
                matches!(outcome.status, Status::AtPrecision | Status::Converged),
                "{context}"
            );
            let error = (outcome.objective / 1e8 - best).abs();
            assert!(error <= 1e-9 * best, "{context} {error:e}");
        }
    }
}

/// Where the interior point runs out of its share, the trust region gets all that is left.
#[test]
fn auto_spends_what_is_allowed_before_it_names_a_limit() {
    let problem = || {
        let all = least_squares().into_iter();
        all.filter(|p| p.name == "PENALTY2")
            .collect::<Vec<_>>()
            .remove(0)
    };
    for most in [20, 60] {
        let options = Options {
            max_iterations: most,
            ..with(Method::Auto)
        };
        let outcome = solve(&mut problem(), &options, &mut Silent);
        assert_eq!(outcome.status, Status::IterationLimit);
        assert_eq!(outcome.counts.iterations, most);
    }
}
