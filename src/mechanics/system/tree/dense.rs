//! Dense blocks of up to order N, and their symmetric factors.

use super::SMALL;
use crate::math::Scalar;

/// A pivot below this fraction of its diagonal entry has lost too many digits. If a body carries
/// one that is 1e5 times as heavy, sparse LU with pivoting is more accurate.
pub(super) const SINGULAR: f64 = 1e-5;

/// The first m entries of `x`, then zeros.
pub(super) fn block<S: Scalar, const N: usize>(x: &[S], m: usize) -> [S; N] {
    std::array::from_fn(|i| if i < m { x[i] } else { S::zero() })
}

pub(super) fn dot<S: Scalar, const N: usize>(a: &[S; N], b: &[S; N]) -> S {
    // Pairs at distance three are independent of each other.
    let pair = |i: usize| match N {
        SMALL => a[i] * b[i],
        _ => a[i] * b[i] + a[i + 3] * b[i + 3],
    };
    pair(0) + pair(1) + pair(2)
}

pub(super) fn axpy<S: Scalar, const N: usize>(out: &mut [S], scale: S, x: &[S; N]) {
    for (out, &x) in out.iter_mut().zip(x) {
        *out += scale * x;
    }
}

/// Replaces the lower triangle by L (unit, strictly below) and D⁻¹ (diagonal) of A = L D Lᵀ.
///
/// # Errors
/// The row whose pivot is not positive relative to its diagonal entry.
pub(super) fn decompose<S: Scalar, const N: usize>(
    a: &mut [[S; N]; N],
    n: usize,
) -> Result<(), usize> {
    for j in 0..n {
        let before = a[j][j].re();
        let mut pivot = a[j][j];
        let mut row = a[j];
        for k in 0..j {
            // So far row[k] = L_jk D_k.
            let l = row[k] * a[k][k];
            pivot -= row[k] * l;
            row[k] = l;
        }
        if pivot.re() <= SINGULAR * before || !pivot.is_finite() {
            return Err(j);
        }
        a[j] = row;
        a[j][j] = S::one() / pivot;
        for i in j + 1..n {
            let mut sum = a[i][j];
            for k in 0..j {
                sum -= a[i][k] * row[k];
            }
            a[i][j] = sum;
        }
    }
    Ok(())
}

/// Solves L D Lᵀ x = b in place.
pub(super) fn solve<S: Scalar, const N: usize>(a: &[[S; N]; N], b: &mut [S], n: usize) {
    for i in 1..n {
        let mut sum = b[i];
        for k in 0..i {
            sum -= a[i][k] * b[k];
        }
        b[i] = sum;
    }
    for i in (0..n).rev() {
        let mut sum = b[i] * a[i][i];
        for k in i + 1..n {
            sum -= a[k][i] * b[k];
        }
        b[i] = sum;
    }
}
