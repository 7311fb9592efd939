//! The terms of flexible bodies in the equations of all bodies: their share of M(q) v̇ − f(q, v),
//! of its derivatives, of the energy and of the momenta. A model without flexible bodies passes
//! through.

mod coordinates;
mod displacement;
mod form;
mod held;
mod strain_forces;
mod truncated;

pub use coordinates::{
    add_coordinates, add_unknown, add_unknowns, basis_of, clear_kinematics, coordinates,
    has_shells, is_divided, nodal_unknowns, rates, unknown_of,
};
pub use displacement::{MeanSquare, add_displacement, emit_displacement, pull_displacement};
pub use form::alone;
pub use held::{
    axial_strains, held, inside_out, of_lateral_moment, pull_energies, pull_momentum,
    pull_strain_energy, pull_stress_ratios, strain_energy, stress_ratios, turned,
};

pub use strain_forces::StrainForces;

use super::bodies::{self, BodyMotion};
use super::flexing::{self, Flexing, FlexingCotangent, Generalised};
use super::numbering::Numbering;
use super::{elastic, finite};
use crate::linalg::Emit;
use crate::math::{Scalar, Team, Vec3, rotation};
use crate::model::Model;
use crate::model::flexible::{FlexibleBody, Form, Inertia};
use coordinates::{accelerated, add_part, elastic_of, motion_of, part_of, slots};
use form::{emit_mass_of, inertial, pull_inertial, unlike};
use truncated::Beside;

/// Inertial forces of a body without those of the rigid body.
fn forces_of<S: Scalar>(
    body: &FlexibleBody<S>,
    at: &Flexing<S>,
    beside: &Beside<S>,
) -> Generalised<S> {
    match body.inertia {
        Inertia::Full => inertial(&body.form, at),
        Inertia::Paper => truncated::inertial(&body.form, at, beside),
    }
}

/// Transpose of the derivative of [`forces_of`], with that by the velocity of the origin (ground axes).
fn pull_forces_of(
    body: &FlexibleBody<f64>,
    (at, beside): (&Flexing<f64>, &Beside<f64>),
    psi: &Generalised<f64>,
    cot: &mut Form<f64>,
) -> (FlexingCotangent<f64>, Vec3<f64>) {
    match body.inertia {
        Inertia::Full => (pull_inertial(&body.form, at, psi, cot), Vec3::zeros()),
        Inertia::Paper => truncated::pull_back(&body.form, (at, beside), psi, cot),
    }
}

/// The ranks that compute a motion together.
pub fn team<S: Scalar>(model: &Model<S>) -> Team {
    let mut all = model.flexible.iter().filter_map(|body| match &body.form {
        Form::Finite(own) => Some(own.team.clone()),
        Form::Modal(_) => None,
    });
    all.next().unwrap_or_default()
}

/// Gives the bodies of finite elements to ranks that compute its motions together.
pub fn set_team<S: Scalar>(model: &mut Model<S>, team: &Team) {
    for body in &mut model.flexible {
        if let Form::Finite(own) = &mut body.form {
            own.team = team.clone();
        }
    }
}

/// lᵀ A r, where A are the derivatives of elastic and viscous forces of finite elements by coordinates, and by their rates,
/// for two vectors in velocity numbering.
pub fn strain_products<S: Scalar>(
    (model, numbering): (&Model<S>, &Numbering),
    motions: &[BodyMotion<S>],
    pair: [&[S]; 2],
) -> [S; 2] {
    let mut sums = [S::zero(); 2];
    for body in &model.flexible {
        if let Form::Finite(own) = &body.form {
            let moving = (&coordinates(body, motions)[..], &rates(body, motions)[..]);
            let [l, r] = pair.map(|x| elastic_of(numbering, body, x));
            let own = finite::strain_products(own, moving, [&l, &r]);
            sums = [sums[0] + own[0], sums[1] + own[1]];
        }
    }
    sums
}

