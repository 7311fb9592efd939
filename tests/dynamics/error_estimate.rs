//! The estimated discretisation errors of functions and gradients against the true ones.
//!
//! The true value is that of dop853 with the halved steps of tolerance 1e-13. The same run with
//! these steps halved again gives its uncertainty, which includes 1e-13 of the value. A number is
//! omitted if its true error is below ten times the uncertainty: it is round-off.

use crate::reference::documents::problem;
use flexbody_driver::Evaluated;
use flexbody_driver::accuracy::{Judged, reach};
use flexbody_driver::error::estimate;
use flexbody_mechanics::integrate::{
    MEMORY, Method, Samples, Settings, Spacing, Start, StepSolver, simulate,
};
use flexbody_problem::Problem;
use serde_json::Value;
use std::path::Path;

const RADAU3: Method = Method::Radau { stages: 3 };
const BDF2: Method = Method::Bdf {
    order: 2,
    start: Start::Radau,
};
/// Smallest and largest trusted ratio of estimate to true error.
const TRUSTED: (f64, f64) = (0.3, 3.0);

fn load(file: &str, change: impl FnOnce(&mut Value)) -> Problem {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("problems")
        .join(file);
    let text = std::fs::read_to_string(path).expect("a problem file");
    let mut document: Value = serde_json::from_str(&text).expect("is JSON");
    change(&mut document);
    problem(&document)
}

fn triple_pendulum() -> Problem {
    load("triple_pendulum.json", |_| {})
}

fn trebuchet() -> Problem {
    load("trebuchet_release_time.json", |_| {})
}

fn andrews() -> Problem {
    load("benchmarks/andrews_squeezer.json", |document| {
        document["variables"] = json!({
            "drive torque": {"path": "/loads/motor/torque/magnitude", "lower": 0.01, "upper": 0.1},
            "stiffness": {"path": "/loads/spring/spring/stiffness", "lower": 1000, "upper": 9000},
            "mass of K3": {"path": "/bodies/K3/mass", "lower": 0.01, "upper": 0.05},
            "duration": {"path": "/simulation/duration", "lower": 0.01, "upper": 0.05}
        });
    })
}

/// A function or one of its derivatives: value and uncertainty.
struct Exact {
    value: f64,
    doubt: f64,
}

/// Every function and then its derivatives, in the order of the file.
fn exact(problem: &Problem) -> Vec<Vec<Exact>> {
    let x = problem.start();
    let scene = problem.scene::<f64>(&x);
    let all: Vec<usize> = (0..scene.functions.len()).collect();
    let (model, duration) = (&scene.model, scene.duration);
    let settings = |spacing, samples| Settings {
        method: Method::Dop853,
        solver: StepSolver::default(),
        spacing,
        samples: Samples::Uniform(samples),
        limits: Default::default(),
        memory: MEMORY,
        derivatives: false,
    };
    let chosen = simulate(model, duration, &settings(Spacing::Tolerance(1e-13), 1)).expect("runs");
    let once = chosen.grid.halved();
    let twice = once.halved();
    let values = |spacing, samples| {
        let run = simulate(model, duration, &settings(spacing, samples)).expect("runs");
        let at = Evaluated {
            x: x.clone(),
            scene: scene.clone(),
            run,
            composition: problem.composition.clone(),
        };
        let (found, _) = at.derivatives(problem, &all).expect("regular");
        let value = |f: usize| {
            let value = at.function(f).value;
            let mut row = vec![(value, value.abs())];
            row.extend(found[f].iter().map(|d| (d.value, d.terms)));
            row
        };
        all.iter().map(|&f| value(f)).collect::<Vec<_>>()
    };
    let (coarse, fine) = (
        values(Spacing::Frozen(once), 10_000),
        values(Spacing::Frozen(twice), 20_000),
    );
    let pair = |(a, b): (&(f64, f64), &(f64, f64))| Exact {
        value: b.0,
        doubt: (a.0 - b.0).abs() + 1e-13 * b.1,
    };
    let rows = coarse.iter().zip(&fine);
    rows.map(|(a, b)| a.iter().zip(b).map(pair).collect())
        .collect()
}

