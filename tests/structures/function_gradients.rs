//! Functions of static solutions: every derivative against the complex step through the whole
//! solution, on a curved and distorted mesh with a fold, for both kinds of unknowns.

use super::sample::{
    ALUMINIUM, Compared, KINDS, Numbers, complex_step, structure_numbers, with_numbers,
};
use flexbody_mathematics::math::{Complex64, Scalar, Vec3};
use flexbody_mechanics::structures::functions::{Aggregate, Function, Solved};
use flexbody_mechanics::structures::generate::panel_of;
use flexbody_mechanics::structures::gradient::{gradient, gradient_von_karman};
use flexbody_mechanics::structures::loads::Load;
use flexbody_mechanics::structures::shell::{ShellKind, Terms};
use flexbody_mechanics::structures::statics::StaticProblem;
use flexbody_mechanics::structures::structure::Structure;
use flexbody_mechanics::structures::supports::{NodeUnknowns, Support};
use flexbody_mechanics::structures::von_karman::LoadSteps;

fn load_numbers<S: Scalar>(cases: &[Vec<Load<S>>]) -> Vec<S> {
    let mut all = Vec::new();
    for load in cases.iter().flatten() {
        all.extend(load.values());
    }
    all
}

/// A curved panel with a fold at x = 1/2 and disturbed nodes.
fn structure(kind: ShellKind, numbers: &mut Numbers, fold: bool) -> Structure<f64> {
    let mut generated = panel_of(kind, [3, 2], false, |x, y| {
        let kink = if fold && x > 0.3 {
            (x - 1.0 / 3.0) * 1.5
        } else {
            0.0
        };
        Vec3::new(1.5 * x, 0.8 * y, 0.2 * x * (1.0 - x) + 0.1 * y * y + kink)
    });
    for node in &mut generated.nodes {
        *node += numbers.vector(0.01);
    }
    let sets = &mut generated.mesh.node_sets;
    let mut held = sets["x0"].clone();
    held.extend(&sets["x1y0"]);
    sets.insert("held".into(), held);
    let mut structure =
        Structure::uniform(generated.mesh, generated.nodes, 0.15, ALUMINIUM).expect("sound");
    for h in &mut structure.thickness {
        *h += 0.02 * numbers.next();
    }
    for m in &mut structure.surface_mass {
        *m = 5.0 + numbers.next();
    }
    structure
}

/// Two load cases, multiplied by `size`; at 1 the panel moves by far less than its thickness.
fn cases(size: f64) -> Vec<Vec<Load<f64>>> {
    let all = || "all".to_owned();
    let cases: Vec<Vec<Load<f64>>> = vec![
        vec![
            Load::Pressure {
                faces: all(),
                pressure: 2e4,
            },
            Load::Gravity {
                acceleration: Vec3::new(1.0, -3.0, -9.81),
            },
            Load::Point {
                nodes: "x1y1".into(),
                force: Vec3::new(100.0, 50.0, -200.0),
                moment: Vec3::new(5.0, -3.0, 2.0),
            },
        ],
        vec![
            Load::Edge {
                edges: "x1".into(),
                force: Vec3::new(1e3, -2e3, 500.0),
            },
            Load::Area {
                faces: all(),
                force: Vec3::new(-3e2, 2e2, 1e3),
            },
        ],
    ];
    let scaled = cases.iter();
    scaled
        .map(|case| case.iter().map(|load| load.map(|x| x * size)).collect())
        .collect()
}

#[test]
fn every_function_has_exact_derivatives_by_everything() {
    check(31, false, NodeUnknowns::Natural, Terms::LINEAR, 1.0);
    check(32, true, NodeUnknowns::Natural, Terms::LINEAR, 1.0);
    check(33, true, NodeUnknowns::Six, Terms::LINEAR, 1.0);
}

/// Von Karman's strains change the displacements by more than 2 %.
#[test]
fn every_function_has_exact_derivatives_with_von_karman_strains() {
    check(34, false, NodeUnknowns::Natural, Terms::VON_KARMAN, 1e3);
    check(35, true, NodeUnknowns::Six, Terms::VON_KARMAN, 1e3);
}

fn check(seed: u64, fold: bool, unknowns: NodeUnknowns, terms: Terms, size: f64) {
    for kind in KINDS {
        // A coarse mesh of four nodes is stiffer, and bends as far under three times the load.
        let times = match (kind, terms.von_karman) {
            (ShellKind::Mitc4, true) => 3.0,
            _ => 1.0,
        };
        check_of(kind, seed, fold, unknowns, terms, times * size);
    }
}

