//! Starts of joints without loops: the states of all bodies follow in closed form from the angles,
//! displacements and rates of the joints.
//!
//! Bodies have about 1 m, 1 kg and 1 rad/s. Differences are round-off, 1e-12.

use crate::reference::documents::problem;
use crate::reference::models::Numbers;
use flexbody_driver::{check, simulate, start::notes};
use flexbody_mathematics::math::rotation::{from_axis_angle, matrix};
use flexbody_mathematics::math::{Mat3, Vec3};
use flexbody_mechanics::model::{Model, RigidBody};
use flexbody_mechanics::system::InMotion;
use flexbody_mechanics::system::initial;
use flexbody_mechanics::system::kkt::SaddlePoint;
use flexbody_mechanics::system::{BodyMotion, Numbering, joints};
use flexbody_problem::Problem;
use serde_json::Value;

/// Position and velocity of a body, ground axes.
#[derive(Clone, Copy, Debug)]
pub(super) struct State {
    pub r: Vec3<f64>,
    pub turn: Mat3<f64>,
    pub v: Vec3<f64>,
    pub omega: Vec3<f64>,
}

impl State {
    /// Velocity of a point that moves with the body.
    pub fn at(&self, point: &Vec3<f64>) -> Vec3<f64> {
        self.v + self.omega.cross(&(point - self.r))
    }

    /// Largest difference from another state.
    pub fn off(&self, other: &Self) -> f64 {
        let places = (self.r - other.r)
            .amax()
            .max((self.turn - other.turn).amax());
        let rates = (self.v - other.v)
            .amax()
            .max((self.omega - other.omega).amax());
        places.max(rates)
    }
}

/// The bodies at the start of the simulation by name, and the model. Joints are closed, and the
/// velocities satisfy them to 1e-12.
pub(super) fn started(problem: &Problem, x: &[f64]) -> (Vec<(String, State)>, Model<f64>) {
    let scene = problem.unlowered_scene(x);
    assert_eq!(scene.unstarted, None);
    let model = scene.model;
    let numbering = Numbering::new(&model);
    let mut saddle = SaddlePoint::new(&model, &numbering);
    let start = initial::solve(&model, &numbering, &mut saddle).expect("starts");
    let mut motions = Vec::new();
    BodyMotion::all(&numbering, &start.q, &start.v, &mut motions);
    let mut rows = vec![0.0; numbering.constraints()];
    let largest = |rows: &[f64]| rows.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    let at = InMotion::new(&model, &numbering, &motions, 0.0);
    joints::values(&at, &mut rows);
    assert!(largest(&rows) <= 1e-12, "{:e}", largest(&rows));
    joints::rates(&at, &mut rows);
    assert!(largest(&rows) <= 1e-12, "{:e}", largest(&rows));
    let state = |(body, motion): (&RigidBody<f64>, &BodyMotion<f64>)| {
        let state = State {
            r: motion.position,
            turn: motion.rotation,
            v: motion.velocity,
            omega: motion.rotation * motion.omega,
        };
        (body.name.clone(), state)
    };
    let all = model.bodies.iter().zip(&motions).map(state).collect();
    (all, model)
}

pub(super) fn named(all: &[(String, State)], name: &str) -> State {
    let found = all.iter().find(|(own, _)| own == name);
    found.unwrap_or_else(|| panic!("{name}")).1
}

pub(super) fn list(v: &Vec3<f64>) -> [f64; 3] {
    [v.x, v.y, v.z]
}

/// A body of full inertia in a file.
fn body(numbers: &mut Numbers, at: &Vec3<f64>, axis: &Vec3<f64>, angle: f64) -> Value {
    let [xx, yy, zz] = [numbers.next(), numbers.next(), numbers.next()].map(|x| 0.2 + 0.05 * x);
    json!({
        "mass": 1.0 + 0.3 * numbers.next(),
        "inertia": {"xx": xx, "yy": yy, "zz": zz, "xy": 0.01, "xz": -0.02, "yz": 0.005},
        "centre_of_mass": list(&(numbers.vector() * 0.3)),
        "place": {"at": list(at), "turn": {"axis": list(axis), "angle": angle}}
    })
}

