//! Claims from starts that are far too steep: ten and a hundred times those of the collections, and
//! sums of high powers. A run that does not converge must have another status.

use crate::problems;
use crate::problems::least_squares;
use crate::problems::residuals;

use flexbody_optimiser::{
    Evaluation, EvaluationFailure, Gradients, Method, Nlp, Options, Outcome, Silent, Status, solve,
};
use least_squares::least_squares;
use problems::dual::Dual;
use problems::hock_schittkowski;
use problems::problem::Problem;
use residuals::Residuals;

const METHODS: [Method; 3] = [Method::InteriorPoint, Method::TrustRegion, Method::Auto];

/// A program that starts at a multiple of its published start.
struct Far {
    inner: Problem,
    times: f64,
}

impl Nlp for Far {
    crate::problems::inner!(
        variables,
        constraints,
        variable_bounds,
        constraint_bounds,
        evaluate,
        gradients
    );

    fn start(&self) -> Vec<f64> {
        self.inner.start().iter().map(|x| x * self.times).collect()
    }
}

fn run(problem: &mut dyn Nlp, method: Method) -> Outcome {
    let options = Options {
        method,
        ..Options::default()
    };
    solve(problem, &options, &mut Silent)
}

/// Whether the conditions hold to the tolerances, in the units of the problem.
fn is_true(problem: &mut dyn Nlp, outcome: &Outcome) -> bool {
    let found = Residuals::in_unit(problem, outcome, 1.0);
    found.violation <= 1e-6
        && found.stationarity <= 1.001e-6
        && found.complementarity <= 1.001e-6
        && found.signs
}

/// No claim from `times` the start is false, and each method converges on at least as many problems
/// as `least` states.
fn check(name: &str, make: impl Fn() -> Vec<Problem>, times: f64, least: [usize; 3]) {
    for (method, least) in METHODS.into_iter().zip(least) {
        let mut converged = 0;
        for inner in make() {
            let context = format!("{} {times} {method:?}", inner.name);
            let mut problem = Far { inner, times };
            let outcome = run(&mut problem, method);
            if outcome.converged() {
                converged += 1;
                assert!(
                    is_true(&mut problem, &outcome),
                    "{context}: {:?}",
                    outcome.kkt
                );
            } else {
                assert_ne!(outcome.status, Status::Unbounded, "{context}");
            }
        }
        println!("{name} {times} {method:?}: {converged}");
        assert!(converged >= least, "{name} {times} {method:?}: {converged}");
    }
}

#[test]
fn claims_of_sums_of_squares_are_true() {
    check("squares", least_squares, 10.0, [15, 13, 15]);
    check("squares", least_squares, 100.0, [13, 10, 13]);
}

#[test]
fn claims_of_constrained_problems_are_true() {
    check("collection", hock_schittkowski, 10.0, [97, 92, 97]);
    check("collection", hock_schittkowski, 100.0, [96, 86, 97]);
}

/// Σ x_i^p + b_i x_i, whose minimum is −Σ (1 − 1/p) b_i (b_i/p)^(1/(p − 1)).
fn powers(power: i32, start: &[f64], b: Vec<f64>) -> Problem {
    let p = f64::from(power);
    let part = |b: &f64| -(1.0 - 1.0 / p) * b * (b / p).powf(1.0 / (p - 1.0));
    let best = b.iter().map(part).sum();
    Problem::new("powers", start, best, move |x| {
        let terms = x.iter().zip(&b);
        terms.map(|(&x, &b)| x.powi(power) + b * x).sum::<Dual>()
    })
}

#[test]
fn steep_powers_are_solved() {
    for power in [4, 6, 8, 10] {
        for method in METHODS {
            for k in 0..50 {
                let n = 2 + k % 4;
                let spread = |i: usize, q: usize| ((k * 7 + i * 13) * q % 101) as f64 / 101.0;
                let start: Vec<f64> = (0..n).map(|i| 5.0 + 20.0 * spread(i, 37)).collect();
                let b: Vec<f64> = (0..n).map(|i| 0.5 + 2.0 * spread(i, 53)).collect();
                let mut problem = powers(power, &start, b);
                let best = problem.best;
                let outcome = run(&mut problem, method);
                let context = format!("{power} {k} {method:?}: {:?}", outcome.status);
                assert!(outcome.converged(), "{context}");
                assert!(is_true(&mut problem, &outcome), "{context}");
                let error = (outcome.objective - best).abs();
                assert!(error <= 1e-6, "{context} {error:e}");
            }
        }
    }
}

#[test]
fn steep_starts_are_left_for_the_optimum() {
    let rosenbrock = || {
        Problem::new("Rosenbrock", &[-200.0, 100.0], 0.0, |x| {
            100.0 * (x[1] - x[0].powi(2)).powi(2) + (1.0 - x[0]).powi(2)
        })
    };
    let eighth = || powers(8, &[30.0, 20.0], vec![1.0, 2.0]);
    let jennrich = || {
        let all = least_squares().into_iter();
        all.filter(|p| p.name == "JENSMP")
            .collect::<Vec<_>>()
            .remove(0)
    };
    for method in METHODS {
        for inner in [rosenbrock(), eighth()] {
            let (name, best) = (inner.name, inner.best);
            let mut problem = inner;
            let outcome = run(&mut problem, method);
            assert!(
                outcome.converged(),
                "{name} {method:?}: {:?}",
                outcome.status
            );
            let error = (outcome.objective - best).abs();
            assert!(error <= 1e-6, "{name} {method:?}: {error:e}");
        }
        let mut problem = Far {
            inner: jennrich(),
            times: 10.0,
        };
        let outcome = run(&mut problem, method);
        assert!(outcome.converged(), "{method:?}: {:?}", outcome.status);
        // The sum has a stationary point apart from its minimum, which is 124.36.
        let context = format!("{method:?}: {} {:?}", outcome.objective, outcome.kkt);
        assert!(outcome.objective < 260.0, "{context}");
        assert!(is_true(&mut problem, &outcome), "{context}");
    }
}
