//! Modes that are followed by their shapes while the design changes: of machines at rest, damped, in steady rotation, and of
//! structures; and what has no such mode.

use crate::reference::documents::problem as parsed;
use crate::reference::gradients::gradients_are_exact;
use flexbody_driver::{Simulated, check};
use flexbody_problem::Problem;
use serde_json::Value;
use std::f64::consts::PI;

fn at(problem: &Problem, x: &[f64]) -> Vec<f64> {
    let found = Simulated::of(problem, x).unwrap_or_else(|failure| panic!("{failure}"));
    (0..problem.function_names.len())
        .map(|f| found.value(f))
        .collect()
}

fn assert_near(found: f64, expected: f64, part: f64) {
    let off = (found - expected).abs();
    assert!(off <= part * expected.abs(), "{found} {expected}");
}

/// Carts of 1 kg on springs of their own, with a damper each. The stiffness of the first is a variable.
fn carts(stiffness: &[f64], damped: bool, follow: bool) -> Value {
    let mut file = json!({
        "version": 1, "name": "carts", "analysis": "rest", "gravity": [0, -9.81, 0],
        "bodies": {}, "joints": {}, "loads": {},
        "functions": {
            "f": {"frequency": {"mode": 1, "damped": damped, "follow": follow}},
            "z": {"damping_ratio": {"mode": 1, "follow": follow}}
        },
        "variables": {"k": {"path": "/loads/s0/spring/stiffness", "lower": 1, "upper": 1e6}}
    });
    for (i, k) in stiffness.iter().enumerate() {
        let (cart, side) = (format!("c{i}"), i as f64);
        file["bodies"][&cart] = json!({
            "shape": {"box": {"size": [0.2, 0.1, 0.1]}}, "mass": 1, "place": {"at": [1, 0, side]}
        });
        file["joints"][format!("j{i}")] =
            json!({"prismatic": {"between": [cart, "ground"], "at": cart, "axis": [1, 0, 0]}});
        file["loads"][format!("s{i}")] = json!({"spring": {
            "between": [cart, "ground"], "at": {"a": [0, 0, 0], "b": [0, 0, side]},
            "rest_length": 1, "stiffness": k, "damping": 0.4 + side
        }});
    }
    file
}

#[test]
fn a_followed_frequency_passes_through_another_one() {
    for damped in [false, true] {
        let problem = parsed(&carts(&[100.0, 400.0], damped, true));
        for k in [100.0, 300.0, 900.0, 5000.0] {
            let damping: f64 = 0.4;
            let whole = k - if damped { damping * damping / 4.0 } else { 0.0 };
            let found = at(&problem, &[k]);
            assert_near(found[0], whole.sqrt() / (2.0 * PI), 1e-10);
            assert_near(found[1], damping / (2.0 * k.sqrt()), 1e-9);
            let derivatives = check(&problem, &[k]).expect("derivatives");
            for own in derivatives {
                assert_near(own.adjoint, own.complex_step, 1e-11);
            }
        }
        // By number the lower one of both is told.
        let problem = parsed(&carts(&[100.0, 400.0], damped, false));
        let lower = at(&problem, &[900.0])[0];
        assert_near(lower, 20.0 / (2.0 * PI), 1e-2);
        gradients_are_exact(
            &parsed(&carts(&[100.0, 400.0], damped, true)),
            &json!(damped),
        );
    }
}

/// The start of the file tells the shape, whatever is asked first.
#[test]
fn the_order_of_designs_does_not_matter() {
    let file = carts(&[100.0, 400.0], false, true);
    let (one, other) = (parsed(&file), parsed(&file));
    let first = [at(&one, &[900.0]), at(&one, &[100.0])];
    let second = [at(&other, &[100.0]), at(&other, &[900.0])];
    assert_eq!(first[0], second[1]);
    assert_eq!(first[1], second[0]);
}

#[test]
fn a_mode_that_is_lost_among_many_is_a_failure() {
    let stiffness: Vec<f64> = (0..14).map(|i| 100.0 * f64::from(i + 1)).collect();
    let problem = parsed(&carts(&stiffness, false, true));
    let failure = match Simulated::of(&problem, &[1e5]) {
        Ok(_) => panic!("it is found"),
        Err(failure) => failure.to_string(),
    };
    assert!(failure.contains("the shape that mode 1 has"), "{failure}");
}