/// Ratios of estimated to true errors, of functions and of derivatives, and the number of omitted
/// ones.
struct Ratios {
    functions: Vec<(String, f64)>,
    derivatives: Vec<(String, f64)>,
    left_out: usize,
}

fn ratios(problem: &Problem, exact: &[Vec<Exact>], method: Method, spacing: Spacing) -> Ratios {
    let mut problem = problem.clone();
    problem.simulation.method = Some(method);
    problem.simulation.spacing = spacing;
    let at = Evaluated::new(&problem, &problem.start()).expect("runs");
    let all: Vec<usize> = (0..exact.len()).collect();
    let found = estimate(&problem, &at, &all, true).expect("runs");
    let mut ratios = Ratios {
        functions: Vec::new(),
        derivatives: Vec::new(),
        left_out: 0,
    };
    for (found, exact) in found.iter().zip(exact) {
        let function = &problem.function_names[found.function];
        let estimates = std::iter::once(&found.value).chain(&found.gradient);
        for (i, (estimate, exact)) in estimates.zip(exact).enumerate() {
            let true_error = (estimate.value - exact.value).abs();
            if true_error <= 10.0 * exact.doubt {
                ratios.left_out += 1;
                continue;
            }
            let ratio = estimate.error / true_error;
            match i {
                0 => ratios.functions.push((function.clone(), ratio)),
                i => {
                    let name = format!("{function} by {}", problem.variables[i - 1].name);
                    ratios.derivatives.push((name, ratio));
                }
            }
        }
    }
    ratios
}

fn trusted(ratio: f64) -> bool {
    (TRUSTED.0..=TRUSTED.1).contains(&ratio)
}

/// One line of the table: number of trusted ratios, and the worst.
fn line(all: &[(String, f64)]) -> String {
    let good = all.iter().filter(|(_, ratio)| trusted(*ratio)).count();
    let far = |ratio: f64| ratio.ln().abs();
    let worst = all.iter().max_by(|a, b| far(a.1).total_cmp(&far(b.1)));
    match worst {
        Some((name, ratio)) => format!("{good}/{} worst {ratio:.2} ({name})", all.len()),
        None => "none".into(),
    }
}

/// Prints the ratios of the settings. Asserts that all those of values are trusted, and this share
/// of those of derivatives.
fn judge(problem: &Problem, settings: &[(Method, Spacing)], share: f64) {
    let exact = exact(problem);
    let (mut wrong, mut derivatives) = (Vec::new(), Vec::new());
    for (method, spacing) in settings {
        let found = ratios(problem, &exact, *method, spacing.clone());
        println!(
            "{} | {} {spacing:?} | {} | {} | {}",
            problem.name,
            method.name(),
            line(&found.functions),
            line(&found.derivatives),
            found.left_out
        );
        let setting = format!("{} {spacing:?}", method.name());
        let bad = found.functions.iter().filter(|(_, ratio)| !trusted(*ratio));
        wrong.extend(bad.map(|(name, ratio)| format!("{setting}: {name} {ratio:.3}")));
        derivatives.extend(found.derivatives);
        if settings.len() <= 4 {
            assert!(!found.functions.is_empty(), "{setting}: all at round-off");
        }
    }
    assert!(wrong.is_empty(), "{wrong:?}");
    let good = derivatives
        .iter()
        .filter(|(_, ratio)| trusted(*ratio))
        .count();
    println!(
        "{} | derivatives {good} of {}",
        problem.name,
        derivatives.len()
    );
    assert!(
        good as f64 >= share * derivatives.len() as f64,
        "{good} of {}",
        derivatives.len()
    );
}

fn tolerance(method: Method, tolerance: f64) -> (Method, Spacing) {
    (method, Spacing::Tolerance(tolerance))
}

