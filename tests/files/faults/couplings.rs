//! Faults of couplings and bushings.

use super::faults;
use serde_json::Value;

/// Two gears and a rack, without a fault.
fn machine() -> Value {
    json!({
        "version": 1, "name": "gears",
        "bodies": {
            "a": {"mass": 1, "inertia": {"xx": 1, "yy": 1, "zz": 1}},
            "b": {"mass": 1, "inertia": {"xx": 1, "yy": 1, "zz": 1}, "place": {"at": [0.3, 0, 0]}},
            "rack": {"mass": 1, "inertia": {"xx": 1, "yy": 1, "zz": 1}, "place": {"at": [0, -0.1, 0]}}
        },
        "joints": {
            "a": {"revolute": {"between": ["a", "ground"], "at": [0, 0, 0], "axis": [0, 0, 1]}},
            "b": {"revolute": {"between": ["b", "ground"], "at": [0.3, 0, 0], "axis": [0, 0, 1]}},
            "rail": {"prismatic": {"between": ["rack", "ground"], "at": [0, -0.1, 0], "axis": [1, 0, 0]}}
        },
        "couplings": {"mesh": {"gear": {"gears": ["a", "b"], "teeth": [20, 40]}}},
        "simulation": {"duration": 1},
        "functions": {"a": {"final": {"angle": {"joint": "a"}}}}
    })
}

fn assert_fault(document: &Value, expected: &[&str]) {
    let text = faults(&document.to_string());
    for part in expected {
        assert!(text.contains(part), "{part}:\n{text}");
    }
}

#[test]
fn couplings_with_faults() {
    let cases = [
        (
            json!({"gear": {"gears": ["a", "c"], "teeth": [20, 40]}}),
            "/couplings/mesh/gear/gears/1",
            "found \"c\"",
        ),
        (
            json!({"gear": {"gears": ["a", "ground"], "teeth": [20, 40]}}),
            "/gears/1",
            "which does not move",
        ),
        (
            json!({"gear": {"gears": ["a", "a"], "teeth": [20, 40]}}),
            "/gears/1",
            "\"a\" twice",
        ),
        (
            json!({"gear": {"gears": ["a", "b"]}}),
            "/couplings/mesh/gear",
            "\"teeth\", \"radii\" or \"ratio\"",
        ),
        (
            json!({"gear": {"gears": ["a", "b"], "ratio": 2, "teeth": [20, 40]}}),
            "/gear/ratio",
            "one of them",
        ),
        (
            json!({"gear": {"gears": ["a", "rack"], "ratio": 2}}),
            "/gears/1",
            "prismatic joint",
        ),
        (
            json!({"gear": {"gears": ["a", "b"], "ratio": 2, "carrier": "d"}}),
            "/gear/carrier",
            "found \"d\"",
        ),
        (
            json!({"bevel": {"gears": ["a", "b"], "at": [0.1, 0.2, 0]}}),
            "/bevel/at",
            "teeth move apart",
        ),
        (
            json!({"bevel": {"gears": ["a", "b"], "at": [0.3, 0, 0.1]}}),
            "/bevel/at",
            "a place on an axis",
        ),
        (
            json!({"rack_and_pinion": {"rack": "rack", "pinion": "a", "at": [0.1, -0.1, 0]}}),
            "/at",
            "teeth move apart",
        ),
        (
            json!({"rack_and_pinion": {"rack": "b", "pinion": "a", "at": [0, -0.1, 0]}}),
            "/rack",
            "revolute joint",
        ),
        (
            json!({"screw": {"joint": "rail", "lead": 0.1}}),
            "/screw/joint",
            "cylindrical",
        ),
        (
            json!({"relation": {"terms": [{"joint": "a", "turn": 1}, {"joint": "b"}]}}),
            "/terms/1",
            "without factor",
        ),
        (
            json!({"relation": {"terms": [{"joint": "a", "turn": 1}, {"joint": "a", "turn": 2}]}}),
            "/terms/1/joint",
            "second time",
        ),
        (
            json!({"relation": {"terms": [{"joint": "a", "turn": 1}, {"joint": "rail", "turn": 2}]}}),
            "/terms/1/joint",
            "prismatic",
        ),
        (
            json!({"relation": {"terms": [{"joint": "a", "turn": 1}, {"joint": "b", "turn": 0}]}}),
            "/terms/1/turn",
            "not zero",
        ),
    ];
    for (coupling, place, found) in cases {
        let mut document = machine();
        document["couplings"]["mesh"] = coupling;
        assert_fault(&document, &[place, found]);
    }
    let mut skew = machine();
    skew["joints"]["b"]["revolute"]["axis"] = json!([1, 0, 0]);
    assert_fault(&skew, &["/gears", "axes at an angle", "bevel"]);
    let mut welded = machine();
    welded["joints"]["b"] = json!({"weld": {"between": ["b", "ground"], "at": [0.3, 0, 0]}});
    assert_fault(&welded, &["/gears/1", "welded to \"ground\""]);
    // A planet on an arm: neither ground nor the arm is joined to both.
    let mut planet = machine();
    planet["joints"]["b"]["revolute"]["between"] = json!(["b", "rack"]);
    assert_fault(
        &planet,
        &["/couplings/mesh/gear", "no \"carrier\" of \"a\" and \"b\""],
    );
    let mut function = machine();
    function["functions"]["a"] = json!({"final": {"coupling_reaction": {"coupling": "mess"}}});
    assert_fault(
        &function,
        &["coupling_reaction/coupling", "did you mean \"mesh\"?"],
    );
    function["functions"]["a"] =
        json!({"final": {"coupling_reaction": {"coupling": "mesh", "on": "rack"}}});
    assert_fault(
        &function,
        &["coupling_reaction/on", "found \"rack\"", "a, b"],
    );
}

#[test]
fn bushings_with_faults() {
    let mut document = machine();
    let mut rows = vec![vec![0; 6]; 6];
    rows[0][4] = 3;
    document["loads"] = json!({"mount": {"bushing": {"joint": "a", "stiffness": {"rows": rows}}}});
    assert_fault(
        &document,
        &["/loads/mount/bushing/stiffness/rows/4/0", "symmetric"],
    );
    document["loads"] = json!({"mount": {"bushing": {"joint": "c", "stiffness": {"diagonal": [1, 1, 1, 1, 1, 1]}}}});
    assert_fault(&document, &["/loads/mount/bushing/joint", "found \"c\""]);
    let mut free = machine();
    free["joints"]["c"] = json!({"free": {"between": ["a", "b"], "at": [0, 0, 0], "axis": [1, 0, 0], "cross": [2, 0, 0]}});
    assert_fault(&free, &["/joints/c/free/cross", "along the other"]);
}
