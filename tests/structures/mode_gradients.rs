//! Derivatives of frequencies against the complex step, and against differences of whole solutions.

use super::sample::{
    ALUMINIUM, Compared, KINDS, Numbers, complex_step, structure_numbers, with_numbers,
};
use flexbody_mathematics::math::{Complex64, Vec3};
use flexbody_mechanics::structures::generate::{Generated, panel_of, plate};
use flexbody_mechanics::structures::lumped_mass::LumpedMass;
use flexbody_mechanics::structures::modes::{
    ModalFailure, ModalProblem, Modes, frequency_gradient, lowest_frequency, reduced,
};
use flexbody_mechanics::structures::shell::ShellKind;
use flexbody_mechanics::structures::structure::Structure;
use flexbody_mechanics::structures::supports::{NodeUnknowns, Support};
use nalgebra::DMatrix;

type Matrix = DMatrix<Complex64>;

/// A curved and disturbed panel with masses of all kinds, of as many nodes with both kinds of elements.
fn panel_with_masses(kind: ShellKind, numbers: &mut Numbers) -> Structure<f64> {
    let elements = [6, 4].map(|steps| steps / kind.order());
    let mut generated = panel_of(kind, elements, false, |x, y| {
        Vec3::new(1.5 * x, 0.8 * y, 0.2 * x * (1.0 - x) + 0.1 * y * y)
    });
    for node in &mut generated.nodes {
        *node += numbers.vector(0.01);
    }
    let mut structure =
        Structure::uniform(generated.mesh, generated.nodes, 0.15, ALUMINIUM).expect("sound");
    for (h, m) in structure
        .thickness
        .iter_mut()
        .zip(&mut structure.surface_mass)
    {
        *h += 0.02 * numbers.next();
        *m = 5.0 + numbers.next();
    }
    for node in [17, 30] {
        let inertia = [0.8, 0.9, 0.7, 0.1, -0.05, 0.08];
        structure.add_mass(
            node,
            LumpedMass {
                mass: 20.0,
                inertia,
            },
        );
    }
    structure
}

fn supports() -> [Support; 2] {
    [
        Support::of("x0", [true; 3], [true, false, false]),
        Support::of("x1y0", [false, false, true], [false, true, true]),
    ]
}

#[test]
fn separate_frequencies_have_exact_derivatives_by_everything() {
    let all = [
        (41, NodeUnknowns::Natural, false),
        (42, NodeUnknowns::Six, false),
        (43, NodeUnknowns::Natural, true),
    ];
    let all = all.into_iter();
    for (kind, (seed, unknowns, free)) in all.flat_map(|own| KINDS.map(|kind| (kind, own))) {
        let structure = panel_with_masses(kind, &mut Numbers::new(seed));
        let supports = if free {
            Vec::new()
        } else {
            supports().to_vec()
        };
        let mut problem = ModalProblem::new(&structure, &supports, unknowns).expect("sets");
        let modes = problem.solve(&structure, 5).expect("modes");
        assert_eq!(modes.rigid, if free { 6 } else { 0 });
        let (at, kinds) = structure_numbers(&structure);
        for index in 0..4 {
            let found = frequency_gradient(&problem, &structure, &modes, index).expect("separate");
            let one = Modes {
                vectors: vec![modes.vectors[index].clone()],
                ..modes.clone()
            };
            let exact = complex_step(&at, |x| {
                let [k, m] = reduced(&problem, &with_numbers(&structure, x), &one);
                (k[0][0] / m[0][0]).sqrt() / (2.0 * std::f64::consts::PI)
            });
            Compared {
                name: &format!("frequency {index}"),
                value: modes.frequencies()[index],
                at: &at,
                exact: &exact,
                found: &found.values(),
                kinds: &kinds,
            }
            .assert(1e-12);
        }
    }
}

/// The eigenvalues of changed structures check the derivatives without any part of the solution.
#[test]
fn frequencies_follow_their_derivatives_in_whole_solutions() {
    let structure = panel_with_masses(ShellKind::Mitc9, &mut Numbers::new(44));
    let supports = supports();
    let mut problem =
        ModalProblem::new(&structure, &supports, NodeUnknowns::Natural).expect("sets");
    let modes = problem.solve(&structure, 4).expect("modes");
    let slopes: Vec<Vec<f64>> = (0..3)
        .map(|k| {
            frequency_gradient(&problem, &structure, &modes, k)
                .expect("separate")
                .values()
        })
        .collect();
    let at = structure.values();
    // A node, a thickness, a mass, an inertia, E, nu, rho.
    let (nodes, last) = (3 * structure.nodes.len(), at.len());
    for i in [
        50,
        nodes + 2,
        last - 18,
        last - 17,
        last - 4,
        last - 3,
        last - 2,
    ] {
        let step = 1e-4 * at[i].abs().max(1e-2);
        let mut frequencies = |factor: f64| {
            let mut count = 0;
            let moved = structure.map(|x| {
                count += 1;
                if count == i + 1 { x + factor * step } else { x }
            });
            problem.solve(&moved, 4).expect("modes").frequencies()
        };
        let sides = [2.0, 1.0, -1.0, -2.0].map(&mut frequencies);
        for k in 0..3 {
            let [a, b, c, d] = [0, 1, 2, 3].map(|side| sides[side][k]);
            let difference = (8.0 * (b - c) - (a - d)) / (12.0 * step);
            let slope = slopes[k][i];
            let unit = 1e-3 * modes.frequencies()[k] / at[i].abs().max(1e-2);
            assert!(
                (difference - slope).abs() <= 1e-6 * slope.abs().max(unit),
                "frequency {k} by number {i}: {slope:e} and {difference:e} by differences"
            );
        }
    }
}

