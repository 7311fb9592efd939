//! The rigid benchmarks in `problems/benchmarks` against their references: Andrews' squeezer from
//! the test set for IVP solvers (Mazzia & Magherini 2008, solved by PSIDE); the simple pendulum
//! from elliptic functions; the governor from an independent integration of its three coordinates
//! to 1e-11 (Radau).

use crate::reference::documents::{benchmark, bodies, final_positions, optimised, problem};
use flexbody_driver::stability::in_units;
use flexbody_driver::start::notes;
use flexbody_driver::{Simulation, simulate};
use flexbody_mathematics::math::{Mat3, Vec3, rotation};
use flexbody_problem::{Override, Problem};
use serde_json::Value;
use std::path::Path;

fn load(name: &str, changes: &[String]) -> Problem {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"));
    let path = path.join(format!("problems/benchmarks/{name}.json"));
    let parse = |text: &String| Override::parse(text).expect("an override");
    let changes: Vec<Override> = changes.iter().map(parse).collect();
    Problem::load(&path, &changes).unwrap_or_else(|faults| panic!("{faults}"))
}

fn run(name: &str, duration: f64) -> Simulation {
    let problem = load(name, &[format!("/simulation/duration={duration}")]);
    simulate(&problem, &problem.start()).expect("runs")
}

fn values(motion: &Simulation) -> Vec<f64> {
    let count = motion.at.scene.functions.len();
    (0..count).map(|f| motion.at.function(f).value).collect()
}

/// Asserts a list of values to `tolerance` of the largest.
fn agree(what: &str, found: &[f64], expected: &[f64], tolerance: f64) {
    let size = expected.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    for (found, expected) in found.iter().zip(expected) {
        let error = (found - expected).abs() / size;
        assert!(
            error <= tolerance,
            "{what}: {found} against {expected}: {error:e}"
        );
    }
}

/// A01: positions after 1, 2, 5 and 10 s.
#[test]
fn simple_pendulum() {
    for (duration, exact) in [
        (1.0, [0.986_291_751_131_875, -0.165_010_853_125_541]),
        (2.0, [-0.793_566_195_343_322, -0.608_483_930_443_792]),
        (5.0, [-0.942_305_435_043_757, -0.334_754_338_414_001]),
        (10.0, [-0.275_087_462_576_117, -0.961_419_205_099_125]),
    ] {
        agree(
            "A01",
            &values(&run("simple_pendulum", duration)),
            &exact,
            1e-9,
        );
    }
}

/// A03 at 0.03 s: angles to 1e-9, angular velocities to 1e-8, multipliers (forces in the joints at
/// E) to 1e-7 of the largest.
#[test]
fn andrews_squeezer() {
    let motion = run("andrews_squeezer", 0.03);
    let [beta, theta, gamma, phi, delta, omega, epsilon] = [
        15.810_771_196_299_04,
        -15.756_371_059_842_98,
        0.040_822_240_130_731_01,
        -0.534_730_116_322_694_8,
        0.524_409_965_880_530_4,
        0.534_730_116_322_694_8,
        1.048_080_741_042_263,
    ];
    let angles = [
        beta,
        beta + theta,
        gamma,
        phi + delta,
        delta,
        omega + epsilon,
        epsilon,
    ];
    agree("A03 angles", &values(&motion), &angles, 1e-9);
    let [beta, theta, gamma, phi, delta, omega, epsilon] = [
        1_139.920_302_151_208,
        -1_424.379_294_994_111,
        11.032_912_219_371_34,
        19.293_374_644_213_85,
        0.573_569_928_479_080_8,
        -19.293_374_644_213_85,
        0.323_179_165_802_695_5,
    ];
    // In the order of the bodies.
    let rates = [
        beta,
        beta + theta,
        gamma,
        delta,
        phi + delta,
        epsilon,
        omega + epsilon,
    ];
    let run = &motion.at.run;
    let v = run.v(run.last());
    let found: Vec<f64> = v.chunks(6).map(|six| six[5]).collect();
    agree("A03 rates", &found, &rates, 1e-8);
    let multipliers = [
        199.175_333_373_191,
        -29.755_312_280_150_52,
        23.066_541_190_983_99,
        31.452_713_654_759_27,
        22.642_492_320_827_39,
        11.617_407_000_196_73,
    ];
    let reactions = motion.reactions(run.last());
    let joints = motion.at.scene.model.joints.iter().zip(&reactions);
    let at_e = joints.filter(|(joint, _)| joint.name.starts_with('E'));
    let found: Vec<f64> = at_e
        .flat_map(|(_, at)| [-at.force_ground.x, -at.force_ground.y])
        .collect();
    assert_eq!(found.len(), multipliers.len());
    agree("A03 multipliers", &found, &multipliers, 1e-7);
}

