//! Strain energy as a quartic polynomial (see [`crate::model::shapes`]), viscous forces of its strains, and all
//! their derivatives.
//!
//! ```text
//! U = ½ qᵀ K q + ½ Σ_p k_p e_p²,     ∂U/∂q = K q + Σ_p k_p e_p ∇e_p
//! ```
//!
//! The strains of a material that is damped in proportion to its stiffness (Kelvin & Voigt) add the
//! forces β (K q̇ + Σ_p k_p ∇e_p ė_p). They vanish where the strains are constant, also while large
//! deflections change.

use super::flexing::Block;
use crate::math::Scalar;
use crate::math::slices::{add_scaled, dot};
use crate::model::shapes::{ModalStiffness, Quadratic};

/// U \[J\].
pub fn energy<S: Scalar>(own: &ModalStiffness<S>, q: &[S]) -> S {
    let mut linear = vec![S::zero(); q.len()];
    add_product(&own.linear, q, &mut linear);
    let mut sum = dot(&linear, q);
    for strain in &own.strains {
        let e = strain.strain.value(q);
        sum += strain.weight * e * e;
    }
    sum * S::from(0.5)
}

/// Pulls U times `scale` back to q (added to `by_q`) and to the parameters (added to `cot`).
pub fn pull_energy(
    own: &ModalStiffness<f64>,
    q: &[f64],
    scale: f64,
    by_q: &mut [f64],
    cot: &mut ModalStiffness<f64>,
) {
    let mut force = vec![0.0; q.len()];
    add_forces(own, q, &mut force);
    add_scaled(by_q, scale, &force);
    add_outer(0.5 * scale, q, q, &mut cot.linear);
    for (strain, cot) in own.strains.iter().zip(&mut cot.strains) {
        let e = strain.strain.value(q);
        cot.weight += 0.5 * scale * e * e;
        let by = scale * strain.weight * e;
        strain.strain.pull_value(q, by, &mut cot.strain);
    }
}

/// Adds ∂U/∂q.
pub fn add_forces<S: Scalar>(own: &ModalStiffness<S>, q: &[S], out: &mut [S]) {
    add_product(&own.linear, q, out);
    for strain in &own.strains {
        let n = strain.weight * strain.strain.value(q);
        strain.strain.add_gradient(q, n, out);
    }
}

/// Adds scale · g hᵀ to the elastic part of a block.
fn add_square<S: Scalar>(block: &mut Block<S>, scale: S, g: &[S], h: &[S]) {
    // Of the coordinates of a beam a strain has those of one kind or two.
    for (i, &g) in g.iter().enumerate().filter(|(_, g)| **g != S::zero()) {
        let row = scale * g;
        for (j, &h) in h.iter().enumerate() {
            block.add(6 + i, 6 + j, row * h);
        }
    }
}

/// ∇e.
fn gradient<S: Scalar>(strain: &Quadratic<S>, q: &[S]) -> Vec<S> {
    let mut out = vec![S::zero(); q.len()];
    strain.add_gradient(q, S::one(), &mut out);
    out
}

/// Adds ∂²U/∂q² to the elastic part of a block.
pub fn add_jacobian<S: Scalar>(own: &ModalStiffness<S>, q: &[S], by_y: &mut Block<S>) {
    let m = q.len();
    for i in 0..m {
        for j in 0..m {
            by_y.add(6 + i, 6 + j, own.linear[i * m + j]);
        }
    }
    for strain in &own.strains {
        let along = gradient(&strain.strain, q);
        add_square(by_y, strain.weight, &along, &along);
        let n = strain.weight * strain.strain.value(q);
        for (c, g) in &strain.strain.squares {
            add_square(by_y, n * *c, g, g);
        }
    }
}

/// lᵀ A r for the derivatives A of [`add_forces`] by q, and of [`add_viscous`] by q and by q̇.
pub fn products<S: Scalar>(
    own: &ModalStiffness<S>,
    (q, rate): (&[S], &[S]),
    [l, r]: [&[S]; 2],
) -> [S; 3] {
    let mut linear = vec![S::zero(); q.len()];
    add_product(&own.linear, r, &mut linear);
    let mut viscous = dot(&linear, l);
    let (mut curved, mut by_place) = (S::zero(), S::zero());
    for strain in &own.strains {
        let form = &strain.strain;
        let bent = |x: &[S], y: &[S]| {
            let squares = form.squares.iter();
            squares.fold(S::zero(), |sum, (c, g)| sum + *c * dot(g, x) * dot(g, y))
        };
        let gradient = gradient(form, q);
        let [along_l, along_r, speed] = [l, r, rate].map(|x| dot(&gradient, x));
        let k = strain.weight;
        viscous += k * along_l * along_r;
        curved += k * form.value(q) * bent(l, r);
        by_place += k * (along_l * bent(rate, r) + speed * bent(l, r));
    }
    [viscous + curved, by_place, viscous]
}

