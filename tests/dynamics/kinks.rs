//! Loads and drives with kinks in time, where the end of the motion moves: its duration is designed, or
//! it ends at an event. Steps stay on the kinks. Closed forms of a pushed mass, by all methods.

use crate::reference::documents::problem;
use flexbody_driver::integration::Integration;
use flexbody_driver::{Evaluated, check};
use flexbody_mechanics::integrate::Grid;
use flexbody_problem::Problem;
use serde_json::Value;

/// A mass on a slide, pushed by the force of a table.
pub(super) fn pushed(table: Value, simulation: Value) -> Value {
    let x = json!({"position": {"body": "m", "direction": [1, 0, 0]}});
    let v = json!({"velocity": {"body": "m", "direction": [1, 0, 0]}});
    json!({
        "version": 1, "name": "pushed", "gravity": [0, 0, 0],
        "bodies": {"m": {"shape": {"sphere": {"radius": 0.1}}, "mass": 1,
                         "velocity": {"linear": [0, 0, 0]}}},
        "joints": {"g": {"prismatic": {"between": ["m", "ground"], "at": [0, 0, 0],
                                       "axis": [1, 0, 0]}}},
        "loads": {"F": {"force": {"body": "m", "direction": [1, 0, 0],
                                  "magnitude": {"table": table}}}},
        "simulation": simulation,
        "functions": {
            "x": {"final": x}, "v": {"final": v},
            "way": {"integral": x},
            "ks": {"ks": {"rho": 2, "of": v}},
            "mean": {"induced_exponential": {"rho": 3, "of": v}},
            "T": "duration"
        },
        "variables": {
            "mass": {"path": "/bodies/m/mass", "lower": 0.1, "upper": 10},
            "push": {"path": "/loads/F/force/magnitude/table/values/1"}
        }
    })
}

/// A ramp up to 1 s and down to 2 s.
pub(super) fn triangle() -> Value {
    json!({"times": [0, 1, 2], "values": [0, 1, 0], "interpolation": "linear"})
}

/// Speed and position of the pushed mass of 1 kg, which starts at rest.
pub(super) fn exact(t: f64) -> [f64; 2] {
    if t <= 1.0 {
        return [t * t / 2.0, t.powi(3) / 6.0];
    }
    let s = (t - 1.0).min(1.0);
    let v = 0.5 + s - s * s / 2.0;
    let x = 1.0 / 6.0 + s / 2.0 + s * s / 2.0 - s.powi(3) / 6.0;
    [v, x + (t - 1.0 - s)]
}

/// Every method with the steps it takes, and whether it is exact for parabolas of the speed.
fn methods() -> Vec<(&'static str, Value, Value, bool)> {
    let mut all = vec![
        ("tolerance", json!(1e-9), json!("dop853"), true),
        (
            "tolerance",
            json!(1e-9),
            json!({"radau": {"stages": 2}}),
            true,
        ),
        (
            "tolerance",
            json!(1e-9),
            json!({"radau": {"stages": 3}}),
            true,
        ),
        ("steps", json!(17), json!("dop853"), true),
        ("steps", json!(23), json!({"radau": {"stages": 2}}), true),
        ("steps", json!(31), json!({"radau": {"stages": 3}}), true),
        (
            "steps",
            json!(100),
            json!({"generalised_alpha": {"radius": 0.7}}),
            false,
        ),
    ];
    for order in 1..=6 {
        let method = json!({"bdf": {"order": order}});
        all.push(("steps", json!(100), method, order >= 3));
    }
    let rising = json!({"bdf": {"order": 3, "start": "rising_order"}});
    all.push(("steps", json!(100), rising, false));
    all
}

fn with_method(file: &mut Value, (key, steps, method): (&str, &Value, &Value)) {
    file["simulation"][key] = steps.clone();
    file["simulation"]["method"] = method.clone();
}