/// A05: height of the slider, known to ten digits.
#[test]
fn flyball_governor() {
    for (duration, height) in [
        (0.5, 0.743_249_424_8),
        (1.0, 0.501_420_922_4),
        (5.0, 0.535_563_103_7),
        (10.0, 0.619_622_917_1),
    ] {
        let found = values(&run("flyball_governor", duration))[0];
        assert!(
            (found - height).abs() <= 1e-8,
            "{duration}: {found} against {height}"
        );
    }
}

/// A spring of 1e5 rad/s without damping, at ω h = 100 by Radau IIA with three stages, against an
/// integration that resolves it. The slow swing agrees to 1e-8 m and 1e-7 m/s throughout, and no
/// fast vibration is excited.
#[test]
fn stiff_pendulum() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"));
    let path = path.join("tests/data/stiff_pendulum_reference.json");
    let text = std::fs::read_to_string(path).expect("a reference");
    let file: Value = serde_json::from_str(&text).expect("valid JSON");
    let rows: Vec<Vec<f64>> =
        serde_json::from_value(file["trajectory"].clone()).expect("rows of numbers");
    let motion = run("stiff_pendulum", 3.0);
    let run = &motion.at.run;
    for row in &rows[1..] {
        let k = (row[0] / 3.0 * run.last() as f64).round() as usize;
        for i in 0..2 {
            let (x, v) = (run.q(k)[i] - row[1 + i], run.v(k)[i] - row[3 + i]);
            assert!(
                x.abs() <= 1e-8 && v.abs() <= 1e-7,
                "{} s: {x:e}, {v:e}",
                row[0]
            );
        }
    }
}

/// The shaking force vanishes at s1 = −L1 (m2 + m3) / m1 = −0.075 m and s2 = −L2 m3 / m2 = −0.15 m.
/// The optimiser finds this from 0.075 m and 0.3 m away, and from the other side.
#[test]
fn balanced_slider_crank() {
    for start in [[0.0, 0.15], [-0.1, -0.2]] {
        let paths = ["crank", "rod"].map(|body| format!("/bodies/{body}/centre_of_mass/0"));
        let changes = [0, 1].map(|i| format!("{}={}", paths[i], start[i]));
        let problem = load("balanced_slider_crank", &changes);
        let done = optimised(&problem);
        let design = &done.history.rows.last().expect("iterations").design;
        agree("balance", design, &[-0.075, -0.15], 1e-6);
    }
}

/// Every benchmark with a short duration, and its tolerance.
const FAMILY: [(&str, f64, f64); 9] = [
    ("simple_pendulum", 0.5, 1e-10),
    ("andrews_squeezer", 0.005, 1e-10),
    ("bricard", 0.5, 1e-9),
    ("balanced_slider_crank", 0.1, 1e-9),
    ("four_bars_1", 0.3, 1e-9),
    ("four_bars_2", 0.3, 1e-9),
    ("four_bars_10", 0.05, 1e-8),
    ("flyball_governor", 0.01, 1e-8),
    ("stiff_pendulum", 0.01, 1e-8),
];

/// A benchmark with the final positions of all centres of mass as its functions. For an
/// `inconsistent` start, its first body has a velocity that violates its joints.
fn plain(name: &str, (duration, tolerance): (f64, f64), inconsistent: bool) -> Value {
    let mut simulation = json!({"duration": duration, "tolerance": tolerance});
    if ["flyball_governor", "stiff_pendulum"].contains(&name) {
        simulation["method"] = json!({"radau": {"stages": 3}});
    }
    let mut file = final_positions(&benchmark(name), simulation);
    let gravity = file.as_object_mut().expect("an object").entry("gravity");
    gravity.or_insert(json!([0, -9.81, 0]));
    if inconsistent {
        let velocity = json!({"linear": [0.3, 0.2, 0.1], "angular": [0.5, -0.4, 1.0]});
        let first = bodies(&file).swap_remove(0);
        file["bodies"][first]["velocity"] = velocity;
    }
    file
}

fn ends(file: &Value) -> Vec<f64> {
    let problem = problem(file);
    values(&simulate(&problem, &problem.start()).unwrap_or_else(|failure| panic!("{failure}")))
}

