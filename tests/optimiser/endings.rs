//! The ends of runs: ill-posed programs, units of the objective, points that only seem infeasible,
//! and the report on fixed variables and rows.

use crate::problems;
use crate::problems::residuals;
use crate::problems::scaled;

use flexbody_optimiser::{BoundSide, Kkt, Method, Options, Outcome, Silent, Status, solve};
use problems::collected::collected;
use problems::dual::Dual;
use problems::hock_schittkowski;
use problems::problem::{INF, Problem};
use residuals::Residuals;
use scaled::Scaled;

const METHODS: [Method; 3] = [Method::InteriorPoint, Method::TrustRegion, Method::Auto];
const NAN: f64 = f64::NAN;

fn with(method: Method) -> Options {
    Options {
        method,
        ..Options::default()
    }
}

fn run(mut problem: Problem, method: Method) -> Outcome {
    solve(&mut problem, &with(method), &mut Silent)
}

/// Minimise x² + y² subject to x + y ≥ 1.
fn line() -> Problem {
    Problem::new("line", &[2.0, 3.0], 0.5, |x| x[0].powi(2) + x[1].powi(2))
        .rows(1, 0, |x| vec![x[0] + x[1] - 1.0])
}

fn assert_ill_posed(make: impl Fn() -> Problem, options: Options, part: &str) {
    for method in METHODS {
        let options = Options {
            method,
            ..options.clone()
        };
        let outcome = solve(&mut make(), &options, &mut Silent);
        match outcome.status {
            Status::IllPosed { what } => assert!(what.contains(part), "{what}"),
            other => panic!("{part} {method:?}: {other:?}"),
        }
        assert_eq!(outcome.counts.evaluations, 0, "{part}");
    }
}

#[test]
fn programs_that_make_no_sense_are_refused_by_name() {
    let plain = Options::default;
    let bounds = |l: [f64; 2], u: [f64; 2]| move || line().bounds(&l, &u);
    assert_ill_posed(bounds([0.0, NAN], [1.0; 2]), plain(), "x[1]");
    assert_ill_posed(bounds([0.0; 2], [NAN, 1.0]), plain(), "x[0]");
    assert_ill_posed(bounds([0.0, INF], [1.0, INF]), plain(), "x[1]");
    assert_ill_posed(bounds([0.0, -INF], [1.0, -INF]), plain(), "x[1]");
    assert_ill_posed(|| line().row_bounds(&[NAN], &[0.0]), plain(), "c[0]");
    assert_ill_posed(|| line().row_bounds(&[0.0], &[NAN]), plain(), "c[0]");
    assert_ill_posed(|| line().row_bounds(&[INF], &[INF]), plain(), "c[0]");
    assert_ill_posed(|| line().bounds(&[0.0], &[1.0; 2]), plain(), "lower bounds");
    assert_ill_posed(
        || line().row_bounds(&[0.0], &[1.0; 2]),
        plain(),
        "upper bounds of constraints",
    );
    let start = |x: f64| move || Problem::new("start", &[1.0, x], 0.0, |x| x[0].powi(2) + x[1]);
    assert_ill_posed(start(NAN), plain(), "x[1]");
    assert_ill_posed(start(INF), plain(), "x[1]");
    for bad in [NAN, 0.0, -1.0, INF] {
        let tolerance = Options {
            tolerance: bad,
            ..plain()
        };
        assert_ill_posed(line, tolerance, "tolerance");
        let constraint_tolerance = Options {
            constraint_tolerance: bad,
            ..plain()
        };
        assert_ill_posed(line, constraint_tolerance, "constraint_tolerance");
    }
    let seconds = Options {
        max_seconds: Some(NAN),
        ..plain()
    };
    assert_ill_posed(line, seconds, "max_seconds");
}

