//! Verdicts if the unit of the variables is far from their typical changes: bounds that are ten to
//! 1e20 typical changes apart and determine the unit, and starts from which everything must shrink.

use crate::problems;

use flexbody_optimiser::{
    Evaluation, EvaluationFailure, Gradients, Method, Nlp, Options, Outcome, Silent, Status, solve,
};
use problems::dual::Dual;
use problems::hock_schittkowski;
use problems::problem::{INF, Problem};

const METHODS: [Method; 3] = [Method::InteriorPoint, Method::TrustRegion, Method::Auto];

fn run(problem: &mut dyn Nlp, method: Method) -> Outcome {
    let options = Options {
        method,
        ..Options::default()
    };
    solve(problem, &options, &mut Silent)
}

/// A problem whose variables are given in `unit`.
struct Stretched {
    inner: Problem,
    unit: f64,
}

impl Stretched {
    fn inside(&self, x: &[f64]) -> Vec<f64> {
        x.iter().map(|v| v * self.unit).collect()
    }

    fn outside(&self, x: &[f64]) -> Vec<f64> {
        x.iter().map(|v| v / self.unit).collect()
    }
}

impl Nlp for Stretched {
    crate::problems::inner!(variables, constraints, constraint_bounds);

    fn variable_bounds(&self) -> (Vec<f64>, Vec<f64>) {
        let (lower, upper) = self.inner.variable_bounds();
        (self.outside(&lower), self.outside(&upper))
    }

    fn start(&self) -> Vec<f64> {
        self.outside(&self.inner.start())
    }

    fn evaluate(&mut self, x: &[f64]) -> Result<Evaluation, EvaluationFailure> {
        self.inner.evaluate(&self.inside(x))
    }

    fn gradients(&mut self, x: &[f64]) -> Result<Gradients, EvaluationFailure> {
        let mut found = self.inner.gradients(&self.inside(x))?;
        found.objective.iter_mut().for_each(|v| *v *= self.unit);
        found.jacobian.scale(self.unit);
        Ok(found)
    }
}

/// Σ v² of the velocities v = s x̂ in the units `s`.
fn energy(x: &[Dual], s: [f64; 3]) -> Dual {
    (0..3).map(|i| (x[i] * s[i]).powi(2)).sum()
}

/// A name, the units of three velocities, their common bounds and their start.
type Scene = (&'static str, [f64; 3], f64, f64, [f64; 3]);

/// Least energy with v_0 ≥ 1.
fn pushed((name, s, lower, upper, start): Scene) -> Problem {
    let start: Vec<f64> = (0..3).map(|i| start[i] / s[i]).collect();
    let of = |bound: f64| s.map(|s| bound / s);
    Problem::new(name, &start, 1.0, move |x| energy(x, s))
        .rows(1, 0, move |x| vec![s[0] * x[0] - 1.0])
        .bounds(&of(lower), &of(upper))
}

/// Least v_0 with an energy of at most 100.
fn driven((name, s, lower, upper, start): Scene) -> Problem {
    let start: Vec<f64> = (0..3).map(|i| start[i] / s[i]).collect();
    let of = |bound: f64| s.map(|s| bound / s);
    Problem::new(name, &start, -10.0, move |x| s[0] * x[0])
        .rows(1, 0, move |x| vec![100.0 - energy(x, s)])
        .bounds(&of(lower), &of(upper))
}

fn assert_solved(problem: Problem, power: i32, method: Method) {
    let (name, best) = (problem.name, problem.best);
    let outcome = run(&mut { problem }, method);
    let context = format!(
        "{name} 1e{power} {method:?}: {:?} {}",
        outcome.status, outcome.objective
    );
    assert!(outcome.converged(), "{context}");
    let error = (outcome.objective - best).abs();
    assert!(error <= 1e-6 * best.abs(), "{context}");
}

#[test]
fn bounds_far_apart_do_not_hide_the_optimum() {
    for power in [4, 6, 7, 8, 9, 10, 12, 14, 16, 20] {
        let wide = 10.0_f64.powi(power);
        let start = [1.0, 2.0, 3.0];
        let both = ("both", [wide; 3], -wide, wide, start);
        let one = ("one", [0.5 * wide; 3], -5.0, wide, start);
        for method in METHODS {
            assert_solved(pushed(both), power, method);
            assert_solved(pushed(one), power, method);
            assert_solved(driven(both), power, method);
        }
    }
}

/// From one or two of these starts the trust region advances slowly to its limit. This must not be
/// called an end.
#[test]
fn far_starts_do_not_end_early() {
    let mut crawled = 0;
    for power in [4, 6, 7, 8, 9, 10] {
        let far = 10.0_f64.powi(power);
        let start = [far, -10.0 * far, 0.1 * far];
        let bounded = ("bounded", [1e12; 3], -1e12, 1e12, start);
        let free = ("free", [far, 10.0 * far, 0.1 * far], -INF, INF, start);
        for method in METHODS {
            assert_solved(pushed(bounded), power, method);
            let status = run(&mut pushed(free), method).status;
            if method == Method::TrustRegion && status == Status::IterationLimit {
                crawled += 1;
            } else {
                assert_solved(pushed(free), power, method);
            }
        }
    }
    assert!(crawled <= 2, "{crawled}");
}

/// Units that are up to 1e6 times too small or too large prevent some optima, but cause no false
/// verdict.
#[test]
fn the_unit_of_the_variables_does_not_decide_the_verdict() {
    for (method, units) in [
        (
            Method::InteriorPoint,
            [(1e-6, 87), (1e-3, 90), (1e3, 91), (1e6, 82)],
        ),
        (
            Method::TrustRegion,
            [(1e-6, 72), (1e-3, 83), (1e3, 83), (1e6, 83)],
        ),
    ] {
        for (unit, least) in units {
            let mut solved = 0;
            for inner in hock_schittkowski() {
                let (name, best) = (inner.name, inner.best);
                let outcome = run(&mut Stretched { inner, unit }, method);
                let error = (outcome.objective - best).abs() / best.abs().max(1.0);
                if outcome.converged() && error <= 1e-6 {
                    solved += 1;
                }
                if outcome.status == Status::AtPrecision {
                    assert!(error <= 1e-4, "{name} {unit:e} {method:?}: {error:e}");
                }
            }
            assert!(solved >= least, "{method:?} {unit:e}: {solved}");
        }
    }
}
