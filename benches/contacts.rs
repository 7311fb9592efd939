//! Contacts: what shapes on a plane and on hills and the points of a foot cost a step, and spheres in a box with a contact for every pair.
//!
//! `cargo bench --bench contacts` prints the tables. Times are processor times of the thread on Linux, and wall times elsewhere.
//!
//! The leg is that of `problems/jumping_leg.json` with a foot on an ankle, whose sole has the points, in 400 equal steps of DOP853
//! from its crouch. The spheres of 0.1 m in diameter and 0.1 kg have random velocities up to 1 m/s in a box without lid, and the error
//! is that of the height of their centre of mass after 0.05 s, against a tolerance of 1e-10.

mod watch;

use flexbody::{Analysis, Problem, SimulationError};
use serde_json::{Map, Value, json};
use watch::fastest;

fn parsed(file: &Value) -> Problem {
    Problem::parse(&file.to_string(), "contacts.json", &[])
        .unwrap_or_else(|faults| panic!("{faults}"))
}

/// The leg with a foot, whose sole has this number of points: in its plane, or on both sides of it. A force of next to nothing across the
/// plane makes a free leg spatial too.
fn leg(points: usize, across: f64) -> Problem {
    let mut file: Value =
        serde_json::from_str(include_str!("../problems/jumping_leg.json")).expect("a problem file");
    let map = file.as_object_mut().expect("an object");
    for key in ["variables", "objective", "constraints"] {
        map.remove(key);
    }
    let law = file["loads"]["ground"]["contact"].clone();
    file["loads"]
        .as_object_mut()
        .expect("loads")
        .remove("ground");
    file["bodies"]["foot"] = json!({"shape": {"box": {"size": [0.2, 0.03, 0.08]}}, "mass": 0.4, "place": {"at": [0, 0, 0]}});
    file["joints"]["ankle"] =
        json!({"revolute": {"between": ["foot", "shank"], "at": "shank.foot", "axis": [0, 0, 1]}});
    file["loads"]["ankle"] =
        json!({"torsion_spring": {"joint": "ankle", "stiffness": 60, "damping": 0.5}});
    for i in 0..points {
        let at = [
            0.02 * (i / 2) as f64 - 0.1,
            -0.015,
            if i % 2 == 0 { across } else { -across },
        ];
        let mut own = law.clone();
        own["between"] = json!(["foot", "ground"]);
        own["at"] = json!({"a": at, "b": [0, -0.015, 0]});
        own["stiffness"] = json!(15000.0 / points as f64);
        file["loads"][format!("point {i}")] = json!({"contact": own});
    }
    if across > 0.0 {
        file["loads"]["across"] =
            json!({"force": {"body": "foot", "direction": [0, 0, 1], "magnitude": 1e-9}});
    }
    file["simulation"] = json!({"duration": 0.2, "steps": 400, "method": "dop853"});
    file["functions"] =
        json!({"height": {"final": {"position": {"body": "trunk", "direction": [0, 1, 0]}}}});
    file["variables"] = json!({"mass": {"path": "/bodies/trunk/mass", "lower": 1}});
    parsed(&file)
}

/// A number in [−1, 1], the next of a sequence.
fn next(seed: &mut u64) -> f64 {
    *seed = seed
        .wrapping_mul(6364136223846793005)
        .wrapping_add(1442695040888963407);
    (*seed >> 33) as f64 / f64::from(1_u32 << 30) - 1.0
}

fn spheres(count: usize, tolerance: f64) -> Problem {
    let (mut bodies, mut loads, mut heights) = (Map::new(), Map::new(), Vec::new());
    let side = (count as f64).cbrt().ceil() as usize;
    let half = 0.055 * side as f64 + 0.06;
    let contact = |between: [&str; 2], at: [f64; 3], surface: Value| {
        json!({"contact": {"between": between, "at": {"a": [0, 0, 0], "b": at}, "radius": 0.05, "surface": surface,
                           "stiffness": 5e3, "dissipation": 0.3, "width": 1e-3, "friction": {"coefficient": 0.3, "width": 0.05}}})
    };
    let mut seed = 1;
    for i in 0..count {
        let name = format!("s{i}");
        let at = |k: usize| 0.11 * (k as f64 - 0.5 * (side - 1) as f64);
        let place = [
            at(i % side),
            0.06 + 0.11 * (i / side % side) as f64,
            at(i / side / side),
        ];
        let velocity = [(); 3].map(|()| next(&mut seed));
        bodies.insert(
            name.clone(),
            json!({"shape": {"sphere": {"radius": 0.05}}, "mass": 0.1, "place": {"at": place}, "velocity": {"linear": velocity}}),
        );
        for (k, (at, normal)) in [
            ([0.0; 3], [0, 1, 0]),
            ([-half, 0.0, 0.0], [1, 0, 0]),
            ([half, 0.0, 0.0], [-1, 0, 0]),
            ([0.0, 0.0, -half], [0, 0, 1]),
            ([0.0, 0.0, half], [0, 0, -1]),
        ]
        .into_iter()
        .enumerate()
        {
            let wall = contact([&name, "ground"], at, json!({"plane": {"normal": normal}}));
            loads.insert(format!("{name} wall {k}"), wall);
        }
        for k in 0..i {
            let other = format!("s{k}");
            let pair = contact(
                [&name, &other],
                [0.0; 3],
                json!({"sphere": {"radius": 0.05}}),
            );
            loads.insert(format!("{name} {other}"), pair);
        }
        heights.push(json!({"position": {"body": name, "direction": [0, 1.0 / count as f64, 0]}}));
    }
    parsed(&json!({
        "version": 1, "name": "spheres", "gravity": [0, -9.81, 0], "bodies": bodies, "loads": loads,
        "simulation": {"duration": 0.05, "tolerance": tolerance, "method": "dop853"},
        "functions": {"height": {"final": {"sum": heights}}},
        "variables": {"mass": {"path": "/bodies/s0/mass", "lower": 0.01}}
    }))
}

