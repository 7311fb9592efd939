//! Whole turns of joints: angles count from the start or drive of the joint, and torsion springs have all turns.
//!
//! A disc of inertia J on a torsion spring k swings as φ(t) = φ0 + (φ(0) − φ0) cos ωt + φ̇(0)/ω sin ωt, ω = √(k/J). Free
//! discs turn by φ(0) + φ̇ t.

use crate::reference::documents::{problem as parsed, run};
use crate::reference::gradients::gradients_are_exact;
use flexbody::Analysis;
use flexbody_driver::simulate;
use flexbody_problem::Problem;
use serde_json::Value;
use std::f64::consts::PI;

/// A disc of 2 kg m² on a hinge or another joint with an axis.
fn disc(kind: &str, axis: [f64; 3], simulation: &Value) -> Value {
    json!({
        "version": 1, "name": "disc", "gravity": [0, 0, 0],
        "bodies": {"disc": {"mass": 1, "inertia": {"xx": 2, "yy": 2, "zz": 2}}},
        "joints": {"axle": {kind: {"between": ["disc", "ground"], "at": [0, 0, 0], "axis": axis}}},
        "simulation": simulation,
        "functions": {"angle": {"final": {"angle": {"joint": "axle"}}}, "mean": {"integral": {"angle": {"joint": "axle"}}}}
    })
}

fn methods(duration: f64, steps: u32) -> [Value; 4] {
    [
        json!({"duration": duration}),
        json!({"duration": duration, "method": {"radau": {"stages": 3}}, "steps": steps}),
        json!({"duration": duration, "method": {"bdf": {"order": 2}}, "steps": steps}),
        json!({"duration": duration, "method": {"radau": {"stages": 2}}, "tolerance": 1e-8}),
    ]
}

fn values(document: &Value) -> Vec<f64> {
    let motion = run(document);
    let count = parsed(document).function_names.len();
    (0..count).map(|k| motion.at.function(k).value).collect()
}

/// Starts beyond a turn to either side, about any axis, reduced or not.
#[test]
fn angles_count_from_the_start_of_the_joint() {
    let starts = [7.0, -20.0, 3.3, -3.3, 4.0 * PI, 100.0];
    let kinds = ["revolute", "planar", "cylindrical"];
    let axes = [[0.0, 0.0, 1.0], [1.0, -2.0, 0.5], [0.0, -1.0, 0.0]];
    for (i, start) in starts.into_iter().enumerate() {
        let simulation = &methods(1.0, 20)[i % 4];
        let mut document = disc(kinds[i % 3], axes[i % 3], simulation);
        let joint = &mut document["joints"]["axle"][kinds[i % 3]];
        joint["start"] = json!({"turn": {"angle": start, "rate": 2}});
        let mut problem = parsed(&document);
        for _ in 0..2 {
            let motion = simulate(&problem, &problem.start()).expect("a motion");
            let [last, mean] = [0, 1].map(|k| motion.at.function(k).value);
            // BDF2 errs by (φ̇ h / 2)² / 3 of the turn.
            let tolerance = if i % 4 == 2 { 1e-2 } else { 1e-6 };
            assert!((last - start - 2.0).abs() < tolerance, "{last} {start}");
            assert!((mean - start - 1.0).abs() < tolerance, "{mean} {start}");
            problem.lowering = None;
        }
    }
}

/// Drives that start anywhere, also where the assembly would not find them: their value is the angle, and a body behind them
/// follows.
#[test]
fn angles_count_from_drives() {
    for (i, start) in [0.3, 2.0, 3.0, -PI, 4.8, 7.5, -20.0]
        .into_iter()
        .enumerate()
    {
        let simulation = &methods(1.0, 10)[i % 2];
        let mut document = disc(
            "revolute",
            [[0.0, 0.0, 1.0], [0.3, 1.0, -2.0]][i % 2],
            simulation,
        );
        document["drives"] =
            json!({"motor": {"joint": "axle", "turn": {"polynomial": [start, 1]}}});
        let found = values(&document);
        assert!(
            (found[0] - start - 1.0).abs() < 1e-9,
            "{} {start}",
            found[0]
        );
        assert!(
            (found[1] - start - 0.5).abs() < 1e-9,
            "{} {start}",
            found[1]
        );
    }
}