#[test]
fn bounds_that_cross_are_infeasible_at_once() {
    for method in METHODS {
        let row = run(line().row_bounds(&[3.0], &[1.0]), method);
        let variable = run(line().bounds(&[0.0, 2.0], &[1.0, 1.0]), method);
        for (outcome, name, half) in [(row, "c[0]", 1.0), (variable, "x[1]", 0.5)] {
            let expected = Status::Infeasible {
                constraint: name.into(),
                violation: half,
            };
            assert_eq!(outcome.status, expected, "{method:?}");
            assert_eq!(outcome.counts.evaluations, 0);
        }
    }
}

/// A claim does not depend on the unit of the objective.
#[test]
fn the_unit_of_the_objective_does_not_matter() {
    let rosenbrock = || {
        Problem::new("Rosenbrock", &[-1.2, 1.0], 0.0, |x| {
            100.0 * (x[1] - x[0].powi(2)).powi(2) + (1.0 - x[0]).powi(2)
        })
    };
    for power in -8..=8 {
        let factor = 10.0_f64.powi(power);
        for method in METHODS {
            let mut problem = Scaled {
                inner: rosenbrock(),
                factor,
            };
            let outcome = solve(&mut problem, &with(method), &mut Silent);
            let context = format!("{factor:e} {method:?}: {:?}", outcome.kkt);
            assert!(outcome.converged(), "{:?} {context}", outcome.status);
            assert!(outcome.objective <= 1e-9 * factor, "{context}");
            assert!((outcome.x[0] - 1.0).abs() <= 1e-4, "{context}");
            assert!(outcome.counts.evaluations <= 80, "{:?}", outcome.counts);
            // Before the end, one of the residuals is too large.
            let mut problem = Scaled {
                inner: rosenbrock(),
                factor,
            };
            let options = Options {
                max_iterations: outcome.counts.iterations - 4,
                ..with(method)
            };
            let early = solve(&mut problem, &options, &mut Silent);
            assert_eq!(
                early.status,
                Status::IterationLimit,
                "{factor:e} {method:?}"
            );
            let Kkt {
                stationarity,
                relative_stationarity,
                ..
            } = early.kkt;
            let worst = stationarity.max(relative_stationarity);
            assert!(worst > 1e-6, "{context} {:?}", early.kkt);
        }
    }
}

/// As many problems are solved in other units, except for a few whose path leads to another
/// optimum, and no claim is false. Gradients on the way are up to 1e4.
#[test]
fn scaled_objectives_are_solved_and_claims_stay_true() {
    for (method, least) in [
        (Method::InteriorPoint, 92),
        (Method::TrustRegion, 86),
        (Method::Auto, 92),
    ] {
        for factor in [1e-8, 1e-4, 1e4, 1e8] {
            let mut solved = 0;
            for inner in hock_schittkowski() {
                let (name, best) = (inner.name, inner.best);
                let mut problem = Scaled { inner, factor };
                let outcome = solve(&mut problem, &with(method), &mut Silent);
                if !outcome.converged() {
                    continue;
                }
                let found = Residuals::in_unit(&mut problem, &outcome, factor);
                let context = format!("{name} {factor:e} {method:?}: {found:?}");
                assert!(found.violation <= 1e-6, "{context}");
                assert!(found.stationarity <= 2e-4, "{context}");
                assert!(found.complementarity <= 1e-6, "{context}");
                assert!(found.signs, "{context}");
                let error = (outcome.objective / factor - best).abs();
                if error <= 1e-6 * best.abs().max(1.0) {
                    solved += 1;
                }
            }
            assert!(solved >= least, "{method:?} {factor:e}: {solved}");
        }
    }
}

/// The first steps start at gradients of 1e8. Those at the optimum are small relative to them.
#[test]
fn a_start_on_a_cliff_does_not_loosen_the_conditions() {
    for method in METHODS {
        let outcome = run(
            Problem::new("cliff", &[1e8, -1e8], 0.5, |x| {
                (x[0] - 1.0).powi(2) + (x[1] - 2.0).powi(2)
            })
            .rows(1, 0, |x| vec![x[0] + x[1] - 4.0]),
            method,
        );
        let near = (outcome.objective - 0.5).abs() <= 1e-6;
        assert!(near, "{method:?}: {outcome:?}");
        assert!(outcome.converged(), "{method:?}: {:?}", outcome.status);
    }
}

