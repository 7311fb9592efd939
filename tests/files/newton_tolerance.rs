//! The work of steps that follow a tolerance in flexible scenes: Newton's method ends at a part of the tolerance, with values
//! and gradients near those of the same steps solved to round-off.

use super::modal::data;
use crate::reference::documents::{problem, read};
use flexbody_driver::evaluate::Evaluated;
use flexbody_mechanics::integrate::{MEMORY, Method, Settings, Spacing, StepSolver, simulate};
use flexbody_problem::Problem;
use serde_json::Value;

/// The bracket whose stiff modes have much round-off, for the first tenth of a second.
fn bracket() -> Value {
    let mut file = read("problems/flexible/modal_bracket.json");
    let place = data("").replace("tests/data/modal/", "problems/flexible/");
    file["bodies"]["bracket"]["modal"]["source"] = json!({"dmig": {
        "nodes": format!("{place}modal_bracket.nodes"), "file": format!("{place}modal_bracket.pch")}});
    file["simulation"]["duration"] = json!(0.1);
    file
}

/// The settings of a simulation of the file, by Radau IIA with three stages.
fn settings(problem: &Problem) -> Settings {
    let spacing = problem.simulation.spacing.clone();
    Settings {
        solver: StepSolver::suited(problem.simulation.solver, &spacing),
        spacing,
        memory: MEMORY,
        ..Settings::steps(Method::Radau { stages: 3 }, 1)
    }
}

/// The largest relative difference of the numbers of two rows, each against the largest of the row.
fn apart(a: &[f64], b: &[f64]) -> f64 {
    let largest = b.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    let pairs = a.iter().zip(b);
    pairs.fold(0.0, |most, (a, b)| most.max((a - b).abs() / largest))
}

/// Work a step of scenes of beams and of a body from files, with that of rejected steps; values and gradients to 1e-8.
#[test]
fn newton_is_as_accurate_as_the_steps() {
    let files = [
        bracket(),
        read("problems/flexible/trebuchet_flexible_arm.json"),
    ];
    for file in files {
        let problem = problem(&file);
        let x = problem.start();
        let scene = problem.scene::<f64>(&x);
        let loose = settings(&problem);
        let run = simulate(&scene.model, scene.duration, &loose).expect("runs");
        let (counts, steps) = (run.counts, run.counts.steps as f64);
        let [iterations, factorisations] =
            [counts.newton_iterations, counts.factorisations].map(|n| n as f64 / steps);
        let name = problem.name();
        assert!(iterations <= 6.0, "{name}: {iterations} iterations a step");
        // A real and a complex matrix, and one for the accelerations at the start of a step.
        assert!(factorisations <= 3.0, "{name}: {factorisations} a step");

        let tight = Settings {
            solver: StepSolver::default(),
            spacing: Spacing::Frozen(run.grid.clone()),
            ..loose
        };
        let exact = simulate(&scene.model, scene.duration, &tight).expect("runs");
        let at = Evaluated::new(&problem, &x).expect("runs");
        let [at, exact] = [run, exact].map(|run| at.with_run(scene.clone(), run));
        let which: Vec<usize> = (0..problem.function_names.len()).collect();
        let rows = |at: &Evaluated| at.gradients(&problem, &which).expect("gradients").0;
        for (f, (a, b)) in rows(&at).iter().zip(rows(&exact)).enumerate() {
            let difference = apart(a, &b);
            let value = |at: &Evaluated| at.function(f).value;
            let moved = (value(&at) / value(&exact) - 1.0).abs();
            let what = format!("{name}: {}", problem.function_names[f]);
            assert!(
                difference < 1e-8 && moved < 1e-8,
                "{what}: {difference:e}, {moved:e}"
            );
            assert!(difference > 0.0, "{what}: the runs are the same");
        }
    }
}
