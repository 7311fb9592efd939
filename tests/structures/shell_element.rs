//! One element against an independent prototype (tests/data/structures/mitc9_element.json: a
//! parallelogram and a curved element, without drilling and correction).

use super::sample::{Numbers, distorted_element, random_motion};
use flexbody_mathematics::math::{Dual, Vec3};
use flexbody_mechanics::structures::material::Material;
use flexbody_mechanics::structures::shell::{
    ElementMatrix, Field, Motion, NODES, RotationAxes, Shell, ShellCotangent, Terms,
};
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

fn vectors(value: &Value) -> [Vec3<f64>; NODES] {
    std::array::from_fn(|a| Vec3::from_column_slice(&numbers(&value[a])))
}

fn motion(value: &Value) -> Motion<f64> {
    let rows: Vec<Vec<f64>> = (0..NODES).map(|a| numbers(&value[a])).collect();
    Motion {
        displacement: std::array::from_fn(|a| Vec3::from_column_slice(&rows[a][..3])),
        rotation: std::array::from_fn(|a| Vec3::from_column_slice(&rows[a][3..])),
    }
}

fn element(case: &Value) -> Shell<f64> {
    let number = |name: &str| case[name].as_f64().expect("a number");
    Shell {
        geometry: Field {
            points: vectors(&case["nodes"]),
            directors: vectors(&case["directors"]),
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
    assert_eq!(matrix.order, 6 * NODES);
    let entry = |i: usize, j: usize| matrix.rows[i.max(j)][i.min(j)];
    let x = |k: usize| {
        let (list, k) = if k < 3 * NODES {
            (&v.displacement, k)
        } else {
            (&v.rotation, k - 3 * NODES)
        };
        list[k / 3][k % 3]
    };
    let row = |i: usize| (0..6 * NODES).map(|j| entry(i, j) * x(j)).sum::<f64>();
    Motion {
        displacement: std::array::from_fn(|a| Vec3::from_fn(|i, _| row(3 * a + i))),
        rotation: std::array::from_fn(|a| Vec3::from_fn(|i, _| row(3 * NODES + 3 * a + i))),
    }
}

#[test]
fn energies_forces_tangents_and_masses_are_those_of_the_reference() {
    let text = include_str!("../data/structures/mitc9_element.json");
    let reference: Value = serde_json::from_str(text).expect("JSON");
    for name in ["parallelogram", "curved"] {
        let case = &reference[name];
        let shell = element(case);
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
            for a in 0..NODES {
                let row = numbers(&case[key][a]);
                for b in 0..NODES {
                    let size = case[key][4][4].as_f64().expect("a number");
                    assert_close(key, row[b], found[a][b], size);
                }
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
    let (shell, v) = (element(case), motion(&case["displacement"]));
    let expected = motion(&case["linear"]["force"]);
    assert_forces("corrected", &expected, &force(&shell, &v, Terms::LINEAR));
}

/// Force and tangent have different formulas. The tangent times a motion is the derivative of the
/// force in its direction, for every choice of terms, on a curved and distorted element.
#[test]
fn the_tangent_is_the_derivative_of_the_force() {
    for (seed, drilling) in [(1, false), (2, true)] {
        let mut numbers = Numbers::new(seed);
        let shell = distorted_element(&mut numbers, drilling);
        let (at, v) = (random_motion(&mut numbers), random_motion(&mut numbers));
        for terms in [PLAIN, PLAIN_VON_KARMAN, Terms::LINEAR, Terms::VON_KARMAN] {
            let dual = |x: &Vec3<f64>, d: &Vec3<f64>| Vec3::from_fn(|i, _| Dual::new(x[i], d[i]));
            let lifted = Shell {
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

/// Six rigid motions have no strain energy, with any folds and distortions.
#[test]
fn rigid_motions_have_no_strain_energy() {
    let mut numbers = Numbers::new(7);
    let shell = distorted_element(&mut numbers, true);
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
        let force = force(&shell, &v, Terms::LINEAR);
        for a in 0..NODES {
            assert!(force.displacement[a].amax() < 1e-12 * stiffest);
            assert!(force.rotation[a].amax() < 1e-12 * stiffest);
        }
    }
}
