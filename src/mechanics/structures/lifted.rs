//! Eigenvalues of structures whose numbers carry an infinitesimal part: what a complex step needs.

use super::beam::BeamMotion;
use super::modes::{ModalProblem, Modes};
use super::shell::{Motion, ShellCotangent, Terms};
use super::state::Configuration;
use super::structure::Structure;
use crate::math::{Scalar, Vec3};

/// Infinitesimal parts of the eigenvalues of modes, xᵀ(δK − λ δM)x. `structure` has the real parts that the
/// modes were found for. Of eigenvalues that are equal only the sum means something.
pub fn eigenvalue_rates<S: Scalar>(
    problem: &ModalProblem,
    structure: &Structure<S>,
    modes: &Modes,
) -> Vec<f64> {
    let configuration = problem.assembly.configuration(structure);
    let moved = moved_elements(&configuration);
    let pairs = modes.vectors.iter().zip(&modes.eigenvalues);
    pairs
        .map(|(x, &lambda)| {
            let x: Vec<S> = x.iter().map(|&x| S::from(x)).collect();
            let motion = configuration.spread(&x);
            // Twice the strain energy less λ times twice the kinetic energy.
            let mut sum = configuration.beam_energy(&motion, Terms::LINEAR) * 2.0;
            for &index in &moved {
                let shell = configuration.shell(index);
                let v = motion.of_element(&structure.topology.mesh.shells[index]);
                let (mut p, mut unused) = (Motion::zeros(), ShellCotangent::zeros());
                shell.add_kinetic_energy_transpose(&v, S::one(), &mut p, &mut unused);
                let kinetic =
                    work(&p.displacement, &v.displacement) + work(&p.rotation, &v.rotation);
                sum += shell.energy(&v, Terms::LINEAR).total() * 2.0 - kinetic * lambda;
            }
            for (index, element) in configuration.beams() {
                let (beam, v) = (configuration.beam(index), motion.of_beam(element));
                let (mut p, mut unused) = (BeamMotion::zeros(), beam.zeros());
                beam.add_kinetic_energy_transpose(&v, S::one(), &mut p, &mut unused);
                let kinetic =
                    work(&p.displacement, &v.displacement) + work(&p.rotation, &v.rotation);
                sum -= kinetic * lambda;
            }
            let nodes = &structure.topology.mass_nodes;
            for (mass, &node) in structure.masses.iter().zip(nodes) {
                let (u, w) = (&motion.displacement[node], &motion.rotation[node]);
                sum -= (mass.mass * u.dot(u) + w.dot(&mass.momentum(w))) * lambda;
            }
            sum.infinitesimal()
        })
        .collect()
}

/// The shells whose numbers, or rotations, have an infinitesimal part.
fn moved_elements<S: Scalar>(configuration: &Configuration<S>) -> Vec<usize> {
    let moves = |v: &Vec3<S>| v.iter().any(|x| x.infinitesimal() != 0.0);
    (0..configuration.structure.topology.mesh.shells.len())
        .filter(|&index| {
            let shell = configuration.shell(index);
            let m = &shell.material;
            let numbers = [
                shell.thickness,
                shell.surface_mass,
                m.young,
                m.poisson,
                m.density,
            ];
            numbers.iter().any(|x| x.infinitesimal() != 0.0)
                || shell.geometry.points.iter().any(moves)
                || shell.geometry.directors.iter().any(moves)
        })
        .collect()
}

fn work<S: Scalar>(forces: &[Vec3<S>], motions: &[Vec3<S>]) -> S {
    let pairs = forces.iter().zip(motions);
    pairs.fold(S::zero(), |sum, (f, v)| sum + f.dot(v))
}
