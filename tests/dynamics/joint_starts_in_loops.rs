//! Starts of joints in loops: the other joints follow.
//!
//! Mechanisms have about 1 m, 1 kg and 1 s. Differences are round-off, 1e-12, unless stated.

use super::joint_starts::{State, list, named, shuffle, started};
use crate::reference::documents::problem;
use crate::reference::models::Numbers;
use flexbody_driver::{check, simulate};
use flexbody_mathematics::math::rotation::{from_axis_angle, matrix};
use flexbody_mathematics::math::scalar::COMPLEX_STEP;
use flexbody_mathematics::math::{Complex64, Dual, Scalar, Vec3};
use flexbody_mechanics::integrate::IntegrationFailure;
use flexbody_mechanics::model::{DegreeOfFreedom, Drive, Model, TimeFunction};
use flexbody_mechanics::system::Numbering;
use flexbody_mechanics::system::initial;
use flexbody_mechanics::system::kkt::SaddlePoint;
use flexbody_mechanics::system::placement;
use flexbody_problem::Problem;
use serde_json::Value;

/// Crank, coupler, rocker and distance of the pivots of a four-bar linkage.
const LENGTHS: [f64; 4] = [0.4, 1.3, 0.9, 1.1];

/// Angles of coupler and rocker of a four-bar linkage with its crank at θ, and their rates for the
/// crank's rate: the intersection of two circles (the open solution of Freudenstein's equation),
/// and the projections of the loop's velocities.
fn linkage<S: Scalar>([a, b, c, d]: [S; 4], theta: S, rate: S) -> [S; 4] {
    let (sine, cosine) = theta.sin_cos();
    let (ax, ay) = (a * cosine, a * sine);
    let (fx, fy) = (d - ax, -ay);
    let f = (fx * fx + fy * fy).sqrt();
    let along = (f * f + b * b - c * c) / (f * 2.0);
    let across = (b * b - along * along).sqrt();
    let (ux, uy) = (fx / f, fy / f);
    let (bx, by) = (ax + ux * along - uy * across, ay + uy * along + ux * across);
    let coupler = (by - ay).atan2(bx - ax);
    let rocker = by.atan2(bx - d);
    let sin = |x: S| x.sin_cos().0;
    [
        coupler,
        rocker,
        a * rate * sin(theta - rocker) / (b * sin(rocker - coupler)),
        a * rate * sin(theta - coupler) / (c * sin(rocker - coupler)),
    ]
}

/// A four-bar linkage whose crank is placed at the angle `placed`; the joint `joint` has this
/// start.
fn four_bar(placed: f64, joint: &str, start: Value) -> Value {
    let [a, b, c, d] = LENGTHS;
    let [coupler, rocker, ..] = linkage(LENGTHS, placed, 0.0);
    let tip = [a * placed.cos(), a * placed.sin(), 0.0];
    let bar = |length: f64, at: [f64; 3], angle: f64| {
        json!({
            "mass": 1.5 * length, "inertia": {"xx": 0.05 * length, "yy": 0.2 * length, "zz": 0.21 * length},
            "centre_of_mass": [0.5 * length, 0, 0], "points": {"end": [length, 0, 0]},
            "place": {"at": at, "turn": {"axis": [0, 0, 1], "angle": angle}}
        })
    };
    let hinge = |between: [&str; 2], at: Value| json!({"revolute": {"between": between, "at": at, "axis": [0, 0, 1]}});
    let zero = [0.0; 3];
    let mut file = json!({
        "version": 1, "name": "four-bar linkage",
        "bodies": {"crank": bar(a, zero, placed), "coupler": bar(b, tip, coupler),
                   "rocker": bar(c, [d, 0.0, 0.0], rocker)},
        "joints": {
            "motor": hinge(["crank", "ground"], json!({"a": zero, "b": zero})),
            "pin": hinge(["coupler", "crank"], json!({"a": zero, "b": "end"})),
            "knee": hinge(["rocker", "coupler"], json!({"a": "end", "b": "end"})),
            "pivot": hinge(["rocker", "ground"], json!({"a": zero, "b": [d, 0, 0]}))
        },
        "simulation": {"duration": 0.3, "steps": 100},
        "functions": {
            "x": {"final": {"position": {"body": "coupler", "direction": [1, 0, 0]}}},
            "work": {"integral": {"energy": "kinetic"}}
        }
    });
    file["joints"][joint]["revolute"]["start"] = start;
    file
}

