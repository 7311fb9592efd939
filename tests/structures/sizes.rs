//! Derivatives in the sizes of generators (lengths, widths, radii, angles, positions of ends)
//! through statics and modes, against the complex step through generator and solution.

use super::sample::{ALUMINIUM, complex_step};
use flexbody_mathematics::math::{Complex64, Dual, Scalar, Vec3};
use flexbody_mechanics::structures::beam::Section;
use flexbody_mechanics::structures::functions::{Aggregate, Function, Solved};
use flexbody_mechanics::structures::generate::{
    Generated, GeneratedBeams, Member, curved_beam, curved_panel, curved_panel_of, cylinder,
    cylinder_of, frame, plate, plate_of, straight_beam,
};
use flexbody_mechanics::structures::gradient::gradient;
use flexbody_mechanics::structures::loads::Load;
use flexbody_mechanics::structures::mesh::Mesh;
use flexbody_mechanics::structures::modes::{ModalProblem, Modes, frequency_gradient, reduced};
use flexbody_mechanics::structures::shell::{ShellKind, Terms};
use flexbody_mechanics::structures::statics::StaticProblem;
use flexbody_mechanics::structures::structure::Structure;
use flexbody_mechanics::structures::supports::{NodeUnknowns, Support};

/// The result of a generator.
struct Made<S> {
    mesh: Mesh,
    nodes: Vec<Vec3<S>>,
    orientations: Vec<Vec3<S>>,
}

fn shells<S>(generated: Generated<S>) -> Made<S> {
    Made {
        mesh: generated.mesh,
        nodes: generated.nodes,
        orientations: Vec::new(),
    }
}

fn beams<S>(generated: GeneratedBeams<S>) -> Made<S> {
    Made {
        mesh: generated.mesh,
        nodes: generated.nodes,
        orientations: generated.orientations,
    }
}

const NAMES: [&str; 9] = [
    "plate",
    "panel",
    "cylinder",
    "plate of four nodes",
    "panel of four nodes",
    "cylinder of four nodes",
    "straight",
    "arc",
    "frame",
];

fn start(name: &str) -> (Vec<f64>, &'static str, &'static str) {
    match name {
        "plate" | "plate of four nodes" => (vec![1.2, 0.8], "x0", "x1"),
        "panel" | "panel of four nodes" => (vec![1.0, 1.4, 0.2, 1.1], "x0", "x1"),
        "cylinder" | "cylinder of four nodes" => (vec![0.5, 1.1], "y0", "y1"),
        "straight" => (vec![0.1, -0.2, 0.3, 1.2, 0.8, 0.9], "start", "end"),
        "arc" => (vec![1.1, 0.3, 1.6], "start", "end"),
        _ => (
            vec![0.0, 0.1, 0.0, 0.2, 0.0, 1.1, 0.9, 0.3, 1.2],
            "point0",
            "point2",
        ),
    }
}

fn make<S: Scalar>(name: &str, x: &[S]) -> Made<S> {
    let vector = |k: usize| Vec3::new(x[k], x[k + 1], x[k + 2]);
    let v = Vec3::new(S::from(0.3), S::from(1.0), S::from(-0.2));
    match name {
        "plate" => shells(plate([x[0], x[1]], [3, 2])),
        "panel" => shells(curved_panel(x[0], x[1], [x[2], x[3]], [3, 2])),
        "cylinder" => shells(cylinder(x[0], x[1], [5, 2])),
        "plate of four nodes" => shells(plate_of(ShellKind::Mitc4, [x[0], x[1]], [5, 3])),
        "panel of four nodes" => {
            let sizes = (x[0], x[1], [x[2], x[3]]);
            shells(curved_panel_of(ShellKind::Mitc4, sizes, [5, 3]))
        }
        "cylinder of four nodes" => shells(cylinder_of(ShellKind::Mitc4, (x[0], x[1]), [11, 3])),
        "straight" => beams(straight_beam([vector(0), vector(3)], v, 3)),
        "arc" => beams(curved_beam(x[0], [x[1], x[2]], 4)),
        _ => {
            let members = [[0, 1], [1, 2]].map(|ends| Member {
                ends,
                elements: 2,
                orientation: v,
            });
            beams(frame(&[vector(0), vector(3), vector(6)], &members))
        }
    }
}

fn real<S: Scalar>(made: &Made<S>) -> Structure<f64> {
    let re = |list: &[Vec3<S>]| list.iter().map(|x| x.map(|x| x.re())).collect();
    let section = Section::Rectangle {
        width: 0.2,
        height: 0.26,
    };
    let (nodes, orientations) = (re(&made.nodes), re(&made.orientations));
    Structure::with_beams(
        made.mesh.clone(),
        nodes,
        0.1,
        section,
        orientations,
        ALUMINIUM,
    )
    .expect("sound")
}

/// The structure with nodes and orientations in another scalar.
fn lifted<S: Scalar>(made: &Made<S>) -> Structure<S> {
    let mut all = real(made).map(S::from);
    all.nodes.clone_from(&made.nodes);
    all.orientations.clone_from(&made.orientations);
    all
}