/// These optima have no multipliers: the gradients of the active rows and bounds are parallel.
#[test]
fn a_cusp_is_not_called_converged() {
    for method in METHODS {
        for lower in [0.0, -INF] {
            let mut problem = Problem::new("cusp", &[0.0, 0.5], -1.0, |x| -x[0])
                .bounds(&[lower, 0.0], &[INF; 2])
                .rows(1, 0, |x| vec![(1.0 - x[0]).powi(3) - x[1]]);
            let outcome = solve(&mut problem, &with(method), &mut Silent);
            if outcome.converged() {
                let found = Residuals::in_unit(&mut problem, &outcome, 1.0);
                assert!(found.stationarity <= 1e-6, "{method:?}: {found:?}");
                assert!(found.complementarity <= 1e-6, "{method:?}: {found:?}");
            } else {
                let named = matches!(&outcome.status, Status::Degenerate { constraint } if constraint == "c[0]");
                assert!(named, "{method:?}: {:?}", outcome.status);
                assert!(
                    outcome.counts.evaluations <= 400,
                    "{method:?}: {:?}",
                    outcome.counts
                );
            }
            assert!(outcome.kkt.violation <= 1e-6, "{method:?}");
            assert!((outcome.objective + 1.0).abs() <= 1e-2, "{method:?}");
        }
    }
}

#[test]
fn maxima_of_the_violation_are_left() {
    for method in METHODS {
        let one = Problem::new("one", &[0.0], 1.0, |x| x[0].powi(2))
            .rows(1, 0, |x| vec![x[0].powi(2) - 1.0]);
        let circle = Problem::new("circle", &[0.0, 0.0], 1.0, |x| {
            x[0].powi(2) + 2.0 * x[1].powi(2)
        })
        .rows(0, 1, |x| vec![x[0].powi(2) + x[1].powi(2) - 1.0]);
        for problem in [one, circle] {
            let outcome = run(problem, method);
            assert!(outcome.converged(), "{method:?}: {:?}", outcome.status);
            assert!((outcome.objective - 1.0).abs() <= 1e-6, "{method:?}");
        }
    }
}

#[test]
fn a_program_without_free_variables_is_judged() {
    let fixed = |x: f64| line().bounds(&[x; 2], &[x; 2]);
    for method in METHODS {
        let outcome = run(fixed(0.2), method);
        match outcome.status {
            Status::Infeasible {
                constraint,
                violation,
            } => {
                assert_eq!(constraint, "c[0]");
                assert!((violation - 0.6).abs() < 1e-15);
            }
            other => panic!("{method:?}: {other:?}"),
        }
        let outcome = run(fixed(0.7), method);
        assert!(outcome.converged(), "{method:?}: {:?}", outcome.status);
        assert_eq!(outcome.multipliers.lower_bounds, [1.4, 1.4]);
    }
}

#[test]
fn an_unbounded_objective_is_named_in_any_unit() {
    for factor in [1e-8, 1e-4, 1.0, 1e4, 1e8] {
        for method in METHODS {
            let linear =
                Problem::new("linear", &[1.0, 1.0], 0.0, |x| x[0] + x[1])
                    .rows(1, 0, |x| vec![1.0 - x[0]]);
            let concave = Problem::new("concave", &[1.0], 0.0, |x| -(x[0].powi(2)));
            for inner in [linear, concave] {
                let outcome = solve(&mut Scaled { inner, factor }, &with(method), &mut Silent);
                assert_eq!(outcome.status, Status::Unbounded, "{factor:e} {method:?}");
            }
        }
    }
}

