//! Reactions balance the loads; bodies have their known inertia.

use super::sample::{ALUMINIUM, Numbers};
use flexbody_mathematics::math::Vec3;
use flexbody_mechanics::structures::beam::Section;
use flexbody_mechanics::structures::functions::{Function, Solved};
use flexbody_mechanics::structures::generate::{curved_panel, cylinder, plate, straight_beam};
use flexbody_mechanics::structures::loads::Load;
use flexbody_mechanics::structures::lumped_mass::LumpedMass;
use flexbody_mechanics::structures::shell::Terms;
use flexbody_mechanics::structures::statics::StaticProblem;
use flexbody_mechanics::structures::structure::Structure;
use flexbody_mechanics::structures::supports::{NodeUnknowns, Support};
use flexbody_mechanics::structures::von_karman::LoadSteps;

/// The total forces and moments of all supports are the opposite of those of the loads: in linear
/// statics about any point. With von Karman's strains only the forces are: moments of loads refer
/// to the undeformed structure.
#[test]
fn reactions_balance_the_loads() {
    for (seed, unknowns, von_karman) in [
        (1, NodeUnknowns::Natural, false),
        (2, NodeUnknowns::Six, false),
        (3, NodeUnknowns::Natural, true),
    ] {
        let mut numbers = Numbers::new(seed);
        let mut generated = curved_panel(1.0, 1.5, [0.2, 1.3], [4, 3]);
        for node in &mut generated.nodes {
            *node += numbers.vector(0.01);
        }
        let corner = generated.nodes[generated.mesh.node_sets["x1y1"][0]];
        let structure =
            Structure::uniform(generated.mesh, generated.nodes, 0.05, ALUMINIUM).expect("sound");
        let (weight, force) = (numbers.vector(100.0), numbers.vector(1e4));
        let cases = [vec![
            Load::Gravity {
                acceleration: weight,
            },
            Load::Point {
                nodes: "x1y1".into(),
                force,
                moment: Vec3::zeros(),
            },
        ]];
        let supports = [
            Support::clamp("x0"),
            Support::of("x1y0", [true, false, true], [false; 3]),
        ];
        let mut problem = StaticProblem::new(&structure, &supports, unknowns).expect("sets");
        problem.factorise(&structure).expect("supported");
        let x = if von_karman {
            let steps = LoadSteps::default();
            problem
                .solve_von_karman(&structure, &cases[0], &steps)
                .expect("an equilibrium")
                .x
        } else {
            problem.solve_linear(&structure, &cases[0]).expect("sets")
        };
        let solved = Solved {
            problem: &problem,
            structure: &structure,
            cases: &cases,
            solutions: &[x],
            terms: if von_karman {
                Terms::VON_KARMAN
            } else {
                Terms::LINEAR
            },
        };
        let value = |function: Function| solved.value(&function).expect("sets");
        let mass = value(Function::Mass);
        let centre = Vec3::from_fn(|k, _| value(Function::Centre(Vec3::ith(k, 1.0))));
        let about = numbers.vector(1.0);
        let load = weight * mass + force;
        let moment = (centre - about).cross(&weight) * mass + (corner - about).cross(&force);
        for k in 0..3 {
            let axis = Vec3::ith(k, 1.0);
            let nodes = || "all".to_owned();
            let reaction = value(Function::Reaction {
                case: 0,
                nodes: nodes(),
                direction: axis,
            });
            assert!(
                (reaction + load[k]).abs() < 1e-8 * load.norm(),
                "{reaction} {load}"
            );
            let parts: f64 = ["x0", "x1y0"]
                .map(|set| {
                    value(Function::Reaction {
                        case: 0,
                        nodes: set.into(),
                        direction: axis,
                    })
                })
                .iter()
                .sum();
            assert!(
                (parts + load[k]).abs() < 1e-8 * load.norm(),
                "free nodes have none"
            );
            let reaction = value(Function::ReactionMoment {
                case: 0,
                nodes: nodes(),
                axis,
                about,
            });
            if !von_karman {
                assert!(
                    (reaction + moment[k]).abs() < 1e-8 * moment.norm(),
                    "{reaction} {moment}"
                );
            }
        }
    }
}

