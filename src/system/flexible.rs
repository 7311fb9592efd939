//! What flexible bodies add to the equations of all bodies: their share of M(q) v̇ − f(q, v), of its
//! derivatives, of the energy and of the momenta. A model without flexible bodies passes through.

use super::bodies::{self, BodyMotion};
use super::elastic;
use super::flexing::{self, Block, Flexing, Generalised};
use super::numbering::Numbering;
use crate::linalg::Emit;
use crate::math::{Scalar, Vec3, rotation};
use crate::model::Model;
use crate::model::flexible::FlexibleBody;

/// Where the coordinates of a flexible body stand among the velocities: six of the frame, then the
/// elastic ones.
fn slots<S: Scalar>(numbering: &Numbering, body: &FlexibleBody<S>) -> Vec<usize> {
    let frame = numbering.velocity(body.frame);
    let elastic = (body.places()).map(|(carrier, k)| numbering.velocity(carrier) + k);
    (frame..frame + 6).chain(elastic).collect()
}

/// Elastic components of a vector in velocity numbering.
fn elastic_of<S: Scalar>(numbering: &Numbering, body: &FlexibleBody<S>, x: &[S]) -> Vec<S> {
    let places = body.places();
    places
        .map(|(carrier, k)| x[numbering.velocity(carrier) + k])
        .collect()
}

/// The part of a vector in velocity numbering that belongs to a flexible body.
fn part_of<S: Scalar>(numbering: &Numbering, body: &FlexibleBody<S>, x: &[S]) -> Generalised<S> {
    let o = numbering.velocity(body.frame);
    Generalised {
        linear: Vec3::new(x[o], x[o + 1], x[o + 2]),
        angular: Vec3::new(x[o + 3], x[o + 4], x[o + 5]),
        elastic: elastic_of(numbering, body, x),
    }
}