fn angle(state: &State) -> f64 {
    state.turn[(1, 0)].atan2(state.turn[(0, 0)])
}

fn around(angle: f64) -> f64 {
    let (sine, cosine) = angle.sin_cos();
    sine.atan2(cosine)
}

/// The linkage has the angles and rates of the closed form for every angle of the crank, up to a
/// whole turn from the placement, and every rate. It also has them with the start of another joint
/// instead.
#[test]
fn a_four_bar_linkage_starts_as_its_closed_form_says() {
    let mut numbers = Numbers(5);
    for k in 0..12 {
        let (placed, rate) = (0.7 + numbers.next(), 3.0 * numbers.next());
        let by = std::f64::consts::PI * (f64::from(k) - 5.5) / 3.0;
        let theta = placed + by;
        let exact = linkage(LENGTHS, theta, rate);
        let before = linkage(LENGTHS, placed, 0.0);
        let by_crank = four_bar(
            placed,
            "motor",
            json!({"turn": {"angle": by, "rate": rate}}),
        );
        let pin = exact[0] - theta - (before[0] - placed);
        let pin = json!({"turn": {"angle": pin, "rate": exact[2] - rate}});
        let by_pin = four_bar(placed, "pin", pin);
        let all = [Some(by_crank), (by.abs() < 1.0).then_some(by_pin)];
        for file in all.into_iter().flatten() {
            let (found, _) = started(&problem(&file), &[]);
            let bodies = ["crank", "coupler", "rocker"].map(|name| named(&found, name));
            for (body, exact) in bodies.iter().zip([theta, exact[0], exact[1]]) {
                let off = around(angle(body) - exact);
                assert!(off.abs() <= 1e-12, "{k}: {off:e}");
            }
            for (body, exact) in bodies.iter().zip([rate, exact[2], exact[3]]) {
                let off = body.omega - Vec3::new(0.0, 0.0, exact);
                assert!(off.amax() <= 5e-12, "{k}: {off}");
            }
        }
    }
}

/// Derivatives of the rocker's angle and rate in the crank's angle and rate and in every length,
/// which opens the joints of the placement. The map to the scene by dual numbers agrees with the
/// closed form by the complex step to 1e-12.
#[test]
fn derivatives_are_those_of_the_closed_form() {
    for (placed, by, rate) in [(0.7, 0.4, 1.3), (0.2, -1.1, -0.8), (1.9, 2.5, 0.6)] {
        let start = json!({"turn": {"angle": by, "rate": rate}});
        let mut file = four_bar(placed, "motor", start);
        file["variables"] = json!({
            "crank": {"path": "/bodies/crank/points/end/0"},
            "coupler": {"path": "/bodies/coupler/points/end/0"},
            "rocker": {"path": "/bodies/rocker/points/end/0"},
            "base": {"path": "/joints/pivot/revolute/at/b/0"},
            "placed": {"path": "/bodies/crank/place/turn/angle"},
            "angle": {"path": "/joints/motor/revolute/start/turn/angle"},
            "rate": {"path": "/joints/motor/revolute/start/turn/rate"},
        });
        let problem = problem(&file);
        let x = problem.start();
        for i in 0..x.len() {
            let dual: Vec<Dual> = (x.iter().enumerate())
                .map(|(j, &x)| Dual::new(x, if i == j { 1.0 } else { 0.0 }))
                .collect();
            let model = problem.unlowered_scene(&dual).model;
            let body = &model.bodies[2];
            let turn = matrix(&body.orientation);
            let found = [
                turn[(1, 0)].atan2(turn[(0, 0)]),
                (turn * body.angular_velocity).z,
            ];
            let step = |j: usize| Complex64::new(x[j], if i == j { COMPLEX_STEP } else { 0.0 });
            let lengths = [step(0), step(1), step(2), step(3)];
            let exact = linkage(lengths, step(4) + step(5), step(6));
            for (found, exact) in found.into_iter().zip([exact[1], exact[3]]) {
                let derivative = exact.im / COMPLEX_STEP;
                let size = 1.0 + derivative.abs();
                assert!(around(found.re - exact.re).abs() <= 1e-11, "{i}");
                let off = (found.du - derivative).abs();
                assert!(off <= 1e-12 * size, "{i}: {} {derivative}", found.du);
            }
        }
        for derivative in check(&problem, &x).expect("runs") {
            let off = derivative.relative_difference();
            assert!(
                derivative.is_round_off() || off <= 1e-12,
                "{derivative:?} {off:e}"
            );
        }
    }
}