/// One link of a chain: its joint in the file, and its motion.
struct Link {
    kind: &'static str,
    point: Vec3<f64>,
    axis: Vec3<f64>,
    /// Angle, displacement and their rates.
    motion: [f64; 4],
}

const KINDS: [&str; 4] = ["revolute", "prismatic", "cylindrical", "planar"];

impl Link {
    fn any(numbers: &mut Numbers) -> Self {
        let kind = KINDS[((numbers.next() + 1.0) * 2.0) as usize];
        let mut motion = [0.0; 4].map(|_| numbers.next());
        motion[0] *= 3.0;
        let (turns, slides) = (
            kind != "prismatic",
            ["prismatic", "cylindrical"].contains(&kind),
        );
        for (k, value) in motion.iter_mut().enumerate() {
            if (k % 2 == 0 && !turns) || (k % 2 == 1 && !slides) {
                *value = 0.0;
            }
        }
        Self {
            kind,
            point: numbers.vector(),
            axis: numbers.vector(),
            motion,
        }
    }

    /// The joint in a file with its bodies in this order. `sign` is −1 if the link's own body is
    /// not the first.
    fn written(&self, between: [&str; 2], sign: f64) -> Value {
        let [angle, shift, spin, speed] = self.motion.map(|x| x * sign);
        let mut start = json!({});
        if self.kind != "prismatic" {
            start["turn"] = json!({"angle": angle, "rate": spin});
        }
        if ["prismatic", "cylindrical"].contains(&self.kind) {
            start["slide"] = json!({"displacement": shift, "rate": speed});
        }
        json!({(self.kind): {"between": between, "at": list(&self.point), "axis": list(&self.axis),
                           "start": start}})
    }
}

/// Shuffles a list (Fisher & Yates).
pub(super) fn shuffle<T>(numbers: &mut Numbers, list: &mut [T]) {
    for i in (1..list.len()).rev() {
        let j = ((numbers.next() + 1.0) / 2.0 * (i + 1) as f64) as usize;
        list.swap(i, j.min(i));
    }
}

/// Trees of five bodies, on ground or on earlier bodies, with all kinds of joint that rotate or
/// slide, and every order of bodies, joints and `between`, have the states of the recursion R =
/// R(e, φ) R_0, ω = ω_near + e φ̇, ….
#[test]
fn trees_start_as_their_recursion_says() {
    for seed in 0..40 {
        let mut numbers = Numbers(seed);
        let count = 5;
        let names: Vec<String> = (0..count).map(|i| format!("body {i}")).collect();
        let links: Vec<Link> = (0..count).map(|_| Link::any(&mut numbers)).collect();
        let hung: Vec<Option<usize>> = (0..count)
            .map(|i| {
                let at = ((numbers.next() + 1.0) / 2.0 * (i + 1) as f64) as usize;
                at.checked_sub(1)
            })
            .collect();
        let bodies: Vec<(String, Value)> = (names.iter())
            .map(|name| {
                let (at, axis) = (numbers.vector(), numbers.vector());
                let angle = 3.0 * numbers.next();
                (name.clone(), body(&mut numbers, &at, &axis, angle))
            })
            .collect();
        let written: Vec<(String, Value)> = (0..count)
            .map(|i| {
                let own = names[i].as_str();
                let near = hung[i].map_or("ground", |j| names[j].as_str());
                let swapped = numbers.next() < 0.0;
                let between = if swapped { [near, own] } else { [own, near] };
                // Ground counts as the second body in any order.
                let sign = if swapped && hung[i].is_some() {
                    -1.0
                } else {
                    1.0
                };
                (format!("joint {i}"), links[i].written(between, sign))
            })
            .collect();
        let order = |numbers: &mut Numbers, list: &[(String, Value)]| {
            let mut list = list.to_vec();
            shuffle(numbers, &mut list);
            Value::Object(list.into_iter().collect())
        };
        let file = json!({
            "version": 1, "name": "tree", "simulation": {"duration": 1},
            "bodies": order(&mut numbers, &bodies), "joints": order(&mut numbers, &written),
        });
        let problem = problem(&file);
        let (found, _) = started(&problem, &[]);
        let mut still = file.clone();
        for joint in still["joints"]
            .as_object_mut()
            .expect("joints")
            .values_mut()
        {
            for joint in joint.as_object_mut().expect("a joint").values_mut() {
                joint.as_object_mut().expect("keys").remove("start");
            }
        }
        let (placed, _) = started(&self::problem(&still), &[]);
        // Displacement x ↦ R x + t of each body, and its velocity field.
        let mut states: Vec<State> = Vec::new();
        let mut moves: Vec<(Mat3<f64>, Vec3<f64>)> = Vec::new();
        for i in 0..count {
            let (near, field) = match hung[i] {
                None => ((Mat3::identity(), Vec3::zeros()), None),
                Some(j) => (moves[j], Some(states[j])),
            };
            let Link {
                point,
                axis,
                motion: [angle, shift, spin, speed],
                ..
            } = &links[i];
            let e = axis.normalize();
            let turn = matrix(&from_axis_angle(&e, *angle));
            let own = (turn, point - turn * point + e * *shift);
            let moved = (near.0 * own.0, near.0 * own.1 + near.1);
            let place = named(&placed, &names[i]);
            let r = moved.0 * place.r + moved.1;
            let e = near.0 * e;
            let p = moved.0 * point + moved.1;
            let rest = State {
                r: Vec3::zeros(),
                turn: Mat3::identity(),
                v: Vec3::zeros(),
                omega: Vec3::zeros(),
            };
            let field = field.unwrap_or(rest);
            states.push(State {
                r,
                turn: moved.0 * place.turn,
                v: field.at(&r) + (e * *spin).cross(&(r - p)) + e * *speed,
                omega: field.omega + e * *spin,
            });
            moves.push(moved);
            let off = named(&found, &names[i]).off(&states[i]);
            assert!(off <= 2e-12, "seed {seed}, body {i}: {off:e}");
        }
        // There are no notes on a start that the file requests.
        assert_eq!(notes(&problem, &[]), [""; 0], "seed {seed}");
    }
}

