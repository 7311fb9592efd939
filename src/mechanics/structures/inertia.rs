//! Inertia of a whole structure: kinetic energy, moments of the mass, lumped masses, damping.

use super::shell::{MassMoments, Motion, ShellCotangent};
use super::state::{Configuration, Cotangent, NodalMotion};
use crate::math::{Scalar, Vec3};

/// Adds the derivatives of `factor` times the kinetic energy: by the rates (the momenta) to
/// `momentum`, by the structure to `to`.
pub fn add_kinetic_energy_transpose<S: Scalar>(
    configuration: &Configuration<S>,
    rates: &NodalMotion<S>,
    factor: S,
    momentum: &mut NodalMotion<S>,
    to: &mut Cotangent<S>,
) {
    let topology = &configuration.structure.topology;
    for (index, element) in topology.mesh.shells.iter().enumerate() {
        let (mut p, mut bar) = (Motion::zeros(), ShellCotangent::zeros());
        let v = rates.of_element(element);
        configuration
            .shell(index)
            .add_kinetic_energy_transpose(&v, factor, &mut p, &mut bar);
        momentum.add_of_element_transpose(element, &p);
        configuration.add_shell_transpose(index, &bar, to);
    }
    configuration.add_beams_transpose(rates, momentum, to, |beam, v, p, bar| {
        beam.add_kinetic_energy_transpose(v, factor, p, bar);
    });
    let half = factor * 0.5;
    for (k, &node) in topology.mass_nodes.iter().enumerate() {
        let mass = &configuration.structure.masses[k];
        let (u, w) = (&rates.displacement[node], &rates.rotation[node]);
        momentum.displacement[node] += u * (mass.mass * factor);
        momentum.rotation[node] += mass.momentum(w) * factor;
        let bar = &mut to.structure.masses[k];
        bar.mass += u.dot(u) * half;
        for (bar, [i, j]) in bar.inertia.iter_mut().zip(super::shell::SECOND) {
            *bar += w[i] * w[j] * if i == j { half } else { factor };
        }
    }
}

/// Moments of the mass: of the middle surfaces of shells, the lines of centres of beams, and of lumped
/// masses with their inertia.
pub fn mass_moments<S: Scalar>(configuration: &Configuration<S>) -> MassMoments<S> {
    let structure = configuration.structure;
    let mut all = MassMoments::zeros();
    let shells = 0..structure.topology.mesh.shells.len();
    let shells = shells.map(|index| configuration.shell(index).mass_moments());
    let beams = configuration.beams();
    let beams = beams.map(|(index, _)| configuration.beam(index).mass_moments());
    for part in shells.chain(beams) {
        all.mass += part.mass;
        all.first += part.first;
        for (sum, x) in all.second.iter_mut().zip(part.second) {
            *sum += x;
        }
    }
    for (mass, &node) in structure.masses.iter().zip(&structure.topology.mass_nodes) {
        all.add(mass.mass, &structure.nodes[node]);
        // ∫ y yᵀ dm = ½ tr(J) 1 − J.
        let [xx, yy, zz, xy, yz, zx] = mass.inertia;
        let half = (xx + yy + zz) * 0.5;
        let own = [half - xx, half - yy, half - zz, -xy, -yz, -zx];
        for (sum, x) in all.second.iter_mut().zip(own) {
            *sum += x;
        }
    }
    all
}

/// Transpose of the derivative of [`mass_moments`].
pub fn add_mass_moments_transpose<S: Scalar>(
    configuration: &Configuration<S>,
    bar: &MassMoments<S>,
    to: &mut Cotangent<S>,
) {
    let structure = configuration.structure;
    for index in 0..structure.topology.mesh.shells.len() {
        let mut part = ShellCotangent::zeros();
        configuration
            .shell(index)
            .add_mass_moments_transpose(bar, &mut part);
        configuration.add_shell_transpose(index, &part, to);
    }
    for (index, _) in configuration.beams() {
        let beam = configuration.beam(index);
        let mut part = beam.zeros();
        beam.add_mass_moments_transpose(bar, &mut part);
        configuration.add_beam_transpose(index, &part, to);
    }
    for (k, &node) in structure.topology.mass_nodes.iter().enumerate() {
        let (by_mass, by_place) =
            bar.add_transpose(structure.masses[k].mass, &structure.nodes[node]);
        to.structure.masses[k].mass += by_mass;
        to.structure.nodes[node] += by_place;
        let half = (bar.second[0] + bar.second[1] + bar.second[2]) * 0.5;
        let inertia = &mut to.structure.masses[k].inertia;
        for (i, x) in inertia.iter_mut().enumerate() {
            *x += if i < 3 { half } else { S::zero() } - bar.second[i];
        }
    }
}

/// Inertia a·J b about the centre of mass: (a·b) tr S − a·S b with S = ∫ x xᵀ dm − f fᵀ/m, f = ∫ x dm.
pub fn inertia<S: Scalar>(moments: &MassMoments<S>, a: &Vec3<f64>, b: &Vec3<f64>) -> S {
    let (f, m) = (&moments.first, moments.mass);
    let [af, bf] = [a, b].map(|v| v.map(S::from).dot(f));
    let weights = inertia_weights(a, b);
    let terms = moments.second.iter().zip(weights);
    let second = terms.fold(S::zero(), |sum, (&x, w)| sum + x * w);
    second + (af * bf - f.dot(f) * a.dot(b)) / m
}

/// Derivatives of [`inertia`] by the moments.
pub fn inertia_transpose(
    moments: &MassMoments<f64>,
    a: &Vec3<f64>,
    b: &Vec3<f64>,
) -> MassMoments<f64> {
    let (f, m) = (&moments.first, moments.mass);
    let (af, bf, ab) = (a.dot(f), b.dot(f), a.dot(b));
    MassMoments {
        mass: (f.dot(f) * ab - af * bf) / (m * m),
        first: (a * bf + b * af - f * (2.0 * ab)) / m,
        second: inertia_weights(a, b),
    }
}

fn inertia_weights(a: &Vec3<f64>, b: &Vec3<f64>) -> [f64; 6] {
    let mut weights = second_weights(a, b).map(|w| -w);
    for w in &mut weights[..3] {
        *w += a.dot(b);
    }
    weights
}

/// Weights of the second moments (xx, yy, zz, xy, yz, zx) in ∫ (a·x)(b·x) dm.
pub fn second_weights(a: &Vec3<f64>, b: &Vec3<f64>) -> [f64; 6] {
    super::shell::SECOND.map(|[i, j]| {
        if i == j {
            a[i] * b[i]
        } else {
            a[i] * b[j] + a[j] * b[i]
        }
    })
}