/// With lengths in 1000 m and mm, and masses in 1000 t and mg, the motions are equal except for the
/// unit, from consistent and from projected starts.
#[test]
fn units_do_not_matter() {
    for (name, duration, tolerance) in FAMILY {
        for inconsistent in [false, true] {
            let file = plain(name, (duration, tolerance), inconsistent);
            let base = ends(&file);
            for (length, mass) in [
                (1e3, 1.0),
                (1e-3, 1.0),
                (1.0, 1e6),
                (1.0, 1e-6),
                (1e3, 1e-6),
            ] {
                let mut other = file.clone();
                for (path, value) in in_units(&file, (length, mass)) {
                    *other.pointer_mut(&path).expect("a number") = value;
                }
                let found: Vec<f64> = ends(&other).iter().map(|x| x / length).collect();
                agree(
                    &format!("{name}, {length}, {mass}"),
                    &found,
                    &base,
                    100.0 * tolerance,
                );
            }
        }
    }
}

/// Rotates the three numbers of a list.
fn turn(value: &mut Value, by: &Mat3<f64>) {
    let list = value
        .as_array()
        .filter(|list| list.len() == 3 && list[0].is_number());
    if let Some(list) = list {
        let x = Vec3::from_fn(|i, _| list[i].as_f64().expect("a number"));
        *value = json!((by * x).as_slice());
    }
}

/// The whole scene, rotated about the origin.
fn turned(file: &Value, axis: &Vec3<f64>, angle: f64) -> Value {
    let by = rotation::matrix(&rotation::from_axis_angle(axis, angle));
    let mut file = file.clone();
    turn(&mut file["gravity"], &by);
    let velocity = |value: &mut Value| {
        for key in ["linear", "angular", "about"] {
            if let Some(own) = value.get_mut(key) {
                turn(own, &by);
            }
        }
    };
    if let Some(all) = file.get_mut("initial_velocity") {
        velocity(all);
    }
    for body in file["bodies"].as_object_mut().expect("bodies").values_mut() {
        if let Some(own) = body.get_mut("velocity") {
            velocity(own);
        }
        if body.get("place").is_none() {
            body["place"] = json!({});
        }
        let place = &mut body["place"];
        if let Some(at) = place.get_mut("at") {
            turn(at, &by);
        }
        if place.get("relative_to").is_none() {
            let mut turns = match place.get("turn") {
                None => Vec::new(),
                Some(Value::Array(turns)) => turns.clone(),
                Some(one) => vec![one.clone()],
            };
            turns.push(json!({"axis": axis.as_slice(), "angle": angle}));
            place["turn"] = turns.into();
        }
    }
    // Points of ground are in ground axes.
    let ends = |value: &mut Value| {
        let grounded = [0, 1].map(|k| value["between"][k] == "ground");
        if value["at"].is_object() {
            for (key, _) in ["a", "b"]
                .iter()
                .zip(grounded)
                .filter(|(_, grounded)| *grounded)
            {
                turn(&mut value["at"][*key], &by);
            }
        } else if let Some(at) = value.get_mut("at") {
            turn(at, &by);
        }
    };
    let joints = file.get_mut("joints").and_then(Value::as_object_mut);
    for joint in joints.into_iter().flat_map(|joints| joints.values_mut()) {
        let joint = joint
            .as_object_mut()
            .expect("a joint")
            .values_mut()
            .next()
            .expect("a kind");
        ends(joint);
        if let Some(axis) = joint.get_mut("axis") {
            turn(axis, &by);
        }
    }
    let loads = file.get_mut("loads").and_then(Value::as_object_mut);
    for load in loads.into_iter().flat_map(|loads| loads.values_mut()) {
        let load = load
            .as_object_mut()
            .expect("a load")
            .values_mut()
            .next()
            .expect("a kind");
        if load["between"].is_array() {
            ends(load);
        }
        if load["axes"] != "body" && load["direction"].is_array() {
            turn(&mut load["direction"], &by);
        }
    }
    file
}

