//! The optimiser solves problems of Hock & Schittkowski (1981) from first derivatives alone.
//!
//! `cargo test --release --test optimiser hock_schittkowski -- --nocapture` prints the table.

use crate::problems;
use crate::problems::allowed;
use crate::problems::residuals;

use allowed::{ALLOWED, Allowed};
use flexbody_optimiser::{Method, Options, Outcome, Silent, solve};
use problems::hock_schittkowski;
use problems::problem::Problem;
use residuals::Residuals;

/// Objectives of stationary points that are not global minima, at which a method may end.
const STATIONARY: [(&str, f64); 11] = [
    ("HS2", 4.941229318),
    ("HS16", 23.14466091),
    ("HS20", 40.19873024),
    ("HS33", -4.0),
    ("HS55", 6.666666667),
    ("HS59", -6.749505269),
    ("HS97", 4.071246356),
    ("HS98", 4.071246356),
    ("HS108", -0.674981442),
    ("HS108", -0.5),
    ("HS116", 97.59103473),
];

/// Requirements on a method over all problems.
struct Demand {
    solved: usize,
    median_evaluations: usize,
    median_gradients: usize,
}

/// Largest number of evaluations of functions and gradients of `method` for a problem.
fn allowed(name: &str, method: Method) -> Allowed {
    let found = ALLOWED.iter().find(|(problem, _, _)| *problem == name);
    let (_, interior, trust) = found.unwrap_or_else(|| panic!("{name} has no band"));
    match method {
        Method::TrustRegion | Method::LeastSquares => *trust,
        Method::InteriorPoint | Method::Auto => *interior,
    }
}

fn is_near(value: f64, best: f64) -> bool {
    (value - best).abs() <= 1e-6 * best.abs().max(1.0)
}

fn median(mut counts: Vec<usize>) -> usize {
    counts.sort_unstable();
    counts[counts.len() / 2]
}

/// A claim of convergence holds at the point with the reported multipliers, and its value is that
/// of a known stationary point. No residual is divided by multipliers, and none comes from the
/// optimiser.
fn assert_true_claim(problem: &mut Problem, outcome: &Outcome) {
    let (name, best) = (problem.name, problem.best);
    let found = Residuals::in_unit(problem, outcome, 1.0);
    assert!(found.violation <= 1e-6, "{name}: {found:?}");
    assert!(found.stationarity <= 2e-5, "{name}: {found:?}");
    assert!(found.complementarity <= 1e-6, "{name}: {found:?}");
    assert!(found.signs, "{name}: {:?}", outcome.multipliers);
    let known = STATIONARY
        .iter()
        .filter(|(n, _)| *n == name)
        .map(|(_, f)| *f);
    let mut values = known.chain([best]);
    assert!(
        values.any(|f| is_near(outcome.objective, f)),
        "{name}: {}",
        outcome.objective
    );
}

fn check(method: Method, demand: &Demand) {
    let options = Options {
        method,
        ..Options::default()
    };
    let mut solved = Vec::new();
    let mut failed = Vec::new();
    println!("{method:?}\nproblem  objective         evaluations  gradients");
    for mut problem in hock_schittkowski() {
        let outcome = solve(&mut problem, &options, &mut Silent);
        let (name, best, counts) = (problem.name, problem.best, outcome.counts);
        if outcome.converged() {
            assert_true_claim(&mut problem, &outcome);
        }
        let (f, g) = (counts.evaluations, counts.gradients);
        if outcome.converged() && is_near(outcome.objective, best) {
            if let Some((most_f, most_g)) = allowed(name, method) {
                let context = format!("{name} {method:?}: {f} / {g} of {most_f} / {most_g}");
                assert!(f <= most_f && g <= most_g, "{context}");
            }
            println!("{name:8} {:<17.9e} {f:11} {g:10}", outcome.objective);
            solved.push((f, g));
        } else {
            println!(
                "{name:8} {:<17.9e} {f:11} {g:10}  {:?}",
                outcome.objective, outcome.status
            );
            assert_eq!(allowed(name, method), None, "{name} {method:?}");
            failed.push(name);
        }
    }
    let evaluations = solved.iter().map(|s| s.0).sum::<usize>();
    let gradients = solved.iter().map(|s| s.1).sum::<usize>();
    let f = median(solved.iter().map(|s| s.0).collect());
    let g = median(solved.iter().map(|s| s.1).collect());
    let total = solved.len() + failed.len();
    println!(
        "{method:?}: {} of {total}, median {f} / {g}, all {evaluations} / {gradients}\n",
        solved.len()
    );
    assert!(
        solved.len() >= demand.solved,
        "{method:?} solved {}: not {failed:?}",
        solved.len()
    );
    assert!(
        f <= demand.median_evaluations,
        "{method:?}: median of evaluations {f}"
    );
    assert!(
        g <= demand.median_gradients,
        "{method:?}: median of gradients {g}"
    );
}

#[test]
fn interior_point_finds_the_known_optima() {
    let demand = Demand {
        solved: 94,
        median_evaluations: 12,
        median_gradients: 12,
    };
    check(Method::InteriorPoint, &demand);
}

#[test]
fn trust_region_finds_the_known_optima() {
    let demand = Demand {
        solved: 90,
        median_evaluations: 11,
        median_gradients: 10,
    };
    check(Method::TrustRegion, &demand);
}

#[test]
fn one_method_falls_back_on_the_other() {
    let demand = Demand {
        solved: 94,
        median_evaluations: 12,
        median_gradients: 12,
    };
    check(Method::Auto, &demand);
}