/// Two bars of 1 m that hang straight down. The arguments extend the joints and the lower bar.
pub(super) fn double_pendulum(first: Value, second: Value, lower: Value) -> Value {
    let joint = |between: [&str; 2], y: f64, start: Value| {
        let mut joint = json!({"between": between, "at": [0, y, 0], "axis": [0, 0, 1]});
        if !start.is_null() {
            joint["start"] = start;
        }
        json!({"revolute": joint})
    };
    let bar = |y: f64| json!({"shape": {"box": {"size": [0.1, 1, 0.1]}}, "mass": 2, "place": {"at": [0, y, 0]}});
    let mut bodies = json!({"upper": bar(-0.5), "lower": bar(-1.5)});
    if !lower.is_null() {
        bodies["lower"]["velocity"] = lower;
    }
    json!({
        "version": 1, "name": "double pendulum", "bodies": bodies,
        "joints": {"hip": joint(["upper", "ground"], 0.0, first),
                   "knee": joint(["lower", "upper"], -1.0, second)},
        "simulation": {"duration": 0.5, "tolerance": 1e-11},
        "functions": {
            "kinetic": {"final": {"energy": "kinetic"}},
            "knee angle": {"final": {"angle": {"joint": "knee"}}},
            "foot": {"final": {"position": {"body": "lower", "point": [0, -0.5, 0],
                                            "direction": [1, 0, 0]}}}
        }
    })
}

