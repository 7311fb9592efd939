//! A clamped plate under pressure against an independent MITC9 code (tests/data/structures/
//! shell_plate.json), 16 × 16 elements, thickness in 4 × 4 patches.
//!
//! That code aggregates the two faces of a Gauss point by its own KS function with ρ = 100. Both
//! faces of this plate have the same stress. So its KS is that over points and faces only for ρ =
//! 100; for ρ = 50 it is smaller by ln 2 (1/50 − 1/100).

use super::sample::ALUMINIUM;
use flexbody_mathematics::math::Vec3;
use flexbody_mechanics::structures::functions::{Aggregate, Function, Solved};
use flexbody_mechanics::structures::generate::{Generated, plate};
use flexbody_mechanics::structures::gradient::gradient;
use flexbody_mechanics::structures::loads::Load;
use flexbody_mechanics::structures::shell::Terms;
use flexbody_mechanics::structures::statics::StaticProblem;
use flexbody_mechanics::structures::structure::Structure;
use flexbody_mechanics::structures::supports::{NodeUnknowns, Support};
use serde_json::Value;

#[test]
fn values_and_derivatives_by_patches_agree_to_a_thousandth() {
    let text = include_str!("../data/structures/shell_plate.json");
    let reference: Value = serde_json::from_str(text).expect("JSON");
    let n = 16;
    let Generated { mut mesh, nodes } = plate([1.0, 1.0], [n, n]);
    let middle = nodes
        .iter()
        .position(|x| (x - Vec3::new(0.5, 0.5, 0.0)).norm() < 1e-9)
        .expect("a middle node");
    mesh.node_sets.insert("middle".into(), vec![middle]);
    let structure = Structure::uniform(mesh, nodes, 0.01, ALUMINIUM).expect("sound");
    let supports = ["x0", "x1", "y0", "y1"].map(Support::clamp);
    let mut problem =
        StaticProblem::new(&structure, &supports, NodeUnknowns::Six).expect("known sets");
    problem.factorise(&structure).expect("supported");
    let cases = vec![vec![Load::Pressure {
        faces: "all".into(),
        pressure: 1e4,
    }]];
    let solutions = vec![
        problem
            .solve_linear(&structure, &cases[0])
            .expect("known sets"),
    ];
    let stress = |rho| Function::Stress {
        cases: vec![0],
        faces: "all".into(),
        rho,
        aggregate: Aggregate::Ks,
    };
    let functions = [
        ("mass [kg]", Function::Mass),
        ("strain energy [J]", Function::StrainEnergy { case: 0 }),
        ("compliance uTf [J]", Function::Compliance { case: 0 }),
        ("KS_discrete_50 [-]", stress(50.0)),
        ("KS_discrete_100 [-]", stress(100.0)),
        (
            "centre uz [m or rad]",
            Function::Displacement {
                case: 0,
                nodes: "middle".into(),
                direction: Vec3::z(),
            },
        ),
    ];
    for (name, function) in functions {
        let solved = Solved {
            problem: &problem,
            structure: &structure,
            cases: &cases,
            solutions: &solutions,
            terms: Terms::LINEAR,
        };
        let value = solved.value(&function).expect("known sets");
        let faces = |rho: f64| 2.0_f64.ln() * (1.0 / rho - 0.01);
        let shift = if name == "KS_discrete_50 [-]" {
            faces(50.0)
        } else {
            0.0
        };
        let expected = reference["values"][name].as_f64().expect("a number") + shift;
        println!("{name}: {value} ({:.1e})", value / expected - 1.0);
        assert!(
            (value / expected - 1.0).abs() < 1e-3,
            "{name}: {value}, {expected} expected"
        );
        let found = gradient(&mut problem, &structure, &cases, &solutions, &function);
        let found = found.expect("known sets").structure.thickness;
        let expected = reference["by_thickness"][name].as_array().expect("a list");
        let mut largest: f64 = 0.0;
        for patch in 0..16 {
            let (px, py) = (patch % 4, patch / 4);
            let inside = |k: &usize| (k % n) / 4 == px && (k / n) / 4 == py;
            let sum: f64 = (0..n * n).filter(inside).map(|k| found[k]).sum();
            let expected = expected[patch].as_f64().expect("a number");
            largest = largest.max((sum / expected - 1.0).abs());
            assert!(
                (sum / expected - 1.0).abs() < 1e-3,
                "{name}: {sum}, {expected} expected"
            );
        }
        println!("{name}: derivatives within {largest:.1e}");
    }
    let solved = Solved {
        problem: &problem,
        structure: &structure,
        cases: &cases,
        solutions: &solutions,
        terms: Terms::LINEAR,
    };
    let peak = solved.peak(&[0], "all").expect("known sets");
    let expected = reference["max_ratio"].as_f64().expect("a number");
    assert!(
        (peak.ratio / expected - 1.0).abs() < 1e-3,
        "{peak:?}, {expected} expected"
    );
    // The largest stress of a clamped plate is in the middle of an edge.
    assert_eq!(peak.case, 0);
    let (i, j) = (peak.shell % n, peak.shell / n);
    assert!([i, j].iter().any(|&k| k == 0 || k == n - 1), "{peak:?}");
    assert!(
        [i, j].iter().any(|&k| k == n / 2 || k == n / 2 - 1),
        "{peak:?}"
    );
}