fn check_of(
    kind: ShellKind,
    seed: u64,
    fold: bool,
    unknowns: NodeUnknowns,
    terms: Terms,
    size: f64,
) {
    let (a, b) = (Vec3::new(0.3, -0.5, 0.8), Vec3::new(1.0, 0.2, -0.4));
    let stress = |aggregate| Function::Stress {
        cases: vec![0, 1],
        faces: "all".into(),
        rho: 30.0,
        aggregate,
    };
    let functions = [
        Function::Mass,
        Function::Centre(a),
        Function::SecondMoment(a, b),
        Function::Inertia(a, b),
        Function::Reaction {
            case: 0,
            nodes: "held".into(),
            direction: a,
        },
        Function::ReactionMoment {
            case: 1,
            nodes: "held".into(),
            axis: b,
            about: Vec3::new(0.3, 0.1, -0.2),
        },
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
        Function::Compliance { case: 1 },
        Function::Displacement {
            case: 0,
            nodes: "x1".into(),
            direction: a,
        },
        stress(Aggregate::Ks),
        stress(Aggregate::InducedExponential),
    ];
    let supports = [
        Support::of("x0", [true; 3], [true, false, false]),
        Support::of("x1y0", [false, false, true], [false, true, false]),
    ];
    let structure = structure(kind, &mut Numbers::new(seed), fold);
    let cases = cases(size);
    let mut problem = StaticProblem::new(&structure, &supports, unknowns).expect("sets");
    problem.factorise(&structure).expect("supported");
    let solutions: Vec<Vec<f64>> = cases
        .iter()
        .map(|case| {
            if terms.von_karman {
                let found = problem.solve_von_karman(&structure, case, &LoadSteps::default());
                problem.factorise(&structure).expect("supported");
                let linear = problem.solve_linear(&structure, case).expect("sets");
                let found = found.expect("an equilibrium").x;
                let apart = found.iter().zip(&linear).map(|(a, b)| (a - b).abs());
                let largest = |list: &[f64]| list.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
                assert!(
                    apart.fold(0.0, f64::max) > 0.02 * largest(&linear),
                    "not linear"
                );
                found
            } else {
                problem.solve_linear(&structure, case).expect("sets")
            }
        })
        .collect();
    let (at, kinds) = structure_numbers(&structure);
    // The values of all functions for each disturbed number, in one pass.
    let found: Vec<_> = functions
        .iter()
        .map(|f| {
            if terms.von_karman {
                gradient_von_karman(&mut problem, &structure, &cases, &solutions, f)
                    .expect("stable")
            } else {
                gradient(&mut problem, &structure, &cases, &solutions, f).expect("sets")
            }
        })
        .collect();
    let shared = std::cell::RefCell::new(problem);
    let real = structure.clone();
    let values =
        |structure: &Structure<Complex64>, cases: &[Vec<Load<Complex64>>], f: &Function| {
            let solutions: Vec<Vec<Complex64>> = cases
                .iter()
                .zip(&solutions)
                .map(|(case, x)| {
                    let mut problem = shared.borrow_mut();
                    if terms.von_karman {
                        let lifted = problem.lift_von_karman(&real, structure, case, x);
                        lifted.expect("stable")
                    } else {
                        problem.solve_linear(structure, case).expect("sets")
                    }
                })
                .collect();
            let solved = Solved {
                problem: &shared.borrow(),
                structure,
                cases,
                solutions: &solutions,
                terms,
            };
            solved.value(f).expect("sets")
        };
    let lifted_cases: Vec<Vec<Load<Complex64>>> = cases
        .iter()
        .map(|case| case.iter().map(|load| load.map(Complex64::from)).collect())
        .collect();
    for (function, found) in functions.iter().zip(&found) {
        let name = format!("{function:?}");
        let exact = complex_step(&at, |x| {
            values(&with_numbers(&structure, x), &lifted_cases, function)
        });
        let lifted = structure.map(Complex64::from);
        let value_of = |f: &Function| values(&lifted, &lifted_cases, f).re;
        // Supports share the load. There a reaction has the round-off of the forces of single
        // elements, in the complex step too: all reactions together show their size.
        let value = match function {
            Function::Reaction { nodes, .. } | Function::ReactionMoment { nodes, .. }
                if nodes == "x0" =>
            {
                let all = |k: usize| {
                    let mut direction = Vec3::zeros();
                    direction[k] = 1.0;
                    value_of(&Function::Reaction {
                        case: 0,
                        nodes: "held".into(),
                        direction,
                    })
                };
                value_of(function)
                    .abs()
                    .max(Vec3::from_fn(|k, _| all(k)).norm())
            }
            _ => value_of(function),
        };
        // The moment of one support is a small rest of the forces of its elements.
        let tolerance = match function {
            Function::ReactionMoment { nodes, .. } if nodes == "x0" => 1e-11,
            _ => 1e-12,
        };
        Compared {
            name: &name,
            value,
            at: &at,
            exact: &exact,
            found: &structure_numbers(&found.structure).0,
            kinds: &kinds,
        }
        .assert(tolerance);
        let loads = load_numbers(&cases);
        let exact = complex_step(&loads, |x| {
            let mut next = x.iter().copied();
            let moved: Vec<Vec<Load<Complex64>>> = cases
                .iter()
                .map(|case| {
                    case.iter()
                        .map(|load| load.map(|_| next.next().expect("as many")))
                        .collect()
                })
                .collect();
            values(&lifted, &moved, function)
        });
        Compared {
            name: &name,
            value,
            at: &loads,
            exact: &exact,
            found: &load_numbers(&found.cases),
            kinds: &[1, 3, 3, 3, 3, 3],
        }
        .assert(1e-12);
    }
}
