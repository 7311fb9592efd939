//! Controllers: their forces on bodies and states, Jacobians and pull-backs. The law is in [`super::control_law`].

use super::control_law::{Known, Outputs, Running, of};
use super::coordinate::Coordinate;
use super::motor;
use super::parameters::give_to_joint;
use super::{LoadCotangent, LoadEntries, give_to_states};
use crate::linalg::Emit;
use crate::math::{Scalar, Vec3};
use crate::model::LoadKind;
use crate::model::controller::{Controller, Coordinate as Written};
use crate::system::bodies::{BodyMotion, add6, velocities_of};
use crate::system::in_motion::InMotion;

/// Calls `visit` for every controller.
pub(super) fn for_each<S: Scalar>(here: &InMotion<S>, mut visit: impl FnMut(usize, &Running<S>)) {
    let mut ground = None;
    for i in 0..here.model.loads.len() {
        if let Some(own) = of(here, i) {
            let ground = ground.get_or_insert_with(BodyMotion::ground);
            visit(i, &Running::of(here, ground, own));
        }
    }
}

/// Adds the efforts on bodies to `out`, in velocity numbering.
pub(super) fn add_efforts<S: Scalar>(here: &InMotion<S>, out: &mut [S]) {
    for_each(here, |_, running| add_effort(here, running, out));
}

fn add_effort<S: Scalar>(here: &InMotion<S>, running: &Running<S>, out: &mut [S]) {
    let (coordinate, at) = &running.coordinates[0];
    let effort = running.effort();
    for (body, (force, torque)) in at.bodies.into_iter().zip(coordinate.unit_forces(at)) {
        let Some(body) = body else { continue };
        let o = here.numbering.velocity(body);
        add6(&mut out[o..], &(force * effort), &(torque * effort));
    }
}

/// Adds the efforts on bodies, and the forces on states, to `out`, in velocity numbering.
pub(super) fn add_forces<S: Scalar>(here: &InMotion<S>, out: &mut [S]) {
    for_each(here, |_, running| {
        add_effort(here, running, out);
        for (body, rate) in running.state_rates().into_iter().flatten() {
            out[here.numbering.velocity(body)] += rate;
        }
    });
}

/// The components of a body that a coordinate moves.
fn moved(coordinate: Coordinate) -> [bool; 2] {
    match coordinate {
        Coordinate::Angle => [false, true],
        Coordinate::Slide | Coordinate::Distance => [true, true],
    }
}

/// Emits the derivatives of the forces of all controllers.
pub(super) fn emit_jacobian<S: Scalar>(
    here: &InMotion<S>,
    to: &LoadEntries<S>,
    emit: &mut dyn Emit<S>,
) {
    let still = [(Vec3::zeros(), Vec3::zeros()); 2];
    for_each(here, |_, running| {
        let (coordinate, at) = &running.coordinates[0];
        for side in 0..2 {
            let Some(body) = at.bodies[side] else {
                continue;
            };
            let row = to.row + here.numbering.velocity(body);
            for component in (0..6).filter(|k| moved(*coordinate)[k / 3]) {
                let mut psi = still;
                let (linear, angular) = &mut psi[side];
                [linear, angular][component / 3][component % 3] = S::one();
                let (_, known) = running.pulled(&psi, [S::zero(); 2]);
                emit_row(here, running, &known, (row + component, to), emit);
            }
        }
        let states = running.state_rates();
        for (k, state) in states.into_iter().enumerate() {
            let Some((body, _)) = state else { continue };
            let mut psi = [S::zero(); 2];
            psi[k] = S::one();
            let (_, known) = running.pulled(&still, psi);
            let row = to.row + here.numbering.velocity(body);
            emit_row(here, running, &known, (row, to), emit);
        }
    });
}

fn emit_row<S: Scalar>(
    here: &InMotion<S>,
    running: &Running<S>,
    known: &Known<S>,
    (row, to): (usize, &LoadEntries<S>),
    emit: &mut dyn Emit<S>,
) {
    let mut body = |body: usize, wanted: [bool; 2], place: [&Vec3<S>; 2], rate: [&Vec3<S>; 2]| {
        let o = here.numbering.velocity(body);
        for part in (0..2).filter(|&part| wanted[part]) {
            let at = o + 3 * part;
            emit.add_row(row, to.y + at, &(place[part] * to.by_y));
            emit.add_row(row, to.v + at, &(rate[part] * to.by_v));
        }
    };
    for ((coordinate, at), pulled) in running.coordinates.iter().zip(&known.coordinates) {
        // The arm of a weight moves with the first body too.
        let wanted = match running.weights.is_empty() {
            true => moved(*coordinate),
            false => [true, true],
        };
        for (index, by) in at.bodies.into_iter().zip([&pulled.a, &pulled.b]) {
            let Some(index) = index else { continue };
            let (place, rate) = ([&by.position, &by.theta], [&by.velocity, &by.omega]);
            body(index, wanted, place, rate);
        }
    }
    let still = Vec3::zeros();
    for (weight, pulled) in running.own.weights.iter().zip(&known.weights) {
        let place = [&pulled.a.position, &pulled.a.theta];
        body(weight.body, [true, true], place, [&still, &still]);
    }
    let integral = running.own.integral.as_ref().map(|own| own.state);
    let lag = running.own.lag.as_ref().map(|own| own.state);
    for (state, by) in [(integral, known.integral), (lag, known.lagged)] {
        if let Some(state) = state {
            let column = to.v + here.numbering.velocity(state);
            emit.add(row, column, by * to.by_v);
        }
    }
}

