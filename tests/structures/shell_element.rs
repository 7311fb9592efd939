//! One element of each kind against independent prototypes (tests/data/structures/mitc9_element.json and
//! mitc4_element.json: a parallelogram and a curved element, without drilling and correction).

use super::sample::{KINDS, Numbers, distorted_element, random_motion};
use flexbody_mathematics::math::{Dual, Vec3};
use flexbody_mechanics::structures::material::Material;
use flexbody_mechanics::structures::shell::{
    ElementMatrix, Field, Motion, NODES, RotationAxes, Shell, ShellCotangent, ShellKind, Terms,
};
use nalgebra::DMatrix;
use serde_json::Value;

const PLAIN: Terms = Terms {
    von_karman: false,
    patch_correction: false,
};
const PLAIN_VON_KARMAN: Terms = Terms {
    von_karman: true,
    patch_correction: false,
};

fn numbers(value: &Value) -> Vec<f64> {
    let list = value.as_array().expect("a list");
    list.iter().map(|x| x.as_f64().expect("a number")).collect()
}

/// The rows of the nodes, three numbers of each from `first` on.
fn vectors(value: &Value, first: usize) -> [Vec3<f64>; NODES] {
    let mut all = [Vec3::zeros(); NODES];
    let rows = value.as_array().expect("a list");
    for (to, row) in all.iter_mut().zip(rows) {
        *to = Vec3::from_column_slice(&numbers(row)[first..first + 3]);
    }
    all
}

fn motion(value: &Value) -> Motion<f64> {
    Motion {
        displacement: vectors(value, 0),
        rotation: vectors(value, 3),
    }
}

fn element(kind: ShellKind, case: &Value) -> Shell<f64> {
    let number = |name: &str| case[name].as_f64().expect("a number");
    Shell {
        kind,
        geometry: Field {
            points: vectors(&case["nodes"], 0),
            directors: vectors(&case["directors"], 0),
        },
        thickness: number("thickness"),
        material: Material {
            young: number("E"),
            poisson: number("nu"),
            density: number("rho"),
            yield_stress: 1.0,
        },
        surface_mass: 0.0,
        drilling: false,
    }
}

fn assert_close(name: &str, expected: f64, found: f64, size: f64) {
    assert!(
        (expected - found).abs() <= 1e-12 * size,
        "{name}: {expected:e} expected, {found:e} found"
    );
}

fn assert_forces(name: &str, expected: &Motion<f64>, found: &Motion<f64>) {
    for (expected, found) in [
        (&expected.displacement, &found.displacement),
        (&expected.rotation, &found.rotation),
    ] {
        let size = expected.iter().fold(0.0_f64, |m, x| m.max(x.amax()));
        for (e, f) in expected.iter().zip(found) {
            for i in 0..3 {
                assert_close(name, e[i], f[i], size);
            }
        }
    }
}

fn force(shell: &Shell<f64>, motion: &Motion<f64>, terms: Terms) -> Motion<f64> {
    let mut force = Motion::zeros();
    shell.add_energy_transpose(motion, terms, &mut force, &mut ShellCotangent::zeros());
    force
}

/// The tangent times a motion. Unknowns of the matrix are all u_a, then all θ_a.
fn tangent_product(
    shell: &Shell<f64>,
    at: &Motion<f64>,
    terms: Terms,
    v: &Motion<f64>,
) -> Motion<f64> {
    let mut matrix = ElementMatrix::new();
    shell.tangent(&RotationAxes::global(), at, terms, &mut matrix);
    let displacements = 3 * (shell.kind.order() + 1).pow(2);
    assert_eq!(matrix.order, 2 * displacements);
    let entry = |i: usize, j: usize| matrix.rows[i.max(j)][i.min(j)];
    let x = |k: usize| {
        let (list, k) = if k < displacements {
            (&v.displacement, k)
        } else {
            (&v.rotation, k - displacements)
        };
        list[k / 3][k % 3]
    };
    let row = |i: usize| (0..matrix.order).map(|j| entry(i, j) * x(j)).sum::<f64>();
    let mut product = Motion::zeros();
    for k in 0..displacements {
        product.displacement[k / 3][k % 3] = row(k);
        product.rotation[k / 3][k % 3] = row(displacements + k);
    }
    product
}

#[test]
fn energies_forces_tangents_and_masses_are_those_of_the_reference() {
    let nine = include_str!("../data/structures/mitc9_element.json");
    let four = include_str!("../data/structures/mitc4_element.json");
    for (kind, text) in [(ShellKind::Mitc9, nine), (ShellKind::Mitc4, four)] {
        let reference: Value = serde_json::from_str(text).expect("JSON");
        for name in ["parallelogram", "curved"] {
            is_that_of_the_reference(kind, &reference[name]);
        }
    }
}

