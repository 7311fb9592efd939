//! Runs that end at an event: closed forms of time, position and derivatives, and gradients against
//! the complex step by several methods.

use crate::reference::documents::{self, problem};
use flexbody_driver::integration::Integration;
use flexbody_driver::{Evaluated, Optimisation, check, simulate};
use flexbody_mechanics::integrate::IntegrationFailure;
use flexbody_problem::Problem;
use flexbody_report::{Optimum, summary};
use serde_json::Value;

/// A ball is thrown up and forward, until it returns to a height.
fn throw(simulation: Value) -> Value {
    json!({
        "version": 1, "name": "throw",
        "bodies": {"ball": {"shape": "point", "mass": 2, "velocity": {"linear": [3, 4, 0]}}},
        "simulation": simulation,
        "functions": {"x": {"final": {"position": {"body": "ball", "direction": [1, 0, 0]}}}},
        "variables": {"speed": {"path": "/bodies/ball/velocity/linear/1"},
                      "along": {"path": "/bodies/ball/velocity/linear/0"},
                      "height": {"path": "/simulation/until/reaches"}}
    })
}

/// The measure of the ball's height.
fn height() -> Value {
    json!({"position": {"body": "ball", "direction": [0, 1, 0]}})
}

/// T = (u + √(u² − 2 g h)) / g for a height h < 0, and its derivatives, by every family of methods.
#[test]
fn a_throw_ends_where_its_parabola_does() {
    let (u, v, h, g) = (4.0_f64, 3.0, -1.5, 9.81);
    let root = (u * u - 2.0 * g * h).sqrt();
    let duration = (u + root) / g;
    let exact = [v * (1.0 + u / root) / g, duration, -v / root];
    for (key, value, method) in [
        ("tolerance", json!(1e-9), json!("dop853")),
        ("tolerance", json!(1e-9), json!({"radau": {"stages": 3}})),
        ("steps", json!(20), json!({"radau": {"stages": 2}})),
    ] {
        let until = json!({"measure": height(), "reaches": h});
        let mut simulation = json!({"duration": 3, "until": until, "method": method});
        simulation[key] = value;
        let problem = problem(&throw(simulation));
        let at = Evaluated::new(&problem, &problem.start()).expect("runs");
        assert!(
            (at.run.duration - duration).abs() <= 1e-14,
            "{method}: {}",
            at.run.duration
        );
        assert!(
            (at.function(0).value - v * duration).abs() <= 1e-13,
            "{method}"
        );
        let (gradient, _) = at.gradients(&problem, &[0]).expect("differentiates");
        for (given, exact) in gradient[0].iter().zip(exact) {
            assert!(
                (given - exact).abs() <= 1e-12,
                "{method}: {given} against {exact}"
            );
        }
    }
}

/// A height that is passed upwards and downwards ends the run at the first passage.
#[test]
fn the_first_of_several_events_counts() {
    let until = json!({"measure": height(), "reaches": 0.5});
    let file = throw(json!({"duration": 3, "until": until}));
    let problem = problem(&file);
    let at = Evaluated::new(&problem, &problem.start()).expect("runs");
    let first = (4.0 - (16.0_f64 - 9.81).sqrt()) / 9.81;
    assert!(
        (at.run.duration - first).abs() <= 1e-14,
        "{}",
        at.run.duration
    );
}

