//! The quadratic subproblem for many variables. The low-rank part of its matrix has variables of
//! its own, so Clarabel sees sparse matrices.

use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSolver, IPSolver, NonnegativeConeT, SolverStatus, ZeroConeT};
use nalgebra::DVector;

use crate::constants::SMALL_PART;
use crate::linear::quasi_newton::Spectrum;
use crate::quadratic::data::settings;

/// Minimises ½ s tᵀB t + qᵀ(t, e) subject to rows · (t, e) ≤ rhs, for B = σ I + W diag(λ − σ) Wᵀ and
/// s = `factor`; returns status, (t, e) and the multipliers of the rows.
///
/// With t = p + W₋ z₋ over the eigenvalues below σ and z₊ = W₊ᵀ p over those above it,
///
/// ```text
/// tᵀB t = min { σ pᵀp + Σ λ₋ σ/(σ − λ₋) z₋² + Σ (λ₊ − σ) z₊² },
/// ```
///
/// a diagonal form in p, z₋ and z₊. Springs in series are softer; parallel springs are stiffer.
pub(crate) fn solve(
    rows: &CscMatrix<f64>,
    b: &Spectrum,
    factor: f64,
    q: &[f64],
    rhs: &[f64],
) -> Option<(SolverStatus, Vec<f64>, Vec<f64>)> {
    let n = b.vectors.nrows();
    let (soft, stiff) = (0..b.values.len())
        .filter(|&k| (b.values[k] - b.sigma).abs() > SMALL_PART * b.sigma)
        .partition::<Vec<usize>, _>(|&k| b.values[k] < b.sigma);
    let (columns, bounded) = (rows.n, rows.m);
    let total = columns + soft.len() + stiff.len();

    let mut diagonal = vec![factor * b.sigma; n];
    diagonal.resize(columns, 0.0);
    let series = |&k: &usize| factor * b.values[k] * b.sigma / (b.sigma - b.values[k]);
    diagonal.extend(soft.iter().map(series));
    diagonal.extend(stiff.iter().map(|&k| factor * (b.values[k] - b.sigma)));
    let p = CscMatrix::new(
        total,
        total,
        (0..=total).collect(),
        (0..total).collect(),
        diagonal,
    );

    // The equalities z₊ − W₊ᵀ p = 0 come first.
    let first = stiff.len();
    let mut pointers = vec![0];
    let (mut indices, mut values) = (Vec::new(), Vec::new());
    for column in 0..columns {
        if column < n {
            for (r, &k) in stiff.iter().enumerate() {
                indices.push(r);
                values.push(-b.vectors[(column, k)]);
            }
        }
        for at in rows.colptr[column]..rows.colptr[column + 1] {
            if rows.nzval[at] != 0.0 {
                indices.push(first + rows.rowval[at]);
                values.push(rows.nzval[at]);
            }
        }
        pointers.push(indices.len());
    }
    let mut linear = q.to_vec();
    for &k in &soft {
        let w = b.vectors.column(k);
        let mut moved = DVector::zeros(bounded);
        for column in 0..n {
            for at in rows.colptr[column]..rows.colptr[column + 1] {
                moved[rows.rowval[at]] += rows.nzval[at] * w[column];
            }
        }
        for (r, &value) in moved.iter().enumerate() {
            if value != 0.0 {
                indices.push(first + r);
                values.push(value);
            }
        }
        pointers.push(indices.len());
        linear.push((0..n).map(|i| q[i] * w[i]).sum());
    }
    for r in 0..first {
        indices.push(r);
        values.push(1.0);
        pointers.push(indices.len());
        linear.push(0.0);
    }
    let a = CscMatrix::new(first + bounded, total, pointers, indices, values);
    let sides = [vec![0.0; first], rhs.to_vec()].concat();
    let cones = [ZeroConeT(first), NonnegativeConeT(bounded)];
    let mut solver = DefaultSolver::new(&p, &linear, &a, &sides, &cones, settings()?).ok()?;
    solver.solve();
    let found = &solver.solution;
    let mut t = found.x[..columns].to_vec();
    for (z, &k) in found.x[columns..].iter().zip(&soft) {
        for (i, w) in b.vectors.column(k).iter().enumerate() {
            t[i] += z * w;
        }
    }
    Some((found.status, t, found.z[first..].to_vec()))
}
