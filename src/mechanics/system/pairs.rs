//! Elastic forces of products of coordinates (see [`crate::model::reduced`]) and their derivatives.
//!
//! ```text
//! U = qᵀ C s + ½ sᵀ G s,   ∂U/∂q = C s + Jᵀ n,   n = Cᵀ q + G s,   J = ∂s/∂q
//! ∂²U/∂q² = C J + Jᵀ Cᵀ + Jᵀ G J + Σ n_k ∂²s_k/∂q²
//! ```
//!
//! With t = J q̇ the viscous forces of the strains (see [`super::strains`]) are C t + Jᵀ (Cᵀ q̇ + G t).

use super::flexing::Block;
use crate::math::Scalar;
use crate::math::slices::{add_scaled, dot};
use crate::model::reduced::PairEnergy;

/// s.
fn products<S: Scalar>(own: &PairEnergy<S>, q: &[S]) -> Vec<S> {
    own.pairs().map(|(i, j)| q[i] * q[j]).collect()
}

/// J ψ.
fn along<S: Scalar>(own: &PairEnergy<S>, q: &[S], psi: &[S]) -> Vec<S> {
    let one = |(i, j): (usize, usize)| psi[i] * q[j] + q[i] * psi[j];
    own.pairs().map(one).collect()
}

/// Adds J(q)ᵀ n.
fn add_transposed<S: Scalar>(own: &PairEnergy<S>, q: &[S], n: &[S], out: &mut [S]) {
    for ((i, j), &n) in own.pairs().zip(n) {
        out[i] += n * q[j];
        out[j] += n * q[i];
    }
}

/// Rows of a symmetric matrix that is stored by rows of its upper triangle.
fn upper<S>(all: &[S], order: usize) -> impl Iterator<Item = &[S]> {
    let mut at = 0;
    (0..order).map(move |k| {
        let from = at;
        at += order - k;
        &all[from..at]
    })
}

/// Adds G x.
fn add_quartic<S: Scalar>(own: &PairEnergy<S>, x: &[S], out: &mut [S]) {
    for (k, row) in upper(&own.quartic, own.count()).enumerate() {
        out[k] += dot(row, &x[k..]);
        add_scaled(&mut out[k + 1..], x[k], &row[1..]);
    }
}

/// Adds Cᵀ x.
fn add_cubic_transposed<S: Scalar>(own: &PairEnergy<S>, x: &[S], out: &mut [S]) {
    for (&x, row) in x.iter().zip(own.cubic.chunks_exact(own.count().max(1))) {
        add_scaled(out, x, row);
    }
}

/// Adds C s.
fn add_cubic<S: Scalar>(own: &PairEnergy<S>, s: &[S], out: &mut [S]) {
    let rows = own.cubic.chunks_exact(own.count().max(1));
    for (out, row) in out.iter_mut().zip(rows) {
        *out += dot(row, s);
    }
}

/// n.
fn stresses<S: Scalar>(own: &PairEnergy<S>, q: &[S], s: &[S]) -> Vec<S> {
    let mut n = vec![S::zero(); s.len()];
    add_cubic_transposed(own, q, &mut n);
    add_quartic(own, s, &mut n);
    n
}

/// U \[J\].
pub(super) fn energy<S: Scalar>(own: &PairEnergy<S>, q: &[S]) -> S {
    let s = products(own, q);
    let mut cubic = vec![S::zero(); s.len()];
    add_cubic_transposed(own, q, &mut cubic);
    let mut quartic = vec![S::zero(); s.len()];
    add_quartic(own, &s, &mut quartic);
    dot(&cubic, &s) + dot(&quartic, &s) * S::from(0.5)
}

/// Adds ∂U/∂q.
pub(super) fn add_forces<S: Scalar>(own: &PairEnergy<S>, q: &[S], out: &mut [S]) {
    let s = products(own, q);
    let n = stresses(own, q, &s);
    add_cubic(own, &s, out);
    add_transposed(own, q, &n, out);
}

/// J by columns: pair k has q_j at i and q_i at j.
fn columns<S: Scalar>(own: &PairEnergy<S>, q: &[S]) -> Vec<Vec<S>> {
    let a = own.of.len();
    let mut columns = vec![vec![S::zero(); own.count()]; a];
    let mut k = 0;
    for i in 0..a {
        for j in i..a {
            columns[i][k] += q[own.of[j]];
            columns[j][k] += q[own.of[i]];
            k += 1;
        }
    }
    columns
}

/// Adds scale · Σ n_k ∂²s_k/∂q² to the elastic part of a block.
fn add_curved<S: Scalar>(own: &PairEnergy<S>, n: &[S], scale: S, to: &mut Block<S>) {
    for ((i, j), &n) in own.pairs().zip(n) {
        to.add(6 + i, 6 + j, scale * n);
        to.add(6 + j, 6 + i, scale * n);
    }
}

/// Adds ∂²U/∂q² to the elastic part of a block.
pub(super) fn add_jacobian<S: Scalar>(own: &PairEnergy<S>, q: &[S], by_y: &mut Block<S>) {
    if own.count() == 0 {
        return;
    }
    let s = products(own, q);
    add_curved(own, &stresses(own, q, &s), S::one(), by_y);
    let columns = columns(own, q);
    add_tangent(own, (&columns, &columns), S::one(), true, by_y);
}

