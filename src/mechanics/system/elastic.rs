//! Elastic forces ∂U/∂q + D q̇ of a flexible body, its strain energy, and their derivatives.

use super::flexing::Block;
use super::pairs;
use super::strains;
use crate::math::Scalar;
use crate::math::slices::{add_scaled, dot};
use crate::model::flexible::Modal;

/// Adds K q̇ + Σ k_p ∇e_p ė_p (see [`strains::add_viscous`]).
fn add_viscous<S: Scalar>(body: &Modal<S>, q: &[S], rate: &[S], out: &mut [S]) {
    strains::add_viscous(&body.stiffness, q, rate, out);
    if let Some(shells) = &body.shells {
        pairs::add_viscous(&shells.pairs, q, rate, out);
    }
}

/// Strain energy U \[J\].
pub fn energy<S: Scalar>(body: &Modal<S>, q: &[S]) -> S {
    let of_pairs = body.shells.as_ref().map(|own| pairs::energy(&own.pairs, q));
    strains::energy(&body.stiffness, q) + of_pairs.unwrap_or_else(S::zero)
}

/// Pulls U times `scale` back to q (added to `by_q`) and to the parameters (added to `cot`).
pub fn pull_energy(
    body: &Modal<f64>,
    q: &[f64],
    scale: f64,
    by_q: &mut [f64],
    cot: &mut Modal<f64>,
) {
    if let (Some(own), Some(cot)) = (&body.shells, &mut cot.shells) {
        pairs::pull_energy(&own.pairs, q, scale, by_q, &mut cot.pairs);
    }
    strains::pull_energy(&body.stiffness, q, scale, by_q, &mut cot.stiffness);
}

/// Adds ∂U/∂q + D q̇, and where strains are damped β (K q̇ + Σ k_p ∇e_p ė_p).
pub fn add_forces<S: Scalar>(body: &Modal<S>, q: &[S], rate: &[S], out: &mut [S]) {
    strains::add_forces(&body.stiffness, q, out);
    if let Some(shells) = &body.shells {
        pairs::add_forces(&shells.pairs, q, out);
    }
    if let Some(beta) = body.strain_damping() {
        let mut force = vec![S::zero(); q.len()];
        add_viscous(body, q, rate, &mut force);
        add_scaled(out, beta, &force);
    }
    strains::add_product(&body.damping, rate, out);
}

/// Adds the derivatives of [`add_forces`] in q and q̇ to the elastic parts of two blocks.
pub fn add_jacobian<S: Scalar>(
    body: &Modal<S>,
    (q, rate): (&[S], &[S]),
    by_y: &mut Block<S>,
    by_v: &mut Block<S>,
) {
    let m = q.len();
    for i in 0..m {
        for j in 0..m {
            by_v.add(6 + i, 6 + j, body.damping[i * m + j]);
        }
    }
    strains::add_jacobian(&body.stiffness, q, by_y);
    if let Some(shells) = &body.shells {
        pairs::add_jacobian(&shells.pairs, q, by_y);
    }
    if let Some(beta) = body.strain_damping() {
        strains::add_viscous_jacobian(&body.stiffness, (q, rate), beta, (by_y, by_v));
        if let Some(shells) = &body.shells {
            pairs::add_viscous_jacobian(&shells.pairs, (q, rate), beta, (by_y, by_v));
        }
    }
}

/// Pulls the cotangent ψ of [`add_forces`] back to q and q̇ (added) and to the parameters (added to
/// `cot`).
pub fn pull_forces(
    body: &Modal<f64>,
    (q, rate): (&[f64], &[f64]),
    psi: &[f64],
    (by_q, by_rate): (&mut [f64], &mut [f64]),
    cot: &mut Modal<f64>,
) {
    if let (Some(own), Some(cot)) = (&body.shells, &mut cot.shells) {
        pairs::pull_forces(&own.pairs, (q, psi), by_q, &mut cot.pairs);
    }
    strains::pull_forces(&body.stiffness, (q, psi), by_q, &mut cot.stiffness);
    if let Some(beta) = body.strain_damping() {
        let motion = (q, rate, psi);
        let mut force = vec![0.0; q.len()];
        add_viscous(body, q, rate, &mut force);
        let by = (&mut *by_q, &mut *by_rate);
        strains::pull_viscous(&body.stiffness, motion, beta, by, &mut cot.stiffness);
        let mut by_beta = cot.viscosity.as_mut();
        if let (Some(shells), Some(own)) = (&body.shells, &mut cot.shells) {
            let by = (&mut *by_q, &mut *by_rate);
            pairs::pull_viscous(&shells.pairs, motion, beta, by, &mut own.pairs);
            by_beta = own.elements.damping.as_mut().map(|[_, beta]| beta);
        }
        if let Some(by_beta) = by_beta {
            *by_beta += dot(psi, &force);
        }
    }
    strains::add_transposed(&body.damping, psi, by_rate);
    strains::add_outer(1.0, psi, rate, &mut cot.damping);
}
