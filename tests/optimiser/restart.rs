//! A run repeats itself exactly, and continues from the saved state of an earlier one.

use crate::problems;
use crate::problems::recorded;

use std::ops::ControlFlow;

use flexbody_optimiser::{
    Method, Observer, Options, Row, SavedState, Silent, Status, resume, solve,
};
use problems::hock_schittkowski;
use problems::problem::Problem;
use recorded::Recorded;

const METHODS: [Method; 3] = [Method::InteriorPoint, Method::TrustRegion, Method::Auto];
const NAMES: [&str; 9] = [
    "HS1", "HS25", "HS43", "HS71", "HS77", "HS100", "HS104", "HS111", "HS117",
];

fn problem(name: &str) -> Problem {
    hock_schittkowski()
        .into_iter()
        .find(|p| p.name == name)
        .expect("the problem is coded")
}

/// A log of evaluations can replace the functions only if the designs are the same to the last bit.
#[test]
fn two_runs_ask_for_the_same_designs() {
    for method in METHODS {
        for name in NAMES {
            let options = Options {
                method,
                ..Options::default()
            };
            let designs = || {
                let mut program = Recorded {
                    inner: problem(name),
                    designs: Vec::new(),
                };
                let _ = solve(&mut program, &options, &mut Silent);
                program.designs
            };
            let (first, second) = (designs(), designs());
            assert!(first.len() > 5, "{name} {method:?}");
            assert_eq!(first, second, "{name} {method:?}");
        }
    }
}

struct StopAfter(usize);

impl Observer for StopAfter {
    fn iteration(&mut self, row: &Row<'_>) -> ControlFlow<()> {
        if row.iteration < self.0 {
            ControlFlow::Continue(())
        } else {
            ControlFlow::Break(())
        }
    }
}

/// The state is stored as text and read back, as between two processes.
#[test]
fn interrupted_runs_reach_the_same_optimum() {
    for method in METHODS {
        for name in NAMES {
            let options = Options {
                method,
                ..Options::default()
            };
            let best = problem(name).best;
            let whole = solve(&mut problem(name), &options, &mut Silent);
            for stop in 1..whole.counts.iterations {
                let part = solve(&mut problem(name), &options, &mut StopAfter(stop));
                let state = part.state.expect("an interrupted run has a state");
                let text = serde_json::to_string(&state).expect("the state is finite");
                let read: SavedState = serde_json::from_str(&text).expect("it was just written");
                assert_eq!(read, state, "{name} {method:?}");
                let end = resume(&mut problem(name), &options, &mut Silent, &read);
                let context = format!("{name} {method:?} stopped after {stop}: {:?}", end.status);
                assert!(end.converged(), "{context}");
                let error = (end.objective - best).abs();
                let size = best.abs().max(1.0);
                assert!(error <= 1e-6 * size, "{context} {}", end.objective);
                let work = part.counts.evaluations + end.counts.evaluations;
                let limit = 2 * whole.counts.evaluations + 10;
                assert!(work <= limit, "{context}: {work} of {limit} evaluations");
            }
        }
    }
}

/// A run resumed from an optimum confirms it at once. The gradients of HS25 are lost in rounding there:
/// a line search must fail.
#[test]
fn optimum_is_confirmed_at_once() {
    for method in METHODS {
        for name in NAMES {
            let options = Options {
                method,
                ..Options::default()
            };
            let whole = solve(&mut problem(name), &options, &mut Silent);
            let state = whole.state.expect("a run that ended has a state");
            let again = resume(&mut problem(name), &options, &mut Silent, &state);
            assert!(again.converged(), "{name} {method:?}: {:?}", again.status);
            assert!(
                again.counts.evaluations <= if name == "HS25" { 70 } else { 3 },
                "{name} {method:?}: {:?}",
                again.counts
            );
        }
    }
}

fn rosenbrock(factor: f64) -> Problem {
    Problem::new("Rosenbrock", &[-1.2, 1.0], 0.0, move |x| {
        factor * (100.0 * (x[1] - x[0].powi(2)).powi(2) + (1.0 - x[0]).powi(2))
    })
}

/// The gradients of an objective multiplied by 1e8 must not make those of the objective look small.
#[test]
fn the_state_of_another_objective_claims_nothing() {
    for method in METHODS {
        let options = Options {
            method,
            ..Options::default()
        };
        let whole = solve(&mut rosenbrock(1e8), &options, &mut Silent);
        for stop in 1..whole.counts.iterations {
            let part = solve(&mut rosenbrock(1e8), &options, &mut StopAfter(stop));
            let state = part.state.expect("an interrupted run has a state");
            for factor in [1.0, 1e-4, 1e4] {
                let end = resume(&mut rosenbrock(factor), &options, &mut Silent, &state);
                let context = format!("{factor:e} {method:?} {stop}: {:?}", end.status);
                assert!(end.converged(), "{context}");
                let value = end.objective / factor;
                assert!(value <= 1e-9, "{context} {value:e}");
            }
        }
    }
}

/// Damaged states are rejected by name, before any evaluation.
#[test]
fn damaged_states_are_refused_by_name() {
    let options = Options::default();
    let whole = solve(&mut problem("HS71"), &options, &mut StopAfter(5));
    let state = serde_json::to_value(whole.state.expect("it has a state")).expect("is finite");
    let damages: [(&str, serde_json::Value, &str); 10] = [
        (
            "/multipliers/lower_bounds",
            serde_json::json!([1.0]),
            "lower bounds",
        ),
        (
            "/multipliers/upper_bounds",
            serde_json::json!([]),
            "upper bounds",
        ),
        ("/multipliers/constraints", serde_json::json!([1.0]), "rows"),
        (
            "/scaling/variables",
            serde_json::json!([1.0]),
            "scales of variables",
        ),
        ("/scaling/constraints/0", serde_json::json!(-1.0), "scale"),
        (
            "/scaling/objective",
            serde_json::json!(0.0),
            "scale of the objective",
        ),
        (
            "/quasi_newton/pairs/0/s",
            serde_json::json!([1.0]),
            "pair 0",
        ),
        (
            "/quasi_newton/sigma",
            serde_json::json!(-1.0),
            "quasi-Newton",
        ),
        ("/barrier", serde_json::json!(-1.0), "barrier"),
        ("/radius", serde_json::json!(0.0), "radius"),
    ];
    for (place, value, part) in damages {
        let mut damaged = state.clone();
        *damaged.pointer_mut(place).expect(place) = value;
        let damaged: SavedState = serde_json::from_value(damaged).expect("is read");
        let fault = damaged.fault(4, 2).expect(place);
        assert!(fault.contains(part), "{place}: {fault}");
        for method in METHODS {
            let options = Options {
                method,
                ..Options::default()
            };
            let end = resume(&mut problem("HS71"), &options, &mut Silent, &damaged);
            match end.status {
                Status::IllPosed { what } => assert!(what.contains(part), "{what}"),
                other => panic!("{place}: {other:?}"),
            }
            assert_eq!(end.counts.evaluations, 0);
        }
    }
    let mut nowhere: SavedState = serde_json::from_value(state).expect("is read");
    assert_eq!(nowhere.fault(4, 2), None);
    nowhere.x[0] = f64::NAN;
    assert!(nowhere.fault(4, 2).is_some());
    nowhere.x[0] = 1.0;
    nowhere.barrier = f64::INFINITY;
    assert!(nowhere.fault(4, 2).is_some());
}