fn steps(method: Method, steps: usize) -> (Method, Spacing) {
    (method, Spacing::Steps(steps))
}

#[test]
fn estimates_are_right_on_the_triple_pendulum() {
    let settings = [
        tolerance(Method::Dop853, 1e-6),
        tolerance(RADAU3, 1e-6),
        steps(BDF2, 5000),
    ];
    judge(&triple_pendulum(), &settings, 0.95);
}

#[test]
fn estimates_are_right_on_the_trebuchet() {
    let settings = [
        tolerance(Method::Dop853, 1e-7),
        tolerance(RADAU3, 1e-6),
        steps(BDF2, 2000),
    ];
    judge(&trebuchet(), &settings, 1.0);
}

#[test]
fn estimates_are_right_on_andrews_squeezer() {
    let settings = [
        tolerance(Method::Dop853, 1e-6),
        tolerance(RADAU3, 1e-6),
        steps(BDF2, 4000),
    ];
    judge(&andrews(), &settings, 1.0);
}

/// The part with the larger error is refined: the tolerance, which also controls sums, or equal
/// steps.
#[test]
fn an_accuracy_is_reached_by_what_lacks_it() {
    let by_tolerance = |tolerance: f64| {
        move |problem: &mut Problem| {
            problem.simulation.spacing = Spacing::Tolerance(tolerance);
        }
    };
    let reached = |file: &str, accuracy: f64, change: &dyn Fn(&mut Problem)| {
        let mut problem = load(file, |_| {});
        change(&mut problem);
        let which = problem.objective.expect("an objective").function;
        let found = reach(&mut problem, &[Judged::alone(which)], accuracy).expect("runs");
        assert!(found.error <= accuracy, "{found:?}");
        // The estimate is that of the refined problem.
        let at = Evaluated::new(&problem, &problem.start()).expect("runs");
        let own = estimate(&problem, &at, &[which], false).expect("runs")[0].value;
        assert!(own.error <= 1.01 * accuracy * own.value.abs(), "{own:?}");
        found
    };
    // Sums over the motion follow the tolerance for any shown samples.
    let seldom = |problem: &mut Problem| {
        problem.simulation.samples = Some(50);
        problem.simulation.spacing = Spacing::Tolerance(1e-5);
    };
    let found = reached("trebuchet.json", 1e-9, &seldom);
    assert!(
        matches!(found.spacing, Some(Spacing::Tolerance(finer)) if finer < 1e-5),
        "{found:?}"
    );
    assert_eq!(found.samples, None, "{found:?}");
    assert_eq!(found.overrides().len(), 1);

    let found = reached("trebuchet_release_time.json", 1e-9, &by_tolerance(1e-6));
    assert!(
        matches!(found.spacing, Some(Spacing::Tolerance(finer)) if finer < 1e-6),
        "{found:?}"
    );
    assert_eq!(found.samples, None, "{found:?}");

    let bdf = |problem: &mut Problem| {
        problem.simulation.method = Some(BDF2);
        problem.simulation.spacing = Spacing::Steps(1000);
        problem.simulation.samples = None;
    };
    let found = reached("trebuchet.json", 1e-5, &bdf);
    assert!(
        matches!(found.spacing, Some(Spacing::Steps(more)) if more > 1000),
        "{found:?}"
    );
    assert_eq!(found.samples, None, "{found:?}");

    // A sufficient setting is not changed.
    let found = reached("trebuchet_release_time.json", 1e-2, &by_tolerance(1e-6));
    assert!(found.overrides().is_empty(), "{found:?}");
}