/// A slider driven at 0.5 m/s pulls the foot of a rod of length L whose end slides up a wall: at height −c below its start
/// after T = √(1 − (1 − c)²)/0.5 s (L = 1 m), while the rod would be at its dead point after 2 s. The end of the motion
/// that is waited for does not matter, by any method.
#[test]
fn an_event_comes_before_a_motion_that_fails_later() {
    let inertia = json!({"xx": 1, "yy": 1, "zz": 1});
    for (simulation, fall) in [
        (json!({"duration": 4}), 0.2_f64),
        (json!({"duration": 40}), 0.6),
        (
            json!({"duration": 2.5, "tolerance": 1e-7, "method": {"radau": {"stages": 3}}}),
            0.2,
        ),
        (
            json!({"duration": 4, "steps": 400, "method": "dop853"}),
            0.2,
        ),
        (
            json!({"duration": 4, "steps": 400, "method": {"radau": {"stages": 3}}}),
            0.4,
        ),
        (
            json!({"duration": 3, "steps": 400, "method": {"bdf": {"order": 2}}}),
            0.3,
        ),
        (
            json!({"duration": 4, "steps": 400, "method": {"generalised_alpha": {"radius": 0.8}}}),
            0.2,
        ),
    ] {
        let mut simulation = simulation;
        simulation["until"] = json!({"measure": {"slide": {"joint": "wall"}}, "reaches": -fall});
        let document = json!({
            "version": 1, "name": "ladder", "gravity": [0, 0, 0],
            "bodies": {
                "foot": {"mass": 1, "inertia": inertia},
                "top": {"mass": 1, "inertia": inertia, "place": {"at": [0, 1, 0]}}
            },
            "joints": {
                "floor": {"prismatic": {"between": ["foot", "ground"], "at": [0, 0, 0], "axis": [1, 0, 0]}},
                "wall": {"prismatic": {"between": ["top", "ground"], "at": [0, 1, 0], "axis": [0, 1, 0]}},
                "ladder": {"rod": {"between": ["foot", "top"], "at": [[0, 0, 0], [0, 1, 0]]}}
            },
            "drives": {"pull": {"joint": "floor", "slide": {"rate": 0.5}}},
            "simulation": simulation, "functions": {"T": "duration"}
        });
        let problem = problem(&document);
        let at = Evaluated::new(&problem, &problem.start()).expect("runs");
        let exact = 2.0 * (1.0 - (1.0 - fall) * (1.0 - fall)).sqrt();
        assert!(
            (at.run.duration / exact - 1.0).abs() < 1e-6,
            "{simulation}: {}",
            at.run.duration
        );
    }
}

#[test]
fn an_event_that_does_not_come_is_named() {
    let until = json!({"measure": height(), "reaches": 2});
    let problem = problem(&throw(json!({"duration": 3, "until": until})));
    let failure = simulate(&problem, &problem.start()).err().expect("fails");
    let IntegrationFailure::NotReached { nearest, .. } = &failure else {
        panic!("{failure}");
    };
    // The nearest sample to the distance 2 − u²/(2 g).
    assert!((nearest - (2.0 - 16.0 / 19.62)).abs() < 1e-4, "{nearest}");
    let text = failure.to_string();
    assert!(
        text.contains("the position of the event does not reach 2 within 3 s"),
        "{text}"
    );
}

/// A double pendulum with a spring, until its second bar has turned: every function, by all
/// families of methods.
#[test]
fn gradients_are_those_of_the_complex_step() {
    for (key, value, method) in [
        ("tolerance", json!(1e-8), json!("dop853")),
        ("tolerance", json!(1e-6), json!({"radau": {"stages": 3}})),
        ("steps", json!(60), json!({"bdf": {"order": 2}})),
        (
            "steps",
            json!(60),
            json!({"generalised_alpha": {"radius": 0.8}}),
        ),
    ] {
        let mut file = json!({
            "version": 1, "name": "pendulum",
            "bodies": {
                "upper": {"shape": {"box": {"size": [1, 0.1, 0.1]}}, "mass": 1,
                          "points": {"root": [-0.5, 0, 0], "tip": [0.5, 0, 0]},
                          "place": {"put": "root"}},
                "lower": {"shape": {"box": {"size": [1, 0.1, 0.1]}}, "mass": 0.6,
                          "points": {"root": [-0.5, 0, 0], "tip": [0.5, 0, 0]},
                          "place": {"put": "root", "at": "upper.tip"}}
            },
            "joints": {
                "hinge": {"revolute": {"between": ["upper", "ground"], "at": "upper.root",
                                       "axis": [0, 0, 1]}},
                "elbow": {"universal": {"between": ["upper", "lower"], "at": "upper.tip",
                                        "axis": [0, 0, 1], "cross": [0, 1, 0]}}
            },
            "loads": {"spring": {"torsion_spring": {"joint": "hinge", "stiffness": 2}}},
            "simulation": {
                "duration": 2, "method": method,
                "until": {"measure": {"rotation": {"body": "lower", "axis": [0, 0, 1]}},
                          "reaches": -0.8}
            },
            "functions": {
                "tip": {"final": {"position": {"body": "lower", "point": "tip",
                                               "direction": [0.6, 0.8, 0]}}},
                "work": {"integral": {"energy": "kinetic"}},
                "rush": {"ks": {"rho": 2, "of": {"speed": {"body": "lower"}}}}
            },
            "variables": {
                "angle": {"path": "/simulation/until/reaches"},
                "stiffness": {"path": "/loads/spring/torsion_spring/stiffness", "lower": 0.1},
                "mass": {"path": "/bodies/lower/mass", "lower": 0.1},
                "length": {"path": "/bodies/upper/points/tip/0", "lower": 0.1}
            }
        });
        file["simulation"][key] = value;
        let problem = problem(&file);
        let found = check(&problem, &problem.start()).expect("runs");
        assert_eq!(found.len(), 12);
        for derivative in &found {
            let of = found.iter().filter(|d| d.function == derivative.function);
            let largest = of.fold(0.0_f64, |m, d| m.max(d.complex_step.abs()));
            assert!(
                derivative.complex_step.abs() > 1e-3 * largest,
                "{derivative:?}"
            );
            let off = (derivative.adjoint - derivative.complex_step).abs();
            assert!(off <= 1e-12 * largest, "{method}: {derivative:?}");
        }
    }
}

