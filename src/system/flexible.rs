//! What flexible bodies add to the equations of all bodies: their share of M(q) v̇ − f(q, v), of its
//! derivatives, of the energy and of the momenta. A model without flexible bodies passes through.

use super::bodies::{self, BodyMotion};
use super::elastic;
use super::finite;
use super::flexing::{self, Block, Flexing, FlexingCotangent, Generalised, Moving};
use super::numbering::Numbering;
use crate::linalg::Emit;
use crate::math::{Mat3, Scalar, Vec3, rotation};
use crate::model::Model;
use crate::model::flexible::{FlexibleBody, Form};

/// Where the coordinates of a flexible body stand among the velocities: six of the frame, then the
/// elastic ones.
fn slots<S: Scalar>(numbering: &Numbering, body: &FlexibleBody<S>) -> Vec<usize> {
    let frame = numbering.velocity(body.frame);
    let elastic = (body.places()).map(|(carrier, k)| numbering.velocity(carrier) + k);
    (frame..frame + 6).chain(elastic).collect()
}

/// Whether some body has finite elements.
pub(crate) fn has_nodes<S: Scalar>(model: &Model<S>) -> bool {
    let finite = |body: &FlexibleBody<S>| match body.form {
        Form::Modal(_) => false,
        Form::Finite(_) => true,
    };
    model.flexible.iter().any(finite)
}

/// Unknowns of the coordinates of finite elements, in an order of little fill.
pub(crate) fn nodal_unknowns<S: Scalar>(model: &Model<S>, numbering: &Numbering) -> Vec<usize> {
    let mut all = Vec::new();
    for body in &model.flexible {
        match &body.form {
            Form::Modal(_) => {}
            Form::Finite(_) => {
                all.extend((body.places()).map(|(carrier, k)| numbering.unknown(carrier) + k));
            }
        }
    }
    all
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
        let mut forces = inertial(&body.form, &at);
        match &body.form {
            Form::Modal(modal) => {
                elastic::add_forces(modal, &at.q, &at.rate, &mut forces.elastic);
            }
            Form::Finite(own) => finite::add_forces(own, &at.q, &mut forces.elastic),
        }
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
        let forces = inertial(&body.form, &at);
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
        let slots = slots(numbering, body);
        emit_mass_of(
            &body.form,
            (rotation, &q),
            &slots,
            (row, column),
            scale,
            emit,
        );
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
        let slots = slots(numbering, body);
        emit_mass_of(&body.form, (&rotation, &elastic), &slots, at, scale, emit);
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
        let slots = slots(numbering, body);
        match &body.form {
            Form::Modal(modal) => {
                let (mut in_y, mut in_v) = flexing::jacobian(&modal.inertia, &at);
                elastic::add_jacobian(modal, &at.q, &mut in_y, &mut in_v);
                emit_block(&slots, &in_y, (row, y), by_y, emit);
                emit_block(&slots, &in_v, (row, v), by_v, emit);
            }
            Form::Finite(own) => {
                finite::emit_jacobian(own, &at, &slots, (row, y, v), (by_y, by_v), emit);
            }
        }
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
        let mut by = pull_inertial(&body.form, &at, &psi, &mut own.form);
        match (&body.form, &mut own.form) {
            (Form::Modal(modal), Form::Modal(own)) => {
                let elastic = (&mut by.q[..], &mut by.rate[..]);
                elastic::pull_forces(modal, (&at.q, &at.rate), &psi.elastic, elastic, own);
            }
            (Form::Finite(finite), Form::Finite(own)) => {
                finite::pull_forces(finite, (&at.q, &psi.elastic), &mut by.q, own);
            }
            (Form::Modal(_), Form::Finite(_)) | (Form::Finite(_), Form::Modal(_)) => unlike(),
        }
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
        let by = pull_inertial(&body.form, &at, &psi, &mut own.form);
        add_part(numbering, body, (&Vec3::zeros(), &by.theta), &by.q, y);
    }
}

