//! Ends that the residuals alone would misname: wrong gradients, points without multipliers, and
//! sizes for which a method is not meant.

use flexbody_optimiser::{Functions, Jacobian, Method, Options, Outcome, Silent, Status, solve};

const METHODS: [Method; 3] = [Method::InteriorPoint, Method::TrustRegion, Method::Auto];
const FREE: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];

fn run(nlp: &mut Functions<'_>, method: Method) -> Outcome {
    let options = Options {
        method,
        ..Options::default()
    };
    solve(nlp, &options, &mut Silent)
}

/// Weighted sum of squares about (1, 2, 3, …), in units of length and of the objective.
fn bowl(x: &[f64], length: f64, unit: f64) -> (f64, Vec<f64>) {
    let term = |(i, v): (usize, &f64)| {
        let d = v / length - 1.0 - i as f64;
        (
            unit * (i + 1) as f64 * d * d,
            2.0 * unit * (i + 1) as f64 * d / length,
        )
    };
    let terms: Vec<(f64, f64)> = x.iter().enumerate().map(term).collect();
    (
        terms.iter().map(|t| t.0).sum(),
        terms.iter().map(|t| t.1).collect(),
    )
}

#[test]
fn wrong_gradients_are_named() {
    let (mut named, mut all) = (0, 0);
    for n in [1, 2, 5, 40] {
        for (length, unit) in [(1.0, 1.0), (1e-2, 1.0), (1e2, 1e3), (1.0, 1e-3)] {
            for constant in [false, true] {
                for method in METHODS {
                    let start: Vec<f64> = (0..n).map(|i| length * (5.0 - i as f64)).collect();
                    let mut lie = Functions::new(&start, |x| {
                        let (f, mut g) = bowl(x, length, unit);
                        if constant {
                            g.fill(unit / length);
                        } else {
                            g.iter_mut().for_each(|v| *v = -*v);
                        }
                        (f, g)
                    });
                    let outcome = run(&mut lie, method);
                    let context = format!("{method:?}, {n}, {length}, {unit}, {constant}");
                    // A run at its limit is not tested.
                    match &outcome.status {
                        Status::Inconsistent { what } => {
                            assert!(what.contains("the slope of the objective is"), "{what}");
                            named += 1;
                        }
                        Status::IterationLimit => {}
                        other => panic!("{context}: {other:?}"),
                    }
                    all += 1;
                    assert!(
                        outcome.counts.evaluations < 1000,
                        "{context}: {:?}",
                        outcome.counts
                    );
                }
            }
        }
    }
    assert!(10 * named >= 9 * all, "{named} of {all}");
}

#[test]
fn a_row_with_wrong_derivatives_is_named() {
    for unit in [1e-3, 1.0, 1e3] {
        for method in METHODS {
            let mut lie = Functions::new(&[3.0, 1.0], |x| bowl(x, 1.0, 1.0)).rows(
                &[4.0 * unit],
                &[4.0 * unit],
                |x| {
                    let c = unit * (x[0] * x[0] + x[1]);
                    (
                        vec![c],
                        Jacobian::dense(1, 2, vec![-2.0 * unit * x[0], -unit]),
                    )
                },
            );
            let outcome = run(&mut lie, method);
            let Status::Inconsistent { what } = &outcome.status else {
                panic!("{method:?}, {unit}: {:?}", outcome.status);
            };
            assert!(what.contains("c[0]"), "{what}");
        }
    }
}

/// Kinks, steps and noise stop a run, but its gradients are right.
#[test]
fn gradients_of_rough_functions_are_not_called_wrong() {
    for slope in [1e-2, 1.0, 1e2] {
        for method in METHODS {
            type Rough = fn(f64) -> (f64, f64);
            let rough: [Rough; 3] = [
                |v| (v.abs(), v.signum()),
                |v| (v + (1e7 * v).sin() * 1e-7, 1.0 + (1e7 * v).cos()),
                |v| (v.abs().sqrt(), 0.5 * v.signum() / v.abs().sqrt().max(1e-9)),
            ];
            for (k, rough) in rough.iter().enumerate() {
                let mut nlp = Functions::new(&[1.3, -0.7], |x| {
                    let (a, b) = (rough(x[0]), rough(x[1] - 0.3));
                    (
                        slope * (a.0 + 2.0 * b.0),
                        vec![slope * a.1, 2.0 * slope * b.1],
                    )
                })
                .bounds(&[-3.0; 2], &[3.0; 2]);
                let status = run(&mut nlp, method).status;
                let wrong = matches!(status, Status::Inconsistent { .. });
                assert!(!wrong, "{method:?}, {slope}, function {k}: {status:?}");
            }
        }
    }
}

