//! Families of random scenes with flexible bodies: the same scene in another order, in other units, turned, without
//! reductions, and by other methods gives the same functions.

use super::modal::data;
use flexbody_driver::simulate;
use flexbody_problem::Problem;
use serde_json::{Map, Value};

/// Numbers between 0 and 1 by a linear congruence.
struct Random(u64);

impl Random {
    fn new(seed: u64) -> Self {
        let mut own = Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ 0x2545_f491_4f6c_dd1d);
        own.next();
        own
    }

    fn next(&mut self) -> f64 {
        self.0 = (self.0.wrapping_mul(6_364_136_223_846_793_005))
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }

    fn pick<'a, T>(&mut self, all: &'a [T]) -> &'a T {
        &all[((self.next() * all.len() as f64) as usize).min(all.len() - 1)]
    }

    fn vector(&mut self) -> [f64; 3] {
        [0; 3].map(|_| self.between(-1.0, 1.0))
    }
}

/// How a scene is written: factors of mass, length and time, and a turn of everything.
#[derive(Clone, Copy)]
struct Written {
    units: [f64; 3],
    turn: Option<([f64; 3], f64)>,
}

const PLAIN: Written = Written {
    units: [1.0; 3],
    turn: None,
};

impl Written {
    /// A number in these units; powers of mass, length and time.
    fn number(&self, value: f64, powers: [i32; 3]) -> f64 {
        let factors = self.units.iter().zip(powers);
        factors.fold(value, |x, (unit, power)| x * unit.powi(power))
    }

    /// A vector in ground axes.
    fn ground(&self, v: [f64; 3], powers: [i32; 3]) -> Value {
        let turned = match self.turn {
            None => v,
            Some((axis, angle)) => {
                let length = axis.iter().map(|x| x * x).sum::<f64>().sqrt();
                let e = axis.map(|x| x / length);
                let (s, c) = angle.sin_cos();
                let along: f64 = (0..3).map(|k| e[k] * v[k]).sum();
                [0, 1, 2].map(|k| {
                    let cross = e[(k + 1) % 3] * v[(k + 2) % 3] - e[(k + 2) % 3] * v[(k + 1) % 3];
                    v[k] * c + cross * s + e[k] * along * (1.0 - c)
                })
            }
        };
        json!(turned.map(|x| self.number(x, powers)))
    }

    /// Turns about ground axes.
    fn turns(&self, axis: [f64; 3], angle: f64) -> Value {
        let mut all = vec![json!({"axis": axis, "angle": angle})];
        if let Some((axis, angle)) = self.turn {
            all.push(json!({"axis": axis, "angle": angle}));
        }
        json!(all)
    }
}

const FORCE: [i32; 3] = [1, 1, -2];
const ENERGY: [i32; 3] = [1, 2, -2];
const LENGTH: [i32; 3] = [0, 1, 0];

