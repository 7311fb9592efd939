//! Time steps of bodies of finite elements: chains of N hinged plates, and two plates of more and more elements.
//!
//! `cargo bench --bench flexible` prints the tables; `cargo bench --bench flexible -- chain 4 bdf 20`,
//! `… -- mesh 32 krylov 100` (BDF2 by the Krylov solver) or `… -- mesh 32 radau 100` one line of a run of so
//! many steps, with the peak resident set of that run alone. Times are wall times, the least of some, with the
//! plans of the matrices; `RAYON_NUM_THREADS` sets the number of threads.
//!
//! Plates of 1 m by 0.25 m and 5 mm start flat, turn with 8 rad/s about z and hang on hinges along their
//! edges, as in `problems/flexible/double_plate.json`. Each has a thickness for each element along it, which a design
//! changes.

use flexbody::{Analysis, Problem, SimulationError};
use serde_json::{Map, json};
use std::time::Instant;

/// Steps of a run in the tables.
const STEPS: usize = 100;
/// Length of a step [s].
const STEP: f64 = 1e-3;

/// Plates with so many elements along and across.
fn problem(plates: usize, elements: [usize; 2], method: &str, steps: usize) -> Problem {
    let (mut bodies, mut joints, mut variables) = (Map::new(), Map::new(), Map::new());
    for i in 0..plates {
        let name = format!("plate {i}");
        let at = match i {
            0 => json!([0, 0, 0]),
            _ => json!(format!("plate {}.end", i - 1)),
        };
        bodies.insert(
            name.clone(),
            json!({
                "elements": {
                    "structure": {
                        "mesh": {"plate": {"length": 1, "width": 0.25, "elements": elements}},
                        "material": "aluminium",
                        "thickness": {"per": "band", "along": "x", "value": 0.005},
                        "sets": {"O": {"node": {"at": [0, 0.5]}}, "B": {"node": {"at": [1, 0.5]}}}
                    },
                    "frame": {"chord": ["O", "B", "x0y0"]},
                    "points": {"start": {"edge": "x0"}, "end": {"edge": "x1"}}
                },
                "place": {"put": "start", "at": at,
                          "turn": {"axis": [1, 0, 0], "angle": std::f64::consts::FRAC_PI_2}},
                "velocity": {"linear": [0, 8.0 * i as f64, 0], "angular": [0, 0, 8]}
            }),
        );
        let before = match i {
            0 => "ground".to_owned(),
            _ => format!("plate {}", i - 1),
        };
        let place = match i {
            0 => "plate 0.start".to_owned(),
            _ => format!("plate {}.end", i - 1),
        };
        joints.insert(
            format!("hinge {i}"),
            json!({"revolute": {"between": [&name, before], "at": place, "axis": [0, 0, 1]}}),
        );
        variables.insert(
            format!("thickness {i}"),
            json!({"path": format!("/bodies/{name}/elements/structure/thickness/value"),
                   "lower": 0.001, "upper": 0.01}),
        );
    }
    let (choice, solver) = match method {
        "radau" => (json!({"radau": {"stages": 3}}), "direct"),
        "krylov" => (json!({"bdf": {"order": 2}}), "krylov"),
        _ => (json!({"bdf": {"order": 2}}), "direct"),
    };
    let position = |k: usize| {
        let direction: [usize; 3] = std::array::from_fn(|i| usize::from(i == k));
        let body = format!("plate {}", plates - 1);
        json!({"final": {"position": {"body": body, "point": "end", "direction": direction}}})
    };
    let file = json!({
        "version": 1, "name": "plates", "bodies": bodies, "joints": joints,
        "materials": {"aluminium": {"young": 70e9, "poisson": 0.3, "density": 2700, "yield_stress": 2e8}},
        "simulation": {
            "duration": STEP * steps as f64, "steps": steps, "method": choice, "linear_solver": solver
        },
        "functions": {"x": position(0), "y": position(1)},
        "variables": variables
    });
    let name = "plates.json";
    Problem::parse(&file.to_string(), name, &[]).unwrap_or_else(|faults| panic!("{faults}"))
}

/// Duration of the fastest of some calls [s] after one that does not count, and the last result.
fn fastest<T>(repeats: usize, mut work: impl FnMut() -> T) -> (f64, T) {
    let mut last = work();
    let mut least = f64::INFINITY;
    for _ in 0..repeats {
        let start = Instant::now();
        last = work();
        least = least.min(start.elapsed().as_secs_f64());
    }
    (least, last)
}

/// Largest resident memory of the process so far [MB], where the system tells.
fn peak_memory() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find(|line| line.starts_with("VmHWM"));
    let number = line.and_then(|line| line.split_whitespace().nth(1)?.parse::<f64>().ok());
    number.unwrap_or(f64::NAN) / 1024.0
}

/// Prints a line of the table.
fn line(
    plates: usize,
    elements: [usize; 2],
    method: &str,
    steps: usize,
) -> Result<(), SimulationError> {
    let problem = problem(plates, elements, method, steps);
    let x = problem.start();
    let repeats = if plates * elements[0] * elements[1] > 500 {
        1
    } else {
        3
    };
    let (seconds, at) = fastest(repeats, || Analysis::new(&problem).at(&x));
    let at = at?;
    let work = at.work();
    let [one, two] =
        [&[0][..], &[0, 1]].map(|which| fastest(repeats, || at.gradients(which)).0 / seconds);
    let nodes = (2 * elements[0] + 1) * (2 * elements[1] + 1);
    let backwards = at.gradients_and_work(&[0])?.1;
    let each = |count: usize| count as f64 / steps as f64;
    println!(
        "{plates:6} {:5} x {:2} {:8} {method:6} {:9.2} {:12.2} {:10.2} {:8.2} {:13.2} {:>16} {:16.3} {:8.0}",
        elements[0],
        elements[1],
        plates * (5 * nodes - 6),
        1e3 * seconds / steps as f64,
        each(work.factorisations),
        each(work.newton_iterations),
        each(work.products),
        one,
        format!(
            "{:.2} {:.1}",
            each(backwards.factorisations),
            each(backwards.products)
        ),
        two - one,
        peak_memory(),
    );
    Ok(())
}

fn main() -> Result<(), SimulationError> {
    println!("{} threads", rayon::current_num_threads());
    println!(
        "plates   elements unknowns method   ms/step factors/step  iterations products gradient/run factors products second gradient       MB"
    );
    let arguments: Vec<String> = (std::env::args().skip(1))
        .filter(|a| a != "--bench")
        .collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let count = |text: &str| text.parse().expect("a count");
    if let [kind, size, method, steps] = arguments[..] {
        let (size, steps) = (count(size), count(steps));
        return match kind {
            "chain" => line(size, [8, 2], method, steps),
            "mesh" => line(2, [size, size / 4], method, steps),
            _ => panic!("expected chain or mesh, found {kind}"),
        };
    }
    assert!(
        arguments.is_empty(),
        "expected chain|mesh N bdf|krylov|radau STEPS"
    );
    for method in ["bdf", "radau"] {
        for plates in [1, 2, 4, 8, 16] {
            line(plates, [8, 2], method, STEPS)?;
        }
    }
    for along in [8, 16, 32, 64, 96] {
        line(2, [along, along / 4], "bdf", STEPS)?;
    }
    Ok(())
}