/// A crank of a parallelogram that starts at 7 rad: all of its joints turn, and the event at 8 rad comes after 0.5 s.
#[test]
fn angles_in_loops_and_events_count_too() {
    let link = |at: [f64; 3]| {
        json!({"shape": {"box": {"size": [0.1, 1, 0.1]}}, "mass": 1, "points": {"a": [0, -0.5, 0], "b": [0, 0.5, 0]},
               "place": {"put": "a", "at": at}})
    };
    let hinge = |between: [&str; 2], at: Value| json!({"revolute": {"between": between, "at": at, "axis": [0, 0, 1]}});
    let mut document = json!({
        "version": 1, "name": "parallelogram", "gravity": [0, 0, 0],
        "bodies": {"left": link([0.0, 0.0, 0.0]), "right": link([3.0, 0.0, 0.0]),
                   "bar": {"shape": {"box": {"size": [3, 0.1, 0.1]}}, "mass": 1, "place": {"at": [1.5, 1, 0]}}},
        "joints": {"a": hinge(["left", "ground"], json!([0, 0, 0])), "b": hinge(["bar", "left"], json!("left.b")),
                   "c": hinge(["bar", "right"], json!("right.b")), "d": hinge(["right", "ground"], json!([3, 0, 0]))},
        "simulation": {"duration": 2, "until": {"measure": {"angle": {"joint": "a"}}, "reaches": 8}},
        "functions": {"a": {"final": {"angle": {"joint": "a"}}}, "T": "duration"}
    });
    document["joints"]["a"]["revolute"]["start"] = json!({"turn": {"angle": 7, "rate": 2}});
    let found = values(&document);
    assert!(
        (found[0] - 8.0).abs() < 1e-8 && (found[1] - 0.5).abs() < 1e-8,
        "{found:?}"
    );
}

/// The disc on a spring of 3 N m/rad.
fn wound(simulation: &Value, [start, rate, rest]: [f64; 3], axis: [f64; 3]) -> (Value, f64) {
    let mut document = disc("revolute", axis, simulation);
    document["joints"]["axle"]["revolute"]["start"] =
        json!({"turn": {"angle": start, "rate": rate}});
    document["loads"] = json!({"spring": {"torsion_spring": {"joint": "axle", "stiffness": 3, "rest_angle": rest}}});
    document["functions"]["torque"] = json!({"final": {"spring_torque": {"load": "spring"}}});
    document["functions"]["energy"] = json!({"final": {"energy": "total"}});
    let (omega, t) = (
        1.5_f64.sqrt(),
        simulation["duration"].as_f64().expect("a duration"),
    );
    let (sin, cos) = (omega * t).sin_cos();
    (document, rest + (start - rest) * cos + rate / omega * sin)
}

/// Springs wound by several turns unwind through all of them, by each method; torque and energy have all turns.
#[test]
fn torsion_springs_have_all_turns() {
    let simulations = methods(2.0, 400);
    let axes = [[0.0, 0.0, 1.0], [1.0, -2.0, 0.5]];
    for (i, numbers) in [
        [0.0, 0.0, -4.0 * PI],
        [7.0, 0.0, 0.0],
        [0.0, 40.0, 0.0],
        [-20.0, 3.0, 10.0],
        [3.0, -25.0, 2.0],
        [0.0, 0.0, 6.0],
        [50.0, 0.0, 48.0],
    ]
    .into_iter()
    .enumerate()
    {
        let simulation = &simulations[i % 4];
        let (document, expected) = wound(simulation, numbers, axes[i % 2]);
        let [start, rate, rest] = numbers;
        let energy = rate * rate + 1.5 * (start - rest).powi(2);
        // BDF2 errs by (φ̇ h / 2)² / 3; the others are far below.
        let tolerance = if i % 4 == 2 { 1e-2 } else { 1e-6 };
        let found = values(&document);
        let size = (start - rest).abs() + rate.abs();
        assert!(
            (found[0] - expected).abs() < tolerance * size,
            "{found:?} {expected}"
        );
        assert!((found[2] - 3.0 * (expected - rest)).abs() < 3.0 * tolerance * size);
        assert!(
            (found[3] / energy - 1.0).abs() < 4.0 * tolerance,
            "{found:?} {energy}"
        );
    }
}

/// Two free discs on a spring between them swing against each other by the reduced inertia; the first starts with a spin.
#[test]
fn springs_between_moving_bodies_count_turns() {
    let (mut document, _) = wound(&json!({"duration": 3}), [9.0, 0.0, 0.0], [0.0, 0.0, 1.0]);
    document["bodies"]["other"] = json!({"mass": 1, "inertia": {"xx": 4, "yy": 4, "zz": 4}});
    document["joints"]["axle"]["revolute"]["between"] = json!(["disc", "other"]);
    document["initial_velocity"] = json!({"angular": [0, 0, 30]});
    let omega = (3.0 * (1.0 / 2.0 + 1.0 / 4.0_f64)).sqrt();
    let found = values(&document);
    assert!(
        (found[0] - 9.0 * (3.0 * omega).cos()).abs() < 1e-6,
        "{found:?}"
    );
}

