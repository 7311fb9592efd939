//! A run repeats itself exactly, and continues from what an earlier one saved.

mod optimiser_problems;
#[path = "optimiser_problems/recorded.rs"]
mod recorded;

use std::ops::ControlFlow;

use flexbody::optimiser::{Method, Observer, Options, Row, SavedState, Silent, resume, solve};
use optimiser_problems::hock_schittkowski;
use optimiser_problems::problem::Problem;
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

/// A history of evaluations can stand in for the functions only if the designs are the same to the
/// last bit.
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

/// A run resumed from an optimum confirms it at once.
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
                again.counts.evaluations <= 3,
                "{name} {method:?}: {:?}",
                again.counts
            );
        }
    }
}
