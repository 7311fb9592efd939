//! The output of `optimize explain`.

use super::*;
use flexbody_driver as driver;

#[test]
fn an_explanation_counts_what_is_left() {
    let problem = load("problems/trebuchet.json", &[]);
    let found = driver::explain(&problem);
    assert_eq!((found.written.velocities, found.written.rows), (30, 21));
    assert_eq!((found.lowered.velocities, found.lowered.rows), (15, 10));
    assert_eq!(found.lowered.stabilised, 50);
    assert!(
        4 * found.lowered.operations < found.written.operations,
        "{found:?}"
    );
    assert_eq!(found.lowered.order.len(), 5);
    assert_eq!(found.functions[0].variables.as_ref().map(Vec::len), Some(6));
    assert!(found.idle_variables.is_empty());
    let loops = driver::explain(&load("problems/benchmarks/four_bars_2.json", &[]));
    let (bodies, closing) = (loops.lowered.order.len(), loops.lowered.closing.len());
    assert_eq!((bodies, closing), (5, 2));
    let spatial = driver::explain(&load("problems/triple_pendulum.json", &[]));
    assert_eq!(spatial.written, spatial.lowered);
    assert!(
        spatial.kept[0].contains("off the normal"),
        "{:?}",
        spatial.kept
    );
}

/// All violated conditions of a reduction are reported, with their variables and the normal.
#[test]
fn an_explanation_tells_all_obstacles() {
    let problem = changed("problems/trebuchet.json", |document| {
        document["gravity"] = json!([0, -9.81, 0]);
        for (name, lower) in [("crosswind", -0.1), ("draught", -0.2)] {
            document["variables"][name] =
                json!({"path": "/gravity/2", "lower": lower, "upper": 0.1});
        }
        document["variables"]["draught"]["path"] = json!("/bodies/stone/velocity/linear/2");
        document["bodies"]["stone"]["velocity"] = json!({"linear": [0, 0, 0]});
    });
    let found = driver::explain(&problem);
    let plane = &found.kept[0];
    for part in [
        "out of the plane across (0.000000, 0.000000, 1.000000)",
        "gravity leaves the plane",
        "\"crosswind\"",
        "the velocity of body \"stone\" leaves the plane",
        "\"draught\"",
    ] {
        assert!(plane.contains(part), "{part}: {plane}");
    }
    assert!(found.kept.len() > 1, "{:?}", found.kept);
}

/// The report gives the reason why the tree of joints is not used, and the effect of merging.
#[test]
fn an_explanation_gives_the_reasons() {
    for (file, part) in [
        (
            "simple_pendulum",
            "body \"bob\" has no inertia of its own about some axis",
        ),
        ("flyball_governor", "digits"),
    ] {
        let found = driver::explain(&load(&format!("problems/benchmarks/{file}.json"), &[]));
        assert!(found.lowered.order.is_empty());
        let reason = found.lowered.sparse.as_ref().expect("a reason");
        assert!(reason.contains(part), "{reason}");
        assert!(found.text().contains(reason));
    }
    for (method, errs) in [("dop853", false), ("radau", true)] {
        let found = driver::explain(&super::welds::carried(|document| {
            document["simulation"]["method"] = match errs {
                true => json!({"radau": {"stages": 3}}),
                false => json!(method),
            };
            document["simulation"]["tolerance"] = json!(1e-7);
        }));
        assert!(found.lowered.sparse.is_none());
        assert_eq!(found.text().contains("not by round-off"), errs, "{method}");
    }
}

/// If the simulation fails, the report has all that does not need it.
#[test]
fn a_start_that_fails_is_explained() {
    let problem = load(
        "problems/trebuchet_release_angle.json",
        &["/simulation/duration=0.1"],
    );
    let found = driver::explain(&problem);
    let failure = found.failure.as_ref().expect("no run");
    assert!(found.text().contains(failure.as_str()), "{failure}");
    assert_eq!(found.integration, None);
    assert_eq!((found.lowered.velocities, found.lowered.rows), (15, 10));
    assert!(found.functions.iter().all(|own| own.variables.is_none()));
    assert!(found.json().expect("JSON").contains("\"failure\""));
}

/// An optimisation reports that reductions did not apply to some of its designs.
#[test]
fn designs_that_ran_as_written_are_told() {
    let blown = |wind: f64| {
        parse(&json!({
            "version": 1, "name": "wind", "gravity": [0, -9.81, wind],
            "bodies": {"ball": {"shape": {"sphere": {"radius": 0.1}}, "mass": 1,
                "velocity": {"linear": [3, 0, 0]}}},
            "simulation": {"duration": 1, "steps": 20},
            "functions": {"x": {"final": {"position": {"body": "ball", "direction": [1, 0, 1]}}}},
            "variables": {"pull": {"path": "/gravity/1", "lower": -10, "upper": -9},
                "speed": {"path": "/bodies/ball/velocity/linear/0", "lower": 1, "upper": 4}},
            "objective": {"maximise": "x"}
        }))
    };
    let run = |problem: &Problem| {
        let go_on = &mut |_: &_| std::ops::ControlFlow::Continue(());
        let log = driver::KnownEvaluations::default();
        let done = driver::optimise(problem, "", None, log, go_on).expect("an objective");
        done.optimum.warnings
    };
    let told = |warnings: &[String]| warnings.iter().any(|own| own.contains("ran without it"));
    let mut problem = blown(0.5);
    assert!(!is_planar(&problem) && !told(&run(&problem)));
    // The reductions without the wind.
    let still = blown(0.0);
    assert!(is_planar(&still) && !told(&run(&still)));
    problem.lowering = still.lowering;
    let warnings = run(&problem);
    assert!(told(&warnings), "{warnings:?}");
}