/// A random scene: two or three bodies in a tree, springs, forces and torques; a rod to ground closes a loop in every
/// third. Also the powers of the units of its functions.
fn scene(seed: u64, at: Written) -> (Value, Vec<[i32; 3]>) {
    let r = &mut Random::new(seed);
    let q = |value: f64, powers: [i32; 3]| at.number(value, powers);
    let lengths = |v: [f64; 3]| json!(v.map(|x| q(x, LENGTH)));
    let (mut bodies, mut joints, mut loads) = (Map::new(), Map::new(), Map::new());
    let (mut functions, mut powers) = (Map::new(), Vec::new());
    let mut before: Option<String> = None;
    let count = 2 + (seed % 2) as usize;
    for i in 0..count {
        let name = format!("b{i}");
        let kind = match i {
            0 => *r.pick(&["beam", "modal"]),
            _ => *r.pick(&["beam", "modal", "rigid"]),
        };
        let mut body = match kind {
            "beam" => json!({"beam": {
                "length": q(r.between(0.5, 1.0), LENGTH),
                "section": {"rectangle": {"height": q(r.between(0.01, 0.03), LENGTH), "width": q(r.between(0.01, 0.03), LENGTH)}},
                "material": {"young": q(r.between(2e8, 2e9), [1, -1, -2]), "density": q(2000.0, [1, -3, 0])},
                "frame": *r.pick(&["chord", "clamped"]), "strain": *r.pick(&["von_karman", "linear"]),
                "modes": {"bending_y": *r.pick(&[1, 2]), "bending_z": 1, "torsion": 1, "stretch": 2},
                "damping": {"ratio": r.between(0.0, 0.05)}
            }}),
            "modal" => {
                let [mass, length, time] = at.units;
                json!({"modal": {
                    "source": {"matrix_market": {"nodes": data("beam.nodes"), "stiffness": data("beam_k.mtx"),
                        "mass": data("beam_m.mtx"), "units": {"length": length, "mass": mass, "time": time}}},
                    "interfaces": {"start": 1, "end": 21}, "modes": 0,
                    "frame": r.pick(&[json!({"clamped": "start"}), json!({"chord": ["start", "end"]})]).clone(),
                    "young_factor": r.between(0.02, 0.05), "damping": {"ratio": r.between(0.0, 0.05)}
                }})
            }
            _ => json!({
                "shape": {"box": {"size": lengths([0.2, 0.3, 0.1])}}, "mass": q(r.between(0.2, 1.0), [1, 0, 0]),
                "points": {"start": lengths([-0.2, 0.05, 0.0]), "end": lengths([0.2, 0.0, 0.1])}
            }),
        };
        let turns = at.turns(r.vector(), r.between(-1.5, 1.5));
        let (near, hinge) = match &before {
            None => ("ground".to_owned(), format!("{name}.start")),
            Some(near) => (near.clone(), format!("{near}.end")),
        };
        body["place"] = match i {
            0 => json!({"put": "start", "at": [0, 0, 0], "turn": turns}),
            _ => json!({"put": "start", "at": hinge, "turn": turns}),
        };
        let mut joint = json!({"between": [name.as_str(), near], "at": hinge});
        let key = *r.pick(&["revolute", "spherical", "weld"]);
        let axis = r.vector();
        if key == "revolute" {
            joint["axis"] = at.ground(axis, [0; 3]);
            loads.insert(format!("turning {i}"), json!({"torsion_spring":
                {"joint": format!("j{i}"), "stiffness": q(10.0, ENERGY), "damping": q(0.05, [1, 2, -1])}}));
        }
        joints.insert(format!("j{i}"), json!({key: joint}));
        let magnitude = q(r.between(1.0, 10.0), FORCE);
        loads.insert(
            format!("push {i}"),
            json!({"force": {"body": name, "point": "end",
            "direction": at.ground(r.vector(), [0; 3]), "magnitude": magnitude}}),
        );
        if kind != "rigid" {
            loads.insert(
                format!("twist {i}"),
                json!({"torque": {"body": name, "point": "end",
                "direction": at.ground(r.vector(), [0; 3]), "magnitude": q(0.5, ENERGY)}}),
            );
            functions.insert(
                format!("strain {i}"),
                json!({"final": {"strain_energy": {"body": name}}}),
            );
            powers.push(ENERGY);
            functions.insert(
                format!("bend {i}"),
                json!({"integral": {"elastic_displacement":
                {"body": name, "point": "end", "direction": [1, 0, 0]}}}),
            );
            powers.push([0, 1, 1]);
        }
        functions.insert(
            format!("place {i}"),
            json!({"final": {"position":
            {"body": name, "point": "end", "direction": at.ground(r.vector(), [0; 3])}}}),
        );
        powers.push(LENGTH);
        bodies.insert(name.clone(), body);
        before = Some(name);
    }
    let last = format!("b{}", count - 1);
    let far = at.ground([1.5, 1.2, -0.7], LENGTH);
    if seed.is_multiple_of(3) {
        joints.insert(
            "rod".into(),
            json!({"rod": {"between": [last, "ground"], "at": {"a": "end", "b": far}}}),
        );
    } else {
        loads.insert("spring".into(), json!({"spring": {"between": [last, "ground"], "at": {"a": "end", "b": far},
            "rest_length": q(1.5, LENGTH), "stiffness": q(100.0, [1, 0, -2]), "damping": q(1.0, [1, 0, -1])}}));
    }
    functions.insert(
        "root".into(),
        json!({"final": {"joint_force":
        {"joint": "j0", "direction": at.ground([0.3, 1.0, -0.4], [0; 3])}}}),
    );
    powers.push(FORCE);
    functions.insert(
        "spin".into(),
        json!({"final": {"angular_momentum": {"direction": at.ground([1.0, 0.2, 0.5], [0; 3])}}}),
    );
    powers.push([1, 2, -1]);
    let document = json!({
        "version": 1, "name": "family", "gravity": at.ground([1.0, -9.81, 2.0], [0, 1, -2]),
        "initial_velocity": {"angular": at.ground([0.5, 1.0, -0.7], [0, 0, -1]), "linear": at.ground([0.0; 3], [0, 1, -1])},
        "bodies": bodies, "joints": joints, "loads": loads,
        "simulation": {"duration": q(0.01, [0, 0, 1]), "steps": 120, "method": "dop853"},
        "functions": functions
    });
    (document, powers)
}

