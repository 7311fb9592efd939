//! Inertia of a whole structure: kinetic energy, moments of the mass, lumped masses, damping.

use super::shell::{MassMoments, Motion, ShellCotangent};
use super::state::{Configuration, Cotangent, NodalMotion};
use crate::math::Scalar;

/// Adds the derivatives of `factor` times the kinetic energy: by the rates (the momenta) to
/// `momentum`, by the structure to `to`.
pub(crate) fn add_kinetic_energy_transpose<S: Scalar>(
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
/// masses as points.
pub(crate) fn mass_moments<S: Scalar>(configuration: &Configuration<S>) -> MassMoments<S> {
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
    }
    all
}

/// Transpose of the derivative of [`mass_moments`].
pub(crate) fn add_mass_moments_transpose<S: Scalar>(
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
    }
}
