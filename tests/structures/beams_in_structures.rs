//! Plates with beams: derivatives of functions and frequencies, also in sizes of generators.

use super::sample::{ALUMINIUM, Compared, Numbers, complex_step, structure_numbers, with_numbers};
use flexbody_mathematics::math::{Complex64, Vec3};
use flexbody_mechanics::structures::beam::Section;
use flexbody_mechanics::structures::functions::{Function, Solved};
use flexbody_mechanics::structures::generate::plate;
use flexbody_mechanics::structures::gradient::{gradient, gradient_von_karman};
use flexbody_mechanics::structures::loads::Load;
use flexbody_mechanics::structures::lumped_mass::LumpedMass;
use flexbody_mechanics::structures::modes::{ModalProblem, Modes, frequency_gradient, reduced};
use flexbody_mechanics::structures::shell::Terms;
use flexbody_mechanics::structures::statics::StaticProblem;
use flexbody_mechanics::structures::structure::Structure;
use flexbody_mechanics::structures::supports::{NodeUnknowns, Support};
use flexbody_mechanics::structures::von_karman::LoadSteps;

/// A disturbed plate with a beam below one row of edges; its line is off the nodes.
fn stiffened(numbers: &mut Numbers) -> Structure<f64> {
    let mut generated = plate([1.2, 0.8], [2, 2]);
    for node in &mut generated.nodes {
        *node += numbers.vector(0.01);
    }
    let mut mesh = generated.mesh;
    mesh.beams = (mesh.edge_sets["y0"].iter())
        .map(|edge| [edge[0], edge[1], edge[2]])
        .collect();
    mesh.beams.push([0, 5, 10]);
    mesh.beam_sets.insert("all".into(), (0..3).collect());
    let sections = [
        Section::Rectangle {
            width: 0.06,
            height: 0.12,
        },
        Section::I {
            width: 0.08,
            height: 0.12,
            flange: 0.01,
            web: 0.008,
        },
        Section::Tube {
            radius: 0.05,
            wall: 0.01,
        },
    ];
    let orientations = vec![
        Vec3::new(0.1, 1.0, 0.05),
        Vec3::y(),
        Vec3::new(1.0, 0.0, 0.2),
    ];
    let mut structure = Structure::with_beams(
        mesh,
        generated.nodes,
        0.1,
        sections[0],
        orientations,
        ALUMINIUM,
    )
    .expect("sound");
    structure.sections = sections.to_vec();
    for (k, offset) in structure.offsets.iter_mut().enumerate() {
        *offset = [0.01 * numbers.next() + 0.02, -0.09 + 0.01 * k as f64];
    }
    structure.line_mass = vec![2.0, 3.0, 4.0];
    structure.surface_mass.fill(5.0);
    let inertia = [0.3, 0.4, 0.2, 0.05, -0.02, 0.03];
    structure.add_mass(12, LumpedMass { mass: 7.0, inertia });
    structure
}

