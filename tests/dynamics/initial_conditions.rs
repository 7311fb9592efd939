//! The start of a simulation is consistent: nearest assembly, projected velocities, and
//! accelerations that satisfy the equations of motion. A model without a start is reported by name.
//!
//! Residuals are round-off, 1e-12 in SI units for bodies of about 2 kg and 1 m. The nearest state
//! is checked by its definition, against other states that the joints allow.

use crate::reference;

use flexbody_mathematics::math::{Mat3, Vec3, rotation};
use flexbody_mechanics::integrate::IntegrationFailure;
use flexbody_mechanics::integrate::{Method, Settings, simulate};
use flexbody_mechanics::model::{JointFrame, JointKind, Model, RigidBody};
use flexbody_mechanics::system::InMotion;
use flexbody_mechanics::system::bodies::{BodyMotion, all_force_balances, mass_product};
use flexbody_mechanics::system::failure::AssemblyFailure;
use flexbody_mechanics::system::initial::{self, InitialState};
use flexbody_mechanics::system::kkt::SaddlePoint;
use flexbody_mechanics::system::placement;
use flexbody_mechanics::system::{Numbering, joints};
use reference::models::{KINDS, Numbers, free_pair, joint, rod};

fn solve(model: &Model<f64>) -> Result<InitialState<f64>, AssemblyFailure> {
    let numbering = Numbering::new(model);
    let mut saddle = SaddlePoint::new(model, &numbering);
    initial::solve(model, &numbering, &mut saddle)
}

/// The kinds of joint between two bodies. The guess leaves the joint open by about 0.2 m and 0.2
/// rad, and its velocities violate it.
fn displaced() -> Vec<(String, Model<f64>)> {
    let one = |(kind, seed): (JointKind, u64)| {
        let mut model = free_pair(kind, seed);
        let mut numbers = Numbers(seed + 100);
        model.gravity = numbers.vector() * 10.0;
        let body = &mut model.bodies[1];
        body.position += numbers.vector() * 0.2;
        body.orientation = turned(&body.orientation, &numbers.vector(), 0.2);
        (format!("{kind:?}, seed {seed}"), model)
    };
    let all = KINDS.into_iter().flat_map(|kind| [(kind, 1), (kind, 2)]);
    all.map(one).collect()
}

fn turned(p: &[f64; 4], axis: &Vec3<f64>, angle: f64) -> [f64; 4] {
    rotation::compose(&rotation::from_axis_angle(axis, angle), p)
}

fn largest(x: &[f64]) -> f64 {
    x.iter().fold(0.0, |m, x| m.max(x.abs()))
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter()
        .zip(b)
        .map(|(a, b)| (a - b).powi(2))
        .sum::<f64>()
        .sqrt()
}

/// Sets the model's guess to these positions.
fn placed(model: &Model<f64>, q: &[f64]) -> Model<f64> {
    let mut model = model.clone();
    for (body, q) in model.bodies.iter_mut().zip(q.chunks(7)) {
        body.position = Vec3::new(q[0], q[1], q[2]);
        body.orientation = [q[3], q[4], q[5], q[6]];
    }
    model
}

/// Σ ∫ |x − x'|² dm of all bodies between two positions, by definition.
fn displacement(model: &Model<f64>, a: &[f64], b: &[f64]) -> f64 {
    let one = |(body, (a, b)): (&RigidBody<f64>, (&[f64], &[f64]))| {
        let place = |q: &[f64]| {
            let p = [q[3], q[4], q[5], q[6]];
            let size = p.iter().map(|x| x * x).sum::<f64>().sqrt();
            (
                Vec3::new(q[0], q[1], q[2]),
                rotation::matrix(&p.map(|x| x / size)),
            )
        };
        let ((r_a, turn_a), (r_b, turn_b)) = (place(a), place(b));
        let moment = Mat3::identity() * (0.5 * body.inertia.trace()) - body.inertia;
        let turned = turn_a - turn_b;
        body.mass * (r_a - r_b).norm_squared() + (turned * moment * turned.transpose()).trace()
    };
    let pairs = a.chunks(7).zip(b.chunks(7));
    model.bodies.iter().zip(pairs).map(one).sum()
}

