//! Samples of stored steps are those of repeated ones, and cost no step.

use crate::reference::documents::{problem, read};
use flexbody_driver::integration::Integration;
use flexbody_mechanics::adjoint::gradients;
use flexbody_mechanics::functions::Scene;
use flexbody_mechanics::integrate::{
    MEMORY, Method, Samples, Settings, Spacing, Trajectory, simulate,
};
use serde_json::Value;

/// A disc that winds up a torsion spring by several turns while a pendulum hangs from its rim.
fn winding() -> Value {
    json!({
        "version": 1, "name": "winding",
        "bodies": {
            "disc": {"mass": 1, "inertia": {"xx": 0.4, "yy": 0.4, "zz": 0.8}},
            "bob": {"mass": 0.05, "inertia": {"xx": 1e-4, "yy": 1e-4, "zz": 1e-4}, "points": {"pin": [0, 0.3, 0]},
                "place": {"put": "pin", "at": [0.2, 0, 0]}}
        },
        "joints": {
            "axle": {"revolute": {"between": ["disc", "ground"], "at": [0, 0, 0], "axis": [0, 0, 1],
                "start": {"turn": {"rate": 25}}}},
            "pin": {"revolute": {"between": ["bob", "disc"], "at": [0.2, 0, 0], "axis": [0, 0, 1]}}
        },
        "loads": {"spring": {"torsion_spring": {"joint": "axle", "stiffness": 1.5}}},
        "simulation": {"duration": 1.2},
        "functions": {
            "angle": {"integral": {"angle": {"joint": "axle"}}},
            "reach": {"ks": {"of": {"position": {"body": "bob", "direction": [0, 1, 0]}}, "rho": 40}}
        }
    })
}

/// Scenes and durations \[s\]: loops, drives, a flexible body, and turns that are counted.
fn scenes() -> Vec<(Scene<f64>, f64)> {
    let mut all: Vec<(Scene<f64>, f64)> = [
        ("problems/trebuchet.json", 1.0),
        ("problems/benchmarks/andrews_squeezer.json", 0.004),
        ("tests/data/driven_slider_crank.json", 0.5),
        ("problems/flexible/spin_up.json", 0.5),
    ]
    .map(|(path, duration)| {
        let problem = problem(&read(path));
        (problem.scene(&problem.start()), duration)
    })
    .to_vec();
    let winding = problem(&winding());
    all.push((winding.scene(&winding.start()), 1.2));
    all
}

/// Some steps without cells, others with several.
fn cells(run: &Trajectory<f64>) -> Vec<u32> {
    (0..run.grid.steps() as u32)
        .map(|k| [1, 0, 3, 2, 0][k as usize % 5])
        .collect()
}

/// Largest difference of two rows of numbers, relative to the largest.
fn difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    let size = a.iter().fold(f64::MIN_POSITIVE, |m, x| m.max(x.abs()));
    a.iter()
        .zip(b)
        .fold(0.0, |m: f64, (a, b)| m.max((a - b).abs()))
        / size
}

fn derivatives(scene: &Scene<f64>, run: &Trajectory<f64>) -> Vec<f64> {
    let which: Vec<usize> = (0..scene.functions.len().min(3)).collect();
    let found = gradients(scene, run, &which).expect("differentiates");
    assert_eq!(found.counts.recomputed, 0, "the steps are stored");
    found
        .gradients
        .iter()
        .flat_map(|own| own.parameters())
        .collect()
}

