//! The method chosen for a scene, the steps that are kept from design to design, and the messages
//! about both.

use flexbody_driver::evaluate::Evaluated;
use flexbody_driver::evaluator::Evaluator;
use flexbody_driver::integration::Integration;
use flexbody_driver::{KnownEvaluations, simulate};
use flexbody_mechanics::integrate::{IntegrationFailure, Method, Spacing};
use flexbody_optimiser::Nlp;
use flexbody_problem::{Override, Problem};
use flexbody_report::evaluations::{EvaluationRecord, Found};
use std::path::Path;

fn load(name: &str, changes: &[&str]) -> Problem {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("problems/{name}.json"));
    let parse = |text: &&str| Override::parse(text).expect("an override");
    let changes: Vec<Override> = changes.iter().map(parse).collect();
    Problem::load(&path, &changes).unwrap_or_else(|faults| panic!("{faults}"))
}

#[test]
fn a_rigid_scene_is_integrated_explicitly() {
    let problem = load("trebuchet_release_time", &[]);
    let motion = simulate(&problem, &problem.start()).expect("runs");
    assert_eq!(motion.at.run.method, Method::Dop853);
    assert!(motion.reason.contains("not stiff"), "{}", motion.reason);
    assert_eq!(motion.warning, None);
    assert_eq!(motion.at.run.counts.newton_iterations, 0);
}

/// Bricard's mechanism with one joint slightly displaced is nearly locked: it shakes between two
/// stops, and 1 s needs half a million steps. It stops after a fixed number of steps with a
/// message, unless the file gives a time limit or leaves the method open.
#[test]
fn a_mechanism_that_is_nearly_locked_is_given_up() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/nearly_locked.json");
    let load = |changes: &[&str]| {
        let parse = |text: &&str| Override::parse(text).expect("an override");
        let changes: Vec<Override> = changes.iter().map(parse).collect();
        Problem::load(&file, &changes).unwrap_or_else(|faults| panic!("{faults}"))
    };
    let off = |by: f64| format!("/joints/R2/revolute/at/0={}", 1.0 - by);
    for (by, more) in [
        (1e-6, "/simulation/tolerance=1e-9"),
        (1e-6, "/simulation/duration=10"),
        (1e-7, "/simulation/tolerance=1e-7"),
    ] {
        let problem = load(&[&off(by), more, "/simulation/method=dop853"]);
        let failure = simulate(&problem, &problem.start()).map(|_| ());
        let failure = failure.expect_err("is given up");
        assert!(
            matches!(failure, IntegrationFailure::NoHeadway { tries: 5000, rejected, .. } if rejected > 500),
            "{failure}"
        );
        let told = failure.to_string();
        assert!(told.contains("nearly locked"), "{told}");
    }
    // Radau IIA takes over if the file allows it: without a degree of freedom nothing moves.
    for more in ["/simulation/tolerance=1e-9", "/simulation/duration=10"] {
        let problem = load(&[&off(1e-6), more]);
        let seen = simulate(&problem, &problem.start()).expect("runs");
        assert_eq!(seen.at.run.method, Method::Radau { stages: 3 });
        assert!(seen.reason.contains("no headway"), "{}", seen.reason);
        let motion = seen.motion();
        let last = motion.q(motion.last());
        for (from, to) in motion.q(0).iter().zip(last) {
            assert!((from - to).abs() < 1e-6, "{from} {to}");
        }
    }
    // The mechanism without displacement moves.
    let problem = load(&["/simulation/duration=0.2"]);
    simulate(&problem, &problem.start()).expect("runs");
    // A time limit instead of a number of steps.
    let problem = load(&[&off(1e-6), "/simulation/seconds=1e-9"]);
    let failure = simulate(&problem, &problem.start()).map(|_| ());
    let failure = failure.expect_err("takes longer");
    assert!(
        matches!(failure, IntegrationFailure::TimeLimit { seconds: 1e-9, .. }),
        "{failure}"
    );
}

