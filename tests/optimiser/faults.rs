//! Programs whose functions or derivatives are at fault, and ends without multipliers: what a run
//! says of them, and after how many evaluations.

use std::ops::ControlFlow;

use flexbody_optimiser::{Barrier, Observer, Row};
use flexbody_optimiser::{Evaluation, EvaluationFailure, Gradients};
use flexbody_optimiser::{
    Functions, Jacobian, Method, Nlp, Options, Outcome, Silent, Status, solve,
};

const METHODS: [Method; 3] = [Method::InteriorPoint, Method::TrustRegion, Method::Auto];
const INF: f64 = f64::INFINITY;

fn run(nlp: &mut dyn Nlp, method: Method) -> Outcome {
    let options = Options {
        method,
        ..Options::default()
    };
    solve(nlp, &options, &mut Silent)
}

fn rosenbrock(x: &[f64]) -> (f64, Vec<f64>) {
    let (a, b) = (x[1] - x[0] * x[0], 1.0 - x[0]);
    let g = vec![-400.0 * x[0] * a - 2.0 * b, 200.0 * a];
    (100.0 * a * a + b * b, g)
}

/// Functions that fail where `fails` says so.
struct Failing<F: FnMut(&[f64]) -> bool> {
    start: Vec<f64>,
    fails: F,
    panics: bool,
}

impl<F: FnMut(&[f64]) -> bool> Failing<F> {
    fn check(&mut self, x: &[f64]) -> Result<(), EvaluationFailure> {
        match (self.fails)(x) {
            true if self.panics => panic!("the mesh is torn"),
            true => Err(EvaluationFailure {
                what: "the objective".into(),
                reason: "no solution".into(),
            }),
            false => Ok(()),
        }
    }
}

impl<F: FnMut(&[f64]) -> bool> Nlp for Failing<F> {
    fn variables(&self) -> usize {
        self.start.len()
    }

    fn constraints(&self) -> usize {
        0
    }

    fn variable_bounds(&self) -> (Vec<f64>, Vec<f64>) {
        let n = self.start.len();
        (vec![-INF; n], vec![INF; n])
    }

    fn constraint_bounds(&self) -> (Vec<f64>, Vec<f64>) {
        (Vec::new(), Vec::new())
    }

    fn start(&self) -> Vec<f64> {
        self.start.clone()
    }

    fn evaluate(&mut self, x: &[f64]) -> Result<Evaluation, EvaluationFailure> {
        self.check(x)?;
        Ok(Evaluation {
            objective: x.iter().map(|v| v.powi(4) + v * v).sum(),
            constraints: Vec::new(),
        })
    }

    fn gradients(&mut self, x: &[f64]) -> Result<Gradients, EvaluationFailure> {
        self.check(x)?;
        Ok(Gradients {
            objective: x.iter().map(|v| 4.0 * v.powi(3) + 2.0 * v).collect(),
            jacobian: Jacobian::sparse(0, x.len(), []),
        })
    }
}

/// Each method gives up after two dozen failures; `Auto` tries both.
#[test]
fn a_program_that_fails_for_good_is_left() {
    for (method, most) in METHODS.into_iter().zip([30, 30, 60]) {
        let mut calls = 0;
        let mut nlp = Failing {
            start: vec![-1.2, 1.0, 3.0],
            fails: |_| {
                calls += 1;
                calls > 4
            },
            panics: false,
        };
        let outcome = run(&mut nlp, method);
        let context = format!("{method:?}: {:?} {:?}", outcome.status, outcome.counts);
        assert_eq!(outcome.status, Status::Stalled, "{context}");
        assert!(outcome.counts.failures <= most, "{context}");
    }
}

/// The optimum lies at the edge of the region where the functions are defined.
#[test]
fn the_edge_of_a_region_is_named_after_few_failures() {
    for (method, most) in METHODS.into_iter().zip([62, 62, 190]) {
        let mut nlp = Failing {
            start: vec![3.0; 5],
            fails: |x| x[0] < 1.0,
            panics: false,
        };
        let outcome = run(&mut nlp, method);
        let context = format!("{method:?}: {:?} {:?}", outcome.status, outcome.counts);
        assert_eq!(outcome.status, Status::Stalled, "{context}");
        assert!(outcome.counts.failures <= most, "{context}");
        assert!(outcome.objective <= 11.0, "{context} {}", outcome.objective);
        assert!(!outcome.failed_designs.is_empty(), "{context}");
    }
}