/// The table of the documentation.
#[test]
#[ignore = "takes a minute"]
fn estimates_are_right_over_a_wide_range() {
    let range = |counts: [[usize; 3]; 3]| {
        let mut all = Vec::new();
        for (method, counts) in [Method::Dop853, RADAU3, BDF2].into_iter().zip(counts) {
            if method.is_adaptive() {
                all.extend([1e-5, 1e-6, 1e-7, 1e-8, 1e-9].map(|tol| tolerance(method, tol)));
            }
            all.extend(counts.map(|count| steps(method, count)));
        }
        all
    };
    let wide = range([[160, 240, 320], [320, 640, 1280], [2500, 5000, 10_000]]);
    judge(&triple_pendulum(), &wide, 0.95);
    let wide = range([[50, 70, 100], [200, 400, 800], [1000, 2000, 4000]]);
    judge(&trebuchet(), &wide, 0.95);
    let wide = range([[40, 60, 80], [200, 400, 800], [2000, 4000, 8000]]);
    judge(&andrews(), &wide, 0.95);
}

/// A point that turns about the origin at radius ½ m: g = ½ cos(ω t − φ).
fn turning(omega: f64, duration: f64, phase: f64, tolerance: f64, functions: Value) -> Evaluated {
    let mut functions = functions;
    let of = json!({"position": {"body": "box", "point": "end",
        "direction": [phase.cos(), phase.sin(), 0.0]}});
    for function in functions.as_object_mut().expect("functions").values_mut() {
        for aggregate in function.as_object_mut().expect("a function").values_mut() {
            match aggregate.is_null() {
                true => *aggregate = of.clone(),
                false => aggregate["of"] = of.clone(),
            }
        }
    }
    let problem = load("extreme/aggregate.json", |document| {
        document["bodies"]["box"]["velocity"]["angular"] = json!([0.0, 0.0, omega]);
        document["simulation"] = json!({"duration": duration, "tolerance": tolerance});
        document["functions"] = functions;
    });
    Evaluated::new(&problem, &problem.start()).expect("runs")
}

/// Mean of f over [0, 1] by Simpson's rule.
fn mean(f: impl Fn(f64) -> f64) -> f64 {
    let n = 40_000;
    let term = |k: i32| {
        let weight = [2.0, 4.0][(k % 2) as usize];
        let weight = if k == 0 || k == n { 1.0 } else { weight };
        weight * f(f64::from(k) / f64::from(n))
    };
    (0..=n).map(term).sum::<f64>() / (3.0 * f64::from(n))
}

#[test]
fn sums_over_the_motion_are_as_exact_as_the_motion() {
    for (omega, duration, phase) in [
        (6.3, 0.7, 0.4),
        (1.0, 0.3, 0.0),
        (-9.0, 3.1, 2.0),
        (0.3, 40.0, 1.0),
    ] {
        for tolerance in [1e-5, 1e-7, 1e-9, 1e-11] {
            for rho in [0.5, 20.0, 1e3] {
                let functions = json!({"sum": {"integral": null}, "ks": {"ks": {"rho": rho}},
                    "above": {"ks": {"rho": rho, "bound": "above"}},
                    "mean": {"induced_exponential": {"rho": rho}}});
                let at = turning(omega, duration, phase, tolerance, functions);
                let g = |s: f64| 0.5 * (omega * s * duration - phase).cos();
                let soft = |s: f64| (rho * (g(s) - 0.5)).exp();
                let integral = 0.5 * ((omega * duration - phase).sin() + phase.sin()) / omega;
                let whole = mean(soft);
                let exact = [
                    integral,
                    0.5 + whole.ln() / rho,
                    mean(|s| g(s) * soft(s)) / whole,
                ];
                // Errors of angles are proportional to the tolerance and the numbers of turns and
                // steps.
                let bound = tolerance * 50.0 * (1.0 + (omega * duration).abs()) + 1e-12;
                for (f, exact) in [0, 1, 3].into_iter().zip(exact) {
                    let size = if f == 0 { duration } else { 1.0 };
                    let error = (at.function(f).value - exact).abs() / size;
                    assert!(error <= bound, "{omega} {tolerance:e} {rho} {f}: {error:e}");
                }
                let known = at.function(1).maximum.expect("an aggregate");
                let ends = g(0.0).max(g(1.0));
                let inside = (0..100)
                    .map(|k| (phase + std::f64::consts::TAU * (f64::from(k) - 50.0)) / omega);
                let top = match inside.into_iter().any(|t| t >= 0.0 && t <= duration) {
                    true => 0.5,
                    false => ends,
                };
                assert!(
                    (known.value - top).abs() <= bound,
                    "{omega} {tolerance:e}: {known:?} {top}"
                );
                let [below, above] = [1, 2].map(|f| at.function(f).value);
                assert!(below <= known.value + 1e-14, "{below} {known:?}");
                assert!(above >= known.value - 1e-14, "{above} {known:?}");
                let peaks = 2.0 + (omega * duration).abs() / std::f64::consts::TAU;
                assert!(
                    above <= known.value + peaks.ln() / rho + 1e-12,
                    "{above} {known:?}"
                );
            }
        }
    }
}

