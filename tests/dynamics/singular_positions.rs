//! Linkages that pass positions with their bars in line. A parallelogram in gravity moves as a
//! pendulum with the same moments, for any lengths, start and tolerance.

use crate::reference;

use flexbody_driver::simulate;
use flexbody_problem::Problem;
use reference::models::Numbers;
use serde_json::Value;

/// Lengths [m] of crank and coupler, masses [kg] of crank, coupler and rocker, initial angle [rad]
/// and rate [rad/s].
struct Parallelogram {
    lengths: [f64; 2],
    masses: [f64; 3],
    angle: f64,
    rate: f64,
    duration: f64,
}

impl Parallelogram {
    fn random(numbers: &mut Numbers) -> Self {
        let mut between = |low: f64, high: f64| low + (high - low) * 0.5 * (numbers.next() + 1.0);
        Self {
            lengths: [between(0.3, 1.0), between(0.5, 2.0)],
            masses: [between(0.5, 2.0), between(0.5, 2.0), between(0.5, 2.0)],
            angle: between(0.2, 2.9),
            rate: between(-6.0, 6.0),
            duration: between(1.0, 5.0),
        }
    }

    fn linkage(&self, tolerance: f64) -> Value {
        let [a, b] = self.lengths;
        let tip = [a * self.angle.cos(), a * self.angle.sin(), 0.0];
        let bar = |length: f64, mass: f64, at: [f64; 3], angle: f64, spin: f64, v: [f64; 3]| {
            json!({
                "shape": {"rod": {"length": length}}, "mass": mass,
                "points": {"from": [-0.5 * length, 0, 0], "to": [0.5 * length, 0, 0]},
                "place": {"put": "from", "at": at, "turn": {"axis": [0, 0, 1], "angle": angle}},
                "velocity": {"linear": v, "angular": [0, 0, spin]}
            })
        };
        let speed = |part: f64| [-part * self.rate * tip[1], part * self.rate * tip[0], 0.0];
        let [crank, coupler, rocker] = self.masses;
        let hinge = |between: [&str; 2], at: &str| json!({"revolute": {"between": between, "at": at, "axis": [0, 0, 1]}});
        json!({
            "version": 1, "name": "parallelogram",
            "bodies": {
                "crank": bar(a, crank, [0.0; 3], self.angle, self.rate, speed(0.5)),
                "coupler": bar(b, coupler, tip, 0.0, 0.0, speed(1.0)),
                "rocker": bar(a, rocker, [b, 0.0, 0.0], self.angle, self.rate, speed(0.5)),
            },
            "joints": {
                "first": hinge(["crank", "ground"], "crank.from"),
                "second": hinge(["crank", "coupler"], "coupler.from"),
                "third": hinge(["coupler", "rocker"], "coupler.to"),
                "fourth": hinge(["rocker", "ground"], "rocker.from"),
            },
            "simulation": {"duration": self.duration, "tolerance": tolerance},
            "functions": {"angle": {"final": {"angle": {"joint": "first"}}}}
        })
    }

    /// One body with the linkage's moments of inertia and of weight about the crank's hinge.
    fn pendulum(&self) -> Value {
        let a = self.lengths[0];
        let [crank, coupler, rocker] = self.masses;
        let mass = crank + coupler + rocker;
        let centre = (0.5 * (crank + rocker) + coupler) * a / mass;
        let inertia = ((crank + rocker) / 3.0 + coupler) * a * a - mass * centre * centre;
        let (sin, cos) = self.angle.sin_cos();
        let speed = self.rate * centre;
        json!({
            "version": 1, "name": "pendulum",
            "bodies": {"bob": {
                "mass": mass, "inertia": {"xx": inertia, "yy": inertia, "zz": inertia},
                "place": {"at": [centre * cos, centre * sin, 0]},
                "velocity": {"linear": [-speed * sin, speed * cos, 0], "angular": [0, 0, self.rate]}
            }},
            "joints": {"first": {"revolute": {"between": ["bob", "ground"], "at": [0, 0, 0],
                                              "axis": [0, 0, 1]}}},
            "simulation": {"duration": self.duration, "tolerance": 1e-13},
            "functions": {"angle": {"final": {"angle": {"joint": "first"}}}}
        })
    }
}

fn angle(file: &Value) -> Result<f64, String> {
    let problem = Problem::parse(&file.to_string(), "linkage.json", &[])
        .unwrap_or_else(|faults| panic!("{faults}"));
    let motion = simulate(&problem, &problem.start()).map_err(|failure| failure.to_string())?;
    Ok(motion.at.function(0).value)
}

/// The error of a passage is the tolerance, magnified by the passages and by the motion.
#[test]
fn parallelograms_in_gravity_move_as_pendulums() {
    let mut numbers = Numbers(41);
    let mut passages = 0;
    for case in 0..40 {
        let linkage = Parallelogram::random(&mut numbers);
        let exact = angle(&linkage.pendulum()).expect("a pendulum runs");
        let turned = |angle: f64| (angle / std::f64::consts::PI).floor();
        passages += usize::from(turned(linkage.angle + exact) != turned(linkage.angle));
        for tolerance in [1e-5, 1e-7, 1e-9, 1e-11, 1e-13] {
            let found = angle(&linkage.linkage(tolerance));
            let found = found.unwrap_or_else(|why| panic!("case {case}, {tolerance:e}: {why}"));
            let error = (found - exact).abs();
            assert!(
                error <= 1e3 * tolerance + 1e-8,
                "case {case}, {tolerance:e}: {error:e}"
            );
        }
    }
    assert!(passages > 10, "{passages}");
}

/// A linkage that locks in some designs, at any length of its coupler: it moves, or the failure says why.
#[test]
fn a_linkage_that_locks_moves_or_says_why() {
    let text = include_str!("../../problems/extreme/locking_linkage.json");
    let problem = Problem::parse(text, "locking_linkage.json", &[]).expect("a problem");
    let mut moved = 0;
    for k in 0..200 {
        match simulate(&problem, &[-10.0 + 0.1 * f64::from(k)]) {
            Ok(_) => moved += 1,
            Err(failure) => assert!(failure.to_string().len() > 20, "{k}: {failure}"),
        }
    }
    assert!((10..190).contains(&moved), "{moved}");
}
