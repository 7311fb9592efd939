//! Reductions change nothing but round-off: every problem of the package is run with and without
//! them, with the same steps. Reductions that do not apply are named with the reason.

mod explanation;
mod oblique;
mod planes;
mod points;
mod reactions;
use crate::reference;
use crate::reference::documents::problem as parse;
mod unseen;
mod welds;

use flexbody_driver::Evaluated;
use flexbody_mechanics::integrate::{
    MEMORY, Method, Samples, Settings, Spacing, StepSolver, simulate,
};
use flexbody_mechanics::lower::ViolatedCondition;
use flexbody_mechanics::system::flexible::has_shells;
use flexbody_problem::{Override, Problem};
use serde_json::Value;
use std::path::{Path, PathBuf};

fn path(file: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(file)
}

fn load(file: &str, changes: &[&str]) -> Problem {
    let parse = |text: &&str| Override::parse(text).expect("an override");
    let changes: Vec<Override> = changes.iter().map(parse).collect();
    Problem::load(&path(file), &changes).unwrap_or_else(|faults| panic!("{faults}"))
}

/// A problem of the package with changes to its document.
fn changed(file: &str, change: impl FnOnce(&mut Value)) -> Problem {
    let text = std::fs::read_to_string(path(file)).expect("a problem file");
    let mut document: Value = serde_json::from_str(&text).expect("JSON");
    change(&mut document);
    parse(&document)
}

/// A design simulated with given settings.
fn run(problem: &Problem, settings: &Settings) -> Evaluated {
    let x = problem.start();
    let scene = problem.scene::<f64>(&x);
    let run = simulate(&scene.model, scene.duration, settings)
        .unwrap_or_else(|failure| panic!("{}: {failure}", problem.name));
    Evaluated {
        x,
        scene,
        run,
        composition: problem.composition.clone(),
    }
}

fn unlowered(problem: &Problem) -> Problem {
    let mut problem = problem.clone();
    problem.lowering = None;
    problem
}

fn is_planar(problem: &Problem) -> bool {
    let lowering = problem.lowering.as_ref().expect("a lowered problem");
    lowering.plane.is_ok()
}

fn obstacle(problem: &Problem) -> ViolatedCondition {
    let lowering = problem.lowering.as_ref().expect("a lowered problem");
    let kept = lowering
        .plane
        .clone()
        .expect_err("a scene that leaves every plane");
    kept.obstacles[0].clone()
}

fn settings(method: Method, spacing: Spacing) -> Settings {
    Settings {
        method,
        solver: StepSolver::default(),
        spacing,
        samples: Samples::Uniform(50),
        limits: Default::default(),
        memory: MEMORY,
        derivatives: false,
    }
}

fn relative(a: &[f64], b: &[f64]) -> f64 {
    let size = b.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    let off = |(a, b): (&f64, &f64)| (a - b).abs();
    let off = a.iter().zip(b).map(off).fold(0.0, f64::max);
    if off == 0.0 { 0.0 } else { off / size }
}

/// Largest differences of states, functions and gradients with and without reductions, relative to
/// the largest.
fn differences(problem: &Problem, settings: &Settings) -> [f64; 3] {
    let full = unlowered(problem);
    let (a, b) = (run(problem, settings), run(&full, settings));
    // The redundant rows of the joints differ.
    assert_eq!(a.run.grid.ends(), b.run.grid.ends());
    let which: Vec<usize> = (0..a.scene.functions.len()).collect();
    let (_, motion) = a.written(problem);
    let states = relative(&motion.q, &b.run.q).max(relative(&motion.v, &b.run.v));
    let mut worst = [states, 0.0, 0.0];
    for &f in &which {
        let (a, b) = (a.function(f).value, b.function(f).value);
        worst[1] = f64::max(worst[1], relative(&[a], &[b]));
    }
    if !a.x.is_empty() {
        let (of_a, _) = a.gradients(problem, &which).expect("regular");
        let (of_b, _) = b.gradients(&full, &which).expect("regular");
        for (a, b) in of_a.iter().zip(&of_b) {
            worst[2] = f64::max(worst[2], relative(a, b));
        }
    }
    worst
}