/// Derivatives in the sizes from those in nodes and orientations.
fn by_sizes(name: &str, at: &[f64], gradient: &Structure<f64>) -> Vec<f64> {
    let one = |k: usize| {
        let seeded: Vec<Dual> = at
            .iter()
            .enumerate()
            .map(|(i, &x)| Dual::new(x, f64::from(u8::from(i == k))))
            .collect();
        let made = make(name, &seeded);
        let dot = |list: &[Vec3<Dual>], bar: &[Vec3<f64>]| -> f64 {
            list.iter()
                .zip(bar)
                .map(|(x, bar)| x.map(|x| x.du).dot(bar))
                .sum()
        };
        dot(&made.nodes, &gradient.nodes) + dot(&made.orientations, &gradient.orientations)
    };
    (0..at.len()).map(one).collect()
}

fn assert_same(name: &str, value: f64, at: &[f64], exact: &[f64], found: &[f64]) {
    let largest = |list: &[f64]| list.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    let size = largest(exact).max(value.abs() / largest(at));
    for (k, (exact, found)) in exact.iter().zip(found).enumerate() {
        assert!(
            (exact - found).abs() <= 1e-12 * size,
            "{name} by size {k}: {exact:e} by the complex step, {found:e}"
        );
    }
}

#[test]
fn statics_have_exact_derivatives_by_sizes() {
    for name in NAMES {
        let (at, held, loaded) = start(name);
        let structure = real(&make(name, &at));
        let case = vec![
            Load::Gravity {
                acceleration: Vec3::new(1.0, -2.0, -9.81),
            },
            Load::Point {
                nodes: loaded.into(),
                force: Vec3::new(30.0, 50.0, -90.0),
                moment: Vec3::zeros(),
            },
        ];
        let case_in: Vec<Load<Complex64>> =
            case.iter().map(|load| load.map(Complex64::from)).collect();
        let cases = [case];
        let mut problem =
            StaticProblem::new(&structure, &[Support::clamp(held)], NodeUnknowns::Natural)
                .expect("sets");
        problem.factorise(&structure).expect("supported");
        let solutions = [problem.solve_linear(&structure, &cases[0]).expect("sets")];
        let mut functions = vec![
            Function::Mass,
            Function::Inertia(Vec3::new(0.3, -0.5, 0.8), Vec3::new(1.0, 0.2, -0.4)),
            Function::Compliance { case: 0 },
            Function::Displacement {
                case: 0,
                nodes: loaded.into(),
                direction: Vec3::new(0.5, 0.7, 1.0),
            },
            Function::ReactionMoment {
                case: 0,
                nodes: held.into(),
                axis: Vec3::new(0.2, 1.0, 0.5),
                about: Vec3::new(0.1, 0.2, 0.3),
            },
        ];
        if !structure.thickness.is_empty() {
            functions.push(Function::Stress {
                cases: vec![0],
                faces: "all".into(),
                rho: 30.0,
                aggregate: Aggregate::Ks,
            });
        }
        for function in functions {
            let found = gradient(&mut problem, &structure, &cases, &solutions, &function)
                .expect("sets")
                .structure;
            let shared = std::cell::RefCell::new(&mut problem);
            let value = |x: &[Complex64]| {
                let structure = lifted(&make(name, x));
                let solution = shared.borrow_mut().solve_linear(&structure, &case_in);
                let solved = Solved {
                    problem: &shared.borrow(),
                    structure: &structure,
                    cases: std::slice::from_ref(&case_in),
                    solutions: &[solution.expect("sets")],
                    terms: Terms::LINEAR,
                };
                solved.value(&function).expect("sets")
            };
            let whole: Vec<Complex64> = at.iter().map(|&x| Complex64::from(x)).collect();
            assert_same(
                &format!("{name}: {function:?}"),
                value(&whole).re,
                &at,
                &complex_step(&at, value),
                &by_sizes(name, &at, &found),
            );
        }
    }
}

#[test]
fn frequencies_have_exact_derivatives_by_sizes() {
    for name in NAMES {
        let (at, held, _) = start(name);
        let structure = real(&make(name, &at));
        let mut problem =
            ModalProblem::new(&structure, &[Support::clamp(held)], NodeUnknowns::Natural)
                .expect("sets");
        let modes = problem.solve(&structure, 6).expect("modes");
        let mut separate = 0;
        for index in 0..4 {
            // Modes of a cylinder come in pairs.
            let Ok(found) = frequency_gradient(&problem, &structure, &modes, index) else {
                assert!(name.starts_with("cylinder"), "{name}");
                continue;
            };
            separate += 1;
            let one = Modes {
                vectors: vec![modes.vectors[index].clone()],
                ..modes.clone()
            };
            let exact = complex_step(&at, |x| {
                let [k, m] = reduced(&problem, &lifted(&make(name, x)), &one);
                (k[0][0] / m[0][0]).sqrt() / (2.0 * std::f64::consts::PI)
            });
            assert_same(
                &format!("{name}: frequency {index}"),
                modes.frequencies()[index],
                &at,
                &exact,
                &by_sizes(name, &at, &found),
            );
        }
        assert!(name.starts_with("cylinder") || separate == 4);
    }
}