/// The joints are closed, and no assembled state nearby is nearer to the guess in the mean square
/// displacement of the mass: states from guesses up to 0.1 around the solution are farther.
#[test]
fn a_displaced_guess_is_assembled_to_the_nearest_state() {
    for (name, model) in displaced() {
        let numbering = Numbering::new(&model);
        let (q_guess, _) = placement::guess(&model);
        let q = solve(&model).expect("assembles").q;
        let closed = |q: &[f64]| {
            let mut phi = vec![0.0; numbering.constraints()];
            let mut motions = Vec::new();
            BodyMotion::all(&numbering, q, &[0.0; 12], &mut motions);
            joints::values(&InMotion::new(&model, &numbering, &motions, 0.0), &mut phi);
            largest(&phi)
        };
        assert!(closed(&q_guess) > 0.05, "{name}: the guess is open");
        assert!(closed(&q) <= 1e-12, "{name}: {:e}", closed(&q));
        let best = displacement(&model, &q, &q_guess);
        assert!(best < 1.0, "{name}: {best}");
        let mut numbers = Numbers(7);
        for size in [0.1, 0.01, 0.001] {
            for _ in 0..20 {
                let near: Vec<f64> = q.iter().map(|q| q + size * numbers.next()).collect();
                let other = solve(&placed(&model, &near)).expect("assembles").q;
                assert!(closed(&other) <= 1e-12, "{name}");
                assert!(
                    distance(&other, &q) > 0.1 * size,
                    "{name}: it is another state"
                );
                let own = displacement(&model, &other, &q_guess);
                assert!(own > best, "{name}: it is nearer");
            }
        }
    }
}

/// An assembled guess and velocities that the joints allow do not change.
#[test]
fn a_consistent_start_is_kept() {
    for (name, model) in displaced() {
        let first = solve(&model).expect("is consistent");
        let mut model = placed(&model, &first.q);
        for (body, v) in model.bodies.iter_mut().zip(first.v.chunks(6)) {
            body.velocity = Vec3::new(v[0], v[1], v[2]);
            body.angular_velocity = Vec3::new(v[3], v[4], v[5]);
        }
        let again = solve(&model).expect("is consistent");
        assert!(distance(&again.q, &first.q) <= 1e-13, "{name}");
        assert!(distance(&again.v, &first.v) <= 1e-13, "{name}");
        assert!(
            initial::velocity_correction(&model, &again) <= 1e-13,
            "{name}"
        );
    }
}

/// G v = 0, with v nearest to the guess: the impulse M (v − v_g) = −Gᵀσ does no work on any
/// velocity that the joints allow.
#[test]
fn velocities_are_projected() {
    for (name, model) in displaced() {
        let numbering = Numbering::new(&model);
        let start = solve(&model).expect("is consistent");
        let (_, v_guess) = placement::guess(&model);
        let rates = |v: &[f64]| {
            let mut rows = vec![0.0; numbering.constraints()];
            let mut motions = Vec::new();
            BodyMotion::all(&numbering, &start.q, v, &mut motions);
            joints::rates(&InMotion::new(&model, &numbering, &motions, 0.0), &mut rows);
            largest(&rows)
        };
        assert!(rates(&v_guess) > 0.1, "{name}");
        assert!(rates(&start.v) <= 1e-12, "{name}: {:e}", rates(&start.v));
        let change: Vec<f64> = start.v.iter().zip(&v_guess).map(|(v, g)| v - g).collect();
        let mut impulse = vec![0.0; change.len()];
        mass_product(&model, &numbering, &change, &mut impulse);
        let mut numbers = Numbers(11);
        for _ in 0..20 {
            let mut other = placed(&model, &start.q);
            for body in &mut other.bodies {
                (body.velocity, body.angular_velocity) = (numbers.vector(), numbers.vector());
            }
            let allowed = solve(&other).expect("is consistent").v;
            assert!(
                largest(&allowed) > 0.1 && rates(&allowed) <= 1e-12,
                "{name}"
            );
            let product: f64 = allowed.iter().zip(&impulse).map(|(a, b)| a * b).sum();
            assert!(product.abs() <= 1e-12, "{name}: {product:e}");
        }
    }
}

