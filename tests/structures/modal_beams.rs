//! Beams by assumed modes against closed forms: frequencies, inertia, statics, rotating beams, bending without
//! stretch, and the derivatives of all their numbers.

use super::sample::{ALUMINIUM, Numbers};
use flexbody_mathematics::math::{Complex64, Dual, Mat3, Scalar, Vec3};
use flexbody_mechanics::model::flexible::Quadratic;
use flexbody_mechanics::structures::beam::{Section, SectionValues};
use flexbody_mechanics::structures::modal::frequencies::{Held, frequencies};
use flexbody_mechanics::structures::modal::sections::SectionForce;
use flexbody_mechanics::structures::modal::{
    BeamDamping, BeamFrame, BeamModes, BendingFunctions, FlexibleBeam, ModalNumbers, StrainMeasure,
};
use nalgebra::{DMatrix, DVector};

const PI: f64 = std::f64::consts::PI;

fn beam<S: Scalar>(section: Section<S>, length: S, bending: [usize; 2]) -> FlexibleBeam<S> {
    FlexibleBeam {
        length,
        section,
        material: ALUMINIUM.map(&mut |x| S::from(x)),
        frame: BeamFrame::Chord,
        functions: BendingFunctions::Polynomial,
        modes: BeamModes {
            bending,
            torsion: 4,
            stretch: BeamModes::companions(bending, 4),
        },
        strain: StrainMeasure::VonKarman,
        shear: true,
        damping: BeamDamping {
            ratios: [S::from(0.01); 3],
            mass: S::zero(),
            viscosity: None,
        },
    }
}

fn given(stiffness: [f64; 6], inertia: [f64; 3]) -> Section<f64> {
    Section::Given(SectionValues { stiffness, inertia })
}

/// βL of cantilever, free–free and hinged beams.
const ROOTS: [[f64; 3]; 3] = [
    [1.875104068711961, 4.694091132974174, 7.854757438237613],
    [4.730040744862704, 7.853204624095838, 10.995607838001671],
    [PI, 2.0 * PI, 3.0 * PI],
];

/// f = (βL)² √(EI/ρA) / 2πL², Euler and Bernoulli's beam without rotary inertia.
#[test]
fn slender_beams_have_the_frequencies_of_the_closed_forms() {
    let mut numbers = Numbers::new(5);
    for _ in 0..4 {
        let mut random = || numbers.next().exp();
        let (length, ei, rho) = (random() * 3.0, [random() * 50.0, random() * 50.0], random());
        let ea = 1e4 * (ei[0] + ei[1]) / (length * length);
        // A rigid motion about the line needs some inertia; rotary inertia stays below the tolerance.
        let rotary = 1e-11 * rho * length * length;
        let section = given(
            [ea, 1.0, 1.0, random(), ei[0], ei[1]],
            [rho, rotary, rotary],
        );
        for (kind, roots) in ROOTS.iter().enumerate() {
            let mut body = beam(section, length, [12, 12]);
            body.shear = false;
            body.modes.torsion = 0;
            body.frame = if kind == 0 {
                BeamFrame::Clamped
            } else {
                BeamFrame::Chord
            };
            let held = if kind == 1 { Held::Nothing } else { Held::Axes };
            let found = frequencies(&body.numbers(), held).expect("stiff");
            for (root, ei) in roots.iter().flat_map(|r| ei.map(|ei| (r, ei))) {
                let exact = (root / length).powi(2) * (ei / rho).sqrt() / (2.0 * PI);
                let off = |f: &f64| (f / exact - 1.0).abs();
                let nearest = found.iter().map(off).fold(f64::INFINITY, f64::min);
                assert!(nearest < 1e-7, "{kind} {root}: {nearest:e}");
            }
            // Stretch: a bar with a fixed start, or free.
            let step = if kind == 1 { 1.0 } else { 0.5 };
            let exact = step * (ea / rho).sqrt() / (2.0 * length);
            let off = |f: &f64| (f / exact - 1.0).abs();
            let nearest = found.iter().map(off).fold(f64::INFINITY, f64::min);
            assert!(nearest < 1e-9, "stretch {kind}: {nearest:e}");
        }
    }
}

