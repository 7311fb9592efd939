//! The backward march skips parts of a motion that affect no function: instants with negligible
//! weight, and the steps after the last instant with weight.

use flexbody_driver::Evaluated;
use flexbody_problem::Problem;
use serde_json::Value;
use std::path::Path;

/// The trebuchet's start with a function: factorisations of its gradient and of its run.
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
    // A forward step has twelve factorisations. The choice of cells for sums repeats the motion.
    [counts.factorisations, 12 * at.run.grid.steps()]
}

/// The stone is released long before the end of the motion. A sum over the whole motion needs all
/// steps.
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
