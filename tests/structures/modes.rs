//! Natural frequencies against other codes and solutions, and the count that detects missed ones.

use super::sample::ALUMINIUM;
use flexbody_mechanics::structures::generate::{Generated, plate};
use flexbody_mechanics::structures::lumped_mass::LumpedMass;
use flexbody_mechanics::structures::material::Material;
use flexbody_mechanics::structures::modes::{ModalFailure, ModalProblem, Modes};
use flexbody_mechanics::structures::structure::Structure;
use flexbody_mechanics::structures::supports::{NodeUnknowns, Support};
use nalgebra::{DMatrix, SymmetricEigen};
use serde_json::Value;

fn modes_of(
    structure: &Structure<f64>,
    supports: &[Support],
    unknowns: NodeUnknowns,
    count: usize,
) -> Modes {
    let mut problem = ModalProblem::new(structure, supports, unknowns).expect("known sets");
    problem.solve(structure, count).expect("modes")
}

fn square(n: usize, thickness: f64) -> Structure<f64> {
    let Generated { mesh, nodes } = plate([1.0, 1.0], [n, n]);
    Structure::uniform(mesh, nodes, thickness, ALUMINIUM).expect("sound")
}

/// ω a² √(ρh/D) of a plate of a = 1 m.
fn dimensionless(modes: &Modes, thickness: f64) -> Vec<f64> {
    let Material {
        young,
        poisson,
        density,
        ..
    } = ALUMINIUM;
    let bending = young * thickness.powi(3) / (12.0 * (1.0 - poisson * poisson));
    let factor = (density * thickness / bending).sqrt();
    let all = modes.eigenvalues.iter();
    all.map(|lambda| lambda.sqrt() * factor).collect()
}

fn assert_near(name: &str, found: &[f64], expected: &[f64], tolerance: f64) {
    println!("{name}: {found:.5?}");
    for (k, (found, expected)) in found.iter().zip(expected).enumerate() {
        assert!(
            (found / expected - 1.0).abs() <= tolerance,
            "{name}: frequency {k} is {found}, {expected} expected"
        );
    }
    assert!(found.len() >= expected.len());
}

/// The same element in an independent prototype, to its five digits. The limit of Ritz series
/// (Kirchhoff) is 3.4710 8.5066 21.284 27.199.
#[test]
fn a_thin_cantilever_plate_has_its_frequencies() {
    for unknowns in [NodeUnknowns::Natural, NodeUnknowns::Six] {
        let structure = square(16, 1e-3);
        let modes = modes_of(&structure, &[Support::clamp("x0")], unknowns, 4);
        let found = dimensionless(&modes, 1e-3);
        assert_near(
            "cantilever",
            &found,
            &[3.4711, 8.5064, 21.285, 27.199],
            3e-5,
        );
        assert_eq!(modes.rigid, 0);
    }
}

/// ω a² √(ρh/D) of Kirchhoff's free square plate, without rigid motions, by Ritz with 13 Legendre
/// polynomials per direction (Leissa 1969 gives the upper bounds 13.49 19.79 24.43 35.02 35.02).
fn ritz_free_square() -> Vec<f64> {
    let (n, points, nu) = (13, 20, ALUMINIUM.poisson);
    // Gauss points and weights by Golub & Welsch.
    let jacobi = DMatrix::from_fn(points, points, |i: usize, j: usize| {
        let k = i.max(j) as f64;
        if i.abs_diff(j) == 1 {
            k / (4.0 * k * k - 1.0).sqrt()
        } else {
            0.0
        }
    });
    let gauss = SymmetricEigen::new(jacobi);
    let weight = |g: usize| 2.0 * gauss.eigenvectors[(0, g)].powi(2);
    // Normalised polynomials and their first two derivatives.
    let polynomials = |x: f64| {
        let mut all = vec![[1.0, 0.0, 0.0], [x, 1.0, 0.0]];
        for k in 1..n - 1 {
            let (a, b, c) = (all[k], all[k - 1], k as f64);
            let next = |d: usize| {
                let lower = if d > 0 { d as f64 * a[d - 1] } else { 0.0 };
                ((2.0 * c + 1.0) * (x * a[d] + lower) - c * b[d]) / (c + 1.0)
            };
            all.push([next(0), next(1), next(2)]);
        }
        let factor = |k: usize| (k as f64 + 0.5).sqrt();
        let scaled = all.iter().enumerate();
        scaled
            .map(|(k, p)| p.map(|p| p * factor(k)))
            .collect::<Vec<_>>()
    };
    let tables: Vec<_> = gauss.eigenvalues.iter().map(|&x| polynomials(x)).collect();
    let integral = |i: usize, di: usize, j: usize, dj: usize| -> f64 {
        (0..points)
            .map(|g| weight(g) * tables[g][i][di] * tables[g][j][dj])
            .sum()
    };
    let stiffness = DMatrix::from_fn(n * n, n * n, |row, column| {
        let ([i, j], [k, l]) = ([row / n, row % n], [column / n, column % n]);
        let mass = |i, k| integral(i, 0, k, 0);
        integral(i, 2, k, 2) * mass(j, l)
            + mass(i, k) * integral(j, 2, l, 2)
            + nu * integral(i, 2, k, 0) * integral(j, 0, l, 2)
            + nu * integral(i, 0, k, 2) * integral(j, 2, l, 0)
            + 2.0 * (1.0 - nu) * integral(i, 1, k, 1) * integral(j, 1, l, 1)
    });
    let mut all: Vec<f64> = SymmetricEigen::new(stiffness)
        .eigenvalues
        .iter()
        .copied()
        .collect();
    all.sort_by(f64::total_cmp);
    // The side is 2 here. The lowest three are the rigid motions out of the plane.
    all[3..].iter().map(|lambda| 4.0 * lambda.sqrt()).collect()
}

