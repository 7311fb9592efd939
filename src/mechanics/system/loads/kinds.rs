//! Forces and energy of every kind of load, and their pull-backs: the simple laws of `power.rs` and `pull.rs`, and those that have
//! files of their own.

use super::pull::{Pulled, Virtual, moving, with_motions};
use super::{Acting, bushing, contact, drag, power, pull, spring, stop};
use crate::math::{Scalar, Vec3};
use crate::model::LoadKind;

/// Force (ground axes) and torque (body axes, about the centre of mass) on body A and on body B.
pub(super) fn forces<S: Scalar>(
    kind: &LoadKind<S>,
    at: &Acting<S>,
    time: S,
) -> [(Vec3<S>, Vec3<S>); 2] {
    let none = (Vec3::zeros(), Vec3::zeros());
    if let Some(stop) = stop::of(kind) {
        return stop.forces(at);
    }
    if let Some(spring) = spring::of(kind) {
        return spring.forces(at);
    }
    match kind {
        LoadKind::Contact(contact) => contact::forces(contact, at),
        LoadKind::Bushing {
            stiffness,
            damping,
            friction,
            ..
        } => bushing::forces(([stiffness, damping], friction.as_ref()), at),
        LoadKind::Drag {
            coefficient,
            width,
            plate,
            ..
        } => [
            drag::force((*coefficient, *width, plate.as_ref()), at),
            none,
        ],
        _ => power::forces(kind, at, time),
    }
}

/// Derivatives of ψᵀf.
pub(super) fn pulled<S: Scalar>(
    kind: &LoadKind<S>,
    at: &Acting<S>,
    time: S,
    psi: &Virtual<S>,
) -> Pulled<S> {
    if let LoadKind::Contact(own) = kind {
        let now = contact::state(own, at);
        return contact::pulled((own, now.as_ref()), at, psi);
    }
    let mut out = Pulled::zero();
    let motions = moving(at, psi);
    let virtually = with_motions(at, &motions);
    if let Some(stop) = stop::of(kind) {
        stop.pull(at, &virtually, &mut out);
        return out;
    }
    if let Some(spring) = spring::of(kind) {
        spring.pull(at, &virtually, &mut out);
        return out;
    }
    match kind {
        LoadKind::Bushing {
            stiffness,
            damping,
            friction,
            ..
        } => {
            let law = ([&stiffness[..], damping], friction.as_ref());
            bushing::pull(law, at, &virtually, &mut out);
        }
        LoadKind::Drag {
            coefficient,
            width,
            plate,
            ..
        } => {
            let law = (*coefficient, *width, plate.as_ref());
            drag::pull(law, at, &virtually, &mut out);
        }
        _ => pull::pull(kind, at, time, &virtually, &mut out),
    }
    out
}

/// Potential energy of a load \[J\]; zero if it stores none.
pub(super) fn potential<S: Scalar>(kind: &LoadKind<S>, at: &Acting<S>) -> S {
    if let Some(stop) = stop::of(kind) {
        return stop.potential(at);
    }
    if let Some(spring) = spring::of(kind) {
        return spring.potential(at);
    }
    match kind {
        LoadKind::Contact(contact) => contact::potential(contact, at),
        LoadKind::Bushing { stiffness, .. } => bushing::potential(stiffness, at),
        _ => S::zero(),
    }
}

/// Derivatives of `weight` times a load's potential energy; `None` if it stores none.
pub(super) fn pulled_potential<S: Scalar>(
    kind: &LoadKind<S>,
    at: &Acting<S>,
    weight: S,
) -> Option<Pulled<S>> {
    let mut out = Pulled::zero();
    if let Some(stop) = stop::of(kind) {
        stop.pull_potential(at, weight, &mut out);
        return Some(out);
    }
    if let Some(spring) = spring::of(kind) {
        spring.pull_potential(at, weight, &mut out);
        return Some(out);
    }
    match kind {
        LoadKind::Contact(contact) => contact::pull_potential(contact, at, weight, &mut out),
        LoadKind::Bushing { stiffness, .. } => {
            bushing::pull_potential(stiffness, at, weight, &mut out);
        }
        _ => return None,
    }
    Some(out)
}