/// Number of unknowns and of imposed rows of the reduced start of a problem.
fn size(problem: &Problem) -> (usize, usize) {
    let model = problem.scene::<f64>(&problem.start()).model;
    let numbering = flexbody_mechanics::system::Numbering::new(&model);
    let imposed = model.joints.iter().map(|joint| joint.imposed().count());
    (numbering.unknowns(), imposed.sum())
}

const RADAU: Method = Method::Radau { stages: 3 };
const BDF: Method = Method::Bdf {
    order: 2,
    start: flexbody_mechanics::integrate::Start::Radau,
};

/// The problems, whether they are planar, the methods, and the limits of round-off. The squeezer
/// magnifies round-off by its fast rotation, the stiff pendulum by its spring. The rows of four
/// bars stop before their first singular position, where the motion is not determined
/// (`benchmarks.rs` runs them through it with reductions).
#[test]
fn every_problem_moves_the_same_lowered() {
    let all: [(&str, bool, &[Method], f64); 26] = [
        ("bump_stop", true, &[Method::Dop853, RADAU], 1e-10),
        ("cart_pole", true, &[Method::Dop853, RADAU], 1e-10),
        ("desk_lamp", true, &[Method::Dop853], 1e-11),
        ("rotor", false, &[Method::Dop853], 1e-11),
        ("fit_pendulum", true, &[Method::Dop853, RADAU], 1e-11),
        (
            "gripper",
            false,
            &[Method::GeneralisedAlpha { radius: 0.8 }],
            1e-10,
        ),
        ("jumping_leg", true, &[Method::Dop853, RADAU], 1e-10),
        ("planetary_gear", true, &[Method::Dop853], 1e-9),
        ("quadruped", false, &[Method::Dop853, RADAU], 1e-11),
        ("straight_line", true, &[Method::Dop853, RADAU], 1e-11),
        ("trebuchet", true, &[Method::Dop853, RADAU, BDF], 1e-11),
        (
            "trebuchet_release_time",
            true,
            &[Method::Dop853, RADAU, BDF],
            1e-11,
        ),
        ("trebuchet_release_angle", true, &[Method::Dop853], 1e-11),
        (
            "triple_pendulum",
            false,
            &[Method::Dop853, RADAU, BDF],
            1e-11,
        ),
        (
            "benchmarks/andrews_squeezer",
            true,
            &[Method::Dop853, RADAU],
            1e-9,
        ),
        (
            "benchmarks/balanced_slider_crank",
            true,
            &[Method::Dop853, RADAU],
            1e-11,
        ),
        (
            "benchmarks/brachistochrone",
            true,
            &[Method::Dop853, RADAU],
            1e-9,
        ),
        ("benchmarks/bricard", false, &[Method::Dop853, RADAU], 1e-11),
        ("benchmarks/flyball_governor", false, &[RADAU], 1e-11),
        ("benchmarks/four_bars_1", true, &[Method::Dop853], 1e-11),
        ("benchmarks/four_bars_2", true, &[Method::Dop853], 1e-11),
        ("benchmarks/four_bars_10", true, &[Method::Dop853], 1e-11),
        ("benchmarks/four_bars_40", true, &[Method::Dop853], 1e-11),
        (
            "benchmarks/simple_pendulum",
            true,
            &[Method::Dop853, RADAU],
            1e-11,
        ),
        ("benchmarks/stiff_pendulum", true, &[RADAU], 5e-9),
        (
            "benchmarks/two_link_reach",
            true,
            &[Method::Dop853, RADAU],
            1e-10,
        ),
    ];
    let mut files: Vec<PathBuf> = Vec::new();
    for folder in ["problems", "problems/benchmarks"] {
        let entries = std::fs::read_dir(path(folder)).expect("a folder");
        let entries = entries.map(|entry| entry.expect("an entry").path());
        files.extend(entries.filter(|entry| entry.extension().is_some_and(|kind| kind == "json")));
    }
    // Structures without motion have nothing to lower, and a problem of cases or events has several scenes.
    files.retain(|file| {
        let text = std::fs::read_to_string(file).expect("a problem file");
        let document: Value = serde_json::from_str(&text).expect("JSON");
        let other = ["structures", "cases", "events"];
        other.iter().all(|key| document.get(key).is_none())
    });
    let listed = |file: &PathBuf| {
        let file = file
            .strip_prefix(path("problems"))
            .expect("below")
            .with_extension("");
        all.iter().any(|(name, ..)| file == Path::new(name))
    };
    for file in &files {
        assert!(listed(file), "{} is not in the list", file.display());
    }
    for (name, planar, methods, round_off) in all {
        let short: &[&str] = match name.contains("four_bars") {
            true => &["/simulation/duration=0.5"],
            false => &[],
        };
        let mut problem = load(&format!("problems/{name}.json"), short);
        if problem.scene::<f64>(&problem.start()).until.is_some() {
            // Up to the event, as the run.
            let seen = flexbody_driver::simulate(&problem, &problem.start()).expect("a run");
            let end = format!("/simulation/duration={}", seen.at.run.duration);
            problem = load(&format!("problems/{name}.json"), &[&end]);
        }
        assert_eq!(is_planar(&problem), planar, "{name}");
        for &method in methods {
            let spacing = match method.is_adaptive() {
                _ if problem.is_rest() => Spacing::Steps(0),
                true => {
                    let scene = problem.scene::<f64>(&problem.start());
                    let chosen = settings(method, Spacing::Tolerance(1e-6));
                    let run = simulate(&scene.model, scene.duration, &chosen);
                    Spacing::Frozen(run.expect("a run").grid)
                }
                false => Spacing::Steps(400),
            };
            let found = differences(&problem, &settings(method, spacing));
            for x in found {
                assert!(x <= round_off, "{name} by {}: {found:?}", method.name());
            }
        }
    }
}

