//! Sums of squares: certified regressions, bounds and constraints, and the work beside methods that see only the sum.

use flexbody_optimiser::{
    Evaluation, EvaluationFailure, Fit, Gradients, Method, Nlp, Options, Outcome, Residuals,
    Silent, Status, Variance, solve, statistics,
};

use crate::problems::dual::Dual;
use crate::problems::least_squares::sums_of_squares;
use crate::problems::nist::nist;
use crate::problems::problem::INF;
use crate::problems::squares::Squares;

fn fitted(problem: &mut dyn Nlp) -> Outcome {
    let options = Options {
        method: Method::LeastSquares,
        ..Options::default()
    };
    solve(problem, &options, &mut Silent)
}

/// From the second start of every set: the certified values to 1e-5 of their standard deviations, these to 1e-4, the sum
/// to 1e-9.
#[test]
fn certified_regressions_are_reproduced() {
    let mut most = 0;
    for set in nist() {
        let mut problem = set.squares(1);
        let found = fitted(&mut problem);
        let name = set.name;
        assert!(found.converged(), "{name}: {:?}", found.status);
        assert_eq!(found.method, Method::LeastSquares);
        let sum = found.objective / set.sum - 1.0;
        assert!(sum.abs() < 1e-9, "{name}: {sum:e}");
        let scales: Vec<f64> = set.values.iter().map(|v| v.abs()).collect();
        let worth = statistics(&Fit {
            residuals: &problem.values(&found.x),
            jacobian: &problem.jacobian(&found.x),
            factors: &vec![1.0; problem.values(&found.x).len()],
            scales: &scales,
            held: &vec![false; scales.len()],
            rows: &[],
            variance: Variance::Estimated,
        });
        let worth = worth.expect("converges");
        assert!(worth.undetermined.is_empty(), "{name}");
        for i in 0..scales.len() {
            let error = (found.x[i] - set.values[i]) / set.deviations[i];
            assert!(
                error.abs() < 1e-5,
                "{name}: value {i} by {error:e} deviations"
            );
            let own = worth.deviations[i].expect("determined") / set.deviations[i] - 1.0;
            assert!(own.abs() < 1e-4, "{name}: deviation {i} by {own:e}");
        }
        println!("{name}: {:?}", problem.counts);
        most = most.max(problem.counts.0);
    }
    // That of MGH10, a problem of Meyer, takes as many by all methods of its kind.
    assert!(most <= 150, "{most} evaluations");
}

/// From the first, far starts: the certified sum, or an honest end.
#[test]
fn far_starts_end_at_the_certified_sum_or_say_that_they_do_not() {
    let mut solved = 0;
    for set in nist() {
        let mut problem = set.squares(0);
        let found = fitted(&mut problem);
        let right = (found.objective / set.sum - 1.0).abs() < 1e-6;
        println!(
            "{}: {right} {:?} {:e} {:?}",
            set.name, found.status, found.objective, problem.counts
        );
        solved += usize::from(right);
    }
    assert!(solved >= 7, "{solved}");
}

/// Sums of squares of Moré, Garbow & Hillstrom take fewer evaluations than by methods that see only the sum,
/// those with large residuals included.
#[test]
fn residuals_save_evaluations() {
    let (mut with, mut without) = (0, 0);
    for (mut own, sum) in sums_of_squares().into_iter().zip(sums_of_squares()) {
        let (name, best) = (own.name, own.best);
        let found = fitted(&mut own);
        let mut sum = sum.into_problem();
        let other = solve(&mut sum, &Options::default(), &mut Silent);
        println!(
            "{name}: {:?} {:e} of {best:e}, {} and {} evaluations",
            found.status, found.objective, found.counts.evaluations, other.counts.evaluations
        );
        assert!(found.converged(), "{name}: {:?}", found.status);
        assert!(
            found.objective - best < 1e-5 * best.abs().max(1e-3),
            "{name}: {:e}",
            found.objective
        );
        with += found.counts.evaluations;
        without += other.counts.evaluations;
    }
    assert!(2 * with < without, "{with} and {without} evaluations");
}

/// Data of a·exp(−b t) with a and b of different sizes.
fn decay() -> Squares {
    Squares::new("decay", &[1.0, 0.1], 0.0, |x| {
        let row = |k: i32| {
            let t = 0.2 * f64::from(k);
            let noise = 0.01 * f64::from((7 * k) % 5 - 2);
            x[0] * (-t * x[1]).exp() - (3.0 * (-0.8 * t).exp() + noise)
        };
        (0..20).map(row).collect()
    })
}