/// The linkage in another plane.
fn tilted(mut file: Value, axis: &Vec3<f64>, angle: f64) -> Value {
    let turn = matrix(&from_axis_angle(axis, angle));
    let tilt = |vector: &mut Value| {
        let x = [0, 1, 2].map(|k| vector[k].as_f64().expect("a number"));
        *vector = json!(list(&(turn * Vec3::from(x))));
    };
    file["gravity"] = json!([0, -9.81, 0]);
    tilt(&mut file["gravity"]);
    for body in file["bodies"].as_object_mut().expect("bodies").values_mut() {
        tilt(&mut body["place"]["at"]);
        let own = body["place"]["turn"].clone();
        body["place"]["turn"] = json!([own, {"axis": list(axis), "angle": angle}]);
    }
    for joint in file["joints"].as_object_mut().expect("joints").values_mut() {
        let joint = &mut joint["revolute"];
        tilt(&mut joint["axis"]);
        if joint["between"][1] == "ground" {
            tilt(&mut joint["at"]["b"]);
        }
    }
    tilt(&mut file["functions"]["x"]["final"]["position"]["direction"]);
    file
}

/// A reduced scene moves as the whole one, in any plane.
#[test]
fn a_lowered_linkage_starts_as_the_whole_one() {
    let mut numbers = Numbers(31);
    let rates = [0.0, 1.3, -2.0, 0.0, 0.5, 0.0];
    for (k, rate) in rates.into_iter().enumerate() {
        let by = [0.4, -2.0, 0.9][k % 3];
        let start = json!({"turn": {"angle": by, "rate": rate}});
        let mut file = four_bar(0.7, "motor", start);
        if k > 0 {
            file = tilted(file, &numbers.vector(), 3.0 * numbers.next());
        }
        file["variables"] = json!({"angle": {"path": "/joints/motor/revolute/start/turn/angle"},
                                   "rate": {"path": "/joints/motor/revolute/start/turn/rate"}});
        let lowered = problem(&file);
        let mut whole = lowered.clone();
        whole.lowering = None;
        let unknowns =
            |problem: &Problem| Numbering::new(&problem.scene(&problem.start()).model).unknowns();
        assert_eq!([unknowns(&lowered), unknowns(&whole)], [9, 18]);
        let of = |problem: &Problem| -> Vec<f64> {
            let motion = simulate(problem, &problem.start()).expect("runs");
            let values = (0..2).map(|f| motion.at.function(f).value);
            let values: Vec<f64> = values.collect();
            let gradient = check(problem, &problem.start()).expect("runs");
            values
                .into_iter()
                .chain(gradient.iter().map(|d| d.adjoint))
                .collect()
        };
        for (lowered, whole) in of(&lowered).into_iter().zip(of(&whole)) {
            let off = (lowered - whole).abs();
            assert!(off <= 1e-11 * (1.0 + whole.abs()), "{lowered} {whole}");
        }
    }
}

/// Order, orientation and units in which a mechanism is written.
struct Writing {
    seed: u64,
    axis: Vec3<f64>,
    angle: f64,
    /// Metre, kilogram and second in the units of the file.
    units: [f64; 3],
}

const PLAIN: Writing = Writing {
    seed: 0,
    axis: Vec3::new(0.0, 0.0, 1.0),
    angle: 0.0,
    units: [1.0; 3],
};

