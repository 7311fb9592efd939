//! The time loop of the explicit method allocates nothing, forwards and backwards: runs of n and of
//! 2 n kept steps make the same number of allocations, as their history is given room before.

use dhat::HeapStats;
use flexbody::adjoint::gradients;
use flexbody::functions::Scene;
use flexbody::integrate::{Method, Samples, Settings, simulate};
use flexbody::problem::Problem;
use std::path::Path;
use std::sync::{Mutex, OnceLock};

#[global_allocator]
static ALLOCATOR: dhat::Alloc = dhat::Alloc;

/// One test at a time, as all allocations of the process are counted.
fn profiler() -> &'static Mutex<dhat::Profiler> {
    static PROFILER: OnceLock<Mutex<dhat::Profiler>> = OnceLock::new();
    PROFILER.get_or_init(|| Mutex::new(dhat::Profiler::builder().testing().build()))
}

/// Allocations while `f` runs.
fn allocations<T>(f: impl FnOnce() -> T) -> u64 {
    let before = HeapStats::get().total_blocks;
    let kept = f();
    let after = HeapStats::get().total_blocks;
    drop(kept);
    after - before
}

fn scene(path: &str) -> Scene<f64> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(path);
    let problem = Problem::load(&path, &[]).unwrap_or_else(|faults| panic!("{faults}"));
    problem.scene(&problem.start())
}

/// Allocations of a run of so many steps and of its adjoint, samples between the steps included.
fn of_steps(scene: &Scene<f64>, duration: f64, steps: usize, keep_stages: bool) -> [u64; 2] {
    let mut settings = Settings::steps(Method::Dop853, steps);
    settings.samples = Samples::Uniform(3 * steps);
    settings.keep_stages = keep_stages;
    let mut run = None;
    let forwards = allocations(|| {
        run = Some(simulate(&scene.model, duration, &settings).expect("runs"));
    });
    let run = run.expect("it ran");
    let backwards = allocations(|| gradients(scene, &run, &[0]).expect("differentiates"));
    [forwards, backwards]
}

/// Allocations that the vectors of the backward march may differ by.
const GROWTH: u64 = 10;

#[test]
fn steps_allocate_nothing() {
    let _one = profiler().lock().expect("no test panicked");
    for (path, duration) in [
        ("problems/trebuchet.json", 1.0),
        ("problems/triple_pendulum.json", 0.5),
        ("problems/benchmarks/andrews_squeezer.json", 0.004),
    ] {
        let scene = scene(path);
        for keep_stages in [true, false] {
            let [few, many] = [40, 80].map(|n| of_steps(&scene, duration, n, keep_stages));
            assert_eq!(few[0], many[0], "{path}: forwards");
            // The vectors that are used again grow until each has had its largest size.
            let more = many[1].saturating_sub(few[1]);
            assert!(more <= GROWTH, "{path}: backwards {few:?}, {many:?}");
        }
    }
}