/// A blade on a hub that turns: its bending in and out of the plane of rotation cross where its section changes.
#[test]
fn a_blade_that_turns_keeps_its_mode() {
    let file = json!({
        "version": 1, "name": "blade", "analysis": "modes", "gravity": [0, 0, 0],
        "turning": {"axis": [0, 0, 1], "speed": 20},
        "bodies": {
            "hub": {"mass": 1, "inertia": {"xx": 0.1, "yy": 0.1, "zz": 0.1}},
            "blade": {
                "beam": {
                    "length": 1.0, "section": {"rectangle": {"width": 0.03, "height": 0.02}},
                    "material": {"young": 7e10, "poisson": 0.3, "density": 2700},
                    "modes": {"bending_y": 3, "bending_z": 3, "torsion": 1}
                },
                "place": {"put": "start", "at": [0, 0, 0]}
            }
        },
        "joints": {
            "axle": {"revolute": {"between": ["hub", "ground"], "at": [0, 0, 0], "axis": [0, 0, 1]}},
            "root": {"weld": {"between": ["blade", "hub"], "at": [0, 0, 0]}}
        },
        "drives": {"motor": {"joint": "axle", "turn": {"rate": 20}}},
        "functions": {
            "followed": {"frequency": {"mode": 1, "follow": true}},
            "second": {"frequency": {"mode": 2, "follow": true}},
            "lowest": {"frequency": {"mode": 1}}
        },
        "variables": {"height": {"path": "/bodies/blade/beam/section/rectangle/height", "lower": 0.01, "upper": 0.1}}
    });
    let problem = parsed(&file);
    let thin = at(&problem, &[0.02]);
    let thick = at(&problem, &[0.045]);
    assert_near(thin[0], thin[2], 1e-12);
    // Beyond the crossing the followed one is not the lowest; one of both does not feel the height.
    let changes = [thick[0] / thin[0], thick[1] / thin[1]];
    assert!(
        changes.iter().any(|x| (x - 1.0).abs() < 0.01) && changes.iter().any(|x| *x > 1.8),
        "{thin:?} {thick:?}"
    );
    assert_near(thick[2], thick[0].min(thick[1]), 1e-12);
    for x in [0.02, 0.045] {
        for own in check(&problem, &[x]).expect("derivatives") {
            let size = thick[0] / x;
            assert!(
                (own.adjoint - own.complex_step).abs() < 1e-10 * size,
                "{own:?}"
            );
        }
    }
}

/// The bending of a beam across its height and across its width cross.
#[test]
fn structures_keep_their_modes() {
    let file = json!({
        "version": 1, "name": "beam",
        "materials": {"m": {"young": 2e11, "poisson": 0.3, "density": 7800}},
        "structures": {"p": {
            "mesh": {"straight_beam": {"from": [0, 0, 0], "to": [2, 0, 0], "orientation": [0, 1, 0], "elements": 8}},
            "material": "m", "section": {"rectangle": {"width": 0.05, "height": 0.03}},
            "supports": {"a": {"nodes": ["start"]}}}},
        "functions": {
            "followed": {"frequency": {"mode": 1, "follow": true}},
            "second": {"frequency": {"mode": 2, "follow": true}},
            "lowest": {"frequency": {"mode": 1}}
        },
        "variables": {"height": {"path": "/structures/p/section/rectangle/height", "lower": 0.01, "upper": 0.2}}
    });
    for other in [false, true] {
        let problem = parsed(&file);
        // The start may be asked for later.
        let thick = other.then(|| at(&problem, &[0.08]));
        let thin = at(&problem, &[0.03]);
        let thick = thick.unwrap_or_else(|| at(&problem, &[0.08]));
        assert_near(thin[0], thin[2], 1e-12);
        assert_near(thick[0] / thin[0], 0.08 / 0.03, 2e-2);
        assert_near(thick[1], thin[1], 1e-3);
        assert_near(thick[2], thick[1], 1e-12);
        for x in [0.03, 0.08] {
            for own in check(&problem, &[x]).expect("derivatives") {
                let size = thick[0] / x;
                assert!(
                    (own.adjoint - own.complex_step).abs() < 1e-10 * size,
                    "{own:?}"
                );
            }
        }
    }
}
