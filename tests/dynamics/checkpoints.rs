//! Gradients with repeated steps equal those with stored steps, and repeat as many as binomial
//! checkpointing says.

use crate::reference::documents::{problem, read};
use flexbody_driver::evaluate::Evaluated;
use flexbody_driver::integration::Integration;
use flexbody_mechanics::adjoint::gradients;
use flexbody_mechanics::functions::Scene;
use flexbody_mechanics::integrate::schedule::{Schedule, advances};
use flexbody_mechanics::integrate::{
    MEMORY, Method, Samples, Settings, Spacing, Start, Tape, Trajectory, simulate,
};

fn scene(path: &str) -> Scene<f64> {
    let problem = problem(&read(path));
    problem.scene(&problem.start())
}

/// Largest relative difference of two gradients.
fn difference(a: &Scene<f64>, b: &Scene<f64>) -> f64 {
    let (a, b) = (a.parameters(), b.parameters());
    let size = a.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    let off = a.iter().zip(&b).fold(0.0_f64, |m, (a, b)| {
        assert!(a.is_finite() && b.is_finite());
        m.max((a - b).abs())
    });
    if off == 0.0 { 0.0 } else { off / size }
}

/// Scenes and durations \[s\]: with a tree, with loops, with driven joints, and with bodies so
/// different that sparse LU is used.
fn scenes() -> Vec<(Scene<f64>, f64)> {
    let mut unlike = read("problems/extreme/double_pendulum.json");
    let bodies = unlike["bodies"].as_object_mut().expect("bodies");
    let first = bodies.values_mut().next().expect("a body");
    first["mass"] = json!(1e-7);
    let unlike = problem(&unlike);
    let mut all: Vec<(Scene<f64>, f64)> = [
        ("problems/triple_pendulum.json", 0.5),
        ("problems/trebuchet.json", 1.0),
        ("problems/benchmarks/andrews_squeezer.json", 0.004),
        ("tests/data/driven_slider_crank.json", 0.5),
    ]
    .map(|(path, duration)| (scene(path), duration))
    .to_vec();
    all.push((unlike.scene(&unlike.start()), 0.3));
    all
}

fn methods() -> [Method; 9] {
    let bdf = |order, start| Method::Bdf { order, start };
    [
        Method::Dop853,
        Method::Radau { stages: 2 },
        Method::Radau { stages: 3 },
        bdf(1, Start::Radau),
        bdf(2, Start::RisingOrder),
        bdf(4, Start::Radau),
        bdf(5, Start::RisingOrder),
        bdf(6, Start::Radau),
        Method::GeneralisedAlpha { radius: 0.8 },
    ]
}

fn schedule(run: &Trajectory<f64>) -> Schedule {
    match &run.tape {
        Tape::Explicit(tape) => tape.schedule(run.grid.steps()),
        Tape::Implicit(tape) => tape.schedule(run.grid.steps()),
    }
}

/// Gradients of the first `count` functions in `memory`, and the number of repeated steps.
fn found(
    (scene, duration): (&Scene<f64>, f64),
    settings: &Settings,
    (memory, count): (usize, usize),
) -> (Vec<Scene<f64>>, usize, Trajectory<f64>) {
    let settings = Settings {
        memory,
        ..settings.clone()
    };
    let scene = Scene {
        duration,
        ..scene.clone()
    };
    let run = simulate(&scene.model, duration, &settings).expect("runs");
    let which: Vec<usize> = (0..count.min(scene.functions.len())).collect();
    let adjoint = gradients(&scene, &run, &which).expect("differentiates");
    (adjoint.gradients, adjoint.counts.recomputed, run)
}

/// Memory of all steps of a run with these settings \[bytes\].
fn whole(scene: (&Scene<f64>, f64), settings: &Settings) -> usize {
    let run = found(scene, settings, (MEMORY, 1)).2;
    run.checkpoint_plan(run.grid.steps()).1
}

#[test]
fn every_method_in_any_memory_finds_the_same_gradients() {
    for (s, (scene, duration)) in scenes().iter().enumerate() {
        let at = (scene, *duration);
        for method in methods() {
            let [few, many] = [&[0.0, 0.15, 0.4, 0.9][..], &[0.1, 0.5][..]];
            for (steps, count, parts) in [(24, 1, few), (61, 9, many)] {
                let mut settings = Settings::steps(method, steps);
                if steps == 61 {
                    settings.samples = Samples::Uniform(40);
                }
                let (kept, none, _) = found(at, &settings, (MEMORY, count));
                assert_eq!(none, 0);
                let whole = whole(at, &settings);
                for &part in parts {
                    let memory = ((part * whole as f64) as usize).max(1);
                    let (again, recomputed, run) = found(at, &settings, (memory, count));
                    let what = format!("scene {s}, {}, {steps} steps, {part}", method.name());
                    for (kept, again) in kept.iter().zip(&again) {
                        let off = difference(kept, again);
                        assert!(off <= 1e-14, "{what}: {off:e}");
                    }
                    let schedule = schedule(&run);
                    assert!(!schedule.keeps_all(), "{what}");
                    assert_eq!(recomputed, schedule.recomputed(), "{what}");
                    let binomial = advances(
                        schedule.head().div_ceil(schedule.block()) + 1,
                        schedule.checkpoints(),
                    );
                    assert!(recomputed <= schedule.block() * binomial, "{what}");
                    if schedule.head().is_multiple_of(schedule.block()) {
                        assert_eq!(recomputed, schedule.block() * binomial, "{what}");
                    }
                }
            }
        }
    }
}