/// What a shape on a plane or on hills costs: a body that rolls and slips for 0.5 s in 500 equal steps of DOP853.
fn rolling(shape: Value, on_hills: bool) -> Problem {
    let places = |count: usize| (0..count).map(|k| 0.25 * k as f64 - 1.0);
    let height = |u: f64, v: f64| 0.02 * (3.0 * u).sin() * (2.0 * v).cos();
    let heights: Vec<Vec<f64>> = places(21)
        .map(|v| places(41).map(|u| height(u, v)).collect())
        .collect();
    let [along, across] = [41, 21].map(|count| places(count).collect::<Vec<f64>>());
    let surface = match on_hills {
        true => {
            json!({"height_field": {"normal": [0, 1, 0], "direction": [1, 0, 0], "along": along, "across": across,
                                        "heights": heights}})
        }
        false => json!({"plane": {"normal": [0, 1, 0]}}),
    };
    let mut contact = json!({"between": ["body", "ground"], "at": {"a": [0, 0, 0], "b": [0, 0, 0]}, "surface": surface,
                             "stiffness": 2e4, "dissipation": 0.5, "width": 2e-3, "friction": {"coefficient": 0.5, "width": 0.05}});
    let own = contact.as_object_mut().expect("an object");
    own.extend(shape.as_object().expect("a shape").clone());
    parsed(&json!({
        "version": 1, "name": "rolling", "gravity": [0, -9.81, 0],
        "bodies": {"body": {"shape": {"box": {"size": [0.3, 0.2, 0.1]}}, "mass": 2, "place": {"at": [0, 0.23, 0]},
                            "velocity": {"linear": [1, 0, 0.2], "angular": [0.2, 0.3, -3]}}},
        "loads": {"ground": {"contact": contact}},
        "simulation": {"duration": 0.5, "steps": 500, "method": "dop853"},
        "functions": {"x": {"final": {"position": {"body": "body", "direction": [1, 0, 0]}}}},
        "variables": {"mass": {"path": "/bodies/body/mass", "lower": 0.01}}
    }))
}

/// Time of one of so many steps \[µs\], and that of a gradient relative to the run.
fn cost(problem: &Problem, steps: f64) -> Result<[f64; 2], SimulationError> {
    let x = problem.start();
    let (seconds, at) = fastest(5, || Analysis::new(problem).at(&x));
    let at = at?;
    let (gradient, found) = fastest(5, || at.gradients(&[0]));
    found?;
    Ok([1e6 * seconds / steps, gradient / seconds])
}

fn main() -> Result<(), SimulationError> {
    println!(
        "a body that rolls, 500 steps of dop853:\nshape         plane: us/step  gradient/run  hills: us/step  gradient/run"
    );
    for (name, shape) in [
        ("sphere", json!({"radius": 0.2})),
        (
            "wheel",
            json!({"radius": 0.05, "wheel": {"axis": [0.1, 0.2, 1], "radius": 0.15}}),
        ),
        (
            "capsule of 2",
            json!({"radius": 0.2, "half": [0.05, 0, 0.2], "spheres": 2}),
        ),
        (
            "capsule of 5",
            json!({"radius": 0.2, "half": [0.05, 0, 0.2], "spheres": 5}),
        ),
    ] {
        print!("{name:12}");
        for on_hills in [false, true] {
            let problem = rolling(shape.clone(), on_hills);
            let [step, ratio] = cost(&problem, 500.0)?;
            print!(" {step:14.1} {ratio:13.2}");
        }
        println!();
    }
    println!();
    println!("leg with a foot, 400 steps of dop853:\n         points  us/step  gradient/run");
    for (what, across) in [("planar", 0.0), ("spatial", 0.04)] {
        for points in [0, 4, 10, 20] {
            let problem = leg(points, across);
            let [step, ratio] = cost(&problem, 400.0)?;
            println!("{what:8} {points:6} {step:8.1} {ratio:13.2}");
        }
    }
    println!(
        "\nspheres in a box, 0.05 s:\nspheres    pairs  tolerance  steps        s  ms/step  gradient/run  error (m)"
    );
    for count in [50, 100, 200] {
        let exact = spheres(count, 1e-10);
        let exact = Analysis::new(&exact).at(&exact.start())?.values()[0];
        for tolerance in [1e-4, 1e-6] {
            let problem = spheres(count, tolerance);
            let x = problem.start();
            let (seconds, at) = fastest(1, || Analysis::new(&problem).at(&x));
            let at = at?;
            let (gradient, found) = fastest(1, || at.gradients(&[0]));
            found?;
            let (steps, pairs) = (at.work().steps, count * (count - 1) / 2);
            println!(
                "{count:7} {pairs:8} {tolerance:10.0e} {steps:6} {seconds:8.2} {:8.2} {:13.2} {:10.1e}",
                1e3 * seconds / steps as f64,
                gradient / seconds,
                (at.values()[0] - exact).abs()
            );
        }
    }
    Ok(())
}