#[test]
fn a_free_beam_has_the_same_frequencies_in_both_frames() {
    let section = Section::Rectangle {
        width: 0.1,
        height: 0.06,
    };
    let mut body = beam(section, 1.3, [6, 6]);
    let chord = frequencies(&body.numbers(), Held::Nothing).expect("stiff");
    body.frame = BeamFrame::Clamped;
    let clamped = frequencies(&body.numbers(), Held::Nothing).expect("stiff");
    for (a, b) in chord.iter().zip(&clamped) {
        assert!((a / b - 1.0).abs() < 1e-9, "{a} {b}");
    }
    // Torsion of a free bar: the polar moment and GJ, f = ½ √(GJ / ρI) / L.
    let values = body.values();
    let exact = 0.5 * (values.stiffness[3] / (values.inertia[1] + values.inertia[2])).sqrt() / 1.3;
    let off = chord
        .iter()
        .map(|f| (f / exact - 1.0).abs())
        .fold(1.0, f64::min);
    assert!(off < 1e-3, "{off:e}");
}

/// Stocky beams on hinges: Timoshenko's equation with w = sin kπξ, ρI ρA/GA λ² − (ρA + a²(ρI + ρA EI/GA)) λ +
/// EI a⁴ = 0, a = kπ/L.
#[test]
fn stocky_beams_have_the_frequencies_of_timoshenko() {
    for slenderness in [5.0, 10.0, 30.0] {
        let section = Section::Rectangle {
            width: 0.1,
            height: 0.1,
        };
        let length = 0.1 * slenderness;
        let found =
            frequencies(&beam(section, length, [12, 0]).numbers(), Held::Axes).expect("stiff");
        let SectionValues {
            stiffness: [_, ga, _, _, _, ei],
            inertia: [m, _, r],
        } = section.values(&ALUMINIUM);
        // Half waves of five heights and more: shear follows the moment as at rest.
        for k in (1..4).filter(|&k| slenderness >= 5.0 * f64::from(k)) {
            let a2 = (f64::from(k) * PI / length).powi(2);
            let (square, linear, constant) = (r * m / ga, m + a2 * (r + m * ei / ga), ei * a2 * a2);
            let root = (linear * linear - 4.0 * square * constant).sqrt();
            let exact = (2.0 * constant / (linear + root)).sqrt() / (2.0 * PI);
            let nearest = found
                .iter()
                .map(|f| (f / exact - 1.0).abs())
                .fold(1.0, f64::min);
            assert!(
                nearest < 1e-4,
                "slenderness {slenderness}, mode {k}: {nearest:e}"
            );
        }
    }
}

#[test]
fn a_beam_at_rest_has_the_mass_and_inertia_of_a_box() {
    let (l, b, h) = (1.7, 0.13, 0.31);
    let body = beam(
        Section::Rectangle {
            width: h,
            height: b,
        },
        l,
        [3, 3],
    )
    .numbers();
    let mass = ALUMINIUM.density * l * b * h;
    let about = |x: f64, y: f64| mass / 12.0 * (x * x + y * y);
    let end = mass * l * l / 4.0;
    let inertia = Mat3::from_diagonal(&Vec3::new(
        about(b, h),
        about(l, h) + end,
        about(l, b) + end,
    ));
    assert!((body.mass / mass - 1.0).abs() < 1e-14);
    assert!((body.shapes.centre / mass - Vec3::new(l / 2.0, 0.0, 0.0)).norm() < 1e-14);
    assert!((body.inertia - inertia).norm() < 1e-13 * inertia.norm());
}

/// Momentum, angular momentum and energy of a field of velocities are those of the sum over thin slices.
#[test]
fn integrals_of_the_shapes_are_sums_over_slices() {
    let section = Section::I {
        width: 0.2,
        height: 0.3,
        flange: 0.02,
        web: 0.01,
    };
    for frame in [BeamFrame::Chord, BeamFrame::Clamped] {
        for functions in [BendingFunctions::Polynomial, BendingFunctions::Sine] {
            let mut body = beam(section, 2.0, [3, 2]);
            (body.frame, body.functions) = (frame, functions);
            let numbers = body.numbers();
            let m = numbers.modes();
            let [line, i2, i3] = body.values().inertia;
            let slices = 20_000;
            let mut sums = (
                vec![Vec3::zeros(); m],
                vec![Mat3::zeros(); m],
                DMatrix::zeros(m, m),
            );
            for slice in 0..slices {
                let xi = (slice as f64 + 0.5) / slices as f64;
                let dm = line * 2.0 / slices as f64;
                // Four points stand for the section: at ± the radii of gyration.
                let (y, z) = ((2.0 * i3 / line).sqrt(), (2.0 * i2 / line).sqrt());
                for offset in [[y, 0.0], [-y, 0.0], [0.0, z], [0.0, -z]] {
                    let point = body.point(xi, offset);
                    for (i, n) in point.displacement.iter().enumerate() {
                        sums.0[i] += n * (dm * 0.25);
                        sums.1[i] += point.position * n.transpose() * (dm * 0.25);
                        for (j, other) in point.displacement.iter().enumerate() {
                            sums.2[(i, j)] += n.dot(other) * (dm * 0.25);
                        }
                    }
                }
            }
            let mass = DMatrix::from_row_slice(m, m, &numbers.elastic_mass());
            assert!((mass.clone() - sums.2).norm() < 1e-6 * mass.norm());
            for i in 0..m {
                let static_moment = numbers.shapes.static_moments[i];
                let second = numbers.shapes.with_position[i];
                assert!(
                    (static_moment - sums.0[i]).norm() < 1e-6 * numbers.mass,
                    "{i}"
                );
                assert!((second - sums.1[i]).norm() < 1e-6 * numbers.mass, "{i}");
            }
        }
    }
}

