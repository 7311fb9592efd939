//! Places of the coordinates of a flexible body in the vectors of the system, and the motion that
//! they describe.

use crate::math::{Scalar, Vec3};
use crate::model::Model;
use crate::model::flexible::{FlexibleBody, Form};
use crate::model::reduced::NodalBasis;
use crate::system::bodies::BodyMotion;
use crate::system::finite;
use crate::system::flexing::{Flexing, Generalised};
use crate::system::numbering::Numbering;

/// A difference of velocities below this is round-off, relative to the velocities.
const ROUND_OFF: f64 = 4.0 * f64::EPSILON;

/// Places of the coordinates of a flexible body among the velocities: six of the frame, then the
/// elastic ones.
pub(super) fn slots<S: Scalar>(numbering: &Numbering, body: &FlexibleBody<S>) -> Vec<usize> {
    let frame = numbering.velocity(body.frame);
    let elastic = (body.places()).map(|(carrier, k)| numbering.velocity(carrier) + k);
    (frame..frame + 6).chain(elastic).collect()
}

/// Whether a body has shells, by all nodes or in a reduced basis.
fn is_of_shells<S: Scalar>(body: &FlexibleBody<S>) -> bool {
    match &body.form {
        Form::Modal(modal) => modal.shells.is_some(),
        Form::Finite(_) => true,
    }
}

/// Whether some body has shells.
pub fn has_shells<S: Scalar>(model: &Model<S>) -> bool {
    model.flexible.iter().any(is_of_shells)
}

/// Whether some body has so many elements that work on them is divided among processors.
pub fn is_divided<S: Scalar>(model: &Model<S>) -> bool {
    model.flexible.iter().any(|body| match &body.form {
        Form::Modal(modal) => {
            let shells = modal.shells.as_ref();
            shells.is_some_and(|own| own.elements.mesh.elements.len() >= finite::SIDE_BY_SIDE)
        }
        Form::Finite(own) => own.mesh.elements.len() >= finite::SIDE_BY_SIDE,
    })
}

/// Unknowns of the coordinates of shells, of nodes in an order of little fill.
pub fn nodal_unknowns<S: Scalar>(model: &Model<S>, numbering: &Numbering) -> Vec<usize> {
    let mut all = Vec::new();
    for body in model.flexible.iter().filter(|body| is_of_shells(body)) {
        all.extend((body.places()).map(|(carrier, k)| numbering.unknown(carrier) + k));
    }
    all
}

/// Sets q̇ − v of nodes to zero where it is round-off, relative to the largest velocity of a body's nodes. The
/// kinematics of nodes are linear, so they hold after one iteration and need no more of its work.
pub fn clear_kinematics<S: Scalar>(
    model: &Model<S>,
    numbering: &Numbering,
    v: &[S],
    kinematics: &mut [S],
) {
    if S::INFINITESIMAL {
        return;
    }
    for body in model.flexible.iter().filter(|body| is_of_shells(body)) {
        let places = body.places();
        let places = places.map(|(carrier, k)| numbering.velocity(carrier) + k);
        let largest = places
            .clone()
            .fold(0.0, |most: f64, i| most.max(v[i].re().abs()));
        for i in places {
            if kinematics[i].re().abs() <= ROUND_OFF * largest {
                kinematics[i] = S::zero();
            }
        }
    }
}

/// Elastic components of a vector in velocity numbering.
pub(super) fn elastic_of<S: Scalar>(
    numbering: &Numbering,
    body: &FlexibleBody<S>,
    x: &[S],
) -> Vec<S> {
    let places = body.places();
    places
        .map(|(carrier, k)| x[numbering.velocity(carrier) + k])
        .collect()
}

/// The part of a vector in velocity numbering that belongs to a flexible body.
pub(super) fn part_of<S: Scalar>(
    numbering: &Numbering,
    body: &FlexibleBody<S>,
    x: &[S],
) -> Generalised<S> {
    let o = numbering.velocity(body.frame);
    Generalised {
        linear: Vec3::new(x[o], x[o + 1], x[o + 2]),
        angular: Vec3::new(x[o + 3], x[o + 4], x[o + 5]),
        elastic: elastic_of(numbering, body, x),
    }
}

/// Adds parts to a vector in velocity numbering.
pub(super) fn add_part<S: Scalar>(
    numbering: &Numbering,
    body: &FlexibleBody<S>,
    (linear, angular): (&Vec3<S>, &Vec3<S>),
    elastic: &[S],
    out: &mut [S],
) {
    let o = numbering.velocity(body.frame);
    for k in 0..3 {
        out[o + k] += linear[k];
        out[o + 3 + k] += angular[k];
    }
    add_coordinates(numbering, body, elastic, out);
}