/// Weights of the elastic coordinates in the displacement that the assembly makes least: the diagonal of
/// ∫ N_Iᵀ N_J dm.
fn weights<S: Scalar>(form: &Form<S>) -> Vec<S> {
    match form {
        Form::Modal(modal) => {
            let (inertia, m) = (&modal.inertia, modal.inertia.static_moments.len());
            let trace = |i: usize| inertia.products[inertia.place(i, i).0].trace();
            (0..m).map(trace).collect()
        }
        Form::Finite(own) => finite::weights(own),
    }
}

/// Transpose of the derivative of [`weights`].
fn pull_weights(form: &Form<f64>, by: &[f64], cot: &mut Form<f64>) {
    match (form, cot) {
        (Form::Modal(_), Form::Modal(own)) => {
            for (i, by) in by.iter().enumerate() {
                let place = own.inertia.place(i, i).0;
                for d in 0..3 {
                    own.inertia.products[place][(d, d)] += by;
                }
            }
        }
        (Form::Finite(own), Form::Finite(cot)) => finite::pull_weights(own, by, cot),
        (Form::Modal(_), Form::Finite(_)) | (Form::Finite(_), Form::Modal(_)) => unlike(),
    }
}

/// Adds the gradient of ½ Σ w_I (q_I − q_I')², q' the start, to tangent positions; `q` are positions.
pub(crate) fn add_displacement<S: Scalar>(
    model: &Model<S>,
    numbering: &Numbering,
    q: &[S],
    out: &mut [S],
) {
    for body in &model.flexible {
        for ((carrier, k), weight) in body.places().zip(weights(&body.form)) {
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
        let slots = slots(numbering, body);
        match &body.form {
            Form::Modal(_) => {
                // Entries come in the order of those of the mass matrix.
                let mut block = Block::zero(body.modes());
                for (i, weight) in weights(&body.form).into_iter().enumerate() {
                    block.add(6 + i, 6 + i, weight);
                }
                emit_block(&slots, &block, (0, 0), S::one(), emit);
            }
            Form::Finite(own) => finite::emit_weights(own, &slots, emit),
        }
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
        let mut by = Vec::with_capacity(body.modes());
        for ((carrier, k), weight) in body.places().zip(weights(&body.form)) {
            let moved = q[numbering.position(carrier) + k] - model.bodies[carrier].position[k];
            let psi = psi[numbering.velocity(carrier) + k];
            by.push(psi * moved);
            cot.bodies[carrier].position[k] -= psi * weight;
        }
        pull_weights(&body.form, &by, &mut own.form);
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
        let moving = moving(&body.form, &at, &nu);
        let momentum = frame.rotation * moving.momentum;
        out.kinetic += moving.kinetic;
        out.momentum += momentum;
        out.angular_momentum += frame.position.cross(&momentum) + frame.rotation * moving.spin;
        let moment = frame.rotation * first_moment(&body.form, &at.q);
        out.potential += elastic_energy(&body.form, &at.q) - model.gravity.dot(&moment);
    }
    out
}

/// Strain energy of one flexible body \[J\].
pub(crate) fn strain_energy<S: Scalar>(body: &FlexibleBody<S>, motions: &[BodyMotion<S>]) -> S {
    elastic_energy(&body.form, &coordinates(body, motions))
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
    match (&body.form, &mut own.form) {
        (Form::Modal(modal), Form::Modal(own)) => {
            elastic::pull_energy(&modal.stiffness, &q, scale, &mut by_q, &mut own.stiffness);
        }
        (Form::Finite(finite), Form::Finite(own)) => {
            finite::pull_energy(finite, &q, scale, &mut by_q, own);
        }
        (Form::Modal(_), Form::Finite(_)) | (Form::Finite(_), Form::Modal(_)) => unlike(),
    }
    let still = Vec3::zeros();
    add_part(numbering, body, (&still, &still), &by_q, y);
}

/// Von Mises stress by yield stress at the points of some elements of a body of finite elements; none of
/// others.
pub(crate) fn stress_ratios<S: Scalar>(
    body: &FlexibleBody<S>,
    motions: &[BodyMotion<S>],
    elements: &[usize],
) -> Vec<S> {
    match &body.form {
        Form::Modal(_) => Vec::new(),
        Form::Finite(own) => finite::stress_ratios(own, &coordinates(body, motions), elements),
    }
}

/// Transpose of the derivative of [`stress_ratios`] of flexible body `i`, for the cotangents `bar`.
pub(crate) fn pull_stress_ratios(
    (model, numbering): (&Model<f64>, &Numbering),
    motions: &[BodyMotion<f64>],
    (i, elements, bar): (usize, &[usize], &[f64]),
    y: &mut [f64],
    cot: &mut Model<f64>,
) {
    let (body, own) = (&model.flexible[i], &mut cot.flexible[i]);
    let q = coordinates(body, motions);
    let mut by_q = vec![0.0; q.len()];
    match (&body.form, &mut own.form) {
        (Form::Modal(_), Form::Modal(_)) => {}
        (Form::Finite(finite), Form::Finite(own)) => {
            finite::pull_stress_ratios(finite, (&q, elements), bar, &mut by_q, own);
        }
        (Form::Modal(_), Form::Finite(_)) | (Form::Finite(_), Form::Modal(_)) => unlike(),
    }
    add_coordinates(numbering, body, &by_q, y);
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
        let own = &mut cot.flexible[i].form;
        let (by, velocity) = pull_kinetic(&body.form, &at, &nu, kinetic, own);
        add_part(numbering, body, (&still, &by.theta), &by.q, y);
        add_part(numbering, body, (&velocity, &by.omega), &by.rate, v);
        // −g · R p.
        let down = frame.rotation.tr_mul(&model.gravity) * -potential;
        let p = first_moment(&body.form, &at.q);
        cot.gravity -= frame.rotation * p * potential;
        let mut by_q = vec![0.0; at.q.len()];
        pull_first_moment(&body.form, (&at.q, true), &down, &mut by_q, own);
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
        let p = first_moment(&body.form, &at.q);
        let nu = Vec3::zeros();
        let momentum = moving(&body.form, &at, &nu).momentum;
        let (mut by_q, mut by_rate) = (vec![0.0; at.q.len()], vec![0.0; at.q.len()]);
        let form = &mut own.form;
        pull_first_moment(&body.form, (&at.q, true), &turned, &mut by_q, form);
        pull_first_moment(
            &body.form,
            (&at.rate, false),
            &own_along,
            &mut by_rate,
            form,
        );
        add_part(
            numbering,
            body,
            (&still, &momentum.cross(&own_along)),
            &by_q,
            y,
        );
        add_part(numbering, body, (&still, &p.cross(&own_along)), &by_rate, v);
    }
}