fn values(structure: &Structure<f64>) -> (f64, Vec3<f64>, [[f64; 3]; 3]) {
    let problem = StaticProblem::new(structure, &[], NodeUnknowns::Natural).expect("sets");
    let solved = Solved {
        problem: &problem,
        structure,
        cases: &[],
        solutions: &[],
        terms: Terms::LINEAR,
    };
    let value = |function: Function| solved.value(&function).expect("sets");
    let e = |k: usize| Vec3::ith(k, 1.0);
    let inertia = |i, j| value(Function::Inertia(e(i), e(j)));
    (
        value(Function::Mass),
        Vec3::from_fn(|k, _| value(Function::Centre(e(k)))),
        [0, 1, 2].map(|i| [0, 1, 2].map(|j| inertia(i, j))),
    )
}

#[test]
fn known_bodies_have_their_inertia() {
    let (a, b, h) = (1.2, 0.7, 0.01);
    let generated = plate([a, b], [3, 2]);
    let plate_ = Structure::uniform(generated.mesh, generated.nodes, h, ALUMINIUM).expect("sound");
    let (mass, centre, j) = values(&plate_);
    assert!((mass - ALUMINIUM.density * a * b * h).abs() < 1e-12 * mass);
    assert!((centre - Vec3::new(a / 2.0, b / 2.0, 0.0)).norm() < 1e-13);
    let expected = [b * b, a * a, a * a + b * b].map(|x| mass * x / 12.0);
    for i in 0..3 {
        for k in 0..3 {
            let expected = if i == k { expected[i] } else { 0.0 };
            assert!((j[i][k] - expected).abs() < 1e-12 * mass, "{i} {k}");
        }
    }
    // A cylinder of 24 elements around: radius r, m r² about its axis, m (r²/2 + l²/12) across.
    let (r, l) = (0.4, 0.9);
    let generated = cylinder(r, l, [24, 2]);
    let tube = Structure::uniform(generated.mesh, generated.nodes, h, ALUMINIUM).expect("sound");
    let (mass, centre, j) = values(&tube);
    assert!((centre - Vec3::new(0.0, 0.0, l / 2.0)).norm() < 1e-12);
    assert!((j[2][2] / (mass * r * r) - 1.0).abs() < 1e-5);
    assert!((j[0][0] / (mass * (r * r / 2.0 + l * l / 12.0)) - 1.0).abs() < 1e-5);
    // Two lumped masses on a massless beam, one with its own inertia.
    let generated = straight_beam([Vec3::zeros(), Vec3::x() * 2.0], Vec3::y(), 1);
    let section = Section::Rectangle {
        width: 0.1,
        height: 0.1,
    };
    let mut material = ALUMINIUM;
    material.density = 0.0;
    let mut rod = Structure::with_beams(
        generated.mesh,
        generated.nodes,
        0.0,
        section,
        generated.orientations,
        material,
    )
    .expect("sound");
    rod.add_mass(0, LumpedMass::point(3.0));
    let inertia = [0.5, 0.6, 0.7, 0.1, 0.2, 0.3];
    rod.add_mass(2, LumpedMass { mass: 1.0, inertia });
    let (mass, centre, j) = values(&rod);
    assert_eq!(mass, 4.0);
    assert!((centre - Vec3::new(0.5, 0.0, 0.0)).norm() < 1e-14);
    // 3 · 0.5² + 1 · 1.5² = 3.
    let expected = [[0.5, 0.1, 0.3], [0.1, 3.6, 0.2], [0.3, 0.2, 3.7]];
    for i in 0..3 {
        for k in 0..3 {
            assert!(
                (j[i][k] - expected[i][k]).abs() < 1e-13,
                "{i} {k}: {}",
                j[i][k]
            );
        }
    }
}