/// min x² + 3xy with y fixed at 2 and x ≥ 1.5 − y: if y changes by δ, then x = −0.5 − δ.
#[test]
fn multipliers_of_fixed_variables_are_sensitivities() {
    let at = |y: f64| {
        Problem::new("fixed", &[0.5, y], 0.0, |x| {
            x[0].powi(2) + 3.0 * x[0] * x[1]
        })
        .bounds(&[-1.0, y], &[1.0, y])
        .rows(1, 0, |x| vec![x[0] + x[1] - 1.5])
    };
    for method in METHODS {
        let here = run(at(2.0), method);
        let [before, after] = [1.999, 2.001].map(|y| run(at(y), method).objective);
        let slope = (after - before) / 2e-3;
        let z = &here.multipliers;
        let found = z.lower_bounds[1] - z.upper_bounds[1];
        assert!((found - slope).abs() <= 1e-5, "{method:?}: {found} {slope}");
        let active = here.active_bounds.iter().find(|a| a.name == "x[1]");
        let active = active.expect("it is fixed");
        assert_eq!(active.side, BoundSide::Equal);
        assert!((active.multiplier - slope.abs()).abs() <= 1e-5);
    }
}

#[test]
fn rows_without_bounds_need_no_values() {
    for method in METHODS {
        let problem = Problem::new("free row", &[2.0, 3.0], 0.5, |x| {
            x[0].powi(2) + x[1].powi(2)
        })
        .rows(2, 0, |x| {
            vec![(-1.0 - x[0].powi(2)).sqrt(), x[0] + x[1] - 1.0]
        })
        .row_bounds(&[-INF, 0.0], &[INF; 2]);
        let outcome = run(problem, method);
        assert!(outcome.converged(), "{method:?}: {:?}", outcome.status);
        assert_eq!(outcome.counts.failures, 0);
        assert_eq!(outcome.constraints[0], 0.0);
    }
}

#[test]
fn active_rows_are_found_in_any_unit() {
    for factor in [1e-6, 1e-3, 1.0, 1e4, 1e7] {
        for method in METHODS {
            let problem = Problem::new("row", &[2.0, 3.0], 0.5, |x| x[0].powi(2) + x[1].powi(2))
                .rows(2, 0, move |x| {
                    vec![factor * (x[0] + x[1] - 1.0), factor * (x[0] + 3.0)]
                });
            let outcome = run(problem, method);
            let active: Vec<&str> = outcome
                .active_constraints
                .iter()
                .map(|a| a.name.as_str())
                .collect();
            assert_eq!(active, ["c[0]"], "{factor:e} {method:?}");
        }
    }
}

/// The interior point crawls along the spiral; the trust region solves it with what is left of 600
/// evaluations, and the outcome names it.
#[test]
fn one_method_stands_in_where_the_other_runs_out() {
    let spiral = || {
        let mut all = collected().into_iter();
        all.find(|p| p.name == "SPIRAL").expect("is coded")
    };
    let within = |method, max_evaluations| Options {
        max_evaluations,
        ..with(method)
    };
    let alone = within(Method::InteriorPoint, 210);
    let alone = solve(&mut spiral(), &alone, &mut Silent);
    assert!(!alone.converged(), "{:?}", alone.status);
    let both = solve(&mut spiral(), &within(Method::Auto, 600), &mut Silent);
    assert!(both.converged(), "{:?}", both.status);
    assert_eq!(both.method, Method::TrustRegion);
    let interior = both.other.as_deref();
    assert!(
        interior.is_some_and(|status| *status != Status::Converged),
        "{interior:?}"
    );
    assert_eq!(alone.other, None);
    assert!(both.objective.abs() <= 1e-6, "{}", both.objective);
    assert!(both.counts.evaluations <= 600, "{:?}", both.counts);
}

#[test]
fn convex_programs_of_large_numbers_are_solved() {
    for method in METHODS {
        let inner = Problem::new("large numbers", &[0.0; 2], 22.0 / 3.0 * 1e15, |x| {
            (x[0] - 1e8).powi(2) + (x[1] - 2e8).powi(2) + 0.5 * x[0] * x[1]
        })
        .rows(1, 0, |x| vec![2.5e8 - x[0] - x[1]]);
        let best = inner.best;
        let outcome = run(inner, method);
        assert!(outcome.converged(), "{method:?}: {:?}", outcome.status);
        let error = (outcome.objective - best).abs();
        assert!(error <= 1e-9 * best, "{method:?}: {}", outcome.objective);
    }
}