/// Values of all functions in SI units.
fn values(document: &Value, powers: &[[i32; 3]], at: Written, lowered: bool) -> Vec<f64> {
    let text = document.to_string();
    let mut problem =
        Problem::parse(&text, "family", &[]).unwrap_or_else(|faults| panic!("{faults}"));
    if !lowered {
        problem.lowering = None;
    }
    let motion = simulate(&problem, &problem.start()).unwrap_or_else(|failure| panic!("{failure}"));
    let all = powers.iter().enumerate();
    all.map(|(k, powers)| motion.at.function(k).value / at.number(1.0, *powers))
        .collect()
}

/// Asserts that values agree relative to the largest of their unit.
fn agree(context: &str, (found, reference): (&[f64], &[f64]), powers: &[[i32; 3]], close: f64) {
    for (k, (a, b)) in found.iter().zip(reference).enumerate() {
        let alike = reference
            .iter()
            .zip(powers)
            .filter(|(_, own)| **own == powers[k]);
        let size = alike.fold(0.0_f64, |m, (x, _)| m.max(x.abs()));
        assert!(
            (a - b).abs() <= close * size,
            "{context}, function {k}: {a:e} {b:e} of {size:e}"
        );
    }
}

const SEEDS: std::ops::Range<u64> = 0..6;

/// Bodies, joints and loads in reverse order.
#[test]
fn order_changes_nothing() {
    for seed in SEEDS {
        let (document, powers) = scene(seed, PLAIN);
        let reference = values(&document, &powers, PLAIN, true);
        let mut reversed = document.clone();
        for key in ["bodies", "joints", "loads"] {
            let all: Map<String, Value> = reversed[key]
                .as_object()
                .expect("a map")
                .clone()
                .into_iter()
                .rev()
                .collect();
            reversed[key] = Value::Object(all);
        }
        let found = values(&reversed, &powers, PLAIN, true);
        agree(
            &format!("scene {seed}"),
            (&found, &reference),
            &powers,
            1e-8,
        );
    }
}

/// Millimetres, tonnes and seconds; kilograms, metres and milliseconds; a turn of the whole scene.
#[test]
fn units_and_turns_change_nothing() {
    let all = [
        Written {
            units: [1e-3, 1e3, 1.0],
            turn: None,
        },
        Written {
            units: [1.0, 1.0, 1e3],
            turn: None,
        },
        Written {
            units: [1.0; 3],
            turn: Some(([0.3, -0.8, 0.5], 2.1)),
        },
    ];
    for seed in SEEDS {
        let (document, powers) = scene(seed, PLAIN);
        let reference = values(&document, &powers, PLAIN, true);
        for (k, at) in all.into_iter().enumerate() {
            let (document, powers) = scene(seed, at);
            let found = values(&document, &powers, at, true);
            agree(
                &format!("scene {seed}, case {k}"),
                (&found, &reference),
                &powers,
                1e-7,
            );
        }
    }
}

/// Without reductions, and by an implicit method with half the steps.
#[test]
fn methods_and_reductions_change_nothing() {
    for seed in SEEDS {
        let (mut document, powers) = scene(seed, PLAIN);
        let reference = values(&document, &powers, PLAIN, true);
        let found = values(&document, &powers, PLAIN, false);
        agree(
            &format!("scene {seed} as written"),
            (&found, &reference),
            &powers,
            1e-8,
        );
        document["simulation"]["steps"] = json!(240);
        document["simulation"]["method"] = json!({"radau": {"stages": 3}});
        let found = values(&document, &powers, PLAIN, true);
        agree(
            &format!("scene {seed} by Radau"),
            (&found, &reference),
            &powers,
            1e-4,
        );
    }
}