/// Ranges of balls of any size and speed, from any height, are those of parabolas.
#[test]
fn ranges_of_balls_of_any_size_are_exact() {
    for unit in [1e-3, 1.0, 1e3] {
        for speed in [1e-3, 1.1, 30.0, 1e3] {
            for (height, angle) in [
                (0.1, 0.0_f64),
                (1e-3, 0.7),
                (5.0, -0.9),
                (-1e-9, 1.2),
                (0.0, 0.5),
            ] {
                let [vx, vy] = [angle.cos(), angle.sin()].map(|part| part * speed);
                let text = json!({"version": 1, "name": "ball",
                    "bodies": {"ball": {"shape": {"sphere": {"radius": 0.05 * unit}}, "mass": 1,
                        "place": {"at": [2.0 * unit, height * unit, 0]},
                        "velocity": {"linear": [vx * unit, vy * unit, 0]}}},
                    "gravity": [0, -9.81 * unit, 0],
                    "simulation": {"duration": 1e-4 * speed.min(1.0)},
                    "functions": {"range": {"final": {"range": {"body": "ball", "ground": 0}}}}});
                let problem = problem(&text);
                let at = Evaluated::new(&problem, &problem.start()).expect("runs");
                let root = (vy * vy + 2.0 * 9.81 * height).max(0.0).sqrt();
                let exact = 2.0 + vx / 9.81 * (vy + root);
                let size = 2.0 + (vx / 9.81 * (vy.abs() + root)).abs();
                let error = (at.function(0).value / unit - exact).abs();
                assert!(
                    error <= 1e-12 * size,
                    "{unit} {speed} {height} {angle}: {error:e}"
                );
            }
        }
    }
}

/// A clearance does not change if throw and barrier are moved together, by any distance and for any
/// sharpness of the aggregate. The weights sum to one, and their derivatives contain no round-off
/// of large terms.
#[test]
fn far_from_the_origin_the_weights_of_a_release_do_not_drift() {
    let far = 1e6;
    let problem = load("trebuchet.json", |document| {
        let moved = |place: &mut Value| *place = json!(place.as_f64().expect("a number") + far);
        moved(&mut document["bodies"]["arm"]["place"]["at"][0]);
        moved(&mut document["functions"]["clearance"]["clearance"]["barrier"]["distance"]);
        let range = &mut document["functions"]["range"]["ks"];
        range["rho"] = json!(30);
        range["of"]["range"]
            .as_object_mut()
            .expect("a range")
            .remove("gate");
        document["simulation"]["duration"] = json!(1.2);
        let near = |path: &str| json!({"path": path, "lower": far - 10.0, "upper": far + 100.0});
        document["variables"] = json!({
            "place": near("/bodies/arm/place/at/0"),
            "barrier": near("/functions/clearance/clearance/barrier/distance")
        });
    });
    let at = Evaluated::new(&problem, &problem.start()).expect("runs");
    let (found, _) = at.gradients(&problem, &[1]).expect("is regular");
    let [place, barrier] = [found[0][0], found[0][1]];
    assert!(
        (place + barrier).abs() <= 1e-12 * barrier.abs(),
        "{place} {barrier}"
    );
}

