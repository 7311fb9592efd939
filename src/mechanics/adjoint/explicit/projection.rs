//! The projections of a step, backwards.

use super::sweep::Sweep;
use crate::adjoint::sensitivity::Sensitivity;
use crate::integrate::explicit::{NodeView, StepView};
use crate::math::{Vec3, rotation};
use crate::model::Model;
use crate::system::accelerations::Accelerations;
use crate::system::bodies::{self, positions_of, velocities_of};
use crate::system::flexible;

/// Largest number of refinement steps. A correction of 1e-6 needs two.
const REFINEMENTS: usize = 40;

/// Pulls the cotangents of the projected state (`sweep.of`) back to the state before the
/// projection. `field` is evaluated and factorised at the projected state, whose time has this `rate`
/// in the duration. `scratch` receives derivatives that are not used.
pub(super) fn pull_back(
    sweep: &mut Sweep,
    field: &mut Accelerations<f64>,
    data: StepView<f64>,
    to: NodeView<f64>,
    (scratch, rate): (&mut Model<f64>, f64),
) {
    let numbering = field.numbering;
    let nv = to.v.len();
    let nq = to.q.len();
    let Sensitivity {
        q,
        v,
        cot,
        by_duration,
        ..
    } = &mut sweep.of;
    let workspace = &mut sweep.workspace;
    let cot = &mut cot.model;
    let mut y = workspace.zeros(nv);
    bodies::tangent_of_cotangent(numbering, to.q, &q.value, &mut y);

    // M δ + Gᵀσ = 0, G (v~ + δ) + Φ_t = 0: subtract Gᵀχ from the cotangent. It is as small as the
    // step.
    let mut psi = workspace.copy(&v.value);
    psi.resize(nv + to.lambda.len(), 0.0);
    field.solve(&mut psi);
    psi.iter_mut().for_each(|x| *x = -*x);
    let mut reaction = workspace.zeros(nv);
    field.add_reactions(&psi[nv..], &mut reaction);
    v.add(1.0, &reaction);
    for (i, body) in cot.bodies.iter_mut().enumerate() {
        let o = numbering.velocity(i);
        let (psi_r, psi_theta) = velocities_of(&psi[o..]);
        let (d_r, d_theta) = velocities_of(&data.delta[o..]);
        body.mass += psi_r.dot(&d_r);
        body.inertia += psi_theta * d_theta.transpose();
    }
    let mut more = workspace.zeros(nv);
    let at = (field.model, numbering);
    let pair = (&psi[..nv], data.delta);
    flexible::pull_mass_product(at, &field.motions, pair, &mut more, cot);
    let mut by_time = field.pull_rate(&psi[..nv], data.sigma, &mut more, cot);
    by_time += field.pull_rates(&psi[nv..], &mut more, cot);
    y.iter_mut().zip(&more).for_each(|(y, &m)| *y += m);

    // M T⁺ (q − q~) + Gᵀs = 0, Φ(q, t) = 0. The matrix differs from the factorised one by terms X
    // of the size of the correction. Iterative refinement accounts for them.
    workspace.back([psi, reaction]);
    let mut psi = y;
    psi.resize(nv + to.lambda.len(), 0.0);
    field.solve(&mut psi);
    let first = workspace.copy(&psi);
    let (mut rest, mut change) = (workspace.zeros(nv), workspace.zeros(psi.len()));
    let mut before = f64::INFINITY;
    for _ in 0..REFINEMENTS {
        rest.fill(0.0);
        add_difference(field, data, to, &psi[..nv], &mut rest, scratch);
        change[..nv].copy_from_slice(&rest);
        change[nv..].fill(0.0);
        field.solve(&mut change);
        // ψ = K⁻¹ (ȳ − Xᵀψ).
        let refined = first.iter().zip(&change).map(|(&x, &d)| x - d);
        let (mut moved, mut size) = (0.0_f64, 0.0_f64);
        for (x, new) in psi.iter_mut().zip(refined) {
            moved = moved.max((new - *x).abs());
            size = size.max(new.abs());
            *x = new;
        }
        if moved <= f64::EPSILON * size || moved >= before {
            break;
        }
        before = moved;
    }
    // M ψ = ȳ − Gᵀχ − Xᵀψ: the part that is subtracted from the cotangent ȳ.
    more.iter_mut().zip(&rest).for_each(|(m, &x)| *m -= x);
    psi.iter_mut().for_each(|x| *x = -*x);
    field.add_reactions(&psi[nv..], &mut more);
    let mut unused = workspace.zeros(nv);
    by_time += field.pull_rate(&psi[..nv], data.s, &mut unused, cot);
    by_time += field.pull_constraints(&psi[nv..], &mut unused, cot);
    *by_duration += rate * by_time;
    if !field.model.flexible.is_empty() {
        let away = flexible::distance(numbering, to.q, data.q_raw);
        let at = (field.model, numbering);
        let pair = (&psi[..nv], &away[..]);
        flexible::pull_mass_product(at, &field.motions, pair, &mut unused, cot);
    }
    workspace.back([rest, change, first, unused]);
    let mut change = workspace.zeros(nq);
    bodies::rates_cotangent(numbering, to.q, &more, &mut change);
    for i in 0..numbering.bodies() {
        let (o, u) = (numbering.position(i), numbering.velocity(i));
        let (r, p) = positions_of(&to.q[o..]);
        let (r_raw, p_raw) = positions_of(&data.q_raw[o..]);
        let (psi_r, psi_theta) = velocities_of(&psi[u..]);
        let away = std::array::from_fn(|k| p[k] - p_raw[k]);
        let turned: Vec3<f64> = rotation::angular_velocity(&p, &away);
        cot.bodies[i].mass += psi_r.dot(&(r - r_raw));
        cot.bodies[i].inertia += psi_theta * turned.transpose();
        // Projected Euler parameters have unit length, so the radial part of the cotangent has no
        // effect.
        let radial: f64 = (0..4).map(|k| p[k] * q.value[o + 3 + k]).sum();
        for k in 0..4 {
            change[o + 3 + k] -= radial * p[k];
        }
    }
    q.add(1.0, &change);
    workspace.back([psi, more, change]);
}

/// Adds Xᵀψ: the transposed derivative, in the projected positions, of the equations of the
/// position projection without the mass matrix.
fn add_difference(
    field: &mut Accelerations<f64>,
    data: StepView<f64>,
    to: NodeView<f64>,
    psi: &[f64],
    out: &mut [f64],
    scratch: &mut Model<f64>,
) {
    let numbering = field.numbering;
    field.pull_rate(psi, data.s, out, scratch);
    let mut product = Vec::new();
    if !field.model.flexible.is_empty() {
        let (model, away) = (field.model, flexible::distance(numbering, to.q, data.q_raw));
        let pair = (psi, &away[..]);
        flexible::pull_mass_product((model, numbering), &field.motions, pair, out, scratch);
        product.resize(psi.len(), 0.0);
        flexible::add_mass_product(model, numbering, &field.motions, psi, &mut product);
    }
    for (i, body) in field.model.bodies.iter().enumerate() {
        let (o, u) = (numbering.position(i), numbering.velocity(i));
        let (_, p) = positions_of(&to.q[o..]);
        let (_, raw) = positions_of(&data.q_raw[o..]);
        let mut w = body.inertia.tr_mul(&velocities_of(&psi[u..]).1);
        if !product.is_empty() {
            w += velocities_of(&product[u..]).1;
        }
        let turned = rotation::rate_product(&p, &rotation::rate_transposed(&raw, &w)) - w;
        bodies::add6(&mut out[u..], &Vec3::zeros(), &turned);
    }
}
