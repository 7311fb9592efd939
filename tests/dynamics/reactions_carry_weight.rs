//! Reactions of bodies at rest agree with statics to 5e-11 N or N m (1e-12 of 50 N).

use crate::reference;

use flexbody_mathematics::math::Vec3;
use flexbody_mechanics::integrate::{Method, Multipliers, Settings, Start, simulate};
use flexbody_mechanics::model::{JointKind, Model, RigidBody};
use flexbody_mechanics::system::kkt::SaddlePoint;
use flexbody_mechanics::system::observe::{Reaction, reactions};
use flexbody_mechanics::system::{Numbering, initial};
use reference::models::{joint, rod};

fn gravity() -> Vec3<f64> {
    Vec3::new(0.0, -9.81, 0.0)
}

fn reactions_at_start(model: &Model<f64>) -> Vec<Reaction> {
    let numbering = Numbering::new(model);
    let mut saddle = SaddlePoint::new(model, &numbering);
    let start = initial::solve(model, &numbering, &mut saddle).expect("is consistent");
    reactions(model, &numbering, (&start.q, &start.lambda), 0.0)
}

fn assert_near(what: &str, found: &Vec3<f64>, expected: &Vec3<f64>) {
    let off = (found - expected).norm();
    assert!(off <= 5e-11, "{what}: {found} against {expected}");
}

/// A body of 1 m that hangs upright with its centre at the height `y`.
fn hanging(name: &str, mass: f64, y: f64) -> RigidBody<f64> {
    RigidBody {
        position: Vec3::new(0.0, y, 0.0),
        ..rod(name, mass, 0.0)
    }
}

/// Two bodies that hang on each other load their joints with the weight below them.
#[test]
fn a_joint_carries_the_weight_that_hangs_from_it() {
    for kind in [
        JointKind::Spherical,
        JointKind::Revolute,
        JointKind::Prismatic,
    ] {
        let bodies = vec![hanging("upper", 2.0, -0.5), hanging("lower", 3.0, -1.5)];
        let at = |y: f64| Vec3::new(0.0, y, 0.0);
        let joints = vec![
            joint(&bodies, ("ceiling", kind), (0, None), &at(0.0), &Vec3::z()),
            joint(
                &bodies,
                ("middle", kind),
                (0, Some(1)),
                &at(-1.0),
                &Vec3::z(),
            ),
        ];
        let model = Model {
            gravity: gravity(),
            bodies,
            joints,
            loads: Vec::new(),
            flexible: Vec::new(),
        };
        let found = reactions_at_start(&model);
        // The upper body is body A: the ceiling holds it, and the lower body pulls it down.
        let up = |force| Vec3::new(0.0, force, 0.0);
        assert_near("ceiling", &found[0].force_ground, &up(5.0 * 9.81));
        assert_near("middle", &found[1].force_ground, &up(-3.0 * 9.81));
        for reaction in &found {
            assert_near("torque", &reaction.torque_ground, &Vec3::zeros());
        }
    }
}

/// Two bodies that hang on each other stay at rest, to 1e-12 m, and their reactions stay the same.
#[test]
fn bodies_at_rest_stay_at_rest() {
    for kind in [
        JointKind::Spherical,
        JointKind::Revolute,
        JointKind::Prismatic,
    ] {
        let bodies = vec![hanging("upper", 2.0, -0.5), hanging("lower", 3.0, -1.5)];
        let at = |y: f64| Vec3::new(0.0, y, 0.0);
        let pin = |name, between, y| joint(&bodies, (name, kind), between, &at(y), &Vec3::z());
        let joints = [
            pin("ceiling", (0, None), 0.0),
            pin("middle", (0, Some(1)), -1.0),
        ];
        // The pair, and the upper body alone.
        for count in [2, 1] {
            let model = Model {
                gravity: gravity(),
                bodies: bodies[..count].to_vec(),
                joints: joints[..count].to_vec(),
                loads: Vec::new(),
                flexible: Vec::new(),
            };
            for method in [
                Method::Dop853,
                Method::Radau { stages: 3 },
                Method::Bdf {
                    order: 2,
                    start: Start::Radau,
                },
            ] {
                let run = simulate(&model, 1.0, &Settings::steps(method, 100)).expect("hangs");
                let moved = |k: usize| {
                    let off = run.q(k).iter().zip(run.q(0)).map(|(a, b)| (a - b).abs());
                    off.fold(0.0, f64::max)
                };
                let weight = at(9.81 * if count == 2 { 5.0 } else { 2.0 });
                let mut multipliers = Multipliers::new(&model, &run.numbering, &run);
                for k in 0..=run.last() {
                    let lambda = multipliers.at(k);
                    let found =
                        &reactions(&model, &run.numbering, (run.q(k), &lambda), run.time(k))[0];
                    assert_near("ceiling", &found.force_ground, &weight);
                    assert!(moved(k) <= 1e-12, "{kind:?}, {method:?}, step {k}");
                }
            }
        }
    }
}

/// A slide along x holds a drawer 0.5 m from its centre of mass. It carries the force m g and the
/// torque m g · 0.5 m about z. In the joint's axes they have the same lengths, and there is no
/// component along the slide. A puck on a horizontal plane is carried by m g.
#[test]
fn a_slide_and_a_plane_carry_weight_and_moment() {
    let bodies = vec![rod("drawer", 2.0, 0.5)];
    let slide = joint(
        &bodies,
        ("slide", JointKind::Prismatic),
        (0, None),
        &Vec3::zeros(),
        &Vec3::x(),
    );
    let model = Model {
        gravity: gravity(),
        bodies: bodies.clone(),
        joints: vec![slide],
        loads: Vec::new(),
        flexible: Vec::new(),
    };
    let found = reactions_at_start(&model)[0];
    let weight = 2.0 * 9.81;
    assert_near("force", &found.force_ground, &Vec3::new(0.0, weight, 0.0));
    assert_near(
        "torque",
        &found.torque_ground,
        &Vec3::new(0.0, 0.0, 0.5 * weight),
    );
    assert!((found.force.norm() - weight).abs() <= 1e-12 && found.force.z.abs() <= 1e-12);
    assert!((found.torque.norm() - 0.5 * weight).abs() <= 1e-12);
    let plane = joint(
        &bodies,
        ("table", JointKind::Planar),
        (0, None),
        &bodies[0].position,
        &Vec3::y(),
    );
    let model = Model {
        joints: vec![plane],
        ..model
    };
    let found = reactions_at_start(&model)[0];
    assert_near("force", &found.force_ground, &Vec3::new(0.0, weight, 0.0));
    assert_near("torque", &found.torque_ground, &Vec3::zeros());
}
