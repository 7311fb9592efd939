//! Runs that cannot succeed end early and claim nothing.

use flexbody_optimiser::{
    Evaluation, EvaluationFailure, Gradients, Jacobian, Method, Nlp, Options, Outcome, Silent,
    Status, solve,
};

use crate::problems::problem::{INF, Problem};

const METHODS: [Method; 3] = [Method::InteriorPoint, Method::TrustRegion, Method::Auto];

fn run(nlp: &mut dyn Nlp, method: Method) -> Outcome {
    let options = Options {
        method,
        ..Options::default()
    };
    solve(nlp, &options, &mut Silent)
}

/// What a program returns wrongly.
#[derive(Clone, Copy, Debug)]
enum Lie {
    LongGradient,
    ShortConstraints,
    WideJacobian,
    ManyRows,
    /// Gradients fail from this call on.
    FailFrom(usize),
}

/// A bowl with a row.
struct Liar {
    inner: Problem,
    lie: Lie,
    calls: usize,
    /// Least objective of the feasible points whose gradients were known.
    least: f64,
}

impl Nlp for Liar {
    crate::problems::inner!(
        variables,
        constraints,
        variable_bounds,
        constraint_bounds,
        start
    );

    fn evaluate(&mut self, x: &[f64]) -> Result<Evaluation, EvaluationFailure> {
        let mut values = self.inner.evaluate(x)?;
        if let Lie::ShortConstraints = self.lie {
            values.constraints.pop();
        }
        Ok(values)
    }

    fn gradients(&mut self, x: &[f64]) -> Result<Gradients, EvaluationFailure> {
        let mut slopes = self.inner.gradients(x)?;
        self.calls += 1;
        match self.lie {
            Lie::LongGradient => slopes.objective.push(0.0),
            Lie::WideJacobian => slopes.jacobian = Jacobian::dense(1, 3, vec![0.0; 3]),
            Lie::ManyRows => slopes.jacobian = Jacobian::sparse(1, 2, [(1, 0, 1.0)]),
            Lie::FailFrom(call) if self.calls >= call => {
                return Err(EvaluationFailure {
                    what: "the gradient".into(),
                    reason: "the adjoint failed".into(),
                });
            }
            Lie::FailFrom(_) => {
                let values = self.inner.evaluate(x)?;
                if values.constraints[0] >= 0.0 {
                    self.least = self.least.min(values.objective);
                }
            }
            Lie::ShortConstraints => {}
        }
        Ok(slopes)
    }
}

fn liar(lie: Lie) -> Liar {
    let inner = Problem::new("bowl", &[3.0, -6.0], 0.0, |x| {
        (x[0] - 1.0).powi(4) + 4.0 * (x[1] - x[0]).powi(2)
    })
    .rows(1, 0, |x| vec![1.5 - x[0] - x[1]]);
    Liar {
        inner,
        lie,
        calls: 0,
        least: INF,
    }
}

#[test]
fn lists_of_wrong_length_are_named_at_once() {
    for (lie, name) in [
        (Lie::LongGradient, "gradient of the objective has 3"),
        (Lie::ShortConstraints, "list of constraints has 0"),
        (Lie::WideJacobian, "Jacobian is 1 × 3 where 1 × 2"),
        (Lie::ManyRows, "Jacobian is 2 × 2 where 1 × 2"),
    ] {
        for method in METHODS {
            let outcome = run(&mut liar(lie), method);
            let Status::IllPosed { what } = &outcome.status else {
                panic!("{lie:?} {method:?}: {:?}", outcome.status);
            };
            assert!(what.contains(name), "{what}");
            assert!(outcome.counts.evaluations <= 1, "{:?}", outcome.counts);
            assert!(outcome.kkt.stationarity.is_nan(), "nothing is known");
        }
    }
}

#[test]
fn the_best_point_is_kept_when_gradients_fail_for_good() {
    for method in METHODS {
        for call in 2..9 {
            let mut nlp = liar(Lie::FailFrom(call));
            let outcome = run(&mut nlp, method);
            let context = format!("{method:?} {call}: {:?}", outcome.status);
            assert!(!outcome.converged(), "{context}");
            let (found, least) = (outcome.objective, nlp.least);
            // Units of the variables may change the last digit.
            assert!(
                found <= least * (1.0 + 1e-14),
                "{context}: {found} and {least}"
            );
            assert!(outcome.counts.evaluations < 600, "{context}");
        }
    }
}

#[test]
fn falling_by_a_logarithm_is_no_convergence() {
    for factor in [1e-2, 1.0, 1e3, 1e7] {
        for start in [0.3, 1.0, 20.0] {
            for method in METHODS {
                let mut problem = Problem::new("logarithm", &[start, 2.0], 0.0, move |x| {
                    (x[1] - 1.0).powi(2) - factor * (1.0 + x[0].powi(2)).ln()
                });
                let outcome = run(&mut problem, method);
                let context = format!("{factor:e} {start} {method:?}");
                assert!(!outcome.converged(), "{context}: {}", outcome.objective);
            }
        }
    }
}

/// These have a limit, or a minimum far away.
#[test]
fn a_distant_optimum_is_no_fall_for_ever() {
    for distance in [1e5, 1e7] {
        let mut problem = Problem::new("distant", &[0.0, 1.0], 0.0, move |x| {
            (x[0] / distance - 1.0).powi(2) + x[1].powi(2)
        });
        let outcome = run(&mut problem, Method::InteriorPoint);
        assert_eq!(outcome.status, Status::Converged, "{distance:e}");
    }
    let mut tail = Problem::new("tail", &[1.0], 0.0, |x| 1.0 / x[0]).all_within(0.1, INF);
    let outcome = run(&mut tail, Method::InteriorPoint);
    assert_eq!(outcome.status, Status::Converged);
}

#[test]
fn at_the_edge_of_an_undefined_region_a_run_ends_early() {
    for edge in [0.25, 1.0, 1.75] {
        for method in [Method::InteriorPoint, Method::TrustRegion] {
            let mut problem = Problem::new("edge", &[0.0, 0.0], 0.0, move |x| {
                let f = (x[0] - 2.0).powi(2) + (x[1] - 1.0).powi(2);
                if x[0].value > edge { f * f64::NAN } else { f }
            });
            let outcome = run(&mut problem, method);
            let context = format!("{edge} {method:?}: {:?}", outcome.status);
            assert_eq!(outcome.status, Status::Stalled, "{context}");
            assert!(outcome.counts.evaluations < 1500, "{context}");
        }
    }
}