fn optimised(file: &Value) -> (Problem, Optimisation) {
    let problem = problem(file);
    let done = documents::optimised(&problem);
    (problem, done)
}

fn design(problem: &Problem, done: &Optimisation) -> Vec<f64> {
    let value = |name: &String| done.optimum.design[name].value;
    problem.variables.iter().map(|v| value(&v.name)).collect()
}

/// The longest throw ends at the longest waiting time, the softest one touches its height. With
/// their own steps, both end at their event.
#[test]
fn an_optimum_ends_at_its_event_by_steps_of_its_own_too() {
    let until = |reaches: f64| json!({"measure": height(), "reaches": reaches});
    for (spacing, value) in [("tolerance", json!(1e-6)), ("steps", json!(40))] {
        let mut simulation = json!({"duration": 3, "until": until(-1.5)});
        simulation[spacing] = value.clone();
        let mut file = throw(simulation);
        file["variables"] =
            json!({"speed": {"path": "/bodies/ball/velocity/linear/1", "lower": 1, "upper": 40}});
        file["objective"] = json!({"maximise": "x"});
        file["optimiser"] = json!({"evaluations": 100});
        let (long, done) = optimised(&file);
        let x = design(&long, &done);
        let at =
            simulate(&long, &x).unwrap_or_else(|failure| panic!("{spacing} {value}: {failure}"));
        let duration = at.at.run.duration;
        assert!(
            duration > 2.8 && duration <= 3.0,
            "{spacing} {value}: {duration}"
        );

        file["simulation"]["until"] = until(1.0);
        file["bodies"]["ball"]["velocity"]["linear"] = json!([3, 8, 0]);
        file["functions"] = json!({"pace": {"final": {"speed": {"body": "ball"}}}});
        file["objective"] = json!({"minimise": "pace"});
        let (soft, done) = optimised(&file);
        let x = design(&soft, &done);
        simulate(&soft, &x).unwrap_or_else(|failure| panic!("{spacing} {value}: {failure}"));
        // At its greatest height the ball moves forward: 3 m/s.
        let pace = done.optimum.objective.value;
        assert!((3.0..3.1).contains(&pace), "{spacing} {value}: {pace}");
    }
}

/// A start without values does not enter the optimum.
#[test]
fn a_start_that_misses_its_event_has_no_objective() {
    // With 4 m/s the ball reaches 0.8155 m.
    let mut file = throw(json!({"duration": 3, "until": {"measure": height(), "reaches": 0.82}}));
    file["variables"] =
        json!({"speed": {"path": "/bodies/ball/velocity/linear/1", "lower": 4, "upper": 10}});
    file["objective"] = json!({"minimise": "x"});
    let (_, done) = optimised(&file);
    assert!(done.outcome.converged() && done.start.is_none());
    assert_eq!(done.optimum.start_objective, None);
    let told = done.optimum.warnings.iter();
    let told: Vec<_> = told
        .filter(|w| w.contains("not known at the start"))
        .collect();
    assert!(
        told.len() == 1 && told[0].contains("does not reach 0.82"),
        "{told:?}"
    );
    let text = done.optimum.to_json().expect("is written");
    assert_eq!(Optimum::from_json(&text).expect("is read"), done.optimum);
    assert!(summary(&done.optimum).contains("x: not known → "));
}