/// A body moves at constant speed, so aggregates of its position have closed forms: with a = ρ s T,
/// KS = m + ln((1 − e^{−a})/a)/ρ and the induced exponential is m − 1/ρ + T s e^{−a}/(1 − e^{−a}), for the
/// largest position m at the end or at the start. Samples that are too wide for them miss the peak, and
/// the estimate says so.
#[test]
fn samples_that_miss_a_sharp_peak_are_known_to() {
    for (speed, rho, steps, samples, method) in [
        (1.0_f64, 1000.0, 20, None, json!("dop853")),
        (-1.0, 1000.0, 20, None, json!("dop853")),
        (2.0, 300.0, 50, None, json!({"radau": {"stages": 2}})),
        (-0.5, 4000.0, 30, Some(12), json!({"radau": {"stages": 3}})),
        (1.0, 90.0, 25, None, json!({"bdf": {"order": 2}})),
        (
            3.0,
            50.0,
            40,
            None,
            json!({"generalised_alpha": {"radius": 0.8}}),
        ),
    ] {
        let x = json!({"position": {"body": "b", "direction": [1, 0, 0]}});
        let mut file = json!({
            "version": 1, "name": "sharp", "gravity": [0, 0, 0],
            "bodies": {"b": {"shape": {"sphere": {"radius": 0.1}}, "mass": 1,
                             "velocity": {"linear": [speed, 0, 0]}}},
            "simulation": {"duration": 1, "steps": steps, "method": method},
            "functions": {"ks": {"ks": {"rho": rho, "of": x}},
                          "mean": {"induced_exponential": {"rho": rho, "of": x}}}
        });
        if let Some(samples) = samples {
            file["simulation"]["samples"] = json!(samples);
        }
        let problem = crate::reference::documents::problem(&file);
        let at = Evaluated::new(&problem, &problem.start()).expect("runs");
        let found = estimate(&problem, &at, &[0, 1], false).expect("runs");
        let a = rho * speed.abs();
        let largest = speed.max(0.0);
        let cold = (-a).exp();
        let ks = largest + ((1.0 - cold) / a).ln() / rho;
        let mean = largest - 1.0 / rho + speed.abs() * cold / (1.0 - cold);
        for (found, exact) in found.iter().zip([ks, mean]) {
            let off = (found.value.value - exact).abs();
            let ratio = found.value.error / off;
            assert!((0.3..3.0).contains(&ratio), "{file}: {ratio} {off}");
        }
        let sharpness = at.function(0).peak_sharpness;
        let wide = a / f64::from(samples.unwrap_or(steps));
        assert!((sharpness / wide - 1.0).abs() < 1e-9, "{sharpness} {wide}");
    }
}