/// A model whose finite elements have no strain energy; `None` if there are none.
pub fn without_strains<S: Scalar>(model: &Model<S>) -> Option<Model<S>> {
    let is_finite = |body: &FlexibleBody<S>| matches!(body.form, Form::Finite(_));
    model.flexible.iter().any(is_finite).then(|| {
        let mut out = model.clone();
        for body in &mut out.flexible {
            if let Form::Finite(own) = &mut body.form {
                *own = finite::without_strains(own);
            }
        }
        out
    })
}

/// Adds the terms of flexible bodies to M v̇ − f(q, v) at the accelerations `a`.
pub fn add_force_balances<S: Scalar>(
    model: &Model<S>,
    numbering: &Numbering,
    motions: &[BodyMotion<S>],
    a: &[S],
    out: &mut [S],
) {
    for body in &model.flexible {
        let at = motion_of(model, numbering, body, motions, a);
        let beside = Beside::of(model, &motions[body.frame]);
        let mut forces = forces_of(body, &at, &beside);
        match &body.form {
            Form::Modal(modal) => {
                elastic::add_forces(modal, &at.q, &at.rate, &mut forces.elastic);
            }
            Form::Finite(own) => {
                finite::add_forces(own, &at.q, &mut forces.elastic);
                finite::add_damping(own, (&at.q, &at.rate), &mut forces.elastic);
            }
        }
        let frame = (&forces.linear, &forces.angular);
        add_part(numbering, body, frame, &forces.elastic, out);
    }
}

/// Adds M(q) x of the flexible bodies.
pub fn add_mass_product<S: Scalar>(
    model: &Model<S>,
    numbering: &Numbering,
    motions: &[BodyMotion<S>],
    x: &[S],
    out: &mut [S],
) {
    for body in &model.flexible {
        let at = accelerated(numbering, body, motions, x);
        let forces = forces_of(body, &at, &Beside::none());
        let frame = (&forces.linear, &forces.angular);
        add_part(numbering, body, frame, &forces.elastic, out);
    }
}