/// Adaptive steps: rejected tries affect the pivots. If the memory does not suffice, the whole
/// motion is repeated once more, because the number of steps was unknown.
#[test]
fn steps_that_were_chosen_on_the_way_are_made_again_as_they_were() {
    for (s, (scene, duration)) in scenes().iter().enumerate() {
        let at = (scene, *duration);
        for method in &methods()[..3] {
            let mut settings = Settings::steps(*method, 1);
            settings.spacing = Spacing::Tolerance(1e-6);
            settings.samples = Samples::Uniform(50);
            let (kept, _, run) = found(at, &settings, (MEMORY, 3));
            let steps = run.grid.steps();
            for part in [0.0, 0.1, 0.5, 0.9] {
                let memory = ((part * run.bytes()[1] as f64) as usize).max(1);
                let (again, recomputed, own) = found(at, &settings, (memory, 3));
                let what = format!("scene {s}, {}, {steps} steps, {part}", method.name());
                assert_eq!(own.grid, run.grid, "{what}");
                for (kept, again) in kept.iter().zip(&again) {
                    let off = difference(kept, again);
                    assert!(off <= 1e-14, "{what}: {off:e}");
                }
                let most = schedule(&own).recomputed() + steps;
                assert!((steps..=most).contains(&recomputed), "{what}: {recomputed}");
            }
        }
    }
}

/// A gradient of a motion without stored steps repeats it once.
#[test]
fn a_motion_that_kept_nothing_is_made_again_once() {
    let scene = scene("problems/triple_pendulum.json");
    for method in methods() {
        let settings = Settings::steps(method, 60);
        let (kept, ..) = found((&scene, 0.5), &settings, (MEMORY, 2));
        let (again, recomputed, run) = found((&scene, 0.5), &settings, (0, 2));
        assert_eq!((recomputed, run.bytes()[1] < 2000), (60, true));
        for (kept, again) in kept.iter().zip(&again) {
            assert!(difference(kept, again) <= 1e-14, "{method:?}");
        }
    }
}

/// Problems whose duration is a variable or ends at an event, with steps chosen at one design and
/// frozen for another.
#[test]
fn durations_and_events_are_differentiated_alike() {
    for path in [
        "problems/trebuchet_release_time.json",
        "problems/trebuchet_release_angle.json",
    ] {
        let mut problem = problem(&read(path));
        let which: Vec<usize> = (0..problem.function_names.len()).collect();
        let start = problem.start();
        let near: Vec<f64> = start.iter().map(|x| x * 1.001).collect();
        let mut of = |memory: usize| {
            problem.simulation.memory = Some(memory);
            let mut integration =
                Integration::new(&problem, &problem.scene(&start), Some(&which), true);
            [&start, &near].map(|x| {
                let (at, _) = Evaluated::with(&mut integration, &problem, x).expect("runs");
                let (found, counts) = at.gradients(&problem, &which).expect("differentiates");
                (found, counts.recomputed, at.run.grid.steps())
            })
        };
        let kept = of(MEMORY);
        for memory in [0, 100_000, 400_000] {
            for (kept, again) in kept.iter().zip(of(memory)) {
                assert_eq!((kept.1, kept.2), (0, again.2));
                assert!(again.1 > 0, "{path} in {memory}: {again:?}");
                for (a, b) in kept.0.iter().zip(&again.0) {
                    let size = a.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
                    for (a, b) in a.iter().zip(b) {
                        assert!((a - b).abs() <= 1e-14 * size, "{path} in {memory}: {a} {b}");
                    }
                }
            }
        }
    }
}

/// The data do not exceed the memory. A thirtieth of the memory costs one more run of the explicit
/// method, whose checkpoints are small relative to its stages, and up to three of Radau IIA; an eighth costs one.
#[test]
fn memory_is_not_exceeded() {
    let scene = scene("problems/triple_pendulum.json");
    for method in [Method::Dop853, Method::Radau { stages: 3 }] {
        let mut settings = Settings::steps(method, 2000);
        settings.samples = Samples::Uniform(1);
        let whole = whole((&scene, 1.0), &settings);
        for part in [8, 30] {
            let memory = whole / part;
            let (_, recomputed, run) = found((&scene, 1.0), &settings, (memory, 1));
            assert!(run.bytes()[1] <= memory, "{method:?}, 1/{part}");
            assert_eq!(recomputed, schedule(&run).recomputed());
            let runs = match (method, part) {
                (Method::Radau { .. }, 30) => 3,
                _ => 1,
            };
            let most = 2000 * runs;
            assert!((most - 2000..most).contains(&recomputed), "{recomputed}");
        }
    }
}