/// Adds derivatives by what controller `load` knows to states, time and parameters.
pub(super) fn give(
    here: &InMotion<f64>,
    (load, running): (usize, &Running<f64>),
    by: (Outputs<f64>, &Known<f64>),
    out: &mut LoadCotangent,
) {
    let (outputs, known) = by;
    let numbering = here.numbering;
    for ((_, at), pulled) in running.coordinates.iter().zip(&known.coordinates) {
        give_to_states(pulled, at, numbering, (&mut out.y, &mut out.v));
    }
    for (weight, pulled) in running.own.weights.iter().zip(&known.weights) {
        if let Some(y) = out.y.as_deref_mut() {
            let o = numbering.velocity(weight.body);
            add6(&mut y[o..], &pulled.a.position, &pulled.a.theta);
        }
    }
    let own = running.own;
    if let Some(v) = out.v.as_deref_mut() {
        if let Some(integral) = &own.integral {
            v[numbering.velocity(integral.state)] += known.integral;
        }
        if let Some(lag) = &own.lag {
            v[numbering.velocity(lag.state)] += known.lagged;
        }
    }
    out.model.gravity += known.gravity;
    for (own, pulled) in own.feedback.iter().zip(&known.coordinates) {
        if let Written::Joint { joint, .. } = own.coordinate {
            give_to_joint(out.model, joint, pulled);
        }
    }
    let LoadKind::Controller(to) = &mut out.model.loads[load].kind else {
        unreachable!("a cotangent has the kind of its load")
    };
    give_to_parameters((running, here.time), (outputs, known), to, out.time);
}

fn give_to_parameters(
    (running, now): (&Running<f64>, f64),
    (outputs, known): (Outputs<f64>, &Known<f64>),
    to: &mut Controller<f64>,
    by_time: &mut f64,
) {
    let own = running.own;
    let u = known.demand;
    let [e, _] = running.errors[0];
    let excess = running.limited.effort - running.demand;
    let mut by_error = 0.0;
    if let (Some(own), Some(to)) = (&own.integral, &mut to.integral) {
        to.gain += outputs.integral * e;
        by_error = outputs.integral * own.gain;
        if let (Some(time), Some(to)) = (own.tracking, &mut to.tracking) {
            *to -= outputs.integral * excess / (time * time);
        }
    }
    if let (Some(own), Some(to)) = (&own.lag, &mut to.lag) {
        let rate = (running.limited.effort - running.lagged) / own.time;
        to.time -= outputs.lag * rate / own.time;
    }
    motor::give(&running.limited, known.limited, &mut to.limits);
    let all = own.feedback.iter().zip(&running.errors).enumerate();
    for (k, (own, [e, rate])) in all {
        let to = &mut to.feedback[k];
        to.proportional += u * e;
        to.derivative += u * rate;
        let weights = [u * own.proportional + by_error, u * own.derivative, 0.0];
        *by_time += own.reference.pull_back(now, weights, &mut to.reference);
        by_error = 0.0;
        if let Written::Distance {
            point_a, point_b, ..
        } = &mut to.coordinate
        {
            *point_a += known.coordinates[k].a.frame.point;
            *point_b += known.coordinates[k].b.frame.point;
        }
    }
    *by_time += own
        .feed_forward
        .pull_back(now, [u, 0.0, 0.0], &mut to.feed_forward);
    for ((to, pulled), by_mass) in to.weights.iter_mut().zip(&known.weights).zip(&known.masses) {
        to.point += pulled.a.frame.point;
        to.mass += by_mass;
    }
}

/// Adds the derivatives of ψᵀf of all controllers.
pub(super) fn pull_back(here: &InMotion<f64>, psi: &[f64], out: &mut LoadCotangent) {
    for_each(here, |load, running| {
        let of_body = |body: Option<usize>| {
            body.map_or((Vec3::zeros(), Vec3::zeros()), |body| {
                velocities_of(&psi[here.numbering.velocity(body)..])
            })
        };
        let virtually = running.coordinates[0].1.bodies.map(of_body);
        let states = running.state_rates();
        let own = states.map(|own| own.map_or(0.0, |(body, _)| psi[here.numbering.velocity(body)]));
        let (by, known) = running.pulled(&virtually, own);
        give(here, (load, running), (by, &known), out);
    });
}