#[test]
fn a_panic_of_an_evaluation_is_an_ending() {
    for method in METHODS {
        for after in [0, 1, 3, 4] {
            let mut calls = 0;
            let mut nlp = Failing {
                start: vec![-1.2, 1.0, 3.0],
                fails: |_| {
                    calls += 1;
                    calls > after
                },
                panics: true,
            };
            let outcome = run(&mut nlp, method);
            let what = "the mesh is torn".to_string();
            assert_eq!(outcome.status, Status::Panicked { what }, "{method:?}");
        }
    }
}

/// At a maximum and at a saddle the gradient vanishes, but values nearby are lower.
#[test]
fn a_stationary_start_that_is_no_minimum_is_left() {
    for method in METHODS {
        let mut saddle = Functions::new(&[0.0, 0.0], |x| {
            let f = x[0].powi(2) - x[1].powi(2) + 0.1 * x[1].powi(4);
            (f, vec![2.0 * x[0], -2.0 * x[1] + 0.4 * x[1].powi(3)])
        });
        let outcome = run(&mut saddle, method);
        assert!(outcome.converged(), "{method:?}: {:?}", outcome.status);
        assert!((outcome.objective + 2.5).abs() <= 1e-6, "{method:?}");
        assert!(outcome.counts.evaluations <= 25, "{:?}", outcome.counts);
        let mut bowl = Functions::new(&[0.0, 0.0], |x| {
            (x[0] * x[0] + x[1] * x[1], vec![2.0 * x[0], 2.0 * x[1]])
        });
        let outcome = run(&mut bowl, method);
        assert!(outcome.converged(), "{method:?}: {:?}", outcome.status);
        assert!(outcome.counts.evaluations <= 7, "{:?}", outcome.counts);
    }
}

#[test]
fn gradients_that_are_zero_by_mistake_are_named() {
    for method in METHODS {
        let mut bowl = Functions::new(&[3.0, 2.0], |x| (x[0] * x[0] + x[1] * x[1], vec![0.0; 2]));
        let outcome = run(&mut bowl, method);
        let named = matches!(outcome.status, Status::Inconsistent { .. });
        assert!(named, "{method:?}: {:?}", outcome.status);
        assert!(outcome.counts.evaluations <= 8, "{:?}", outcome.counts);
    }
}

/// One derivative of three is twice too large. The steps shorten over and over again.
#[test]
fn one_wrong_derivative_is_named_early() {
    for method in [Method::InteriorPoint, Method::Auto] {
        let mut nlp = Functions::new(&[-1.2, 1.0, 2.0], |x| {
            let (f, g) = rosenbrock(x);
            let d = x[2] - x[1];
            (f + d * d, vec![g[0], 2.0 * (g[1] - 2.0 * d), 2.0 * d])
        })
        .bounds(&[-5.0; 3], &[5.0; 3]);
        let outcome = run(&mut nlp, method);
        let named = matches!(outcome.status, Status::Inconsistent { .. });
        assert!(named, "{method:?}: {:?}", outcome.status);
        assert!(outcome.counts.evaluations <= 200, "{:?}", outcome.counts);
    }
}

/// The row x² = 0 or x² ≤ 0 has no derivative where it holds.
#[test]
fn rows_without_multipliers_are_named() {
    for lower in [0.0, -INF] {
        let outcome = {
            let mut nlp =
                Functions::new(&[1.0], |x| (x[0], vec![1.0])).rows(&[lower], &[0.0], |x| {
                    (vec![x[0] * x[0]], Jacobian::dense(1, 1, vec![2.0 * x[0]]))
                });
            run(&mut nlp, Method::InteriorPoint)
        };
        let constraint = "c[0]".to_string();
        let context = format!("{lower}: {:?} {:?}", outcome.status, outcome.counts);
        assert_eq!(
            outcome.status,
            Status::Degenerate { constraint },
            "{context}"
        );
        let most = if lower == 0.0 { 30 } else { 700 };
        assert!(outcome.counts.evaluations <= most, "{context}");
    }
}