/// A bound that excludes the best number holds, and the others fit given it.
#[test]
fn bounds_hold() {
    let mut problem = decay().bounds(&[0.0, 0.0], &[2.5, 10.0]);
    let found = fitted(&mut problem);
    assert!(found.converged(), "{:?}", found.status);
    assert_eq!(found.x[0], 2.5);
    assert!(found.multipliers.upper_bounds[0] > 0.0);
    let (r, j) = (problem.values(&found.x), problem.jacobian(&found.x));
    let slope: f64 = r.iter().zip(&j).map(|(r, j)| r * j[1]).sum();
    assert!(slope.abs() < 1e-5, "{slope:e}");
    assert!(found.counts.evaluations <= 15, "{:?}", found.counts);
    // From a start on the bound that the fit leaves.
    let mut problem = decay().bounds(&[1.0, 0.1], &[5.0, 10.0]);
    let found = fitted(&mut problem);
    assert!(found.converged() && found.x[0] > 2.9, "{:?}", found.x);
}

/// Equations and limits between the numbers hold: a b = 2, then a + b ≤ 3.
#[test]
fn constraints_hold() {
    let product = |x: &[Dual]| vec![x[0] * x[1]];
    let mut problem = decay().rows(&[2.0], &[2.0], product);
    let found = fitted(&mut problem);
    assert!(found.converged(), "{:?}", found.status);
    assert!((found.constraints[0] - 2.0).abs() < 1e-8);
    let (r, j) = (problem.values(&found.x), problem.jacobian(&found.x));
    let force = |i: usize| -> f64 { r.iter().zip(&j).map(|(r, j)| 2.0 * r * j[i]).sum() };
    let y = found.multipliers.constraints[0];
    assert!((force(0) + y * found.x[1]).abs() < 1e-5, "{y}");
    assert!((force(1) + y * found.x[0]).abs() < 1e-5);
    let mut problem = decay().rows(&[-INF], &[3.0], |x| vec![x[0] + x[1]]);
    let found = fitted(&mut problem);
    assert!(found.converged() && (found.constraints[0] - 3.0).abs() < 1e-8);
}

/// A combination that the data do not see keeps the start's distance: the step is the shortest.
#[test]
fn numbers_without_influence_stay() {
    let mut problem = Squares::new("blind", &[1.0, 1.0, 5.0], 0.0, |x| {
        let row = |k: i32| x[0] + x[1] - 0.1 * f64::from(k);
        (0..5).map(row).collect()
    });
    let found = fitted(&mut problem);
    assert!(found.converged(), "{:?}", found.status);
    assert!((found.x[0] + found.x[1] - 0.2).abs() < 1e-9);
    assert!((found.x[0] - found.x[1]).abs() < 1e-9 && found.x[2] == 5.0);
}

/// A program whose functions are undefined beyond a line, as a simulation that fails.
struct Fails(Squares);

impl Nlp for Fails {
    fn variables(&self) -> usize {
        self.0.variables()
    }
    fn constraints(&self) -> usize {
        0
    }
    fn variable_bounds(&self) -> (Vec<f64>, Vec<f64>) {
        self.0.variable_bounds()
    }
    fn constraint_bounds(&self) -> (Vec<f64>, Vec<f64>) {
        self.0.constraint_bounds()
    }
    fn start(&self) -> Vec<f64> {
        self.0.start()
    }
    fn evaluate(&mut self, x: &[f64]) -> Result<Evaluation, EvaluationFailure> {
        match x[1] > 0.85 {
            true => Err(EvaluationFailure {
                what: "the run".into(),
                reason: "it fails".into(),
            }),
            false => self.0.evaluate(x),
        }
    }
    fn gradients(&mut self, x: &[f64]) -> Result<Gradients, EvaluationFailure> {
        self.0.gradients(x)
    }
    fn residuals(&mut self, x: &[f64]) -> Result<Option<Residuals>, EvaluationFailure> {
        self.0.residuals(x)
    }
}

/// Designs that fail are left, and the fit beside them is found.
#[test]
fn failed_evaluations_back_off() {
    let found = fitted(&mut Fails(decay()));
    assert!(found.converged(), "{:?}", found.status);
    assert!((found.x[1] - 0.8).abs() < 0.03, "{:?}", found.x);
}

/// A program without residuals is refused.
#[test]
fn a_sum_without_residuals_is_refused() {
    let mut problem = decay().into_problem();
    let found = fitted(&mut problem);
    assert!(
        matches!(found.status, Status::IllPosed { .. }),
        "{:?}",
        found.status
    );
}