/// Five rotations of every scene: equal motions, rotated, from consistent and from projected
/// starts.
#[test]
fn axes_do_not_matter() {
    for (name, duration, tolerance) in FAMILY {
        for inconsistent in [false, true] {
            let file = plain(name, (duration, tolerance), inconsistent);
            let base = ends(&file);
            for (axis, angle) in [
                (Vec3::new(1.0, 2.0, 3.0), 0.7),
                (Vec3::new(-2.0, 0.3, 1.0), 2.1),
                (Vec3::new(0.1, -1.0, 0.4), -1.3),
                (Vec3::new(0.0, 0.0, 1.0), 0.4),
                (Vec3::new(1.0, 0.0, 0.0), 3.0),
            ] {
                let back = rotation::matrix(&rotation::from_axis_angle(&axis, -angle));
                let found = ends(&turned(&file, &axis, angle));
                let found: Vec<f64> = found
                    .chunks(3)
                    .flat_map(|x| Vec::from((back * Vec3::from_column_slice(x)).as_slice()))
                    .collect();
                agree(&format!("{name}, {axis}"), &found, &base, 100.0 * tolerance);
            }
        }
    }
}

/// A body on one hinge with a velocity that violates the hinge. It starts with the velocity after
/// an impulse of the hinge, ω = e · (J_C ω + c × m v) / (e · J_O e), in any unit of length, with a
/// note.
#[test]
fn an_inconsistent_start_is_told_and_has_no_unit() {
    for unit in [1.0, 1e3, 1e-3] {
        let of = |x: f64| x * unit;
        let file = json!({
            "version": 1, "name": "hinged",
            "bodies": {"body": {"shape": {"box": {"size": [of(1.0), of(0.4), of(0.2)]}}, "mass": 2,
                                "place": {"at": [of(0.5), 0, 0]},
                                "velocity": {"linear": [of(3.0), of(5.0), of(7.0)],
                                             "angular": [1, 2, 4]}}},
            "joints": {"hinge": {"revolute": {"between": ["body", "ground"], "at": [0, 0, 0],
                                              "axis": [0, 0, 1]}}},
            "simulation": {"duration": 0.1, "steps": 10}
        });
        let problem = Problem::parse(&file.to_string(), "hinged.json", &[]).expect("no faults");
        let motion = simulate(&problem, &[]).expect("runs");
        let moment = 2.0 * (1.0 + 0.16) / 12.0;
        let exact = (moment * 4.0 + 0.5 * 2.0 * 5.0) / (moment + 0.5);
        let found = motion.motion().v(0)[5];
        assert!(
            (found - exact).abs() <= 1e-13 * exact,
            "{unit}: {found} for {exact}"
        );
        let notes = notes(&problem, &[]);
        assert_eq!(notes.len(), 1, "{notes:?}");
        let told = "the joints do not admit the given velocity of body \"body\": it starts with";
        assert!(notes[0].starts_with(told), "{notes:?}");
    }
}

/// A door whose second hinge is tilted by 1e-6 cannot move. Notes report this, and that it does not
/// start as given. The same holds for a Bricard mechanism with a hinge displaced by 1e-6 m, whose
/// conditions are nearly redundant.
#[test]
fn joints_that_leave_no_freedom_are_told() {
    let door = |tilt: f64| {
        json!({
            "version": 1, "input_tolerance": 1e-9, "name": "door",
            "bodies": {"door": {"shape": {"box": {"size": [1, 2, 0.04]}}, "mass": 30,
                                "place": {"at": [0.5, 0, 0]},
                                "velocity": {"linear": [0, 0, -1], "angular": [0, 2, 0]}}},
            "joints": {
                "upper": {"revolute": {"between": ["door", "ground"], "at": [0, 0.8, 0],
                                       "axis": [0, 1, 0]}},
                "lower": {"revolute": {"between": ["door", "ground"], "at": [0, -0.8, 0],
                                       "axis": [tilt, 1, 0]}}},
            "simulation": {"duration": 0.1, "steps": 10}
        })
    };
    let told = |file: &Value| {
        let problem = Problem::parse(&file.to_string(), "door.json", &[]).expect("no faults");
        notes(&problem, &[])
    };
    assert_eq!(told(&door(0.0)), Vec::<String>::new());
    let locked = told(&door(1e-6));
    assert!(
        locked[0].starts_with("the joints leave no freedom: nothing can move; their"),
        "{locked:?}"
    );
    assert!(
        locked[1].contains("\"door\": it starts with 1.4e-4 of 1.0000 m/s"),
        "{locked:?}"
    );
    let mut bricard = plain("bricard", (0.1, 1e-8), false);
    assert_eq!(told(&bricard), Vec::<String>::new());
    bricard["input_tolerance"] = json!(1e-9);
    bricard["joints"]["P2"]["revolute"]["at"] = json!([1, -0.999999, 0]);
    let nearly = told(&bricard);
    assert!(nearly[0].contains("nearly repeat each other"), "{nearly:?}");
}