/// Designs stay exactly between the bounds although they are multiplied by the units.
#[test]
fn scaled_variables_stay_between_their_bounds() {
    for method in METHODS {
        for k in 0..200 {
            let lower = 0.1 + 0.001 * f64::from(k);
            let upper = 0.7 + 0.013 * f64::from(k);
            let problem = Problem::new("box", &[lower, upper], 0.0, move |x| {
                if x[0].value < lower || x[1].value > upper {
                    return 0.0 * x[0] + NAN;
                }
                x[0] - x[1]
            })
            .all_within(lower, upper);
            let options = Options {
                scale_variables: true,
                ..with(method)
            };
            let outcome = solve(&mut { problem }, &options, &mut Silent);
            assert!(outcome.converged(), "{method:?}: {:?}", outcome.status);
            assert_eq!(outcome.counts.failures, 0, "{method:?} {lower} {upper}");
        }
    }
}

/// The second variable changes the functions at most by round-off: at most the barrier moves it, by
/// 6e-4.
#[test]
fn variables_without_effect_stay_where_they_are() {
    for method in METHODS {
        for bounds in [[-INF, INF], [0.0, 1.0]] {
            let problem = Problem::new("rounding", &[2.0, 0.3], 0.0625, |x| {
                (x[0] - 1.0).powi(4) + 1e-17 * x[1]
            })
            .bounds(&[-5.0, bounds[0]], &[5.0, bounds[1]])
            .rows(1, 0, |x| vec![x[0] - 1.5 + 1e-17 * x[1]]);
            let outcome = run(problem, method);
            assert!(outcome.converged(), "{method:?}: {:?}", outcome.status);
            assert!((outcome.objective - 0.0625).abs() <= 1e-6);
            let moved = (outcome.x[1] - 0.3).abs();
            assert!(moved <= 1e-3, "{method:?} {bounds:?}: {moved:e}");
        }
    }
}

/// A variable without effect at the start is used again where it has an effect.
#[test]
fn variables_wake_where_they_matter() {
    for method in METHODS {
        let problem = Problem::new("waking", &[0.0, 0.4], -1.0, |x| {
            (x[0] - 2.0).powi(2) - x[0] * x[1] * 0.5
        })
        .all_within(0.0, 2.0);
        let mut problem = problem;
        let outcome = solve(&mut problem, &with(method), &mut Silent);
        assert!(outcome.converged(), "{method:?}: {:?}", outcome.status);
        assert!(
            (outcome.x[1] - 2.0).abs() <= 1e-5,
            "{method:?}: {:?}",
            outcome.x
        );
        let found = Residuals::in_unit(&mut problem, &outcome, 1.0);
        assert!(found.stationarity <= 1e-6, "{method:?}: {found:?}");
    }
}

