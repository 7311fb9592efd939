//! Every derivative of the beam element against the complex step, for all sections, on curved
//! elements with offsets. The transposes are checked by dot products.

use super::sample::{ALUMINIUM, Compared, Numbers, complex_step};
use flexbody_mathematics::math::{Complex64, Scalar, Vec3};
use flexbody_mechanics::structures::beam::{BEAM_NODES, Beam, BeamMotion, Section, SectionValues};
use flexbody_mechanics::structures::shell::{ElementMatrix, MassMoments};

fn sections() -> Vec<Section<f64>> {
    let rectangle = |width, height| Section::Rectangle { width, height };
    vec![
        rectangle(0.05, 0.12),
        rectangle(0.12, 0.05),
        rectangle(0.08, 0.08),
        Section::Tube {
            radius: 0.06,
            wall: 0.01,
        },
        Section::Tube {
            radius: 0.05,
            wall: 0.05,
        },
        Section::I {
            width: 0.1,
            height: 0.2,
            flange: 0.012,
            web: 0.008,
        },
        Section::Given(SectionValues {
            stiffness: [5e8, 1.1e8, 1.3e8, 4e5, 9e5, 3e5],
            inertia: [20.0, 0.03, 0.01],
        }),
    ]
}

fn beam(numbers: &mut Numbers, section: Section<f64>) -> Beam<f64> {
    let mut points = [0.0, 0.5, 1.0].map(|x| Vec3::new(x, 0.4 * x * x, 0.2 * x - 0.3 * x * x));
    for x in &mut points {
        *x += numbers.vector(0.03);
    }
    Beam {
        points,
        orientation: Vec3::new(0.2, -0.3, 1.0) + numbers.vector(0.1),
        section,
        offset: [0.07 + 0.01 * numbers.next(), -0.04],
        material: ALUMINIUM,
        line_mass: 3.0,
    }
}

fn motion(numbers: &mut Numbers) -> BeamMotion<f64> {
    BeamMotion {
        displacement: std::array::from_fn(|_| numbers.vector(0.02)),
        rotation: std::array::from_fn(|_| numbers.vector(0.05)),
    }
}

fn beam_numbers<S: Scalar>(beam: &Beam<S>) -> Vec<S> {
    let mut all = Vec::new();
    beam.map(|x| {
        all.push(x);
        x
    });
    all
}

/// Lengths of the ranges of equal units: nodes, orientation, each number of the section, offset,
/// material, mass.
fn kinds(beam: &Beam<f64>) -> Vec<usize> {
    let mut all = vec![3 * BEAM_NODES, 3];
    let _ = beam.section.map(&mut |_| all.push(1));
    all.extend([2, 1, 1, 1, 1, 1]);
    all
}

fn with_numbers(beam: &Beam<f64>, values: &[Complex64]) -> Beam<Complex64> {
    let mut next = values.iter().copied();
    beam.map(|_| next.next().expect("as many"))
}

fn motion_numbers<S: Scalar>(motion: &BeamMotion<S>) -> Vec<S> {
    let all = motion.displacement.iter().chain(&motion.rotation);
    all.flat_map(|v| [v.x, v.y, v.z]).collect()
}

fn motion_of<S: Scalar>(numbers: &[S]) -> BeamMotion<S> {
    let vector = |k: usize| Vec3::from_column_slice(&numbers[3 * k..3 * k + 3]);
    BeamMotion {
        displacement: std::array::from_fn(vector),
        rotation: std::array::from_fn(|a| vector(BEAM_NODES + a)),
    }
}

fn lift(motion: &BeamMotion<f64>) -> BeamMotion<Complex64> {
    let all: Vec<Complex64> = motion_numbers(motion)
        .into_iter()
        .map(Complex64::from)
        .collect();
    motion_of(&all)
}

/// Checks the derivatives in all numbers of the beam and of the motion.
fn check(
    name: &str,
    beam: &Beam<f64>,
    motion: &BeamMotion<f64>,
    value: impl Fn(&Beam<Complex64>, &BeamMotion<Complex64>) -> Complex64,
    transpose: impl Fn(&mut BeamMotion<f64>, &mut Beam<f64>),
) {
    let (mut force, mut to) = (BeamMotion::zeros(), beam.zeros());
    transpose(&mut force, &mut to);
    let (lifted, real_motion) = (beam.map(Complex64::from), lift(motion));
    let real = value(&lifted, &real_motion).re;
    let at = beam_numbers(beam);
    Compared {
        name,
        value: real,
        at: &at,
        exact: &complex_step(&at, |x| value(&with_numbers(beam, x), &real_motion)),
        found: &beam_numbers(&to),
        kinds: &kinds(beam),
    }
    .assert(1e-12);
    let at = motion_numbers(motion);
    Compared {
        name,
        value: real,
        at: &at,
        exact: &complex_step(&at, |x| value(&lifted, &motion_of(x))),
        found: &motion_numbers(&force),
        kinds: &[6 * BEAM_NODES],
    }
    .assert(1e-12);
}