/// Derivatives by rest angle, stiffness, start and rate, from the tape and from checkpoints, whose states have the turns.
#[test]
fn derivatives_of_wound_springs_are_exact() {
    for simulation in [
        json!({"duration": 2, "steps": 40, "method": "dop853"}),
        json!({"duration": 2, "steps": 60, "method": {"radau": {"stages": 2}}}),
        json!({"duration": 2, "steps": 120, "method": {"bdf": {"order": 3}}}),
    ] {
        let (mut document, _) = wound(&simulation, [7.0, 12.0, -4.0 * PI], [1.0, -2.0, 0.5]);
        document["loads"]["spring"]["torsion_spring"]["damping"] = json!(0.1);
        document["variables"] = json!({
            "rest": {"path": "/loads/spring/torsion_spring/rest_angle", "lower": -100, "upper": 100},
            "stiffness": {"path": "/loads/spring/torsion_spring/stiffness", "lower": 0, "upper": 100},
            "damping": {"path": "/loads/spring/torsion_spring/damping", "lower": 0, "upper": 100},
            "start": {"path": "/joints/axle/revolute/start/turn/angle", "lower": -100, "upper": 100},
            "rate": {"path": "/joints/axle/revolute/start/turn/rate", "lower": -100, "upper": 100}
        });
        let problem = parsed(&document);
        gradients_are_exact(&problem, &simulation);
        let mut small = problem.clone();
        small.limit_memory(1);
        let gradients = |problem: &Problem| {
            let mut analysis = Analysis::new(problem);
            let design = analysis.at(&problem.start()).expect("values");
            design.gradients(&[0, 1, 2, 3]).expect("gradients")
        };
        assert_eq!(gradients(&problem), gradients(&small), "{simulation}");
    }
}

/// Rotations count the turns of starts and drives between the bodies, as angles do: from the placement and from parallel
/// axes, against ground and against another body, about the axis to either side.
#[test]
fn rotations_count_the_turns_of_starts_and_drives() {
    let inertia = json!({"xx": 2, "yy": 2, "zz": 2});
    for (first, second, axis, placed) in [
        (7.0, 9.0, [0.0, 0.0, 1.0], 0.0),
        (-20.0, 3.0, [0.0, 0.0, -1.0], 0.4),
        (13.0, -13.0, [1.0, -2.0, 0.5], 0.0),
        (4.0 * PI, 0.5, [0.0, 1.0, 0.0], -0.9),
        (2.0, -8.0, [-1.0, 0.0, 0.3], 1.2),
        (100.0, 40.0, [0.3, 0.2, 1.0], 0.0),
    ] {
        let back = axis.map(|x: f64| -x);
        let rotation = |body: &str, axis: [f64; 3], other: &str, from: &str| json!({"final": {"rotation": {"body": body, "axis": axis, "relative_to": other, "from": from}}});
        let document = json!({
            "version": 1, "name": "discs", "gravity": [0, 0, 0],
            "bodies": {
                "near": {"mass": 1, "inertia": inertia, "place": {"turn": {"axis": axis, "angle": placed}}},
                "far": {"mass": 1, "inertia": inertia}
            },
            "joints": {
                "a": {"revolute": {"between": ["ground", "near"], "at": [0, 0, 0], "axis": axis}},
                "b": {"cylindrical": {"between": ["far", "near"], "at": [0, 0, 0], "axis": back,
                    "start": {"turn": {"angle": second, "rate": 2}}}}
            },
            "drives": {"d": {"joint": "a", "turn": {"polynomial": [first, 1]}}},
            "simulation": {"duration": 1},
            "functions": {
                "near": rotation("near", axis, "ground", "placement"),
                "near from axes": rotation("near", axis, "ground", "axes"),
                "far": rotation("far", axis, "ground", "placement"),
                "far of near": rotation("far", axis, "near", "placement"),
                "near of far, back": rotation("near", back, "far", "axes")
            }
        });
        // An angle is that of the joint's first body against the second, and ground counts as the second.
        let near = first + 1.0;
        let relative = -(second + 2.0);
        let exact = [
            near,
            near + placed,
            near + relative,
            relative,
            relative - placed,
        ];
        for (found, exact) in values(&document).iter().zip(exact) {
            assert!(
                (found - exact).abs() < 1e-6,
                "{first} {second}: {found} {exact}"
            );
        }
    }
}