/// Minimise sums of squares that vanish at the optimum, with bounds and rows that are not active. Their
/// gradients vanish too, and fast, so neither gives a unit.
#[test]
fn least_values_of_zero_are_recognised() {
    type Square = (&'static str, Vec<f64>, fn(&[Dual]) -> Dual);
    let squares: [Square; 8] = [
        ("ring", vec![0.3, 0.2], |x| {
            ((x[0] * x[0] + x[1] * x[1]).sqrt() - 1.0).powi(2)
        }),
        ("circle", vec![1.2, 0.9], |x| {
            (x[0] * x[0] + x[1] * x[1] - 1.0).powi(2)
        }),
        ("product", vec![0.7, 1.1], |x| (x[0] * x[1] - 1.0).powi(2)),
        ("point", vec![-1.0], |x| (x[0] - 0.3).powi(2)),
        ("valley", vec![0.8, 0.7], |x| {
            (x[1] - x[0] * x[0]).powi(2) * 10.0 + (x[0] - 1.0).powi(2)
        }),
        ("bowl", vec![1.5, 0.0, -1.0], |x| {
            let term = |i: usize| (x[i] - 0.2 * i as f64).powi(2) * (i + 1) as f64;
            term(0) + term(1) + term(2)
        }),
        ("decay", vec![0.5, 1.0], |x| {
            let at = |t: f64| (x[0] * (x[1] * -t).exp() - 0.8 * (-0.6 * t).exp()).powi(2);
            at(0.0) + at(0.5) + at(1.0) + at(1.5)
        }),
        ("sphere", vec![0.4, 0.3, 0.2], |x| {
            ((x[0] * x[0] + x[1] * x[1] + x[2] * x[2]).sqrt() - 1.0).powi(2)
        }),
    ];
    for (name, start, square) in squares {
        for unit in [1e-4, 1.0, 1e4] {
            for with_row in [false, true] {
                for method in METHODS {
                    let n = start.len();
                    let f = move |x: &[Dual]| square(x) * unit;
                    let mut nlp =
                        Problem::new(name, &start, 0.0, f).bounds(&vec![-2.0; n], &vec![2.0; n]);
                    if with_row {
                        nlp = nlp.rows(1, 0, |x| vec![x[0] + 30.0]);
                    }
                    let outcome = solve(&mut nlp, &with(method), &mut Silent);
                    let context = format!("{name}, {unit}, {with_row}, {method:?}: {outcome:?}");
                    assert_eq!(outcome.status, Status::Converged, "{context}");
                    assert!(outcome.objective <= 1e-9 * unit, "{context}");
                    assert!(outcome.counts.evaluations < 100, "{context}");
                }
            }
        }
    }
}

/// Minimise the energy ½ k (r − L)² of a spring, zero on a ring. From most starts Newton's method on it squares the
/// gradients at each step, so two or three points have gradients that mean anything.
#[test]
fn the_lowest_ring_of_a_spring_is_recognised_from_everywhere() {
    for stiffness in [0.5, 5.0, 50.0] {
        for length in [0.35, 0.5, 0.6] {
            for k in 0..12 {
                let angle = 0.3 + 0.51 * f64::from(k);
                let reach = 0.08 + 0.07 * f64::from(k);
                let start = [reach * angle.cos(), reach * angle.sin()];
                for method in METHODS {
                    let energy = move |x: &[Dual]| {
                        let r = (x[0] * x[0] + x[1] * x[1]).sqrt();
                        (r - length).powi(2) * (0.5 * stiffness * 4.0)
                    };
                    let mut nlp = Problem::new("ring", &start, 0.0, energy).all_within(-1.0, 1.0);
                    let outcome = solve(&mut nlp, &with(method), &mut Silent);
                    let context = format!("{stiffness}, {length}, {k}, {method:?}: {outcome:?}");
                    assert_eq!(outcome.status, Status::Converged, "{context}");
                    assert!(outcome.objective <= 1e-9 * stiffness, "{context}");
                    assert!(outcome.counts.evaluations < 100, "{context}");
                }
            }
        }
    }
}

/// A start at the least value of zero is a solution, whatever bounds and rows are far away. No step moves it,
/// and the barrier falls no further.
#[test]
fn starts_at_a_least_value_of_zero_are_solutions() {
    for unit in [1e-4, 1.0, 1e4] {
        for reach in [0.4, 30.0] {
            for method in METHODS {
                let mut nlp = Problem::new("rest", &[0.0, 0.0], 0.0, move |x| {
                    (x[0] * x[0] + x[1] * x[1]) * unit
                })
                .bounds(&[-1.0, -2.0], &[2.0, 1.0])
                .rows(1, 0, move |x| vec![x[0] * x[0] * -1.0 + reach]);
                let outcome = solve(&mut nlp, &with(method), &mut Silent);
                let context = format!("{unit}, {reach}, {method:?}: {outcome:?}");
                assert_eq!(outcome.status, Status::Converged, "{context}");
                assert_eq!(outcome.objective, 0.0, "{context}");
            }
        }
    }
}