/// Frozen steps that find the event of another design but are not accurate are chosen again for the
/// whole waiting time, not only up to the event.
#[test]
fn steps_are_chosen_anew_for_the_whole_time() {
    let file = json!({
        "version": 1, "name": "elastic pendulum",
        "bodies": {"bob": {"shape": "point", "mass": 1, "place": {"at": [0, -1, 0]},
                           "velocity": {"linear": [1.5, 0, 0]}}},
        "loads": {"spring": {"spring": {"between": ["bob", "ground"],
            "at": {"a": [0, 0, 0], "b": [0, 0, 0]}, "rest_length": 1, "stiffness": 100}}},
        "simulation": {
            "duration": 2, "tolerance": 1e-9,
            "until": {"measure": {"position": {"body": "bob", "direction": [1, 0, 0]}},
                      "reaches": 0.4}
        },
        "functions": {"y": {"final": {"position": {"body": "bob", "direction": [0, 1, 0]}}}},
        "variables": {"stiffness": {"path": "/loads/spring/spring/stiffness", "lower": 1}}
    });
    let problem = problem(&file);
    let scene = problem.scene(&problem.start());
    let mut integration = Integration::new(&problem, &scene, Some(&[0]), true);
    for stiffness in [100.0, 2000.0, 300.0, 5000.0, 8000.0] {
        let x = [stiffness];
        let (kept, _) = Evaluated::with(&mut integration, &problem, &x).expect("runs");
        let alone = Evaluated::new(&problem, &x).expect("runs");
        let off = kept.run.duration - alone.run.duration;
        assert!(off.abs() < 1e-7, "{stiffness}: {off}");
    }
    assert!(integration.refreshes > 1, "{}", integration.refreshes);
}

/// A bob on a massless rod is released at an angle. It swings until the hinge is at its lowest
/// point.
fn clock(angle: f64, constraints: Value) -> Problem {
    let length = 1.3;
    problem(&json!({
        "version": 1, "name": "clock",
        "bodies": {"bob": {
            "mass": 1, "inertia": {"xx": 1e-30, "yy": 1e-30, "zz": 1e-30},
            "points": {"pin": [0, length, 0]},
            "place": {"put": "pin", "turn": {"axis": [0, 0, 1], "angle": angle}}
        }},
        "joints": {"pin": {"revolute": {"between": ["ground", "bob"], "at": "bob.pin",
                                        "axis": [0, 0, 1]}}},
        "simulation": {"duration": 4, "tolerance": 1e-12, "until": {
            "measure": {"angle": {"joint": "pin"}}, "reaches": -angle}},
        "functions": {
            "quarter": "duration",
            "path": {"integral": {"speed": {"body": "bob"}}},
            "square": {"integral": {"speed_squared": {"body": "bob"}}}
        },
        "variables": {"length": {"path": "/bodies/bob/points/pin/1", "lower": 0.2, "upper": 3}},
        "constraints": constraints
    }))
}

/// A quarter of a pendulum's period is (π/2) √(l/g) / agm(1, cos ½θ). Its derivative in the length
/// is half of it divided by the length. The integral of the speed is the length of the arc.
#[test]
fn the_time_of_an_event_is_a_function() {
    for angle in [0.3_f64, 1.0, 2.5] {
        let (mut a, mut b) = (1.0, (0.5 * angle).cos());
        for _ in 0..8 {
            (a, b) = (0.5 * (a + b), f64::sqrt(a * b));
        }
        let quarter = 0.5 * std::f64::consts::PI * f64::sqrt(1.3 / 9.81) / a;
        let problem = clock(angle, json!({}));
        let at = Evaluated::new(&problem, &problem.start()).expect("runs");
        let found = at.function(0).value;
        assert!((found - quarter).abs() <= 1e-10, "{found} and {quarter}");
        let (gradient, _) = at.gradients(&problem, &[0]).expect("differentiates");
        let slope = 0.5 * quarter / 1.3;
        assert!(
            (gradient[0][0] - slope).abs() <= 1e-9,
            "{gradient:?} and {slope}"
        );
        assert!((at.function(1).value - 1.3 * angle).abs() <= 1e-5);
        for derivative in check(&problem, &problem.start()).expect("runs") {
            assert!(derivative.relative_difference() < 1e-10, "{derivative:?}");
        }
        let units = [0, 1, 2].map(|f| problem.function_unit(f));
        assert_eq!(units, ["s", "m", "m²/s"]);
    }
}