/// Adjoint and complex step agree for every function and variable.
fn agrees(problem: &Problem, what: &str) {
    let found = check(problem, &problem.start()).expect("runs");
    for derivative in &found {
        let of = found.iter().filter(|d| d.function == derivative.function);
        let largest = of.fold(derivative.terms, |m, d| m.max(d.complex_step.abs()));
        let off = (derivative.adjoint - derivative.complex_step).abs();
        assert!(off <= 1e-12 * largest, "{what}: {derivative:?}");
    }
}

/// dx/dT = v(T), dv/dT = F(T)/m and d(∫ x dt)/dT = x(T) for durations between, at and beyond the kinks.
#[test]
fn derivatives_in_a_designed_duration_by_all_methods() {
    for (key, steps, method, is_exact) in methods() {
        for duration in [1.0, 1.45, 2.0, 2.5] {
            let mut file = pushed(triangle(), json!({"duration": duration}));
            with_method(&mut file, (key, &steps, &method));
            file["variables"] =
                json!({"T": {"path": "/simulation/duration", "lower": 0.1, "upper": 20}});
            let problem = problem(&file);
            let what = format!("{method} {steps} to {duration}");
            let at = Evaluated::new(&problem, &problem.start()).expect("runs");
            let (found, _) = at
                .gradients(&problem, &[0, 1, 2, 5])
                .expect("differentiates");
            let [v, x] = exact(duration);
            let push = (2.0_f64 - duration).max(0.0);
            // Methods of lower order err by their steps.
            let bound: f64 = match (is_exact, method["bdf"]["order"].as_i64()) {
                (true, _) => 1e-10,
                (false, Some(1)) => 0.03,
                (false, _) => 1e-3,
            };
            // Sums over the ends of equal steps err by their distance, others by the tolerance.
            let of_sums = if key == "steps" { 2e-3 } else { 1e-8 };
            let exact = [
                (v, bound),
                (push, bound),
                (x, bound.max(of_sums)),
                (1.0, 0.0),
            ];
            for (row, (exact, bound)) in found.iter().zip(exact) {
                let off = (row[0] - exact).abs();
                assert!(off <= bound, "{what}: {} for {exact}", row[0]);
            }
            let value = at.function(0).value;
            assert!((value - x).abs() <= bound, "{what}: {value} for {x}");
            agrees(&problem, &what);
        }
    }
}

/// At x = 3 the speed is 1 after T = 4 s: dT/dm = 3 and dT/dk = −3; and a place amid the second ramp.
#[test]
fn events_after_kinks_by_all_methods() {
    for (key, steps, method, is_exact) in methods() {
        let until =
            |reaches: f64| json!({"measure": {"slide": {"joint": "g"}}, "reaches": reaches});
        let simulation = json!({"duration": 20, "until": until(3.0)});
        let mut file = pushed(triangle(), simulation);
        with_method(&mut file, (key, &steps, &method));
        let scene = problem(&file);
        let at = Evaluated::new(&scene, &scene.start()).expect("runs");
        let (found, _) = at.gradients(&scene, &[5, 1]).expect("differentiates");
        let bound: f64 = match (is_exact, method["bdf"]["order"].as_i64()) {
            (true, _) => 1e-9,
            (false, Some(1)) => 0.3,
            (false, _) => 5e-3,
        };
        let given = [
            at.run.duration,
            found[0][0],
            found[0][1],
            found[1][0],
            found[1][1],
        ];
        for (given, exact) in given.into_iter().zip([4.0, 3.0, -3.0, -1.0, 1.0]) {
            let off = (given - exact).abs();
            assert!(off <= bound, "{method} {steps}: {given} for {exact}");
        }
        agrees(&scene, &format!("{method} {steps}"));

        let [v, x] = exact(1.3);
        file["simulation"]["until"] = until(x);
        let scene = problem(&file);
        let at = Evaluated::new(&scene, &scene.start()).expect("runs");
        let off = (at.run.duration - 1.3).abs() * v;
        assert!(off <= bound, "{method} {steps}: {}", at.run.duration);
        agrees(&scene, &format!("{method} {steps} amid the ramp"));
    }
}