/// A stiff spring vibrates without damping. At a tight tolerance it needs hundreds of thousands of
/// steps, and a fifth of them is rejected. The scene has one body, and the run is not stopped.
#[test]
fn a_fast_vibration_is_not_given_up() {
    let simulation = r#"/simulation={"duration": 4, "tolerance": 1e-11, "samples": 1}"#;
    let problem = load("benchmarks/stiff_pendulum", &[simulation]);
    let motion = simulate(&problem, &problem.start()).expect("runs");
    assert_eq!(motion.at.run.grid.reached(), 1.0);
}

/// The optimiser backs off from a design whose simulation exceeds its limit.
#[test]
fn a_simulation_over_its_limit_is_a_failed_evaluation() {
    let problem = load("trebuchet", &["/simulation/seconds=1e-9"]);
    let log = KnownEvaluations::new(Vec::new(), |_| ());
    let mut program = Evaluator::new(&problem, log).expect("an objective");
    let start = program.start();
    let failure = program.evaluate(&start).expect_err("takes longer");
    assert!(
        failure.reason.contains("time limit of 0.000000001 s"),
        "{failure:?}"
    );
}

/// A spring of 1e5 rad/s limits explicit steps to 6e-5 s: 50 000 for 3 s. Radau IIA needs a
/// thirtieth of them.
#[test]
fn a_stiff_scene_hands_over_by_itself() {
    let path =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("problems/benchmarks/stiff_pendulum.json");
    let text = std::fs::read_to_string(path).expect("a problem");
    let mut document: serde_json::Value = serde_json::from_str(&text).expect("valid JSON");
    document["simulation"] = json!({"duration": 3, "tolerance": 1e-7});
    let problem = Problem::parse(&document.to_string(), "stiff.json", &[]).expect("no faults");
    let motion = simulate(&problem, &problem.start()).expect("runs");
    assert_eq!(motion.at.run.method, Method::Radau { stages: 3 });
    assert!(
        motion.reason.contains("the scene is stiff"),
        "{}",
        motion.reason
    );
    assert!(
        motion.at.run.grid.steps() < 3000,
        "{}",
        motion.at.run.grid.steps()
    );

    document["simulation"]["method"] = json!("dop853");
    let problem = Problem::parse(&document.to_string(), "stiff.json", &[]).expect("no faults");
    let failure = simulate(&problem, &problem.start())
        .map(|_| ())
        .expect_err("is refused");
    let told = failure.to_string();
    assert!(told.contains("stiff") && told.contains("radau"), "{told}");
}

/// A warning names BDF of order 3 and more if it amplifies an undamped spring.
#[test]
fn an_unstable_formula_is_told() {
    let path =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("problems/benchmarks/stiff_pendulum.json");
    let text = std::fs::read_to_string(path).expect("a problem");
    let mut document: serde_json::Value = serde_json::from_str(&text).expect("valid JSON");
    document["loads"]["spring"]["spring"]["stiffness"] = json!(1e6);
    for (order, told) in [(2, false), (3, true), (4, true), (5, true)] {
        document["simulation"] = json!({
            "duration": 0.3, "steps": 300, "method": {"bdf": {"order": order}}
        });
        let problem = Problem::parse(&document.to_string(), "stiff.json", &[]).expect("no faults");
        let motion = simulate(&problem, &problem.start()).expect("runs");
        assert_eq!(motion.warning.is_some(), told, "order {order}");
        if let Some(warning) = motion.warning {
            assert!(
                warning.contains("\"spring\"") && warning.contains("bdf"),
                "{warning}"
            );
        }
    }
}