#[test]
fn stored_steps_have_the_samples_and_gradients_of_repeated_ones() {
    for (s, (scene, duration)) in scenes().into_iter().enumerate() {
        let scene = Scene { duration, ..scene };
        for method in [
            Method::Dop853,
            Method::Radau { stages: 3 },
            Method::Radau { stages: 2 },
        ] {
            if method == Method::Dop853 && !scene.model.flexible.is_empty() {
                continue;
            }
            let what = format!("scene {s}, {}", method.name());
            let mut settings = Settings::steps(method, 1);
            settings.spacing = Spacing::Tolerance(1e-6);
            settings.samples = Samples::Quadrature(37);
            settings.memory = MEMORY;
            let run = simulate(&scene.model, duration, &settings).expect("runs");
            let (cells, before) = (cells(&run), run.counts);
            settings.spacing = Spacing::Frozen(run.grid.clone().with_cells(cells.clone()));
            let again = simulate(&scene.model, duration, &settings).expect("runs");
            let run = run
                .resampled(&scene.model, cells, settings.samples)
                .expect("all is stored");
            assert_eq!(run.counts.steps, before.steps, "{what}");
            assert_eq!(
                run.counts.newton_iterations, before.newton_iterations,
                "{what}"
            );
            assert!(
                run.counts.evaluations <= before.evaluations + 3 * before.steps,
                "{what}"
            );
            assert_eq!(run.grid, again.grid, "{what}");
            assert_eq!(run.instants, again.instants, "{what}");
            assert_eq!(run.places, again.places, "{what}");
            assert_eq!(run.shown, again.shown, "{what}");
            assert!(difference(&run.weights, &again.weights) < 1e-15, "{what}");
            assert!(difference(&run.moving, &again.moving) < 1e-15, "{what}");
            for (a, b) in [(&run.q, &again.q), (&run.v, &again.v)] {
                let off = difference(a, b);
                assert!(off < 1e-10, "{what}: {off:e}");
            }
            let off = difference(&derivatives(&scene, &run), &derivatives(&scene, &again));
            assert!(off < 1e-8, "{what}: {off:e}");
            // Cells that are asked for later need stages that were not kept.
            let all = vec![2; run.grid.steps()];
            settings.spacing = Spacing::Frozen(run.grid.clone().with_cells(all.clone()));
            let again = simulate(&scene.model, duration, &settings).expect("runs");
            let run = run
                .resampled(&scene.model, all, settings.samples)
                .expect("all is stored");
            let off = difference(&run.q, &again.q);
            assert!(off < 1e-10, "{what}: {off:e}");
            let off = difference(&derivatives(&scene, &run), &derivatives(&scene, &again));
            assert!(off < 1e-8, "{what}: {off:e}");
        }
    }
}

#[test]
fn a_motion_without_stored_steps_has_no_other_samples() {
    let (scene, duration) = scenes().remove(0);
    let mut settings = Settings::steps(Method::Dop853, 1);
    settings.spacing = Spacing::Tolerance(1e-6);
    settings.samples = Samples::Quadrature(0);
    settings.memory = 0;
    let run = simulate(&scene.model, duration, &settings).expect("runs");
    let cells = cells(&run);
    assert!(
        run.resampled(&scene.model, cells, settings.samples)
            .is_none()
    );
}

/// The cells of sums are found on one motion; only the stages inside steps are added.
#[test]
fn sums_cost_one_motion() {
    for file in ["problems/trebuchet.json", "problems/bump_stop.json"] {
        let problem = problem(&read(file));
        let mut scene = problem.scene(&problem.start());
        let mut whole = Integration::new(&problem, &scene, None, false);
        let (run, _) = whole.simulate(&mut scene).expect("runs");
        let plain = Settings {
            method: Method::Dop853,
            samples: Samples::Uniform(1),
            memory: 0,
            derivatives: true,
            spacing: problem.simulation.spacing.clone(),
            ..Settings::steps(Method::Dop853, 1)
        };
        let one = simulate(&scene.model, scene.duration, &plain).expect("runs");
        let most = one.counts.evaluations + 4 * run.grid.steps();
        let found = run.counts.evaluations;
        assert!(found <= most, "{file}: {found} evaluations of {most}");
        assert_eq!(run.bytes()[1], 0, "{file}: no gradient is asked");
    }
}

/// The damping ratio of two pendulums with a spring between is zero but for round-off, which needs no cells.
#[test]
fn round_off_needs_no_cells() {
    let rod = |length: f64, z: f64| {
        json!({"shape": {"rod": {"length": length}}, "mass": 1, "points": {"a": [-0.5 * length, 0, 0]},
            "place": {"put": "a", "at": [0, 0, z], "turn": {"z": -60}}})
    };
    let hinge = |body: &str| json!({"revolute": {"between": [body, "ground"], "at": format!("{body}.a"), "axis": [0, 0, 1]}});
    let problem = problem(&json!({
        "version": 1, "name": "pair",
        "bodies": {"u": rod(1.0, 0.0), "l": rod(0.7, 1.0)},
        "joints": {"j": hinge("u"), "k": hinge("l")},
        "loads": {"s": {"spring": {"between": ["l", "u"], "at": {"a": [0.1, 0, 0], "b": [0.2, 0, 0]}, "rest_length": 0.9, "stiffness": 50}}},
        "simulation": {"duration": 0.5},
        "functions": {"z": {"mean": {"damping_ratio": {"mode": 1}}}}
    }));
    let mut scene = problem.scene(&problem.start());
    let (run, _) = Integration::new(&problem, &scene, None, false)
        .simulate(&mut scene)
        .expect("runs");
    let most = (1..=run.grid.steps()).map(|k| run.grid.cells(k)).max();
    assert_eq!(most, Some(1));
}