#[test]
fn energies_masses_and_moments_of_all_sections_have_exact_derivatives() {
    for (seed, section) in sections().into_iter().enumerate() {
        let mut numbers = Numbers::new(60 + seed as u64);
        let (beam, motion) = (beam(&mut numbers, section), motion(&mut numbers));
        for von_karman in [false, true] {
            check(
                &format!("energy of {section:?}"),
                &beam,
                &motion,
                |beam, motion| beam.energy(motion, von_karman),
                |force, to| beam.add_energy_transpose(&motion, von_karman, force, to),
            );
        }
        check(
            &format!("kinetic energy of {section:?}"),
            &beam,
            &motion,
            |beam, motion| beam.kinetic_energy(motion) * 0.7,
            |force, to| beam.add_kinetic_energy_transpose(&motion, 0.7, force, to),
        );
        let bar = MassMoments {
            mass: numbers.next(),
            first: numbers.vector(1.0),
            second: std::array::from_fn(|_| numbers.next()),
        };
        check(
            &format!("moments of {section:?}"),
            &beam,
            &motion,
            |beam, _| {
                let found = beam.mass_moments();
                let first: Complex64 = (0..3).map(|i| found.first[i] * bar.first[i]).sum();
                let second: Complex64 = (0..6).map(|i| found.second[i] * bar.second[i]).sum();
                found.mass * bar.mass + first + second
            },
            |_, to| beam.add_mass_moments_transpose(&bar, to),
        );
    }
}

/// The tangent is the derivative of the force, the mass matrix that of the momenta.
#[test]
fn matrices_are_the_derivatives_of_forces_and_momenta() {
    for (seed, section) in sections().into_iter().enumerate() {
        let mut numbers = Numbers::new(80 + seed as u64);
        let (beam, motion) = (beam(&mut numbers, section), motion(&mut numbers));
        let lifted = beam.map(Complex64::from);
        let at = motion_numbers(&motion);
        let mut matrix = ElementMatrix::new();
        for which in ["linear", "von Karman", "mass"] {
            match which {
                "mass" => beam.mass_matrix(&mut matrix),
                _ => beam.tangent(&motion, which != "linear", &mut matrix),
            }
            assert_eq!(matrix.order, 6 * BEAM_NODES);
            for row in 0..matrix.order {
                let exact = complex_step(&at, |x| {
                    let (mut force, mut to) = (BeamMotion::zeros(), lifted.zeros());
                    let v = motion_of(x);
                    if which == "mass" {
                        let one = Complex64::from(1.0);
                        lifted.add_kinetic_energy_transpose(&v, one, &mut force, &mut to);
                    } else {
                        lifted.add_energy_transpose(&v, which != "linear", &mut force, &mut to);
                    }
                    motion_numbers(&force)[row]
                });
                let largest = (0..matrix.order).fold(0.0_f64, |m, k| m.max(matrix.rows[k][k]));
                for (column, exact) in exact.iter().enumerate().take(row + 1) {
                    let found = matrix.rows[row][column];
                    assert!(
                        (found - exact).abs() <= 1e-13 * largest,
                        "{which} of {section:?}: ({row}, {column}) {found} and {exact}"
                    );
                }
            }
        }
    }
}

/// Rigid motions of a curved beam with an offset cause no strain.
#[test]
fn rigid_motions_have_no_strain_energy() {
    let mut numbers = Numbers::new(90);
    for section in sections() {
        let beam = beam(&mut numbers, section);
        for _ in 0..4 {
            let (move_, turn) = (numbers.vector(1.0), numbers.vector(1.0));
            let rigid = BeamMotion {
                displacement: beam.points.map(|x| move_ + turn.cross(&x)),
                rotation: [turn; BEAM_NODES],
            };
            let other = motion(&mut numbers);
            let size = beam.energy(&other, false);
            assert!(
                beam.energy(&rigid, false).abs() < 1e-18 * size.max(1.0) * 1e6,
                "{section:?}"
            );
        }
    }
}

/// Torsion constants J / (long short³): Timoshenko & Goodier 1951, table of section 109. J is
/// symmetric in the sides and smooth at the square.
#[test]
fn torsion_constants_of_rectangles_are_those_of_the_table() {
    let constant = |width: f64, height: f64| {
        let unit = flexbody_mechanics::structures::material::Material {
            young: 2.0,
            poisson: 0.0,
            ..ALUMINIUM
        };
        Section::Rectangle { width, height }.values(&unit).stiffness[3]
    };
    let table = [
        (1.0, 0.1406),
        (1.2, 0.166),
        (1.5, 0.196),
        (2.0, 0.229),
        (2.5, 0.249),
        (3.0, 0.263),
        (4.0, 0.281),
        (5.0, 0.291),
        (10.0, 0.312),
        (1e4, 1.0 / 3.0),
    ];
    for (ratio, expected) in table {
        let found = constant(ratio, 1.0) / ratio;
        assert!(
            (found - expected).abs() < 1e-3 * expected.max(0.5),
            "{ratio}: {found}"
        );
        assert_eq!(constant(1.0, ratio), constant(ratio, 1.0));
    }
    let step = 1e-3;
    let line = [-1.5, -0.5, 0.5, 1.5].map(|k| constant(1.0, 1.0 + k * step));
    let third = line[3] - 3.0 * line[2] + 3.0 * line[1] - line[0];
    assert!(third.abs() < 10.0 * step * step * step, "{third}");
}