/// Adds cotangents of the elastic coordinates to a vector in velocity numbering.
pub fn add_coordinates<S: Scalar>(
    numbering: &Numbering,
    body: &FlexibleBody<S>,
    elastic: &[S],
    out: &mut [S],
) {
    for ((carrier, k), &x) in body.places().zip(elastic) {
        out[numbering.velocity(carrier) + k] += x;
    }
}

/// An unknown of the nodes of a body of elements at the coordinates `q`, through the basis if there is one.
pub fn unknown_of<S: Scalar>(basis: Option<&NodalBasis>, unknown: usize, q: &[S]) -> S {
    match basis {
        None => q[unknown],
        Some(basis) => basis.unknown(unknown, q),
    }
}

/// Transpose of [`unknown_of`], added to the cotangent of the coordinates.
pub fn add_unknown<S: Scalar>(basis: Option<&NodalBasis>, unknown: usize, by: S, out: &mut [S]) {
    match basis {
        None => out[unknown] += by,
        Some(basis) => basis.add_unknown(unknown, by, out),
    }
}

/// Adds cotangents of these unknowns, or of all coordinates, to a vector in velocity numbering.
pub fn add_unknowns(
    numbering: &Numbering,
    (body, unknowns): (&FlexibleBody<f64>, Option<&[usize]>),
    by: &[f64],
    out: &mut [f64],
) {
    let Some(unknowns) = unknowns else {
        return add_coordinates(numbering, body, by, out);
    };
    let mut elastic = vec![0.0; body.modes()];
    for (&unknown, by) in unknowns.iter().zip(by) {
        add_unknown(basis_of(body), unknown, *by, &mut elastic);
    }
    add_coordinates(numbering, body, &elastic, out);
}

/// The vectors of a reduced basis.
pub fn basis_of<S: Scalar>(body: &FlexibleBody<S>) -> Option<&NodalBasis> {
    match &body.form {
        Form::Modal(modal) => modal.shells.as_ref().map(|own| &*own.basis),
        Form::Finite(_) => None,
    }
}

/// Elastic coordinates of a body in motion.
pub fn coordinates<S: Scalar>(body: &FlexibleBody<S>, motions: &[BodyMotion<S>]) -> Vec<S> {
    let places = body.places();
    places
        .map(|(carrier, k)| motions[carrier].position[k])
        .collect()
}

/// Their rates.
pub fn rates<S: Scalar>(body: &FlexibleBody<S>, motions: &[BodyMotion<S>]) -> Vec<S> {
    let places = body.places();
    places
        .map(|(carrier, k)| motions[carrier].velocity[k])
        .collect()
}

/// The motion of a flexible body at the accelerations `a` (velocity numbering).
pub(super) fn motion_of<S: Scalar>(
    model: &Model<S>,
    numbering: &Numbering,
    body: &FlexibleBody<S>,
    motions: &[BodyMotion<S>],
    a: &[S],
) -> Flexing<S> {
    let frame = &motions[body.frame];
    let a = part_of(numbering, body, a);
    Flexing {
        rotation: frame.rotation,
        gamma: frame.rotation.tr_mul(&(a.linear - model.gravity)),
        omega: frame.omega,
        alpha: a.angular,
        q: coordinates(body, motions),
        rate: rates(body, motions),
        acceleration: a.elastic,
    }
}

/// The motion whose inertial forces are M(q) x: no velocity, no gravity.
pub(super) fn accelerated<S: Scalar>(
    numbering: &Numbering,
    body: &FlexibleBody<S>,
    motions: &[BodyMotion<S>],
    x: &[S],
) -> Flexing<S> {
    let rotation = motions[body.frame].rotation;
    let x = part_of(numbering, body, x);
    let q = coordinates(body, motions);
    Flexing {
        rotation,
        gamma: rotation.tr_mul(&x.linear),
        omega: Vec3::zeros(),
        alpha: x.angular,
        rate: vec![S::zero(); q.len()],
        q,
        acceleration: x.elastic,
    }
}

/// The motion of a flexible body without accelerations.
pub(super) fn at_rest<S: Scalar>(body: &FlexibleBody<S>, motions: &[BodyMotion<S>]) -> Flexing<S> {
    let frame = &motions[body.frame];
    let q = coordinates(body, motions);
    Flexing {
        rotation: frame.rotation,
        gamma: Vec3::zeros(),
        omega: frame.omega,
        alpha: Vec3::zeros(),
        acceleration: vec![S::zero(); q.len()],
        rate: rates(body, motions),
        q,
    }
}