/// Minimise x subject to x^p = 0: the derivative of the row vanishes at the only feasible point.
#[test]
fn no_claim_is_made_where_no_multipliers_exist() {
    for power in [2, 3, 4] {
        for unit in [1e-2, 1.0, 1e2] {
            for start in [1.0, -0.5, 10.0] {
                for method in METHODS {
                    let mut nlp =
                        Functions::new(&[start], |x| (x[0], vec![1.0])).rows(&[0.0], &[0.0], |x| {
                            let slope = unit * f64::from(power) * x[0].powi(power - 1);
                            let value = unit * x[0].powi(power);
                            (vec![value], Jacobian::dense(1, 1, vec![slope]))
                        });
                    let outcome = run(&mut nlp, method);
                    let context = format!("{method:?}: {unit} x^{power} = 0 from {start}");
                    assert!(!outcome.converged(), "{context}: {:?}", outcome.kkt);
                }
            }
        }
    }
}

#[test]
fn huge_multipliers_are_believed_where_they_exist() {
    for unit in [1e-7, 1e-8, 1e-9] {
        for method in METHODS {
            let mut nlp = Functions::new(&[3.0, 1.0], |x| bowl(x, 1.0, 10.0)).rows(
                &[unit],
                &FREE[1..],
                |x| {
                    let c = unit * (x[0] * x[0] - x[1]);
                    (
                        vec![c],
                        Jacobian::dense(1, 2, vec![2.0 * unit * x[0], -unit]),
                    )
                },
            );
            let outcome = run(&mut nlp, method);
            assert!(
                outcome.converged(),
                "{method:?}, {unit}: {:?}",
                outcome.status
            );
            assert!(
                outcome.multipliers.constraints[0] < -0.1 / unit,
                "{outcome:?}"
            );
        }
    }
}

#[test]
fn the_trust_region_refuses_sizes_for_which_it_is_not_meant() {
    let solved = |n: usize, method| {
        let mut nlp = Functions::new(&vec![0.0; n], |x| bowl(x, 1.0 + x.len() as f64, 1.0));
        run(&mut nlp, method)
    };
    let refused = solved(2001, Method::TrustRegion);
    let Status::IllPosed { what } = refused.status else {
        panic!("{:?}", refused.status);
    };
    assert!(
        what.contains("at most 2000 variables") && what.contains("2001"),
        "{what}"
    );
    assert_eq!(refused.counts.evaluations, 0);
    for method in [Method::InteriorPoint, Method::Auto] {
        assert!(solved(2001, method).converged(), "{method:?}");
    }
}

/// No x satisfies c(x) ≥ 0. At the largest c its slope is what convergence and rounding leave of it, 1e-6 of the
/// gradient. By values and by gradients it may differ by its own size, and says nothing.
#[test]
fn rests_of_slopes_at_a_stationary_point_are_not_called_wrong() {
    for error in [3e-7, 1e-6, 1e-5] {
        for steep in [1.0, 100.0] {
            for method in METHODS {
                let mut nlp =
                    Functions::new(&[0.1, 0.2, 1.0], |x| (x[0] + x[1], vec![1.0, 1.0, 0.0]))
                        .rows(&[0.0], &[f64::INFINITY], |x| {
                            let (a, b) = (x[0] - 0.3, x[1] + 0.2);
                            let c = -65.0 - a * a - 2.0 * b * b + steep * x[2];
                            let slopes =
                                vec![-2.0 * a + steep * error, -4.0 * b + steep * error, steep];
                            (vec![c], Jacobian::dense(1, 3, slopes))
                        })
                        .bounds(&[-2.0, -2.0, -1.0], &[2.0, 2.0, 0.5]);
                let status = run(&mut nlp, method).status;
                let wrong = matches!(status, Status::Inconsistent { .. } | Status::Converged);
                assert!(!wrong, "{error}, {steep}, {method:?}: {status:?}");
            }
        }
    }
}
