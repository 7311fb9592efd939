//! Momentum and energy of a whole scene at one instant.

use super::instant::EnergyPart;
use super::snapshot::{Snapshot, SnapshotCotangent};
use crate::math::{Scalar, Vec3};
use crate::model::Role;
use crate::system::bodies::add6;
use crate::system::loads::LoadCotangent;
use crate::system::{flexible, loads};

/// Linear momentum of the model in a snapshot, ground axes \[kg m/s\].
pub(super) fn momentum<S: Scalar>(at: &Snapshot<S>) -> Vec3<S> {
    let motions = at.motions();
    let bodies = at.model.bodies.iter().zip(&motions);
    let bodies = bodies.filter(|(body, _)| !body.role.is_abstract());
    let own = flexible::held(at.model, &motions).momentum;
    bodies.fold(own, |sum, (body, motion)| sum + motion.velocity * body.mass)
}

/// Energy of the model in a snapshot \[J\].
pub fn energy<S: Scalar>(at: &Snapshot<S>, part: EnergyPart) -> S {
    let mut sum = S::zero();
    let motions = at.motions();
    for (body, motion) in at.model.bodies.iter().zip(&motions) {
        if part != EnergyPart::Potential && body.role != Role::State {
            let linear = motion.velocity.dot(&motion.velocity) * body.mass;
            let angular = motion.omega.dot(&(body.inertia * motion.omega));
            sum += (linear + angular) * 0.5;
        }
        if part != EnergyPart::Kinetic && !body.role.is_abstract() {
            sum -= at.model.gravity.dot(&motion.position) * body.mass;
        }
    }
    let held = flexible::held(at.model, &motions);
    if part != EnergyPart::Potential {
        sum += held.kinetic;
    }
    if part != EnergyPart::Kinetic {
        sum += held.potential + loads::potential(at.model, &motions, at.time);
    }
    sum
}

/// Adds the derivative of `along` · [`momentum`] to the cotangents of the snapshot.
pub(super) fn pull_momentum(at: &Snapshot<f64>, along: &Vec3<f64>, out: &mut SnapshotCotangent) {
    let motions = at.motions();
    for (i, (body, motion)) in at.model.bodies.iter().zip(&motions).enumerate() {
        if body.role.is_abstract() {
            continue;
        }
        let o = at.numbering.velocity(i);
        add6(&mut out.v[o..], &(along * body.mass), &Vec3::zeros());
        out.model.bodies[i].mass += along.dot(&motion.velocity);
    }
    let of = (at.model, at.numbering);
    flexible::pull_momentum(of, &motions, along, (out.y, out.v), out.model);
}

/// Adds `weight` times the derivative of [`energy`] to the cotangents of the snapshot.
pub(super) fn pull_energy(
    at: &Snapshot<f64>,
    part: EnergyPart,
    weight: f64,
    out: &mut SnapshotCotangent,
) {
    let gravity = at.model.gravity;
    let motions = at.motions();
    for (i, (body, motion)) in at.model.bodies.iter().zip(&motions).enumerate() {
        let o = at.numbering.velocity(i);
        let own = &mut out.model.bodies[i];
        if part != EnergyPart::Potential && body.role != Role::State {
            let (velocity, omega) = (&motion.velocity, &motion.omega);
            let (momentum, spin) = (velocity * body.mass, body.inertia * omega);
            add6(&mut out.v[o..], &(momentum * weight), &(spin * weight));
            own.mass += 0.5 * weight * velocity.norm_squared();
            own.inertia += omega * omega.transpose() * (0.5 * weight);
        }
        if part != EnergyPart::Kinetic && !body.role.is_abstract() {
            add6(
                &mut out.y[o..],
                &(gravity * (-weight * body.mass)),
                &Vec3::zeros(),
            );
            own.mass -= weight * gravity.dot(&motion.position);
            out.model.gravity -= motion.position * (weight * body.mass);
        }
    }
    if part != EnergyPart::Kinetic {
        let mut to = LoadCotangent {
            y: Some(&mut *out.y),
            v: None,
            time: &mut *out.time,
            model: &mut *out.model,
        };
        loads::pull_potential(&at.in_motion(&motions), weight, &mut to);
    }
    let parts = match part {
        EnergyPart::Kinetic => [weight, 0.0],
        EnergyPart::Potential => [0.0, weight],
        EnergyPart::Total => [weight, weight],
    };
    let of = (at.model, at.numbering);
    flexible::pull_energies(of, &motions, parts, (out.y, out.v), out.model);
}