/// A loop of four bodies with five degrees of freedom (a hinge, a ball, a cylindrical and a
/// universal joint, and a ball), and a body that it carries. The starts of the hinge and the
/// cylindrical joint are given. The rest follows from the mass.
fn five_freedoms(writing: &Writing) -> Value {
    let [metre, kilogram, second] = writing.units;
    let turn = matrix(&from_axis_angle(&writing.axis, writing.angle));
    let mut numbers = Numbers(17);
    let corners = [
        Vec3::new(0.0, 0.0, 0.0),
        Vec3::new(0.2, 1.0, 0.1),
        Vec3::new(1.1, 1.2, 0.4),
        Vec3::new(1.6, 0.6, -0.2),
        Vec3::new(1.5, -0.3, 0.1),
        Vec3::new(0.9, 2.0, 0.2),
    ];
    let corner = |i: usize| list(&(turn * corners[i] * metre));
    let mut bodies: Vec<(String, Value)> = ["a", "b", "c", "d", "hung"]
        .iter()
        .enumerate()
        .map(|(i, name)| {
            let middle = match i {
                4 => corners[5],
                _ => (corners[i] + corners[i + 1]) * 0.5,
            };
            let own = json!({"axis": list(&numbers.vector()), "angle": numbers.next()});
            let whole = json!({"axis": list(&writing.axis), "angle": writing.angle});
            let j = kilogram * metre * metre;
            let body = json!({
                "mass": (1.0 + 0.5 * numbers.next()) * kilogram,
                "inertia": {"xx": 0.1 * j, "yy": 0.13 * j, "zz": 0.16 * j, "xy": 0.02 * j},
                "place": {"at": list(&(turn * middle * metre)), "turn": [own, whole]},
                "velocity": {
                    "linear": list(&(turn * numbers.vector() * (metre / second))),
                    "angular": list(&(turn * numbers.vector() / second))
                }
            });
            ((*name).to_owned(), body)
        })
        .collect();
    let direction = |x: f64, y: f64, z: f64| list(&(turn * Vec3::new(x, y, z)));
    let mut order = Numbers(writing.seed + 1000);
    let mut between = |names: [&'static str; 2]| -> ([&'static str; 2], f64) {
        match writing.seed > 0 && order.next() < 0.0 {
            true if names[1] == "ground" => ([names[1], names[0]], 1.0),
            true => ([names[1], names[0]], -1.0),
            false => (names, 1.0),
        }
    };
    let (hinge, sign) = between(["a", "ground"]);
    let hinge = json!({"revolute": {
        "between": hinge, "at": corner(0), "axis": direction(0.3, 0.2, 1.0),
        "start": {"turn": {"angle": 0.5 * sign, "rate": 1.2 * sign / second}}
    }});
    let (slide, sign) = between(["c", "b"]);
    let slide = json!({"cylindrical": {
        "between": slide, "at": corner(2), "axis": direction(0.8, -0.5, 0.3),
        "start": {"slide": {"displacement": 0.15 * sign * metre, "rate": -0.4 * sign * metre / second}}
    }});
    let (cross, _) = between(["d", "c"]);
    let order_of_cross = cross[0] == "d";
    let (first, second_axis) = (direction(0.0, 0.6, 0.8), direction(1.0, 0.0, 0.0));
    let axes = if order_of_cross {
        [first, second_axis]
    } else {
        [second_axis, first]
    };
    let hung = between(["hung", "b"]);
    let mut joints = vec![
        ("hinge".to_owned(), hinge),
        (
            "first ball".to_owned(),
            json!({"spherical": {"between": between(["b", "a"]).0, "at": corner(1)}}),
        ),
        ("slide".to_owned(), slide),
        (
            "cross".to_owned(),
            json!({"universal": {"between": cross, "at": corner(3), "axis": axes[0], "cross": axes[1]}}),
        ),
        (
            "last ball".to_owned(),
            json!({"spherical": {"between": between(["d", "ground"]).0, "at": corner(4)}}),
        ),
        (
            "hanger".to_owned(),
            json!({"revolute": {
                "between": hung.0, "at": corner(1), "axis": direction(1.0, 0.2, 0.1),
                "start": {"turn": {"rate": 0.9 * hung.1 / second}}
            }}),
        ),
    ];
    if writing.seed > 0 {
        shuffle(&mut order, &mut bodies);
        shuffle(&mut order, &mut joints);
    }
    json!({
        "version": 1, "name": "loop",
        "gravity": [0, 0, 0],
        "bodies": Value::Object(bodies.into_iter().collect()),
        "joints": Value::Object(joints.into_iter().collect()),
        "simulation": {"duration": 0.1, "steps": 10}
    })
}

