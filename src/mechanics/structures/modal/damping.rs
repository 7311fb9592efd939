//! Damping of all modes by one ratio, without the modes.
//!
//! With M x ω² = K x and the same ratio ζ for all modes C = 2ζ M (M⁻¹K)^½. For K = L Lᵀ and G = L⁻¹ M L⁻ᵀ this
//! is C = 2ζ L G^½ Lᵀ. A matrix function has derivatives where frequencies meet; modes have none there.

use crate::math::Scalar;
use nalgebra::{DMatrix, SymmetricEigen};

/// C = 2ζ M (M⁻¹K)^½ for symmetric positive definite M and K, by rows.
pub fn ratio_damping<S: Scalar>(mass: &[S], stiffness: &[S], ratio: S) -> Vec<S> {
    if mass.is_empty() {
        return Vec::new();
    }
    let n = mass.len().isqrt();
    let l = cholesky(stiffness, n);
    // G = L⁻¹ M L⁻ᵀ: L⁻¹ of the columns, then of the rows.
    let half = forward(&l, mass, n);
    let g = forward(&l, &transposed(&half, n), n);
    let root = square_root(&g, n);
    let left = product(&l, &root, n);
    let c = product(&left, &transposed(&l, n), n);
    c.into_iter().map(|x| x * ratio * 2.0).collect()
}

/// The lower factor L of A = L Lᵀ, by rows.
fn cholesky<S: Scalar>(a: &[S], n: usize) -> Vec<S> {
    let mut l = vec![S::zero(); n * n];
    for i in 0..n {
        for j in 0..=i {
            let inner = (0..j).fold(a[i * n + j], |sum, k| sum - l[i * n + k] * l[j * n + k]);
            l[i * n + j] = if i == j {
                inner.sqrt()
            } else {
                inner / l[j * n + j]
            };
        }
    }
    l
}

/// L⁻¹ B.
fn forward<S: Scalar>(l: &[S], b: &[S], n: usize) -> Vec<S> {
    let mut x = b.to_vec();
    for column in 0..n {
        for i in 0..n {
            let inner = (0..i).fold(x[i * n + column], |sum, k| {
                sum - l[i * n + k] * x[k * n + column]
            });
            x[i * n + column] = inner / l[i * n + i];
        }
    }
    x
}

fn transposed<S: Scalar>(a: &[S], n: usize) -> Vec<S> {
    (0..n * n).map(|at| a[(at % n) * n + at / n]).collect()
}

fn product<S: Scalar>(a: &[S], b: &[S], n: usize) -> Vec<S> {
    let entry = |at: usize| {
        let (i, j) = (at / n, at % n);
        (0..n).fold(S::zero(), |sum, k| sum + a[i * n + k] * b[k * n + j])
    };
    (0..n * n).map(entry).collect()
}

/// X of X X = A for a symmetric positive definite A. The infinitesimal part solves X dX + dX X = dA
/// (Sylvester), which in the eigenvectors of A is a division by √λ_i + √λ_j.
fn square_root<S: Scalar>(a: &[S], n: usize) -> Vec<S> {
    let symmetric = |part: &dyn Fn(S) -> f64| {
        DMatrix::from_fn(n, n, |i, j| 0.5 * (part(a[i * n + j]) + part(a[j * n + i])))
    };
    let SymmetricEigen {
        eigenvectors: v,
        eigenvalues,
    } = symmetric(&|x| x.re()).symmetric_eigen();
    let roots = eigenvalues.map(|x| x.max(0.0).sqrt());
    let value = &v * DMatrix::from_diagonal(&roots) * v.transpose();
    let mut slope = v.transpose() * symmetric(&|x| x.infinitesimal()) * &v;
    for i in 0..n {
        for j in 0..n {
            slope[(i, j)] /= roots[i] + roots[j];
        }
    }
    let slope = &v * slope * v.transpose();
    (0..n * n)
        .map(|at| {
            let place = (at / n, at % n);
            S::from(value[place]) + S::of_infinitesimal(slope[place])
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{Complex64, Dual};

    /// Every mode gets the ratio, also where frequencies are equal, and the derivative is that of a closed
    /// form: with K → (1 + ε) K the damping grows by ½ ε, with M too; M and K of random shapes.
    #[test]
    fn every_mode_has_the_ratio_and_the_derivative_is_exact() {
        let n = 5;
        let mix = |seed: usize, at: usize| ((seed * 31 + at * 17) as f64 * 0.7).sin();
        let spd = |seed: usize| {
            let a = DMatrix::from_fn(n, n, |i, j| mix(seed, i * n + j));
            &a * a.transpose() + DMatrix::identity(n, n)
        };
        for seed in 1..6 {
            let mass = spd(seed);
            // Two equal frequencies: K = M in a plane of two vectors, more elsewhere.
            let more = DMatrix::from_fn(n, n, |i, j| {
                (2..n)
                    .map(|k| mix(k, i) * mix(k, j) * k as f64)
                    .sum::<f64>()
            });
            let stiffness = &mass + more;
            let rows = |a: &DMatrix<f64>| a.transpose().iter().copied().collect::<Vec<f64>>();
            let (m, k) = (rows(&mass), rows(&stiffness));
            let c = DMatrix::from_row_slice(n, n, &ratio_damping(&m, &k, 0.03));
            // C M⁻¹ C = 4ζ² K.
            let square = &c * mass.clone().try_inverse().expect("regular") * &c;
            let gap = (square - &stiffness * (4.0 * 0.03f64.powi(2))).norm();
            assert!(gap < 1e-13 * stiffness.norm(), "{gap:e}");
            let dual = |a: &[f64], by: f64| -> Vec<Dual> {
                a.iter().map(|&x| Dual::new(x, by * x)).collect()
            };
            for (by_m, by_k) in [(1.0, 0.0), (0.0, 1.0), (0.3, -0.7)] {
                let moved = ratio_damping(&dual(&m, by_m), &dual(&k, by_k), Dual::from(0.03));
                for (moved, &c) in moved.iter().zip(c.transpose().iter()) {
                    let expected = 0.5 * (by_m + by_k) * c;
                    assert!((moved.du - expected).abs() < 1e-12 * c.abs().max(0.1));
                }
            }
            // Another direction: C M⁻¹ C = 4ζ² K stays true to first order.
            let direction = spd(seed + 9);
            let moved: Vec<Complex64> = (k.iter().zip(direction.iter()))
                .map(|(&x, &d)| Complex64::new(x, d * 1e-30))
                .collect();
            let lifted: Vec<Complex64> = m.iter().map(|&x| Complex64::from(x)).collect();
            let slope = ratio_damping(&lifted, &moved, Complex64::from(0.03));
            let slope = DMatrix::from_fn(n, n, |i, j| slope[i * n + j].im * 1e30);
            let inverse = mass.try_inverse().expect("regular");
            let left = &slope * &inverse * &c + &c * &inverse * &slope;
            let gap = (left - direction * (4.0 * 0.03f64.powi(2))).norm();
            assert!(gap < 1e-12, "{gap:e}");
        }
    }
}
