//! Motions and files that exceed the memory, and optimisations with little memory.

use crate::program::{HAMMER, expect, json, optimum, read, scratch};
use serde_json::{Value, json};
use std::path::Path;

fn write(directory: &Path, document: &Value) {
    std::fs::write(directory.join("scene.json"), document.to_string()).expect("written");
}

fn hammer() -> Value {
    json(&read(Path::new(HAMMER)))
}

#[test]
fn an_optimum_in_little_memory_is_the_same() {
    let at = scratch();
    expect(0, at.path(), &[HAMMER, "--quiet", "--output", "much"]);
    let ran = expect(
        0,
        at.path(),
        &[HAMMER, "--memory", "40kB", "--output", "little"],
    );
    assert!(ran.out.contains("recomputed for gradients"), "{}", ran.out);
    let [much, little] = ["much", "little"].map(|own| optimum(&at.path().join(own)));
    for key in ["objective", "constraints", "design", "multipliers", "kkt"] {
        assert!(much[key].is_object(), "{key}");
        assert_eq!(much[key], little[key], "{key}");
    }
    assert_eq!(much["counts"]["recomputed_steps"], 0);
    let again = little["counts"]["recomputed_steps"].as_u64();
    assert!(again.is_some_and(|steps| steps > 0), "{again:?}");
    let told = expect(
        0,
        at.path(),
        &["explain", HAMMER, "--memory", "40kB", "--json"],
    );
    let told = json(&told.out);
    assert!(told["recomputed"].as_u64() > Some(0), "{told}");
    assert!(told["stretch"].is_null());
}

/// A pendulum with a table of torques and a spring, by Radau IIA with steps that follow a tolerance.
fn wound_pendulum(tolerance: f64) -> Value {
    let joint = json!({"between": ["p", "ground"], "at": [0, 0, 0], "axis": [0, 0, 1],
        "start": {"turn": {"angle": -0.24, "rate": 3.6}}});
    let torque = json!({"table": {"times": [0, 0.12, 0.34, 1.46], "values": [-43, 5, -58, -21],
        "interpolation": "linear"}});
    json!({
        "version": 1, "name": "scene", "gravity": [0, -9.81, 0],
        "bodies": {"p": {"mass": 9.5, "inertia": {"xx": 0.3, "yy": 0.3, "zz": 0.3},
            "points": {"a": [-0.7, 0, 0]}, "place": {"put": "a", "at": [0, 0, 0]}}},
        "joints": {"j": {"revolute": joint}},
        "loads": {
            "spring": {"torsion_spring": {"joint": "j", "stiffness": 20, "damping": 0.25}},
            "torque": {"torque": {"body": "p", "direction": [0, 0, 1], "magnitude": torque}}
        },
        "simulation": {"duration": 1.46, "tolerance": tolerance, "method": {"radau": {"stages": 3}}},
        "functions": {
            "energy": {"integral": {"energy": "kinetic"}},
            "rate": {"mean_square": {"of": {"angle_rate": {"joint": "j"}}, "during": [0.05, 0.36]}},
            "fast": {"ks": {"rho": 40, "of": {"speed": {"body": "p"}}}}
        },
        "variables": {
            "m": {"path": "/bodies/p/mass", "lower": 1, "upper": 90},
            "k": {"path": "/loads/spring/torsion_spring/stiffness", "lower": 2, "upper": 200}
        }
    })
}

/// The adjoint and the complex step are compared on one motion, whose steps are stored whatever the memory of gradients.
#[test]
fn gradients_are_checked_on_one_motion_in_any_memory() {
    let at = scratch();
    write(at.path(), &wound_pendulum(1e-7));
    for memory in ["1KB", "100MB"] {
        let told = expect(0, at.path(), &["check", "scene.json", "--memory", memory]);
        assert!(told.out.contains("0 above"), "{memory}: {}", told.out);
    }
}

/// The error of a true maximum contains that of the steps.
#[test]
fn a_true_maximum_has_the_error_of_its_motion() {
    let at = scratch();
    let maximum = |tolerance: f64| {
        write(at.path(), &wound_pendulum(tolerance));
        let told = expect(
            0,
            at.path(),
            &["simulate", "scene.json", "--json", "--error"],
        );
        let all = json(&told.out);
        let own = &all["functions"]["fast"]["true_maximum"];
        ["value", "error"].map(|key| own[key].as_f64().expect("a number"))
    };
    let [exact, _] = maximum(1e-11);
    for tolerance in [1e-4, 1e-6] {
        let [value, error] = maximum(tolerance);
        let off = (value - exact).abs();
        assert!(
            off > 1e-12 && error > 0.3 * off && error < 1e-3,
            "{off} {error}"
        );
    }
}