/// Other tables of forces and of prescribed motions, with kinks away from the start: derivatives are
/// those of the values on steps of their own, by differences.
#[test]
fn derivatives_are_those_of_the_values_for_all_tables() {
    for (interpolation, drives, steps) in [
        ("linear", false, None),
        ("monotone", false, None),
        ("spline", false, Some(40)),
        ("linear", true, None),
        // 61 and 40 steps keep their shares of the parts beside this duration.
        ("monotone", true, Some(61)),
        ("spline", true, None),
    ] {
        let table = json!({"times": [0.3, 0.9, 1.4, 2.2], "values": [0.2, 1.1, -0.4, 0.6],
                           "interpolation": interpolation});
        let mut file = pushed(table.clone(), json!({"duration": 1.8, "method": "dop853"}));
        if let Some(steps) = steps {
            file["simulation"]["steps"] = json!(steps);
        } else {
            file["simulation"]["tolerance"] = json!(1e-11);
        }
        if drives {
            // A pendulum whose pivot is driven.
            file["gravity"] = json!([0, -9.81, 0]);
            file["bodies"]["m"]["place"] = json!({"at": [0, 0, 0]});
            file["bodies"]["bob"] = json!({"shape": {"sphere": {"radius": 0.1}}, "mass": 0.5,
                                           "place": {"at": [0, -0.7, 0]}});
            file["joints"]["rod"] = json!({"revolute": {"between": ["m", "bob"], "at": [0, 0, 0],
                                                        "axis": [0, 0, 1]}});
            file["drives"] = json!({"pivot": {"joint": "g", "slide": {"table": table}}});
            file["loads"] = json!({});
            for name in ["x", "way", "ks", "mean", "v"] {
                let text = file["functions"][name]
                    .to_string()
                    .replace("\"m\"", "\"bob\"");
                file["functions"][name] = serde_json::from_str(&text).expect("JSON");
            }
        }
        file["variables"] =
            json!({"T": {"path": "/simulation/duration", "lower": 0.1, "upper": 20}});
        let own = problem(&file);
        let what = format!("{interpolation} {drives} {steps:?}");
        agrees(&own, &what);
        let at = Evaluated::new(&own, &own.start()).expect("runs");
        let (found, _) = at
            .gradients(&own, &[0, 1, 2, 3, 4])
            .expect("differentiates");
        // Sums over given steps bend more than the noise of chosen ones is.
        let step = if steps.is_some() { 1e-5 } else { 1e-4 };
        let values = |by: f64| {
            let mut file = file.clone();
            file["simulation"]["duration"] = json!(1.8 + by);
            let moved = problem(&file);
            let at = Evaluated::new(&moved, &moved.start()).expect("runs");
            [0, 1, 2, 3, 4].map(|f| at.function(f).value)
        };
        let (more, less) = (values(step), values(-step));
        for f in 0..5 {
            let difference = (more[f] - less[f]) / (2.0 * step);
            let off = (found[f][0] - difference).abs();
            // The third derivative times step², and the round-off of the difference.
            let bound = 2e-6 * (1.0 + difference.abs());
            assert!(off < bound, "{what} {f}: {} for {difference}", found[f][0]);
        }
    }
}