/// The kinetic energy of a hinged bar is ½ (m l²/3) φ̇², that of a double pendulum follows from its
/// two angles. A joint without start stays as placed and keeps the rate of the file.
#[test]
fn a_double_pendulum_starts_as_its_angles_say() {
    let mut numbers = Numbers(3);
    for _ in 0..20 {
        let [a, b] = [numbers.next() * 3.0, numbers.next() * 3.0];
        let [p, q, r] = [numbers.next(), numbers.next(), numbers.next()];
        let first = json!({"turn": {"angle": a, "rate": p}});
        let lower = json!({"angular": [0, 0, r], "linear": [0.5 * r, 0, 0]});
        for (second, lower, b, q) in [
            (Value::Null, Value::Null, 0.0, 0.0),
            (json!({"turn": {"rate": q}}), Value::Null, 0.0, q),
            (json!({"turn": {"angle": b}}), Value::Null, b, 0.0),
            (json!({"turn": {"angle": b, "rate": q}}), Value::Null, b, q),
            // The file's velocities give the knee the rate r. A note reports that the lower bar is
            // moved.
            (Value::Null, lower.clone(), 0.0, r),
            (json!({"turn": {"rate": q}}), lower, 0.0, q),
        ] {
            let replaced = !lower.is_null();
            // The file's velocities are those of the hanging bodies.
            let (a, first) = match replaced {
                true => (0.0, json!({"turn": {"rate": p}})),
                false => (a, first.clone()),
            };
            let problem = problem(&double_pendulum(first, second, lower));
            let (found, model) = started(&problem, &[]);
            let along = |angle: f64| Vec3::new(angle.sin(), -angle.cos(), 0.0);
            let across = |angle: f64| Vec3::new(angle.cos(), angle.sin(), 0.0);
            let (upper, lower) = (named(&found, "upper"), named(&found, "lower"));
            assert!((upper.r - along(a) * 0.5).amax() <= 1e-13);
            assert!((lower.r - along(a) - along(a + b) * 0.5).amax() <= 1e-13);
            let v = across(a) * p + across(a + b) * (0.5 * (p + q));
            assert!((lower.v - v).amax() <= 1e-13, "{} {v}", lower.v);
            let j = 2.0 * (1.0 + 0.01) / 12.0;
            let of_upper = 0.5 * (j + 2.0 / 4.0) * p * p;
            let exact = of_upper + v.norm_squared() + 0.5 * j * (p + q).powi(2);
            let kinetic: f64 = (model.bodies.iter())
                .map(|body| {
                    let omega = &body.angular_velocity;
                    let spin = omega.dot(&(body.inertia * omega));
                    0.5 * (body.mass * body.velocity.norm_squared() + spin)
                })
                .sum();
            assert!((kinetic - exact).abs() <= 1e-13, "{kinetic} {exact}");
            let told = notes(&problem, &[]);
            assert_eq!(told.len(), usize::from(replaced), "{told:?}");
            let of_lower = "the starts of joints replace the given velocity of body \"lower\": ";
            assert!(
                told.iter().all(|note| note.starts_with(of_lower)),
                "{told:?}"
            );
        }
    }
}

/// The angle of a joint counts from the placement. At the start it has the given value.
#[test]
fn angles_are_those_that_are_given() {
    for [a, b] in [[0.3, -0.7], [-2.0, 3.0], [0.0, 1e-9]] {
        let [first, second] = [a, b].map(|angle| json!({"turn": {"angle": angle}}));
        let mut file = double_pendulum(first, second, Value::Null);
        file["simulation"] = json!({"duration": 1e-9, "steps": 1});
        let problem = problem(&file);
        let motion = simulate(&problem, &[]).expect("runs");
        assert!((motion.at.function(1).value - b).abs() <= 1e-14, "{a} {b}");
    }
}