/// The extreme scenes as in their files, if they run. A scene that fails with reductions also fails
/// without. Most gradients of the parallelogram are zero; their round-off is not compared. Chains of a thousand bodies are
/// those of a hundred.
#[test]
fn every_extreme_scene_moves_the_same_lowered() {
    let entries = std::fs::read_dir(path("problems/extreme")).expect("a folder");
    let mut ran = Vec::new();
    for entry in entries.map(|entry| entry.expect("an entry").path()) {
        // Of the chains the short ones: the bodies of the others are the same.
        let name = entry.to_string_lossy();
        if name.ends_with("00.json") {
            continue;
        }
        let Ok(mut problem) = Problem::load(&entry, &[]) else {
            continue;
        };
        if problem.name == "parallelogram" {
            problem = load(
                "problems/extreme/parallelogram.json",
                &["/simulation/duration=1"],
            );
        }
        let mut scene = problem.scene::<f64>(&problem.start());
        if has_shells(&scene.model) {
            // Explicit steps of shells are short.
            let duration = format!("/simulation/duration={}", 0.01 * scene.duration);
            problem = load(entry.to_str().expect("a path"), &[&duration]);
            scene = problem.scene::<f64>(&problem.start());
        }
        let chosen = settings(Method::Dop853, Spacing::Tolerance(1e-8));
        let grid = match simulate(&scene.model, scene.duration, &chosen) {
            Ok(run) => run.grid,
            Err(failure) => {
                let written = problem.unlowered_scene::<f64>(&problem.start());
                let other = simulate(&written.model, written.duration, &chosen);
                assert!(other.is_err(), "{}: {failure}", problem.name);
                continue;
            }
        };
        let found = differences(&problem, &settings(Method::Dop853, Spacing::Frozen(grid)));
        let compared = if problem.name == "parallelogram" {
            2
        } else {
            3
        };
        for x in &found[..compared] {
            assert!(*x <= 1e-10, "{}: {found:?}", problem.name);
        }
        ran.push(problem.name);
    }
    assert!(ran.len() >= 9, "{ran:?}");
}