/// Coordinates at rest under dead forces: K q = f.
fn at_rest(numbers: &ModalNumbers<f64>, force: &[f64]) -> DVector<f64> {
    let m = numbers.modes();
    let stiffness = DMatrix::from_row_slice(m, m, &numbers.linear_stiffness());
    let solved = stiffness.cholesky().expect("stiff");
    solved.solve(&DVector::from_column_slice(force))
}

#[test]
fn cantilevers_bend_shear_twist_and_stretch_as_timoshenko_says() {
    let sections = [
        Section::Rectangle {
            width: 0.1,
            height: 0.2,
        },
        Section::Tube {
            radius: 0.1,
            wall: 0.02,
        },
        Section::I {
            width: 0.2,
            height: 0.3,
            flange: 0.02,
            web: 0.01,
        },
    ];
    for (length, section) in [0.5, 3.0]
        .into_iter()
        .flat_map(|l| sections.map(|s| (l, s)))
    {
        let mut body = beam(section, length, [3, 3]);
        body.frame = BeamFrame::Clamped;
        let numbers = body.numbers();
        let tip = body.point(1.0, [0.0, 0.0]);
        let (force, moment) = (Vec3::new(3.0, -2.0, 5.0), Vec3::new(7.0, 0.0, 0.0));
        let work: Vec<f64> = (tip.displacement.iter().zip(&tip.rotation))
            .map(|(n, turn)| n.dot(&force) + turn.dot(&moment))
            .collect();
        let q = at_rest(&numbers, &work);
        let moved: Vec3<f64> = tip.displacement.iter().zip(&q).map(|(n, &q)| n * q).sum();
        let turned: Vec3<f64> = tip.rotation.iter().zip(&q).map(|(n, &q)| n * q).sum();
        let [ea, ga2, ga3, gj, ei2, ei3] = body.values().stiffness;
        let (l, cube) = (length, length.powi(3) / 3.0);
        let exact = Vec3::new(
            force.x * l / ea,
            force.y * (cube / ei3 + l / ga2),
            force.z * (cube / ei2 + l / ga3),
        );
        let angles = Vec3::new(
            moment.x * l / gj,
            -force.z * l * l / (2.0 * ei2),
            force.y * l * l / (2.0 * ei3),
        );
        for k in 0..3 {
            assert!((moved[k] / exact[k] - 1.0).abs() < 1e-11, "{section:?} {k}");
            assert!(
                (turned[k] / angles[k] - 1.0).abs() < 1e-11,
                "{section:?} {k}"
            );
        }
        // Section forces and the stress at a corner, linear in small forces.
        let at = |form: Quadratic<f64>| form.linear.iter().zip(&q).map(|(b, q)| b * q).sum::<f64>();
        for xi in [0.0, 0.3, 1.0] {
            let arm = l * (1.0 - xi);
            for (kind, exact) in [
                (SectionForce::Axial, force.x),
                (SectionForce::ShearY, force.y),
                (SectionForce::ShearZ, force.z),
                (SectionForce::Torsion, moment.x),
                (SectionForce::BendingY, -force.z * arm),
                (SectionForce::BendingZ, force.y * arm),
            ] {
                let found = at(body.section_force(kind, xi));
                assert!(
                    (found - exact).abs() < 1e-10 * (1.0 + l),
                    "{kind:?} at {xi}: {found}"
                );
            }
            let [y, z] = body.half_sizes().expect("a size");
            let e = ALUMINIUM.young;
            let exact =
                force.x / (ea / e) - force.y * arm * y / (ei3 / e) - force.z * arm * z / (ei2 / e);
            let found = at(body.fibre_stress(xi, [y, z]));
            assert!((found / exact - 1.0).abs() < 1e-9, "{section:?} at {xi}");
        }
    }
}

