//! What is left out of a scene changes nothing but round-off: every problem of the package is run
//! lowered and as it is written, with the same steps. What has to stay is named with its reason.

use flexbody::adjoint;
use flexbody::driver::Evaluated;
use flexbody::integrate::{Grid, Method, Samples, Settings, Spacing, simulate};
use flexbody::lower::Obstacle;
use flexbody::problem::{Override, Problem};
use std::path::{Path, PathBuf};

fn path(file: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(file)
}

fn load(file: &str, changes: &[&str]) -> Problem {
    let parse = |text: &&str| Override::parse(text).expect("an override");
    let changes: Vec<Override> = changes.iter().map(parse).collect();
    Problem::load(&path(file), &changes).unwrap_or_else(|faults| panic!("{faults}"))
}

/// A design simulated with given settings.
fn run(problem: &Problem, settings: &Settings) -> Evaluated {
    let x = problem.start();
    let scene = problem.scene::<f64>(&x);
    let run = simulate(&scene.model, scene.duration, settings)
        .unwrap_or_else(|failure| panic!("{}: {failure}", problem.name));
    Evaluated { x, scene, run }
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

fn obstacle(problem: &Problem) -> Obstacle {
    let lowering = problem.lowering.as_ref().expect("a lowered problem");
    lowering
        .plane
        .clone()
        .expect_err("a scene that leaves every plane")
}

fn settings(method: Method, spacing: Spacing) -> Settings {
    Settings {
        method,
        spacing,
        samples: Samples::Uniform(50),
        keep_stages: true,
    }
}

fn relative(a: &[f64], b: &[f64]) -> f64 {
    let size = b.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    let off = a
        .iter()
        .zip(b)
        .fold(0.0_f64, |m, (a, b)| m.max((a - b).abs()));
    if off == 0.0 { 0.0 } else { off / size }
}

/// Largest differences of the states, of the functions and of the gradients, relative to the
/// largest.
fn differences(problem: &Problem, settings: &Settings) -> [f64; 3] {
    let full = unlowered(problem);
    let (a, b) = (run(problem, settings), run(&full, settings));
    assert_eq!(a.run.grid, b.run.grid);
    let which: Vec<usize> = (0..a.scene.functions.len()).collect();
    let mut worst = [
        relative(&a.run.q, &b.run.q).max(relative(&a.run.v, &b.run.v)),
        0.0,
        0.0,
    ];
    for &f in &which {
        let (a, b) = (a.function(f).value, b.function(f).value);
        worst[1] = f64::max(worst[1], relative(&[a], &[b]));
    }
    if !a.x.is_empty() {
        let (ga, _) = a.gradients(problem, &which).expect("regular");
        let (gb, _) = b.gradients(&full, &which).expect("regular");
        for (a, b) in ga.iter().zip(&gb) {
            worst[2] = f64::max(worst[2], relative(a, b));
        }
    }
    worst
}

#[test]
fn every_problem_moves_the_same_lowered() {
    for file in std::fs::read_dir(path("problems/benchmarks"))
        .expect("a folder")
        .map(|e| e.expect("an entry").path())
        .chain(
            [
                "problems/trebuchet.json",
                "problems/trebuchet_release_time.json",
                "problems/triple_pendulum.json",
            ]
            .map(|p| path(p)),
        )
    {
        let problem = load(file.strip_prefix(path("")).unwrap().to_str().unwrap(), &[]);
        println!(
            "{}: {}",
            problem.name,
            match &problem.lowering.as_ref().unwrap().plane {
                Ok(p) => format!("planar {:?}", p.normal.as_slice()),
                Err(e) => e.to_string(),
            }
        );
        for method in [Method::Dop853, Method::Radau { stages: 3 }] {
            let t = std::time::Instant::now();
            let scene = problem.scene::<f64>(&problem.start());
            let chosen = simulate(
                &scene.model,
                scene.duration,
                &settings(method, Spacing::Tolerance(1e-6)),
            );
            let Ok(chosen) = chosen else {
                println!("  {} {}", method.name(), chosen.err().unwrap());
                continue;
            };
            let d = differences(&problem, &settings(method, Spacing::Frozen(chosen.grid)));
            println!("  {} {d:?} {:?}", method.name(), t.elapsed());
        }
    }
}
