//! Chains of N hinged bars: time a step and body, error of the whole second (of all centres of mass at
//! 101 instants), peak memory.
//!
//! `cargo bench --bench chains` prints a table; `cargo bench --bench chains -- memory 1024 1000`
//! prints the peak resident set of one run of so many bars and steps with its adjoint. Times are the
//! processor time of the thread where the system tells it (Linux) and wall time elsewhere.
//!
//! Bars of 1 m and 1 kg, 0.1 m square, hinged about z, start at rest along x and fall for 1 s.

mod watch;

use flexbody::driver::{Evaluated, simulate};
use flexbody::integrate::{IntegrationFailure, Method, Spacing, Start};
use flexbody::problem::Problem;
use serde_json::{Map, Value, json};
use watch::fastest;

/// The chain as a problem file.
fn chain(bars: usize, duration: f64) -> String {
    let (mut bodies, mut joints) = (Map::new(), Map::new());
    for i in 0..bars {
        let x = i as f64;
        bodies.insert(
            format!("bar {i}"),
            json!({"shape": {"box": {"size": [1, 0.1, 0.1]}}, "mass": 1,
                   "place": {"at": [x + 0.5, 0, 0]}}),
        );
        let before = match i {
            0 => "ground".to_owned(),
            _ => format!("bar {}", i - 1),
        };
        joints.insert(
            format!("hinge {i}"),
            json!({"revolute": {"between": [format!("bar {i}"), before], "at": [x, 0, 0],
                                "axis": [0, 0, 1]}}),
        );
    }
    let last = format!("bar {}", bars - 1);
    let file = json!({
        "version": 1, "name": "chain", "bodies": Value::Object(bodies),
        "joints": Value::Object(joints),
        "simulation": {"duration": duration, "tolerance": 1e-6, "method": "dop853"},
        "functions": {
            "x": {"final": {"position": {"body": last, "direction": [1, 0, 0]}}},
            "y": {"final": {"position": {"body": last, "direction": [0, 1, 0]}}}
        },
        "variables": {"mass": {"path": "/bodies/bar 0/mass", "lower": 0.1}}
    });
    file.to_string()
}

fn problem(bars: usize, duration: f64) -> Problem {
    Problem::parse(&chain(bars, duration), "chain.json", &[])
        .unwrap_or_else(|faults| panic!("{faults}"))
}

/// Centres of mass of all bars at 101 instants (m), instant by instant.
fn places(problem: &Problem) -> Result<Vec<[f64; 3]>, IntegrationFailure> {
    let mut problem = problem.clone();
    problem.simulation.samples = Some(100);
    let done = simulate(&problem, &problem.start())?;
    let (run, bars) = (done.motion(), done.written.model.bodies.len());
    assert_eq!(run.last(), 100);
    let place = |k: usize, bar: usize| {
        let at = run.numbering.position(bar);
        std::array::from_fn(|i| run.q(k)[at + i])
    };
    let all = (0..=100).flat_map(|k| (0..bars).map(move |bar| (k, bar)));
    Ok(all.map(|(k, bar)| place(k, bar)).collect())
}

/// The largest distance of two places (m).
fn apart(a: &[[f64; 3]], b: &[[f64; 3]]) -> f64 {
    let distance = |(a, b): (&[f64; 3], &[f64; 3])| {
        let square: f64 = (0..3).map(|i| (a[i] - b[i]).powi(2)).sum();
        square.sqrt()
    };
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(distance).fold(0.0, f64::max)
}

fn main() -> Result<(), IntegrationFailure> {
    let arguments: Vec<String> = std::env::args()
        .skip(1)
        .filter(|a| a != "--bench")
        .collect();
    if let [what, bars, steps] = &arguments[..]
        && what == "memory"
    {
        let count = |text: &String| text.parse().expect("a count");
        return memory(count(bars), count(steps));
    }
    println!("   N  method          steps     ms/step  us/(step body)  gradient/run");
    for bars in [16, 32, 64, 128, 256, 512, 1024] {
        let bdf = Method::Bdf {
            order: 2,
            start: Start::RisingOrder,
        };
        // Equal steps, so that every length of chain does the same work a step.
        let steps = 40;
        let radau = Method::Radau { stages: 3 };
        for (name, method, duration) in [
            ("dop853", Method::Dop853, 0.1),
            ("bdf2, 1 ms", bdf, 0.04),
            ("radau3, 1 ms", radau, 0.04),
        ] {
            let mut problem = problem(bars, duration);
            problem.simulation.spacing = Spacing::Steps(steps);
            problem.simulation.method = Some(method);
            let x = problem.start();
            let repeats = (2048 / bars).clamp(3, 20);
            let (seconds, at) = fastest(repeats, || Evaluated::new(&problem, &x));
            let at = at?;
            let (gradient, found) = fastest(repeats, || at.gradients(&problem, &[0]));
            found?;
            let step = seconds / steps as f64;
            println!(
                "{bars:4}  {name:14} {steps:6} {:11.4} {:15.3} {:13.2}",
                1e3 * step,
                1e6 * step / bars as f64,
                gradient / seconds
            );
        }
    }
    println!("\nN = 256, the whole second:\n   tolerance      steps          s    error (m)");
    let mut exact = problem(256, 1.0);
    exact.simulation.spacing = Spacing::Tolerance(1e-11);
    let exact = places(&exact)?;
    for tolerance in [1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9] {
        let mut problem = problem(256, 1.0);
        problem.simulation.spacing = Spacing::Tolerance(tolerance);
        let (seconds, at) = fastest(3, || Evaluated::new(&problem, &problem.start()));
        let at = at?;
        let error = apart(&places(&problem)?, &exact);
        println!(
            "   {tolerance:9.0e} {:10} {seconds:10.3} {error:12.2e}",
            at.run.grid.steps()
        );
    }
    Ok(())
}

/// Peak resident set of a run and its gradient, beside what the history must take.
fn memory(bars: usize, steps: usize) -> Result<(), IntegrationFailure> {
    let mut problem = problem(bars, 1e-3 * steps as f64);
    problem.simulation.spacing = Spacing::Steps(steps);
    problem.simulation.samples = Some(1);
    let before = peak();
    let at = Evaluated::new(&problem, &problem.start())?;
    let forward = peak();
    at.gradients(&problem, &[0])?;
    let numbering = &at.run.numbering;
    let node = 8 * (numbering.positions() + 2 * numbering.velocities() + numbering.constraints());
    println!(
        "{bars} bars, {steps} steps of dop853: problem {before:.1} MB, after the run {forward:.1} MB, \
         with its adjoint {:.1} MB; states of all steps {:.1} MB",
        peak(),
        (node * steps) as f64 / 1e6
    );
    Ok(())
}

/// Peak resident set so far (MB); NaN where the system does not tell.
fn peak() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find(|line| line.starts_with("VmHWM"));
    let number = line.and_then(|line| line.split_whitespace().nth(1)?.parse::<f64>().ok());
    number.map_or(f64::NAN, |kb| kb / 1e3)
}