/// With any memory, a gradient repeats each step at most twenty times, and has the same value.
#[test]
fn any_memory_bounds_the_work() {
    let at = scratch();
    for (steps, method) in [
        (300, json!("dop853")),
        (1200, json!("dop853")),
        (300, json!({"radau": {"stages": 3}})),
        (700, json!({"bdf": {"order": 2}})),
    ] {
        let mut document = hammer();
        document["simulation"]["steps"] = json!(steps);
        document["simulation"]["method"] = method;
        document["optimiser"] = json!({"iterations": 1});
        write(at.path(), &document);
        let of = |memory: &[&str], to: &str| {
            let own = [&["scene.json", "--quiet", "--output", to][..], memory].concat();
            expect(1, at.path(), &own);
            optimum(&at.path().join(to))
        };
        let much = of(&[], "much");
        for memory in ["1B", "700B", "9kB"] {
            let little = of(&["--memory", memory], "little");
            assert_eq!(little["design"], much["design"], "{memory}");
            assert_eq!(little["multipliers"], much["multipliers"], "{memory}");
            let counts = &little["counts"];
            let again = counts["recomputed_steps"].as_u64().expect("a number");
            let gradients = counts["gradient_evaluations"].as_u64().expect("a number");
            assert!(again > 0, "{memory}");
            assert!(
                again <= 20 * steps * gradients,
                "{memory}: {again} {gradients}"
            );
        }
    }
}

#[test]
fn sizes_are_understood_or_refused() {
    let at = scratch();
    for size in ["much", "0", "1e3", "5 parsecs"] {
        let ran = expect(2, at.path(), &["simulate", HAMMER, "--memory", size]);
        assert!(ran.err.contains("500MB or 2GiB"), "{}", ran.err);
    }
    expect(0, at.path(), &["simulate", HAMMER, "--memory", "2 GiB"]);
}

/// The explanation of a motion of a million steps uses its first part.
#[test]
fn a_long_motion_is_explained_from_its_first_stretch() {
    let at = scratch();
    let mut document = hammer();
    document["simulation"]["steps"] = json!(1_000_000);
    write(at.path(), &document);
    let told = expect(
        0,
        at.path(),
        &["explain", "scene.json", "--memory", "100MB", "--json"],
    );
    let told = json(&told.out);
    assert_eq!(told["steps"], 1_000_000);
    let stretch = told["stretch"].as_f64().expect("a stretch");
    assert!(stretch > 0.0 && stretch <= 0.02, "{stretch}");
    assert!(told["tape_bytes"].as_u64() <= Some(100_000_000), "{told}");
    assert!(told["recomputed"].as_u64() >= Some(800_000), "{told}");
    let told = expect(
        0,
        at.path(),
        &["explain", "scene.json", "--memory", "100MB"],
    );
    assert!(
        told.out.contains("estimated from the first"),
        "{}",
        told.out
    );
}

/// A motion that exceeds the memory of any machine is rejected before any allocation.
#[test]
fn a_motion_larger_than_memory_is_refused() {
    let at = scratch();
    let mut document = hammer();
    let bodies = document["bodies"].as_object_mut().expect("bodies");
    for i in 0..1000 {
        let body = json!({"shape": {"sphere": {"radius": 0.1}}, "mass": 1,
                          "place": {"at": [0, 0, 10 + i]}});
        bodies.insert(format!("ball {i}"), body);
    }
    document["simulation"]["steps"] = json!(10_000_000);
    document["simulation"]["samples"] = json!(10_000_000);
    write(at.path(), &document);
    for command in ["simulate", "check", "scene.json"] {
        let arguments = [&[command][..], &["scene.json"]].concat();
        let arguments = &arguments[..if command == "scene.json" { 1 } else { 2 }];
        let ran = expect(3, at.path(), arguments);
        for word in ["TB of memory", "10000001 samples", "/simulation/samples"] {
            assert!(ran.err.contains(word), "{command}: {}", ran.err);
        }
    }
    let told = expect(0, at.path(), &["explain", "scene.json"]);
    assert!(told.out.contains("TB of memory"), "{}", told.out);
}

/// A list that is too long is rejected at the place where it becomes so.
#[test]
fn an_endless_list_is_refused() {
    let at = scratch();
    let text = format!("{{\n  \"bodies\": [{}1]}}", "1,".repeat(1_500_000));
    std::fs::write(at.path().join("scene.json"), text).expect("written");
    for command in ["simulate", "explain", "check"] {
        let ran = expect(2, at.path(), &[command, "scene.json"]);
        for word in ["scene.json:2:2000013", "more than 1000000 entries"] {
            assert!(ran.err.contains(word), "{}", ran.err);
        }
        assert!(ran.err.len() < 1000);
    }
}
