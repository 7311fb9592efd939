//! Closed loops that are not stable are told, also where what grows does not oscillate and has no damping ratio.

use super::machines_at_rest::notes_of;
use crate::reference::documents::{extended, faults_say, problem as parsed, values};
use serde_json::{Map, Value};

/// Slides of 1 kg, each with its controller.
fn slides(analysis: &str, controllers: &[Value]) -> Value {
    let [mut bodies, mut joints, mut loads] = [(); 3].map(|()| Map::new());
    for (k, own) in controllers.iter().enumerate() {
        let [body, joint] = ["mass", "slide"].map(|name| format!("{name} {k}"));
        let at = json!([0, 0, k]);
        bodies.insert(
            body.clone(),
            json!({"mass": 1, "inertia": {"xx": 1, "yy": 1, "zz": 1}, "place": {"at": at}}),
        );
        let between = json!({"between": [body, "ground"], "at": at, "axis": [1, 0, 0]});
        joints.insert(joint.clone(), json!({"prismatic": between}));
        let controller = extended(json!({"joint": joint}), own);
        loads.insert(format!("control {k}"), json!({"controller": controller}));
    }
    json!({
        "version": 1, "name": "slides", "gravity": [0, 0, 0], "analysis": analysis,
        "bodies": bodies, "joints": joints, "loads": loads
    })
}

/// s² − 3 s + 1 = 0 beside a slide that is damped: nothing oscillates in the first loop.
#[test]
fn a_growth_without_an_oscillation_is_told() {
    let controllers = [
        json!({"proportional": 1, "derivative": -3}),
        json!({"proportional": 100, "derivative": 1}),
    ];
    let growth = f64::midpoint(3.0, 5.0_f64.sqrt());
    let told = format!("grows by a factor of e in {:.1e} s", 1.0 / growth);
    for order in [[0, 1], [1, 0]] {
        let own = order.map(|k| controllers[k].clone());
        let mut file = slides("modes", &own);
        let problem = parsed(&file);
        let modes = problem.modes_of_machine(&problem.start(), (2, None));
        let found = modes.expect("modes").growth.expect("a growth");
        assert!((found - growth).abs() < 1e-9 * growth, "{found} {growth}");
        file["functions"] = json!({"z": {"damping_ratio": {"mode": 1}}});
        faults_say(&file, &["/functions", "it is not stable", &told]);
        let notes = notes_of(&slides("rest", &own));
        assert!(notes.iter().any(|note| note.contains(&told)), "{notes:?}");
    }
}

/// A damping ratio tells an oscillation that grows: s² − 0.2 s + 1 = 0. So does a note.
#[test]
fn an_oscillation_that_grows_has_its_damping_ratio() {
    let mut file = slides("rest", &[json!({"proportional": 1, "derivative": -0.2})]);
    file["functions"] = json!({"z": {"damping_ratio": {"mode": 1}}});
    let found = values(&file)[0];
    assert!((found + 0.1).abs() < 1e-9, "{found}");
    let notes = notes_of(&file);
    let told = format!("grows by a factor of e in {:.1e} s", 10.0);
    assert!(notes.iter().any(|note| note.contains(&told)), "{notes:?}");
}

/// With a negative gain of the integral, s³ + s² + s + k = 0 has a real root that grows beside an oscillation that decays.
#[test]
fn a_wrong_sign_of_an_integral_is_told() {
    let loop_of = |integral: f64| {
        let own = json!({"proportional": 1, "derivative": 1, "integral": integral});
        let mut file = slides("rest", &[own]);
        file["functions"] = json!({"z": {"damping_ratio": {"mode": 1}}});
        file
    };
    // s = −1/2 gives k = 3/8, and the others s² + s/2 + 3/4 = 0.
    let found = values(&loop_of(0.375))[0];
    let expected = 0.25 / 0.75_f64.sqrt();
    assert!((found - expected).abs() < 1e-9, "{found} {expected}");
    faults_say(&loop_of(-0.1), &["/functions", "it is not stable"]);
}

/// A lag does not make neutral what its controller pushes away.
#[test]
fn what_a_controller_pushes_away_is_not_neutral() {
    let lag = json!({"proportional": -1, "derivative": 1, "motor": {"lag": 0.1}});
    let notes = notes_of(&slides("rest", &[lag]));
    let of_rest: Vec<&String> = (notes.iter())
        .filter(|note| note.contains("the rest is"))
        .collect();
    assert!(
        of_rest.len() == 1 && of_rest[0].contains("not stable"),
        "{notes:?}"
    );
}

/// s² = 1 grows by 1/s, near which rates are sought; s² + s + 100 = 0 has the damping ratio 1/20.
#[test]
fn a_growth_at_the_shift_of_the_search_hides_nothing() {
    let controllers = [
        json!({"proportional": -1, "derivative": 0}),
        json!({"proportional": 100, "derivative": 1}),
    ];
    let mut file = slides("motion", &controllers);
    file["simulation"] = json!({"duration": 0.1});
    file["functions"] = json!({"z": {"final": {"damping_ratio": {"mode": 1}}}});
    let found = values(&file)[0];
    assert!((found - 0.05).abs() < 1e-9, "{found}");
}