/// A bent beam shortens by ½∫w'² and stays free of strain; with fewer functions of stretch it does not.
#[test]
fn companions_let_a_bent_beam_shorten_without_strain() {
    let mut random = Numbers::new(3);
    let section = Section::Rectangle {
        width: 0.02,
        height: 0.03,
    };
    for frame in [BeamFrame::Chord, BeamFrame::Clamped] {
        for bending in [[1, 0], [2, 2], [4, 3], [6, 6]] {
            for missing in [0, 1] {
                let mut body = beam(section, 1.5, bending);
                body.frame = frame;
                body.modes.torsion = 0;
                body.modes.stretch = BeamModes::companions(bending, 0) - missing;
                let numbers = body.numbers();
                let bent: Vec<f64> = (0..bending[0] + bending[1])
                    .map(|_| 0.1 * random.next())
                    .collect();
                let (strained, shortened) = least_strain(&body, &numbers, &bent);
                if missing == 1 {
                    assert!(strained > 1e-6, "{bending:?} does not lock: {strained:e}");
                    continue;
                }
                assert!(strained < 1e-13, "{frame:?} {bending:?}: {strained:e}");
                let slices = 4000;
                let exact: f64 = (0..slices)
                    .map(|k| {
                        let step = 1e-6;
                        let xi = (f64::from(k) + 0.5) / f64::from(slices);
                        let [a, b] = [xi - step, xi + step].map(|xi| {
                            let shapes = body.point(xi, [0.0, 0.0]).displacement;
                            shapes
                                .iter()
                                .zip(&bent)
                                .map(|(n, &q)| n * q)
                                .sum::<Vec3<f64>>()
                        });
                        let slope = (b - a) / (2.0 * step * body.length);
                        -0.5 * slope.norm_squared() * body.length / f64::from(slices)
                    })
                    .sum();
                assert!(
                    (shortened / exact - 1.0).abs() < 1e-4,
                    "{shortened} {exact}"
                );
            }
        }
    }
}

/// The least Σ k e² over the stretch, as a part of that without stretch, and the end's displacement there.
fn least_strain(body: &FlexibleBeam<f64>, numbers: &ModalNumbers<f64>, bent: &[f64]) -> (f64, f64) {
    let (m, stretch) = (numbers.modes(), body.modes.stretch);
    let mut q = bent.to_vec();
    q.resize(m, 0.0);
    let strains = &numbers.stiffness.strains;
    let rows = DMatrix::from_fn(strains.len(), stretch, |p, k| {
        strains[p].weight.sqrt() * strains[p].strain.linear[m - stretch + k]
    });
    let right = DVector::from_fn(strains.len(), |p, _| {
        -strains[p].weight.sqrt() * strains[p].strain.value(&q)
    });
    let found = rows
        .clone()
        .svd(true, true)
        .solve(&right, 1e-12)
        .expect("factors");
    let rest = (rows * &found - &right).norm_squared() / right.norm_squared();
    let end = body.point(1.0, [0.0, 0.0]).displacement;
    let shortened = found
        .iter()
        .zip(&end[m - stretch..])
        .map(|(q, n)| q * n.x)
        .sum();
    (rest, shortened)
}

/// Wright, Smith, Thresher & Wang 1982 (J. Appl. Mech. 49:197), table 1: the first frequency of a cantilever
/// that turns about an axis through its root, out of its plane of rotation, in √(EI / ρA L⁴), at speeds 0 … 12.
const ROTATING: [(f64, f64); 6] = [
    (0.0, 3.5160),
    (1.0, 3.6816),
    (3.0, 4.7973),
    (5.0, 6.4495),
    (8.0, 9.2568),
    (12.0, 13.1702),
];