/// Steps are kept for designs near the first, stretched to the duration, and chosen again if they
/// are no longer accurate.
#[test]
fn steps_are_kept_until_they_do_not_suffice() {
    let problem = load("trebuchet_release_time", &["/simulation/tolerance=1e-6"]);
    let start = problem.start();
    let mut integration = Integration::new(&problem, &problem.scene(&start), Some(&[0]), false);
    let mut ends = Vec::new();
    for (moved, refreshed) in [(0.0, true), (1e-3, false), (-2e-3, false)] {
        let mut x = start.clone();
        x[6] += moved;
        let (at, changed) = Evaluated::with(&mut integration, &problem, &x).expect("runs");
        assert_eq!(changed.is_some(), refreshed, "{moved}");
        assert_eq!(at.run.duration, x[6]);
        ends.push(at.run.grid.ends().to_vec());
    }
    assert_eq!(ends[0], ends[1]);
    assert_eq!(ends[0], ends[2]);
    assert_eq!(integration.refreshes, 0);
    // A different throw: a light sling, released late.
    let far = [500.0, 8.0, 30.0, 0.004, 0.02, -0.3, 1.8];
    let (at, changed) = Evaluated::with(&mut integration, &problem, &far).expect("runs");
    let changed = changed.expect("steps that suffice");
    let why = &changed.reason;
    assert!(
        why.contains("exceeds") || why.contains("too large"),
        "{why}"
    );
    assert_eq!(integration.refreshes, 1);
    assert!(at.run.step_error <= 1e-6);
    let Some((settings, _)) = integration.chosen() else {
        panic!("a design was simulated");
    };
    assert_eq!(settings.spacing, Spacing::Frozen(at.run.grid.clone()));
}

/// A load of 1 N s that lasts 0.2 of 10 s acts on a body at rest. The steps resolve it without
/// notice.
#[test]
fn a_short_load_is_not_stepped_over() {
    let file = json!({
        "version": 1, "name": "blow", "gravity": [0, 0, 0],
        "bodies": {"ball": {"shape": {"sphere": {"radius": 0.1}}, "mass": 1}},
        "loads": {"blow": {"force": {
            "body": "ball", "direction": [1, 0, 0],
            "magnitude": {"table": {"times": [5, 5.1, 5.2], "values": [0, 10, 0]}}
        }}},
        "simulation": {"duration": 10},
        "functions": {"x": {"final": {"position": {"body": "ball", "direction": [1, 0, 0]}}}}
    });
    let problem = Problem::parse(&file.to_string(), "blow.json", &[]).expect("no faults");
    let motion = simulate(&problem, &[]).expect("runs");
    let x = motion.at.function(0).value;
    assert!((x - 4.9).abs() < 1e-12, "{x}");
}

/// Steps end at the kinks of a linear table, and at the ends of the rounded parts of a motion.
#[test]
fn steps_end_where_a_table_is_not_smooth() {
    let file = json!({
        "version": 1, "name": "kinks", "gravity": [0, 0, 0],
        "bodies": {
            "ball": {"shape": {"sphere": {"radius": 0.1}}, "mass": 1},
            "slide": {"shape": {"box": {"size": [0.1, 0.1, 0.1]}}, "mass": 1}
        },
        "joints": {"guide": {"prismatic": {"between": ["slide", "ground"], "at": [0, 0, 0],
                                           "axis": [0, 1, 0]}}},
        "drives": {"cam": {"joint": "guide", "slide": {"table": {
            "times": [0.25, 0.75, 1.25], "values": [0, 0.2, 0.2], "interpolation": "linear"}}}},
        "loads": {"pull": {"force": {
            "body": "ball", "direction": [1, 0, 0],
            "magnitude": {"table": {"times": [0.3, 0.7, 1.1], "values": [0, 3, 1],
                                    "interpolation": "linear"}}
        }}},
        "simulation": {"duration": 2, "tolerance": 1e-10},
        "functions": {
            "v": {"final": {"velocity": {"body": "ball", "direction": [1, 0, 0]}}},
            "dwell": {"ks": {"rho": 1e6, "of": {"position": {"body": "slide",
                                                             "direction": [0, 1, 0]}}}}
        }
    });
    let problem = Problem::parse(&file.to_string(), "kinks.json", &[]).expect("no faults");
    let motion = simulate(&problem, &[]).expect("runs");
    let ends = motion.at.run.grid.ends();
    for time in [0.25, 0.3, 0.35, 0.65, 0.7, 0.75, 0.85, 1.1, 1.15, 1.25] {
        let near = ends.iter().any(|end| (end * 2.0 - time).abs() < 1e-12);
        assert!(near, "no step ends at {time}");
    }
    // Impulse 0.6 + 0.8, then 1 N for 0.9 s.
    let v = motion.at.function(0).value;
    assert!((v - 2.3).abs() < 1e-12, "{v}");
    let highest = motion.at.function(1).maximum.expect("an aggregate").value;
    assert!((highest - 0.2).abs() < 1e-9, "{highest}");
}

