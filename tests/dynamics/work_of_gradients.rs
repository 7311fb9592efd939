//! What no function sees of a motion is left out of the backward march: instants that weigh nothing, and
//! the steps behind the last that weighs something.

use flexbody::driver::Evaluated;
use flexbody::problem::Problem;
use serde_json::{Value, json};
use std::path::Path;

/// The trebuchet's start with a function, and the factorisations of its gradient beside those of its
/// run.
fn work(function: Value) -> [usize; 2] {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("problems/trebuchet.json");
    let text = std::fs::read_to_string(path).expect("the problem file");
    let mut document: Value = serde_json::from_str(&text).expect("JSON");
    document["functions"]["other"] = function;
    let problem = Problem::parse(&document.to_string(), "trebuchet.json", &[])
        .unwrap_or_else(|faults| panic!("{faults}"));
    let names = &problem.function_names;
    let other = names.iter().position(|name| name == "other");
    let at = Evaluated::new(&problem, &problem.start()).expect("runs");
    let which = [other.expect("the function")];
    let (_, counts) = at.gradients(&problem, &which).expect("regular");
    assert_eq!(counts.steps, at.run.grid.steps());
    // A step forwards factorises twelve times; choosing the cells of sums makes the motion again.
    [counts.factorisations, 12 * at.run.grid.steps()]
}

/// The stone has left long before the end of the motion; what is summed over all of it needs all steps.
#[test]
fn gradients_begin_where_a_function_ends() {
    let range = json!({"body": "stone", "ground": -10,
        "gate": {"body": "sling", "axis": [0, 0, 1], "above": -3.641592653589793, "width": 0.15}});
    let [backwards, forwards] = work(json!({"ks": {"rho": 0.3, "of": {"range": range}}}));
    assert!(2 * backwards < forwards, "{backwards} of {forwards}");
    let speed = json!({"speed": {"body": "stone"}});
    let [backwards, forwards] = work(json!({"integral": speed}));
    assert!(4 * backwards > 3 * forwards, "{backwards} of {forwards}");
}