/// Frequencies of small vibrations about the steady rotation with speed Ω about the body's axis `axis`.
fn spinning(numbers: &ModalNumbers<f64>, speed: f64, axis: usize) -> Vec<f64> {
    let m = numbers.modes();
    let mut omega = Vec3::zeros();
    omega[axis] = speed;
    let cross = omega.cross_matrix();
    let centrifugal = cross * cross;
    let second = |i: usize, j: usize| {
        let (at, turned) = numbers.shapes.place(i, j);
        let s = numbers.shapes.products[at];
        if turned { s.transpose() } else { s }
    };
    let along = |i: usize, j: usize| (centrifugal * second(i, j).transpose()).trace();
    let pull = DVector::from_fn(m, |i, _| {
        (centrifugal * numbers.shapes.with_position[i]).trace()
    });
    let spin = DMatrix::from_fn(m, m, along);
    let mut q = DVector::zeros(m);
    let mut tangent = DMatrix::zeros(m, m);
    for _ in 0..20 {
        let mut force = &pull + &spin * &q;
        let linear = DMatrix::from_row_slice(m, m, &numbers.stiffness.linear);
        force += &linear * &q;
        tangent = linear + &spin;
        for strain in &numbers.stiffness.strains {
            let e = strain.strain.value(q.as_slice());
            let mut row = vec![0.0; m];
            strain.strain.add_gradient(q.as_slice(), 1.0, &mut row);
            let row = DVector::from_vec(row);
            force += &row * (strain.weight * e);
            tangent += &row * row.transpose() * strain.weight;
            for (c, g) in &strain.strain.squares {
                let g = DVector::from_column_slice(g);
                tangent += &g * g.transpose() * (strain.weight * e * c);
            }
        }
        q -= tangent.clone().lu().solve(&force).expect("regular");
    }
    let mass = DMatrix::from_row_slice(m, m, &numbers.elastic_mass());
    let coriolis = DMatrix::from_fn(m, m, |i, j| 2.0 * (cross * second(j, i)).trace());
    let inverse = mass.try_inverse().expect("regular");
    let mut state = DMatrix::zeros(2 * m, 2 * m);
    state.view_mut((0, m), (m, m)).fill_with_identity();
    state
        .view_mut((m, 0), (m, m))
        .copy_from(&(-&inverse * tangent));
    state
        .view_mut((m, m), (m, m))
        .copy_from(&(-&inverse * coriolis));
    let values = state.complex_eigenvalues();
    let mut all: Vec<f64> = values.iter().filter(|x| x.im > 0.0).map(|x| x.im).collect();
    all.sort_by(f64::total_cmp);
    all
}

#[test]
fn a_rotating_beam_stiffens_as_the_theory_says() {
    let section = given([1e7, 1.0, 1.0, 1.0, 1.0, 1.0], [1.0, 0.0, 0.0]);
    for (speed, exact) in ROTATING {
        for (plane, axis) in [([0, 6], 2), ([6, 0], 2)] {
            let mut body = beam(section, 1.0, plane);
            (body.frame, body.shear, body.modes.torsion) = (BeamFrame::Clamped, false, 0);
            let first = spinning(&body.numbers(), speed, axis)[0];
            // In the plane of rotation the square is less by that of the speed (Southwell).
            let found = match plane {
                [0, _] => first,
                _ => first.hypot(speed),
            };
            assert!(
                (found / exact - 1.0).abs() < 6e-5,
                "{speed} {plane:?}: {found} {exact}"
            );
        }
    }
    // Without von Karman's terms the beam softens instead and gives way at Ω = 3.516.
    let mut body = beam(section, 1.0, [4, 0]);
    (body.frame, body.shear, body.modes.torsion) = (BeamFrame::Clamped, false, 0);
    body.strain = StrainMeasure::Linear;
    let softened = spinning(&body.numbers(), 3.0, 2)[0];
    assert!((softened / (3.5160f64.powi(2) - 9.0).sqrt() - 1.0).abs() < 1e-3);
    assert!(
        spinning(&body.numbers(), 4.0, 2)[0] > 10.0,
        "the first mode is no vibration"
    );
}