/// Adds parts to a vector in velocity numbering.
fn add_part<S: Scalar>(
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
pub(crate) fn add_coordinates<S: Scalar>(
    numbering: &Numbering,
    body: &FlexibleBody<S>,
    elastic: &[S],
    out: &mut [S],
) {
    for ((carrier, k), &x) in body.places().zip(elastic) {
        out[numbering.velocity(carrier) + k] += x;
    }
}

/// Elastic coordinates of a body in motion.
pub(crate) fn coordinates<S: Scalar>(body: &FlexibleBody<S>, motions: &[BodyMotion<S>]) -> Vec<S> {
    let places = body.places();
    places
        .map(|(carrier, k)| motions[carrier].position[k])
        .collect()
}

/// Their rates.
pub(crate) fn rates<S: Scalar>(body: &FlexibleBody<S>, motions: &[BodyMotion<S>]) -> Vec<S> {
    let places = body.places();
    places
        .map(|(carrier, k)| motions[carrier].velocity[k])
        .collect()
}

/// The motion of a flexible body at the accelerations `a` (velocity numbering).
fn flexing<S: Scalar>(
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
fn accelerated<S: Scalar>(
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

/// Adds what flexible bodies add to M v̇ − f(q, v) at the accelerations `a`.
pub(crate) fn add_force_balances<S: Scalar>(
    model: &Model<S>,
    numbering: &Numbering,
    motions: &[BodyMotion<S>],
    a: &[S],
    out: &mut [S],
) {
    for body in &model.flexible {
        let at = flexing(model, numbering, body, motions, a);
        let mut forces = flexing::inertial(&body.inertia, &at);
        elastic::add_forces(body, &at.q, &at.rate, &mut forces.elastic);
        let frame = (&forces.linear, &forces.angular);
        add_part(numbering, body, frame, &forces.elastic, out);
    }
}

/// Adds M(q) x of the flexible bodies.
pub(crate) fn add_mass_product<S: Scalar>(
    model: &Model<S>,
    numbering: &Numbering,
    motions: &[BodyMotion<S>],
    x: &[S],
    out: &mut [S],
) {
    for body in &model.flexible {
        let at = accelerated(numbering, body, motions, x);
        let forces = flexing::inertial(&body.inertia, &at);
        let frame = (&forces.linear, &forces.angular);
        add_part(numbering, body, frame, &forces.elastic, out);
    }
}

/// As [`add_mass_product`] at the positions `q`.
pub(crate) fn add_mass_product_at<S: Scalar>(
    model: &Model<S>,
    numbering: &Numbering,
    q: &[S],
    x: &[S],
    out: &mut [S],
) {
    if model.flexible.is_empty() {
        return;
    }
    let mut motions = Vec::new();
    let still = vec![S::zero(); numbering.velocities()];
    BodyMotion::all(numbering, q, &still, &mut motions);
    add_mass_product(model, numbering, &motions, x, out);
}

/// T(q)⁺ (q − q'): how far positions are from others, as velocities.
pub(crate) fn distance<S: Scalar>(numbering: &Numbering, q: &[S], from: &[S]) -> Vec<S> {
    let away: Vec<S> = q.iter().zip(from).map(|(&q, &from)| q - from).collect();
    let mut out = vec![S::zero(); numbering.velocities()];
    bodies::velocity_of_rates(numbering, q, &away, &mut out);
    out
}

/// Adds M(q) T(q)⁺ (q − q') of the flexible bodies, which stand at q.
pub(crate) fn add_metric<S: Scalar>(
    (model, numbering): (&Model<S>, &Numbering),
    motions: &[BodyMotion<S>],
    (q, from): (&[S], &[S]),
    out: &mut [S],
) {
    if !model.flexible.is_empty() {
        let away = distance(numbering, q, from);
        add_mass_product(model, numbering, motions, &away, out);
    }
}

/// Emits what flexible bodies add to the mass matrix, times `scale`, at (`row`, `column`).
pub(crate) fn emit_mass<S: Scalar>(
    (model, numbering): (&Model<S>, &Numbering),
    motions: &[BodyMotion<S>],
    (row, column): (usize, usize),
    scale: S,
    emit: &mut dyn Emit<S>,
) {
    for body in &model.flexible {
        let rotation = &motions[body.frame].rotation;
        let q = coordinates(body, motions);
        let block = flexing::mass(&body.inertia, rotation, &q);
        emit_block(&slots(numbering, body), &block, (row, column), scale, emit);
    }
}

/// As [`emit_mass`] at the positions `q`.
pub(crate) fn emit_mass_at<S: Scalar>(
    (model, numbering): (&Model<S>, &Numbering),
    q: &[S],
    at: (usize, usize),
    scale: S,
    emit: &mut dyn Emit<S>,
) {
    for body in &model.flexible {
        let o = numbering.position(body.frame) + 3;
        let rotation = rotation::matrix(&[q[o], q[o + 1], q[o + 2], q[o + 3]]);
        let places = body.places();
        let elastic: Vec<S> = places
            .map(|(carrier, k)| q[numbering.position(carrier) + k])
            .collect();
        let block = flexing::mass(&body.inertia, &rotation, &elastic);
        emit_block(&slots(numbering, body), &block, at, scale, emit);
    }
}

/// Emits the derivatives of what flexible bodies add to M v̇ − f(q, v), the accelerations held: in
/// tangent positions times `by_y` at (row, y), in velocities times `by_v` at (row, v).
pub(crate) fn emit_force_balances<S: Scalar>(
    (model, numbering): (&Model<S>, &Numbering),
    (motions, a): (&[BodyMotion<S>], &[S]),
    (row, y, v): (usize, usize, usize),
    (by_y, by_v): (S, S),
    emit: &mut dyn Emit<S>,
) {
    for body in &model.flexible {
        let at = flexing(model, numbering, body, motions, a);
        let (mut in_y, mut in_v) = flexing::jacobian(&body.inertia, &at);
        elastic::add_jacobian(body, &at.q, &mut in_y, &mut in_v);
        let slots = slots(numbering, body);
        emit_block(&slots, &in_y, (row, y), by_y, emit);
        emit_block(&slots, &in_v, (row, v), by_v, emit);
    }
}

fn emit_block<S: Scalar>(
    slots: &[usize],
    block: &Block<S>,
    (row, column): (usize, usize),
    scale: S,
    emit: &mut dyn Emit<S>,
) {
    let mut entries = block.entries.iter();
    for i in slots {
        for (j, &x) in slots.iter().zip(&mut entries) {
            emit.add(row + i, column + j, x * scale);
        }
    }
}

/// Where cotangents of positions and velocities go; `None` if not wanted.
pub(crate) struct StateCotangent<'a> {
    /// Tangent positions.
    pub y: Option<&'a mut [f64]>,
    /// Velocities.
    pub v: Option<&'a mut [f64]>,
}

/// Pulls the cotangent ψ of [`add_force_balances`] back to positions, velocities and parameters.
pub(crate) fn pull_force_balances(
    (model, numbering): (&Model<f64>, &Numbering),
    (motions, a): (&[BodyMotion<f64>], &[f64]),
    psi: &[f64],
    state: &mut StateCotangent,
    cot: &mut Model<f64>,
) {
    for (body, own) in model.flexible.iter().zip(&mut cot.flexible) {
        let at = flexing(model, numbering, body, motions, a);
        let psi = part_of(numbering, body, psi);
        let mut by = flexing::pull_back(&body.inertia, &at, &psi, &mut own.inertia);
        let elastic = (&mut by.q[..], &mut by.rate[..]);
        elastic::pull_forces(body, (&at.q, &at.rate), &psi.elastic, elastic, own);
        cot.gravity += by.gravity;
        let still = Vec3::zeros();
        if let Some(y) = state.y.as_deref_mut() {
            add_part(numbering, body, (&still, &by.theta), &by.q, y);
        }
        if let Some(v) = state.v.as_deref_mut() {
            add_part(numbering, body, (&still, &by.omega), &by.rate, v);
        }
    }
}

/// Pulls ψᵀ M(q) x of the flexible bodies back to tangent positions and parameters.
pub(crate) fn pull_mass_product(
    (model, numbering): (&Model<f64>, &Numbering),
    motions: &[BodyMotion<f64>],
    (psi, x): (&[f64], &[f64]),
    y: &mut [f64],
    cot: &mut Model<f64>,
) {
    for (body, own) in model.flexible.iter().zip(&mut cot.flexible) {
        let at = accelerated(numbering, body, motions, x);
        let psi = part_of(numbering, body, psi);
        let by = flexing::pull_back(&body.inertia, &at, &psi, &mut own.inertia);
        add_part(numbering, body, (&Vec3::zeros(), &by.theta), &by.q, y);
    }
}

/// Weights of the elastic coordinates in the displacement that the assembly makes least: the diagonal of
/// ∫ N_Iᵀ N_J dm.
fn weights<S: Scalar>(body: &FlexibleBody<S>) -> impl Iterator<Item = S> + '_ {
    let inertia = &body.inertia;
    (0..body.modes()).map(|i| inertia.products[inertia.place(i, i).0].trace())
}

/// Adds the gradient of ½ Σ w_I (q_I − q_I')², q' the start, to tangent positions; `q` are positions.
pub(crate) fn add_displacement<S: Scalar>(
    model: &Model<S>,
    numbering: &Numbering,
    q: &[S],
    out: &mut [S],
) {
    for body in &model.flexible {
        for ((carrier, k), weight) in body.places().zip(weights(body)) {
            let moved = q[numbering.position(carrier) + k] - model.bodies[carrier].position[k];
            out[numbering.velocity(carrier) + k] += weight * moved;
        }
    }
}

/// Emits the second derivative of that.
pub(crate) fn emit_displacement<S: Scalar>(
    model: &Model<S>,
    numbering: &Numbering,
    emit: &mut dyn Emit<S>,
) {
    for body in &model.flexible {
        // Entries come in the order of those of the mass matrix.
        let mut block = Block::zero(body.modes());
        for (i, weight) in weights(body).enumerate() {
            block.add(6 + i, 6 + i, weight);
        }
        emit_block(&slots(numbering, body), &block, (0, 0), S::one(), emit);
    }
}

/// Pulls ψ · [`add_displacement`] back to the start and to the weights.
pub(crate) fn pull_displacement(
    model: &Model<f64>,
    numbering: &Numbering,
    (q, psi): (&[f64], &[f64]),
    cot: &mut Model<f64>,
) {
    for (body, own) in model.flexible.iter().zip(&mut cot.flexible) {
        for (i, ((carrier, k), weight)) in body.places().zip(weights(body)).enumerate() {
            let moved = q[numbering.position(carrier) + k] - model.bodies[carrier].position[k];
            let psi = psi[numbering.velocity(carrier) + k];
            let place = own.inertia.place(i, i).0;
            for d in 0..3 {
                own.inertia.products[place][(d, d)] += psi * moved;
            }
            cot.bodies[carrier].position[k] -= psi * weight;
        }
    }
}

/// What flexible bodies add to energy and momenta.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Held<S> {
    /// Kinetic energy \[J\].
    pub kinetic: S,
    /// Gravity's and strain energy \[J\].
    pub potential: S,
    /// Linear momentum, ground axes \[kg m/s\].
    pub momentum: Vec3<S>,
    /// Angular momentum about the origin, ground axes \[kg m²/s\].
    pub angular_momentum: Vec3<S>,
}

