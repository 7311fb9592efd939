//! Controllers: the equations of [`crate::model::controller`], their Jacobians, pull-backs and power.
//!
//! With virtual velocities ψ of the bodies and ψ_I, ψ_F of the states,
//!
//! ```text
//! ψᵀf = F ẋ_0(ψ) + İ ψ_I + Ḟ ψ_F
//! ```
//!
//! so the cotangents of F, İ and Ḟ are ẋ_0(ψ), ψ_I and ψ_F, and all others follow by the chain rule.

use super::coordinate::Coordinate;
use super::motor::{self, Limited};
use super::parameters::give_to_joint;
use super::pull::{Pulled, Virtual, hold_virtual, moving, pull_axis, pull_point, with_motions};
use super::{Acting, LoadCotangent, LoadEntries, give_to_states};
use crate::linalg::Emit;
use crate::math::{Scalar, Vec3};
use crate::model::controller::{Controller, Coordinate as Written};
use crate::model::{JointFrame, LoadKind};
use crate::system::bodies::{BodyMotion, add6, velocities_of};
use crate::system::in_motion::InMotion;
use crate::system::side::JointSide;
use crate::system::turns;

/// A controller in motion.
struct Running<'a, S> {
    own: &'a Controller<S>,
    gravity: Vec3<S>,
    coordinates: Vec<(Coordinate, Acting<'a, S>)>,
    /// e_k and ė_k.
    errors: Vec<[S; 2]>,
    /// The points whose weights are balanced.
    weights: Vec<JointSide<'a, S>>,
    /// I and F of a lag, or zero.
    integral: S,
    lagged: S,
    demand: S,
    limited: Limited<S>,
}

/// Cotangents of F, İ and Ḟ.
#[derive(Clone, Copy)]
struct Outputs<S> {
    effort: S,
    integral: S,
    lag: S,
}

/// Derivatives by what a controller knows.
struct Known<S> {
    /// By coordinate; its points or frames with it.
    coordinates: Vec<Pulled<S>>,
    /// By weight.
    weights: Vec<Pulled<S>>,
    gravity: Vec3<S>,
    masses: Vec<S>,
    /// Of u, of s, and of I and F.
    demand: S,
    limited: S,
    integral: S,
    lagged: S,
}

/// The controller that a load is, if it is one.
fn of<'a, S: Scalar>(here: &InMotion<'a, S>, load: usize) -> Option<&'a Controller<S>> {
    match &here.model.loads[load].kind {
        LoadKind::Controller(own) => Some(own),
        _ => None,
    }
}

/// Calls `visit` for every controller.
fn for_each<S: Scalar>(here: &InMotion<S>, mut visit: impl FnMut(usize, &Running<S>)) {
    let mut ground = None;
    for i in 0..here.model.loads.len() {
        if let Some(own) = of(here, i) {
            let ground = ground.get_or_insert_with(BodyMotion::ground);
            visit(i, &Running::of(here, ground, own));
        }
    }
}

/// What acts on a coordinate.
fn acting<'a, S: Scalar>(
    here: &InMotion<'a, S>,
    ground: &'a BodyMotion<S>,
    coordinate: &Written<S>,
) -> (Coordinate, Acting<'a, S>) {
    let motions = here.motions;
    let between = |(body_a, frame_a): (usize, JointFrame<S>),
                   (body_b, frame_b): (Option<usize>, JointFrame<S>)| Acting {
        bodies: [Some(body_a), body_b],
        a: JointSide::fixed(&motions[body_a], frame_a),
        b: JointSide::fixed(body_b.map_or(ground, |body| &motions[body]), frame_b),
        counted: None,
    };
    match coordinate {
        Written::Joint {
            joint,
            dof,
            counter,
        } => {
            let own = &here.model.joints[*joint];
            let mut acting = between((own.body_a, own.frame_a), (own.body_b, own.frame_b));
            acting.counted = counter.map(|counter| {
                let ends = [&acting.a.motion.orientation, &acting.b.motion.orientation];
                let known = motions[counter].position.x.re();
                turns::counted(here.model, (*joint, counter), ends, known)
            });
            (Coordinate::from(*dof), acting)
        }
        Written::Distance {
            body_a,
            body_b,
            point_a,
            point_b,
        } => {
            let at = |point: &Vec3<S>| JointFrame {
                point: *point,
                ..JointFrame::zero()
            };
            let acting = between((*body_a, at(point_a)), (*body_b, at(point_b)));
            (Coordinate::Distance, acting)
        }
    }
}