/// All numbers of a body, in groups of one size.
fn all<S: Scalar>(body: &FlexibleBeam<S>, station: S) -> Vec<Vec<S>> {
    let numbers = body.numbers();
    let shapes = &numbers.shapes;
    let vectors = |v: &[Vec3<S>]| v.iter().flatten().copied().collect::<Vec<S>>();
    let matrices = |v: &[Mat3<S>]| v.iter().flatten().copied().collect::<Vec<S>>();
    let point = body.point(station, [S::from(0.01), S::from(-0.02)]);
    let mut groups = vec![
        vec![numbers.mass],
        numbers.inertia.iter().copied().collect(),
        vectors(&[shapes.centre]),
        vectors(&shapes.static_moments),
        matrices(&shapes.with_position),
        matrices(&shapes.products),
        vectors(&[point.position]),
        vectors(&point.displacement),
        vectors(&point.rotation),
        numbers.stiffness.linear,
    ];
    // The kinds of modes have their own sizes of damping.
    let m = body.modes.count();
    for range in body.modes.ranges() {
        let rows = range
            .clone()
            .flat_map(|i| range.clone().map(move |j| i * m + j));
        groups.push(rows.map(|at| numbers.damping[at]).collect());
    }
    let mut forms: Vec<Quadratic<S>> = Vec::new();
    for strain in numbers.stiffness.strains {
        groups.push(vec![strain.weight]);
        forms.push(strain.strain);
    }
    forms.push(body.section_force(SectionForce::Axial, station));
    forms.push(body.section_force(SectionForce::ShearZ, station));
    if let Some(half) = body.half_sizes() {
        forms.push(body.fibre_stress(station, half));
    }
    for form in forms {
        groups.push(form.linear);
        for (c, g) in form.squares {
            groups.push(vec![c]);
            groups.push(g);
        }
    }
    groups
}

/// The body with its parameters as given.
fn parametrised<S: Scalar>(p: &[S], section: usize, rayleigh: bool) -> (FlexibleBeam<S>, S) {
    let section = match section {
        0 => Section::Rectangle {
            width: p[0],
            height: p[1],
        },
        1 => Section::Tube {
            radius: p[0],
            wall: p[1] * 0.1,
        },
        _ => Section::I {
            width: p[0],
            height: p[1],
            flange: p[0] * 0.2,
            web: p[1] * 0.1,
        },
    };
    let mut body = beam(section, p[2], [3, 2]);
    (
        body.material.young,
        body.material.density,
        body.material.poisson,
    ) = (p[3], p[4], p[5]);
    match rayleigh {
        true => {
            (body.damping.mass, body.damping.viscosity) = (p[6], Some(p[7] * 1e-4));
        }
        false => body.damping.ratios = [p[6], p[7], p[6]],
    }
    (body, p[8])
}

#[test]
fn every_number_has_the_derivative_of_the_complex_step_and_of_differences() {
    let at = [0.1, 0.13, 1.7, 3e10, 2700.0, 0.3, 0.02, 0.03, 0.41];
    for section in 0..3 {
        for rayleigh in [false, true] {
            for frame in [BeamFrame::Chord, BeamFrame::Clamped] {
                for i in 0..at.len() {
                    let dual: Vec<Dual> = (0..at.len())
                        .map(|k| Dual::new(at[k], if k == i { at[k] } else { 0.0 }))
                        .collect();
                    let complex: Vec<Complex64> = (dual.iter())
                        .map(|x| Complex64::new(x.re, x.du * 1e-30))
                        .collect();
                    let moved = |by: f64| {
                        let mut p = at;
                        p[i] *= 1.0 + by;
                        let (mut body, station) = parametrised(&p, section, rayleigh);
                        body.frame = frame;
                        all(&body, station)
                    };
                    let step = 2e-3;
                    let far: Vec<Vec<Vec<f64>>> =
                        [-2.0, -1.0, 1.0, 2.0].map(|k| moved(k * step)).into();
                    let (mut body, station) = parametrised(&dual, section, rayleigh);
                    body.frame = frame;
                    let dual = all(&body, station);
                    let (mut body, station) = parametrised(&complex, section, rayleigh);
                    body.frame = frame;
                    let complex = all(&body, station);
                    for (group, (d, c)) in dual.iter().zip(&complex).enumerate() {
                        let size = |x: &Dual| x.re.abs() + x.du.abs();
                        let scale = d.iter().map(size).fold(0.0, f64::max);
                        for (k, (d, c)) in d.iter().zip(c).enumerate() {
                            let off = (d.du - c.im * 1e30).abs();
                            assert!(off <= 1e-13 * scale, "{i} {group} {k}: {off:e} {scale:e}");
                            let [a, b, c, e] = [0, 1, 2, 3].map(|at| far[at][group][k]);
                            let slope = (a - e + 8.0 * (c - b)) / (12.0 * step);
                            let off = (d.du - slope).abs();
                            assert!(off <= 1e-7 * scale, "{i} {group} {k}: {off:e} {scale:e}");
                        }
                    }
                }
            }
        }
    }
}