/// Energy and momenta that flexible bodies add to those of the rigid ones.
pub(crate) fn held<S: Scalar>(model: &Model<S>, motions: &[BodyMotion<S>]) -> Held<S> {
    let mut out = Held {
        kinetic: S::zero(),
        potential: S::zero(),
        momentum: Vec3::zeros(),
        angular_momentum: Vec3::zeros(),
    };
    for body in &model.flexible {
        let frame = &motions[body.frame];
        let at = at_rest(body, motions);
        let nu = frame.rotation.tr_mul(&frame.velocity);
        let moving = flexing::moving(&body.inertia, &at, &nu);
        let momentum = frame.rotation * moving.momentum;
        out.kinetic += moving.kinetic;
        out.momentum += momentum;
        out.angular_momentum += frame.position.cross(&momentum) + frame.rotation * moving.spin;
        let moment = frame.rotation * flexing::first_moment(body, &at.q);
        out.potential += elastic::energy(&body.stiffness, &at.q) - model.gravity.dot(&moment);
    }
    out
}

/// Strain energy of one flexible body \[J\].
pub(crate) fn strain_energy<S: Scalar>(body: &FlexibleBody<S>, motions: &[BodyMotion<S>]) -> S {
    elastic::energy(&body.stiffness, &coordinates(body, motions))
}