/// In any units, orientation and order of bodies, joints and `between`, the start is the same and
/// has the given values.
#[test]
fn a_loop_of_five_freedoms_starts_the_same_however_it_is_written() {
    let pattern = problem(&five_freedoms(&PLAIN));
    let (exact, model) = started(&pattern, &[]);
    let given = [
        (DegreeOfFreedom::Rotation, "hinge", [0.5, 1.2]),
        (DegreeOfFreedom::Translation, "slide", [0.15, -0.4]),
        (DegreeOfFreedom::Rotation, "hanger", [0.0, 0.9]),
    ];
    for (dof, joint, values) in given {
        let found = measured(&model, joint, dof);
        for (found, value) in found.iter().zip(values) {
            assert!((found - value).abs() <= 1e-12, "{joint}: {found} {value}");
        }
    }
    let mut numbers = Numbers(23);
    let mut writings = Vec::new();
    for seed in 1..8 {
        writings.push(Writing { seed, ..PLAIN });
    }
    for _ in 0..5 {
        let (axis, angle) = (numbers.vector(), 3.0 * numbers.next());
        writings.push(Writing {
            axis,
            angle,
            ..PLAIN
        });
    }
    for units in [
        [1000.0, 1000.0, 1.0],
        [1e-3, 1.0, 1e3],
        [39.37, 2.2046, 60.0],
    ] {
        writings.push(Writing { units, ..PLAIN });
    }
    for (k, writing) in writings.iter().enumerate() {
        let other = problem(&five_freedoms(writing));
        let scene = other.unlowered_scene::<f64>(&[]);
        assert_eq!(scene.unstarted, None);
        let turn = matrix(&from_axis_angle(&writing.axis, writing.angle));
        let [metre, _, second] = writing.units;
        for body in &scene.model.bodies {
            let own = matrix(&body.orientation);
            let found = State {
                r: turn.tr_mul(&body.position) / metre,
                turn: turn.tr_mul(&own),
                v: turn.tr_mul(&body.velocity) * (second / metre),
                omega: turn.tr_mul(&(own * body.angular_velocity)) * second,
            };
            let off = found.off(&named(&exact, &body.name));
            assert!(off <= 1e-11, "writing {k}, {}: {off:e}", body.name);
        }
    }
}

/// Angle or displacement of a joint and its rate in the placement, from its frames.
fn measured(model: &Model<f64>, name: &str, dof: DegreeOfFreedom) -> [f64; 2] {
    let joint = model.joints.iter().find(|joint| joint.name == name);
    let joint = joint.expect("a joint of this name");
    let a = &model.bodies[joint.body_a];
    let turn_a = matrix(&a.orientation);
    let axes_a = joint.frame_a.axes.map(|e| turn_a * e);
    let omega_a = turn_a * a.angular_velocity;
    let arm_a = turn_a * joint.frame_a.point;
    let mut other = (
        joint.frame_b.point,
        joint.frame_b.axes,
        Vec3::zeros(),
        Vec3::zeros(),
    );
    if let Some(b) = joint.body_b.map(|b| &model.bodies[b]) {
        let turn = matrix(&b.orientation);
        let (arm, omega) = (turn * joint.frame_b.point, turn * b.angular_velocity);
        let point = b.position + arm;
        let axes = joint.frame_b.axes.map(|e| turn * e);
        // Velocity of the point of body B at the point of body A.
        let to_a = a.position + arm_a - b.position;
        other = (point, axes, b.velocity + omega.cross(&to_a), omega);
    }
    let (point, axes, velocity, omega) = other;
    match dof {
        DegreeOfFreedom::Rotation => [
            axes_a[0].dot(&axes[1]).atan2(axes_a[0].dot(&axes[0])),
            axes[2].dot(&(omega_a - omega)),
        ],
        DegreeOfFreedom::Translation => [
            axes[2].dot(&(a.position + arm_a - point)),
            axes[2].dot(&(a.velocity + omega_a.cross(&arm_a) - velocity)),
        ],
    }
}