/// As [`add_mass_product`] at the positions `q`.
pub fn add_mass_product_at<S: Scalar>(
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

/// T(q)⁺ (q − q'): the distance of positions from others, as velocities.
pub fn distance<S: Scalar>(numbering: &Numbering, q: &[S], from: &[S]) -> Vec<S> {
    let away: Vec<S> = q.iter().zip(from).map(|(&q, &from)| q - from).collect();
    let mut out = vec![S::zero(); numbering.velocities()];
    bodies::velocity_of_rates(numbering, q, &away, &mut out);
    out
}

/// Adds M(q) T(q)⁺ (q − q') of the flexible bodies at the positions q.
pub fn add_metric<S: Scalar>(
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

/// The coordinates at which a body has its mass matrix.
fn weighed<S: Scalar>(body: &FlexibleBody<S>, mut q: Vec<S>) -> Vec<S> {
    match body.inertia {
        Inertia::Full => {}
        Inertia::Paper => q.fill(S::zero()),
    }
    q
}

/// Emits the terms of flexible bodies in the mass matrix, times `scale`, at (`row`, `column`).
pub fn emit_mass<S: Scalar>(
    (model, numbering): (&Model<S>, &Numbering),
    motions: &[BodyMotion<S>],
    (row, column): (usize, usize),
    scale: S,
    emit: &mut dyn Emit<S>,
) {
    for body in &model.flexible {
        let rotation = &motions[body.frame].rotation;
        let q = weighed(body, coordinates(body, motions));
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
pub fn emit_mass_at<S: Scalar>(
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
        let elastic = weighed(body, elastic);
        let slots = slots(numbering, body);
        emit_mass_of(&body.form, (&rotation, &elastic), &slots, at, scale, emit);
    }
}

/// Emits the derivatives of the terms of flexible bodies in M v̇ − f(q, v) at constant
/// accelerations: in tangent positions times `by_y` at (row, y), in velocities times `by_v` at
/// (row, v).
pub fn emit_force_balances<S: Scalar>(
    (model, numbering): (&Model<S>, &Numbering),
    (motions, a): (&[BodyMotion<S>], &[S]),
    (row, y, v): (usize, usize, usize),
    (by_y, by_v): (S, S),
    emit: &mut dyn Emit<S>,
) {
    for body in &model.flexible {
        let at = motion_of(model, numbering, body, motions, a);
        let slots = slots(numbering, body);
        if body.inertia == Inertia::Paper {
            let at = (&at, &Beside::of(model, &motions[body.frame]));
            truncated::emit_jacobian(&body.form, at, &slots, (row, y, v), (by_y, by_v), emit);
            continue;
        }
        match &body.form {
            Form::Modal(modal) => {
                let (mut in_y, mut in_v) = flexing::jacobian(&modal.inertia, &at);
                elastic::add_jacobian(modal, (&at.q, &at.rate), &mut in_y, &mut in_v);
                in_y.emit(&slots, (row, y), by_y, emit);
                in_v.emit(&slots, (row, v), by_v, emit);
            }
            Form::Finite(own) => {
                finite::emit_jacobian(own, &at, &slots, (row, y, v), (by_y, by_v), emit);
            }
        }
    }
}

/// Where cotangents of positions and velocities go; `None` if not wanted.
pub struct StateCotangent<'a> {
    /// Tangent positions.
    pub y: Option<&'a mut [f64]>,
    /// Velocities.
    pub v: Option<&'a mut [f64]>,
}

/// Pulls the cotangent ψ of [`add_force_balances`] back to positions, velocities and parameters.
pub fn pull_force_balances(
    (model, numbering): (&Model<f64>, &Numbering),
    (motions, a): (&[BodyMotion<f64>], &[f64]),
    psi: &[f64],
    state: &mut StateCotangent,
    cot: &mut Model<f64>,
) {
    for (body, own) in model.flexible.iter().zip(&mut cot.flexible) {
        let at = motion_of(model, numbering, body, motions, a);
        let psi = part_of(numbering, body, psi);
        let beside = Beside::of(model, &motions[body.frame]);
        let (mut by, velocity) = pull_forces_of(body, (&at, &beside), &psi, &mut own.form);
        match (&body.form, &mut own.form) {
            (Form::Modal(modal), Form::Modal(own)) => {
                let elastic = (&mut by.q[..], &mut by.rate[..]);
                elastic::pull_forces(modal, (&at.q, &at.rate), &psi.elastic, elastic, own);
            }
            (Form::Finite(finite), Form::Finite(own)) => {
                let wanted = state.y.is_some();
                let by_q = wanted.then_some(&mut by.q[..]);
                finite::pull_forces(finite, (&at.q, &psi.elastic), by_q, own);
                let motion = (&at.q[..], &at.rate[..], &psi.elastic[..]);
                finite::pull_damping(finite, motion, (&mut by.q, &mut by.rate), own);
            }
            (Form::Modal(_), Form::Finite(_)) | (Form::Finite(_), Form::Modal(_)) => unlike(),
        }
        cot.gravity += by.gravity;
        let still = Vec3::zeros();
        if let Some(y) = state.y.as_deref_mut() {
            add_part(numbering, body, (&still, &by.theta), &by.q, y);
        }
        if let Some(v) = state.v.as_deref_mut() {
            add_part(numbering, body, (&velocity, &by.omega), &by.rate, v);
        }
    }
}

/// Pulls ψᵀ M(q) x of the flexible bodies back to tangent positions and parameters.
pub fn pull_mass_product(
    (model, numbering): (&Model<f64>, &Numbering),
    motions: &[BodyMotion<f64>],
    (psi, x): (&[f64], &[f64]),
    y: &mut [f64],
    cot: &mut Model<f64>,
) {
    for (body, own) in model.flexible.iter().zip(&mut cot.flexible) {
        let at = accelerated(numbering, body, motions, x);
        let psi = part_of(numbering, body, psi);
        let still = (&at, &Beside::none());
        let (by, _) = pull_forces_of(body, still, &psi, &mut own.form);
        add_part(numbering, body, (&Vec3::zeros(), &by.theta), &by.q, y);
    }
}
