//! Chains of N hinged bars: time per step and body, error after one second (of all centres of mass
//! at 101 instants), peak memory.
//!
//! `cargo bench --bench chains` prints a table; `cargo bench --bench chains -- memory 1024 1000`
//! prints the peak resident set of one run with so many bars and steps and its adjoint. Times are
//! processor times of the thread on Linux, and wall times elsewhere.
//!
//! Bars of 1 m and 1 kg, 0.1 m square, hinged about z, start at rest along x and fall for 1 s.

mod watch;

use flexbody::{Analysis, Problem, SimulationError, simulate};
use serde_json::{Map, Value, json};
use watch::fastest;

/// The chain with the settings `simulation`.
fn problem(bars: usize, simulation: Value) -> Problem {
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
        "simulation": simulation,
        "functions": {
            "x": {"final": {"position": {"body": last, "direction": [1, 0, 0]}}},
            "y": {"final": {"position": {"body": last, "direction": [0, 1, 0]}}}
        },
        "variables": {"mass": {"path": "/bodies/bar 0/mass", "lower": 0.1}}
    });
    Problem::parse(&file.to_string(), "chain.json", &[]).unwrap_or_else(|faults| panic!("{faults}"))
}

/// The whole second of N = 256 at a tolerance.
fn whole_second(tolerance: f64) -> Problem {
    let simulation =
        json!({"duration": 1, "tolerance": tolerance, "method": "dop853", "samples": 100});
    problem(256, simulation)
}

/// Centres of mass of all bars at 101 instants \[m\], instant by instant.
fn places(problem: &Problem) -> Result<Vec<[f64; 3]>, SimulationError> {
    let motion = simulate(problem, &problem.start())?;
    assert_eq!(motion.times().len(), 101);
    let place = |k: usize| {
        let bar = |i: usize| motion.body(&format!("bar {i}"), k);
        (0..)
            .map_while(bar)
            .map(|bar| bar.position)
            .collect::<Vec<_>>()
    };
    Ok((0..=100).flat_map(place).collect())
}

/// The largest distance between two sets of positions \[m\].
fn apart(a: &[[f64; 3]], b: &[[f64; 3]]) -> f64 {
    let distance = |(a, b): (&[f64; 3], &[f64; 3])| {
        let square: f64 = (0..3).map(|i| (a[i] - b[i]).powi(2)).sum();
        square.sqrt()
    };
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(distance).fold(0.0, f64::max)
}

fn main() -> Result<(), SimulationError> {
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
        // Equal steps: the work per step and body does not depend on the length of the chain.
        let steps = 40;
        let bdf = json!({"bdf": {"order": 2, "start": "rising_order"}});
        for (name, method, duration) in [
            ("dop853", json!("dop853"), 0.1),
            ("bdf2, 1 ms", bdf, 0.04),
            ("radau3, 1 ms", json!({"radau": {"stages": 3}}), 0.04),
        ] {
            let simulation = json!({"duration": duration, "steps": steps, "method": method});
            let problem = problem(bars, simulation);
            let x = problem.start();
            let repeats = (2048 / bars).clamp(3, 20);
            let (seconds, at) = fastest(repeats, || Analysis::new(&problem).at(&x));
            let at = at?;
            let (gradient, found) = fastest(repeats, || at.gradients(&[0]));
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
    let exact = places(&whole_second(1e-11))?;
    for tolerance in [1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9] {
        let problem = whole_second(tolerance);
        let x = problem.start();
        let (seconds, at) = fastest(3, || Analysis::new(&problem).at(&x));
        let steps = at?.work().steps;
        let error = apart(&places(&problem)?, &exact);
        println!("   {tolerance:9.0e} {steps:10} {seconds:10.3} {error:12.2e}");
    }
    Ok(())
}

/// Peak resident set of a run and its gradient.
fn memory(bars: usize, steps: usize) -> Result<(), SimulationError> {
    let duration = 1e-3 * steps as f64;
    let simulation =
        json!({"duration": duration, "steps": steps, "samples": 1, "method": "dop853"});
    let problem = problem(bars, simulation);
    let before = peak();
    let at = Analysis::new(&problem).at(&problem.start())?;
    let forward = peak();
    at.gradients(&[0])?;
    println!(
        "{bars} bars, {steps} steps of dop853: problem {before:.1} MB, after the run {forward:.1} MB, \
         with its adjoint {:.1} MB",
        peak()
    );
    Ok(())
}

/// Peak resident set so far \[MB\]; NaN if it is unknown.
fn peak() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find(|line| line.starts_with("VmHWM"));
    let number = line.and_then(|line| line.split_whitespace().nth(1)?.parse::<f64>().ok());
    number.map_or(f64::NAN, |kb| kb / 1e3)
}