/// A free square plate has six rigid motions, which are not modes, and a pair of equal frequencies,
/// which is found completely.
#[test]
fn a_free_plate_has_six_rigid_motions() {
    let expected = ritz_free_square();
    println!("Ritz: {:.5?}", &expected[..5]);
    for unknowns in [NodeUnknowns::Natural, NodeUnknowns::Six] {
        let modes = modes_of(&square(12, 1e-3), &[], unknowns, 4);
        assert_eq!(modes.rigid, 6);
        assert_eq!(modes.eigenvalues.len(), 5, "the pair is not cut");
        let found = dimensionless(&modes, 1e-3);
        assert_near("free", &found, &expected[..5], 2e-4);
        assert!((found[4] / found[3] - 1.0).abs() < 1e-9, "{found:?}");
    }
}

/// Rigid motions are those that the supports admit: with a hinge about x0, and with a slide along
/// y.
#[test]
fn rigid_motions_are_those_that_supports_leave() {
    let none = [false; 3];
    let cases: [(&[Support], usize); 4] = [
        (&[Support::of("x0", [true; 3], none)], 1),
        (&[Support::of("x0", [true, false, true], [true; 3])], 1),
        (&[Support::of("x0y0", [true; 3], none)], 3),
        (&[Support::of("all", [false, false, true], none)], 3),
    ];
    for (supports, expected) in cases {
        for unknowns in [NodeUnknowns::Natural, NodeUnknowns::Six] {
            let modes = modes_of(&square(4, 0.02), supports, unknowns, 3);
            assert_eq!(modes.rigid, expected, "{supports:?}");
            assert!(modes.frequencies()[0] > 1.0, "{:?}", modes.frequencies());
        }
    }
}

/// An independent MITC9 code on the same mesh, and its series of meshes.
#[test]
fn a_clamped_plate_agrees_with_another_code() {
    let text = include_str!("../data/structures/shell_plate.json");
    let reference: Value = serde_json::from_str(text).expect("JSON");
    let supports = ["x0", "x1", "y0", "y1"].map(Support::clamp);
    let list = reference["frequencies_Hz"].as_array().expect("a list");
    let expected: Vec<f64> = list.iter().filter_map(Value::as_f64).collect();
    assert_eq!(expected.len(), 8);
    let modes = modes_of(&square(16, 0.01), &supports, NodeUnknowns::Six, 8);
    assert_near("clamped", &modes.frequencies(), &expected, 1e-4);
    for n in [8, 32] {
        let name = format!("plate {n}x{n}");
        let expected = reference["meshes"][&name]["f1 [Hz]"]
            .as_f64()
            .expect("a number");
        let modes = modes_of(&square(n, 0.01), &supports, NodeUnknowns::Six, 1);
        assert_near(&name, &modes.frequencies(), &[expected], 1e-4);
    }
}

