//! The time loops do not allocate, forwards and backwards: runs of n and of 2 n frozen steps make
//! equal numbers of allocations, because memory for their history is reserved.

use flexbody_mechanics::adjoint::gradients;
use flexbody_mechanics::functions::Scene;
use flexbody_mechanics::integrate::{Grid, Method, Samples, Settings, Spacing, Start, simulate};
use flexbody_problem::Problem;
use std::path::Path;

/// Allocations of this thread while `f` runs.
fn allocations(f: impl FnOnce()) -> u64 {
    allocation_counter::measure(f).count_total
}

fn scene(path: &str) -> Scene<f64> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(path);
    let problem = Problem::load(&path, &[]).unwrap_or_else(|faults| panic!("{faults}"));
    problem.scene(&problem.start())
}

/// Allocations of a run and of its adjoint, with samples inside the steps; and its grid.
fn of_run(scene: &Scene<f64>, duration: f64, settings: &Settings) -> ([u64; 2], Grid) {
    let mut run = None;
    let forwards = allocations(|| {
        run = Some(simulate(&scene.model, duration, settings).expect("runs"));
    });
    let run = run.expect("it ran");
    let backwards = allocations(|| {
        gradients(scene, &run, &[0]).expect("differentiates");
    });
    ([forwards, backwards], run.grid)
}

/// As [`of_run`], for equal steps.
fn of_steps(scene: &Scene<f64>, duration: f64, steps: usize, method: Method) -> [u64; 2] {
    let mut settings = Settings::steps(method, steps);
    if method.is_adaptive() {
        settings.samples = Samples::Uniform(3 * steps);
    }
    of_run(scene, duration, &settings).0
}

/// Largest difference by reused vectors until each has had its largest size: in the backward march,
/// and in an LU factorisation that changes its pivots.
const GROWTH: u64 = 10;

/// Scenes: trees, in a plane and in space, with loops, and with driven joints; and durations.
const SCENES: [(&str, f64); 4] = [
    ("problems/trebuchet.json", 1.0),
    ("problems/triple_pendulum.json", 0.5),
    ("problems/benchmarks/andrews_squeezer.json", 0.004),
    ("tests/data/driven_slider_crank.json", 0.5),
];

/// Asserts that twice the steps need no more allocations, up to `growth` forwards and backwards.
fn assert_none(what: &str, few: [u64; 2], many: [u64; 2], growth: [u64; 2]) {
    for k in 0..2 {
        let more = many[k].saturating_sub(few[k]);
        assert!(
            more <= growth[k],
            "{what}: forwards and backwards {few:?}, {many:?}"
        );
    }
}

/// Vectors of the additional checkpoints of forty more steps in little memory, four per checkpoint,
/// forwards and backwards.
const CHECKPOINTS: [u64; 2] = [4 * 12, 4 * 40];

#[test]
fn explicit_steps_allocate_nothing() {
    for (path, duration) in SCENES {
        let scene = scene(path);
        for (memory, more) in [(1 << 28, [0, 0]), (200_000, CHECKPOINTS)] {
            let [few, many] = [40, 80].map(|steps| {
                let mut settings = Settings::steps(Method::Dop853, steps);
                settings.samples = Samples::Uniform(3 * steps);
                settings.memory = memory;
                of_run(&scene, duration, &settings).0
            });
            assert_none(path, few, many, [more[0], GROWTH + more[1]]);
        }
    }
}

/// The implicit methods, and a formula that Radau IIA starts.
fn implicit() -> [Method; 5] {
    [
        Method::Radau { stages: 2 },
        Method::Radau { stages: 3 },
        Method::Bdf {
            order: 2,
            start: Start::RisingOrder,
        },
        Method::Bdf {
            order: 4,
            start: Start::Radau,
        },
        Method::GeneralisedAlpha { radius: 0.8 },
    ]
}

#[test]
fn implicit_steps_allocate_nothing() {
    for (path, duration) in SCENES {
        let scene = scene(path);
        for method in implicit() {
            let of = |steps| of_steps(&scene, duration, steps, method);
            let what = format!("{path}, {method:?}");
            assert_none(&what, of(400), of(800), [GROWTH; 2]);
        }
    }
}

/// Vectors of the history, which grow with adaptive steps.
const HISTORY: u64 = 10;

#[test]
fn steps_that_follow_the_error_allocate_their_history_only() {
    for (path, duration) in SCENES {
        let scene = scene(path);
        let mut settings = Settings::steps(Method::Radau { stages: 3 }, 1);
        settings.samples = Samples::StepEnds;
        let [few, many] = [1e-6, 1e-9].map(|tolerance| {
            settings.spacing = Spacing::Tolerance(tolerance);
            of_run(&scene, duration, &settings)
        });
        let ratio = many.1.steps() as f64 / few.1.steps() as f64;
        assert!(ratio > 2.0, "{path}: {ratio}");
        let doublings = ratio.log2().ceil() as u64 + 1;
        let more = many.0[0].saturating_sub(few.0[0]);
        assert!(more <= HISTORY * doublings, "{path}: {few:?}, {many:?}");
        // The same steps, frozen, and each of them halved.
        let [few, many] = [few.1.halved(), few.1.halved().halved()].map(|grid| {
            settings.spacing = Spacing::Frozen(grid);
            of_run(&scene, duration, &settings).0
        });
        assert_none(path, few, many, [GROWTH; 2]);
    }
}