/// A weight on a damped spring.
const SAG: &str = r#"{
  "version": 1, "name": "sag",
  "bodies": {"weight": {"shape": "point", "mass": 1, "place": {"at": [0, -1, 0]}}},
  "loads": {"spring": {"spring": {"between": ["weight", "ground"],
    "at": {"a": [0, 0, 0], "b": [0, 0, 0]}, "rest_length": 1, "stiffness": 100, "damping": 10}}},
  "simulation": {"duration": 1, "steps": 200},
  "functions": {"height": {"final": {"position": {"body": "weight", "direction": [0, 1, 0]}}}},
  "variables": {"stiffness": {"path": "/loads/spring/spring/stiffness", "lower": 0, "scale": 1}},
  "objective": {"maximise": "height"}
}"#;

/// If a design is stiff for the given explicit steps, another method continues. A resumed run that
/// has that design from its log continues with it, too.
#[test]
fn a_method_that_took_over_stays_in_a_resumed_run() {
    let problem = Problem::parse(SAG, "sag.json", &[]).expect("no faults");
    let run = |earlier: &[EvaluationRecord]| {
        let mut records = earlier.to_vec();
        let log = KnownEvaluations::new(earlier.to_vec(), |record| records.push(record));
        let mut program = Evaluator::new(&problem, log).expect("has an objective");
        let mut found = Vec::new();
        for stiffness in [100.0, 2e6, 150.0] {
            let values = program.evaluate(&[stiffness]).expect("runs");
            let gradients = program.gradients(&[stiffness]).expect("differentiates");
            found.extend([values.objective, gradients.objective[0]].map(f64::to_bits));
        }
        let (settings, reason) = program.integration.chosen().expect("is chosen");
        let end = (settings.method, reason.to_owned(), program.counts());
        drop(program);
        (found, end, records)
    };
    let whole = run(&[]);
    let (_, (method, reason, _), records) = &whole;
    assert_eq!(*method, Method::Radau { stages: 3 });
    // The run fails after three steps, before stiffness is detected.
    assert!(
        reason.contains("explicit steps of this size fail"),
        "{reason}"
    );
    let steps = |record: &&EvaluationRecord| matches!(record.found, Found::Steps(_));
    assert_eq!(
        (records.len(), records.iter().filter(steps).count()),
        (8, 2)
    );
    for known in (0..=records.len()).filter(|&k| k == 0 || !steps(&&records[k - 1])) {
        assert!(run(&records[..known]) == whole, "with {known} records");
    }
}

/// A spring pendulum with a damper, with stiffness k, damping ratio ζ and tolerance.
fn damped_spring(stiffness: f64, ratio: f64, tolerance: f64, method: Option<&str>) -> Problem {
    let damping = 2.0 * ratio * stiffness.sqrt();
    let mut document = json!({
        "version": 1, "name": "damped spring", "gravity": [0, -9.81, 0],
        "bodies": {"bob": {"shape": {"sphere": {"radius": 0.05}}, "mass": 1, "place": {"at": [1, 0, 0]}}},
        "loads": {"spring": {"spring": {"between": ["bob", "ground"], "at": {"a": [0, 0, 0], "b": [0, 0, 0]},
            "rest_length": 1, "stiffness": stiffness, "damping": damping}}},
        "simulation": {"duration": 2, "tolerance": tolerance, "samples": 1}
    });
    if let Some(method) = method {
        document["simulation"]["method"] = serde_json::from_str(method).expect("JSON");
    }
    Problem::parse(&document.to_string(), "spring.json", &[]).unwrap_or_else(|f| panic!("{f}"))
}