/// A cotangent has the form of its body.
fn unlike() -> ! {
    unreachable!("a cotangent has the form of its body")
}

/// Inertial forces without those of the rigid body.
fn inertial<S: Scalar>(form: &Form<S>, at: &Flexing<S>) -> Generalised<S> {
    match form {
        Form::Modal(modal) => flexing::inertial(&modal.inertia, at),
        Form::Finite(own) => finite::inertial(own, at),
    }
}

/// Transpose of the derivative of [`inertial`].
fn pull_inertial(
    form: &Form<f64>,
    at: &Flexing<f64>,
    psi: &Generalised<f64>,
    cot: &mut Form<f64>,
) -> FlexingCotangent<f64> {
    match (form, cot) {
        (Form::Modal(modal), Form::Modal(own)) => {
            flexing::pull_back(&modal.inertia, at, psi, &mut own.inertia)
        }
        (Form::Finite(own), Form::Finite(cot)) => finite::pull_back(own, at, psi, cot),
        (Form::Modal(_), Form::Finite(_)) | (Form::Finite(_), Form::Modal(_)) => unlike(),
    }
}

/// Kinetic energy and momenta without those of the rigid body.
fn moving<S: Scalar>(form: &Form<S>, at: &Flexing<S>, nu: &Vec3<S>) -> Moving<S> {
    match form {
        Form::Modal(modal) => flexing::moving(&modal.inertia, at, nu),
        Form::Finite(own) => finite::moving(own, at, nu),
    }
}

