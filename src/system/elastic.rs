//! Elastic forces ∂U/∂q + D q̇ of a flexible body, its strain energy, and their derivatives.

use super::flexing::Block;
use super::pairs;
use crate::math::Scalar;
use crate::math::slices::{add_scaled, dot};
use crate::model::flexible::{Modal, ModalStiffness};

/// Strain energy U \[J\].
pub(crate) fn energy<S: Scalar>(body: &Modal<S>, q: &[S]) -> S {
    let stiffness = &body.stiffness;
    let mut linear = vec![S::zero(); q.len()];
    add_product(&stiffness.linear, q, &mut linear);
    let mut sum = dot(&linear, q);
    for strain in &stiffness.strains {
        let e = strain.strain.value(q);
        sum += strain.weight * e * e;
    }
    let of_pairs = body.shells.as_ref().map(|own| pairs::energy(&own.pairs, q));
    sum * S::from(0.5) + of_pairs.unwrap_or_else(S::zero)
}

/// Pulls U times `scale` back to q (added to `by_q`) and to the parameters (added to `cot`).
pub(crate) fn pull_energy(
    body: &Modal<f64>,
    q: &[f64],
    scale: f64,
    by_q: &mut [f64],
    cot: &mut Modal<f64>,
) {
    if let (Some(own), Some(cot)) = (&body.shells, &mut cot.shells) {
        pairs::pull_energy(&own.pairs, q, scale, by_q, &mut cot.pairs);
    }
    let (stiffness, cot) = (&body.stiffness, &mut cot.stiffness);
    let mut force = vec![0.0; q.len()];
    add_stiffness(stiffness, q, &mut force);
    add_scaled(by_q, scale, &force);
    add_outer(0.5 * scale, q, q, &mut cot.linear);
    for (strain, cot) in stiffness.strains.iter().zip(&mut cot.strains) {
        let e = strain.strain.value(q);
        cot.weight += 0.5 * scale * e * e;
        let by = scale * strain.weight * e;
        strain.strain.pull_value(q, by, &mut cot.strain);
    }
}

/// Adds ∂U/∂q.
fn add_stiffness<S: Scalar>(stiffness: &ModalStiffness<S>, q: &[S], out: &mut [S]) {
    add_product(&stiffness.linear, q, out);
    for strain in &stiffness.strains {
        let n = strain.weight * strain.strain.value(q);
        strain.strain.add_gradient(q, n, out);
    }
}

/// Adds ∂U/∂q + D q̇.
pub(crate) fn add_forces<S: Scalar>(body: &Modal<S>, q: &[S], rate: &[S], out: &mut [S]) {
    add_stiffness(&body.stiffness, q, out);
    if let Some(shells) = &body.shells {
        pairs::add_forces(&shells.pairs, q, out);
    }
    add_product(&body.damping, rate, out);
}

/// Adds the derivatives of [`add_forces`] in q and q̇ to the elastic parts of two blocks.
pub(crate) fn add_jacobian<S: Scalar>(
    body: &Modal<S>,
    q: &[S],
    by_y: &mut Block<S>,
    by_v: &mut Block<S>,
) {
    let m = q.len();
    for i in 0..m {
        for j in 0..m {
            by_y.add(6 + i, 6 + j, body.stiffness.linear[i * m + j]);
            by_v.add(6 + i, 6 + j, body.damping[i * m + j]);
        }
    }
    if let Some(shells) = &body.shells {
        pairs::add_jacobian(&shells.pairs, q, by_y);
    }
    let mut gradient = vec![S::zero(); m];
    let mut add_square = |scale: S, g: &[S]| {
        for i in 0..m {
            let row = scale * g[i];
            for j in 0..m {
                by_y.add(6 + i, 6 + j, row * g[j]);
            }
        }
    };
    for strain in &body.stiffness.strains {
        gradient.fill(S::zero());
        strain.strain.add_gradient(q, S::one(), &mut gradient);
        add_square(strain.weight, &gradient);
        let n = strain.weight * strain.strain.value(q);
        for (c, g) in &strain.strain.squares {
            add_square(n * *c, g);
        }
    }
}

/// Pulls the cotangent ψ of [`add_forces`] back to q and q̇ (added) and to the parameters (added to
/// `cot`).
pub(crate) fn pull_forces(
    body: &Modal<f64>,
    (q, rate): (&[f64], &[f64]),
    psi: &[f64],
    (by_q, by_rate): (&mut [f64], &mut [f64]),
    cot: &mut Modal<f64>,
) {
    if let (Some(own), Some(cot)) = (&body.shells, &mut cot.shells) {
        pairs::pull_forces(&own.pairs, (q, psi), by_q, &mut cot.pairs);
    }
    add_transposed(&body.stiffness.linear, psi, by_q);
    add_transposed(&body.damping, psi, by_rate);
    add_outer(1.0, psi, q, &mut cot.stiffness.linear);
    add_outer(1.0, psi, rate, &mut cot.damping);
    let mut gradient = vec![0.0; q.len()];
    let strains = body.stiffness.strains.iter();
    for (strain, cot) in strains.zip(&mut cot.stiffness.strains) {
        let (form, k) = (&strain.strain, strain.weight);
        gradient.fill(0.0);
        form.add_gradient(q, 1.0, &mut gradient);
        let (e, along) = (form.value(q), dot(&gradient, psi));
        add_scaled(by_q, k * along, &gradient);
        for (c, g) in &form.squares {
            add_scaled(by_q, k * e * c * dot(g, psi), g);
        }
        cot.weight += e * along;
        form.pull_value(q, k * along, &mut cot.strain);
        form.pull_gradient(q, psi, k * e, &mut cot.strain);
    }
}

/// Adds A x, A by rows.
fn add_product<S: Scalar>(a: &[S], x: &[S], out: &mut [S]) {
    for (out, row) in out.iter_mut().zip(a.chunks_exact(x.len().max(1))) {
        *out += dot(row, x);
    }
}

/// Adds Aᵀ x.
fn add_transposed(a: &[f64], x: &[f64], out: &mut [f64]) {
    for (&x, row) in x.iter().zip(a.chunks_exact(out.len().max(1))) {
        add_scaled(out, x, row);
    }
}

/// Adds scale · x yᵀ.
fn add_outer(scale: f64, x: &[f64], y: &[f64], out: &mut [f64]) {
    for (&x, row) in x.iter().zip(out.chunks_exact_mut(y.len().max(1))) {
        add_scaled(row, scale * x, y);
    }
}
