//! Every derivative of the shell element against the complex step, on curved, distorted elements.

use super::sample::{
    Compared, KINDS, Numbers, complex_step, distorted_element, motion_numbers, motion_of,
    random_motion, shell_numbers, shell_of,
};
use flexbody_mathematics::math::{Complex64, Dual, Scalar};
use flexbody_mechanics::structures::shell::{
    MassMoments, Motion, NODES, STRESS_POINTS, Shell, ShellCotangent, ShellKind, Terms,
};

const TERMS: [Terms; 3] = [
    Terms::LINEAR,
    Terms::VON_KARMAN,
    Terms {
        von_karman: true,
        patch_correction: false,
    },
];

/// Lengths of ranges of equal units in the numbers of an element: geometry, h, μ, E, ν, ρ, yield
/// stress.
const SHELL_KINDS: [usize; 7] = [6 * NODES, 1, 1, 1, 1, 1, 1];

fn cotangent_numbers<S: Scalar>(cotangent: &ShellCotangent<S>) -> Vec<S> {
    shell_numbers(&Shell {
        kind: ShellKind::default(),
        geometry: cotangent.geometry,
        thickness: cotangent.thickness,
        material: cotangent.material,
        surface_mass: cotangent.surface_mass,
        drilling: false,
    })
}

/// Checks the derivatives in all numbers of the element and of the motion.
fn check(
    name: &str,
    shell: &Shell<f64>,
    motion: &Motion<f64>,
    value: impl Fn(&Shell<Complex64>, &Motion<Complex64>) -> Complex64,
    transpose: impl Fn(&mut Motion<f64>, &mut ShellCotangent<f64>),
) {
    let (mut force, mut cotangent) = (Motion::zeros(), ShellCotangent::zeros());
    transpose(&mut force, &mut cotangent);
    let fixed = motion_of(
        &motion_numbers(motion)
            .into_iter()
            .map(Complex64::from)
            .collect::<Vec<_>>(),
    );
    let exact = complex_step(&shell_numbers(shell), |x| {
        value(&shell_of(shell.kind, x, shell.drilling), &fixed)
    });
    let real = value(
        &shell_of(
            shell.kind,
            &shell_numbers(shell)
                .into_iter()
                .map(Complex64::from)
                .collect::<Vec<_>>(),
            shell.drilling,
        ),
        &fixed,
    )
    .re;
    Compared {
        name,
        value: real,
        at: &shell_numbers(shell),
        exact: &exact,
        found: &cotangent_numbers(&cotangent),
        kinds: &SHELL_KINDS,
    }
    .assert(1e-12);
    let lifted: Vec<Complex64> = shell_numbers(shell)
        .into_iter()
        .map(Complex64::from)
        .collect();
    let lifted = shell_of(shell.kind, &lifted, shell.drilling);
    let exact = complex_step(&motion_numbers(motion), |x| value(&lifted, &motion_of(x)));
    let found = motion_numbers(&force);
    Compared {
        name,
        value: real,
        at: &motion_numbers(motion),
        exact: &exact,
        found: &found,
        kinds: &[6 * NODES],
    }
    .assert(1e-12);
}

#[test]
fn energies_stresses_and_masses_have_exact_derivatives() {
    let all = [(3, false), (4, true)].into_iter();
    for (kind, (seed, drilling)) in all.flat_map(|own| KINDS.map(|kind| (kind, own))) {
        let mut numbers = Numbers::new(seed);
        let shell = distorted_element(kind, &mut numbers, drilling);
        let motion = random_motion(kind, &mut numbers);
        for terms in TERMS {
            check(
                "energy",
                &shell,
                &motion,
                |shell, motion| shell.energy(motion, terms).total(),
                |force, to| shell.add_energy_transpose(&motion, terms, force, to),
            );
            let weights: [f64; STRESS_POINTS] = std::array::from_fn(|_| numbers.next());
            check(
                "stress",
                &shell,
                &motion,
                |shell, motion| {
                    let ratios = shell.stress_ratios(motion, terms);
                    let sum = |sum, (&r, &w)| sum + r * w;
                    ratios.iter().zip(&weights).fold(Complex64::from(0.0), sum)
                },
                |force, to| {
                    shell.add_stress_ratios_transpose(&motion, terms, &weights, force, to);
                },
            );
        }
        check(
            "kinetic energy",
            &shell,
            &motion,
            |shell, motion| shell.kinetic_energy(motion) * 0.7,
            |force, to| shell.add_kinetic_energy_transpose(&motion, 0.7, force, to),
        );
        let bar = MassMoments {
            mass: numbers.next(),
            first: numbers.vector(1.0),
            second: std::array::from_fn(|_| numbers.next()),
        };
        check(
            "moments",
            &shell,
            &motion,
            |shell, _| {
                let found = shell.mass_moments();
                let first: Complex64 = (0..3).map(|i| found.first[i] * bar.first[i]).sum();
                let second: Complex64 = (0..6).map(|i| found.second[i] * bar.second[i]).sum();
                found.mass * bar.mass + first + second
            },
            |_, to| shell.add_mass_moments_transpose(&bar, to),
        );
    }
}

/// The products for an adjoint, ψ·∂f/∂p for every number p of the element, are the infinitesimal
/// parts of the derivatives of the energy at v + ε ψ.
#[test]
fn dual_motions_give_the_derivatives_of_the_force_times_an_adjoint() {
    for (kind, terms) in KINDS
        .into_iter()
        .flat_map(|kind| TERMS.map(|terms| (kind, terms)))
    {
        let mut numbers = Numbers::new(5);
        let shell = distorted_element(kind, &mut numbers, true);
        let [motion, adjoint] = [0; 2].map(|_| random_motion(kind, &mut numbers));
        let dual: Vec<Dual> = motion_numbers(&motion)
            .into_iter()
            .zip(motion_numbers(&adjoint))
            .map(|(v, psi)| Dual::new(v, psi))
            .collect();
        let lifted: Vec<Dual> = shell_numbers(&shell).into_iter().map(Dual::from).collect();
        let mut to = ShellCotangent::zeros();
        shell_of(kind, &lifted, true).add_energy_transpose(
            &motion_of(&dual),
            terms,
            &mut Motion::zeros(),
            &mut to,
        );
        let found: Vec<f64> = cotangent_numbers(&to).iter().map(|x| x.du).collect();
        let exact = complex_step(&shell_numbers(&shell), |x| {
            let at: Vec<Complex64> = motion_numbers(&motion)
                .into_iter()
                .map(Complex64::from)
                .collect();
            let mut force = Motion::zeros();
            let to = &mut ShellCotangent::zeros();
            shell_of(kind, x, true).add_energy_transpose(&motion_of(&at), terms, &mut force, to);
            let force = motion_numbers(&force);
            force
                .iter()
                .zip(motion_numbers(&adjoint))
                .map(|(&f, psi)| f * psi)
                .sum()
        });
        Compared {
            name: "adjoint product",
            value: 0.0,
            at: &shell_numbers(&shell),
            exact: &exact,
            found: &found,
            kinds: &SHELL_KINDS,
        }
        .assert(1e-12);
    }
}