/// Integrals of quantities that are zero but for round-off take one cell a step, as others do.
#[test]
fn integrals_of_round_off_take_no_more_samples_than_others() {
    for (joint, of, method) in [
        (
            "spherical",
            json!({"joint_moment": {"joint": "j", "direction": [1, 2, 3]}}),
            json!({"radau": {"stages": 3}}),
        ),
        (
            "spherical",
            json!({"joint_moment": {"joint": "j", "direction": [0, 0, 1]}}),
            json!("dop853"),
        ),
        (
            "spherical",
            json!({"square": {"joint_moment": {"joint": "j", "direction": [1, 0, 1]}}}),
            json!("dop853"),
        ),
        (
            "revolute",
            json!({"joint_moment": {"joint": "j", "direction": [0, 0, 1]}}),
            json!({"radau": {"stages": 2}}),
        ),
        (
            "revolute",
            json!({"joint_force": {"joint": "j", "direction": [0, 0, 1]}}),
            json!("dop853"),
        ),
        (
            "revolute",
            json!({"velocity": {"body": "b", "direction": [0, 0, 3]}}),
            json!({"radau": {"stages": 3}}),
        ),
        (
            "revolute",
            json!({"acceleration": {"body": "b", "direction": [0, 0, 1]}}),
            json!({"radau": {"stages": 3}}),
        ),
        (
            "revolute",
            json!({"angular_velocity": {"body": "b", "direction": [1, 0, 0]}}),
            json!("dop853"),
        ),
        (
            "revolute",
            json!({"momentum": {"direction": [0, 0, 1]}}),
            json!({"radau": {"stages": 2}}),
        ),
    ] {
        for size in [1.0_f64, 1e-3, 1e3] {
            let connection = match joint {
                "spherical" => json!({"between": ["b", "ground"], "at": "b.p"}),
                _ => json!({"between": ["b", "ground"], "at": "b.p", "axis": [0, 0, 1]}),
            };
            let gravity = if joint == "spherical" {
                [1.0, -9.0, 2.0]
            } else {
                [1.0, -9.0, 0.0]
            };
            let file = json!({
                "version": 1, "name": "zero", "gravity": gravity,
                "bodies": {"b": {"shape": {"box": {"size": [size, 0.2 * size, 0.3 * size]}}, "mass": 1,
                                 "points": {"p": [-0.5 * size, 0.1 * size, 0.0]},
                                 "place": {"put": "p", "at": [0, 0, 0]}}},
                "joints": {"j": {joint: connection}},
                "simulation": {"duration": size.sqrt(), "tolerance": 1e-9, "method": method},
                "functions": {"zero": {"integral": of}}
            });
            let problem = crate::reference::documents::problem(&file);
            let at = Evaluated::new(&problem, &problem.start()).expect("runs");
            let cells = at.run.grid.all_cells().iter().max();
            assert!(
                cells.is_none_or(|&most| most <= 2),
                "{joint} {of} {method} {size}: {cells:?}"
            );
        }
    }
}

/// Halves of steps around an impact pass over the next one, as impacts move with the steps. The error then follows from a motion by a
/// smaller tolerance.
#[test]
fn impacts_between_halved_steps_leave_an_estimate() {
    let file = json!({
        "version": 1, "name": "rod", "gravity": [0, 0, 0],
        "bodies": {"A": {"shape": {"box": {"size": [0.867406097194261, 0.1, 0.05]}}, "mass": 2.5927206477292253,
            "points": {"a": [-0.4337030485971305, 0, 0], "b": [0.4337030485971305, 0, 0]},
            "place": {"put": "a", "at": [0, 0, 0], "turn": {"axis": [0, 0, 1], "angle": -2.9576061130776115}}}},
        "joints": {"h": {"revolute": {"between": ["A", "ground"], "at": "A.a", "axis": [0, 0, 1],
            "start": {"turn": {"rate": -47.082136777048355}}}}},
        "loads": {"c": {"contact": {"between": ["A", "ground"],
            "at": {"a": "b", "b": [0.3433227468425023, -0.7946644033027829, 0]},
            "surface": {"sphere": {"radius": 0.02218391272245027}},
            "stiffness": 35171.74710928287, "width": 0.0021543660272590297}}},
        "functions": {"x": {"final": {"position": {"body": "A", "point": "b", "direction": [1, 0, 0]}}}},
        "simulation": {"duration": 0.29662229400870643, "tolerance": 9.241403070177526e-06}
    });
    let value = |tolerance: f64| {
        let mut file = file.clone();
        file["simulation"]["tolerance"] = json!(tolerance);
        let problem = problem(&file);
        let at = Evaluated::new(&problem, &problem.start()).expect("runs");
        let error = estimate(&problem, &at, &[0], false).expect("an estimate");
        (at.function(0).value, error[0].value.error)
    };
    let (x, error) = value(9.241403070177526e-06);
    let (exact, _) = value(1e-11);
    let ratio = error / (x - exact).abs();
    assert!(
        (TRUSTED.0..TRUSTED.1).contains(&ratio),
        "{x} {exact} {error}"
    );
}
