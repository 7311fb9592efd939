//! One table: position error, time of a simulation, time of its gradients.
//!
//! `cargo bench --bench work_precision`. Times are the processor time of the thread where the
//! system tells it (Linux) and wall time elsewhere: the least of several runs after a first one.
//! The gradients are in every parameter of the scene: masses, inertias, joint frames, the start,
//! gravity and the duration.

mod scenes;

use flexbody::adjoint;
use scenes::{Case, NAMES};
use std::hint::black_box;
use std::time::{Duration, Instant};

/// Runs of which the fastest counts.
const RUNS: usize = 10;

fn main() {
    println!(
        "{:15} {:7} {:>8} {:>6} {:>9}  {:>9} {:>6} {:>6}  {:>9} {:>6}  {:>9} {:>6}",
        "scene",
        "method",
        "unknowns",
        "steps",
        "error [m]",
        "forward",
        "Newton",
        "LU",
        "gradient",
        "ratio",
        "three",
        "ratio"
    );
    for name in NAMES {
        for h in [2e-3, 1e-3, 5e-4] {
            row(&Case::new(name, h));
        }
        for tolerance in [1e-5, 1e-7, 1e-9, 1e-11] {
            row(&Case::explicit(name, tolerance));
        }
    }
    println!();
    println!("times in s; Newton iterations and factorisations (LU) a step of the simulation;");
    println!("gradient of one function, of three; ratio to the simulation");
}

fn row(case: &Case) {
    let run = case.simulate();
    let forward = fastest(|| {
        black_box(case.simulate());
    });
    let gradient = |which: &[usize]| {
        fastest(|| {
            let found = adjoint::gradients(&case.scene, &run, which).expect("regular");
            black_box(found);
        })
    };
    let (one, three) = (gradient(&[0]), gradient(&[0, 1, 2]));
    let per_step = |count: usize| count as f64 / run.grid.steps() as f64;
    println!(
        "{:15} {:7} {:>8} {:>6} {:>9.1e}  {:>9.5} {:>6.2} {:>6.2}  {:>9.5} {:>6.2}  {:>9.5} {:>6.2}",
        case.name,
        run.method.name().replace(" with rising order", ""),
        2 * (run.numbering.velocities() + run.numbering.constraints()),
        run.grid.steps(),
        case.error,
        forward,
        per_step(run.counts.newton_iterations),
        per_step(run.counts.factorisations),
        one,
        one / forward,
        three,
        three / forward
    );
}

/// Least time of a run [s].
fn fastest(mut work: impl FnMut()) -> f64 {
    work();
    let mut least = Duration::MAX;
    for _ in 0..RUNS {
        let start = Watch::start();
        work();
        least = least.min(start.elapsed());
    }
    least.as_secs_f64()
}

/// A clock of this thread.
struct Watch {
    wall: Instant,
    used: Option<Duration>,
}

impl Watch {
    fn start() -> Self {
        Self {
            used: processor_time(),
            wall: Instant::now(),
        }
    }

    fn elapsed(&self) -> Duration {
        let wall = self.wall.elapsed();
        match (processor_time(), self.used) {
            (Some(now), Some(then)) => now.saturating_sub(then),
            _ => wall,
        }
    }
}

/// Time that this thread has run on a processor, the first number of its `schedstat`.
fn processor_time() -> Option<Duration> {
    // The kernel brings the number up to date when it schedules.
    std::thread::yield_now();
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    let nanoseconds = text.split_whitespace().next()?.parse().ok()?;
    Some(Duration::from_nanos(nanoseconds))
}