/// Noise of 1e-6 in the gradients of a quadratic, as of a truncated solution.
#[test]
fn noise_in_gradients_does_not_delay_the_end() {
    let mut calls = 0_u32;
    let mut noise = || {
        calls += 1;
        2e-6 * ((f64::from(calls) * 0.754_877).fract() - 0.5)
    };
    let weight = |i: usize| i as f64 + 1.0;
    let mut nlp = Functions::new(&[3.0; 10], |x| {
        let f = (0..10).map(|i| weight(i) * x[i] * x[i]).sum::<f64>() + 1.0;
        let g = (0..10).map(|i| 2.0 * weight(i) * x[i] + noise());
        (f, g.collect())
    });
    let outcome = run(&mut nlp, Method::InteriorPoint);
    assert!(outcome.converged(), "{:?}", outcome.status);
    assert!(outcome.counts.evaluations <= 30, "{:?}", outcome.counts);
}

#[test]
fn starts_far_away_are_left_behind() {
    for far in [1e4, 1e8] {
        let mut nlp = Functions::new(&[far, -far], |x| {
            let (a, b) = (x[0] - 1.0, x[1] - x[0]);
            (a.powi(4) + b * b, vec![4.0 * a.powi(3) - 2.0 * b, 2.0 * b])
        });
        for method in METHODS {
            let outcome = run(&mut nlp, method);
            let context = format!("{far} {method:?}: {:?}", outcome.counts);
            assert!(outcome.converged(), "{context} {:?}", outcome.status);
            assert!(outcome.objective <= 1e-8, "{context}");
            assert!(outcome.counts.evaluations <= 100, "{context}");
        }
    }
}

/// Keeps the barrier parameter of the first iteration.
struct FirstBarrier(f64);

impl Observer for FirstBarrier {
    fn iteration(&mut self, row: &Row<'_>) -> ControlFlow<()> {
        if row.iteration == 1 {
            self.0 = row.barrier;
        }
        ControlFlow::Continue(())
    }
}

#[test]
fn the_first_iteration_has_the_barrier_parameter_of_the_user() {
    for barrier in [Barrier::Adaptive, Barrier::Monotone] {
        for wanted in [10.0, 0.3, 1e-4] {
            let options = Options {
                barrier,
                initial_barrier: Some(wanted),
                ..Options::default()
            };
            let mut first = FirstBarrier(f64::NAN);
            let mut disc = Functions::new(&[0.0, 0.5], |x| {
                let f = (x[0] - 2.0).powi(2) + x[1] * x[1];
                (f, vec![2.0 * (x[0] - 2.0), 2.0 * x[1]])
            })
            .rows(&[-INF], &[1.0], |x| {
                let slopes = vec![2.0 * x[0], 2.0 * x[1]];
                (
                    vec![x[0] * x[0] + x[1] * x[1]],
                    Jacobian::dense(1, 2, slopes),
                )
            });
            let outcome = solve(&mut disc, &options, &mut first);
            assert!(
                outcome.converged(),
                "{wanted} {barrier:?}: {:?}",
                outcome.status
            );
            assert_eq!(first.0, wanted, "{barrier:?}");
        }
    }
}

/// The least sum Σ y_i that Σ i/y_i ≤ 6 allows is (Σ √i)²/6, by Cauchy and Schwarz. The variables are
/// the y_i in units from 1e-6 to 1e6.
#[test]
fn variables_in_mixed_units_are_measured_by_their_own_size() {
    let units: Vec<f64> = (0..6)
        .map(|i| 10_f64.powf(-6.0 + 2.4 * f64::from(i)))
        .collect();
    let roots: f64 = (1..=6).map(|i| f64::from(i).sqrt()).sum();
    let start: Vec<f64> = units.iter().map(|u| 3.0 * u).collect();
    let (lower, upper): (Vec<f64>, Vec<f64>) = units.iter().map(|u| (0.1 * u, 10.0 * u)).unzip();
    for method in METHODS {
        let y = |x: &[f64]| -> Vec<f64> { x.iter().zip(&units).map(|(x, u)| x / u).collect() };
        let mut nlp = Functions::new(&start, |x| {
            (y(x).iter().sum(), units.iter().map(|u| 1.0 / u).collect())
        })
        .bounds(&lower, &upper)
        .rows(&[-INF], &[6.0], |x| {
            let y = y(x);
            let share = |i: usize| (i + 1) as f64 / y[i];
            let slopes = (0..6).map(|i| -share(i) / (y[i] * units[i]));
            let c = (0..6).map(share).sum();
            (vec![c], Jacobian::dense(1, 6, slopes.collect()))
        });
        let outcome = run(&mut nlp, method);
        assert!(outcome.converged(), "{method:?}: {:?}", outcome.status);
        let error = (outcome.objective - roots.powi(2) / 6.0).abs();
        assert!(error <= 1e-5, "{method:?}: {error:e}");
        assert!(
            outcome.counts.evaluations <= 40,
            "{method:?}: {:?}",
            outcome.counts
        );
    }
}