/// Adds scale · (C J' + Jᵀ G J'), and of all of it with J' = J scale · Jᵀ Cᵀ, to the elastic part of a block;
/// J and J' by columns.
fn add_tangent<S: Scalar>(
    own: &PairEnergy<S>,
    (left, right): (&[Vec<S>], &[Vec<S>]),
    scale: S,
    whole: bool,
    to: &mut Block<S>,
) {
    let count = own.count();
    for (column, &at) in right.iter().zip(&own.of) {
        let rows = own.cubic.chunks_exact(count);
        for (i, row) in rows.enumerate() {
            let x = scale * dot(row, column);
            to.add(6 + i, 6 + at, x);
            if whole {
                to.add(6 + at, 6 + i, x);
            }
        }
        let mut product = vec![S::zero(); count];
        add_quartic(own, column, &mut product);
        for (other, &row) in left.iter().zip(&own.of) {
            to.add(6 + row, 6 + at, scale * dot(other, &product));
        }
    }
}

/// Adds C t + Jᵀ (Cᵀ q̇ + G t).
pub(super) fn add_viscous<S: Scalar>(own: &PairEnergy<S>, q: &[S], rate: &[S], out: &mut [S]) {
    let t = along(own, q, rate);
    add_cubic(own, &t, out);
    add_transposed(own, q, &stresses(own, rate, &t), out);
}

/// Adds the derivatives of `beta` times [`add_viscous`] in q and q̇ to the elastic parts of two blocks.
pub(super) fn add_viscous_jacobian<S: Scalar>(
    own: &PairEnergy<S>,
    (q, rate): (&[S], &[S]),
    beta: S,
    (by_y, by_v): (&mut Block<S>, &mut Block<S>),
) {
    if own.count() == 0 {
        return;
    }
    let (in_q, in_rate) = (columns(own, q), columns(own, rate));
    add_tangent(own, (&in_q, &in_q), beta, true, by_v);
    add_tangent(own, (&in_q, &in_rate), beta, false, by_y);
    let t = along(own, q, rate);
    add_curved(own, &stresses(own, rate, &t), beta, by_y);
}

/// Pulls `beta` times ψ · [`add_viscous`] back to q and q̇ (added) and to the parameters (added to `cot`).
pub(super) fn pull_viscous(
    own: &PairEnergy<f64>,
    (q, rate, psi): (&[f64], &[f64], &[f64]),
    beta: f64,
    (by_q, by_rate): (&mut [f64], &mut [f64]),
    cot: &mut PairEnergy<f64>,
) {
    // ψᵀ C t + q̇ᵀ C u + uᵀ G t with t = J q̇ and u = J ψ.
    let psi: Vec<f64> = psi.iter().map(|x| beta * x).collect();
    let (t, u) = (along(own, q, rate), along(own, q, &psi));
    let (by_t, by_u) = (stresses(own, &psi, &u), stresses(own, rate, &t));
    add_transposed(own, rate, &by_t, by_q);
    add_transposed(own, &psi, &by_u, by_q);
    add_transposed(own, q, &by_t, by_rate);
    add_cubic(own, &u, by_rate);
    add_products(own.count(), [(&psi, &t), (rate, &u)], cot);
}

/// Pulls U times `scale` back to q (added to `by_q`) and to the parameters (added to `cot`).
pub(super) fn pull_energy(
    own: &PairEnergy<f64>,
    q: &[f64],
    scale: f64,
    by_q: &mut [f64],
    cot: &mut PairEnergy<f64>,
) {
    let mut force = vec![0.0; q.len()];
    add_forces(own, q, &mut force);
    add_scaled(by_q, scale, &force);
    let s = products(own, q);
    let count = own.count();
    for (&q, row) in q.iter().zip(cot.cubic.chunks_exact_mut(count.max(1))) {
        add_scaled(row, scale * q, &s);
    }
    let mut at = 0;
    for k in 0..count {
        cot.quartic[at] += 0.5 * scale * s[k] * s[k];
        add_scaled(
            &mut cot.quartic[at + 1..at + count - k],
            scale * s[k],
            &s[k + 1..],
        );
        at += count - k;
    }
}

/// Pulls the cotangent ψ of [`add_forces`] back to q (added) and to the parameters (added to `cot`).
pub(super) fn pull_forces(
    own: &PairEnergy<f64>,
    (q, psi): (&[f64], &[f64]),
    by_q: &mut [f64],
    cot: &mut PairEnergy<f64>,
) {
    // ψ · ∂U/∂q = ψᵀ C s + n · t with t = J ψ.
    let (s, t) = (products(own, q), along(own, q, psi));
    let n = stresses(own, q, &s);
    let w = stresses(own, psi, &t);
    add_transposed(own, q, &w, by_q);
    add_transposed(own, psi, &n, by_q);
    add_cubic(own, &t, by_q);
    add_products(own.count(), [(psi, &s), (q, &t)], cot);
}

/// Adds the derivatives of aᵀ C s + bᵀ C t + sᵀ G t by C and G, of `count` products each.
fn add_products(count: usize, [(a, s), (b, t)]: [(&[f64], &[f64]); 2], cot: &mut PairEnergy<f64>) {
    for (i, row) in cot.cubic.chunks_exact_mut(count.max(1)).enumerate() {
        add_scaled(row, a[i], s);
        add_scaled(row, b[i], t);
    }
    let mut at = 0;
    for k in 0..count {
        cot.quartic[at] += s[k] * t[k];
        let row = &mut cot.quartic[at + 1..at + count - k];
        add_scaled(row, s[k], &t[k + 1..]);
        add_scaled(row, t[k], &s[k + 1..]);
        at += count - k;
    }
}
