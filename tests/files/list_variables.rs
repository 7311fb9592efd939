//! Design variables that are the numbers of a list.

use crate::reference::documents::problem as parsed;
use crate::reference::gradients::gradients_are_exact;
use flexbody_problem::Problem;
use serde_json::Value;

/// A sledge that a force by a table pushes, against another one.
fn sledge(variables: Value) -> Value {
    let push = |values: [f64; 4]| {
        json!({"force": {"body": "sledge", "direction": [1, 0, 0],
            "magnitude": {"table": {"times": [0, 0.3, 0.6, 1], "values": values, "interpolation": "linear"}}}})
    };
    json!({
        "version": 1, "name": "sledge",
        "bodies": {"sledge": {"mass": 2, "inertia": {"xx": 1, "yy": 1, "zz": 1}}},
        "joints": {"rail": {"prismatic": {"between": ["sledge", "ground"], "at": [0, 0, 0], "axis": [1, 0, 0]}}},
        "loads": {"push": push([1.0, 2.0, 3.0, 1.5]), "other": push([1.0, 2.0, 3.0, 1.5])},
        "simulation": {"duration": 1},
        "functions": {"way": {"final": {"slide": {"joint": "rail"}}}},
        "variables": variables
    })
}

const NODES: &str = "/loads/push/force/magnitude/table/values";
const OTHERS: &str = "/loads/other/force/magnitude/table/values";

/// They are those that are written one by one, with exact derivatives; lists are shared number by number.
#[test]
fn each_number_of_a_list_is_a_variable() {
    let of_list = parsed(&sledge(
        json!({"f": {"path": NODES, "lower": -4, "upper": 5}}),
    ));
    let one = |k: usize| json!({"path": format!("{NODES}/{k}"), "lower": -4, "upper": 5});
    let one_by_one = parsed(&sledge(
        json!({"f[0]": one(0), "f[1]": one(1), "f[2]": one(2), "f[3]": one(3)}),
    ));
    assert_eq!(of_list.variables, one_by_one.variables);
    assert_eq!(of_list.start(), [1.0, 2.0, 3.0, 1.5]);
    gradients_are_exact(&of_list, &json!("list"));
    let shared = parsed(&sledge(json!({"f": {"paths": [NODES, OTHERS]}})));
    assert_eq!(
        shared.variables[2].paths,
        [format!("{NODES}/2"), format!("{OTHERS}/2")]
    );
    gradients_are_exact(&shared, &json!("lists"));
}

#[test]
fn what_lists_may_not_be_is_told() {
    let told = |variables: Value| {
        Problem::parse(&sledge(variables).to_string(), "sledge.json", &[])
            .expect_err("a fault")
            .to_string()
    };
    let twice = told(json!({"f": {"path": NODES}, "f[1]": {"path": format!("{OTHERS}/1")}}));
    assert!(twice.contains("the name of a number of a list"), "{twice}");
    let lengths = told(json!({"f": {"paths": [NODES, "/gravity"]}}));
    assert!(
        lengths.contains("does not exist") || lengths.contains("which has"),
        "{lengths}"
    );
    let lengths = told(json!({"f": {"paths": [NODES, "/joints/rail/prismatic/axis"]}}));
    assert!(
        lengths.contains("which has 3 numbers, expected a list of 4"),
        "{lengths}"
    );
    let bounds = told(json!({"f": {"path": NODES, "lower": 2}}));
    assert_eq!(bounds.matches("the lower bound 2").count(), 1, "{bounds}");
    let names = told(json!({"f": {"path": "/joints/rail/prismatic/between"}}));
    assert!(names.contains("the path of a physical number"), "{names}");
}