/// Bricard's loop of six hinges, one of whose conditions is redundant, with a start of each hinge
/// in turn. The simulation's own assembly and projection, with a drive instead of the start, have
/// the same derivatives by the complex step to 1e-12.
#[test]
fn every_hinge_of_a_bricard_loop_can_start() {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/problems/benchmarks/bricard.json"
    );
    let text = std::fs::read_to_string(path).expect("a problem");
    let plain: Value = serde_json::from_str(&text).expect("valid JSON");
    for joint in 0..6 {
        for [angle, rate] in [[0.3, 1.0], [-0.2, 0.5], [0.05, -2.0]] {
            let name = format!("P{joint}");
            let mut file = plain.clone();
            let start = json!({"turn": {"angle": angle, "rate": rate}});
            file["joints"][&name]["revolute"]["start"] = start;
            let pointer = |key: &str| format!("/joints/{name}/revolute/start/turn/{key}");
            file["variables"] = json!({
                "angle": {"path": pointer("angle")}, "rate": {"path": pointer("rate")},
                "mass": {"path": "/bodies/rod 2/mass", "lower": 0.1}
            });
            let problem = problem(&file);
            let x = problem.start();
            let (_, model) = started(&problem, &x);
            let found = measured(&model, &name, DegreeOfFreedom::Rotation);
            assert!((found[0] - angle).abs() <= 1e-12 && (found[1] - rate).abs() <= 1e-12);
            for i in 0..x.len() {
                let step = |j: usize| Complex64::new(x[j], if i == j { COMPLEX_STEP } else { 0.0 });
                let design: Vec<Complex64> = (0..x.len()).map(step).collect();
                let scene = problem.unlowered_scene(&design).model;
                // From the same real start, without its infinitesimal part.
                let mut driven = scene.clone();
                for body in &mut driven.bodies {
                    body.position = body.position.map(|x| x.re.into());
                    body.orientation = body.orientation.map(|x| x.re.into());
                    body.velocity = body.velocity.map(|x| x.re.into());
                    body.angular_velocity = body.angular_velocity.map(|x| x.re.into());
                }
                driven.joints[joint].drives.push(Drive {
                    dof: DegreeOfFreedom::Rotation,
                    course: TimeFunction::Polynomial(vec![step(0), step(1)]),
                });
                let numbering = Numbering::new(&driven);
                let mut saddle = SaddlePoint::new(&driven, &numbering);
                let exact = initial::solve(&driven, &numbering, &mut saddle).expect("starts");
                let (q, v) = placement::guess(&scene);
                for (found, exact) in q.iter().chain(&v).zip(exact.q.iter().chain(&exact.v)) {
                    let (found, exact) = (found.im / COMPLEX_STEP, exact.im / COMPLEX_STEP);
                    let off = (found - exact).abs() / (1.0 + exact.abs());
                    assert!(off <= 1e-12, "{name}, {i}: {found} {exact}");
                }
            }
        }
    }
}

/// Starts that contradict the loop are rejected with the joint's name: an impossible angle, and
/// more starts than degrees of freedom. Designs that cannot start are failed simulations.
#[test]
fn what_a_loop_cannot_have_is_refused() {
    let refused = |file: &Value| match Problem::parse(&file.to_string(), "scene.json", &[]) {
        Ok(_) => panic!("is sound"),
        Err(faults) => faults.to_string(),
    };
    let start = json!({"turn": {"angle": 0.1}});
    let mut twice = four_bar(0.7, "motor", start.clone());
    twice["joints"]["knee"]["revolute"]["start"] = start.clone();
    let told = refused(&twice);
    assert!(
        told.contains("the start of joint \"knee\" cannot be chosen"),
        "{told}"
    );
    let mut rates = four_bar(0.7, "motor", json!({"turn": {"rate": 0.1}}));
    rates["joints"]["pivot"]["revolute"]["start"] = json!({"turn": {"rate": 3}});
    let told = refused(&rates);
    assert!(
        told.contains("the start of joint \"pivot\" cannot be chosen"),
        "{told}"
    );
    let mut driven = four_bar(0.7, "motor", json!({"turn": {"rate": 0.1}}));
    driven["drives"] = json!({"push": {"joint": "pivot", "turn": {"rate": 1}}});
    let told = refused(&driven);
    assert!(
        told.contains("the start of joint \"motor\" cannot be chosen"),
        "{told}"
    );
    // An angle and a rate of two joints use one degree of freedom each.
    let mut each = four_bar(0.7, "motor", json!({"turn": {"angle": 0.2}}));
    each["joints"]["pivot"]["revolute"]["start"] = json!({"turn": {"rate": 3}});
    let (found, model) = started(&problem(&each), &[]);
    assert!((angle(&named(&found, "crank")) - 0.9).abs() <= 1e-12);
    assert!((measured(&model, "pivot", DegreeOfFreedom::Rotation)[1] - 3.0).abs() <= 1e-12);

    // The rocker swings by less than half a turn.
    let mut far = four_bar(0.7, "pivot", json!({"turn": {"angle": 2.5}}));
    let told = refused(&far);
    assert!(
        told.contains("cannot be assembled") || told.contains("singular"),
        "{told}"
    );
    far["joints"]["pivot"]["revolute"]["start"]["turn"]["angle"] = json!(0.1);
    far["variables"] = json!({"angle": {"path": "/joints/pivot/revolute/start/turn/angle"}});
    let problem = problem(&far);
    assert!(simulate(&problem, &[0.1]).is_ok());
    let failure = simulate(&problem, &[2.5]).err().expect("fails");
    assert!(
        matches!(failure, IntegrationFailure::Assembly(_)),
        "{failure}"
    );
}