fn matrix(columns: &[Vec<Complex64>]) -> Matrix {
    DMatrix::from_fn(columns.len(), columns.len(), |i, j| columns[j][i])
}

/// −(1/ρ) ln tr e^{−ρ√A/2π} by matrix functions only, A = M⁻¹K: without eigenvalues or
/// eigenvectors. The square root is that of Denman & Beavers (1976), the exponential is by scaling
/// and squaring.
fn aggregate_of_matrices(stiffness: &Matrix, mass: &Matrix, rho: f64, shift: f64) -> Complex64 {
    let n = mass.nrows();
    let one = Matrix::identity(n, n);
    let half = Complex64::from(0.5);
    let mut root = mass.clone().try_inverse().expect("definite") * stiffness;
    let mut inverse = one.clone();
    for _ in 0..40 {
        let next = (&root + inverse.clone().try_inverse().expect("regular")) * half;
        inverse = (&inverse + root.try_inverse().expect("regular")) * half;
        root = next;
    }
    let per_hertz = Complex64::from(1.0 / (2.0 * std::f64::consts::PI));
    let halvings = 14;
    let scale = Complex64::from(-rho / f64::from(1 << halvings));
    let exponent = (root * per_hertz - &one * Complex64::from(shift)) * scale;
    let (mut term, mut sum) = (one.clone(), one);
    for k in 1..=12 {
        term = &term * &exponent / Complex64::from(f64::from(k));
        sum += &term;
    }
    for _ in 0..halvings {
        sum = &sum * &sum;
    }
    Complex64::from(shift) - sum.trace().ln() / rho
}

/// A square plate has a double second frequency. The aggregate has exact derivatives there, and for
/// nine equal plates.
#[test]
fn the_aggregate_of_a_cluster_has_exact_derivatives() {
    for (n, size, rho) in [
        (2, [1.0, 1.0], 0.02),
        (3, [1.0, 1.0], 0.05),
        (2, [1.3, 0.9], 0.02),
    ] {
        let Generated { mesh, nodes } = plate(size, [n, n]);
        let structure = Structure::uniform(mesh, nodes, 0.1, ALUMINIUM).expect("sound");
        let supports = ["x0", "x1", "y0", "y1"].map(Support::clamp);
        let mut problem =
            ModalProblem::new(&structure, &supports, NodeUnknowns::Natural).expect("sets");
        let found = lowest_frequency(&mut problem, &structure, rho).expect("modes");
        let f = found.modes.frequencies();
        println!("rho {rho}: {} of {:.3?}", found.value, &f[..4]);
        if size[0] == size[1] {
            assert!((f[2] / f[1] - 1.0).abs() < 1e-9, "a pair: {f:?}");
            let failure = frequency_gradient(&problem, &structure, &found.modes, 1).err();
            assert!(matches!(
                failure,
                Some(ModalFailure::Repeated { mode: 2, .. })
            ));
        }
        assert!(found.value <= f[0]);
        let kept = Modes {
            vectors: found.modes.vectors.clone(),
            ..found.modes.clone()
        };
        let (at, kinds) = structure_numbers(&structure);
        let value = |x: &[Complex64]| {
            let [k, m] = reduced(&problem, &with_numbers(&structure, x), &kept);
            aggregate_of_matrices(&matrix(&k), &matrix(&m), rho, f[0])
        };
        let real: Vec<Complex64> = at.iter().map(|&x| Complex64::from(x)).collect();
        let expected = value(&real).re;
        assert!((found.value / expected - 1.0).abs() < 1e-11, "{expected}");
        Compared {
            name: "aggregate",
            value: found.value,
            at: &at,
            exact: &complex_step(&at, value),
            found: &found.gradient.values(),
            kinds: &kinds,
        }
        .assert(1e-12);
    }
}

/// Two modes swap when the length of a plate passes the square, and others enter at the end of the
/// range. The aggregate and its derivative in the length have no jump.
#[test]
fn the_aggregate_does_not_jump_where_modes_swap() {
    let supports = ["x0", "x1", "y0", "y1"].map(Support::clamp);
    let rho = 0.05;
    let at = |length: f64| {
        let step = flexbody_mathematics::math::Dual::new(length, 1.0);
        let Generated { mesh, nodes } = plate([step, 1.0.into()], [3, 3]);
        let real = nodes.iter().map(|x| x.map(|x| x.re)).collect();
        let structure = Structure::uniform(mesh, real, 0.1, ALUMINIUM).expect("sound");
        let mut problem =
            ModalProblem::new(&structure, &supports, NodeUnknowns::Natural).expect("sets");
        let found = lowest_frequency(&mut problem, &structure, rho).expect("modes");
        let pairs = nodes.iter().zip(&found.gradient.nodes);
        let slope: f64 = pairs
            .map(|(x, bar)| x.iter().zip(bar.iter()).map(|(x, b)| x.du * b).sum::<f64>())
            .sum();
        (found.value, slope)
    };
    let step = 1e-3;
    let line: Vec<(f64, f64)> = (-6..=6).map(|k| at(1.0 + step * f64::from(k))).collect();
    for k in 2..line.len() - 2 {
        let difference = (8.0 * (line[k + 1].0 - line[k - 1].0) - (line[k + 2].0 - line[k - 2].0))
            / (12.0 * step);
        assert!(
            (difference / line[k].1 - 1.0).abs() < 1e-7,
            "{k}: {} and {difference} by differences",
            line[k].1
        );
        // The derivatives are smooth, too.
        let bend = line[k + 1].1 - 2.0 * line[k].1 + line[k - 1].1;
        assert!((bend / line[k].1).abs() < 1e-4, "{k}: {bend}");
    }
}