/// Many equal separate plates: every frequency is as often as there are plates, more than any block
/// of vectors. The count detects those that the iteration misses.
#[test]
fn frequencies_of_any_multiplicity_are_found() {
    for (copies, clamped) in [(3, false), (7, true), (9, true)] {
        let one = plate([1.0, 0.7], [3, 2]);
        let (mut mesh, mut nodes) = (one.mesh.clone(), one.nodes.clone());
        for copy in 1..copies {
            let first = nodes.len();
            nodes.extend(
                one.nodes
                    .iter()
                    .map(|x| x.add_scalar(2.0 * f64::from(copy))),
            );
            for shell in &one.mesh.shells {
                mesh.shells.push(shell.map(|node| node + first));
            }
            let edge = one.mesh.node_sets["x0"].iter().map(|node| node + first);
            mesh.node_sets.entry("x0".into()).or_default().extend(edge);
        }
        mesh.nodes = nodes.len();
        let single = Structure::uniform(one.mesh, one.nodes, 0.02, ALUMINIUM).expect("sound");
        let all = Structure::uniform(mesh, nodes, 0.02, ALUMINIUM).expect("sound");
        let support = if clamped {
            vec![Support::clamp("x0")]
        } else {
            Vec::new()
        };
        let expected = modes_of(&single, &support, NodeUnknowns::Natural, 2);
        let found = modes_of(&all, &support, NodeUnknowns::Natural, copies as usize + 1);
        assert_eq!(found.rigid, if clamped { 0 } else { 6 * copies as usize });
        assert_eq!(found.eigenvalues.len(), 2 * copies as usize);
        for (k, lambda) in found.eigenvalues.iter().enumerate() {
            let expected = expected.eigenvalues[k / copies as usize];
            assert!((lambda / expected - 1.0).abs() < 1e-9, "{copies}: {k}");
        }
        println!("{copies} copies: {:?}", found.work);
    }
}

/// All modes of a coarse mesh: as many as unknowns with mass. A request for more is rejected.
#[test]
fn a_structure_has_no_more_modes_than_it_has() {
    let structure = square(1, 0.1);
    let supports = [Support::clamp("x0")];
    let mut problem =
        ModalProblem::new(&structure, &supports, NodeUnknowns::Natural).expect("known sets");
    let unknowns = problem.unknowns();
    let all = problem.solve(&structure, unknowns).expect("all modes");
    assert_eq!(all.eigenvalues.len(), unknowns);
    let failure = problem.solve(&structure, unknowns + 1).err();
    let expected = ModalFailure::TooMany {
        asked: unknowns + 1,
        there: unknowns,
    };
    assert_eq!(failure, Some(expected));
    let mut massless = square(2, 0.1);
    massless.materials[0].density = 0.0;
    let mut problem =
        ModalProblem::new(&massless, &supports, NodeUnknowns::Natural).expect("known sets");
    assert_eq!(
        problem.solve(&massless, 1).err(),
        Some(ModalFailure::NoMass)
    );
}

/// A heavy mass at the tip of a light strip: f = √(3EI / ((m + 33/140 ρAL) L³)) / 2π (Rayleigh; 0.1
/// %).
#[test]
fn a_lumped_mass_lowers_the_frequency_as_it_should() {
    let (length, width, thickness) = (1.0, 0.05, 0.01);
    let Generated { mesh, nodes } = plate([length, width], [10, 1]);
    let tip = mesh.node_sets["x1"].clone();
    let mut structure = Structure::uniform(mesh, nodes, thickness, ALUMINIUM).expect("sound");
    structure.materials[0].poisson = 0.0;
    let own = ALUMINIUM.density * width * thickness * length;
    let mass = 8.0 * own;
    // Simpson's weights across the edge.
    for (node, share) in tip.iter().zip([1.0, 4.0, 1.0]) {
        structure.add_mass(*node, LumpedMass::point(mass * share / 6.0));
    }
    let modes = modes_of(
        &structure,
        &[Support::clamp("x0")],
        NodeUnknowns::Natural,
        1,
    );
    let bending = ALUMINIUM.young * width * thickness.powi(3) / 12.0;
    let omega = (3.0 * bending / ((mass + 33.0 / 140.0 * own) * length.powi(3))).sqrt();
    let expected = omega / (2.0 * std::f64::consts::PI);
    assert_near("tip mass", &modes.frequencies()[..1], &[expected], 1e-3);
}