/// Adds `scale` times the derivative of the strain energy of flexible body `i` to tangent positions and
/// parameters.
pub(crate) fn pull_strain_energy(
    (model, numbering): (&Model<f64>, &Numbering),
    motions: &[BodyMotion<f64>],
    (i, scale): (usize, f64),
    y: &mut [f64],
    cot: &mut Model<f64>,
) {
    let (body, own) = (&model.flexible[i], &mut cot.flexible[i]);
    let q = coordinates(body, motions);
    let mut by_q = vec![0.0; q.len()];
    elastic::pull_energy(&body.stiffness, &q, scale, &mut by_q, &mut own.stiffness);
    let still = Vec3::zeros();
    add_part(numbering, body, (&still, &still), &by_q, y);
}

/// Adds the derivatives of the kinetic energy times the first and of the potential energy times the
/// second of `scales`, as in [`held`].
pub(crate) fn pull_energies(
    (model, numbering): (&Model<f64>, &Numbering),
    motions: &[BodyMotion<f64>],
    [kinetic, potential]: [f64; 2],
    (y, v): (&mut [f64], &mut [f64]),
    cot: &mut Model<f64>,
) {
    let still = Vec3::zeros();
    for (i, body) in model.flexible.iter().enumerate() {
        let frame = &motions[body.frame];
        let at = at_rest(body, motions);
        let nu = frame.rotation.tr_mul(&frame.velocity);
        let own = &mut cot.flexible[i].inertia;
        let (by, velocity) = flexing::pull_kinetic(&body.inertia, &at, &nu, kinetic, own);
        add_part(numbering, body, (&still, &by.theta), &by.q, y);
        add_part(numbering, body, (&velocity, &by.omega), &by.rate, v);
        // −g · R p.
        let down = frame.rotation.tr_mul(&model.gravity) * -potential;
        let p = flexing::first_moment(body, &at.q);
        cot.gravity -= frame.rotation * p * potential;
        own.centre += down;
        let mut by_q = Vec::with_capacity(at.q.len());
        for ((p, by_p), &q) in (body.inertia.static_moments.iter())
            .zip(&mut own.static_moments)
            .zip(&at.q)
        {
            by_q.push(down.dot(p));
            *by_p += down * q;
        }
        add_part(numbering, body, (&still, &p.cross(&down)), &by_q, y);
        pull_strain_energy((model, numbering), motions, (i, potential), y, cot);
    }
}

/// Adds the derivatives of the linear momentum of the flexible bodies, as in [`held`], along a vector in
/// ground axes.
pub(crate) fn pull_momentum(
    (model, numbering): (&Model<f64>, &Numbering),
    motions: &[BodyMotion<f64>],
    along: &Vec3<f64>,
    (y, v): (&mut [f64], &mut [f64]),
    cot: &mut Model<f64>,
) {
    let still = Vec3::zeros();
    for (body, own) in model.flexible.iter().zip(&mut cot.flexible) {
        let (frame, at) = (&motions[body.frame], at_rest(body, motions));
        // R (ω × p + ṗ) · d with p = Σ q_I p_I.
        let own_along = frame.rotation.tr_mul(along);
        let turned = own_along.cross(&at.omega);
        let p = flexing::first_moment(body, &at.q);
        let nu = Vec3::zeros();
        let momentum = flexing::moving(&body.inertia, &at, &nu).momentum;
        let moments = &body.inertia.static_moments;
        let by_q: Vec<f64> = moments.iter().map(|p| p.dot(&turned)).collect();
        let by_rate: Vec<f64> = moments.iter().map(|p| p.dot(&own_along)).collect();
        add_part(
            numbering,
            body,
            (&still, &momentum.cross(&own_along)),
            &by_q,
            y,
        );
        add_part(numbering, body, (&still, &p.cross(&own_along)), &by_rate, v);
        own.inertia.centre += turned;
        let rates = at.q.iter().zip(&at.rate);
        for (by, (q, rate)) in own.inertia.static_moments.iter_mut().zip(rates) {
            *by += turned * *q + own_along * *rate;
        }
    }
}

/// The motion of a flexible body without accelerations.
fn at_rest<S: Scalar>(body: &FlexibleBody<S>, motions: &[BodyMotion<S>]) -> Flexing<S> {
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