/// G a + bias = 0 and M a − f(v) + Gᵀλ = 0.
#[test]
fn accelerations_obey_constraints_and_equations_of_motion() {
    for (name, model) in displaced() {
        let numbering = Numbering::new(&model);
        let start = solve(&model).expect("is consistent");
        let (mut motions, mut gradients) = (Vec::new(), Vec::new());
        BodyMotion::all(&numbering, &start.q, &start.v, &mut motions);
        joints::gradients(
            &InMotion::new(&model, &numbering, &motions, 0.0),
            &mut gradients,
        );
        let rows = numbering.constraints();
        let (mut ga, mut bias) = (vec![0.0; rows], vec![0.0; rows]);
        joints::rates_from_gradients(&model, &numbering, &gradients, &start.a, &mut ga);
        joints::accelerations(&InMotion::new(&model, &numbering, &motions, 0.0), &mut bias);
        assert!(largest(&bias) > 0.1, "{name}");
        let sum: Vec<f64> = ga.iter().zip(&bias).map(|(a, b)| a + b).collect();
        let scale = largest(&ga).max(1.0);
        assert!(
            largest(&sum) <= 1e-12 * scale,
            "{name}: {:e}",
            largest(&sum)
        );
        let mut balance = vec![0.0; 12];
        all_force_balances(&model, &numbering, &motions, &start.a, &mut balance);
        let scale = largest(&balance).max(1.0);
        joints::add_reactions(&model, &numbering, &gradients, &start.lambda, &mut balance);
        assert!(
            largest(&balance) <= 1e-12 * scale,
            "{name}: {:e}",
            largest(&balance)
        );
    }
}

fn gravity() -> Vec3<f64> {
    Vec3::new(0.0, -9.81, 0.0)
}

/// Two rods of 1 m that form a roof, with the right wall at the given distance.
fn roof(span: f64) -> Model<f64> {
    let (up, down) = (1.0, -1.0);
    let turn = |angle| rotation::from_axis_angle(&Vec3::z(), angle);
    let top = rotation::matrix(&turn(up)) * Vec3::x();
    let foot = Vec3::new(2.0 * top.x, 0.0, 0.0);
    let placed = |name, angle, position| RigidBody {
        orientation: turn(angle),
        position,
        ..rod(name, 1.0, 0.0)
    };
    let bodies = vec![
        placed("left", up, top * 0.5),
        placed("right", down, (top + foot) * 0.5),
    ];
    let ball = |name, between, point| {
        let at = (name, JointKind::Spherical);
        joint(&bodies, at, between, &point, &Vec3::z())
    };
    let mut joints = vec![
        ball("left wall", (0, None), Vec3::zeros()),
        ball("middle", (0, Some(1)), top),
        ball("right wall", (1, None), foot),
    ];
    joints[2].frame_b.point = Vec3::new(span, 0.3, 0.1);
    Model {
        gravity: gravity(),
        bodies,
        joints,
        loads: Vec::new(),
        flexible: Vec::new(),
    }
}

/// Two rods of 1 m cannot span more than 2 m. The message names a joint, the open condition, and
/// the gap.
#[test]
fn an_impossible_assembly_names_the_joint() {
    assert!(solve(&roof(1.9)).is_ok());
    for span in [2.2, 2.5] {
        let model = roof(span);
        let failure = solve(&model).expect_err("cannot be assembled");
        let AssemblyFailure::Open { joint, gap, .. } = &failure else {
            panic!("{failure:?}");
        };
        let names = ["left wall", "middle", "right wall"];
        assert!(names.contains(&joint.as_str()));
        assert!(*gap > 0.1 * (span - 2.0) && *gap < span, "{gap}");
        let text = failure.to_string();
        let start = format!("joint \"{joint}\" cannot be assembled: its ");
        assert!(text.starts_with(&start), "{text}");
        let settings = Settings::steps(Method::Dop853, 10);
        let told = simulate(&model, 1.0, &settings).expect_err("cannot be simulated");
        assert_eq!(told, IntegrationFailure::Assembly(failure));
    }
}

