//! Verdicts that must not come too early (unbounded, infeasible, a limit), and the ends of programs
//! with extreme numbers and round-off.

use crate::problems;
use crate::problems::least_squares;
use crate::problems::scaled;

use flexbody_optimiser::{Method, Nlp, Options, Outcome, Silent, Status, solve};
use least_squares::least_squares;
use problems::dual::Dual;
use problems::hock_schittkowski;
use problems::problem::{INF, Problem};
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

/// All of these have a minimum and feasible points.
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

/// At these starts the violation has a maximum or a saddle. Feasible points are at distances from a
/// hundred to a thousand.
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

/// Far from its bump the row is constant: it is not known that no point is feasible.
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

/// Huge numbers, no variables, more equalities than variables: every run ends with a status.
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

/// The round-off of an objective of 1e13 exceeds the tolerance. The status says so, at a point that
/// is as good as possible.
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
            // In the last digits of BROWNDEN the interior point finds no rest.
            let restless = name == "BROWNDEN" && method == Method::InteriorPoint;
            assert!(
                matches!(outcome.status, Status::AtPrecision | Status::Converged)
                    || restless && outcome.status == Status::Stalled,
                "{context}"
            );
            let error = (outcome.objective / 1e8 - best).abs();
            assert!(error <= 1e-9 * best, "{context} {error:e}");
        }
    }
}

/// If the interior point uses up its share, the trust region gets the rest.
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

/// The residuals of an outcome follow from its point and its multipliers, whose signs are those of
/// ∇f + Jᵀy − z_L + z_U = 0. They are all computed again here, at ends and on the way.
#[test]
fn residuals_follow_from_the_point_and_its_multipliers() {
    let made: [fn() -> Problem; 5] = [
        // Both variables at their upper bounds, with forces 1 and 2.
        || {
            Problem::new("up", &[0.4, 0.2], -7.0, |x| x[0] * (-1.0) - x[1] * 2.0)
                .bounds(&[0.0, -1.0], &[1.0, 3.0])
        },
        // Both at their lower bounds, with forces 1 and 2.
        || {
            Problem::new("down", &[0.4, 0.2], 2.0, |x| x[0] + x[1] * 2.0)
                .bounds(&[0.0, 1.0], &[1.0, 3.0])
        },
        // A row at its upper bound, one at its lower bound and one between.
        || {
            Problem::new("rows", &[0.5, 0.5], -1.0, |x| x[1] - x[0])
                .rows(3, 0, |x| vec![x[0] + x[1], x[1] * 1.0, x[0] - x[1] * 3.0])
                .row_bounds(&[-INF, -0.5, -9.0], &[1.0, 4.0, 9.0])
                .all_within(-5.0, 5.0)
        },
        || {
            Problem::new("round", &[0.3, 0.1], 0.0, |x| {
                (x[0] - 2.0).powi(2) + (x[1] - 1.0).powi(2)
            })
            .rows(2, 0, |x| vec![x[0] * x[0] - x[1], x[0] + x[1]])
            .row_bounds(&[-INF, -INF], &[0.0, 2.0])
            .all_within(-3.0, 0.9)
        },
        || {
            Problem::new("far", &[20.0, -30.0], 0.0, |x| x[0].powi(2) * 1e-3 - x[1])
                .rows(1, 1, |x| vec![x[0] * 40.0 - x[1], x[0] + x[1] * 2.0])
                .row_bounds(&[-3.0, 4.0], &[INF, 4.0])
                .all_within(-60.0, 50.0)
        },
    ];
    for make in made {
        for method in METHODS {
            for iterations in [1, 2, 3, 5, 8, 1000] {
                let options = Options {
                    max_iterations: iterations,
                    ..with(method)
                };
                let outcome = solve(&mut make(), &options, &mut Silent);
                recomputed(make(), &outcome, &format!("{method:?} {iterations}"));
            }
        }
    }
    for (method, (make, signs)) in METHODS
        .iter()
        .flat_map(|m| [(m, (made[0], 1.0)), (m, (made[1], -1.0))])
    {
        let outcome = run(make(), *method);
        assert!(outcome.converged());
        let z = &outcome.multipliers;
        let (forces, none) = match signs > 0.0 {
            true => (&z.upper_bounds, &z.lower_bounds),
            false => (&z.lower_bounds, &z.upper_bounds),
        };
        for (k, (force, none)) in forces.iter().zip(none).enumerate() {
            let expected = 1.0 + k as f64;
            assert!((force - expected).abs() < 1e-5, "{method:?} {z:?}");
            assert!((0.0..1e-5).contains(none), "{method:?} {z:?}");
        }
    }
    for method in METHODS {
        let y = run(made[2](), method).multipliers.constraints;
        // min y − x: x + y = 1 has the multiplier 1, y = −0.5 has −2.
        let expected = [1.0, -2.0, 0.0];
        for (y, expected) in y.iter().zip(expected) {
            assert!((y - expected).abs() < 1e-5, "{method:?} {y} {expected}");
        }
    }
}

/// Compares the residuals of an outcome with those computed from the problem.
fn recomputed(mut problem: Problem, outcome: &Outcome, context: &str) {
    let context = format!("{} {context} {:?}", problem.name, outcome.status);
    let slopes = problem.gradients(&outcome.x).expect("is defined");
    let (lower, upper) = problem.variable_bounds();
    let (row_lower, row_upper) = problem.constraint_bounds();
    let z = &outcome.multipliers;
    let part = |force: f64, distance: f64| {
        assert!(force >= 0.0, "{context}: {z:?}");
        if force > 0.0 {
            force * distance.abs()
        } else {
            0.0
        }
    };
    let (mut stationarity, mut complementarity) = (0.0_f64, 0.0);
    for i in 0..outcome.x.len() {
        let rows = (0..z.constraints.len()).map(|j| slopes.jacobian[(j, i)] * z.constraints[j]);
        let force = slopes.objective[i] + rows.sum::<f64>();
        let residual = force - z.lower_bounds[i] + z.upper_bounds[i];
        stationarity = stationarity.max(residual.abs());
        complementarity += part(z.lower_bounds[i], outcome.x[i] - lower[i]);
        complementarity += part(z.upper_bounds[i], upper[i] - outcome.x[i]);
    }
    for (j, &y) in z.constraints.iter().enumerate() {
        let c = outcome.constraints[j];
        complementarity +=
            part(y.max(0.0), row_upper[j] - c) + part((-y).max(0.0), c - row_lower[j]);
    }
    let kkt = &outcome.kkt;
    let near = |own: f64, found: f64| (own - found).abs() <= 1e-9 * (own.abs() + 1e-4);
    assert!(
        near(stationarity, kkt.stationarity),
        "{context}: {stationarity:e} {kkt:?}"
    );
    assert!(
        near(complementarity, kkt.complementarity),
        "{context}: {complementarity:e} {kkt:?}"
    );
}