fn is_that_of_the_reference(kind: ShellKind, case: &Value) {
    let shell = element(kind, case);
    let v = motion(&case["displacement"]);
    let parts = shell.energy(&v, PLAIN);
    let linear = &case["linear"];
    for (key, value) in [
        ("membrane", parts.membrane),
        ("bending", parts.bending),
        ("shear", parts.shear),
    ] {
        let expected = linear[key].as_f64().expect("a number");
        assert_close(key, expected, value, expected);
    }
    let f = motion(&linear["force"]);
    assert_forces("linear force", &f, &force(&shell, &v, PLAIN));
    let product = tangent_product(&shell, &Motion::zeros(), PLAIN, &v);
    assert_forces("linear stiffness", &f, &product);

    let karman = &case["von_karman"];
    let expected = karman["energy"].as_f64().expect("a number");
    let energy = shell.energy(&v, PLAIN_VON_KARMAN).total();
    assert_close("energy", expected, energy, expected);
    let f = motion(&karman["force"]);
    assert_forces("force", &f, &force(&shell, &v, PLAIN_VON_KARMAN));
    let expected = motion(&karman["tangent_times_displacement"]);
    let product = tangent_product(&shell, &v, PLAIN_VON_KARMAN, &v);
    assert_forces("tangent", &expected, &product);

    let masses = shell.nodal_masses();
    for (key, found) in [("m", &masses.mass), ("i", &masses.rotary)] {
        let rows = case[key].as_array().expect("a list");
        let largest = numbers(&rows[rows.len() / 2]);
        let size = largest.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        for (row, found) in rows.iter().zip(found) {
            for (&expected, &found) in numbers(row).iter().zip(found) {
                assert_close(key, expected, found, size);
            }
        }
    }
}

/// The correction vanishes for a parallelogram.
#[test]
fn the_patch_correction_leaves_a_parallelogram_alone() {
    let text = include_str!("../data/structures/mitc9_element.json");
    let reference: Value = serde_json::from_str(text).expect("JSON");
    let case = &reference["parallelogram"];
    let (shell, v) = (
        element(ShellKind::Mitc9, case),
        motion(&case["displacement"]),
    );
    let expected = motion(&case["linear"]["force"]);
    assert_forces("corrected", &expected, &force(&shell, &v, Terms::LINEAR));
}

/// Force and tangent have different formulas. The tangent times a motion is the derivative of the
/// force in its direction, for every choice of terms, on a curved and distorted element.
#[test]
fn the_tangent_is_the_derivative_of_the_force() {
    let all = [(1, false), (2, true)].into_iter();
    for (kind, (seed, drilling)) in all.flat_map(|own| KINDS.map(|kind| (kind, own))) {
        let mut numbers = Numbers::new(seed);
        let shell = distorted_element(kind, &mut numbers, drilling);
        let [at, v] = [0; 2].map(|_| random_motion(kind, &mut numbers));
        for terms in [PLAIN, PLAIN_VON_KARMAN, Terms::LINEAR, Terms::VON_KARMAN] {
            let dual = |x: &Vec3<f64>, d: &Vec3<f64>| Vec3::from_fn(|i, _| Dual::new(x[i], d[i]));
            let lifted = Shell {
                kind,
                geometry: Field {
                    points: shell.geometry.points.map(|x| x.map(Dual::from)),
                    directors: shell.geometry.directors.map(|x| x.map(Dual::from)),
                },
                thickness: shell.thickness.into(),
                material: shell.material.map(&mut Dual::from),
                surface_mass: shell.surface_mass.into(),
                drilling,
            };
            let moved = Motion {
                displacement: std::array::from_fn(|a| {
                    dual(&at.displacement[a], &v.displacement[a])
                }),
                rotation: std::array::from_fn(|a| dual(&at.rotation[a], &v.rotation[a])),
            };
            let mut force = Motion::zeros();
            lifted.add_energy_transpose(&moved, terms, &mut force, &mut ShellCotangent::zeros());
            let derivative = Motion {
                displacement: force.displacement.map(|x| x.map(|x| x.du)),
                rotation: force.rotation.map(|x| x.map(|x| x.du)),
            };
            let product = tangent_product(&shell, &at, terms, &v);
            assert_forces("tangent", &derivative, &product);
        }
    }
}

/// Six rigid motions have no strain energy, with any folds and distortions, and no other motion has none.
#[test]
fn rigid_motions_have_no_strain_energy() {
    for kind in KINDS {
        rigid_motions(&distorted_element(kind, &mut Numbers::new(7), true));
    }
}

fn rigid_motions(shell: &Shell<f64>) {
    let mut matrix = ElementMatrix::new();
    shell.tangent(
        &RotationAxes::global(),
        &Motion::zeros(),
        Terms::LINEAR,
        &mut matrix,
    );
    let stiffest = (0..matrix.order).fold(0.0_f64, |m, i| m.max(matrix.rows[i][i]));
    for direction in 0..6 {
        let unit = Vec3::from_fn(|i, _| f64::from(u8::from(i == direction % 3)));
        let mut v = Motion::zeros();
        for a in 0..NODES {
            if direction < 3 {
                v.displacement[a] = unit;
            } else {
                v.rotation[a] = unit;
                v.displacement[a] = unit.cross(&shell.geometry.points[a]);
            }
        }
        let force = force(shell, &v, Terms::LINEAR);
        for a in 0..NODES {
            assert!(force.displacement[a].amax() < 1e-12 * stiffest);
            assert!(force.rotation[a].amax() < 1e-12 * stiffest);
        }
    }
    // Displacements by the size of the element, so that both kinds of unknowns compare.
    let (order, size) = (matrix.order, 0.5);
    let unit = |i: usize| if i < order / 2 { size } else { 1.0 };
    let full = DMatrix::from_fn(order, order, |i, j| {
        matrix.rows[i.max(j)][i.min(j)] * unit(i) * unit(j)
    });
    let mut all: Vec<f64> = full.symmetric_eigenvalues().iter().copied().collect();
    all.sort_by(f64::total_cmp);
    let largest = all[order - 1];
    assert!(all[5].abs() < 1e-12 * largest, "{all:?}");
    assert!(all[6] > 1e-8 * largest, "{all:?}");
}