/// A door on two hinges has five redundant constraints. A third joint elsewhere is not named.
#[test]
fn redundant_constraints_are_named() {
    let bodies = vec![rod("door", 1.0, 0.5), rod("flap", 1.0, 1.5)];
    let hinge = |name, between, point| {
        let at = (name, JointKind::Revolute);
        joint(&bodies, at, between, &point, &Vec3::y())
    };
    let model = Model {
        gravity: gravity(),
        joints: vec![
            hinge("upper hinge", (0, None), Vec3::new(0.0, 0.5, 0.0)),
            hinge("flap hinge", (1, Some(0)), Vec3::new(1.0, 0.0, 0.0)),
            hinge("lower hinge", (0, None), Vec3::new(0.0, -0.5, 0.0)),
        ],
        bodies: bodies.clone(),
        loads: Vec::new(),
        flexible: Vec::new(),
    };
    let failure = solve(&model).expect_err("is redundant");
    assert_eq!(
        failure.to_string(),
        "5 of 15 constraints are redundant; joints that repeat each other: upper hinge, lower hinge"
    );
}

/// A hinge whose guess is rotated away from its axis: up to a right angle the correct solution is
/// found. Beyond it, the solution with opposite axes is nearer, and is rejected by name.
#[test]
fn a_frame_turned_by_half_a_turn_is_refused() {
    for kind in KINDS {
        if kind.common_axes().is_empty() {
            continue;
        }
        for degrees in [0.0_f64, 20.0, 60.0, 120.0, 160.0, 179.0, 180.0] {
            let mut bodies = vec![rod("arm", 1.0, 0.5)];
            let point = Vec3::zeros();
            let hinge = joint(&bodies, ("hinge", kind), (0, None), &point, &Vec3::z());
            bodies[0].orientation = turned(
                &bodies[0].orientation,
                &Vec3::new(1.0, 0.2, 0.0),
                degrees.to_radians(),
            );
            let model = Model {
                gravity: gravity(),
                bodies,
                joints: vec![hinge],
                loads: Vec::new(),
                flexible: Vec::new(),
            };
            let outcome = solve(&model);
            if degrees < 90.0 {
                let q = outcome
                    .unwrap_or_else(|e| panic!("{kind:?} {degrees}: {e}"))
                    .q;
                let r = rotation::matrix(&[q[3], q[4], q[5], q[6]]);
                let axis: &JointFrame<f64> = &model.joints[0].frame_a;
                let found = (r * axis.axes[2] - Vec3::z()).norm();
                assert!(found <= 1e-12, "{kind:?} {degrees}: {found:e}");
            } else {
                let failure = outcome.expect_err("is turned");
                assert_eq!(
                    failure.to_string(),
                    "joint \"hinge\" was assembled with its axes turned by 180 degrees",
                    "{kind:?} {degrees}"
                );
            }
        }
    }
}

/// A rod on a ball joint starts with any thickness and rotation. From rest it falls with the
/// angular acceleration r × m g / (m L²/3) across its axis, and zero about its axis.
#[test]
fn thin_rods_start() {
    for (radius, seed) in [
        (1e-2, 1),
        (1e-5, 2),
        (1e-7, 3),
        (1e-9, 4),
        (1e-12, 5),
        (1e-15, 6),
    ] {
        let mut numbers = Numbers(seed);
        let (length, mass) = (1.0 + 0.5 * numbers.next(), 2.0 + numbers.next());
        let about = 0.5 * mass * radius * radius;
        let across = mass * length * length / 12.0 + 0.5 * about;
        let mut body = numbers.body("rod");
        body.mass = mass;
        body.inertia = Mat3::from_diagonal(&Vec3::new(about, across, across));
        (body.velocity, body.angular_velocity) = (Vec3::zeros(), Vec3::zeros());
        let turned = rotation::matrix(&body.orientation);
        let near = Vec3::new(-0.5 * length, 0.0, 0.0);
        let mut model = free_pair(JointKind::Spherical, seed);
        let pivot = body.position + turned * near;
        model.bodies = vec![body];
        model.loads.clear();
        model.gravity = numbers.vector() * 10.0;
        let own = &mut model.joints[0];
        (own.body_a, own.body_b) = (0, None);
        own.frame_a.point = near;
        own.frame_b.point = pivot;
        let start = solve(&model).unwrap_or_else(|failure| panic!("{radius:e}: {failure}"));
        let torque = (-near).cross(&(turned.transpose() * model.gravity * mass));
        let end_to_end = across + mass * near.norm_squared();
        let exact = torque / end_to_end;
        let found = Vec3::new(start.a[3], start.a[4], start.a[5]);
        let off = (found - exact).norm();
        assert!(off < 1e-12 * exact.norm(), "{radius:e}: {found} {exact}");
    }
}