/// Optima without multipliers end by name and soon: the gradients of the active rows are parallel.
#[test]
fn parallel_gradients_of_rows_are_named() {
    let circle = |x: &[f64], y: f64| x[0] * x[0] + (x[1] - y).powi(2);
    for method in METHODS {
        let mut discs = Functions::new(&[1.0, 1.0], |x| (x[0], vec![1.0, 0.0])).rows(
            &[-INF; 2],
            &[1.0; 2],
            |x| {
                let slope = |y: f64| [2.0 * x[0], 2.0 * (x[1] - y)];
                let slopes = [slope(1.0), slope(-1.0)].concat();
                let c = vec![circle(x, 1.0), circle(x, -1.0)];
                (c, Jacobian::dense(2, 2, slopes))
            },
        );
        let mut horn = Functions::new(&[-2.0, -2.0], |x| {
            let f = (x[0] - 2.0).powi(2) + x[1] * x[1];
            (f, vec![2.0 * (x[0] - 2.0), 2.0 * x[1]])
        })
        .bounds(&[0.0; 2], &[INF; 2])
        .rows(&[0.0], &[INF], |x| {
            let slopes = vec![-3.0 * (1.0 - x[0]).powi(2), -1.0];
            let c = vec![(1.0 - x[0]).powi(3) - x[1]];
            (c, Jacobian::dense(1, 2, slopes))
        });
        for (nlp, best, most) in [(&mut discs, 0.0, 600), (&mut horn, 1.0, 250)] {
            let outcome = run(nlp, method);
            let context = format!("{method:?}: {:?} {:?}", outcome.status, outcome.counts);
            let named = matches!(outcome.status, Status::Degenerate { .. });
            assert!(named, "{context}");
            let error = (outcome.objective - best).abs();
            assert!(error <= 1e-3, "{context}: {error:e}");
            assert!(outcome.counts.evaluations <= most, "{context}");
        }
    }
}

/// A disc of radius one, from 1e8 away in the units of the objective.
#[test]
fn a_small_disc_is_found_from_far_away() {
    let mut nlp = Functions::new(&[1e8, -1e8], |x| {
        let f = (x[0] - 1.0).powi(2) + 10.0 * (x[1] - 2.0).powi(2);
        (f, vec![2.0 * (x[0] - 1.0), 20.0 * (x[1] - 2.0)])
    })
    .rows(&[-INF], &[1.0], |x| {
        let slopes = vec![2.0 * x[0], 2.0 * x[1]];
        (
            vec![x[0] * x[0] + x[1] * x[1]],
            Jacobian::dense(1, 2, slopes),
        )
    });
    let outcome = run(&mut nlp, Method::InteriorPoint);
    assert!(outcome.converged(), "{:?}", outcome.status);
    // The optimum is ((1/(1 + y)), 20/(10 + y)) on the circle, for the multiplier y.
    let radius = |y: f64| (1.0 / (1.0 + y)).hypot(20.0 / (10.0 + y));
    let (mut low, mut high) = (0.0, 100.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if radius(middle) > 1.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    let error = (outcome.x[0] - 1.0 / (1.0 + low)).abs();
    assert!(error <= 1e-4, "{error:e}");
    assert!(outcome.counts.evaluations <= 1000, "{:?}", outcome.counts);
}