/// Free bodies keep the velocity of their first body. Joints in loops that are open in the
/// placement are closed, with the given angle.
#[test]
fn bodies_in_flight_and_open_joints_start_as_they_are_given() {
    let mut file = double_pendulum(
        Value::Null,
        json!({"turn": {"rate": 2, "angle": 0.5}}),
        Value::Null,
    );
    let flight = json!({"linear": [1, 2, 3], "angular": [0.1, 0.2, 0.3]});
    file["joints"]
        .as_object_mut()
        .expect("joints")
        .remove("hip");
    file["initial_velocity"] = flight;
    let flying = problem(&file);
    let (found, _) = started(&flying, &[]);
    let (upper, lower) = (named(&found, "upper"), named(&found, "lower"));
    let omega = Vec3::new(0.1, 0.2, 0.3);
    let field = |r: &Vec3<f64>| Vec3::new(1.0, 2.0, 3.0) + omega.cross(r);
    assert!((upper.r - Vec3::new(0.0, -0.5, 0.0)).amax() <= 1e-15);
    assert!((upper.v - field(&upper.r)).amax() <= 1e-14);
    let arm = Vec3::new(0.5_f64.sin(), -0.5_f64.cos(), 0.0) * 0.5;
    assert!((lower.r - Vec3::new(0.0, -1.0, 0.0) - arm).amax() <= 1e-14);
    let relative = Vec3::new(0.0, 0.0, 2.0);
    assert!((lower.omega - omega - relative).amax() <= 1e-14);
    assert!((lower.v - field(&lower.r) - relative.cross(&arm)).amax() <= 1e-14);
    assert_eq!(notes(&flying, &[]), [""; 0]);

    // The knee is 0.2 m open. The bodies meet, and thigh and knee have the given values.
    let mut open = double_pendulum(
        json!({"turn": {"angle": 0.4, "rate": -1.5}}),
        json!({"turn": {"angle": -0.3, "rate": 0.7}}),
        Value::Null,
    );
    open["bodies"]["lower"]["place"]["at"] = json!([0.1, -1.7, 0]);
    open["joints"]["knee"]["revolute"]["at"] = json!({"a": [0, 0.5, 0], "b": [0, -0.5, 0]});
    let (found, _) = started(&problem(&open), &[]);
    let (upper, lower) = (named(&found, "upper"), named(&found, "lower"));
    let angle = |state: &State| state.turn[(1, 0)].atan2(state.turn[(0, 0)]);
    assert!((angle(&upper) - 0.4).abs() <= 1e-13 && (angle(&lower) - 0.1).abs() <= 1e-13);
    assert!((upper.omega.z + 1.5).abs() <= 1e-13 && (lower.omega.z + 0.8).abs() <= 1e-13);

    // Without angles the open joint is closed as without starts, and a note reports it.
    let mut rates = open.clone();
    for joint in ["hip", "knee"] {
        let turn = &mut rates["joints"][joint]["revolute"]["start"]["turn"];
        turn.as_object_mut().expect("a turn").remove("angle");
    }
    let mut plain = rates.clone();
    for joint in ["hip", "knee"] {
        let keys = plain["joints"][joint]["revolute"].as_object_mut();
        keys.expect("a joint").remove("start");
    }
    let (rates, plain) = (problem(&rates), problem(&plain));
    let (with, without) = (started(&rates, &[]).0, started(&plain, &[]).0);
    for ((_, with), (_, without)) in with.iter().zip(&without) {
        assert!((with.r - without.r).amax() <= 1e-12 && (with.turn - without.turn).amax() <= 1e-12);
    }
    assert!((named(&with, "upper").omega.z + 1.5).abs() <= 1e-12);
    assert!((named(&with, "lower").omega.z + 0.8).abs() <= 1e-12);
    assert_eq!(notes(&rates, &[]).len(), 2);
    assert_eq!(notes(&rates, &[]), notes(&plain, &[]));
}

/// Gradients in angles, rates and geometry agree with the complex step to 1e-12. The energy of the
/// start has its closed form.
#[test]
fn gradients_by_starts_match_the_complex_step() {
    for method in [json!("dop853"), json!({"radau": {"stages": 3}})] {
        let mut file = double_pendulum(
            json!({"turn": {"angle": 0.4, "rate": 1.5}}),
            json!({"turn": {"angle": -0.3, "rate": -0.7}}),
            Value::Null,
        );
        file["simulation"] = json!({"duration": 0.5, "steps": 200, "method": method});
        file["variables"] = json!({
            "hip": {"path": "/joints/hip/revolute/start/turn/angle"},
            "hip rate": {"path": "/joints/hip/revolute/start/turn/rate"},
            "knee": {"path": "/joints/knee/revolute/start/turn/angle"},
            "knee rate": {"path": "/joints/knee/revolute/start/turn/rate"},
            "knee x": {"path": "/joints/knee/revolute/at/0"},
            "knee y": {"path": "/joints/knee/revolute/at/1"},
            "hip y": {"path": "/joints/hip/revolute/at/1"},
            "tilt": {"path": "/joints/hip/revolute/axis/0"},
            "place": {"path": "/bodies/lower/place/at/0"}
        });
        let problem = problem(&file);
        assert_eq!(problem.variables[1].unit, "rad/s");
        for derivative in check(&problem, &problem.start()).expect("runs") {
            let small = derivative.adjoint.abs().max(derivative.complex_step.abs()) <= 1e-12;
            let off = derivative.relative_difference();
            assert!(small || off <= 1e-12, "{derivative:?}: {off:e}");
        }
    }
}