/// Without an objective, the feasible design nearest to that of the file is found.
#[test]
fn a_problem_of_constraints_alone_is_made_feasible() {
    let second = json!({"second": {"function": "quarter", "lower": 0.5, "upper": 0.5}});
    let done = documents::optimised(&clock(0.3, second));
    let length = done.optimum.design["length"].value;
    let at = |length: f64| {
        let problem = clock(0.3, json!({}));
        Evaluated::new(&problem, &[length])
            .expect("runs")
            .function(0)
            .value
    };
    assert_eq!(done.optimum.status, "converged", "{}", done.optimum.message);
    assert!((at(length) - 0.5).abs() < 1e-6, "{length}");
    // A feasible file stays as it is.
    let loose = json!({"loose": {"function": "quarter", "lower": 0.1, "upper": 2}});
    let done = documents::optimised(&clock(0.3, loose));
    assert_eq!(done.optimum.status, "converged", "{}", done.optimum.message);
    assert!((done.optimum.design["length"].value - 1.3).abs() < 1e-6);
    // A file that cannot be feasible is reported so.
    let never = json!({"never": {"function": "quarter", "lower": 3}});
    let done = documents::optimised(&clock(0.3, never));
    assert_ne!(done.optimum.status, "converged", "{}", done.optimum.message);
}

/// The time at which a ball that is thrown up at 5 m/s passes a height, whatever the samples: the first
/// passage is found inside one step, and inside one interval of samples.
#[test]
fn both_passages_inside_one_interval_of_samples() {
    let (u, g) = (5.0_f64, 9.81);
    for (samples, spacing, h) in [
        (Some(3), json!(1e-9), 0.63),
        (Some(1), json!(1e-5), 1.27),
        (Some(2), json!(1e-9), 1.274),
        (None, json!(1e-9), 1.2742),
        (None, json!(7), 0.4),
        (Some(5), json!(9), 1.1),
        (Some(2), json!(6), 0.9),
    ] {
        for method in [
            json!("dop853"),
            json!({"radau": {"stages": 3}}),
            json!({"bdf": {"order": 2}}),
        ] {
            let is_bdf = method["bdf"].is_object();
            let until = json!({"measure": height(), "reaches": h});
            let mut simulation = json!({"duration": 20, "until": until, "method": method});
            match (spacing.as_i64(), samples) {
                (Some(_), Some(_)) | (None, _) if is_bdf => continue,
                (Some(steps), _) if is_bdf => simulation["steps"] = json!(steps * 20),
                (Some(steps), _) => simulation["steps"] = json!(steps),
                (None, _) => simulation["tolerance"] = spacing.clone(),
            }
            if let Some(samples) = samples {
                simulation["samples"] = json!(samples);
            }
            let mut file = throw(simulation);
            file["bodies"]["ball"]["velocity"]["linear"] = json!([3, u, 0]);
            let problem = problem(&file);
            let what = format!("{method} {spacing} {samples:?} {h}");
            let at = simulate(&problem, &problem.start())
                .unwrap_or_else(|failure| panic!("{what}: {failure}"));
            let root = (u * u - 2.0 * g * h).sqrt();
            let exact = (u - root) / g;
            // BDF2 is exact for parabolas but for its start, which is.
            let off = (at.at.run.duration - exact).abs();
            assert!(off <= 1e-9, "{what}: {} for {exact}", at.at.run.duration);
            let (found, _) = at.at.gradients(&problem, &[0]).expect("differentiates");
            // dT/du = −T / (u − g T) before the top.
            let by_speed = -3.0 * exact / root;
            assert!(
                (found[0][0] - by_speed).abs() <= 1e-6,
                "{what}: {}",
                found[0][0]
            );
        }
    }
}

/// A height that is touched at the top has no derivative; one that is missed is not reached.
#[test]
fn an_event_that_only_touches_is_named() {
    let g = 9.81;
    for (u, method) in [
        (4.0_f64, json!("dop853")),
        (0.3, json!({"radau": {"stages": 2}})),
        (11.0, json!({"radau": {"stages": 3}})),
    ] {
        let top = u * u / (2.0 * g);
        let of = |height_of_event: f64| {
            let until = json!({"measure": height(), "reaches": height_of_event});
            let mut file = throw(json!({"duration": 3, "until": until, "method": method}));
            file["bodies"]["ball"]["velocity"]["linear"] = json!([3, u, 0]);
            let problem = problem(&file);
            simulate(&problem, &problem.start()).map(|found| {
                let gradient = found.at.gradients(&problem, &[0]);
                gradient.map(|_| ()).map_err(|failure| failure.to_string())
            })
        };
        let said = match of(top) {
            Ok(gradient) => gradient.expect_err("has no derivative"),
            Err(failure) => failure.to_string(),
        };
        assert!(
            said.contains("touches") && said.contains("derivative"),
            "{u}: {said}"
        );
        assert!(of(top * (1.0 - 1e-6)).expect("crosses").is_ok());
        let missed = of(top * (1.0 + 1e-4)).expect_err("misses");
        assert!(
            matches!(missed, IntegrationFailure::NotReached { .. }),
            "{missed}"
        );
    }
}