impl<'a, S: Scalar> Running<'a, S> {
    fn of(here: &InMotion<'a, S>, ground: &'a BodyMotion<S>, own: &'a Controller<S>) -> Self {
        let coordinates: Vec<(Coordinate, Acting<'a, S>)> = (own.feedback.iter())
            .map(|own| acting(here, ground, &own.coordinate))
            .collect();
        let errors: Vec<[S; 2]> = (own.feedback.iter().zip(&coordinates))
            .map(|(own, (coordinate, at))| {
                let [r, rate, ..] = own.reference.derivatives(here.time);
                [r - coordinate.value(at), rate - coordinate.rate(at)]
            })
            .collect();
        let weights = own.weights.iter().map(|own| {
            let at = JointFrame {
                point: own.point,
                ..JointFrame::zero()
            };
            JointSide::fixed(&here.motions[own.body], at)
        });
        let state = |body: usize| here.motions[body].velocity.x;
        let mut running = Self {
            own,
            gravity: here.model.gravity,
            errors,
            weights: weights.collect(),
            integral: own
                .integral
                .as_ref()
                .map_or(S::zero(), |own| state(own.state)),
            lagged: own.lag.as_ref().map_or(S::zero(), |own| state(own.state)),
            demand: S::zero(),
            limited: motor::limited(&own.limits, S::zero(), S::zero()),
            coordinates,
        };
        let terms = own.feedback.iter().zip(&running.errors);
        let demand = terms.fold(running.integral, |sum, (own, [e, rate])| {
            sum + own.proportional * *e + own.derivative * *rate
        });
        running.demand = demand + own.feed_forward.value(here.time) + running.balance();
        let (coordinate, at) = &running.coordinates[0];
        let rate = coordinate.rate(at);
        running.limited = motor::limited(&own.limits, running.demand, rate);
        running
    }

    /// The effort against the weights that are balanced.
    fn balance(&self) -> S {
        let (kind, at) = &self.coordinates[0];
        let axis = at.a.axis(2);
        let all = self.own.weights.iter().zip(&self.weights);
        all.fold(S::zero(), |sum, (own, side)| {
            let along = match kind {
                Coordinate::Angle => axis.cross(&(side.point() - at.a.point())),
                Coordinate::Slide | Coordinate::Distance => axis,
            };
            sum - own.mass * self.gravity.dot(&along)
        })
    }

    /// F.
    fn effort(&self) -> S {
        match self.own.lag {
            Some(_) => self.lagged,
            None => self.limited.effort,
        }
    }

    /// Bodies and rates of the states: İ and Ḟ.
    fn state_rates(&self) -> [Option<(usize, S)>; 2] {
        let s = self.limited.effort;
        let integral = self.own.integral.as_ref().map(|own| {
            let excess = own.tracking.map(|time| (s - self.demand) / time);
            let rate = own.gain * self.errors[0][0] + excess.unwrap_or(S::zero());
            (own.state, rate)
        });
        let lag = self.own.lag.as_ref();
        let lag = lag.map(|own| (own.state, (s - self.lagged) / own.time));
        [integral, lag]
    }

    /// Derivatives of F, İ and Ḟ times their cotangents, but for those by virtual velocities.
    fn pull(&self, by: Outputs<S>) -> Known<S> {
        let own = self.own;
        let mut out = Known {
            coordinates: self.coordinates.iter().map(|_| Pulled::zero()).collect(),
            weights: self.weights.iter().map(|_| Pulled::zero()).collect(),
            gravity: Vec3::zeros(),
            masses: Vec::new(),
            demand: S::zero(),
            limited: S::zero(),
            integral: S::zero(),
            lagged: S::zero(),
        };
        match &own.lag {
            Some(lag) => {
                out.limited += by.lag / lag.time;
                out.lagged += by.effort - by.lag / lag.time;
            }
            None => out.limited += by.effort,
        }
        let mut by_error = S::zero();
        if let Some(integral) = &own.integral {
            by_error += by.integral * integral.gain;
            if let Some(time) = integral.tracking {
                out.limited += by.integral / time;
                out.demand -= by.integral / time;
            }
        }
        out.demand += out.limited * self.limited.by_demand;
        out.integral = out.demand;
        let mut by_rate = out.limited * self.limited.by_rate;
        let all = own.feedback.iter().zip(&self.coordinates);
        for ((own, (coordinate, at)), to) in all.zip(&mut out.coordinates) {
            let by_x = -(own.proportional * out.demand + by_error);
            by_rate -= own.derivative * out.demand;
            coordinate.pull(at, by_x, by_rate, to);
            (by_error, by_rate) = (S::zero(), S::zero());
        }
        self.pull_balance(&mut out);
        out
    }

    /// Adds the derivatives of the effort against weights.
    fn pull_balance(&self, out: &mut Known<S>) {
        let (kind, at) = &self.coordinates[0];
        let (axis, zero) = (at.a.axis(2), Vec3::zeros());
        let all = self.own.weights.iter().zip(&self.weights);
        for ((own, side), to) in all.zip(&mut out.weights) {
            let by_mass = self.gravity * -out.demand;
            let by_along = by_mass * own.mass;
            let own_point = &mut out.coordinates[0].a;
            let along = match kind {
                Coordinate::Angle => {
                    let arm = side.point() - at.a.point();
                    pull_axis(&at.a, 2, arm.cross(&by_along), own_point);
                    let by_arm = by_along.cross(&axis);
                    pull_point(side, [by_arm, zero], &mut to.a);
                    pull_point(&at.a, [-by_arm, zero], own_point);
                    axis.cross(&arm)
                }
                Coordinate::Slide | Coordinate::Distance => {
                    pull_axis(&at.a, 2, by_along, own_point);
                    axis
                }
            };
            out.masses.push(by_mass.dot(&along));
            out.gravity -= along * (own.mass * out.demand);
        }
    }

    /// The rate of the first coordinate by virtual velocities, and derivatives of ψᵀf.
    fn pulled(&self, psi: &Virtual<S>, [integral, lag]: [S; 2]) -> (S, Known<S>) {
        let (coordinate, at) = &self.coordinates[0];
        let motions = moving(at, psi);
        let virtually = with_motions(at, &motions);
        let effort = coordinate.rate(&virtually);
        let by = Outputs {
            effort,
            integral,
            lag,
        };
        let mut out = self.pull(by);
        let mut geometry = Pulled::zero();
        coordinate.pull(&virtually, S::zero(), self.effort(), &mut geometry);
        hold_virtual(&mut geometry);
        let first = &mut out.coordinates[0];
        first.a.add(&geometry.a);
        first.b.add(&geometry.b);
        (effort, out)
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
            let weight = here.model.gravity.x * here.model.bodies[body].mass;
            out[here.numbering.velocity(body)] += rate - weight;
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
fn give(
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
        for (state, psi) in states.into_iter().zip(own) {
            let Some((body, _)) = state else { continue };
            out.model.gravity.x -= here.model.bodies[body].mass * psi;
            out.model.bodies[body].mass -= here.model.gravity.x * psi;
        }
        let (effort, known) = running.pulled(&virtually, own);
        let [integral, lag] = own;
        let by = Outputs {
            effort,
            integral,
            lag,
        };
        give(here, (load, running), (by, &known), out);
    });
}

/// What `with` makes of the controller that a load is.
fn with<S: Scalar, T>(
    here: &InMotion<S>,
    load: usize,
    with: impl FnOnce(&Running<S>) -> T,
) -> Option<T> {
    let own = of(here, load)?;
    let ground = BodyMotion::ground();
    Some(with(&Running::of(here, &ground, own)))
}

/// The power by which a controller drives its bodies; `None` of another load.
pub(super) fn power<S: Scalar>(here: &InMotion<S>, load: usize) -> Option<S> {
    with(here, load, |running| {
        let (coordinate, at) = &running.coordinates[0];
        running.effort() * coordinate.rate(at)
    })
}

/// Adds `weight` times the derivative of [`power`].
pub(super) fn pull_power(here: &InMotion<f64>, load: usize, weight: f64, out: &mut LoadCotangent) {
    with(here, load, |running| {
        let (coordinate, at) = &running.coordinates[0];
        let by = Outputs {
            effort: weight * coordinate.rate(at),
            integral: 0.0,
            lag: 0.0,
        };
        let mut known = running.pull(by);
        let first = &mut known.coordinates[0];
        coordinate.pull(at, 0.0, weight * running.effort(), first);
        give(here, (load, running), (by, &known), out);
    });
}

/// The effort F of a controller.
pub(super) fn effort<S: Scalar>(here: &InMotion<S>, load: usize) -> Option<S> {
    with(here, load, |running| running.effort())
}

/// Adds `weight` times the derivative of [`effort`].
pub(super) fn pull_effort(here: &InMotion<f64>, load: usize, weight: f64, out: &mut LoadCotangent) {
    with(here, load, |running| {
        let by = Outputs {
            effort: weight,
            integral: 0.0,
            lag: 0.0,
        };
        give(here, (load, running), (by, &running.pull(by)), out);
    });
}

/// The error e_0 of a controller.
pub(super) fn error<S: Scalar>(here: &InMotion<S>, load: usize) -> Option<S> {
    with(here, load, |running| running.errors[0][0])
}

/// Adds `weight` times the derivative of [`error`].
pub(super) fn pull_error(here: &InMotion<f64>, load: usize, weight: f64, out: &mut LoadCotangent) {
    with(here, load, |running| {
        let (coordinate, at) = &running.coordinates[0];
        let mut pulled = Pulled::zero();
        coordinate.pull(at, -weight, 0.0, &mut pulled);
        give_to_states(&pulled, at, here.numbering, (&mut out.y, &mut out.v));
        let own = &running.own.feedback[0];
        if let Written::Joint { joint, .. } = own.coordinate {
            give_to_joint(out.model, joint, &pulled);
        }
        let LoadKind::Controller(to) = &mut out.model.loads[load].kind else {
            unreachable!("a cotangent has the kind of its load")
        };
        let to = &mut to.feedback[0];
        if let Written::Distance {
            point_a, point_b, ..
        } = &mut to.coordinate
        {
            *point_a += pulled.a.frame.point;
            *point_b += pulled.b.frame.point;
        }
        let weights = [weight, 0.0, 0.0];
        *out.time += own
            .reference
            .pull_back(here.time, weights, &mut to.reference);
    });
}