/// Work of a run in evaluations of the accelerations; infinite if it fails.
fn work(problem: &Problem) -> (f64, Option<Method>) {
    let scene = problem.scene::<f64>(&problem.start());
    let settings = flexbody_mechanics::integrate::Settings {
        spacing: problem.simulation.spacing.clone(),
        samples: flexbody_mechanics::integrate::Samples::Uniform(1),
        ..flexbody_mechanics::integrate::Settings::steps(Method::Dop853, 1)
    };
    let method = problem.simulation.method;
    let found =
        flexbody_mechanics::integrate::simulate_by(&scene.model, scene.duration, method, &settings);
    let Ok(found) = found else {
        return (f64::INFINITY, None);
    };
    let counts = found.run.counts;
    let work = match found.run.method {
        Method::Dop853 => 12.0 * (counts.steps + counts.rejected) as f64,
        _ => counts.implicit_work(),
    };
    (work, Some(found.run.method))
}

const RADAU: &str = r#"{"radau": {"stages": 3}}"#;

/// Prints the work of the chosen method and of both methods; returns the largest ratio to the
/// better one.
fn shares(cases: impl Iterator<Item = [f64; 3]>) -> f64 {
    println!("stiffness  damping  tolerance  |    dop853      radau3     chosen   share");
    let mut worst = 0.0_f64;
    for [stiffness, ratio, tolerance] in cases {
        let of = |method| work(&damped_spring(stiffness, ratio, tolerance, method)).0;
        let (chosen, method) = work(&damped_spring(stiffness, ratio, tolerance, None));
        let both = [of(Some(r#""dop853""#)), of(Some(RADAU))];
        let share = chosen / both[0].min(both[1]);
        worst = worst.max(share);
        println!(
            "{stiffness:9.0e}  {ratio:7.2}  {tolerance:9.0e}  | {:9.0}   {:9.0}  {chosen:9.0}   {share:5.2}  {}",
            both[0],
            both[1],
            method.map_or("-".into(), Method::name)
        );
    }
    worst
}

/// The chosen method needs at most 1.5 times the work of the better one.
#[test]
fn the_method_that_costs_less_is_chosen() {
    let cases = [
        [1e2, 0.1, 1e-7],
        [1e4, 3.0, 1e-9],
        [1e6, 1.0, 1e-5],
        [1e6, 3.0, 1e-9],
        [1e8, 1.0, 1e-7],
        [1e8, 10.0, 1e-11],
    ];
    let worst = shares(cases.into_iter());
    assert!(worst < 1.5, "{worst}");
    // Strong dampers, which h |λ| alone does not indicate.
    let problem = load("benchmarks/flyball_governor", &["/simulation/duration=1"]);
    let document = problem.document.to_string().replace(RADAU, "null");
    let mut document: serde_json::Value = serde_json::from_str(&document).expect("JSON");
    let simulation = document["simulation"].as_object_mut().expect("an object");
    simulation.shift_remove("method");
    let problem = Problem::parse(&document.to_string(), "governor.json", &[]).expect("no faults");
    let motion = simulate(&problem, &problem.start()).expect("runs");
    assert_eq!(
        motion.at.run.method,
        Method::Radau { stages: 3 },
        "{}",
        motion.reason
    );
    assert!(
        motion.reason.contains("of the work of dop853"),
        "{}",
        motion.reason
    );
}

/// The whole family of cases.
#[test]
#[ignore = "a table of 480 runs"]
fn the_method_that_costs_less_is_chosen_over_decades() {
    let stiffness = [1e0, 1e2, 1e4, 1e6, 1e8].into_iter();
    let cases = stiffness.flat_map(|k| {
        [0.0, 0.1, 1.0, 10.0]
            .into_iter()
            .flat_map(move |ratio| (4..=11).map(move |digits| [k, ratio, 10_f64.powi(-digits)]))
    });
    let worst = shares(cases);
    println!("worst share {worst:.2}");
}

/// A bar on a hinge and a spring: equal explicit steps that are too large for the spring are
/// rejected where the motion is lost, for any damping.
#[test]
fn explicit_steps_that_are_too_large_are_refused() {
    let (mut refused, mut kept) = (0, 0);
    for stiffness in [1e1_f64, 1e2, 1e4, 1e6, 1e8] {
        for damping in [0.0, 10.0, 1e3] {
            for steps in [30, 100, 1500] {
                let file = json!({
                    "version": 1, "name": "sprung bar", "gravity": [0, -9.81, 0],
                    "bodies": {"bar": {"shape": {"box": {"size": [1, 0.1, 0.1]}}, "mass": 1,
                                       "place": {"at": [0.5, 0, 0]}}},
                    "joints": {"hinge": {"revolute": {"between": ["bar", "ground"], "at": [0, 0, 0],
                                                      "axis": [0, 0, 1]}}},
                    "loads": {"spring": {"spring": {"between": ["bar", "ground"],
                                                    "at": [[0.5, 0, 0], [1, 1, 0]], "rest_length": 1,
                                                    "stiffness": stiffness, "damping": damping}}},
                    "simulation": {"duration": 10, "steps": steps, "method": "dop853"},
                    "functions": {"speed": {"ks": {"of": {"speed": {"body": "bar"}}, "rho": 1}}}
                });
                let problem =
                    Problem::parse(&file.to_string(), "bar.json", &[]).expect("no faults");
                match simulate(&problem, &[]) {
                    Err(failure) => {
                        let told = failure.to_string();
                        let named = ["too large", "stiff", "not finite", "singular"];
                        assert!(named.iter().any(|name| told.contains(name)), "{told}");
                        refused += 1;
                    }
                    // The energy bounds the speed of the bar.
                    Ok(run) => {
                        let most = (3.0 * (9.81 + stiffness)).sqrt();
                        let speed = run.at.function(0).value;
                        assert!(
                            speed < most,
                            "{stiffness:e}, {damping}, {steps}: {speed} > {most}"
                        );
                        kept += 1;
                    }
                }
            }
        }
    }
    assert!(refused >= 10 && kept >= 10, "{refused}, {kept}");
}

/// The smallest step depends on the scene, not on the duration.
#[test]
fn long_durations_are_simulated_with_any_tolerance() {
    for (duration, tolerance) in [
        (1e3, 1e-9),
        (1e9, 1e-9),
        (1e9, 1e-13),
        (1e-9, 1e-13),
        (1e15, 1e-6),
    ] {
        let spin = 10.0 / duration;
        let file = json!({
            "version": 1, "name": "bar", "gravity": [0, 0, 0],
            "bodies": {"bar": {"shape": {"box": {"size": [1, 0.1, 0.1]}}, "mass": 1,
                               "place": {"at": [0.5, 0, 0]},
                               "velocity": {"linear": [0, 0.5 * spin, 0], "angular": [0, 0, spin]}}},
            "joints": {"hinge": {"revolute": {"between": ["bar", "ground"], "at": [0, 0, 0],
                                              "axis": [0, 0, 1]}}},
            "simulation": {"duration": duration, "tolerance": tolerance},
            "functions": {"angle": {"final": {"rotation": {"body": "bar", "axis": [0, 0, 1]}}}}
        });
        let mut falling = file.clone();
        let problem = Problem::parse(&file.to_string(), "bar.json", &[]).expect("no faults");
        let run = simulate(&problem, &[]).unwrap_or_else(|e| panic!("{duration:e}: {e}"));
        let error = (run.at.function(0).value - 10.0).abs();
        assert!(
            error < 100.0 * tolerance + 1e-11,
            "{duration:e}, {tolerance:e}: {error:e}"
        );
        if duration == 1e9 {
            // The number of its oscillations exceeds that of possible steps, and the message says
            // so.
            falling["gravity"] = json!([0, -9.81, 0]);
            let problem = Problem::parse(&falling.to_string(), "bar.json", &[]).expect("no faults");
            let told = simulate(&problem, &[])
                .map(|_| ())
                .expect_err("too long")
                .to_string();
            assert!(told.contains("makes no headway"), "{told}");
        }
    }
}