/// Transpose of the derivative of the kinetic energy, times `scale`.
fn pull_kinetic(
    form: &Form<f64>,
    at: &Flexing<f64>,
    nu: &Vec3<f64>,
    scale: f64,
    cot: &mut Form<f64>,
) -> (FlexingCotangent<f64>, Vec3<f64>) {
    match (form, cot) {
        (Form::Modal(modal), Form::Modal(own)) => {
            flexing::pull_kinetic(&modal.inertia, at, nu, scale, &mut own.inertia)
        }
        (Form::Finite(own), Form::Finite(cot)) => finite::pull_kinetic(own, at, nu, scale, cot),
        (Form::Modal(_), Form::Finite(_)) | (Form::Finite(_), Form::Modal(_)) => unlike(),
    }
}

/// Static moment of the deformed body about the frame's origin, axes of the frame \[kg m\].
fn first_moment<S: Scalar>(form: &Form<S>, q: &[S]) -> Vec3<S> {
    match form {
        Form::Modal(modal) => flexing::static_moment(&modal.inertia, S::one(), q),
        Form::Finite(own) => finite::first_moment(own, q),
    }
}

/// Pulls w · [`first_moment`] back, of the deformed places if `placed`, else of displacements `q` alone.
fn pull_first_moment(
    form: &Form<f64>,
    (q, placed): (&[f64], bool),
    w: &Vec3<f64>,
    by_q: &mut [f64],
    cot: &mut Form<f64>,
) {
    match (form, cot) {
        (Form::Modal(modal), Form::Modal(own)) => {
            if placed {
                own.inertia.centre += w;
            }
            let moments = modal.inertia.static_moments.iter();
            for (((p, by_p), &q), by_q) in moments
                .zip(&mut own.inertia.static_moments)
                .zip(q)
                .zip(by_q)
            {
                *by_q += w.dot(p);
                *by_p += w * q;
            }
        }
        (Form::Finite(own), Form::Finite(cot)) => {
            finite::pull_first_moment(own, (q, placed), w, by_q, cot);
        }
        (Form::Modal(_), Form::Finite(_)) | (Form::Finite(_), Form::Modal(_)) => unlike(),
    }
}

/// Strain energy at elastic coordinates \[J\].
fn elastic_energy<S: Scalar>(form: &Form<S>, q: &[S]) -> S {
    match form {
        Form::Modal(modal) => elastic::energy(&modal.stiffness, q),
        Form::Finite(own) => finite::energy(own, q),
    }
}

/// Emits the mass matrix of a body without that of the rigid body.
fn emit_mass_of<S: Scalar>(
    form: &Form<S>,
    (rotation, q): (&Mat3<S>, &[S]),
    slots: &[usize],
    at: (usize, usize),
    scale: S,
    emit: &mut dyn Emit<S>,
) {
    match form {
        Form::Modal(modal) => {
            let block = flexing::mass(&modal.inertia, rotation, q);
            emit_block(slots, &block, at, scale, emit);
        }
        Form::Finite(own) => finite::emit_mass(own, (rotation, q), slots, at, scale, emit),
    }
}

/// Stiffness and mass of each elastic coordinate by itself, and its damping.
pub(crate) fn alone<S: Scalar>(body: &FlexibleBody<S>) -> Vec<[S; 3]> {
    let weights = weights(&body.form);
    match &body.form {
        Form::Modal(modal) => {
            let m = weights.len();
            let own = |i: usize| {
                let diagonal = i * (m + 1);
                [
                    modal.stiffness.linear[diagonal],
                    weights[i],
                    modal.damping[diagonal],
                ]
            };
            (0..m).map(own).collect()
        }
        Form::Finite(own) => {
            let both = finite::diagonal(own).into_iter().zip(weights);
            both.map(|(k, m)| [k, m, S::zero()]).collect()
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