/// The duration passes the kinks at 1 s and 2 s on the steps in use: values stay on the closed form,
/// and the steps are made anew.
#[test]
fn values_are_smooth_where_the_end_passes_a_kink() {
    for (key, steps, method, is_exact) in methods() {
        let mut file = pushed(triangle(), json!({"duration": 1.6}));
        with_method(&mut file, (key, &steps, &method));
        file["variables"] =
            json!({"T": {"path": "/simulation/duration", "lower": 0.1, "upper": 20}});
        let problem = problem(&file);
        let start = problem.start();
        let mut kept = Integration::new(&problem, &problem.scene(&start), None, true);
        let bound: f64 = match (is_exact, method["bdf"]["order"].as_i64()) {
            (true, _) => 1e-9,
            (false, Some(1)) => 0.03,
            (false, _) => 1e-3,
        };
        let (mut anew, mut steps_at_2) = (0, Vec::new());
        for duration in [1.6, 1.9, 2.0 - 1e-7, 2.0, 2.0 + 1e-7, 2.3, 1.2, 0.8, 2.6] {
            let (at, refresh) = Evaluated::with(&mut kept, &problem, &[duration]).expect("runs");
            anew +=
                usize::from(refresh.is_some_and(|now| now.reason.contains("passed an instant")));
            let [v, x] = exact(duration);
            let (found, _) = at.gradients(&problem, &[0]).expect("differentiates");
            for (given, exact) in [(at.function(0).value, x), (found[0][0], v)] {
                let off = (given - exact).abs();
                assert!(off <= bound, "{method} to {duration}: {given} for {exact}");
            }
            if (duration - 2.0).abs() < 1e-6 {
                steps_at_2.push(at.function(0).value);
            }
        }
        // At 2 s, 1.2 s, 0.8 s and back.
        assert_eq!(anew, 4, "{method}");
        // The steps are made anew there, so the value jumps by the difference of two errors of steps.
        let way = steps_at_2[2] - steps_at_2[0] - 2e-7;
        assert!(way.abs() <= bound, "{method}: {way}");
    }
}

/// A grid keeps the steps of each part, and those before the last kink where they were.
#[test]
fn kept_steps_follow_their_parts() {
    let grid = Grid::between(10, &[0.4, 0.8]);
    assert_eq!(grid.steps(), 10);
    let longer = grid.fitted(&[0.2, 0.4]);
    let expected = [0.0, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.7, 1.0];
    for (given, expected) in longer.ends().iter().zip(expected) {
        assert!((given - expected).abs() < 1e-15, "{:?}", longer.ends());
    }
    assert_eq!((longer.rate(0.4), longer.rate(1.0)), (0.0, 1.0));
    assert!((longer.rate(0.7) - 0.5).abs() < 1e-15);
    assert_eq!(
        [longer.in_part(4), longer.in_part(5), longer.in_part(10)],
        [4, 1, 2]
    );
    assert_eq!(grid.fitted(&[0.4, 0.8]), grid);
    // Without kinks nothing changes, to the bit.
    let uniform = Grid::uniform(7);
    assert_eq!(uniform.fitted(&[0.5]), uniform);
    assert_eq!(Grid::between(7, &[]).ends(), uniform.ends());
    assert_eq!(
        (uniform.rate(3.0 / 7.0), uniform.growth(0.2)),
        (3.0 / 7.0, 1.0)
    );
    // Given steps are shared anew if a kink comes or goes; each part has one at least.
    assert_eq!(grid.fitted(&[0.1, 0.2, 0.9]).steps(), 10);
    assert_eq!(Grid::between(2, &[0.1, 0.2, 0.9]).steps(), 4);
    // Steps chosen by a tolerance leave out the parts that are gone.
    let ends = vec![0.0, 0.3, 0.4, 0.5, 0.8, 0.9, 1.0];
    let chosen = Grid::from_ends(ends).and_then(|grid| grid.with_kinks(vec![0.4, 0.8], false));
    let chosen = chosen.expect("kinks are ends");
    let fewer = chosen.fitted(&[0.8]);
    let pairs = fewer.ends().iter().zip([0.0, 0.6, 0.8, 0.85, 1.0]);
    assert!(
        pairs
            .into_iter()
            .all(|(given, exact)| (given - exact).abs() < 1e-15),
        "{fewer:?}"
    );
    assert_eq!(chosen.fitted(&[0.2, 0.4, 0.6]).steps(), 8);
}
