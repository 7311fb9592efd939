//! Elastic forces of products of coordinates (see [`crate::model::reduced`]) and their derivatives.
//!
//! ```text
//! U = qᵀ C s + ½ sᵀ G s,   ∂U/∂q = C s + Jᵀ n,   n = Cᵀ q + G s,   J = ∂s/∂q
//! ∂²U/∂q² = C J + Jᵀ Cᵀ + Jᵀ G J + Σ n_k ∂²s_k/∂q²
//! ```

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

/// Adds ∂²U/∂q² to the elastic part of a block.
pub(super) fn add_jacobian<S: Scalar>(own: &PairEnergy<S>, q: &[S], by_y: &mut Block<S>) {
    let (count, a) = (own.count(), own.of.len());
    if count == 0 {
        return;
    }
    let s = products(own, q);
    for ((i, j), n) in own.pairs().zip(stresses(own, q, &s)) {
        by_y.add(6 + i, 6 + j, n);
        by_y.add(6 + j, 6 + i, n);
    }
    // J by columns: pair k has q_j at i and q_i at j.
    let mut columns = vec![vec![S::zero(); count]; a];
    let mut k = 0;
    for i in 0..a {
        for j in i..a {
            columns[i][k] += q[own.of[j]];
            columns[j][k] += q[own.of[i]];
            k += 1;
        }
    }
    for (column, &at) in columns.iter().zip(&own.of) {
        let rows = own.cubic.chunks_exact(count);
        for (i, row) in rows.enumerate() {
            let x = dot(row, column);
            by_y.add(6 + i, 6 + at, x);
            by_y.add(6 + at, 6 + i, x);
        }
        let mut product = vec![S::zero(); count];
        add_quartic(own, column, &mut product);
        for (other, &to) in columns.iter().zip(&own.of) {
            by_y.add(6 + to, 6 + at, dot(other, &product));
        }
    }
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
    let count = own.count();
    for (i, row) in cot.cubic.chunks_exact_mut(count.max(1)).enumerate() {
        add_scaled(row, psi[i], &s);
        add_scaled(row, q[i], &t);
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
