//! Arnoldi's method for eigenvalues μ of A y = μ y, of largest size first.

use crate::linalg::eigenvalues;
use crate::math::slices::{add_scaled, any_vector, dot};
use nalgebra::DMatrix;

/// Largest dimension of the Krylov space.
const DIMENSION: usize = 24;
/// Largest residual |A y − μ y|, relative to |μ|, for |y| = 1 in the metric.
const CONVERGED: f64 = 1e-2;
/// Most iterations for the singular vectors of a small matrix.
const SWEEPS: usize = 10_000;
/// A vector lies in the space of those before if this part of it is left; and so does one that is found again.
const DEPENDENT: f64 = 1e-8;
const DISTINCT: f64 = 0.1;

/// Real eigenvalues of a matrix of the order n, given by its products, that `counts(μ, largest |μ|)`, with their vectors
/// of unit length in the metric that `weighted` multiplies with; all copies of each, at most `independent` in all. `None` if
/// a product is not finite.
pub(super) fn ritz_vectors(
    mut product: impl FnMut(&[f64]) -> Vec<f64>,
    weighted: impl Fn(&[f64]) -> Vec<f64>,
    (n, independent): (usize, usize),
    counts: impl Fn(f64, f64) -> bool,
) -> Option<Vec<(f64, Vec<f64>)>> {
    let mut all: Vec<(f64, Vec<f64>)> = Vec::new();
    let mut known: Vec<[Vec<f64>; 2]> = Vec::new();
    // A Krylov space has one copy of an eigenvalue. Others are in the space without it.
    while known.len() < independent {
        let found = one_of_each(&mut product, &weighted, (&known, n), (independent, &counts))?;
        let before = known.len();
        for (value, mut y) in found {
            let length = dot(&y, &weighted(&y)).sqrt();
            without(&known, &mut y);
            let metric = weighted(&y);
            let rest = dot(&y, &metric).sqrt();
            if rest > DISTINCT * length {
                known.push([&y, &metric].map(|x| x.iter().map(|x| x / rest).collect()));
                all.push((value, y));
            }
        }
        if known.len() == before {
            break;
        }
    }
    Some(all)
}

/// Removes the parts along orthonormal vectors with their products with the metric, which it gives; twice, so that round-off
/// of the first pass goes.
fn without(known: &[[Vec<f64>; 2]], from: &mut [f64]) -> Vec<f64> {
    let mut parts = vec![0.0; known.len()];
    for _ in 0..2 {
        for (part, [y, with_metric]) in parts.iter_mut().zip(known) {
            let along = dot(with_metric, from);
            *part += along;
            add_scaled(from, -along, y);
        }
    }
    parts
}

/// One vector of each eigenvalue that counts, in the space that is orthogonal to the known ones.
fn one_of_each(
    full: &mut impl FnMut(&[f64]) -> Vec<f64>,
    weighted: &impl Fn(&[f64]) -> Vec<f64>,
    (known, n): (&[[Vec<f64>; 2]], usize),
    (independent, counts): (usize, &impl Fn(f64, f64) -> bool),
) -> Option<Vec<(f64, Vec<f64>)>> {
    let mut product = |y: &[f64]| {
        let mut out = full(y);
        without(known, &mut out);
        out
    };
    let seed = 1.0 + known.len() as f64;
    let mut next = product(&any_vector(n, seed));
    let mut basis: Vec<[Vec<f64>; 2]> = Vec::new();
    let mut columns: Vec<Vec<f64>> = Vec::new();
    loop {
        let before = dot(&next, &weighted(&next)).max(0.0).sqrt();
        let mut column = without(&basis, &mut next);
        let mut metric = weighted(&next);
        let square = dot(&next, &metric);
        if !square.is_finite() {
            return None;
        }
        // That of round-off may be negative.
        let rest = square.max(0.0).sqrt();
        column.push(rest);
        if !basis.is_empty() {
            columns.push(column);
        }
        if rest <= DEPENDENT * before || basis.len() == DIMENSION.min(independent - known.len()) {
            break;
        }
        next.iter_mut().for_each(|x| *x /= rest);
        metric.iter_mut().for_each(|x| *x /= rest);
        let y = next;
        next = product(&y);
        basis.push([y, metric]);
    }
    let mut all = Vec::new();
    for (value, parts) in of_hessenberg(&columns, counts)? {
        let mut y = vec![0.0; n];
        for (part, [vector, _]) in parts.iter().zip(&basis) {
            add_scaled(&mut y, *part, vector);
        }
        // A space of errors of products has eigenvalues, too.
        let mut rest = product(&y);
        add_scaled(&mut rest, -value, &y);
        if dot(&rest, &weighted(&rest)).sqrt() <= CONVERGED * value.abs() {
            all.push((value, y));
        }
    }
    Some(all)
}

/// Real eigenvalues that count of the columns of a Hessenberg matrix, with unit eigenvectors.
fn of_hessenberg(
    columns: &[Vec<f64>],
    counts: impl Fn(f64, f64) -> bool,
) -> Option<Vec<(f64, Vec<f64>)>> {
    let k = columns.len();
    if k == 0 {
        return Some(Vec::new());
    }
    let h = DMatrix::from_fn(k, k, |i, j| columns[j].get(i).copied().unwrap_or(0.0));
    let values = eigenvalues(&h)?;
    let largest = values.iter().fold(0.0_f64, |m, x| m.max(x.norm()));
    let real = values.iter().filter(|x| x.im == 0.0).map(|x| x.re);
    let vector = |value: f64| {
        let shifted = &h - DMatrix::identity(k, k) * value;
        let svd = shifted.try_svd(false, true, f64::EPSILON, SWEEPS)?;
        let v = svd.v_t?;
        Some((value, v.row(k - 1).iter().copied().collect()))
    };
    let counted = real.filter(|&value| counts(value, largest));
    Some(counted.filter_map(vector).collect())
}