#[test]
fn functions_have_exact_derivatives_by_sections_offsets_and_all_else() {
    let line = |size: f64| {
        vec![
            Load::Line {
                beams: "all".into(),
                force: Vec3::new(2e2, -3e2, 4e3) * size,
            },
            Load::Gravity {
                acceleration: Vec3::new(1.0, 2.0, -9.81) * size,
            },
            Load::Point {
                nodes: "x1y1".into(),
                force: Vec3::new(2e2, -1e2, 5e3) * size,
                moment: Vec3::zeros(),
            },
        ]
    };
    let (a, b) = (Vec3::new(0.3, -0.5, 0.8), Vec3::new(1.0, 0.2, -0.4));
    let functions = [
        Function::Mass,
        Function::Centre(Vec3::new(0.3, -0.5, 0.8)),
        Function::SecondMoment(Vec3::x(), Vec3::new(0.2, 0.5, 1.0)),
        Function::Inertia(a, b),
        Function::Reaction {
            case: 0,
            nodes: "x0".into(),
            direction: a,
        },
        Function::ReactionMoment {
            case: 0,
            nodes: "x0".into(),
            axis: b,
            about: Vec3::new(0.3, 0.1, -0.2),
        },
        Function::StrainEnergy { case: 0 },
        Function::Compliance { case: 0 },
        Function::Displacement {
            case: 0,
            nodes: "x1".into(),
            direction: Vec3::new(0.1, 0.2, 1.0),
        },
    ];
    for (seed, unknowns, von_karman) in [
        (50, NodeUnknowns::Natural, false),
        (51, NodeUnknowns::Six, true),
    ] {
        let structure = stiffened(&mut Numbers::new(seed));
        let cases = [line(if von_karman { 300.0 } else { 1.0 })];
        let mut problem =
            StaticProblem::new(&structure, &[Support::clamp("x0")], unknowns).expect("sets");
        problem.factorise(&structure).expect("supported");
        let x = if von_karman {
            let steps = LoadSteps::default();
            let found = problem.solve_von_karman(&structure, &cases[0], &steps);
            found.expect("an equilibrium").x
        } else {
            problem.solve_linear(&structure, &cases[0]).expect("sets")
        };
        let solutions = [x];
        let terms = if von_karman {
            Terms::VON_KARMAN
        } else {
            Terms::LINEAR
        };
        let (at, kinds) = structure_numbers(&structure);
        for function in &functions {
            let found = if von_karman {
                gradient_von_karman(&mut problem, &structure, &cases, &solutions, function)
                    .expect("stable")
            } else {
                gradient(&mut problem, &structure, &cases, &solutions, function).expect("sets")
            };
            let shared = std::cell::RefCell::new(&mut problem);
            let lifted_case: Vec<_> = cases[0].iter().map(|l| l.map(Complex64::from)).collect();
            let value = |x: &[Complex64]| {
                let moved = with_numbers(&structure, x);
                let solution = if von_karman {
                    let mut problem = shared.borrow_mut();
                    problem
                        .lift_von_karman(&structure, &moved, &lifted_case, &solutions[0])
                        .expect("stable")
                } else {
                    let mut problem = shared.borrow_mut();
                    problem.solve_linear(&moved, &lifted_case).expect("sets")
                };
                let solved = Solved {
                    problem: &shared.borrow(),
                    structure: &moved,
                    cases: std::slice::from_ref(&lifted_case),
                    solutions: &[solution],
                    terms,
                };
                solved.value(function).expect("sets")
            };
            let real: Vec<Complex64> = at.iter().map(|&x| Complex64::from(x)).collect();
            Compared {
                name: &format!("{function:?}"),
                value: value(&real).re,
                at: &at,
                exact: &complex_step(&at, value),
                found: &structure_numbers(&found.structure).0,
                kinds: &kinds,
            }
            .assert(1e-12);
        }
    }
}

#[test]
fn frequencies_have_exact_derivatives_by_sections_offsets_and_all_else() {
    for (seed, supported) in [(52, true), (53, false)] {
        let structure = stiffened(&mut Numbers::new(seed));
        let supports = if supported {
            vec![Support::clamp("x0")]
        } else {
            Vec::new()
        };
        let mut problem =
            ModalProblem::new(&structure, &supports, NodeUnknowns::Natural).expect("sets");
        let modes = problem.solve(&structure, 4).expect("modes");
        assert_eq!(modes.rigid, if supported { 0 } else { 6 });
        let (at, kinds) = structure_numbers(&structure);
        for index in 0..3 {
            let found = frequency_gradient(&problem, &structure, &modes, index).expect("separate");
            let one = Modes {
                vectors: vec![modes.vectors[index].clone()],
                ..modes.clone()
            };
            Compared {
                name: &format!("frequency {index}"),
                value: modes.frequencies()[index],
                at: &at,
                exact: &complex_step(&at, |x| {
                    let [k, m] = reduced(&problem, &with_numbers(&structure, x), &one);
                    (k[0][0] / m[0][0]).sqrt() / (2.0 * std::f64::consts::PI)
                }),
                found: &found.values(),
                kinds: &kinds,
            }
            .assert(1e-12);
        }
    }
}