/// Pulls the cotangent ψ of [`add_forces`] back to q (added) and to the parameters (added to `cot`).
pub fn pull_forces(
    own: &ModalStiffness<f64>,
    (q, psi): (&[f64], &[f64]),
    by_q: &mut [f64],
    cot: &mut ModalStiffness<f64>,
) {
    add_transposed(&own.linear, psi, by_q);
    add_outer(1.0, psi, q, &mut cot.linear);
    for (strain, cot) in own.strains.iter().zip(&mut cot.strains) {
        let (form, k) = (&strain.strain, strain.weight);
        let gradient = gradient(form, q);
        let (e, along) = (form.value(q), dot(&gradient, psi));
        add_scaled(by_q, k * along, &gradient);
        add_curved(form, psi, k * e, by_q);
        cot.weight += e * along;
        form.pull_value(q, k * along, &mut cot.strain);
        form.pull_gradient(q, psi, k * e, &mut cot.strain);
    }
}

/// Adds scale · H x with H = Σ c_s g_s g_sᵀ.
fn add_curved<S: Scalar>(form: &Quadratic<S>, x: &[S], scale: S, out: &mut [S]) {
    for (c, g) in &form.squares {
        add_scaled(out, scale * *c * dot(g, x), g);
    }
}

/// Adds K q̇ + Σ k_p ∇e_p ė_p.
pub fn add_viscous<S: Scalar>(own: &ModalStiffness<S>, q: &[S], rate: &[S], out: &mut [S]) {
    add_product(&own.linear, rate, out);
    for strain in &own.strains {
        let along = gradient(&strain.strain, q);
        add_scaled(out, strain.weight * dot(&along, rate), &along);
    }
}

/// Adds the derivatives of `beta` times [`add_viscous`] in q and q̇ to the elastic parts of two blocks.
pub fn add_viscous_jacobian<S: Scalar>(
    own: &ModalStiffness<S>,
    (q, rate): (&[S], &[S]),
    beta: S,
    (by_y, by_v): (&mut Block<S>, &mut Block<S>),
) {
    let m = q.len();
    for i in 0..m {
        for j in 0..m {
            by_v.add(6 + i, 6 + j, beta * own.linear[i * m + j]);
        }
    }
    for strain in &own.strains {
        let k = beta * strain.weight;
        let along = gradient(&strain.strain, q);
        add_square(by_v, k, &along, &along);
        let mut turned = vec![S::zero(); m];
        add_curved(&strain.strain, rate, S::one(), &mut turned);
        add_square(by_y, k, &along, &turned);
        let speed = k * dot(&along, rate);
        for (c, g) in &strain.strain.squares {
            add_square(by_y, speed * *c, g, g);
        }
    }
}

/// Pulls `beta` times ψ · [`add_viscous`] back to q and q̇ (added) and to the parameters (added to `cot`).
pub fn pull_viscous(
    own: &ModalStiffness<f64>,
    (q, rate, psi): (&[f64], &[f64], &[f64]),
    beta: f64,
    (by_q, by_rate): (&mut [f64], &mut [f64]),
    cot: &mut ModalStiffness<f64>,
) {
    let scaled: Vec<f64> = psi.iter().map(|x| beta * x).collect();
    add_transposed(&own.linear, &scaled, by_rate);
    add_outer(1.0, &scaled, rate, &mut cot.linear);
    for (strain, cot) in own.strains.iter().zip(&mut cot.strains) {
        let (form, k) = (&strain.strain, beta * strain.weight);
        let along = gradient(form, q);
        let (speed, virtually) = (dot(&along, rate), dot(&along, psi));
        add_scaled(by_rate, k * virtually, &along);
        add_curved(form, rate, k * virtually, by_q);
        add_curved(form, psi, k * speed, by_q);
        cot.weight += beta * speed * virtually;
        form.pull_gradient(q, rate, k * virtually, &mut cot.strain);
        form.pull_gradient(q, psi, k * speed, &mut cot.strain);
    }
}

/// Adds A x, A by rows.
pub(super) fn add_product<S: Scalar>(a: &[S], x: &[S], out: &mut [S]) {
    for (out, row) in out.iter_mut().zip(a.chunks_exact(x.len().max(1))) {
        *out += dot(row, x);
    }
}

/// Adds Aᵀ x.
pub(super) fn add_transposed(a: &[f64], x: &[f64], out: &mut [f64]) {
    for (&x, row) in x.iter().zip(a.chunks_exact(out.len().max(1))) {
        add_scaled(out, x, row);
    }
}

/// Adds scale · x yᵀ.
pub(super) fn add_outer(scale: f64, x: &[f64], y: &[f64], out: &mut [f64]) {
    for (&x, row) in x.iter().zip(out.chunks_exact_mut(y.len().max(1))) {
        add_scaled(row, scale * x, y);
    }
}
